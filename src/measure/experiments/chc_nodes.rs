//! The picture of classified nodes (Bittner et al. 2004, the figure of the city's nodes): from above, what a frame of CHC drew, and the nodes
//! that it found hidden, which grow with their distance from what is visible.

use plotters::prelude::*;

use super::{Bench, Place};
use crate::cull::chc::ChcMemory;
use crate::cull::coherent::{self, QueryParameters};
use crate::cull::vfc::World;
use crate::draw::Canvas;
use crate::error::Result;
use crate::measure::plot_canvas::paint;
use crate::measure::plot_chart::{self, INK, Pen, SIZE, chart, head};
use crate::measure::report_number::tick;

/// Frames before the one that is shown: what CHC knows then has settled.
const BEFORE: usize = 2;

/// Writes the picture of the middle of a place's walk to `experiment-chc-nodes-SCENE.png`.
///
/// # Errors
/// Those of a frame of chc, and [`crate::Error::File`].
pub(super) fn picture(bench: &Bench<'_>, place: &Place) -> Result<()> {
    let world = World::new(&place.prepared);
    let middle = place.views.len() / 2;
    let mut canvas = Canvas::new(place.views[middle].viewport(), bench.level)?;
    let (mut memory, parameters) = (ChcMemory::default(), QueryParameters::new(true));
    for view in &place.views[middle.saturating_sub(BEFORE)..=middle] {
        coherent::draw(&world, view, &parameters, &mut memory, &mut canvas)?;
    }
    let (visible, mut hidden) = memory.classified(&world);
    let rect = |b: &crate::geometry::Aabb| [(b.min.x.into(), b.min.z.into()), (b.max.x.into(), b.max.z.into())];
    let [(left, back), (right, front)]: [(f64, f64); 2] = rect(&world.tree.bounds[0]);
    // The largest first: smaller ones lie on top.
    hidden.sort_by(|a, b| (b.size().x * b.size().z).total_cmp(&(a.size().x * a.size().z)));
    let eye = place.views[middle].eye() - place.prepared.origin;
    let name: String = place.scene.name.chars().map(|c| if c.is_alphanumeric() { c } else { '-' }).collect();
    let title = format!("Nodes as chc left them, from above: {}", place.scene.name);
    let line = format!(
        "frame {middle} of {}: {} objects visible, {} nodes and objects found hidden; the eye in black",
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
        let faint = culled.colour().mix(0.12).filled();
        chart.draw_series(hidden.iter().map(|b| Rectangle::new(rect(b), faint)))?;
        chart.draw_series(hidden.iter().map(|b| Rectangle::new(rect(b), culled.colour().stroke_width(1))))?;
        chart.draw_series(visible.iter().map(|b| Rectangle::new(rect(b), drawn.colour().filled())))?;
        chart.draw_series([Circle::new((eye.x, eye.z), 9, INK.filled())])?;
        Ok(())
    })
}
