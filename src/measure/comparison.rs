//! The table of the thesis's experiments: what each technique leaves of the triangles, and what that gains (Zhang 1998, 8.3, 8.4).
//!
//! One row a method: the means of the four curves of a culling graph (8.3.1), the speed-up over view-frustum culling, the time over the
//! ideal's, and the error. What the thesis says of its own speed-up stands beside it. Text, CSV and JSON say the same; what was not
//! measured is a dash, an empty cell, `null`.

use std::io;

use serde_json::{Value, json};

use super::json::hash;
use super::preset::{Claim, Preset};
use super::report::{FrameRatios, MethodRun, WalkReport};
use super::report_number::{NO_FIGURE, count, digits3};
use super::report_target::Target;
use super::table::Table;
use super::table_walk::heading;
use crate::error::Result;

/// A preset's walk beside the thesis's figures.
#[derive(Debug, Clone, Copy)]
pub struct Comparison<'a> {
    /// What was walked.
    pub preset: &'a Preset,
    /// What came of it.
    pub report: &'a WalkReport,
}

/// A method's row.
struct Row<'a> {
    name: String,
    run: &'a MethodRun,
    ms: f64,
    /// After level of detail, in the frustum, after occlusion culling, exactly visible: means of the frames.
    triangles: [Option<f64>; 4],
    speedup: Option<FrameRatios>,
    over_ideal: Option<FrameRatios>,
    wrong_percent: Option<f64>,
    wrongly_culled: Option<u64>,
    equal: bool,
}

impl<'a> Comparison<'a> {
    fn rows(&self) -> Vec<Row<'a>> {
        let report = self.report;
        let row = |(run, name): (&'a MethodRun, String)| {
            let mean = run.mean(report.pixels());
            Row {
                name,
                run,
                ms: run.frame_ms().total / run.frames.len().max(1) as f64,
                triangles: [
                    Some(mean.triangles_after_lod),
                    Some(mean.triangles_in_frustum),
                    Some(mean.triangles_drawn),
                    mean.triangles_visible_exact,
                ],
                speedup: report.speedup_over_vfc(run),
                over_ideal: report.time_over_ideal(run),
                wrong_percent: run.wrong_pixels_percent(report.pixels()).map(|wrong| wrong.mean),
                wrongly_culled: run.wrongly_culled_objects(),
                equal: report.image_equals_first(run),
            }
        };
        report.runs.iter().zip(report.labels()).map(row).collect()
    }

    /// The table as text.
    pub fn text(&self) -> String {
        let mut table = Table::new()
            .left("method")
            .group("triangles left, mean of the frames", &["LOD", "frustum", "occlusion", "visible"])
            .group("mean", &["ms"])
            .group("faster than vfc", &["mean", "ratio", "best"])
            .group("over ideal time", &["mean", "ratio", "worst"])
            .group("wrong", &["pixels %", "objects"])
            .group("image", &["equal"]);
        for row in self.rows() {
            table.row(row.cells());
        }
        for line in self.beside_the_thesis() {
            table.note(line);
        }
        let Preset { name, section, .. } = self.preset;
        format!("{name}, after section {section} of the thesis\n{}\n{table}", heading(self.report))
    }

    /// The thesis's words, and what came of it here.
    fn beside_the_thesis(&self) -> Vec<String> {
        let Preset { section, claim, .. } = self.preset;
        let mut lines = vec![
            "LOD: all of the model, since there is one level; mean: of the frames' ratios; ratio: of the mean times"
                .to_owned(),
            "hom: the map from the display's samples, thresholds of 1, conservative; hom-1998: 256x256 point samples and the thesis's \
             thresholds, not conservative".to_owned(),
            format!("thesis, {section}: {} over view-frustum culling", claim.text),
        ];
        let culls =
            |row: &&Row<'_>| ![super::report::BASELINE, super::report::IDEAL].contains(&row.run.method.as_str());
        for row in self.rows().iter().filter(culls) {
            let Some(speedup) = row.speedup else { continue };
            lines.push(format!("here, {}: {}", row.name, speedups(claim, &speedup, row.least_speedup(self.report))));
        }
        let ideal = self.report.runs.iter().find(|run| run.method == super::report::IDEAL);
        if let Some(best) = ideal.and_then(|run| self.report.speedup_over_vfc(run)) {
            lines.push(format!(
                "the ideal, which draws what is visible and decides nothing, gains {} in the mean and {} at best: the bound for any method here",
                digits3(best.of_means),
                digits3(best.greatest_frame)
            ));
        }
        lines
    }

    /// The table as comma-separated values.
    ///
    /// # Errors
    /// [`crate::Error::File`] with the target and the system's reason.
    pub fn write_csv(&self, target: &Target) -> Result<()> {
        target.write(|out| {
            let mut rows = csv::Writer::from_writer(out);
            rows.write_record(COLUMNS).map_err(io::Error::from)?;
            for row in self.rows() {
                rows.write_record(row.values(self.preset)).map_err(io::Error::from)?;
            }
            rows.flush()
        })
    }

    /// The table as JSON, field by field as its CSV.
    pub fn json(&self) -> Value {
        let rows: Vec<Value> = self.rows().iter().map(Row::json).collect();
        let Preset { name, section, claim, .. } = self.preset;
        json!({
            "preset": name,
            "section": section,
            "scene": {
                "name": self.report.scene_name,
                "objects": self.report.objects,
                "triangles": self.report.triangles,
            },
            "view": {"width": self.report.width, "height": self.report.height, "frames": self.report.frames},
            "thesis": {
                "text": claim.text,
                "speedup_over_vfc": {"mean": claim.mean, "least_frame": claim.least, "best_frame": claim.best},
            },
            "rows": rows,
        })
    }
}

