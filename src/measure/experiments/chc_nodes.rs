//! The picture of classified nodes (Bittner et al. 2004, the figure of the city's nodes): from above, what a frame of CHC drew, and the nodes
//! that it found hidden, which grow with their distance from what is visible.

use plotters::prelude::*;

use super::{Bench, Place};
use crate::cull::chc::ChcMemory;
use crate::cull::coherent::{self, QueryParameters};
use crate::cull::vfc::World;
use crate::draw::Canvas;
use crate::error::Result;
use crate::geometry::Aabb;
use crate::measure::plot_canvas::paint;
use crate::measure::plot_chart::{self, INK, Pen, SIZE, chart, head};
use crate::measure::report_number::tick;

/// A node's footprint, and whether it is visible.
type Footprint = ([(f64, f64); 2], bool);

/// Writes the picture of the frame of a place's walk with the most hidden nodes to `experiment-chc-nodes-SCENE.png`.
///
/// # Errors
/// Those of a frame of chc, and [`crate::Error::File`].
pub(super) fn picture(bench: &Bench<'_>, place: &Place) -> Result<()> {
    let world = World::new(&place.prepared);
    let Some(&all) = world.tree.bounds.first() else { return Ok(()) };
    let mut canvas = Canvas::new(place.views[0].viewport(), bench.level)?;
    let (mut memory, parameters) = (ChcMemory::default(), QueryParameters::new(true));
    let (mut shown, mut visible, mut hidden) = (0, Vec::new(), Vec::new());
    for (frame, view) in place.views.iter().enumerate() {
        coherent::draw(&world, view, &parameters, &mut memory, &mut canvas)?;
        let classified = memory.classified(&world);
        if classified.1.len() > hidden.len() || frame == 0 {
            shown = frame;
            (visible, hidden) = classified;
        }
    }
    let footprint = |b: &Aabb| [(b.min.x.into(), b.min.z.into()), (b.max.x.into(), b.max.z.into())];
    let [(left, back), (right, front)]: [(f64, f64); 2] = footprint(&all);
    let nodes = visible.iter().map(|b| (footprint(b), true)).chain(hidden.iter().map(|b| (footprint(b), false)));
    let mut nodes: Vec<Footprint> = nodes.collect();
    // The largest first: smaller ones lie on top.
    let area = |&([(x0, z0), (x1, z1)], _): &Footprint| (x1 - x0) * (z1 - z0);
    nodes.sort_by(|a, b| area(b).total_cmp(&area(a)));
    let eye = place.views[shown].eye() - place.prepared.origin;
    let last = place.scene.name.rsplit('/').next().unwrap_or_default();
    let name: String = last.chars().map(|c| if c.is_alphanumeric() { c } else { '-' }).collect();
    let title = format!("Nodes as chc left them, from above: {}", place.scene.name);
    let line = format!(
        "frame {shown} of {}: {} objects visible, {} nodes and objects found hidden; the eye in black",
        place.views.len(),
        visible.len(),
        hidden.len()
    );
    let (drawn, culled) = (Pen::nth(2), Pen::nth(1));
    paint(&bench.out.join(format!("experiment-chc-nodes-{name}.png")), SIZE, |root| {
        let area = head(root, &title, &line, &[(drawn, "visible"), (culled, "hidden")])?;
        // One scale for both axes, the scene in the middle.
        let (width, height) = area.dim_in_pixel();
        let metres = ((right - left) / f64::from(width)).max((front - back) / f64::from(height)) * 1.15;
        let span = |low: f64, high: f64, pixels: u32| {
            let half = metres * f64::from(pixels) / 2.0;
            (low + high) / 2.0 - half..(low + high) / 2.0 + half
        };
        let x = plot_chart::Axis { name: "x", range: span(left, right, width), ticks: 10, tick: &tick };
        let y = plot_chart::Axis { name: "z", range: span(back, front, height), ticks: 8, tick: &tick };
        let mut chart = chart(&area, x, y)?;
        for (corners, visible) in nodes {
            let (pen, share) = if visible { (drawn, 0.3) } else { (culled, 0.1) };
            chart.draw_series([
                Rectangle::new(corners, pen.colour().mix(share).filled()),
                Rectangle::new(corners, pen.colour().stroke_width(1)),
            ])?;
        }
        chart.draw_series([Circle::new((eye.x, eye.z), 9, INK.filled())])?;
        Ok(())
    })
}
