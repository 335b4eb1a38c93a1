//! What each sample shows, and how deep: against a rasterizer in f64, and against triangles drawn one by one.

mod oracle;

use glam::{DVec3, Vec3};
use homcull::raster::Facing;
use homcull::scene::{PreparedScene, Scene};
use homcull::view::View;
use oracle::float::{Answer, Triangle, center, clip};
use oracle::random::Random;
use oracle::scenes::{Builder, camera, city, flat_view, viewport};
use oracle::state::{Drawn, draw, draw_in, for_levels, ids, levels, same};

/// The rim of edges where snapping may decide: 1/128 of a sample, in subpixels.
const RIM: f64 = 2.0;

/// The triangles of a scene in f64, by number; objects' positions are taken as they are, rotated vertices as f32.
fn float_triangles(scene: &Scene, view: &View) -> Vec<(Option<Triangle>, Facing)> {
    let mut out = Vec::new();
    for object in &scene.objects {
        let mesh = &scene.meshes[object.mesh as usize];
        let corner = |i: u32| {
            let v = mesh.positions()[i as usize].as_dvec3();
            clip(view, object.rotation.as_dmat3() * v + object.position)
        };
        out.extend(mesh.triangles().iter().map(|t| (Triangle::new(t.map(corner)), object.facing)));
    }
    out
}

fn faces(triangle: &Triangle, facing: Facing) -> bool {
    match facing {
        Facing::Front => triangle.orientation < 0.0,
        Facing::Back => triangle.orientation > 0.0,
        Facing::Both => true,
    }
}

/// What f64 sees at a sample.
struct Seen {
    /// Depth and number of the nearest triangle that surely covers it.
    nearest: Option<(f64, u32)>,
    /// The nearest depth that a triangle too close to call may have.
    rim: f64,
}

fn see(triangles: &[(Option<Triangle>, Facing)], x: f64, y: f64) -> Seen {
    let mut seen = Seen { nearest: None, rim: 0.0 };
    for (number, (triangle, facing)) in triangles.iter().enumerate() {
        let Some(t) = triangle else { continue };
        match t.at(x, y, RIM) {
            // Beyond the far plane nothing is drawn.
            Answer::Inside if faces(t, *facing) && t.depth(x, y) > 0.0 => {
                if seen.nearest.is_none_or(|(z, _)| t.depth(x, y) > z) {
                    seen.nearest = Some((t.depth(x, y), number as u32));
                }
            }
            Answer::Inside | Answer::Outside => {}
            // A triangle seen edge-on has no depth to speak of there.
            Answer::Rim => seen.rim = f64::INFINITY,
        }
    }
    seen
}

/// The stated bound: depth errs by at most this share of itself, and by what moving this part of a sample changes it.
const RELATIVE: f64 = 1.0 / (1 << 21) as f64;
const SHIFT: f64 = 1.0 / 2048.0;

#[test]
fn the_visible_object_and_its_depth_are_those_of_f64() {
    let mut r = Random::new(1);
    let (mut sure, mut largest, mut largest_share, mut contested) = (0, 0.0f64, 0.0f64, 0);
    for round in 0..60 {
        let eye = Vec3::new(r.float(-9.0, 9.0), r.float(-2.0, 9.0), r.float(-9.0, 9.0));
        let scene = city(&mut r, eye, 20);
        let view = camera(&mut r, eye.as_dvec3()).view(viewport(72, 56)).unwrap();
        let prepared = PreparedScene::new(&scene).unwrap();
        let drawn = for_levels(&format!("round {round}"), |level| draw(level, &view, &prepared));
        let triangles = float_triangles(&scene, &view);
        for (at, item) in drawn.items.iter().enumerate() {
            let (px, py) = (at as u32 % 72, at as u32 / 72);
            let (x, y) = (center(px), center(py));
            let seen = see(&triangles, x, y);
            if seen.rim > 0.0 {
                continue;
            }
            let what = || format!("round {round}, sample ({px}, {py}): drawn {item:?}, f64 {:?}", seen.nearest);
            let (Some((bits, number)), Some((z, should))) = (item, seen.nearest) else {
                // Next to the far plane f32 and f64 may disagree on which side.
                let far = seen.nearest.is_some_and(|(z, _)| z < 1e-6);
                assert!(item.is_none() && seen.nearest.is_none() || far, "{}", what());
                continue;
            };
            let is = f64::from(f32::from_bits(*bits));
            let slope = |n: u32| triangles[n as usize].0.as_ref().map_or(0.0, Triangle::slope);
            let bound = RELATIVE * z + SHIFT * slope(should).max(slope(*number));
            let error = (is - z).abs();
            assert!(error <= bound, "{}: error {error:e}, bound {bound:e}", what());
            sure += 1;
            largest = largest.max(error / z);
            largest_share = largest_share.max(error / bound);
            if prepared.object_of(*number) != prepared.object_of(should) {
                let other = triangles[*number as usize].0.as_ref().unwrap();
                let gap = (z - other.depth(x, y)).abs();
                assert!(gap <= 2.0 * bound, "{}: the depths are {gap:e} apart, bound {bound:e}", what());
                contested += 1;
            }
        }
    }
    println!(
        "{sure} samples; largest error {largest:e} of the depth, {largest_share:.3} of the bound; {contested} contested"
    );
    assert!(sure > 50_000, "only {sure} samples could be compared");
    assert!(contested < sure / 1000, "{contested} of {sure} samples show another object");
}

