//! Overlap tests with thresholds, held against figure 5.3 of the thesis, sample by sample (SEMANTICS, *The pyramid and the
//! overlap test*).

mod oracle;

use glam::{DVec3, Vec3};
use homcull::geometry::{Aabb, SampleRect};
use homcull::occlusion::{
    ActiveLevels, BoxSet, Hidden, OcclusionBuffer, OcclusionSettings, OverlapStatistics, ProjectedBoxes, PyramidShape,
    Thresholds, Verdict, Visible,
};
use homcull::raster::Facing;
use homcull::scene::PreparedScene;
use homcull::view::View;
use homcull_simd::Level;
use oracle::maps::{self, Map, Rules};
use oracle::random::Random;
use oracle::scenes::{Builder, flat_view, viewport};
use oracle::state::{begun, for_levels};

const ALL: Option<ActiveLevels> = Some(ActiveLevels { finest: 0, coarsest: None });

/// Quads that cover exactly the samples of a map, run by run, at depth 0.5.
fn occluders(map: &Map) -> PreparedScene {
    let mut quads: Vec<[Vec3; 3]> = Vec::new();
    for y in 0..map.height {
        let mut x = 0;
        while x < map.width {
            let run = (x..map.width).take_while(|&x| map.covered(x, y)).count();
            if run > 0 {
                let at = |dx: usize, dy: usize| Vec3::new((x + dx) as f32, (y + dy) as f32, 0.5);
                quads.push([at(0, 0), at(run, 0), at(run, 1)]);
                quads.push([at(0, 0), at(run, 1), at(0, 1)]);
            }
            x += run.max(1);
        }
    }
    let mut b = Builder::new();
    b.triangles(&quads, Facing::Both);
    b.prepared()
}

/// A box whose rectangle is exactly that of these samples, behind the occluders.
fn behind(r: SampleRect) -> Aabb {
    Aabb {
        min: Vec3::new(r.x0 as f32 + 0.4, r.y0 as f32 + 0.4, 0.1),
        max: Vec3::new(r.x1 as f32 + 0.6, r.y1 as f32 + 0.6, 0.2),
    }
}

fn drawn(level: Level, view: &View, scene: &PreparedScene, settings: &OcclusionSettings) -> OcclusionBuffer {
    let mut buffer = begun(level, view, settings.clone());
    buffer.submit(&scene.meshes, &scene.occluders).unwrap();
    buffer
}

