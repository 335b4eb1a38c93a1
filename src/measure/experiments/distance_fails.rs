//! 7.3.2 and figure 7.3: where distance-based selection fails, and what mends it.
//!
//! The limit is used up by the near objects before the good occluders, relatively far away, are reached. Temporal coherence (7.4) leaves
//! out the near ones that were hidden, a bake (7.5) takes what shows most first, static selection (7.1) strikes out bad
//! occluders beforehand, progressive culling (2.1.4) needs no choice.

use std::ops::ControlFlow;

use glam::{DVec3, UVec3};

use super::{
    ALL_TESTS, Axis, Bench, Cell, Column, Curve, Experiment, Findings, Panel, Place, Places, Statement, figure_7_3,
    hidden_share, triangles_drawn,
};
use crate::cull::{HomParameters, Method, Selection};
use crate::error::Result;
use crate::measure::bake::{BakeOptions, bake, default_near, scene_box};
use crate::measure::report::WalkReport;
use crate::measure::report_number::{count, digits3, grouped};
use crate::select::ViewGrid;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "distance-fails",
    section: "7.3.2, figure 7.3",
    shows: "a scene where selection by distance takes redundant near occluders, and what mends it",
    places: Places::Built("figure-7.3", figure_7_3::build),
    frames: 24,
    run,
};

/// Occluder limits, in triangles.
const LIMITS: [u64; 7] = [1_000, 2_000, 4_000, 8_000, 16_000, 32_000, 64_000];
/// The limit of the statements.
const JUDGED: usize = 3;
/// Selections, by how they are written.
const SELECTIONS: [(&str, &str); 4] =
    [("distance", "select=distance"), ("temporal", "select=temporal"), ("static", "database=static"), ("baked", "")];
/// Distance fails where it leaves so many times the triangles that progressive culling leaves.
const FAILS: f64 = 2.0;
/// What mends it saves so many percent of what progressive culling saves.
const MENDS: f64 = 90.0;
/// View points along each axis of the box that the eyes are in, and samples of a cube's face.
const POINTS: u32 = 4;
const FACE: u32 = 128;

fn run(bench: &Bench<'_>, places: &[Place]) -> Result<Findings> {
    let mut findings = Findings {
        columns: vec![
            Column::new("scene", ""),
            Column::new("selection", ""),
            Column::new("limit", "triangles"),
            Column::new("triangles drawn", "a frame"),
            Column::new("culled", "percent of hidden"),
            Column::new("wrong pixels", "percent"),
        ],
        ..Findings::default()
    };
    for place in places {
        let methods = methods(bench, place)?;
        let report = bench.walk_methods(place, &methods, 1)?;
        let names = SELECTIONS.iter().flat_map(|(name, _)| LIMITS.map(|limit| (*name, Some(limit))));
        for ((name, limit), run) in names.chain([("progressive", None), ("vfc", None)]).zip(&report.runs) {
            findings.rows.push(vec![
                Cell::text(&place.scene.name),
                Cell::text(name),
                limit.map_or(Cell::Unknown, Cell::Count),
                Cell::Figure(triangles_drawn(&report, run)),
                Cell::Figure(hidden_share(&report, run)),
                Cell::Figure(super::wrong_percent(&report, run)),
            ]);
        }
        findings.panels.push(over_limits(&report));
        findings.panels.push(over_frames(&report));
        findings.statements.extend(statements(place, &report));
    }
    Ok(findings)
}

/// All selections under all limits, then progressive culling, and view-frustum culling alone.
fn methods(bench: &Bench<'_>, place: &Place) -> Result<Vec<Method>> {
    let baked = bake_eyes(bench, place)?;
    let mut methods = Vec::new();
    for (name, written) in SELECTIONS {
        for limit in LIMITS {
            methods.push(match name {
                "baked" => Method::Hom(HomParameters { occluder_triangles: limit, ..baked.clone() }),
                _ => Method::parse(&format!("hom:{written},occluder-triangles={limit},{ALL_TESTS}"))?,
            });
        }
    }
    methods.push(Method::parse(&format!("hom-progressive:{ALL_TESTS}"))?);
    methods.push(Method::parse("vfc")?);
    Ok(methods)
}

