//! The kernels alone, repeated, as benches see them: raster, query, progressive, pyramid (PROTOCOL, *measure*).

use std::time::Instant;

use homcull_simd::Level;

use super::clock::clock_ghz;
use super::statistics::median;
use crate::draw::Canvas;
use crate::error::Result;
use crate::hash::Hash;
use crate::occlusion::{
    BandJob, DepthRepresentation, Occluder, Occluders, OcclusionBuffer, OcclusionSettings, ProgressiveJob,
    ProjectedBoxes,
};
use crate::scene::{PreparedScene, Reference};
use crate::view::{View, Viewport};
use crate::workers::Workers;

/// The clock that times are normalized to, in GHz: that of the peers' published measurements.
pub const NORMAL_GHZ: f64 = 3.3;

/// What to measure with.
#[derive(Debug, Clone, Copy)]
pub struct KernelOptions {
    /// SIMD level.
    pub level: Level,
    /// Repetitions of each view.
    pub repetitions: usize,
    /// Whether clusters are tested before they are drawn.
    pub cluster_test: bool,
    /// What stands for the occluders' depth. Progressive culling in bands takes the no-background Z-buffer alone.
    pub depth: DepthRepresentation,
    /// False for coverage alone (`raster`).
    pub keep_depth: bool,
}

/// Times over views: each view's fastest repetition.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Times {
    /// Milliseconds.
    pub ms: Vec<f64>,
    /// The same at [`NORMAL_GHZ`], by the clock measured beside each.
    pub normalized_ms: Vec<f64>,
    /// The clock, in GHz, of every repetition.
    pub clock_ghz: Vec<f64>,
}

impl Times {
    fn push_fastest(&mut self, repetitions: &[(f64, f64)]) {
        let least = |f: fn(&(f64, f64)) -> f64| repetitions.iter().map(f).fold(f64::INFINITY, f64::min);
        self.ms.push(least(|r| r.0));
        self.normalized_ms.push(least(|r| r.0 * r.1 / NORMAL_GHZ));
        self.clock_ghz.extend(repetitions.iter().map(|r| r.1));
    }

    /// The middle view's.
    pub fn median(&self) -> f64 {
        median(&self.ms).unwrap_or(f64::NAN)
    }

    /// The fastest view's.
    pub fn min(&self) -> f64 {
        self.ms.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

/// Verdicts against exact answers, over all views.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Agreement {
    /// Called hidden, but visible.
    pub false_occluded: u64,
    /// Those among them with more than two visible samples.
    pub false_occluded_over_2_pixels: u64,
    /// Called visible, but hidden.
    pub missed_occluded: u64,
}

/// One object called hidden that an exact answer shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FalseCull {
    /// View number.
    pub view: usize,
    /// Object id.
    pub object: u32,
    /// Samples that show it in the exact answer.
    pub pixels: u32,
}

/// An object that only one of the two references calls visible.
#[derive(Debug, Clone, Copy)]
pub struct Difference {
    /// In which view.
    pub view: usize,
    /// Which object.
    pub object: u32,
    /// Samples that show it in our item buffer, whose vertices are snapped to 1/256.
    pub own: u32,
    /// Samples that show it in the brought answer.
    pub brought: u32,
}

/// Verdicts of a run, and what the exact answers say to them.
#[derive(Debug, Clone, Default)]
pub struct Verdicts {
    /// Boxes tested.
    pub queries: u64,
    /// Called visible.
    pub visible: u64,
    /// Called hidden.
    pub occluded: u64,
    /// Against our own item buffer.
    pub own: Agreement,
    /// Against the scene's brought answers.
    pub brought: Option<Agreement>,
    /// The brought answers that disagree, listed.
    pub brought_false: Vec<FalseCull>,
    /// Over all views: verdicts, and the effective depth of every sample. Equal at every SIMD level and thread count.
    pub hash: Hash,
    /// (View, object) pairs that either reference calls visible.
    pub visible_pairs: u64,
    /// Those that only one does.
    pub references_differ: Vec<Difference>,
}

/// `raster`: every object in the frustum into a cleared buffer.
#[derive(Debug, Clone, Default)]
pub struct RasterReport {
    /// Triangles of the frustum's objects, over all views.
    pub triangles: u64,
    /// A frame each.
    pub times: Times,
}

/// `query`: all boxes against that buffer.
#[derive(Debug, Clone, Default)]
pub struct QueryReport {
    /// A frame's tests and projections each.
    pub times: Times,
    /// What they said.
    pub verdicts: Verdicts,
}

/// `progressive`: cull, sort, clear, and the walk.
#[derive(Debug, Clone, Default)]
pub struct ProgressiveReport {
    /// A frame each.
    pub times: Times,
    /// What was said.
    pub verdicts: Verdicts,
}

/// `pyramid`: all levels from a full map, and brought in step object by object.
#[derive(Debug, Clone, Default)]
pub struct PyramidReport {
    /// A build each.
    pub times: Times,
    /// Bytes of all levels.
    pub bytes: usize,
    /// Updates after one object each, over all views.
    pub updates: u64,
    /// Tiles of 32x32 samples that they changed, together.
    pub changed_tiles: u64,
    /// Their time together, in milliseconds.
    pub update_ms: f64,
}

