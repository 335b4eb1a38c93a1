//! What a walk along a camera path measured, and the figures that follow from it.
//!
//! One [`FrameRecord`] a frame and method, gathered in [`MethodRun`]s, gathered in a
//! [`WalkReport`]. Nothing is summarized while measuring; every summary is derived here, in one
//! place, so that the table, the JSON and the plots cannot disagree. Times are in milliseconds.
//!
//! Ratios between methods are given three ways, because the papers differ: the mean of the frames'
//! ratios (as Bittner et al. 2004 print theirs), the ratio of the mean times, and the extreme frame.
//! The counts of a frame are the four curves of the thesis' culling graph (section 8.3.1): triangles
//! after level of detail, in the frustum, after occlusion culling, and exactly visible, where all
//! triangles of an object count as visible when one sample of it is.

use super::statistics::{mean, median, percentile, range};
use crate::occlusion::OverlapStatistics;

/// The method that all speed-ups are measured against: view-frustum culling alone.
pub const BASELINE: &str = "vfc";
/// The method that draws exactly what is visible and decides nothing.
pub const IDEAL: &str = "ideal";

/// The time of a frame's stages, in milliseconds.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StageTimes {
    /// Choosing occluders.
    pub select: f64,
    /// Rasterizing occluders.
    pub occluders: f64,
    /// Building the pyramid of occlusion maps.
    pub pyramid: f64,
    /// Testing objects.
    pub cull: f64,
    /// The final draw on the CPU.
    pub draw: f64,
}

/// A frame's time in the pipeline (thesis 8.1), in milliseconds. Beside it [`StageTimes`] hold the time at work: of OccSel `select`, of
/// Cull `cull`, of the Draw stage `occluders`, `pyramid` and `draw`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PipelineTimes {
    /// From the frame's view to its picture.
    pub latency: f64,
    /// OccSel waiting for the frame.
    pub select_waiting: f64,
    /// Cull waiting for the frame.
    pub cull_waiting: f64,
    /// The Draw stage waiting for OccSel and for Cull.
    pub draw_waiting: f64,
}

/// What one stage of a composed method left, and what it cost: in a frame, or on the mean of frames.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StageCounts {
    /// The stage's method.
    pub method: String,
    /// Objects that it left to the next stage, or to be drawn.
    pub objects_left: f64,
    /// Their triangles.
    pub triangles_left: f64,
    /// Occlusion tests of boxes.
    pub queries: f64,
    /// Triangles drawn as occluders.
    pub occluder_triangles: f64,
    /// Its time, in milliseconds, with the draw of a stage that draws while it culls.
    pub ms: f64,
}

/// What one frame of one method measured.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FrameRecord {
    /// The whole frame, selection to final draw, in milliseconds.
    pub frame_ms: f64,
    /// Its parts, in milliseconds; they need not add up to the whole.
    pub stage_ms: StageTimes,
    /// Of a composed method, its stages in order; else none.
    pub stages: Vec<StageCounts>,
    /// What the pipeline adds; `None` for a frame drawn in turn.
    pub pipeline_ms: Option<PipelineTimes>,
    /// Objects that view-frustum culling leaves.
    pub objects_in_frustum: u32,
    /// Objects that the method draws.
    pub objects_drawn: u32,
    /// Objects with a sample in the exact image; `None` without the exact reference.
    pub objects_visible_exact: Option<u32>,
    /// Triangles of the whole scene at the frame's levels of detail.
    pub triangles_after_lod: u64,
    /// Triangles of the objects in the frustum.
    pub triangles_in_frustum: u64,
    /// Triangles of the objects drawn.
    pub triangles_drawn: u64,
    /// Triangles of the exactly visible objects; `None` without the exact reference.
    pub triangles_visible_exact: Option<u64>,
    /// Samples covered by the triangles drawn, hidden ones included.
    pub fragments: u64,
    /// Triangles drawn as occluders, into another buffer than the picture.
    pub occluder_triangles: u64,
    /// Occlusion tests of boxes.
    pub queries: u64,
    /// What was waited for answers to occlusion queries, of the frame's first repetition: steps, and milliseconds of a device with a thread.
    pub waited_steps: u64,
    /// See `waited_steps`.
    pub waited_ms: f64,
    /// Whether the method gave up testing in this frame because nothing was hidden, or, of `pvs`, no view point was in reach.
    pub bypassed: bool,
    /// Objects with a sample in the exact image that were not drawn; `None` without the reference.
    pub wrongly_culled: Option<u32>,
    /// Pixels that differ from the image of everything in the frustum; `None` without the reference.
    pub wrong_pixels: Option<u64>,
}

