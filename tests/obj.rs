//! Statements about OBJ models: what loads, as what, and what is refused, with file and line.
#![cfg(feature = "obj")]

use std::path::{Path, PathBuf};

use glam::Vec3;
use homcull::Error;
use homcull::scene::{Facing, Scene, load_obj};

/// Writes a file into the tests' own folder and returns its path.
fn file(name: &str, text: impl AsRef<[u8]>) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("obj");
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

fn load(name: &str, text: impl AsRef<[u8]>) -> Result<Scene, Error> {
    load_obj(&file(name, text))
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

/// Asserts that a text is refused at a line, for a reason that has some words.
#[track_caller]
fn refused(name: &str, text: &str, at: Option<usize>, words: &str) {
    match load(name, text) {
        Err(Error::Format { path, line, reason }) => {
            assert!(path.ends_with(name), "names {}", path.display());
            assert_eq!(line, at, "{reason}");
            assert!(reason.contains(words), "'{reason}' does not say '{words}'");
        }
        other => panic!("{text:?} gave {other:?}"),
    }
}

fn area(scene: &Scene) -> f32 {
    let mut sum = 0.0;
    for object in &scene.objects {
        let mesh = &scene.meshes[object.mesh as usize];
        for t in mesh.triangles() {
            let [a, b, c] = t.map(|i| mesh.positions()[i as usize]);
            sum += (b - a).cross(c - a).length() * 0.5;
        }
    }
    sum
}

fn names(scene: &Scene) -> Vec<&str> {
    scene.objects.iter().map(|o| o.name.as_str()).collect()
}

#[test]
fn every_object_has_its_own_vertices_and_both_sides() {
    let text = "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 5\no a\nf 2 3 4\no b\nf 2 3 5\n";
    let scene = load("own.obj", text).unwrap();
    assert_eq!(names(&scene), ["a", "b"]);
    assert!(scene.objects.iter().all(|o| o.facing == Facing::Both && o.is_opaque()));
    assert!(scene.meshes.iter().all(|m| m.positions().len() == 3));
    assert_eq!(scene.name, "own");
}

#[test]
fn faces_without_a_name_are_of_an_object_named_after_the_file() {
    assert_eq!(names(&load("soup.obj", format!("{TRIANGLE}f 1 2 3\n")).unwrap()), ["soup"]);
}

#[test]
fn groups_within_an_object_are_objects_and_come_back_as_the_same() {
    let text = format!("{TRIANGLE}o house\ng wall\nf 1 2 3\ng roof\nf 1 2 3\ng wall\nf 3 2 1\no house\nf 1 2 3\n");
    let scene = load("groups.obj", text).unwrap();
    assert_eq!(names(&scene), ["house/wall", "house/roof", "house"]);
    assert_eq!(scene.meshes[0].triangles().len(), 2);
}

#[test]
fn empty_groups_leave_nothing() {
    let scene = load("empty.obj", format!("o nothing\n{TRIANGLE}g\no something\nf 1 2 3\no end\n")).unwrap();
    assert_eq!(names(&scene), ["something"]);
}

#[test]
fn relative_indices_count_back_from_the_last_vertex() {
    let scene = load("relative.obj", format!("{TRIANGLE}f -3 -2 -1\nv 5 5 5\nf -4//-9 2/7 -2/1/1\n")).unwrap();
    assert_eq!(scene.triangles(), 2);
    assert_eq!(area(&scene), 1.0);
}

#[test]
fn a_face_may_name_vertices_that_come_later() {
    assert_eq!(load("ahead.obj", format!("o a\nf 1 2 3\n{TRIANGLE}")).unwrap().triangles(), 1);
}

#[test]
fn continuations_comments_colours_and_line_ends_are_read() {
    let text = "\u{feff}# a \\\nv 0 0 0 # origin\r\nv 1 0 0 0.5 0.5 0.5\r\nv 0 1 \\\r\n 0 1.0\r\nf 1 2 \\\n3 # done \\\nl 1 2 3\n";
    let scene = load("odd.obj", text).unwrap();
    assert_eq!(scene.triangles(), 1);
    assert_eq!(scene.meshes[0].positions()[2], Vec3::Y);
}

#[test]
fn lines_and_points_are_no_triangles() {
    let scene = load("lines.obj", format!("{TRIANGLE}l 1 2 3\np 1 2 3\nf 1 2 3\nl 3 2 1 2\n")).unwrap();
    assert_eq!(scene.triangles(), 1);
    refused("only_lines.obj", &format!("{TRIANGLE}l 1 2 3\n"), None, "has no triangles");
}

#[test]
fn a_concave_polygon_covers_its_own_area_only() {
    // An L of area 3: its fan from the first corner would cover more.
    let text = "v 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1\nv 0 0 1\nf 1 2 3 4 5 6\n";
    let scene = load("l.obj", text).unwrap();
    assert_eq!((scene.triangles(), area(&scene)), (4, 3.0));
    // An arrow head, the notch first: the fan that tobj makes happens to be right; from any other corner it is not.
    for turn in 0..4 {
        let corners: Vec<String> = (0..4).map(|k| ((k + turn) % 4 + 1).to_string()).collect();
        let text = format!("v 0 0 1\nv 0 2 -1\nv 0 0 0\nv 0 -2 -1\nf {}\n", corners.join(" "));
        let scene = load("arrow.obj", text).unwrap();
        assert_eq!((scene.triangles(), area(&scene)), (2, 2.0), "from corner {turn}");
    }
}

#[test]
fn polygons_keep_their_orientation_in_every_plane() {
    for axes in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2]] {
        let points = [[2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.], [0., 0.]];
        let line = |p: &[f32; 2]| {
            let mut v = [0.0; 3];
            (v[axes[0]], v[axes[1]]) = (p[0], p[1]);
            format!("v {} {} {}\n", v[0], v[1], v[2])
        };
        let text = points.iter().map(line).collect::<String>() + "f 1 2 3 4 5 6\n";
        let scene = load(&format!("plane{}{}.obj", axes[0], axes[1]), text).unwrap();
        let mesh = &scene.meshes[0];
        let normal = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| mesh.positions()[i as usize]);
            (b - a).cross(c - a)
        };
        let first = normal(&mesh.triangles()[0]);
        assert!(mesh.triangles().iter().all(|t| normal(t).dot(first) > 0.0), "{axes:?}");
        let expected = if axes == [1, 0, 2] { -1.0 } else { 1.0 };
        assert_eq!(first[axes[2]].signum(), expected, "{axes:?}");
    }
}

