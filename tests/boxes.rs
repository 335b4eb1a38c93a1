//! Verdicts are conservative, the same however they are asked for, and mean what they say.

mod oracle;

use glam::{DMat4, DVec3, Vec3};
use homcull::geometry::{Aabb, SampleRect};
use homcull::occlusion::{BoxSet, Hidden, Occluder, OcclusionSettings, ProjectedBoxes, Verdict, Visible};
use homcull::raster::Facing;
use homcull::scene::PreparedScene;
use homcull::view::{Camera, ClipSpace, DepthRange, View};
use homcull_simd::Level;
use oracle::float::clip;
use oracle::random::Random;
use oracle::scenes::{Builder, camera, city, orthographic, perspective, restated, viewport};
use oracle::state::{State, begun, draw, for_levels, same, submitted};
use oracle::verdicts::{all_covered, at_the_edge, conservative, samples, verdicts, world};

#[test]
fn what_is_called_hidden_shows_no_sample() {
    let mut r = Random::new(1);
    let mut reasons = std::collections::BTreeMap::new();
    for round in 0..240 {
        let (view, scene) = world(&mut r, round, 90);
        let what = format!("round {round}");
        let all =
            for_levels(&what, |level| verdicts(&submitted(level, &view, &scene.meshes, &scene.occluders), &scene));
        conservative(&what, &view, &scene, &all);
        for v in &all {
            *reasons.entry(v.reason()).or_insert(0) += 1;
        }
    }
    println!("{reasons:?}");
    for reason in ["overlap_and_depth", "outside_frustum", "no_sample", "near_plane", "uncovered", "in_front"] {
        assert!(reasons.get(reason).is_some_and(|&n| n > 20), "too few are {reason}: {reasons:?}");
    }
}

#[test]
fn what_a_part_of_the_objects_hides_shows_no_sample_either() {
    let mut r = Random::new(2);
    for round in 0..120 {
        let (view, scene) = world(&mut r, round, 90);
        let some: Vec<Occluder> = scene.occluders.iter().filter(|_| r.chance(0.3)).copied().collect();
        let what = format!("round {round}");
        let all = for_levels(&what, |level| verdicts(&submitted(level, &view, &scene.meshes, &some), &scene));
        conservative(&what, &view, &scene, &all);
    }
}

#[test]
fn a_box_between_samples_far_to_the_right_of_a_wide_screen_is_judged_by_its_bound() {
    // At sample 16000 a subpixel is eight rounding steps of f32.
    let mut r = Random::new(3);
    for round in 0..24 {
        let (w, h) = [(16_384, 3), (3, 16_384)][round % 2];
        let lens = Camera {
            eye: DVec3::ZERO,
            target: DVec3::NEG_Z,
            up: DVec3::Y,
            fov_y_deg: [0.01, 120.0][round % 2],
            near: 0.1,
            far: None,
        };
        let view = lens.view(viewport(w, h)).unwrap();
        let mut b = Builder::new();
        let half = (lens.fov_y_deg.to_radians() * 0.5).tan();
        let (half_x, half_y) = (half * f64::from(w) / f64::from(h), half);
        for _ in 0..300 {
            let z = r.range(1.0, 20.0);
            let at = Vec3::new(
                (r.range(-1.0, 1.0) * half_x * z) as f32,
                (r.range(-1.0, 1.0) * half_y * z) as f32,
                -z as f32,
            );
            let wide = |r: &mut Random, half: f64, n: u32| (r.range(0.0, 3.0) * half * z / f64::from(n)) as f32;
            let size = Vec3::new(wide(&mut r, half_x, w), wide(&mut r, half_y, h), r.float(0.0, 0.01));
            b.cuboid(at, at + size, Facing::Both);
        }
        let scene = b.prepared();
        let what = format!("round {round}, {w}x{h}");
        let all =
            for_levels(&what, |level| verdicts(&submitted(level, &view, &scene.meshes, &scene.occluders), &scene));
        conservative(&what, &view, &scene, &all);
        assert!(all.contains(&Verdict::Hidden(Hidden::NoSample)), "{what}");
    }
}

