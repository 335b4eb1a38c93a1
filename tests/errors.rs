//! Wrong input answers in one line on standard error and with status 2, and leaves nothing half-written.
#![cfg(feature = "cli")]

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use homcull::draw::Canvas;
use homcull::error::Error;
use homcull::occlusion::{OcclusionBuffer, OcclusionSettings};
use homcull::view::Viewport;
use homcull_simd::Level;

/// A folder of one test's own, removed when the test ends.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Folder {
        let path = std::env::temp_dir().join(format!("homcull-errors-{}-{test}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> String {
        let path = self.0.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, bytes).unwrap();
        path.to_str().unwrap().to_owned()
    }

    fn path(&self, name: &str) -> String {
        self.0.join(name).to_str().unwrap().to_owned()
    }

    /// Everything below it, sorted.
    fn files(&self) -> Vec<PathBuf> {
        fn below(folder: &Path, out: &mut Vec<PathBuf>) {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    below(&path, out);
                }
                out.push(path);
            }
        }
        let mut out = Vec::new();
        below(&self.0, &mut out);
        out.sort();
        out
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn homcull<A: AsRef<OsStr>>(folder: &Folder, args: &[A]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_homcull")).args(args).current_dir(&folder.0).output().unwrap()
}

/// Runs and demands: status 2, nothing on standard output, one line on standard error that names what is at fault, and no
/// file more than before.
#[track_caller]
fn refused(folder: &Folder, args: &[&str], names: &[&str]) {
    let before = folder.files();
    let output = homcull(folder, args);
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.status.code(), Some(2), "{args:?}\n{out}\n{err}");
    assert_eq!(out, "", "{args:?} writes to standard output");
    assert!(err.ends_with('\n') && err.lines().count() == 1, "{args:?} says not one line:\n{err}");
    for name in names {
        assert!(err.contains(name), "{args:?}: no '{name}' in {err}");
    }
    assert_eq!(folder.files(), before, "{args:?} leaves files");
}

const SMALL: &str = "city:triangles=2000";
const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

#[test]
fn a_scene_that_is_not_there_is_named() {
    let f = Folder::new("missing");
    for command in [&["walk"][..], &["inspect"], &["measure", "raster"], &["measure", "query"]] {
        let missing = f.path("missing.obj");
        refused(&f, &[command, &[&missing]].concat(), &["missing.obj"]);
        refused(&f, &[command, &["no-such-scene"]].concat(), &["no-such-scene", "city"]);
        refused(&f, &[command, &[&f.path("")]].concat(), &["scene.bin"]);
    }
    refused(&f, &["walk", ""], &["scene"]);
    refused(&f, &["walk"], &["SCENE"]);
    refused(&f, &["measure", SMALL], &[SMALL]);
}

