//! What all plots share: the head with title and legend, axes over a light grid, and pens.

use plotters::coord::types::RangedCoordf64;
use plotters::element::DashedPathElement;
use plotters::prelude::*;

use super::plot_canvas::{Area, Canvas, DrawResult, px, text};

/// Width and height of every plot, in pixels.
pub const SIZE: (u32, u32) = (1200, 700);

/// Blue, vermilion, green, purple, orange, sky, black, grey: the set of Okabe and Ito, for any
/// colour vision; yellow is left out because it vanishes on white.
const COLOURS: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
    RGBColor(136, 136, 136),
];
const FAINT_INK: RGBColor = RGBColor(96, 96, 96);
const GRID: RGBColor = RGBColor(224, 224, 224);
/// The colour of text.
pub(super) const INK: RGBColor = RGBColor(34, 34, 34);
/// Length of a dash and of the gap after it, in drawn pixels.
const DASH: (i32, i32) = (px(7), px(4));
/// Where the axis of a plot stands, from the left, and the end of its width, in drawn pixels.
const LEFT: i32 = px(84);
const RIGHT: i32 = px(SIZE.0 as i32 - 30);

/// A chart over two plain axes.
pub(super) type Chart<'a, 'b> = ChartContext<'a, Canvas<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// An axis: its name, its span, and how its values are written.
pub(super) struct Axis<'a> {
    pub(super) name: &'a str,
    pub(super) range: std::ops::Range<f64>,
    /// About so many labels.
    pub(super) ticks: usize,
    pub(super) tick: &'a dyn Fn(f64) -> String,
}

/// How a curve is drawn.
#[derive(Clone, Copy)]
pub(super) struct Pen {
    colour: RGBColor,
    dashed: bool,
}

impl Pen {
    /// The pen of the `index`-th curve; from the ninth on the colours return, dashed.
    pub(super) fn nth(index: usize) -> Pen {
        Pen { colour: COLOURS[index % COLOURS.len()], dashed: index >= COLOURS.len() }
    }

    /// A dashed black line, for what is a limit rather than a method; another curve under it shows.
    pub(super) fn limit() -> Pen {
        Pen { colour: RGBColor(0, 0, 0), dashed: true }
    }

    /// Its colour.
    pub(super) fn colour(self) -> RGBColor {
        self.colour
    }

    fn stroke(self, width: i32) -> ShapeStyle {
        self.colour.stroke_width(px(width) as u32)
    }

    /// Joins `points` by lines.
    pub(super) fn draw(self, chart: &mut Chart, points: Vec<(f64, f64)>) -> DrawResult {
        let stroke = self.stroke(2);
        if self.dashed {
            chart.draw_series(DashedLineSeries::new(points, DASH.0, DASH.1, stroke))?;
        } else {
            chart.draw_series(LineSeries::new(points, stroke))?;
        }
        Ok(())
    }
}

/// Title, subtitle and legend at the top; returns the area that remains for the chart.
pub(super) fn head<'a>(root: &Area<'a>, title: &str, subtitle: &str, legend: &[(Pen, &str)]) -> DrawResult<Area<'a>> {
    for (line, style, y) in [(title, text(30, INK), px(14)), (subtitle, text(17, FAINT_INK), px(50))] {
        root.draw_text(&fitted(root, line, &style)?, &style, (LEFT, y))?;
    }
    let style = text(18, INK);
    let (mut x, mut y) = (LEFT, px(80));
    for &(pen, name) in legend {
        let (width, _) = root.estimate_text_size(name, &style)?;
        let width = px(36) + width as i32;
        if x > LEFT && x + width > RIGHT {
            (x, y) = (LEFT, y + px(24));
        }
        let line = [(x, y + px(9)), (x + px(28), y + px(9))];
        if pen.dashed {
            root.draw(&DashedPathElement::new(line, DASH.0, DASH.1, pen.stroke(3)))?;
        } else {
            root.draw(&PathElement::new(line, pen.stroke(3)))?;
        }
        root.draw_text(name, &style, (x + px(36), y))?;
        x += width + px(28);
    }
    let (_, chart) = root.split_vertically(y + px(36));
    Ok(chart.margin(0, px(8), px(4), px(30)))
}

/// `line`, its end cut off and marked with dots if it is wider than the plot.
fn fitted(root: &Area<'_>, line: &str, style: &TextStyle<'_>) -> DrawResult<String> {
    let mut kept = line.to_string();
    let mut shown = kept.clone();
    while root.estimate_text_size(&shown, style)?.0 as i32 > RIGHT - LEFT && kept.pop().is_some() {
        shown = format!("{}...", kept.trim_end());
    }
    Ok(shown)
}

/// A chart on `area` with its axes, ticks and a light grid.
pub(super) fn chart<'a, 'b>(area: &'a Area<'b>, x: Axis<'_>, y: Axis<'_>) -> DrawResult<Chart<'a, 'b>> {
    let mut chart = ChartBuilder::on(area)
        .x_label_area_size(px(52))
        .y_label_area_size(LEFT)
        .build_cartesian_2d(x.range, y.range)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID.stroke_width(px(1) as u32))
        .axis_style(FAINT_INK.stroke_width(px(1) as u32))
        .x_labels(x.ticks)
        .y_labels(y.ticks)
        .x_label_formatter(&|value| (x.tick)(*value))
        .y_label_formatter(&|value| (y.tick)(*value))
        .label_style(text(17, INK))
        .axis_desc_style(text(19, INK))
        .x_desc(x.name)
        .y_desc(y.name)
        .draw()?;
    Ok(chart)
}
