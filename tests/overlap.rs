//! The overlap test is what the thesis defines, and thresholds and depth readings are ordered as they should be.

mod oracle;

use homcull::geometry::SampleRect;
use homcull::occlusion::{DepthReading, DepthRepresentation, OcclusionSettings, ProjectedBoxes, Thresholds};
use homcull::scene::PreparedScene;
use homcull::view::View;
use homcull_simd::Level;
use oracle::random::Random;
use oracle::state::{State, begun, for_levels};
use oracle::verdicts::{all_covered, at_the_edge, verdicts, world};

fn with(thresholds: Thresholds, keep_depth: bool, depth: DepthReading) -> OcclusionSettings {
    let depth = DepthRepresentation::NoBackground(depth);
    OcclusionSettings { thresholds, keep_depth, depth, ..OcclusionSettings::default() }
}

fn hidden_with(level: Level, view: &View, scene: &PreparedScene, settings: OcclusionSettings) -> Vec<bool> {
    let mut buffer = begun(level, view, settings);
    buffer.submit(&scene.meshes, &scene.occluders[..scene.occluders.len() * 2 / 3]).unwrap();
    verdicts(&buffer, scene).iter().map(|v| v.is_hidden()).collect()
}

#[test]
fn a_lower_threshold_hides_no_less_and_a_blockwise_reading_no_more() {
    let mut r = Random::new(8);
    let (mut more, mut fewer) = (0, 0);
    for round in 0..60 {
        let (view, scene) = world(&mut r, round, 90);
        let hidden = |thresholds: Thresholds, keep_depth, depth| {
            for_levels("thresholds", |level| {
                hidden_with(level, &view, &scene, with(thresholds.clone(), keep_depth, depth))
            })
        };
        for depth in [DepthReading::PerSample, DepthReading::PerBlock] {
            for keep_depth in [true, false] {
                let mut before = hidden(Thresholds::conservative(), keep_depth, depth);
                for t in [1.0, 0.99, 0.95, 0.9, 0.7, 0.5, 0.2] {
                    let now = hidden(Thresholds::uniform(t).unwrap(), keep_depth, depth);
                    let lost = (0..now.len()).find(|&i| before[i] && !now[i]);
                    let what = format!("round {round}, threshold {t}, depth kept {keep_depth}, {depth:?}");
                    assert_eq!(lost, None, "{what}: this object was hidden at the threshold above");
                    assert!(t < 1.0 || now == before, "{what}: a threshold of 1 is the conservative test");
                    more += (0..now.len()).filter(|&i| now[i] && !before[i]).count();
                    before = now;
                }
            }
        }
        let samples = hidden(Thresholds::conservative(), true, DepthReading::PerSample);
        let blocks = hidden(Thresholds::conservative(), true, DepthReading::PerBlock);
        for id in 0..samples.len() {
            assert!(samples[id] || !blocks[id], "round {round}, object {id}: hidden by blocks, but not by samples");
            fewer += u32::from(samples[id] && !blocks[id]);
        }
    }
    println!("{more} more are hidden as thresholds fall, {fewer} fewer by blocks than by samples");
    assert!(more > 50 && fewer > 10, "{more} more, {fewer} fewer: nothing was tested");
}

/// The overlap test by its definition: pixels of the finest level wider than the rectangle's smaller side, each opaque, or all
/// of its touched children; at level 0 also when the touched samples are covered.
fn overlap_by_definition(state: &State, t: f64, r: SampleRect) -> bool {
    let smaller = (r.x1 - r.x0 + 1).min(r.y1 - r.y0 + 1);
    let top = {
        let mut level = 0;
        while (8 << level) < state.width.max(state.height) {
            level += 1;
        }
        level
    };
    let start = (0..=top).find(|&l| (8 << l) > smaller).unwrap_or(top);
    fn passes(state: &State, t: f64, r: SampleRect, level: i32, x: i32, y: i32) -> bool {
        let side = 8 << level;
        let pixel = SampleRect { x0: x * side, y0: y * side, x1: (x + 1) * side - 1, y1: (y + 1) * side - 1 };
        let (w, h) = (state.width as i32, state.height as i32);
        let holes_in = |r: SampleRect| {
            let ys = r.y0.max(0)..=r.y1.min(h - 1);
            ys.map(|y| (r.x0.max(0)..=r.x1.min(w - 1)).filter(|&x| !state.covered[(y * w + x) as usize]).count())
                .sum::<usize>()
        };
        if holes_in(pixel) <= ((1.0 - t) * f64::from(side) * f64::from(side) + 1e-9).floor() as usize {
            return true;
        }
        let part = SampleRect {
            x0: pixel.x0.max(r.x0),
            y0: pixel.y0.max(r.y0),
            x1: pixel.x1.min(r.x1),
            y1: pixel.y1.min(r.y1),
        };
        if part.is_empty() {
            return true;
        }
        if level == 0 {
            return holes_in(part) == 0;
        }
        let touched = |i: i32, from: i32, to: i32| i * side / 2 <= to && (i + 1) * side / 2 > from;
        (2 * y..2 * y + 2).filter(|&i| touched(i, r.y0, r.y1)).all(|cy| {
            (2 * x..2 * x + 2).filter(|&i| touched(i, r.x0, r.x1)).all(|cx| passes(state, t, r, level - 1, cx, cy))
        })
    }
    let side = 8 << start;
    (r.y0 / side..=r.y1 / side).all(|y| (r.x0 / side..=r.x1 / side).all(|x| passes(state, t, r, start, x, y)))
}

#[test]
fn the_hierarchical_overlap_test_is_its_definition() {
    let mut r = Random::new(9);
    let (mut passed, mut failed) = (0, 0);
    for round in 0..72 {
        let (view, scene) = world(&mut r, round, 90);
        for t in [1.0, 1.0 - 1e-8, 0.95, 0.8, 0.5] {
            for_levels("overlap", |level| {
                let mut buffer =
                    begun(level, &view, with(Thresholds::uniform(t).unwrap(), false, DepthReading::PerSample));
                buffer.submit(&scene.meshes, &scene.occluders[..12]).unwrap();
                let state = State::of(&buffer, &view);
                let mut projected = ProjectedBoxes::new();
                buffer.project(&scene.boxes, scene.origin, &mut projected).unwrap();
                let inside = projected.boxes().iter().filter(|b| !b.touches_near_plane() && !b.rect().is_empty());
                inside
                    .filter(|b| !at_the_edge(&view, b.rect()))
                    .map(|b| {
                        let is = buffer.test_one_projected(b, &scene.bounds, scene.origin).unwrap().is_hidden();
                        let should = overlap_by_definition(&state, t, b.rect());
                        assert_eq!(is, should, "round {round}, threshold {t}, {b:?} at {}", level.name());
                        if t > 0.999 {
                            assert_eq!(
                                is,
                                all_covered(&state, b.rect()),
                                "round {round}, threshold {t}, {b:?}: sample by sample"
                            );
                        }
                        is
                    })
                    .collect::<Vec<_>>()
            })
            .iter()
            .for_each(|&is| if is { passed += 1 } else { failed += 1 });
        }
    }
    println!("{passed} rectangles pass, {failed} fail");
    assert!(passed > 200 && failed > 200, "{passed} pass, {failed} fail");
}
