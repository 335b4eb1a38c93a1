//! One method of a walk: what it keeps from frame to frame, and a timed frame of it.

use std::time::Instant;

use super::report::{FrameRecord, StageTimes};
use super::walk::{Exact, Tally, WalkOptions};
use crate::cull::chc::ChcMemory;
use crate::cull::coherent::{self, QueryParameters};
use crate::cull::hom::{self, HomFrame};
use crate::cull::horizons::{self, HorizonsMemory};
use crate::cull::hzb::{self, HzbMemory};
use crate::cull::plp::PlpFrame;
use crate::cull::portals::{self, PortalMemory, PortalScene};
use crate::cull::vfc::{self, VfcMemory, World};
use crate::cull::{
    FeedbackLine, HomParameters, HzbParameters, IdealSet, Method, PlpParameters, PortalParameters, SharedCells,
    SharedSources, VisibleSet, ideal,
};
use crate::draw::{Canvas, DrawJob};
use crate::error::{Error, Result};
use crate::scene::PreparedScene;
use crate::select::Prisms;
use crate::view::View;

/// One method at work.
pub(super) struct Runner<'m> {
    /// Its place among the methods.
    pub place: usize,
    pub method: &'m Method,
    pub canvas: Canvas,
    pub tally: Tally,
    state: State<'m>,
    /// What the frames before left behind: every repetition begins with it.
    before: Before,
}

