//! 6.4: what redundant occluders, hidden by others, do to each depth representation.
//!
//! The occluders of a view are all objects that its exact picture shows, and then more and more of the hidden ones, spread evenly
//! over the distance, up to all that is in the frustum. Everything is tested against them, the occluders too.
//!
//! Our no-background Z-buffer may count a triangle that covers a whole block with its farthest depth there. Something hidden behind
//! that triangle can be nearer than this, so a redundant occluder may add an object to what is culled; it never takes one away.

use super::verdicts::{Judge, Judged, representations};
use super::{Axis, Bench, Cell, Column, Curve, Experiment, Findings, Panel, Place, Places, Progress, Statement};
use crate::error::Result;
use crate::measure::report_number::{digits3, grouped};
use crate::occlusion::{Hidden, OcclusionSettings, Verdict};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "redundant-occluders",
    section: "6.4",
    shows: "what each depth representation culls as hidden objects are added to the occluders, up to all objects",
    places: Places::Scenes(&["city", "machine-room", super::PLANT]),
    frames: 4,
    run,
};

/// Of the hidden objects, so many percent are occluders too.
const ADDED: [u32; 7] = [0, 1, 3, 10, 30, 60, 100];

/// Why there may be gains.
const BY_BLOCK: &str =
    " (where a triangle counts with its farthest depth in a block, what it hides can be nearer than that)";

/// Sums over the frames for one depth representation and share of redundant occluders.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    occluders: u64,
    culled: u64,
    culled_triangles: u64,
    occluders_culled: u64,
    /// Objects culled without redundant occluders, and now no longer; and the other way round.
    lost: u64,
    gained: u64,
}

/// The sums of one depth representation over [`ADDED`].
type Curves = [Sums; ADDED.len()];

fn run(bench: &Bench<'_>, places: &[Place]) -> Result<Findings> {
    let mut findings = Findings {
        columns: vec![
            Column::new("scene", ""),
            Column::new("depth", ""),
            Column::new("redundant", "percent of the hidden"),
            Column::new("occluders", "a walk"),
            Column::new("culled", "objects"),
            Column::new("culled triangles", "percent of hidden"),
            Column::new("occluders culled", "objects"),
            Column::new("lost", "objects"),
            Column::new("gained", "objects"),
        ],
        ..Findings::default()
    };
    for place in places {
        let (sums, hidden) = measure(bench, place)?;
        let percent = |sums: &Sums| 100.0 * sums.culled_triangles as f64 / hidden.max(1) as f64;
        for ((depth, _), sums) in representations().iter().zip(&sums) {
            for (added, sums) in ADDED.iter().zip(sums) {
                findings.rows.push(vec![
                    Cell::text(&place.scene.name),
                    Cell::text(*depth),
                    Cell::Count(u64::from(*added)),
                    Cell::Count(sums.occluders),
                    Cell::Count(sums.culled),
                    Cell::Figure(percent(sums)),
                    Cell::Count(sums.occluders_culled),
                    Cell::Count(sums.lost),
                    Cell::Count(sums.gained),
                ]);
            }
        }
        let curve = |(depth, sums): (&str, &Curves)| {
            Curve::new(depth, ADDED.iter().map(|&added| f64::from(added)).zip(sums.iter().map(percent)).collect())
        };
        findings.panels.push(Panel {
            title: place.scene.name.clone(),
            x: Axis::plain("hidden objects among the occluders, percent"),
            y: Axis::plain("triangles culled, percent of the hidden"),
            curves: representations().iter().map(|(depth, _)| *depth).zip(&sums).map(curve).collect(),
        });
        findings.statements.extend(statements(place, &sums, hidden));
    }
    Ok(findings)
}

