//! The report's promises: JSON field names, CSV columns, a table that fits, one line for an error.
#![cfg(feature = "cli")]

use std::ffi::OsString;
use std::path::PathBuf;
use std::{env, fs, process};

use homcull::cli::arguments::{self, Exit};
use homcull::measure::report::{FrameRecord, MethodRun, StageTimes, WalkReport};
use homcull::measure::report_target::Target;
use homcull::measure::{csv, json, plot, table_walk};
use serde_json::{Value, json};

/// A walk that looks like one: `frames` frames, deterministic bumps, every figure present.
fn walk(frames: usize) -> WalkReport {
    let run = |method: &str, cost: f64, share: f64, parameters: &[(&str, &str)]| MethodRun {
        method: method.into(),
        parameters: parameters.iter().map(|&(key, value)| (key.into(), value.into())).collect(),
        frames: (0..frames).map(|number| frame(number, cost, share)).collect(),
        image_hash: 0x0123_4567_89ab_cdef,
        visible_set_hash: 0xf,
        ..MethodRun::default()
    };
    WalkReport {
        scene_name: "city".into(),
        objects: 5210,
        triangles: 312_524,
        width: 1280,
        height: 1024,
        frames,
        simd: "avx512".into(),
        threads: 1,
        clock_ghz: 2.9,
        peak_memory_bytes: Some(3 << 30),
        runs: vec![
            run("vfc", 1.0, 1.0, &[]),
            run("hom", 0.24, 0.13, &[("depth", "nbz"), ("threshold", "1")]),
            run("hom", 0.2, 0.11, &[("depth", "nbz"), ("threshold", "0.85")]),
            run("hom-progressive", 0.19, 0.12, &[]),
            run("ideal", 0.15, 0.1, &[]),
        ],
    }
}

fn frame(number: usize, cost: f64, share: f64) -> FrameRecord {
    let turn = number as f64 / 9.0;
    let in_frustum = 120_000.0 + 60_000.0 * turn.sin() + 15_000.0 * (turn * 3.7).cos();
    let visible = 9_000.0 + 3_000.0 * (turn * 1.3).sin();
    let drawn = if share >= 1.0 { in_frustum } else { visible * (0.9 + share * 2.0) };
    let whole = in_frustum * 9e-5 * cost + 0.3;
    FrameRecord {
        stages: Vec::new(),
        frame_ms: whole,
        stage_ms: StageTimes {
            select: whole * 0.02,
            occluders: whole * 0.2,
            pyramid: whole * 0.01,
            cull: whole * 0.07,
            draw: whole * 0.7,
        },
        pipeline_ms: None,
        objects_in_frustum: 2100,
        objects_drawn: (2100.0 * share) as u32,
        objects_visible_exact: Some(205),
        triangles_after_lod: 312_524,
        triangles_in_frustum: in_frustum as u64,
        triangles_drawn: drawn as u64,
        triangles_visible_exact: Some(visible as u64),
        fragments: 2_621_440,
        occluder_triangles: 25_000,
        queries: 431,
        waited_steps: 12,
        waited_ms: 0.5,
        bypassed: false,
        wrongly_culled: Some(u32::from(share == 0.11)),
        wrong_pixels: Some(if share == 0.11 { 17 * (number as u64 % 3) } else { 0 }),
    }
}

fn scratch(name: &str) -> PathBuf {
    env::temp_dir().join(format!("homcull-report-{}-{name}", process::id()))
}

/// The skeleton of `walk --json` as it is promised.
fn promised() -> Value {
    json!({"scene": {"name": "", "objects": 0, "triangles": 0},
     "view": {"width": 1280, "height": 1024, "frames": 120},
     "machine": {"simd": "avx512", "threads": 2, "clock_ghz": 0, "peak_memory_bytes": 0},
     "runs": [{"method": "hom", "parameters": {},
       "frame_ms": {"median": 0, "p95": 0, "min": 0, "max": 0, "total": 0},
       "stage_ms": {"select": 0, "occluders": 0, "pyramid": 0, "cull": 0, "draw": 0},
       "mean": {"objects_in_frustum": 0, "objects_drawn": 0, "objects_visible_exact": 0,
                "triangles_after_lod": 0, "triangles_in_frustum": 0, "triangles_drawn": 0,
                "triangles_visible_exact": 0, "depth_complexity": 0, "queries": 0},
       "wrongly_culled_objects": 0,
       "wrong_pixels_percent": {"mean": 0, "max": 0},
       "speedup_over_vfc": {"mean_of_frames": 0, "of_means": 0, "best_frame": 0},
       "time_over_ideal": {"mean_of_frames": 0, "of_means": 0, "worst_frame": 0},
       "image_hash": "hex", "visible_set_hash": "hex"}]})
}