/// A soup with many ties: triangles repeated, flat at a few depths, small and large.
fn tied_soup(r: &mut Random, objects: usize, width: u32, height: u32) -> Builder {
    let mut b = Builder::new();
    let mut before: Vec<[Vec3; 3]> = Vec::new();
    for _ in 0..objects {
        let mut soup = Vec::new();
        for _ in 0..1 + r.below(30) {
            if !before.is_empty() && r.chance(0.4) {
                let mut t = before[r.below(before.len())];
                t.rotate_left(r.below(3));
                soup.push(t);
                continue;
            }
            let size = [3.0, 12.0, 60.0, 400.0][r.below(4)];
            let (x, y) = (r.range(-10.0, f64::from(width)), r.range(-10.0, f64::from(height)));
            let flat = r.chance(0.5).then(|| 0.1 * (1 + r.below(4)) as f32);
            soup.push(std::array::from_fn(|_| {
                let z = flat.unwrap_or_else(|| r.float(0.05, 0.95));
                Vec3::new((x + r.range(-size, size)) as f32, (y + r.range(-size, size)) as f32, z)
            }));
        }
        before.extend(&soup);
        b.triangles(&soup, Facing::Both);
    }
    b
}

/// Each triangle of the scene drawn alone, then put together: the nearest, of equals the lower number.
fn one_by_one(scene: &Scene, view: &View, level: homcull_simd::Level) -> Vec<Option<(u32, u32)>> {
    let size = (view.viewport().width() * view.viewport().height()) as usize;
    let mut out: Vec<Option<(u32, u32)>> = vec![None; size];
    let mut number = 0;
    for object in &scene.objects {
        let mesh = &scene.meshes[object.mesh as usize];
        for t in mesh.triangles() {
            let mut alone = Builder::new();
            let copy = alone.triangles(&[t.map(|i| mesh.positions()[i as usize])], object.facing);
            (copy.rotation, copy.position) = (object.rotation, object.position);
            let drawn = draw(level, view, &alone.prepared());
            for (to, item) in out.iter_mut().zip(drawn.items) {
                if let Some((bits, _)) = item
                    && to.is_none_or(|(z, _)| f32::from_bits(bits) > f32::from_bits(z))
                {
                    *to = Some((bits, number));
                }
            }
            number += 1;
        }
    }
    out
}

#[test]
fn a_picture_is_the_nearest_of_its_triangles_each_drawn_alone() {
    let mut r = Random::new(2);
    for round in 0..12 {
        let (w, h) = [(64, 48), (33, 31), (70, 40)][round % 3];
        let view = flat_view(viewport(w, h));
        let scene = tied_soup(&mut r, 6, w, h).0;
        let prepared = PreparedScene::new(&scene).unwrap();
        for level in levels() {
            let is = draw(level, &view, &prepared).items;
            same(&format!("round {round} at {}", level.name()), &is, &one_by_one(&scene, &view, level));
        }
    }
}

#[test]
fn a_city_is_the_nearest_of_its_triangles_each_drawn_alone() {
    let mut r = Random::new(3);
    for round in 0..6 {
        let eye = Vec3::new(r.float(-9.0, 9.0), r.float(0.0, 9.0), r.float(-9.0, 9.0));
        let scene = city(&mut r, eye, 16);
        let view = camera(&mut r, eye.as_dvec3()).view(viewport(64, 48)).unwrap();
        let prepared = PreparedScene::new(&scene).unwrap();
        let level = homcull_simd::Level::best();
        let is = draw(level, &view, &prepared).items;
        same(&format!("round {round}"), &is, &one_by_one(&scene, &view, level));
    }
}

