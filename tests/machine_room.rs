//! The machine room (thesis 8.4.2): closed solids in a hull, as many triangles as asked, and a walk that meets nothing.

use std::collections::BTreeSet;

use glam::{DMat3, DVec3};
use homcull::geometry::Aabb;
use homcull::scene::{Generated, Object, Scene, parse};

/// The hull as the generator's plan has it: inner radius of the plating, its thickness, height of its axis, metres.
const RADIUS: f64 = 5.4;
const PLATING: f64 = 0.05;
const AXIS: f64 = 1.9;

/// World triangles of an object, in f64.
fn triangles<'a>(scene: &'a Scene, object: &'a Object) -> impl Iterator<Item = [DVec3; 3]> + 'a {
    let mesh = &scene.meshes[object.mesh as usize];
    let turn: DMat3 = object.rotation.as_dmat3();
    mesh.triangles().iter().map(move |t| t.map(|i| turn * mesh.positions()[i as usize].as_dvec3() + object.position))
}

fn room(text: &str) -> Generated {
    parse(text).unwrap()
}

#[test]
fn the_default_has_the_thesis_number_of_triangles() {
    let generated = room("machine-room");
    assert_eq!(generated.scene.triangles(), 632_252);
    assert_eq!(generated.scene.name, "machine-room");
    assert!(generated.scene.objects.len() > 3000, "{}", generated.scene.objects.len());
}

#[test]
fn targets_are_met_within_five_percent_from_below() {
    for seed in [1, 2, 77] {
        for target in [100_000u64, 250_000, 632_252, 1_000_000] {
            let generated = room(&format!("machine-room:seed={seed},triangles={target}"));
            let is = generated.scene.triangles();
            assert!(is <= target && is * 100 >= target * 95, "seed {seed}: {is} of {target}");
            let last = generated.scene.objects.last().unwrap();
            let spare = generated.scene.meshes[last.mesh as usize].triangles().len();
            assert!(last.name != "strum_box" || spare < 200, "seed {seed}, {target}: a spare of {spare}");
        }
    }
    for few in [2, 10, 5000] {
        assert_eq!(room(&format!("machine-room:triangles={few}")).scene.triangles(), few);
    }
}

#[test]
fn the_same_seed_gives_the_same_room_and_another_a_different_one() {
    assert_eq!(room("machine-room"), room("machine-room:seed=1,triangles=632252"));
    let (one, other) = (room("machine-room:seed=5"), room("machine-room:seed=6"));
    assert_ne!(one.scene, other.scene);
    assert_eq!(one.path, other.path, "the walk keeps to aisles that every room has");
}

#[test]
fn objects_are_closed_outward_solids_of_a_sensible_size() {
    let generated = room("machine-room");
    let scene = &generated.scene;
    for (number, mesh) in scene.meshes.iter().enumerate() {
        let name = &scene.objects.iter().find(|o| o.mesh as usize == number).unwrap().name;
        let corner = |t: &[u32; 3]| t.map(|i| mesh.positions()[i as usize].as_dvec3());
        let middle = mesh.positions().iter().map(|p| p.as_dvec3()).sum::<DVec3>() / mesh.positions().len() as f64;
        let volume = |[a, b, c]: [DVec3; 3]| (a - middle).cross(b - middle).dot(c - middle);
        assert!(mesh.triangles().len() <= 3000, "{name}: {}", mesh.triangles().len());
        // Piece by piece: triangles that share corners make a surface.
        for piece in pieces(mesh.triangles(), mesh.positions().len()) {
            let sum: f64 = piece.iter().map(corner).map(volume).sum();
            assert!(sum > 0.0, "{name} is inside out");
            let mut edges: Vec<(u32, u32)> = piece.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
            let mut turned: Vec<(u32, u32)> = edges.iter().map(|&(a, b)| (b, a)).collect();
            edges.sort_unstable();
            turned.sort_unstable();
            assert_eq!(edges, turned, "{name} is not closed");
        }
    }
    let names: BTreeSet<&str> = scene.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names.len(), scene.objects.len(), "names are unique");
    assert!(scene.objects.iter().all(|o| (o.rotation.determinant() - 1.0).abs() < 1e-4), "turned, not mirrored");
}

