//! Progressive culling in one call: nearest first, what is visible becomes an occluder before the next box is tested
//! (Zhang 1998, 2.1.4).
//!
//! It is executed band by band: every band of the screen walks the same order, tests a box's part in it, and draws the
//! object there only if that part may be visible. An object is visible when any band says so. What a band finds hidden
//! would change nothing in it, so the verdicts and the state are those of the whole screen at once, on any number of
//! threads (SEMANTICS, *What "conservative" covers*).

use homcull_simd::{Kernel, Level, Simd};

use super::boxes::ProjectedBoxes;
use super::buffer::{Occluder, Occluders, OcclusionBuffer, OcclusionSettings};
use super::depth::Depth;
use super::map::OccluderSink;
use super::project::BoxView;
use super::query::DepthReading;
use super::test::{AtOnce, test_box};
use crate::error::{Error, Result};
use crate::raster::{Engine, ObjectRows, Queues, RasterCounts};
use crate::view::View;

/// What a progressive pass found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ProgressiveResult {
    /// Boxes in the frustum that may be seen.
    pub visible: u32,
    /// Boxes in the frustum that are hidden.
    pub hidden: u32,
}

/// What all bands of a pass share.
#[derive(Clone, Copy)]
pub(crate) struct Pass<'a> {
    pub level: Level,
    pub view: &'a View,
    pub box_view: &'a BoxView,
    pub boxes: &'a ProjectedBoxes,
    pub world: &'a Occluders<'a>,
    pub reading: DepthReading,
    pub no_sample_is_hidden: bool,
    pub cluster_test: bool,
}

/// One band's share of a pass. May run on any thread.
pub(crate) struct BandPass<'a> {
    pub pass: Pass<'a>,
    pub sink: OccluderSink<'a>,
    pub queues: &'a mut Queues,
    /// One flag a box of the pass, set when it may be seen in this band.
    pub visible: &'a mut [bool],
    pub counts: RasterCounts,
}

impl BandPass<'_> {
    pub fn run(&mut self) {
        self.pass.level.run(RunBand(self));
    }
}

struct RunBand<'b, 'a>(&'b mut BandPass<'a>);

impl Kernel for RunBand<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let BandPass { pass, sink, queues, visible, counts } = self.0;
        let p = *pass;
        let mut engine = Engine {
            simd: s,
            sink: sink.reborrow(),
            queues,
            counts: RasterCounts::default(),
            cluster_test: p.cluster_test,
        };
        let mut placed = PlacedRows::new(p.view);
        for (index, b) in p.boxes.boxes.iter().enumerate() {
            let state = AtOnce { map: engine.sink.view(), reading: p.reading };
            if test_box(s, &state, p.box_view, b, p.world.bounds, p.no_sample_is_hidden) {
                continue;
            }
            visible[index] = true;
            let occluder = &p.world.occluders[b.id() as usize];
            if occluder.opaque {
                engine.draw(p.world.meshes, &placed.placement(occluder));
                engine.flush();
            }
        }
        *counts += engine.counts;
    }
}

/// The view's rows for a run of objects: computed anew only where the position changes.
pub(crate) struct PlacedRows<'v> {
    view: &'v View,
    position: glam::DVec3,
    rows: ObjectRows,
}

impl<'v> PlacedRows<'v> {
    pub fn new(view: &'v View) -> PlacedRows<'v> {
        PlacedRows { view, position: glam::DVec3::ZERO, rows: ObjectRows::new(view, glam::DVec3::ZERO) }
    }

    #[inline(always)]
    pub fn placement(&mut self, o: &Occluder) -> crate::raster::Placement<'_> {
        if o.position != self.position {
            self.position = o.position;
            self.rows = ObjectRows::new(self.view, o.position);
        }
        crate::raster::Placement {
            mesh: o.mesh,
            rows: &self.rows,
            rotation: o.rotation,
            facing: o.facing,
            first_triangle: 0,
        }
    }
}

impl OcclusionBuffer {
    /// Culls progressively: walks sorted boxes nearest first, draws what is visible, and fills `visible`, by place in
    /// [`ProjectedBoxes::boxes`]. `run` gets one job a band; see [`OcclusionBuffer::submit_in_bands`].
    ///
    /// # Errors
    /// [`Error::View`] when no view has begun; [`Error::Parameter`] when tests walk the pyramid
    /// ([`OcclusionBuffer::walks_pyramid`]), for which bands would differ, or when depth is not kept in the no-background Z-buffer: a
    /// far boundary holds for the whole screen and is tested round by round.
    pub fn progressive(
        &mut self,
        boxes: &ProjectedBoxes,
        world: &Occluders<'_>,
        visible: &mut Vec<bool>,
        bands: usize,
        run: impl FnOnce(&mut [ProgressiveJob<'_>]),
    ) -> Result<ProgressiveResult> {
        let view = *self.begun()?;
        if self.walks_pyramid() {
            let reason = "progressive culling in bands needs thresholds at 1, every level, and no fusion";
            return Err(Error::parameter("threshold", self.settings.thresholds.opacity(0), reason));
        }
        match &self.depth {
            Depth::InMap => {}
            Depth::Nothing => {
                return Err(Error::parameter("keep_depth", false, "progressive culling in bands needs depth"));
            }
            Depth::Estimation(_) | Depth::Plane(_) => {
                let depth = self.settings.depth.name();
                return Err(Error::parameter("depth", depth, "progressive culling in bands needs nbz or nbz-block"));
            }
        }
        let box_view = self.box_view(&view, world.origin);
        let bands = bands.clamp(1, self.map.grid.tiles_y());
        while self.queues.len() < bands {
            self.queues.push(Queues::new());
        }
        let n = boxes.len();
        self.flags.clear();
        self.flags.resize(n * bands, false);
        let reading = self.reading();
        let OcclusionSettings { no_sample_is_hidden, cluster_test, .. } = self.settings;
        let (level, view, box_view) = (self.level, &view, &box_view);
        let pass = Pass { level, view, box_view, boxes, world, reading, no_sample_is_hidden, cluster_test };
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
