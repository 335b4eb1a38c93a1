//! The face of the occlusion representation: what an engine embeds.

use glam::{DVec3, Mat3};
use homcull_simd::Level;

use super::depth::{Depth, DepthRepresentation};
use super::layers::Layers;
#[cfg(feature = "bvh")]
use super::map::OccluderSink;
use super::map::{MapView, OcclusionMap};
use super::overlap::{ActiveLevels, OverlapTest};
use super::project::BoxView;
use super::pyramid::{Pyramid, PyramidShape};
use super::pyramid_build::{Coverage, UpdatePyramid};
use super::query::DepthReading;
use super::thresholds::{Limits, Thresholds};
use crate::error::{Error, Result};
use crate::geometry::Aabb;
use crate::raster::{Band, Facing, Grid, MeshId, ObjectRows, PreparedMeshes, Queues, RasterCounts};
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
    /// False for what must not occlude by itself: translucent or alpha-tested. [`OcclusionBuffer::submit`] passes over it,
    /// unless it is fused with others ([`OcclusionSettings::fusion`]).
    pub opaque: bool,
    /// What a surface that is not opaque adds where layers are fused: [`optical_depth`](super::optical_depth) of its opacity.
    pub optical_depth: u16,
    /// Relative luminance, 0 to 255, for thresholds raised by contrast: see
    /// [`relative_luminance`](super::relative_luminance).
    pub luminance: u8,
}

impl Occluder {
    /// Whether it covers anything: by itself, or, where layers are fused, with others.
    pub fn covers(&self, fused: bool) -> bool {
        self.opaque || fused && self.optical_depth > 0
    }
}

/// Objects that occlude and are tested: what a box's id stands for.
#[derive(Debug, Clone, Copy)]
pub struct Occluders<'a> {
    /// Where their meshes are.
    pub meshes: &'a PreparedMeshes,
    /// By id.
    pub occluders: &'a [Occluder],
    /// Their boxes about `origin`, by id, as they were given to [`BoxSet::new`](super::BoxSet::new).
    pub bounds: &'a [Aabb],
    /// The origin of the boxes.
    pub origin: DVec3,
}

/// How a buffer tests.
#[derive(Debug, Clone, PartialEq)]
pub struct OcclusionSettings {
    /// What counts as opaque; at 1 (the default) tests are conservative.
    pub thresholds: Thresholds,
    /// What stands for the occluders' depth. Another reading of the no-background Z-buffer holds from the next test on, another
    /// representation from the next view on.
    pub depth: DepthRepresentation,
    /// Whether whole clusters are tested before their triangles are drawn. Never changes the effective state.
    pub cluster_test: bool,
    /// False for the occlusion map alone, without depth: [`OcclusionBuffer::test`] is then the overlap test, for occluders
    /// that are known to stand in front. A change holds from the next view on.
    pub keep_depth: bool,
    /// False when the picture's sample positions are unknown (another renderer, multisampling): a box between samples then counts
    /// as visible.
    pub no_sample_is_hidden: bool,
    /// What a level-0 pixel of the pyramid stands for, and where its levels end.
    pub pyramid: PyramidShape,
    /// The levels that overlap tests use. `None`: all, and at thresholds of 1 none is needed: tests go by samples.
    pub levels: Option<ActiveLevels>,
    /// Whether opacity thresholds are raised by the contrast between occluders and what is tested, where its luminance is given.
    pub contrast: bool,
    /// The opacity, above 0 and below 1, from which translucent occluders count together as covering a sample; `None`
    /// leaves them out. What they let through is then lost.
    pub fusion: Option<f64>,
}

impl Default for OcclusionSettings {
    fn default() -> Self {
        OcclusionSettings {
            thresholds: Thresholds::conservative(),
            depth: DepthRepresentation::default(),
            cluster_test: true,
            keep_depth: true,
            no_sample_is_hidden: true,
            pyramid: PyramidShape::default(),
            levels: None,
            contrast: false,
            fusion: None,
        }
    }
}

