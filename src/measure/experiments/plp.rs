//! Prioritized-layered projection on the plant, as the gem measured it on UNC's (Correa, Klosowski and Silva 2002): pixels right over the
//! budget, with layers and with accumulated solidity; and what it costs to have all of them right, with cPLP.
//!
//! A pixel is right when it shows the object, depth and colour of the exact picture; where nothing is drawn it is right. Beside the heuristics
//! stands the *best choice*: the visible objects that show most samples a triangle, known from the exact picture, as far as the budget goes.
//! Nothing that takes whole objects can do much better. Milliseconds are of the whole frame, culling and draw.

use super::verdicts::Judge;
use super::{Axis, Bench, Cell, Column, Curve, Experiment, Findings, Panel, Place, Places, Statement, triangles_drawn};
use crate::error::Result;
use crate::measure::report::{MethodRun, WalkReport};
use crate::measure::report_number::{count, digits3};
use crate::measure::statistics::{mean, percentile};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "plp",
    section: GEM,
    shows: "PLP's pixels right over the budget, with two heuristics; cPLP's cost for all of them right",
    places: Places::Scenes(&["plant"]),
    frames: 16,
    run,
};

const GEM: &str = "Correa, Klosowski and Silva 2002";

/// Triangles a frame; the gem's is among them.
const BUDGETS: [u64; 5] = [35_000, 70_000, GEM_BUDGET, 280_000, 560_000];
const GEM_BUDGET: u64 = 140_000;
/// The gem's pixels right, in percent: on the mean, and in three quarters of the frames.
const GEM_RIGHT: (f64, f64) = (96.3, 94.9);
/// The gem's frames a second on the mean: of PLP over those of cPLP.
const GEM_COST: f64 = 10.1 / 2.1;
const HEURISTICS: [&str; 2] = ["solidity", "layer"];
/// What the best choice is called.
const BEST: &str = "best choice";

fn run(bench: &Bench<'_>, places: &[Place]) -> Result<Findings> {
    let mut findings = Findings {
        columns: vec![
            Column::new("scene", ""),
            Column::new("method", ""),
            Column::new("heuristic", ""),
            Column::new("budget", "triangles"),
            Column::new("pixels right", "percent"),
            Column::new("in 3 of 4 frames", "percent"),
            Column::new("worst frame", "percent"),
            Column::new("objects drawn", "a frame"),
            Column::new("triangles drawn", "a frame"),
            Column::new("queries", "a frame"),
            Column::new("frame", "ms"),
        ],
        panels: vec![
            panel("on the mean", Axis::doubling("budget, triangles", BUDGETS[0] as f64)),
            panel("in a quarter of the frames, or more", Axis::doubling("budget, triangles", BUDGETS[0] as f64)),
            panel("along the walk, 140,000 triangles", Axis::plain("frame")),
        ],
        ..Findings::default()
    };
    for place in places {
        let report = bench.walk(place, &methods(), 1)?;
        let best = best_choices(bench, place)?;
        findings.rows.extend(report.runs.iter().map(|run| row(&report, run)));
        findings.rows.extend(BUDGETS.iter().zip(&best).map(|(&budget, right)| best_row(place, budget, right)));
        add_curves(&mut findings, place, &report, &best);
        findings.statements.extend(statements(&report));
    }
    Ok(findings)
}

fn panel(title: &str, x: Axis) -> Panel {
    Panel { title: title.into(), x, y: Axis::plain("wrong pixels, percent"), curves: Vec::new() }
}

/// View-frustum culling, PLP by heuristic and budget, cPLP by heuristic.
fn methods() -> Vec<String> {
    let plp = HEURISTICS.iter().flat_map(|h| BUDGETS.map(|budget| format!("plp:heuristic={h},budget={budget}")));
    let cplp = HEURISTICS.iter().map(|h| format!("cplp:heuristic={h},budget={GEM_BUDGET}"));
    ["vfc".to_owned()].into_iter().chain(plp).chain(cplp).chain(["ideal".to_owned()]).collect()
}

