//! Statements about scenes: benchmark files, subdivision, generators, camera paths, scene arguments.
#![cfg(feature = "cli")]

use std::path::{Path, PathBuf};

use glam::{DVec3, Mat3, Vec3};
use homcull::Error;
use homcull::geometry::Aabb;
use homcull::scene::{
    Facing, Generated, Mesh, Object, Scene, SceneSource, Subdivision, Views, generators, load, load_benchmark,
    load_reference, parse, subdivide,
};
use homcull::view::{CameraPath, PathKey, load_path, load_path_file};

/// A fresh folder of the tests' own.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("scene").join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[track_caller]
fn fails_with(result: Result<impl std::fmt::Debug, Error>, words: &[&str]) {
    let text = result.expect_err("should be refused").to_string();
    assert!(words.iter().all(|w| text.contains(w)), "'{text}' does not say all of {words:?}");
}

/// A scene file of one triangle, and a views file of one view.
fn tiny_benchmark() -> (Vec<u8>, Vec<u8>) {
    let mut scene: Vec<u8> = [1u32, 3, 1].iter().flat_map(|n| n.to_le_bytes()).collect();
    scene.extend([0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|n| n.to_le_bytes()));
    scene.extend([0u32, 1, 2].iter().flat_map(|n| n.to_le_bytes()));
    scene.extend([0.0f32, 0.0, 0.0, 1.0, 1.0, 0.0].iter().flat_map(|n| n.to_le_bytes()));
    let mut views: Vec<u8> = [1u32, 1920, 1080].iter().flat_map(|n| n.to_le_bytes()).collect();
    views.extend((0..16).flat_map(|n| (n as f32).to_le_bytes()));
    (scene, views)
}

fn benchmark(name: &str, scene: &[u8], views: &[u8]) -> PathBuf {
    let folder = folder(name);
    std::fs::write(folder.join("scene.bin"), scene).unwrap();
    std::fs::write(folder.join("views.bin"), views).unwrap();
    folder
}

#[test]
fn a_benchmark_folder_gives_objects_and_matrices() {
    let (scene, views) = tiny_benchmark();
    let loaded = load_benchmark(&benchmark("tiny", &scene, &views)).unwrap();
    assert_eq!((loaded.width, loaded.height, loaded.views.len()), (1920, 1080, 1));
    assert_eq!(loaded.views[0][5], 5.0);
    let object = &loaded.scene.objects[0];
    assert_eq!((object.name.as_str(), object.facing, object.is_opaque()), ("object_00000", Facing::Front, true));
    assert_eq!(loaded.scene.meshes[0].bounds(), Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, 1.0, 0.0) });
}

#[test]
fn a_benchmark_cut_anywhere_is_refused_and_names_the_file() {
    let (scene, views) = tiny_benchmark();
    for end in 0..scene.len() {
        fails_with(load_benchmark(&benchmark("cut", &scene[..end], &views)), &["scene.bin"]);
    }
    for end in 0..views.len() {
        fails_with(load_benchmark(&benchmark("cut", &scene, &views[..end])), &["views.bin"]);
    }
    fails_with(load_benchmark(&folder("none")), &["scene.bin"]);
}

#[test]
fn a_damaged_benchmark_is_refused_with_what_is_wrong() {
    let (scene, views) = tiny_benchmark();
    let damaged = |at: usize, bytes: [u8; 4]| {
        let mut scene = scene.clone();
        scene[at..at + 4].copy_from_slice(&bytes);
        load_benchmark(&benchmark("damaged", &scene, &views))
    };
    fails_with(damaged(0, u32::MAX.to_le_bytes()), &["scene.bin", "4294967295 objects"]);
    fails_with(damaged(4, u32::MAX.to_le_bytes()), &["scene.bin", "object_00000"]);
    fails_with(damaged(8, u32::MAX.to_le_bytes()), &["scene.bin", "object_00000"]);
    fails_with(damaged(12, f32::NAN.to_le_bytes()), &["scene.bin", "object_00000", "vertex 0"]);
    fails_with(damaged(48, 3u32.to_le_bytes()), &["scene.bin", "object_00000", "3 vertices"]);
    fails_with(damaged(60, f32::INFINITY.to_le_bytes()), &["scene.bin", "object_00000", "box"]);
    let long = [scene.as_slice(), &[0]].concat();
    fails_with(load_benchmark(&benchmark("long", &long, &views)), &["scene.bin", "1 bytes too many"]);
    let mut bad = views.clone();
    bad[4..8].copy_from_slice(&0u32.to_le_bytes());
    fails_with(load_benchmark(&benchmark("size", &scene, &bad)), &["views.bin", "0x1080"]);
    let mut bad = views.clone();
    bad[20..24].copy_from_slice(&f32::NAN.to_le_bytes());
    fails_with(load_benchmark(&benchmark("matrix", &scene, &bad)), &["views.bin", "view 0", "not finite"]);
}