/// The figures that the thesis's claim is about: its mean, its best frame, its least.
fn speedups(claim: &Claim, speedup: &FrameRatios, least: f64) -> String {
    let mut parts = Vec::new();
    if claim.mean.is_some() {
        parts.push(format!("{} in the mean", digits3(speedup.of_means)));
    }
    if claim.least.is_some() {
        parts.push(format!("{} at least", digits3(least)));
    }
    if claim.best.is_some() {
        parts.push(format!("{} at best", digits3(speedup.greatest_frame)));
    }
    parts.join(", ")
}

const COLUMNS: [&str; 20] = [
    "name",
    "method",
    "mean_ms",
    "triangles_after_lod",
    "triangles_in_frustum",
    "triangles_drawn",
    "triangles_visible_exact",
    "speedup_mean_of_frames",
    "speedup_of_means",
    "speedup_best_frame",
    "thesis_speedup_mean",
    "thesis_speedup_least_frame",
    "thesis_speedup_best_frame",
    "over_ideal_mean_of_frames",
    "over_ideal_of_means",
    "over_ideal_worst_frame",
    "wrong_pixels_percent",
    "wrongly_culled_objects",
    "image_equal",
    "image_hash",
];

impl Row<'_> {
    fn cells(&self) -> Vec<String> {
        let figure = |value: Option<f64>| value.map_or_else(|| NO_FIGURE.to_owned(), digits3);
        let mut cells = vec![self.name.clone()];
        cells.extend(self.triangles.map(|n| n.map_or_else(|| NO_FIGURE.to_owned(), count)));
        cells.push(digits3(self.ms));
        cells.extend(three(self.speedup).map(figure));
        cells.extend(three(self.over_ideal).map(figure));
        cells.push(figure(self.wrong_percent));
        cells.push(self.wrongly_culled.map_or_else(|| NO_FIGURE.to_owned(), |n| n.to_string()));
        cells.push(if self.equal { "yes" } else { "NO" }.to_owned());
        cells
    }

    fn values(&self, preset: &Preset) -> Vec<String> {
        let figure = |value: Option<f64>| value.map(|value| value.to_string()).unwrap_or_default();
        let thesis = self.run.method.starts_with("hom").then_some(preset.claim);
        let mut values = vec![self.name.clone(), self.run.full_name(), self.ms.to_string()];
        values.extend(self.triangles.map(figure));
        values.extend(three(self.speedup).map(figure));
        values.extend(thesis.map_or([None; 3], |claim| [claim.mean, claim.least, claim.best]).map(figure));
        values.extend(three(self.over_ideal).map(figure));
        values.push(figure(self.wrong_percent));
        values.push(self.wrongly_culled.map(|n| n.to_string()).unwrap_or_default());
        values.push(u8::from(self.equal).to_string());
        values.push(hash(self.run.image_hash));
        values
    }

    fn json(&self) -> Value {
        let ratios = |ratios: Option<FrameRatios>, greatest: &str| {
            ratios.map(
                |r| json!({"mean_of_frames": r.mean_of_frames, "of_means": r.of_means, greatest: r.greatest_frame}),
            )
        };
        json!({
            "name": self.name,
            "method": self.run.full_name(),
            "mean_ms": self.ms,
            "triangles_after_lod": self.triangles[0],
            "triangles_in_frustum": self.triangles[1],
            "triangles_drawn": self.triangles[2],
            "triangles_visible_exact": self.triangles[3],
            "speedup_over_vfc": ratios(self.speedup, "best_frame"),
            "time_over_ideal": ratios(self.over_ideal, "worst_frame"),
            "wrong_pixels_percent": self.wrong_percent,
            "wrongly_culled_objects": self.wrongly_culled,
            "image_equal": self.equal,
            "image_hash": hash(self.run.image_hash),
        })
    }

    /// The frame that gained least over view-frustum culling.
    fn least_speedup(&self, report: &WalkReport) -> f64 {
        let baseline = report.runs.iter().find(|run| run.method == super::report::BASELINE);
        let pairs = baseline.into_iter().flat_map(|vfc| vfc.frames.iter().zip(&self.run.frames));
        pairs.map(|(vfc, own)| vfc.frame_ms / own.frame_ms).fold(f64::INFINITY, f64::min)
    }
}

fn three(ratios: Option<FrameRatios>) -> [Option<f64>; 3] {
    ratios.map_or([None; 3], |r| [r.mean_of_frames, r.of_means, r.greatest_frame].map(Some))
}