/// The sums by depth representation and share, and the hidden triangles in the frustum, over all frames.
fn measure(bench: &Bench<'_>, place: &Place) -> Result<([Curves; 4], u64)> {
    let mut judge = Judge::new(bench, place)?;
    let mut sums = [Curves::default(); 4];
    let mut hidden_triangles = 0;
    (bench.progress)(Progress::Ahead(place.views.len() * representations().len()));
    for view in &place.views {
        let objects = judge.look(view)?;
        let (visible, hidden): (Vec<u32>, Vec<u32>) = objects.iter().partition(|&&o| judge.samples[o as usize] > 0);
        hidden_triangles += hidden.iter().map(|&o| judge.triangles(o)).sum::<u64>();
        for ((_, depth), sums) in representations().into_iter().zip(&mut sums) {
            let mut buffer = judge.buffer(view, OcclusionSettings { depth, ..OcclusionSettings::default() })?;
            let mut before: Vec<Judged> = Vec::new();
            for (added, sums) in ADDED.iter().zip(sums) {
                let occluders = [&visible[..], &spread(&hidden, *added)].concat();
                let judged = judge.judge(&mut buffer, view, &occluders)?;
                if before.is_empty() {
                    before.clone_from(&judged);
                }
                count(&judge, &judged, &before, &occluders, sums);
            }
            (bench.progress)(Progress::Done);
        }
    }
    Ok((sums, hidden_triangles))
}

/// So many percent of the objects, spread evenly over their order.
fn spread(objects: &[u32], percent: u32) -> Vec<u32> {
    let upto = |i: usize| i * percent as usize / 100;
    objects.iter().enumerate().filter(|(i, _)| upto(i + 1) > upto(*i)).map(|(_, &o)| o).collect()
}

fn count(judge: &Judge<'_>, judged: &[Judged], before: &[Judged], occluders: &[u32], sums: &mut Sums) {
    let culled = |judged: &Judged| judged.verdict == Verdict::Hidden(Hidden::OverlapAndDepth);
    let mut occludes = vec![false; judge.samples.len()];
    occluders.iter().for_each(|&o| occludes[o as usize] = true);
    sums.occluders += occluders.len() as u64;
    for (now, before) in judged.iter().zip(before) {
        if culled(now) {
            sums.culled += 1;
            sums.culled_triangles += judge.triangles(now.object);
            sums.occluders_culled += u64::from(occludes[now.object as usize]);
        }
        sums.lost += u64::from(culled(before) && !culled(now));
        sums.gained += u64::from(culled(now) && !culled(before));
    }
}

fn statements(place: &Place, sums: &[Curves; 4], hidden: u64) -> [Statement; 3] {
    let [nbz, _, deb, plane] = sums;
    let (few, all) = (nbz[0], nbz[ADDED.len() - 1]);
    let percent = |sums: Sums| digits3(100.0 * sums.culled_triangles as f64 / hidden.max(1) as f64);
    let deb_all = deb[ADDED.len() - 1];
    let far_culled: u64 = deb.iter().chain(plane).map(|sums| sums.occluders_culled).sum();
    let on = &place.scene.name;
    [
        Statement {
            section: "6.4",
            claim: "redundant occluders do not affect the no-background Z-buffer",
            found: format!(
                "on {on}, with all {} hidden objects among the occluders, {} culled objects are lost and {} gained, of {}{}",
                grouped(all.occluders - few.occluders),
                all.lost,
                all.gained,
                grouped(few.culled),
                if all.gained > 0 { BY_BLOCK } else { "" },
            ),
            holds: nbz.iter().all(|sums| sums.lost + sums.gained == 0),
        },
        Statement {
            section: "6.4",
            claim: "with the depth estimation buffer no culling is possible once all objects are occluders",
            found: format!(
                "on {on} it culls {} percent of the hidden triangles without redundant occluders, {} objects when all are occluders",
                percent(deb[0]),
                deb_all.culled,
            ),
            holds: deb_all.culled == 0,
        },
        Statement {
            section: "6.4",
            claim: "no object chosen as an occluder can be culled with a far boundary, while the no-background Z-buffer can cull it",
            found: format!(
                "on {on} the depth estimation buffer and the plane culled {far_culled} occluders, the no-background Z-buffer {} of {}",
                grouped(all.occluders_culled),
                grouped(all.occluders),
            ),
            holds: far_culled == 0 && all.occluders_culled > 0,
        },
    ]
}
