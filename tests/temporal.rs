//! Temporal coherence (thesis 7.4): equation 7.1, its hazards (figure 7.4), its claim, the lag of its feedback, and resets.
#![cfg(feature = "bvh")]

mod oracle;

use std::collections::BTreeSet;

use glam::{DVec3, Vec3};
use homcull::cull::hom::{self, HomFrame};
use homcull::cull::vfc::World;
use homcull::cull::{HomParameters, Selection, Update};
use homcull::raster::Facing;
use homcull::scene::PreparedScene;
use homcull::select::{Occluded, temporal_candidates};
use homcull::view::{Camera, View};
use homcull::workers::Workers;
use homcull_simd::Level;
use oracle::float::{self, Answer};
use oracle::random::Random;
use oracle::scenes::{Builder, camera, city, cuboid_corners, viewport};
use oracle::state::{draw, draw_in, same};

#[test]
fn the_candidates_are_those_of_equation_7_1() {
    let mut r = Random::new(1);
    for round in 0..200 {
        let n = 1 + r.below(300) as u32;
        let chance = [0.0, 0.1, 0.5, 0.9, 1.0][round % 5];
        let mut some = |of: &mut dyn FnMut(u32) -> bool| -> BTreeSet<u32> {
            (0..n).filter(|&id| r.chance(chance) && of(id)).collect()
        };
        let before = some(&mut |_| true);
        let visible = some(&mut |id| before.contains(&id));
        let now = some(&mut |_| true);
        // Both lines of the equation, the second one bracketed; `before` and `now` are F, `visible` is V of before.
        let entered = &now - &(&now & &before);
        let stayed_in_sight = &(&now & &before) & &visible;
        let first: BTreeSet<u32> = &entered | &stayed_in_sight;
        let second = &entered | &(&now & &visible);
        assert_eq!(first, second);

        let mut occluded = Occluded::default();
        occluded.clear(n as usize);
        (&before - &visible).into_iter().for_each(|id| occluded.insert(id));
        let is: BTreeSet<u32> = temporal_candidates(now.iter().copied(), &occluded).collect();
        assert_eq!(is, first, "round {round}");
        occluded.forget();
        assert!(temporal_candidates(now.iter().copied(), &occluded).eq(now.iter().copied()));
    }
}

fn look(eye: DVec3, degrees: f64) -> View {
    let (s, c) = degrees.to_radians().sin_cos();
    let target = eye + DVec3::new(s, 0.0, -c);
    let lens = Camera { eye, target, up: DVec3::Y, fov_y_deg: 60.0, near: 0.1, far: None };
    lens.view(viewport(160, 96)).unwrap()
}

fn with(select: Selection, lag: u32) -> HomParameters {
    HomParameters { select, lag: Some(lag), rest: 0, ..HomParameters::new(Update::Once) }
}

/// What a frame chose and what it drew.
#[derive(Debug, Clone, PartialEq)]
struct Frame {
    occluders: Vec<u32>,
    drawn: BTreeSet<u32>,
}

/// Walks some views; every picture must be that of everything.
fn walk(scene: &PreparedScene, parameters: &HomParameters, views: &[View], resets: &[usize]) -> Vec<Frame> {
    let (world, workers, level) = (World::new(scene), Workers::new(1).unwrap(), Level::best());
    let mut frame = HomFrame::new(&views[0], level, parameters).unwrap();
    let mut out = Vec::new();
    for (n, view) in views.iter().enumerate() {
        if resets.contains(&n) {
            frame.reset();
        }
        frame = hom::select_occluders(&world, level, view, parameters, frame).unwrap();
        frame = hom::build_pyramid(hom::draw_occluders(&world, &workers, frame).unwrap());
        let occluders = frame.chosen().to_vec();
        let set;
        (set, frame) = hom::cull(&world, &workers, parameters, frame).unwrap();
        same(&format!("frame {n}"), &draw_in(level, view, scene, &set.objects, 1), &draw(level, view, scene));
        out.push(Frame { occluders, drawn: set.objects.into_iter().collect() });
    }
    out
}

/// Boxes by their middle and half their size; ids in the order given.
fn boxes(list: &[([f32; 3], [f32; 3])]) -> PreparedScene {
    let mut b = Builder::new();
    for &(middle, half) in list {
        let (middle, half) = (Vec3::from(middle), Vec3::from(half));
        b.cuboid(middle - half, middle + half, Facing::Both);
    }
    b.prepared()
}

/// A box at an angle to the right of straight ahead, `distance` away.
fn at(degrees: f32, distance: f32, half: f32) -> ([f32; 3], [f32; 3]) {
    let (s, c) = degrees.to_radians().sin_cos();
    ([s * distance, 0.0, -c * distance], [half; 3])
}

