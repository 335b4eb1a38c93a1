//! Statements about detail culling: what is small on the screen goes while the view moves, and nothing else.
#![cfg(feature = "bvh")]

use glam::{DVec3, Vec3};
use homcull::cull::detail::{cull, is_detail, stands_still};
use homcull::geometry::Aabb;
use homcull::occlusion::{BoxSet, OcclusionBuffer, ProjectedBoxes};
use homcull::view::{Camera, View, Viewport};

/// A view along -z from (x, 0, 0): at a depth of 100 a unit is a pixel and 0.28.
fn view(x: f64) -> View {
    let (eye, ahead) = (DVec3::X * x, DVec3::NEG_Z);
    let camera = Camera { eye, target: eye + ahead, up: DVec3::Y, fov_y_deg: 90.0, near: 1.0, far: None };
    camera.view(Viewport::new(256, 256).unwrap()).unwrap()
}

fn projected(view: &View, boxes: &[Aabb]) -> ProjectedBoxes {
    let mut buffer = OcclusionBuffer::new(view.viewport());
    buffer.begin(view).unwrap();
    let mut out = ProjectedBoxes::new();
    buffer.project(&BoxSet::new(boxes), DVec3::ZERO, &mut out).unwrap();
    out.sort();
    out
}

fn cube(at: Vec3, half: f32) -> Aabb {
    Aabb { min: at - half, max: at + half }
}

fn ids(boxes: &ProjectedBoxes) -> Vec<u32> {
    boxes.boxes().iter().map(|b| b.id()).collect()
}

#[test]
fn what_is_small_goes_while_the_view_moves() {
    // Of about 64, 28, 13, 7, 3 and 2 pixels a side, nearest first; then one at the near plane, and a sliver at the border.
    let mut boxes: Vec<Aabb> = (0..6)
        .map(|k| cube(Vec3::new(0.0, 0.0, -100.0 * (k + 1) as f32), 20.0 / (1 << k) as f32 * (k + 1) as f32))
        .collect();
    boxes.push(cube(Vec3::new(0.0, 0.0, -1.0), 0.001));
    boxes.push(cube(Vec3::new(50.5, 0.0, -50.0), 0.6));
    let (now, before) = (view(0.0), view(0.1));
    let all = projected(&now, &boxes);
    assert_eq!(all.len(), boxes.len());
    for (pixels, smallest_left) in [(0, 5), (1, 5), (80, 2), (150, 2), (2000, 0)] {
        let (left, dropped) = cull(all.clone(), pixels, &now, Some(&before));
        // Boxes cut by the near plane or the border stay at any number.
        let expected: Vec<u32> = ids(&all).into_iter().filter(|&id| id <= smallest_left || id >= 6).collect();
        assert_eq!(ids(&left), expected, "{pixels} pixels");
        assert_eq!(dropped as usize + left.len(), all.len());
    }
}

#[test]
fn a_view_that_stands_still_shows_all() {
    let boxes: Vec<Aabb> = (0..40).map(|k| cube(Vec3::new(k as f32 - 20.0, 0.0, -90.0), 0.1)).collect();
    let (now, before) = (view(0.0), view(1e-12));
    let all = projected(&now, &boxes);
    assert!(stands_still(&now, Some(&now)) && !stands_still(&now, Some(&before)) && !stands_still(&now, None));
    assert_eq!(ids(&cull(all.clone(), 1000, &now, Some(&now)).0), ids(&all));
    assert_eq!(cull(all.clone(), 1000, &now, None).1, 40, "a first view is taken to move");
}

#[test]
fn the_area_counts_every_sample_that_the_box_may_touch() {
    let now = view(0.0);
    let boxes: Vec<Aabb> = (1..400).map(|k| cube(Vec3::new(0.3, 0.2, -60.0 - k as f32), 0.02 * k as f32)).collect();
    let all = projected(&now, &boxes);
    for b in all.boxes() {
        let rect = b.rect();
        let samples = (rect.y0..=rect.y1).map(|_| (rect.x0..=rect.x1).count()).sum::<usize>() as u32;
        assert!(is_detail(b, samples + 1) && !is_detail(b, samples), "{rect:?}");
    }
}
