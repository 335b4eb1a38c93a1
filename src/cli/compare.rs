//! `homcull compare`: every method, and a sweep of every knob that gives up the picture for time, on one scene and path: error against run
//! time as a table, a plot, JSON and CSV, with the Pareto front.

use std::path::Path;

use serde_json::json;

use super::arguments::Options;
use super::{files, setting, walk};
use crate::cull::Method;
use crate::error::Result;
use crate::measure::json;
use crate::measure::plot::{ScatterPoint, ScatterSeries, error_against_time};
use crate::measure::report::{MethodRun, WalkReport};
use crate::measure::report_number::digits3;
use crate::measure::walk::applies;
use crate::scene::PreparedScene;

/// Where the plot goes unless said otherwise.
const OUT: &str = "homcull-out";
/// Frames of the walk, and times each is drawn.
const FRAMES: u32 = 24;
const REPETITIONS: u32 = 3;

/// What has one line in the plot: methods by themselves, or one method by the values of a knob.
struct Sweep {
    name: &'static str,
    /// A method without the knob's value, and the values; none for methods that stand for themselves.
    method: &'static str,
    values: &'static [&'static str],
}

/// Methods that keep the picture.
static EXACT: Sweep = Sweep {
    name: "methods that keep the picture",
    method: "",
    values: &[
        "vfc",
        "hom",
        "hom-multipass",
        "hom-progressive",
        "hzb",
        "stop-and-wait",
        "chc",
        "cplp",
        "portals",
        "horizons",
        "portals+hzb",
        "horizons+hzb",
        "ideal",
    ],
};
/// Knobs that trade error for time.
static KNOBS: [Sweep; 7] = [
    Sweep { name: "hom, opacity threshold", method: "hom:threshold=", values: &["0.95", "0.85", "0.7", "0.5"] },
    Sweep { name: "hom, LOD occluders, pixels", method: "hom:occluders=lod,lod=", values: &["4", "16", "64"] },
    Sweep {
        name: "hom-progressive, samples",
        method: "hom-progressive:resolution=",
        values: &["640x512", "320x256", "160x128"],
    },
    Sweep { name: "chc, pixels", method: "chc:pixels=", values: &["5", "25", "100", "400"] },
    Sweep { name: "chc of 25 pixels, frames", method: "chc:pixels=25,assume-visible=", values: &["2", "8"] },
    Sweep { name: "detail before hzb, pixels", method: "detail:pixels=", values: &["4+hzb", "16+hzb", "64+hzb"] },
    Sweep { name: "plp, triangles", method: "plp:budget=", values: &["10000", "35000", "140000"] },
];

/// One method of the comparison.
struct Entry {
    sweep: &'static Sweep,
    value: &'static str,
    method: Method,
}

impl Entry {
    fn written(&self) -> String {
        format!("{}{}", self.sweep.method, self.value)
    }
}

/// All methods that apply to a scene; of the others, why they do not.
fn entries(scene: &PreparedScene) -> Result<(Vec<Entry>, Vec<String>)> {
    let (mut entries, mut left_out) = (Vec::new(), Vec::new());
    for sweep in std::iter::once(&EXACT).chain(&KNOBS) {
        for &value in sweep.values {
            let method = Method::parse(&format!("{}{value}", sweep.method))?;
            match applies(&method, scene) {
                Ok(()) => entries.push(Entry { sweep, value, method }),
                // What a stage does not apply to is said of the stage.
                Err(_) if method.stages().len() > 1 => {}
                Err(reason) => left_out.push(format!("{} is left out: {reason}", method.name())),
            }
        }
    }
    Ok((entries, left_out))
}

