//! Tests by question, in one program: every one of them alone would compile the integrators anew.

mod agreement;
mod allocations;
mod brackets;
mod cases_astray;
mod cases_step;
mod cases_step_long;
mod cases_step_starts;
mod cases_tolerance;
mod extremes;
mod failures;
mod growth;
mod guard;
mod guide;
mod house;
mod instruction_sets;
mod invariants;
mod kept;
mod kinks;
mod kinks_fixed;
mod kinks_random;
mod long;
mod manifests;
mod many;
mod newton;
mod order;
mod pay_as_you_go;
mod random;
mod relatives;
mod reproducibility;
mod springs;
mod stories;
mod tables;
mod uncorrected;
mod work;

/// A file of tests that is not named above would be left out in silence.
#[test]
fn every_file_is_here() {
    let here = concat!(env!("CARGO_MANIFEST_DIR"), "/tests");
    for entry in std::fs::read_dir(here).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let name = name.trim_end_matches(".rs");
        let line = format!("mod {name};");
        assert!(
            name == "all" || include_str!("all.rs").contains(&line),
            "add `{line}` to tests/all.rs"
        );
    }
}
