//! The thesis's experiments as presets of `walk`: they write all their files, say the same in each, and obey what is asked explicitly.
#![cfg(feature = "cli")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

fn run(args: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_homcull")).args(args).output().unwrap();
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{args:?}: {err}");
    assert_eq!(err, "", "{args:?} writes to standard error in a pipe");
    out.into_owned()
}

/// Runs with `--out FOLDER`, a fresh one.
fn run_into(name: &str, args: &[&str]) -> (PathBuf, String) {
    let folder = std::env::temp_dir().join(format!("homcull-preset-{name}-{}", std::process::id()));
    let text = run(&[args, &["--out", folder.to_str().unwrap()]].concat());
    (folder, text)
}

fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

const FORMS: [&str; 6] = ["vfc", "hom", "hom-1998", "hom-progressive", "hzb", "ideal"];
const FILES: [&str; 9] = [
    "comparison.csv",
    "comparison.json",
    "culling-hom-1998.png",
    "culling-hom-progressive.png",
    "culling-hom.png",
    "frame-rate.png",
    "frame-time.png",
    "frames.csv",
    "report.json",
];
const SMALL: [&str; 6] = ["--frames", "3", "--size", "320x256", "--repetitions", "1"];

/// Walks a preset, small; its folder, table and comparison.
fn preset(name: &str, settings: &str) -> (PathBuf, String, Value) {
    let scene = format!("{name}:{settings}");
    let (folder, text) = run_into(name, &[&["walk", &scene, "--images", "0"], &SMALL[..]].concat());
    let comparison = json(&folder.join("comparison.json"));
    (folder, text, comparison)
}

/// The five methods in order; what claims to be conservative is, and each technique leaves no more than the one before.
#[track_caller]
fn rows_are_sound(comparison: &Value) {
    let rows = comparison["rows"].as_array().unwrap();
    assert_eq!(rows.iter().map(|row| row["name"].as_str().unwrap()).collect::<Vec<_>>(), FORMS);
    for row in rows {
        let triangles =
            ["after_lod", "in_frustum", "drawn"].map(|what| row[format!("triangles_{what}")].as_f64().unwrap());
        assert!(triangles.is_sorted_by(|a, b| a >= b) && triangles[2] > 0.0, "{row:#}");
        if row["name"] != "hom-1998" {
            let visible = row["triangles_visible_exact"].as_f64().unwrap();
            assert!(triangles[2] >= visible, "{row:#}");
            assert_eq!((&row["wrongly_culled_objects"], &row["image_equal"]), (&0.into(), &true.into()), "{row:#}");
            assert_eq!(row["wrong_pixels_percent"].as_f64(), Some(0.0), "{row:#}");
        }
        assert!(
            row["mean_ms"].as_f64() > Some(0.0) && row["speedup_over_vfc"]["of_means"].as_f64() > Some(0.0),
            "{row:#}"
        );
        assert!(row["time_over_ideal"]["worst_frame"].as_f64() > Some(0.0), "{row:#}");
    }
}

#[test]
fn the_city_writes_its_graphs_and_its_table() {
    let (folder, text, comparison) = preset("thesis-city", "triangles=20000");
    assert_eq!(files(&folder), FILES);
    rows_are_sound(&comparison);
    assert_eq!(comparison["thesis"]["speedup_over_vfc"]["best_frame"].as_f64(), Some(6.0));
    assert_eq!(comparison["scene"]["triangles"], 20_000);
    assert!(text.contains("thesis, 8.4.1: up to six times") && text.contains("here, hom: "), "{text}");
    let report = json(&folder.join("report.json"));
    let depths: Vec<&Value> =
        report["runs"].as_array().unwrap().iter().map(|run| &run["parameters"]["depth"]).collect();
    assert_eq!((depths[1], depths[2]), (&"deb".into(), &"deb".into()), "{depths:?}");
    assert_eq!(report["machine"]["threads"], 1, "a single CPU");
    // A line for the names, and one for each row: the same methods, in the same order.
    let csv = fs::read_to_string(folder.join("comparison.csv")).unwrap();
    let names: Vec<&str> = csv.lines().skip(1).map(|line| line.split(',').next().unwrap()).collect();
    assert_eq!(names, FORMS);
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_machine_room_goes_through_the_pipeline() {
    let (folder, _, comparison) = preset("thesis-machine-room", "triangles=40000");
    assert_eq!(files(&folder), FILES);
    rows_are_sound(&comparison);
    let report = json(&folder.join("report.json"));
    for run in &report["runs"].as_array().unwrap()[1..=2] {
        assert_eq!((&run["parameters"]["pipeline"], &run["parameters"]["select"]), (&"on".into(), &"temporal".into()));
        assert!(run["pipeline_ms"]["draw"]["busy"].as_f64() > Some(0.0), "{run:#}");
    }
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_plant_bakes_once() {
    let (folder, _, comparison) = preset("thesis-plant", "triangles=40000,grid=3x1x3");
    let expected: Vec<&str> = FILES.into_iter().chain(["visibility.bake"]).collect();
    assert_eq!(files(&folder), expected);
    rows_are_sound(&comparison);
    let bake = folder.join("visibility.bake");
    let (bytes, written) = (fs::read(&bake).unwrap(), fs::metadata(&bake).unwrap().modified().unwrap());
    let (again, _, second) = preset("thesis-plant", "triangles=40000,grid=3x1x3");
    assert_eq!((&again, fs::metadata(&bake).unwrap().modified().unwrap()), (&folder, written), "baked anew");
    let hashes = |c: &Value| c["rows"].as_array().unwrap().iter().map(|r| r["image_hash"].clone()).collect::<Vec<_>>();
    assert_eq!(hashes(&second), hashes(&comparison));
    // Another grid is another bake.
    preset("thesis-plant", "triangles=40000,grid=2x1x2");
    assert_ne!(fs::read(&bake).unwrap(), bytes);
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn what_is_asked_explicitly_is_obeyed() {
    let scene = "thesis-plant:triangles=20000";
    let methods = ["--method", "vfc", "--method", "hom-progressive"];
    let small = ["--frames", "2", "--size", "160x128", "--images", "0", "--quiet"];
    let (folder, text) = run_into("explicit", &[&["walk", scene], &methods[..], &small].concat());
    assert_eq!(text, "");
    let report = json(&folder.join("report.json"));
    assert_eq!(report["view"], serde_json::json!({"width": 160, "height": 128, "frames": 2}));
    let names: Vec<&Value> = report["runs"].as_array().unwrap().iter().map(|run| &run["method"]).collect();
    assert_eq!(names, ["vfc", "hom-progressive"]);
    assert!(!folder.join("visibility.bake").exists(), "nothing reads a bake");
    assert!(folder.join("culling-2-hom-progressive.png").is_file());
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn presets_are_listed_with_the_scenes() {
    let scenes = run(&["scenes"]);
    for name in ["thesis-city", "thesis-machine-room", "thesis-plant:grid=20x10x20"] {
        assert!(scenes.lines().any(|line| line == name), "no {name} in\n{scenes}");
    }
}