/// Walks with all methods; prints, and writes what was asked for.
pub fn run(scene: &str, options: &Options) -> Result<()> {
    files::check_targets(options)?;
    let out = files::folder(options.out.as_deref().unwrap_or(Path::new(OUT)))?;
    let options = Options {
        frames: options.frames.or(Some(FRAMES)),
        repetitions: options.repetitions.or(Some(REPETITIONS)),
        ..options.clone()
    };
    let setting = setting::load(scene, &options, false)?;
    let prepared = PreparedScene::new(&setting.scene)?;
    let (entries, left_out) = entries(&prepared)?;
    let methods: Vec<Method> = entries.iter().map(|entry| entry.method.clone()).collect();
    let mut report = walk::walk_prepared(&setting, &prepared, &methods, &options, None)?;
    for (run, entry) in report.runs.iter_mut().zip(&entries) {
        run.name = Some(entry.written());
    }
    let front = pareto_front(&report);
    let plot = out.join("error-against-time.png");
    let title = format!("Error against run time: {}", report.scene_name);
    error_against_time(&plot, &title, "means of the frames", &series(&report, &entries, &front))?;
    if let Some(target) = &options.json {
        let mut value = json::walk(&report);
        value["pareto_front"] = json!(front.iter().map(|&i| entries[i].written()).collect::<Vec<_>>());
        value["left_out"] = json!(left_out);
        json::write_json(target, &value)?;
    }
    walk::print(
        &report,
        &Options { json: None, quiet: options.quiet || options.reports_to_stdout(), ..options.clone() },
    )?;
    if !options.quiet && !options.reports_to_stdout() {
        left_out.iter().for_each(|line| say!("{line}"));
        print_front(&report, &front);
        say!("Plot: {}", plot.display());
    }
    Ok(())
}

fn ms(report: &WalkReport, run: &MethodRun) -> f64 {
    run.frame_ms().total / report.frames.max(1) as f64
}

fn wrong(report: &WalkReport, run: &MethodRun) -> f64 {
    run.wrong_pixels_percent(report.pixels()).map_or(0.0, |w| w.mean)
}

/// Runs that no other beats in both time and error, the fastest first. The ideal is not among them: nobody has it.
fn pareto_front(report: &WalkReport) -> Vec<usize> {
    let mut order: Vec<usize> = (0..report.runs.len()).filter(|&i| report.runs[i].method != "ideal").collect();
    order.sort_by(|&i, &j| {
        let (a, b) = (&report.runs[i], &report.runs[j]);
        ms(report, a).total_cmp(&ms(report, b)).then(wrong(report, a).total_cmp(&wrong(report, b)))
    });
    let mut least = f64::INFINITY;
    order.retain(|&i| {
        let error = wrong(report, &report.runs[i]);
        let better = error < least;
        least = least.min(error);
        better
    });
    order
}

/// A series a knob; methods that keep the picture are no sweep and stand apart, each by itself; the front last.
fn series(report: &WalkReport, entries: &[Entry], front: &[usize]) -> Vec<ScatterSeries> {
    let point = |i: usize, label: &str| ScatterPoint {
        ms: ms(report, &report.runs[i]),
        wrong_percent: wrong(report, &report.runs[i]),
        label: label.to_owned(),
    };
    let mut all: Vec<ScatterSeries> = Vec::new();
    for (i, entry) in entries.iter().enumerate() {
        let name = if entry.sweep.method.is_empty() { entry.value } else { entry.sweep.name };
        match all.last_mut().filter(|last| last.name == name) {
            Some(last) => last.points.push(point(i, entry.value)),
            None => all.push(ScatterSeries { name: name.into(), points: vec![point(i, entry.value)] }),
        }
    }
    let points = front.iter().map(|&i| point(i, "")).collect();
    all.push(ScatterSeries { name: "Pareto front".into(), points });
    all
}

fn print_front(report: &WalkReport, front: &[usize]) {
    say!("\nNothing is both faster and more right than (the ideal aside):");
    for &i in front {
        let run = &report.runs[i];
        let name = run.name.as_deref().unwrap_or(&run.method);
        let culled = run.wrongly_culled_objects().map_or("-".into(), |n| n.to_string());
        let (ms, wrong) = (digits3(ms(report, run)), digits3(wrong(report, run)));
        say!("  {name:<40} {ms:>7} ms  {wrong:>9} % of pixels wrong  {culled:>6} objects wrongly culled");
    }
}
