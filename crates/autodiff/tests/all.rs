//! Tests of the derivatives, in one program.

mod allocations;
mod bytes;
mod closures;
mod common;
mod exact;
mod external;
mod floor;
mod functions;
mod given;
mod growth;
mod half_powers;
mod lanes;
mod long_sums;
mod operations;
mod potential;
mod random;
mod refused;
mod routes;
mod size;
mod switches;

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