#[test]
fn a_reference_answers_by_view_and_object() {
    let folder = folder("reference");
    let words = [2u32, 2, 1, 2, 3, 4, 10, 20, 30, 40];
    let mut bytes: Vec<u8> = words.iter().flat_map(|n| n.to_le_bytes()).collect();
    bytes.extend([0, 1, 3, 7]);
    std::fs::write(folder.join("ref_8x4.bin"), &bytes).unwrap();
    let reference = load_reference(&folder, 8, 4, 2, 2).unwrap().unwrap();
    let answer = reference.answer(1, 0).unwrap();
    assert_eq!((answer.visible_pixels, answer.covered_pixels), (3, 30));
    assert_eq!((answer.in_frustum, answer.hidden_by_rectangle, answer.hidden_by_box), (true, true, false));
    assert_eq!((reference.answer(2, 0), reference.answer(0, 2)), (None, None));
    assert_eq!(load_reference(&folder, 8, 5, 2, 2).unwrap(), None);
    fails_with(load_reference(&folder, 8, 4, 3, 2), &["ref_8x4.bin", "2 views of 2 objects"]);
    std::fs::write(folder.join("ref_8x4.bin"), &bytes[..bytes.len() - 1]).unwrap();
    fails_with(load_reference(&folder, 8, 4, 2, 2), &["ref_8x4.bin", "36 bytes, not 35"]);
}

#[test]
fn the_brought_scenes_load_whole() {
    let shared = std::env::var_os("HOMCULL_MODELS").map_or_else(|| PathBuf::from("../shared"), PathBuf::from);
    for (name, objects, triangles, views) in [("city", 10_000, 312_254, 60), ("sponza", 1994, 262_267, 30)] {
        let folder = shared.join("scenes").join(name);
        if !folder.is_dir() {
            eprintln!("SKIPPED: {} is not there (set HOMCULL_MODELS)", folder.display());
            continue;
        }
        let loaded = load_benchmark(&folder).unwrap();
        let counts = (loaded.scene.objects.len(), loaded.scene.triangles(), loaded.views.len());
        assert_eq!(counts, (objects, triangles, views), "{name}");
        let reference = load_reference(&folder, 512, 256, objects, views).unwrap().unwrap();
        assert!((0..views).any(|v| (0..objects).any(|o| reference.answer(v, o).unwrap().visible_pixels > 0)));
    }
}

// ---- subdivision