/// Fails where `given` lacks a field of `promised` or holds another kind of value there.
fn assert_holds(promised: &Value, given: &Value, place: &str) {
    match (promised, given) {
        (Value::Object(fields), Value::Object(_)) => {
            for (name, value) in fields {
                assert_holds(value, &given[name], &format!("{place}.{name}"));
            }
        }
        (Value::Array(items), Value::Array(given)) => {
            assert!(!given.is_empty(), "{place} is empty");
            given.iter().for_each(|given| assert_holds(&items[0], given, place));
        }
        (Value::Number(_), Value::Number(_)) | (Value::String(_), Value::String(_)) | (Value::Null, Value::Null) => {}
        _ => panic!("{place} is {given}"),
    }
}

#[test]
fn the_json_holds_every_promised_field() {
    let given = json::walk(&walk(12));
    assert_holds(&promised(), &given, "report");
    let hom = &given["runs"][1];
    assert_eq!(hom["parameters"], json!({"depth": "nbz", "threshold": "1"}));
    assert_eq!(hom["image_hash"], "0123456789abcdef");
    assert_eq!(hom["visible_set_hash"], "000000000000000f");
    assert_eq!(hom["mean"]["depth_complexity"], 2.0);
    assert_eq!(given["machine"]["peak_memory_bytes"], 3_u64 << 30);
    let unknown = json::walk(&WalkReport { peak_memory_bytes: None, ..walk(1) });
    assert!(unknown["machine"].get("peak_memory_bytes").is_none(), "what the system does not tell is left out");
    assert_eq!(hom["bypassed_frames"], 0);
    assert_eq!(given["runs"][2]["wrongly_culled_objects"], 12);
}

#[test]
fn what_was_not_measured_is_null() {
    let mut report = walk(3);
    report.runs.retain(|run| run.method == "hom");
    for frame in report.runs.iter_mut().flat_map(|run| &mut run.frames) {
        frame.objects_visible_exact = None;
        frame.triangles_visible_exact = None;
        frame.wrongly_culled = None;
        frame.wrong_pixels = None;
    }
    let run = &json::walk(&report)["runs"][0];
    for name in ["speedup_over_vfc", "time_over_ideal", "wrong_pixels_percent", "wrongly_culled_objects"] {
        assert!(run.get(name).is_some_and(Value::is_null), "{name}");
    }
    assert!(run["mean"]["triangles_visible_exact"].is_null());
    let text = table_walk::walk(&report);
    assert!(!text.contains("wrong px") && !text.contains("ideal"), "\n{text}");
}

#[test]
fn the_json_file_reads_back() {
    let path = scratch("walk.json");
    let value = json::walk(&walk(2));
    json::write_json(&Target::File(path.clone()), &value).unwrap();
    let text = fs::read_to_string(&path).unwrap();
    fs::remove_file(&path).unwrap();
    assert!(text.ends_with("}\n"));
    let read: Value = serde_json::from_str(&text).unwrap();
    assert_holds(&value, &read, "report");
    assert_eq!(read["runs"][0]["image_hash"], value["runs"][0]["image_hash"]);
}

#[test]
fn the_csv_has_a_row_for_each_method_and_frame() {
    let path = scratch("walk.csv");
    let mut report = walk(4);
    report.runs[0].frames[0].wrong_pixels = None;
    csv::write_csv(&Target::File(path.clone()), &report).unwrap();
    let text = fs::read_to_string(&path).unwrap();
    fs::remove_file(&path).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 1 + 5 * 4);
    assert!(lines[0].starts_with("method,parameters,frame,frame_ms,select_ms,"), "{}", lines[0]);
    assert!(lines[1].starts_with("vfc,,0,"), "{}", lines[1]);
    let cell = |line: &str, column: &str| {
        let at = lines[0].split(',').position(|name| name == column).unwrap();
        line.split(',').nth(at).unwrap().to_owned()
    };
    for unknown in ["wrong_pixels", "occsel_waiting_ms", "cull_waiting_ms", "draw_waiting_ms"] {
        assert_eq!(cell(lines[1], unknown), "", "{unknown} of {}", lines[1]);
    }
    assert_ne!(cell(lines[2], "wrong_pixels"), "", "{}", lines[2]);
    for (column, value) in [("occluder_triangles", "25000"), ("waited_steps", "12"), ("waited_ms", "0.5")] {
        assert_eq!(cell(lines[1], column), value);
    }
    assert!(lines[6].starts_with("hom,\"depth=nbz,threshold=1\",1,"), "{}", lines[6]);
}

