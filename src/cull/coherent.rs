//! What stop-and-wait and coherent hierarchical culling share: a frame of either on a query device.
//!
//! Both draw while they cull, on one device that owns the picture. The set they give is what was drawn.

use homcull_simd::{Kernel, Level, Simd};

use super::VisibleSet;
use super::chc::{self, ChcMemory};
use super::nearest_first::{NearestFirst, Waiting, begin, open_group};
use super::query_device::{Drawing, QueryDevice, SteppedDevice, Waited};
pub use super::query_parameters::{AssumeVisible, Latency, QueryParameters, Traversal};
use super::query_thread;
use super::stop_and_wait;
use super::vfc::World;
use crate::draw::{BandDraw, Canvas, clear, shade};
use crate::error::Result;
use crate::occlusion::{BoxView, PlacedRows, ProjectedBoxes};
use crate::raster::{Engine, RasterCounts};
use crate::scene::WideHierarchy;
use crate::view::View;

/// What a walk needs of a frame.
pub(super) struct Frame<'a> {
    pub world: &'a World<'a>,
    pub box_view: &'a BoxView,
    /// Samples up to which a node counts as hidden.
    pub threshold: u32,
}

/// Nodes to visit.
pub(super) struct Pending {
    order: Traversal,
    front: NearestFirst,
    /// Depth first: the nearest last.
    stack: Vec<Waiting>,
    children: ProjectedBoxes,
}

impl Pending {
    /// The root, and what has no box.
    pub fn new(tree: &WideHierarchy, order: Traversal) -> Pending {
        let mut pending =
            Pending { order, front: NearestFirst::default(), stack: Vec::new(), children: ProjectedBoxes::new() };
        begin(tree, &mut pending.front);
        pending.stack_up();
        pending
    }

    /// The next node.
    #[inline(always)]
    #[allow(clippy::manual_map)] // kernels hold no closures
    pub fn pop(&mut self) -> Option<Waiting> {
        match self.order {
            Traversal::Depth => self.stack.pop(),
            Traversal::Priority => match self.front.pop() {
                Some((_, waiting)) => Some(waiting),
                None => None,
            },
        }
    }

    /// Puts a group's children that meet the frustum among what is to be visited.
    #[inline(always)]
    pub fn open<S: Simd>(&mut self, s: S, frame: &Frame<'_>, group: (u32, u8)) {
        open_group(s, frame.box_view, &frame.world.tree, group, &mut self.children, &mut self.front);
        self.stack_up();
    }

    fn stack_up(&mut self) {
        if self.order == Traversal::Depth {
            self.front.move_to(&mut self.stack);
        }
    }
}

/// Culls and draws a frame.
///
/// # Errors
/// [`crate::Error::View`] when the view and the canvas differ in size.
pub fn draw(
    world: &World<'_>,
    view: &View,
    parameters: &QueryParameters,
    memory: &mut ChcMemory,
    canvas: &mut Canvas,
) -> Result<VisibleSet> {
    let level = canvas.level();
    memory.begin(world, view.eye());
    let mut bands = canvas.bands(view, 1)?;
    let Some(band) = bands.pop() else { return Ok(VisibleSet::default()) };
    let box_view = world.box_view(view);
    let on = OnDevice { level, world, view, box_view: &box_view, parameters };
    Ok(match parameters.latency {
        Latency::Steps(latency) => level.run(Stepped { on, latency, memory, band }),
        Latency::Thread => query_thread::run(on, memory, band),
    })
}

/// A frame, and what it is drawn with.
#[derive(Clone, Copy)]
pub(super) struct OnDevice<'a> {
    pub level: Level,
    pub world: &'a World<'a>,
    pub view: &'a View,
    pub box_view: &'a BoxView,
    pub parameters: &'a QueryParameters,
}

impl<'w> OnDevice<'w> {
    /// The cleared band as a drawing.
    #[inline(always)]
    pub fn drawing<'a, S: Simd>(&self, s: S, band: BandDraw<'a>) -> (Drawing<'a, 'a, 'w, S>, &'a mut [i32]) {
        let BandDraw { mut sink, queues, image } = band;
        clear(&mut sink);
        let engine = Engine { simd: s, sink, queues, counts: RasterCounts::default(), cluster_test: true };
        let OnDevice { world, view, box_view, .. } = *self;
        let threshold = self.parameters.pixels;
        (Drawing { engine, placed: PlacedRows::new(view), world, box_view, threshold }, image)
    }

    /// Walks the frame on a device.
    #[inline(always)]
    pub fn walk<S: Simd, D: QueryDevice>(&self, s: S, memory: &mut ChcMemory, device: &mut D) -> VisibleSet {
        let frame = Frame { world: self.world, box_view: self.box_view, threshold: self.parameters.pixels };
        let mut set = if self.parameters.coherent {
            chc::walk(s, &frame, self.parameters, memory, device)
        } else {
            stop_and_wait::walk(s, &frame, self.parameters.order, device)
        };
        let Waited { steps, nanoseconds } = device.waited();
        (set.waited.steps, set.waited.nanoseconds) = (steps, nanoseconds);
        set
    }
}

struct Stepped<'f, 'a> {
    on: OnDevice<'f>,
    latency: u32,
    memory: &'f mut ChcMemory,
    band: BandDraw<'a>,
}

impl Kernel for Stepped<'_, '_> {
    type Output = VisibleSet;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> VisibleSet {
        let Stepped { on, latency, memory, band } = self;
        let (drawing, image) = on.drawing(s, band);
        let mut device = SteppedDevice::new(drawing, latency);
        let set = on.walk(s, memory, &mut device);
        let drawing = device.finish();
        shade(s, &drawing.engine.sink, &on.world.scene.colors, image);
        set
    }
}
