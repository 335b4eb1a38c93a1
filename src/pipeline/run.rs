//! The hom methods as stages of the pipeline.
//!
//! Two occlusion buffers go around: OccDraw of one frame fills the one while Cull of the frame before reads the other. What OccSel
//! makes stands apart from them, three at most. Everything is used again, so that a steady run allocates what its stages do.

use std::sync::Arc;
use std::time::Instant;

use homcull_simd::Level;

use super::schedule::{DrawStage, FrameTimes, run_in_turn, run_pipelined};
use crate::cull::hom::{self, HomFrame, Selected};
use crate::cull::vfc::World;
use crate::cull::{FeedbackLine, HomParameters, OccluderSources, VisibleSet};
use crate::draw::{Canvas, DrawJob};
use crate::error::Result;
use crate::view::View;
use crate::workers::Workers;

/// What is asked for one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameInput {
    /// The view.
    pub view: View,
    /// Whether the frame begins anew, as the first one did: for a teleport, a cut, or a changed scene. Nothing that
    /// earlier frames found is heard from here on. The thesis has no rule to find teleports by, so only the caller can say. Without
    /// it the picture is still right; only occluders may be chosen badly for `lag` frames.
    pub reset: bool,
}

impl From<View> for FrameInput {
    fn from(view: View) -> FrameInput {
        FrameInput { view, reset: false }
    }
}

/// A frame that is complete.
pub struct CompleteFrame<'a> {
    /// Its number, from 0.
    pub frame: usize,
    /// Its view.
    pub view: &'a View,
    /// What was drawn.
    pub set: &'a VisibleSet,
    /// The picture.
    pub canvas: &'a Canvas,
    /// The occlusion representation.
    pub hom: &'a mut HomFrame,
    /// Where its time went.
    pub times: FrameTimes,
    /// Of OccDraw's time, that of the pyramid, in milliseconds.
    pub pyramid_ms: f64,
}

/// Culls and draws a frame for every input, which is asked for when OccSel is free for it, and gives each to `complete` in
/// order, in the caller's thread. `sources` that runs share are used if they are of the scene and the parameters. Overlapping if `parameters.pipeline` says so, else in turn. Ends when the inputs do, with
/// every frame drawn. `workers` are shared by all stages: occluders and picture in bands, tests in stretches.
///
/// # Errors
/// [`Error::Stage`](crate::Error::Stage) when a stage fails, by an error (as when views differ in size) or a panic, or `complete`
/// does; what is under way then is dropped. Those of [`HomFrame::new`].
pub fn run<I: Into<FrameInput>>(
    world: &World<'_>,
    level: Level,
    workers: &Workers,
    parameters: &HomParameters,
    sources: Option<Arc<OccluderSources>>,
    inputs: impl IntoIterator<Item = I>,
    complete: impl FnMut(CompleteFrame<'_>) -> Result<()>,
) -> Result<()> {
    let mut inputs = inputs.into_iter().map(Into::into).peekable();
    let Some(first) = inputs.peek().map(|input| input.view) else { return parameters.check() };
    let mut frame = HomFrame::new(&first, level, parameters)?;
    frame.selected.sources = sources;
    let sources = if parameters.needs_sources() { Some(frame.sources(world.scene, parameters)?) } else { None };
    let walks_tree = hom::walks_tree(parameters, &frame.buffer);
    let mut draw = HomDraw {
        world,
        workers,
        level,
        parameters,
        first,
        sources,
        frames: vec![frame],
        spare: Vec::new(),
        line: FeedbackLine::new(parameters.lag()),
        canvas: Canvas::new(first.viewport(), level)?,
        inputs,
        complete,
    };
    let select = |_, (view, selected): (View, Selected)| {
        let selected = hom::select(world, level, &view, parameters, walks_tree, selected)?;
        Ok((view, selected))
    };
    let cull = |_, r: Represented| {
        let (set, frame) = hom::cull_selected(world, workers, parameters, r.frame)?;
        Ok(Culled { set, r: Represented { frame, ..r } })
    };
    if parameters.pipeline { run_pipelined(&mut draw, select, cull) } else { run_in_turn(&mut draw, select, cull) }
}

/// The Draw stage of the hom methods.
struct HomDraw<'a, I, C> {
    world: &'a World<'a>,
    workers: &'a Workers,
    level: Level,
    parameters: &'a HomParameters,
    first: View,
    /// What occluders are chosen from, shared by all frames.
    sources: Option<Arc<OccluderSources>>,
    /// Frames that nobody uses, each with its occlusion buffer. By the schedule there are two at most.
    frames: Vec<HomFrame>,
    /// What OccSel may use again.
    spare: Vec<Selected>,
    line: FeedbackLine,
    canvas: Canvas,
    inputs: I,
    complete: C,
}

/// What OccDraw hands to Cull.
struct Represented {
    view: View,
    frame: HomFrame,
    pyramid_ms: f64,
}

/// What Cull hands back.
struct Culled {
    set: VisibleSet,
    r: Represented,
}

impl<I, C> DrawStage for HomDraw<'_, I, C>
where
    I: Iterator<Item = FrameInput>,
    C: FnMut(CompleteFrame<'_>) -> Result<()>,
{
    type Order = (View, Selected);
    type Selected = (View, Selected);
    type Represented = Represented;
    type Culled = Culled;

    fn order(&mut self, _frame: usize) -> Result<Option<Self::Order>> {
        let Some(FrameInput { view, reset }) = self.inputs.next() else { return Ok(None) };
        let viewport = self.parameters.resolution.unwrap_or(self.first.viewport());
        let mut selected = self.spare.pop().unwrap_or_else(|| Selected::new(&view, viewport));
        selected.sources.clone_from(&self.sources);
        if reset {
            self.line.reset();
        }
        selected.feedback = self.line.begin();
        Ok(Some((view, selected)))
    }

    fn draw_occluders(&mut self, _frame: usize, (view, selected): Self::Selected) -> Result<Represented> {
        let mut frame = match self.frames.pop() {
            Some(frame) => frame,
            None => HomFrame::new(&self.first, self.level, self.parameters)?,
        };
        self.spare.push(std::mem::replace(&mut frame.selected, selected));
        frame.selected.begin(&mut frame.buffer)?;
        let frame = hom::draw_occluders(self.world, self.workers, frame)?;
        let start = Instant::now();
        let frame = hom::build_pyramid(frame);
        Ok(Represented { view, frame, pyramid_ms: start.elapsed().as_secs_f64() * 1e3 })
    }

    fn draw(&mut self, _frame: usize, culled: &mut Culled) -> Result<()> {
        let Culled { set, r } = culled;
        let workers = self.workers;
        let run = |jobs: &mut [DrawJob<'_>]| workers.run(jobs, DrawJob::run);
        self.canvas.draw(&r.view, self.world.scene, &set.objects, workers.bands(), run)?;
        Ok(())
    }

    fn complete(&mut self, frame: usize, culled: Culled, times: FrameTimes) -> Result<()> {
        let Culled { set, r: Represented { view, frame: mut hom, pyramid_ms } } = culled;
        self.line.tell(std::mem::take(&mut hom.selected.feedback));
        let canvas = &self.canvas;
        (self.complete)(CompleteFrame { frame, view: &view, set: &set, canvas, hom: &mut hom, times, pyramid_ms })?;
        self.frames.push(hom);
        Ok(())
    }
}
