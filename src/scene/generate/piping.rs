//! What machinery is piped and walked with: pipes with bends, flanges, valves, vessels, gratings, rails, stairs, ladders.
//!
//! Closed solids throughout (see `solid`), in metres. What has an axis of its own is made along y and turned by
//! `upright_to`; shapes used often are made once and placed as instances.

use glam::{Mat3, Vec2, Vec3};

use super::solid::{Solid, circle, upright_to};

/// A pipe of `sides` along a polyline of at least two points, its corners rounded with the radius `bend` about the axis (as
/// far as the straights allow) in `steps` steps: 2 * sides a stretch or step, and the caps.
pub(super) fn pipe(solid: &mut Solid, sides: usize, radius: f32, points: &[Vec3], (bend, steps): (f32, usize)) {
    let mut ahead = (points[1] - points[0]).normalize();
    let mut aside = upright_to(ahead).x_axis;
    let mut rings = vec![ring(sides, radius, points[0], aside, ahead)];
    for k in 1..points.len() - 1 {
        let (corner, next) = (points[k], (points[k + 1] - points[k]).normalize());
        let cosine = ahead.dot(next).clamp(-1.0, 1.0);
        if cosine > 0.9999 {
            continue;
        }
        let sine = libm::sqrtf(1.0 - cosine * cosine).max(1e-3);
        // How far before and after the corner the bend begins and ends: radius * tan(half the angle).
        let half_tangent = sine / (1.0 + cosine).max(1e-3);
        let room = (corner - points[k - 1]).length().min((points[k + 1] - corner).length()) * 0.49;
        let reach = (bend * half_tangent).min(room);
        let bend = reach / half_tangent;
        let inward = (next - ahead * cosine) / sine;
        let (middle, out) = (corner - ahead * reach + inward * bend, ahead.cross(inward));
        let (along_inward, along_out) = (aside.dot(inward), aside.dot(out));
        let angle = libm::acosf(cosine);
        for step in 0..=steps.max(1) {
            let turn = angle * step as f32 / steps.max(1) as f32;
            let (s, c) = (libm::sinf(turn), libm::cosf(turn));
            let (tangent, radial) = (ahead * c + inward * s, inward * c - ahead * s);
            aside = radial * along_inward + out * along_out;
            rings.push(ring(sides, radius, middle - radial * bend, aside, tangent));
        }
        ahead = next;
    }
    rings.push(ring(sides, radius, points[points.len() - 1], aside, ahead));
    solid.skin(&rings);
}

/// A regular ring that turns by the right hand about `ahead`, a unit vector, with `aside` perpendicular to it.
fn ring(sides: usize, radius: f32, middle: Vec3, aside: Vec3, ahead: Vec3) -> Vec<Vec3> {
    let up = aside.cross(ahead);
    circle(sides, Vec2::ZERO, radius).iter().map(|p| middle + aside * p.x + up * p.y).collect()
}

/// A rod of few sides from one point to another: 4 * sides - 4 triangles.
pub(super) fn rod(solid: &mut Solid, sides: usize, radius: f32, from: Vec3, to: Vec3) {
    pipe(solid, sides, radius, &[from, to], (0.0, 1));
}

/// A round bar bent to a ring about y, around the origin: 2 * sides * steps triangles.
pub(super) fn torus(solid: &mut Solid, steps: usize, radius: f32, sides: usize, bar: f32) {
    let rings: Vec<Vec<Vec3>> = circle(steps, Vec2::ZERO, 1.0)
        .iter()
        .map(|p| {
            let out = Vec3::new(p.x, 0.0, p.y);
            ring(sides, bar, out * radius, out, Vec3::Y.cross(out))
        })
        .collect();
    solid.hoop(&rings);
}

/// Bolts of five sides standing on a circle about y, from `y0` to `y1`: 16 triangles each.
pub(super) fn bolts(solid: &mut Solid, count: usize, circle_radius: f32, size: f32, (y0, y1): (f32, f32)) {
    for at in circle(count, Vec2::ZERO, circle_radius) {
        solid.column(5, at, (y0, size), (y1, size));
    }
}

