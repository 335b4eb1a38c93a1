//! The depth representations of the thesis's chapter 6 can be exchanged for each other: each is what it is defined to be, all are conservative,
//! and they lose what the thesis says they lose.

mod oracle;

use glam::{DVec3, Vec3};
use homcull::geometry::Aabb;
use homcull::occlusion::{
    DepthReading, DepthRepresentation, Hidden, Occluder, Occluders, OcclusionBuffer, OcclusionSettings, Partitions,
    ProjectedBoxes, Thresholds, Verdict, Visible,
};
use homcull::raster::Facing;
use homcull::scene::{PreparedScene, Scene};
use homcull::view::{Camera, View};
use homcull_simd::Level;
use oracle::float::clip;
use oracle::random::Random;
use oracle::scenes::{Builder, KINDS, city, flat_triangle, flat_view, viewport};
use oracle::state::{State, begun, draw_in, for_levels, same};
use oracle::verdicts::{any_view, behind_walls, conservative, samples, verdicts, world};

const NBZ: DepthRepresentation = DepthRepresentation::NoBackground(DepthReading::PerSample);

fn deb(width: u32, height: u32) -> DepthRepresentation {
    DepthRepresentation::Estimation(Partitions::new(width, height).unwrap())
}

fn settings(depth: DepthRepresentation) -> OcclusionSettings {
    OcclusionSettings { depth, ..OcclusionSettings::default() }
}

fn holding(
    level: Level,
    view: &View,
    scene: &PreparedScene,
    occluders: &[Occluder],
    depth: DepthRepresentation,
) -> OcclusionBuffer {
    let mut buffer = begun(level, view, settings(depth));
    buffer.submit(&scene.meshes, occluders).unwrap();
    buffer
}

/// The occluders by the distance of their boxes, without those around the eye.
fn nearest(view: &View, scene: &PreparedScene, count: usize) -> Vec<Occluder> {
    let eye = (view.eye() - scene.origin).as_vec3();
    let mut near: Vec<(f32, usize)> = (scene.bounds.iter().map(|b| b.distance_squared(eye)).zip(0..)).collect();
    near.retain(|&(distance, _)| distance > 0.0);
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    near.iter().take(count).map(|&(_, id)| scene.occluders[id]).collect()
}

#[test]
fn what_a_far_boundary_hides_behind_walls_shows_no_sample() {
    let mut r = Random::new(60);
    let mut culled = std::collections::BTreeMap::new();
    for round in 0..45 {
        let (walls, view, scene) = behind_walls(&mut r, round);
        for depth in [deb(64, 64), deb(7, 5), deb(400, 300), DepthRepresentation::Plane] {
            let what = format!("round {round}, {depth:?}");
            let all = for_levels(&what, |level| {
                verdicts(&holding(level, &view, &scene, &scene.occluders[..walls], depth), &scene)
            });
            conservative(&what, &view, &scene, &all);
            let behind = all.iter().filter(|&&v| v == Verdict::Hidden(Hidden::OverlapAndDepth)).count();
            *culled.entry(format!("{depth:?}")).or_insert(0) += behind;
        }
    }
    println!("{culled:?}");
    assert!(culled.len() == 4 && culled.values().all(|&n| n > 200), "too few are culled: {culled:?}");
}

#[test]
fn what_a_far_boundary_hides_in_a_city_shows_no_sample() {
    let mut r = Random::new(61);
    for round in 0..48 {
        let (view, scene) = world(&mut r, round, 90);
        let some = match round % 3 {
            0 => scene.occluders.clone(),
            1 => scene.occluders.iter().filter(|_| r.chance(0.2)).copied().collect(),
            _ => nearest(&view, &scene, 12),
        };
        for depth in [deb(64, 64), deb(7, 5), deb(400, 300), DepthRepresentation::Plane] {
            let what = format!("round {round}, {depth:?}");
            let all = for_levels(&what, |level| verdicts(&holding(level, &view, &scene, &some, depth), &scene));
            conservative(&what, &view, &scene, &all);
        }
    }
}

