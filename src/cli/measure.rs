//! `homcull measure`: the kernels alone.

use std::path::Path;
use std::time::Instant;

use serde_json::{Value, json};

use super::arguments::{Depth, Kernel, Options};
use super::{progress, setting};
use crate::error::Result;
use crate::measure::json::write_json;
use crate::measure::kernels::{Agreement, Difference, KernelBench, KernelOptions, NORMAL_GHZ, Times, Verdicts};
use crate::measure::statistics::median;
use crate::occlusion::{DepthReading, DepthRepresentation, Partitions};
use crate::scene::{PreparedScene, load_reference};

/// Repetitions of each view, of which the fastest counts.
const REPETITIONS: usize = 5;

/// Measures a kernel and prints or writes what it found.
pub fn run(kernel: Kernel, scene: &str, cluster_test: bool, depth: Depth, options: &Options) -> Result<()> {
    let level = setting::level(options)?;
    let workers = setting::workers(options, 1)?;
    let loaded = setting::load(scene, options, true)?;
    let start = Instant::now();
    let prepared = PreparedScene::new(&loaded.scene)?;
    let prepare_ms = start.elapsed().as_secs_f64() * 1e3;
    let viewport = loaded.viewport;
    let folder = Path::new(scene);
    let whole = folder.is_dir() && options.frames.is_none() && options.path.is_none();
    let reference = if whole {
        load_reference(folder, viewport.width(), viewport.height(), loaded.scene.objects.len(), loaded.views.len())?
    } else {
        None
    };
    let kernel_options = KernelOptions {
        level,
        repetitions: options.repetitions.map_or(REPETITIONS, |n| n as usize),
        cluster_test,
        depth: match depth {
            Depth::Nbz => DepthRepresentation::NoBackground(DepthReading::PerSample),
            Depth::NbzBlock => DepthRepresentation::NoBackground(DepthReading::PerBlock),
            Depth::Deb => DepthRepresentation::Estimation(Partitions::default()),
            Depth::Plane => DepthRepresentation::Plane,
        },
        keep_depth: true,
    };
    let bar = progress::bar(loaded.views.len(), "measure", options.quiet);
    let step = |n: usize| bar.set_position(n as u64);
    let mut bench = KernelBench::new(&prepared, &loaded.views, reference.as_ref(), viewport, &workers, kernel_options)?;
    let mut value = match kernel {
        Kernel::Raster => raster(&mut bench, cluster_test, step)?,
        Kernel::Query => query(&mut bench, step)?,
        Kernel::Progressive => progressive(&mut bench, step)?,
        Kernel::Pyramid => pyramid(&mut bench, step)?,
    };
    bar.finish_and_clear();
    let about = json!({
        "scene": scene, "views": loaded.views.len(), "width": viewport.width(), "height": viewport.height(),
        "simd": level.name(), "threads": workers.threads(), "repetitions": kernel_options.repetitions,
        "prepare_ms": prepare_ms,
    });
    if let (Some(map), Value::Object(about)) = (value.as_object_mut(), about) {
        map.extend(about);
    }
    match &options.json {
        Some(target) => write_json(target, &value),
        None if options.quiet => Ok(()),
        None => {
            say!("{}", serde_json::to_string_pretty(&value).unwrap_or_default());
            Ok(())
        }
    }
}

fn raster(bench: &mut KernelBench<'_>, cluster_test: bool, step: impl FnMut(usize)) -> Result<Value> {
    let report = bench.raster(step)?;
    let total: f64 = report.times.ms.iter().sum();
    Ok(json!({
        "kernel": "raster",
        "mode": "coverage+depth",
        "cluster_test": cluster_test,
        "triangles_in_frustum": report.triangles,
        "ms_per_frame": frame_ms(&report.times),
        "normalized": normalized(&report.times),
        "mtriangles_per_s": report.triangles as f64 / total / 1e3,
        "clock_ghz": clock(&report.times),
    }))
}