#[test]
fn a_box_shaped_object_does_not_hide_itself() {
    let mut r = Random::new(4);
    let (mut shown_alone, mut visible) = (0, 0);
    for round in 0..400 {
        let mut lens = camera(&mut r, DVec3::ZERO);
        lens.far = None;
        let view = lens.view(viewport(64, 48)).unwrap();
        let ahead = (lens.target - lens.eye).normalize();
        let at = (ahead * r.range(0.5, 30.0)).as_vec3() + Vec3::new(r.float(-2.0, 2.0), r.float(-2.0, 2.0), 0.0);
        let mut size = Vec3::new(r.float(0.0, 9.0), r.float(0.0, 9.0), r.float(0.0, 9.0));
        size[r.below(3)] *= [0.0, 1.0][r.below(2)];
        let mut b = Builder::new();
        b.cuboid(at, at + size, Facing::Both);
        let scene = b.prepared();
        let what = format!("round {round}");
        let all =
            for_levels(&what, |level| verdicts(&submitted(level, &view, &scene.meshes, &scene.occluders), &scene));
        conservative(&what, &view, &scene, &all);
        shown_alone += u32::from(samples(&view, &scene).0[0] > 0);
        visible += u32::from(!all[0].is_hidden());
    }
    println!("{shown_alone} boxes show a sample, {visible} are called visible");
    assert!(shown_alone > 100 && visible < shown_alone + 100, "{shown_alone} show, {visible} are called visible");
}

/// True when something nearer than `z` is kept at every sample of the rectangle.
fn all_nearer(state: &State, r: SampleRect, z: f32) -> bool {
    (r.y0..=r.y1)
        .all(|y| (r.x0..=r.x1).all(|x| f32::from_bits(state.depth[y as usize * state.width as usize + x as usize]) > z))
}

#[test]
fn one_by_one_in_a_batch_or_projected_first_the_verdict_is_the_same() {
    let mut r = Random::new(5);
    for round in 0..96 {
        let (view, scene) = world(&mut r, round, 90);
        for_levels(&format!("round {round}"), |level| {
            let buffer = submitted(level, &view, &scene.meshes, &scene.occluders[..scene.occluders.len() / 2]);
            let single = verdicts(&buffer, &scene);
            let mut projected = ProjectedBoxes::new();
            buffer.project(&scene.boxes, scene.origin, &mut projected).unwrap();
            let mut met = vec![false; single.len()];
            let mut flags = Vec::new();
            let n = projected.len();
            buffer.test_projected(&projected, 0..n, &scene.bounds, scene.origin, &mut flags).unwrap();
            let mut pieces = Vec::new();
            for from in (0..n).step_by(7) {
                let mut piece = Vec::new();
                let range = from..(from + 7).min(n);
                buffer.test_projected(&projected, range, &scene.bounds, scene.origin, &mut piece).unwrap();
                pieces.extend(piece);
            }
            assert_eq!(pieces, flags, "round {round}: in pieces of seven");
            for (b, &hidden) in projected.boxes().iter().zip(&flags) {
                let id = b.id() as usize;
                let verdict = buffer.test_one_projected(b, &scene.bounds, scene.origin).unwrap();
                let about = || format!("round {round}, object {id} {:?}, {b:?}", scene.bounds[id]);
                assert!(!std::mem::replace(&mut met[id], true), "{}: projected twice", about());
                assert_eq!(verdict, single[id], "{}: projected, against single", about());
                assert_eq!(hidden, verdict.is_hidden(), "{}: the batch's flag, against {verdict:?}", about());
            }
            for id in (0..met.len()).filter(|&id| !met[id]) {
                assert_eq!(
                    single[id],
                    Verdict::Hidden(Hidden::OutsideFrustum),
                    "round {round}, object {id} is not projected"
                );
            }
            single
        });
    }
}

