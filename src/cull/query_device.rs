//! Occlusion queries in software (Bittner et al. 2004, section 2): a device that draws objects and answers how many samples of a box are
//! visible, after a latency.
//!
//! Commands are carried out in order; a query is answered against what was drawn before it was issued, with the bounds of our projection:
//! a box that touches the near plane is visible, samples that a box may touch count. Answers come out in the order of their queries. With a
//! latency in *steps* an answer is there once so many further commands have been given, or by waiting: steps are counted, no
//! time is slept. So the same frame gives the same counts always. With a thread of its own the device draws while the caller
//! walks on, and waiting is a matter of time (`query_thread.rs`).

use std::collections::VecDeque;

use homcull_simd::{Kernel, Simd};

use super::nearest_first::Waiting;
use super::vfc::World;
use crate::draw::DrawSink;
use crate::geometry::Aabb;
use crate::occlusion::{AtOnce, BoxView, DepthReading, PlacedRows, ProjectedBox, test_box};
use crate::raster::Engine;

/// A node of the hierarchy as the device is asked about it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Query {
    pub b: ProjectedBox,
    /// `None` for an object, whose id is the box's.
    pub group: Option<u32>,
}

impl Query {
    #[inline(always)]
    #[allow(clippy::manual_map)] // kernels hold no closures
    pub fn of(waiting: &Waiting) -> Query {
        Query {
            b: waiting.b,
            group: match waiting.group {
                Some((group, _)) => Some(group),
                None => None,
            },
        }
    }
}

/// What was waited for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Waited {
    /// Steps until answers were there, in which nothing was done.
    pub steps: u64,
    /// Time, of a device with a thread of its own.
    pub nanoseconds: u64,
}

/// Draws and answers.
pub(super) trait QueryDevice {
    /// Draws an object.
    fn draw(&mut self, object: u32);

    /// Issues a query.
    fn issue(&mut self, query: Query);

    /// The answer to the oldest query without one taken, if it is there: visible samples, exact up to one more than the threshold.
    fn ready(&mut self) -> Option<u32>;

    /// The answer to the oldest query. Nothing else may be outstanding than was issued.
    fn wait(&mut self) -> u32;

    /// The answer to the oldest query, when nothing more will be drawn: the frame ends when the device is done, and it is there by then.
    fn rest(&mut self) -> u32;

    fn waited(&self) -> Waited;
}

/// Draws objects and looks at boxes: what both devices are made of.
pub(super) struct Drawing<'q, 'a, 'w, S> {
    pub engine: Engine<'q, S, DrawSink<'a>>,
    pub placed: PlacedRows<'w>,
    pub world: &'w World<'w>,
    pub box_view: &'w BoxView,
    /// Samples up to which a node counts as hidden.
    pub threshold: u32,
}

impl<S: Simd> Drawing<'_, '_, '_, S> {
    /// Draws an object; some of its triangles may wait in the queues.
    #[inline(always)]
    pub fn draw(&mut self, object: u32) {
        self.engine.simd.vectorize(DrawObject(self, object));
    }

    /// Visible samples of a node, exact up to one more than the threshold.
    #[inline(always)]
    pub fn answer(&mut self, query: Query) -> u32 {
        let (scene, tree) = (self.world.scene, &self.world.tree);
        match query.group {
            Some(group) => {
                self.visible_samples(query.b.renumbered(0), std::slice::from_ref(&tree.bounds[group as usize]))
            }
            None => self.visible_samples(query.b, &scene.bounds),
        }
    }

    /// Visible samples of a box, exact up to one more than the threshold; its number is its place among `bounds`.
    #[inline(always)]
    pub fn visible_samples(&mut self, b: ProjectedBox, bounds: &[Aabb]) -> u32 {
        self.engine.simd.vectorize(AnswerQuery(self, b, bounds))
    }
}

// Both are inlined nowhere: one function a level serves every walk.

struct DrawObject<'d, 'q, 'a, 'w, S>(&'d mut Drawing<'q, 'a, 'w, S>, u32);

impl<S: Simd> Kernel for DrawObject<'_, '_, '_, '_, S> {
    type Output = ();

    #[inline(always)]
    fn run<T: Simd>(self, _: T) {
        let DrawObject(drawing, object) = self;
        let scene = drawing.world.scene;
        let mut placement = drawing.placed.placement(&scene.occluders[object as usize]);
        placement.first_triangle = scene.first_triangle[object as usize];
        drawing.engine.draw(&scene.meshes, &placement);
    }
}

struct AnswerQuery<'d, 'q, 'a, 'w, S>(&'d mut Drawing<'q, 'a, 'w, S>, ProjectedBox, &'d [Aabb]);

impl<S: Simd> Kernel for AnswerQuery<'_, '_, '_, '_, S> {
    type Output = u32;

    #[inline(always)]
    fn run<T: Simd>(self, _: T) -> u32 {
        let AnswerQuery(drawing, b, bounds) = self;
        drawing.engine.flush();
        let s = drawing.engine.simd;
        let state = AtOnce { map: drawing.engine.sink.view(), reading: DepthReading::PerSample };
        if test_box(s, &state, drawing.box_view, &b, bounds, true) {
            return 0;
        }
        if drawing.threshold == 0 || b.touches_near_plane() {
            return u32::MAX;
        }
        state.map.visible_samples(s, b.rect(), b.depth(), drawing.threshold)
    }
}

/// The device whose latency is a number of steps.
pub(super) struct SteppedDevice<'q, 'a, 'w, S> {
    drawing: Drawing<'q, 'a, 'w, S>,
    latency: u64,
    /// Commands given, and steps waited.
    now: u64,
    /// Answers, and when they are there.
    answers: VecDeque<(u32, u64)>,
    waited: u64,
}

impl<'q, 'a, 'w, S: Simd> SteppedDevice<'q, 'a, 'w, S> {
    pub fn new(drawing: Drawing<'q, 'a, 'w, S>, latency: u32) -> Self {
        SteppedDevice { drawing, latency: latency.into(), now: 0, answers: VecDeque::new(), waited: 0 }
    }

    /// The drawing, all of it done.
    pub fn finish(mut self) -> Drawing<'q, 'a, 'w, S> {
        self.drawing.engine.flush();
        self.drawing
    }
}

impl<S: Simd> QueryDevice for SteppedDevice<'_, '_, '_, S> {
    #[inline(always)]
    fn draw(&mut self, object: u32) {
        self.now += 1;
        self.drawing.draw(object);
    }

    #[inline(always)]
    fn issue(&mut self, query: Query) {
        self.now += 1;
        let answer = self.drawing.answer(query);
        self.answers.push_back((answer, self.now + self.latency));
    }

    #[inline(always)]
    fn ready(&mut self) -> Option<u32> {
        let there = self.answers.front().is_some_and(|&(_, due)| due <= self.now);
        if there { self.answers.pop_front().map(|(answer, _)| answer) } else { None }
    }

    #[inline(always)]
    fn wait(&mut self) -> u32 {
        let Some((answer, due)) = self.answers.pop_front() else { return u32::MAX };
        let steps = due.saturating_sub(self.now);
        self.waited += steps;
        self.now += steps;
        answer
    }

    #[inline(always)]
    #[allow(clippy::manual_unwrap_or)] // kernels hold no closures
    fn rest(&mut self) -> u32 {
        match self.answers.pop_front() {
            Some((answer, _)) => answer,
            None => u32::MAX,
        }
    }

    fn waited(&self) -> Waited {
        Waited { steps: self.waited, nanoseconds: 0 }
    }
}
