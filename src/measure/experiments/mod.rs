//! The papers' claims as experiments: each a measurement over chosen scenes, with a table, a plot, and a statement that is
//! computed from its figures (each experiment names the section, of Zhang 1998 unless it says otherwise).
//!
//! An experiment is a line of [`EXPERIMENTS`] and a function from places to [`Findings`]; what it walks with are methods as the
//! command line writes them, so that every row can be repeated by `homcull walk`. Counts and errors are exact and the same on
//! every machine; milliseconds are not, and only experiments about time use them.

mod aggressive;
mod chc;
mod chc_nodes;
mod deb_resolution;
mod distance_fails;
mod figure_7_3;
mod findings;
mod levels;
mod map_resolution;
mod no_occluders;
mod occluder_limit;
mod pipeline;
mod plot;
mod plp;
mod redundant_occluders;
mod threshold;
mod verdicts;

use std::path::Path;

use homcull_simd::Level;

use super::report::{MethodRun, WalkReport};
use super::walk::{WalkOptions, walk};
use crate::cull::Method;
use crate::error::{Error, Result};
use crate::scene::{Generated, PreparedScene, Scene};
use crate::view::View;
use crate::workers::Workers;

pub use findings::{Axis, Cell, Column, Curve, Findings, Panel, Scale, Statement};
pub use plot::plot;

/// An experiment.
#[derive(Debug, Clone, Copy)]
pub struct Experiment {
    /// Its name on the command line.
    pub name: &'static str,
    /// Where the claim is made: a section of the thesis, or a paper and its section.
    pub section: &'static str,
    /// What it shows, in a line.
    pub shows: &'static str,
    /// Where it is made unless another scene is named.
    pub places: Places,
    /// Frames of each place's walk unless said otherwise.
    pub frames: u32,
    /// Measures, and judges.
    pub run: fn(&Bench<'_>, &[Place]) -> Result<Findings>,
}

/// Where an experiment is made by default.
#[derive(Debug, Clone, Copy)]
pub enum Places {
    /// In scenes, as SCENE arguments.
    Scenes(&'static [&'static str]),
    /// In a scene built for it, of this name.
    Built(&'static str, fn() -> Generated),
}

/// All experiments, those of the thesis in its order, then the other papers'.
pub static EXPERIMENTS: [Experiment; 12] = [
    map_resolution::EXPERIMENT,
    no_occluders::EXPERIMENT,
    deb_resolution::EXPERIMENT,
    redundant_occluders::EXPERIMENT,
    distance_fails::EXPERIMENT,
    occluder_limit::EXPERIMENT,
    levels::EXPERIMENT,
    threshold::EXPERIMENT,
    aggressive::EXPERIMENT,
    pipeline::EXPERIMENT,
    chc::EXPERIMENT,
    plp::EXPERIMENT,
];

/// The plant at a size that loads in a second.
const PLANT: &str = "plant:triangles=1000000";

/// All tests are made in all frames: counts are then of the method, not of when it gives up or rests.
const ALL_TESTS: &str = "bypass=4294967295,rest=0";

/// A scene with its views.
pub struct Place {
    /// The scene; its name is the SCENE argument.
    pub scene: Scene,
    /// The same, ready for frames.
    pub prepared: PreparedScene,
    /// The walk, at one size; not empty.
    pub views: Vec<View>,
}

/// What an experiment works with.
pub struct Bench<'a> {
    /// SIMD level of everything.
    pub level: Level,
    /// Threads of everything that knows threads.
    pub workers: &'a Workers,
    /// Times each frame is drawn by each method where time is measured; `None` lets the experiment choose.
    pub repetitions: Option<usize>,
    /// The folder for files that an experiment needs beside its result.
    pub out: &'a Path,
    /// Told how much work there is, and of each step done.
    pub progress: &'a dyn Fn(Progress),
}

