//! The face of the occlusion representation: what an engine embeds.

use glam::{DVec3, Mat3};
use homcull_simd::{Kernel, Level, Simd};

use super::boxes::{BoxSet, CUT, NEAR, ProjectedBox, ProjectedBoxes};
use super::clip_box::{ClippedBox, clip_box};
use super::map::{MapView, OccluderSink, OcclusionMap};
use super::overlap::{Thresholds, overlap_test};
use super::progressive::{BandPass, BoxTest, Pass, ProgressiveResult};
use super::project::{BoxView, Project, ProjectOne};
use super::pyramid::Pyramid;
use super::query::DepthReading;
use super::submit::Submit;
use super::verdict::{Hidden, Verdict, Visible};
use crate::error::{Error, Result};
use crate::geometry::{Aabb, SampleRect};
use crate::raster::{Facing, Grid, MeshId, ObjectRows, PreparedMeshes, Queues, RasterCounts};
use crate::view::{View, Viewport};

/// A prepared mesh placed in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Occluder {
    /// Which mesh.
    pub mesh: MeshId,
    /// World position; world = rotation * vertex + position.
    pub position: DVec3,
    /// `None` is the identity. May scale and mirror.
    pub rotation: Option<Mat3>,
    /// Which side is drawn.
    pub facing: Facing,
    /// False for what must not occlude: translucent or alpha-tested. [`OcclusionBuffer::submit`] passes over it.
    pub opaque: bool,
}

/// Objects that occlude and are tested: what a box's id stands for.
#[derive(Debug, Clone, Copy)]
pub struct Occluders<'a> {
    /// Where their meshes are.
    pub meshes: &'a PreparedMeshes,
    /// By id.
    pub occluders: &'a [Occluder],
    /// Their boxes about `origin`, by id, as they were given to [`BoxSet::new`].
    pub bounds: &'a [Aabb],
    /// The origin of the boxes.
    pub origin: DVec3,
}

/// How a buffer tests.
#[derive(Debug, Clone, PartialEq)]
pub struct OcclusionSettings {
    /// What counts as opaque; at 1 (the default) tests are conservative.
    pub thresholds: Thresholds,
    /// How the no-background Z-buffer is read.
    pub depth: DepthReading,
    /// Whether whole clusters are tested before their triangles are drawn. Never changes the effective state.
    pub cluster_test: bool,
    /// False for the occlusion map alone, without depth: [`OcclusionBuffer::test`] is then the overlap test, for occluders
    /// that are known to stand in front.
    pub keep_depth: bool,
    /// False when the picture's sample positions are unknown (another renderer, multisampling): a box between samples then counts
    /// as visible.
    pub no_sample_is_hidden: bool,
}

impl Default for OcclusionSettings {
    fn default() -> Self {
        OcclusionSettings {
            thresholds: Thresholds::conservative(),
            depth: DepthReading::default(),
            cluster_test: true,
            keep_depth: true,
            no_sample_is_hidden: true,
        }
    }
}

/// The occlusion representation of one view.
///
/// Begin a view, submit occluders, test boxes; updates and tests may alternate. Tests take `&self` and may run on any number
/// of threads. Nothing is allocated between the views of one size once the first has passed.
pub struct OcclusionBuffer {
    level: Level,
    settings: OcclusionSettings,
    map: OcclusionMap,
    pyramid: Pyramid,
    queues: Vec<Box<Queues>>,
    view: Option<View>,
    plain: PreparedMeshes,
    counts: RasterCounts,
    /// Flags of progressive passes, one a band and box.
    flags: Vec<bool>,
    /// Set by callers that bring the pyramid in step themselves, once for many submissions.
    pub(crate) pyramid_deferred: bool,
}

impl OcclusionBuffer {
    /// A buffer for views of this size, at the best SIMD level of the CPU.
    pub fn new(viewport: Viewport) -> OcclusionBuffer {
        OcclusionBuffer::build(viewport, Level::best(), OcclusionSettings::default())
    }

