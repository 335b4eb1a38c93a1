//! Conservative prioritized-layered projection, cPLP (Correa, Klosowski and Silva 2002; Klosowski and Silva 2001).
//!
//! The visible set of `plp` is the first guess, and is drawn into an occlusion buffer. Then every cell of the front is asked
//! about by a visible-sample query of its own, its box against the buffer: one that may be seen is projected, its objects are
//! drawn, its neighbours join the front; one that is hidden stays behind. It ends when no cell of the front may be seen.
//!
//! **Exact.** Follow the ray of a sample to what is drawn there. Its cells touch one after the other, all of them are in the frustum
//! and hold the sample; the first is one that the view begins in. As long as the thing is not drawn, the buffer is farther
//! at the sample than it, and so than every cell before it: none of them is hidden, and the front goes through them all. Two
//! things need care. A sample may be drawn beside a triangle, by half a subpixel that snapping moved it, and there as near
//! as the triangle's nearest corner: its object may then be in no cell that the ray passes. And cells do not hold what has no
//! box. So at the end the objects in the frustum that no seen cell held, the *strays*, are asked about by their own
//! boxes. With that the set is conservative whatever the cells are.
//!
//! **Not as in the gem.** Its item buffer lets a farther box overwrite a nearer one, which then leaves the front for good, and knows 256
//! nodes. Queries of our own have neither fault. They also need no passes: what is drawn only comes nearer, so what was hidden stays
//! hidden and need not be asked again; cells are asked one by one, each against all that was drawn before. Nor do they need active tiles,
//! which save reading back parts of the screen: no query reads more than its own box. Objects of a seen cell are drawn
//! unless their own box is hidden.

use homcull_simd::{Kernel, Simd};

use super::VisibleSet;
use super::front::CellState;
use super::plp::PlpFrame;
use super::plp_parameters::PlpParameters;
use super::vfc::World;
use crate::error::Result;
use crate::occlusion::{
    AtOnce, BoxView, DepthReading, OccluderSink, OcclusionBuffer, OcclusionSettings, PlacedRows, test_box,
};
use crate::raster::{Engine, Queues, RasterCounts};
use crate::view::View;

impl PlpFrame {
    /// The visible set of `cplp`, nearest first: the picture is that of everything in the frustum.
    ///
    /// # Errors
    /// Those of [`PlpParameters::check_conservative`] and [`OcclusionBuffer::with_level`].
    pub fn cplp(&mut self, world: &World<'_>, view: &View, parameters: &PlpParameters) -> Result<VisibleSet> {
        parameters.check_conservative()?;
        let mut buffer = match self.buffer.take().filter(|(viewport, _)| *viewport == view.viewport()) {
            Some((_, buffer)) => buffer,
            None => OcclusionBuffer::with_level(view.viewport(), self.level, OcclusionSettings::default())?,
        };
        buffer.begin(view)?;
        self.begin(world, view, parameters);
        self.guess(world, parameters.budget);
        let box_view = world.box_view(view);
        let reading = buffer.reading();
        let OcclusionSettings { no_sample_is_hidden, cluster_test, .. } = *buffer.settings();
        let (level, sink, queues, counts) = buffer.parts();
        let walk = Walk {
            world,
            view,
            box_view: &box_view,
            reading,
            no_sample_is_hidden,
            cluster_test,
            sink,
            queues,
            counts,
            frame: self,
        };
        let queries = level.run(walk);
        let occluder_triangles = buffer.counts().triangles;
        self.buffer = Some((view.viewport(), buffer));
        let set = self.set(world);
        let triangles_hidden = set.triangles_in_frustum - world.triangles(&set.objects);
        Ok(VisibleSet { queries, triangles_hidden, occluder_triangles, ..set })
    }

    /// Objects of the last frame's visible set that no projected cell held: see the module's head.
    pub fn strays(&self) -> Vec<u32> {
        let from = self.taken.len() - self.strays;
        self.taken[from..].iter().map(|&place| self.objects.boxes()[place as usize].id()).collect()
    }
}

struct Walk<'a, 'w, 'r> {
    world: &'a World<'w>,
    view: &'a View,
    box_view: &'a BoxView,
    reading: DepthReading,
    no_sample_is_hidden: bool,
    cluster_test: bool,
    sink: OccluderSink<'r>,
    queues: &'a mut Queues,
    counts: &'a mut RasterCounts,
    frame: &'a mut PlpFrame,
}

impl Kernel for Walk<'_, '_, '_> {
    /// Queries of cells and objects.
    type Output = u64;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> u64 {
        let Walk { world, view, box_view, reading, no_sample_is_hidden, cluster_test, .. } = self;
        let Walk { sink, queues, counts, frame, .. } = self;
        let (scene, cells) = (world.scene, frame.cells.clone());
        let mut engine = Engine { simd: s, sink, queues, counts: RasterCounts::default(), cluster_test };
        let mut placed = PlacedRows::new(view);
        let mut queries = 0;
        let (mut seen, mut last) = (None, false);
        begin_with_guess(frame);
        loop {
            for i in 0..frame.pending.len() {
                let place = frame.pending[i];
                let b = frame.objects.boxes()[place as usize];
                frame.met[place as usize] = true;
                queries += 1;
                let state = AtOnce { map: engine.sink.view(), reading };
                let hidden: bool = test_box(s, &state, box_view, &b, &scene.bounds, no_sample_is_hidden);
                if hidden {
                    continue;
                }
                frame.taken.push(place);
                let occluder = &scene.occluders[b.id() as usize];
                if occluder.opaque {
                    engine.draw(&scene.meshes, &placed.placement(occluder));
                    engine.flush();
                }
            }
            if let Some(cell) = seen.take() {
                frame.project(cell);
            }
            while seen.is_none() {
                let Some(cell) = frame.next() else { break };
                let b = frame.cell_boxes.boxes()[frame.cell_places[cell as usize] as usize];
                queries += 1;
                let state = AtOnce { map: engine.sink.view(), reading };
                let hidden: bool = test_box(s, &state, box_view, &b, &cells.bounds, no_sample_is_hidden);
                if hidden {
                    frame.front.set_state(cell, CellState::Unseen);
                } else {
                    seen = Some(cell);
                }
            }
            match seen {
                Some(cell) => frame.gather(cell),
                None if last => break,
                None => {
                    gather_strays(frame);
                    last = true;
                }
            }
        }
        frame.strays = frame.taken.len() - frame.strays;
        *counts += engine.counts;
        queries
    }
}

/// The objects of the guess, nearest first.
fn begin_with_guess(frame: &mut PlpFrame) {
    frame.pending.clear();
    frame.pending.append(&mut frame.taken);
    frame.pending.sort_unstable();
}

/// The objects that were not met, nearest first; from here on what is taken is a stray.
fn gather_strays(frame: &mut PlpFrame) {
    frame.pending.clear();
    let unmet = (0..frame.met.len() as u32).filter(|&place| !frame.met[place as usize]);
    frame.pending.extend(unmet);
    frame.strays = frame.taken.len();
}
