//! Walks in the pipeline: whole paths, since frames overlap.
//!
//! The first pass is judged: every picture and visible set is held against the exact reference when the frame is complete,
//! with the other stages at work on the next ones. What that takes would give them a head start, so times are of later passes, in
//! which nothing is looked at; of these the fastest as a whole counts, since frames that overlap cannot be timed apart.

use std::sync::Arc;

use super::clock::clock_ghz;
use super::report::{FrameRecord, PipelineTimes, StageTimes};
use super::walk::{Exact, FrameLook, Tally, WalkOptions};
use crate::cull::vfc::World;
use crate::cull::{HomParameters, OccluderSources};
use crate::error::Result;
use crate::pipeline::{self, CompleteFrame};
use crate::view::View;

/// What is walked.
pub(super) struct Path<'a> {
    pub world: &'a World<'a>,
    pub views: &'a [View],
    pub options: &'a WalkOptions<'a>,
    /// The method's place among the methods.
    pub method: usize,
    /// What its occluders are chosen from, in every pass.
    pub sources: Option<Arc<OccluderSources>>,
}

impl Path<'_> {
    /// Walks the path, judged, then timed as often as asked.
    pub fn walk(
        &self,
        parameters: &HomParameters,
        exact: &mut Exact,
        clocks: &mut Vec<f64>,
        look: &mut impl FnMut(FrameLook<'_>) -> Result<()>,
    ) -> Result<Tally> {
        let mut tally = self.judged(parameters, exact, look)?;
        let mut least = f64::INFINITY;
        for _ in 0..self.options.repetitions.max(1) {
            clocks.push(clock_ghz());
            let mut pass = Vec::with_capacity(self.views.len());
            self.run(parameters, |complete| {
                pass.push(times_of(&complete));
                Ok(())
            })?;
            let total: f64 = pass.iter().map(|record| record.frame_ms).sum();
            if total < least {
                least = total;
                for (record, times) in tally.frames.iter_mut().zip(pass) {
                    (record.frame_ms, record.stage_ms) = (times.frame_ms, times.stage_ms);
                    record.pipeline_ms = times.pipeline_ms;
                }
            }
        }
        Ok(tally)
    }

    fn judged(
        &self,
        parameters: &HomParameters,
        exact: &mut Exact,
        look: &mut impl FnMut(FrameLook<'_>) -> Result<()>,
    ) -> Result<Tally> {
        let mut tally = Tally::default();
        self.run(parameters, |complete| {
            let CompleteFrame { frame, view, set, canvas, hom, .. } = complete;
            exact.look(self.world, view, self.options)?;
            tally.frames.push(FrameRecord::default());
            tally.judge(self.world, set, canvas, exact, self.options.exact);
            let (drawn, in_frustum) = (&set.objects[..], &exact.in_frustum[..]);
            look(FrameLook { frame, method: self.method, view, canvas, drawn, in_frustum, hom: Some(hom) })
        })?;
        Ok(tally)
    }

    fn run(&self, parameters: &HomParameters, complete: impl FnMut(CompleteFrame<'_>) -> Result<()>) -> Result<()> {
        let WalkOptions { level, workers, .. } = *self.options;
        let sources = self.sources.clone();
        pipeline::run(self.world, level, workers, parameters, sources, self.views.iter().copied(), complete)
    }
}

pub(super) fn times_of(complete: &CompleteFrame<'_>) -> FrameRecord {
    let (times, pyramid) = (&complete.times, complete.pyramid_ms);
    let stage_ms = StageTimes {
        select: times.select.busy_ms,
        occluders: times.occluders.busy_ms - pyramid,
        pyramid,
        cull: times.cull.busy_ms,
        draw: times.draw.busy_ms,
    };
    let pipeline_ms = PipelineTimes {
        latency: times.latency_ms,
        select_waiting: times.select.waiting_ms,
        cull_waiting: times.cull.waiting_ms,
        draw_waiting: times.occluders.waiting_ms + times.draw.waiting_ms,
    };
    FrameRecord { frame_ms: times.frame_ms, stage_ms, pipeline_ms: Some(pipeline_ms), ..FrameRecord::default() }
}
