//! What an occlusion buffer holds: never nearer than what is drawn, and the same bits in any order, in any pieces.

mod oracle;

use glam::{DVec3, Vec3};
use homcull::geometry::Aabb;
use homcull::occlusion::{Occluder, OcclusionBuffer, OcclusionSettings, Thresholds};
use homcull::raster::Facing;
use homcull::scene::PreparedScene;
use homcull::view::{Camera, View};
use homcull_simd::Level;
use oracle::random::Random;
use oracle::scenes::{Builder, KINDS, camera, city, flat_triangle, flat_view, viewport};
use oracle::state::{Difference, Drawn, State, begun, draw, for_levels, picture, same, submitted};

const SIZES: [(u32, u32); 9] =
    [(1, 1), (7, 5), (33, 31), (100, 1), (257, 129), (64, 64), (1, 100), (130, 97), (8, 256)];

/// Occluders of every sort, and a view of them; `far` allows a far plane.
fn world(r: &mut Random, round: usize, far: bool) -> (View, PreparedScene) {
    let (w, h) = SIZES[round % SIZES.len()];
    if r.chance(0.4) {
        let view = flat_view(viewport(w, h));
        let mut b = Builder::new();
        for _ in 0..8 {
            let soup: Vec<[Vec3; 3]> = (0..1 + r.below(40))
                .map(|_| {
                    let kind = r.below(KINDS);
                    flat_triangle(r, kind, w, h)
                })
                .collect();
            b.triangles(&soup, Facing::Both);
        }
        return (view, b.prepared());
    }
    let eye = Vec3::new(r.float(-9.0, 9.0), r.float(0.0, 9.0), r.float(-9.0, 9.0));
    let mut lens = camera(r, eye.as_dvec3());
    if !far {
        lens.far = None;
    } else {
        lens.far = Some(r.range(20.0, 60.0));
    }
    (lens.view(viewport(w, h)).unwrap(), PreparedScene::new(&city(r, eye, 40)).unwrap())
}

fn state(level: Level, view: &View, scene: &PreparedScene, occluders: &[Occluder]) -> State {
    State::of(&submitted(level, view, &scene.meshes, occluders), view)
}

#[track_caller]
fn never_nearer(what: &str, state: &State, drawn: &Drawn) {
    for at in 0..drawn.items.len() {
        let (x, y) = (at as u32 % drawn.width, at as u32 / drawn.width);
        let (kept, shown) = (f32::from_bits(state.depth[at]), drawn.depth(at));
        assert!(kept <= shown, "{what}: at ({x}, {y}) {kept:e} is kept, but {shown:e} drawn");
        assert_eq!(
            kept > 0.0,
            state.covered[at],
            "{what}: at ({x}, {y}) depth {kept:e}, covered {}",
            state.covered[at]
        );
    }
}

#[test]
fn what_is_kept_is_never_nearer_than_what_is_drawn_and_covers_the_same_samples() {
    let mut r = Random::new(1);
    let (mut exact, mut all) = (0, 0);
    for round in 0..90 {
        let (view, scene) = world(&mut r, round, false);
        let what = format!("round {round}");
        let state = for_levels(&what, |level| state(level, &view, &scene, &scene.occluders));
        let drawn = for_levels(&what, |level| draw(level, &view, &scene));
        if let Some(p) = picture(state.width, state.height, &state.covered, &drawn.covered()) {
            panic!("{what}: kept coverage, against drawn\n{p}");
        }
        never_nearer(&what, &state, &drawn);
        all += state.covered.iter().filter(|&&c| c).count();
        exact +=
            (0..drawn.items.len()).filter(|&i| state.covered[i] && state.depth[i] == drawn.depth(i).to_bits()).count();
    }
    println!("{exact} of {all} covered samples keep exactly the drawn depth");
    assert!(exact * 10 > all, "{exact} of {all}: what is kept is far too far");
}