/// The bench: a scene, its views, and buffers of their size.
pub struct KernelBench<'a> {
    workers: &'a Workers,
    scene: &'a PreparedScene,
    views: &'a [View],
    reference: Option<&'a Reference>,
    options: KernelOptions,
    buffer: OcclusionBuffer,
    boxes: ProjectedBoxes,
    viewport: Viewport,
}

impl<'a> KernelBench<'a> {
    /// # Errors
    /// [`crate::Error::SimdLevel`] when the CPU lacks the level.
    pub fn new(
        scene: &'a PreparedScene,
        views: &'a [View],
        reference: Option<&'a Reference>,
        viewport: Viewport,
        workers: &'a Workers,
        options: KernelOptions,
    ) -> Result<KernelBench<'a>> {
        let settings = OcclusionSettings {
            depth: options.depth,
            cluster_test: options.cluster_test,
            keep_depth: options.keep_depth,
            ..OcclusionSettings::default()
        };
        let buffer = OcclusionBuffer::with_level(viewport, options.level, settings)?;
        Ok(KernelBench { workers, scene, views, reference, options, buffer, boxes: ProjectedBoxes::new(), viewport })
    }

    /// Projects and sorts the view's boxes; the occluders in the frustum, nearest first.
    fn frustum(&mut self, view: &View) -> Result<Vec<Occluder>> {
        self.buffer.begin(view)?;
        self.buffer.project(&self.scene.boxes, self.scene.origin, &mut self.boxes)?;
        self.boxes.sort();
        Ok(self.boxes.boxes().iter().map(|b| self.scene.occluders[b.id() as usize]).collect())
    }

    fn submit(&mut self, view: &View, occluders: &[Occluder]) -> Result<()> {
        self.buffer.begin(view)?;
        if self.workers.threads() == 1 {
            return self.buffer.submit(&self.scene.meshes, occluders);
        }
        let workers = self.workers;
        self.buffer
            .submit_in_bands(&self.scene.meshes, occluders, workers.bands(), |jobs| workers.run(jobs, BandJob::run))
    }

    /// Measures `raster`.
    ///
    /// # Errors
    /// Those of the buffer.
    pub fn raster(&mut self, mut progress: impl FnMut(usize)) -> Result<RasterReport> {
        let mut report = RasterReport::default();
        for (v, view) in self.views.iter().enumerate() {
            let occluders = self.frustum(view)?;
            report.triangles += occluders.iter().map(|o| u64::from(self.scene.meshes.triangles(o.mesh))).sum::<u64>();
            let times = self.repeat(|bench| bench.submit(view, &occluders))?;
            report.times.push_fastest(&times);
            progress(v + 1);
        }
        Ok(report)
    }

    /// Measures `query`.
    ///
    /// # Errors
    /// Those of the buffer.
    pub fn query(&mut self, mut progress: impl FnMut(usize)) -> Result<QueryReport> {
        let mut report = QueryReport::default();
        let mut exact = ExactAnswers::new(self.scene, self.viewport, self.options.level)?;
        let mut hidden = Vec::new();
        for (v, view) in self.views.iter().enumerate() {
            let occluders = self.frustum(view)?;
            self.submit(view, &occluders)?;
            let times = self.repeat(|bench| {
                bench.buffer.project(&bench.scene.boxes, bench.scene.origin, &mut bench.boxes)?;
                let all = 0..bench.boxes.len();
                bench.buffer.test_projected(&bench.boxes, all, &bench.scene.bounds, bench.scene.origin, &mut hidden)
            })?;
            report.times.push_fastest(&times);
            self.judge(v, view, |i| hidden[i], &mut exact, &mut report.verdicts)?;
            progress(v + 1);
        }
        Ok(report)
    }

    /// Measures `progressive`.
    ///
    /// # Errors
    /// Those of the buffer.
    pub fn progressive(&mut self, mut progress: impl FnMut(usize)) -> Result<ProgressiveReport> {
        let mut report = ProgressiveReport::default();
        let mut exact = ExactAnswers::new(self.scene, self.viewport, self.options.level)?;
        let mut visible = Vec::new();
        for (v, view) in self.views.iter().enumerate() {
            let times = self.repeat(|bench| {
                let KernelBench { scene, buffer, boxes, workers, .. } = bench;
                buffer.begin(view)?;
                buffer.project(&scene.boxes, scene.origin, boxes)?;
                boxes.sort();
                let world = Occluders {
                    meshes: &scene.meshes,
                    occluders: &scene.occluders,
                    bounds: &scene.bounds,
                    origin: scene.origin,
                };
                buffer.progressive(boxes, &world, &mut visible, workers.bands(), |jobs| {
                    workers.run(jobs, ProgressiveJob::run)
                })?;
                Ok(())
            })?;
            report.times.push_fastest(&times);
            self.judge(v, view, |i| !visible[i], &mut exact, &mut report.verdicts)?;
            progress(v + 1);
        }
        Ok(report)
    }

    /// Measures `pyramid`: a whole build, from the map of all objects; then updates, object by object, nearest first.
    ///
    /// # Errors
    /// Those of the buffer.
    pub fn pyramid(&mut self, mut progress: impl FnMut(usize)) -> Result<PyramidReport> {
        let mut report = PyramidReport::default();
        for (v, view) in self.views.iter().enumerate() {
            let occluders = self.frustum(view)?;
            self.submit(view, &occluders)?;
            let times = self.repeat(|bench| {
                bench.buffer.mark_all_changed();
                report.bytes = bench.buffer.pyramid().bytes();
                Ok(())
            })?;
            report.times.push_fastest(&times);
            self.buffer.begin(view)?;
            self.buffer.pyramid();
            for occluder in &occluders {
                self.buffer.submit(&self.scene.meshes, std::slice::from_ref(occluder))?;
                report.changed_tiles += self.buffer.changed_tiles() as u64;
                let start = Instant::now();
                self.buffer.pyramid();
                report.update_ms += start.elapsed().as_secs_f64() * 1e3;
                report.updates += 1;
            }
            progress(v + 1);
        }
        Ok(report)
    }

    /// Runs something as often as asked: milliseconds, and the clock beside them.
    fn repeat(&mut self, mut run: impl FnMut(&mut KernelBench<'a>) -> Result<()>) -> Result<Vec<(f64, f64)>> {
        let mut times = Vec::with_capacity(self.options.repetitions);
        for _ in 0..self.options.repetitions {
            let ghz = clock_ghz();
            let start = Instant::now();
            run(self)?;
            times.push((start.elapsed().as_secs_f64() * 1e3, ghz));
        }
        Ok(times)
    }

    /// Holds a view's verdicts against the exact answers.
    fn judge(
        &self,
        v: usize,
        view: &View,
        hidden: impl Fn(usize) -> bool,
        exact: &mut ExactAnswers,
        verdicts: &mut Verdicts,
    ) -> Result<()> {
        exact.look(view, self.scene, &self.boxes)?;
        verdicts.hash.add(self.buffer.state_hash());
        for (i, b) in self.boxes.boxes().iter().enumerate() {
            let (object, hidden) = (b.id(), hidden(i));
            verdicts.queries += 1;
            verdicts.hash.add(u64::from(object) << 1 | u64::from(hidden));
            verdicts.visible += u64::from(!hidden);
            verdicts.occluded += u64::from(hidden);
            verdicts.own.add(hidden, exact.pixels[object as usize]);
        }
        let Some(reference) = self.reference else { return Ok(()) };
        let mut in_frustum = vec![false; self.scene.occluders.len()];
        let brought = verdicts.brought.get_or_insert_default();
        for (i, b) in self.boxes.boxes().iter().enumerate() {
            let Some(answer) = reference.answer(v, b.id() as usize) else { continue };
            in_frustum[b.id() as usize] = true;
            if !answer.in_frustum && answer.visible_pixels == 0 {
                continue;
            }
            brought.add(hidden(i), answer.visible_pixels);
            if hidden(i) && answer.visible_pixels > 0 {
                verdicts.brought_false.push(FalseCull { view: v, object: b.id(), pixels: answer.visible_pixels });
            }
        }
        for object in 0..self.scene.occluders.len() {
            let pixels = reference.answer(v, object).map_or(0, |a| a.visible_pixels);
            if pixels > 0 && !in_frustum[object] {
                brought.add(true, pixels);
                verdicts.brought_false.push(FalseCull { view: v, object: object as u32, pixels });
            }
            let own = exact.pixels[object];
            verdicts.visible_pairs += u64::from(own > 0 || pixels > 0);
            if (own > 0) != (pixels > 0) {
                verdicts.references_differ.push(Difference { view: v, object: object as u32, own, brought: pixels });
            }
        }
        Ok(())
    }
}

impl Agreement {
    fn add(&mut self, hidden: bool, pixels: u32) {
        self.false_occluded += u64::from(hidden && pixels > 0);
        self.false_occluded_over_2_pixels += u64::from(hidden && pixels > 2);
        self.missed_occluded += u64::from(!hidden && pixels == 0);
    }
}

/// The item buffer of a view: how many samples show each object.
struct ExactAnswers {
    canvas: Canvas,
    pixels: Vec<u32>,
}

impl ExactAnswers {
    fn new(scene: &PreparedScene, viewport: Viewport, level: Level) -> Result<ExactAnswers> {
        Ok(ExactAnswers { canvas: Canvas::new(viewport, level)?, pixels: vec![0; scene.occluders.len()] })
    }

    fn look(&mut self, view: &View, scene: &PreparedScene, boxes: &ProjectedBoxes) -> Result<()> {
        let objects: Vec<u32> = boxes.boxes().iter().map(|b| b.id()).collect();
        self.canvas.draw(view, scene, &objects, 1, |jobs| jobs.iter_mut().for_each(|j| j.run()))?;
        self.canvas.count_items(scene, &mut self.pixels);
        Ok(())
    }
}