/// The occlusion representation of one view.
///
/// Begin a view, submit occluders, test boxes; updates and tests may alternate. Tests take `&self` and may run on any number
/// of threads. Nothing is allocated between the views of one size once the first has passed.
pub struct OcclusionBuffer {
    pub(super) level: Level,
    pub(super) settings: OcclusionSettings,
    pub(super) map: OcclusionMap,
    /// Of the kind that the settings asked for when the view began.
    pub(super) depth: Depth,
    pub(super) pyramid: Pyramid,
    /// The thresholds as hole counts.
    pub(super) limits: Limits,
    /// What adds up over all that was submitted, where settings ask for it.
    pub(super) layers: Option<Box<Layers>>,
    pub(super) queues: Vec<Box<Queues>>,
    pub(super) view: Option<View>,
    pub(super) plain: PreparedMeshes,
    pub(super) counts: RasterCounts,
    /// Flags of progressive passes, one a band and box.
    pub(super) flags: Vec<bool>,
    /// Set by callers that bring the pyramid in step themselves, once for many submissions.
    pub(crate) pyramid_deferred: bool,
}

impl OcclusionBuffer {
    /// A buffer for views of this size, at the best SIMD level of the CPU.
    pub fn new(viewport: Viewport) -> OcclusionBuffer {
        OcclusionBuffer::build(viewport, Level::best())
    }

    /// A buffer at a chosen SIMD level. Every level gives the same bits.
    ///
    /// # Errors
    /// [`Error::SimdLevel`] when the CPU lacks it; those of [`OcclusionBuffer::set_settings`].
    pub fn with_level(viewport: Viewport, level: Level, settings: OcclusionSettings) -> Result<OcclusionBuffer> {
        if !level.is_available() {
            return Err(Error::SimdLevel(level.name().into()));
        }
        let mut buffer = OcclusionBuffer::build(viewport, level);
        buffer.set_settings(settings)?;
        Ok(buffer)
    }

    fn build(viewport: Viewport, level: Level) -> OcclusionBuffer {
        let (grid, settings) = (Grid::new(viewport), OcclusionSettings::default());
        let pyramid = Pyramid::new(grid, settings.pyramid, false);
        OcclusionBuffer {
            level,
            map: OcclusionMap::new(grid),
            limits: Limits::new(&settings.thresholds, settings.pyramid.block_samples(), 0, pyramid.levels() - 1),
            settings,
            depth: Depth::InMap,
            pyramid,
            layers: None,
            queues: vec![Queues::new()],
            view: None,
            plain: PreparedMeshes::new(),
            counts: RasterCounts::default(),
            flags: Vec::new(),
            pyramid_deferred: false,
        }
    }

    /// Bytes that a buffer of this size holds: 8.8 MB at 1920x1080, 1.1 GB at 16384x16384. A depth estimation buffer adds four a
    /// partition.
    pub fn bytes(viewport: Viewport) -> usize {
        OcclusionMap::bytes(Grid::new(viewport))
    }

    /// Changes how it tests, from the next test on. Fusion and contrast, when turned on, know only of what is submitted from then
    /// on.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a block, minimal resolution, range of levels or opacity of fusion that cannot be; then
    /// nothing is changed.
    pub fn set_settings(&mut self, settings: OcclusionSettings) -> Result<()> {
        let grid = self.map.grid;
        settings.pyramid.check()?;
        let another = settings.pyramid != self.settings.pyramid || settings.contrast != self.settings.contrast;
        let pyramid = another.then(|| Pyramid::new(grid, settings.pyramid, settings.contrast));
        let levels = pyramid.as_ref().unwrap_or(&self.pyramid).levels();
        let active = ActiveLevels { finest: 0, coarsest: None };
        let (finest, coarsest) = settings.levels.unwrap_or(active).in_pyramid(levels)?;
        if settings.fusion != self.settings.fusion || settings.contrast != self.settings.contrast {
            self.layers = Layers::new(grid, settings.fusion, settings.contrast)?;
            self.mark_all_changed();
        }
        if let Some(pyramid) = pyramid {
            self.pyramid = pyramid;
            self.mark_all_changed();
        }
        self.limits = Limits::new(&settings.thresholds, settings.pyramid.block_samples(), finest, coarsest);
        self.settings = settings;
        if self.view.is_none() {
            self.depth.begin(&self.settings, grid);
        }
        self.settle();
        Ok(())
    }

