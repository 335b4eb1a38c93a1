//! The pipeline (thesis 8.1): the schedule of figure 8.2, results equal to those in turn, failures that are reported.
#![cfg(feature = "cli")]

use std::process::Command;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Condvar, Mutex};
use std::time::{Duration, Instant};

use homcull::cull::hom::{self, HomFrame};
use homcull::cull::vfc::World;
use homcull::cull::{HomParameters, Method, VisibleSet};
use homcull::pipeline::{self, DrawStage, FrameInput, FrameTimes, run_in_turn, run_pipelined};
use homcull::scene::{PreparedScene, parse};
use homcull::view::{View, Viewport};
use homcull::workers::Workers;
use homcull::{Error, Result};
use homcull_simd::Level;
use serde_json::Value;

/// Longer than anything here takes: who waits so long waits for ever.
const FOR_EVER: Duration = Duration::from_secs(60);

/// Runs something that must not hang.
fn in_time<T: Send + 'static>(what: &str, run: impl FnOnce() -> T + Send + 'static) -> T {
    let (done, wait) = channel();
    std::thread::spawn(move || done.send(run()));
    match wait.recv_timeout(FOR_EVER) {
        Ok(value) => value,
        Err(RecvTimeoutError::Timeout) => panic!("{what}: hangs"),
        Err(RecvTimeoutError::Disconnected) => panic!("{what}: panicked"),
    }
}

// ---- the schedule, with stages that only take notes