    /// A buffer at a chosen SIMD level. Every level gives the same bits.
    ///
    /// # Errors
    /// [`Error::SimdLevel`] when the CPU lacks it.
    pub fn with_level(viewport: Viewport, level: Level, settings: OcclusionSettings) -> Result<OcclusionBuffer> {
        if !level.is_available() {
            return Err(Error::SimdLevel(level.name().into()));
        }
        Ok(OcclusionBuffer::build(viewport, level, settings))
    }

    fn build(viewport: Viewport, level: Level, settings: OcclusionSettings) -> OcclusionBuffer {
        let grid = Grid::new(viewport);
        OcclusionBuffer {
            level,
            settings,
            map: OcclusionMap::new(grid),
            pyramid: Pyramid::new(grid),
            queues: vec![Queues::new()],
            view: None,
            plain: PreparedMeshes::new(),
            counts: RasterCounts::default(),
            flags: Vec::new(),
            pyramid_deferred: false,
        }
    }

    /// Bytes that a buffer of this size holds: 8.8 MB at 1920x1080, 1.1 GB at 16384x16384.
    pub fn bytes(viewport: Viewport) -> usize {
        OcclusionMap::bytes(Grid::new(viewport))
    }

    /// How it tests. A change holds from the next test on.
    pub fn settings_mut(&mut self) -> &mut OcclusionSettings {
        self.update_pyramid();
        &mut self.settings
    }

    /// Begins a view: nothing is covered.
    ///
    /// # Errors
    /// [`Error::View`] when the view's size is not the buffer's.
    pub fn begin(&mut self, view: &View) -> Result<()> {
        if Grid::new(view.viewport()) != self.map.grid {
            let (g, v) = (self.map.grid, view.viewport());
            let sizes = (g.width(), g.height(), v.width(), v.height());
            return Err(Error::View(format!(
                "the buffer is {}x{}, the view {}x{}",
                sizes.0, sizes.1, sizes.2, sizes.3
            )));
        }
        self.view = Some(*view);
        self.map.clear();
        self.counts = RasterCounts::default();
        self.settle();
        Ok(())
    }

    fn begun(&self) -> Result<&View> {
        self.view.as_ref().ok_or_else(|| Error::View("no view has begun".into()))
    }

    /// Draws occluders, in a list: small meshes are bound by memory latency, which only a list can hide.
    ///
    /// # Errors
    /// [`Error::View`] when no view has begun.
    pub fn submit(&mut self, meshes: &PreparedMeshes, occluders: &[Occluder]) -> Result<()> {
        let view = *self.begun()?;
        let (keep_depth, cluster_test) = (self.settings.keep_depth, self.settings.cluster_test);
        let submit = Submit {
            view: &view,
            sink: self.map.sink(),
            queues: &mut self.queues[0],
            meshes,
            occluders,
            cluster_test,
            keep_depth,
        };
        self.counts += self.level.run(submit);
        self.settle();
        Ok(())
    }

