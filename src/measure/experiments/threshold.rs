//! Figure 8.11: triangles drawn against the opacity threshold, on the machine room with the thesis's own parameters (8.4.2),
//! wrong pixels beside them (5.3.2: what aggressive approximate culling buys, and what it costs).

use super::{
    ALL_TESTS, Axis, Bench, Cell, Column, Curve, Experiment, Findings, Panel, Place, Places, Statement,
    triangles_drawn, wrong_percent,
};
use crate::error::Result;
use crate::measure::report::{MethodRun, WalkReport};
use crate::measure::report_number::{count, digits3};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "threshold",
    section: "8.4.2, figure 8.11",
    shows: "triangles drawn against the opacity threshold, wrong pixels beside them",
    places: Places::Scenes(&["machine-room"]),
    frames: 24,
    run,
};

/// Opacity thresholds of the finest active level.
const THRESHOLDS: [f64; 7] = [1.0, 0.98, 0.95, 0.9, 0.85, 0.7, 0.5];
/// The threshold of 8.4.2.
const CHOSEN: f64 = 0.85;
/// Wrong pixels, in percent, that are noticed only by those who look for them: this experiment's reading of the thesis.
const NOTICED: f64 = 1.0;

fn run(bench: &Bench<'_>, places: &[Place]) -> Result<Findings> {
    let mut findings = Findings {
        columns: vec![
            Column::new("scene", ""),
            Column::new("threshold", ""),
            Column::new("triangles drawn", "a frame"),
            Column::new("of those at 1", "percent"),
            Column::new("wrong pixels", "percent"),
            Column::new("worst frame", "percent"),
            Column::new("wrongly culled", "objects"),
            Column::new("frame", "ms"),
        ],
        ..Findings::default()
    };
    for place in places {
        let methods: Vec<String> = THRESHOLDS.iter().map(|t| method(place, *t)).collect();
        let report = bench.walk(place, &methods, 1)?;
        add_rows(&mut findings, place, &report);
        findings.panels.extend(panels(&report));
        findings.statements.push(statement(place, &report));
    }
    Ok(findings)
}

/// 8.4.2's parameters, in its own pyramid: a map of 256x256 pixels, of which 64x64 is the finest active one. Without temporal
/// coherence, which frames far apart have not got.
fn method(place: &Place, threshold: f64) -> String {
    let block = super::block_of(place, 256);
    format!("hom:occluder-triangles=25000,block={block},levels=2-,minimal=4x4,threshold={threshold},{ALL_TESTS}")
}

fn add_rows(findings: &mut Findings, place: &Place, report: &WalkReport) {
    let at_one = triangles_drawn(report, &report.runs[0]);
    for (threshold, run) in THRESHOLDS.iter().zip(&report.runs) {
        let drawn = triangles_drawn(report, run);
        findings.rows.push(vec![
            Cell::text(&place.scene.name),
            Cell::Figure(*threshold),
            Cell::Figure(drawn),
            Cell::Figure(100.0 * drawn / at_one),
            Cell::Figure(wrong_percent(report, run)),
            Cell::Figure(run.wrong_pixels_percent(report.pixels()).map_or(f64::NAN, |w| w.max)),
            Cell::Count(run.wrongly_culled_objects().unwrap_or_default()),
            Cell::Figure(run.frame_ms().total / report.frames as f64),
        ]);
    }
}

fn panels(report: &WalkReport) -> [Panel; 2] {
    let over_frames = |run: &MethodRun| {
        run.frames.iter().enumerate().map(|(frame, record)| (frame as f64, record.triangles_drawn as f64)).collect()
    };
    let curves = THRESHOLDS.iter().zip(&report.runs).map(|(t, run)| Curve::new(format!("OT {t}"), over_frames(run)));
    let wrong = THRESHOLDS.iter().zip(&report.runs).map(|(t, run)| (*t, wrong_percent(report, run)));
    [
        Panel {
            title: format!("{}: triangles drawn", report.scene_name),
            x: Axis::plain("frame"),
            y: Axis::plain("triangles"),
            curves: curves.collect(),
        },
        Panel {
            title: "what it costs".into(),
            x: Axis::plain("opacity threshold of the finest active level"),
            y: Axis::plain("wrong pixels, percent"),
            curves: vec![Curve::new("wrong pixels", wrong.collect())],
        },
    ]
}

fn statement(place: &Place, report: &WalkReport) -> Statement {
    let chosen = THRESHOLDS.iter().position(|t| *t == CHOSEN).unwrap_or_default();
    let drawn: Vec<f64> = report.runs.iter().map(|run| triangles_drawn(report, run)).collect();
    let falls = drawn.windows(2).all(|pair| pair[1] <= pair[0]);
    let wrong = wrong_percent(report, &report.runs[chosen]);
    let saved = 100.0 * (1.0 - drawn[chosen] / drawn[0]);
    Statement {
        section: "8.4.2",
        claim: "lower opacity thresholds cull more, with artifacts noticed only when looked for",
        found: format!(
            "on {} a threshold of {CHOSEN} leaves {} of {} triangles, {} percent fewer, at {} percent wrong pixels{}",
            place.scene.name,
            count(drawn[chosen]),
            count(drawn[0]),
            digits3(saved),
            digits3(wrong),
            if falls { "" } else { "; and not every lower threshold culls more" },
        ),
        holds: falls && saved > 0.0 && wrong <= NOTICED,
    }
}
