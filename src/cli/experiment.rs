//! `homcull experiment`: the papers' claims, one command each; table, statements, and files in `homcull-out/`.

use std::path::Path;

use serde_json::{Value, json};

use super::arguments::Options;
use super::setting::{self, Setting};
use super::{files, progress};
use crate::error::Result;
use crate::measure::experiments::{Bench, EXPERIMENTS, Experiment, Findings, Place, Places, Progress, plot};
use crate::measure::json::write_json;
use crate::measure::report_number::grouped;
use crate::measure::report_target::Target;
use crate::measure::table::Table;

/// Where results go.
const OUT: &str = "homcull-out";

/// Lists the experiments, or makes one.
pub fn run(name: Option<&str>, scene: Option<&str>, options: &Options) -> Result<()> {
    match name {
        None => list(),
        Some(name) => make(Experiment::find(name)?, scene, options),
    }
}

fn list() -> Result<()> {
    let mut table = Table::new().left("experiment").left("source").left("made in").right("frames").left("shows");
    for e in &EXPERIMENTS {
        table.row([e.name.to_owned(), e.source(), e.places.names(), e.frames.to_string(), e.shows.to_owned()]);
    }
    Target::Stdout.write(|out| write!(out, "{table}"))
}

fn make(experiment: &Experiment, scene: Option<&str>, options: &Options) -> Result<()> {
    let out = files::folder(options.out.as_deref().unwrap_or(Path::new(OUT)))?;
    files::check_targets(options)?;
    let (level, workers) = (setting::level(options)?, setting::workers(options, setting::processors())?);
    let options = Options { frames: options.frames.or(Some(experiment.frames)), ..options.clone() };
    let places = places(experiment, scene, &options)?;
    let bar = progress::bar(0, experiment.name, options.quiet);
    let step = |progress| match progress {
        Progress::Ahead(steps) => bar.inc_length(steps as u64),
        Progress::Done => bar.inc(1),
    };
    let repetitions = options.repetitions.map(|n| n as usize);
    let bench = Bench { level, workers: &workers, repetitions, out: &out, progress: &step };
    let findings = (experiment.run)(&bench, &places)?;
    bar.finish_and_clear();
    write(experiment, &findings, &about(experiment, &bench, &places), &out)?;
    print(experiment, &findings, &about(experiment, &bench, &places), &out, &options)
}

fn places(experiment: &Experiment, scene: Option<&str>, options: &Options) -> Result<Vec<Place>> {
    let place = |Setting { scene, views, .. }| Place::new(scene, views);
    match (scene, experiment.places) {
        (Some(scene), _) => Ok(vec![place(setting::load(scene, options, false)?)?]),
        (None, Places::Scenes(names)) => names.iter().map(|name| place(setting::load(name, options, false)?)).collect(),
        (None, Places::Built(name, build)) => Ok(vec![place(setting::of_generated(name, build(), options)?)?]),
    }
}

/// What it was measured on.
struct About {
    json: Value,
    line: String,
}

fn about(experiment: &Experiment, bench: &Bench<'_>, places: &[Place]) -> About {
    let (level, threads) = (bench.level.name(), bench.workers.threads());
    let scenes = places.iter().map(|place| {
        let (width, height) = place.size();
        let (objects, triangles) = (place.scene.objects.len(), place.scene.triangles());
        json!({
            "name": place.scene.name, "objects": objects, "triangles": triangles,
            "width": width, "height": height, "frames": place.views.len(),
        })
    });
    let json = json!({
        "experiment": experiment.name, "section": experiment.section, "shows": experiment.shows,
        "scenes": scenes.collect::<Vec<_>>(), "machine": {"simd": level, "threads": threads},
    });
    let scene = |place: &Place| format!("{}, {} triangles", place.scene.name, grouped(place.scene.triangles()));
    let scenes = places.iter().map(scene).collect::<Vec<_>>().join("; ");
    let (width, height) = places.first().map_or((0, 0), Place::size);
    let frames = places.iter().map(|place| place.views.len()).max().unwrap_or(0);
    let s = if threads == 1 { "" } else { "s" };
    About { json, line: format!("{scenes}; {width}x{height}, {frames} frames; {level}, {threads} thread{s}") }
}

/// The three files of every experiment.
fn write(experiment: &Experiment, findings: &Findings, about: &About, out: &Path) -> Result<()> {
    let file = |end: &str| out.join(format!("experiment-{}.{end}", experiment.name));
    findings.write_csv(&Target::File(file("csv")))?;
    write_json(&Target::File(file("json")), &findings.json(about.json.clone()))?;
    let title = format!("{} ({})", experiment.name, experiment.source());
    plot(&file("png"), &title, &about.line, &findings.panels)
}

/// What was asked for, then the table and the statements on standard output unless JSON or CSV go there.
fn print(experiment: &Experiment, findings: &Findings, about: &About, out: &Path, options: &Options) -> Result<()> {
    if let Some(target) = &options.json {
        write_json(target, &findings.json(about.json.clone()))?;
    }
    if let Some(target) = &options.csv {
        findings.write_csv(target)?;
    }
    if options.quiet || [&options.json, &options.csv].into_iter().any(|t| matches!(t, Some(Target::Stdout))) {
        return Ok(());
    }
    Target::Stdout.write(|to| {
        writeln!(to, "{}: {}\n{}\n\n{}", experiment.name, experiment.shows, about.line, findings.table())?;
        findings.statements.iter().try_for_each(|statement| writeln!(to, "{statement}"))?;
        writeln!(to, "\nFiles: {}/experiment-{}.png, .csv, .json", out.display(), experiment.name)
    })
}
