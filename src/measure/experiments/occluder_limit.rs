//! 7.6: triangles drawn and time over the occluder limit, for one pass, multi-pass and progressive culling.
//!
//! One pass is bounded by the triangles of its occluders. Multi-pass has no such bound: there the same number is what gathers before an
//! update. Progressive culling has neither and stands as a line. Times are of the whole frame, the fastest of the repetitions.

use super::{
    ALL_TESTS, Axis, Bench, Cell, Column, Curve, Experiment, Findings, Panel, Place, Places, Statement, hidden_share,
    triangles_drawn,
};
use crate::error::Result;
use crate::measure::report::{MethodRun, WalkReport};
use crate::measure::report_number::{count, digits3, grouped};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "occluder-limit",
    section: "7.6",
    shows: "triangles drawn and time over the occluder limit for one pass, multi-pass and progressive culling",
    places: Places::Scenes(&["city", "machine-room"]),
    frames: 16,
    run,
};

/// Triangles: of the occluders, or until an update.
const LIMITS: [u64; 9] = [1_000, 2_000, 4_000, 8_000, 16_000, 32_000, 64_000, 128_000, 256_000];
/// As few triangles as progressive culling leaves, or a tenth more.
const NEAR: f64 = 1.1;
/// How often each frame is drawn.
const REPETITIONS: usize = 2;

/// The methods that have a number to vary: name, and how it is written.
const VARIED: [(&str, &str); 2] =
    [("one pass", "hom:occluder-triangles="), ("multi-pass", "hom-multipass:update-triangles=")];
/// And those that have none.
const FIXED: [&str; 2] = ["progressive", "vfc"];

fn run(bench: &Bench<'_>, places: &[Place]) -> Result<Findings> {
    let mut findings = Findings {
        columns: vec![
            Column::new("scene", ""),
            Column::new("method", ""),
            Column::new("limit", "triangles"),
            Column::new("triangles drawn", "a frame"),
            Column::new("culled", "percent of hidden"),
            Column::new("frame", "ms"),
            Column::new("before the draw", "ms"),
        ],
        ..Findings::default()
    };
    for place in places {
        let varied = VARIED.iter().flat_map(|(_, method)| LIMITS.map(|limit| format!("{method}{limit},{ALL_TESTS}")));
        let methods: Vec<String> = varied.chain([format!("hom-progressive:{ALL_TESTS}"), "vfc".into()]).collect();
        let report = bench.walk(place, &methods, REPETITIONS)?;
        let varied = VARIED.iter().flat_map(|(name, _)| LIMITS.map(|limit| (*name, Some(limit))));
        let names = varied.chain(FIXED.map(|name| (name, None)));
        for ((name, limit), run) in names.zip(&report.runs) {
            findings.rows.push(vec![
                Cell::text(&place.scene.name),
                Cell::text(name),
                limit.map_or(Cell::Unknown, Cell::Count),
                Cell::Figure(triangles_drawn(&report, run)),
                Cell::Figure(hidden_share(&report, run)),
                Cell::Figure(frame_ms(&report, run)),
                Cell::Figure(frame_ms(&report, run) - run.stage_ms().draw),
            ]);
        }
        findings.panels.push(panel(&report, "triangles drawn a frame", triangles_drawn));
        findings.panels.push(panel(&report, "milliseconds a frame", frame_ms));
        findings.statements.extend(statements(place, &report));
    }
    Ok(findings)
}

/// The mean frame.
fn frame_ms(report: &WalkReport, run: &MethodRun) -> f64 {
    run.frame_ms().total / report.frames.max(1) as f64
}

/// The runs of a varied method.
fn runs_of(report: &WalkReport, method: usize) -> &[MethodRun] {
    &report.runs[method * LIMITS.len()..][..LIMITS.len()]
}

/// The run of a fixed method.
fn fixed(report: &WalkReport, method: usize) -> &MethodRun {
    &report.runs[VARIED.len() * LIMITS.len() + method]
}

fn panel(report: &WalkReport, unit: &str, of: fn(&WalkReport, &MethodRun) -> f64) -> Panel {
    let (first, last) = (LIMITS[0] as f64, LIMITS[LIMITS.len() - 1] as f64);
    let curve = |(method, (name, _)): (usize, &(&str, &str))| {
        let figures = runs_of(report, method).iter().map(|run| of(report, run));
        Curve::new(*name, LIMITS.iter().map(|&limit| limit as f64).zip(figures).collect())
    };
    let mut curves: Vec<Curve> = VARIED.iter().enumerate().map(curve).collect();
    let level =
        |method: usize| vec![(first, of(report, fixed(report, method))), (last, of(report, fixed(report, method)))];
    curves.push(Curve::new("progressive", level(0)));
    curves.push(Curve { limit: true, ..Curve::new("view-frustum culling alone", level(1)) });
    Panel {
        title: report.scene_name.clone(),
        x: Axis::doubling("occluder triangles (limit, or until an update)", 1000.0),
        y: Axis::plain(unit),
        curves,
    }
}

fn statements(place: &Place, report: &WalkReport) -> [Statement; 2] {
    let (progressive, one_pass) = (fixed(report, 0), runs_of(report, 0));
    let drawn = |run: &MethodRun| triangles_drawn(report, run);
    // Progressive culling takes all that it draws for occluders: as many for one pass, at least.
    let same = LIMITS.iter().position(|&limit| limit as f64 >= drawn(progressive)).unwrap_or(LIMITS.len() - 1);
    let near = LIMITS.iter().zip(one_pass).find(|(_, run)| drawn(run) <= NEAR * drawn(progressive));
    let needs = near.map_or("none of the limits".into(), |(limit, _)| format!("a limit of {}", grouped(*limit)));
    let on = &place.scene.name;
    let (ms_one, ms_progressive) = (frame_ms(report, &one_pass[same]), frame_ms(report, progressive));
    [
        Statement {
            section: "7.6",
            claim: "one-pass culling requires more accurate occluder selection than progressive culling",
            found: format!(
                "on {on} progressive culling leaves {} triangles, one pass with a limit of {} leaves {}, and {needs} brings it within \
                 10 percent",
                count(drawn(progressive)),
                grouped(LIMITS[same]),
                count(drawn(&one_pass[same])),
            ),
            holds: drawn(&one_pass[same]) > NEAR * drawn(progressive),
        },
        Statement {
            section: "7.6",
            claim: "what progressive culling gains in occluder selection can be canceled out by the overhead of its updates",
            found: format!(
                "on {on} it takes {} ms a frame, {} of them before the draw; one pass with that limit {} and {}; view-frustum culling \
                 alone {}",
                digits3(ms_progressive),
                digits3(ms_progressive - progressive.stage_ms().draw),
                digits3(ms_one),
                digits3(ms_one - one_pass[same].stage_ms().draw),
                digits3(frame_ms(report, fixed(report, 1))),
            ),
            holds: ms_progressive > ms_one,
        },
    ]
}
