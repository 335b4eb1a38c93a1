//! Statements about the generated power plant: its size, its solids, its walk, and that every method draws it alike.
#![cfg(feature = "cli")]

use std::collections::{BTreeMap, BTreeSet};
use std::sync::LazyLock;

use glam::DVec3;
use homcull::cull::Method;
use homcull::geometry::Aabb;
use homcull::measure::walk::{WalkOptions, walk};
use homcull::scene::{Facing, Generated, Mesh, PreparedScene, Scene, parse};
use homcull::view::{View, Viewport};
use homcull::workers::Workers;
use homcull_simd::Level;

/// The default plant; it is a list of instances, and takes no longer to make than a small scene.
static FULL: LazyLock<Generated> = LazyLock::new(|| parse("plant").unwrap());

fn triangles(scene: &Scene, mesh: u32) -> u64 {
    scene.meshes[mesh as usize].triangles().len() as u64
}

/// The triangles of a mesh by connected surface.
fn surfaces(mesh: &Mesh) -> Vec<Vec<[u32; 3]>> {
    // Each vertex points towards the first of its surface.
    let mut first: Vec<usize> = (0..mesh.positions().len()).collect();
    let root = |first: &[usize], mut v: usize| {
        while first[v] != v {
            v = first[v];
        }
        v
    };
    for t in mesh.triangles() {
        let roots = t.map(|v| root(&first, v as usize));
        let least = *roots.iter().min().unwrap();
        roots.iter().chain(t.map(|v| v as usize).iter()).for_each(|&v| first[v] = least);
    }
    let mut surfaces: BTreeMap<usize, Vec<[u32; 3]>> = BTreeMap::new();
    mesh.triangles().iter().for_each(|&t| surfaces.entry(root(&first, t[0] as usize)).or_default().push(t));
    surfaces.into_values().collect()
}

#[test]
fn the_default_plant_has_as_many_triangles_as_uncs() {
    let scene = &FULL.scene;
    assert_eq!((scene.name.as_str(), scene.triangles()), ("plant", 12_748_510));
    assert!((10_000..=40_000).contains(&scene.objects.len()), "{} objects", scene.objects.len());
    let largest = scene.objects.iter().map(|o| triangles(scene, o.mesh)).max().unwrap();
    assert!(largest <= 8000, "the thesis cut objects of more than 8,000 triangles, one has {largest}");
    let stored: u64 = (0..scene.meshes.len() as u32).map(|mesh| triangles(scene, mesh)).sum();
    assert!(stored < 400_000, "{stored} triangles are stored, and placed many times");
}

#[test]
fn about_half_of_its_triangles_are_piping() {
    let scene = &FULL.scene;
    let mut kinds: BTreeMap<&str, u64> = BTreeMap::new();
    for object in &scene.objects {
        let kind = object.name.split('/').next_back().unwrap().trim_end_matches(|c: char| c.is_ascii_digit());
        *kinds.entry(kind.trim_end_matches('_')).or_default() += triangles(scene, object.mesh);
    }
    let piping = [
        "pipe",
        "bend",
        "valve",
        "wheel",
        "riser",
        "riser_bend",
        "riser_valve",
        "hanger",
        "rack",
        "header",
        "downcomer",
    ];
    let share = piping.iter().map(|kind| kinds[kind]).sum::<u64>() as f64 / scene.triangles() as f64;
    assert!((0.45..0.6).contains(&share), "{share} of the triangles are piping: {kinds:?}");
    for kind in ["column", "girder", "grating", "rail", "stairs", "casing", "flue", "stack", "pump", "wall", "turbine"]
    {
        assert!(kinds.contains_key(kind), "no {kind} in {kinds:?}");
    }
}

#[test]
fn its_solids_are_closed_and_face_outward() {
    for generated in [&*FULL, &parse("plant:triangles=100000").unwrap()] {
        let scene = &generated.scene;
        let mut seen = BTreeSet::new();
        for object in &scene.objects {
            assert_eq!((object.facing, object.is_opaque()), (Facing::Front, true));
            assert!(object.rotation.determinant() > 0.0, "{} is mirrored", object.name);
            if object.name == "vent" || !seen.insert(object.mesh) {
                continue;
            }
            let mesh = &scene.meshes[object.mesh as usize];
            let corner = |t: &[u32; 3]| t.map(|i| mesh.positions()[i as usize].as_dvec3());
            for surface in surfaces(mesh) {
                let about = corner(&surface[0])[0];
                let volume = |t: &[u32; 3]| {
                    let [a, b, c] = corner(t).map(|p| p - about);
                    a.cross(b).dot(c)
                };
                assert!(surface.iter().map(volume).sum::<f64>() > 0.0, "{} is inside out", object.name);
            }
            let sides = |&[a, b, c]: &[u32; 3]| [(a, b), (b, c), (c, a)];
            let mut edges: Vec<(u32, u32)> = mesh.triangles().iter().flat_map(sides).collect();
            let mut turned: Vec<(u32, u32)> = edges.iter().map(|&(a, b)| (b, a)).collect();
            edges.sort_unstable();
            turned.sort_unstable();
            assert_eq!(edges, turned, "{} is not closed", object.name);
        }
        let names: BTreeSet<&str> = scene.objects.iter().map(|o| o.name.as_str()).collect();
        assert_eq!(names.len(), scene.objects.len(), "names are unique");
    }
}