/// Work, in frames times methods.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// So many steps more are to be done.
    Ahead(usize),
    /// One step is done.
    Done,
}

impl Experiment {
    /// The paper and its section.
    pub fn source(&self) -> String {
        if findings::of_thesis(self.section) { format!("thesis {}", self.section) } else { self.section.to_owned() }
    }

    /// The experiment of that name.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the names there are.
    pub fn find(name: &str) -> Result<&'static Experiment> {
        EXPERIMENTS.iter().find(|e| e.name == name).ok_or_else(|| {
            let names: Vec<&str> = EXPERIMENTS.iter().map(|e| e.name).collect();
            Error::parameter("experiment", name, format!("is unknown; known are {}", names.join(", ")))
        })
    }
}

impl Places {
    /// Their names, as a table shows them.
    pub fn names(&self) -> String {
        match self {
            Places::Scenes(names) => names.join(" "),
            Places::Built(name, _) => format!("({name})"),
        }
    }
}

impl Place {
    /// Prepares a scene.
    ///
    /// # Errors
    /// Those of [`PreparedScene::new`]; [`Error::View`] without views.
    pub fn new(scene: Scene, views: Vec<View>) -> Result<Place> {
        if views.is_empty() {
            return Err(Error::View(format!("the scene '{}' has no views", scene.name)));
        }
        Ok(Place { prepared: PreparedScene::new(&scene)?, scene, views })
    }

    /// Width and height of its views, in samples.
    pub fn size(&self) -> (u32, u32) {
        let viewport = self.views[0].viewport();
        (viewport.width(), viewport.height())
    }
}

impl Bench<'_> {
    /// Walks a place with methods as the command line writes them, each frame drawn `repetitions` times (the user's choice goes
    /// first), errors against the exact item buffer included.
    ///
    /// # Errors
    /// Those of [`Method::parse`] and [`walk`].
    pub fn walk(&self, place: &Place, methods: &[String], repetitions: usize) -> Result<WalkReport> {
        let parsed = methods.iter().map(|m| Method::parse(m)).collect::<Result<Vec<_>>>()?;
        self.walk_methods(place, &parsed, repetitions)
    }

    /// As [`Bench::walk`].
    ///
    /// # Errors
    /// Those of [`walk`].
    pub fn walk_methods(&self, place: &Place, methods: &[Method], repetitions: usize) -> Result<WalkReport> {
        (self.progress)(Progress::Ahead(place.views.len() * methods.len()));
        let repetitions = self.repetitions.unwrap_or(repetitions);
        let options = WalkOptions { level: self.level, workers: self.workers, repetitions, exact: true };
        walk(&place.scene.name, &place.prepared, &place.views, methods, &options, |_| {
            (self.progress)(Progress::Done);
            Ok(())
        })
    }
}

/// Triangles drawn in a frame, on the mean.
fn triangles_drawn(report: &WalkReport, run: &MethodRun) -> f64 {
    run.mean(report.pixels()).triangles_drawn
}

/// Wrong pixels in percent of the view's, mean of the frames.
fn wrong_percent(report: &WalkReport, run: &MethodRun) -> f64 {
    run.wrong_pixels_percent(report.pixels()).map_or(f64::NAN, |wrong| wrong.mean)
}

/// The block of samples of a level-0 pixel, as `block=` writes it, for a map of about `side` by `side` pixels.
fn block_of(place: &Place, side: u32) -> String {
    let (width, height) = place.size();
    format!("{}x{}", width.div_ceil(side), height.div_ceil(side))
}

/// Percent of the hidden triangles in the frustum that a run culled, of all frames together: 100 is exact.
fn hidden_share(report: &WalkReport, run: &MethodRun) -> f64 {
    let mean = run.mean(report.pixels());
    let hidden = mean.triangles_in_frustum - mean.triangles_visible_exact.unwrap_or(f64::NAN);
    100.0 * (mean.triangles_in_frustum - mean.triangles_drawn) / hidden
}
