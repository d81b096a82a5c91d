//! Random Hamiltonians, starts, numbers of stages, steps over six decades: every run ends well.
//!
//! One case: `EQUIP_RANDOM_SEED=17 cargo test -p equip-tests --test all random:: -- --nocapture`.
//! More cases: `EQUIP_RANDOM_CASES=100000`.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

mod case;
mod claims;
mod summary;
mod trajectory;

use case::{Case, Seen, run};
use std::panic::{AssertUnwindSafe, catch_unwind};
use summary::{Freedom, Summary};
use trajectory::errors;

const CASES: u64 = 2400;

fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok().map(|text| text.parse().unwrap())
}

#[test]
fn random_hamiltonians_end_well() {
    let seeds = match number("EQUIP_RANDOM_SEED") {
        Some(seed) => {
            let case = Case::new(seed);
            println!("{case}");
            run(&case).seen.iter().for_each(|seen| println!("{seen:?}"));
            println!("{:?}", errors(&case, &run(&case)));
            seed..seed + 1
        }
        None => 0..number("EQUIP_RANDOM_CASES").unwrap_or(CASES),
    };
    let standard = seeds == (0..CASES);
    let mut summary = Summary::default();
    let mut failed = Vec::new();
    for seed in seeds {
        if catch_unwind(AssertUnwindSafe(|| summary.see(seed))).is_err() {
            println!("failed: {}", Case::new(seed));
            failed.push(seed);
        }
    }
    summary.print();
    assert!(failed.is_empty(), "{} failed: {failed:?}", failed.len());
    if !standard {
        return;
    }
    // The worst have hω = 28 to 83, where rounding of the stages is worth more than that of the state. Of
    // 12 000 cases 1 % is above 29 or 30, and two at 10⁴ and 10⁵; of these 381 6 are above 32.
    let quadratic = &summary.quadratic;
    let above = quadratic.iter().filter(|(x, _)| *x > 32.0).count();
    let all = quadratic.len();
    assert!(50 * above <= all, "{above} of {all}");
    // Measured 6 of 757, the worst 5.1.
    let several = &summary.trajectories[&Freedom::Several];
    let above = several.iter().filter(|(ratio, _)| *ratio > 1.5).count();
    assert!(20 * above <= several.len(), "{above} of {}", several.len());
    for (ratio, seed) in several {
        assert!(*ratio <= 10.0, "{ratio}: {}", Case::new(*seed));
    }
    // Measured 211: s = 2, each step moves 1000 times as far as g/|∇H|.
    let single = &summary.trajectories[&Freedom::Single];
    assert!(single.iter().all(|(ratio, _)| *ratio <= 422.0));
}

#[test]
#[ignore = "long: run with cargo test -p equip-tests --release --test all random:: -- --ignored"]
fn no_quadratic_energy_is_far_off() {
    let mut summary = Summary::default();
    (0..CASES).for_each(|seed| summary.see(seed));
    let quadratic = &summary.quadratic;
    assert!(quadratic.iter().all(|(floors, _)| *floors <= 256.0));
}

/// Seed 2029 has run away to 1e96, where the floor, taken at the end of the step, was 1e192.
#[test]
fn a_step_that_runs_away_does_not_claim_the_energy() {
    let case = Case::new(2029);
    let vacuous = |seen: &Seen| {
        seen.outcome.energy_conserved() && seen.floor.is_some_and(|floor| floor > 1e10)
    };
    assert!(!run(&case).seen.iter().any(vacuous), "{case}");
}
