//! The frames one by one, as comma-separated values: one row a method and frame, for spreadsheets
//! and plotting programs.
//!
//! The first row names the columns. Times are in milliseconds, counts whole; what was not measured
//! is an empty cell, a yes or no is 1 or 0. Figures are written so that they read back as the same
//! `f64`.

use std::io;

use super::report::{FrameRecord, WalkReport};
use super::report_target::Target;
use crate::error::Result;

/// A column of a frame: its name and what stands in it.
type Column = (&'static str, fn(&FrameRecord) -> String);

/// The columns after `method`, `parameters` and `frame`, left to right.
const COLUMNS: [Column; 25] = [
    ("frame_ms", |frame| frame.frame_ms.to_string()),
    ("select_ms", |frame| frame.stage_ms.select.to_string()),
    ("occluders_ms", |frame| frame.stage_ms.occluders.to_string()),
    ("pyramid_ms", |frame| frame.stage_ms.pyramid.to_string()),
    ("cull_ms", |frame| frame.stage_ms.cull.to_string()),
    ("draw_ms", |frame| frame.stage_ms.draw.to_string()),
    ("objects_in_frustum", |frame| frame.objects_in_frustum.to_string()),
    ("objects_drawn", |frame| frame.objects_drawn.to_string()),
    ("objects_visible_exact", |frame| known(frame.objects_visible_exact)),
    ("triangles_after_lod", |frame| frame.triangles_after_lod.to_string()),
    ("triangles_in_frustum", |frame| frame.triangles_in_frustum.to_string()),
    ("triangles_drawn", |frame| frame.triangles_drawn.to_string()),
    ("triangles_visible_exact", |frame| known(frame.triangles_visible_exact)),
    ("fragments", |frame| frame.fragments.to_string()),
    ("queries", |frame| frame.queries.to_string()),
    ("bypassed", |frame| u8::from(frame.bypassed).to_string()),
    ("wrongly_culled_objects", |frame| known(frame.wrongly_culled)),
    ("wrong_pixels", |frame| known(frame.wrong_pixels)),
    ("latency_ms", |frame| frame.latency_ms().to_string()),
    ("occsel_waiting_ms", |frame| known(frame.pipeline_ms.map(|times| times.select_waiting))),
    ("cull_waiting_ms", |frame| known(frame.pipeline_ms.map(|times| times.cull_waiting))),
    ("draw_waiting_ms", |frame| known(frame.pipeline_ms.map(|times| times.draw_waiting))),
    ("occluder_triangles", |frame| frame.occluder_triangles.to_string()),
    ("waited_steps", |frame| frame.waited_steps.to_string()),
    ("waited_ms", |frame| frame.waited_ms.to_string()),
];

/// Writes every frame of every run. Frames count from 0; `parameters` is `key=value,...`.
///
/// # Errors
///
/// [`crate::Error::File`] with the target and the system's reason.
pub fn write_csv(target: &Target, report: &WalkReport) -> Result<()> {
    target.write(|out| {
        let mut rows = csv::Writer::from_writer(out);
        let names = COLUMNS.iter().map(|(name, _)| *name);
        rows.write_record(["method", "parameters", "frame"].into_iter().chain(names)).map_err(io::Error::from)?;
        for run in &report.runs {
            let parameters: Vec<String> = run.parameters.iter().map(|(key, value)| format!("{key}={value}")).collect();
            let parameters = parameters.join(",");
            for (number, frame) in run.frames.iter().enumerate() {
                let mut row = vec![run.method.clone(), parameters.clone(), number.to_string()];
                row.extend(COLUMNS.iter().map(|(_, cell)| cell(frame)));
                rows.write_record(&row).map_err(io::Error::from)?;
            }
        }
        rows.flush()
    })
}

fn known(figure: Option<impl ToString>) -> String {
    figure.map(|figure| figure.to_string()).unwrap_or_default()
}
