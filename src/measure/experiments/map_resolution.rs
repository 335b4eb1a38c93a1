//! 3.1: triangles drawn over the resolution of the occlusion map, against that of the depth: the amount of occlusion is said to
//! be more sensitive to approximations of the cumulative projection than of depth (figure 3.2).
//!
//! Both are made coarser conservatively, by the same factors. The projection: a pixel of the map counts as opaque when all its
//! samples are covered, a rectangle passes when all pixels that it touches are opaque; depth stays the no-background Z-buffer's.
//! Depth: the depth estimation buffer of as many partitions; the projection stays that of the samples. Beside them the map
//! *point-sampled* at that resolution, as in 1998: not conservative, so its error stands beside it.

use super::{
    ALL_TESTS, Axis, Bench, Cell, Column, Curve, Experiment, Findings, Panel, Place, Places, Statement, hidden_share,
    triangles_drawn, wrong_percent,
};
use crate::error::Result;
use crate::measure::report::WalkReport;
use crate::measure::report_number::digits3;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "map-resolution",
    section: "3.1, 8.2.2",
    shows: "triangles drawn over the resolution of the occlusion map, and of depth; the error of a map sampled more coarsely",
    places: Places::Scenes(&["city", "machine-room", super::PLANT]),
    frames: 8,
    run,
};

/// Pixels of the map, or partitions of the depth, each way.
const SIDES: [u32; 7] = [4, 8, 16, 32, 64, 128, 256];
/// Between these the two are compared: the thesis's map, and one that is sixteen times coarser.
const FINE: usize = 6;
const COARSE: usize = 2;
/// Error in percent of the pixels up to which a resolution "proved to be sufficient": this experiment's reading of 8.2.2.
const SUFFICIENT: f64 = 1.0;

fn run(bench: &Bench<'_>, places: &[Place]) -> Result<Findings> {
    let mut findings = Findings {
        columns: vec![
            Column::new("scene", ""),
            Column::new("coarser", ""),
            Column::new("resolution", "a side"),
            Column::new("triangles drawn", "a frame"),
            Column::new("culled", "percent of hidden"),
            Column::new("wrong pixels", "percent"),
            Column::new("wrongly culled", "objects"),
        ],
        ..Findings::default()
    };
    let mut errors = Vec::new();
    for place in places {
        let kinds = ["projection", "depth", "samples"];
        let coarser = kinds.iter().flat_map(|kind| SIDES.iter().map(move |&side| (*kind, side)));
        let methods: Vec<String> = std::iter::once(format!("hom:{ALL_TESTS}"))
            .chain(coarser.clone().map(|(kind, side)| method(place, kind, side)))
            .collect();
        let report = bench.walk(place, &methods, 1)?;
        let named = std::iter::once(("nothing", None)).chain(coarser.map(|(kind, side)| (kind, Some(side))));
        for ((kind, side), run) in named.zip(&report.runs) {
            findings.rows.push(vec![
                Cell::text(&place.scene.name),
                Cell::text(kind),
                side.map_or(Cell::Unknown, |side| Cell::Count(side.into())),
                Cell::Figure(triangles_drawn(&report, run)),
                Cell::Figure(hidden_share(&report, run)),
                Cell::Figure(wrong_percent(&report, run)),
                Cell::Count(run.wrongly_culled_objects().unwrap_or_default()),
            ]);
        }
        findings.panels.push(panel(&report));
        errors.push(error_panel(&report));
        findings.statements.push(projection_matters_more(place, &report));
        findings.statements.push(sampled_at_256(place, &report));
    }
    findings.panels.extend(errors);
    Ok(findings)
}

fn method(place: &Place, kind: &str, side: u32) -> String {
    let (width, height) = place.size();
    // At a finest level above 0 the test goes by whole pixels of the map, never by samples.
    let half = |samples: u32| samples.div_ceil(2 * side);
    match kind {
        "projection" => format!("hom:block={}x{},levels=1-,{ALL_TESTS}", half(width), half(height)),
        "depth" => format!("hom:depth=deb,deb-size={side}x{side},{ALL_TESTS}"),
        _ => format!("hom:resolution={side}x{side},{ALL_TESTS}"),
    }
}

/// The runs of a kind, after the first, in which nothing is coarser.
fn first_of(kind: usize) -> usize {
    1 + kind * SIDES.len()
}

fn panel(report: &WalkReport) -> Panel {
    let drawn = |i: usize| triangles_drawn(report, &report.runs[i]);
    let curve = |name: &str, kind: usize| {
        let points = SIDES.iter().enumerate().map(|(i, &side)| (f64::from(side), drawn(first_of(kind) + i)));
        Curve::new(name, points.collect())
    };
    let (first, last) = (f64::from(SIDES[0]), f64::from(SIDES[SIDES.len() - 1]));
    Panel {
        title: report.scene_name.clone(),
        x: Axis::doubling("resolution a side", 1.0),
        y: Axis::plain("triangles drawn a frame"),
        curves: vec![
            curve("coarser projection", 0),
            curve("coarser depth", 1),
            curve("point-sampled, not conservative", 2),
            Curve::limit("the display's samples", first, last, drawn(0)),
        ],
    }
}

fn error_panel(report: &WalkReport) -> Panel {
    let wrong = SIDES
        .iter()
        .enumerate()
        .map(|(i, &side)| (f64::from(side), wrong_percent(report, &report.runs[first_of(2) + i])));
    Panel {
        title: String::new(),
        x: Axis::doubling("resolution a side", 1.0),
        y: Axis::plain("wrong pixels, percent"),
        curves: vec![Curve::new("point-sampled, not conservative", wrong.collect())],
    }
}

fn projection_matters_more(place: &Place, report: &WalkReport) -> Statement {
    let culled = |kind: usize, side: usize| hidden_share(report, &report.runs[first_of(kind) + side]);
    let lost = |kind: usize| culled(kind, FINE) - culled(kind, COARSE);
    let (projection, depth) = (lost(0), lost(1));
    Statement {
        section: "3.1",
        claim: "the amount of occlusion is more sensitive to approximations in the cumulative projection than in depth",
        found: format!(
            "on {} to go from 256 to 16 a side loses {} percent of the hidden triangles where the projection is coarser ({} to \
             {}), {} where depth is ({} to {})",
            place.scene.name,
            digits3(projection),
            digits3(culled(0, FINE)),
            digits3(culled(0, COARSE)),
            digits3(depth),
            digits3(culled(1, FINE)),
            digits3(culled(1, COARSE)),
        ),
        holds: projection > depth,
    }
}

fn sampled_at_256(place: &Place, report: &WalkReport) -> Statement {
    let run = &report.runs[first_of(2) + FINE];
    let wrong = wrong_percent(report, run);
    Statement {
        section: "8.2.2",
        claim: "occluders rendered at 256x256 proved to be sufficient in practice",
        found: format!(
            "on {} such a map gets {} percent of the pixels wrong, and {} objects over all frames",
            place.scene.name,
            digits3(wrong),
            run.wrongly_culled_objects().unwrap_or_default(),
        ),
        holds: wrong <= SUFFICIENT,
    }
}
