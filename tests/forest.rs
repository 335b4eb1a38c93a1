//! Statements about the generated forest: its size, its leaves, its walk, and that every method draws it alike.
#![cfg(feature = "cli")]

use std::collections::BTreeSet;

use glam::{DVec2, DVec3, Vec3};
use homcull::cull::Method;
use homcull::measure::walk::{WalkOptions, walk};
use homcull::scene::{Facing, PreparedScene, Scene, parse};
use homcull::view::{View, Viewport};
use homcull::workers::Workers;
use homcull_simd::Level;

fn triangles(scene: &Scene, mesh: u32) -> usize {
    scene.meshes[mesh as usize].triangles().len()
}

#[test]
fn every_number_of_triangles_is_met_by_whole_plants() {
    for (target, expected) in [(2, 2), (1000, 1000), (100_000, 100_000), (777_777, 777_776), (20_000_000, 20_000_000)] {
        let scene = parse(&format!("forest:seed=3,triangles={target}")).unwrap().scene;
        assert_eq!(scene.triangles(), expected, "{target}");
        let last = scene.objects.last().unwrap();
        assert!(target < 100_000 || last.name != "ant_hill" || triangles(&scene, last.mesh) < 60);
        let names: BTreeSet<&str> = scene.objects.iter().map(|o| o.name.as_str()).collect();
        assert_eq!(names.len(), scene.objects.len(), "names are unique");
        let stored: usize = scene.meshes.iter().map(|mesh| mesh.triangles().len()).sum();
        assert!(target < 1_000_000 || stored < scene.triangles() as usize / 5, "plants are placed many times");
    }
    assert_eq!(parse("forest").unwrap().scene.triangles(), 3_000_000);
    assert_eq!(parse("forest:seed=4").unwrap(), parse("forest:seed=4").unwrap());
    assert_ne!(parse("forest:seed=4").unwrap().scene, parse("forest:seed=5").unwrap().scene);
}

#[test]
fn nearly_all_of_it_are_small_leaves_seen_from_both_sides() {
    let scene = parse("forest:triangles=1000000").unwrap().scene;
    let (mut leaves, mut largest) = (0, 0.0f32);
    for object in &scene.objects {
        assert!(object.is_opaque());
        if !object.name.contains("/leaves") {
            assert_eq!(object.facing, Facing::Front, "{}", object.name);
            continue;
        }
        assert_eq!(object.facing, Facing::Both, "{}", object.name);
        leaves += triangles(&scene, object.mesh);
        let mesh = &scene.meshes[object.mesh as usize];
        let size = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| mesh.positions()[i as usize]);
            a.distance(b).max(b.distance(c)).max(c.distance(a))
        };
        largest = mesh.triangles().iter().map(size).fold(largest, f32::max);
    }
    assert!(leaves > 850_000, "{leaves} triangles of leaves");
    assert!(largest < 1.0, "a leaf of {largest} m");
}

#[test]
fn the_walk_winds_between_trunks_and_through_no_leaf() {
    for text in ["forest", "forest:triangles=100000", "forest:seed=8,triangles=400000"] {
        let generated = parse(text).unwrap();
        let scene = &generated.scene;
        for (frame, camera) in generated.path.sample(generated.frames).unwrap().iter().enumerate() {
            let ground = |o: &DVec3| DVec2::new(o.x, o.z).distance(DVec2::new(camera.eye.x, camera.eye.z));
            for object in scene.objects.iter().filter(|o| !o.name.starts_with("ground") && ground(&o.position) < 8.0) {
                assert!(ground(&object.position) > 0.9, "{text}: frame {frame} meets {}", object.name);
                let mesh = &scene.meshes[object.mesh as usize];
                let at = |v: &Vec3| (object.rotation * *v).as_dvec3() + object.position;
                let near = mesh.positions().iter().map(|v| at(v).distance(camera.eye)).fold(f64::INFINITY, f64::min);
                assert!(near > 0.3, "{text}: frame {frame} is {near} m from {}", object.name);
            }
        }
    }
}

#[test]
fn every_method_draws_the_same_forest_and_much_of_it_is_hidden() {
    let generated = parse("forest:triangles=600000").unwrap();
    let scene = PreparedScene::new(&generated.scene).unwrap();
    let viewport = Viewport::new(320, 256).unwrap();
    let cameras = generated.path.sample(5).unwrap();
    let views: Vec<View> = cameras.iter().map(|camera| camera.view(viewport).unwrap()).collect();
    let methods = ["vfc", "hom", "hom-progressive", "ideal"].map(|name| Method::parse(name).unwrap());
    let workers = Workers::new(1).unwrap();
    let options = WalkOptions { level: Level::best(), workers: &workers, repetitions: 1, exact: true };
    let report = walk("forest", &scene, &views, &methods, &options, |_| Ok(())).unwrap();
    for run in &report.runs {
        assert_eq!(run.wrongly_culled_objects(), Some(0), "{}", run.method);
        assert_eq!(run.image_hash, report.runs[0].image_hash, "{}", run.method);
    }
    let drawn: Vec<f64> = report.runs.iter().map(|run| run.mean(report.pixels()).triangles_drawn).collect();
    assert!(drawn[3] < drawn[0] * 0.7, "the ideal leaves out a good part: {drawn:?}");
}
