//! Everything in the frustum, nearest first, into a cleared buffer: what drawing occluders costs. Items are triangles
//! submitted, an iteration is a frame of every view.

mod scenes;

use divan::Bencher;
use divan::counter::ItemsCount;
use homcull::occlusion::Occluder;
use homcull::occlusion::OcclusionSettings;
use scenes::{Case, Stage, on_one_and_two_threads, on_one_thread};

fn main() {
    scenes::run();
}

/// The occluders of every view, and how many triangles they have.
fn lists(stage: &mut Stage) -> (Vec<Vec<Occluder>>, usize) {
    let views = &stage.ground.views;
    let lists: Vec<Vec<Occluder>> = views.iter().map(|view| stage.occluders(view)).collect();
    let triangles = lists.iter().map(|list| stage.triangles(list)).sum();
    (lists, triangles)
}

fn draw_all(bencher: Bencher<'_, '_>, stage: &mut Stage) {
    let (lists, triangles) = lists(stage);
    let views = &stage.ground.views;
    bencher
        .counter(ItemsCount::new(triangles))
        .bench_local(|| views.iter().zip(&lists).for_each(|(view, list)| stage.submit(view, list)));
}

/// Coverage and depth, hidden clusters dropped whole: the default.
#[divan::bench(args = on_one_and_two_threads())]
fn coverage_and_depth(bencher: Bencher<'_, '_>, case: &Case) {
    draw_all(bencher, &mut Stage::new(case));
}

/// Without the cluster test: every triangle is looked at.
#[divan::bench(args = on_one_thread())]
fn without_cluster_test(bencher: Bencher<'_, '_>, case: &Case) {
    let mut stage = Stage::with(case, OcclusionSettings { cluster_test: false, ..OcclusionSettings::default() });
    draw_all(bencher, &mut stage);
}

/// The occlusion map alone.
#[divan::bench(args = on_one_thread())]
fn coverage(bencher: Bencher<'_, '_>, case: &Case) {
    let mut stage = Stage::with(case, OcclusionSettings { keep_depth: false, ..OcclusionSettings::default() });
    draw_all(bencher, &mut stage);
}
