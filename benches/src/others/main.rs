//! Runs by tolerance of Hamiltonians from the literature, from random starts, EQUIP beside Gauss: what
//! constants of step control are judged by. Nothing was tuned on these starts; some of the systems (DNLS,
//! three bodies, a stiff spring) have a relative among the scenes.
//!
//! `cargo run --release -p equip-benches --bin others -- 12`
//!
//! For each system, start, number of stages and tolerance: the error at the end in tolerances, positions and
//! momenta each in units of the largest of them there or at the start; and the work in gradients, with 2m of
//! them for a Hessian. The reference is Gauss with 12 stages at 1e-15, trusted as far as 10 stages at 1e-14
//! agree with it. Errors below a tolerance count as one.

mod systems;

use clap::Parser;
use equip_autodiff::BuildError;
use equip_integrate::{Equip, Gauss, Integrator, Record, RunFailure};
use equip_tests::Seeded;
use systems::{SYSTEMS, System};

/// Runs by tolerance of systems that nothing was tuned on.
#[derive(Debug, Parser)]
struct Args {
    /// Random starts of each system.
    #[arg(default_value_t = 4)]
    starts: u64,
    /// Only the systems whose name contains this.
    #[arg(long, default_value = "", value_name = "SYSTEM")]
    filter: String,
    /// Numbers of stages.
    #[arg(long, value_delimiter = ',', default_value = "3,4,6,8,12")]
    stages: Vec<usize>,
    /// Tolerances.
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "1e-5,1e-7,1e-9,1e-11,1e-13"
    )]
    tolerances: Vec<f64>,
}

/// EQUIP and Gauss with the same stages and tolerance: errors in tolerances, and work.
struct Pair {
    errors: [f64; 2],
    work: [f64; 2],
}

fn main() -> Result<(), BuildError> {
    let args = Args::parse();
    let mut all = Pairs::default();
    println!(
        "{:<24} {:>6} {:>10} {:>10} {:>14} {:>14} {:>7}",
        "system", "runs", "work", "error", "largest", "Gauss's", "ended"
    );
    for (name, system) in SYSTEMS {
        if name.contains(&args.filter) {
            let mut pairs = Pairs::default();
            for seed in 0..args.starts {
                pairs.run(name, &system(&mut Seeded::new(seed))?, &args);
            }
            pairs.print(name);
            all.append(pairs);
        }
    }
    all.print("all");
    Ok(())
}

#[derive(Default)]
struct Pairs {
    made: Vec<Pair>,
    /// Runs of EQUIP that end with an error.
    ended: usize,
}

impl Pairs {
    fn run(&mut self, name: &str, system: &System, args: &Args) {
        let (fine, less_fine) = (Gauss::stages(12), Gauss::stages(10));
        let (Ok(fine), Ok(less_fine)) = (
            system.end(fine.tolerance(1e-15)),
            system.end(less_fine.tolerance(1e-14)),
        ) else {
            eprintln!("{name}: a start has no reference");
            return;
        };
        let trusted = system.distance(&fine.0, &less_fine.0);
        for &stages in &args.stages {
            for &tolerance in &args.tolerances {
                let runs = [Equip::stages(stages), Gauss::stages(stages)]
                    .map(|method| system.end(method.tolerance(tolerance)));
                match runs {
                    [Ok(equip), Ok(gauss)] => self.made.push(Pair {
                        errors: [&equip, &gauss].map(|(state, _)| {
                            let error = system.distance(state, &fine.0);
                            (error / tolerance.max(trusted)).max(1.0)
                        }),
                        work: [equip.1, gauss.1],
                    }),
                    [Err(error), _] => {
                        self.ended += 1;
                        eprintln!("{name}, s = {stages}, {tolerance:e}: {error}");
                    }
                    [Ok(_), Err(_)] => {}
                }
            }
        }
    }

    fn append(&mut self, mut other: Pairs) {
        self.made.append(&mut other.made);
        self.ended += other.ended;
    }

    /// Means are geometric, of EQUIP over Gauss.
    fn print(&self, name: &str) {
        let mean = |of: fn(&Pair) -> [f64; 2]| {
            let logarithms = self.made.iter().map(of).map(|[a, b]| (a / b).ln());
            (logarithms.sum::<f64>() / self.made.len() as f64).exp()
        };
        let [equip, gauss] = [0, 1].map(|i| {
            let errors = self.made.iter().map(|pair| pair.errors[i]);
            errors.fold(0.0, f64::max)
        });
        println!(
            "{name:<24} {:>6} {:>10.2} {:>10.2} {equip:>14.1} {gauss:>14.1} {:>7}",
            self.made.len(),
            mean(|pair| pair.work),
            mean(|pair| pair.errors),
            self.ended
        );
    }
}

impl System {
    /// The state at the end, and the work.
    fn end(&self, method: Integrator<f64>) -> Result<(Vec<f64>, f64), RunFailure<f64>> {
        let method = method.record(Record::Ends);
        let run = method.integrate(&self.energy, &self.q, &self.p, 0.0..=self.end)?;
        let (counts, (_, q, p)) = (&run.certificate().counts, run.last());
        let work = counts.gradients + 2 * self.q.len() as u64 * counts.hessians;
        Ok(([q, p].concat(), work as f64))
    }

    fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let m = self.q.len();
        let largest = |x: &[f64]| x.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let halves = [(&self.q, 0..m), (&self.p, m..2 * m)].map(|(start, half)| {
            let size = largest(start).max(largest(&b[half.clone()]));
            let pairs = a[half.clone()].iter().zip(&b[half]);
            pairs.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs())) / size
        });
        halves[0].max(halves[1])
    }
}
