//! Occlusion horizons, for cities (Downs, Moeller, Sequin, *Occlusion horizons for driving through urban scenery*, 2001;
//! Russin's lecture): what the buildings drawn so far hide, by azimuth and slope around the eye.
//!
//! The full circle is cut into [`SECTORS`] of azimuth. A sector holds intervals of slope, height over horizontal distance,
//! in which every ray has met an occluder. Occluders are upright boxes inside what is drawn ([`Prisms`]); they are rounded
//! inwards: to whole sectors less one at either end, to the slopes that every ray of three sectors shares, and by a hundredth of
//! a pixel. Objects come front to back by the horizontal distance to their boxes, which are rounded outwards: hidden is a box
//! whose slopes lie within one interval in each of its sectors. A prism waits until the distance is reached by which all its rays
//! have met it, so nothing is hidden by what may lie behind it. What lies outside the view counts as hidden.
//!
//! Sectors are about the world's vertical, y; the camera may pitch and roll as it will, and look straight up or down.
//! Conservative as sets of points (SEMANTICS, *What "conservative" covers*); the roundings exceed what snapping to samples moves. A
//! parallel view has no eye: nothing is culled in it. Costs a few products a sector of an occluder, and a few comparisons a
//! sector of an object; no allocation when the memory has grown.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::f64::consts::TAU;

use glam::{DMat3, DVec2, DVec3, Mat3, Vec3Swizzles};
use homcull_simd::Level;

use super::VisibleSet;
use super::vfc::{VfcMemory, World};
use crate::geometry::Aabb;
use crate::select::Prisms;
use crate::view::{View, lies_beyond_near};

/// Sectors of the full circle: a pixel and a half each, at 60 degrees and 1280 x 1024.
pub const SECTORS: usize = 4096;
const SECTOR: f64 = TAU / SECTORS as f64;
/// Intervals of slope that a sector keeps; of more, the narrowest is forgotten.
const INTERVALS: usize = 6;
/// Sectors of a prism that wait together.
const RUN: usize = 16;
/// Pixels that occluders are drawn in by: snapping moves a corner by a 512th, in x and in y.
const MARGIN: f64 = 1.0 / 128.0;
/// Relative slack of what is computed in f64.
const SLACK: f64 = 1e-9;
/// Distance of a chord between two points at most three sectors apart, over that of the nearer of them, at least.
const CHORD: f64 = 1.0 - 1e-5;

/// An upright prism about the eye: four corners, convex, as (x, z), and from where to where it reaches in y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prism {
    /// In order around it.
    pub corners: [DVec2; 4],
    /// Lowest y.
    pub low: f64,
    /// Highest y.
    pub high: f64,
}

impl Prism {
    /// A box in the space of an object, which is placed by its rotation, one that leaves it upright, and then by `shift`.
    pub fn placed(b: Aabb, rotation: Option<Mat3>, shift: DVec3) -> Prism {
        let r = rotation.map_or(DMat3::IDENTITY, |r| r.as_dmat3());
        let (min, max) = (b.min.as_dvec3(), b.max.as_dvec3());
        let at = |x: f64, z: f64| (r * DVec3::new(x, 0.0, z) + shift).xz();
        let heights = [min.y, max.y].map(|y| r.y_axis.y * y + shift.y);
        Prism {
            corners: [at(min.x, min.z), at(max.x, min.z), at(max.x, max.z), at(min.x, max.z)],
            low: heights[0].min(heights[1]),
            high: heights[0].max(heights[1]),
        }
    }

    /// Where a ray on the ground plan enters and leaves; `None` where it does not surely do both, beyond the eye.
    fn hit(&self, way: DVec2, turn: f64) -> Option<[f64; 2]> {
        let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
        for k in 0..4 {
            let (a, b) = (self.corners[k], self.corners[(k + 1) % 4]);
            let inward = (b - a).perp() * turn;
            let (rate, from) = (inward.dot(way), inward.dot(a));
            if rate > 0.0 {
                enter = enter.max(from / rate);
            } else if rate < 0.0 {
                leave = leave.min(from / rate);
            } else if from >= 0.0 {
                return None;
            }
        }
        (enter > 0.0 && leave.is_finite() && leave > enter * (1.0 + 2.0 * SLACK))
            .then_some([enter * (1.0 + SLACK), leave * (1.0 - SLACK)])
    }
}