#[test]
fn the_overlap_test_is_figure_5_3() {
    let mut r = Random::new(1);
    let (mut passed, mut failed, mut above_finest, mut aggressive) = (0, 0, 0, 0);
    for round in 0..60 {
        let map = maps::random(&mut r);
        let view = flat_view(viewport(map.width as u32, map.height as u32));
        let scene = occluders(&map);
        let block = [[8, 8], [8, 8], [5, 4], [20, 16], [1, 1], [3, 11], [16, 8]][round % 7];
        let minimal = [[1, 1], [4, 4], [2, 1]][round % 3];
        let shape = PyramidShape { block, minimal };
        let mut rules = Rules::new(&map, shape);
        let finest = r.below(rules.sizes.len().min(3));
        let coarsest = finest + r.below(rules.sizes.len() - finest);
        rules.active = (finest, coarsest);
        let d = r.range(1.0, 4.0);
        let t = [1.0, 0.97, 0.85, 0.6, r.range(0.01, 1.0)][r.below(5)];
        let low = if r.chance(0.5) { 0.0 } else { r.range(0.0, t) };
        let thresholds = Thresholds::from_finest(t, d).unwrap().with_transparency(low, d).unwrap();
        (rules.opacity, rules.transparency) = maps::by_recursion(t, low, d);
        let levels = Some(ActiveLevels { finest, coarsest: Some(coarsest) });
        let settings = OcclusionSettings { thresholds, levels, pyramid: shape, ..OcclusionSettings::default() };
        let rects: Vec<SampleRect> = (0..150).map(|_| maps::random_rect(&mut r, &map)).collect();
        let what = format!("round {round}, {shape:?}, levels {finest} to {coarsest}, T {t}, t {low}, D {d}");
        let answers = for_levels(&what, |level| {
            let buffer = drawn(level, &view, &scene, &settings);
            rects.iter().map(|&r| buffer.assess(behind(r), DVec3::ZERO, None).unwrap()).collect::<Vec<_>>()
        });
        for (&rect, answer) in rects.iter().zip(&answers) {
            let should = maps::overlap_test(&map, &rules, rect);
            assert_eq!(answer.verdict.is_hidden(), should.passed, "{what}, {rect:?}: {answer:?}");
            assert_eq!(answer.decided_at, Some(should.level), "{what}, {rect:?}: {answer:?}");
            let visibility = maps::level_of_visibility(&map, &rules, rect, should.level);
            assert!(
                (answer.level_of_visibility - visibility).abs() < 1e-12,
                "{what}, {rect:?}: {answer:?} {visibility}"
            );
            rules.predicts = false;
            let descended = maps::overlap_test(&map, &rules, rect);
            rules.predicts = true;
            assert_eq!(descended.passed, should.passed, "{what}, {rect:?}: predictive rejection changed the verdict");
            let exact = map.all_covered(rect);
            if t == 1.0 && low == 0.0 && finest == 0 {
                assert_eq!(should.passed, exact, "{what}, {rect:?}: at 1 the test is exact by samples");
            }
            assert!(t < 1.0 || !should.passed || exact, "{what}, {rect:?}: at 1 nothing visible is culled");
            aggressive += u32::from(should.passed && !exact);
            above_finest += u32::from(should.level > finest);
            if should.passed { passed += 1 } else { failed += 1 }
        }
    }
    println!(
        "{passed} pass, {aggressive} of them not covered; {failed} fail; {above_finest} decided above the finest level"
    );
    assert!(passed > 1500 && failed > 1500 && aggressive > 300 && above_finest > 500);
}

#[test]
fn walking_the_pyramid_at_1_gives_the_verdicts_of_the_plain_test() {
    let mut r = Random::new(2);
    for round in 0..20 {
        let map = maps::random(&mut r);
        let view = flat_view(viewport(map.width as u32, map.height as u32));
        let scene = occluders(&map);
        let rects: Vec<SampleRect> = (0..100).map(|_| maps::random_rect(&mut r, &map)).collect();
        let verdicts = |levels| {
            for_levels("verdicts", |level| {
                let settings = OcclusionSettings { levels, ..OcclusionSettings::default() };
                let buffer = drawn(level, &view, &scene, &settings);
                rects.iter().map(|&r| buffer.test(behind(r), DVec3::ZERO).unwrap()).collect::<Vec<_>>()
            })
        };
        assert_eq!(verdicts(None), verdicts(ALL), "round {round}");
    }
}

#[test]
fn plain_tests_report_visibility_by_blocks() {
    let mut r = Random::new(3);
    for round in 0..20 {
        let map = maps::random(&mut r);
        let view = flat_view(viewport(map.width as u32, map.height as u32));
        let scene = occluders(&map);
        let buffer = drawn(Level::best(), &view, &scene, &OcclusionSettings::default());
        let rules = Rules::new(&map, PyramidShape::default());
        for _ in 0..100 {
            let rect = maps::random_rect(&mut r, &map);
            let answer = buffer.assess(behind(rect), DVec3::ZERO, None).unwrap();
            let hidden = map.all_covered(rect);
            let visibility = maps::level_of_visibility(&map, &rules, rect, 0);
            assert_eq!((answer.verdict.is_hidden(), answer.decided_at), (hidden, None), "round {round}, {rect:?}");
            assert!((answer.level_of_visibility - visibility).abs() < 1e-12, "round {round}, {rect:?}: {answer:?}");
            assert_eq!(answer.level_of_visibility == 0.0, hidden, "round {round}, {rect:?}: {answer:?}");
        }
    }
}