/// Draws each object alone and demands the far boundary at, or beyond, each of its samples; gives the samples looked at.
fn no_sample_lies_beyond_its_boundary(what: &str, view: &View, scene: &PreparedScene) -> usize {
    let size = view.viewport();
    let mut buffer = begun(Level::best(), view, settings(deb(size.width(), size.height())));
    let mut looked_at = 0;
    for id in 0..scene.occluders.len() as u32 {
        buffer.begin(view).unwrap();
        buffer.submit(&scene.meshes, &scene.occluders[id as usize..][..1]).unwrap();
        let drawn = draw_in(Level::best(), view, scene, &[id], 1);
        for at in (0..drawn.items.len()).filter(|&at| drawn.items[at].is_some()) {
            let (x, y) = (at as u32 % drawn.width, at as u32 / drawn.width);
            let boundary = buffer.depth_at(x, y).unwrap();
            assert!(
                boundary <= drawn.depth(at),
                "{what}, object {id} {:?}: at ({x}, {y}) the boundary is {boundary:e}, the object {:e}",
                scene.bounds[id as usize],
                drawn.depth(at)
            );
            looked_at += 1;
        }
    }
    looked_at
}

#[test]
fn no_sample_of_an_occluder_lies_outside_its_far_rectangle_or_beyond_it() {
    let mut r = Random::new(62);
    let mut looked_at = 0;
    for round in 0..24 {
        let (view, scene) = world(&mut r, round, 60);
        looked_at += no_sample_lies_beyond_its_boundary(&format!("round {round}"), &view, &scene);
    }
    println!("{looked_at} samples");
    assert!(looked_at > 50_000, "only {looked_at} samples were looked at");
}

#[test]
fn triangles_that_break_rasterizers_do_not_leave_their_far_rectangles() {
    let mut r = Random::new(63);
    for round in 0..12 {
        let (w, h) = [(64, 48), (33, 70), (1, 1), (128, 3)][round % 4];
        let view = flat_view(viewport(w, h));
        let mut b = Builder::new();
        for kind in 0..KINDS {
            for _ in 0..6 {
                b.triangles(&[flat_triangle(&mut r, kind, w, h)], Facing::Both);
            }
        }
        no_sample_lies_beyond_its_boundary(&format!("flat, round {round}"), &view, &b.prepared());
    }
}

#[test]
fn triangles_through_the_near_plane_far_from_the_origin_and_turned_do_not_either() {
    let mut r = Random::new(64);
    let mut looked_at = 0;
    for round in 0..36 {
        let eye = DVec3::new(r.range(-1.0, 1.0), r.range(-1.0, 1.0), 0.0) * [1.0, 1e4, 1e7][round / 3 % 3];
        let view = any_view(&mut r, round, eye, (72, 40));
        let mut b = Builder::new();
        for n in 0..24 {
            // Meshes far from their own origin lose bits when they are turned.
            let far_off = [0.0, 30.0, 3000.0][n % 3];
            let base = Vec3::new(r.float(-1.0, 1.0), r.float(-1.0, 1.0), r.float(-1.0, 1.0)) * far_off;
            let reach = r.float(0.05, 4.0);
            let p =
                |r: &mut Random| base + Vec3::new(r.float(-1.0, 1.0), r.float(-1.0, 1.0), r.float(-1.0, 1.0)) * reach;
            let soup: Vec<[Vec3; 3]> = (0..1 + r.below(4)).map(|_| [p(&mut r), p(&mut r), p(&mut r)]).collect();
            let turn = glam::Mat3::from_axis_angle(oracle::scenes::direction(&mut r).as_vec3(), r.float(0.0, 6.0));
            let turn = turn * r.float(0.3, 2.0);
            let object = b.triangles(&soup, Facing::Both);
            object.rotation = if n % 2 == 0 { turn } else { glam::Mat3::IDENTITY };
            let at = object.rotation.as_dmat3() * base.as_dvec3();
            object.position = eye - at + DVec3::new(r.range(-6.0, 6.0), r.range(-6.0, 6.0), r.range(-6.0, 6.0));
        }
        looked_at += no_sample_lies_beyond_its_boundary(&format!("round {round}"), &view, &b.prepared());
    }
    println!("{looked_at} samples");
    assert!(looked_at > 20_000, "only {looked_at} samples were looked at");
}