fn query(bench: &mut KernelBench<'_>, step: impl FnMut(usize)) -> Result<Value> {
    let report = bench.query(step)?;
    let per_query = |ms: &[f64]| ms.iter().sum::<f64>() * 1e6 / report.verdicts.queries.max(1) as f64;
    let mut value = json!({
        "kernel": "query",
        "ns_per_query": per_query(&report.times.ms),
        "normalized": {"clock_ghz": NORMAL_GHZ, "ns_per_query": per_query(&report.times.normalized_ms)},
        "clock_ghz": clock(&report.times),
    });
    add_verdicts(&mut value, &report.verdicts);
    Ok(value)
}

fn progressive(bench: &mut KernelBench<'_>, step: impl FnMut(usize)) -> Result<Value> {
    let report = bench.progressive(step)?;
    let mut value = json!({
        "kernel": "progressive",
        "round": 1,
        "ms_per_frame": frame_ms(&report.times),
        "normalized": normalized(&report.times),
        "objects_visible": report.verdicts.visible,
        "objects_occluded": report.verdicts.occluded,
        "clock_ghz": clock(&report.times),
    });
    add_verdicts(&mut value, &report.verdicts);
    Ok(value)
}

fn pyramid(bench: &mut KernelBench<'_>, step: impl FnMut(usize)) -> Result<Value> {
    let report = bench.pyramid(step)?;
    Ok(json!({
        "kernel": "pyramid",
        "ms_per_build": report.times.median(),
        "normalized": {"clock_ghz": NORMAL_GHZ, "ms_per_build": median(&report.times.normalized_ms)},
        "bytes": report.bytes,
        "updates": report.updates,
        "changed_tiles_per_update": report.changed_tiles as f64 / report.updates.max(1) as f64,
        "ms_per_update": report.update_ms / report.updates.max(1) as f64,
        "clock_ghz": clock(&report.times),
    }))
}

fn frame_ms(times: &Times) -> Value {
    json!({"median": times.median(), "min": times.min()})
}

fn normalized(times: &Times) -> Value {
    let min = times.normalized_ms.iter().copied().fold(f64::INFINITY, f64::min);
    json!({"clock_ghz": NORMAL_GHZ, "ms_per_frame": {"median": median(&times.normalized_ms), "min": min}})
}

fn clock(times: &Times) -> Option<f64> {
    median(&times.clock_ghz)
}

fn add_verdicts(value: &mut Value, v: &Verdicts) {
    let agreement = |a: &Agreement| {
        json!({
            "false_occluded": a.false_occluded,
            "false_occluded_over_2_pixels": a.false_occluded_over_2_pixels,
            "missed_occluded": a.missed_occluded,
        })
    };
    let Some(map) = value.as_object_mut() else { return };
    map.insert("queries".into(), v.queries.into());
    map.insert("visible".into(), v.visible.into());
    map.insert("occluded".into(), v.occluded.into());
    map.insert("false_occluded".into(), v.own.false_occluded.into());
    map.insert("missed_occluded".into(), v.own.missed_occluded.into());
    map.insert("state_hash".into(), format!("{:016x}", v.hash.value()).into());
    let Some(brought) = &v.brought else { return };
    map.insert("brought".into(), agreement(brought));
    let listed: Vec<Value> =
        v.brought_false.iter().map(|f| json!({"view": f.view, "object": f.object, "pixels": f.pixels})).collect();
    map.insert("brought_false_list".into(), listed.into());
    let pair = |d: &Difference| json!({"view": d.view, "object": d.object, "own": d.own, "brought": d.brought});
    let listed: Vec<Value> = v.references_differ.iter().map(pair).collect();
    let percent = 100.0 * listed.len() as f64 / v.visible_pairs.max(1) as f64;
    map.insert(
        "references".into(),
        json!({"differ": listed.len(), "visible_pairs": v.visible_pairs, "percent": percent, "list": listed}),
    );
}
