use equip_autodiff::*;
use equip_scalar::*;
use equip_solver::*;
use std::time::Instant;
type H = Hamiltonian;
fn sq(x: Var) -> Var {
    x * x
}
pub struct Sys {
    name: &'static str,
    h: H,
    q: Vec<f64>,
    p: Vec<f64>,
    cells: Vec<(usize, f64, usize)>,
}
fn run<T: Float>(
    h: &H,
    q: &[f64],
    p: &[f64],
    s: usize,
    dt: T,
    n: usize,
    equip: bool,
    pre: Preconditioner,
) -> Result<(Vec<T>, Counts, f64, f64, f64), String> {
    let fam = if equip {
        Family::Equip(Alphas::All)
    } else {
        Family::Gauss
    };
    let mut o = StepOptions::<T>::new(s, fam);
    o.preconditioner = pre;
    let qt: Vec<T> = q.iter().map(|&x| T::exact(x)).collect();
    let pt: Vec<T> = p.iter().map(|&x| T::exact(x)).collect();
    let mut y = State::new(&qt, &pt);
    let mut ev = h.evaluator::<T>();
    let h0 = ev.compensated_value(&y.hi);
    let g = equip_tableau::Gauss::<T>::new(s).unwrap();
    let cons = if equip && !h.structure().is_quadratic() {
        vec![Constraint::energy(h0, y.hi.len())]
    } else {
        vec![]
    };
    let mut core = Core::new(h, ev, o, g, cons);
    let mut next = y.clone();
    let t0 = Instant::now();
    let mut worst = 0f64;
    let mut ev2 = h.evaluator::<T>();
    for i in 0..n {
        let out = core
            .step(&y, T::int(i as i64) * dt, dt, &mut next)
            .map_err(|e| format!("{e:?} at {i}"))?;
        core.counts_mut().record(out);
        std::mem::swap(&mut y, &mut next);
        worst = worst.max((ev2.compensated_value(&y.hi) - h0).abs().to_f64());
    }
    let el = t0.elapsed().as_secs_f64();
    // back
    let mut back = 0f64;
    let hs: Vec<T> = y.hi.clone();
    {
        let mut yy = y.clone();
        core.forget();
        for i in 0..n.min(20) {
            if core
                .step(&yy, T::int(i as i64) * dt, -dt, &mut next)
                .is_err()
            {
                back = f64::NAN;
                break;
            }
            std::mem::swap(&mut yy, &mut next);
        }
        // forward again
        core.forget();
        if back == 0.0 {
            for i in 0..n.min(20) {
                if core
                    .step(&yy, T::int(i as i64) * dt, dt, &mut next)
                    .is_err()
                {
                    back = f64::NAN;
                    break;
                }
                std::mem::swap(&mut yy, &mut next);
            }
            back = yy
                .hi
                .iter()
                .zip(&hs)
                .map(|(a, b)| ((*a - *b).abs()).to_f64())
                .fold(0.0, f64::max);
        }
    }
    Ok((hs, *core.counts(), el, worst, back))
}
fn err(a: &[DoubleDouble], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(x, y)| (x.to_f64() - y).abs())
        .fold(0.0, f64::max)
}
fn main() {
    let filter = std::env::args().nth(1).unwrap_or_default();
    let ring = |n: usize| {
        Hamiltonian::new(n, move |q, p| {
            (0..n)
                .map(|i| 0.5 * p[i] * p[i] + 1.0 - (q[(i + 1) % n] - q[i]).cos())
                .sum::<Var>()
        })
        .unwrap()
    };
    let rnd = |n: usize, a: f64, b: f64, seed: u64| -> Vec<f64> {
        let mut x = seed
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (0..n)
            .map(|_| {
                x = x
                    .wrapping_mul(6364136223846793005)
                    .wrapping_add(1442695040888963407);
                a + (b - a) * ((x >> 11) as f64 / (1u64 << 53) as f64)
            })
            .collect()
    };
    let fpu = |w: f64| {
        Hamiltonian::new(6, move |q, p| {
            let k: Var = p.iter().map(|&p| 0.5 * p * p).sum();
            let f: Var = (3..6).map(|i| 0.5 * w * w * q[i] * q[i]).sum();
            let mut u = sq(sq(q[0] - q[3])) + sq(sq(q[2] + q[5]));
            for i in 0..2 {
                u = u + sq(sq(q[i + 1] - q[4 + i] - q[i] - q[3 + i]));
            }
            k + f + 0.25 * u
        })
        .unwrap()
    };
    let kepler = || {
        Hamiltonian::new(2, |q, p| {
            0.5 * (p[0] * p[0] + p[1] * p[1]) - 1.0 / (q[0] * q[0] + q[1] * q[1]).sqrt()
        })
        .unwrap()
    };
    let kep = |e: f64| {
        (
            vec![1.0 - e, 0.0],
            vec![0.0, ((1.0 + e) / (1.0 - e)).sqrt()],
        )
    };
    let hh = || {
        Hamiltonian::new(2, |q, p| {
            0.5 * (p[0] * p[0] + p[1] * p[1] + q[0] * q[0] + q[1] * q[1]) + q[0] * q[0] * q[1]
                - q[1] * q[1] * q[1] / 3.0
        })
        .unwrap()
    };
    let tp = std::f64::consts::TAU;
    let mut v: Vec<Sys> = vec![];
    let mut add = |name, h, q: Vec<f64>, p: Vec<f64>, cells: Vec<(usize, f64, usize)>| {
        v.push(Sys {
            name,
            h,
            q,
            p,
            cells,
        })
    };
    add(
        "pendulum",
        Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos()).unwrap(),
        vec![1.3],
        vec![0.9],
        vec![
            (4, 0.35, 60),
            (6, 0.67, 30),
            (8, 0.5, 40),
            (3, 0.2, 100),
            (2, 0.1, 200),
            (12, 1.0, 40),
        ],
    );
    add(
        "pend.01",
        Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + (1.0 - q[0].cos())).unwrap(),
        vec![0.01],
        vec![0.0],
        vec![(4, 0.25, 400)],
    );
    add(
        "pend1e-5",
        Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + (1.0 - q[0].cos())).unwrap(),
        vec![1e-5],
        vec![0.0],
        vec![(4, 0.25, 400)],
    );
    add(
        "HH 1/6",
        hh(),
        vec![0.0, 0.1],
        vec![0.55, 0.05],
        vec![
            (6, 1.0, 60),
            (4, 0.5, 100),
            (8, 1.0, 60),
            (12, 1.0, 60),
            (3, 0.25, 100),
            (2, 0.1, 200),
        ],
    );
    let (q, p) = kep(0.6);
    add(
        "Kepler.6",
        kepler(),
        q,
        p,
        vec![
            (4, tp / 24.0, 100),
            (6, tp / 24.0, 100),
            (8, tp / 24.0, 100),
            (8, tp / 12.0, 100),
            (16, tp / 12.0, 100),
            (16, tp / 6.0, 60),
            (3, tp / 75.0, 150),
            (2, tp / 75.0, 150),
        ],
    );
    let (q, p) = kep(0.05);
    add(
        "Kepler.05",
        kepler(),
        q,
        p,
        vec![
            (6, tp / 12.0, 100),
            (4, tp / 24.0, 100),
            (16, tp / 4.0, 100),
        ],
    );
    let (q, p) = kep(0.0);
    add(
        "Kepler0",
        kepler(),
        q,
        p,
        vec![
            (6, tp / 12.0, 100),
            (16, tp / 4.0, 100),
            (8, tp / 12.0, 1000),
        ],
    );
    let (q, p) = kep(0.9);
    add(
        "Kepler.9",
        kepler(),
        q,
        p,
        vec![(8, tp / 100.0, 200), (12, tp / 60.0, 100)],
    );
    add(
        "dblpend",
        Hamiltonian::new(2, |q, p| {
            let d = q[0] - q[1];
            let s = d.sin();
            let c = d.cos();
            (p[0] * p[0] + 2.0 * p[1] * p[1] - 2.0 * p[0] * p[1] * c) / (2.0 * (1.0 + s * s))
                - 2.0 * q[0].cos()
                - q[1].cos()
        })
        .unwrap(),
        vec![1.0, 1.6],
        vec![0.3, 0.1],
        vec![(4, 0.0625, 100), (6, 0.2, 60), (8, 0.3, 40)],
    );
    add(
        "ring16",
        ring(16),
        rnd(16, 0.0, 3.0, 5),
        rnd(16, -2.0, 2.0, 6),
        vec![
            (4, 10.0 / 60.0, 60),
            (4, 10.0 / 120.0, 120),
            (6, 0.25, 40),
            (8, 0.25, 40),
        ],
    );
    add(
        "ring11",
        ring(11),
        rnd(11, 0.0, 3.0, 7),
        rnd(11, -2.0, 2.0, 8),
        vec![(4, 0.3, 100)],
    );
    add(
        "fput16",
        Hamiltonian::new(16, |q, p| {
            let k: Var = p.iter().map(|&p| 0.5 * p * p).sum();
            let z = 0.0 * q[0];
            let mut u = z;
            let mut prev = z;
            for i in 0..16 {
                let d = q[i] - prev;
                u = u + 0.5 * d * d + 0.25 * d * d * d * d;
                prev = q[i];
            }
            u = u + 0.5 * prev * prev + 0.25 * prev * prev * prev * prev;
            k + u
        })
        .unwrap(),
        (1..=16)
            .map(|i| (i as f64 * 3.14159 / 17.0).sin())
            .collect(),
        vec![0.0; 16],
        vec![(4, 0.3, 100), (8, 0.5, 60)],
    );
    add(
        "field",
        Hamiltonian::new(3, |q, p| {
            let a0 = -0.5 * q[1] * (1.0 + 0.1 * q[0] * q[0]);
            let a1 = 0.5 * q[0] * (1.0 + 0.2 * q[2]);
            0.5 * (sq(p[0] - a0) + sq(p[1] - a1) + p[2] * p[2])
                + 0.1 * (q[0] * q[0] + q[1] * q[1]).cos()
                + 0.05 * q[2] * q[2] * q[2] * q[2]
        })
        .unwrap(),
        vec![1.0, 0.2, 0.3],
        vec![0.1, 0.9, 0.4],
        vec![(4, 0.5, 60), (6, 0.8, 50), (8, 0.8, 50)],
    );
    add(
        "spring1e6",
        Hamiltonian::new(2, |q, p| {
            let r = (q[0] * q[0] + q[1] * q[1]).sqrt();
            0.5 * (p[0] * p[0] + p[1] * p[1]) + 0.5e6 * sq(r - 1.0) + q[1]
        })
        .unwrap(),
        vec![1.0, 0.0],
        vec![0.0, 0.0],
        vec![(8, 0.42e-3, 2000), (6, 0.55e-3, 2000), (8, 0.01, 200)],
    );
    add(
        "fpu50",
        fpu(50.0),
        vec![1.0, 0.0, 0.0, 0.02, 0.0, 0.0],
        vec![1.0, 0.0, 0.0, 1.0, 0.0, 0.0],
        vec![
            (6, 0.05, 200),
            (8, 0.02, 300),
            (16, 0.2, 50),
            (24, 0.25, 40),
            (32, 0.5, 20),
        ],
    );
    add(
        "fpu500",
        fpu(500.0),
        vec![1.0, 0.0, 0.0, 0.002, 0.0, 0.0],
        vec![1.0, 0.0, 0.0, 1.0, 0.0, 0.0],
        vec![(32, 0.05, 100), (16, 0.02, 100), (4, 0.1, 100)],
    );
    let c = 10.0;
    add(
        "relkepler",
        Hamiltonian::new(2, move |q, p| {
            c * (c * c + p[0] * p[0] + p[1] * p[1]).sqrt()
                - c * c
                - 1.0 / (q[0] * q[0] + q[1] * q[1]).sqrt()
        })
        .unwrap(),
        vec![0.5, 0.0],
        vec![0.0, 1.7],
        vec![(8, 0.1, 300)],
    );
    add(
        "gyr",
        Hamiltonian::new(2, |q, p| {
            0.5 * p[0] * p[0] + ((1.0 + q[0] * q[0]) * q[1] * q[1] + p[1] * p[1]) * (0.5 / 1e-4)
        })
        .unwrap(),
        vec![0.0, 0.01],
        vec![1.0, 0.0],
        vec![(4, 0.005, 1000), (4, 0.08, 60)],
    );
    for sys in &v {
        if !sys.name.contains(&filter) {
            continue;
        }
        for &(s, h, n) in &sys.cells {
            let reft = run::<DoubleDouble>(
                &sys.h,
                &sys.q,
                &sys.p,
                16.max(s).min(20),
                DoubleDouble::exact(h) / DoubleDouble::int(if s > 16 { 4 } else { 2 }),
                n * (if s > 16 { 4 } else { 2 }),
                false,
                Preconditioner::Automatic,
            );
            let mut best = [f64::INFINITY; 2];
            let mut keep = [None, None];
            for _ in 0..3 {
                for (i, e) in [false, true].into_iter().enumerate() {
                    let r = run::<f64>(
                        &sys.h,
                        &sys.q,
                        &sys.p,
                        s,
                        h,
                        n,
                        e,
                        Preconditioner::Automatic,
                    );
                    if let Ok(x) = &r {
                        best[i] = best[i].min(x.2);
                    }
                    keep[i] = Some(r);
                }
            }
            let (g, e) = (keep[0].take().unwrap(), keep[1].take().unwrap());
            let refs = match &reft {
                Ok(r) => Some(r.0.clone()),
                Err(x) => {
                    println!("ref {x}");
                    None
                }
            };
            match (g, e) {
                (Ok(g), Ok(e)) => {
                    let (a, b) = refs
                        .map(|r| (err(&r, &g.0), err(&r, &e.0)))
                        .unwrap_or((0., 0.));
                    let c = &e.1;
                    let cg = &g.1;
                    println!(
                        "{:10} s={:2} h={:<7.4} err {:.1e}/{:.1e} = {:<7.2} dH {:.1e}/{:.1e} t {:<5.2} grad {:<5.2} it/step {:.1} | {:.1} hess {} dir {} mov {} | floor {} solved {} noslope {} bound {} far {} halv {} back {:.1e}/{:.1e}",
                        sys.name,
                        s,
                        h,
                        b,
                        a,
                        b / a,
                        e.3,
                        g.3,
                        best[1] / best[0],
                        c.gradients as f64 / cg.gradients as f64,
                        (cg.sweeps + cg.newton_iterations) as f64 / n as f64,
                        (c.sweeps + c.newton_iterations) as f64 / n as f64,
                        c.hessians,
                        c.directions,
                        c.alpha_moves,
                        c.outcome(Outcome::AtFloor),
                        c.outcome(Outcome::Solved),
                        c.outcome(Outcome::NoSlope),
                        c.outcome(Outcome::BeyondBound),
                        c.outcome(Outcome::TooFar),
                        c.halvings,
                        e.4,
                        g.4
                    );
                }
                (g, e) => println!(
                    "{} s={s} h={h}: gauss {:?} equip {:?}",
                    sys.name,
                    g.err(),
                    e.err()
                ),
            }
        }
    }
}
