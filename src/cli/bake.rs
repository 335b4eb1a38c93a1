//! `homcull bake`: visibility preprocessing (Zhang 1998, 7.5), into a file for `hom:select=baked`.

use std::ops::ControlFlow;
use std::time::Instant;

use glam::DVec3;
use serde_json::json;

use super::arguments::{BakeArguments, Options};
use super::{files, progress, setting};
use crate::error::{Error, Result};
use crate::measure::bake::{BakeOptions, BakeSummary, bake, default_near, scene_box};
use crate::measure::json::write_json;
use crate::measure::preset::view_points;
use crate::measure::report_number::grouped;
use crate::scene;
use crate::select::ViewGrid;

/// Bakes, with a progress bar.
pub fn run(argument: &str, arguments: &BakeArguments, options: &Options) -> Result<()> {
    let out =
        options.out.as_deref().ok_or_else(|| Error::parameter("out", "", "bake needs a file to write: --out FILE"))?;
    if out.is_dir() {
        return Err(Error::file(out, "is a folder; bake writes a file"));
    }
    files::check_targets(options)?;
    let cells = view_points(&arguments.grid)?;
    let (least, greatest) = (corner("min", &arguments.min)?, corner("max", &arguments.max)?);
    let (level, workers) = (setting::level(options)?, setting::workers(options, setting::processors())?);
    let scene = scene::load(argument, None)?.scene;
    let whole = scene_box(&scene).unwrap_or((DVec3::ZERO, DVec3::ZERO));
    let grid = ViewGrid::new(cells, least.unwrap_or(whole.0), greatest.unwrap_or(whole.1))?;
    let near = arguments.near.unwrap_or_else(|| default_near(whole));
    let bake_options = BakeOptions { grid, side: arguments.face, near };

    let bar = progress::bar(2 * grid.points(), "bake", options.quiet);
    let start = Instant::now();
    let summary = bake(&scene, &bake_options, level, &workers, out, |steps| {
        bar.set_position(steps as u64);
        ControlFlow::Continue(())
    })?;
    bar.finish_and_clear();
    let Some(summary) = summary else { return Ok(()) };
    let seconds = start.elapsed().as_secs_f64();
    let bytes = std::fs::metadata(out).map_err(|e| Error::file(out, e))?.len();
    if let Some(target) = &options.json {
        return write_json(target, &json(argument, &bake_options, &summary, bytes, seconds));
    }
    if !options.quiet {
        print(&summary, bytes, seconds);
        say!("  file        {}", out.display());
    }
    Ok(())
}

fn json(scene: &str, options: &BakeOptions, summary: &BakeSummary, bytes: u64, seconds: f64) -> serde_json::Value {
    let (min, max) = options.grid.corners();
    json!({
        "scene": scene,
        "grid": options.grid.cells().to_array(),
        "min": min.to_array(),
        "max": max.to_array(),
        "face": options.side,
        "near": options.near,
        "points": summary.points,
        "skipped": {"enclosed": summary.enclosed, "back_sides": summary.back_sides},
        "objects_seen": summary.seen,
        "resumed_steps": summary.resumed,
        "bytes": bytes,
        "seconds": seconds,
    })
}

fn print(summary: &BakeSummary, bytes: u64, seconds: f64) {
    let skipped = summary.enclosed + summary.back_sides;
    let baked = summary.points - skipped;
    let mean = if baked > 0 { summary.seen / baked as u64 } else { 0 };
    say!("  view points {} of {} can be reached", grouped(baked as u64), grouped(summary.points as u64));
    say!(
        "  skipped     {} enclosed, {} behind back sides",
        grouped(summary.enclosed as u64),
        grouped(summary.back_sides as u64)
    );
    say!("  sees        {} objects from a point, on the mean", grouped(mean));
    say!("  took        {seconds:.1} s, {} of {} steps from the journal", summary.resumed, 2 * summary.points);
    say!("  bytes       {}", grouped(bytes));
}

/// `-10,0,2.5`.
fn corner(name: &str, text: &Option<String>) -> Result<Option<DVec3>> {
    let Some(text) = text else { return Ok(None) };
    let numbers: Option<Vec<f64>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) => Ok(Some(DVec3::new(x, y, z))),
        _ => Err(Error::parameter(name, text, "must be X,Y,Z in metres")),
    }
}