#[test]
fn with_a_far_plane_nothing_is_kept_that_is_not_drawn() {
    let mut r = Random::new(2);
    for round in 0..60 {
        let (view, scene) = world(&mut r, round, true);
        let what = format!("round {round}");
        let state = for_levels(&what, |level| state(level, &view, &scene, &scene.occluders));
        let drawn = for_levels(&what, |level| draw(level, &view, &scene));
        never_nearer(&what, &state, &drawn);
    }
}

#[test]
fn the_state_does_not_depend_on_order_pieces_bands_or_early_outs() {
    let mut r = Random::new(3);
    for round in 0..54 {
        let (view, scene) = world(&mut r, round, round % 4 == 0);
        let gold = for_levels("in order", |level| state(level, &view, &scene, &scene.occluders));
        let hash = submitted(Level::Scalar, &view, &scene.meshes, &scene.occluders).state_hash();
        let mut reversed = scene.occluders.clone();
        reversed.reverse();
        let shuffled = r.shuffled(&scene.occluders);
        let orders = [("in order", &scene.occluders), ("reversed", &reversed), ("shuffled", &shuffled)];
        for (order, occluders) in orders {
            for cluster_test in [true, false] {
                for bands in [0, 1, 2, 3, 5, 7] {
                    let what = format!("round {round}, {order}, cluster test {cluster_test}, {bands} bands");
                    let is = for_levels(&what, |level| {
                        let settings = OcclusionSettings { cluster_test, ..OcclusionSettings::default() };
                        let mut buffer = begun(level, &view, settings);
                        if bands == 0 {
                            for piece in occluders.chunks(3) {
                                buffer.submit(&scene.meshes, piece).unwrap();
                            }
                        } else {
                            // The last job first, and the first left to the library.
                            let run = |jobs: &mut [homcull::occlusion::BandJob<'_>]| {
                                jobs.iter_mut().skip(1).rev().for_each(|j| j.run());
                            };
                            buffer.submit_in_bands(&scene.meshes, occluders, bands, run).unwrap();
                        }
                        assert_eq!(buffer.state_hash(), hash, "{what}: state hash at {}", level.name());
                        State::of(&buffer, &view)
                    });
                    same(&what, &is, &gold);
                }
            }
        }
    }
}

#[test]
fn a_second_view_finds_nothing_of_the_first() {
    let mut r = Random::new(4);
    for round in 0..SIZES.len() {
        let (first, a) = world(&mut r, round, false);
        let (second, b) = world(&mut r, round, false);
        let is = for_levels("the second of two views", |level| {
            let mut buffer = submitted(level, &first, &a.meshes, &a.occluders);
            buffer.begin(&second).unwrap();
            let empty = State::of(&buffer, &second);
            assert!(!empty.covered.contains(&true), "round {round}: a new view begins covered");
            buffer.submit(&b.meshes, &b.occluders).unwrap();
            State::of(&buffer, &second)
        });
        same(&format!("round {round}"), &is, &state(Level::Scalar, &second, &b, &b.occluders));
    }
}

#[test]
fn the_map_alone_covers_what_the_map_with_depth_covers() {
    let mut r = Random::new(5);
    for round in 0..36 {
        let (view, scene) = world(&mut r, round, false);
        let gold = state(Level::Scalar, &view, &scene, &scene.occluders);
        let is = for_levels("coverage alone", |level| {
            let mut buffer =
                begun(level, &view, OcclusionSettings { keep_depth: false, ..OcclusionSettings::default() });
            buffer.submit(&scene.meshes, &scene.occluders).unwrap();
            State::of(&buffer, &view).covered
        });
        if let Some(p) = picture(gold.width, gold.height, &is, &gold.covered) {
            panic!("round {round}\n{p}");
        }
    }
}

