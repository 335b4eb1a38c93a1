//! `homcull walk thesis-...`: the thesis's experiments (Zhang 1998, 8.4), with their graphs and the table beside its figures.
//!
//! The folder gets `frame-rate.png` and `frame-time.png` (figures 8.5, 8.9, 8.15), a `culling-NAME.png` for each method that culls (8.6,
//! 8.10, 8.16), `comparison.csv` and `comparison.json`, `frames.csv` and `report.json`, pictures of some frames; and, where
//! visibility is preprocessed, `visibility.bake`, which is used again while it is of the same scene and grid.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::arguments::{Options, Size};
use super::setting::{self, Setting};
use super::{files, progress, walk};
use crate::cull::{Method, Selection};
use crate::error::Result;
use crate::measure::bake::{BakeOptions, DEFAULT_SIDE, bake, default_near, scene_box};
use crate::measure::comparison::Comparison;
use crate::measure::json::write_json;
use crate::measure::plot::{FrameAxis, culling_graph, frame_rate_graph};
use crate::measure::preset::{Expanded, Form, Preset, grid_around};
use crate::measure::report::WalkReport;
use crate::measure::report_target::Target;
use crate::measure::{csv, json};
use crate::scene::{self, PreparedScene, Views};
use crate::select::{BakedVisibility, ViewGrid};

/// Where reports go, each in a folder of its own.
const OUT: &str = "homcull-out";
/// Times each frame is drawn by each method unless said otherwise; the fastest counts.
const REPETITIONS: u32 = 3;

/// Walks a preset, or explicit methods in its setting.
pub fn run(expanded: &Expanded, methods: &[String], options: &Options) -> Result<()> {
    let preset = expanded.preset;
    let explicit = methods.iter().map(|m| Method::parse(m)).collect::<Result<Vec<_>>>()?;
    let mut forms = if explicit.is_empty() { preset.forms()? } else { Vec::new() };
    let options = with_defaults(preset, options);
    let out = options.out.clone().unwrap_or_else(|| Path::new(OUT).join(preset.name));
    let out = files::folder(&out)?;
    files::check_targets(&options)?;
    let mut setting = setting::load(&expanded.scene, &options, false)?;
    setting.scene.name = format!("{} ({})", preset.name, expanded.scene);
    if let Some(cells) = expanded.grid.filter(|_| forms.iter().any(reads_bake)) {
        let grid = grid_around(cells, eyes(&expanded.scene, &options)?)?;
        let file = baked(&setting, grid, &options, &out)?;
        forms.iter_mut().for_each(|form| form.set_bake(&file));
    }
    let methods = if explicit.is_empty() { forms.iter().map(|f| f.method.clone()).collect() } else { explicit };
    let mut report = walk::walk_setting(&setting, &methods, &options, Some(&out))?;
    for (run, form) in report.runs.iter_mut().zip(&forms) {
        run.name = Some(form.name.to_owned());
    }
    write_files(preset, &report, &out)?;
    print(preset, &report, &options, &out)
}

/// The user's options, and the preset's where the user has none.
fn with_defaults(preset: &Preset, options: &Options) -> Options {
    Options {
        size: options.size.or_else(|| Size::new(preset.size.0, preset.size.1)),
        frames: options.frames.or(Some(preset.frames as u32)),
        threads: options.threads.or(preset.threads.map(|n| n as u32)),
        repetitions: options.repetitions.or(Some(REPETITIONS)),
        ..options.clone()
    }
}

fn reads_bake(form: &Form) -> bool {
    matches!(&form.method, Method::Hom(p) if p.select == Selection::Baked)
}

/// The eyes of a scene's walk at its keys: they do not depend on the number of frames.
fn eyes(scene: &str, options: &Options) -> Result<Vec<DVec3>> {
    match scene::load(scene, options.path.as_deref())?.views {
        Views::Path(path, _) => Ok(path.keys.iter().map(|key| key.eye).collect()),
        Views::Matrices { .. } => Ok(Vec::new()),
    }
}

/// The bake of the setting's scene, made unless it is there.
fn baked(setting: &Setting, grid: ViewGrid, options: &Options, out: &Path) -> Result<PathBuf> {
    let file = out.join("visibility.bake");
    let near = default_near(scene_box(&setting.scene).unwrap_or_default());
    let bake_options = BakeOptions { grid, side: DEFAULT_SIDE, near };
    if file.is_file() {
        let scene = PreparedScene::new(&setting.scene)?;
        let fits = |b: &BakedVisibility| b.header().grid == grid && b.header().side == DEFAULT_SIDE;
        if BakedVisibility::load(&file, &scene).is_ok_and(|b| fits(&b)) {
            return Ok(file);
        }
    }
    let (level, workers) = (setting::level(options)?, setting::workers(options, setting::processors())?);
    let bar = progress::bar(2 * grid.points(), "bake", options.quiet);
    bake(&setting.scene, &bake_options, level, &workers, &file, |steps| {
        bar.set_position(steps as u64);
        ControlFlow::Continue(())
    })?;
    bar.finish_and_clear();
    Ok(file)
}

fn write_files(preset: &Preset, report: &WalkReport, out: &Path) -> Result<()> {
    let file = |name: &str| Target::File(out.join(name));
    let comparison = Comparison { preset, report };
    frame_rate_graph(&out.join("frame-rate.png"), report, FrameAxis::FramesPerSecond)?;
    frame_rate_graph(&out.join("frame-time.png"), report, FrameAxis::Milliseconds)?;
    for (i, run) in report.runs.iter().enumerate().filter(|(_, run)| run.method.starts_with("hom")) {
        let name = run.name.clone().unwrap_or_else(|| format!("{}-{}", i + 1, run.method));
        culling_graph(&out.join(format!("culling-{name}.png")), report, run)?;
    }
    comparison.write_csv(&file("comparison.csv"))?;
    write_json(&file("comparison.json"), &comparison.json())?;
    csv::write_csv(&file("frames.csv"), report)?;
    write_json(&file("report.json"), &json::walk(report))
}

/// The walk's table and files as asked for, then the preset's own table.
fn print(preset: &Preset, report: &WalkReport, options: &Options, out: &Path) -> Result<()> {
    walk::print(report, options)?;
    if !options.quiet && !options.reports_to_stdout() {
        say!("\n{}\nGraphs, pictures and tables: {}", Comparison { preset, report }.text(), out.display());
    }
    Ok(())
}
