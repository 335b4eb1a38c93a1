//! The table of a walk: one row a method, every figure that a reader compares, at most 150 columns.
//!
//! Groups without a single figure are left out: the ratios when their reference method did not
//! run, the errors without the exact reference. Method names too long for the row are numbered and
//! spelled out underneath.

use std::fmt::Write;

use super::report::{FrameRatios, MethodRun, WalkReport};
use super::report_number::{NO_FIGURE, count, digits3, grouped};
use super::table::Table;

/// The widest method name in a row; what is left of 150 columns with every group shown.
const NAME_WIDTH: usize = 15;

/// Which of the optional groups have a figure.
struct Shown {
    speedup: bool,
    ideal: bool,
    exact: bool,
}

/// The walk as text: a line on the scene, the table, and notes. Times are in milliseconds, means
/// over the frames unless the head says otherwise.
pub fn walk(report: &WalkReport) -> String {
    let any = |has: &dyn Fn(&MethodRun) -> bool| report.runs.iter().any(has);
    let shown = Shown {
        speedup: any(&|run| report.speedup_over_vfc(run).is_some()),
        ideal: any(&|run| report.time_over_ideal(run).is_some()),
        exact: any(&|run| run.wrong_pixels_percent(report.pixels()).is_some()),
    };
    let mut table = columns(&shown);
    for (number, (run, label)) in report.runs.iter().zip(report.labels()).enumerate() {
        let name = if label.chars().count() <= NAME_WIDTH {
            label
        } else {
            table.note(format!("#{} {label}", number + 1));
            let room = NAME_WIDTH.saturating_sub(4);
            format!("{} #{}", run.method.chars().take(room).collect::<String>(), number + 1)
        };
        table.row(row(report, run, name, &shown));
    }
    add_notes(report, &mut table);
    let stages: String =
        report.runs.iter().zip(report.labels()).filter_map(|(run, label)| stages(run, &label)).collect();
    format!("{}\n{table}{stages}", heading(report))
}

/// Of a composed method: what each stage left to the next one, and what it cost.
fn stages(run: &MethodRun, label: &str) -> Option<String> {
    let stages = run.stages();
    if stages.is_empty() {
        return None;
    }
    let mut table = Table::new()
        .left("stage")
        .group("left", &["objects", "tris"])
        .group("box", &["tests"])
        .group("occluder", &["tris"]);
    table = table.group("stage", &["ms"]);
    for stage in stages {
        let counts = [stage.objects_left, stage.triangles_left, stage.queries, stage.occluder_triangles].map(count);
        table.row(std::iter::once(stage.method).chain(counts).chain([digits3(stage.ms)]));
    }
    Some(format!("\n{label}, by stages:\n{table}"))
}

/// What was walked, and on what: `city: 5,210 objects, 312,524 triangles; 1280x1024, 120 frames; ...`.
pub fn heading(report: &WalkReport) -> String {
    let mut line = format!(
        "{}: {} objects, {} triangles; {}x{}, {} frames; {}, {} thread{}",
        report.scene_name,
        grouped(report.objects),
        grouped(report.triangles),
        report.width,
        report.height,
        report.frames,
        report.simd,
        report.threads,
        if report.threads == 1 { "" } else { "s" },
    );
    if report.clock_ghz > 0.0 {
        // Writing to a String cannot fail.
        let _ = write!(line, ", {:.2} GHz", report.clock_ghz);
    }
    line
}

fn columns(shown: &Shown) -> Table {
    let mut table = Table::new().left("method").group("frame ms", &["median", "p95"]);
    if shown.speedup {
        table = table.group("faster than vfc", &["mean", "ratio", "best"]);
    }
    if shown.ideal {
        table = table.group("over ideal time", &["mean", "ratio", "worst"]);
    }
    let objects: &[&str] = if shown.exact { &["drawn", "exact", "frust"] } else { &["drawn", "frust"] };
    table = table
        .group("objects", objects)
        .group("drawn", &["tris"])
        .group("box", &["tests"])
        .group("stages, ms", &["sel", "occl", "pyr", "cull", "draw"]);
    if shown.exact {
        table = table.group("wrong: px %, obj", &["mean", "max", "cull"]);
    }
    table.group("image", &["equal"])
}

