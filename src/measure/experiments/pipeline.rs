//! The pipeline (8.1) against the same stages in turn: frame time, latency, and where the time went.
//!
//! All modes draw the same frames from the same feedback: the lag is the pipeline's in each. In turn, a frame has all threads in every
//! stage; in the pipeline OccSel and Cull have a thread each, and the Draw stage its own, with or without others for its bands. Passes
//! over the walk take turns from mode to mode; each figure is the median of the passes' means. A pass before them, which is not timed,
//! holds pictures and visible sets of all modes against each other.

use super::{Axis, Bench, Cell, Column, Curve, Experiment, Findings, Panel, Place, Places, Progress, Statement};
use crate::cull::vfc::World;
use crate::cull::{HomParameters, Method, PIPELINE_LAG};
use crate::error::Result;
use crate::hash::Hash;
use crate::measure::report::FrameRecord;
use crate::measure::report_number::digits3;
use crate::measure::statistics::{mean, median};
use crate::measure::walk_pipeline::times_of;
use crate::pipeline::{self, CompleteFrame};
use crate::workers::Workers;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "pipeline",
    section: "8.1, figure 8.2",
    shows: "the pipeline against the same stages in turn: frame time, latency, and where the time went",
    places: Places::Scenes(&["machine-room", super::PLANT]),
    frames: 48,
    run,
};

/// The thesis's selection for its pipelined models, as far as it needs no bake (8.4.2).
const METHOD: &str = "hom:select=temporal";
/// Passes over the walk for each mode.
const PASSES: usize = 5;
/// The part of culling's time for which the Draw stage does not wait when it is "almost entirely hidden": this experiment's reading.
const HIDDEN: f64 = 0.8;

/// How the stages run.
struct Mode {
    name: String,
    parameters: HomParameters,
    workers: Workers,
    /// All passes, each a record a frame.
    passes: Vec<Vec<FrameRecord>>,
    /// Pictures and visible sets of all frames.
    hash: u64,
}

/// Medians over the passes of their means, in milliseconds.
struct Figures {
    frame: f64,
    latency: f64,
    select: f64,
    occluders: f64,
    pyramid: f64,
    cull: f64,
    draw: f64,
    waiting: [f64; 3],
}

fn run(bench: &Bench<'_>, places: &[Place]) -> Result<Findings> {
    let mut findings = Findings {
        columns: vec![
            Column::new("scene", ""),
            Column::new("stages", ""),
            Column::new("frame", "ms"),
            Column::new("latency", "ms"),
            Column::new("OccSel", "ms"),
            Column::new("OccDraw", "ms"),
            Column::new("pyramid", "ms"),
            Column::new("Cull", "ms"),
            Column::new("FinalDraw", "ms"),
            Column::new("OccSel waits", "ms"),
            Column::new("Cull waits", "ms"),
            Column::new("Draw waits", "ms"),
            Column::new("same frames", ""),
        ],
        ..Findings::default()
    };
    for place in places {
        let modes = measured(bench, place)?;
        let figures: Vec<Figures> = modes.iter().map(Mode::figures).collect();
        for (mode, figures) in modes.iter().zip(&figures) {
            findings.rows.push(row(place, mode, figures, mode.hash == modes[0].hash));
        }
        findings.panels.push(panel(&place.scene.name, "frame time", &modes, |r| r.frame_ms));
        findings.panels.push(panel(&place.scene.name, "latency", &modes, FrameRecord::latency_ms));
        findings.statements.extend(statements(place, &modes, &figures));
    }
    Ok(findings)
}

/// In turn and pipelined, on one thread a stage, then on all; the second pair only if there are more.
fn modes(bench: &Bench<'_>) -> Result<Vec<Mode>> {
    let mut threads = vec![1, bench.workers.threads()];
    threads.dedup();
    let mut modes = Vec::new();
    for n in threads {
        for (pipelined, name) in [(false, "in turn"), (true, "pipelined")] {
            let Method::Hom(parameters) = Method::parse(METHOD)? else { continue };
            let s = if n == 1 { "" } else { "s" };
            modes.push(Mode {
                name: format!("{name}, {n} thread{s}{}", if pipelined { " and 2" } else { "" }),
                parameters: HomParameters { pipeline: pipelined, lag: Some(PIPELINE_LAG), ..parameters },
                workers: Workers::new(n)?,
                passes: Vec::new(),
                hash: 0,
            });
        }
    }
    Ok(modes)
}