/// A pair of flanges about y around the origin, for a pipe of `radius`, with `count` bolts through: 8 * sides - 8 and 16 a
/// bolt.
pub(super) fn flange(sides: usize, radius: f32, count: usize) -> Solid {
    let mut solid = Solid::default();
    let (outer, thick) = (radius * 1.45 + 0.02, radius * 0.16 + 0.008);
    for (y0, y1) in [(-thick, -thick * 0.08), (thick * 0.08, thick)] {
        solid.column(sides, Vec2::ZERO, (y0, outer), (y1, outer));
    }
    let size = (outer - radius) * 0.3;
    bolts(&mut solid, count, (outer + radius) * 0.5, size, (-thick - size, thick + size));
    solid
}

/// The body of a gate valve in a pipe of `radius` along x, its stem along y, flanged at both ends; and its handwheel, apart,
/// since it has a colour of its own. The body is `4.4 * radius + 0.05` long.
pub(super) fn valve(radius: f32) -> [Solid; 2] {
    let (mut body, mut wheel) = (Solid::default(), Solid::default());
    let (along, half) = (upright_to(Vec3::X), valve_length(radius) * 0.5);
    let thick = radius * 0.2 + 0.006;
    let outer = radius * 1.45 + 0.02;
    let shape = [(radius, thick - half), (radius * 1.1, -half * 0.6), (radius * 1.5, 0.0), (radius * 1.1, half * 0.6)];
    let shape: Vec<(f32, f32)> = shape.into_iter().chain([(radius, half - thick)]).collect();
    let mut trunk = Solid::default();
    trunk.lathe(10, &shape);
    for (y0, y1) in [(-half, thick - half), (half - thick, half)] {
        trunk.column(12, Vec2::ZERO, (y0, outer), (y1, outer));
    }
    body.join(&trunk, along, Vec3::ZERO);
    // The bonnet with its flange and bolts, the gland, and the yoke that carries the stem.
    let top = radius * 2.2 + 0.02;
    let bonnet = [(radius * 1.05, 0.0), (radius * 1.05, top), (radius * 0.5, top * 1.35), (radius * 0.4, top * 1.6)];
    body.lathe(8, &bonnet);
    body.column(10, Vec2::ZERO, (top * 0.8, radius * 1.45), (top, radius * 1.45));
    bolts(&mut body, 4, radius * 1.25, radius * 0.16, (top * 0.72, top * 1.08));
    let stem = top * 2.4 + 0.06;
    for side in [-1.0, 1.0] {
        let foot = Vec3::new(0.0, top * 1.3, side * radius * 0.55);
        rod(&mut body, 5, radius * 0.14, foot, Vec3::new(0.0, stem * 0.93, side * radius * 0.3));
    }
    body.column(8, Vec2::ZERO, (stem * 0.88, radius * 0.42), (stem * 0.95, radius * 0.42));
    body.column(6, Vec2::ZERO, (top, radius * 0.18), (stem * 1.12, radius * 0.18));
    let rim = radius * 1.5 + 0.05;
    let mut hand = Solid::default();
    torus(&mut hand, 16, rim, 5, 0.012 + radius * 0.06);
    for spoke in circle(4, Vec2::ZERO, rim) {
        rod(&mut hand, 5, 0.008 + radius * 0.04, Vec3::ZERO, Vec3::new(spoke.x, 0.0, spoke.y));
    }
    hand.column(8, Vec2::ZERO, (-0.02, 0.02 + radius * 0.2), (0.03, 0.015 + radius * 0.18));
    wheel.join(&hand, Mat3::IDENTITY, Vec3::Y * stem);
    [body, wheel]
}

/// How long the body of [`valve`] is along its pipe.
pub(super) fn valve_length(radius: f32) -> f32 {
    4.4 * radius + 0.05
}

/// A closed vessel about y, from 0 to `length`, with dished heads: a tank, a bottle, a shell of an exchanger.
pub(super) fn vessel(solid: &mut Solid, sides: usize, radius: f32, length: f32) {
    let dish = (radius * 0.5).min(length * 0.45);
    // Quarter of an ellipse, as (share of the radius, share of the dish).
    let head = [(0.0, 0.0), (0.44, 0.102), (0.76, 0.35), (0.95, 0.69), (1.0, 1.0)];
    let low = head.iter().map(|&(r, y)| (r * radius, y * dish));
    let high = head.iter().rev().map(|&(r, y)| (r * radius, length - y * dish));
    let profile: Vec<(f32, f32)> = low.chain(high).collect();
    solid.lathe(sides, &profile);
}

