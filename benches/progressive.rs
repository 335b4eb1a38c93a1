//! A whole frame of progressive culling: clear, frustum, sort, and the walk, nearest first, in which what is visible
//! becomes an occluder before the next box is tested. Items are boxes in the frustum, an iteration is a frame of every
//! view.

mod scenes;

use divan::Bencher;
use divan::counter::ItemsCount;
use homcull::cull::hom::{self, HomFrame};
use homcull::cull::vfc::World;
use homcull::cull::{HomParameters, Update};
use homcull::occlusion::{Occluders, ProgressiveJob, ProjectedBoxes};
use scenes::{Case, Stage, on_one_and_two_threads, on_one_thread};

fn main() {
    scenes::run();
}

fn boxes_in_views(stage: &mut Stage) -> ItemsCount {
    let views = &stage.ground.views;
    ItemsCount::new(views.iter().map(|view| stage.boxes(view).len()).sum::<usize>())
}

/// Over the list of boxes, in bands of the screen: [`homcull::occlusion::OcclusionBuffer::progressive`].
#[divan::bench(args = on_one_and_two_threads())]
fn boxes(bencher: Bencher<'_, '_>, case: &Case) {
    let mut stage = Stage::new(case);
    let count = boxes_in_views(&mut stage);
    let Stage { ground, buffer, workers } = &mut stage;
    let scene = &ground.scene;
    let world =
        Occluders { meshes: &scene.meshes, occluders: &scene.occluders, bounds: &scene.bounds, origin: scene.origin };
    let (mut boxes, mut visible) = (ProjectedBoxes::new(), Vec::new());
    bencher.counter(count).bench_local(|| {
        for view in &ground.views {
            buffer.begin(view).expect("a view of the buffer's size");
            buffer.project(&scene.boxes, scene.origin, &mut boxes).expect("a begun view");
            boxes.sort();
            let run = |jobs: &mut [ProgressiveJob<'_>]| workers.run(jobs, ProgressiveJob::run);
            buffer.progressive(&boxes, &world, &mut visible, workers.bands(), run).expect("a begun view");
        }
    });
}

/// Through the hierarchy: the method `hom-progressive`, without the draw, and without rests: every frame is culled.
#[divan::bench(args = on_one_thread())]
fn hierarchy(bencher: Bencher<'_, '_>, case: &Case) {
    let mut stage = Stage::new(case);
    let count = boxes_in_views(&mut stage);
    let views = &stage.ground.views;
    let world = World::new(&stage.ground.scene);
    let parameters = HomParameters { rest: 0, ..HomParameters::new(Update::Always) };
    let mut kept = Some(HomFrame::new(&views[0], case.level, &parameters).expect("a level of this CPU"));
    bencher.counter(count).bench_local(|| {
        for view in views {
            let frame = kept.take().expect("the frame is handed back");
            let frame = hom::select_occluders(&world, case.level, view, &parameters, frame).expect("a possible view");
            let (set, frame) = hom::cull(&world, &stage.workers, &parameters, frame).expect("a begun view");
            divan::black_box(set);
            kept = Some(frame);
        }
    });
}