/// The directions around the origin in which some points on the ground plan are seen: an angle from x towards z, and how
/// far it goes on; `None` unless they are seen within half a turn. All in radians.
fn directions(points: &[DVec2]) -> Option<[f64; 2]> {
    let middle = points.iter().copied().sum::<DVec2>();
    let offset = |p: &DVec2| libm::atan2(middle.perp_dot(*p), middle.dot(*p));
    let (low, high) =
        points.iter().map(offset).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), o| (a.min(o), b.max(o)));
    let seen = middle.is_finite() && middle != DVec2::ZERO && high - low < TAU * 0.5;
    seen.then(|| [libm::atan2(middle.y, middle.x) + low, high - low])
}

/// Disjoint closed intervals of slope in which every ray has met an occluder.
#[derive(Debug, Clone, Copy)]
struct Slopes {
    count: usize,
    intervals: [[f32; 2]; INTERVALS],
}

impl Slopes {
    const NONE: Slopes = Slopes { count: 0, intervals: [[0.0; 2]; INTERVALS] };

    /// Adds an interval; joined with those that it touches.
    fn cover(&mut self, [mut low, mut high]: [f32; 2]) {
        if low.is_nan() || high.is_nan() || low > high {
            return;
        }
        let mut kept = 0;
        for k in 0..self.count {
            let [a, b] = self.intervals[k];
            if b < low || a > high {
                self.intervals[kept] = [a, b];
                kept += 1;
            } else {
                (low, high) = (low.min(a), high.max(b));
            }
        }
        if kept == INTERVALS {
            let width = |k: &usize| self.intervals[*k][1] - self.intervals[*k][0];
            let narrowest = (0..kept).min_by(|a, b| width(a).total_cmp(&width(b))).unwrap_or(0);
            if high - low > width(&narrowest) {
                self.intervals[narrowest] = [low, high];
            }
        } else {
            self.intervals[kept] = [low, high];
            kept += 1;
        }
        self.count = kept;
    }

    fn hide(&self, low: f32, high: f32) -> bool {
        self.intervals[..self.count].iter().any(|&[a, b]| a <= low && high <= b)
    }
}

/// What a view sees around its eye.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// The eye, in the world.
    pub eye: DVec3,
    /// Azimuth, as an angle from x towards z and how far it goes on, in radians; `None` for the full circle.
    azimuth: Option<[f64; 2]>,
    /// Least and greatest slope.
    slopes: [f64; 2],
    /// The greatest angle of a pixel, in radians.
    pixel: f64,
}

impl Limits {
    /// The full circle and all slopes, for pixels of an angle, in radians.
    pub fn around(eye: DVec3, pixel: f64) -> Limits {
        Limits { eye, azimuth: None, slopes: [f64::NEG_INFINITY, f64::INFINITY], pixel }
    }

    /// Those of a view; `None` for a parallel one, and where they cannot be computed.
    pub fn of(view: &View) -> Option<Limits> {
        let [x, y, w, ..] = *view.rows();
        let rows = DMat3::from_cols(x.truncate(), y.truncate(), w.truncate()).transpose();
        let inverse = rows.inverse();
        let centre = inverse * -DVec3::new(x.w, y.w, w.w);
        if w.truncate() == DVec3::ZERO || !inverse.is_finite() || !centre.is_finite() {
            return None;
        }
        // The ray through a place on the screen, in subpixels, to where w is 1.
        let side = |samples: u32| f64::from(samples) * 256.0;
        let (right, bottom) = (side(view.viewport().width()), side(view.viewport().height()));
        let corners = [(0.0, 0.0), (right, 0.0), (right, bottom), (0.0, bottom)];
        let corners = corners.map(|(px, py)| (inverse * DVec3::new(px, py, 1.0)).normalize());
        let pixel = 256.0 * (inverse.x_axis.length() + inverse.y_axis.length()) * w.truncate().length();
        let sees = |way: DVec3| {
            let p = rows * way;
            let by = 512.0 * p.z;
            p.z > 0.0 && p.x >= -by && p.y >= -by && p.x <= right * p.z + by && p.y <= bottom * p.z + by
        };
        let (up, down) = (sees(DVec3::Y), sees(DVec3::NEG_Y));
        let greatest = |sees: bool, way: DVec3| if sees { f64::INFINITY } else { steepest(&corners, way, pixel) };
        let azimuth = if up || down { None } else { directions(&corners.map(DVec3::xz)) };
        let slopes = [-greatest(down, DVec3::NEG_Y), greatest(up, DVec3::Y)];
        let limits = Limits { eye: view.eye() + centre, azimuth, slopes, pixel };
        pixel.is_finite().then_some(limits)
    }
}