fn row(report: &WalkReport, run: &MethodRun, name: String, shown: &Shown) -> Vec<String> {
    let times = run.frame_ms();
    let stages = run.stage_ms();
    let mean = run.mean(report.pixels());
    let mut cells = vec![name, digits3(times.median), digits3(times.p95)];
    if shown.speedup {
        cells.extend(ratio_cells(report.speedup_over_vfc(run)));
    }
    if shown.ideal {
        cells.extend(ratio_cells(report.time_over_ideal(run)));
    }
    cells.push(count(mean.objects_drawn));
    if shown.exact {
        cells.push(mean.objects_visible_exact.map_or_else(no_figure, count));
    }
    cells.extend([count(mean.objects_in_frustum), count(mean.triangles_drawn), count(mean.queries)]);
    cells.extend([stages.select, stages.occluders, stages.pyramid, stages.cull, stages.draw].map(stage_cell));
    if shown.exact {
        let wrong = run.wrong_pixels_percent(report.pixels());
        cells.push(wrong.map_or_else(no_figure, |wrong| percent_cell(wrong.mean)));
        cells.push(wrong.map_or_else(no_figure, |wrong| percent_cell(wrong.max)));
        cells.push(run.wrongly_culled_objects().map_or_else(no_figure, |n| count(n as f64)));
    }
    cells.push(if report.image_equals_first(run) { "yes" } else { "NO" }.to_string());
    cells
}

/// What the heads are too narrow to say.
fn add_notes(report: &WalkReport, table: &mut Table) {
    for (run, label) in report.runs.iter().zip(report.labels()) {
        match run.bypassed_frames() {
            0 => {}
            frames if run.method == "pvs" => {
                table.note(format!("{label}: no view point in reach in {frames} frames, drawn as by vfc"));
            }
            frames => table.note(format!("{label}: gave up testing in {frames} frames, nothing hidden")),
        }
        if let Some(times) = run.pipeline_ms() {
            let stages = run.stage_ms();
            let stage = |name, busy, waiting| format!("{name} {} + {}", stage_cell(busy), stage_cell(waiting));
            table.note(format!(
                "{label}: view to picture {} ms (median); at work + waiting, ms: {}, {}, {}",
                digits3(run.latency_ms().median),
                stage("OccSel", stages.select, times.select_waiting),
                stage("Cull", stages.cull, times.cull_waiting),
                stage("Draw", stages.occluders + stages.pyramid + stages.draw, times.draw_waiting),
            ));
        }
    }
    if let Some(bytes) = report.peak_memory_bytes {
        table.note(format!("peak memory: {} MiB", grouped(bytes.div_ceil(1 << 20))));
    }
    if let [first, _, ..] = &report.runs[..] {
        table.note(
            "mean: of the frames' ratios; ratio: of the mean times; exact: objects that are visible; frust: in the frustum;",
        );
        table.note(format!(
            "cull: objects culled that were visible; equal: all images bit for bit those of {}",
            first.method
        ));
    }
}

fn no_figure() -> String {
    NO_FIGURE.to_string()
}

fn ratio_cells(ratios: Option<FrameRatios>) -> [String; 3] {
    match ratios {
        Some(ratios) => [ratios.mean_of_frames, ratios.of_means, ratios.greatest_frame].map(digits3),
        None => [no_figure(), no_figure(), no_figure()],
    }
}

/// A stage's milliseconds, mostly in four characters; `0` is none at all, `0.00` very little.
fn stage_cell(ms: f64) -> String {
    if ms == 0.0 {
        "0".to_string()
    } else if ms.abs() < 0.995 {
        format!("{ms:.2}")
    } else {
        digits3(ms)
    }
}

/// A percentage in at most five characters that never shows a wrong pixel as none.
fn percent_cell(percent: f64) -> String {
    if percent > 0.0 && percent < 0.0005 {
        "<.001".to_string()
    } else if percent > 0.0 && percent < 0.1 {
        format!("{percent:.3}")
    } else {
        digits3(percent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_stay_narrow() {
        assert_eq!([0.0, 0.0001, 0.0421, 0.5, 12.34, 1234.0].map(stage_cell).join(" "), "0 0.00 0.04 0.50 12.3 1234");
        assert_eq!([0.0, 0.0001, 0.0421, 3.0, 100.0].map(percent_cell).join(" "), "0 <.001 0.042 3.00 100");
    }
}
