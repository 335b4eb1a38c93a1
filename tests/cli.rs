//! The commands: what they print, and that every method, level and number of threads draws the same pictures.
#![cfg(feature = "cli")]

use std::path::Path;
use std::process::Command;

use homcull_simd::Level;
use serde_json::Value;

fn run(args: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_homcull")).args(args).output().unwrap();
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{args:?}: {err}");
    assert_eq!(err, "", "{args:?} writes to standard error in a pipe");
    out.into_owned()
}

fn json(args: &[&str]) -> Value {
    let text = run(&[args, &["--json", "-"]].concat());
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{args:?} prints no JSON: {e}\n{text}"))
}

/// Every field of a list `a.b.c` is there and a number, or `null` where one is allowed.
#[track_caller]
fn numbers(value: &Value, fields: &[&str]) {
    for field in fields {
        let found = field.split('.').try_fold(value, |v, key| v.get(key));
        assert!(found.is_some_and(Value::is_number), "'{field}' is {found:?} in\n{value:#}");
    }
}

fn levels() -> Vec<&'static str> {
    let (here, absent): (Vec<Level>, Vec<Level>) = Level::ALL.into_iter().partition(|l| l.is_available());
    for level in absent {
        println!("SIMD level {} absent: not tested", level.name());
    }
    here.into_iter().map(Level::name).collect()
}

const METHODS: [&str; 5] = ["vfc", "hom", "hom-multipass", "hom-progressive", "ideal"];

#[test]
fn scenes_and_methods_are_listed_with_their_parameters() {
    let scenes = run(&["scenes"]);
    for name in ["city:seed=1,triangles=312524", "plant:seed=1,triangles=12748510", "terrain:seed=1,triangles=200000"] {
        assert!(scenes.contains(name), "no {name} in\n{scenes}");
    }
    let methods = run(&["methods"]);
    for name in METHODS {
        assert!(methods.lines().any(|line| line == name), "no {name} in\n{methods}");
    }
    for parameter in ["depth=nbz", "threshold=1", "update-triangles=2000", "occluder-triangles=25000", "bypass=384"] {
        assert!(methods.contains(parameter), "no {parameter} in\n{methods}");
    }
}

#[test]
fn the_city_has_its_triangles() {
    let city = json(&["inspect", "city"]);
    assert_eq!(city["triangles"], 312_524);
    numbers(&city, &["objects", "meshes", "triangles_per_object.median", "triangles_per_object.max", "views"]);
    let text = run(&["inspect", "city:triangles=5000"]);
    assert!(text.lines().any(|line| line == "  triangles   5,000"), "{text}");
    assert_eq!(run(&["inspect", "city:triangles=5000", "--quiet"]), "");
}

#[test]
fn a_walk_has_the_protocols_fields() {
    let mut args = vec!["walk", "city", "--frames", "2", "--size", "160x128"];
    METHODS.iter().for_each(|m| args.extend(["--method", m]));
    let report = json(&args);
    numbers(
        &report,
        &["scene.objects", "scene.triangles", "view.width", "view.height", "view.frames", "machine.threads"],
    );
    assert_eq!(report["scene"]["name"], "city");
    assert_eq!(report["view"], serde_json::json!({"width": 160, "height": 128, "frames": 2}));
    assert_eq!(report["machine"]["simd"], Level::best().name());
    let runs = report["runs"].as_array().unwrap();
    assert_eq!(runs.len(), METHODS.len());
    for (run, name) in runs.iter().zip(METHODS) {
        assert_eq!(run["method"], name);
        assert!(run["parameters"].is_object());
        for field in ["frame_ms", "stage_ms", "mean"] {
            assert!(run[field].is_object(), "{name}: {field}");
        }
        let frame = ["median", "p95", "min", "max", "total"].map(|f| format!("frame_ms.{f}"));
        let stage = ["select", "occluders", "pyramid", "cull", "draw"].map(|f| format!("stage_ms.{f}"));
        let mean = [
            "objects_in_frustum",
            "objects_drawn",
            "objects_visible_exact",
            "triangles_after_lod",
            "triangles_in_frustum",
            "triangles_drawn",
            "triangles_visible_exact",
            "depth_complexity",
            "queries",
        ]
        .map(|f| format!("mean.{f}"));
        let fields: Vec<&str> = frame.iter().chain(&stage).chain(&mean).map(String::as_str).collect();
        numbers(run, &fields);
        numbers(run, &["wrongly_culled_objects", "wrong_pixels_percent.mean", "wrong_pixels_percent.max"]);
        numbers(run, &["speedup_over_vfc.mean_of_frames", "speedup_over_vfc.of_means", "speedup_over_vfc.best_frame"]);
        numbers(run, &["time_over_ideal.mean_of_frames", "time_over_ideal.of_means", "time_over_ideal.worst_frame"]);
        for field in ["image_hash", "visible_set_hash"] {
            let hash = run[field].as_str().unwrap();
            assert!(hash.len() == 16 && u64::from_str_radix(hash, 16).is_ok(), "{name}: {field} {hash}");
        }
        assert!(run["mean"]["objects_in_frustum"].as_f64() > Some(0.0), "{name} sees nothing");
    }
}

