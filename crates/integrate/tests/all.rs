//! Tests of the integrators, in one program: every one of them alone would compile the integrators anew.

mod adaptive;
mod backward;
mod beside_gauss;
mod checkpoint;
#[cfg(feature = "serde")]
mod checkpoint_file;
mod dense;
mod encounters;
mod energy_verdict;
#[cfg(feature = "rayon")]
mod ensemble;
mod event_steps;
mod events;
mod events_together;
mod extended;
mod fast_drive;
mod force_rounding;
mod gradients;
mod memory;
mod outputs_end_no_run;
mod preconditioners;
mod restart;
mod silent_switches;
mod suggest;
mod tangent;
mod there_and_back;
mod thin_obstacles;
mod tiny_and_huge;
mod verdicts;
mod with_time;

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