fn measured(bench: &Bench<'_>, place: &Place) -> Result<Vec<Mode>> {
    let world = World::new(&place.prepared);
    let mut modes = modes(bench)?;
    let passes = bench.repetitions.unwrap_or(PASSES);
    (bench.progress)(Progress::Ahead(place.views.len() * modes.len() * (passes + 1)));
    let step = || (bench.progress)(Progress::Done);
    for mode in &mut modes {
        let mut hash = Hash::default();
        mode.walk(bench, place, &world, |complete| {
            let mut drawn = complete.set.objects.clone();
            drawn.sort_unstable();
            drawn.iter().for_each(|&object| hash.add(object.into()));
            hash.add(complete.canvas.hash(&place.prepared));
            step();
        })?;
        mode.hash = hash.value();
    }
    for pass in 0..passes {
        let n = modes.len();
        for i in 0..n {
            let mode = &mut modes[(i + pass) % n];
            let mut records = Vec::with_capacity(place.views.len());
            mode.walk(bench, place, &world, |complete| records.push(times_of(complete)))?;
            records.iter().for_each(|_| step());
            mode.passes.push(records);
        }
    }
    Ok(modes)
}

impl Mode {
    fn walk(
        &self,
        bench: &Bench<'_>,
        place: &Place,
        world: &World<'_>,
        mut look: impl FnMut(&CompleteFrame<'_>),
    ) -> Result<()> {
        let views = place.views.iter().copied();
        pipeline::run(world, bench.level, &self.workers, &self.parameters, None, views, |complete| {
            look(&complete);
            Ok(())
        })
    }

    fn figures(&self) -> Figures {
        let of = |part: fn(&FrameRecord) -> f64| {
            let means: Vec<f64> = self.passes.iter().filter_map(|pass| mean(pass.iter().map(part))).collect();
            median(&means).unwrap_or(f64::NAN)
        };
        Figures {
            frame: of(|r| r.frame_ms),
            latency: of(FrameRecord::latency_ms),
            select: of(|r| r.stage_ms.select),
            occluders: of(|r| r.stage_ms.occluders),
            pyramid: of(|r| r.stage_ms.pyramid),
            cull: of(|r| r.stage_ms.cull),
            draw: of(|r| r.stage_ms.draw),
            waiting: [
                of(|r| r.pipeline_ms.map_or(0.0, |p| p.select_waiting)),
                of(|r| r.pipeline_ms.map_or(0.0, |p| p.cull_waiting)),
                of(|r| r.pipeline_ms.map_or(0.0, |p| p.draw_waiting)),
            ],
        }
    }

    /// Of every frame the median over the passes.
    fn curve(&self, of: fn(&FrameRecord) -> f64) -> Curve {
        let frames = self.passes.first().map_or(0, Vec::len);
        let point = |frame: usize| {
            let values: Vec<f64> = self.passes.iter().filter_map(|pass| pass.get(frame)).map(of).collect();
            (frame as f64, median(&values).unwrap_or(f64::NAN))
        };
        Curve::new(&self.name, (0..frames).map(point).collect())
    }
}

fn row(place: &Place, mode: &Mode, f: &Figures, same: bool) -> Vec<Cell> {
    let mut row = vec![Cell::text(&place.scene.name), Cell::text(&mode.name)];
    row.extend([f.frame, f.latency, f.select, f.occluders, f.pyramid, f.cull, f.draw].map(Cell::Figure));
    // In turn nothing waits for another thread.
    let waits = |ms: f64| if mode.parameters.pipeline { Cell::Figure(ms) } else { Cell::Unknown };
    row.extend(f.waiting.map(waits));
    row.push(Cell::text(if same { "yes" } else { "NO" }));
    row
}

fn panel(scene: &str, what: &str, modes: &[Mode], of: fn(&FrameRecord) -> f64) -> Panel {
    Panel {
        title: format!("{scene}: {what}"),
        x: Axis::plain("frame"),
        y: Axis::plain("milliseconds"),
        curves: modes.iter().map(|mode| mode.curve(of)).collect(),
    }
}

fn statements(place: &Place, modes: &[Mode], figures: &[Figures]) -> [Statement; 2] {
    let name = &place.scene.name;
    let (turn, pipe) = (&figures[0], &figures[1]);
    let overhead = turn.select + turn.cull;
    let waits = pipe.waiting[2];
    let same = modes.iter().all(|mode| mode.hash == modes[0].hash);
    [
        Statement {
            section: "8.1",
            claim: "the overhead of culling is almost entirely hidden by the final rendering",
            found: format!(
                "on {name} OccSel and Cull take {} ms of a frame in turn, and the Draw stage waits {} ms for them in the pipeline; a \
                 frame takes {} ms instead of {}, and the latency grows from {} to {} ms",
                digits3(overhead),
                digits3(waits),
                digits3(pipe.frame),
                digits3(turn.frame),
                digits3(turn.latency),
                digits3(pipe.latency),
            ),
            holds: waits <= (1.0 - HIDDEN) * overhead && pipe.frame < turn.frame,
        },
        Statement {
            section: "8.1",
            claim: "overlapping stages change when a frame is made and not what it shows",
            found: format!(
                "on {name} pictures and visible sets of all modes are {}",
                if same { "equal, bit for bit" } else { "NOT equal" }
            ),
            holds: same,
        },
    ]
}