/// A method with its parameters and what it keeps from frame to frame.
enum State<'m> {
    Vfc(VfcMemory),
    /// The frame is taken while it is culled.
    Hom(&'m HomParameters, Option<Box<HomFrame>>),
    Hzb(&'m HzbParameters, HzbMemory),
    Queries(&'m QueryParameters, ChcMemory),
    Horizons(Box<(Prisms, HorizonsMemory)>),
    Portals(&'m PortalParameters, Box<(PortalScene, PortalMemory)>),
    Plp(&'m PlpParameters, Box<PlpFrame>),
    Cplp(&'m PlpParameters, Box<PlpFrame>),
    /// The objects of the exact item buffer.
    Exact,
    /// The visible set of stop-and-wait.
    StopAndWait(ChcMemory),
}

/// The part of it that a frame reads.
enum Before {
    Nothing,
    Hom(FeedbackLine),
    Hzb(HzbMemory),
    Queries(ChcMemory),
}

impl<'m> State<'m> {
    fn new(
        method: &'m Method,
        world: &World<'_>,
        view: &View,
        options: &WalkOptions<'_>,
        (sources, cells): (&mut SharedSources, &mut SharedCells),
    ) -> Result<State<'m>> {
        let scene = world.scene;
        Ok(match method {
            Method::Vfc => State::Vfc(VfcMemory::default()),
            Method::Hzb(p) => State::Hzb(p, HzbMemory::default()),
            Method::Queries(p) => State::Queries(p, ChcMemory::default()),
            Method::Plp(p) => State::Plp(p, Box::new(PlpFrame::new(options.level, cells.of(scene, p)))),
            Method::Cplp(p) => State::Cplp(p, Box::new(PlpFrame::new(options.level, cells.of(scene, p)))),
            Method::Portals(p) => State::Portals(p, Box::new((PortalScene::new(scene)?, PortalMemory::default()))),
            Method::Horizons => State::Horizons(Box::new((prisms_of(scene)?, HorizonsMemory::default()))),
            Method::Ideal(IdealSet::Exact) => State::Exact,
            Method::Ideal(IdealSet::StopAndWait) => State::StopAndWait(ChcMemory::default()),
            Method::Hom(p) => {
                let mut frame = HomFrame::new(view, options.level, p)?;
                if let Some(sources) = sources.of(scene, p)? {
                    frame.set_sources(sources);
                }
                State::Hom(p, Some(Box::new(frame)))
            }
        })
    }

    fn memory(&self) -> Before {
        match self {
            State::Hom(_, Some(frame)) => Before::Hom(frame.memory().clone()),
            State::Hzb(_, memory) => Before::Hzb(memory.clone()),
            State::Queries(_, memory) => Before::Queries(memory.clone()),
            // These keep working memory alone, or nothing.
            State::Hom(_, None) | State::Vfc(_) | State::Exact | State::StopAndWait(_) => Before::Nothing,
            State::Horizons(_) | State::Portals(..) | State::Plp(..) | State::Cplp(..) => Before::Nothing,
        }
    }

    fn set_memory(&mut self, before: &Before) {
        match (self, before) {
            (State::Hom(_, Some(frame)), Before::Hom(memory)) => frame.set_memory(memory),
            (State::Hzb(_, own), Before::Hzb(memory)) => own.clone_from(memory),
            (State::Queries(_, own), Before::Queries(memory)) => own.clone_from(memory),
            _ => {}
        }
    }

    /// Whether the method draws the picture while it culls.
    fn draws(&self) -> bool {
        matches!(self, State::Hzb(..) | State::Queries(..))
    }
}

/// Why a method does not apply to a scene, if it does not.
///
/// # Errors
/// [`Error::Parameter`] that says so.
pub fn applies(method: &Method, scene: &PreparedScene) -> Result<()> {
    match method {
        Method::Portals(_) => PortalScene::new(scene).map(drop),
        Method::Horizons => prisms_of(scene).map(drop),
        _ => Ok(()),
    }
}

impl<'m> Runner<'m> {
    pub fn new(
        place: usize,
        method: &'m Method,
        world: &World<'_>,
        view: &View,
        options: &WalkOptions<'_>,
        shared: (&mut SharedSources, &mut SharedCells),
    ) -> Result<Runner<'m>> {
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
        let hom = match &mut self.state {
            State::Hom(_, frame) => frame.as_deref_mut(),
            _ => None,
        };
        (&self.canvas, &mut self.tally, hom)
    }

    /// One timed frame; the record keeps the fastest repetition.
    pub fn draw(
        &mut self,
        world: &World<'_>,
        view: &View,
        exact: &Exact,
        options: &WalkOptions<'_>,
    ) -> Result<VisibleSet> {
        let ideal = self.ideal(world, view, exact)?;
        self.state.set_memory(&self.before);
        let mut stages = StageTimes::default();
        let start = Instant::now();
        let set = match ideal {
            Some(set) => set,
            None => self.cull(world, view, options, &mut stages)?,
        };
        if !self.state.draws() {
            let (workers, canvas) = (options.workers, &mut self.canvas);
            timed(&mut stages.draw, || {
                canvas.draw(view, world.scene, &set.objects, workers.bands(), |jobs| workers.run(jobs, DrawJob::run))
            })?;
        }
        let ms = start.elapsed().as_secs_f64() * 1e3;
        if let Some(record) = self.tally.frames.last_mut().filter(|r| ms < r.frame_ms) {
            (record.frame_ms, record.stage_ms) = (ms, stages);
        }
        Ok(set)
    }

    /// The set of an ideal, found before time is taken.
    fn ideal(&mut self, world: &World<'_>, view: &View, exact: &Exact) -> Result<Option<VisibleSet>> {
        match &mut self.state {
            State::Exact => Ok(Some(ideal::cull(world, &exact.in_frustum, &exact.samples))),
            State::StopAndWait(memory) => {
                let stop_and_wait = QueryParameters::new(false);
                coherent::draw(world, view, &stop_and_wait, memory, &mut self.canvas).map(Some)
            }
            _ => Ok(None),
        }
    }

    /// Culls; some methods draw meanwhile.
    fn cull(
        &mut self,
        world: &World<'_>,
        view: &View,
        options: &WalkOptions<'_>,
        stages: &mut StageTimes,
    ) -> Result<VisibleSet> {
        let (level, canvas) = (options.level, &mut self.canvas);
        match &mut self.state {
            State::Hom(p, frame) => cull_hom(frame, world, view, p, options, stages),
            State::Hzb(p, memory) => {
                timed(&mut stages.draw, || hzb::draw(world, options.workers, view, p.previous_first, memory, canvas))
            }
            State::Queries(p, memory) => timed(&mut stages.draw, || coherent::draw(world, view, p, memory, canvas)),
            State::Cplp(p, frame) => timed(&mut stages.cull, || frame.cplp(world, view, p)),
            State::Plp(p, frame) => Ok(timed(&mut stages.cull, || frame.plp(world, view, p))),
            State::Vfc(memory) => Ok(timed(&mut stages.cull, || vfc::cull(world, level, view, memory))),
            State::Portals(p, state) => {
                let (scene, memory) = &mut **state;
                Ok(timed(&mut stages.cull, || portals::cull(world, level, view, scene, p, memory)))
            }
            State::Horizons(state) => {
                let (prisms, memory) = &mut **state;
                Ok(timed(&mut stages.cull, || horizons::cull(world, prisms, level, view, memory)))
            }
            // Found before.
            State::Exact | State::StopAndWait(_) => Ok(VisibleSet::default()),
        }
    }
}

fn cull_hom(
    state: &mut Option<Box<HomFrame>>,
    world: &World<'_>,
    view: &View,
    parameters: &HomParameters,
    options: &WalkOptions<'_>,
    stages: &mut StageTimes,
) -> Result<VisibleSet> {
    let frame = match state.take() {
        Some(frame) => *frame,
        None => HomFrame::new(view, options.level, parameters)?,
    };
    let frame = timed(&mut stages.select, || hom::select_occluders(world, options.level, view, parameters, frame))?;
    let frame = timed(&mut stages.occluders, || hom::draw_occluders(world, options.workers, frame))?;
    let frame = timed(&mut stages.pyramid, || hom::build_pyramid(frame));
    let (set, frame) = timed(&mut stages.cull, || hom::cull(world, options.workers, parameters, frame))?;
    *state = Some(Box::new(frame));
    Ok(set)
}

/// The occluders of horizons; an error where there are none, as the method does not apply then.
fn prisms_of(scene: &PreparedScene) -> Result<Prisms> {
    let prisms = Prisms::new(scene)?;
    let reason = "no object has a closed, opaque, upright part with a box inside: there is nothing to occlude with";
    if prisms.is_empty() { Err(Error::parameter("method", "horizons", reason)) } else { Ok(prisms) }
}

/// Runs something and takes down its milliseconds.
fn timed<R>(ms: &mut f64, run: impl FnOnce() -> R) -> R {
    let start = Instant::now();
    let result = run();
    *ms = start.elapsed().as_secs_f64() * 1e3;
    result
}
