//! 8.2.4: at which level of the pyramid overlap tests decide, and what is lost by leaving out the finest.
//!
//! The pyramid is the thesis's: a map of 256x256 pixels at the bottom, filtered from the display's samples, 4x4 at the top. All
//! tests are made (no bypass, no rest), once with all levels active, then with fewer and fewer of the finer ones.

use super::{
    ALL_TESTS, Axis, Bench, Cell, Column, Curve, Experiment, Findings, Panel, Place, Places, Statement, block_of,
    hidden_share, triangles_drawn,
};
use crate::error::Result;
use crate::measure::report::WalkReport;
use crate::measure::report_number::digits3;
use crate::occlusion::OverlapStatistics;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "levels",
    section: "8.2.4",
    shows: "the level of the pyramid at which overlap tests decide, and triangles drawn over the finest active level",
    places: Places::Scenes(&["city", "machine-room", super::PLANT]),
    frames: 16,
    run,
};

/// Pixels of the finest map, each way (8.2.2).
const MAP: u32 = 256;
/// Pixels of the coarsest, at least.
const MINIMAL: u32 = 4;
/// The finest active level of the thesis: 64x64.
const ACTIVE: usize = 2;
/// The finest levels that are tried: down to a map of 16x16.
const FINEST: usize = 4;
/// Thresholds of 8.4.1 and 8.4.2.
const THRESHOLDS: [f64; 2] = [1.0, 0.85];
/// "Very few" tests, in percent: this experiment's reading.
const FEW: f64 = 10.0;
/// What may be lost, in percent of what all levels cull, where the thesis says that further descent does not help.
const LITTLE: f64 = 5.0;

fn run(bench: &Bench<'_>, places: &[Place]) -> Result<Findings> {
    let mut findings = Findings {
        columns: vec![
            Column::new("scene", ""),
            Column::new("threshold", ""),
            Column::new("level", ""),
            Column::new("map", "pixels"),
            Column::new("tests passed", "a walk"),
            Column::new("of all passed", "percent"),
            Column::new("tests failed", "a walk"),
            Column::new("drawn if finest", "triangles"),
            Column::new("culled if finest", "percent of hidden"),
        ],
        panels: THRESHOLDS.iter().map(|t| passed_panel(*t)).chain([culled_panel()]).collect(),
        ..Findings::default()
    };
    for place in places {
        let levels = levels(place);
        for (panel, threshold) in THRESHOLDS.into_iter().enumerate() {
            let finest = 0..levels.min(FINEST + 1);
            let methods: Vec<String> = finest.map(|level| method(place, level, threshold)).collect();
            let report = bench.walk(place, &methods, 1)?;
            add_rows(&mut findings, place, threshold, &report);
            let curve = |points| Curve::new(&place.scene.name, points);
            let shares = shares(&report.runs[0].overlap).into_iter().enumerate();
            findings.panels[panel].curves.push(curve(shares.map(|(l, share)| (l as f64, share)).collect()));
            if panel == 0 {
                let culled = report.runs.iter().enumerate().map(|(l, run)| (l as f64, hidden_share(&report, run)));
                findings.panels[THRESHOLDS.len()].curves.push(curve(culled.collect()));
            }
            findings.statements.push(decided_early(place, threshold, &report));
            findings.statements.extend(little_lost(place, threshold, &report));
        }
    }
    Ok(findings)
}

fn method(place: &Place, finest: usize, threshold: f64) -> String {
    let block = block_of(place, MAP);
    format!("hom:block={block},minimal={MINIMAL}x{MINIMAL},levels={finest}-,threshold={threshold},{ALL_TESTS}")
}

/// Width and height of a level's map.
fn map_size(place: &Place, level: usize) -> (u32, u32) {
    let (width, height) = place.size();
    let pixels = |samples: u32| samples.div_ceil(samples.div_ceil(MAP)).div_ceil(1 << level);
    (pixels(width), pixels(height))
}

/// Levels of the pyramid: the last has the minimal resolution.
fn levels(place: &Place) -> usize {
    let fits = |level: &usize| {
        let (width, height) = map_size(place, *level);
        width.min(height) >= MINIMAL
    };
    1 + (1..16).take_while(fits).count()
}

/// Percent of the passed tests that each level decided.
fn shares(overlap: &OverlapStatistics) -> Vec<f64> {
    let all: u64 = overlap.passed.iter().sum();
    overlap.passed.iter().map(|&n| 100.0 * n as f64 / all.max(1) as f64).collect()
}

fn add_rows(findings: &mut Findings, place: &Place, threshold: f64, report: &WalkReport) {
    let overlap = &report.runs[0].overlap;
    let shares = shares(overlap);
    for level in 0..levels(place) {
        let (width, height) = map_size(place, level);
        let count = |counts: &[u64]| Cell::Count(counts.get(level).copied().unwrap_or(0));
        let run = report.runs.get(level);
        findings.rows.push(vec![
            Cell::text(&place.scene.name),
            Cell::Figure(threshold),
            Cell::Count(level as u64),
            Cell::text(format!("{width}x{height}")),
            count(&overlap.passed),
            Cell::Figure(shares.get(level).copied().unwrap_or(0.0)),
            count(&overlap.failed),
            run.map_or(Cell::Unknown, |run| Cell::Figure(triangles_drawn(report, run))),
            run.map_or(Cell::Unknown, |run| Cell::Figure(hidden_share(report, run))),
        ]);
    }
}

fn passed_panel(threshold: f64) -> Panel {
    Panel {
        title: format!("passed tests, threshold {threshold}"),
        x: Axis::plain("deciding level (0: 256x256)"),
        y: Axis::plain("percent of the tests passed"),
        curves: Vec::new(),
    }
}

fn culled_panel() -> Panel {
    Panel {
        title: "culled, threshold 1".into(),
        x: Axis::plain("finest active level (0: 256x256)"),
        y: Axis::plain("triangles culled, percent of the hidden"),
        curves: Vec::new(),
    }
}

fn decided_early(place: &Place, threshold: f64, report: &WalkReport) -> Statement {
    let finer: f64 = shares(&report.runs[0].overlap).iter().take(ACTIVE).sum();
    Statement {
        section: "8.2.4",
        claim: "very few overlap tests succeed at levels finer than 64x64",
        found: format!(
            "on {}, at a threshold of {threshold}, {} percent of those that pass do; tests of small rectangles start there",
            place.scene.name,
            digits3(finer)
        ),
        holds: finer <= FEW,
    }
}

fn little_lost(place: &Place, threshold: f64, report: &WalkReport) -> Option<Statement> {
    let (all, active) = (hidden_share(report, &report.runs[0]), hidden_share(report, report.runs.get(ACTIVE)?));
    Some(Statement {
        section: "8.2.4",
        claim: "descending further than 64x64 is unlikely to help",
        found: format!(
            "on {}, at a threshold of {threshold}, {} percent of the hidden triangles are culled with 64x64 as the finest level, {} \
             with 256x256",
            place.scene.name,
            digits3(active),
            digits3(all),
        ),
        holds: all - active <= LITTLE / 100.0 * all,
    })
}
