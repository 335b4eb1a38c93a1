//! What the benches look at: the generated city and terrain, from a few views of their own walks, at the size of the
//! thesis's experiments, so that they run without any file.
//!
//! Every bench runs each case, a scene at a SIMD level of this CPU on a number of threads, and counts one frame of every
//! view as one iteration: its items per second are over the whole walk, not over a view that happens to suit.

#![allow(dead_code)] // each bench uses its part

use std::fmt;
use std::sync::OnceLock;

use homcull::occlusion::{BandJob, Occluder, OcclusionBuffer, OcclusionSettings, ProjectedBoxes};
use homcull::scene::{PreparedScene, parse};
use homcull::view::{View, Viewport};
use homcull::workers::Workers;
use homcull_simd::Level;

/// Views of each walk, evenly spread, without its ends, which are one where a walk goes around.
const VIEWS: usize = 6;

/// One row of a bench.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    pub scene: &'static str,
    pub level: Level,
    pub threads: usize,
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} x{}", self.scene, self.level.name(), self.threads)
    }
}

/// Both scenes at every level of this CPU, on one thread.
pub fn on_one_thread() -> Vec<Case> {
    cases(&[1])
}

/// The same on one thread and on two.
pub fn on_one_and_two_threads() -> Vec<Case> {
    cases(&[1, 2])
}

fn cases(threads: &[usize]) -> Vec<Case> {
    let levels = || Level::ALL.into_iter().filter(|level| level.is_available());
    let scenes = ["city", "terrain"].into_iter();
    let of_scene =
        |scene| levels().flat_map(move |level| threads.iter().map(move |&threads| Case { scene, level, threads }));
    scenes.flat_map(of_scene).collect()
}

/// A scene made ready, and how it is looked at.
pub struct Ground {
    pub scene: PreparedScene,
    pub views: Vec<View>,
}

/// The ground of a name, made once.
pub fn ground(name: &str) -> &'static Ground {
    static CITY: OnceLock<Ground> = OnceLock::new();
    static TERRAIN: OnceLock<Ground> = OnceLock::new();
    let place = if name == "city" { &CITY } else { &TERRAIN };
    place.get_or_init(|| {
        let generated = parse(name).expect("a generator of this name");
        let viewport = Viewport::new(1280, 1024).expect("a possible size");
        let cameras = generated.path.sample(VIEWS + 2).expect("a path that can be walked");
        let views = cameras[1..=VIEWS].iter().map(|c| c.view(viewport).expect("a possible view")).collect();
        Ground { scene: PreparedScene::new(&generated.scene).expect("a sound scene"), views }
    })
}

/// A case ready to run: its ground, a buffer at its level, and its threads.
pub struct Stage {
    pub ground: &'static Ground,
    pub buffer: OcclusionBuffer,
    pub workers: Workers,
}

impl Stage {
    pub fn new(case: &Case) -> Stage {
        Stage::with(case, OcclusionSettings::default())
    }

    pub fn with(case: &Case, settings: OcclusionSettings) -> Stage {
        let ground = ground(case.scene);
        let viewport = ground.views[0].viewport();
        let buffer = OcclusionBuffer::with_level(viewport, case.level, settings);
        Stage {
            ground,
            buffer: buffer.expect("a level of this CPU"),
            workers: Workers::new(case.threads).expect("threads can be started"),
        }
    }

    /// The boxes in a view's frustum, projected and nearest first. Begins the view.
    pub fn boxes(&mut self, view: &View) -> ProjectedBoxes {
        let mut boxes = ProjectedBoxes::new();
        self.buffer.begin(view).expect("a view of the buffer's size");
        self.buffer.project(&self.ground.scene.boxes, self.ground.scene.origin, &mut boxes).expect("a begun view");
        boxes.sort();
        boxes
    }

    /// The objects in a view's frustum, nearest first.
    pub fn occluders(&mut self, view: &View) -> Vec<Occluder> {
        let boxes = self.boxes(view);
        boxes.boxes().iter().map(|b| self.ground.scene.occluders[b.id() as usize]).collect()
    }

    /// Draws occluders into a cleared buffer.
    pub fn submit(&mut self, view: &View, occluders: &[Occluder]) {
        let Stage { ground, buffer, workers } = self;
        buffer.begin(view).expect("a view of the buffer's size");
        let meshes = &ground.scene.meshes;
        let done = match workers.threads() {
            1 => buffer.submit(meshes, occluders),
            _ => buffer.submit_in_bands(meshes, occluders, workers.bands(), |jobs| workers.run(jobs, BandJob::run)),
        };
        done.expect("a begun view");
    }

    /// Triangles of a list of occluders.
    pub fn triangles(&self, occluders: &[Occluder]) -> usize {
        occluders.iter().map(|o| self.ground.scene.meshes.triangles(o.mesh) as usize).sum()
    }
}

/// Runs the benches of this program: 20 samples, at most 2 seconds a case, unless its arguments or `DIVAN_...` say otherwise.
pub fn run() {
    let most = std::time::Duration::from_secs(2);
    divan::Divan::default().sample_count(20).max_time(most).config_with_args().main();
}