/// Percent of the pixels that are right, frame by frame.
fn right(report: &WalkReport, run: &MethodRun) -> Vec<f64> {
    let percent = |wrong: u64| 100.0 - 100.0 * wrong as f64 / report.pixels().max(1) as f64;
    run.frames.iter().filter_map(|frame| frame.wrong_pixels.map(percent)).collect()
}

/// Mean, what three quarters of the frames reach, and the worst frame.
fn summary(right: &[f64]) -> [f64; 3] {
    [
        mean(right.iter().copied()).unwrap_or(f64::NAN),
        percentile(right, 25.0).unwrap_or(f64::NAN),
        right.iter().copied().fold(f64::INFINITY, f64::min),
    ]
}

/// Pixels right of the best choice, in percent, by budget and frame.
fn best_choices(bench: &Bench<'_>, place: &Place) -> Result<Vec<Vec<f64>>> {
    let mut judge = Judge::new(bench, place)?;
    let mut out = vec![Vec::new(); BUDGETS.len()];
    let (width, height) = place.size();
    for view in &place.views {
        let mut visible = judge.look(view)?;
        visible.retain(|&o| judge.samples[o as usize] > 0);
        let cost = |o: u32| judge.triangles(o).max(1);
        let gain = |o: u32| f64::from(judge.samples[o as usize]) / cost(o) as f64;
        visible.sort_by(|&a, &b| gain(b).total_cmp(&gain(a)).then(a.cmp(&b)));
        for (budget, out) in BUDGETS.iter().zip(&mut out) {
            let (mut left, mut wrong) = (*budget, 0);
            for &o in &visible {
                if cost(o) <= left {
                    left -= cost(o);
                } else {
                    wrong += u64::from(judge.samples[o as usize]);
                }
            }
            out.push(100.0 - 100.0 * wrong as f64 / (f64::from(width) * f64::from(height)));
        }
    }
    Ok(out)
}

fn row(report: &WalkReport, run: &MethodRun) -> Vec<Cell> {
    let [mean_right, quartile, worst] = summary(&right(report, run));
    let budget = run.parameter("budget").and_then(|b| b.parse().ok());
    let queries = mean(run.frames.iter().map(|f| f.queries as f64)).unwrap_or(f64::NAN);
    vec![
        Cell::text(&report.scene_name),
        Cell::text(&run.method),
        run.parameter("heuristic").map_or(Cell::Unknown, Cell::text),
        budget.map_or(Cell::Unknown, Cell::Count),
        Cell::Figure(mean_right),
        Cell::Figure(quartile),
        Cell::Figure(worst),
        Cell::Figure(run.mean(report.pixels()).objects_drawn),
        Cell::Figure(triangles_drawn(report, run)),
        Cell::Figure(queries),
        Cell::Figure(mean_ms(report, run)),
    ]
}

fn best_row(place: &Place, budget: u64, right: &[f64]) -> Vec<Cell> {
    let mut row = vec![Cell::text(&place.scene.name), Cell::text(BEST), Cell::Unknown, Cell::Count(budget)];
    row.extend(summary(right).map(Cell::Figure));
    row.resize(11, Cell::Unknown);
    row
}

fn mean_ms(report: &WalkReport, run: &MethodRun) -> f64 {
    run.frame_ms().total / report.frames.max(1) as f64
}

fn find<'r>(report: &'r WalkReport, method: &str, heuristic: &str, budget: u64) -> Option<&'r MethodRun> {
    let is = |run: &&MethodRun| {
        run.method == method
            && run.parameter("heuristic") == Some(heuristic)
            && run.parameter("budget") == Some(&budget.to_string())
    };
    report.runs.iter().find(is)
}