/// An object's far rectangle in f64, in samples and exact depth; `None` when it reaches behind the near plane or close to it.
fn exact_far_rectangle(view: &View, scene: &Scene, id: usize) -> Option<([f64; 4], f64)> {
    let object = &scene.objects[id];
    let bounds = Aabb::around(scene.meshes[object.mesh as usize].positions().iter().copied());
    let at = oracle::scenes::cuboid_corners(bounds.min, bounds.max)
        .map(|c| clip(view, object.rotation.as_dmat3() * c.as_dvec3() + object.position));
    let greatest = at.iter().fold(0.0f64, |a, c| a.max(c[2].abs()));
    if at.iter().any(|c| c[4] < 0.01 * greatest) {
        return None;
    }
    let fold = |row: usize, f: fn(f64, f64) -> f64| at.iter().map(|c| c[row] / c[2]).reduce(f).unwrap();
    let sides = [fold(0, f64::min), fold(1, f64::min), fold(0, f64::max), fold(1, f64::max)];
    Some((sides.map(|v| v / 256.0), fold(3, f64::min)))
}

/// The depth estimation buffer sample by sample, with rectangles widened by so many samples; NaN where a partition holds no sample.
fn by_definition(view: &View, size: Partitions, rectangles: &[([f64; 4], f64)], widened: f64) -> Vec<f64> {
    let (w, h) = (view.viewport().width(), view.viewport().height());
    let mut depths = vec![f64::NAN; size.width() as usize * size.height() as usize];
    for (x, y) in (0..h).flat_map(|y| (0..w).map(move |x| (x, y))) {
        let (cx, cy) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
        let px = (0..size.width()).rfind(|&p| p * w <= x * size.width()).unwrap();
        let py = (0..size.height()).rfind(|&p| p * h <= y * size.height()).unwrap();
        let at = &mut depths[(py * size.width() + px) as usize];
        *at = at.min(f64::INFINITY);
        for ([x0, y0, x1, y1], far) in rectangles {
            let inside = |v: f64, low: f64, high: f64| low - widened <= v && v <= high + widened;
            if inside(cx, *x0, *x1) && inside(cy, *y0, *y1) && *far < *at {
                *at = *far;
            }
        }
    }
    depths
}

#[test]
fn the_depth_estimation_buffer_is_its_definition() {
    let mut r = Random::new(65);
    let (mut filled, mut empty) = (0, 0);
    for round in 0..24 {
        let eye = Vec3::new(r.float(-9.0, 9.0), r.float(0.0, 9.0), r.float(-9.0, 9.0));
        let scene = city(&mut r, eye, 60);
        let prepared = PreparedScene::new(&scene).unwrap();
        let view = any_view(&mut r, round, eye.as_dvec3(), [(96, 64), (50, 77)][round % 2]);
        let bounded: Vec<(usize, _)> = (0..scene.objects.len())
            .filter(|_| r.chance(0.3))
            .filter_map(|id| Some((id, exact_far_rectangle(&view, &scene, id)?)))
            .collect();
        let occluders: Vec<Occluder> = bounded.iter().map(|b| prepared.occluders[b.0]).collect();
        let rectangles: Vec<_> = bounded.iter().map(|b| b.1).collect();
        for size in [[64, 64], [16, 9], [1, 1], [130, 200]].map(|[w, h]| Partitions::new(w, h).unwrap()) {
            let buffer = holding(Level::best(), &view, &prepared, &occluders, DepthRepresentation::Estimation(size));
            let is = buffer.depth_estimation().unwrap();
            assert_eq!(is.partitions(), size);
            let (most, least) =
                (by_definition(&view, size, &rectangles, -0.25), by_definition(&view, size, &rectangles, 0.25));
            for (i, &depth) in is.depths().iter().enumerate().filter(|&(i, _)| !least[i].is_nan()) {
                let depth = f64::from(depth);
                let about =
                    format!("round {round}, {size:?}, partition {i}: {depth:e} of {:e} to {:e}", least[i], most[i]);
                // Beyond the far plane nothing is drawn: a boundary there stands on it.
                assert!(depth <= most[i].max(0.0), "{about}");
                assert!(depth == least[i] || depth >= least[i] - 1e-3 * least[i].abs() - 1e-5, "{about}");
                if depth == f64::INFINITY { empty += 1 } else { filled += 1 }
            }
        }
    }
    println!("{filled} partitions have an occluder, {empty} have none");
    assert!(filled > 10_000 && empty > 10_000, "{filled} filled, {empty} empty");
}

