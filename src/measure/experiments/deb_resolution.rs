//! 6.3.3: triangles drawn over the resolution of the depth estimation buffer, 1x1 to 256x256; the single plane, which is its
//! 1x1, and the no-background Z-buffer beside it. Occluders as on the thesis's city (8.4.1): 5,000 triangles by distance.

use super::{
    ALL_TESTS, Axis, Bench, Cell, Column, Curve, Experiment, Findings, Panel, Place, Places, Statement, hidden_share,
    triangles_drawn,
};
use crate::error::Result;
use crate::measure::report::WalkReport;
use crate::measure::report_number::{count, digits3};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "deb-resolution",
    section: "6.3.3",
    shows: "triangles drawn over the resolution of the depth estimation buffer, 1 to 256",
    places: Places::Scenes(&["city", "machine-room", super::PLANT]),
    frames: 16,
    run,
};

/// Partitions each way.
const SIDES: [u32; 9] = [1, 2, 4, 8, 16, 32, 64, 128, 256];
/// The thesis's own.
const CHOSEN: u32 = 64;
/// Percent of the hidden triangles that more partitions may still bring where the thesis says that they bring nothing.
const NOTHING: f64 = 1.0;

fn run(bench: &Bench<'_>, places: &[Place]) -> Result<Findings> {
    let mut findings = Findings {
        columns: vec![
            Column::new("scene", ""),
            Column::new("depth", ""),
            Column::new("partitions", "a side"),
            Column::new("triangles drawn", "a frame"),
            Column::new("culled", "percent of hidden"),
            Column::new("wrong pixels", "percent"),
        ],
        ..Findings::default()
    };
    for place in places {
        let depths = SIDES.iter().map(|side| format!("depth=deb,deb-size={side}x{side}"));
        let depths = depths.chain(["depth=plane".into(), "depth=nbz".into()]);
        let methods: Vec<String> =
            depths.map(|depth| format!("hom:{depth},occluder-triangles=5000,{ALL_TESTS}")).collect();
        let report = bench.walk(place, &methods, 1)?;
        add_rows(&mut findings, place, &report);
        findings.panels.push(panel(&report));
        findings.statements.push(enough(place, &report));
    }
    Ok(findings)
}

fn add_rows(findings: &mut Findings, place: &Place, report: &WalkReport) {
    let names = SIDES.iter().map(|&side| ("deb", Some(side))).chain([("plane", None), ("nbz", None)]);
    for ((depth, side), run) in names.zip(&report.runs) {
        findings.rows.push(vec![
            Cell::text(&place.scene.name),
            Cell::text(depth),
            side.map_or(Cell::Unknown, |side| Cell::Count(side.into())),
            Cell::Figure(triangles_drawn(report, run)),
            Cell::Figure(hidden_share(report, run)),
            Cell::Figure(super::wrong_percent(report, run)),
        ]);
    }
}

fn panel(report: &WalkReport) -> Panel {
    let drawn: Vec<f64> = report.runs.iter().map(|run| triangles_drawn(report, run)).collect();
    let (first, last) = (f64::from(SIDES[0]), f64::from(SIDES[SIDES.len() - 1]));
    let mean = report.runs[0].mean(report.pixels());
    let across = |name: &str, level: f64| Curve::new(name, vec![(first, level), (last, level)]);
    Panel {
        title: report.scene_name.clone(),
        x: Axis::doubling("partitions a side", 1.0),
        y: Axis::plain("triangles drawn a frame"),
        curves: vec![
            Curve::new("depth estimation buffer", SIDES.iter().map(|&s| f64::from(s)).zip(drawn.clone()).collect()),
            Curve::limit("no-background Z-buffer", first, last, drawn[SIDES.len() + 1]),
            across("in the frustum", mean.triangles_in_frustum),
            across("exactly visible", mean.triangles_visible_exact.unwrap_or(f64::NAN)),
        ],
    }
}

fn enough(place: &Place, report: &WalkReport) -> Statement {
    let chosen = SIDES.iter().position(|&side| side == CHOSEN).unwrap_or_default();
    let run = |i: usize| (triangles_drawn(report, &report.runs[i]), hidden_share(report, &report.runs[i]));
    let (at_chosen, at_most, sampled) = (run(chosen), run(SIDES.len() - 1), run(SIDES.len() + 1));
    Statement {
        section: "6.3.3",
        claim: "64x64 partitions are enough, and more do not provide further benefits",
        found: format!(
            "on {} a single partition leaves {} triangles, 64x64 leave {} and 256x256 {}, that is {} percent of the hidden ones \
             more culled; the no-background Z-buffer leaves {}",
            place.scene.name,
            count(run(0).0),
            count(at_chosen.0),
            count(at_most.0),
            digits3(at_most.1 - at_chosen.1),
            count(sampled.0),
        ),
        holds: at_most.1 - at_chosen.1 <= NOTHING,
    }
}
