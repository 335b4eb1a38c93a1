//! Walks: methods along a camera path, interleaved, against the exact item buffer.
//!
//! Every frame is drawn by every method as often as asked, in turn, so that what slows the machine slows all of them; of each
//! method's repetitions the fastest counts. The exact reference, everything in the frustum, is drawn once a frame and
//! never timed. Methods in the pipeline cannot take turns frame by frame: they walk the whole path when the others are done,
//! once to be judged, then to be timed (`walk_pipeline.rs`).

use homcull_simd::Level;

use super::clock::clock_ghz;
use super::memory::peak_memory_bytes;
use super::report::{FrameRecord, MethodRun, WalkReport};
use super::runner::Runner;
pub use super::stage::applies;
use super::statistics::median;
use super::walk_pipeline;
use crate::cull::hom::HomFrame;
use crate::cull::vfc::{self, VfcMemory, World};
use crate::cull::{Method, SharedCells, SharedSources, VisibleSet};
use crate::draw::{Canvas, DrawJob};
use crate::error::Result;
use crate::hash::Hash;
use crate::occlusion::OverlapStatistics;
use crate::scene::PreparedScene;
use crate::view::View;
use crate::workers::Workers;

/// How to walk.
pub struct WalkOptions<'a> {
    /// SIMD level of everything.
    pub level: Level,
    /// Threads of the occluder draw and the final draw.
    pub workers: &'a Workers,
    /// Times each frame is drawn by each method, at least 1.
    pub repetitions: usize,
    /// Whether errors are measured against the exact item buffer.
    pub exact: bool,
}

/// What may be looked at after a frame of a method: for pictures.
pub struct FrameLook<'a> {
    /// Frame number.
    pub frame: usize,
    /// Which of the methods.
    pub method: usize,
    /// The frame's view.
    pub view: &'a View,
    /// The picture.
    pub canvas: &'a Canvas,
    /// What was drawn.
    pub drawn: &'a [u32],
    /// Everything in the frustum.
    pub in_frustum: &'a [u32],
    /// The occlusion representation, of hom methods.
    pub hom: Option<&'a mut HomFrame>,
}