/// The greatest slope towards `up` or down in the cone of four rays, widened by two pixels.
fn steepest(corners: &[DVec3; 4], way: DVec3, pixel: f64) -> f64 {
    let slope = |d: DVec3| d.dot(way) / d.xz().length();
    let mut most = f64::NEG_INFINITY;
    for k in 0..4 {
        let (a, b) = (corners[k], corners[(k + 1) % 4]);
        most = most.max(slope(a));
        // On a side of the screen the steepest ray may lie between the corners.
        let normal = a.cross(b).normalize_or_zero();
        let up = way - normal * normal.dot(way);
        if up.length() > SLACK && a.cross(up).dot(normal) >= 0.0 && up.cross(b).dot(normal) >= 0.0 {
            most = most.max(slope(up));
        }
    }
    // What is not a number limits nothing.
    if most.is_nan() { f64::INFINITY } else { most + 2.0 * pixel * (1.0 + most * most) }
}

/// A run of a prism's sectors that waits for its distance. In order of distance, whose bits sort as it does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Waiting {
    distance: u64,
    /// Its first slopes, and how many.
    slopes: usize,
    count: usize,
    sector: usize,
}

/// The horizon of a view in the making. Reused from view to view.
#[derive(Debug, Clone)]
pub struct Horizon {
    /// Where sectors begin: unit vectors on the ground plan.
    ways: Vec<DVec2>,
    sectors: Vec<Slopes>,
    waiting: BinaryHeap<Reverse<Waiting>>,
    /// Slopes of what waits.
    slopes: Vec<[f32; 2]>,
    hits: Vec<Option<[f64; 2]>>,
    /// How far it has got.
    reached: f64,
    pixel: f64,
}

impl Default for Horizon {
    fn default() -> Horizon {
        let way = |k: usize| DVec2::new(libm::cos(k as f64 * SECTOR), libm::sin(k as f64 * SECTOR));
        Horizon {
            ways: (0..SECTORS).map(way).collect(),
            sectors: vec![Slopes::NONE; SECTORS],
            waiting: BinaryHeap::new(),
            slopes: Vec::new(),
            hits: Vec::new(),
            reached: 0.0,
            pixel: 0.0,
        }
    }
}

impl Horizon {
    /// Begins a view: nothing hides, but what lies outside the limits is hidden.
    pub fn begin(&mut self, limits: &Limits) {
        self.waiting.clear();
        self.slopes.clear();
        (self.reached, self.pixel) = (0.0, limits.pixel);
        let [least, greatest] = limits.slopes.map(|s| s as f32);
        let mut open = Slopes::NONE;
        if least.is_finite() {
            open.cover([f32::NEG_INFINITY, least.next_down()]);
        }
        if greatest.is_finite() {
            open.cover([greatest.next_up(), f32::INFINITY]);
        }
        let mut outside = Slopes::NONE;
        outside.cover([f32::NEG_INFINITY, f32::INFINITY]);
        match limits.azimuth.map(|[from, span]| sectors_of(from, span, 2)) {
            Some((first, count)) if count < SECTORS => {
                self.sectors.fill(outside);
                (0..count).for_each(|k| self.sectors[(first + k) % SECTORS] = open);
            }
            _ => self.sectors.fill(open),
        }
    }