#[test]
fn figure_7_4_a_what_enters_the_frustum_is_a_candidate_and_occludes_at_once() {
    // E hides F in both frames. A, with B, C and D behind it, enters as the viewer turns right by 60 degrees.
    let (a, b, c, d, e, f) = (0, 1, 2, 3, 4, 5);
    let (at_80, at_20) = (at(80.0, 8.0, 3.0), at(20.0, 8.0, 2.0));
    let scene =
        boxes(&[at_80, at(80.0, 20.0, 1.0), at(80.0, 25.0, 1.0), at(80.0, 30.0, 1.0), at_20, at(20.0, 20.0, 1.0)]);
    let views = [look(DVec3::ZERO, 0.0), look(DVec3::ZERO, 50.0)];
    let frames = walk(&scene, &with(Selection::Temporal, 1), &views, &[]);
    assert_eq!(frames[0].occluders, [e, f], "at first all in the frustum, nearest first");
    assert_eq!(frames[0].drawn, BTreeSet::from([e]));
    let chosen: BTreeSet<u32> = frames[1].occluders.iter().copied().collect();
    assert_eq!(chosen, BTreeSet::from([a, b, c, d, e]), "F stays occluded and is no candidate; A to D have just come");
    assert_eq!(frames[1].drawn, BTreeSet::from([a, e]), "A hides B, C and D in the frame in which it comes");
}

#[test]
fn figure_7_4_b_what_comes_out_from_behind_is_a_candidate_one_frame_late() {
    // W hides A, and B, C, D behind A, until the viewer has stepped to the right.
    let (w, a, b, c, d) = (0, 1, 2, 3, 4);
    let ahead = |z: f32, half: f32| ([0.0, 0.0, z], [half, half, 0.5]);
    let scene = boxes(&[ahead(-4.0, 2.0), ahead(-10.0, 3.0), ahead(-12.0, 1.0), ahead(-14.0, 1.0), ahead(-16.0, 1.0)]);
    let aside = look(DVec3::new(6.0, 0.0, 0.0), -25.0);
    let views = [look(DVec3::ZERO, 0.0), aside, aside];
    let temporal = walk(&scene, &with(Selection::Temporal, 1), &views, &[]);
    assert_eq!(temporal[0].drawn, BTreeSet::from([w]));
    assert_eq!(temporal[1].occluders, [w], "all others were occluded and are no candidates");
    assert_eq!(temporal[1].drawn, BTreeSet::from([w, a, b, c, d]), "the hazard: nothing is culled in this frame");
    assert!(temporal[2].occluders.contains(&a));
    assert_eq!(temporal[2].drawn, BTreeSet::from([w, a]), "one frame later all is well");
    let distance = walk(&scene, &with(Selection::Distance(Default::default()), 1), &views, &[]);
    assert_eq!(distance[1].drawn, BTreeSet::from([w, a]), "without coherence there is no such frame");
}

#[test]
fn what_is_occluded_does_not_use_up_the_limit() {
    // A wall hides a hundred near boxes on the left; on the right, farther away, G hides H.
    let mut list = vec![([-6.0, 0.0, -6.0], [5.0, 5.0, 0.2])];
    list.extend((0..100).map(|i| ([-5.0 + 0.04 * i as f32, 0.0, -8.0], [0.1; 3])));
    let (g, h) = (101, 102);
    list.extend([([8.0, 0.0, -14.0], [3.0; 3]), ([12.0, 0.0, -22.0], [0.5; 3])]);
    let scene = boxes(&list);
    let views = [look(DVec3::ZERO, 0.0); 3];
    let limited = |select| HomParameters { occluder_triangles: 600, ..with(select, 1) };
    let distance = walk(&scene, &limited(Selection::Distance(Default::default())), &views, &[]);
    assert!(distance.iter().all(|f| !f.occluders.contains(&g) && f.drawn.contains(&h)), "the limit goes to the hidden");
    let temporal = walk(&scene, &limited(Selection::Temporal), &views, &[]);
    assert_eq!(temporal[0], distance[0], "a cold start is distance selection");
    assert!(temporal[1].occluders.contains(&g) && !temporal[1].drawn.contains(&h));
}

#[test]
fn what_a_frame_found_is_heard_lag_frames_later_and_never_before_or_across_a_reset() {
    let (near, far) = (0, 1);
    let scene = boxes(&[([0.0, 0.0, -5.0], [2.0; 3]), ([0.0, 0.0, -15.0], [1.0; 3])]);
    let views = [look(DVec3::ZERO, 0.0); 24];
    for lag in [1, 2, 3, 5] {
        let frames = walk(&scene, &with(Selection::Temporal, lag as u32), &views, &[11, 12]);
        for (n, frame) in frames.iter().enumerate() {
            let since = if n < 11 { 0 } else { [11, 12][usize::from(n >= 12)] };
            let should = if n - since < lag { vec![near, far] } else { vec![near] };
            assert_eq!(frame.occluders, should, "lag {lag}, frame {n}");
        }
    }
}