#[test]
fn what_is_not_opaque_does_not_occlude() {
    let mut r = Random::new(6);
    for round in 0..12 {
        let (view, mut scene) = world(&mut r, round, false);
        scene.occluders.iter_mut().step_by(2).for_each(|o| o.opaque = false);
        let opaque: Vec<Occluder> = scene.occluders.iter().filter(|o| o.opaque).copied().collect();
        let is = for_levels("glass", |level| state(level, &view, &scene, &scene.occluders));
        same(&format!("round {round}"), &is, &state(Level::Scalar, &view, &scene, &opaque));
    }
}

/// Hole counts of all levels, by counting samples: width, height, counts.
fn counted_holes(state: &State) -> Vec<(usize, usize, Vec<u32>)> {
    let (w, h) = (state.width as usize, state.height as usize);
    let mut out = Vec::new();
    let mut side = 8;
    loop {
        let (nx, ny) = (w.div_ceil(side), h.div_ceil(side));
        let mut holes = vec![0; nx * ny];
        for (at, covered) in state.covered.iter().enumerate() {
            holes[at / w / side * nx + at % w / side] += u32::from(!covered);
        }
        out.push((nx, ny, holes));
        if nx == 1 && ny == 1 {
            return out;
        }
        side *= 2;
    }
}

fn pyramid_holes(buffer: &mut OcclusionBuffer) -> Vec<(usize, usize, Vec<u32>)> {
    let pyramid = buffer.pyramid();
    (0..pyramid.levels())
        .map(|level| {
            let (nx, ny) = pyramid.size(level);
            let holes = (0..nx * ny).map(|i| pyramid.holes(level, i % nx, i / nx)).collect();
            (nx, ny, holes)
        })
        .collect()
}

#[test]
fn the_pyramid_counts_the_holes_of_every_level() {
    let mut r = Random::new(7);
    for round in 0..45 {
        let (view, scene) = world(&mut r, round, false);
        let what = format!("round {round}");
        let holes = for_levels(&what, |level| {
            let mut buffer = begun(level, &view, OcclusionSettings::default());
            same(
                &format!("{what}: nothing drawn"),
                &pyramid_holes(&mut buffer),
                &counted_holes(&State::of(&buffer, &view)),
            );
            // Step by step: only what changed is computed anew.
            for piece in scene.occluders.chunks(5) {
                buffer.submit(&scene.meshes, piece).unwrap();
                same(&what, &pyramid_holes(&mut buffer), &counted_holes(&State::of(&buffer, &view)));
            }
            let stepwise = pyramid_holes(&mut buffer);
            buffer.mark_all_changed();
            same(&format!("{what}: a whole build"), &stepwise, &pyramid_holes(&mut buffer));
            stepwise
        });
        // At once, and with tests that keep it in step.
        let at_once = for_levels(&what, |level| {
            let settings =
                OcclusionSettings { thresholds: Thresholds::uniform(0.8).unwrap(), ..OcclusionSettings::default() };
            let mut buffer = begun(level, &view, settings);
            buffer.submit_in_bands(&scene.meshes, &scene.occluders, 3, |_| {}).unwrap();
            pyramid_holes(&mut buffer)
        });
        same(&format!("{what}: at once"), &at_once, &holes);
    }
}

#[test]
fn opacity_is_one_minus_the_share_of_holes_inside_the_viewport() {
    let mut r = Random::new(8);
    let (view, scene) = world(&mut r, 2, false);
    let (w, h) = (view.viewport().width() as usize, view.viewport().height() as usize);
    let mut buffer = submitted(Level::best(), &view, &scene.meshes, &scene.occluders);
    let pyramid = buffer.pyramid();
    for level in 0..pyramid.levels() {
        let ((nx, ny), side) = (pyramid.size(level), 8 << level);
        assert_eq!(pyramid.pixel(level), (side, side));
        for (x, y) in (0..ny).flat_map(|y| (0..nx).map(move |x| (x, y))) {
            let samples = (w.min((x + 1) * side) - x * side) * (h.min((y + 1) * side) - y * side);
            let should = 1.0 - f64::from(pyramid.holes(level, x, y)) / samples as f64;
            assert_eq!(pyramid.opacity(level, x, y), should, "level {level}, pixel ({x}, {y})");
        }
    }
}

