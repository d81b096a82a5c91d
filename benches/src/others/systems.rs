//! Hamiltonians from textbooks and papers, in units in which they are of size 1, each with random starts.

use equip_autodiff::{BuildError, Hamiltonian, Var};
use equip_tests::Seeded;

/// A Hamiltonian, a start, and how long it runs.
pub(crate) struct System {
    pub(crate) energy: Hamiltonian,
    pub(crate) q: Vec<f64>,
    pub(crate) p: Vec<f64>,
    pub(crate) end: f64,
}

/// One of them, of random parameters, at a random start.
type Drawn = Result<System, BuildError>;
type Draw = fn(&mut Seeded) -> Drawn;

/// All of them, by name.
pub(crate) const SYSTEMS: [(&str, Draw); 30] = [
    ("three Toda particles", toda),
    ("Morse oscillators", morse),
    ("spring and rod", spring),
    ("oscillator in a bath", bath),
    ("small pendulum", small_pendulum),
    ("eight rotors", rotors),
    ("cosh chain", cosh_chain),
    ("restricted three bodies", three_bodies),
    ("Hill's problem", hill),
    ("logarithmic halo", halo),
    ("Plummer sphere", plummer),
    ("predator and prey", predator),
    ("four vortices", vortices),
    ("DNLS ring", dnls),
    ("Lennard-Jones triangle", lennard_jones),
    ("Schwarzschild orbit", schwarzschild),
    ("relativistic Kepler", relativistic),
    ("swinging Atwood machine", atwood),
    ("spherical pendulum", spherical),
    ("free rigid body", rigid_body),
    ("helium, planar", helium),
    ("kinks of φ⁴", phi_four),
    ("Störmer's dipole", dipole),
    ("Nosé's thermostat", nose),
    ("geodesic on a torus", torus),
    ("relativistic oscillator", relativistic_oscillator),
    ("Yang-Mills mechanics", yang_mills),
    ("graded index fibre", fibre),
    ("Paul trap", paul_trap),
    ("centrifugal barrier", barrier),
];

/// Starts around (q, p), each component within so much of it, and the end.
fn system(
    rng: &mut Seeded,
    (q, p, [by_q, by_p]): (&[f64], &[f64], [f64; 2]),
    end: f64,
    energy: impl Fn(&[Var], &[Var]) -> Var,
) -> Drawn {
    let mut around =
        |x: &[f64], by: f64| -> Vec<f64> { x.iter().map(|x| x + rng.between(-by, by)).collect() };
    let (q, p) = (around(q, by_q), around(p, by_p));
    Ok(System {
        energy: Hamiltonian::new(q.len(), energy)?,
        q,
        p,
        end,
    })
}

fn square(x: &[Var]) -> Var {
    x.iter().skip(1).fold(x[0] * x[0], |sum, &x| sum + x * x)
}

fn kinetic(p: &[Var]) -> Var {
    0.5 * square(p)
}

/// Σ f(x_{i+1} − x_i) on a ring.
fn ring(x: &[Var], f: impl Fn(Var) -> Var) -> Var {
    let next = x.iter().cycle().skip(1);
    let terms = x.iter().zip(next).map(|(&x, &next)| f(next - x));
    terms.reduce(|a, b| a + b).unwrap_or(x[0] * 0.0)
}

fn toda(rng: &mut Seeded) -> Drawn {
    let start = (&[0.0; 3][..], &[0.0; 3][..], [1.0, 1.0]);
    system(rng, start, 20.0, |q, p| {
        kinetic(p) + ring(q, Var::exp) - 3.0
    })
}

fn morse(rng: &mut Seeded) -> Drawn {
    let start = (&[0.3; 2][..], &[0.0; 2][..], [0.3, 0.5]);
    system(rng, start, 20.0, |q, p| {
        let well = |x: Var| (1.0 - (-x).exp()).powi(2);
        kinetic(p) + 4.0 * well(q[0]) + 2.0 * well(q[1]) + 0.1 * q[0] * q[1]
    })
}

