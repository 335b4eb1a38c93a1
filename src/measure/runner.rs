//! One method of a walk: what it keeps from frame to frame, and a timed frame of it.

use std::time::Instant;

use super::report::FrameRecord;
use super::stage::{Before, State, Timing, timed};
use super::walk::{Exact, Tally, WalkOptions};
use crate::cull::hom::HomFrame;
use crate::cull::vfc::World;
use crate::cull::{Method, SharedCells, SharedSources, VisibleSet};
use crate::draw::{Canvas, DrawJob};
use crate::error::Result;
use crate::view::View;

/// One method at work.
pub(super) struct Runner<'m, 's> {
    /// Its place among the methods.
    pub place: usize,
    pub method: &'m Method,
    pub canvas: Canvas,
    pub tally: Tally,
    state: State<'m, 's>,
    /// What the frames before left behind: every repetition begins with it.
    before: Before,
}

impl<'m, 's> Runner<'m, 's> {
    pub fn new(
        place: usize,
        method: &'m Method,
        world: &World<'s>,
        view: &View,
        options: &WalkOptions<'_>,
        shared: (&mut SharedSources, &mut SharedCells),
    ) -> Result<Runner<'m, 's>> {
        Ok(Runner {
            place,
            method,
            canvas: Canvas::new(view.viewport(), options.level)?,
            tally: Tally::default(),
            state: State::new(method, world, view, options, shared)?,
            before: Before::Nothing,
        })
    }

    pub fn begin_frame(&mut self) {
        self.before = self.state.memory();
        self.tally.frames.push(FrameRecord { frame_ms: f64::INFINITY, ..FrameRecord::default() });
    }

    /// The occlusion representation, of hom methods.
    pub fn look(&mut self) -> (&Canvas, &mut Tally, Option<&mut HomFrame>) {
        (&self.canvas, &mut self.tally, self.state.hom())
    }

    /// One timed frame; the record keeps the fastest repetition.
    pub fn draw(
        &mut self,
        world: &World<'s>,
        view: &View,
        exact: &Exact,
        options: &WalkOptions<'_>,
    ) -> Result<VisibleSet> {
        let ideal = self.state.ideal(world, view, exact, &mut self.canvas)?;
        self.state.set_memory(&self.before);
        let mut timing = Timing::default();
        let start = Instant::now();
        let set = match ideal {
            Some(set) => set,
            None => self.state.cull(world, view, options, &mut self.canvas, &mut timing)?,
        };
        if !self.state.draws() {
            let (workers, canvas) = (options.workers, &mut self.canvas);
            timed(&mut timing.parts.draw, || {
                canvas.draw(view, world.scene, &set.objects, workers.bands(), |jobs| workers.run(jobs, DrawJob::run))
            })?;
        }
        let ms = start.elapsed().as_secs_f64() * 1e3;
        if let Some(record) = self.tally.frames.last_mut().filter(|r| ms < r.frame_ms) {
            (record.frame_ms, record.stage_ms, record.stages) = (ms, timing.parts, timing.stages);
        }
        Ok(set)
    }
}
