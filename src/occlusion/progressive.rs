//! Progressive culling in one call: nearest first, what is visible becomes an occluder before the next box is tested
//! (Zhang 1998, 2.1.4).
//!
//! It is executed band by band: every band of the screen walks the same order, tests a box's part in it, and draws the
//! object there only if that part may be visible. An object is visible when any band says so. What a band finds hidden
//! would change nothing in it, so the verdicts and the state are those of the whole screen at once, on any number of
//! threads (SEMANTICS, *What "conservative" covers*).

use homcull_simd::{Kernel, Level, Simd};

use super::boxes::{CUT, NEAR, ProjectedBox, ProjectedBoxes};
use super::buffer::{Occluder, Occluders};
use super::clip_box::{ClippedBox, clip_box};
use super::map::OccluderSink;
use super::project::BoxView;
use super::query::DepthReading;
use crate::geometry::{Aabb, SampleRect};
use crate::raster::{Engine, ObjectRows, Queues, RasterCounts, Sink};
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
    pub test: BoxTest,
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
            sink: OccluderSinkRef(sink),
            queues,
            counts: RasterCounts::default(),
            cluster_test: p.cluster_test,
        };
        let mut placed = PlacedRows::new(p.view);
        for (index, b) in p.boxes.boxes.iter().enumerate() {
            if !may_be_seen(s, &engine.sink.0.view(), p.box_view, b, p.world.bounds, p.test) {
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

/// How a box is tested at thresholds of 1.
#[derive(Clone, Copy)]
pub(crate) struct BoxTest {
    pub reading: DepthReading,
    pub no_sample_is_hidden: bool,
}

/// The test of one projected box against a band: false when its part there is hidden, or it has none.
#[inline(always)]
pub(crate) fn may_be_seen<S: Simd>(
    s: S,
    map: &super::map::MapView<'_>,
    view: &BoxView,
    b: &ProjectedBox,
    bounds: &[Aabb],
    test: BoxTest,
) -> bool {
    let in_band =
        |r: SampleRect| SampleRect { y0: r.y0.max(map.band.first_row()), y1: r.y1.min(map.band.last_row()), ..r };
    if b.tag & NEAR == 0 {
        if b.rect().is_empty() {
            return !test.no_sample_is_hidden;
        }
        let r = in_band(b.rect());
        if r.is_empty() || map.hides(s, r, b.depth, test.reading) {
            return false;
        }
        if b.tag & CUT == 0 || map.is_open(s, r) {
            return true;
        }
    }
    match bounds.get(b.id() as usize).map(|&bounds| clip_box(view, bounds)) {
        None | Some(ClippedBox::Near) => true,
        Some(ClippedBox::Outside) => false,
        Some(ClippedBox::Inside(r, z)) => {
            if r.is_empty() {
                return !test.no_sample_is_hidden;
            }
            let r = in_band(r);
            !(r.is_empty() || map.hides(s, r, z, test.reading))
        }
    }
}

/// A sink by reference, so that it can be read between draws.
pub(crate) struct OccluderSinkRef<'r, 'a>(pub &'r mut OccluderSink<'a>);

impl<'a> Sink<'a> for OccluderSinkRef<'_, 'a> {
    const EXACT: bool = false;

    #[inline(always)]
    fn surface(&mut self) -> &mut crate::raster::Surface<'a> {
        self.0.surface()
    }
    #[inline(always)]
    fn expect(&self, tile: usize, block: usize) {
        self.0.expect(tile, block);
    }
    #[inline(always)]
    fn whole<S: Simd>(&mut self, s: S, tile: usize, blocks: homcull_simd::Mask, floors: S::F, far: S::F) -> S::F {
        self.0.whole(s, tile, blocks, floors, far)
    }
    #[inline(always)]
    fn samples<S: Simd>(&mut self, s: S, tile: usize, block: usize, word: u64, depths: [S::F; 4], id: u32) -> f32 {
        self.0.samples(s, tile, block, word, depths, id)
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