fn spring(rng: &mut Seeded) -> Drawn {
    let k = rng.power_of_ten(2.0, 6.0);
    let start = (&[1.005, 0.0][..], &[0.0, 0.5][..], [0.005, 0.5]);
    system(rng, start, 5.0, move |q, p| {
        kinetic(p) + 0.5 * k * (square(q).sqrt() - 1.0).powi(2) + q[1]
    })
}

fn bath(rng: &mut Seeded) -> Drawn {
    let omega = rng.power_of_ten(0.5, 2.0);
    let start = (&[0.0; 3][..], &[0.0; 3][..], [0.3, 1.0]);
    system(rng, start, 5.0, move |q, p| {
        let slow = 0.25 * q[0].powi(4) + 0.5 * (q[1] - q[0]).powi(2);
        kinetic(p) + slow + 0.5 * omega * omega * q[2] * q[2] + 0.3 * q[2] * q[1] * q[1]
    })
}

fn small_pendulum(rng: &mut Seeded) -> Drawn {
    let start = ([rng.power_of_ten(-6.0, 0.0)], [0.0], [0.0, 0.0]);
    let start = (&start.0[..], &start.1[..], start.2);
    system(rng, start, 50.0, |q, p| kinetic(p) + (1.0 - q[0].cos()))
}

fn rotors(rng: &mut Seeded) -> Drawn {
    let start = (&[1.5; 8][..], &[0.0; 8][..], [1.5, 2.0]);
    system(rng, start, 10.0, |q, p| {
        kinetic(p) + ring(q, |d| 1.0 - d.cos())
    })
}

fn cosh_chain(rng: &mut Seeded) -> Drawn {
    let start = (&[0.0; 6][..], &[0.0; 6][..], [0.5, 0.5]);
    system(rng, start, 10.0, |q, p| {
        kinetic(p) + ring(q, |d| d.cosh() - 1.0)
    })
}

/// The Earth and the Moon, in the rotating frame.
fn three_bodies(rng: &mut Seeded) -> Drawn {
    let start = (&[0.4, 0.0][..], &[0.0, 1.6][..], [0.1, 0.2]);
    system(rng, start, 10.0, |q, p| {
        let mu = 0.0121505;
        let from = |x: f64| ((q[0] - x).powi(2) + q[1] * q[1]).sqrt();
        kinetic(p) + q[1] * p[0] - q[0] * p[1] - (1.0 - mu) / from(-mu) - mu / from(1.0 - mu)
    })
}

fn hill(rng: &mut Seeded) -> Drawn {
    let start = (&[0.3, 0.0][..], &[0.0, 1.9][..], [0.05, 0.2]);
    system(rng, start, 10.0, |q, p| {
        let tide = 0.5 * q[1] * q[1] - q[0] * q[0];
        kinetic(p) + q[1] * p[0] - q[0] * p[1] + tide - 1.0 / square(q).sqrt()
    })
}

fn halo(rng: &mut Seeded) -> Drawn {
    let start = (&[0.65, 0.1][..], &[0.1, 0.5][..], [0.3, 0.3]);
    system(rng, start, 30.0, |q, p| {
        kinetic(p) + 0.5 * (q[0] * q[0] + q[1] * q[1] / 0.81 + 0.01).ln()
    })
}

fn plummer(rng: &mut Seeded) -> Drawn {
    let start = (&[0.0; 3][..], &[0.0; 3][..], [1.0, 0.4]);
    system(rng, start, 30.0, |q, p| {
        kinetic(p) - 1.0 / (square(q) + 0.25).sqrt()
    })
}

/// Lotka and Volterra, in logarithms.
fn predator(rng: &mut Seeded) -> Drawn {
    let start = (&[0.0][..], &[0.0][..], [1.0, 1.0]);
    system(rng, start, 30.0, |q, p| {
        q[0].exp() - q[0] + 0.7 * p[0].exp() - p[0]
    })
}

