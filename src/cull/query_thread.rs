//! The query device with a thread of its own: it draws and answers while the caller walks on.
//!
//! Commands and answers go through channels, in order. How many answers are there when the caller looks depends on the machine, so counts
//! differ from run to run; the picture does not. Cost: two threads, a hand-over a command, and the start of a thread a frame.
//!
//! The thread begins and ends with its frame, because it draws into the caller's canvas for that long. Starting and joining it takes
//! 0.03 ms, keeping it would take 0.005 ms, of frames of 10 ms and more: not worth a canvas that moves to and fro and a scope around every walk.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Instant;

use homcull_simd::{Kernel, Simd};

use super::VisibleSet;
use super::chc::ChcMemory;
use super::coherent::OnDevice;
use super::query_device::{Query, QueryDevice, Waited};
use crate::draw::{BandDraw, shade};

enum Command {
    Draw(u32),
    Query(Query),
}

/// Draws a frame on a thread of its own while it is walked here.
pub(super) fn run(on: OnDevice<'_>, memory: &mut ChcMemory, band: BandDraw<'_>) -> VisibleSet {
    let ((commands, to_do), (answers, given)) = (channel(), channel());
    std::thread::scope(|scope| {
        scope.spawn(|| on.level.run(Serve { on, to_do, answers, band }));
        // When the walk is over its end of the channel goes, and the device finishes.
        on.level.run(WalkHere { on, memory, device: ThreadedDevice { commands, given, waited: 0 } })
    })
}

/// The device's side.
struct Serve<'f, 'a> {
    on: OnDevice<'f>,
    to_do: Receiver<Command>,
    answers: Sender<u32>,
    band: BandDraw<'a>,
}

impl Kernel for Serve<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let Serve { on, to_do, answers, band } = self;
        let (mut drawing, image) = on.drawing(s, band);
        while let Ok(command) = to_do.recv() {
            match command {
                Command::Draw(object) => drawing.draw(object),
                // Nobody may want the answer any more: then there is nothing left to do but to finish.
                Command::Query(query) => drop(answers.send(drawing.answer(query))),
            }
        }
        drawing.engine.flush();
        shade(s, &drawing.engine.sink, &on.world.scene.colors, image);
    }
}

/// The caller's side.
struct ThreadedDevice {
    commands: Sender<Command>,
    given: Receiver<u32>,
    waited: u64,
}

impl QueryDevice for ThreadedDevice {
    fn draw(&mut self, object: u32) {
        // A device that is gone has panicked; the scope says so.
        drop(self.commands.send(Command::Draw(object)));
    }

    fn issue(&mut self, query: Query) {
        drop(self.commands.send(Command::Query(query)));
    }

    fn ready(&mut self) -> Option<u32> {
        self.given.try_recv().ok()
    }

    fn wait(&mut self) -> u32 {
        let start = Instant::now();
        // Visible, should the device be gone: nothing is lost by that.
        let answer = self.given.recv().unwrap_or(u32::MAX);
        self.waited += start.elapsed().as_nanos() as u64;
        answer
    }

    fn rest(&mut self) -> u32 {
        self.given.recv().unwrap_or(u32::MAX)
    }

    fn waited(&self) -> Waited {
        Waited { steps: 0, nanoseconds: self.waited }
    }
}

struct WalkHere<'f> {
    on: OnDevice<'f>,
    memory: &'f mut ChcMemory,
    device: ThreadedDevice,
}

impl Kernel for WalkHere<'_> {
    type Output = VisibleSet;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> VisibleSet {
        let WalkHere { on, memory, mut device } = self;
        on.walk(s, memory, &mut device)
    }
}
