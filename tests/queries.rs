//! Methods that cull while they draw: the hierarchical Z-buffer, stop-and-wait, coherent hierarchical culling. The picture is that of
//! everything, at any latency; standing still, all find the same visible set.
#![cfg(feature = "bvh")]

mod oracle;

use glam::{DVec3, Vec3};
use homcull::cull::VisibleSet;
use homcull::cull::chc::ChcMemory;
use homcull::cull::coherent::{self, AssumeVisible, Latency, QueryParameters, Traversal};
use homcull::cull::hzb::{self, HzbMemory};
use homcull::cull::vfc::{self, VfcMemory, World};
use homcull::draw::{Canvas, DrawJob};
use homcull::occlusion::{OcclusionBuffer, ProjectedBoxes};
use homcull::raster::Facing;
use homcull::scene::PreparedScene;
use homcull::view::{Camera, View};
use homcull::workers::Workers;
use homcull_simd::Level;
use oracle::random::Random;
use oracle::scenes::{Builder, viewport};
use oracle::state::for_levels;
use oracle::verdicts::world;

/// The picture of everything in the frustum.
fn everything(level: Level, view: &View, world: &World<'_>) -> Canvas {
    let set = vfc::cull(world, level, view, &mut VfcMemory::default());
    let mut canvas = Canvas::new(view.viewport(), level).unwrap();
    canvas.draw(view, world.scene, &set.objects, 1, |jobs| jobs.iter_mut().for_each(DrawJob::run)).unwrap();
    canvas
}

fn chc(latency: u32) -> QueryParameters {
    QueryParameters { latency: Latency::Steps(latency), ..QueryParameters::new(true) }
}

/// All that chc and stop-and-wait can be told without giving up the picture.
fn settings() -> Vec<QueryParameters> {
    let still = QueryParameters::new(false);
    vec![
        still,
        QueryParameters { latency: Latency::Steps(3), ..still },
        QueryParameters { latency: Latency::Thread, ..still },
        chc(0),
        chc(4),
        QueryParameters { order: Traversal::Depth, ..chc(2) },
        QueryParameters { assume_visible: AssumeVisible::Frames(2), ..chc(9) },
        QueryParameters { assume_visible: AssumeVisible::Frames(6), spread: true, ..chc(0) },
        QueryParameters { assume_visible: AssumeVisible::Adaptive, spread: true, idle: true, ..chc(20) },
        QueryParameters { speculate: true, ..chc(1000) },
        QueryParameters { latency: Latency::Thread, speculate: true, ..chc(0) },
        QueryParameters { latency: Latency::Thread, idle: true, ..chc(0) },
    ]
}

/// A frame by occlusion queries: what was drawn, the picture's hash; the picture is that of everything.
#[track_caller]
fn queried(
    level: Level,
    view: &View,
    world: &World<'_>,
    parameters: &QueryParameters,
    memory: &mut ChcMemory,
    what: &str,
) -> VisibleSet {
    let mut canvas = Canvas::new(view.viewport(), level).unwrap();
    let set = coherent::draw(world, view, parameters, memory, &mut canvas).unwrap();
    assert!(canvas.equals(&everything(level, view, world)), "{what}: {parameters:?}");
    set
}

fn sorted(mut objects: Vec<u32>) -> Vec<u32> {
    objects.sort_unstable();
    objects
}

/// Views about the first one of a scene, some steps apart, as a viewer makes who turns and walks.
fn worlds(rounds: usize, objects: usize) -> impl Iterator<Item = (usize, View, PreparedScene)> {
    let mut r = Random::new(31);
    (0..rounds).map(move |round| {
        let (view, scene) = world(&mut r, round, objects);
        (round, view, scene)
    })
}

#[test]
fn queries_keep_the_picture_at_any_latency_and_level() {
    for (round, view, scene) in worlds(24, 90) {
        let world = World::new(&scene);
        for parameters in settings() {
            let what = format!("round {round}");
            let frames = |level| {
                let mut memory = ChcMemory::default();
                let mut counts = Vec::new();
                for _ in 0..3 {
                    let set = queried(level, &view, &world, &parameters, &mut memory, &what);
                    counts.push((set.objects, set.queries, set.waited.steps));
                }
                // With a thread, what is drawn is a matter of time.
                if parameters.latency == Latency::Thread { Vec::new() } else { counts }
            };
            for_levels(&format!("{what}: {parameters:?}"), frames);
        }
    }
}

