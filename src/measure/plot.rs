//! The plots of a walk: frame rates, culling, and error against run time, as PNG.
//!
//! The first two are the graphs of the thesis' section 8.3.1 (its figures 8.5 and 8.6): time over
//! the path's frames with one curve a method, and triangles over the frames as each technique takes
//! its share away, with the exactly visible ones as the floor that nothing conservative can pass.
//! The third shows what an approximation buys: milliseconds against wrong pixels. The graphs of a
//! walk start at zero, so that areas do not lie; the third is fitted to its points, and errors that
//! span decades are drawn on a logarithmic scale.
//! Frames without a finite figure are skipped; their neighbours are joined.

use std::path::Path;

use plotters::prelude::*;

use super::plot_canvas::{paint, px, text};
pub use super::plot_chart::SIZE;
use super::plot_chart::{Axis, INK, Pen, chart, head};
use super::plot_labels::Taken;
use super::report::{FrameRecord, MethodRun, WalkReport};
use super::report_number::tick;
use super::table_walk::heading;
use crate::error::Result;

/// Labels of the axes.
const X_TICKS: usize = 13;
const Y_TICKS: usize = 9;

/// What the frame-rate graph shows upwards.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrameAxis {
    /// Frames per second, as the thesis does: higher is better.
    FramesPerSecond,
    /// Milliseconds a frame: lower is better, and additive.
    Milliseconds,
}

/// One setting of an approximation: what it cost and what it got wrong.
#[derive(Debug, Clone, PartialEq)]
pub struct ScatterPoint {
    /// Mean time of a frame, in milliseconds.
    pub ms: f64,
    /// Wrong pixels, in percent of the view's pixels.
    pub wrong_percent: f64,
    /// The setting, written beside the point.
    pub label: String,
}

/// The settings of one parameter, in the order in which they are joined by a line.
#[derive(Debug, Clone, PartialEq)]
pub struct ScatterSeries {
    /// The parameter, as the legend names it.
    pub name: String,
    /// Its settings.
    pub points: Vec<ScatterPoint>,
}

/// A curve over the frame numbers.
struct Curve {
    name: String,
    pen: Pen,
    values: Vec<f64>,
}

/// The frame-rate graph (thesis, figure 8.5): one curve a method over the path's frames.
///
/// # Errors
///
/// [`crate::Error::File`] with the path and the reason.
pub fn frame_rate_graph(path: &Path, report: &WalkReport, axis: FrameAxis) -> Result<()> {
    let (title, unit) = match axis {
        FrameAxis::FramesPerSecond => ("Frame rate", "frames per second"),
        FrameAxis::Milliseconds => ("Frame time", "milliseconds a frame"),
    };
    let value = |frame: &FrameRecord| match axis {
        FrameAxis::FramesPerSecond => 1000.0 / frame.frame_ms,
        FrameAxis::Milliseconds => frame.frame_ms,
    };
    let runs = report.runs.iter().zip(report.labels()).enumerate();
    let curves: Vec<Curve> = runs
        .map(|(index, (run, name))| {
            let values = run.frames.iter().map(value).collect();
            Curve { name, pen: Pen::nth(index), values }
        })
        .collect();
    frame_graph(path, title, &heading(report), unit, &curves)
}

/// The culling graph (thesis, figure 8.6) of one run of the report: triangles that remain after
/// level of detail, after view-frustum culling, after occlusion culling, and the exactly visible
/// ones, the last only where they are known.
///
/// # Errors
///
/// [`crate::Error::File`] with the path and the reason.
pub fn culling_graph(path: &Path, report: &WalkReport, run: &MethodRun) -> Result<()> {
    let curve = |name: &str, pen: Pen, count: fn(&FrameRecord) -> Option<u64>| {
        let value = |frame| count(frame).map_or(f64::NAN, |count| count as f64);
        Curve { name: name.to_string(), pen, values: run.frames.iter().map(value).collect() }
    };
    let curves = [
        curve("after level of detail", Pen::nth(0), |frame| Some(frame.triangles_after_lod)),
        curve("after view-frustum culling", Pen::nth(1), |frame| Some(frame.triangles_in_frustum)),
        curve("after occlusion culling", Pen::nth(2), |frame| Some(frame.triangles_drawn)),
        curve("exactly visible", Pen::limit(), |frame| frame.triangles_visible_exact),
    ];
    let mut labelled = report.runs.iter().zip(report.labels());
    let label = labelled.find(|(other, _)| *other == run).map(|(_, label)| label);
    let title = format!("Culling by {}", label.unwrap_or_else(|| run.full_name()));
    frame_graph(path, &title, &heading(report), "triangles", &curves)
}

fn frame_graph(path: &Path, title: &str, subtitle: &str, unit: &str, curves: &[Curve]) -> Result<()> {
    let known = |curve: &&Curve| curve.values.iter().any(|value| value.is_finite());
    let shown: Vec<&Curve> = curves.iter().filter(known).collect();
    let values = shown.iter().flat_map(|curve| curve.values.iter().copied());
    let greatest = values.filter(|value| value.is_finite()).fold(0.0, f64::max);
    let top = if greatest > 0.0 { greatest * 1.06 } else { 1.0 };
    let frames = shown.iter().map(|curve| curve.values.len()).max().unwrap_or(0);
    let last_frame = frames.saturating_sub(1).max(1) as f64;
    let legend: Vec<(Pen, &str)> = shown.iter().map(|curve| (curve.pen, curve.name.as_str())).collect();
    paint(path, SIZE, |root| {
        let area = head(root, title, subtitle, &legend)?;
        let x = Axis { name: "frame", range: 0.0..last_frame, ticks: X_TICKS, tick: &whole };
        let y = Axis { name: unit, range: 0.0..top, ticks: Y_TICKS, tick: &tick };
        let mut chart = chart(&area, x, y)?;
        for curve in &shown {
            let points = curve.values.iter().enumerate().filter(|(_, value)| value.is_finite());
            let points = points.map(|(frame, &value)| (frame as f64, value)).collect();
            curve.pen.draw(&mut chart, points)?;
        }
        Ok(())
    })
}

