//! Methods that cull while they draw: the hierarchical Z-buffer, stop-and-wait, coherent hierarchical culling. The picture is that of
//! everything, at any latency; standing still, all find the same visible set.
#![cfg(feature = "bvh")]

mod oracle;

use homcull::cull::VisibleSet;
use homcull::cull::chc::ChcMemory;
use homcull::cull::coherent::{self, Latency, QueryParameters, Traversal};
use homcull::cull::hzb::{self, HzbMemory};
use homcull::cull::vfc::{self, VfcMemory, World};
use homcull::draw::{Canvas, DrawJob};
use homcull::occlusion::{OcclusionBuffer, ProjectedBoxes};
use homcull::scene::PreparedScene;
use homcull::view::View;
use homcull::workers::Workers;
use homcull_simd::Level;
use oracle::random::Random;
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
        QueryParameters { assume_visible: 2, ..chc(9) },
        QueryParameters { speculate: true, ..chc(1000) },
        QueryParameters { latency: Latency::Thread, speculate: true, ..chc(0) },
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