    /// Draws occluders band by band, as jobs that the caller runs on threads of its own: `run` gets the jobs and must call
    /// [`BandJob::run`] on each. The bits are those of [`OcclusionBuffer::submit`], whatever the number of bands.
    ///
    /// # Errors
    /// [`Error::View`] when no view has begun.
    pub fn submit_in_bands(
        &mut self,
        meshes: &PreparedMeshes,
        occluders: &[Occluder],
        bands: usize,
        run: impl FnOnce(&mut [BandJob<'_>]),
    ) -> Result<()> {
        let view = *self.begun()?;
        let (level, keep_depth, cluster_test) = (self.level, self.settings.keep_depth, self.settings.cluster_test);
        let bands = bands.clamp(1, self.map.grid.tiles_y());
        while self.queues.len() < bands {
            self.queues.push(Queues::new());
        }
        let mut jobs: Vec<BandJob<'_>> = (self.map.sinks(bands).zip(&mut self.queues))
            .map(|(sink, queues)| {
                let submit = Submit { view: &view, sink, queues, meshes, occluders, cluster_test, keep_depth };
                BandJob { level, submit: Some(submit), counts: RasterCounts::default() }
            })
            .collect();
        run(&mut jobs);
        // A job that the caller left out is done here: the state must not depend on it.
        let counts = jobs.iter_mut().map(BandJob::finish).fold(RasterCounts::default(), |mut a, c| {
            a += c;
            a
        });
        drop(jobs);
        self.counts += counts;
        self.settle();
        Ok(())
    }

    /// Draws a mesh that has not been prepared, e.g. one that changes every frame.
    ///
    /// # Errors
    /// [`Error::Mesh`] as for [`PreparedMeshes::add`]; [`Error::View`] when no view has begun.
    pub fn submit_triangles(
        &mut self,
        positions: &[glam::Vec3],
        triangles: &[[u32; 3]],
        position: DVec3,
        facing: Facing,
    ) -> Result<()> {
        let mut plain = std::mem::take(&mut self.plain);
        plain.clear();
        let done = plain
            .add_in_order(positions, triangles)
            .and_then(|mesh| self.submit(&plain, &[Occluder { mesh, position, rotation: None, facing, opaque: true }]));
        self.plain = plain;
        done
    }

    /// Keeps the pyramid in step where tests read it.
    fn settle(&mut self) {
        if !self.pyramid_deferred {
            self.bring_pyramid_in_step();
        }
    }

    /// Brings the pyramid in step if tests read it: at a threshold of 1 they do not.
    pub(crate) fn bring_pyramid_in_step(&mut self) {
        if !self.settings.thresholds.is_conservative() {
            self.update_pyramid();
        }
    }

    fn update_pyramid(&mut self) {
        let OcclusionMap { grid, floors, tiles, cover, samples, dirty } = &mut self.map;
        let view = MapView { band: crate::raster::Band::whole(*grid), floors, tiles, cover, samples };
        self.pyramid.update(view, dirty);
    }

    /// The hierarchical occlusion maps of what has been drawn; only what changed since the last call is computed.
    pub fn pyramid(&mut self) -> &Pyramid {
        self.update_pyramid();
        &self.pyramid
    }

    /// Makes the next [`OcclusionBuffer::pyramid`] compute all of it: for measuring a whole build.
    pub fn mark_all_changed(&mut self) {
        self.map.dirty.fill(true);
    }

    /// What a walk needs that draws and tests in turn: the level, the map, the queues, and where counts go.
    #[cfg(feature = "bvh")]
    pub(crate) fn parts(&mut self) -> (Level, OccluderSink<'_>, &mut Queues, &mut RasterCounts) {
        (self.level, self.map.sink(), &mut self.queues[0], &mut self.counts)
    }

    pub(crate) fn box_test(&self) -> BoxTest {
        BoxTest { reading: self.settings.depth, no_sample_is_hidden: self.settings.no_sample_is_hidden }
    }

    /// How it tests.
    pub fn settings(&self) -> &OcclusionSettings {
        &self.settings
    }

    /// Width and height in samples.
    pub fn size(&self) -> (u32, u32) {
        (self.map.grid.width() as u32, self.map.grid.height() as u32)
    }

    /// What the rasterizer did since the view began.
    pub fn counts(&self) -> RasterCounts {
        self.counts
    }

    /// Tests one box, given about `origin`: may any of it be seen?
    ///
    /// A box that is not finite counts as visible, an empty one as outside.
    ///
    /// # Errors
    /// [`Error::View`] when no view has begun.
    pub fn test(&self, bounds: Aabb, origin: DVec3) -> Result<Verdict> {
        let view = self.begun()?;
        if !bounds.is_finite() {
            let empty = bounds.is_empty() && !bounds.min.is_nan() && !bounds.max.is_nan();
            return Ok(if empty {
                Verdict::Hidden(Hidden::OutsideFrustum)
            } else {
                Verdict::Visible(Visible::NearPlane)
            });
        }
        let box_view = self.box_view(view, origin);
        let mut projected = ProjectedBoxes::new();
        self.level.run(ProjectOne { view: &box_view, min: bounds.min, max: bounds.max, out: &mut projected });
        Ok(match projected.boxes.first() {
            None => Verdict::Hidden(Hidden::OutsideFrustum),
            Some(b) => self.verdict(&box_view, b, &[bounds]),
        })
    }

    /// Projects a set of boxes about `origin` for this view: once, however often they are then tested.
    ///
    /// # Errors
    /// [`Error::View`] when no view has begun.
    pub fn project(&self, boxes: &BoxSet, origin: DVec3, out: &mut ProjectedBoxes) -> Result<()> {
        let view = self.box_view(self.begun()?, origin);
        self.level.run(Project { view: &view, set: boxes, out });
        Ok(())
    }

    /// Tests projected boxes `range.start..range.end`; `hidden` gets a flag for each. `bounds` are the boxes as they were given to
    /// [`BoxSet::new`], for those that have to be clipped; `origin` is theirs.
    ///
    /// # Errors
    /// [`Error::View`] when no view has begun.
    pub fn test_projected(
        &self,
        boxes: &ProjectedBoxes,
        range: std::ops::Range<usize>,
        bounds: &[Aabb],
        origin: DVec3,
        hidden: &mut Vec<bool>,
    ) -> Result<()> {
        let view = self.box_view(self.begun()?, origin);
        hidden.clear();
        self.level.run(TestMany { buffer: self, view: &view, boxes: &boxes.boxes[range], bounds, hidden });
        Ok(())
    }

    /// The verdict on one projected box, with its reason.
    ///
    /// # Errors
    /// [`Error::View`] when no view has begun.
    pub fn test_one_projected(&self, b: &ProjectedBox, bounds: &[Aabb], origin: DVec3) -> Result<Verdict> {
        let view = self.box_view(self.begun()?, origin);
        Ok(self.verdict(&view, b, bounds))
    }

    /// Culls progressively: walks sorted boxes nearest first, draws what is visible, and fills `visible`, by place in
    /// [`ProjectedBoxes::boxes`]. `run` gets one job a band; see [`OcclusionBuffer::submit_in_bands`].
    ///
    /// # Errors
    /// [`Error::View`] when no view has begun; [`Error::Parameter`] when thresholds are below 1, for
    /// which bands would differ, or when no depth is kept.
    pub fn progressive(
        &mut self,
        boxes: &ProjectedBoxes,
        world: &Occluders<'_>,
        visible: &mut Vec<bool>,
        bands: usize,
        run: impl FnOnce(&mut [ProgressiveJob<'_>]),
    ) -> Result<ProgressiveResult> {
        let view = *self.begun()?;
        if !self.settings.thresholds.is_conservative() {
            return Err(Error::parameter("threshold", "below 1", "progressive culling in bands needs thresholds at 1"));
        }
        if !self.settings.keep_depth {
            return Err(Error::parameter("keep_depth", false, "progressive culling needs depth"));
        }
        let box_view = self.box_view(&view, world.origin);
        let bands = bands.clamp(1, self.map.grid.tiles_y());
        while self.queues.len() < bands {
            self.queues.push(Queues::new());
        }
        let n = boxes.len();
        self.flags.clear();
        self.flags.resize(n * bands, false);
        let (test, cluster_test) = (self.box_test(), self.settings.cluster_test);
        let pass = Pass { level: self.level, view: &view, box_view: &box_view, boxes, world, test, cluster_test };
        let flags = self.flags.chunks_mut(n.max(1));
        let mut jobs: Vec<ProgressiveJob<'_>> = (self.map.sinks(bands).zip(&mut self.queues).zip(flags))
            .map(|((sink, queues), visible)| ProgressiveJob {
                band: BandPass { pass, sink, queues, visible, counts: RasterCounts::default() },
                done: false,
            })
            .collect();
        run(&mut jobs);
        let mut counts = RasterCounts::default();
        for job in &mut jobs {
            job.run();
            counts += job.band.counts;
        }
        drop(jobs);
        self.counts += counts;
        visible.clear();
        visible.extend((0..n).map(|i| (0..bands).any(|b| self.flags[b * n + i])));
        let seen = visible.iter().filter(|&&v| v).count() as u32;
        Ok(ProgressiveResult { visible: seen, hidden: n as u32 - seen })
    }

    /// The effective reversed depth at a sample, 0 where nothing covers it; `None` outside the viewport.
    pub fn depth_at(&self, x: u32, y: u32) -> Option<f32> {
        let grid = self.map.grid;
        if x >= grid.width() as u32 || y >= grid.height() as u32 {
            return None;
        }
        let (tile, block) = grid.place(x as usize / 8, y as usize / 8);
        Some(self.map.view().effective(tile, block, (y as usize % 8) * 8 + x as usize % 8))
    }

    /// True when an occluder covers the sample; `None` outside the viewport.
    pub fn covered(&self, x: u32, y: u32) -> Option<bool> {
        let grid = self.map.grid;
        if x >= grid.width() as u32 || y >= grid.height() as u32 {
            return None;
        }
        let (tile, block) = grid.place(x as usize / 8, y as usize / 8);
        Some(self.map.view().word(tile, block) >> ((y % 8) * 8 + x % 8) & 1 != 0)
    }

    /// A hash of coverage and effective depths: of what the state means, not of how it came about.
    pub fn state_hash(&self) -> u64 {
        let (grid, map) = (self.map.grid, self.map.view());
        let mut hash = crate::hash::Hash::default();
        for by in 0..grid.blocks_y() {
            for bx in 0..grid.blocks_x() {
                let (tile, block) = grid.place(bx, by);
                hash.add(map.word(tile, block));
                for sample in 0..64 {
                    hash.add(map.effective(tile, block, sample).to_bits().into());
                }
            }
        }
        hash.value()
    }

    /// The buffer as text, one character a block of samples: ` ` open, `.` up to half covered, `+` more, `#` whole.
    pub fn to_ascii(&self) -> String {
        let (grid, map) = (self.map.grid, self.map.view());
        let mut out = String::new();
        for by in 0..grid.blocks_y() {
            for bx in 0..grid.blocks_x() {
                let (tile, block) = grid.place(bx, by);
                let samples = (!grid.padding(bx, by)).count_ones();
                let holes = map.word(tile, block).count_zeros();
                out.push(match (holes, samples - holes) {
                    (0, _) => '#',
                    (_, 0) => ' ',
                    (holes, covered) if covered > holes => '+',
                    _ => '.',
                });
            }
            out.push('\n');
        }
        out
    }

    fn box_view(&self, view: &View, origin: DVec3) -> BoxView {
        BoxView::new(ObjectRows::new(view, origin), self.map.grid, view.near_center())
    }

    fn verdict(&self, view: &BoxView, b: &ProjectedBox, bounds: &[Aabb]) -> Verdict {
        if b.tag & NEAR == 0 {
            let verdict = self.verdict_of(b.rect(), b.depth);
            // What is seen through a hole stays visible, however it is clipped.
            if verdict.is_hidden() || b.tag & CUT == 0 || verdict == Verdict::Visible(Visible::Uncovered) {
                return verdict;
            }
        }
        match bounds.get(b.id() as usize).map(|&bounds| clip_box(view, bounds)) {
            None | Some(ClippedBox::Near) => Verdict::Visible(Visible::NearPlane),
            Some(ClippedBox::Outside) => Verdict::Hidden(Hidden::OutsideFrustum),
            Some(ClippedBox::Inside(r, z)) => self.verdict_of(r, z),
        }
    }

    fn verdict_of(&self, r: SampleRect, z: f32) -> Verdict {
        self.level.run(TestRect { buffer: self, r, z })
    }

    /// Hidden or not, without the reason.
    #[inline(always)]
    fn hides<S: Simd>(&self, s: S, r: SampleRect, z: f32) -> bool {
        let map = self.map.view();
        if !self.settings.keep_depth {
            return !self.is_open(s, r);
        }
        if self.settings.thresholds.is_conservative() {
            return map.hides(s, r, z, self.settings.depth);
        }
        overlap_test(map, &self.pyramid, &self.settings.thresholds, r)
            && map.covered_is_nearer(s, r, z, self.settings.depth)
    }
}

impl OcclusionBuffer {
    /// True when the overlap test fails.
    #[inline(always)]
    fn is_open<S: Simd>(&self, s: S, r: SampleRect) -> bool {
        if self.settings.thresholds.is_conservative() {
            self.map.view().is_open(s, r)
        } else {
            !overlap_test(self.map.view(), &self.pyramid, &self.settings.thresholds, r)
        }
    }
}

struct TestRect<'a> {
    buffer: &'a OcclusionBuffer,
    r: SampleRect,
    z: f32,
}

impl Kernel for TestRect<'_> {
    type Output = Verdict;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Verdict {
        let TestRect { buffer, r, z } = self;
        if r.is_empty() {
            return if buffer.settings.no_sample_is_hidden {
                Verdict::Hidden(Hidden::NoSample)
            } else {
                Verdict::Visible(Visible::Uncovered)
            };
        }
        if buffer.hides(s, r, z) {
            return Verdict::Hidden(Hidden::OverlapAndDepth);
        }
        Verdict::Visible(if buffer.is_open(s, r) { Visible::Uncovered } else { Visible::InFront })
    }
}

struct TestMany<'a> {
    buffer: &'a OcclusionBuffer,
    view: &'a BoxView,
    boxes: &'a [ProjectedBox],
    bounds: &'a [Aabb],
    hidden: &'a mut Vec<bool>,
}

impl Kernel for TestMany<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let TestMany { buffer, view, boxes, bounds, hidden } = self;
        for b in boxes {
            // At first as it was projected; then, if that may be too near, clipped to the frustum.
            let (mut r, mut z) = (b.rect(), b.depth);
            let mut clip = b.tag & NEAR != 0;
            let mut verdict = false;
            loop {
                if clip {
                    match bounds.get(b.id() as usize).map(|&bounds| clip_box(view, bounds)) {
                        None | Some(ClippedBox::Near) => break,
                        Some(ClippedBox::Outside) => {
                            verdict = true;
                            break;
                        }
                        Some(ClippedBox::Inside(rect, depth)) => (r, z) = (rect, depth),
                    }
                }
                if r.is_empty() {
                    verdict = buffer.settings.no_sample_is_hidden;
                    break;
                }
                verdict = buffer.hides(s, r, z);
                if clip || verdict || b.tag & CUT == 0 || buffer.is_open(s, r) {
                    break;
                }
                clip = true;
            }
            hidden.push(verdict);
        }
    }
}

/// One band's share of [`OcclusionBuffer::submit_in_bands`]. May run on any thread.
pub struct BandJob<'a> {
    level: Level,
    submit: Option<Submit<'a>>,
    counts: RasterCounts,
}

impl BandJob<'_> {
    /// Draws the band. A second call does nothing.
    pub fn run(&mut self) {
        if let Some(submit) = self.submit.take() {
            self.counts = self.level.run(submit);
        }
    }

    fn finish(&mut self) -> RasterCounts {
        self.run();
        self.counts
    }
}

/// One band's share of [`OcclusionBuffer::progressive`]. May run on any thread.
pub struct ProgressiveJob<'a> {
    band: BandPass<'a>,
    done: bool,
}

impl ProgressiveJob<'_> {
    /// Walks the band. A second call does nothing.
    pub fn run(&mut self) {
        if !std::mem::replace(&mut self.done, true) {
            self.band.run();
        }
    }
}