/// One method's walk along the path.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MethodRun {
    /// What a preset calls it.
    pub name: Option<String>,
    /// The method's name, without parameters.
    pub method: String,
    /// Its parameters and their values, in the order in which the method prints them.
    pub parameters: Vec<(String, String)>,
    /// One record a frame, in path order.
    pub frames: Vec<FrameRecord>,
    /// Hash of all frames' colours, depths and object ids.
    pub image_hash: u64,
    /// Hash of all frames' visible sets.
    pub visible_set_hash: u64,
    /// Overlap tests by the level of the pyramid that decided them, where tests walk it.
    pub overlap: OverlapStatistics,
}

/// A walk along a camera path with one or more methods.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WalkReport {
    /// The scene as the user named it.
    pub scene_name: String,
    /// Objects in the scene.
    pub objects: u64,
    /// Triangles in the scene, at full detail.
    pub triangles: u64,
    /// Width of the view in pixels.
    pub width: u32,
    /// Height of the view in pixels.
    pub height: u32,
    /// Frames of the path.
    pub frames: usize,
    /// The SIMD level used, as `--simd` names it.
    pub simd: String,
    /// Threads used.
    pub threads: usize,
    /// The clock in GHz, measured beside the runs.
    pub clock_ghz: f64,
    /// The process's peak memory in bytes after the walk; `None` where the system does not tell.
    pub peak_memory_bytes: Option<u64>,
    /// The methods' runs, in the order asked for.
    pub runs: Vec<MethodRun>,
}

/// A run's frame times in milliseconds; all zero without frames.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FrameTimes {
    /// The median frame.
    pub median: f64,
    /// The 95th percentile, by nearest rank.
    pub p95: f64,
    /// The fastest frame.
    pub min: f64,
    /// The slowest frame.
    pub max: f64,
    /// All frames together.
    pub total: f64,
}

/// The means per frame of a run's counts; zero or `None` without frames.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MeanCounts {
    /// Objects in the frustum.
    pub objects_in_frustum: f64,
    /// Objects drawn.
    pub objects_drawn: f64,
    /// Objects exactly visible; `None` unless known in every frame.
    pub objects_visible_exact: Option<f64>,
    /// Triangles after level of detail.
    pub triangles_after_lod: f64,
    /// Triangles in the frustum.
    pub triangles_in_frustum: f64,
    /// Triangles drawn.
    pub triangles_drawn: f64,
    /// Triangles exactly visible; `None` unless known in every frame.
    pub triangles_visible_exact: Option<f64>,
    /// Samples covered by the drawn triangles for each pixel of the view.
    pub depth_complexity: f64,
    /// Triangles drawn as occluders.
    pub occluder_triangles: f64,
    /// Occlusion tests.
    pub queries: f64,
    /// Steps waited for their answers.
    pub waited_steps: f64,
    /// Milliseconds waited for their answers.
    pub waited_ms: f64,
}

/// A ratio of two runs' frame times, three ways.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameRatios {
    /// The mean over the frames of each frame's ratio.
    pub mean_of_frames: f64,
    /// The ratio of the mean times.
    pub of_means: f64,
    /// The frame with the greatest ratio: the best for a speed-up, the worst for a time over ideal.
    pub greatest_frame: f64,
}

/// Pixels that differ from the exact image, in percent of the view's pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WrongPixels {
    /// The mean over the frames.
    pub mean: f64,
    /// The worst frame.
    pub max: f64,
}

