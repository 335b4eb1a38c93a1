//! The face of the occlusion representation: what an engine embeds.

use glam::{DVec3, Mat3};
use homcull_simd::Level;

#[cfg(feature = "bvh")]
use super::map::OccluderSink;
use super::map::{MapView, OcclusionMap};
use super::overlap::Thresholds;
use super::project::BoxView;
use super::pyramid::Pyramid;
use super::query::DepthReading;
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
    pub(super) level: Level,
    pub(super) settings: OcclusionSettings,
    pub(super) map: OcclusionMap,
    pub(super) pyramid: Pyramid,
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

    pub(super) fn begun(&self) -> Result<&View> {
        self.view.as_ref().ok_or_else(|| Error::View("no view has begun".into()))
    }

    /// Keeps the pyramid in step where tests read it.
    pub(super) fn settle(&mut self) {
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
        let view = MapView { band: Band::whole(*grid), floors, tiles, cover, samples };
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

    /// How it tests.
    pub fn settings(&self) -> &OcclusionSettings {
        &self.settings
    }

    pub(super) fn box_view(&self, view: &View, origin: DVec3) -> BoxView {
        BoxView::new(ObjectRows::new(view, origin), self.map.grid, view.near_center())
    }
}
