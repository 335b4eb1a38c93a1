//! Fading in what becomes visible (Zhang 1998, 5.3.2).
//!
//! With opacity thresholds below 1 an object can pop in through a hole or at a silhouette. Drawn with a weight that grows from
//! frame to frame it fades in instead, as it would between levels of detail. Counts frames, not time: the same walk fades the
//! same way everywhere. Costs one pass over the visible set, and eight bytes an object.

/// How long each object has been visible.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FadeIn {
    frames: u32,
    now: u32,
    /// Frames in a row for which an object has been visible, at the frame it was last seen in (0: never).
    seen: Vec<Seen>,
    /// True before the first frame and after [`FadeIn::reset`]: then everything counts as having been there.
    fresh: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Seen {
    last: u32,
    in_a_row: u32,
}

impl FadeIn {
    /// For objects numbered from 0, each at full weight in the `frames`-th frame it is visible; 0 and 1 do not fade.
    pub fn new(objects: usize, frames: u32) -> FadeIn {
        FadeIn { frames: frames.max(1), now: 0, seen: vec![Seen::default(); objects], fresh: true }
    }

    /// Takes the visible set of the next frame. What is not in it fades anew when it comes back. In the first frame nothing
    /// fades. Numbers that are not an object's are passed over.
    pub fn advance(&mut self, visible: &[u32]) {
        if self.now == u32::MAX {
            self.reset();
            self.seen.fill(Seen::default());
            self.now = 0;
        }
        self.now += 1;
        for &object in visible {
            let Some(seen) = self.seen.get_mut(object as usize) else { continue };
            if seen.last == self.now {
                continue;
            }
            let before = seen.last != 0 && seen.last + 1 == self.now;
            let in_a_row = match (self.fresh, before) {
                (true, _) => self.frames,
                (false, true) => (seen.in_a_row + 1).min(self.frames),
                (false, false) => 1,
            };
            *seen = Seen { last: self.now, in_a_row };
        }
        self.fresh = false;
    }

    /// For a teleport: in the next frame nothing fades.
    pub fn reset(&mut self) {
        self.fresh = true;
    }

    /// The weight of an object in the current frame: 0 when it is not visible, else `k / frames` in its k-th visible frame, 1 at
    /// most.
    pub fn weight(&self, object: u32) -> f32 {
        match self.seen.get(object as usize) {
            Some(seen) if seen.last == self.now && self.now != 0 => seen.in_a_row as f32 / self.frames as f32,
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weights(fade: &FadeIn, objects: u32) -> Vec<f32> {
        (0..objects).map(|o| fade.weight(o)).collect()
    }

    #[test]
    fn what_becomes_visible_fades_in_and_what_was_there_does_not() {
        let mut fade = FadeIn::new(3, 4);
        assert_eq!(weights(&fade, 3), [0.0; 3]);
        fade.advance(&[0]);
        assert_eq!(weights(&fade, 3), [1.0, 0.0, 0.0]);
        for weight in [0.25, 0.5, 0.75, 1.0, 1.0] {
            fade.advance(&[1, 0]);
            assert_eq!(weights(&fade, 3), [1.0, weight, 0.0]);
        }
    }

    #[test]
    fn what_vanishes_fades_anew() {
        let mut fade = FadeIn::new(1, 2);
        fade.advance(&[0]);
        fade.advance(&[]);
        assert_eq!(fade.weight(0), 0.0);
        fade.advance(&[0]);
        assert_eq!(fade.weight(0), 0.5);
        fade.advance(&[0]);
        assert_eq!(fade.weight(0), 1.0);
    }

    #[test]
    fn after_a_teleport_nothing_fades_and_without_frames_nothing_ever_does() {
        let mut fade = FadeIn::new(2, 10);
        fade.advance(&[0]);
        fade.reset();
        fade.advance(&[1, 7]);
        assert_eq!(weights(&fade, 8), [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let mut at_once = FadeIn::new(1, 0);
        at_once.advance(&[]);
        at_once.advance(&[0]);
        assert_eq!(at_once.weight(0), 1.0);
    }

    #[test]
    fn a_set_that_names_an_object_twice_counts_it_once() {
        let mut fade = FadeIn::new(1, 4);
        fade.advance(&[]);
        fade.advance(&[0, 0]);
        assert_eq!(fade.weight(0), 0.25);
        fade.advance(&[0, 0]);
        assert_eq!(fade.weight(0), 0.5);
    }
}