impl FrameRecord {
    /// From the frame's view to its picture, in milliseconds: in turn, the frame's time.
    pub fn latency_ms(&self) -> f64 {
        self.pipeline_ms.map_or(self.frame_ms, |times| times.latency)
    }

    /// Samples covered for each of the view's `pixels`; zero for an empty view.
    pub fn depth_complexity(&self, pixels: u64) -> f64 {
        if pixels == 0 { 0.0 } else { self.fragments as f64 / pixels as f64 }
    }
}

impl MethodRun {
    /// The frame times, summarized.
    pub fn frame_ms(&self) -> FrameTimes {
        summary(&self.times_ms())
    }

    /// The latencies, summarized.
    pub fn latency_ms(&self) -> FrameTimes {
        summary(&self.frames.iter().map(FrameRecord::latency_ms).collect::<Vec<_>>())
    }

    /// The means of the pipeline's times; `None` unless every frame went through it.
    pub fn pipeline_ms(&self) -> Option<PipelineTimes> {
        let stage = |of: fn(&PipelineTimes) -> f64| self.mean_if_known(|frame| frame.pipeline_ms.as_ref().map(of));
        Some(PipelineTimes {
            latency: stage(|times| times.latency)?,
            select_waiting: stage(|times| times.select_waiting)?,
            cull_waiting: stage(|times| times.cull_waiting)?,
            draw_waiting: stage(|times| times.draw_waiting)?,
        })
    }

    /// The mean time of each stage in milliseconds; zero without frames.
    pub fn stage_ms(&self) -> StageTimes {
        let stage = |of: fn(&StageTimes) -> f64| self.mean_of(|frame| of(&frame.stage_ms));
        StageTimes {
            select: stage(|stages| stages.select),
            occluders: stage(|stages| stages.occluders),
            pyramid: stage(|stages| stages.pyramid),
            cull: stage(|stages| stages.cull),
            draw: stage(|stages| stages.draw),
        }
    }

    /// Its frame times over those of another run of the same walk.
    pub fn time_over(&self, other: &MethodRun) -> Option<FrameRatios> {
        ratios(&self.times_ms(), &other.times_ms())
    }

    /// The stages of a composed method, on the mean of frames; none of another one.
    pub fn stages(&self) -> Vec<StageCounts> {
        let Some(first) = self.frames.first() else { return Vec::new() };
        let stage = |(i, stage): (usize, &StageCounts)| {
            let mean = |of: fn(&StageCounts) -> f64| self.mean_of(|frame| frame.stages.get(i).map_or(f64::NAN, of));
            StageCounts {
                method: stage.method.clone(),
                objects_left: mean(|stage| stage.objects_left),
                triangles_left: mean(|stage| stage.triangles_left),
                queries: mean(|stage| stage.queries),
                occluder_triangles: mean(|stage| stage.occluder_triangles),
                ms: mean(|stage| stage.ms),
            }
        };
        first.stages.iter().enumerate().map(stage).collect()
    }

    /// The means per frame of the counts, for a view of so many `pixels`.
    pub fn mean(&self, pixels: u64) -> MeanCounts {
        MeanCounts {
            objects_in_frustum: self.mean_of(|frame| frame.objects_in_frustum.into()),
            objects_drawn: self.mean_of(|frame| frame.objects_drawn.into()),
            objects_visible_exact: self.mean_if_known(|frame| frame.objects_visible_exact.map(f64::from)),
            triangles_after_lod: self.mean_of(|frame| frame.triangles_after_lod as f64),
            triangles_in_frustum: self.mean_of(|frame| frame.triangles_in_frustum as f64),
            triangles_drawn: self.mean_of(|frame| frame.triangles_drawn as f64),
            triangles_visible_exact: self
                .mean_if_known(|frame| frame.triangles_visible_exact.map(|count| count as f64)),
            depth_complexity: self.mean_of(|frame| frame.depth_complexity(pixels)),
            occluder_triangles: self.mean_of(|frame| frame.occluder_triangles as f64),
            queries: self.mean_of(|frame| frame.queries as f64),
            waited_steps: self.mean_of(|frame| frame.waited_steps as f64),
            waited_ms: self.mean_of(|frame| frame.waited_ms),
        }
    }