#[test]
fn what_is_decided_without_an_overlap_test_is_wholly_visible_or_not_at_all() {
    let map = maps::full(64, 64);
    let view = flat_view(viewport(64, 64));
    for levels in [None, ALL] {
        let settings = OcclusionSettings { levels, ..OcclusionSettings::default() };
        let buffer = drawn(Level::best(), &view, &occluders(&map), &settings);
        let ask = |min: Vec3, max: Vec3| {
            let answer = buffer.assess(Aabb { min, max }, DVec3::ZERO, None).unwrap();
            (answer.verdict, answer.level_of_visibility)
        };
        let inside = |z0, z1| ask(Vec3::new(9.0, 9.0, z0), Vec3::new(19.0, 19.0, z1));
        assert_eq!(inside(0.1, 0.2), (Verdict::Hidden(Hidden::OverlapAndDepth), 0.0));
        assert_eq!(inside(0.1, 0.8), (Verdict::Visible(Visible::InFront), 1.0));
        assert_eq!(inside(0.1, 1.5), (Verdict::Visible(Visible::NearPlane), 1.0));
        let aside = ask(Vec3::new(99.0, 9.0, 0.1), Vec3::new(109.0, 19.0, 0.2));
        assert_eq!(aside, (Verdict::Hidden(Hidden::OutsideFrustum), 0.0));
    }
}

#[test]
fn a_test_starts_at_the_finest_level_whose_pixels_exceed_the_smaller_side() {
    // Where all is covered the first pixel decides: the deciding level is the one it starts at.
    let map = maps::full(640, 640);
    let view = flat_view(viewport(640, 640));
    let settings = OcclusionSettings { levels: ALL, ..OcclusionSettings::default() };
    let buffer = drawn(Level::best(), &view, &occluders(&map), &settings);
    for (width, height, level) in
        [(1, 1, 0), (7, 7, 0), (8, 8, 1), (7, 600, 0), (600, 7, 0), (15, 15, 1), (16, 200, 2), (640, 640, 7)]
    {
        let rect = SampleRect { x0: 0, y0: 0, x1: width - 1, y1: height - 1 };
        let answer = buffer.assess(behind(rect), DVec3::ZERO, None).unwrap();
        assert_eq!((answer.verdict.is_hidden(), answer.decided_at), (true, Some(level)), "{width}x{height}");
    }
}

#[test]
fn blocks_of_any_size_count_the_holes_of_every_level() {
    let mut r = Random::new(4);
    for round in 0..42 {
        let map = maps::random(&mut r);
        let view = flat_view(viewport(map.width as u32, map.height as u32));
        let scene = occluders(&map);
        let side = |r: &mut Random| 1 + r.below(40) as u32;
        let block = [[8, 8], [1, 1], [64, 8], [20, 16], [16384, 1], [side(&mut r), side(&mut r)]][round % 6];
        let minimal = [[1, 1], [4, 4], [1, 9]][round % 3];
        let shape = PyramidShape { block, minimal };
        let rules = Rules::new(&map, shape);
        let settings = OcclusionSettings { pyramid: shape, ..OcclusionSettings::default() };
        for_levels("holes", |level| {
            let mut buffer = begun(level, &view, settings.clone());
            let mut counted = Vec::new();
            for whole in [false, true] {
                // The first time what has been drawn since the view began, the second time everything.
                if whole {
                    buffer.mark_all_changed();
                } else {
                    let _ = buffer.pyramid();
                    buffer.submit(&scene.meshes, &scene.occluders).unwrap();
                }
                let pyramid = buffer.pyramid();
                let sizes: Vec<_> = (0..pyramid.levels()).map(|l| pyramid.size(l)).collect();
                assert_eq!(sizes, rules.sizes, "round {round}, {shape:?}");
                for (level, &(width, height)) in sizes.iter().enumerate() {
                    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
                        let should = map.holes(rules.pixel(level, x, y));
                        let is = pyramid.holes(level, x, y) as usize;
                        assert_eq!(is, should, "round {round}, {shape:?}, level {level}, ({x}, {y})");
                        counted.push(is);
                    }
                }
            }
            counted
        });
    }
}

