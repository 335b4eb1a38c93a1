//! The stages of a frame on threads, or in turn, with the same results (Zhang 1998, 8.1).
//!
//! OccSel, Cull and Draw work on three consecutive frames at once ([`run_pipelined`]). [`run`] does so for the hom methods, as
//! their parameters `pipeline` and `lag` say. All threads are of the call: they begin and end in it, and nothing is global.
//!
//! What it brings: the time of OccSel and Cull is hidden behind that of Draw. What it costs: a frame is shown two frame times
//! after its view was asked for instead of one, and what was occluded is heard two frames later. Where the final draw can be
//! spread over the same processors in bands, as ours can, there is little left to hide; it pays where Draw is bound to one
//! thread or device.
//!
//! Equal results: a frame depends on its view and on what the frame `lag` before it told (`cull/feedback.rs`), and on nothing
//! else; so runs with equal lag are equal, on threads or in turn, visible sets, counts and pictures.

mod run;
mod schedule;

pub use run::{CompleteFrame, FrameInput, run};
pub use schedule::{DrawStage, FrameTimes, StageTime, run_in_turn, run_pipelined};
