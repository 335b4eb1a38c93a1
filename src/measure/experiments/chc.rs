//! The two tables of coherent hierarchical culling (Bittner et al. 2004, section 5), its frame times, and its nodes.
//!
//! Frustum culling, stop-and-wait, CHC and the ideal on the same hierarchy: queries, waiting, triangles, time, speed-up as the mean over
//! the frames; CHC's options beside them. The paper's device is a GPU, whose answers are late whatever is asked. In software a
//! query can be answered at once (latency 0): then nobody ever waits, stop-and-wait knows as much as can be known, and CHC can save
//! no more than tests of boxes. What the paper is about shows on the device with a thread of its own, where answers
//! come from another processor. `hzb` stands beside them: what a CPU does when it needs no device at all.
//!
//! Frames follow one another closely: CHC lives on what the last one showed.
//!
//! Each scene's picture of classified nodes is written beside the plot.

use super::chc_nodes::picture;
use super::{Axis, Bench, Cell, Column, Curve, Experiment, Findings, Panel, Place, Places, Statement};
use crate::error::Result;
use crate::measure::report::{self, MethodRun, WalkReport};
use crate::measure::report_number::digits3;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "chc",
    section: "Bittner et al. 2004, tables 1 and 2",
    shows: "queries, waiting, triangles and time of stop-and-wait, CHC with its options, and the ideal on the same hierarchy",
    places: Places::Scenes(&["teapots:triangles=1152000", "chc-city", super::PLANT]),
    frames: 120,
    run,
};

/// A row: what the paper calls it, and the method.
const ROWS: [(&str, &str); 9] = [
    ("VFC", "vfc"),
    ("S&W", "stop-and-wait"),
    ("CHC", "chc"),
    ("CHC t_av=2", "chc:assume-visible=2"),
    ("CHC t_av=2 n_vp=25", "chc:assume-visible=2,pixels=25"),
    ("S&W, thread", "stop-and-wait:latency=thread"),
    ("CHC, thread", "chc:latency=thread"),
    ("ideal", "ideal:set=stop-and-wait"),
    ("hzb", "hzb"),
];
/// Their places.
const STOP_AND_WAIT: usize = 1;
const CHC: usize = 2;
const ON_A_THREAD: [usize; 2] = [5, 6];
const IDEAL: usize = 7;
/// The rows whose frame times are plotted, as in the paper's figures.
const PLOTTED: [usize; 5] = [0, ON_A_THREAD[0], ON_A_THREAD[1], CHC, IDEAL];
/// The bottom of the axis of times, in milliseconds.
const LEAST_MS: f64 = 1.0;
/// The paper's greatest share of CHC's queries in those of stop-and-wait, and of triangles beyond its.
const MOST_QUERIES: f64 = 2827.0 / 4704.0;
const MOST_EXTRA: f64 = 9.0;

fn run(bench: &Bench<'_>, places: &[Place]) -> Result<Findings> {
    let mut findings = Findings {
        columns: vec![
            Column::new("scene", ""),
            Column::new("method", ""),
            Column::new("queries", "a frame"),
            Column::new("of S&W's", "percent"),
            Column::new("wait", "ms"),
            Column::new("triangles", "a frame"),
            Column::new("beyond S&W", "percent"),
            Column::new("frame", "ms"),
            Column::new("faster than VFC", "mean of frames"),
            Column::new("over ideal", "mean of frames"),
            Column::new("wrong pixels", "percent"),
        ],
        ..Findings::default()
    };
    let methods = ROWS.map(|(_, method)| method.to_owned());
    for place in places {
        let report = bench.walk(place, &methods, 1)?;
        add_rows(&mut findings, &report);
        findings.panels.push(panel(&report));
        findings.statements.extend(statements(&report));
        picture(bench, place)?;
    }
    Ok(findings)
}

fn queries(report: &WalkReport, run: &MethodRun) -> f64 {
    run.mean(report.pixels()).queries
}

fn frame_ms(report: &WalkReport, run: &MethodRun) -> f64 {
    run.frame_ms().total / report.frames as f64
}

/// Triangles beyond those of stop-and-wait, in percent.
fn extra(report: &WalkReport, run: &MethodRun) -> f64 {
    let of = |run| super::triangles_drawn(report, run);
    100.0 * (of(run) / of(&report.runs[STOP_AND_WAIT]) - 1.0)
}

fn add_rows(findings: &mut Findings, report: &WalkReport) {
    let asked = queries(report, &report.runs[STOP_AND_WAIT]);
    for ((name, _), run) in ROWS.iter().zip(&report.runs) {
        let mean = run.mean(report.pixels());
        // The ideal asked beforehand.
        let asks = mean.queries > 0.0 && run.method != report::IDEAL;
        let known = |figure: f64| if asks { Cell::Figure(figure) } else { Cell::Unknown };
        findings.rows.push(vec![
            Cell::text(&report.scene_name),
            Cell::text(*name),
            known(mean.queries),
            known(100.0 * mean.queries / asked),
            known(mean.waited_ms),
            Cell::Figure(mean.triangles_drawn),
            Cell::Figure(extra(report, run)),
            Cell::Figure(frame_ms(report, run)),
            Cell::Figure(report.speedup_over_vfc(run).map_or(f64::NAN, |r| r.mean_of_frames)),
            Cell::Figure(run.time_over(&report.runs[IDEAL]).map_or(f64::NAN, |r| r.mean_of_frames)),
            Cell::Figure(super::wrong_percent(report, run)),
        ]);
    }
}

fn panel(report: &WalkReport) -> Panel {
    let curve = |i: usize| {
        let frames = report.runs[i].frames.iter().enumerate();
        Curve::new(ROWS[i].0, frames.map(|(frame, record)| (frame as f64, record.frame_ms)).collect())
    };
    Panel {
        title: report.scene_name.clone(),
        x: Axis::plain("frame"),
        y: Axis::doubling("frame, ms", LEAST_MS),
        curves: PLOTTED.map(curve).into(),
    }
}

fn statements(report: &WalkReport) -> [Statement; 3] {
    let scene = &report.scene_name;
    let (chc, asked) = (&report.runs[CHC], queries(report, &report.runs[STOP_AND_WAIT]));
    let share = queries(report, chc) / asked;
    let [alone, coherent] = ON_A_THREAD.map(|i| frame_ms(report, &report.runs[i]));
    let at_once = frame_ms(report, &report.runs[STOP_AND_WAIT]) / frame_ms(report, chc);
    let over = extra(report, chc);
    let statement = |section, claim, found, holds| Statement { section, claim, found, holds };
    [
        statement(
            "Bittner et al. 2004, table 1",
            "CHC asks at most 60 percent of stop-and-wait's queries",
            format!("on {scene} it asks {} percent", digits3(100.0 * share)),
            share <= MOST_QUERIES,
        ),
        statement(
            "Bittner et al. 2004, table 1",
            "CHC is faster than stop-and-wait, as it does not wait",
            format!(
                "on {scene} it is {} times as fast on a device with a thread, {} times where answers are there at once",
                digits3(alone / coherent),
                digits3(at_once)
            ),
            coherent < alone,
        ),
        statement(
            "Bittner et al. 2004, table 1",
            "CHC draws at most 9 percent more triangles than stop-and-wait",
            format!("on {scene} it draws {} percent more", digits3(over)),
            over <= MOST_EXTRA,
        ),
    ]
}