/// A scene of one object: a triangle of side 0.1 at every point.
fn soup(points: &[Vec3]) -> Scene {
    let positions = points.iter().flat_map(|&p| [p, p + Vec3::X * 0.1, p + Vec3::Y * 0.1]).collect();
    let triangles = (0..points.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = Mesh::new("soup", positions, triangles).unwrap();
    let object = Object {
        name: "soup".into(),
        mesh: 0,
        rotation: Mat3::IDENTITY,
        position: DVec3::ZERO,
        facing: Facing::Both,
        color: [1, 2, 3],
        opacity: 0.25,
    };
    Scene { name: "test".into(), meshes: vec![mesh], objects: vec![object], ..Scene::default() }
}

fn grid_points(n: i32) -> Vec<Vec3> {
    (0..n * n * n).map(|k| Vec3::new((k % n) as f32, (k / n % n) as f32, (k / n / n) as f32)).collect()
}

/// Every triangle of a scene as bits, sorted.
fn all_triangles(scene: &Scene) -> Vec<[[u32; 3]; 3]> {
    let mut all: Vec<_> = scene
        .objects
        .iter()
        .map(|o| &scene.meshes[o.mesh as usize])
        .flat_map(|m| m.triangles().iter().map(|t| t.map(|i| m.positions()[i as usize].to_array().map(f32::to_bits))))
        .collect();
    all.sort();
    all
}

#[test]
fn subdivision_loses_no_triangle_and_keeps_parts_small_and_compact() {
    let whole = soup(&grid_points(20));
    let limits = Subdivision { max_triangles: 200, max_depth: 16 };
    let split = subdivide(whole.clone(), &limits);
    assert_eq!(all_triangles(&split), all_triangles(&whole));
    assert!(split.objects.len() > 40);
    for (k, object) in split.objects.iter().enumerate() {
        let mesh = &split.meshes[object.mesh as usize];
        assert_eq!(object.name, format!("soup#{k}"));
        assert!(mesh.triangles().len() <= 200 && !mesh.triangles().is_empty());
        assert_eq!(mesh.positions().len(), mesh.triangles().len() * 3);
        assert!(mesh.bounds().size().max_element() <= 5.2, "{:?}", mesh.bounds());
        assert_eq!((object.color, object.opacity), ([1, 2, 3], 0.25));
    }
}

#[test]
fn small_objects_are_left_alone() {
    let whole = soup(&grid_points(3));
    assert_eq!(subdivide(whole.clone(), &Subdivision::default()), whole);
}

#[test]
fn instances_share_the_parts_of_their_mesh() {
    let mut scene = soup(&grid_points(4));
    scene.objects.push(Object { name: "other".into(), position: DVec3::X * 9.0, ..scene.objects[0].clone() });
    let split = subdivide(scene, &Subdivision { max_triangles: 8, max_depth: 16 });
    assert_eq!(split.objects.len(), split.meshes.len() * 2);
    assert_eq!(split.objects[split.meshes.len()].name, "other#0");
    assert_eq!(split.objects[split.meshes.len()].mesh, 0);
}

#[test]
fn triangles_in_one_place_stay_together() {
    let split = subdivide(soup(&[Vec3::ONE; 100]), &Subdivision { max_triangles: 10, max_depth: 1000 });
    assert_eq!((split.objects.len(), split.triangles(), split.objects[0].name.as_str()), (1, 100, "soup"));
    // All but one in one place, and places at distances that halve: depth ends it.
    let mut points = vec![Vec3::ZERO; 50];
    points.push(Vec3::splat(1e30));
    points.extend((0..60).map(|k| Vec3::X * f32::powi(0.5, k)));
    let split = subdivide(soup(&points), &Subdivision { max_triangles: 0, max_depth: 200 });
    assert_eq!(split.triangles(), 111);
    let split = subdivide(soup(&points), &Subdivision { max_triangles: 1, max_depth: 3 });
    assert_eq!(split.triangles(), 111);
}

#[test]
fn a_long_object_is_cut_into_cubes() {
    let row: Vec<Vec3> = (0..800).map(|k| Vec3::new(k as f32 * 0.1, 0.0, (k % 10) as f32)).collect();
    let split = subdivide(soup(&row), &Subdivision { max_triangles: 100, max_depth: 16 });
    assert_eq!(split.objects.len(), 8, "an 80 x 10 strip gives eight squares");
}

// ---- the hierarchy

/// FNV-1a over every object's name, position, vertices and indices.
fn hash(generated: &Generated) -> u64 {
    let mut state = 0xcbf2_9ce4_8422_2325u64;
    let mut eat =
        |bytes: &[u8]| bytes.iter().for_each(|&b| state = (state ^ u64::from(b)).wrapping_mul(0x100_0000_01b3));
    for object in &generated.scene.objects {
        let mesh = &generated.scene.meshes[object.mesh as usize];
        eat(object.name.as_bytes());
        eat(&object.color);
        object.position.to_array().iter().for_each(|c| eat(&c.to_bits().to_le_bytes()));
        mesh.positions().iter().flat_map(|p| p.to_array()).for_each(|c| eat(&c.to_bits().to_le_bytes()));
        mesh.triangles().iter().flatten().for_each(|i| eat(&i.to_le_bytes()));
    }
    for key in &generated.path.keys {
        [key.eye, key.target].iter().flat_map(|p| p.to_array()).for_each(|c| eat(&c.to_bits().to_le_bytes()));
    }
    state
}

#[test]
fn default_scenes_are_the_same_on_every_machine() {
    for (name, triangles, golden) in [("city", 312_524, CITY), ("terrain", 200_000, TERRAIN)] {
        let generated = parse(name).unwrap();
        assert_eq!(generated.scene.triangles(), triangles, "{name}");
        assert_eq!(generated.scene.name, name);
        assert_eq!(hash(&generated), golden, "{name}: {:#x}", hash(&generated));
    }
}

#[test]
fn an_even_number_of_triangles_is_met_and_an_odd_one_but_for_one() {
    for (target, expected) in [(100_000, 100_000), (100_001, 100_000), (250_018, 250_018), (1_000_000, 1_000_000)] {
        for seed in [0, 7, u64::MAX] {
            for generator in generators() {
                let text = format!("{}:seed={seed},triangles={target}", generator.name);
                let triangles = parse(&text).unwrap().scene.triangles();
                if generator.name == "teapots" {
                    assert_eq!(triangles, expected / 2304 * 2304, "{text}: whole teapots");
                } else {
                    assert_eq!(triangles, expected, "{text}");
                }
            }
        }
    }
    assert_eq!(parse("city:triangles=2").unwrap().scene.triangles(), 2);
}

#[test]
fn the_last_object_is_small() {
    for generated in [parse("city").unwrap(), parse("terrain").unwrap(), parse("city:seed=9,triangles=400000").unwrap()]
    {
        let last = generated.scene.objects.last().unwrap();
        assert!(last.name != "monument" || generated.scene.meshes[last.mesh as usize].triangles().len() < 100);
    }
}

#[test]
fn a_generated_scene_is_split_on_demand_and_keeps_its_triangles_and_walk() {
    let (whole, parts) = (parse("plant:triangles=60000").unwrap(), parse("plant:triangles=60000,split=50").unwrap());
    let largest =
        |scene: &Scene| scene.objects.iter().map(|o| scene.meshes[o.mesh as usize].triangles().len()).max().unwrap();
    assert!(largest(&whole.scene) > 50 && largest(&parts.scene) <= 50);
    assert_eq!(all_triangles(&whole.scene).len(), all_triangles(&parts.scene).len());
    assert_eq!((whole.path, whole.scene.name), (parts.path, parts.scene.name));
    fails_with(parse("plant:split=0"), &["split", "0"]);
}

#[test]
fn seeds_give_different_cities() {
    assert_ne!(hash(&parse("city:seed=1").unwrap()), hash(&parse("city:seed=2").unwrap()));
    assert_eq!(hash(&parse("city:seed=1").unwrap()), hash(&parse("city").unwrap()));
}

#[test]
fn a_city_is_thousands_of_objects_of_closed_outward_solids() {
    let generated = parse("city").unwrap();
    let scene = &generated.scene;
    assert!(scene.objects.len() > 3000, "{}", scene.objects.len());
    for object in &scene.objects {
        let mesh = &scene.meshes[object.mesh as usize];
        assert_eq!(object.facing, Facing::Front);
        assert!(mesh.triangles().len() <= 400, "{}: {}", object.name, mesh.triangles().len());
        let flat = ["road", "stripes", "outskirts"].iter().any(|kind| object.name.contains(kind));
        let corner = |t: &[u32; 3]| t.map(|i| mesh.positions()[i as usize].as_dvec3());
        if flat || object.name == "monument" {
            assert!(mesh.triangles().iter().map(corner).all(|[a, b, c]| (b - a).cross(c - a).y > 0.0 || !flat));
            continue;
        }
        let volume: f64 = mesh.triangles().iter().map(corner).map(|[a, b, c]| a.cross(b).dot(c)).sum();
        assert!(volume > 0.0, "{} is inside out", object.name);
        let mut edges: Vec<(u32, u32)> =
            mesh.triangles().iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
        let mut turned: Vec<(u32, u32)> = edges.iter().map(|&(a, b)| (b, a)).collect();
        edges.sort_unstable();
        turned.sort_unstable();
        assert_eq!(edges, turned, "{} is not closed", object.name);
    }
    let names: std::collections::BTreeSet<&str> = scene.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names.len(), scene.objects.len(), "names are unique");
}

