//! Labels beside the points of a scatter plot, kept off each other, off the points and the lines.
//!
//! Greedy: each label in turn takes the place around its point that overlaps least with what is
//! there and with the border; to the right is tried first. Quadratic in the number of points, of
//! which a plot that can be read has few.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::plot_canvas::{Area, DrawResult, px};

/// A rectangle in drawn pixels: left, top, right, bottom.
type Bounds = [i32; 4];

/// Where a label may stand from its point: a multiple of half its size and of the gap, each way.
const PLACES: [(i32, i32); 8] = [(1, 0), (1, -1), (0, -1), (1, 1), (0, 1), (-1, -1), (-1, 0), (-1, 1)];
/// Half the side of a dot, with some air.
const DOT: i32 = px(7);
/// Half the side of the squares that stand for a line, and their distance along it.
const LINE: (i32, i32) = (px(2), px(6));

/// What is drawn already, where labels should not be.
pub(super) struct Taken {
    inside: Bounds,
    boxes: Vec<Bounds>,
}

impl Taken {
    /// A plot `inside` a rectangle with `dots`, and `lines` that each join some points.
    pub(super) fn new(inside: Bounds, dots: &[(i32, i32)], lines: &[Vec<(i32, i32)>]) -> Taken {
        let mut boxes: Vec<Bounds> = dots.iter().map(|&dot| around(dot, (DOT, DOT))).collect();
        for ends in lines.iter().flat_map(|line| line.windows(2)) {
            let (from, to) = (ends[0], ends[1]);
            let length = (to.0 - from.0).abs().max((to.1 - from.1).abs());
            let steps = (length / LINE.1).max(1);
            boxes.extend((0..=steps).map(|step| {
                let middle = (from.0 + (to.0 - from.0) * step / steps, from.1 + (to.1 - from.1) * step / steps);
                around(middle, (LINE.0, LINE.0))
            }));
        }
        Taken { inside, boxes }
    }

    /// Writes `labels` beside `dots`, both in the same order.
    pub(super) fn place_labels(
        &mut self,
        root: &Area<'_>,
        dots: &[(i32, i32)],
        labels: &[&str],
        style: &TextStyle<'_>,
    ) -> DrawResult {
        let style = style.pos(Pos::new(HPos::Center, VPos::Center));
        for (&dot, label) in dots.iter().zip(labels) {
            let (width, height) = root.estimate_text_size(label, &style)?;
            let half = (width as i32 / 2, height as i32 / 2);
            let places = PLACES.iter().map(|&(right, down)| {
                let gap = px(if right != 0 && down != 0 { 3 } else { 8 });
                (dot.0 + right * (half.0 + gap), dot.1 + down * (half.1 + gap))
            });
            // The first of the cheapest; there always is one.
            if let Some(middle) = places.min_by_key(|&middle| self.cost(around(middle, half))) {
                root.draw_text(label, &style, middle)?;
                self.boxes.push(around(middle, half));
            }
        }
        Ok(())
    }

    /// The area of `label` that is taken or outside.
    fn cost(&self, label: Bounds) -> i64 {
        let outside = overlap(label, label) - overlap(label, self.inside);
        self.boxes.iter().map(|&other| overlap(label, other)).sum::<i64>() + outside
    }
}

fn around((x, y): (i32, i32), (half_width, half_height): (i32, i32)) -> Bounds {
    [x - half_width, y - half_height, x + half_width, y + half_height]
}

/// The area that two boxes share.
fn overlap(a: Bounds, b: Bounds) -> i64 {
    let width = a[2].min(b[2]) - a[0].max(b[0]);
    let height = a[3].min(b[3]) - a[1].max(b[1]);
    i64::from(width.max(0)) * i64::from(height.max(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_share_what_they_share() {
        assert_eq!(overlap([0, 0, 4, 4], [2, 3, 9, 9]), 2);
        assert_eq!(overlap([0, 0, 4, 4], [4, 0, 8, 4]), 0);
        assert_eq!(overlap([0, 0, 4, 4], [10, 10, 12, 12]), 0);
    }

    #[test]
    fn a_place_on_a_line_or_outside_costs() {
        let taken = Taken::new([0, 0, 100, 100], &[], &[vec![(0, 50), (100, 50)]]);
        assert_eq!(taken.cost([10, 10, 20, 20]), 0);
        assert!(taken.cost([10, 45, 20, 55]) > 0);
        assert_eq!(taken.cost([95, 10, 105, 20]), 50);
    }
}
