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
use crate::cull::{FeedbackLine, HomParameters, IdealSet, Method, SharedCells, SharedSources, VisibleSet, ideal};
use crate::draw::{Canvas, DrawJob};
use crate::error::{Error, Result};
use crate::select::Prisms;
use crate::view::View;

/// One method at work.
pub(super) struct Runner<'m> {
    /// Its place among the methods.
    pub place: usize,
    pub method: &'m Method,
    pub canvas: Canvas,
    pub tally: Tally,
    state: State,
    /// What the frames before left behind: every repetition begins with it.
    before: Before,
}

/// What a method keeps from frame to frame.
enum State {
    Vfc(VfcMemory),
    /// Taken while a frame is culled.
    Hom(Option<Box<HomFrame>>),
    Hzb(HzbMemory),
    Queries(ChcMemory),
    Horizons(Box<(Prisms, HorizonsMemory)>),
    Portals(Box<(PortalScene, PortalMemory)>),
    Plp(Box<PlpFrame>),
}

/// The part of it that a frame reads.
enum Before {
    Nothing,
    Hom(FeedbackLine),
    Hzb(HzbMemory),
    Queries(ChcMemory),
}

impl State {
    fn new(
        method: &Method,
        world: &World<'_>,
        view: &View,
        options: &WalkOptions<'_>,
        (sources, cells): (&mut SharedSources, &mut SharedCells),
    ) -> Result<State> {
        Ok(match method {
            Method::Vfc | Method::Ideal(IdealSet::Exact) => State::Vfc(VfcMemory::default()),
            Method::Hzb(_) => State::Hzb(HzbMemory::default()),
            Method::Plp(p) | Method::Cplp(p) => {
                State::Plp(Box::new(PlpFrame::new(options.level, cells.of(world.scene, p))))
            }
            Method::Portals(_) => State::Portals(Box::new((PortalScene::new(world.scene)?, PortalMemory::default()))),
            Method::Horizons => State::Horizons(Box::new((prisms_of(world)?, HorizonsMemory::default()))),
            Method::Queries(_) | Method::Ideal(IdealSet::StopAndWait) => State::Queries(ChcMemory::default()),
            Method::Hom(parameters) => {
                let mut frame = HomFrame::new(view, options.level, parameters)?;
                if let Some(sources) = sources.of(world.scene, parameters)? {
                    frame.set_sources(sources);
                }
                State::Hom(Some(Box::new(frame)))
            }
        })
    }

    fn memory(&self) -> Before {
        match self {
            State::Hom(Some(frame)) => Before::Hom(frame.memory().clone()),
            State::Hzb(memory) => Before::Hzb(memory.clone()),
            State::Queries(memory) => Before::Queries(memory.clone()),
            State::Vfc(_) | State::Hom(None) | State::Horizons(_) | State::Portals(_) | State::Plp(_) => {
                Before::Nothing
            }
        }
    }

    fn set_memory(&mut self, before: &Before) {
        match (self, before) {
            (State::Hom(Some(frame)), Before::Hom(memory)) => frame.set_memory(memory),
            (State::Hzb(own), Before::Hzb(memory)) => own.clone_from(memory),
            (State::Queries(own), Before::Queries(memory)) => own.clone_from(memory),
            _ => {}
        }
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
            State::Hom(frame) => frame.as_deref_mut(),
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
        let draws_itself = matches!(self.method, Method::Hzb(_) | Method::Queries(_));
        if !draws_itself {
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
        Ok(match (self.method, &mut self.state) {
            (Method::Ideal(_), State::Queries(memory)) => {
                let stop_and_wait = QueryParameters::new(false);
                Some(coherent::draw(world, view, &stop_and_wait, memory, &mut self.canvas)?)
            }
            (Method::Ideal(_), _) => Some(ideal::cull(world, &exact.in_frustum, &exact.samples)),
            _ => None,
        })
    }

    /// Culls; some methods draw meanwhile.
    fn cull(
        &mut self,
        world: &World<'_>,
        view: &View,
        options: &WalkOptions<'_>,
        stages: &mut StageTimes,
    ) -> Result<VisibleSet> {
        let canvas = &mut self.canvas;
        match (self.method, &mut self.state) {
            (Method::Hom(parameters), State::Hom(frame)) => cull_hom(frame, world, view, parameters, options, stages),
            (Method::Hzb(parameters), State::Hzb(memory)) => timed(&mut stages.draw, || {
                hzb::draw(world, options.workers, view, parameters.previous_first, memory, canvas)
            }),
            (Method::Queries(parameters), State::Queries(memory)) => {
                timed(&mut stages.draw, || coherent::draw(world, view, parameters, memory, canvas))
            }
            (_, State::Horizons(state)) => {
                Ok(timed(&mut stages.cull, || horizons::cull(world, &state.0, options.level, view, &mut state.1)))
            }
            (Method::Plp(parameters), State::Plp(frame)) => {
                Ok(timed(&mut stages.cull, || frame.plp(world, view, parameters)))
            }
            (Method::Cplp(parameters), State::Plp(frame)) => {
                timed(&mut stages.cull, || frame.cplp(world, view, parameters))
            }
            (Method::Portals(parameters), State::Portals(state)) => Ok(timed(&mut stages.cull, || {
                portals::cull(world, options.level, view, &state.0, parameters, &mut state.1)
            })),
            (_, State::Vfc(memory)) => Ok(timed(&mut stages.cull, || vfc::cull(world, options.level, view, memory))),
            // A state is made for its method.
            _ => Ok(timed(&mut stages.cull, || vfc::cull(world, options.level, view, &mut VfcMemory::default()))),
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
fn prisms_of(world: &World<'_>) -> Result<Prisms> {
    let prisms = Prisms::new(world.scene)?;
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
