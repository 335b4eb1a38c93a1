//! Aggressive approximate culling (5.3.2) and levels of detail as occluders (7.2): what they gain and what they get wrong, over the opacity
//! threshold of the finest active level, with original occluders and with levels of detail of some sizes of error.
//!
//! One-pass culling as `hom` does it unless told otherwise, level-0 pixels of 8x8 samples and all levels; the thesis's own pyramid, coarser
//! and with fewer levels, is in `threshold.rs`. Beside it view-frustum culling and the ideal, in the same run.

use super::{
    Axis, Bench, Cell, Column, Curve, Experiment, Findings, Panel, Place, Places, Statement, triangles_drawn,
    wrong_percent,
};
use crate::error::Result;
use crate::measure::report::{MethodRun, WalkReport};
use crate::measure::report_number::digits3;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "aggressive",
    section: "5.3.2, 7.2",
    shows: "aggressive approximate culling and LOD occluders: error against run time, over the opacity threshold",
    places: Places::Scenes(&["machine-room", super::PLANT]),
    frames: 24,
    run,
};

/// Opacity thresholds of the finest active level; 1 leaves no hole.
const THRESHOLDS: [f64; 7] = [1.0, 0.98, 0.95, 0.9, 0.85, 0.7, 0.5];
/// Errors of levels of detail that stand in for occluders, in pixels: the thesis's display took 1, and 4 times that for its occluders.
const LOD_PIXELS: [u32; 3] = [1, 4, 16];
/// Thresholds that these are tried with.
const LOD_THRESHOLDS: [f64; 3] = [1.0, 0.85, 0.5];
/// Times each frame is drawn: time is what this is about.
const REPETITIONS: usize = 3;
/// Wrong pixels, in percent, that are noticed only by those who look for them: this experiment's reading of the thesis.
const NOTICED: f64 = 1.0;

fn run(bench: &Bench<'_>, places: &[Place]) -> Result<Findings> {
    let mut findings = Findings {
        columns: vec![
            Column::new("scene", ""),
            Column::new("culling", ""),
            Column::new("threshold", ""),
            Column::new("LOD", "pixels"),
            Column::new("frame", "ms"),
            Column::new("median", "ms"),
            Column::new("objects drawn", "a frame"),
            Column::new("triangles drawn", "a frame"),
            Column::new("wrongly culled", "objects"),
            Column::new("wrong pixels", "percent"),
            Column::new("worst frame", "percent"),
        ],
        panels: vec![
            panel("frame time", "opacity threshold", "milliseconds a frame"),
            panel("error", "opacity threshold", "wrong pixels, percent"),
            panel("error against run time", "milliseconds a frame", "wrong pixels, percent"),
        ],
        ..Findings::default()
    };
    let knobs = knobs();
    for place in places {
        let report = bench.walk(place, &methods(&knobs), REPETITIONS)?;
        for (i, run) in report.runs.iter().enumerate() {
            findings.rows.push(row(place, &report, run, i.checked_sub(1).and_then(|k| knobs.get(k))));
        }
        for same in knobs.iter().zip(&report.runs[1..]).collect::<Vec<_>>().chunk_by(|p, q| p.0.lod == q.0.lod) {
            let name = match same[0].0.lod {
                None => place.scene.name.clone(),
                Some(pixels) => format!("{}, LOD of {pixels} pixels", place.scene.name),
            };
            let curve = |of: &dyn Fn(&Knobs, &MethodRun) -> (f64, f64)| {
                Curve::new(&name, same.iter().map(|(knobs, run)| of(knobs, run)).collect())
            };
            let wrong = |run: &MethodRun| wrong_percent(&report, run);
            findings.panels[0].curves.push(curve(&|k, run| (k.threshold, mean_ms(&report, run))));
            findings.panels[1].curves.push(curve(&|k, run| (k.threshold, wrong(run))));
            findings.panels[2].curves.push(curve(&|_, run| (mean_ms(&report, run), wrong(run))));
        }
        findings.statements.push(statement(place, &report));
    }
    Ok(findings)
}

