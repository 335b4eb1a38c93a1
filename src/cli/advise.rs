//! `homcull advise`, first form: what a scene and path need, what to leave out, and the counts behind it.
//!
//! Advice rests on counts, which are the same on every machine: triangles that need not be drawn, against triangles drawn as occluders, a buffer
//! more. The tests made, and the times of this machine, stand beside them.

use super::arguments::Options;
use super::{setting, walk};
use crate::cull::Method;
use crate::error::Result;
use crate::measure::json::write_json;
use crate::measure::report::{MethodRun, WalkReport};
use crate::measure::report_number::{digits3, grouped};
use crate::measure::table::Table;
use crate::measure::walk::applies;
use crate::scene::PreparedScene;
use serde_json::json;

/// What is tried: a method and what it is for.
const TRIED: [(&str, &str); 6] = [
    ("hzb", "the CPU draws the picture itself"),
    ("hom-progressive", "an engine that draws by other means asks what is visible"),
    ("hom", "the same, with occluders drawn beforehand, on other threads"),
    ("hom-multipass", "the same, in a few rounds"),
    ("chc:latency=20", "answers come late, as from a GPU"),
    ("ideal", "what any method could gain at most"),
];
/// Stages that may stand in front of the first of them.
const IN_FRONT: [&str; 3] = ["portals+hzb", "horizons+hzb", "detail+hzb"];
/// Frames of the walk, and times each is drawn.
const FRAMES: u32 = 24;
const REPETITIONS: u32 = 3;
/// Share of the frustum's triangles that must be hidden for occlusion culling to be worth its tests.
const WORTH: f64 = 0.2;

/// What a method saves and costs, a frame.
struct Account {
    /// Triangles in the frustum that it does not draw.
    saved: f64,
    /// Triangles that it draws as occluders beside the picture.
    spent: f64,
    /// Tests of boxes.
    tests: f64,
    /// Mean time, in milliseconds.
    ms: f64,
}

/// Walks, counts, and says what follows.
pub fn run(scene: &str, options: &Options) -> Result<()> {
    super::files::check_targets(options)?;
    let options = Options {
        frames: options.frames.or(Some(FRAMES)),
        repetitions: options.repetitions.or(Some(REPETITIONS)),
        ..options.clone()
    };
    let setting = setting::load(scene, &options, false)?;
    let prepared = PreparedScene::new(&setting.scene)?;
    let mut names: Vec<&str> = ["vfc"].into_iter().chain(TRIED.iter().map(|t| t.0)).collect();
    for name in IN_FRONT {
        if applies(&Method::parse(name)?, &prepared).is_ok() {
            names.push(name);
        }
    }
    let methods = names.iter().map(|m| Method::parse(m)).collect::<Result<Vec<_>>>()?;
    let report = walk::walk_prepared(&setting, &prepared, &methods, &options, None)?;
    let accounts: Vec<Account> = report.runs.iter().map(|run| account(&report, run)).collect();
    let advice = advice(&report, &accounts);
    if let Some(target) = &options.json {
        let rows = names.iter().zip(&accounts).zip(&report.runs).map(|((name, a), run)| {
            json!({"method": name, "triangles_saved": a.saved, "occluder_triangles": a.spent, "tests": a.tests, "ms": a.ms,
                   "bypassed_frames": run.frames.iter().filter(|f| f.bypassed).count()})
        });
        write_json(
            target,
            &json!({"scene": report.scene_name, "methods": rows.collect::<Vec<_>>(), "advice": advice}),
        )?;
    }
    if options.quiet || options.reports_to_stdout() {
        return Ok(());
    }
    print_table(&report, &accounts);
    for line in advice {
        say!("- {line}");
    }
    Ok(())
}

fn account(report: &WalkReport, run: &MethodRun) -> Account {
    let mean = run.mean(report.pixels());
    Account {
        saved: mean.triangles_in_frustum - mean.triangles_drawn,
        spent: mean.occluder_triangles,
        tests: mean.queries,
        ms: run.frame_ms().total / report.frames.max(1) as f64,
    }
}