#[test]
fn the_order_the_rounds_and_the_bands_of_submission_do_not_matter() {
    let mut r = Random::new(66);
    for round in 0..18 {
        let (view, scene) = world(&mut r, round, 60);
        for depth in [deb(64, 64), deb(9, 4), DepthRepresentation::Plane] {
            let what = format!("round {round}, {depth:?}");
            let of = |buffer: &OcclusionBuffer| (State::of(buffer, &view), verdicts(buffer, &scene));
            let gold = for_levels(&what, |level| of(&holding(level, &view, &scene, &scene.occluders[..20], depth)));
            let hash = holding(Level::Scalar, &view, &scene, &scene.occluders[..20], depth).state_hash();
            let order = r.shuffled(&scene.occluders[..20]);
            let mut rounds = begun(Level::best(), &view, settings(depth));
            order.chunks(3).for_each(|chunk| rounds.submit(&scene.meshes, chunk).unwrap());
            same(&format!("{what}, in rounds"), &of(&rounds), &gold);
            assert_eq!(rounds.state_hash(), hash, "{what}, in rounds");
            for bands in [2, 3] {
                let mut buffer = begun(Level::best(), &view, settings(depth));
                buffer
                    .submit_in_bands(&scene.meshes, &order, bands, |jobs| jobs.iter_mut().for_each(|j| j.run()))
                    .unwrap();
                same(&format!("{what}, in {bands} bands"), &of(&buffer), &gold);
                assert_eq!(buffer.state_hash(), hash, "{what}, in {bands} bands");
            }
            // A view that begins anew knows nothing of the one before.
            rounds.begin(&view).unwrap();
            assert_eq!(rounds.state_hash(), begun(Level::best(), &view, settings(depth)).state_hash(), "{what}, anew");
        }
    }
}

fn hidden(view: &View, scene: &PreparedScene, occluders: &[Occluder], depth: DepthRepresentation) -> Vec<bool> {
    verdicts(&holding(Level::best(), view, scene, occluders, depth), scene).iter().map(|v| v.is_hidden()).collect()
}

#[test]
fn finer_partitions_hide_no_less_one_is_the_plane_and_none_hides_more_than_the_no_background_z_buffer() {
    let mut r = Random::new(67);
    let mut gained = vec![0; 9];
    for round in 0..48 {
        let (walls, view, scene) = behind_walls(&mut r, round);
        let some = &scene.occluders[..walls];
        let one = hidden(&view, &scene, some, deb(1, 1));
        assert_eq!(one, hidden(&view, &scene, some, DepthRepresentation::Plane), "round {round}: one partition");
        let mut before = one;
        for (step, depth) in (1..=7).map(|k| deb(1 << k, 1 << k)).chain([NBZ]).enumerate() {
            let now = hidden(&view, &scene, some, depth);
            let lost = (0..now.len()).find(|&id| before[id] && !now[id]);
            assert_eq!(lost, None, "round {round}: hidden by what is coarser than {depth:?}, but not by it");
            gained[step] += (0..now.len()).filter(|&id| now[id] && !before[id]).count();
            before = now;
        }
    }
    println!("gained from 2x2 to 128x128, and by the no-background Z-buffer: {gained:?}");
    assert!(gained.iter().sum::<usize>() > 100, "nothing was tested: {gained:?}");
}

#[test]
fn without_occluders_all_pass_the_depth_test_and_nothing_is_culled() {
    // Thesis 6.1.
    let mut r = Random::new(68);
    for round in 0..12 {
        let (view, scene) = world(&mut r, round, 60);
        for depth in
            [NBZ, DepthRepresentation::NoBackground(DepthReading::PerBlock), deb(64, 64), DepthRepresentation::Plane]
        {
            for occluders in [&[][..], &opaque(&scene, false)] {
                let buffer = holding(Level::best(), &view, &scene, occluders, depth);
                for (id, verdict) in verdicts(&buffer, &scene).into_iter().enumerate() {
                    let culled = matches!(verdict, Verdict::Hidden(Hidden::OverlapAndDepth));
                    assert!(!culled, "round {round}, {depth:?}: object {id} is culled");
                    assert_ne!(verdict, Verdict::Visible(Visible::InFront), "round {round}, {depth:?}: object {id}");
                }
            }
        }
    }
}