#[test]
fn standing_still_chc_finds_what_stop_and_wait_finds() {
    let mut smaller = 0;
    for (round, view, scene) in worlds(40, 120) {
        let world = World::new(&scene);
        let (level, what) = (Level::best(), format!("round {round}"));
        let mut none = ChcMemory::default();
        for parameters in [chc(0), chc(7), QueryParameters { order: Traversal::Depth, ..chc(0) }] {
            let stop_and_wait = QueryParameters { order: parameters.order, ..QueryParameters::new(false) };
            let gold = queried(level, &view, &world, &stop_and_wait, &mut none, &what);
            let mut memory = ChcMemory::default();
            let mut last = VisibleSet::default();
            for _ in 0..4 {
                last = queried(level, &view, &world, &parameters, &mut memory, &what);
            }
            assert_eq!(memory.visible_objects(), sorted(gold.objects.clone()), "{what}: {parameters:?}");
            assert!(
                last.queries <= gold.queries,
                "{what}: {} queries, {} of stop-and-wait",
                last.queries,
                gold.queries
            );
            smaller += usize::from(last.queries < gold.queries);
        }
    }
    assert!(smaller > 60, "only {smaller} of 120 walks asked less than stop-and-wait");
}

/// A street between two rows of houses with things behind them, and a walk along it that turns.
fn street(frames: usize) -> (PreparedScene, Vec<View>) {
    let (mut b, mut r) = (Builder::new(), Random::new(7));
    for i in 0..80 {
        let (side, z) = (if i % 2 == 0 { -1.0 } else { 1.0 }, -3.0 * f64::from(i / 2));
        let behind = i % 4 > 1;
        let size = if behind { Vec3::splat(r.float(0.3, 2.0)) } else { Vec3::new(2.0, r.float(2.0, 6.0), 2.6) };
        let x = side * if behind { r.range(8.0, 14.0) } else { 4.0 };
        b.cuboid(-size * 0.5, size * 0.5, Facing::Both).position = DVec3::new(x, 1.0, z);
    }
    let view = |i: usize| {
        let t = i as f64 / frames as f64;
        let eye = DVec3::new(0.0, 1.5, 4.0 - 60.0 * t);
        let target = eye + DVec3::new(2.0 * libm::sin(9.0 * t), 0.0, -1.0);
        let camera = Camera { eye, target, up: DVec3::Y, fov_y_deg: 60.0, near: 0.1, far: None };
        camera.view(viewport(128, 96)).unwrap()
    };
    (b.prepared(), (0..frames).map(view).collect())
}

/// What a walk drew, asked and waited for; every picture is that of everything.
#[track_caller]
fn walked(scene: &PreparedScene, views: &[View], parameters: &QueryParameters) -> Vec<VisibleSet> {
    let (world, mut memory) = (World::new(scene), ChcMemory::default());
    let frame = |view| queried(Level::best(), view, &world, parameters, &mut memory, "on the way");
    views.iter().map(frame).collect()
}

fn queries(sets: &[VisibleSet]) -> Vec<u64> {
    sets.iter().map(|set| set.queries).collect()
}

#[test]
fn on_a_walk_assumptions_save_queries_and_idle_queries_save_waits() {
    let (scene, views) = street(60);
    let total = |parameters: &QueryParameters| {
        let sets = walked(&scene, &views, parameters);
        let drawn: usize = sets.iter().map(|set| set.objects.len()).sum();
        (queries(&sets).iter().sum::<u64>(), sets.iter().map(|set| set.waited.steps).sum::<u64>(), drawn)
    };
    let assumed = |assume_visible| total(&QueryParameters { assume_visible, ..chc(0) });
    let (still, none) = (total(&QueryParameters::new(false)), total(&chc(0)));
    let (two, adaptive) = (assumed(AssumeVisible::Frames(2)), assumed(AssumeVisible::Adaptive));
    assert!(none.0 < still.0 && two.0 < none.0 && adaptive.0 < none.0, "{still:?} {none:?} {two:?} {adaptive:?}");
    assert!(still.2 <= none.2 && none.2 <= two.2 && none.2 <= adaptive.2, "{still:?} {none:?} {two:?} {adaptive:?}");

    let stalled = total(&QueryParameters { latency: Latency::Steps(20), ..QueryParameters::new(false) });
    let (late, idle) = (total(&chc(20)), total(&QueryParameters { idle: true, ..chc(20) }));
    assert_eq!(stalled.1, 20 * stalled.0, "stop-and-wait waits for every answer");
    assert!(late.1 * 10 < stalled.1 && idle.1 * 5 < late.1 * 4, "steps waited: {stalled:?}, {late:?}, {idle:?}");
    assert_eq!(total(&QueryParameters { speculate: true, ..chc(20) }).1, 0, "who speculates waits for nothing");
}