#[test]
fn a_star_of_twenty_thousand_corners_is_no_wait() {
    let mut text = String::new();
    let n = 20_000;
    for i in 0..n {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(n);
        let radius = if i % 2 == 0 { 1.0 } else { 0.9 };
        text += &format!("v {:.9} {:.9} 0\n", libm::cos(angle) * radius, libm::sin(angle) * radius);
    }
    text += "f";
    (1..=n).for_each(|i| text += &format!(" {i}"));
    let scene = load("star.obj", text).unwrap();
    assert_eq!(scene.triangles(), n as u64 - 2);
    let expected = f64::from(n) * 0.5 * 0.9 * libm::sin(std::f64::consts::TAU / f64::from(n));
    assert!((f64::from(area(&scene)) - expected).abs() < 1e-2, "{} against {expected}", area(&scene));
}

#[test]
fn polygons_that_repeat_or_cross_or_lie_in_a_line_do_no_harm() {
    let scene = load("repeat.obj", format!("{TRIANGLE}v 1 1 0\nf 1 1 2 2 4 3 3 1\n")).unwrap();
    assert_eq!((scene.triangles(), area(&scene)), (2, 1.0));
    let scene = load("bow.obj", "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0.5\nf 1 2 3 4\n").unwrap();
    assert!(scene.triangles() <= 2);
    refused("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nf 1 2 3 4\n", None, "has no triangles");
}

#[test]
fn a_corner_in_the_middle_of_a_straight_edge_stays_a_corner() {
    let scene = load("straight.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4 5\n").unwrap();
    assert_eq!((scene.triangles(), area(&scene)), (3, 4.0));
    assert!(scene.meshes[0].triangles().iter().flatten().any(|&i| scene.meshes[0].positions()[i as usize] == Vec3::X));
}

#[test]
fn what_is_malformed_is_refused_with_its_line() {
    refused("nan.obj", "v 0 0 0\nv nan 0 0\n", Some(2), "finite");
    refused("inf.obj", "v 0 -inf 0\n", Some(1), "finite");
    refused("overflow.obj", "v 0 0 1e400\n", Some(1), "'1e400'");
    refused("word.obj", "# x\n\nv 0 zero 0\n", Some(3), "'zero' is not a number");
    refused("short.obj", "v 0 0\n", Some(1), "z is missing");
    refused("range.obj", &format!("{TRIANGLE}f 1 2 4\n"), Some(4), "index 4 is out of range: there are 3");
    refused("back.obj", &format!("{TRIANGLE}f 1 2 -4\n"), Some(4), "index -4 is out of range");
    refused("zero.obj", &format!("{TRIANGLE}f 0 1 2\n"), Some(4), "count from 1");
    refused("huge.obj", &format!("{TRIANGLE}f 1 2 99999999999999999999\n"), Some(4), "not a face vertex");
    refused("two.obj", &format!("{TRIANGLE}f 1 2\n"), Some(4), "at least 3");
    refused("slash.obj", &format!("{TRIANGLE}f 1/1/1/1 2 3\n"), Some(4), "1/1/1/1");
    refused("letters.obj", &format!("{TRIANGLE}\nf 1/a 2 3\n"), Some(5), "1/a");
    refused("joined.obj", &format!("{TRIANGLE}f 1 \\\n2 \\\nx\n"), Some(4), "'x'");
}