#[test]
fn a_lag_is_one_to_sixty_frames() {
    let view = look(DVec3::ZERO, 0.0);
    for (lag, pipeline, fine) in [(0, false, false), (1, false, true), (60, false, true), (61, false, false)]
        .into_iter()
        .chain([(1, true, false), (2, true, false), (3, true, true), (60, true, true), (61, true, false)])
    {
        let parameters = HomParameters { pipeline, ..with(Selection::Temporal, lag) };
        let made = HomFrame::new(&view, Level::best(), &parameters);
        assert_eq!(made.is_ok(), fine, "lag {lag}, pipeline {pipeline}");
    }
}

#[test]
fn pictures_stay_the_same_whatever_is_remembered() {
    let mut r = Random::new(3);
    let (mut fewer, mut all) = (0, 0);
    for round in 0..18 {
        let mut eye = DVec3::new(r.range(-9.0, 9.0), r.range(0.0, 5.0), r.range(-9.0, 9.0));
        let scene = PreparedScene::new(&city(&mut r, eye.as_vec3(), 70)).unwrap();
        let mut lens = camera(&mut r, eye);
        let views: Vec<View> = (0..6)
            .map(|_| {
                eye += DVec3::new(r.range(-2.0, 2.0), 0.0, r.range(-2.0, 2.0));
                lens = Camera { eye, target: lens.target + DVec3::new(r.range(-1.0, 1.0), 0.0, 0.0), ..lens };
                lens.view(viewport(97, 65)).unwrap()
            })
            .collect();
        let lag = 1 + round as u32 % 3;
        // `walk` compares the pictures.
        let frames = walk(&scene, &with(Selection::Temporal, lag), &views, &[]);
        let distance = walk(&scene, &with(Selection::Distance(Default::default()), lag), &views, &[]);
        fewer += frames.iter().map(|f| f.occluders.len()).sum::<usize>();
        all += distance.iter().map(|f| f.occluders.len()).sum::<usize>();
    }
    println!("{fewer} occluders with temporal coherence, {all} without");
    assert!(fewer < all);
}

/// Samples that show each object, by a rasterizer in f64 that knows nothing of the library's.
fn oracle_samples(view: &View, boxes: &[(Vec3, Vec3)], triangles: &[[u32; 3]]) -> Vec<u32> {
    let (w, h) = (view.viewport().width(), view.viewport().height());
    let mut nearest = vec![(0.0, usize::MAX); (w * h) as usize];
    for (id, &(min, max)) in boxes.iter().enumerate() {
        let corners = cuboid_corners(min, max).map(|p| float::clip(view, p.as_dvec3()));
        for t in triangles {
            let corners = t.map(|i| corners[i as usize]);
            let Some(triangle) = float::Triangle::new(corners) else { continue };
            for at in within(corners, w, h) {
                let (x, y) = (float::center(at % w), float::center(at / w));
                if triangle.at(x, y, 0.0) != Answer::Outside && triangle.depth(x, y) > nearest[at as usize].0 {
                    nearest[at as usize] = (triangle.depth(x, y), id);
                }
            }
        }
    }
    let mut samples = vec![0; boxes.len()];
    nearest.iter().filter(|n| n.1 < boxes.len()).for_each(|n| samples[n.1] += 1);
    samples
}

/// The samples of a rectangle around a triangle; all of them when it crosses the near plane, none when it is behind it.
fn within(corners: [[f64; 5]; 3], w: u32, h: u32) -> impl Iterator<Item = u32> {
    let (cut, behind) = (corners.iter().any(|c| c[4] <= 0.0), corners.iter().all(|c| c[4] <= 0.0));
    let (w, h) = if behind { (0, 0) } else { (w, h) };
    let range = move |axis: usize, n: u32| {
        let at = corners.map(|c| (c[axis] / c[2] / 256.0).clamp(0.0, n.into()));
        let low = at.into_iter().fold(f64::INFINITY, f64::min).floor() as u32;
        let high = at.into_iter().fold(0.0, f64::max).ceil() as u32;
        if cut { 0..n } else { low..high.min(n) }
    };
    range(1, h).flat_map(move |y| range(0, w).map(move |x| y * w + x))
}