/// Rows of twenty cubes with an edge of 1, all in view from afar; and the view from somewhat to the right.
fn rows_of_cubes(rows: u32) -> (PreparedScene, impl Fn(f64) -> View) {
    let mut b = Builder::new();
    for i in 0..20 * rows {
        let at = DVec3::new(2.0 * f64::from(i % 20), 2.0 * f64::from(i / 20), 0.0);
        b.cuboid(Vec3::splat(-0.5), Vec3::splat(0.5), Facing::Both).position = at;
    }
    let from = |right: f64| {
        let eye = DVec3::new(19.0 + right, 9.0, 50.0);
        let camera = Camera { eye, target: eye - DVec3::Z, up: DVec3::Y, fov_y_deg: 60.0, near: 0.1, far: None };
        camera.view(viewport(160, 120)).unwrap()
    };
    (b.prepared(), from)
}

/// Frames, from 1, in which all cubes are asked about and nothing else; in all others but the first, nothing is.
#[track_caller]
fn due(counts: &[u64], cubes: u64) -> Vec<usize> {
    let all: Vec<usize> = (1..).zip(counts).skip(1).filter(|c| *c.1 > 0).map(|c| c.0).collect();
    assert!(all.iter().all(|&frame| counts[frame - 1] == cubes), "{counts:?}");
    all
}

#[test]
fn where_the_eye_stays_an_adaptive_assumption_doubles_up_to_ten_frames() {
    let (scene, from) = rows_of_cubes(1);
    let adaptive = QueryParameters { assume_visible: AssumeVisible::Adaptive, ..chc(0) };
    let counts = queries(&walked(&scene, &vec![from(0.0); 45], &adaptive));
    assert_eq!(due(&counts, 20), [3, 6, 11, 20, 31, 42], "1, 2, 4, 8, 10, 10 frames in between");
}

#[test]
fn an_adaptive_assumption_ends_when_the_eye_has_moved_by_the_leafs_diagonal() {
    let (scene, from) = rows_of_cubes(1);
    let adaptive = QueryParameters { assume_visible: AssumeVisible::Adaptive, ..chc(0) };
    let moving = |step: f64| {
        // To and fro, so that all cubes stay in view.
        let views: Vec<View> = (0..30).map(|i| from(if i % 2 == 0 { 0.0 } else { step })).collect();
        due(&queries(&walked(&scene, &views, &adaptive)), 20)
    };
    let diagonal = 3f64.sqrt();
    assert_eq!(moving(diagonal * 1.01), (2..=30).collect::<Vec<_>>(), "too fast to assume anything");
    // Two steps are less than a diagonal, three are more.
    assert_eq!(moving(diagonal * 0.4), (3..=30).step_by(3).collect::<Vec<_>>());
    assert_eq!(moving(diagonal * 0.001), [3, 6, 11, 20], "slowly: as if standing");
}

#[test]
fn spread_assumptions_come_due_at_different_times_and_as_often() {
    let cubes = 200;
    let (scene, from) = rows_of_cubes(10);
    let counts = |spread| {
        let nine = QueryParameters { assume_visible: AssumeVisible::Frames(9), spread, ..chc(0) };
        queries(&walked(&scene, &vec![from(0.0); 41], &nine))
    };
    let (together, spread) = (counts(false), counts(true));
    assert_eq!(due(&together, cubes), [11, 21, 31, 41]);
    assert_eq!(spread, counts(true), "the same always");
    // Each cube within ten frames of the first, and from then on every tenth.
    assert_eq!(spread[1..11].iter().sum::<u64>(), cubes);
    assert_eq!(spread[1..11], spread[11..21]);
    assert_eq!(spread[1..11], spread[21..31]);
    let worst = spread[1..].iter().max().unwrap();
    assert!(worst * 5 < cubes, "{spread:?}");
}