#[test]
fn walks_meet_no_object() {
    for text in ["city", "city:seed=5,triangles=150000", "terrain"] {
        let generated = parse(text).unwrap();
        let scene = &generated.scene;
        let boxes: Vec<Aabb> = scene.objects.iter().map(|o| scene.object_bounds(o, DVec3::ZERO)).collect();
        for (frame, camera) in generated.path.sample(generated.frames).unwrap().iter().enumerate() {
            let eye = camera.eye.as_vec3();
            if let Some(hit) = boxes.iter().position(|b| b.distance_squared(eye) < 0.25) {
                panic!("{text}: frame {frame} at {eye} meets {}", scene.objects[hit].name);
            }
        }
    }
}

#[test]
fn the_city_walk_has_streets_roofs_and_an_outward_look() {
    let generated = parse("city").unwrap();
    let frames = generated.path.sample(generated.frames).unwrap();
    let top = generated.scene.objects.iter().map(|o| generated.scene.object_bounds(o, DVec3::ZERO).max.y);
    let top = f64::from(top.fold(0.0, f32::max));
    assert!(frames.iter().filter(|c| c.eye.y < 2.0).count() > generated.frames / 2);
    assert!(frames.iter().filter(|c| c.eye.y > top).count() > generated.frames / 20);
    let last = frames.last().unwrap();
    assert!((last.target - last.eye).normalize().dot(last.eye.normalize()) > 0.7, "outward at the end");
}

