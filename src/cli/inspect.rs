//! `homcull inspect`, `homcull scenes`, `homcull methods`.

use std::time::Instant;

use serde_json::json;

use super::arguments::Options;
use super::setting;
use crate::cull;
use crate::error::Result;
use crate::geometry::Aabb;
use crate::measure::json::write_json;
use crate::measure::preset::presets;
use crate::measure::report_number::grouped;
use crate::scene::{self, Hierarchy, PreparedScene};
use crate::select::{Criterion, StaticCriteria, StaticSelection};

/// What a scene is made of.
pub fn scene(argument: &str, options: &Options) -> Result<()> {
    let setting = setting::load(argument, options, false)?;
    let prepared = PreparedScene::new(&setting.scene)?;
    let hierarchy = Hierarchy::build(&prepared.bounds);
    let bounds = prepared.bounds.iter().filter(|b| b.is_finite()).fold(Aabb::EMPTY, |a, &b| a.union(b));
    let mut triangles: Vec<u32> = (0..setting.scene.objects.len() as u32).map(|o| prepared.triangles(o)).collect();
    triangles.sort_unstable();
    let (median, most) = (triangles.get(triangles.len() / 2).copied(), triangles.last().copied());
    let finite = bounds.is_finite();
    let size = if finite { bounds.size().to_array() } else { [0.0; 3] };
    let occluders = occluders(&prepared)?;
    let cells = InspectedCells::new(&prepared);
    let value = json!({
        "scene": argument,
        "objects": setting.scene.objects.len(),
        "meshes": setting.scene.meshes.len(),
        "triangles": setting.scene.triangles(),
        "triangles_per_object": {"median": median, "max": most},
        "translucent_objects": setting.scene.objects.iter().filter(|o| !o.is_opaque()).count(),
        "size": size,
        "views": setting.views.len(),
        "hierarchy": {"nodes": hierarchy.nodes.len(), "depth": hierarchy.depth(), "unplaced": hierarchy.unplaced.len()},
        "occluders": occluders.json(),
        "cells": cells.json(),
    });
    if let Some(target) = &options.json {
        return write_json(target, &value);
    }
    if !options.quiet {
        say!("{argument}");
        say!("  objects     {}", grouped(setting.scene.objects.len() as u64));
        say!("  triangles   {}", grouped(setting.scene.triangles()));
        say!("  an object   {} triangles in the middle, {} at most", median.unwrap_or(0), most.unwrap_or(0));
        say!("  size        {} x {} x {}", size[0], size[1], size[2]);
        say!("  views       {}", setting.views.len());
        say!("  hierarchy   {} nodes, {} deep", hierarchy.nodes.len(), hierarchy.depth());
        say!("  occluders   {}", occluders.line());
        say!("  cells       {}", cells.line());
    }
    Ok(())
}

/// The cells and portals of a scene: its own, or those found.
struct InspectedCells {
    cells: usize,
    portals: usize,
    /// What of the faces between cells found is no portal, and the seconds that it took to find them.
    found: Option<(f64, f64)>,
}

impl InspectedCells {
    fn new(scene: &PreparedScene) -> InspectedCells {
        if let Some(own) = &scene.cells {
            let (cells, portals) = (own.cells().len(), own.portals().len());
            return InspectedCells { cells, portals, found: None };
        }
        let start = Instant::now();
        let found = scene.found_cells();
        let seconds = start.elapsed().as_secs_f64();
        let (cells, portals) = (found.cells.cells().len(), found.cells.portals().len());
        InspectedCells { cells, portals, found: Some((found.covered, seconds)) }
    }

    fn json(&self) -> serde_json::Value {
        json!({
            "from": if self.found.is_some() { "found" } else { "given" },
            "cells": self.cells,
            "portals": self.portals,
            "covered": self.found.map(|(covered, _)| covered),
            "seconds": self.found.map(|(_, seconds)| seconds),
        })
    }

    fn line(&self) -> String {
        let counts = format!("{} with {} portals", grouped(self.cells as u64), grouped(self.portals as u64));
        match self.found {
            None => format!("{counts}, given"),
            Some((covered, seconds)) => format!(
                "{counts}, found in {seconds:.2} s; {:.1} % of the faces between them are covered",
                covered * 100.0
            ),
        }
    }
}

/// What static occluder selection leaves of a scene.
struct Occluders {
    candidates: usize,
    kept: usize,
    /// Objects that each criterion flags, and its parameter's value.
    rejected: [(Criterion, usize, String); 5],
}

/// Static selection by its defaults; locality and aspect, which are off by default, as for the depth estimation buffer.
fn occluders(scene: &PreparedScene) -> Result<Occluders> {
    let standard = StaticCriteria::default();
    let boxes = StaticCriteria { redundancy: None, ..StaticCriteria::for_estimation_buffer() };
    let (chosen, by_boxes) = (StaticSelection::new(scene, &standard)?, StaticSelection::new(scene, &boxes)?);
    let rejected = Criterion::ALL.map(|c| match c {
        Criterion::Locality | Criterion::Aspect => (c, by_boxes.rejected_by(c), boxes.value(c)),
        _ => (c, chosen.rejected_by(c), standard.value(c)),
    });
    Ok(Occluders { candidates: chosen.candidates(), kept: chosen.kept(), rejected })
}

impl Occluders {
    fn json(&self) -> serde_json::Value {
        let counts = self.rejected.iter().map(|(c, n, value)| {
            let by_default = StaticCriteria::default().value(*c) != "off";
            (c.name().to_owned(), json!({"objects": n, "parameter": value, "by_default": by_default}))
        });
        let rejected: serde_json::Map<String, serde_json::Value> = counts.collect();
        json!({"candidates": self.candidates, "kept": self.kept, "rejected": rejected})
    }

    fn line(&self) -> String {
        let part =
            |(c, n, value): &(Criterion, usize, String)| format!("{} {} ({value})", c.name(), grouped(*n as u64));
        let (off, on): (Vec<_>, Vec<_>) =
            self.rejected.iter().partition(|(c, ..)| StaticCriteria::default().value(*c) == "off");
        let list = |of: Vec<&(Criterion, usize, String)>| of.into_iter().map(part).collect::<Vec<_>>().join(", ");
        format!(
            "{} of {} by database=static; rejected by {}; if asked, by {}",
            grouped(self.kept as u64),
            grouped(self.candidates as u64),
            list(on),
            list(off)
        )
    }
}

/// The generators and their defaults, and the presets.
pub fn generators() -> Result<()> {
    for g in scene::generators() {
        say!("{}:seed={},triangles={}\n    {}", g.name, g.seed, g.triangles, g.about);
    }
    say!("\nPresets, of `walk` alone: the thesis's experiments, with the generator's parameters");
    for p in presets() {
        let grid = p.grid.map(|[x, y, z]| format!(":grid={x}x{y}x{z}")).unwrap_or_default();
        say!(
            "{}{grid}\n    section {}: {}; {} and, as in 1998, {}",
            p.name,
            p.section,
            p.generator,
            p.method,
            p.thresholds
        );
    }
    Ok(())
}

/// The methods and their parameters.
pub fn methods() -> Result<()> {
    for m in cull::methods() {
        say!("{}\n    from        {}\n    guarantee   {}", m.name, m.source, m.guarantee);
        say!("    parameters  {}\n    use it when {}", m.parameters, m.when);
    }
    Ok(())
}
