//! The experiments about time, as far as they are not: errors at thresholds, and that overlapping stages make the same frames.
#![cfg(feature = "cli")]

use std::process::Command;

use serde_json::Value;

/// Makes an experiment on small pictures, and gives its JSON.
fn experiment(name: &str, scene: &str, threads: &str) -> Value {
    let folder = std::env::temp_dir().join(format!("homcull-{name}-{threads}-{}", std::process::id()));
    let small = ["--size", "320x256", "--frames", "4", "--repetitions", "1", "--json", "-"];
    let args =
        [&["experiment", name, scene, "--threads", threads, "--out", folder.to_str().unwrap()], &small[..]].concat();
    let output = Command::new(env!("CARGO_BIN_EXE_homcull")).args(&args).output().unwrap();
    let (text, error) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success() && error.is_empty(), "{args:?}: {error}");
    for end in ["png", "csv", "json"] {
        assert!(folder.join(format!("experiment-{name}.{end}")).is_file(), "no {end}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{args:?} prints no JSON: {e}\n{text}"))
}

fn rows(value: &Value) -> &[Value] {
    value["rows"].as_array().unwrap()
}

#[test]
fn thresholds_of_1_err_nowhere_and_lower_ones_draw_less() {
    let value = experiment("aggressive", "machine-room:triangles=60000", "1");
    let (mut at_one, mut thresholds) = (f64::INFINITY, 0);
    let (lods, originals): (Vec<&Value>, Vec<&Value>) = rows(&value).iter().partition(|row| row["LOD"].is_number());
    assert_eq!((lods.len(), originals.len()), (9, 9), "three levels of detail at three thresholds");
    for row in originals {
        let threshold = row["threshold"].as_f64();
        if threshold.unwrap_or(1.0) == 1.0 {
            assert_eq!((&row["wrongly_culled"], row["wrong_pixels"].as_f64()), (&0.into(), Some(0.0)), "{row:#}");
        }
        if threshold.is_some() {
            let drawn = row["triangles_drawn"].as_f64().unwrap();
            assert!(drawn <= at_one, "{drawn}, at 1 {at_one}: {row:#}");
            thresholds += 1;
            if threshold == Some(1.0) {
                at_one = drawn;
            }
        }
    }
    assert_eq!(thresholds, 7);
}

#[test]
fn frames_are_the_same_in_turn_and_in_the_pipeline() {
    for (threads, modes) in [("1", 2), ("2", 4)] {
        let value = experiment("pipeline", "machine-room:triangles=30000", threads);
        assert_eq!(rows(&value).len(), modes);
        for row in rows(&value) {
            assert_eq!(row["same_frames"], "yes", "{row:#}");
            let pipelined = row["stages"].as_str().unwrap().starts_with("pipelined");
            assert_eq!(row["Draw_waits"].is_number(), pipelined, "{row:#}");
            assert!(row["frame"].as_f64() > Some(0.0) && row["latency"].as_f64() > Some(0.0), "{row:#}");
        }
        assert_eq!(value["statements"][1]["holds"], true, "{value:#}");
    }
}
