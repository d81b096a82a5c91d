//! What all cases come to.

use super::case::{Case, run};
use super::claims::{energy_is_as_claimed, work_is_bounded};
use super::trajectory::errors;
use equip_integrate::{Alphas, IntegrateError, Outcome};
use std::collections::BTreeMap;

/// What the trajectory is held against: with more than one α the energy is kept without much displacement;
/// with a single one (s = 2, or only the last) it costs what it costs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Freedom {
    Several,
    Single,
}

#[derive(Debug, Default)]
pub(super) struct Summary {
    pub(super) outcomes: BTreeMap<&'static str, u64>,
    pub(super) ends: BTreeMap<String, u64>,
    pub(super) kinds: BTreeMap<String, u64>,
    /// Largest defect in floors, and the seed.
    pub(super) energy: Vec<(f64, u64)>,
    pub(super) quadratic: Vec<(f64, u64)>,
    /// Error over that of Gauss, and the seed.
    pub(super) trajectories: BTreeMap<Freedom, Vec<(f64, u64)>>,
}

impl Summary {
    pub(super) fn see(&mut self, seed: u64) {
        let case = Case::new(seed);
        let ran = run(&case);
        work_is_bounded(&case, &ran);
        let energy = energy_is_as_claimed(&case, &ran);
        for outcome in Outcome::ALL {
            *self.outcomes.entry(outcome.label()).or_default() += ran.counts.outcome(outcome);
        }
        let end = ran.error.as_ref().map_or("complete".into(), name_of);
        *self.ends.entry(end).or_default() += 1;
        *self
            .kinds
            .entry(format!("{:?}", case.system.kind))
            .or_default() += 1;
        if case.system.hamiltonian.structure().is_quadratic() {
            self.quadratic.push((energy, seed));
            return;
        }
        self.energy.push((energy, seed));
        if let Some(errors) = errors(&case, &ran) {
            let freedom = match (case.stages, case.alphas) {
                (3.., Alphas::Several) => Freedom::Several,
                _ => Freedom::Single,
            };
            self.trajectories
                .entry(freedom)
                .or_default()
                .push((errors.ratio(), seed));
        }
    }

    pub(super) fn print(&mut self) {
        println!(
            "steps by outcome {:#?}\nends of runs {:#?}\nkinds {:#?}",
            self.outcomes, self.ends, self.kinds
        );
        let lists = [
            ("energy in floors", &mut self.energy),
            ("quadratic H in floors", &mut self.quadratic),
        ];
        for (name, list) in lists {
            worst_first(list);
            println!(
                "{name}: {} runs, worst (value, seed) {:.2?}",
                list.len(),
                &list[..list.len().min(6)]
            );
        }
        for (freedom, list) in &mut self.trajectories {
            worst_first(list);
            let above = |bound| list.iter().filter(|(ratio, _)| *ratio > bound).count();
            let (some, many) = (above(1.5), above(10.0));
            println!(
                "{freedom:?} α: {} trajectories, {some} above 1.5 of Gauss, {many} above 10",
                list.len()
            );
            println!("  worst (ratio, seed) {:.1?}", &list[..list.len().min(12)]);
        }
    }
}

fn worst_first(list: &mut [(f64, u64)]) {
    list.sort_by(|a, b| b.0.total_cmp(&a.0));
}

/// The variant's name.
fn name_of(error: &IntegrateError<f64>) -> String {
    let text = format!("{error:?}");
    text.split([' ', '{']).next().unwrap().to_owned()
}