fn opaque(scene: &PreparedScene, opaque: bool) -> Vec<Occluder> {
    scene.occluders.iter().map(|&o| Occluder { opaque, ..o }).collect()
}

/// A wall before the eye, and behind it boxes in a row: first the wall.
fn boxes_behind_a_wall() -> (View, PreparedScene) {
    let lens = Camera { eye: DVec3::ZERO, target: DVec3::NEG_Z, up: DVec3::Y, fov_y_deg: 60.0, near: 0.1, far: None };
    let mut b = Builder::new();
    b.cuboid(Vec3::new(-6.0, -6.0, -6.0), Vec3::new(6.0, 6.0, -5.0), Facing::Both);
    for n in 0..8 {
        let at = Vec3::new(n as f32 - 4.0, -1.0, -8.0 - 3.0 * n as f32);
        b.cuboid(at, at + Vec3::new(0.8, 2.0, 0.8), Facing::Both);
    }
    (lens.view(viewport(160, 96)).unwrap(), b.prepared())
}

#[test]
fn redundant_occluders_leave_the_no_background_z_buffer_as_it_is_and_make_the_estimation_buffer_useless() {
    // Thesis 6.4.
    let (view, scene) = boxes_behind_a_wall();
    let wall = &scene.occluders[..1];
    let [with_wall, with_all] = [wall, &scene.occluders[..]]
        .map(|occluders| holding(Level::best(), &view, &scene, occluders, NBZ).state_hash());
    assert_eq!(with_wall, with_all, "the no-background Z-buffer");
    for depth in [NBZ, deb(64, 64), deb(1, 1), DepthRepresentation::Plane] {
        let behind = |occluders| hidden(&view, &scene, occluders, depth).iter().filter(|&&h| h).count();
        assert_eq!(behind(wall), 8, "{depth:?}: behind the wall alone");
        let all = behind(&scene.occluders);
        assert_eq!(all, if depth == NBZ { 8 } else { 0 }, "{depth:?}: when all are occluders");
        // One redundant occluder pushes the boundary away where it stands.
        let one_more = [scene.occluders[0], scene.occluders[8]];
        let left = behind(&one_more);
        match depth {
            NBZ => assert_eq!(left, 8),
            DepthRepresentation::Estimation(p) if p.width() == 64 => assert!((1..8).contains(&left), "{left} are left"),
            _ => assert_eq!(left, 0, "{depth:?}"),
        }
    }
}

#[test]
fn an_occluder_is_never_culled_by_a_far_boundary() {
    // Thesis 6.4: they all lie on its near side.
    let mut r = Random::new(69);
    let mut by_samples = 0;
    for round in 0..24 {
        let (view, scene) = world(&mut r, round, 90);
        let (_, fragments) = samples(&view, &scene);
        for depth in [NBZ, deb(64, 64), deb(500, 500), DepthRepresentation::Plane] {
            let buffer = holding(Level::best(), &view, &scene, &scene.occluders, depth);
            for (id, verdict) in verdicts(&buffer, &scene).into_iter().enumerate() {
                let culled = verdict == Verdict::Hidden(Hidden::OverlapAndDepth) && fragments[id] > 0;
                assert!(!culled || depth == NBZ, "round {round}, {depth:?}: object {id} {:?}", scene.bounds[id]);
                by_samples += u32::from(culled);
            }
        }
    }
    assert!(by_samples > 50, "only {by_samples} are culled by the no-background Z-buffer: nothing was tested");
}