#[test]
fn the_order_of_objects_changes_nothing_in_the_picture() {
    let mut r = Random::new(4);
    for round in 0..40 {
        let (w, h) = [(130, 97), (64, 64), (7, 5), (100, 1), (257, 129)][round % 5];
        let (view, prepared) = if round % 2 == 0 {
            (flat_view(viewport(w, h)), tied_soup(&mut r, 12, w, h).prepared())
        } else {
            let eye = Vec3::new(r.float(-9.0, 9.0), r.float(0.0, 9.0), r.float(-9.0, 9.0));
            let scene = city(&mut r, eye, 30);
            (camera(&mut r, eye.as_dvec3()).view(viewport(w, h)).unwrap(), PreparedScene::new(&scene).unwrap())
        };
        let mut order = ids(&prepared);
        let gold = for_levels("in order", |level| draw_in(level, &view, &prepared, &order, 1));
        order.reverse();
        let same_as_gold = |what: &str, order: &[u32], bands| {
            let is: Drawn = for_levels(what, |level| draw_in(level, &view, &prepared, order, bands));
            same(&format!("round {round}, {what}, {bands} bands"), &is, &gold);
        };
        same_as_gold("reversed", &order, 1);
        for bands in [1, 2, 3, 5, 7] {
            same_as_gold("shuffled", &r.shuffled(&order), bands);
        }
    }
}

#[test]
fn of_two_equal_objects_the_lower_id_shows_and_of_two_equal_triangles_the_lower_number() {
    let t = |z: f32| [Vec3::new(2.0, 3.0, z), Vec3::new(9.0, 50.0, z), Vec3::new(60.0, 20.0, z)];
    let mut b = Builder::new();
    b.triangles(&[t(0.2)], Facing::Both);
    b.triangles(&[t(0.5), t(0.5), t(0.5)], Facing::Both);
    b.triangles(&[t(0.5), t(0.5)], Facing::Both);
    b.triangles(&[t(0.1)], Facing::Both);
    let (view, prepared) = (flat_view(viewport(64, 64)), b.prepared());
    for order in [[0, 1, 2, 3], [3, 2, 1, 0], [2, 0, 3, 1], [1, 3, 0, 2]] {
        let drawn = for_levels("equal triangles", |level| draw_in(level, &view, &prepared, &order, 1));
        let shown: Vec<u32> = drawn.items.iter().flatten().map(|&(_, number)| number).collect();
        assert!(shown.len() > 500 && shown.iter().all(|&n| n == 1), "order {order:?}: {:?}", &shown[..4]);
    }
}

#[test]
fn a_plane_that_slopes_through_everything_has_the_depth_of_its_plane() {
    // One triangle beyond the screen on all sides: its depth is known in closed form at every sample.
    let mut r = Random::new(5);
    let (mut largest, mut share) = (0.0f64, 0.0f64);
    for _ in 0..200 {
        let lens = camera(&mut r, DVec3::ZERO);
        let view = lens.view(viewport(64, 48)).unwrap();
        let ahead = (lens.target - lens.eye).normalize();
        let right = ahead.cross(lens.up).normalize();
        let up = right.cross(ahead);
        let middle = ahead * r.range(2.0, 30.0);
        let (a, b) = (right * 500.0 + ahead * r.range(-250.0, 250.0), up * 500.0 + ahead * r.range(-250.0, 250.0));
        let t = [middle - a - b, middle + a - b, middle + b].map(|p| p.as_vec3());
        let float = Triangle::new(t.map(|v| clip(&view, v.as_dvec3()))).unwrap();
        let mut scene = Builder::new();
        scene.triangles(&[t], Facing::Both);
        let drawn = for_levels("a sloping plane", |level| draw(level, &view, &scene.prepared()));
        for (at, item) in drawn.items.iter().enumerate() {
            let (x, y) = (center(at as u32 % 64), center(at as u32 / 64));
            if let (Some((bits, _)), Answer::Inside) = (item, float.at(x, y, RIM)) {
                let (is, should) = (f64::from(f32::from_bits(*bits)), float.depth(x, y));
                let bound = RELATIVE * should + SHIFT * float.slope();
                assert!((is - should).abs() <= bound, "{is:e}, should be {should:e}, bound {bound:e}: {lens:?} {t:?}");
                largest = largest.max((is - should).abs() / should);
                share = share.max((is - should).abs() / bound);
            }
        }
    }
    println!("largest error: {largest:e} of the depth, {share:.3} of the bound");
}
