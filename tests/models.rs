//! The shared models and benchmark scenes: every method draws the same pictures and culls nothing that shows.
//!
//! They lie in the folder HOMCULL_MODELS, `../shared` by default; what is not there is passed over, and said so.
#![cfg(feature = "cli")]

use std::path::PathBuf;
use std::process::Command;

use serde_json::Value;

/// A file or folder of the shared models; `None`, with a line, when it is not there.
fn model(name: &str) -> Option<String> {
    let folder = std::env::var_os("HOMCULL_MODELS")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared"), PathBuf::from);
    let path = folder.join(name);
    if !path.exists() {
        println!("NOT TESTED: {} is not there (HOMCULL_MODELS names the folder)", path.display());
        return None;
    }
    path.to_str().map(str::to_owned)
}

fn json(args: &[&str]) -> Value {
    let output = Command::new(env!("CARGO_BIN_EXE_homcull")).args(args).args(["--json", "-"]).output().unwrap();
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

const METHODS: [&str; 5] = ["vfc", "hom", "hom-multipass", "hom-progressive", "ideal"];

/// All methods draw the same pictures, and none culls what shows.
fn methods_agree(scene: &str, frames: &str, size: &str) {
    let mut args = vec!["walk", scene, "--frames", frames, "--size", size];
    METHODS.iter().for_each(|m| args.extend(["--method", m]));
    let report = json(&args);
    let runs = report["runs"].as_array().unwrap();
    assert_eq!(runs.len(), METHODS.len());
    for run in runs {
        let what = format!("{} of {scene}", run["method"]);
        assert_eq!(run["wrongly_culled_objects"], 0, "{what}");
        assert_eq!(run["image_hash"], runs[0]["image_hash"], "{what}");
        assert!(run["mean"]["objects_visible_exact"].as_f64() > Some(0.0), "{what} sees nothing");
    }
}

#[test]
fn methods_agree_on_a_town_of_photogrammetry() {
    if let Some(scene) = model("data/denhaag_01.obj") {
        methods_agree(&scene, "9", "320x256");
    }
}

#[test]
fn methods_agree_on_a_walk_through_a_game_map() {
    if let Some(scene) = model("data/oa_thor.obj") {
        methods_agree(&scene, "9", "320x256");
    }
}

/// The kernels' verdicts against our item buffer and against the scene's own answers.
fn verdicts_agree_with_the_answers(name: &str) {
    let Some(scene) = model(name) else { return };
    methods_agree(&scene, "4", "256x128");
    for kernel in ["query", "progressive"] {
        let value = json(&["measure", kernel, &scene, "--size", "512x256", "--repetitions", "1"]);
        assert_eq!(value["false_occluded"], 0, "{kernel} of {name}");
        if !PathBuf::from(&scene).join("ref_512x256.bin").exists() {
            println!("NOT TESTED: {name} has no ref_512x256.bin");
            continue;
        }
        let brought = &value["brought"];
        assert_eq!(brought["false_occluded_over_2_pixels"], 0, "{kernel} of {name}: {brought}");
        println!("{kernel} of {name}: against the brought answers {brought}");
    }
}

#[test]
fn verdicts_agree_with_the_answers_that_the_city_brings() {
    verdicts_agree_with_the_answers("scenes/city");
}

#[test]
fn verdicts_agree_with_the_answers_that_the_walls_bring() {
    verdicts_agree_with_the_answers("scenes/walls");
}