/// Error against run time: one series a parameter, one labelled point a setting. The lower left
/// corner is the place to be.
///
/// # Errors
///
/// [`crate::Error::File`] with the path and the reason.
pub fn error_against_time(path: &Path, title: &str, subtitle: &str, series: &[ScatterSeries]) -> Result<()> {
    let finite = |point: &&ScatterPoint| point.ms.is_finite() && point.wrong_percent.is_finite();
    let all: Vec<&ScatterPoint> = series.iter().flat_map(|series| &series.points).filter(finite).collect();
    let scale = ErrorScale::of(all.iter().map(|point| point.wrong_percent));
    let times = time_range(all.iter().map(|point| point.ms));
    let pens = || (0..series.len()).map(Pen::nth);
    let legend: Vec<(Pen, &str)> = pens().zip(series.iter().map(|series| series.name.as_str())).collect();
    paint(path, SIZE, |root| {
        let area = head(root, title, subtitle, &legend)?;
        let y_tick = |place| scale.tick(place);
        let x = Axis { name: "milliseconds a frame", range: times, ticks: X_TICKS, tick: &tick };
        let y = Axis { name: "wrong pixels, percent", range: scale.range(), ticks: Y_TICKS, tick: &y_tick };
        let mut chart = chart(&area, x, y)?;
        let (mut dots, mut lines) = (Vec::new(), Vec::new());
        for (pen, series) in pens().zip(series) {
            let points = series.points.iter().filter(finite);
            let points: Vec<(f64, f64)> = points.map(|point| (point.ms, scale.place(point.wrong_percent))).collect();
            pen.draw(&mut chart, points.clone())?;
            let dot = |&point| Circle::new(point, px(5), pen.colour().filled());
            chart.draw_series(points.iter().map(dot))?;
            let places: Vec<(i32, i32)> = points.iter().map(|point| chart.backend_coord(point)).collect();
            dots.extend_from_slice(&places);
            lines.push(places);
        }
        let (columns, rows) = chart.plotting_area().get_pixel_range();
        let inside = [columns.start, rows.start, columns.end, rows.end];
        let labels: Vec<&str> = all.iter().map(|point| point.label.as_str()).collect();
        let mut taken = Taken::new(inside, &dots, &lines);
        taken.place_labels(root, &dots, &labels, &text(17, INK))
    })
}

/// Frames have whole numbers; between them nothing is written.
fn whole(frame: f64) -> String {
    if frame.fract() == 0.0 { tick(frame) } else { String::new() }
}

/// The span of the times with a margin; from zero if the fastest is less than a third of the slowest.
fn time_range(times: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
    let (least, greatest) =
        times.fold((f64::INFINITY, 0.0f64), |(least, greatest), time| (least.min(time), greatest.max(time)));
    if greatest <= 0.0 {
        return 0.0..1.0;
    }
    let span = (greatest - least).max(greatest * 0.05);
    let left = if least < greatest / 3.0 { 0.0 } else { (least - span * 0.12).max(0.0) };
    left..greatest + span * 0.12
}

/// How wrong pixels are laid out upwards: plain, or by decades when they span more than two. Below
/// zero there is a little room, so that faultless settings do not stand on the axis.
enum ErrorScale {
    /// In percent.
    Plain { top: f64 },
    /// Exponents of 10; errors of zero lie on the floor.
    Decades { floor: i32, top: i32 },
}

impl ErrorScale {
    fn of(percents: impl Iterator<Item = f64> + Clone) -> ErrorScale {
        let greatest = percents.clone().fold(0.0, f64::max);
        let least = percents.filter(|percent| *percent > 0.0).fold(f64::INFINITY, f64::min);
        if greatest > 100.0 * least {
            let floor = least.log10().floor() as i32 - 1;
            return ErrorScale::Decades { floor, top: greatest.log10().ceil() as i32 };
        }
        ErrorScale::Plain { top: if greatest > 0.0 { greatest * 1.1 } else { 1.0 } }
    }

    fn range(&self) -> std::ops::Range<f64> {
        match *self {
            ErrorScale::Plain { top } => -0.06 * top..top,
            ErrorScale::Decades { floor, top } => f64::from(floor) - 0.35..f64::from(top),
        }
    }

    fn place(&self, percent: f64) -> f64 {
        match *self {
            ErrorScale::Plain { .. } => percent,
            ErrorScale::Decades { floor, .. } if percent <= 0.0 => f64::from(floor),
            ErrorScale::Decades { floor, .. } => percent.log10().max(f64::from(floor)),
        }
    }

    fn tick(&self, place: f64) -> String {
        match *self {
            ErrorScale::Plain { .. } if place < 0.0 => String::new(),
            ErrorScale::Plain { .. } => tick(place),
            ErrorScale::Decades { floor, .. } if place == f64::from(floor) => "0".to_string(),
            ErrorScale::Decades { .. } if place.fract() == 0.0 => tick(10f64.powf(place)),
            ErrorScale::Decades { .. } => String::new(),
        }
    }
}
