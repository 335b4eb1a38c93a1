//! The schedule of figure 8.2 (Zhang 1998, 8.1), for stages of any kind: it moves what they make and never looks inside.
//!
//! OccSel and Cull have a thread each. The Draw stage is the caller's thread; it does OccDraw and FinalDraw in turn, and
//! releases and waits for the others. Figure 8.2 never releases OccSel 0 and 1, nor draws frames 0 and 1; with its N replaced by
//! k - 2 where it counts frames, and its NOPs kept, step k = 0, 1, 2, ... is
//!
//! ```text
//! (1) wait for OccSel k-1      (NOP for k = 0)
//! (2) release OccSel k
//! (3) do OccDraw k-1           (NOP for k = 0)
//! (4) wait for Cull k-2        (NOP for k = 0, 1)
//! (5) release Cull k-1         (NOP for k = 0)
//! (6) do FinalDraw k-2         (NOP for k = 0, 1)
//! ```
//!
//! After the last frame the releases are NOPs too, and the steps go on until it is drawn. At (3) Cull k-2 may still read its
//! occlusion buffer: there are two. At (2) Cull k-3 has ended, and FinalDraw k-3: OccSel k hears of frame k-3 and none later.
//!
//! A stage has at most one frame; channels of one place hand it over. A stage that fails, by an error or a panic, sends that in
//! place of its frame; the Draw stage finds it when it waits, lets go of the channels, which ends the other threads as soon as
//! they are done with what they have, and returns it. Nobody waits for a stage that is gone.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{Builder, Scope};
use std::time::Instant;

use crate::error::{Error, Result};

/// The Draw stage, which controls the others: what it hands them, and what it does with what they make.
pub trait DrawStage {
    /// What OccSel is told of a frame.
    type Order: Send;
    /// What OccSel makes of it.
    type Selected: Send;
    /// What OccDraw makes of that.
    type Represented: Send;
    /// What Cull makes of that.
    type Culled: Send;

    /// The order for a frame, or `None` when there are no more. Called once a frame, in order.
    ///
    /// # Errors
    /// Any; it ends the run.
    fn order(&mut self, frame: usize) -> Result<Option<Self::Order>>;

    /// OccDraw: makes the occlusion representation.
    ///
    /// # Errors
    /// Any; it ends the run.
    fn draw_occluders(&mut self, frame: usize, selected: Self::Selected) -> Result<Self::Represented>;

    /// FinalDraw.
    ///
    /// # Errors
    /// Any; it ends the run.
    fn draw(&mut self, frame: usize, culled: &mut Self::Culled) -> Result<()>;

    /// The frame is complete. What is done here counts as no stage's work.
    ///
    /// # Errors
    /// Any; it ends the run.
    fn complete(&mut self, frame: usize, culled: Self::Culled, times: FrameTimes) -> Result<()>;
}

/// What a stage's thread did for a frame, in milliseconds. Busy time is by the wall: with more threads than
/// processors a stage is also busy while it is made to stand still.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StageTime {
    /// At work on the frame.
    pub busy_ms: f64,
    /// Before that, waiting for it.
    pub waiting_ms: f64,
}

/// Where a frame's time went.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FrameTimes {
    /// From the end of the frame before (for the first, from the start of the run) to the end of this one: what a viewer sees as
    /// frame time. In a run these add up to the whole.
    pub frame_ms: f64,
    /// From the order to the end of the frame: how old its view is when it is shown.
    pub latency_ms: f64,
    /// OccSel's thread.
    pub select: StageTime,
    /// The Draw stage in OccDraw; it waits for OccSel.
    pub occluders: StageTime,
    /// Cull's thread.
    pub cull: StageTime,
    /// The Draw stage in FinalDraw; it waits for Cull.
    pub draw: StageTime,
}

/// Runs the frames with all stages overlapping.
///
/// # Errors
/// [`Error::Stage`] for the first failure, an error or a panic, that the Draw stage meets, or when threads cannot be started.
pub fn run_pipelined<D: DrawStage>(
    draw: &mut D,
    select: impl FnMut(usize, D::Order) -> Result<D::Selected> + Send,
    cull: impl FnMut(usize, D::Represented) -> Result<D::Culled> + Send,
) -> Result<()> {
    std::thread::scope(|scope| {
        let mut select = Stage::start(scope, "OccSel", select)?;
        let mut cull = Stage::start(scope, "Cull", cull)?;
        let mut last_end = Instant::now();
        let (mut selecting, mut culling): (Option<InStage>, Option<InStage>) = (None, None);
        let mut more = true;
        for step in 0.. {
            let selected =
                selecting.take().map(|f| select.wait(f, |t| (&mut t.select, &mut t.occluders))).transpose()?;
            if more {
                let frame = InStage { frame: step, ordered: Instant::now(), times: FrameTimes::default() };
                match guarded("Draw", step, || draw.order(step))? {
                    Some(order) => selecting = Some(select.release(frame, order)?),
                    None => more = false,
                }
            }
            let represented = match selected {
                Some((mut f, selected)) => {
                    let start = Instant::now();
                    let represented = guarded("OccDraw", f.frame, || draw.draw_occluders(f.frame, selected))?;
                    f.times.occluders.busy_ms = milliseconds(start);
                    Some((f, represented))
                }
                None => None,
            };
            let culled = culling.take().map(|f| cull.wait(f, |t| (&mut t.cull, &mut t.draw))).transpose()?;
            if let Some((f, represented)) = represented {
                culling = Some(cull.release(f, represented)?);
            }
            if let Some((f, culled)) = culled {
                finish(draw, f, culled, &mut last_end)?;
            }
            if selecting.is_none() && culling.is_none() {
                break;
            }
        }
        Ok(())
    })
}