#[test]
fn pyramids_end_at_the_minimal_resolution() {
    let sizes = |block, minimal| {
        let settings = OcclusionSettings { pyramid: PyramidShape { block, minimal }, ..OcclusionSettings::default() };
        let mut buffer = OcclusionBuffer::with_level(viewport(1280, 1024), Level::best(), settings).unwrap();
        let pyramid = buffer.pyramid();
        (0..pyramid.levels()).map(|l| pyramid.size(l)).collect::<Vec<_>>()
    };
    // The thesis's own: 256x256 to 4x4 (8.2.2), its active levels 64x64 to 4x4 of 20x16 samples (8.4.2).
    assert_eq!(sizes([5, 4], [4, 4]), [256, 128, 64, 32, 16, 8, 4].map(|n| (n, n)));
    assert_eq!(sizes([20, 16], [4, 4]), [64, 32, 16, 8, 4].map(|n| (n, n)));
    assert_eq!(sizes([8, 8], [4, 4]), [(160, 128), (80, 64), (40, 32), (20, 16), (10, 8), (5, 4)]);
    assert_eq!(sizes([8, 8], [1, 1])[5..], [(5, 4), (3, 2), (2, 1), (1, 1)]);
    assert_eq!(sizes([640, 1024], [9, 9]), [(2, 1)]);
}

#[test]
fn settings_that_do_not_fit_are_refused_by_name() {
    let refused = |settings: OcclusionSettings, name: &str| match OcclusionBuffer::with_level(
        viewport(64, 64),
        Level::best(),
        settings,
    ) {
        Err(homcull::Error::Parameter { name: n, .. }) => assert_eq!(n, name),
        Err(e) => panic!("{e}"),
        Ok(_) => panic!("{name} was taken"),
    };
    let plain = OcclusionSettings::default();
    for block in [[0, 8], [8, 0], [16385, 1]] {
        refused(OcclusionSettings { pyramid: PyramidShape { block, minimal: [1, 1] }, ..plain.clone() }, "block");
    }
    let minimal = [0, 1];
    refused(OcclusionSettings { pyramid: PyramidShape { block: [8, 8], minimal }, ..plain.clone() }, "minimal");
    for (finest, coarsest) in [(4, None), (0, Some(4)), (2, Some(1))] {
        let levels = Some(ActiveLevels { finest, coarsest });
        refused(OcclusionSettings { levels, ..plain.clone() }, "levels");
    }
    for fusion in [0.0, 1.0, f64::NAN] {
        refused(OcclusionSettings { fusion: Some(fusion), ..plain.clone() }, "fusion");
    }
    let mut buffer = OcclusionBuffer::new(viewport(64, 64));
    let bad = OcclusionSettings { levels: Some(ActiveLevels { finest: 9, coarsest: None }), ..plain };
    assert!(buffer.set_settings(bad).is_err());
    assert_eq!(buffer.settings().levels, None, "settings that are refused change nothing");
}

/// Leaves with holes: every sample but one in 25 is covered.
fn leaves() -> (View, Map) {
    let mut map = maps::full(96, 96);
    for (x, y) in (0..96).step_by(5).flat_map(|y| (0..96).step_by(5).map(move |x| (x, y))) {
        map.open(x, y);
    }
    (flat_view(viewport(96, 96)), map)
}

#[test]
fn what_contrasts_with_the_leaves_shows_through_their_holes() {
    let (view, map) = leaves();
    let mut scene = occluders(&map);
    // Dark leaves: before them a bright thing shows, a dark one does not.
    scene.occluders.iter_mut().for_each(|o| o.luminance = 20);
    let thing = behind(SampleRect { x0: 20, y0: 20, x1: 59, y1: 59 });
    let hidden = |contrast, luminance| {
        for_levels("leaves", |level| {
            let thresholds = Thresholds::uniform(0.9).unwrap();
            let settings = OcclusionSettings { thresholds, contrast, ..OcclusionSettings::default() };
            let buffer = drawn(level, &view, &scene, &settings);
            vec![buffer.assess(thing, DVec3::ZERO, luminance).unwrap().verdict.is_hidden()]
        })[0]
    };
    assert!(hidden(false, None) && hidden(false, Some(255)), "without contrast, thresholds are those that were set");
    assert!(!hidden(true, Some(255)), "the sun");
    assert!(hidden(true, Some(20)) && hidden(true, Some(30)), "another leaf");
    assert!(!hidden(true, Some(200)));
    assert!(hidden(true, None), "without a luminance nothing is raised");
}

