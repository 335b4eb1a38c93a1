//! The plot of an experiment: its charts side by side, in one row or two, under one head, with one legend.

use std::path::Path;

use plotters::prelude::*;

use super::findings::{Axis, Curve, Panel, Scale};
use crate::error::Result;
use crate::measure::plot_canvas::{Area, DrawResult, paint, px, text};
use crate::measure::plot_chart::{self, INK, Pen, SIZE, chart, head};
use crate::measure::report_number::tick;

/// Points that are marked on a curve, at most: more would be a band of dots.
const MOST_DOTS: usize = 16;
/// Charts in a row, at most; more stand in two rows.
const MOST_ACROSS: usize = 3;
/// Labels of an x axis over the whole width of the plot; charts side by side share them.
const LABELS: usize = 13;

/// Draws the charts and writes them as PNG.
///
/// # Errors
/// [`crate::Error::File`] with the path and the reason.
pub fn plot(path: &Path, title: &str, subtitle: &str, panels: &[Panel]) -> Result<()> {
    let pens = pens(panels);
    let legend: Vec<(Pen, &str)> = pens.iter().map(|(name, pen)| (*pen, *name)).collect();
    paint(path, SIZE, |root| {
        let area = head(root, title, subtitle, &legend)?;
        let rows = if panels.len() > MOST_ACROSS { 2 } else { 1 };
        let across = panels.len().div_ceil(rows).max(1);
        for (area, panel) in area.split_evenly((rows, across)).into_iter().zip(panels) {
            draw_panel(&area.margin(0, px(12), 0, 0), panel, &pens, across)?;
        }
        Ok(())
    })
}

/// A pen for every name: limits have their own.
fn pens(panels: &[Panel]) -> Vec<(&str, Pen)> {
    let mut pens: Vec<(&str, Pen)> = Vec::new();
    let mut coloured = 0;
    for curve in panels.iter().flat_map(|panel| &panel.curves) {
        if pens.iter().any(|(name, _)| *name == curve.name) {
            continue;
        }
        let pen = if curve.limit { Pen::limit() } else { Pen::nth(coloured) };
        coloured += usize::from(!curve.limit);
        pens.push((&curve.name, pen));
    }
    pens
}

fn draw_panel(area: &Area<'_>, panel: &Panel, pens: &[(&str, Pen)], across: usize) -> DrawResult {
    let area = titled(area, &panel.title)?;
    let placed: Vec<Vec<(f64, f64)>> = panel.curves.iter().map(|curve| placed(panel, curve)).collect();
    let all = || placed.iter().flatten();
    let (left, right) = all().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, r), p| (l.min(p.0), r.max(p.0)));
    let (left, right) = if left <= right { (left, right) } else { (0.0, 1.0) };
    let margin = (right - left).max(1e-9) * 0.03;
    let greatest = all().fold(0.0f64, |greatest, p| greatest.max(p.1));
    let top = if greatest > 0.0 { greatest * 1.06 } else { 1.0 };
    // Below what doublings are counted from there is room only where something is.
    let bottom = all().fold(0.0f64, |least, p| least.min(p.1)).floor();
    let ticks = (LABELS / across).max(6);
    let (x_tick, y_tick) = (|at| label(&panel.x, at), |at| label(&panel.y, at));
    let x = plot_chart::Axis { name: &panel.x.name, range: left - margin..right + margin, ticks, tick: &x_tick };
    let y = plot_chart::Axis { name: &panel.y.name, range: bottom..top, ticks: 9, tick: &y_tick };
    let mut chart = chart(&area, x, y)?;
    for (i, (curve, points)) in panel.curves.iter().zip(placed).enumerate() {
        let Some((_, pen)) = pens.iter().find(|(name, _)| *name == curve.name) else { continue };
        if points.len() <= MOST_DOTS && !curve.limit {
            // Smaller and smaller: where curves coincide, the earlier ones show around the later.
            let radius = px(6 - i.min(3) as i32);
            let dot = |&point| Circle::new(point, radius, pen.colour().filled());
            chart.draw_series(points.iter().map(dot))?;
        }
        pen.draw(&mut chart, points)?;
    }
    Ok(())
}

/// Writes a chart's title, and gives what is left below it.
fn titled<'a>(area: &Area<'a>, title: &str) -> DrawResult<Area<'a>> {
    if title.is_empty() {
        return Ok(area.clone());
    }
    area.draw_text(title, &text(19, INK), (px(84), px(2)))?;
    Ok(area.split_vertically(px(30)).1)
}

/// The curve's points where the chart has them.
fn placed(panel: &Panel, curve: &Curve) -> Vec<(f64, f64)> {
    let place = |axis: &Axis, value: f64| match axis.scale {
        Scale::Plain => value,
        Scale::Doubling(from) => (value / from).log2(),
    };
    let points = curve.points.iter().map(|&(x, y)| (place(&panel.x, x), place(&panel.y, y)));
    points.filter(|(x, y)| x.is_finite() && y.is_finite()).collect()
}

/// What is written at a place of an axis.
fn label(axis: &Axis, at: f64) -> String {
    match axis.scale {
        Scale::Plain => tick(at),
        Scale::Doubling(from) if (at - at.round()).abs() < 1e-9 => tick(from * at.round().exp2()),
        Scale::Doubling(_) => String::new(),
    }
}