/// A wall that fills a view along -z, and a box behind it.
fn wall() -> (View, PreparedScene, Aabb) {
    let lens = Camera { eye: DVec3::ZERO, target: DVec3::NEG_Z, up: DVec3::Y, fov_y_deg: 60.0, near: 0.1, far: None };
    let mut b = Builder::new();
    b.cuboid(Vec3::new(-50.0, -50.0, -6.0), Vec3::new(50.0, 50.0, -5.0), Facing::Both);
    let behind = Aabb { min: Vec3::new(-2.0, -2.0, -21.0), max: Vec3::new(2.0, 2.0, -20.0) };
    (lens.view(viewport(128, 96)).unwrap(), b.prepared(), behind)
}

fn with_threshold(t: f64) -> OcclusionSettings {
    OcclusionSettings { thresholds: Thresholds::uniform(t).unwrap(), ..OcclusionSettings::default() }
}

#[test]
fn a_new_view_begins_open_at_every_threshold() {
    let (view, scene, behind) = wall();
    for t in [1.0, 0.9, 0.3] {
        let hidden = for_levels("a wall", |level| {
            let mut buffer = begun(level, &view, with_threshold(t));
            buffer.submit(&scene.meshes, &scene.occluders).unwrap();
            let first = buffer.test(behind, DVec3::ZERO).unwrap().is_hidden();
            buffer.begin(&view).unwrap();
            vec![first, buffer.test(behind, DVec3::ZERO).unwrap().is_hidden()]
        });
        assert_eq!(hidden, [true, false], "threshold {t}: hidden behind the wall; hidden when nothing has been drawn");
    }
}

#[test]
fn a_buffer_is_open_at_every_threshold_before_anything_is_drawn() {
    let (view, _, behind) = wall();
    for t in [1.0, 0.9, 0.3] {
        let hidden = for_levels("nothing", |level| {
            let buffer = begun(level, &view, with_threshold(t));
            vec![buffer.test(behind, DVec3::ZERO).unwrap().is_hidden()]
        });
        assert_eq!(hidden, [false], "threshold {t}: hidden when nothing has been drawn");
    }
}

#[test]
fn a_threshold_changed_after_drawing_holds_from_the_next_test() {
    // The wall fills the first view; in the second it stands far to the side.
    let (view, scene, behind) = wall();
    let mut aside = scene.occluders.clone();
    aside[0].position = DVec3::new(500.0, 0.0, 0.0);
    let hidden = for_levels("two views", |level| {
        let mut buffer = begun(level, &view, OcclusionSettings::default());
        buffer.submit(&scene.meshes, &scene.occluders).unwrap();
        buffer.set_settings(with_threshold(0.9)).unwrap();
        let first = buffer.test(behind, DVec3::ZERO).unwrap().is_hidden();
        let _ = buffer.pyramid();
        buffer.set_settings(OcclusionSettings::default()).unwrap();
        buffer.begin(&view).unwrap();
        buffer.submit(&scene.meshes, &aside).unwrap();
        buffer.set_settings(with_threshold(0.9)).unwrap();
        vec![first, buffer.test(behind, DVec3::ZERO).unwrap().is_hidden()]
    });
    assert_eq!(hidden, [true, false], "hidden behind the wall; hidden where nothing stands");
}

#[test]
fn a_view_of_another_size_is_refused_and_so_is_work_before_a_view() {
    let (view, scene, behind) = wall();
    let mut buffer = OcclusionBuffer::new(viewport(64, 64));
    assert!(buffer.begin(&view).is_err());
    assert!(buffer.submit(&scene.meshes, &scene.occluders).is_err());
    assert!(buffer.test(behind, DVec3::ZERO).is_err());
    let empty: Option<String> = vec![1].difference(&vec![1]);
    assert_eq!(empty, None);
}
