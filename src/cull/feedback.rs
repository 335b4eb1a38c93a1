//! What a frame's culling tells a later frame: the only things that outlive a frame.
//!
//! They are the rest of culling (`hom.rs`) and the occluded objects of temporal coherence (`select/temporal.rs`). What frame N
//! found reaches frame N + lag and no other: so a frame's choices depend on that one frame, and are the same whether the frames
//! between are already culled or still under way. In turn the lag is 1; in the pipeline at least 3 (`pipeline/`). With a lag of
//! L, rests are counted in every L-th frame, in L chains that do not know of each other.
//!
//! Cold start: the first L frames have no feedback, which means no rest and no object held back; so have the first L after a reset.

use std::collections::VecDeque;

use crate::select::Occluded;

/// How long culling still rests. The first rest is one frame; as long as frames keep hiding next to nothing, each is twice as
/// long as the one before, up to the parameter `rest`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Rest {
    left: u32,
    in_a_row: u32,
}

impl Rest {
    pub fn is_on(self) -> bool {
        self.left > 0
    }

    /// After a frame that rested.
    pub fn shorter(self) -> Rest {
        Rest { left: self.left.saturating_sub(1), ..self }
    }

    /// After a frame that was culled.
    pub fn after(self, paid: bool, longest: u32) -> Rest {
        if paid {
            return Rest::default();
        }
        Rest { left: longest.min(1 << self.in_a_row.min(30)), in_a_row: self.in_a_row + 1 }
    }
}

/// What one frame tells the frame `lag` after it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Feedback {
    pub rest: Rest,
    /// In the frustum and occluded: kept by one-pass culling with temporal selection alone.
    pub occluded: Occluded,
}

/// Feedback on its way from frame to frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FeedbackLine {
    lag: u64,
    /// Frames that have begun, and frames that have told.
    begun: u64,
    told: u64,
    /// The first frame that may be heard: the first after the last reset.
    since: u64,
    under_way: VecDeque<Feedback>,
}

impl FeedbackLine {
    pub(crate) fn new(lag: u32) -> FeedbackLine {
        FeedbackLine { lag: lag.max(1).into(), begun: 0, told: 0, since: 0, under_way: VecDeque::new() }
    }

    /// Begins the next frame: what the frame `lag` before it told, if it may be heard. That frame must have told.
    pub(crate) fn begin(&mut self) -> Feedback {
        let source = self.begun.checked_sub(self.lag).filter(|&n| n >= self.since);
        debug_assert!(source.is_none_or(|n| n < self.told), "frame {} begins before feedback is there", self.begun);
        self.begun += 1;
        source.and_then(|_| self.under_way.pop_front()).unwrap_or_default()
    }

    /// The earliest frame that has not yet told tells. Heard by nobody when it was before a reset.
    pub(crate) fn tell(&mut self, feedback: Feedback) {
        if self.told == self.begun {
            return;
        }
        if self.told >= self.since {
            self.under_way.push_back(feedback);
        }
        self.told += 1;
    }

    /// Frames that began and were given up tell nothing.
    pub(crate) fn settle(&mut self) {
        while self.told < self.begun {
            self.tell(Feedback::default());
        }
    }

    /// For a teleport, or another scene: the next frame begins as the first one did.
    pub(crate) fn reset(&mut self) {
        self.since = self.begun;
        self.under_way.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Feedback that can be told apart.
    fn of(frame: u32) -> Feedback {
        Feedback { rest: Rest { left: frame, in_a_row: 0 }, ..Feedback::default() }
    }

    #[test]
    fn a_frame_hears_the_frame_lag_before_it_and_no_other() {
        for lag in 1..6 {
            for overlap in 0..lag {
                let mut line = FeedbackLine::new(lag);
                for frame in 0..20u32 {
                    let should = frame.checked_sub(lag).map_or(0, |n| n + 1);
                    assert_eq!(line.begin().rest.left, should, "lag {lag}, frame {frame}");
                    if frame >= overlap {
                        line.tell(of(frame - overlap + 1));
                    }
                }
            }
        }
    }

    #[test]
    fn nothing_from_before_a_reset_is_heard_after_it() {
        for (lag, overlap) in [(1, 0), (3, 0), (3, 2), (5, 3)] {
            let mut line = FeedbackLine::new(lag);
            for frame in 0..30u32 {
                if frame == 11 || frame == 13 {
                    line.reset();
                }
                let since = if frame >= 13 { 13 } else { 11 * u32::from(frame >= 11) };
                let should = frame.checked_sub(lag).filter(|&n| n >= since).map_or(0, |n| n + 1);
                assert_eq!(line.begin().rest.left, should, "lag {lag}, frame {frame}");
                if frame >= overlap {
                    line.tell(of(frame - overlap + 1));
                }
            }
        }
    }

    #[test]
    fn a_frame_given_up_tells_nothing_and_a_frame_too_many_is_not_heard() {
        let mut line = FeedbackLine::new(1);
        line.begin();
        line.settle();
        assert_eq!(line.begin(), Feedback::default());
        line.tell(of(7));
        line.tell(of(8));
        assert_eq!(line.begin(), of(7));
    }
}