    /// Adds a prism about the eye: it hides from the distance on by which it is met. One around or above the eye, or below, or that
    /// has no area, hides nothing.
    pub fn add(&mut self, prism: &Prism) {
        let [a, b, c, d] = prism.corners;
        let turn = (c - a).perp_dot(d - b).signum();
        let Some([from, span]) = directions(&prism.corners).filter(|_| turn.is_finite()) else { return };
        let (first, count) = sectors_of(from, span, 0);
        self.hits.clear();
        self.hits.extend((0..count + 1).map(|k| prism.hit(self.ways[(first + k) % SECTORS], turn)));
        // All around a sector, and around its neighbours: rays that meet a convex outline are next to each other.
        let Some(begin) = self.hits.iter().position(Option::is_some) else { return };
        let end = begin + self.hits[begin..].iter().take_while(|hit| hit.is_some()).count();
        let farthest = prism.corners.iter().map(|p| p.length()).fold(0.0, f64::max);
        let mut at = begin + 1;
        while at + 2 < end {
            let run = RUN.min(end - 2 - at);
            self.add_run(prism, (first + at) % SECTORS, at, run, farthest);
            at += run;
        }
    }

    /// Adds a run of sectors, the first of which lies between the hits `at` and `at + 1`.
    fn add_run(&mut self, prism: &Prism, sector: usize, at: usize, count: usize, farthest: f64) {
        let (low, high) = (prism.low, prism.high);
        // Met on entering where it reaches from below the eye to above; else perhaps only on leaving.
        let level = low <= 0.0 && high >= 0.0;
        let (slopes, mut distance) = (self.slopes.len(), if level { 0.0 } else { farthest });
        for k in at..at + count {
            let around = self.hits[k - 1..=k + 2].iter().flatten();
            let (enter, leave) = around.fold((0.0f64, f64::INFINITY), |(e, l), hit| (e.max(hit[0]), l.min(hit[1])));
            let leave = leave * CHORD;
            distance = distance.max(enter);
            let least = if low <= 0.0 { low / enter } else { low / leave };
            let most = if high >= 0.0 { high / enter } else { high / leave };
            self.slopes.push(drawn_in(least, most, self.pixel * MARGIN));
        }
        let distance = (distance * (1.0 + SLACK)).to_bits();
        self.waiting.push(Reverse(Waiting { distance, slopes, count, sector }));
    }

    /// Whether a box about the eye is hidden by the prisms that lie before it. Boxes must come nearest first, by the horizontal
    /// distance; one that does not is never hidden, nor one above the eye or below.
    pub fn hides(&mut self, min: DVec3, max: DVec3) -> bool {
        let [near, far] = horizontal_distances(min, max);
        if !(near > 0.0 && near >= self.reached && far.is_finite()) {
            return false;
        }
        self.reach(near);
        let corners = [min.xz(), DVec2::new(max.x, min.z), max.xz(), DVec2::new(min.x, max.z)];
        let Some([from, span]) = directions(&corners) else { return false };
        let low = if min.y < 0.0 { min.y / near } else { min.y / far };
        let high = if max.y > 0.0 { max.y / near } else { max.y / far };
        let outward = |slope: f64| slope.abs() * SLACK;
        let (low, high) = (((low - outward(low)) as f32).next_down(), ((high + outward(high)) as f32).next_up());
        let (first, count) = sectors_of(from, span, 0);
        (0..count.min(SECTORS)).all(|k| self.sectors[(first + k) % SECTORS].hide(low, high))
    }

    /// Lets hide what waited for a distance.
    fn reach(&mut self, distance: f64) {
        self.reached = distance;
        let due = (distance * (1.0 - SLACK)).to_bits();
        while let Some(Reverse(next)) = self.waiting.peek().copied().filter(|Reverse(next)| next.distance <= due) {
            self.waiting.pop();
            for k in 0..next.count {
                self.sectors[(next.sector + k) % SECTORS].cover(self.slopes[next.slopes + k]);
            }
        }
    }
}

/// Slopes drawn in by an angle, as far as that is less than a sector in azimuth; an empty interval if it never is.
fn drawn_in(least: f64, most: f64, angle: f64) -> [f32; 2] {
    if angle >= SECTOR {
        return [1.0, 0.0];
    }
    let steep = libm::sqrt((SECTOR / angle) * (SECTOR / angle) - 1.0);
    let by = |slope: f64| angle * (1.0 + slope * slope) + slope.abs() * SLACK;
    let (least, most) = (least.max(-steep), most.min(steep));
    [((least + by(least)) as f32).next_up(), ((most - by(most)) as f32).next_down()]
}