#[test]
fn standing_still_idle_queries_find_all_that_shows_and_no_more_than_stop_and_wait() {
    let mut equal = 0;
    for (round, view, scene) in worlds(40, 120) {
        let (world, what) = (World::new(&scene), format!("round {round}"));
        let mut none = ChcMemory::default();
        let still = queried(Level::best(), &view, &world, &QueryParameters::new(false), &mut none, &what).objects;
        for latency in [0, 7] {
            let (idle, mut memory) = (QueryParameters { idle: true, ..chc(latency) }, ChcMemory::default());
            for _ in 0..4 {
                queried(Level::best(), &view, &world, &idle, &mut memory, &what);
            }
            let found = memory.visible_objects();
            assert!(found.iter().all(|o| still.contains(o)), "{what}: {found:?}, {still:?}");
            equal += usize::from(found.len() == still.len());
        }
    }
    assert!(equal > 40, "only {equal} of 80 are equal");
}

#[test]
fn another_scene_is_another_beginning() {
    let scenes: Vec<(usize, View, PreparedScene)> = worlds(6, 60).collect();
    let mut memory = ChcMemory::default();
    for (round, view, scene) in &scenes {
        queried(Level::best(), view, &World::new(scene), &chc(1), &mut memory, &format!("round {round}"));
    }
}

#[test]
fn a_node_of_few_visible_samples_counts_as_hidden() {
    let (mut dropped, mut all) = (0, 0);
    for (round, view, scene) in worlds(20, 90) {
        let world = World::new(&scene);
        let drawn = |pixels| {
            let parameters = QueryParameters { pixels, ..QueryParameters::new(false) };
            let mut canvas = Canvas::new(view.viewport(), Level::best()).unwrap();
            coherent::draw(&world, &view, &parameters, &mut ChcMemory::default(), &mut canvas).unwrap().objects
        };
        let exact = drawn(0);
        let (few, screen) = (drawn(50), drawn(view.viewport().width() * view.viewport().height()));
        all += exact.len();
        dropped += exact.iter().filter(|o| !few.contains(o)).count();
        // No box has more samples than the screen: what is left touches the near plane, or has no box.
        let mut boxes = ProjectedBoxes::new();
        let mut buffer = OcclusionBuffer::new(view.viewport());
        buffer.begin(&view).unwrap();
        buffer.project(&scene.boxes, scene.origin, &mut boxes).unwrap();
        let near = |id: u32| boxes.boxes().iter().any(|b| b.id() == id && b.touches_near_plane());
        assert!(
            screen.iter().all(|&id| near(id) || !scene.bounds[id as usize].is_finite()),
            "round {round}: {screen:?}"
        );
    }
    assert!(dropped > 0 && dropped < all, "{dropped} of {all}");
}

#[test]
fn another_scene_draws_nothing_of_the_last_one_first() {
    let workers = Workers::new(1).unwrap();
    let mut memory = HzbMemory::default();
    for objects in [120, 5, 60] {
        for (round, view, scene) in worlds(2, objects) {
            let world = World::new(&scene);
            let mut canvas = Canvas::new(view.viewport(), Level::best()).unwrap();
            hzb::draw(&world, &workers, &view, true, &mut memory, &mut canvas).unwrap();
            assert!(canvas.equals(&everything(Level::best(), &view, &world)), "{objects} objects, round {round}");
        }
    }
}

#[test]
fn the_hierarchical_z_buffer_keeps_the_picture_in_any_number_of_bands() {
    for (round, view, scene) in worlds(30, 90) {
        let world = World::new(&scene);
        for first in [false, true] {
            let what = format!("round {round}, first {first}");
            let gold = for_levels(&what, |level| {
                let mut sets = Vec::new();
                for threads in [1, 2, 3] {
                    let workers = Workers::new(threads).unwrap();
                    let mut memory = HzbMemory::default();
                    let mut canvas = Canvas::new(view.viewport(), level).unwrap();
                    let mut frames = Vec::new();
                    for _ in 0..2 {
                        let set = hzb::draw(&world, &workers, &view, first, &mut memory, &mut canvas).unwrap();
                        assert!(canvas.equals(&everything(level, &view, &world)), "{what}, {threads} threads");
                        frames.push(set.objects);
                    }
                    sets.push(frames);
                }
                assert!(sets.iter().all(|s| *s == sets[0]), "{what}");
                sets.swap_remove(0)
            });
            let mut none = ChcMemory::default();
            let still = queried(Level::best(), &view, &world, &QueryParameters::new(false), &mut none, &what);
            assert_eq!(gold[0], sorted(still.objects), "{what}: at no latency, stop-and-wait is the same");
        }
    }
}