/// The image hash of every method, which must be one, with nothing culled wrongly.
#[track_caller]
fn one_image(scene: &str, options: &[&str]) -> String {
    let mut args = vec!["walk", scene];
    args.extend(options);
    let methods = [
        "vfc",
        "hom",
        "hom:depth=nbz-block",
        "hom-multipass:update-triangles=100",
        "hom-multipass",
        "hom-progressive",
        "ideal",
    ];
    methods.iter().for_each(|m| args.extend(["--method", m]));
    let report = json(&args);
    let mut hash = None;
    for run in report["runs"].as_array().unwrap() {
        let what = format!("{} of {args:?}", run["method"]);
        assert_eq!(run["wrongly_culled_objects"], 0, "{what}");
        assert_eq!(run["wrong_pixels_percent"]["max"].as_f64(), Some(0.0), "{what}");
        let image = run["image_hash"].as_str().unwrap();
        assert_eq!(image, *hash.get_or_insert(image), "{what}: another picture than {}", methods[0]);
    }
    hash.unwrap().to_owned()
}

#[test]
fn pictures_do_not_depend_on_method_level_or_threads() {
    let mut scenes: Vec<(String, &str)> = vec![
        ("city:triangles=30000".into(), "160x128"),
        ("plant:triangles=60000".into(), "160x128"),
        ("terrain:triangles=20000".into(), "123x77"),
    ];
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    for entry in std::fs::read_dir(data).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "obj") {
            scenes.push((path.to_str().unwrap().to_owned(), "160x120"));
        }
    }
    scenes.sort();
    assert!(scenes.len() >= 4, "no models in data: {scenes:?}");
    for (scene, size) in scenes {
        let mut images = Vec::new();
        for level in levels() {
            for threads in ["1", "2", "3"] {
                let options = ["--frames", "5", "--size", size, "--simd", level, "--threads", threads];
                images.push((one_image(&scene, &options), level, threads));
            }
        }
        assert!(images.iter().all(|i| i.0 == images[0].0), "{scene}: {images:?}");
    }
}

#[test]
fn an_inexact_walk_says_null_and_not_zero() {
    let args = ["walk", "city:triangles=5000", "--frames", "1", "--size", "64x48", "--no-exact"];
    let run = &json(&args)["runs"][0];
    for field in ["wrongly_culled_objects", "wrong_pixels_percent", "speedup_over_vfc", "time_over_ideal"] {
        assert!(run[field].is_null(), "{field} is {}", run[field]);
    }
}

const TINY: [&str; 7] = ["city:triangles=100000", "--size", "320x200", "--frames", "2", "--repetitions", "1"];

fn measured(kernel: &str, more: &[&str]) -> Value {
    let value = json(&[&["measure", kernel], &TINY[..], more].concat());
    assert_eq!((&value["kernel"], &value["width"], &value["views"]), (&kernel.into(), &320.into(), &2.into()));
    numbers(&value, &["prepare_ms", "clock_ghz", "threads", "height", "repetitions"]);
    value
}

#[test]
fn the_raster_kernel_has_the_protocols_fields() {
    for switch in ["on", "off"] {
        let value = measured("raster", &["--cluster-test", switch]);
        numbers(&value, &["triangles_in_frustum", "ms_per_frame.median", "ms_per_frame.min", "mtriangles_per_s"]);
        assert_eq!((&value["mode"], &value["cluster_test"]), (&"coverage+depth".into(), &(switch == "on").into()));
        assert!(value["triangles_in_frustum"].as_u64() > Some(1000));
    }
}

#[test]
fn queries_and_progressive_culling_hide_nothing_that_shows_at_any_level() {
    for (kernel, time) in [("query", "ns_per_query"), ("progressive", "ms_per_frame.median")] {
        let mut states = Vec::new();
        for level in levels() {
            for threads in ["1", "3"] {
                for depth in ["nbz", "nbz-block"] {
                    let value = measured(kernel, &["--simd", level, "--threads", threads, "--depth", depth]);
                    numbers(&value, &[time, "queries", "visible", "occluded", "false_occluded", "missed_occluded"]);
                    assert_eq!(value["false_occluded"], 0, "{kernel} at {level}, {threads} threads, {depth}");
                    assert!(value["occluded"].as_u64() > Some(0) && value["visible"].as_u64() > Some(0));
                    assert!(value.get("brought").is_none(), "a generated scene brings no answers");
                    let both = value["visible"].as_u64().unwrap() + value["occluded"].as_u64().unwrap();
                    assert_eq!(Some(both), value["queries"].as_u64());
                    states.push((depth, value["state_hash"].clone(), level, threads));
                }
            }
        }
        for depth in ["nbz", "nbz-block"] {
            let mut of_depth = states.iter().filter(|s| s.0 == depth);
            let first = of_depth.next().unwrap();
            assert!(of_depth.all(|s| s.1 == first.1), "{kernel}: {states:?}");
        }
    }
    let progressive = measured("progressive", &[]);
    numbers(&progressive, &["objects_visible", "objects_occluded", "ms_per_frame.min"]);
}

