//! `homcull walk`: methods along a path, their table, files and pictures.

use std::path::Path;

use super::arguments::Options;
use super::pictures::Pictures;
use super::setting::{self, Setting};
use super::{files, preset, progress};
use crate::cull::Method;
use crate::error::Result;
use crate::measure::plot::{FrameAxis, culling_graph, frame_rate_graph};
use crate::measure::preset::Preset;
use crate::measure::report::WalkReport;
use crate::measure::walk::{WalkOptions, walk};
use crate::measure::{csv, json, table_walk};
use crate::scene::PreparedScene;

/// The method of a walk that does not say which.
const DEFAULT_METHOD: &str = "hom";
/// Times each frame is drawn by each method unless said otherwise: once, so that a walk is a walk.
const REPETITIONS: usize = 1;
/// Frames written as pictures when there is a folder for them.
const IMAGES: usize = 3;

/// Walks, prints the table, and writes what was asked for.
pub fn run(scene: &str, methods: &[String], options: &Options) -> Result<()> {
    if let Some(expanded) = Preset::parse(scene)? {
        return preset::run(&expanded, methods, options);
    }
    let methods = if methods.is_empty() { &[DEFAULT_METHOD.to_owned()] } else { methods };
    let methods = methods.iter().map(|m| Method::parse(m)).collect::<Result<Vec<_>>>()?;
    let out = options.out.as_deref().map(files::folder).transpose()?;
    files::check_targets(options)?;
    let setting = setting::load(scene, options, false)?;
    let report = walk_setting(&setting, &methods, options, out.as_deref())?;
    print(&report, options)?;
    if let Some(out) = out.as_deref() {
        plots(&report, out)?;
    }
    Ok(())
}

/// Prepares a scene and walks with all methods.
pub fn walk_setting(
    setting: &Setting,
    methods: &[Method],
    options: &Options,
    out: Option<&Path>,
) -> Result<WalkReport> {
    walk_prepared(setting, &PreparedScene::new(&setting.scene)?, methods, options, out)
}

/// Walks with a progress bar, and writes pictures to `out`.
pub fn walk_prepared(
    setting: &Setting,
    scene: &PreparedScene,
    methods: &[Method],
    options: &Options,
    out: Option<&Path>,
) -> Result<WalkReport> {
    let level = setting::level(options)?;
    let workers = setting::workers(options, setting::processors())?;
    let repetitions = options.repetitions.map_or(REPETITIONS, |n| n as usize);
    let walk_options = WalkOptions { level, workers: &workers, repetitions, exact: !options.no_exact };
    let bar = progress::bar(setting.views.len() * methods.len(), "walk", options.quiet);
    let images = options.images.map_or(IMAGES, |n| n as usize);
    let mut pictures = out.map(|out| Pictures::new(out, setting, scene, methods, level, images)).transpose()?;
    let report = walk(&setting.scene.name, scene, &setting.views, methods, &walk_options, |look| {
        bar.inc(1);
        pictures.as_mut().map_or(Ok(()), |p| p.take(look))
    })?;
    bar.finish_and_clear();
    Ok(report)
}

/// The files asked for, then the table on standard output unless JSON or CSV go there.
pub fn print(report: &WalkReport, options: &Options) -> Result<()> {
    if let Some(target) = &options.json {
        json::write_json(target, &json::walk(report))?;
    }
    if let Some(target) = &options.csv {
        csv::write_csv(target, report)?;
    }
    // Last: a file that cannot be written leaves nothing on standard output.
    if !options.quiet && !options.reports_to_stdout() {
        say!("{}", table_walk::walk(report).trim_end());
    }
    Ok(())
}

/// The frame-rate graph, and a culling graph for every method that culls.
pub fn plots(report: &WalkReport, out: &Path) -> Result<()> {
    frame_rate_graph(&out.join("frame-rate.png"), report, FrameAxis::FramesPerSecond)?;
    for (i, run) in report.runs.iter().enumerate() {
        if run.method.starts_with("hom") {
            culling_graph(&out.join(format!("culling-{}-{}.png", i + 1, run.method)), report, run)?;
        }
    }
    Ok(())
}
