//! Tests of the number types, in one program.

mod common;
mod double_double_arithmetic;
mod double_double_functions;
mod double_double_tables;
mod double_double_text;
mod functions_of_doubles;
mod glue;
mod half_power;
mod lanes;
mod own;

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