#[test]
fn the_table_lines_up_and_fits_150_columns() {
    let mut report = walk(30);
    report.runs[2].image_hash += 1;
    report.runs[3].parameters.push(("a-long-parameter".into(), "with-a-long-value".into()));
    report.runs.push(report.runs[3].clone());
    report.runs[5].parameters.clear();
    let text = table_walk::walk(&report);
    println!("{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 150), "\n{text}");
    let rows: Vec<&str> = text.lines().skip(2).take(7).collect();
    assert!(rows.iter().all(|row| row.chars().count() == rows[0].chars().count()), "\n{text}");
    assert!(rows[3].ends_with(" NO") && rows[2].ends_with("yes"), "\n{text}");
    assert!(text.contains("\n#4 hom-progressive:a-long-parameter=with-a-long-value\n"), "\n{text}");
}

#[test]
fn the_table_fits_with_the_widest_figures() {
    let mut report = walk(3);
    for frame in report.runs.iter_mut().flat_map(|run| &mut run.frames) {
        frame.frame_ms *= 987.0;
        frame.stage_ms.draw *= 987.0;
        frame.triangles_drawn *= 12_345;
        frame.queries = 123_456_789;
        frame.wrong_pixels = Some(1);
        frame.wrongly_culled = Some(4_000_000);
    }
    let text = table_walk::walk(&report);
    assert!(text.lines().all(|line| line.chars().count() <= 150), "\n{text}");
}

fn refused(line: &str) -> Exit {
    let exit = arguments::parse(line.split(' ').map(OsString::from)).unwrap_err();
    assert_eq!((exit.code, exit.to_stdout), (2, false), "{exit:?}");
    assert!(!exit.message.contains('\n') && exit.message.starts_with("homcull: "), "{exit:?}");
    exit
}

#[test]
fn bad_usage_is_one_line_that_names_the_fault() {
    for (line, fault) in [
        ("homcull walk", "<SCENE>"),
        ("homcull measure", "<KERNEL>"),
        ("homcull measure fill city", "fill"),
        ("homcull view city", "view"),
        ("homcull walk city --size 0x5", "size 0x5: each side must be 1 to 16384"),
        ("homcull walk city --size 5by5", "5by5"),
        ("homcull walk city --frames 0", "--frames"),
        ("homcull walk city --frames many", "many"),
        ("homcull walk city --simd sse9", "sse9"),
        ("homcull walk city --cluster-test on", "--cluster-test"),
        ("homcull measure raster city --cluster-test maybe", "maybe"),
        ("homcull walk city --bogus", "--bogus"),
        ("homcull walk city town", "town"),
        ("homcull walk city --json", "--json"),
        ("homcull walk city --frames a\nb", "a b"),
    ] {
        let exit = refused(line);
        println!("{}", exit.message);
        assert!(exit.message.contains(fault), "{line}: {exit:?}");
    }
}

#[test]
fn help_and_version_go_to_standard_output() {
    for line in ["homcull --help", "homcull walk --help", "homcull --version"] {
        let exit = arguments::parse(line.split(' ').map(OsString::from)).unwrap_err();
        assert_eq!((exit.code, exit.to_stdout), (0, true), "{line}");
        assert!(exit.message.contains("homcull"), "{line}");
    }
}

#[test]
fn the_plots_are_pictures_of_the_stated_size() {
    let report = walk(120);
    // Kept where the caller says, to be looked at; else in a scratch folder that goes away.
    let kept = env::var_os("HOMCULL_TEST_PLOTS").map(PathBuf::from);
    let folder = kept.clone().unwrap_or_else(|| scratch("plots"));
    fs::create_dir_all(&folder).unwrap();
    let point =
        |ms: f64, wrong_percent: f64, label: &str| plot::ScatterPoint { ms, wrong_percent, label: label.into() };
    let threshold = plot::ScatterSeries {
        name: "opacity threshold".into(),
        points: vec![
            point(3.1, 0.0, "1"),
            point(3.02, 0.002, "0.98"),
            point(2.9, 0.011, "0.95"),
            point(2.8, 0.09, "0.9"),
            point(2.79, 0.13, "0.85"),
            point(2.5, 1.4, "0.7"),
        ],
    };
    let resolution = plot::ScatterSeries {
        name: "resolution".into(),
        points: vec![point(3.1, 0.0, "1280x1024"), point(2.2, 0.02, "640x512"), point(1.9, 0.3, "320x256")],
    };
    let series = [threshold, resolution];
    let draw = |name: &str| {
        let path = folder.join(name);
        match name {
            "fps.png" => plot::frame_rate_graph(&path, &report, plot::FrameAxis::FramesPerSecond),
            "ms.png" => plot::frame_rate_graph(&path, &report, plot::FrameAxis::Milliseconds),
            "culling.png" => plot::culling_graph(&path, &report, &report.runs[1]),
            "error.png" => plot::error_against_time(&path, "Error against run time", "city", &series),
            _ => plot::frame_rate_graph(&path, &WalkReport::default(), plot::FrameAxis::Milliseconds),
        }
        .unwrap();
        let picture = image::open(&path).unwrap();
        assert_eq!((picture.width(), picture.height()), plot::SIZE, "{name}");
    };
    for name in ["fps.png", "ms.png", "culling.png", "error.png", "empty.png"] {
        draw(name);
    }
    if kept.is_none() {
        fs::remove_dir_all(folder).unwrap();
    }
}
