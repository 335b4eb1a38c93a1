//! Covered area from thirteen directions, as pictures of 64 x 64 bits.
//!
//! The directions are those of the 26 neighbours of a cube; opposite ones cover the same area under a parallel
//! projection, so one of each pair stands for both. All pictures of one part share its frames, so that subsets of
//! triangles are compared bit by bit. A bit is set if its centre is covered: an estimate, to choose by; nothing rests
//! on it. Cost: the rows that a triangle meets, a direction.

use glam::{DVec2, DVec3, Vec3};

/// Rows of a picture, and bits of a row.
const SIDE: usize = 64;
/// Pairs of opposite directions.
pub(super) const DIRECTIONS: usize = 13;

/// What a flat thing of area 1 covers, at most, on the mean over the directions: the greatest length of a sum of the directions with
/// any signs, by their number.
const MOST_FLAT: f64 = 0.513_148_779_2;

/// What something covers: a picture a direction.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Cover(Box<[[u64; SIDE]; DIRECTIONS]>);

impl Cover {
    pub fn empty() -> Cover {
        Cover(Box::new([[0; SIDE]; DIRECTIONS]))
    }

    /// All rows of all pictures.
    pub fn rows(&self) -> &[u64] {
        self.0.as_flattened()
    }

    pub fn rows_mut(&mut self) -> &mut [u64] {
        self.0.as_flattened_mut()
    }
}

/// Thirteen frames around some points.
#[derive(Debug, Clone)]
pub(super) struct Frames {
    /// Picture x and y, in bits, of a point are its products with these, less the origin's.
    axes: [[DVec3; 2]; DIRECTIONS],
    origins: [DVec2; DIRECTIONS],
    /// Area of a bit.
    weights: [f64; DIRECTIONS],
}

impl Frames {
    pub fn around(points: impl Iterator<Item = Vec3> + Clone) -> Frames {
        let mut frames = Frames {
            axes: [[DVec3::ZERO; 2]; DIRECTIONS],
            origins: [DVec2::ZERO; DIRECTIONS],
            weights: [0.0; DIRECTIONS],
        };
        for (k, direction) in directions().into_iter().enumerate() {
            let (u, v) = direction.any_orthonormal_pair();
            let flat = points.clone().map(|p| p.as_dvec3()).map(|p| DVec2::new(p.dot(u), p.dot(v)));
            let (min, max) = flat.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)));
            let size = max - min;
            if !size.is_finite() || size.min_element() <= 0.0 {
                continue;
            }
            let scale = DVec2::splat(SIDE as f64) / size;
            frames.axes[k] = [u * scale.x, v * scale.y];
            frames.origins[k] = min * scale;
            frames.weights[k] = 1.0 / (scale.x * scale.y);
        }
        frames
    }

    /// Adds a triangle, whichever way it faces.
    pub fn draw(&self, triangle: [Vec3; 3], cover: &mut Cover) {
        for k in 0..DIRECTIONS {
            if self.weights[k] > 0.0 {
                let [u, v] = self.axes[k];
                let flat = triangle.map(|p| DVec2::new(p.as_dvec3().dot(u), p.as_dvec3().dot(v)) - self.origins[k]);
                fill(flat, &mut cover.0[k]);
            }
        }
    }

    pub fn cover(&self, triangles: impl Iterator<Item = [Vec3; 3]>) -> Cover {
        let mut cover = Cover::empty();
        triangles.for_each(|t| self.draw(t, &mut cover));
        cover
    }

    /// Mean covered area over the directions.
    pub fn area(&self, cover: &Cover) -> f64 {
        let bits = |picture: &[u64; SIDE]| picture.iter().map(|row| row.count_ones()).sum::<u32>();
        let areas = cover.0.iter().zip(&self.weights).map(|(picture, weight)| f64::from(bits(picture)) * weight);
        areas.sum::<f64>() / DIRECTIONS as f64
    }

    /// The most that one triangle in a box covers on the mean: a bound. `half` is half the box's sides.
    ///
    /// In a box, a triangle's shadow on each side is at most half that side, and its area the root of the sum of the
    /// shadows' squares; seen from one direction, it is at most half of what bounds the picture.
    pub fn most_a_triangle(&self, half: DVec3) -> f64 {
        let sides = DVec3::new(half.y * half.z, half.z * half.x, half.x * half.y) * 4.0;
        let by_area = 0.5 * sides.length() * MOST_FLAT;
        let pictures = self.weights.iter().map(|weight| weight * (SIDE * SIDE) as f64 * 0.5);
        by_area.min(pictures.sum::<f64>() / DIRECTIONS as f64)
    }

    /// Areas of the bits of each row of [`Cover::rows`].
    pub fn row_weight(&self, row: usize) -> f64 {
        self.weights[row / SIDE] / DIRECTIONS as f64
    }
}

/// One of each pair of the 26 directions.
fn directions() -> [DVec3; DIRECTIONS] {
    let mut out = [DVec3::ZERO; DIRECTIONS];
    for (k, out) in out.iter_mut().enumerate() {
        // 14 to 26 in base 3: the half of the 27 digits after the middle, 111.
        let n = k + 14;
        *out = DVec3::new((n / 9) as f64 - 1.0, (n / 3 % 3) as f64 - 1.0, (n % 3) as f64 - 1.0).normalize();
    }
    out
}

/// Sets the bits whose centres a triangle covers.
fn fill(t: [DVec2; 3], picture: &mut [u64; SIDE]) {
    let low = t[0].y.min(t[1].y).min(t[2].y);
    let high = t[0].y.max(t[1].y).max(t[2].y);
    let (first, end) = (centres(low), centres(high));
    for (y, row) in picture.iter_mut().enumerate().take(end).skip(first) {
        let at = y as f64 + 0.5;
        let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
        for i in 0..3 {
            let (p, q) = (t[i], t[(i + 1) % 3]);
            if (p.y <= at) != (q.y <= at) {
                let x = p.x + (q.x - p.x) * ((at - p.y) / (q.y - p.y));
                (left, right) = (left.min(x), right.max(x));
            }
        }
        let (from, to) = (centres(left), centres(right));
        if from < to {
            *row |= u64::MAX >> (SIDE - (to - from)) << from;
        }
    }
}

/// How many centres lie before a coordinate or at it, 0 to 64.
fn centres(x: f64) -> usize {
    (x + 0.5).clamp(0.0, SIDE as f64) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_flat_thing_covers_more_than_the_greatest_sum_of_directions() {
        let directions = directions();
        let sum = |signs: u32| -> DVec3 {
            directions.iter().enumerate().map(|(k, d)| if signs >> k & 1 != 0 { *d } else { -*d }).sum()
        };
        let most = (0..1 << DIRECTIONS).map(|signs| sum(signs).length()).fold(0.0, f64::max) / DIRECTIONS as f64;
        assert!((MOST_FLAT - most).abs() < 1e-9 && MOST_FLAT >= most, "{most}");
    }
}
