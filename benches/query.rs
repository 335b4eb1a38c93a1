//! Box tests against the buffer of everything in the frustum. Items are boxes tested, an iteration is a pass over every
//! view. More than one thread share a buffer by reference, each with a part of the boxes.

mod scenes;

use divan::Bencher;
use divan::counter::ItemsCount;
use homcull::occlusion::{OcclusionBuffer, ProjectedBoxes};
use homcull::scene::PreparedScene;
use homcull::workers::Workers;
use scenes::{Case, Stage, on_one_and_two_threads, on_one_thread};

fn main() {
    scenes::run();
}

/// A buffer for each view, full, with the boxes of its frustum.
fn full_buffers(case: &Case) -> Vec<(OcclusionBuffer, ProjectedBoxes)> {
    let views = &scenes::ground(case.scene).views;
    let full = |view| {
        let mut stage = Stage::new(case);
        let occluders = stage.occluders(view);
        stage.submit(view, &occluders);
        let mut boxes = ProjectedBoxes::new();
        stage.buffer.project(&stage.ground.scene.boxes, stage.ground.scene.origin, &mut boxes).expect("a begun view");
        boxes.sort();
        (stage.buffer, boxes)
    };
    views.iter().map(full).collect()
}

fn count(buffers: &[(OcclusionBuffer, ProjectedBoxes)]) -> ItemsCount {
    ItemsCount::new(buffers.iter().map(|(_, boxes)| boxes.len()).sum::<usize>())
}

/// Tests alone, of boxes that have been projected.
#[divan::bench(args = on_one_and_two_threads())]
fn test(bencher: Bencher<'_, '_>, case: &Case) {
    let buffers = full_buffers(case);
    let scene = &scenes::ground(case.scene).scene;
    let workers = Workers::new(case.threads).expect("threads can be started");
    let mut parts: Vec<Part> =
        (0..case.threads).map(|i| Part { number: i, of: case.threads, hidden: Vec::new() }).collect();
    bencher.counter(count(&buffers)).bench_local(|| {
        for (buffer, boxes) in &buffers {
            workers.run(&mut parts, |part| part.test(buffer, boxes, scene));
        }
    });
}

/// One thread's share of the boxes.
struct Part {
    number: usize,
    of: usize,
    hidden: Vec<bool>,
}

impl Part {
    fn test(&mut self, buffer: &OcclusionBuffer, boxes: &ProjectedBoxes, scene: &PreparedScene) {
        let range = boxes.len() * self.number / self.of..boxes.len() * (self.number + 1) / self.of;
        buffer.test_projected(boxes, range, &scene.bounds, scene.origin, &mut self.hidden).expect("a begun view");
    }
}

/// Frustum test and projection alone. Items are those that end up in the frustum.
#[divan::bench(args = on_one_thread())]
fn project(bencher: Bencher<'_, '_>, case: &Case) {
    let mut buffers = full_buffers(case);
    let scene = &scenes::ground(case.scene).scene;
    bencher.counter(count(&buffers)).bench_local(|| {
        for (buffer, boxes) in &mut buffers {
            buffer.project(&scene.boxes, scene.origin, boxes).expect("a begun view");
        }
    });
}

/// The radix sort by distance.
#[divan::bench(args = on_one_thread())]
fn sort(bencher: Bencher<'_, '_>, case: &Case) {
    let mut buffers = full_buffers(case);
    bencher.counter(count(&buffers)).bench_local(|| buffers.iter_mut().for_each(|(_, boxes)| boxes.sort()));
}