/// The sectors that some directions meet, and `more` on either side: the first, and how many.
fn sectors_of(from: f64, span: f64, more: usize) -> (usize, usize) {
    let first = ((from - SLACK) / SECTOR).floor() as i64 - more as i64;
    let last = ((from + span + SLACK) / SECTOR).floor() as i64 + more as i64;
    (first.rem_euclid(SECTORS as i64) as usize, (last - first + 1).max(0) as usize)
}

/// The nearest and the farthest horizontal distance of a box about the eye, rounded outwards.
fn horizontal_distances(min: DVec3, max: DVec3) -> [f64; 2] {
    let near = min.xz().max(-max.xz()).max(DVec2::ZERO).length();
    let far = min.xz().abs().max(max.xz().abs()).length();
    [near * (1.0 - SLACK), far * (1.0 + SLACK)]
}

/// Working memory, reused from frame to frame.
#[derive(Default)]
pub struct HorizonsMemory {
    vfc: VfcMemory,
    horizon: Horizon,
    /// Bits of horizontal distances, with ids.
    order: Vec<(u64, u32)>,
    hidden: Vec<bool>,
}

/// What is in the frustum and not hidden by prisms of what is drawn before it, nearest first.
pub fn cull(world: &World<'_>, prisms: &Prisms, level: Level, view: &View, memory: &mut HorizonsMemory) -> VisibleSet {
    let HorizonsMemory { vfc, horizon, order, hidden } = memory;
    world.collect(level, view, false, &mut vfc.stack, &mut vfc.boxes);
    let mut set = world.all_of(&vfc.boxes);
    let Some(limits) = Limits::of(view) else { return set };
    let scene = world.scene;
    let shift = scene.origin - limits.eye;
    let about_eye = |id: u32| {
        let b = scene.bounds[id as usize];
        (b.min.as_dvec3() + shift, b.max.as_dvec3() + shift)
    };
    order.clear();
    order.extend(set.objects.iter().filter(|&&id| scene.bounds[id as usize].is_finite()).map(|&id| {
        let (min, max) = about_eye(id);
        (horizontal_distances(min, max)[0].to_bits(), id)
    }));
    order.sort_unstable();
    hidden.clear();
    hidden.resize(scene.bounds.len(), false);
    horizon.begin(&limits);
    for &(_, id) in order.iter() {
        let (min, max) = about_eye(id);
        set.queries += 1;
        if horizon.hides(min, max) {
            hidden[id as usize] = true;
            set.triangles_hidden += u64::from(scene.triangles(id));
            continue;
        }
        let boxes = prisms.of(id);
        if !boxes.is_empty() && lies_beyond_near(view, scene.bounds[id as usize], scene.origin) {
            let object = &scene.occluders[id as usize];
            for &b in boxes {
                horizon.add(&Prism::placed(b, object.rotation, object.position - limits.eye));
            }
        }
    }
    set.objects.retain(|&id| !hidden[id as usize]);
    set
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_hide_what_their_union_holds_in_one_piece() {
        let mut state = 7u64;
        let mut draw = |n: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % n
        };
        for _ in 0..2000 {
            // Five at most: none is forgotten. Cells of the oracle: places and the gaps between them.
            let (mut slopes, mut cells) = (Slopes::NONE, [false; 41]);
            for _ in 0..5 {
                let (a, b) = (draw(20), draw(20));
                slopes.cover([a as f32, b as f32]);
                (2 * a..=2 * b).for_each(|k| cells[k as usize] = true);
                for low in 0..20 {
                    for high in low..20 {
                        let held = cells[2 * low..=2 * high].iter().all(|&c| c);
                        assert_eq!(slopes.hide(low as f32, high as f32), held, "{low} to {high} in {slopes:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn of_too_many_intervals_the_narrowest_is_forgotten() {
        let mut slopes = Slopes::NONE;
        (0..8).for_each(|k| slopes.cover([k as f32 * 10.0, k as f32 * 10.0 + 1.0 + k as f32]));
        assert_eq!(slopes.count, INTERVALS);
        assert!(!slopes.hide(0.0, 1.0) && !slopes.hide(10.0, 12.0) && slopes.hide(70.0, 78.0));
    }
}