/// One setting of what trades error for time.
struct Knobs {
    threshold: f64,
    /// Error of the levels of detail that occlude, in pixels; `None` for the originals.
    lod: Option<u32>,
}

/// All settings, those of the original occluders first.
fn knobs() -> Vec<Knobs> {
    let original = THRESHOLDS.iter().map(|&threshold| Knobs { threshold, lod: None });
    let lods = LOD_PIXELS
        .iter()
        .flat_map(|&pixels| LOD_THRESHOLDS.iter().map(move |&threshold| Knobs { threshold, lod: Some(pixels) }));
    original.chain(lods).collect()
}

fn panel(title: &str, x: &str, y: &str) -> Panel {
    Panel { title: title.into(), x: Axis::plain(x), y: Axis::plain(y), curves: Vec::new() }
}

/// View-frustum culling, the settings, the ideal.
fn methods(knobs: &[Knobs]) -> Vec<String> {
    let at = |k: &Knobs| match k.lod {
        None => format!("hom:threshold={}", k.threshold),
        Some(pixels) => format!("hom:threshold={},occluders=lod,lod={pixels}", k.threshold),
    };
    ["vfc".to_owned()].into_iter().chain(knobs.iter().map(at)).chain(["ideal".to_owned()]).collect()
}

fn mean_ms(report: &WalkReport, run: &MethodRun) -> f64 {
    run.frame_ms().total / report.frames as f64
}

fn row(place: &Place, report: &WalkReport, run: &MethodRun, knobs: Option<&Knobs>) -> Vec<Cell> {
    vec![
        Cell::text(&place.scene.name),
        Cell::text(&run.method),
        knobs.map_or(Cell::Unknown, |k| Cell::Figure(k.threshold)),
        knobs.and_then(|k| k.lod).map_or(Cell::Unknown, |pixels| Cell::Count(pixels.into())),
        Cell::Figure(mean_ms(report, run)),
        Cell::Figure(run.frame_ms().median),
        Cell::Figure(run.mean(report.pixels()).objects_drawn),
        Cell::Figure(triangles_drawn(report, run)),
        Cell::Count(run.wrongly_culled_objects().unwrap_or_default()),
        Cell::Figure(wrong_percent(report, run)),
        Cell::Figure(run.wrong_pixels_percent(report.pixels()).map_or(f64::NAN, |w| w.max)),
    ]
}

/// The lowest threshold whose error is hardly noticed, against the method without thresholds.
fn statement(place: &Place, report: &WalkReport) -> Statement {
    let plain = &report.runs[1];
    let bearable = |(_, run): &(&f64, &MethodRun)| wrong_percent(report, run) <= NOTICED;
    let runs = THRESHOLDS.iter().zip(&report.runs[1..]).skip(1);
    let chosen = runs.take_while(bearable).last();
    let (found, holds) = match chosen {
        None => {
            (format!("on {} every threshold below 1 has over {NOTICED} percent wrong pixels", place.scene.name), false)
        }
        Some((t, run)) => {
            let ratio = mean_ms(report, plain) / mean_ms(report, run);
            let found = format!(
                "on {} the lowest threshold of at most {NOTICED} percent wrong pixels is {t}: {} percent wrong, {} objects \
                 wrongly culled in {} frames, and {} ms a frame instead of {}",
                place.scene.name,
                digits3(wrong_percent(report, run)),
                run.wrongly_culled_objects().unwrap_or_default(),
                report.frames,
                digits3(mean_ms(report, run)),
                digits3(mean_ms(report, plain)),
            );
            (found, ratio > 1.0)
        }
    };
    Statement {
        section: "5.3.2, 8.4.2",
        claim: "ignoring small holes among the occluders makes frames faster, with artifacts noticed only when looked for",
        found,
        holds,
    }
}