#[test]
fn a_bad_model_is_named_with_its_line() {
    let f = Folder::new("obj");
    let bad = [
        ("prose.obj", "Dear reader,\nthis is not a model.\n", "prose.obj"),
        ("binary.obj", "\u{0}\u{1}\u{2}PNG\u{7}\n", "binary.obj"),
        ("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "range.obj:4"),
        ("zero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "zero.obj:4"),
        ("below.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -4\n", "below.obj:4"),
        ("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "nan.obj:2"),
        ("huge.obj", "v 0 0 0\nv 1 0 1e400\nv 0 1 0\nf 1 2 3\n", "huge.obj:2"),
        ("words.obj", "v 0 0 0\nv 1 x 0\nv 0 1 0\nf 1 2 3\n", "words.obj:2"),
        ("two.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", "two.obj:3"),
        ("empty.obj", "", "empty.obj"),
        ("points.obj", "v 0 0 0\nv 1 0 0\n", "points.obj"),
    ];
    for (name, text, culprit) in bad {
        let path = f.write(name, text);
        refused(&f, &["inspect", &path], &[culprit]);
        refused(&f, &["walk", &path, "--frames", "1", "--size", "32x32", "--json", "out.json"], &[culprit]);
    }
    let folder = f.path("folder.obj");
    fs::create_dir(&folder).unwrap();
    refused(&f, &["inspect", &folder], &["folder.obj"]);
}

#[test]
fn an_unknown_key_or_value_of_a_generator_is_named() {
    let f = Folder::new("generator");
    for (scene, culprit) in [
        ("castle", "castle"),
        ("city:height=3", "height"),
        ("city:triangles=many", "many"),
        ("city:triangles=-1", "-1"),
        ("city:triangles=0", "0"),
        ("city:triangles=99999999999999999999", "99999999999999999999"),
        ("city:seed=x", "x"),
        ("city:seed", "seed"),
        ("terrain:=4", "key"),
    ] {
        refused(&f, &["inspect", scene], &[culprit]);
    }
}

#[test]
fn a_bad_option_is_named() {
    let f = Folder::new("options");
    for size in ["0x0", "0x128", "128x0", "200000x200000", "16385x1", "99999999999999999999x1"] {
        refused(&f, &["walk", SMALL, "--size", size], &["16384"]);
    }
    for size in ["big", "128", "x", "128x", "128x96x3", "1.5x2", "128X96", ""] {
        refused(&f, &["walk", SMALL, "--size", size], &["size"]);
    }
    refused(&f, &["walk", SMALL, "--size", "-1x5"], &["-1"]);
    refused(&f, &["walk", SMALL, "--threads", "0"], &["threads", "0"]);
    refused(&f, &["walk", SMALL, "--threads", "two"], &["threads", "two"]);
    refused(&f, &["walk", SMALL, "--threads", "99999"], &["threads", "99999"]);
    refused(&f, &["walk", SMALL, "--threads", "1000", "--frames", "1", "--size", "32x32"], &["threads", "1000"]);
    refused(&f, &["walk", SMALL, "--frames", "0"], &["frames", "0"]);
    refused(&f, &["walk", SMALL, "--frames", "-3"], &["-3"]);
    refused(&f, &["walk", SMALL, "--repetitions", "0"], &["repetitions", "0"]);
    refused(&f, &["walk", SMALL, "--simd", "mmx"], &["simd", "mmx"]);
    refused(&f, &["walk", SMALL, "--no-such-option"], &["--no-such-option"]);
    refused(&f, &["measure", "teapots", SMALL], &["teapots"]);
    refused(&f, &["measure", "raster", SMALL, "--depth", "deep"], &["deep"]);
    refused(&f, &["measure", "raster", SMALL, "--cluster-test", "maybe"], &["maybe"]);
    refused(&f, &["fly", SMALL], &["fly"]);
    refused(&f, &["walk", SMALL, "city"], &["city"]);
}

#[test]
fn an_unknown_method_key_or_value_is_named() {
    let f = Folder::new("methods");
    for (method, culprit) in [
        ("magic", "magic"),
        ("", "method"),
        ("vfc:depth=nbz", "depth"),
        ("hom:colour=red", "colour"),
        ("hom:depth=deep", "deep"),
        ("hom:depth", "depth"),
        ("hom:deb-size=8x8", "deb-size"),
        ("hom:depth=deb,deb-size=0x8", "0x8"),
        ("hom:threshold=0", "threshold"),
        ("hom:threshold=1.5", "1.5"),
        ("hom:threshold=NaN", "NaN"),
        ("hom:occluder-triangles=few", "few"),
        ("hom:resolution=0x0", "0x0"),
        ("hom:resolution=big", "big"),
        ("hom:bypass=0", "bypass"),
        ("hom:select=taste", "taste"),
        ("hom-multipass:update-triangles=x", "x"),
        ("hom-progressive:update-triangles=5", "update-triangles"),
        ("ideal:set=guess", "guess"),
    ] {
        refused(&f, &["walk", SMALL, "--frames", "1", "--size", "32x32", "--method", method], &[culprit]);
    }
}

#[test]
fn a_bad_camera_path_is_named_with_its_key() {
    let f = Folder::new("path");
    let whole = r#"{"fov_y_deg": 60, "near": 0.1, "far": null, "up": [0, 1, 0],
        "keys": [{"eye": [0, 2, 9], "target": [0, 2, 0]}]}"#;
    for (from, to, culprit) in [
        ("\"fov_y_deg\": 60,", "", "fov_y_deg"),
        ("\"near\": 0.1,", "", "near"),
        ("\"up\": [0, 1, 0],", "", "up"),
        ("\"target\": [0, 2, 0]", "\"to\": [0, 2, 0]", "target"),
        ("\"eye\": [0, 2, 9],", "", "eye"),
        ("\"keys\": [{", "\"doors\": [{", "keys"),
        ("[0, 2, 9]", "[0, 2]", "eye"),
        ("[0, 2, 9]", "[0, 2, null]", "eye"),
        ("[0, 2, 9]", "[0, 2, 0]", "key 0"),
        ("[0, 2, 9]", "[0, 5, 0]", "up"),
        ("60", "180", "fov_y_deg"),
        ("0.1", "0", "near"),
        ("null", "0.05", "far"),
        ("60", "sixty", "path.json:1"),
        ("}]}", "", "JSON"),
    ] {
        let text = whole.replacen(from, to, 1);
        assert_ne!(text, whole, "{from}");
        let path = f.write("path.json", text);
        let args = ["walk", SMALL, "--path", &path, "--frames", "1", "--size", "32x32"];
        refused(&f, &args, &["path.json", culprit]);
    }
    f.write("path.json", whole.replace("[{\"eye\": [0, 2, 9], \"target\": [0, 2, 0]}]", "[]"));
    refused(&f, &["walk", SMALL, "--path", "path.json"], &["path.json", "key"]);
    refused(&f, &["walk", SMALL, "--path", "nowhere.json"], &["nowhere.json"]);
    // A path that stands beside a model is read as well.
    let model = f.write("m.obj", TRIANGLE);
    f.write("m.path.json", "{}");
    refused(&f, &["walk", &model, "--frames", "1"], &["m.path.json"]);
}

/// A benchmark scene of one triangle and one view.
fn benchmark() -> (Vec<u8>, Vec<u8>) {
    let mut scene: Vec<u8> = Vec::new();
    let floats = |v: &[f32]| v.iter().flat_map(|f| f.to_le_bytes()).collect::<Vec<u8>>();
    let words = |v: &[u32]| v.iter().flat_map(|w| w.to_le_bytes()).collect::<Vec<u8>>();
    scene.extend(words(&[1, 3, 1]));
    scene.extend(floats(&[-1.0, -1.0, -5.0, 1.0, -1.0, -5.0, 0.0, 1.0, -5.0]));
    scene.extend(words(&[0, 1, 2]));
    scene.extend(floats(&[-1.0, -1.0, -5.0, 1.0, 1.0, -5.0]));
    let mut views = words(&[1, 64, 48]);
    // 90 degrees, near 0.1, far 100.
    let (zz, zw) = (-100.1f32 / 99.9, -20.0f32 / 99.9);
    views.extend(floats(&[1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, zz, -1.0, 0.0, 0.0, zw, 0.0]));
    (scene, views)
}

#[test]
fn a_truncated_or_damaged_benchmark_scene_is_named() {
    let f = Folder::new("benchmark");
    let (scene, views) = benchmark();
    f.write("b/scene.bin", &scene);
    f.write("b/views.bin", &views);
    let folder = f.path("b");
    let output = homcull(&f, &["measure", "query", &folder, "--repetitions", "1"]);
    assert!(output.status.success(), "the whole scene: {}", String::from_utf8_lossy(&output.stderr));
    for length in (0..scene.len()).step_by(7).chain([scene.len() - 1]) {
        f.write("b/scene.bin", &scene[..length]);
        refused(&f, &["inspect", &folder], &["scene.bin"]);
    }
    let changed = |at: usize, word: u32| {
        let mut bytes = scene.clone();
        bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
        bytes
    };
    // Counts beyond the file, an index out of range, a vertex that is no number.
    for (at, word) in [(0, u32::MAX), (4, u32::MAX), (8, u32::MAX), (48, 3), (12, f32::NAN.to_bits())] {
        f.write("b/scene.bin", changed(at, word));
        refused(&f, &["inspect", &folder], &["b"]);
    }
    f.write("b/scene.bin", &scene);
    for length in [0, 3, 12, views.len() - 1] {
        f.write("b/views.bin", &views[..length]);
        refused(&f, &["inspect", &folder], &["views.bin"]);
    }
    let mut singular = views.clone();
    singular[12..76].fill(0);
    f.write("b/views.bin", singular);
    refused(&f, &["measure", "raster", &folder], &["singular"]);
    f.write("b/views.bin", &views);
    f.write("b/ref_64x48.bin", &views[..9]);
    refused(&f, &["measure", "query", &folder, "--repetitions", "1"], &["ref_64x48.bin"]);
}

#[test]
fn output_that_cannot_be_written_is_named_and_leaves_nothing() {
    let f = Folder::new("output");
    let file = f.write("file", "not a folder");
    let short = ["walk", SMALL, "--frames", "1", "--size", "32x32"];
    for option in ["--json", "--csv"] {
        for target in [format!("{file}/below.out"), f.path("no/such/folder/x.out")] {
            refused(&f, &[&short[..], &[option, &target]].concat(), &[".out"]);
        }
        // A folder is no file.
        refused(&f, &[&short[..], &[option, &f.path("")]].concat(), &["homcull-errors"]);
    }
    for target in [file.clone(), format!("{file}/below")] {
        refused(&f, &[&short[..], &["--out", &target]].concat(), &["file"]);
    }
    refused(&f, &["--out", &format!("{file}/below"), "--frames", "1"], &["file"]);
    refused(&f, &["inspect", SMALL, "--json", &format!("{file}/x.json")], &["x.json"]);
    let measure = ["measure", "raster", SMALL, "--frames", "1", "--repetitions", "1", "--size", "32x32"];
    refused(&f, &[&measure[..], &["--json", &format!("{file}/x.json")]].concat(), &["x.json"]);
    assert_eq!(fs::read_to_string(&file).unwrap(), "not a folder");
}

#[test]
fn a_report_that_fails_leaves_the_former_one_in_place() {
    let f = Folder::new("former");
    let former = f.write("report.json", "the former one");
    refused(&f, &["walk", SMALL, "--method", "magic", "--json", &former], &["magic"]);
    refused(&f, &["walk", "nowhere.obj", "--json", &former], &["nowhere.obj"]);
    assert_eq!(fs::read_to_string(&former).unwrap(), "the former one");
}

#[test]
fn a_simd_level_that_the_machine_lacks_is_a_typed_error() {
    let f = Folder::new("simd");
    let viewport = Viewport::new(32, 32).unwrap();
    let absent: Vec<Level> = Level::ALL.into_iter().filter(|l| !l.is_available()).collect();
    if absent.is_empty() {
        println!("NOT TESTED: this machine has every SIMD level, so none can be refused");
    }
    for level in absent {
        refused(&f, &["walk", SMALL, "--simd", level.name()], &[level.name()]);
        let refused = Err(Error::SimdLevel(level.name().into()));
        assert_eq!(OcclusionBuffer::with_level(viewport, level, OcclusionSettings::default()).map(|_| ()), refused);
        assert_eq!(Canvas::new(viewport, level).map(|_| ()), refused);
    }
    let message = Error::SimdLevel("avx512".into()).to_string();
    assert!(message.contains("avx512") && !message.contains('\n'), "{message}");
}

#[test]
fn help_is_no_error() {
    let f = Folder::new("help");
    for args in [&["--help"][..], &["--version"], &["walk", "--help"], &["help"]] {
        let output = homcull(&f, args);
        assert_eq!((output.status.code(), output.stderr.len()), (Some(0), 0), "{args:?}");
        assert!(!output.stdout.is_empty());
    }
}
