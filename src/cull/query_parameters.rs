//! Parameters of `stop-and-wait` and `chc`, as they are written on the command line: `chc:latency=20,assume-visible=adaptive`.

use crate::error::{Error, Result};

/// When a query is answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Latency {
    /// So many commands later: the same always.
    Steps(u32),
    /// When a thread of the device's own is done with it.
    Thread,
}

/// In which order nodes are visited.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Traversal {
    /// Depth first, the nearest child first.
    Depth,
    /// By distance, whatever their parents (section 4, *priority queue*).
    Priority,
}

/// For how long a leaf that was found visible is assumed to stay so (section 4, *conservative visibility testing*).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AssumeVisible {
    /// Always so many frames (t_av).
    Frames(u32),
    /// By its history and the eye's speed (`assumption.rs`).
    Adaptive,
}

/// Parameters of `stop-and-wait` and `chc`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct QueryParameters {
    /// False for stop-and-wait.
    pub coherent: bool,
    /// When a query is answered.
    pub latency: Latency,
    /// For how long a visible leaf is assumed to stay visible.
    pub assume_visible: AssumeVisible,
    /// Whether the frames in which assumed leaves are asked about again are spread at random (Mattausch et al. 2008).
    pub spread: bool,
    /// Samples up to which a node counts as hidden (n_vp); above 0 it is approximate.
    pub pixels: u32,
    /// The order of the walk.
    pub order: Traversal,
    /// Whether nodes that wait for their answers are drawn, or opened, rather than waited for.
    pub speculate: bool,
    /// Whether visible leaves are asked about only when there is nothing else to do (Mattausch et al. 2008).
    pub idle: bool,
}

impl QueryParameters {
    /// The defaults of chc, or of stop-and-wait.
    pub fn new(coherent: bool) -> QueryParameters {
        QueryParameters {
            coherent,
            latency: Latency::Steps(0),
            assume_visible: AssumeVisible::Frames(0),
            spread: false,
            pixels: 0,
            order: Traversal::Priority,
            speculate: false,
            idle: false,
        }
    }

    /// Sets a parameter by name; `unknown` says that there is none of the name.
    pub(super) fn set(&mut self, key: &str, value: &str, unknown: impl Fn() -> Error) -> Result<()> {
        let number = |most: u32| match value.parse() {
            Ok(n) if n <= most => Ok(n),
            _ => Err(Error::parameter(key, value, format!("a number from 0 to {most}"))),
        };
        let switch = || match value {
            "on" | "off" => Ok(value == "on"),
            _ => Err(Error::parameter(key, value, "on or off")),
        };
        match key {
            "latency" if value == "thread" => self.latency = Latency::Thread,
            "latency" => self.latency = Latency::Steps(number(1_000_000)?),
            "pixels" => self.pixels = number(1_000_000)?,
            "order" => {
                self.order = match value {
                    "priority" => Traversal::Priority,
                    "depth" => Traversal::Depth,
                    _ => return Err(Error::parameter(key, value, "priority or depth")),
                }
            }
            _ if !self.coherent => return Err(unknown()),
            "assume-visible" if value == "adaptive" => self.assume_visible = AssumeVisible::Adaptive,
            "assume-visible" => {
                let frames = value.parse().ok().filter(|&n| n <= 1_000);
                let frames = frames
                    .ok_or_else(|| Error::parameter(key, value, "a number of frames from 0 to 1000, or adaptive"))?;
                self.assume_visible = AssumeVisible::Frames(frames);
            }
            "spread" => self.spread = switch()?,
            "speculate" => self.speculate = switch()?,
            "idle" => self.idle = switch()?,
            _ => return Err(unknown()),
        }
        Ok(())
    }

    /// All parameters with their values.
    pub(super) fn list(&self) -> Vec<(String, String)> {
        let on_off = |on: bool| if on { "on" } else { "off" }.to_owned();
        let latency = match self.latency {
            Latency::Steps(steps) => steps.to_string(),
            Latency::Thread => "thread".into(),
        };
        let order = if self.order == Traversal::Depth { "depth" } else { "priority" };
        let mut list = vec![("latency", latency), ("pixels", self.pixels.to_string()), ("order", order.into())];
        if self.coherent {
            let assumed = match self.assume_visible {
                AssumeVisible::Frames(frames) => frames.to_string(),
                AssumeVisible::Adaptive => "adaptive".into(),
            };
            list.push(("assume-visible", assumed));
            list.push(("spread", on_off(self.spread)));
            list.push(("speculate", on_off(self.speculate)));
            list.push(("idle", on_off(self.idle)));
        }
        list.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
    }
}