fn add_curves(findings: &mut Findings, place: &Place, report: &WalkReport, best: &[Vec<f64>]) {
    let name = |what: &str| format!("{}, {what}", place.scene.name);
    let over_budgets = |of: &dyn Fn(usize) -> f64| {
        BUDGETS.iter().enumerate().map(|(i, &budget)| (budget as f64, 100.0 - of(i))).collect::<Vec<_>>()
    };
    let over_frames = |right: &[f64]| right.iter().enumerate().map(|(i, r)| (i as f64, 100.0 - r)).collect::<Vec<_>>();
    for heuristic in HEURISTICS {
        let of = |i: usize| find(report, "plp", heuristic, BUDGETS[i]).map_or(Vec::new(), |run| right(report, run));
        let at_budget = |statistic: usize| over_budgets(&|i| summary(&of(i))[statistic]);
        let along = BUDGETS.iter().position(|&b| b == GEM_BUDGET).map_or(Vec::new(), of);
        let points = [at_budget(0), at_budget(1), over_frames(&along)];
        for (panel, points) in findings.panels.iter_mut().zip(points) {
            panel.curves.push(Curve::new(name(heuristic), points));
        }
    }
    let at_budget = |statistic: usize| over_budgets(&|i| summary(&best[i])[statistic]);
    for (panel, points) in findings.panels.iter_mut().zip([at_budget(0), at_budget(1)]) {
        panel.curves.push(Curve { limit: true, ..Curve::new(name(BEST), points) });
    }
}

fn statements(report: &WalkReport) -> Vec<Statement> {
    let [solidity, layer] = HEURISTICS.map(|h| find(report, "plp", h, GEM_BUDGET).map(|run| right(report, run)));
    let (solidity, layer) = (summary(&solidity.unwrap_or_default()), summary(&layer.unwrap_or_default()));
    let scene = &report.scene_name;
    let accuracy = Statement {
        section: GEM,
        claim: "with 140,000 triangles a frame 96.3 percent of the pixels are right on the mean, and 94.9 in three quarters of the frames, with \
                the layer heuristic alone",
        found: format!(
            "on {scene} layers get {} and {} percent right, accumulated solidity {} and {}",
            tenths(layer[0]),
            tenths(layer[1]),
            tenths(solidity[0]),
            tenths(solidity[1])
        ),
        holds: layer[0] >= GEM_RIGHT.0 && layer[1] >= GEM_RIGHT.1,
    };
    vec![accuracy, better_heuristics(report), conservative(report)]
}

fn better_heuristics(report: &WalkReport) -> Statement {
    let mean_right = |heuristic: &str, budget: u64| {
        find(report, "plp", heuristic, budget).map_or(f64::NAN, |run| summary(&right(report, run))[0])
    };
    let better = BUDGETS.iter().filter(|&&b| mean_right(HEURISTICS[0], b) >= mean_right(HEURISTICS[1], b)).count();
    Statement {
        section: GEM,
        claim: "the accuracy can be even better with more sophisticated heuristics",
        found: format!(
            "on {} accumulated solidity shows no less than layers at {better} of {} budgets",
            report.scene_name,
            BUDGETS.len()
        ),
        holds: better == BUDGETS.len(),
    }
}

fn conservative(report: &WalkReport) -> Statement {
    let of = |method: &str| find(report, method, HEURISTICS[0], GEM_BUDGET);
    let wrong: u64 = report
        .runs
        .iter()
        .filter(|run| run.method == "cplp")
        .flat_map(|run| &run.frames)
        .filter_map(|f| f.wrong_pixels)
        .sum();
    let (triangles, time) = match (of("cplp"), of("plp")) {
        (Some(c), Some(p)) => {
            (triangles_drawn(report, c) / triangles_drawn(report, p), mean_ms(report, c) / mean_ms(report, p))
        }
        _ => (f64::NAN, f64::NAN),
    };
    let vfc = report.runs.first().zip(of("cplp")).map_or(f64::NAN, |(v, c)| mean_ms(report, v) / mean_ms(report, c));
    Statement {
        section: GEM,
        claim: "cPLP's pictures are right in every pixel, for frames of 4.8 times PLP's length",
        found: format!(
            "on {} {} pixels are wrong in {} frames of cPLP, for {} times PLP's triangles and {} times its time; view-frustum culling takes \
             {} times cPLP's",
            report.scene_name,
            count(wrong as f64),
            report.frames,
            digits3(triangles),
            digits3(time),
            digits3(vfc)
        ),
        holds: wrong == 0 && time <= GEM_COST,
    }
}

/// Percents in tenths.
fn tenths(percent: f64) -> String {
    format!("{percent:.1}")
}