/// Whether a box is wholly in the frustum: all its corners on the inner side of all planes.
fn wholly_inside(view: &View, (min, max): (Vec3, Vec3)) -> bool {
    let (w, h) = (f64::from(view.viewport().width()) * 256.0, f64::from(view.viewport().height()) * 256.0);
    cuboid_corners(min, max).iter().all(|p| {
        let [x, y, pw, _, near] = float::clip(view, p.as_dvec3());
        near > 0.0 && (0.0..=w * pw).contains(&x) && (0.0..=h * pw).contains(&y)
    })
}

/// The claim is one about areas; samples can miss what shows through a slit. Where *occluded* is what shows no sample of a grid
/// four times as fine, exceptions are of at most two samples, and counted. Where it is what shows no plain sample, they are of up to
/// four: the claim does not hold of samples within two, as it is stated. Both are held to what was found.
#[test]
fn what_is_occluded_stays_so_while_the_viewer_turns_in_place() {
    let mut r = Random::new(7);
    let (mut pairs, mut by_library, mut exceptions) = (0, 0, Vec::new());
    let (mut between, mut plain_exceptions) = (0, Vec::new());
    for round in 0..8 {
        // Boxes all around, none nearer than the near plane reaches, at whatever angle the viewer stands.
        let boxes: Vec<(Vec3, Vec3)> = (0..150)
            .map(|_| {
                let (s, c) = r.range(0.0, std::f64::consts::TAU).sin_cos();
                let distance = r.range(5.0, 30.0);
                let middle = Vec3::new((s * distance) as f32, r.float(-3.0, 3.0), (c * distance) as f32);
                let half = Vec3::new(r.float(0.3, 1.3), r.float(0.3, 2.5), r.float(0.3, 1.3));
                (middle - half, middle + half)
            })
            .collect();
        let mut b = Builder::new();
        boxes.iter().for_each(|&(min, max)| {
            b.cuboid(min, max, Facing::Both);
        });
        let scene = b.prepared();
        let up = DVec3::new(r.range(-0.3, 0.3), 1.0, r.range(-0.3, 0.3));
        let (mut heading, turn) = (r.range(0.0, 6.0), r.range(0.05, 0.3));
        let lenses: Vec<Camera> = (0..5)
            .map(|_| {
                heading += turn;
                let target = DVec3::new(heading.sin(), r.range(-0.2, 0.2), heading.cos());
                Camera { eye: DVec3::ZERO, target, up, fov_y_deg: 80.0, near: 0.1, far: None }
            })
            .collect();
        let seen = |scale: u32| -> Vec<(View, Vec<u32>)> {
            let views = lenses.iter().map(|lens| lens.view(viewport(72 * scale, 56 * scale)).unwrap());
            views.map(|view| (view, oracle_samples(&view, &boxes, &oracle::scenes::CUBOID))).collect()
        };
        let (plain, fine) = (seen(1), seen(4));
        let views: Vec<View> = plain.iter().map(|p| p.0).collect();
        let frames = walk(&scene, &with(Selection::Temporal, 1), &views, &[]);
        for n in 0..views.len() - 1 {
            let both = |b| wholly_inside(&views[n], b) && wholly_inside(&views[n + 1], b);
            for (id, _) in boxes.iter().enumerate().filter(|&(_, &b)| both(b)) {
                let (now, next) = (plain[n].1[id], plain[n + 1].1[id]);
                let culled = !frames[n].drawn.contains(&(id as u32));
                assert!(!culled || now == 0, "round {round}, frame {n}, object {id} is culled and shows {now} samples");
                if fine[n].1[id] == 0 {
                    pairs += 1;
                    by_library += usize::from(culled);
                    exceptions.extend((next > 0).then_some((round, n, id, next)));
                } else if now == 0 {
                    between += 1;
                    plain_exceptions.extend((next > 0).then_some((round, n, id, next)));
                }
            }
        }
    }
    println!("{pairs} objects occluded in a frame and in both frusta, {by_library} of them culled by the library;");
    println!(
        "{} of them show samples in the next frame: (round, frame, object, samples) {exceptions:?}",
        exceptions.len()
    );
    println!(
        "{between} others show between samples only; those that show samples in the next frame: {plain_exceptions:?}"
    );
    assert!(pairs > 250 && by_library > 200, "{pairs}, {by_library}: the scenes prove nothing");
    assert!(exceptions.iter().all(|e| e.3 <= 2), "more than 2 samples of what was occluded: {exceptions:?}");
    assert!(plain_exceptions.iter().all(|e| e.3 <= 4), "slits have grown: {plain_exceptions:?}");
    assert!(plain_exceptions.len() <= 7, "{} of {between}: {plain_exceptions:?}", plain_exceptions.len());
    assert!(exceptions.len() * 50 <= pairs, "{} of {pairs} are too many to lie between samples", exceptions.len());
}