/// A panel of grating with its top at 0, `size` in x and z around the origin: bearing bars along z every `pitch`, cross bars
/// every four times that, in a frame; 12 triangles a bar.
pub(super) fn grating(size: Vec2, pitch: f32) -> Solid {
    let mut solid = Solid::default();
    let (half, deep, thin) = (size * 0.5, 0.035, 0.006);
    for side in [-1.0, 1.0] {
        solid.block(side * (half.x - thin), -deep, 0.0, Vec3::new(thin * 2.0, deep, size.y));
        solid.block(0.0, -deep, side * (half.y - thin), Vec3::new(size.x - thin * 4.0, deep, thin * 2.0));
    }
    let count = (size.x / pitch) as usize;
    for k in 1..count {
        let x = size.x * (k as f32 / count as f32 - 0.5);
        solid.block(x, -deep, 0.0, Vec3::new(thin, deep, size.y - thin * 4.0));
    }
    let count = (size.y / (pitch * 4.0)) as usize;
    for k in 1..count {
        let z = size.y * (k as f32 / count as f32 - 0.5);
        solid.block(0.0, -deep * 0.5, z, Vec3::new(size.x - thin * 4.0, deep * 0.4, thin));
    }
    solid
}

/// A handrail with a knee rail and a toe board from one point on the deck to another, posts at most 1.6 m apart.
pub(super) fn rail(solid: &mut Solid, from: Vec3, to: Vec3) {
    for (height, radius) in [(1.05, 0.022), (0.55, 0.016)] {
        rod(solid, 7, radius, from + Vec3::Y * height, to + Vec3::Y * height);
    }
    let posts = ((to - from).length() / 1.6).ceil().max(1.0) as usize;
    for k in 0..=posts {
        let foot = from.lerp(to, k as f32 / posts as f32);
        rod(solid, 7, 0.02, foot, foot + Vec3::Y * 1.05);
    }
    beam(solid, from + Vec3::Y * 0.05, to + Vec3::Y * 0.05, Vec2::new(0.012, 0.1));
}

/// A bar of a rectangular section, `size` level and upward, about a line that is not upright: 12 triangles.
pub(super) fn beam(solid: &mut Solid, from: Vec3, to: Vec3, size: Vec2) {
    let ahead = (to - from).normalize();
    let aside = Vec3::Y.cross(ahead).normalize();
    let (level, upward) = (aside * size.x * 0.5, ahead.cross(aside) * size.y * 0.5);
    let end = |at: Vec3| vec![at - level - upward, at + level - upward, at + level + upward, at - level + upward];
    solid.skin(&[end(from), end(to)]);
}

/// An inclined stair with open treads `width` wide from a foot to a top, with stringers and handrails.
pub(super) fn stairs(solid: &mut Solid, foot: Vec3, top: Vec3, width: f32) {
    let flat = Vec3::new(top.x - foot.x, 0.0, top.z - foot.z).normalize();
    let aside = Vec3::Y.cross(flat);
    let steps = ((top.y - foot.y) / 0.22).round().max(2.0) as usize;
    for k in 1..steps {
        let at = foot.lerp(top, k as f32 / steps as f32);
        beam(solid, at - flat * 0.12, at + flat * 0.12, Vec2::new(width, 0.03));
    }
    for side in [-1.0, 1.0] {
        let shift = aside * (width * 0.5 + 0.01) * side;
        beam(solid, foot + shift, top + shift, Vec2::new(0.02, 0.2));
        let (low, high) = (foot + shift * 1.06, top + shift * 1.06);
        rod(solid, 7, 0.02, low + Vec3::Y * 0.9, high + Vec3::Y * 0.95);
        for k in 0..3 {
            let at = low.lerp(high, 0.06 + 0.44 * k as f32);
            rod(solid, 6, 0.016, at, at + Vec3::Y * 0.92);
        }
    }
}

/// An upright ladder from a foot, `height` high, that faces `toward` (a unit vector on the level).
pub(super) fn ladder(solid: &mut Solid, foot: Vec3, height: f32, toward: Vec3) {
    let aside = Vec3::Y.cross(toward) * 0.22;
    for side in [-aside, aside] {
        rod(solid, 6, 0.022, foot + side, foot + side + Vec3::Y * height);
    }
    let rungs = (height / 0.3) as usize;
    for k in 1..=rungs {
        let at = foot + Vec3::Y * (k as f32 * 0.3 - 0.1);
        rod(solid, 5, 0.013, at - aside, at + aside);
    }
}
