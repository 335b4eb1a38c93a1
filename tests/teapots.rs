//! Statements about the generated teapots: their number, their shape, where they lie, and that every method draws them alike.
#![cfg(feature = "cli")]

use std::collections::BTreeMap;

use glam::{DVec3, Mat3, Vec3};
use homcull::cull::Method;
use homcull::geometry::Aabb;
use homcull::measure::walk::{WalkOptions, walk};
use homcull::scene::{Facing, PreparedScene, Scene, parse};
use homcull::view::{View, Viewport};
use homcull::workers::Workers;
use homcull_simd::Level;

#[test]
fn five_thousand_teapots_have_as_many_triangles_as_the_papers() {
    let generated = parse("teapots").unwrap();
    let scene = &generated.scene;
    assert_eq!((scene.objects.len(), scene.meshes.len(), scene.triangles()), (5000, 1, 11_520_000));
    assert_eq!(scene.meshes[0].triangles().len(), 2304);
    for (target, teapots) in [(2, 1), (4607, 1), (4608, 2), (100_000, 43), (1_000_000, 434), (100_000_000, 43_402)] {
        let objects = parse(&format!("teapots:triangles={target}")).unwrap().scene.objects.len();
        assert_eq!(objects, teapots, "of {target} triangles");
    }
    assert_eq!(parse("teapots:seed=5").unwrap(), parse("teapots:seed=5").unwrap());
    assert_ne!(parse("teapots:seed=5").unwrap().scene, generated.scene);
}

/// Corners of a triangle.
fn corners(scene: &Scene, triangle: &[u32; 3]) -> [DVec3; 3] {
    triangle.map(|i| scene.meshes[0].positions()[i as usize].as_dvec3())
}

#[test]
fn a_teapot_has_a_lid_a_spout_a_handle_and_a_bottom() {
    let scene = parse("teapots:triangles=2304").unwrap().scene;
    let mesh = &scene.meshes[0];
    // In the paper's units, from the middle of the table under it.
    let unit = |v: Vec3| v / 0.05 + Vec3::new(0.2, 1.575, 0.0);
    let (low, high) = (unit(mesh.bounds().min), unit(mesh.bounds().max));
    assert!((low.y.abs() < 1e-5) && (high.y - 3.15).abs() < 1e-5, "3.15 high: {low} to {high}");
    assert!((high.z - 2.0).abs() < 0.01 && (low.z + 2.0).abs() < 0.01, "a body of radius 2: {low} to {high}");
    assert!((-3.05..-2.9).contains(&low.x) && (3.3..3.5).contains(&high.x), "handle and spout: {low} to {high}");
    let area = |t: &[u32; 3]| {
        let [a, b, c] = corners(&scene, t);
        (b - a).cross(c - a).length()
    };
    let (flat, solid): (Vec<[u32; 3]>, Vec<[u32; 3]>) = mesh.triangles().iter().copied().partition(|t| area(t) == 0.0);
    assert_eq!(flat.len(), 48, "one row of four patches at either pole");
    assert!(
        flat.iter().all(|t| t[0] == t[1] || t[1] == t[2] || t[2] == t[0]),
        "and they are points or lines by number"
    );
    // An edge in common is passed in both directions: all patches face outward. The rest are the five open ends.
    let mut edges: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    for [a, b, c] in solid {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            assert!(edges.insert((from, to), 1).is_none(), "an edge is passed twice in one direction");
        }
    }
    let open = edges.keys().filter(|&&(a, b)| !edges.contains_key(&(b, a))).count();
    assert_eq!(open, 24 + 24 + 4 * 12, "the lid's border, the rim's, and two ends of two tubes");
    let volume: f64 = mesh.triangles().iter().map(|t| corners(&scene, t)).map(|[a, b, c]| a.cross(b).dot(c)).sum();
    assert!(volume > 0.0, "outward");
}

#[test]
fn they_lie_at_random_in_a_long_thin_box() {
    let scene = parse("teapots").unwrap().scene;
    let spread = Aabb::around(scene.objects.iter().map(|o| o.position.as_vec3())).size();
    assert!(spread.x > 5.5 * spread.y && spread.x > 5.5 * spread.z, "{spread}");
    let mut places: Vec<DVec3> = scene.objects.iter().map(|o| o.position).collect();
    places.sort_by(|a, b| a.x.total_cmp(&b.x));
    for (k, a) in places.iter().enumerate() {
        let near = places[k + 1..].iter().take_while(|b| b.x - a.x < 0.17);
        assert!(near.clone().all(|b| a.distance(*b) > 0.1699), "two bodies meet at {a}");
    }
    for object in &scene.objects {
        let r = object.rotation;
        assert!((r * r.transpose()).abs_diff_eq(Mat3::IDENTITY, 1e-5) && r.determinant() > 0.0, "{}", object.name);
        assert_eq!((object.facing, object.is_opaque()), (Facing::Both, true));
    }
    let up: Vec3 = scene.objects.iter().map(|o| o.rotation.y_axis).sum::<Vec3>() / 5000.0;
    assert!(up.length() < 0.05, "no direction is preferred: {up}");
}

#[test]
fn the_walk_goes_around_and_sees_nearly_all_of_the_box() {
    let generated = parse("teapots").unwrap();
    let scene = PreparedScene::new(&parse("teapots:triangles=4608").unwrap().scene).unwrap();
    assert_eq!(scene.occluders.len(), 2);
    let viewport = Viewport::new(1280, 1024).unwrap();
    let frames = generated.path.sample(generated.frames).unwrap();
    let half = generated.scene.objects.iter().map(|o| o.position.abs()).fold(DVec3::ZERO, DVec3::max);
    let mut seen = 0;
    for (k, camera) in frames.iter().enumerate() {
        assert!((camera.eye.abs() - half).max_element() > 0.5, "frame {k} is among the teapots");
        let broadside = (camera.target - camera.eye).normalize().z < -0.8;
        assert!(broadside || !(25..=89).contains(&k), "frame {k} looks at the long side");
        let view = camera.view(viewport).unwrap();
        let on_screen = |p: DVec3| {
            let [x, y, w] = [0, 1, 2].map(|row| view.rows()[row].dot((p - view.eye()).extend(1.0)));
            w > 0.0 && x > 0.0 && y > 0.0 && x < w * 1280.0 * 256.0 && y < w * 1024.0 * 256.0
        };
        seen += generated.scene.objects.iter().filter(|o| on_screen(o.position)).count();
    }
    let share = seen as f64 / (frames.len() * 5000) as f64;
    assert!((0.94..=1.0).contains(&share), "the paper had 97 percent in the frustum, here {share}");
}

#[test]
fn every_method_draws_the_same_teapots() {
    let generated = parse("teapots:triangles=500000").unwrap();
    let scene = PreparedScene::new(&generated.scene).unwrap();
    let viewport = Viewport::new(320, 256).unwrap();
    let cameras = generated.path.sample(4).unwrap();
    let views: Vec<View> = cameras.iter().map(|camera| camera.view(viewport).unwrap()).collect();
    let methods = ["vfc", "hom", "hom-progressive"].map(|name| Method::parse(name).unwrap());
    let workers = Workers::new(1).unwrap();
    let options = WalkOptions { level: Level::best(), workers: &workers, repetitions: 1, exact: true };
    let report = walk("teapots", &scene, &views, &methods, &options, |_| Ok(())).unwrap();
    for run in &report.runs {
        assert_eq!(run.wrongly_culled_objects(), Some(0), "{}", run.method);
        assert_eq!(run.image_hash, report.runs[0].image_hash, "{}", run.method);
    }
}