fn print_table(report: &WalkReport, accounts: &[Account]) {
    say!(
        "{}: {} objects, {} triangles; {} frames\n",
        report.scene_name,
        grouped(report.objects),
        grouped(report.triangles),
        report.frames
    );
    let mut table = Table::new()
        .left("method")
        .right("triangles saved")
        .right("drawn as occluders")
        .right("tests")
        .right("ms a frame")
        .left("when");
    let when = |i: usize| match i.checked_sub(1) {
        None => "frustum culling alone: the baseline",
        Some(i) => TRIED.get(i).map_or("a stage in front of it", |tried| tried.1),
    };
    for (i, (run, a)) in report.runs.iter().zip(accounts).enumerate() {
        table.row([
            run.method.clone(),
            rounded(a.saved),
            rounded(a.spent),
            rounded(a.tests),
            digits3(a.ms),
            when(i).to_owned(),
        ]);
    }
    say!("{table}");
}

/// What to use, what to leave out, and why.
fn advice(report: &WalkReport, accounts: &[Account]) -> Vec<String> {
    let (vfc, ideal) = (&accounts[0], &accounts[TRIED.len()]);
    let in_frustum = report.runs[0].mean(report.pixels()).triangles_in_frustum.max(1.0);
    let hidden = ideal.saved / in_frustum;
    let mut out = vec![format!(
        "{} percent of the triangles in the frustum belong to objects that nobody sees; drawing none of them gains {} in time",
        digits3(hidden * 100.0),
        digits3(vfc.ms / ideal.ms),
    )];
    if hidden < WORTH {
        out.push("leave occlusion culling out: what is hidden is not worth looking for; vfc is enough".into());
        return out;
    }
    let net = |a: &Account| a.saved - a.spent;
    let best = |range: std::ops::Range<usize>| range.max_by(|&i, &j| net(&accounts[i]).total_cmp(&net(&accounts[j])));
    out.push(verdict("if the CPU draws the picture", "hzb", &accounts[1], in_frustum, vfc));
    // Those of an engine that draws by other means: from hom-progressive to hom-multipass.
    if let Some(i) = best(2..5).filter(|&i| net(&accounts[i]) > 0.0) {
        out.push(verdict("if something else draws it", TRIED[i - 1].0, &accounts[i], in_frustum, vfc));
    }
    out.extend((1..TRIED.len()).filter(|&i| net(&accounts[i]) <= 0.0).map(|i| {
        format!("leave {} out: it draws as many triangles as occluders as it saves, or more", TRIED[i - 1].0)
    }));
    out.extend(report.runs.iter().filter_map(|run| {
        let bypassed = run.frames.iter().filter(|f| f.bypassed).count();
        let often = run.stages().is_empty() && 2 * bypassed > run.frames.len();
        often.then(|| {
            format!("{} gave up in {bypassed} of {} frames: they hid too little", run.method, run.frames.len())
        })
    }));
    out.extend(stages_in_front(report, accounts));
    out
}

/// A count of triangles or tests.
fn rounded(count: f64) -> String {
    grouped(count.round() as u64)
}

/// What each stage in front of `hzb` saves it, in tests.
fn stages_in_front(report: &WalkReport, accounts: &[Account]) -> Vec<String> {
    let alone = &accounts[1];
    let mut out = Vec::new();
    for (run, account) in report.runs.iter().zip(accounts).skip(1 + TRIED.len()) {
        let stages = run.stages();
        let (Some(first), Some(last)) = (stages.first(), stages.last()) else { continue };
        let wrong = run.wrong_pixels_percent(report.pixels()).map_or(0.0, |w| w.mean);
        let does = format!(
            "{} before hzb leaves it {} of {} tests, with {} tests of its own; a frame takes {} times the time, {} percent of the pixels are wrong",
            first.method,
            rounded(last.queries),
            rounded(alone.tests),
            rounded(first.queries),
            digits3(account.ms / alone.ms),
            digits3(wrong),
        );
        let pays = last.queries <= (1.0 - WORTH) * alone.tests;
        out.push(if pays { does } else { format!("leave {} out: {does}", first.method) });
    }
    out
}

fn verdict(when: &str, method: &str, a: &Account, in_frustum: f64, vfc: &Account) -> String {
    format!(
        "{when}, use {method}: it saves {} percent of the triangles in the frustum and draws {} percent as occluders, with {} tests a frame; with our \
         own draw, which drops what is hidden cheaply, a frame takes {} times vfc's time",
        digits3(a.saved / in_frustum * 100.0),
        digits3(a.spent / in_frustum * 100.0),
        digits3(a.tests),
        digits3(a.ms / vfc.ms),
    )
}
