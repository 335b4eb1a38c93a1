//! `homcull` alone: the city walkthrough, every method that pays, with a report in `homcull-out/`.

use std::path::Path;

use super::arguments::Options;
use super::{files, setting, walk};
use crate::cull::Method;
use crate::error::Result;
use crate::measure::plot::{ScatterPoint, ScatterSeries, error_against_time};
use crate::measure::report::WalkReport;

/// Where the report goes.
const OUT: &str = "homcull-out";
/// The scene.
const SCENE: &str = "city";
/// Frames of the walk: all of the path's stretches, in well under a minute.
const FRAMES: u32 = 48;
/// Frames of the walks that turn a knob.
const KNOB_FRAMES: u32 = 8;
const METHODS: [&str; 5] = ["vfc", "hom", "hom-multipass", "hom-progressive", "ideal"];
/// The first knobs that trade error for time: the opacity threshold, and the buffer's resolution.
const THRESHOLDS: [&str; 5] = ["1", "0.95", "0.85", "0.7", "0.5"];
const RESOLUTIONS: [&str; 4] = ["640x512", "320x256", "256x256", "160x128"];

/// Walks, prints, writes.
pub fn run(options: &Options) -> Result<()> {
    let out = files::folder(options.out.as_deref().unwrap_or(Path::new(OUT)))?;
    let options = Options { frames: options.frames.or(Some(FRAMES)), ..options.clone() };
    let methods = METHODS.iter().map(|m| Method::parse(m)).collect::<Result<Vec<_>>>()?;
    let setting = setting::load(SCENE, &options, false)?;
    if !options.quiet {
        say!("The city: {} objects, {} triangles.", setting.scene.objects.len(), setting.scene.triangles());
    }
    let two = Options { repetitions: options.repetitions.or(Some(3)), ..options.clone() };
    let report = walk::walk_setting(&setting, &methods, &two, Some(&out))?;
    walk::print(&report, &options)?;
    walk::plots(&report, &out)?;
    let knobs = knobs(&options)?;
    let title = "Error against run time: the city";
    let series = series(&knobs);
    error_against_time(&out.join("error-against-time.png"), title, "mean of frames; hom-progressive", &series)?;
    if !options.quiet {
        print_knobs(&knobs);
        say!("\nPictures and graphs: {}", out.display());
    }
    Ok(())
}

/// A shorter walk for each setting of each knob.
fn knobs(options: &Options) -> Result<WalkReport> {
    let settings = THRESHOLDS.iter().map(|t| format!("hom-progressive:threshold={t}"));
    let settings = settings.chain(RESOLUTIONS.iter().map(|r| format!("hom-progressive:resolution={r}")));
    let methods = settings.map(|m| Method::parse(&m)).collect::<Result<Vec<_>>>()?;
    let options = Options {
        frames: Some(options.frames.unwrap_or(FRAMES).min(KNOB_FRAMES)),
        json: None,
        csv: None,
        ..options.clone()
    };
    let setting = setting::load(SCENE, &options, false)?;
    walk::walk_setting(&setting, &methods, &options, None)
}

fn series(report: &WalkReport) -> Vec<ScatterSeries> {
    let point = |i: usize, parameter: &str| {
        let run = &report.runs[i];
        ScatterPoint {
            ms: run.frame_ms().total / report.frames.max(1) as f64,
            wrong_percent: run.wrong_pixels_percent(report.pixels()).map_or(0.0, |w| w.mean),
            label: run.parameter(parameter).unwrap_or("display").to_owned(),
        }
    };
    let thresholds = (0..THRESHOLDS.len()).map(|i| point(i, "threshold")).collect();
    let resolutions =
        std::iter::once(0).chain(THRESHOLDS.len()..report.runs.len()).map(|i| point(i, "resolution")).collect();
    vec![
        ScatterSeries { name: "opacity threshold".into(), points: thresholds },
        ScatterSeries { name: "samples of the buffer".into(), points: resolutions },
    ]
}

fn print_knobs(report: &WalkReport) {
    use crate::measure::report_number::digits3;
    use crate::measure::table::Table;
    let mut table = Table::new()
        .left("hom-progressive")
        .right("ms")
        .right("wrong pixels %")
        .right("wrongly culled objects")
        .right("drawn");
    for run in &report.runs {
        let setting = match run.parameter("resolution") {
            Some(r) => format!("resolution={r}"),
            None => format!("threshold={}", run.parameter("threshold").unwrap_or("1")),
        };
        let wrong = run.wrong_pixels_percent(report.pixels()).map_or("-".into(), |w| digits3(w.mean));
        let culled = run.wrongly_culled_objects().map_or("-".into(), |n| n.to_string());
        let mean = run.mean(report.pixels());
        let ms = digits3(run.frame_ms().total / report.frames.max(1) as f64);
        table.row([setting, ms, wrong, culled, digits3(mean.objects_drawn)]);
    }
    say!("\nError against run time, the first knobs ({} frames):\n\n{table}", report.frames);
}
