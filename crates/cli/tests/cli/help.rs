//! What the program says of itself and of its scenes.

use crate::{file, stdout, well_formed};

#[test]
fn help_teaches() {
    for arguments in [
        &["--help"][..],
        &["run", "--help"],
        &["scenes", "--help"],
        &["report", "--help"],
        &["growth", "--help"],
        &["paper", "--help"],
    ] {
        assert!(stdout(arguments).contains("Examples:"), "{arguments:?}");
    }
    let help = stdout(&["run", "kepler", "--help"]);
    assert!(help.contains("--e <VALUE>") && help.contains("eccentricity"));
    assert!(!help.contains("--omega"));
    assert!(stdout(&["--version"]).starts_with("equip "));
}

#[test]
fn scenes_are_listed_and_described() {
    let list = stdout(&["scenes"]);
    for scene in equip_scenes::all() {
        assert!(
            list.lines().any(|line| line.starts_with(scene.name)),
            "{}",
            scene.name
        );
        // Long lines are wrapped.
        let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        let page = words(&stdout(&["scenes", scene.name]));
        assert!(page.contains(&words(scene.formula)) && page.contains(&words(scene.source)));
        assert!(
            scene
                .parameters
                .iter()
                .all(|p| page.contains(&format!("--{} ", p.name)))
        );
    }
}

#[test]
fn every_scene_makes_a_few_steps_and_a_picture() {
    for scene in equip_scenes::all() {
        let step = scene.instance(&[]).unwrap().suggested_step();
        let (until, plot) = (
            format!("{}", 4.0 * step),
            file(&format!("{}.svg", scene.name)),
        );
        let plot = plot.to_str().unwrap();
        let printed = stdout(&["run", scene.name, "--until", &until, "--plot", plot]);
        assert!(printed.contains("energy error"), "{}", scene.name);
        let first = "energy conserved to round-off: ";
        assert!(printed.starts_with(first), "{}: {printed}", scene.name);
        well_formed(&std::fs::read_to_string(plot).unwrap());
    }
}

#[test]
fn methods_are_what_they_are_called() {
    let printed = |method| stdout(&["run", "kepler", "--until", "5", "--method", method]);
    assert!(printed("equip").contains("EQUIP, 8 stages, order 16"));
    assert!(printed("equip-last").contains("EQUIP with the last α only"));
    assert!(printed("gauss").contains("Gauss, 8 stages, order 16"));
    assert!(printed("fixed-alpha=1/50").contains("fixed α = 0.02, 8 stages, order 14"));
    assert!(printed("fixed-alpha=-0.01").contains("fixed α = -0.01"));
}
