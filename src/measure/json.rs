//! The machine-readable report: JSON with stable field names.
//!
//! Field names and units are a promise to whoever reads them by program: times in milliseconds,
//! ratios plain, percent only where the name says so. What was not measured is `null`, never zero:
//! the exact figures without the exact reference, the ratios without the method they are against.
//! The peak memory alone is left out where the system does not tell it.
//! Hashes are strings of 16 hexadecimal digits, because JSON's numbers end at 53 bits.

use serde_json::{Map, Value, json};

use super::report::{FrameRatios, MethodRun, StageCounts, WalkReport};
use super::report_target::Target;
use crate::error::Result;

/// The walk as `walk --json` prints it.
pub fn walk(report: &WalkReport) -> Value {
    let runs: Vec<Value> = report.runs.iter().map(|run| method_run(report, run)).collect();
    let mut value = json!({
        "scene": {
            "name": report.scene_name,
            "objects": report.objects,
            "triangles": report.triangles,
        },
        "view": {"width": report.width, "height": report.height, "frames": report.frames},
        "machine": {
            "simd": report.simd,
            "threads": report.threads,
            "clock_ghz": report.clock_ghz,
        },
        "runs": runs,
    });
    if let Some(bytes) = report.peak_memory_bytes {
        value["machine"]["peak_memory_bytes"] = json!(bytes);
    }
    value
}

fn method_run(report: &WalkReport, run: &MethodRun) -> Value {
    let parameters: Map<String, Value> =
        run.parameters.iter().map(|(key, value)| (key.clone(), json!(value))).collect();
    let times = run.frame_ms();
    let stages = run.stage_ms();
    let mut value = json!({
        "method": run.method,
        "parameters": parameters,
        "frame_ms": {
            "median": times.median,
            "p95": times.p95,
            "min": times.min,
            "max": times.max,
            "total": times.total,
        },
        "latency_ms": latency(run),
        "stage_ms": {
            "select": stages.select,
            "occluders": stages.occluders,
            "pyramid": stages.pyramid,
            "cull": stages.cull,
            "draw": stages.draw,
        },
        "pipeline_ms": pipeline(run),
        "mean": mean(report, run),
        "bypassed_frames": run.bypassed_frames(),
        "wrongly_culled_objects": run.wrongly_culled_objects(),
        "wrong_pixels_percent": run
            .wrong_pixels_percent(report.pixels())
            .map(|wrong| json!({"mean": wrong.mean, "max": wrong.max})),
        "speedup_over_vfc": ratios(report.speedup_over_vfc(run), "best_frame"),
        "time_over_ideal": ratios(report.time_over_ideal(run), "worst_frame"),
        "image_hash": hash(run.image_hash),
        "visible_set_hash": hash(run.visible_set_hash),
    });
    if let Some(name) = &run.name {
        value["name"] = json!(name);
    }
    let stages: Vec<Value> = run.stages().iter().map(stage).collect();
    if !stages.is_empty() {
        value["stages"] = json!(stages);
    }
    if let (false, Some(fields)) = (run.overlap.is_empty(), value.as_object_mut()) {
        let tests = json!({"passed_at_level": run.overlap.passed, "failed_at_level": run.overlap.failed});
        fields.insert("overlap_tests".into(), tests);
    }
    value
}

/// A stage of a composed method.
fn stage(stage: &StageCounts) -> Value {
    json!({
        "method": stage.method,
        "objects_left": stage.objects_left,
        "triangles_left": stage.triangles_left,
        "queries": stage.queries,
        "occluder_triangles": stage.occluder_triangles,
        "ms": stage.ms,
    })
}

/// From view to picture; in turn, the frame's time.
fn latency(run: &MethodRun) -> Value {
    let times = run.latency_ms();
    json!({"median": times.median, "p95": times.p95, "min": times.min, "max": times.max})
}

/// Where the mean frame's time went on each thread of the pipeline; null for what was drawn in turn.
fn pipeline(run: &MethodRun) -> Value {
    let stages = run.stage_ms();
    let stage = |busy: f64, waiting: f64| json!({"busy": busy, "waiting": waiting});
    run.pipeline_ms().map_or(Value::Null, |times| {
        json!({
            "occsel": stage(stages.select, times.select_waiting),
            "cull": stage(stages.cull, times.cull_waiting),
            "draw": stage(stages.occluders + stages.pyramid + stages.draw, times.draw_waiting),
        })
    })
}

fn mean(report: &WalkReport, run: &MethodRun) -> Value {
    let mean = run.mean(report.pixels());
    json!({
        "objects_in_frustum": mean.objects_in_frustum,
        "objects_drawn": mean.objects_drawn,
        "objects_visible_exact": mean.objects_visible_exact,
        "triangles_after_lod": mean.triangles_after_lod,
        "triangles_in_frustum": mean.triangles_in_frustum,
        "triangles_drawn": mean.triangles_drawn,
        "triangles_visible_exact": mean.triangles_visible_exact,
        "depth_complexity": mean.depth_complexity,
        "occluder_triangles": mean.occluder_triangles,
        "queries": mean.queries,
        "waited_steps": mean.waited_steps,
        "waited_ms": mean.waited_ms,
    })
}

fn ratios(ratios: Option<FrameRatios>, greatest: &str) -> Value {
    ratios.map_or(Value::Null, |ratios| {
        json!({
            "mean_of_frames": ratios.mean_of_frames,
            "of_means": ratios.of_means,
            greatest: ratios.greatest_frame,
        })
    })
}

/// A hash as reports write it: 16 hexadecimal digits.
pub fn hash(hash: u64) -> String {
    format!("{hash:016x}")
}

/// Writes `value`, indented, with a line end.
///
/// # Errors
///
/// [`crate::Error::File`] with the target and the system's reason.
pub fn write_json(target: &Target, value: &Value) -> Result<()> {
    target.write(|out| {
        serde_json::to_writer_pretty(&mut *out, value)?;
        out.write_all(b"\n")
    })
}
