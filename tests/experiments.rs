//! The experiments: their sharp claims (6.1, 6.4, figure 7.3), the files they write, and bad usage.
#![cfg(feature = "cli")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

/// A folder of its own for each test, gone at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let path = std::env::temp_dir().join(format!("homcull-experiments-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Folder(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn homcull(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_homcull")).args(args).output().unwrap()
}

/// Makes an experiment on small pictures, and gives its JSON.
fn experiment(folder: &Folder, args: &[&str]) -> Value {
    let out = folder.0.to_str().unwrap();
    let common = ["--size", "256x192", "--frames", "3", "--threads", "2", "--json", "-", "--out", out];
    let output = homcull(&[&["experiment"], args, &common].concat());
    let (text, error) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{args:?}: {error}");
    assert_eq!(error, "", "{args:?}");
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{args:?} prints no JSON: {e}\n{text}"))
}

fn rows<'a>(value: &'a Value, with: &[(&str, &str)]) -> Vec<&'a Value> {
    let fits = |row: &&Value| {
        with.iter().all(|(key, wanted)| match &row[*key] {
            Value::String(text) => text == wanted,
            other => other.to_string().as_str() == *wanted,
        })
    };
    let rows: Vec<&Value> = value["rows"].as_array().unwrap().iter().filter(fits).collect();
    assert!(!rows.is_empty(), "no row with {with:?} in\n{value:#}");
    rows
}

#[track_caller]
fn count(row: &Value, key: &str) -> u64 {
    row[key].as_u64().unwrap_or_else(|| panic!("'{key}' is no count in {row}"))
}

#[track_caller]
fn figure(row: &Value, key: &str) -> f64 {
    row[key].as_f64().unwrap_or_else(|| panic!("'{key}' is no figure in {row}"))
}

const CITY: &str = "city:triangles=20000";

#[test]
fn without_occluders_nothing_is_culled_by_any_representation() {
    let folder = Folder::new("none");
    for scene in [CITY, "machine-room:triangles=20000"] {
        let value = experiment(&folder, &["no-occluders", scene]);
        for depth in ["nbz", "nbz-block", "deb", "plane"] {
            for row in rows(&value, &[("depth", depth)]) {
                let tested = count(row, "tested");
                assert!(tested > 100, "{row}");
                assert_eq!(count(row, "pass_the_depth_test"), tested, "{row}");
                assert_eq!((count(row, "pass_the_overlap_test"), count(row, "culled")), (0, 0), "{row}");
            }
        }
        assert_eq!(value["statements"][0]["holds"], true, "{value:#}");
    }
}

#[test]
fn a_redundant_occluder_costs_the_z_buffer_nothing_and_a_far_boundary_everything() {
    let folder = Folder::new("redundant");
    for scene in [CITY, "machine-room:triangles=200000"] {
        let value = experiment(&folder, &["redundant-occluders", scene]);
        let all = |depth| rows(&value, &[("depth", depth), ("redundant", "100")])[0];
        let none = |depth| rows(&value, &[("depth", depth), ("redundant", "0")])[0];
        for depth in ["nbz", "nbz-block"] {
            let (all, none) = (all(depth), none(depth));
            assert!(count(none, "culled") > 10 && count(all, "occluders") > count(none, "occluders"), "{none} {all}");
            assert_eq!(count(all, "lost"), 0, "{all}");
            assert!(count(all, "culled") >= count(none, "culled"), "{none} {all}");
            assert!(count(all, "occluders_culled") > 10, "{all}");
        }
        for depth in ["deb", "plane"] {
            assert_eq!(count(all(depth), "culled"), 0, "{scene}: {}", all(depth));
            for row in rows(&value, &[("depth", depth)]) {
                assert_eq!(count(row, "occluders_culled"), 0, "{row}");
            }
        }
        assert!(count(none("deb"), "culled") > 0, "{scene}: the estimation buffer culls nothing at all");
    }
}

#[test]
fn distance_fails_in_figure_7_3_and_the_remedies_mend_it() {
    let folder = Folder::new("figure-7-3");
    let value = experiment(&folder, &["distance-fails"]);
    let drawn =
        |selection, limit| figure(rows(&value, &[("selection", selection), ("limit", limit)])[0], "triangles_drawn");
    let progressive = figure(rows(&value, &[("selection", "progressive")])[0], "triangles_drawn");
    let vfc = figure(rows(&value, &[("selection", "vfc")])[0], "triangles_drawn");
    assert!(drawn("distance", "8000") > 5.0 * progressive, "{value:#}");
    assert!(drawn("distance", "64000") < 0.1 * vfc, "a limit beyond the crowd reaches the walls");
    assert!(drawn("baked", "2000") < 0.05 * vfc, "{value:#}");
    // Temporal coherence knows nothing in the first of the three frames.
    assert!(drawn("temporal", "8000") < 0.6 * drawn("distance", "8000"), "{value:#}");
    for row in value["rows"].as_array().unwrap() {
        assert_eq!(figure(row, "wrong_pixels"), 0.0, "{row}");
    }
    assert_eq!(value["statements"][0]["holds"], true, "{value:#}");
}

