//! Statements about the hierarchy over a scene's objects.
#![cfg(feature = "bvh")]

use glam::Vec3;
use homcull::geometry::Aabb;
use homcull::scene::{Hierarchy, MAX_DEPTH};

fn cube(x: f32, y: f32, z: f32, r: f32) -> Aabb {
    Aabb { min: Vec3::new(x - r, y - r, z - r), max: Vec3::new(x + r, y + r, z + r) }
}

/// Asserts all that a [`Hierarchy`] promises.
#[track_caller]
fn sound(boxes: &[Aabb], hierarchy: &Hierarchy) {
    let mut ids = [hierarchy.objects.clone(), hierarchy.unplaced.clone()].concat();
    ids.sort_unstable();
    assert!(ids.iter().copied().eq(0..boxes.len() as u32), "every object once");
    assert!(hierarchy.depth() <= MAX_DEPTH, "depth {}", hierarchy.depth());
    for (index, node) in hierarchy.nodes.iter().enumerate() {
        let first = node.first as usize;
        let union = if node.is_leaf() {
            assert!(node.count <= 4);
            let ids = &hierarchy.objects[first..first + node.count as usize];
            ids.iter().fold(Aabb::EMPTY, |b, &id| b.union(boxes[id as usize]))
        } else {
            assert!(first > index, "children follow their parent");
            hierarchy.nodes[first].bounds.union(hierarchy.nodes[first + 1].bounds)
        };
        assert_eq!(node.bounds, union, "node {index}");
    }
}

#[test]
fn boxes_that_tie_give_a_shallow_tree() {
    let n = 10_000;
    let cases: [(&str, Vec<Aabb>); 9] = [
        ("identical", vec![cube(1.0, 2.0, 3.0, 1.0); n]),
        ("identical points far away", vec![cube(1e9, -1e9, 1e9, 0.0); n]),
        ("a row", (0..n).map(|i| cube(i as f32, 0.0, 0.0, 0.5)).collect()),
        ("a row far away", (0..n).map(|i| cube(1e8 + i as f32 * 8.0, 0.0, 0.0, 4.0)).collect()),
        ("nested", (0..n).map(|i| cube(0.0, 0.0, 0.0, i as f32)).collect()),
        ("ever larger", (0..n).map(|i| cube(libm::powf(1.01, i as f32 % 8000.0), 0.0, 0.0, 0.1)).collect()),
        ("two places", (0..n).map(|i| cube([-1e20, 1e20][i % 2], 0.0, 0.0, 1.0)).collect()),
        ("as large as can be", vec![Aabb { min: Vec3::splat(-f32::MAX), max: Vec3::splat(f32::MAX) }; n]),
        ("a row and a sky", (0..n).map(|i| cube(i as f32, 0.0, 0.0, if i == 7 { 1e30 } else { 0.5 })).collect()),
    ];
    for (name, boxes) in cases {
        let start = std::time::Instant::now();
        let hierarchy = Hierarchy::build(&boxes);
        let took = start.elapsed();
        sound(&boxes, &hierarchy);
        assert!(took.as_millis() < 1000, "{name} took {took:?}: the quadratic case takes seconds");
    }
}

#[test]
fn boxes_that_are_none_are_unplaced() {
    let mut boxes: Vec<Aabb> = (0..20).map(|i| cube(i as f32, 0.0, 0.0, 0.4)).collect();
    boxes[3] = Aabb::EMPTY;
    boxes[5].min.y = f32::NAN;
    boxes[7].max.z = f32::INFINITY;
    let hierarchy = Hierarchy::build(&boxes);
    assert_eq!(hierarchy.unplaced, [3, 5, 7]);
    sound(&boxes, &hierarchy);
}

#[test]
fn small_and_empty_scenes_have_trees_too() {
    assert_eq!(Hierarchy::build(&[]), Hierarchy::default());
    assert!(Hierarchy::build(&[Aabb::EMPTY]).nodes.is_empty());
    assert_eq!(Hierarchy::default().depth(), 0);
    for n in 1..40 {
        let boxes: Vec<Aabb> = (0..n).map(|i| cube((i * 7 % 11) as f32, (i % 3) as f32, i as f32, 0.5)).collect();
        sound(&boxes, &Hierarchy::build(&boxes));
    }
}

#[test]
fn a_refit_follows_the_boxes() {
    let mut boxes: Vec<Aabb> = (0..500).map(|i| cube((i % 23) as f32, (i % 7) as f32, i as f32, 0.5)).collect();
    let mut hierarchy = Hierarchy::build(&boxes);
    boxes.iter_mut().enumerate().for_each(|(i, b)| *b = cube(b.min.x * 2.0, i as f32, b.max.z, 1.0));
    hierarchy.refit(&boxes);
    sound(&boxes, &hierarchy);
}

// ---- generators