    /// Wrongly culled objects over all frames; `None` unless known in every frame.
    pub fn wrongly_culled_objects(&self) -> Option<u64> {
        if self.frames.is_empty() {
            return None;
        }
        self.frames.iter().map(|frame| frame.wrongly_culled.map(u64::from)).sum()
    }

    /// Frames in which the method gave up testing.
    pub fn bypassed_frames(&self) -> usize {
        self.frames.iter().filter(|frame| frame.bypassed).count()
    }

    /// The wrong pixels of a view of so many `pixels`; `None` unless known in every frame.
    pub fn wrong_pixels_percent(&self, pixels: u64) -> Option<WrongPixels> {
        let percents: Option<Vec<f64>> = self
            .frames
            .iter()
            .map(|frame| frame.wrong_pixels.map(|wrong| 100.0 * wrong as f64 / pixels.max(1) as f64))
            .collect();
        let percents = percents?;
        let (_, max) = range(&percents)?;
        Some(WrongPixels { mean: mean(percents)?, max })
    }

    /// The value of a parameter by its name.
    pub fn parameter(&self, name: &str) -> Option<&str> {
        self.parameters.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// The method as the user writes it, `hom:depth=nbz,threshold=0.85`, all parameters included.
    pub fn full_name(&self) -> String {
        self.name_with(|_, _| true)
    }

    fn name_with(&self, keep: impl Fn(&str, &str) -> bool) -> String {
        let kept: Vec<String> = self
            .parameters
            .iter()
            .filter(|(key, value)| keep(key, value))
            .map(|(key, value)| format!("{key}={value}"))
            .collect();
        if kept.is_empty() { self.method.clone() } else { format!("{}:{}", self.method, kept.join(",")) }
    }

    fn times_ms(&self) -> Vec<f64> {
        self.frames.iter().map(|frame| frame.frame_ms).collect()
    }

    fn mean_of(&self, of: impl Fn(&FrameRecord) -> f64) -> f64 {
        mean(self.frames.iter().map(of)).unwrap_or_default()
    }

    fn mean_if_known(&self, of: impl Fn(&FrameRecord) -> Option<f64>) -> Option<f64> {
        let known: Option<Vec<f64>> = self.frames.iter().map(of).collect();
        mean(known?)
    }
}

impl WalkReport {
    /// Pixels of the view.
    pub fn pixels(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    /// How many times faster than view-frustum culling alone `run` is; its greatest frame is the
    /// best. `None` without a `vfc` run in this report, and 1 for that run itself.
    pub fn speedup_over_vfc(&self, run: &MethodRun) -> Option<FrameRatios> {
        let baseline = self.runs.iter().find(|run| run.method == BASELINE)?;
        ratios(&baseline.times_ms(), &run.times_ms())
    }

    /// How many times the ideal method's time `run` takes; its greatest frame is the worst. `None`
    /// without an `ideal` run of the exact set in this report.
    pub fn time_over_ideal(&self, run: &MethodRun) -> Option<FrameRatios> {
        let exact = |run: &&MethodRun| run.method == IDEAL && run.parameter("set").is_none_or(|set| set == "exact");
        let ideal = self.runs.iter().find(exact)?;
        ratios(&run.times_ms(), &ideal.times_ms())
    }

    /// Whether the run's images are the first run's, bit for bit.
    pub fn image_equals_first(&self, run: &MethodRun) -> bool {
        self.runs.first().is_none_or(|first| first.image_hash == run.image_hash)
    }

    /// A short name for each run: what a preset calls it, else the method, with those parameters only in which it differs from
    /// another run of the same method.
    pub fn labels(&self) -> Vec<String> {
        let differs = |run: &MethodRun, key: &str, value: &str| {
            let mut others = self.runs.iter().filter(|other| other.method == run.method);
            others.any(|other| other.parameter(key) != Some(value))
        };
        let made = |run: &MethodRun| run.name_with(|key, value| differs(run, key, value));
        self.runs.iter().map(|run| run.name.clone().unwrap_or_else(|| made(run))).collect()
    }
}

fn summary(times: &[f64]) -> FrameTimes {
    let (min, max) = range(times).unwrap_or_default();
    FrameTimes {
        median: median(times).unwrap_or_default(),
        p95: percentile(times, 95.0).unwrap_or_default(),
        min,
        max,
        total: times.iter().sum(),
    }
}

/// The ratios of two runs' frames; frames in which the divisor took no time are left out of the
/// frames' ratios. `None` if nothing is left.
fn ratios(dividends: &[f64], divisors: &[f64]) -> Option<FrameRatios> {
    let frames: Vec<f64> = dividends
        .iter()
        .zip(divisors)
        .filter(|&(_, &divisor)| divisor > 0.0)
        .map(|(dividend, divisor)| dividend / divisor)
        .collect();
    let (_, greatest_frame) = range(&frames)?;
    let of_means = mean(dividends.iter().copied())? / mean(divisors.iter().copied())?;
    Some(FrameRatios { mean_of_frames: mean(frames)?, of_means, greatest_frame })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(method: &str, times_ms: &[f64]) -> MethodRun {
        let frames = times_ms.iter().map(|&frame_ms| FrameRecord { frame_ms, ..FrameRecord::default() }).collect();
        MethodRun { method: method.into(), frames, ..MethodRun::default() }
    }

    #[test]
    fn the_three_ratios_differ_as_they_should() {
        let runs = vec![run("vfc", &[10.0, 40.0]), run("hom", &[10.0, 10.0])];
        let report = WalkReport { runs, ..WalkReport::default() };
        let speedup = report.speedup_over_vfc(&report.runs[1]).unwrap();
        assert_eq!((speedup.mean_of_frames, speedup.of_means), (2.5, 2.5));
        assert_eq!(speedup.greatest_frame, 4.0);
        let own = report.speedup_over_vfc(&report.runs[0]).unwrap();
        assert_eq!((own.mean_of_frames, own.of_means, own.greatest_frame), (1.0, 1.0, 1.0));
        assert_eq!(report.time_over_ideal(&report.runs[1]), None);
    }

    #[test]
    fn only_the_exact_set_is_ideal() {
        let mut lesser = run("ideal", &[1.0]);
        lesser.parameters = vec![("set".into(), "stop-and-wait".into())];
        let mut report = WalkReport { runs: vec![lesser, run("hom", &[6.0])], ..WalkReport::default() };
        assert_eq!(report.time_over_ideal(&report.runs[1]), None);
        report.runs.push(run("ideal", &[2.0]));
        assert_eq!(report.time_over_ideal(&report.runs[1]).unwrap().of_means, 3.0);
    }

    #[test]
    fn a_walk_without_frames_or_time_divides_by_nothing() {
        let empty = WalkReport { runs: vec![run("vfc", &[])], ..WalkReport::default() };
        assert_eq!(empty.speedup_over_vfc(&empty.runs[0]), None);
        assert_eq!(empty.runs[0].frame_ms(), FrameTimes::default());
        assert_eq!(empty.runs[0].wrong_pixels_percent(0), None);
        let idle = WalkReport { runs: vec![run("vfc", &[0.0])], ..WalkReport::default() };
        assert_eq!(idle.speedup_over_vfc(&idle.runs[0]), None);
    }

    #[test]
    fn labels_name_only_what_differs() {
        let with = |threshold: &str| MethodRun {
            parameters: vec![("depth".into(), "nbz".into()), ("threshold".into(), threshold.into())],
            ..run("hom", &[1.0])
        };
        let runs = vec![run("vfc", &[1.0]), with("1"), with("0.85")];
        let report = WalkReport { runs, ..WalkReport::default() };
        assert_eq!(report.labels(), ["vfc", "hom:threshold=1", "hom:threshold=0.85"]);
        assert_eq!(report.runs[2].full_name(), "hom:depth=nbz,threshold=0.85");
    }
}