#[test]
fn reasons_mean_what_they_say() {
    let mut r = Random::new(6);
    for round in 0..96 {
        let (view, scene) = world(&mut r, round, 90);
        let buffer = submitted(Level::best(), &view, &scene.meshes, &scene.occluders);
        let state = State::of(&buffer, &view);
        let mut projected = ProjectedBoxes::new();
        buffer.project(&scene.boxes, scene.origin, &mut projected).unwrap();
        for b in projected.boxes() {
            let id = b.id() as usize;
            let verdict = buffer.test_one_projected(b, &scene.bounds, scene.origin).unwrap();
            let (rect, bounds) = (b.rect(), scene.bounds[id]);
            let about = format!("round {round}, object {id} {bounds:?}, {b:?}: {verdict:?}");
            if verdict == Verdict::Visible(Visible::NearPlane) {
                let corners = oracle::scenes::cuboid_corners(bounds.min, bounds.max);
                let at = corners.map(|c| clip(&view, c.as_dvec3() + scene.origin));
                let (near, w) = at.iter().fold((f64::MAX, f64::MAX), |a, c| (a.0.min(c[4]), a.1.min(c[2])));
                let scale = at.iter().fold(0.0f64, |a, c| a.max(c[2].abs()));
                assert!(
                    near <= 1e-4 * (scale + 1.0) || w <= 0.02,
                    "{about}: its least distance from the near plane is {near:e}"
                );
                continue;
            }
            if b.touches_near_plane() {
                continue;
            }
            if rect.is_empty() {
                assert_eq!(verdict, Verdict::Hidden(Hidden::NoSample), "{about}");
                continue;
            }
            let hidden = all_nearer(&state, rect, b.depth());
            if hidden {
                assert_eq!(verdict, Verdict::Hidden(Hidden::OverlapAndDepth), "{about}");
            } else if !at_the_edge(&view, rect) {
                let covered = all_covered(&state, rect);
                let should = if covered { Visible::InFront } else { Visible::Uncovered };
                assert_eq!(verdict, Verdict::Visible(should), "{about}");
            }
            // A drawn object is no nearer than its box says.
            if !at_the_edge(&view, rect) {
                let mut alone = scene.clone();
                alone.occluders = vec![scene.occluders[id]];
                alone.first_triangle = vec![0, scene.triangles(b.id())];
                let from = scene.first_triangle[id] as usize;
                alone.colors = scene.colors[from..from + scene.triangles(b.id()) as usize].to_vec();
                let drawn = draw(Level::best(), &view, &alone);
                for at in (0..drawn.items.len()).filter(|&at| drawn.items[at].is_some()) {
                    let (x, y) = ((at as u32 % drawn.width) as i32, (at as u32 / drawn.width) as i32);
                    let inside = (rect.x0..=rect.x1).contains(&x) && (rect.y0..=rect.y1).contains(&y);
                    assert!(
                        inside && drawn.depth(at) <= b.depth(),
                        "{about}: drawn at ({x}, {y}) {:e}",
                        drawn.depth(at)
                    );
                }
            }
        }
    }
}

#[test]
fn every_convention_of_clip_space_gives_the_same_verdicts() {
    let mut r = Random::new(7);
    for round in 0..60 {
        let eye = Vec3::new(r.float(-9.0, 9.0), r.float(0.0, 9.0), r.float(-9.0, 9.0));
        let scene = PreparedScene::new(&city(&mut r, eye, 60)).unwrap();
        let m: DMat4 =
            if round % 2 == 0 { perspective(&mut r, eye.as_dvec3()) } else { orthographic(&mut r, eye.as_dvec3()) };
        let of = |space: ClipSpace| {
            let view = View::new(restated(m, space), space, viewport(96, 64)).unwrap();
            for_levels("a convention", |level| {
                let buffer = submitted(level, &view, &scene.meshes, &scene.occluders);
                (State::of(&buffer, &view), verdicts(&buffer, &scene))
            })
        };
        let gold = of(ClipSpace::REVERSED);
        for depth in [DepthRange::Reversed, DepthRange::ZeroToOne, DepthRange::MinusOneToOne] {
            for y_down in [false, true] {
                let space = ClipSpace { depth, y_down };
                same(&format!("round {round}, {space:?}"), &of(space), &gold);
            }
        }
    }
}

#[test]
fn boxes_that_are_no_boxes_are_visible_or_outside() {
    let lens = Camera { eye: DVec3::ZERO, target: DVec3::NEG_Z, up: DVec3::Y, fov_y_deg: 60.0, near: 0.1, far: None };
    let view = lens.view(viewport(64, 64)).unwrap();
    let mut b = Builder::new();
    b.cuboid(Vec3::new(-9.0, -9.0, -3.0), Vec3::new(9.0, 9.0, -2.0), Facing::Both);
    let scene = b.prepared();
    let nan = Vec3::new(f32::NAN, 0.0, -5.0);
    let behind = Vec3::new(0.5, 0.5, -9.0);
    let bounds = [
        (Aabb { min: nan, max: Vec3::ONE }, false),
        (Aabb { min: -Vec3::ONE, max: nan }, false),
        (Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY }, false),
        (Aabb { min: Vec3::splat(-f32::MAX), max: Vec3::splat(f32::MAX) }, false),
        (Aabb::EMPTY, true),
        (Aabb { min: Vec3::ONE, max: -Vec3::ONE }, true),
        (Aabb { min: behind, max: behind }, true),
        (Aabb { min: -behind, max: -behind }, true),
        (Aabb { min: Vec3::new(-0.5, -0.5, -1.5), max: Vec3::new(0.5, 0.5, -1.0) }, false),
    ];
    let boxes: Vec<Aabb> = bounds.iter().map(|b| b.0).collect();
    for_levels("no boxes", |level| {
        let buffer = submitted(level, &view, &scene.meshes, &scene.occluders);
        let mut projected = ProjectedBoxes::new();
        buffer.project(&BoxSet::new(&boxes), DVec3::ZERO, &mut projected).unwrap();
        let mut flags = Vec::new();
        buffer.test_projected(&projected, 0..projected.len(), &boxes, DVec3::ZERO, &mut flags).unwrap();
        let mut batch = vec![true; boxes.len()];
        projected.boxes().iter().zip(flags).for_each(|(b, hidden)| batch[b.id() as usize] = hidden);
        for (i, &(b, hidden)) in bounds.iter().enumerate() {
            assert_eq!(buffer.test(b, DVec3::ZERO).unwrap().is_hidden(), hidden, "{b:?}");
            assert_eq!(batch[i], hidden, "{b:?} in a batch");
        }
        batch
    });
}