/// Runs the frames stage by stage in the caller's thread: the same calls, the same results, no overlap.
///
/// # Errors
/// [`Error::Stage`] for the first failure, an error or a panic.
pub fn run_in_turn<D: DrawStage>(
    draw: &mut D,
    mut select: impl FnMut(usize, D::Order) -> Result<D::Selected>,
    mut cull: impl FnMut(usize, D::Represented) -> Result<D::Culled>,
) -> Result<()> {
    let mut last_end = Instant::now();
    for frame in 0.. {
        let mut f = InStage { frame, ordered: Instant::now(), times: FrameTimes::default() };
        let Some(order) = guarded("Draw", frame, || draw.order(frame))? else { break };
        let start = Instant::now();
        let selected = guarded("OccSel", frame, || select(frame, order))?;
        f.times.select.busy_ms = milliseconds(start);
        let start = Instant::now();
        let represented = guarded("OccDraw", frame, || draw.draw_occluders(frame, selected))?;
        f.times.occluders.busy_ms = milliseconds(start);
        let start = Instant::now();
        let culled = guarded("Cull", frame, || cull(frame, represented))?;
        f.times.cull.busy_ms = milliseconds(start);
        finish(draw, f, culled, &mut last_end)?;
    }
    Ok(())
}

/// FinalDraw, and the end of the frame.
fn finish<D: DrawStage>(draw: &mut D, frame: InStage, culled: D::Culled, last_end: &mut Instant) -> Result<()> {
    let InStage { frame, ordered, mut times } = frame;
    let mut culled = culled;
    let start = Instant::now();
    guarded("FinalDraw", frame, || draw.draw(frame, &mut culled))?;
    times.draw.busy_ms = milliseconds(start);
    times.latency_ms = milliseconds(ordered);
    times.frame_ms = milliseconds(*last_end);
    *last_end = Instant::now();
    guarded("Draw", frame, || draw.complete(frame, culled, times))
}

/// A frame under way.
struct InStage {
    frame: usize,
    ordered: Instant,
    times: FrameTimes,
}

/// What a stage's thread sends back.
struct Done<T> {
    result: Result<T>,
    time: StageTime,
}

/// A stage on a thread of its own, as the Draw stage sees it.
struct Stage<I, O> {
    name: &'static str,
    orders: SyncSender<(usize, I)>,
    done: Receiver<Done<O>>,
}

impl<I: Send, O: Send> Stage<I, O> {
    /// Starts the thread. It ends when this is dropped.
    fn start<'scope, 'env>(
        scope: &'scope Scope<'scope, 'env>,
        name: &'static str,
        work: impl FnMut(usize, I) -> Result<O> + Send + 'scope,
    ) -> Result<Stage<I, O>>
    where
        I: 'scope,
        O: 'scope,
    {
        let (orders, inbox) = sync_channel::<(usize, I)>(1);
        let (outbox, done) = sync_channel(1);
        let mut work = work;
        let run = move || {
            let mut free = Instant::now();
            while let Ok((frame, input)) = inbox.recv() {
                let waiting_ms = milliseconds(free);
                let start = Instant::now();
                let result = guarded(name, frame, || work(frame, input));
                let time = StageTime { busy_ms: milliseconds(start), waiting_ms };
                let failed = result.is_err();
                free = Instant::now();
                if outbox.send(Done { result, time }).is_err() || failed {
                    break;
                }
            }
        };
        let thread = Builder::new().name(format!("homcull {name}")).spawn_scoped(scope, run);
        thread.map_err(|e| gone(name, 0, e.to_string()))?;
        Ok(Stage { name, orders, done })
    }

    fn release(&mut self, frame: InStage, input: I) -> Result<InStage> {
        let sent = self.orders.send((frame.frame, input));
        sent.map_err(|_| gone(self.name, frame.frame, "has ended".into()))?;
        Ok(frame)
    }

    /// Waits for the frame; `places` are where the stage's time goes, and that of the Draw stage, which waits.
    fn wait(
        &mut self,
        frame: InStage,
        places: impl FnOnce(&mut FrameTimes) -> (&mut StageTime, &mut StageTime),
    ) -> Result<(InStage, O)> {
        let mut frame = frame;
        let start = Instant::now();
        let done = self.done.recv().map_err(|_| gone(self.name, frame.frame, "has ended".into()))?;
        let (own, waiting) = places(&mut frame.times);
        *own = done.time;
        waiting.waiting_ms = milliseconds(start);
        Ok((frame, done.result?))
    }
}

/// Does a stage's work; an error or a panic becomes an error that names the stage and the frame.
fn guarded<T>(stage: &'static str, frame: usize, work: impl FnOnce() -> Result<T>) -> Result<T> {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(value)) => Ok(value),
        Ok(Err(error)) => Err(gone(stage, frame, error.to_string())),
        Err(panic) => {
            let text = panic.downcast_ref::<&str>().map(|s| (*s).to_owned());
            let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
            Err(gone(stage, frame, format!("panicked: {}", text.unwrap_or_else(|| "without a word".into()))))
        }
    }
}

fn gone(stage: &'static str, frame: usize, reason: String) -> Error {
    Error::Stage { stage, frame, reason }
}

fn milliseconds(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e3
}