/// What happened, in order; and somebody who waits for it.
type Entries = Mutex<Vec<(&'static str, usize)>>;

#[derive(Clone, Default)]
struct Log(Arc<(Entries, Condvar)>);

impl Log {
    fn note(&self, what: &'static str, frame: usize) {
        self.0.0.lock().unwrap().push((what, frame));
        self.0.1.notify_all();
    }

    fn wait_for(&self, what: &'static str, frame: usize) -> Result<()> {
        let lock = self.0.0.lock().unwrap();
        let until = |notes: &mut Vec<_>| !notes.contains(&(what, frame));
        let (_lock, timeout) = self.0.1.wait_timeout_while(lock, Duration::from_secs(20), until).unwrap();
        let missing = || Error::parameter("overlap", format!("{what} {frame}"), "never came");
        if timeout.timed_out() { Err(missing()) } else { Ok(()) }
    }

    /// Where in the log something stands.
    fn place(&self, what: &'static str, frame: usize) -> usize {
        let notes = self.0.0.lock().unwrap();
        let found = notes.iter().position(|&n| n == (what, frame));
        found.unwrap_or_else(|| panic!("no {what} {frame} in {notes:?}"))
    }
}

#[derive(Clone, Copy, PartialEq, Debug)]
enum How {
    Error,
    Panic,
}

/// Stages for so many frames; one may fail at a frame.
#[derive(Clone, Default)]
struct Notes {
    log: Log,
    frames: usize,
    fails: Option<(&'static str, usize, How)>,
    drawn: Vec<(usize, FrameTimes)>,
}

impl Notes {
    fn at(&self, stage: &'static str, frame: usize) -> Result<()> {
        match self.fails {
            Some((s, f, How::Error)) if (s, f) == (stage, frame) => {
                Err(Error::parameter("stage", stage, "fails as it was told"))
            }
            // Without the hook's message on standard error.
            Some((s, f, How::Panic)) if (s, f) == (stage, frame) => {
                std::panic::resume_unwind(Box::new(format!("{stage} panics as it was told")))
            }
            _ => Ok(()),
        }
    }

    fn run(&mut self, pipelined: bool) -> Result<()> {
        let (own, other) = (self.clone(), self.clone());
        let select = move |frame, order: usize| {
            own.log.note("OccSel begins", frame);
            own.at("OccSel", frame)?;
            Ok(order + 1)
        };
        let cull = move |frame: usize, represented: usize| {
            // All that the schedule lets overlap with this, if there is such a frame.
            if pipelined && other.fails.is_none() {
                if frame + 1 < other.frames {
                    other.log.wait_for("OccDraw ends", frame + 1)?;
                }
                if frame + 2 < other.frames {
                    other.log.wait_for("OccSel begins", frame + 2)?;
                }
                if frame >= 1 {
                    other.log.wait_for("FinalDraw ends", frame - 1)?;
                }
            }
            other.at("Cull", frame)?;
            other.log.note("Cull ends", frame);
            Ok(represented + 1)
        };
        if pipelined { run_pipelined(self, select, cull) } else { run_in_turn(self, select, cull) }
    }
}

impl DrawStage for Notes {
    type Order = usize;
    type Selected = usize;
    type Represented = usize;
    type Culled = usize;

    fn order(&mut self, frame: usize) -> Result<Option<usize>> {
        self.at("order", frame)?;
        self.log.note("order", frame);
        Ok((frame < self.frames).then_some(1000 * frame))
    }

    fn draw_occluders(&mut self, frame: usize, selected: usize) -> Result<usize> {
        self.log.note("OccDraw begins", frame);
        self.at("OccDraw", frame)?;
        self.log.note("OccDraw ends", frame);
        Ok(selected + 1)
    }

    fn draw(&mut self, frame: usize, culled: &mut usize) -> Result<()> {
        self.at("FinalDraw", frame)?;
        assert_eq!(*culled, 1000 * frame + 3, "each stage had it once");
        self.log.note("FinalDraw ends", frame);
        Ok(())
    }

    fn complete(&mut self, frame: usize, _culled: usize, times: FrameTimes) -> Result<()> {
        self.at("complete", frame)?;
        self.log.note("complete", frame);
        self.drawn.push((frame, times));
        Ok(())
    }
}

#[test]
fn every_frame_is_drawn_once_and_in_order_and_stages_overlap_as_in_figure_8_2() {
    for frames in [0, 1, 2, 3, 4, 9] {
        for pipelined in [true, false] {
            let notes = in_time("a run", move || {
                let mut notes = Notes { frames, ..Notes::default() };
                // In the pipeline Cull waits for what must overlap with it: in turn that would fail.
                notes.run(pipelined).unwrap();
                notes
            });
            assert!(notes.drawn.iter().map(|d| d.0).eq(0..frames), "{frames} frames: {:?}", notes.drawn);
            for k in 3..frames {
                // OccSel k hears of frame k-3; no view is asked for before its time.
                assert!(notes.log.place("complete", k - 3) < notes.log.place("order", k));
                assert!(notes.log.place("order", k) < notes.log.place("OccSel begins", k));
            }
            for k in 2..frames {
                // Frames k-1 and k have an occlusion buffer each; k-2 must have given its back.
                assert!(notes.log.place("complete", k - 2) < notes.log.place("OccDraw begins", k));
                assert!(notes.log.place("Cull ends", k - 2) < notes.log.place("OccDraw begins", k));
            }
        }
    }
}

#[test]
fn a_stage_that_fails_is_reported_with_its_frame_and_nobody_hangs() {
    let stages = ["order", "OccSel", "OccDraw", "Cull", "FinalDraw", "complete"];
    for stage in stages {
        for how in [How::Error, How::Panic] {
            for at in [0, 1, 2, 5, 7] {
                for pipelined in [true, false] {
                    let what = format!("{stage} of frame {at}, {how:?}, pipelined {pipelined}");
                    let (notes, result) = in_time(&what, move || {
                        let mut notes = Notes { frames: 8, fails: Some((stage, at, how)), ..Notes::default() };
                        let result = notes.run(pipelined);
                        (notes, result)
                    });
                    let Err(Error::Stage { stage: named, frame, reason }) = &result else {
                        panic!("{what}: {result:?}")
                    };
                    let should = if ["order", "complete"].contains(&stage) { "Draw" } else { stage };
                    assert_eq!((*named, *frame), (should, at), "{what}: {reason}");
                    assert!(reason.contains("as it was told"), "{what}: {reason}");
                    assert_eq!(reason.contains("panicked"), how == How::Panic, "{what}: {reason}");
                    // What was complete before stays so, in order; nothing after it is drawn.
                    assert!(notes.drawn.iter().map(|d| d.0).eq(0..notes.drawn.len()), "{what}");
                    assert!(notes.drawn.len() <= at, "{what}: {:?}", notes.drawn);
                }
            }
        }
    }
}

#[test]
fn frame_times_add_up_to_the_run_and_latencies_hold_all_the_work() {
    for pipelined in [true, false] {
        let mut notes = Notes { frames: 30, ..Notes::default() };
        let start = Instant::now();
        notes.run(pipelined).unwrap();
        let wall = start.elapsed().as_secs_f64() * 1e3;
        let total: f64 = notes.drawn.iter().map(|(_, t)| t.frame_ms).sum();
        assert!(total <= wall && total > 0.0, "{total} of {wall} ms");
        for (frame, t) in &notes.drawn {
            let work = t.select.busy_ms + t.occluders.busy_ms + t.cull.busy_ms + t.draw.busy_ms;
            assert!(t.latency_ms >= work, "frame {frame}: {t:?}");
            assert!(pipelined || t.cull.waiting_ms == 0.0, "frame {frame}: {t:?}");
        }
    }
}

// ---- the hom methods

struct Ground {
    scene: PreparedScene,
    views: Vec<View>,
}

fn ground(scene: &str, frames: usize, size: (u32, u32)) -> Ground {
    let generated = parse(scene).unwrap();
    let viewport = Viewport::new(size.0, size.1).unwrap();
    let cameras = generated.path.sample(frames).unwrap();
    let views = cameras.iter().map(|camera| camera.view(viewport).unwrap()).collect();
    Ground { scene: PreparedScene::new(&generated.scene).unwrap(), views }
}

fn parameters(text: &str) -> HomParameters {
    match Method::parse(text).unwrap() {
        Method::Hom(parameters) => parameters,
        other => panic!("{other:?} has no pipeline"),
    }
}

/// What a frame gives: all but the time.
type Given = (VisibleSet, u64, Vec<u32>);

fn given(ground: &Ground, threads: usize, parameters: &HomParameters, inputs: &[FrameInput]) -> Vec<Given> {
    let (world, workers) = (World::new(&ground.scene), Workers::new(threads).unwrap());
    let mut out = Vec::new();
    pipeline::run(&world, Level::best(), &workers, parameters, None, inputs.iter().copied(), |complete| {
        assert_eq!((complete.frame, *complete.view), (out.len(), inputs[out.len()].view));
        let chosen = complete.hom.chosen().to_vec();
        out.push((complete.set.clone(), complete.canvas.hash(&ground.scene), chosen));
        Ok(())
    })
    .unwrap();
    out
}

fn inputs(views: &[View], resets: &[usize]) -> Vec<FrameInput> {
    views.iter().enumerate().map(|(n, &view)| FrameInput { view, reset: resets.contains(&n) }).collect()
}

#[test]
fn pipelined_and_in_turn_give_the_same_at_equal_lag() {
    let methods = [
        "hom",
        "hom:select=temporal",
        "hom:select=temporal,occluder-triangles=3000,lag=4",
        "hom:select=zplane,depth=nbz-block,bypass=20",
        "hom:threshold=0.8,select=temporal",
        "hom:resolution=128x96,rest=2",
        "hom-multipass:lag=5",
        "hom-progressive",
        "hom-progressive:threshold=0.9,rest=3",
    ];
    for (scene, frames) in [("city:triangles=30000", 11), ("terrain:triangles=8000", 16)] {
        let ground = ground(scene, frames, (240, 160));
        for method in methods {
            let on = HomParameters { pipeline: true, ..parameters(method) };
            let on = HomParameters { lag: Some(on.lag().max(3)), ..on };
            let off = HomParameters { pipeline: false, ..on.clone() };
            let inputs = inputs(&ground.views, &[7]);
            let should = given(&ground, 1, &off, &inputs);
            for threads in [1, 2] {
                let is = given(&ground, threads, &on, &inputs);
                for (n, (is, should)) in is.iter().zip(&should).enumerate() {
                    assert!(is == should, "{scene}, {method}, {threads} threads: frame {n} differs");
                }
                assert_eq!(is.len(), frames);
            }
        }
    }
}

#[test]
fn the_stages_called_by_hand_give_the_same_as_the_run_in_turn() {
    let ground = ground("city:triangles=20000", 8, (160, 120));
    let parameters = parameters("hom:select=temporal,lag=2");
    let (world, workers, level) = (World::new(&ground.scene), Workers::new(1).unwrap(), Level::best());
    let mut frame = HomFrame::new(&ground.views[0], level, &parameters).unwrap();
    let run = given(&ground, 1, &parameters, &inputs(&ground.views, &[5]));
    for (n, view) in ground.views.iter().enumerate() {
        if n == 5 {
            frame.reset();
        }
        frame = hom::select_occluders(&world, level, view, &parameters, frame).unwrap();
        frame = hom::build_pyramid(hom::draw_occluders(&world, &workers, frame).unwrap());
        let set;
        (set, frame) = hom::cull(&world, &workers, &parameters, frame).unwrap();
        assert_eq!((&set, frame.chosen()), (&run[n].0, &run[n].2[..]), "frame {n}");
    }
}

#[test]
fn after_a_reset_frames_are_those_of_a_fresh_run() {
    let ground = ground("city:triangles=30000", 12, (160, 120));
    for method in ["hom:select=temporal,pipeline=on", "hom:select=temporal", "hom-progressive:pipeline=on,lag=4"] {
        let parameters = parameters(method);
        let whole = given(&ground, 1, &parameters, &inputs(&ground.views, &[2, 6]));
        let from_2 = given(&ground, 1, &parameters, &inputs(&ground.views[2..6], &[]));
        let from_6 = given(&ground, 1, &parameters, &inputs(&ground.views[6..], &[]));
        assert!(whole[2..6] == from_2 && whole[6..] == from_6, "{method}");
    }
}

#[test]
fn a_run_may_have_any_number_of_frames() {
    let ground = ground("city:triangles=5000", 5, (64, 48));
    let on = parameters("hom:select=temporal,pipeline=on");
    let whole = given(&ground, 1, &on, &inputs(&ground.views, &[]));
    for frames in 0..5 {
        assert!(given(&ground, 1, &on, &inputs(&ground.views[..frames], &[])) == whole[..frames], "{frames} frames");
    }
}

#[test]
fn tests_spread_over_threads_give_the_same_set_and_counts() {
    for scene in ["city:triangles=60000", "terrain:triangles=60000"] {
        let ground = ground(scene, 3, (240, 160));
        for bypass in [1, 63, 64, 65, 200, 100_000] {
            let parameters = HomParameters { bypass_after: bypass, rest: 0, ..parameters("hom") };
            let inputs = inputs(&ground.views, &[]);
            let should = given(&ground, 1, &parameters, &inputs);
            for threads in [2, 3, 5] {
                let same = given(&ground, threads, &parameters, &inputs) == should;
                assert!(same, "{scene}, bypass after {bypass}, {threads} threads");
            }
        }
    }
}

#[test]
fn rests_do_not_depend_on_threads() {
    // Some frames pay when triangles are counted once, and would not if they were counted once a band.
    let ground = ground("city:triangles=30000", 12, (240, 160));
    let (parameters, inputs) = (parameters("hom"), inputs(&ground.views, &[]));
    let should = given(&ground, 1, &parameters, &inputs);
    assert!(should.iter().any(|g| !g.0.bypassed), "no frame is culled");
    for threads in [2, 3] {
        assert!(given(&ground, threads, &parameters, &inputs) == should, "{threads} threads");
    }
}

#[test]
fn a_view_of_another_size_is_reported_and_what_was_complete_stays() {
    let ground = ground("city:triangles=5000", 6, (64, 48));
    for method in ["hom", "hom:pipeline=on"] {
        let mut views = ground.views.clone();
        views[4] = views[4].resized(Viewport::new(64, 49).unwrap());
        let (world, workers) = (World::new(&ground.scene), Workers::new(1).unwrap());
        let mut complete = 0;
        let result = pipeline::run(&world, Level::best(), &workers, &parameters(method), None, views, |_| {
            complete += 1;
            Ok(())
        });
        assert!(matches!(result, Err(Error::Stage { stage: "FinalDraw", frame: 4, .. })), "{method}: {result:?}");
        assert_eq!(complete, 4, "{method}");
    }
    let (world, workers) = (World::new(&ground.scene), Workers::new(1).unwrap());
    let lag = HomParameters { lag: Some(2), ..parameters("hom:pipeline=on") };
    for views in [&ground.views[..], &[]] {
        let result = pipeline::run(&world, Level::best(), &workers, &lag, None, views.iter().copied(), |_| Ok(()));
        assert!(matches!(&result, Err(Error::Parameter { name, .. }) if name == "lag"), "{result:?}");
    }
}

// ---- the program

fn homcull(args: &[&str]) -> (Option<i32>, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_homcull")).args(args).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

#[test]
fn a_walk_in_the_pipeline_reports_its_latency_and_draws_the_same_pictures() {
    let methods = ["hom:pipeline=on", "vfc", "hom:lag=3", "hom:select=temporal,pipeline=on"];
    let mut args = vec!["walk", "city:triangles=20000", "--frames", "6", "--size", "160x128", "--json", "-"];
    methods.iter().for_each(|m| args.extend(["--method", m]));
    let (code, out, err) = homcull(&args);
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let report: Value = serde_json::from_str(&out).unwrap();
    let runs = report["runs"].as_array().unwrap();
    let names: Vec<_> = runs.iter().map(|run| run["method"].as_str().unwrap()).collect();
    assert_eq!(names, ["hom", "vfc", "hom", "hom"], "in the order asked for");
    for (run, method) in runs.iter().zip(methods) {
        assert_eq!(run["image_hash"], runs[1]["image_hash"], "{method}");
        assert_eq!(run["wrongly_culled_objects"], 0, "{method}");
        for field in ["median", "p95", "min", "max"] {
            assert!(run["latency_ms"][field].as_f64() > Some(0.0), "{method}: latency_ms.{field}");
        }
        let pipelined = method.contains("pipeline=on");
        assert_eq!(run["pipeline_ms"].is_object(), pipelined, "{method}");
        for stage in ["occsel", "cull", "draw"] {
            let field = |f: &str| run["pipeline_ms"][stage][f].as_f64();
            assert_eq!(field("busy") > Some(0.0) && field("waiting").is_some(), pipelined, "{method}: {stage}");
        }
        let latency = run["latency_ms"]["median"].as_f64();
        assert!(pipelined || latency == run["frame_ms"]["median"].as_f64(), "{method}: in turn they are one");
    }
    assert_eq!(runs[0]["visible_set_hash"], runs[2]["visible_set_hash"], "equal lag, equal sets");
    let parameter = |run: usize, name: &str| runs[run]["parameters"][name].as_str().map(str::to_owned);
    assert_eq!(parameter(0, "lag").as_deref(), Some("3"));
    assert_eq!(parameter(3, "select").as_deref(), Some("temporal"));
}

#[test]
fn a_lag_that_the_pipeline_cannot_have_is_named() {
    for (method, named) in [
        ("hom:pipeline=on,lag=2", "lag '2'"),
        ("hom:lag=1,pipeline=on", "lag '1'"),
        ("hom:lag=0", "lag '0'"),
        ("hom:lag=61", "lag '61'"),
        ("hom:pipeline=maybe", "pipeline 'maybe'"),
        ("hom:select=yesterday", "select 'yesterday'"),
        ("vfc:pipeline=on", "pipeline"),
    ] {
        let (code, _, err) = homcull(&["walk", "city:triangles=5000", "--frames", "1", "--method", method]);
        assert_eq!(code, Some(2), "{method}: {err}");
        assert!(err.contains(named) && err.lines().count() == 1, "{method}: {err}");
    }
}
