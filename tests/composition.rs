//! Methods composed of stages: how they are written, that the picture stays whatever stages follow one another, and what each is
//! said to have left.
#![cfg(feature = "cli")]

use std::process::Command;

use homcull::cull::Method;
use serde_json::Value;

fn name(text: &str) -> String {
    Method::parse(text).unwrap().name()
}

/// The report of a walk by methods, in small pictures.
fn walk(scene: &str, frames: &str, methods: &[impl AsRef<str>], more: &[&str]) -> Value {
    let mut args = vec!["walk", scene, "--frames", frames, "--size", "160x120", "--json", "-"];
    methods.iter().for_each(|m| args.extend(["--method", m.as_ref()]));
    args.extend(more);
    let output = Command::new(env!("CARGO_BIN_EXE_homcull")).args(args).output().unwrap();
    assert!(output.status.success(), "{scene}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn keeps_the_picture(scene: &str, methods: &[impl AsRef<str>]) -> Value {
    let methods: Vec<&str> = std::iter::once("vfc").chain(methods.iter().map(AsRef::as_ref)).collect();
    let report = walk(scene, "2", &methods, &["--threads", "2"]);
    let runs = report["runs"].as_array().unwrap();
    for (run, method) in runs.iter().zip(&methods) {
        assert_eq!(run["wrongly_culled_objects"], 0, "{method} of {scene}");
        assert_eq!(run["image_hash"], runs[0]["image_hash"], "{method} of {scene}");
    }
    report
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

#[test]
fn stages_are_read_as_they_are_written() {
    assert_eq!(name("detail:pixels=4+portals+hom"), "detail+portals+hom");
    assert_eq!(name(" frustum + detail + hzb:first=previous "), "vfc+detail+hzb");
    let method = Method::parse("detail:pixels=9+chc:latency=20,pixels=2").unwrap();
    let parameters = method.parameters();
    let value = |key: &str| parameters.iter().find(|(k, _)| k == key).map(|(_, v)| v.as_str());
    assert_eq!((value("detail.pixels"), value("chc.pixels"), value("chc.latency")), (Some("9"), Some("2"), Some("20")));
    assert_eq!(method.stages().len(), 2);
}

#[test]
fn a_plus_in_a_file_name_is_no_stage() {
    let Method::Hom(one) = Method::parse("hom:select=baked,bake=a+b.bake").unwrap() else { panic!("one method") };
    assert_eq!(one.bake.unwrap().to_str(), Some("a+b.bake"));
    assert_eq!(name("hom:select=baked,bake=a+b.bake+hzb"), "hom+hzb");
}

#[test]
fn what_cannot_be_composed_is_refused_by_name() {
    for (text, names) in [
        ("hzb+ideal", "ideal"),
        ("detail+hom:pipeline=on", "hom"),
        ("detail+nonsense", "nonsense"),
        ("detail+", "known are"),
        ("+hzb", "known are"),
        ("detail:pixels=-1+hzb", "pixels"),
        ("detail:size=4", "size"),
    ] {
        let error = Method::parse(text).unwrap_err().to_string();
        assert!(error.contains(names), "{text}: {error}");
    }
}

/// Methods of image space, with what they remember over frames.
const IMAGE_SPACE: [&str; 6] = [
    "hom:rest=0",
    "hom-progressive:rest=0",
    "hzb:first=previous",
    "stop-and-wait",
    "chc:latency=8,assume-visible=1",
    "cplp:budget=3000",
];

#[test]
fn any_two_methods_of_image_space_keep_the_picture_together() {
    let pairs: Vec<String> = IMAGE_SPACE.iter().flat_map(|a| IMAGE_SPACE.map(|b| format!("{a}+{b}"))).collect();
    let report = keeps_the_picture("city:triangles=30000", &pairs);
    for run in &report["runs"].as_array().unwrap()[1..] {
        // A second stage sees what the first left, and finds nothing more visible than that.
        let stages = run["stages"].as_array().unwrap();
        assert_eq!(stages.len(), 2);
        assert!(number(&stages[1]["objects_left"]) <= number(&stages[0]["objects_left"]), "{run}");
        assert_eq!(run["mean"]["objects_drawn"], stages[1]["objects_left"], "{run}");
        let tests: f64 = stages.iter().map(|stage| number(&stage["queries"])).sum();
        assert!((number(&run["mean"]["queries"]) - tests).abs() < 1e-6, "{run}");
    }
}

#[test]
fn compositions_keep_the_picture_of_every_kind_of_scene() {
    for scene in
        ["teapots:triangles=140000", "forest:triangles=60000", "terrain:triangles=40000", "plant:triangles=300000"]
    {
        keeps_the_picture(scene, &["hom:rest=0+hzb", "cplp:budget=3000+chc", "detail:pixels=0+stop-and-wait"]);
    }
    keeps_the_picture("rooms", &["portals+hom:rest=0", "portals+hzb", "portals+chc+cplp:budget=2000"]);
    keeps_the_picture("city:triangles=30000", &["horizons+hzb", "frustum+horizons+hom-progressive:rest=0"]);
}

#[test]
fn portals_leave_less_to_the_stage_behind_them() {
    let report = keeps_the_picture("rooms", &["hzb", "portals+hzb"]);
    let tests = |i: usize| {
        number(&report["runs"][i]["stages"].as_array().map_or(&report["runs"][i]["mean"], |s| &s[1])["queries"])
    };
    assert!(tests(2) < tests(1), "{} tests behind portals, {} without", tests(2), tests(1));
}

#[test]
fn detail_goes_while_the_view_moves_and_comes_back_when_it_rests() {
    let folder = std::env::temp_dir().join(format!("homcull-composition-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let (path, table) = (folder.join("rest.json"), folder.join("frames.csv"));
    let key = |x: f64| format!(r#"{{"eye": [{x}, 2, 0], "target": [{x}, 2, -30]}}"#);
    let keys = [0.0, 1.0, 1.0].map(key).join(", ");
    let camera = r#""fov_y_deg": 60, "near": 0.1, "far": null, "up": [0, 1, 0], "frames": 3"#;
    std::fs::write(&path, format!("{{{camera}, \"keys\": [{keys}]}}")).unwrap();
    let files = ["--path", path.to_str().unwrap(), "--csv", table.to_str().unwrap()];
    walk("forest:triangles=60000", "3", &["vfc", "detail:pixels=400+hzb"], &files);
    let mut frames = csv::Reader::from_path(&table).unwrap();
    let head = frames.headers().unwrap().clone();
    let at = |name: &str| head.iter().position(|column| column == name).unwrap();
    let (method, drawn, wrong) = (at("method"), at("objects_drawn"), at("wrong_pixels"));
    let rows: Vec<csv::StringRecord> = frames.records().map(Result::unwrap).collect();
    let of = |m: &str, column: usize| -> Vec<u32> {
        rows.iter().filter(|row| &row[method] == m).map(|row| row[column].parse().unwrap()).collect()
    };
    std::fs::remove_dir_all(folder).unwrap();
    let (all, kept) = (of("vfc", drawn), of("detail+hzb", drawn));
    assert!(kept[0] < all[0] && kept[1] < kept[2], "{kept:?} of {all:?} objects");
    let wrong = of("detail+hzb", wrong);
    assert!(wrong[1] > 0 && wrong[2] == 0, "{wrong:?} wrong pixels");
}
