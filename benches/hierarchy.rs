//! Building the hierarchy. The first two cases are those in which a builder of bounding volume hierarchies may turn
//! quadratic: 10,000 boxes that are all the same, and a row of 10,000. Each must stay below [`MOST`]; that is asserted here,
//! on the fastest of three builds before any timing, and not left to the reader of a table.

mod scenes;

use std::time::{Duration, Instant};

use divan::Bencher;
use divan::counter::ItemsCount;
use glam::Vec3;
use homcull::geometry::Aabb;
use homcull::scene::{Hierarchy, WideHierarchy};

/// A build may take no longer.
const MOST: Duration = Duration::from_millis(50);
const CASES: [&str; 3] = ["10,000 identical", "a row of 10,000", "the city"];

fn main() {
    for case in CASES {
        let boxes = boxes(case);
        let fastest = (0..3).map(|_| timed(|| WideHierarchy::new(&boxes))).min();
        assert!(fastest < Some(MOST), "{case}: {fastest:?}, should take less than {MOST:?}");
    }
    scenes::run();
}

fn timed<T>(run: impl FnOnce() -> T) -> Duration {
    let start = Instant::now();
    divan::black_box(run());
    start.elapsed()
}

fn boxes(case: &str) -> Vec<Aabb> {
    let unit = |x: f32| Aabb { min: Vec3::new(x, 0.0, 0.0), max: Vec3::new(x + 1.0, 1.0, 1.0) };
    match case {
        "10,000 identical" => vec![unit(0.0); 10_000],
        "a row of 10,000" => (0..10_000).map(|i| unit(i as f32)).collect(),
        _ => scenes::ground("city").scene.bounds.clone(),
    }
}

/// The binary tree.
#[divan::bench(args = CASES)]
fn binary(bencher: Bencher<'_, '_>, case: &str) {
    let boxes = boxes(case);
    bencher.counter(ItemsCount::new(boxes.len())).bench_local(|| Hierarchy::build(&boxes));
}

/// The tree of sixteen children a node that is walked, the binary one included.
#[divan::bench(args = CASES)]
fn wide(bencher: Bencher<'_, '_>, case: &str) {
    let boxes = boxes(case);
    bencher.counter(ItemsCount::new(boxes.len())).bench_local(|| WideHierarchy::new(&boxes));
}

/// Boxes that have moved, in the tree that they had.
#[divan::bench(args = CASES)]
fn refit(bencher: Bencher<'_, '_>, case: &str) {
    let boxes = boxes(case);
    let mut tree = Hierarchy::build(&boxes);
    bencher.counter(ItemsCount::new(boxes.len())).bench_local(|| tree.refit(&boxes));
}