/// Triangles in groups that are joined by corners.
fn pieces(triangles: &[[u32; 3]], vertices: usize) -> Vec<Vec<[u32; 3]>> {
    let mut parent: Vec<usize> = (0..vertices).collect();
    fn root(parent: &mut [usize], mut i: usize) -> usize {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    }
    for t in triangles {
        for k in [1, 2] {
            let (a, b) = (root(&mut parent, t[0] as usize), root(&mut parent, t[k] as usize));
            parent[a] = b;
        }
    }
    let mut groups: std::collections::BTreeMap<usize, Vec<[u32; 3]>> = std::collections::BTreeMap::new();
    for &t in triangles {
        groups.entry(root(&mut parent, t[0] as usize)).or_default().push(t);
    }
    groups.into_values().collect()
}

#[test]
fn all_is_within_the_hull_and_polygons_are_large_and_small() {
    let generated = room("machine-room");
    let (mut least, mut most, mut length) = (f64::INFINITY, 0.0f64, 0.0f64);
    for object in &generated.scene.objects {
        for t in triangles(&generated.scene, object) {
            for p in t {
                let out = (p.y - AXIS).hypot(p.z);
                assert!(out < RADIUS + PLATING + 1e-3, "{} is {out} m from the hull's axis", object.name);
                length = length.max(p.x);
            }
            let side = (t[1] - t[0]).length().max((t[2] - t[1]).length()).max((t[0] - t[2]).length());
            (least, most) = (least.min(side), most.max(side));
        }
    }
    assert!(most > 0.95 * length, "a polygon of {most} m in a room of {length} m");
    assert!(least < 0.02, "{least}");
}

/// Squared distance from a point to a triangle (Ericson 2005, 5.1.5, by regions).
fn distance_squared(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let inside = |u: DVec3, v: DVec3| normal.cross(v - u).dot(p - u) >= 0.0;
    if normal != DVec3::ZERO && inside(a, b) && inside(b, c) && inside(c, a) {
        let off = normal.normalize().dot(p - a);
        return off * off;
    }
    let edge = |u: DVec3, v: DVec3| {
        let along = v - u;
        let t = ((p - u).dot(along) / along.length_squared().max(1e-300)).clamp(0.0, 1.0);
        (p - u - along * t).length_squared()
    };
    edge(a, b).min(edge(b, c)).min(edge(c, a))
}

/// How often the surface winds around the point: the sum of the triangles' solid angles (van Oosterom, Strackee 1983).
fn winding(p: DVec3, surface: impl Iterator<Item = [DVec3; 3]>) -> f64 {
    let angle = |t: [DVec3; 3]| {
        let [a, b, c] = t.map(|v| v - p);
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        2.0 * a.dot(b.cross(c)).atan2(below)
    };
    surface.map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

#[test]
fn the_walk_is_inside_the_hull_and_outside_every_solid() {
    for text in ["machine-room", "machine-room:seed=8,triangles=100000", "machine-room:seed=3,triangles=1000000"] {
        let generated = room(text);
        let scene = &generated.scene;
        let boxes: Vec<Aabb> = scene.objects.iter().map(|o| scene.object_bounds(o, DVec3::ZERO)).collect();
        let eyes = generated.path.sample(generated.frames).unwrap();
        let all = boxes.iter().fold(Aabb::EMPTY, |a, &b| a.union(b));
        for (object, bounds) in scene.objects.iter().zip(&boxes) {
            for (frame, camera) in eyes.iter().enumerate() {
                let eye = camera.eye;
                assert!((eye.y - AXIS).hypot(eye.z) < RADIUS && bounds.distance_squared(eye.as_vec3()) >= 0.0);
                assert!(eye.x > f64::from(all.min.x) + 0.5 && eye.x < f64::from(all.max.x) - 0.5);
                if f64::from(bounds.distance_squared(eye.as_vec3())) > 0.0625 {
                    continue;
                }
                let near = triangles(scene, object).map(|t| distance_squared(eye, t)).fold(f64::INFINITY, f64::min);
                let (name, near) = (&object.name, near.sqrt());
                assert!(near > 0.25, "{text}: frame {frame} at {eye} is {near} m from {name}");
                assert!(winding(eye, triangles(scene, object)).abs() < 0.5, "{text}: frame {frame} is in {name}");
            }
        }
    }
}

#[test]
fn the_walk_goes_below_and_above_and_looks_back_at_the_end() {
    let generated = room("machine-room");
    let frames = generated.path.sample(generated.frames).unwrap();
    assert!(frames.iter().filter(|c| c.eye.y < 1.7).count() > generated.frames / 4);
    assert!(frames.iter().filter(|c| c.eye.y > 4.8).count() > generated.frames / 4);
    let (first, last) = (frames.first().unwrap(), frames.last().unwrap());
    assert!(first.target.x > first.eye.x && last.target.x < last.eye.x && last.eye.x > first.eye.x + 20.0);
}