fn vortices(rng: &mut Seeded) -> Drawn {
    let (q, p) = ([1.0, -0.5, -0.6, 0.2], [0.1, 0.9, -0.8, 0.05]);
    let start = (&q[..], &p[..], [0.1, 0.1]);
    system(rng, start, 20.0, |q, p| {
        let pairs = (0..4).flat_map(|i| (0..i).map(move |j| (i, j)));
        pairs.fold(q[0] * 0.0, |sum, (i, j)| {
            sum - 0.25 * ((q[i] - q[j]).powi(2) + (p[i] - p[j]).powi(2)).ln()
        })
    })
}

fn dnls(rng: &mut Seeded) -> Drawn {
    let start = (&[0.0; 5][..], &[0.0; 5][..], [0.7, 0.7]);
    system(rng, start, 20.0, |q, p| {
        let sites = (0..5).map(|i| (q[i] * q[i] + p[i] * p[i], (i + 1) % 5, i));
        sites.fold(q[0] * 0.0, |sum, (norm, next, i)| {
            sum + 0.25 * norm * norm - (q[i] * q[next] + p[i] * p[next])
        })
    })
}

fn lennard_jones(rng: &mut Seeded) -> Drawn {
    let (q, p) = ([0.0, 0.0, 1.15, 0.0, 0.55, 1.0], [0.0; 6]);
    let start = (&q[..], &p[..], [0.03, 0.3]);
    system(rng, start, 5.0, |q, p| {
        let pairs = [(0, 2), (0, 4), (2, 4)];
        pairs.into_iter().fold(kinetic(p), |sum, (i, j)| {
            let r = (q[i] - q[j]).powi(2) + (q[i + 1] - q[j + 1]).powi(2);
            let sixth = 1.0 / r.powi(3);
            sum + 4.0 * (sixth * sixth - sixth)
        })
    })
}

fn schwarzschild(rng: &mut Seeded) -> Drawn {
    let start = (&[10.0, 0.0][..], &[0.0, 3.9][..], [2.0, 0.1]);
    system(rng, start, 500.0, |q, p| {
        let f = 1.0 - 2.0 / q[0];
        let angular = (p[1] / q[0]).powi(2);
        (f * (1.0 + f * p[0] * p[0] + angular)).sqrt() - 1.0
    })
}

fn relativistic(rng: &mut Seeded) -> Drawn {
    let c = rng.power_of_ten(0.5, 2.2);
    let start = (&[1.0, 0.0][..], &[0.0, 1.1][..], [0.05, 0.1]);
    system(rng, start, 20.0, move |q, p| {
        c * (c * c + square(p)).sqrt() - c * c - 1.0 / square(q).sqrt()
    })
}

fn atwood(rng: &mut Seeded) -> Drawn {
    let start = (&[1.0, 0.7][..], &[0.0, 0.0][..], [0.2, 0.4]);
    system(rng, start, 10.0, |q, p| {
        let moving = p[0] * p[0] / 7.0 + 0.5 * (p[1] / q[0]).powi(2);
        moving + q[0] * (2.5 - q[1].cos())
    })
}

fn spherical(rng: &mut Seeded) -> Drawn {
    let start = (&[1.25, 0.0][..], &[0.0, 0.65][..], [0.7, 0.35]);
    system(rng, start, 20.0, |q, p| {
        0.5 * p[0] * p[0] + 0.5 * (p[1] / q[0].sin()).powi(2) + q[0].cos()
    })
}

/// In Andoyer's variables, moments of inertia 1, 1.7 and 2.6.
fn rigid_body(rng: &mut Seeded) -> Drawn {
    let start = (&[1.5, 1.5][..], &[0.0, 1.0][..], [1.5, 0.3]);
    system(rng, start, 30.0, |q, p| {
        let across = p[1] * p[1] - p[0] * p[0];
        let inverse = q[0].sin().powi(2) + q[0].cos().powi(2) / 1.7;
        0.5 * across * inverse + p[0] * p[0] / 5.2
    })
}