    /// True when overlap tests walk the pyramid: with thresholds below 1, a choice of levels, or fused layers. Else they go by
    /// samples, and no pyramid is kept.
    pub fn walks_pyramid(&self) -> bool {
        let s = &self.settings;
        !s.thresholds.is_exact() || s.levels.is_some() || s.fusion.is_some()
    }

    /// Whether an occluder covers anything: by itself, or fused with others.
    pub fn occludes(&self, occluder: &Occluder) -> bool {
        occluder.covers(self.settings.fusion.is_some())
    }

    pub(super) fn coverage(&self) -> Coverage<'_> {
        Coverage { map: self.map.view(), fused: self.layers.as_ref().and_then(|l| l.fused()) }
    }

    /// The overlap test through the pyramid, where tests walk it.
    pub(super) fn overlap_test(&self) -> Option<OverlapTest<'_>> {
        let test = OverlapTest { coverage: self.coverage(), pyramid: &self.pyramid, limits: &self.limits };
        self.walks_pyramid().then_some(test)
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
        if let Some(layers) = &mut self.layers {
            layers.clear();
        }
        self.depth.begin(&self.settings, self.map.grid);
        self.counts = RasterCounts::default();
        self.settle();
        Ok(())
    }

    pub(super) fn begun(&self) -> Result<&View> {
        self.view.as_ref().ok_or_else(|| Error::View("no view has begun".into()))
    }

    /// Keeps the pyramid in step where tests read it.
    pub(super) fn settle(&mut self) {
        if !self.pyramid_deferred {
            self.bring_pyramid_in_step();
        }
    }

    /// Brings the pyramid in step if tests read it.
    pub(crate) fn bring_pyramid_in_step(&mut self) {
        if self.walks_pyramid() {
            self.update_pyramid();
        }
    }

    fn update_pyramid(&mut self) {
        let OcclusionMap { grid, floors, tiles, cover, samples, dirty } = &mut self.map;
        let map = MapView { band: Band::whole(*grid), floors, tiles, cover, samples };
        let layers = self.layers.as_ref();
        self.level.run(UpdatePyramid {
            pyramid: &mut self.pyramid,
            coverage: Coverage { map, fused: layers.and_then(|l| l.fused()) },
            luminance: layers.and_then(|l| l.luminance()),
            dirty,
        });
    }

    /// The hierarchical occlusion maps of what has been drawn; only what changed since the last call is computed.
    pub fn pyramid(&mut self) -> &Pyramid {
        self.update_pyramid();
        &self.pyramid
    }

    /// Tiles of 32x32 samples that changed since the pyramid was last brought in step.
    pub fn changed_tiles(&self) -> usize {
        self.map.dirty.iter().filter(|&&changed| changed).count()
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

    /// True where both tests are one: thresholds at 1, and depth in the no-background Z-buffer. Verdicts then do not depend on how a
    /// walk is cut up.
    #[inline(always)]
    pub(crate) fn tests_at_once(&self) -> bool {
        self.depth.is_in_map() && !self.walks_pyramid()
    }

    /// How the no-background Z-buffer is read.
    pub(crate) fn reading(&self) -> DepthReading {
        match self.settings.depth {
            DepthRepresentation::NoBackground(reading) => reading,
            _ => DepthReading::default(),
        }
    }

    /// How it tests.
    pub fn settings(&self) -> &OcclusionSettings {
        &self.settings
    }

    pub(super) fn box_view(&self, view: &View, origin: DVec3) -> BoxView {
        BoxView::new(ObjectRows::new(view, origin), self.map.grid, view.near_center())
    }
}
