//! The hierarchical occlusion maps: all levels anew, and brought in step after one object. Items are pixels of all levels
//! where all are computed. The pyramid is built on one thread: it costs microseconds.

mod scenes;

use divan::Bencher;
use divan::counter::ItemsCount;
use homcull::occlusion::{OcclusionBuffer, OcclusionSettings, Pyramid, PyramidShape};
use scenes::{Case, Stage, on_one_thread};

fn main() {
    scenes::run();
}

fn pixels(pyramid: &Pyramid) -> usize {
    (0..pyramid.levels()).map(|level| pyramid.size(level)).map(|(width, height)| width * height).sum()
}

/// A buffer with all that the middle view's frustum holds.
fn full(case: &Case) -> (Stage, usize) {
    let mut stage = Stage::new(case);
    let view = &stage.ground.views[stage.ground.views.len() / 2];
    let occluders = stage.occluders(view);
    stage.submit(view, &occluders);
    let pixels = pixels(stage.buffer.pyramid());
    (stage, pixels)
}

fn top(buffer: &mut OcclusionBuffer) -> u32 {
    let pyramid = buffer.pyramid();
    pyramid.holes(pyramid.levels() - 1, 0, 0)
}

/// A whole build.
#[divan::bench(args = on_one_thread())]
fn build(bencher: Bencher<'_, '_>, case: &Case) {
    let (mut stage, pixels) = full(case);
    bencher.counter(ItemsCount::new(pixels)).bench_local(|| {
        stage.buffer.mark_all_changed();
        top(&mut stage.buffer)
    });
}

/// A whole build where level-0 pixels are blocks of 20x16 samples, as the machine room's finest active map has them at
/// 1280x1024 (thesis 8.4.2): cut out of the words.
#[divan::bench(args = on_one_thread())]
fn build_of_other_blocks(bencher: Bencher<'_, '_>, case: &Case) {
    let (mut stage, _) = full(case);
    let shape = PyramidShape { block: [20, 16], minimal: [1, 1] };
    let settings = OcclusionSettings { pyramid: shape, ..OcclusionSettings::default() };
    stage.buffer.set_settings(settings).expect("a block that can be");
    bencher.bench_local(|| {
        stage.buffer.mark_all_changed();
        top(&mut stage.buffer)
    });
}

/// One more object, and the pyramid in step with it: an update of progressive culling with thresholds below 1.
#[divan::bench(args = on_one_thread())]
fn update(bencher: Bencher<'_, '_>, case: &Case) {
    let mut stage = Stage::new(case);
    let view = &stage.ground.views[stage.ground.views.len() / 2];
    let occluders = stage.occluders(view);
    let meshes = &stage.ground.scene.meshes;
    let mut next = occluders.iter().cycle();
    bencher.bench_local(|| {
        stage.buffer.submit(meshes, std::slice::from_ref(next.next().expect("objects in view"))).expect("a begun view");
        top(&mut stage.buffer)
    });
}