/// Walks a path with some methods. `look` is called once a frame and method, outside all timing.
///
/// # Errors
/// Those of views, methods and SIMD levels.
pub fn walk(
    name: &str,
    scene: &PreparedScene,
    views: &[View],
    methods: &[Method],
    options: &WalkOptions<'_>,
    mut look: impl FnMut(FrameLook<'_>) -> Result<()>,
) -> Result<WalkReport> {
    let mut report = WalkReport {
        scene_name: name.to_owned(),
        objects: scene.occluders.len() as u64,
        triangles: scene.colors.len() as u64,
        frames: views.len(),
        simd: options.level.name().to_owned(),
        threads: options.workers.threads(),
        ..WalkReport::default()
    };
    let Some(first) = views.first() else { return Ok(report) };
    (report.width, report.height) = (first.viewport().width(), first.viewport().height());
    let world = World::new(scene);
    let mut exact = Exact::new(first, &world, options.level)?;
    let overlaps = |m: &Method| matches!(m, Method::Hom(p) if p.pipeline);
    let in_turn = methods.iter().enumerate().filter(|(_, m)| !overlaps(m));
    let mut sources = SharedSources::default();
    let mut cells = SharedCells::default();
    let new = |(i, m)| Runner::new(i, m, &world, first, options, (&mut sources, &mut cells));
    let mut runners = in_turn.map(new).collect::<Result<Vec<_>>>()?;
    let mut clocks = Vec::new();
    walk_in_turn(&world, views, &mut runners, &mut exact, options, &mut clocks, &mut look)?;
    let mut runs: Vec<_> = runners.into_iter().map(|r| (r.place, r.tally.finish(r.method))).collect();
    for (i, method) in methods.iter().enumerate() {
        if let Method::Hom(parameters) = method
            && parameters.pipeline
        {
            let sources = sources.of(scene, parameters)?;
            let path = walk_pipeline::Path { world: &world, views, options, method: i, sources };
            let tally = path.walk(parameters, &mut exact, &mut clocks, &mut look)?;
            runs.push((i, tally.finish(method)));
        }
    }
    runs.sort_by_key(|(place, _)| *place);
    report.clock_ghz = median(&clocks).unwrap_or(0.0);
    report.peak_memory_bytes = peak_memory_bytes();
    report.runs = runs.into_iter().map(|(_, run)| run).collect();
    Ok(report)
}

/// Walks with methods whose frames do not overlap, side by side.
fn walk_in_turn<'s>(
    world: &World<'s>,
    views: &[View],
    runners: &mut [Runner<'_, 's>],
    exact: &mut Exact,
    options: &WalkOptions<'_>,
    clocks: &mut Vec<f64>,
    look: &mut impl FnMut(FrameLook<'_>) -> Result<()>,
) -> Result<()> {
    if runners.is_empty() {
        return Ok(());
    }
    for (frame, view) in views.iter().enumerate() {
        exact.look(world, view, options)?;
        runners.iter_mut().for_each(Runner::begin_frame);
        for repetition in 0..options.repetitions.max(1) {
            clocks.push(clock_ghz());
            for i in 0..runners.len() {
                // Methods change places from repetition to repetition: none always follows the same one.
                let i = (i + repetition) % runners.len();
                let set = runners[i].draw(world, view, exact, options)?;
                if repetition == 0 {
                    let method = runners[i].place;
                    let (canvas, tally, hom) = runners[i].look();
                    tally.judge(world, &set, canvas, exact, options.exact);
                    look(FrameLook {
                        frame,
                        method,
                        view,
                        canvas,
                        drawn: &set.objects,
                        in_frustum: &exact.in_frustum,
                        hom,
                    })?;
                }
            }
        }
    }
    Ok(())
}

/// The exact reference of a frame.
pub(super) struct Exact {
    canvas: Canvas,
    memory: VfcMemory,
    pub in_frustum: Vec<u32>,
    triangles_in_frustum: u64,
    /// Samples that show each object.
    pub samples: Vec<u32>,
    /// Samples that each object covers, hidden or not.
    fragments: Vec<u64>,
    hash: u64,
}

impl Exact {
    fn new(view: &View, world: &World<'_>, level: Level) -> Result<Exact> {
        let objects = world.scene.occluders.len();
        Ok(Exact {
            canvas: Canvas::new(view.viewport(), level)?,
            memory: VfcMemory::default(),
            in_frustum: Vec::new(),
            triangles_in_frustum: 0,
            samples: vec![0; objects],
            fragments: vec![0; objects],
            hash: 0,
        })
    }

    pub fn look(&mut self, world: &World<'_>, view: &View, options: &WalkOptions<'_>) -> Result<()> {
        let set = vfc::cull(world, options.level, view, &mut self.memory);
        let fragments = self.canvas.count_fragments(view, world.scene, &set.objects)?;
        for (&object, count) in set.objects.iter().zip(fragments) {
            self.fragments[object as usize] = count;
        }
        let workers = options.workers;
        self.canvas.draw(view, world.scene, &set.objects, workers.bands(), |jobs| workers.run(jobs, DrawJob::run))?;
        self.canvas.count_items(world.scene, &mut self.samples);
        self.hash = self.canvas.hash(world.scene);
        (self.in_frustum, self.triangles_in_frustum) = (set.objects, set.triangles_in_frustum);
        Ok(())
    }
}

/// What is taken down of a method's frames.
#[derive(Default)]
pub(super) struct Tally {
    pub frames: Vec<FrameRecord>,
    image_hash: Hash,
    set_hash: Hash,
    overlap: OverlapStatistics,
}

impl Tally {
    /// Takes down a frame's counts and errors, in the last record, whose times are kept.
    pub fn judge(&mut self, world: &World<'_>, set: &VisibleSet, canvas: &Canvas, exact: &Exact, errors: bool) {
        let scene = world.scene;
        let mut drawn = set.objects.clone();
        drawn.sort_unstable();
        for &object in &drawn {
            self.set_hash.add(object.into());
        }
        self.set_hash.add(u64::MAX);
        self.overlap += &set.overlap;
        let equal = canvas.equals(&exact.canvas);
        self.image_hash.add(if equal { exact.hash } else { canvas.hash(scene) });
        let visible = |o: &&u32| exact.samples[**o as usize] > 0;
        let seen: Vec<u32> = exact.in_frustum.iter().filter(visible).copied().collect();
        let missing = seen.iter().filter(|o| drawn.binary_search(o).is_err()).count() as u32;
        let wrong = if equal { 0 } else { canvas.differing_samples(&exact.canvas, scene) };
        let Some(record) = self.frames.last_mut() else { return };
        *record = FrameRecord {
            frame_ms: record.frame_ms,
            stage_ms: record.stage_ms,
            stages: std::mem::take(&mut record.stages),
            pipeline_ms: record.pipeline_ms,
            objects_in_frustum: exact.in_frustum.len() as u32,
            objects_drawn: drawn.len() as u32,
            objects_visible_exact: errors.then_some(seen.len() as u32),
            triangles_after_lod: scene.colors.len() as u64,
            triangles_in_frustum: exact.triangles_in_frustum,
            triangles_drawn: world.triangles(&drawn),
            triangles_visible_exact: errors.then(|| world.triangles(&seen)),
            fragments: drawn.iter().map(|&o| exact.fragments[o as usize]).sum(),
            occluder_triangles: set.occluder_triangles,
            queries: set.queries,
            waited_steps: set.waited.steps,
            waited_ms: set.waited.nanoseconds as f64 * 1e-6,
            bypassed: set.bypassed,
            wrongly_culled: errors.then_some(missing),
            wrong_pixels: errors.then_some(wrong),
        };
    }

    fn finish(self, method: &Method) -> MethodRun {
        MethodRun {
            name: None,
            method: method.name(),
            parameters: method.parameters(),
            frames: self.frames,
            image_hash: self.image_hash.value(),
            visible_set_hash: self.set_hash.value(),
            overlap: self.overlap,
        }
    }
}
