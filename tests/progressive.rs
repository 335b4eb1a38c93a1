//! Progressive culling in one call is testing and drawing one object at a time, in any number of bands.

mod oracle;

use homcull::occlusion::{
    DepthReading, DepthRepresentation, Occluders, OcclusionSettings, ProgressiveJob, ProjectedBoxes,
};
use homcull::scene::PreparedScene;
use homcull::view::View;
use homcull_simd::Level;
use oracle::random::Random;
use oracle::state::{State, begun, for_levels, same};
use oracle::verdicts::{samples, world};

/// Visible flags of a progressive pass by id, and the state it leaves.
fn progressive(
    level: Level,
    view: &View,
    scene: &PreparedScene,
    settings: OcclusionSettings,
    bands: usize,
) -> (Vec<(u32, bool)>, State) {
    let mut buffer = begun(level, view, settings);
    let mut projected = ProjectedBoxes::new();
    buffer.project(&scene.boxes, scene.origin, &mut projected).unwrap();
    projected.sort();
    let world =
        Occluders { meshes: &scene.meshes, occluders: &scene.occluders, bounds: &scene.bounds, origin: scene.origin };
    let mut visible = Vec::new();
    let run = |jobs: &mut [ProgressiveJob<'_>]| jobs.iter_mut().rev().for_each(|j| j.run());
    let result = buffer.progressive(&projected, &world, &mut visible, bands, run).unwrap();
    let seen = visible.iter().filter(|&&v| v).count() as u32;
    assert_eq!((result.visible, result.visible + result.hidden), (seen, projected.len() as u32));
    (projected.boxes().iter().zip(visible).map(|(b, v)| (b.id(), v)).collect(), State::of(&buffer, view))
}

/// The same by testing and submitting one object at a time.
fn round_by_round(
    level: Level,
    view: &View,
    scene: &PreparedScene,
    settings: OcclusionSettings,
) -> (Vec<(u32, bool)>, State) {
    let mut buffer = begun(level, view, settings);
    let mut projected = ProjectedBoxes::new();
    buffer.project(&scene.boxes, scene.origin, &mut projected).unwrap();
    projected.sort();
    let mut visible = vec![false; projected.len()];
    for (b, visible) in projected.boxes().iter().zip(&mut visible) {
        *visible = !buffer.test_one_projected(b, &scene.bounds, scene.origin).unwrap().is_hidden();
        if *visible {
            buffer.submit(&scene.meshes, &scene.occluders[b.id() as usize..][..1]).unwrap();
        }
    }
    (projected.boxes().iter().zip(visible).map(|(b, v)| (b.id(), v)).collect(), State::of(&buffer, view))
}

#[test]
fn progressive_culling_is_round_by_round_culling_in_any_number_of_bands() {
    let mut r = Random::new(10);
    for round in 0..60 {
        let (view, mut scene) = world(&mut r, round, 90);
        scene.occluders.iter_mut().step_by(7).for_each(|o| o.opaque = false);
        for depth in [DepthReading::PerSample, DepthReading::PerBlock] {
            let settings =
                OcclusionSettings { depth: DepthRepresentation::NoBackground(depth), ..OcclusionSettings::default() };
            let what = format!("round {round}, {depth:?}");
            let gold = for_levels(&what, |level| round_by_round(level, &view, &scene, settings.clone()));
            for bands in [1, 2, 3, 5] {
                let is = for_levels(&what, |level| progressive(level, &view, &scene, settings.clone(), bands));
                same(&format!("{what}, {bands} bands"), &is, &gold);
                let (shown, _) = samples(&view, &scene);
                for (id, visible) in is.0 {
                    assert!(
                        visible || shown[id as usize] == 0,
                        "{what}, {bands} bands: object {id} shows, but is hidden"
                    );
                }
            }
        }
    }
}

/// A progressive pass under settings, against testing and submitting one at a time under the same.
fn progressive_keeps_to(seed: u64, settings: &OcclusionSettings) {
    let mut r = Random::new(seed);
    for round in 0..24 {
        let (view, scene) = world(&mut r, round, 90);
        let gold = round_by_round(Level::best(), &view, &scene, settings.clone());
        let is = progressive(Level::best(), &view, &scene, settings.clone(), 1);
        same(&format!("round {round}, {settings:?}"), &is.0, &gold.0);
    }
}

#[test]
fn progressive_culling_without_known_samples_keeps_boxes_between_samples() {
    progressive_keeps_to(11, &OcclusionSettings { no_sample_is_hidden: false, ..OcclusionSettings::default() });
}

#[test]
fn progressive_culling_on_the_map_alone_is_refused() {
    let mut r = Random::new(12);
    let (view, scene) = world(&mut r, 0, 20);
    let mut buffer =
        begun(Level::Scalar, &view, OcclusionSettings { keep_depth: false, ..OcclusionSettings::default() });
    let world =
        Occluders { meshes: &scene.meshes, occluders: &scene.occluders, bounds: &scene.bounds, origin: scene.origin };
    let result = buffer.progressive(&ProjectedBoxes::new(), &world, &mut Vec::new(), 1, |_| {});
    assert!(result.unwrap_err().to_string().contains("keep_depth"));
}
