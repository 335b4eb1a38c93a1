//! `homcull inspect`, `homcull scenes`, `homcull methods`.

use serde_json::json;

use super::arguments::Options;
use super::setting;
use crate::cull;
use crate::error::Result;
use crate::geometry::Aabb;
use crate::measure::json::write_json;
use crate::measure::report_number::grouped;
use crate::scene::{self, Hierarchy, PreparedScene};

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
    });
    if let Some(target) = &options.json {
        return write_json(target, &value);
    }
    if !options.quiet {
        println!("{argument}");
        println!("  objects     {}", grouped(setting.scene.objects.len() as u64));
        println!("  triangles   {}", grouped(setting.scene.triangles()));
        println!("  an object   {} triangles in the middle, {} at most", median.unwrap_or(0), most.unwrap_or(0));
        println!("  size        {} x {} x {}", size[0], size[1], size[2]);
        println!("  views       {}", setting.views.len());
        println!("  hierarchy   {} nodes, {} deep", hierarchy.nodes.len(), hierarchy.depth());
    }
    Ok(())
}

/// The generators and their defaults.
pub fn generators() -> Result<()> {
    for g in scene::generators() {
        println!("{}:seed={},triangles={}\n    {}", g.name, g.seed, g.triangles, g.about);
    }
    Ok(())
}

/// The methods and their parameters.
pub fn methods() -> Result<()> {
    for m in cull::methods() {
        println!("{}\n    from        {}\n    guarantee   {}", m.name, m.source, m.guarantee);
        println!("    parameters  {}\n    use it when {}", m.parameters, m.when);
    }
    Ok(())
}
