//! 6.1: without occluders every object passes the depth test, and the overlap test alone declares all of them visible.

use super::verdicts::{Judge, representations};
use super::{Axis, Bench, Cell, Column, Curve, Experiment, Findings, Panel, Place, Places, Progress, Statement};
use crate::error::Result;
use crate::measure::report_number::grouped;
use crate::occlusion::{Hidden, OcclusionSettings, Thresholds, Verdict, Visible};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "no-occluders",
    section: "6.1",
    shows: "without any occluder nothing is culled, with any depth representation",
    places: Places::Scenes(&["city", "machine-room", super::PLANT]),
    frames: 12,
    run,
};

/// An opacity threshold so low that almost nothing has to be covered.
const LOW: f64 = 0.01;

/// What a frame's objects were told.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    tested: u64,
    near: u64,
    no_sample: u64,
    passed_depth: u64,
    passed_overlap: u64,
    culled: u64,
}

fn run(bench: &Bench<'_>, places: &[Place]) -> Result<Findings> {
    let mut findings = Findings {
        columns: vec![
            Column::new("scene", ""),
            Column::new("depth", ""),
            Column::new("threshold", ""),
            Column::new("at the near plane", "objects"),
            Column::new("without a sample", "objects"),
            Column::new("tested", "objects"),
            Column::new("pass the depth test", "objects"),
            Column::new("pass the overlap test", "objects"),
            Column::new("culled", "objects"),
        ],
        ..Findings::default()
    };
    let (mut all, mut in_all) = (Sums::default(), 0);
    for place in places {
        let mut panel = Panel {
            title: place.scene.name.clone(),
            x: Axis::plain("frame"),
            y: Axis::plain("objects"),
            curves: Vec::new(),
        };
        let settings = settings()?;
        for ((depth, threshold), frames) in settings.iter().map(|s| (s.0, s.1)).zip(measure(bench, place, &settings)?) {
            let sum = frames.iter().copied().fold(Sums::default(), plus);
            findings.rows.push(vec![
                Cell::text(&place.scene.name),
                Cell::text(depth),
                Cell::Figure(threshold),
                Cell::Count(sum.near),
                Cell::Count(sum.no_sample),
                Cell::Count(sum.tested),
                Cell::Count(sum.passed_depth),
                Cell::Count(sum.passed_overlap),
                Cell::Count(sum.culled),
            ]);
            let over =
                |of: fn(&Sums) -> u64| frames.iter().enumerate().map(|(i, s)| (i as f64, of(s) as f64)).collect();
            if panel.curves.is_empty() {
                panel.curves.push(Curve { limit: true, ..Curve::new("tested", over(|s| s.tested)) });
            }
            let name =
                if threshold < 1.0 { format!("culled, {depth} at {threshold}") } else { format!("culled, {depth}") };
            panel.curves.push(Curve::new(name, over(|s| s.culled)));
            (all, in_all) = (plus(all, sum), in_all + 1);
        }
        findings.panels.push(panel);
    }
    findings.statements.push(statement(all, in_all));
    Ok(findings)
}

/// Every depth representation at a threshold of 1, and one at a low one.
fn settings() -> Result<Vec<(&'static str, f64, OcclusionSettings)>> {
    let plain = OcclusionSettings::default();
    let mut out: Vec<_> = representations()
        .into_iter()
        .map(|(name, depth)| (name, 1.0, OcclusionSettings { depth, ..plain.clone() }))
        .collect();
    out.push(("nbz", LOW, OcclusionSettings { thresholds: Thresholds::from_finest(LOW, 1.0)?, ..plain }));
    Ok(out)
}

/// The sums of every setting, frame by frame.
fn measure(bench: &Bench<'_>, place: &Place, settings: &[(&str, f64, OcclusionSettings)]) -> Result<Vec<Vec<Sums>>> {
    let mut judge = Judge::new(bench, place)?;
    let mut frames = vec![Vec::new(); settings.len()];
    (bench.progress)(Progress::Ahead(place.views.len()));
    for view in &place.views {
        judge.look(view)?;
        for ((_, _, settings), frames) in settings.iter().zip(&mut frames) {
            let mut buffer = judge.buffer(view, settings.clone())?;
            let mut sums = Sums::default();
            for judged in judge.judge(&mut buffer, view, &[])? {
                match judged.verdict {
                    Verdict::Visible(Visible::NearPlane) => sums.near += 1,
                    Verdict::Hidden(Hidden::NoSample | Hidden::OutsideFrustum) => sums.no_sample += 1,
                    verdict => {
                        sums.tested += 1;
                        sums.passed_depth += u64::from(judged.behind);
                        sums.passed_overlap += u64::from(verdict != Verdict::Visible(Visible::Uncovered));
                        sums.culled += u64::from(verdict.is_hidden());
                    }
                }
            }
            frames.push(sums);
        }
        (bench.progress)(Progress::Done);
    }
    Ok(frames)
}

fn plus(a: Sums, b: Sums) -> Sums {
    Sums {
        tested: a.tested + b.tested,
        near: a.near + b.near,
        no_sample: a.no_sample + b.no_sample,
        passed_depth: a.passed_depth + b.passed_depth,
        passed_overlap: a.passed_overlap + b.passed_overlap,
        culled: a.culled + b.culled,
    }
}

fn statement(all: Sums, settings: usize) -> Statement {
    Statement {
        section: "6.1",
        claim: "without occluders all objects pass the depth test, and the overlap test declares all of them visible",
        found: format!(
            "of {} tests, over {settings} scenes and settings, {} pass the depth test, {} the overlap test, and {} objects are culled",
            grouped(all.tested),
            grouped(all.passed_depth),
            all.passed_overlap,
            all.culled,
        ),
        holds: all.tested > 0 && all.passed_depth == all.tested && all.passed_overlap == 0 && all.culled == 0,
    }
}