fn helium(rng: &mut Seeded) -> Drawn {
    let (q, p) = ([1.0, 0.1, -1.0, -0.05], [0.0, 1.2, 0.0, -1.2]);
    let start = (&q[..], &p[..], [0.1, 0.2]);
    system(rng, start, 10.0, |q, p| {
        let apart = ((q[0] - q[2]).powi(2) + (q[1] - q[3]).powi(2)).sqrt();
        let bound = 2.0 / square(&q[..2]).sqrt() + 2.0 / square(&q[2..]).sqrt();
        kinetic(p) - bound + 1.0 / apart
    })
}

fn phi_four(rng: &mut Seeded) -> Drawn {
    let start = (&[0.0; 12][..], &[0.0; 12][..], [1.0, 0.5]);
    system(rng, start, 10.0, |q, p| {
        let wells = q
            .iter()
            .fold(q[0] * 0.0, |sum, &q| sum + 0.25 * (q * q - 1.0).powi(2));
        kinetic(p) + ring(q, |d| 0.5 * d * d) + wells
    })
}

fn dipole(rng: &mut Seeded) -> Drawn {
    let start = (&[1.0, 0.0, 0.1][..], &[0.0, 0.1, 0.1][..], [0.05, 0.1]);
    system(rng, start, 20.0, |q, p| {
        let r = square(q);
        let a = 5.0 / (r * r.sqrt());
        0.5 * ((p[0] + a * q[1]).powi(2) + (p[1] - a * q[0]).powi(2) + p[2] * p[2])
    })
}

fn nose(rng: &mut Seeded) -> Drawn {
    let start = (&[1.0, 1.0][..], &[0.0, 0.0][..], [0.3, 0.3]);
    system(rng, start, 20.0, |q, p| {
        0.5 * (p[0] / q[1]).powi(2) + 0.5 * (q[0] * q[0] + p[1] * p[1]) + q[1].ln()
    })
}

fn torus(rng: &mut Seeded) -> Drawn {
    let start = (&[1.5, 0.0][..], &[0.0, 1.2][..], [1.5, 0.7]);
    system(rng, start, 20.0, |q, p| {
        0.5 * p[0] * p[0] + 0.5 * (p[1] / (2.0 + q[0].cos())).powi(2)
    })
}

fn relativistic_oscillator(rng: &mut Seeded) -> Drawn {
    let start = (&[1.75][..], &[0.0][..], [1.25, 0.5]);
    system(rng, start, 30.0, |q, p| {
        (1.0 + p[0] * p[0]).sqrt() - 1.0 + 0.5 * q[0] * q[0]
    })
}

fn yang_mills(rng: &mut Seeded) -> Drawn {
    let start = (&[0.0; 2][..], &[0.0; 2][..], [1.2, 0.7]);
    system(rng, start, 20.0, |q, p| {
        kinetic(p) + 0.5 * (q[0] * q[1]).powi(2)
    })
}

fn fibre(rng: &mut Seeded) -> Drawn {
    let start = (&[0.0; 2][..], &[0.0; 2][..], [0.5, 0.3]);
    system(rng, start, 20.0, |q, p| {
        -(2.25 * (1.0 - 0.1 * square(q)) - square(p)).sqrt()
    })
}

/// Time is the second position.
fn paul_trap(rng: &mut Seeded) -> Drawn {
    let start = (&[0.75, 0.0][..], &[0.0, 0.0][..], [0.25, 0.2]);
    system(rng, start, 20.0, |q, p| {
        0.5 * p[0] * p[0] + p[1] + 0.5 * q[0] * q[0] * (0.3 + 0.4 * (2.0 * q[1]).cos())
    })
}

fn barrier(rng: &mut Seeded) -> Drawn {
    let spin = rng.between(1.0, 30.0);
    let start = (&[1.0][..], &[0.0][..], [0.1, 0.5]);
    system(rng, start, 3.0, move |q, p| {
        0.5 * p[0] * p[0] + 0.5 * (spin / q[0]).powi(2) + 0.5 * q[0] * q[0]
    })
}