#[test]
fn a_seed_and_a_size_give_one_plant() {
    let text = "plant:seed=3,triangles=300000";
    assert_eq!(parse(text).unwrap(), parse(text).unwrap());
    assert_ne!(parse(text).unwrap().scene, parse("plant:seed=4,triangles=300000").unwrap().scene);
    for (target, expected) in [(2, 2), (100_000, 100_000), (1_000_001, 1_000_000), (30_000_000, 30_000_000)] {
        assert_eq!(parse(&format!("plant:triangles={target}")).unwrap().scene.triangles(), expected);
    }
}

#[test]
fn what_makes_up_the_number_is_small() {
    for generated in [&*FULL, &parse("plant:triangles=100000").unwrap(), &parse("plant:triangles=1000000").unwrap()] {
        let scene = &generated.scene;
        let last = scene.objects.last().unwrap();
        assert!(last.name != "vent" || triangles(scene, last.mesh) < 200, "{}", triangles(scene, last.mesh));
    }
}

#[test]
fn the_walk_meets_nothing_and_stays_on_one_floor() {
    for text in [
        "plant",
        "plant:triangles=100000",
        "plant:seed=9,triangles=700000",
        "plant:seed=2,triangles=4000000",
        "plant:seed=5,triangles=1500000",
    ] {
        let generated = if text == "plant" { FULL.clone() } else { parse(text).unwrap() };
        let scene = &generated.scene;
        let boxes: Vec<Aabb> = scene.objects.iter().map(|o| scene.object_bounds(o, DVec3::ZERO)).collect();
        let frames = generated.path.sample(generated.frames).unwrap();
        for (frame, camera) in frames.iter().enumerate() {
            let eye = camera.eye.as_vec3();
            let meets = boxes.iter().position(|b| b.distance_squared(eye) < 0.25);
            assert!(meets.is_none(), "{text}: frame {frame} at {eye} meets {}", scene.objects[meets.unwrap()].name);
            assert!((camera.eye.y - frames[0].eye.y).abs() < 1e-9, "{text}: frame {frame} leaves the floor");
            let below = boxes.iter().zip(&scene.objects).any(|(b, object)| {
                let within = b.min.x < eye.x && eye.x < b.max.x && b.min.z < eye.z && eye.z < b.max.z;
                let walked = ["grating", "plate", "transfer_tower"].iter().any(|kind| object.name.contains(kind));
                within && walked && (b.max.y - (eye.y - 1.7)).abs() < 0.1
            });
            assert!(below, "{text}: frame {frame} at {eye} stands on nothing");
        }
    }
}

#[test]
fn the_walk_is_inside_for_the_most_part_and_turns() {
    let generated = &*FULL;
    let frames = generated.path.sample(generated.frames).unwrap();
    let columns = generated.scene.objects.iter().filter(|o| o.name.contains("/column_")).map(|o| o.position);
    let (low, high) = columns.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)));
    let inside = frames.iter().filter(|c| c.eye.cmpgt(low).all() && c.eye.cmplt(high).all()).count();
    assert!(inside * 2 > frames.len(), "{inside} of {} frames are inside", frames.len());
    assert!((0.35..0.7).contains(&(frames[0].eye.y / high.y)), "half of the way up");
    // The walls' directions that the eye looks along, one after the other.
    let looks = frames.iter().map(|c| (c.target - c.eye).normalize());
    let mut ways: Vec<DVec3> = looks.map(DVec3::round).filter(|way| way.length() == 1.0).collect();
    ways.dedup();
    assert!(ways.len() >= 4, "into the house, along the boiler, behind it, out: {ways:?}");
    let last = frames.last().unwrap();
    assert!((last.target - last.eye).normalize().x > 0.8 && last.eye.x > high.x, "outward at the end");
}

#[test]
fn every_method_draws_the_same_plant() {
    let generated = parse("plant:triangles=1000000").unwrap();
    let scene = PreparedScene::new(&generated.scene).unwrap();
    let viewport = Viewport::new(320, 256).unwrap();
    let cameras = generated.path.sample(6).unwrap();
    let views: Vec<View> = cameras.iter().map(|camera| camera.view(viewport).unwrap()).collect();
    let names = ["vfc", "hom", "hom-multipass", "hom-progressive", "ideal"];
    let methods: Vec<Method> = names.iter().map(|name| Method::parse(name).unwrap()).collect();
    let workers = Workers::new(1).unwrap();
    let options = WalkOptions { level: Level::best(), workers: &workers, repetitions: 1, exact: true };
    let report = walk("plant", &scene, &views, &methods, &options, |_| Ok(())).unwrap();
    for run in &report.runs {
        assert_eq!(run.wrongly_culled_objects(), Some(0), "{}", run.method);
        assert_eq!(run.image_hash, report.runs[0].image_hash, "{}", run.method);
    }
    let drawn: Vec<f64> = report.runs.iter().map(|run| run.mean(report.pixels()).triangles_drawn).collect();
    assert!(drawn[3] < drawn[0] * 0.6, "there is much to cull: {drawn:?}");
}