#[test]
fn the_pyramid_kernel_has_the_protocols_fields() {
    let value = measured("pyramid", &[]);
    numbers(&value, &["ms_per_build", "bytes"]);
    assert!(value["bytes"].as_u64() > Some(0));
}

#[test]
fn whoever_reads_may_stop_reading() {
    for command in
        [&["methods"][..], &["scenes"], &["experiment"], &["--help"], &["inspect", "data/corridor.obj", "--json", "-"]]
    {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = Command::new(env!("CARGO_BIN_EXE_homcull")).args(command).stdout(writer).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && said.is_empty(), "{command:?}: {said}");
    }
}

#[test]
fn compare_has_every_method_that_applies_and_a_front_that_nothing_beats() {
    let report = std::env::temp_dir().join(format!("homcull-compare-{}", std::process::id()));
    let out = report.to_str().unwrap();
    let scene = "city:triangles=8000";
    let output = Command::new(env!("CARGO_BIN_EXE_homcull"))
        .args(["compare", scene, "--frames", "2", "--size", "128x96", "--threads", "1", "--json", "-", "--out", out])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(report.join("error-against-time.png").is_file());
    std::fs::remove_dir_all(&report).unwrap();
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let runs = value["runs"].as_array().unwrap();
    let name = |run: &serde_json::Value| run["name"].as_str().unwrap().to_owned();
    let wrong = |run: &serde_json::Value| run["wrong_pixels_percent"]["mean"].as_f64().unwrap();
    let ms = |run: &serde_json::Value| run["frame_ms"]["total"].as_f64().unwrap();
    for exact in ["vfc", "hom", "hom-multipass", "hom-progressive", "hzb", "stop-and-wait", "chc", "cplp", "horizons"] {
        let run = runs.iter().find(|run| name(run) == exact).unwrap_or_else(|| panic!("no {exact}"));
        assert_eq!((wrong(run), &run["image_hash"]), (0.0, &runs[0]["image_hash"]), "{exact}");
    }
    let left_out = value["left_out"].as_array().unwrap();
    assert!(left_out.len() == 1 && left_out[0].as_str().unwrap().starts_with("portals is left out"), "{left_out:?}");
    let front = value["pareto_front"].as_array().unwrap();
    assert!(!front.is_empty());
    for best in runs.iter().filter(|run| front.contains(&run["name"])) {
        let beats = |run: &&serde_json::Value| {
            let no_worse = ms(run) <= ms(best) && wrong(run) <= wrong(best);
            no_worse && (ms(run) < ms(best) || wrong(run) < wrong(best)) && run["method"] != "ideal"
        };
        assert_eq!(runs.iter().find(beats).map(name), None, "beats {}", name(best));
    }
}

#[test]
fn advice_rests_on_counts_that_agree_with_a_walk() {
    let run = |args: &[&str]| -> serde_json::Value {
        let rest = ["--frames", "2", "--size", "320x256", "--threads", "1", "--json", "-", "--quiet"];
        let output = Command::new(env!("CARGO_BIN_EXE_homcull")).args(args).args(rest).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let scene = "city:triangles=60000";
    let advised = run(&["advise", scene]);
    let walked = run(&["walk", scene, "--method", "vfc", "--method", "hzb", "--method", "hom-progressive"]);
    for walked in walked["runs"].as_array().unwrap() {
        let rows = advised["methods"].as_array().unwrap();
        let row = rows.iter().find(|row| row["method"] == walked["method"]).unwrap();
        let mean = |key: &str| walked["mean"][key].as_f64().unwrap();
        assert_eq!(row["triangles_saved"].as_f64(), Some(mean("triangles_in_frustum") - mean("triangles_drawn")));
        assert_eq!(row["occluder_triangles"].as_f64(), Some(mean("occluder_triangles")));
        assert_eq!(row["tests"].as_f64(), Some(mean("queries")));
        let draws_twice = walked["method"] == "hom-progressive";
        assert_eq!(mean("occluder_triangles") > 0.0, draws_twice, "{}", walked["method"]);
    }
    assert!(advised["advice"].as_array().unwrap().len() >= 2, "{advised:#}");
}

#[test]
fn a_folder_that_is_called_as_a_generator_does_not_hide_it() {
    let around = std::env::temp_dir().join(format!("homcull-hidden-{}", std::process::id()));
    std::fs::create_dir_all(around.join("terrain")).unwrap();
    let inspect = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_homcull"));
        command.args(["inspect", "terrain", "--json", "-"]).current_dir(&around).output().unwrap()
    };
    assert!(inspect().status.success());
    // A benchmark that is cut short is meant, and refused.
    std::fs::write(around.join("terrain/scene.bin"), b"HOM").unwrap();
    let refused = inspect();
    assert_eq!(refused.status.code(), Some(2), "{}", String::from_utf8_lossy(&refused.stderr));
    std::fs::remove_dir_all(&around).unwrap();
}