/// Bakes a grid in the box that the eyes are in, into a file beside the result.
fn bake_eyes(bench: &Bench<'_>, place: &Place) -> Result<HomParameters> {
    let eyes = || place.views.iter().map(|view| view.eye());
    let least = eyes().fold(DVec3::INFINITY, DVec3::min);
    let greatest = eyes().fold(DVec3::NEG_INFINITY, DVec3::max);
    let points = |axis: usize| if greatest[axis] > least[axis] { POINTS } else { 1 };
    let grid = ViewGrid::new(UVec3::new(points(0), points(1), points(2)), least, greatest)?;
    let near = default_near(scene_box(&place.scene).unwrap_or((least, greatest)));
    let file = bench.out.join(format!("experiment-{}.bake", EXPERIMENT.name));
    let options = BakeOptions { grid, side: FACE, near };
    bake(&place.scene, &options, bench.level, bench.workers, &file, |_| ControlFlow::Continue(()))?;
    let plain = HomParameters::new(crate::cull::Update::Once);
    Ok(HomParameters { select: Selection::Baked, bake: Some(file), bypass_after: u32::MAX, rest: 0, ..plain })
}

fn drawn(report: &WalkReport, selection: usize, limit: usize) -> f64 {
    triangles_drawn(report, &report.runs[selection * LIMITS.len() + limit])
}

fn progressive(report: &WalkReport) -> f64 {
    triangles_drawn(report, &report.runs[SELECTIONS.len() * LIMITS.len()])
}

fn over_limits(report: &WalkReport) -> Panel {
    let (first, last) = (LIMITS[0] as f64, LIMITS[LIMITS.len() - 1] as f64);
    let curve = |(selection, (name, _)): (usize, &(&str, &str))| {
        let points = LIMITS.iter().enumerate().map(|(i, &limit)| (limit as f64, drawn(report, selection, i)));
        Curve::new(*name, points.collect())
    };
    let mut curves: Vec<Curve> = SELECTIONS.iter().enumerate().map(curve).collect();
    let level = progressive(report);
    curves.push(Curve::new("progressive", vec![(first, level), (last, level)]));
    let vfc = report.runs.last().map_or(f64::NAN, |run| triangles_drawn(report, run));
    curves.push(Curve::limit("view-frustum culling alone", first, last, vfc));
    Panel {
        title: format!("{}, mean of the frames", report.scene_name),
        x: Axis::doubling("occluder limit, triangles", 1000.0),
        y: Axis::plain("triangles drawn a frame"),
        curves,
    }
}

fn over_frames(report: &WalkReport) -> Panel {
    let curve = |name: &str, run: usize| {
        let frames = report.runs[run].frames.iter().enumerate();
        Curve::new(name, frames.map(|(frame, record)| (frame as f64, record.triangles_drawn as f64)).collect())
    };
    let mut curves: Vec<Curve> =
        SELECTIONS.iter().enumerate().map(|(s, (name, _))| curve(name, s * LIMITS.len() + JUDGED)).collect();
    curves.push(curve("progressive", SELECTIONS.len() * LIMITS.len()));
    Panel {
        title: format!("with a limit of {}", grouped(LIMITS[JUDGED])),
        x: Axis::plain("frame"),
        y: Axis::plain("triangles drawn"),
        curves,
    }
}

fn statements(place: &Place, report: &WalkReport) -> [Statement; 2] {
    let best = progressive(report);
    let at = |selection: usize| drawn(report, selection, JUDGED);
    let saved = |selection: usize| 100.0 * (at(0) - at(selection)) / (at(0) - best);
    let selections = || SELECTIONS.iter().enumerate().skip(1);
    let mending: Vec<&str> = selections().filter(|(s, _)| saved(*s) >= MENDS).map(|(_, (name, _))| *name).collect();
    let figures: Vec<String> = selections()
        .map(|(s, (name, _))| format!("{name} leaves {} ({} percent)", count(at(s)), digits3(saved(s))))
        .collect();
    let limit = grouped(LIMITS[JUDGED]);
    [
        Statement {
            section: "7.3.2",
            claim: "selection by distance exceeds its limit before good occluders that are relatively far away, and what these hide is drawn",
            found: format!(
                "on {}, under a limit of {limit}, it leaves {} triangles, where progressive culling leaves {}",
                place.scene.name,
                count(at(0)),
                count(best)
            ),
            holds: at(0) >= FAILS * best,
        },
        Statement {
            section: "7.4, 7.5",
            claim: "temporal coherence and visibility preprocessing improve the selection",
            found: format!("under the same limit, of what progressive culling saves, {}", figures.join(", "),),
            holds: ["temporal", "baked"].iter().all(|name| mending.contains(name)),
        },
    ]
}
