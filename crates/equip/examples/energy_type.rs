//! An energy as a type: the compiler turns it into machine code with its derivatives, and other energies can
//! be built on it.

use equip::prelude::*;

/// A ring of masses with springs whose force has a cubic part, as Fermi, Pasta, Ulam and Tsingou had it.
struct Chain {
    masses: usize,
    beta: Constant,
}

impl Energy for Chain {
    fn degrees_of_freedom(&self) -> usize {
        self.masses
    }

    fn energy<S: Scalar>(&self, q: &[Num<S>], p: &[Num<S>]) -> Num<S> {
        let kinetic: Num<S> = p.iter().map(|&p| 0.5 * p * p).sum();
        let stretch = |i: usize| q[(i + 1) % self.masses] - q[i];
        let potential: Num<S> = (0..self.masses)
            .map(|i| 0.5 * stretch(i).powi(2) + self.beta * (0.25 * stretch(i).powi(4)))
            .sum();
        kinetic + potential
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let chain = Chain {
        masses: 8,
        beta: ratio(3, 10),
    };
    let q: Vec<f64> = (0..8)
        .map(|i| (std::f64::consts::TAU * i as f64 / 8.0).sin())
        .collect();
    let run = Equip::stages(4).step(0.1).integrate(
        &Hamiltonian::from_energy(chain)?,
        &q,
        &[0.0; 8],
        0.0..=100.0,
    )?;
    println!("{}", run.certificate());
    assert!(run.certificate().energy_kept_on_every_step());
    Ok(())
}
