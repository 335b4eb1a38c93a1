//! A method at work: its parameters, what it keeps from frame to frame, and a frame of it. A composed method is a list of these.

use std::time::Instant;

use super::report::{StageCounts, StageTimes};
use super::walk::{Exact, WalkOptions};
use crate::cull::chc::ChcMemory;
use crate::cull::coherent::{self, QueryParameters};
use crate::cull::detail::{self, DetailMemory};
use crate::cull::hom::{self, HomFrame};
use crate::cull::horizons::{self, HorizonsMemory};
use crate::cull::hzb::{self, HzbMemory};
use crate::cull::plp::PlpFrame;
use crate::cull::portals::{self, PortalMemory, PortalScene};
use crate::cull::pvs::Pvs;
use crate::cull::vfc::{self, VfcMemory, World};
use crate::cull::{
    FeedbackLine, HomParameters, HzbParameters, IdealSet, Method, PlpParameters, PortalParameters, SharedCells,
    SharedSources, VisibleSet, ideal,
};
use crate::draw::Canvas;
use crate::error::{Error, Result};
use crate::scene::PreparedScene;
use crate::select::Prisms;
use crate::view::View;

/// A method with its parameters and what it keeps from frame to frame.
pub(super) enum State<'m, 's> {
    Vfc(VfcMemory),
    Detail(u32, Box<DetailMemory>),
    /// The frame is taken while it is culled.
    Hom(&'m HomParameters, Option<Box<HomFrame>>),
    Hzb(&'m HzbParameters, HzbMemory),
    Queries(&'m QueryParameters, ChcMemory),
    Horizons(Box<(Prisms, HorizonsMemory)>),
    Portals(&'m PortalParameters, Box<(PortalScene, PortalMemory)>),
    Pvs(Box<Pvs>),
    Plp(&'m PlpParameters, Box<PlpFrame>),
    Cplp(&'m PlpParameters, Box<PlpFrame>),
    /// The objects of the exact item buffer.
    Exact,
    /// The visible set of stop-and-wait.
    StopAndWait(ChcMemory),
    Composed(Vec<Stage<'m, 's>>),
}

/// One of the stages of a composed method.
pub(super) struct Stage<'m, 's> {
    name: String,
    state: State<'m, 's>,
    /// The world restricted to what the stage before it left; `None` for the first, which sees all.
    left: Option<World<'s>>,
}

/// Where a frame's time went: parts of the frame, and the stages of a composed method.
#[derive(Default)]
pub(super) struct Timing {
    pub parts: StageTimes,
    pub stages: Vec<StageCounts>,
}

/// The part of it that a frame reads.
pub(super) enum Before {
    Nothing,
    Hom(FeedbackLine),
    Hzb(HzbMemory),
    Queries(ChcMemory),
    /// The view of the last frame.
    Detail(Option<View>),
    Composed(Vec<Before>),
}

impl<'m, 's> State<'m, 's> {
    pub fn new(
        method: &'m Method,
        world: &World<'s>,
        view: &View,
        options: &WalkOptions<'_>,
        (sources, cells): (&mut SharedSources, &mut SharedCells),
    ) -> Result<State<'m, 's>> {
        let scene = world.scene;
        Ok(match method {
            Method::Vfc => State::Vfc(VfcMemory::default()),
            Method::Detail(pixels) => State::Detail(*pixels, Box::default()),
            Method::Composed(stages) => {
                let stage = |(i, stage): (usize, &'m Method)| {
                    let state = State::new(stage, world, view, options, (&mut *sources, &mut *cells))?;
                    Ok(Stage { name: stage.name(), state, left: (i > 0).then(|| world.copy()) })
                };
                State::Composed(stages.iter().enumerate().map(stage).collect::<Result<_>>()?)
            }
            Method::Hzb(p) => State::Hzb(p, HzbMemory::default()),
            Method::Queries(p) => State::Queries(p, ChcMemory::default()),
            Method::Plp(p) => State::Plp(p, Box::new(PlpFrame::new(options.level, cells.of(scene, p)))),
            Method::Cplp(p) => State::Cplp(p, Box::new(PlpFrame::new(options.level, cells.of(scene, p)))),
            Method::Portals(p) => {
                State::Portals(p, Box::new((PortalScene::new(scene, p.cells)?, PortalMemory::default())))
            }
            Method::Horizons => State::Horizons(Box::new((prisms_of(scene)?, HorizonsMemory::default()))),
            Method::Pvs(p) => State::Pvs(Box::new(Pvs::new(scene, p)?)),
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

    pub fn memory(&self) -> Before {
        match self {
            State::Hom(_, Some(frame)) => Before::Hom(frame.memory().clone()),
            State::Hzb(_, memory) => Before::Hzb(memory.clone()),
            State::Queries(_, memory) => Before::Queries(memory.clone()),
            State::Detail(_, memory) => Before::Detail(memory.before),
            State::Composed(stages) => Before::Composed(stages.iter().map(|stage| stage.state.memory()).collect()),
            // These keep working memory alone, or nothing.
            State::Hom(_, None) | State::Vfc(_) | State::Exact | State::StopAndWait(_) => Before::Nothing,
            State::Pvs(_) | State::Horizons(_) | State::Portals(..) | State::Plp(..) | State::Cplp(..) => {
                Before::Nothing
            }
        }
    }

    pub fn set_memory(&mut self, before: &Before) {
        match (self, before) {
            (State::Hom(_, Some(frame)), Before::Hom(memory)) => frame.set_memory(memory),
            (State::Hzb(_, own), Before::Hzb(memory)) => own.clone_from(memory),
            (State::Queries(_, own), Before::Queries(memory)) => own.clone_from(memory),
            (State::Detail(_, own), Before::Detail(view)) => own.before = *view,
            (State::Composed(stages), Before::Composed(all)) => {
                stages.iter_mut().zip(all).for_each(|(stage, before)| stage.state.set_memory(before));
            }
            _ => {}
        }
    }

    /// Whether the method draws the picture while it culls.
    pub fn draws(&self) -> bool {
        match self {
            State::Composed(stages) => stages.last().is_some_and(|last| last.state.draws()),
            state => matches!(state, State::Hzb(..) | State::Queries(..) | State::Cplp(..)),
        }
    }

    /// The occlusion representation, of hom methods; of stages, the last one's.
    pub fn hom(&mut self) -> Option<&mut HomFrame> {
        match self {
            State::Hom(_, frame) => frame.as_deref_mut(),
            State::Composed(stages) => stages.last_mut().and_then(|last| last.state.hom()),
            _ => None,
        }
    }

    /// The set of an ideal, found before time is taken.
    pub fn ideal(
        &mut self,
        world: &World<'_>,
        view: &View,
        exact: &Exact,
        canvas: &mut Canvas,
    ) -> Result<Option<VisibleSet>> {
        match self {
            State::Exact => Ok(Some(ideal::cull(world, &exact.in_frustum, &exact.samples))),
            State::StopAndWait(memory) => {
                let stop_and_wait = QueryParameters::new(false);
                coherent::draw(world, view, &stop_and_wait, memory, canvas).map(Some)
            }
            _ => Ok(None),
        }
    }

    /// Culls; some methods draw meanwhile.
    pub fn cull(
        &mut self,
        world: &World<'s>,
        view: &View,
        options: &WalkOptions<'_>,
        canvas: &mut Canvas,
        timing: &mut Timing,
    ) -> Result<VisibleSet> {
        let (level, stages) = (options.level, &mut timing.parts);
        match self {
            State::Hom(p, frame) => cull_hom(frame, world, view, p, options, stages),
            State::Hzb(p, memory) => {
                timed(&mut stages.draw, || hzb::draw(world, options.workers, view, p.previous_first, memory, canvas))
            }
            State::Queries(p, memory) => timed(&mut stages.draw, || coherent::draw(world, view, p, memory, canvas)),
            State::Cplp(p, frame) => timed(&mut stages.draw, || frame.cplp(world, view, p, canvas)),
            State::Plp(p, frame) => Ok(timed(&mut stages.cull, || frame.plp(world, view, p))),
            State::Pvs(pvs) => Ok(timed(&mut stages.cull, || pvs.cull(world, level, view))),
            State::Vfc(memory) => Ok(timed(&mut stages.cull, || vfc::cull(world, level, view, memory))),
            State::Portals(p, state) => {
                let (scene, memory) = &mut **state;
                Ok(timed(&mut stages.cull, || portals::cull(world, level, view, scene, p, memory)))
            }
            State::Horizons(state) => {
                let (prisms, memory) = &mut **state;
                Ok(timed(&mut stages.cull, || horizons::cull(world, prisms, level, view, memory)))
            }
            State::Detail(pixels, memory) => {
                Ok(timed(&mut stages.cull, || detail::keep(world, level, view, *pixels, memory)))
            }
            State::Composed(stages) => cull_composed(stages, world, view, options, canvas, timing),
            // Found before.
            State::Exact | State::StopAndWait(_) => Ok(VisibleSet::default()),
        }
    }
}

/// Why a method does not apply to a scene, if it does not.
///
/// # Errors
/// [`Error::Parameter`] that says so.
pub fn applies(method: &Method, scene: &PreparedScene) -> Result<()> {
    match method {
        Method::Portals(p) => PortalScene::new(scene, p.cells).map(drop),
        Method::Horizons => prisms_of(scene).map(drop),
        Method::Composed(stages) => stages.iter().try_for_each(|stage| applies(stage, scene)),
        _ => Ok(()),
    }
}

/// Culls by stages: each walks what the one before it left. What a stage draws meanwhile counts if it is the last.
fn cull_composed<'s>(
    stages: &mut [Stage<'_, 's>],
    whole: &World<'s>,
    view: &View,
    options: &WalkOptions<'_>,
    canvas: &mut Canvas,
    timing: &mut Timing,
) -> Result<VisibleSet> {
    let mut total = VisibleSet::default();
    for Stage { name, state, left } in stages {
        let start = Instant::now();
        let world = match left {
            Some(left) => {
                timed(&mut timing.parts.cull, || left.restrict_to(whole, &total.objects));
                &*left
            }
            None => whole,
        };
        let set = state.cull(world, view, options, canvas, timing)?;
        timing.stages.push(StageCounts {
            method: name.clone(),
            objects_left: set.objects.len() as f64,
            triangles_left: whole.triangles(&set.objects) as f64,
            queries: set.queries as f64,
            occluder_triangles: set.occluder_triangles as f64,
            ms: start.elapsed().as_secs_f64() * 1e3,
        });
        total = total.then(set);
    }
    Ok(total)
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

/// Runs something and adds its milliseconds.
pub(super) fn timed<R>(ms: &mut f64, run: impl FnOnce() -> R) -> R {
    let start = Instant::now();
    let result = run();
    *ms += start.elapsed().as_secs_f64() * 1e3;
    result
}
