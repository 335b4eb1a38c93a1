//! `homcull inspect SCENE --occluders`: what of a scene is closed, and how few triangles stand in for it.

use serde_json::json;

use super::arguments::Options;
use super::setting;
use crate::error::Result;
use crate::measure::json::write_json;
use crate::measure::report_number::grouped;
use crate::raster::Facing;
use crate::scene::Mesh;
use crate::scene::lod::{Merge, OccluderLevels, Open, most_within, price_within};

/// Shares of the closed parts' triangles that the table has rows for.
const SHARES: [f64; 5] = [0.5, 0.2, 0.1, 0.05, 0.02];

/// Parts and triangles.
#[derive(Clone, Copy, Default)]
struct Tally {
    parts: usize,
    triangles: usize,
}

/// Prints the table, or writes it as JSON. Every mesh counts once, however many objects share it.
pub fn run(argument: &str, options: &Options) -> Result<()> {
    let setting = setting::load(argument, options, false)?;
    let workers = setting::workers(options, setting::processors())?;
    let mut facings = vec![Facing::Both; setting.scene.meshes.len()];
    setting.scene.objects.iter().for_each(|o| facings[o.mesh as usize] = o.facing);
    let mut jobs: Vec<(&Mesh, Facing, Option<OccluderLevels>)> =
        setting.scene.meshes.iter().zip(facings).map(|(mesh, facing)| (mesh, facing, None)).collect();
    workers.run(&mut jobs, |(mesh, facing, levels)| *levels = Some(OccluderLevels::new(mesh, *facing, Merge::Inner)));
    let levels: Vec<OccluderLevels> = jobs.into_iter().filter_map(|job| job.2).collect();

    let closed = closed(&levels);
    let area: f64 = levels.iter().flat_map(|l| &l.closed).map(|part| part.area).sum();
    let open = [Open::Border, Open::Orientation, Open::NoRoom].map(|reason| (reason, open(&levels, reason)));
    let merged: usize = levels.iter().map(|l| l.merged.triangles.len()).sum();
    let triangles_of = |share: f64| (closed.triangles as f64 * share) as usize;
    let rows = SHARES.map(|share| kept(&levels, triangles_of(share)));
    let most = SHARES.map(|share| most_within(&levels, triangles_of(share)));
    let share_of = |kept: f64| if area > 0.0 { kept / area } else { 0.0 };
    let tally = |t: Tally| json!({"parts": t.parts, "triangles": t.triangles});
    let value = json!({
        "scene": argument,
        "meshes": levels.len(),
        "triangles": levels.iter().map(OccluderLevels::triangles).sum::<usize>(),
        "closed": tally(closed),
        "open": {"border": tally(open[0].1), "orientation": tally(open[1].1), "no_room": tally(open[2].1),
                 "triangles_merged": merged},
        "simplified": rows.iter().zip(SHARES).zip(most).map(|((&(t, area), share), most)| json!({
            "share_of_triangles": share, "parts": t.parts, "triangles": t.triangles, "share_of_area": share_of(area),
            "share_of_area_at_most": most
        })).collect::<Vec<_>>(),
    });
    if let Some(target) = &options.json {
        return write_json(target, &value);
    }
    if options.quiet {
        return Ok(());
    }
    say!("{argument}");
    let line = |what: &str, t: Tally| {
        say!("  {what:<54} {:>9} parts {:>11} triangles", grouped(t.parts as u64), grouped(t.triangles as u64));
    };
    line("closed", closed);
    line("open: a border", open[0].1);
    line("open: turned against each other", open[1].1);
    line("open: no room inside", open[2].1);
    say!("  {:<54} {:>15} {:>11} triangles", "open parts, coplanar ones merged", "", grouped(merged as u64));
    for (((t, area), share), most) in rows.into_iter().zip(SHARES).zip(most) {
        let [share, kept, most] = [share, share_of(area), most].map(|v| v * 100.0);
        line(&format!("closed, {share:>4.1} % of triangles: {kept:>5.1} % of area, {most:>5.1} possible"), t);
    }
    Ok(())
}

fn closed(levels: &[OccluderLevels]) -> Tally {
    let parts = levels.iter().map(|l| l.closed.len()).sum();
    Tally { parts, triangles: levels.iter().map(OccluderLevels::closed_triangles).sum() }
}

fn open(levels: &[OccluderLevels], reason: Open) -> Tally {
    let parts = levels.iter().flat_map(|l| &l.open).filter(|part| part.0 == reason);
    parts.fold(Tally::default(), |t, part| Tally { parts: t.parts + 1, triangles: t.triangles + part.1 })
}

/// What covers most with that many triangles: parts that are left, their triangles, and their area.
fn kept(levels: &[OccluderLevels], triangles: usize) -> (Tally, f64) {
    let price = price_within(levels, triangles);
    let chosen = levels.iter().flat_map(|l| &l.closed).filter_map(|part| part.at(price));
    chosen.fold((Tally::default(), 0.0), |(t, area), level| {
        let tally = Tally { parts: t.parts + 1, triangles: t.triangles + level.triangles.len() };
        (tally, area + level.area)
    })
}