#[test]
fn plp_shows_less_than_the_best_choice_and_cplp_shows_all() {
    let folder = Folder::new("plp");
    let value = experiment(&folder, &["plp", "plant:triangles=200000"]);
    for budget in ["35000", "70000", "140000"] {
        let of = |with: &[(&str, &str)]| figure(rows(&value, with)[0], "pixels_right");
        let best = of(&[("method", "best choice"), ("budget", budget)]);
        let solidity = of(&[("method", "plp"), ("heuristic", "solidity"), ("budget", budget)]);
        let layer = of(&[("method", "plp"), ("heuristic", "layer"), ("budget", budget)]);
        assert!(best >= solidity && solidity >= layer, "{budget}: {best}, {solidity}, {layer}");
    }
    for row in [rows(&value, &[("method", "cplp")]), rows(&value, &[("method", "vfc")])].concat() {
        assert_eq!(figure(row, "worst_frame"), 100.0, "{row}");
    }
    assert_eq!(value["statements"].as_array().unwrap().len(), 3, "{value:#}");
}

#[test]
fn results_are_equal_at_every_number_of_threads() {
    let folder = Folder::new("threads");
    let out = folder.0.to_str().unwrap();
    let csv = |threads: &str| {
        let size = ["--size", "160x128", "--frames", "2", "--out", out, "--threads", threads, "--csv", "-"];
        homcull(&[&["experiment", "deb-resolution", CITY][..], &size].concat()).stdout
    };
    let one = csv("1");
    assert!(one.starts_with(b"scene,depth,partitions,"), "{}", String::from_utf8_lossy(&one));
    assert_eq!(one, csv("3"));
}

#[test]
fn table_plot_and_files_are_written() {
    let folder = Folder::new("files");
    let out = folder.0.to_str().unwrap();
    for name in ["threshold", "levels", "map-resolution", "occluder-limit"] {
        let args = ["experiment", name, CITY, "--size", "160x128", "--frames", "2", "--repetitions", "1", "--out", out];
        let output = homcull(&args);
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(text.contains("The thesis (") && text.to_lowercase().contains("borne out: here"), "{text}");
        let file = |end: &str| folder.0.join(format!("experiment-{name}.{end}"));
        assert!(std::fs::read(file("png")).unwrap().starts_with(b"\x89PNG"), "{name}");
        let value: Value = serde_json::from_slice(&std::fs::read(file("json")).unwrap()).unwrap();
        assert_eq!(value["experiment"], name);
        let csv = std::fs::read_to_string(file("csv")).unwrap();
        assert_eq!(csv.lines().count(), 1 + value["rows"].as_array().unwrap().len(), "{name}");
        assert!(value["columns"].as_array().unwrap().iter().all(|c| c["unit"].is_string()), "{value:#}");
        let statements = value["statements"].as_array().unwrap();
        assert!(!statements.is_empty() && statements.iter().all(|s| s["holds"].is_boolean()), "{value:#}");
    }
    let args = ["experiment", "chc", CITY, "--size", "160x128", "--frames", "2", "--repetitions", "1", "--out", out];
    let output = homcull(&args);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.contains("Bittner et al. 2004, table 1 claim that"), "{text}");
    let left: Vec<_> = std::fs::read_dir(&folder.0).unwrap().map(|f| f.unwrap().file_name()).collect();
    assert_eq!(left.len(), 16, "{left:?}");
    assert!(left.iter().any(|name| name.to_string_lossy().starts_with("experiment-chc-nodes-city")), "{left:?}");
}

#[test]
fn alone_it_lists_them() {
    let text = String::from_utf8(homcull(&["experiment"]).stdout).unwrap();
    for (name, section) in [("levels", "8.2.4"), ("no-occluders", "6.1"), ("distance-fails", "7.3.2")] {
        assert!(text.lines().any(|line| line.starts_with(name) && line.contains(section)), "no {name} in\n{text}");
    }
}

#[test]
fn bad_usage_is_one_line_and_status_2() {
    let folder = Folder::new("errors");
    let (out, file) = (folder.0.to_str().unwrap(), folder.0.join("a-file"));
    std::fs::write(&file, b"").unwrap();
    let blocked = file.join("x");
    for (args, named) in [
        (vec!["experiment", "leveles"], "leveles"),
        (vec!["experiment", "levels", "no-such-scene"], "no-such-scene"),
        (vec!["experiment", "levels", CITY, "extra"], "extra"),
        (vec!["experiment", "levels", CITY, "--frames", "0"], "0"),
        (vec!["experiment", "distance-fails", "--path", "no-such.json"], "no-such.json"),
        (vec!["experiment", "levels", CITY, "--out", blocked.to_str().unwrap()], "a-file"),
    ] {
        let args = if args.contains(&"--out") { args } else { [&args[..], &["--out", out]].concat() };
        let output = homcull(&args);
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {error}");
        assert!(error.lines().count() == 1 && error.contains(named), "{args:?}: {error}");
        assert!(output.stdout.is_empty(), "{args:?}");
    }
    assert!(!Path::new("homcull-out").join("experiment-leveles.csv").exists());
}