#[test]
fn a_box_behind_a_wall_is_occluded_and_one_beside_or_before_it_is_not() {
    let lens = Camera { eye: DVec3::ZERO, target: DVec3::NEG_Z, up: DVec3::Y, fov_y_deg: 60.0, near: 0.1, far: None };
    let view = lens.view(viewport(320, 192)).unwrap();
    let mut b = Builder::new();
    b.cuboid(Vec3::new(-2.0, -2.0, -6.0), Vec3::new(2.0, 2.0, -5.0), Facing::Both);
    let scene = b.prepared();
    let at = |x: f32, z: f32| Aabb { min: Vec3::new(x - 0.5, -0.5, z - 0.5), max: Vec3::new(x + 0.5, 0.5, z + 0.5) };
    let cases = [
        (at(0.0, -12.0), Verdict::Hidden(Hidden::OverlapAndDepth)),
        (at(0.0, -3.0), Verdict::Visible(Visible::InFront)),
        (at(4.5, -12.0), Verdict::Visible(Visible::Uncovered)),
        (at(0.0, 3.0), Verdict::Hidden(Hidden::OutsideFrustum)),
        (at(0.0, 0.0), Verdict::Visible(Visible::NearPlane)),
        (
            Aabb { min: Vec3::new(0.013, 0.013, -40.0), max: Vec3::new(0.014, 0.014, -39.9) },
            Verdict::Hidden(Hidden::NoSample),
        ),
    ];
    for_levels("a wall", |level| {
        let buffer = submitted(level, &view, &scene.meshes, &scene.occluders);
        for (bounds, should) in cases {
            let is = buffer.test(bounds, DVec3::ZERO).unwrap();
            assert_eq!(is, should, "{bounds:?}\n{}", buffer.to_ascii());
        }
        vec![0]
    });
}

#[test]
fn a_long_wall_beside_the_eye_is_as_near_as_where_it_enters_the_view() {
    // It runs past the eye, far nearer than the occluder, but comes into view only behind it.
    let lens = Camera { eye: DVec3::ZERO, target: DVec3::NEG_Z, up: DVec3::Y, fov_y_deg: 40.0, near: 0.1, far: None };
    let view = lens.view(viewport(128, 128)).unwrap();
    let mut b = Builder::new();
    b.cuboid(Vec3::new(-9.0, -9.0, -4.5), Vec3::new(9.0, 9.0, -4.0), Facing::Both);
    let scene = b.prepared();
    let wall = Aabb { min: Vec3::new(2.5, -1.0, -60.0), max: Vec3::new(2.75, 1.0, 20.0) };
    let is = for_levels("a long wall", |level| {
        vec![submitted(level, &view, &scene.meshes, &scene.occluders).test(wall, DVec3::ZERO).unwrap()]
    });
    assert_eq!(is, [Verdict::Hidden(Hidden::OverlapAndDepth)]);
}

#[test]
fn boxes_sort_by_the_distance_to_their_nearest_point() {
    let mut r = Random::new(12);
    for round in 0..12 {
        let (view, scene) = world(&mut r, round, 200);
        let order = for_levels("sorted", |level| {
            let buffer = begun(level, &view, OcclusionSettings::default());
            let mut projected = ProjectedBoxes::new();
            buffer.project(&scene.boxes, scene.origin, &mut projected).unwrap();
            projected.sort();
            projected.boxes().iter().map(|b| b.id()).collect::<Vec<_>>()
        });
        let eye = view.eye() - scene.origin;
        let distance = |id: u32| {
            let b = scene.bounds[id as usize];
            let outside = (b.min.as_dvec3() - eye).max(eye - b.max.as_dvec3()).max(DVec3::ZERO);
            outside.length_squared()
        };
        for pair in order.windows(2) {
            let [a, b] = [distance(pair[0]), distance(pair[1])];
            assert!(a <= b * (1.0 + 1.0 / 4096.0) + 1e-9, "round {round}: {a} stands before {b}");
        }
        let mut once = order.clone();
        once.sort_unstable();
        once.dedup();
        assert_eq!(once.len(), order.len(), "round {round}: a box is sorted in twice");
    }
}
