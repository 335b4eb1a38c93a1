//! Conservative prioritized-layered projection, cPLP (Correa, Klosowski and Silva 2002; Klosowski and Silva 2001).
//!
//! The visible set of `plp` is the first guess, and is drawn into the picture. Then the front begins anew, and every cell in it is asked
//! about by a visible-sample query of its own, its box against the picture so far: one that may be seen is projected, its objects are
//! drawn, its neighbours join the front; one that is hidden stays behind. It ends when no cell of the front may be seen.
//!
//! **Exact.** Follow the ray of a sample to what is drawn there. Its cells touch one after the other, all of them are in the frustum
//! and hold the sample; the first is one that the view begins in. As long as the thing is not drawn, the picture is farther
//! at the sample than it, and so than every cell before it: none of them is hidden, and the front goes through them all. Two
//! things need care. A sample may be drawn beside a triangle, by half a subpixel that snapping moved it, and there as near
//! as the triangle's nearest corner: its object may then be in no cell that the ray passes. And cells do not hold what has no
//! box. So at the end the hierarchy is asked from the root down, group by group, for objects that no seen cell held, the *strays*.
//! With that the set is conservative whatever the cells are.
//!
//! **Not as in the gem.** Its item buffer lets a farther box overwrite a nearer one, which then leaves the front for good, and knows 256
//! nodes. Queries of our own have neither fault. They also need no passes: what is drawn only comes nearer, so what was hidden stays
//! hidden and need not be asked again; cells are asked one by one, each against all that was drawn before. Nor do they need active tiles,
//! which save reading back parts of the screen: no query reads more than its own box. Objects, those of the guess too, are drawn unless
//! their own box is hidden. As with `hzb` the final draw is the occluder rendering: nothing is drawn twice.
//!
//! **Cost**: that of `plp`'s guess, a query for each cell of the front, each object of a seen one and each group that may be seen, and the
//! draw. One thread.

use homcull_simd::{Kernel, Simd};

use super::VisibleSet;
use super::front::CellState;
use super::nearest_first::{NearestFirst, begin, open_group};
use super::plp::{NOWHERE, PlpFrame};
use super::plp_parameters::PlpParameters;
use super::query_device::{Drawing, Query};
use super::vfc::World;
use crate::draw::{BandDraw, Canvas, clear, shade};
use crate::error::Result;
use crate::occlusion::{BoxView, PlacedRows, ProjectedBoxes};
use crate::raster::{Engine, RasterCounts};
use crate::view::View;

impl PlpFrame {
    /// Culls and draws a frame of `cplp`: the picture is that of everything in the frustum. The objects of the set, nearest first, have
    /// been drawn.
    ///
    /// # Errors
    /// Those of [`PlpParameters::check_conservative`]; [`Error::View`](crate::error::Error::View) when the view and the canvas differ in
    /// size.
    pub fn cplp(
        &mut self,
        world: &World<'_>,
        view: &View,
        parameters: &PlpParameters,
        canvas: &mut Canvas,
    ) -> Result<VisibleSet> {
        parameters.check_conservative()?;
        let level = canvas.level();
        let mut bands = canvas.bands(view, 1)?;
        let Some(band) = bands.pop() else { return Ok(VisibleSet::default()) };
        self.begin(world, view, parameters);
        if parameters.budget > 0 {
            self.guess(world, view, parameters.budget);
        }
        self.begin_front(view, world.scene.origin);
        // The guess, nearest first.
        self.pending.append(&mut self.taken);
        self.pending.sort_unstable();
        let box_view = world.box_view(view);
        let queries = level.run(Walk { world, view, box_view: &box_view, band, frame: self });
        let set = self.set(world);
        let triangles_hidden = set.triangles_in_frustum - world.triangles(&set.objects);
        Ok(VisibleSet { queries, triangles_hidden, ..set })
    }

    /// Objects of the last frame's visible set that no projected cell held: see the module's head.
    pub fn strays(&self) -> Vec<u32> {
        let from = self.taken.len() - self.strays;
        self.taken[from..].iter().map(|&place| self.objects.boxes()[place as usize].id()).collect()
    }
}

struct Walk<'a, 'w> {
    world: &'a World<'w>,
    view: &'a View,
    box_view: &'a BoxView,
    band: BandDraw<'a>,
    frame: &'a mut PlpFrame,
}

impl Kernel for Walk<'_, '_> {
    /// Queries of cells and objects.
    type Output = u64;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> u64 {
        let Walk { world, view, box_view, band: BandDraw { mut sink, queues, image }, frame } = self;
        let (scene, cells) = (world.scene, frame.cells.clone());
        clear(&mut sink);
        let engine = Engine { simd: s, sink, queues, counts: RasterCounts::default(), cluster_test: true };
        let mut drawing = Drawing { engine, placed: PlacedRows::new(view), world, box_view, threshold: 0 };
        let mut queries = 0;
        let mut seen = None;
        loop {
            for i in 0..frame.pending.len() {
                let place = frame.pending[i];
                let b = frame.objects.boxes()[place as usize];
                frame.met[place as usize] = true;
                queries += 1;
                if drawing.visible_samples(b, &scene.bounds) > 0 {
                    frame.taken.push(place);
                    drawing.draw(b.id());
                }
            }
            if let Some(cell) = seen.take() {
                frame.project(cell);
            }
            while seen.is_none() {
                let Some(cell) = frame.next() else { break };
                let b = frame.cell_boxes.boxes()[frame.cell_places[cell as usize] as usize];
                queries += 1;
                if drawing.visible_samples(b, &cells.bounds) > 0 {
                    seen = Some(cell);
                } else {
                    frame.front.set_state(cell, CellState::Unseen);
                }
            }
            match seen {
                Some(cell) => frame.gather(cell),
                None => break,
            }
        }
        let found = frame.taken.len();
        let mut rest = NearestFirst::default();
        let mut children = ProjectedBoxes::new();
        begin(&world.tree, &mut rest);
        while let Some((_, waiting)) = rest.pop() {
            let place = match waiting.group {
                Some(_) => NOWHERE,
                None => frame.object_places[waiting.b.id() as usize],
            };
            if place != NOWHERE && frame.met[place as usize] {
                continue;
            }
            queries += 1;
            if drawing.answer(Query::of(&waiting)) == 0 {
                continue;
            }
            match waiting.group {
                Some(group) => open_group(s, box_view, &world.tree, group, &mut children, &mut rest),
                None if place == NOWHERE => {}
                None => {
                    frame.taken.push(place);
                    drawing.draw(waiting.b.id());
                }
            }
        }
        frame.strays = frame.taken.len() - found;
        drawing.engine.flush();
        shade(s, &drawing.engine.sink, &scene.colors, image);
        queries
    }
}