#[test]
fn contrast_goes_by_the_mean_of_what_covers_the_pixel() {
    // The left half is covered by white, the right half by black leaves.
    let (view, map) = leaves();
    let half = |left: bool| {
        let mut half = map.clone();
        for (x, y) in (0..96).flat_map(|y| (0..96).map(move |x| (x, y))).filter(|&(x, _)| (x < 48) != left) {
            half.open(x, y);
        }
        occluders(&half)
    };
    let (mut white, mut black) = (half(true), half(false));
    white.occluders[0].luminance = 255;
    black.occluders[0].luminance = 0;
    let thing = |x0: i32| behind(SampleRect { x0, y0: 20, x1: x0 + 15, y1: 59 });
    let answers = |white_first: bool| {
        for_levels("halves", |level| {
            let thresholds = Thresholds::uniform(0.9).unwrap();
            let settings = OcclusionSettings { thresholds, contrast: true, ..OcclusionSettings::default() };
            let mut buffer = begun(level, &view, settings);
            for scene in if white_first { [&white, &black] } else { [&black, &white] } {
                buffer.submit(&scene.meshes, &scene.occluders).unwrap();
            }
            [(16, 255), (16, 0), (64, 255), (64, 0)]
                .map(|(x0, light)| buffer.assess(thing(x0), DVec3::ZERO, Some(light)).unwrap().verdict.is_hidden())
                .to_vec()
        })
    };
    assert_eq!(answers(true), [true, false, false, true]);
    assert_eq!(answers(true), answers(false), "the order of submission tells");
}

#[test]
fn tests_are_counted_by_the_level_that_decided_them() {
    let mut r = Random::new(5);
    let map = maps::random(&mut r);
    let view = flat_view(viewport(map.width as u32, map.height as u32));
    let scene = occluders(&map);
    let thresholds = Thresholds::from_finest(0.85, 2.0).unwrap();
    let settings = OcclusionSettings { thresholds, ..OcclusionSettings::default() };
    let rects: Vec<SampleRect> = (0..300).map(|_| maps::random_rect(&mut r, &map)).collect();
    let bounds: Vec<Aabb> = rects.iter().map(|&r| behind(r)).collect();
    let boxes = BoxSet::new(&bounds);
    for_levels("counts", |level| {
        let buffer = drawn(level, &view, &scene, &settings);
        let mut projected = ProjectedBoxes::new();
        buffer.project(&boxes, DVec3::ZERO, &mut projected).unwrap();
        let (mut answers, mut hidden) = (Vec::new(), Vec::new());
        buffer.assess_projected(&projected, 0..projected.len(), &bounds, DVec3::ZERO, &[], &mut answers).unwrap();
        buffer.test_projected(&projected, 0..projected.len(), &bounds, DVec3::ZERO, &mut hidden).unwrap();
        let mut statistics = OverlapStatistics::default();
        for (b, (answer, &hidden)) in projected.boxes().iter().zip(answers.iter().zip(&hidden)) {
            assert_eq!(*answer, buffer.assess(bounds[b.id() as usize], DVec3::ZERO, None).unwrap());
            assert_eq!(answer.verdict.is_hidden(), hidden);
            statistics.add(answer);
        }
        let (mut counted, mut flags) = (OverlapStatistics::default(), Vec::new());
        let all = 0..projected.len();
        buffer.test_projected_counted(&projected, all, &bounds, DVec3::ZERO, &[], &mut flags, &mut counted).unwrap();
        assert_eq!((&counted, &flags), (&statistics, &hidden));
        let (passed, failed) = (statistics.passed.iter().sum::<u64>(), statistics.failed.iter().sum::<u64>());
        assert_eq!(passed, hidden.iter().filter(|&&h| h).count() as u64);
        assert_eq!(passed + failed, 300);
        vec![statistics.passed, statistics.failed]
    });
}