#[test]
fn generators_name_what_they_do_not_know() {
    fails_with(parse("town"), &["town", "city", "terrain"]);
    fails_with(parse("city:sead=1"), &["sead", "seed", "triangles"]);
    fails_with(parse("city:triangles=many"), &["triangles", "many"]);
    fails_with(parse("city:triangles=0"), &["triangles", "0"]);
    fails_with(parse("city:seed=-1"), &["seed", "-1"]);
    fails_with(parse("terrain:seed"), &["seed"]);
    assert!(generators().iter().all(|g| !g.about.is_empty() && g.triangles > 0));
}

// ---- camera paths

fn path(keys: &[([f64; 3], [f64; 3])]) -> CameraPath {
    let keys = keys.iter().map(|&(eye, target)| PathKey { eye: eye.into(), target: target.into() }).collect();
    CameraPath { fov_y_deg: 60.0, near: 0.1, far: None, up: DVec3::Y, keys }
}

fn directions(path: &CameraPath, frames: usize) -> Vec<DVec3> {
    path.sample(frames).unwrap().iter().map(|c| c.target - c.eye).collect()
}

#[test]
fn frames_are_even_in_key_index_with_both_ends() {
    let path = path(&[
        ([0.0, 0.0, 0.0], [0.0, 0.0, -9.0]),
        ([4.0, 0.0, 0.0], [4.0, 0.0, -1.0]),
        ([4.0, 2.0, 0.0], [4.0, 2.0, -1.0]),
    ]);
    let eyes: Vec<DVec3> = path.sample(5).unwrap().iter().map(|c| c.eye).collect();
    let expected = [[0.0, 0.0], [2.0, 0.0], [4.0, 0.0], [4.0, 1.0], [4.0, 2.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
    assert_eq!(eyes, expected);
    assert_eq!(path.sample(1).unwrap()[0].eye, DVec3::ZERO);
    assert_eq!(path.sample(1).unwrap()[0].target, DVec3::NEG_Z);
    fails_with(path.sample(0), &["frames"]);
}

#[test]
fn directions_turn_evenly_on_the_sphere() {
    let turn = path(&[([0.0; 3], [3.0, 0.0, 0.0]), ([0.0; 3], [0.0, 0.0, 1.0])]);
    for (k, d) in directions(&turn, 4).iter().enumerate() {
        let angle = (30.0 * k as f64).to_radians();
        assert!((*d - DVec3::new(libm::cos(angle), 0.0, libm::sin(angle))).length() < 1e-12, "{d}");
    }
}

#[test]
fn opposite_directions_turn_about_up() {
    for wobble in [0.0, 1e-9, 9e-7] {
        let turn = path(&[([0.0; 3], [1.0, 0.0, 0.0]), ([0.0; 3], [-1.0, wobble, 0.0])]);
        let d = directions(&turn, 3);
        assert!((d[1] - DVec3::NEG_Z).length() < 2e-6, "{wobble}: {}", d[1]);
        assert!((d[2] - DVec3::new(-1.0, wobble, 0.0).normalize()).length() < 1e-12);
    }
    // Tilted: half way it has turned about the axis nearest to up, and it ends where it should.
    let d = directions(&path(&[([0.0; 3], [1.0, 0.5, 0.0]), ([0.0; 3], [-1.0, -0.5, 0.0])]), 3);
    assert!((d[1] - DVec3::NEG_Z).length() < 1e-9, "{}", d[1]);
    // Beyond the limit the great circle is taken, here over the top.
    let over = path(&[([0.0; 3], [1.0, 0.0, 0.1]), ([0.0; 3], [-1.0, 1e-3, -0.1])]);
    assert!(directions(&over, 3)[1].y > 0.99);
}

#[test]
fn what_cannot_be_walked_is_refused() {
    fails_with(path(&[]).sample(3), &["no keys"]);
    fails_with(path(&[([0.0; 3], [0.0; 3])]).sample(3), &["key 0", "target is the eye"]);
    fails_with(
        path(&[([0.0; 3], [1.0, 0.0, 0.0]), ([0.0; 3], [0.0, -4.0, 0.0])]).sample(3),
        &["key 1", "up is parallel"],
    );
    fails_with(path(&[([f64::NAN, 0.0, 0.0], [1.0; 3])]).sample(3), &["key 0", "finite"]);
    let good = path(&[([0.0; 3], [1.0, 0.0, 0.0])]);
    fails_with(CameraPath { up: DVec3::ZERO, ..good.clone() }.sample(1), &["up"]);
    fails_with(CameraPath { near: 0.0, ..good.clone() }.sample(1), &["near"]);
    fails_with(CameraPath { far: Some(0.05), ..good.clone() }.sample(1), &["far"]);
    fails_with(CameraPath { fov_y_deg: 180.0, ..good }.sample(1), &["fov_y_deg"]);
    let pole = path(&[([0.0; 3], [1.0, 1.0, 0.0]), ([0.0; 3], [-1.0, 1.0, 0.0])]);
    fails_with(pole.sample(3), &["frame 1", "up is parallel"]);
}

#[test]
fn an_orbit_is_outside_and_sees_the_middle() {
    let cube = |middle: Vec3, r: f32| Aabb { min: middle - r, max: middle + r };
    for bounds in [cube(Vec3::new(5.0, 1.0, -3.0), 2.0), cube(Vec3::ZERO, 0.0), Aabb::EMPTY, cube(Vec3::ZERO, 1e30)] {
        let path = CameraPath::orbit(bounds);
        for camera in path.sample(50).unwrap() {
            assert!(bounds.is_empty() || bounds.distance_squared(camera.eye.as_vec3()) > 0.0);
        }
        assert_eq!(path.keys.first(), path.keys.last());
    }
}

fn path_file(name: &str, text: &str) -> PathBuf {
    let file = folder("paths").join(name);
    std::fs::write(&file, text).unwrap();
    file
}

#[test]
fn a_path_file_may_leave_out_far_and_have_more_fields() {
    let text = r#"{"fov_y_deg": 50, "near": 0.2, "up": [0, 1, 0], "author": "me",
                   "keys": [{"eye": [1, 2, 3], "target": [4, 2, 3], "note": 1}]}"#;
    let path = load_path(&path_file("good.json", text)).unwrap();
    assert_eq!((path.fov_y_deg, path.near, path.far, path.keys[0].eye), (50.0, 0.2, None, DVec3::new(1.0, 2.0, 3.0)));
    let text = text.replace("\"near\"", "\"far\": null, \"frames\": 77, \"near\"");
    assert_eq!(load_path_file(&path_file("frames.json", &text)).unwrap().frames, Some(77));
    let text = text.replace("null", "9.5");
    assert_eq!(load_path(&path_file("far.json", &text)).unwrap().far, Some(9.5));
}

#[test]
fn a_path_file_at_fault_is_named_with_the_key() {
    let key = r#"{"eye": [1, 2, 3], "target": [4, 2, 3]}"#;
    let with = |name: &str, keys: &str, rest: &str| {
        load_path(&path_file(name, &format!("{{\"keys\": [{keys}], \"near\": 1, \"fov_y_deg\": 60 {rest}}}")))
    };
    let up = ", \"up\": [0, 1, 0]";
    fails_with(with("a.json", key, ""), &["a.json", "'up' is missing"]);
    fails_with(with("b.json", r#"{"eye": [0, 0, 0]}"#, up), &["b.json", "'keys[0].target' is missing"]);
    fails_with(with("c.json", r#"{"eye": [0, 0], "target": [1, 1, 1]}"#, up), &["keys[0].eye", "three numbers"]);
    fails_with(with("d.json", "", up), &["d.json", "no keys"]);
    fails_with(with("e.json", key, ", \"up\": [0, \"x\", 0]"), &["'up'", "\"x\""]);
    fails_with(with("f.json", key, ", \"up\": [0, 1, 0], \"far\": \"wide\""), &["'far'", "wide"]);
    fails_with(with("g.json", key, ", \"up\": [3, 0, 0]"), &["key 0", "parallel"]);
    fails_with(with("h.json", key, ", \"up\": [0, 1, 0], \"frames\": 0"), &["'frames'"]);
    fails_with(load_path(&path_file("i.json", "{\n\"keys\": oops}")), &["i.json:2", "is not JSON"]);
    fails_with(load_path(&path_file("j.json", "[]")), &["j.json", "object"]);
    fails_with(load_path(&folder("paths").join("none.json")), &["none.json"]);
}

// ---- scene arguments

#[test]
fn a_scene_argument_is_a_file_a_generator_or_a_folder() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    let room = data.join("room.obj").display().to_string();
    assert!(matches!(SceneSource::resolve(&room), Ok(SceneSource::Obj(_))));
    assert!(matches!(SceneSource::resolve("city:seed=3"), Ok(SceneSource::Generator(_))));
    let (scene, views) = tiny_benchmark();
    let folder_path = benchmark("argument", &scene, &views).display().to_string();
    assert!(matches!(SceneSource::resolve(&folder_path), Ok(SceneSource::Benchmark(_))));
    assert!(matches!(load(&folder_path, None).unwrap().views, Views::Matrices { width: 1920, .. }));
    fails_with(SceneSource::resolve("atlantis"), &["scene", "atlantis", "city"]);
    fails_with(SceneSource::resolve(&folder("empty").display().to_string()), &["scene.bin"]);
    fails_with(load("nowhere.obj", None), &["nowhere.obj"]);
    fails_with(load("city:x=1", None), &["x"]);
}

#[test]
fn a_model_takes_the_path_beside_it_or_the_one_given_or_an_orbit() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    let room = data.join("room.obj").display().to_string();
    let Views::Path(beside, 120) = load(&room, None).unwrap().views else { panic!("room.path.json says 120 frames") };
    assert_eq!(beside.keys.len(), 6);
    let other = data.join("corridor.path.json");
    assert!(matches!(load(&room, Some(&other)).unwrap().views, Views::Path(p, 240) if p.keys.len() == 11));
    let alone = folder("alone").join("alone.obj");
    std::fs::write(&alone, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    assert!(
        matches!(load(&alone.display().to_string(), None).unwrap().views, Views::Path(p, 120) if p.keys.len() == 25)
    );
}

#[test]
fn soup_is_subdivided_on_loading() {
    let mut text = String::new();
    for p in grid_points(12) {
        text += &format!(
            "v {} {} {}\nv {} {} {}\nv {} {} {}\nf -3 -2 -1\n",
            p.x,
            p.y,
            p.z,
            p.x + 0.5,
            p.y,
            p.z,
            p.x,
            p.y + 0.5,
            p.z
        );
    }
    let file = folder("soup").join("soup.obj");
    std::fs::write(&file, text).unwrap();
    let scene = load(&file.display().to_string(), None).unwrap().scene;
    assert_eq!(scene.triangles(), 1728);
    assert_eq!((scene.objects.len(), scene.objects[7].name.as_str()), (8, "soup#7"));
}

const CITY: u64 = 0xb155_52b4_a2ec_b5ef;
const TERRAIN: u64 = 0x3ff8_1690_2faa_6bb1;