#[test]
fn lower_thresholds_hide_no_less_before_a_far_boundary_too() {
    let mut r = Random::new(70);
    let mut more = 0;
    for round in 0..24 {
        let (walls, view, scene) = behind_walls(&mut r, round);
        let some = &scene.occluders[..walls];
        for depth in [deb(64, 64), DepthRepresentation::Plane] {
            let mut before = hidden(&view, &scene, some, depth);
            for t in [1.0, 0.95, 0.7] {
                let settings = OcclusionSettings { thresholds: Thresholds::uniform(t).unwrap(), ..settings(depth) };
                let mut buffer = begun(Level::best(), &view, settings);
                buffer.submit(&scene.meshes, some).unwrap();
                let now: Vec<bool> = verdicts(&buffer, &scene).iter().map(|v| v.is_hidden()).collect();
                assert!((0..now.len()).all(|id| now[id] || !before[id]), "round {round}, {depth:?}, threshold {t}");
                assert!(
                    t < 1.0 || now == before,
                    "round {round}, {depth:?}: a threshold of 1 is the conservative test"
                );
                more += (0..now.len()).filter(|&id| now[id] && !before[id]).count();
                before = now;
            }
        }
    }
    assert!(more > 10, "only {more} more are hidden");
}

#[test]
fn another_representation_holds_from_the_next_view_on() {
    let (view, scene) = boxes_behind_a_wall();
    let mut buffer = holding(Level::best(), &view, &scene, &scene.occluders, NBZ);
    let before = verdicts(&buffer, &scene);
    let state = buffer.state_hash();
    for depth in [deb(64, 64), DepthRepresentation::Plane] {
        let settings = OcclusionSettings { depth, keep_depth: false, ..OcclusionSettings::default() };
        buffer.set_settings(settings).unwrap();
        same("in the same view", &verdicts(&buffer, &scene), &before);
        assert_eq!(buffer.state_hash(), state);
    }
    let depth = DepthRepresentation::Plane;
    buffer.set_settings(OcclusionSettings { depth, ..OcclusionSettings::default() }).unwrap();
    buffer.begin(&view).unwrap();
    buffer.submit(&scene.meshes, &scene.occluders).unwrap();
    let plane = holding(Level::best(), &view, &scene, &scene.occluders, DepthRepresentation::Plane);
    same("in the next", &verdicts(&buffer, &scene), &verdicts(&plane, &scene));
}

#[test]
fn progressive_culling_in_bands_is_refused_before_a_far_boundary() {
    let (view, scene) = boxes_behind_a_wall();
    let world =
        Occluders { meshes: &scene.meshes, occluders: &scene.occluders, bounds: &scene.bounds, origin: scene.origin };
    for (depth, name) in [(deb(64, 64), "deb"), (DepthRepresentation::Plane, "plane")] {
        let mut buffer = begun(Level::best(), &view, settings(depth));
        let result = buffer.progressive(&ProjectedBoxes::new(), &world, &mut Vec::new(), 1, |_| {});
        assert!(result.unwrap_err().to_string().contains(name), "{name}");
    }
}

#[test]
fn occluders_that_are_no_occluders_push_nothing_or_all() {
    let (view, scene) = boxes_behind_a_wall();
    let mut meshes = scene.meshes.clone();
    let nothing = Occluder { mesh: meshes.add(&[Vec3::ONE], &[]).unwrap(), ..scene.occluders[0] };
    let elsewhere = Occluder { position: DVec3::new(0.0, 0.0, 90.0), ..scene.occluders[0] };
    let beside = Occluder { position: DVec3::new(500.0, 0.0, 0.0), ..scene.occluders[0] };
    let odd = Occluder { rotation: Some(glam::Mat3::NAN), ..scene.occluders[0] };
    let through = Occluder { position: DVec3::new(0.0, 0.0, 5.5), ..scene.occluders[0] };
    for depth in [deb(64, 64), DepthRepresentation::Plane] {
        let with = |occluder: Occluder| {
            let mut buffer = begun(Level::best(), &view, settings(depth));
            buffer.submit(&meshes, &[occluder]).unwrap();
            (buffer.depth_at(0, 0).unwrap(), buffer.depth_at(80, 48).unwrap())
        };
        let infinite = (f32::INFINITY, f32::INFINITY);
        for (occluder, name) in [(nothing, "an empty mesh"), (elsewhere, "behind the eye"), (beside, "off the screen")]
        {
            assert_eq!(with(occluder), infinite, "{depth:?}: {name}");
        }
        assert_eq!(with(odd), (0.0, 0.0), "{depth:?}: what can't be placed");
        // Around the eye: it covers what it likes, no farther than its corners.
        let (corner, middle) = with(through);
        assert!(corner == middle && (0.01..0.2001).contains(&corner), "{depth:?}: {corner} {middle}");
    }
}
