//! Combinations of the hom methods' parameters keep the picture: with thresholds at 1, every pair of values of any two parameters is
//! walked together on the generated scenes and on the shared models.
//!
//! Those lie in the folder HOMCULL_MODELS, `../shared` by default; what is not there is passed over, and said so.
#![cfg(feature = "cli")]

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::process::Command;

use serde_json::Value;

/// Parameters and their values; the first of each is the default.
const FACTORS: [(&str, &[&str]); 4] = [
    ("depth", &["nbz", "nbz-block", "deb", "plane"]),
    ("select", &["distance", "nearest", "zplane", "temporal", "baked"]),
    ("pipeline", &["off", "on"]),
    ("database", &["all", "static"]),
];
/// Those that progressive and multi-pass culling have, too.
const OF_ALL: [usize; 2] = [0, 2];

/// Methods that cull while they draw, each with what it may be told.
const DRAWING: [&str; 10] = [
    "hzb",
    "hzb:first=previous",
    "stop-and-wait",
    "stop-and-wait:latency=thread",
    "chc",
    "chc:latency=5,order=depth",
    "chc:latency=40,assume-visible=2",
    "chc:latency=20,assume-visible=adaptive,spread=on,idle=on",
    "chc:latency=1000,speculate=on",
    "chc:latency=thread",
];

/// Values of some parameters such that every pair of values of two of them occurs: greedily, the row that has most pairs not had
/// yet, of equals the first.
fn covering(factors: &[usize]) -> Vec<Vec<usize>> {
    let rows = factors.iter().fold(vec![vec![]], |rows: Vec<Vec<usize>>, &f| {
        let values = 0..FACTORS[f].1.len();
        rows.iter().flat_map(|r| values.clone().map(|v| [&r[..], &[v]].concat())).collect()
    });
    let pairs = |row: &[usize]| -> BTreeSet<[usize; 4]> {
        let of = |a: usize| (0..a).map(move |b| (b, a));
        (0..row.len()).flat_map(of).map(|(b, a)| [b, row[b], a, row[a]]).collect()
    };
    let mut left: BTreeSet<[usize; 4]> = rows.iter().flat_map(|r| pairs(r)).collect();
    let mut chosen = Vec::new();
    while !left.is_empty() {
        let gain = |row: &Vec<usize>| pairs(row).intersection(&left).count();
        let best = rows.iter().rev().max_by_key(|r| gain(r)).unwrap().clone();
        left = &left - &pairs(&best);
        chosen.push(best);
    }
    chosen
}

fn methods(bake: &str) -> Vec<String> {
    let mut out = vec!["vfc".to_owned()];
    let all: Vec<usize> = (0..FACTORS.len()).collect();
    for (method, factors) in [("hom", &all[..]), ("hom-multipass", &OF_ALL), ("hom-progressive", &OF_ALL)] {
        for row in covering(factors) {
            let mut values: Vec<String> =
                factors.iter().zip(row).map(|(&f, v)| format!("{}={}", FACTORS[f].0, FACTORS[f].1[v])).collect();
            if values.iter().any(|v| v == "select=baked") {
                values.push(format!("bake={bake}"));
            }
            // Redundancy has tests of its own, and takes long.
            if values.iter().any(|v| v == "database=static") {
                values.push("static-redundancy=off".into());
            }
            out.push(format!("{method}:{},rest=0", values.join(",")));
        }
    }
    out.extend(DRAWING.map(str::to_owned));
    out
}

fn homcull(args: &[&str]) -> Vec<u8> {
    let output = Command::new(env!("CARGO_BIN_EXE_homcull")).args(args).output().unwrap();
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

fn keeps_the_picture(name: &str, scene: &str) {
    let bake = std::env::temp_dir().join(format!("homcull-combinations-{name}-{}.bake", std::process::id()));
    let bake = bake.to_str().unwrap();
    homcull(&["bake", scene, "--grid", "2x1x2", "--face", "64", "--out", bake, "--quiet"]);
    let methods = methods(bake);
    let mut args = vec!["walk", scene, "--frames", "4", "--size", "256x192", "--threads", "2", "--json", "-"];
    methods.iter().for_each(|m| args.extend(["--method", m]));
    let report: Value = serde_json::from_slice(&homcull(&args)).unwrap();
    std::fs::remove_file(bake).unwrap();
    let runs = report["runs"].as_array().unwrap();
    assert_eq!(runs.len(), methods.len());
    for (run, method) in runs.iter().zip(&methods) {
        assert_eq!(run["wrongly_culled_objects"], 0, "{method} of {scene}");
        assert_eq!(run["image_hash"], runs[0]["image_hash"], "{method} of {scene}");
    }
    let drawn = |run: &Value| run["mean"]["objects_drawn"].as_f64().unwrap();
    let fewer = runs.iter().filter(|r| drawn(r) < drawn(&runs[0])).count();
    println!("{name}: {fewer} of {} methods draw fewer objects than vfc", methods.len() - 1);
    assert!(fewer * 3 > methods.len(), "{scene}: {fewer} of {} methods cull anything", methods.len() - 1);
}

fn model_keeps_the_picture(name: &str) {
    let folder = std::env::var_os("HOMCULL_MODELS")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared"), PathBuf::from);
    let path = folder.join("data").join(name);
    if !path.exists() {
        println!("NOT TESTED: {} is not there (HOMCULL_MODELS names the folder)", path.display());
        return;
    }
    keeps_the_picture(name, path.to_str().unwrap());
}

#[test]
fn every_pair_of_values_is_walked() {
    let rows = methods("x");
    for (f, (key, values)) in FACTORS.iter().enumerate() {
        for (other, theirs) in &FACTORS[..f] {
            for (a, b) in values.iter().flat_map(|a| theirs.iter().map(move |b| (a, b))) {
                let (a, b) = (format!("{key}={a},"), format!("{other}={b},"));
                assert!(rows.iter().any(|r| r.starts_with("hom:") && r.contains(&a) && r.contains(&b)), "{a} {b}");
            }
        }
    }
}

#[test]
fn combinations_keep_the_picture_of_the_city() {
    keeps_the_picture("city", "city:triangles=60000");
}

#[test]
fn combinations_keep_the_picture_of_the_machine_room() {
    keeps_the_picture("machine-room", "machine-room:triangles=100000");
}

#[test]
fn combinations_keep_the_picture_of_the_plant() {
    keeps_the_picture("plant", "plant:triangles=1000000");
}

#[test]
fn combinations_keep_the_picture_of_a_town_of_photogrammetry() {
    model_keeps_the_picture("denhaag_01.obj");
}

#[test]
fn combinations_keep_the_picture_of_an_arena() {
    model_keeps_the_picture("oa_thor.obj");
}