#[test]
fn what_is_no_model_is_refused() {
    refused("nothing.obj", "", None, "has no triangles");
    refused("vertices.obj", TRIANGLE, None, "has no triangles");
    refused("json.obj", "{\"keys\": []}\n", Some(1), "is not an OBJ");
    refused("binary.obj", "\n\u{0}\u{1}\u{2}\n", Some(2), "is not an OBJ");
    let missing = Path::new(env!("CARGO_TARGET_TMPDIR")).join("no such file.obj");
    assert!(matches!(load_obj(&missing), Err(Error::File { path, .. }) if path == missing));
    assert!(load("bytes.obj", [0xff, 0xfe, 0x00, 0x0a, 0x80]).is_err());
}

#[test]
fn materials_give_colour_and_part_an_object() {
    file(
        "m.mtl",
        "newmtl red\nKd 1 0 0.5 # bright\nnewmtl grey\nKd 0.5\nmap_Kd x.png\nnewmtl glass\nKd 0 0 1\nd 0.5\n\
                   newmtl cut\nmap_d leaf.png\nnewmtl thin\nTr 0.1\nnewmtl full\nTr 0\nd 1.0\nKd spectral f.rfl\n",
    );
    let mut text = format!("mtllib m.mtl\n{TRIANGLE}o a\n");
    for material in ["red", "grey", "glass", "cut", "thin", "full", "unknown", "red"] {
        text += &format!("usemtl {material}\nf 1 2 3\n");
    }
    let scene = load("m.obj", text).unwrap();
    assert_eq!(names(&scene), ["a/red", "a/grey", "a/glass", "a/cut", "a/thin", "a/full", "a/unknown"]);
    assert_eq!(scene.meshes[0].triangles().len(), 2);
    assert_eq!(scene.objects[0].color, [255, 0, 128]);
    assert_eq!(scene.objects[1].color, [128; 3]);
    let opaque: Vec<bool> = scene.objects.iter().map(|o| o.is_opaque()).collect();
    assert_eq!(opaque, [true, true, false, false, false, true, true]);
}

#[test]
fn a_material_library_may_be_missing_but_not_malformed() {
    let text = format!("mtllib nowhere.mtl\n{TRIANGLE}usemtl x\nf 1 2 3\n");
    assert_eq!(load("missing.obj", text).unwrap().triangles(), 1);
    for (body, line) in
        [("newmtl a\nKd 1 0\n", 2), ("newmtl a\n\nd glassy\n", 3), ("newmtl\n", 1), ("newmtl a\nKd nan 0 0\n", 2)]
    {
        file("bad.mtl", body);
        match load("bad.obj", format!("mtllib bad.mtl\n{TRIANGLE}f 1 2 3\n")) {
            Err(Error::Format { path, line: at, .. }) => {
                assert!(path.ends_with("bad.mtl"));
                assert_eq!(at, Some(line), "{body:?}");
            }
            other => panic!("{body:?} gave {other:?}"),
        }
    }
}

#[test]
fn our_own_rooms_load_with_their_materials() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    let room = load_obj(&data.join("room.obj")).unwrap();
    assert_eq!((room.objects.len(), room.triangles()), (23, 1640));
    assert_eq!(room.objects.iter().filter(|o| !o.is_opaque()).map(|o| o.name.as_str()).collect::<Vec<_>>(), ["window"]);
    let corridor = load_obj(&data.join("corridor.obj")).unwrap();
    assert_eq!((corridor.objects.len(), corridor.triangles()), (55, 4040));
}

#[test]
fn real_models_have_the_objects_and_triangles_that_they_should() {
    let folder = std::env::var_os("HOMCULL_MODELS").map_or_else(|| PathBuf::from("../shared"), PathBuf::from);
    for (name, objects, triangles) in [("oa_thor", 2276, 57_530), ("denhaag_01", 1991, 41_183)] {
        let path = folder.join("data").join(format!("{name}.obj"));
        if !path.is_file() {
            eprintln!("SKIPPED: {} is not there (set HOMCULL_MODELS)", path.display());
            continue;
        }
        let scene = load_obj(&path).unwrap();
        assert_eq!((scene.objects.len(), scene.triangles()), (objects, triangles), "{name}");
    }
}
