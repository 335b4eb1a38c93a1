//! Fronts: windows, sills, bands, doors and awnings set upon a wall, thin solids half sunk into it.

use glam::Vec3;

use super::super::solid::Solid;

/// Which way a wall faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    West,
    East,
    North,
    South,
}

pub(super) const SIDES: [Side; 4] = [Side::West, Side::East, Side::North, Side::South];

/// A box-shaped body that fronts are set upon: half its sizes along x and z, about the object's position.
#[derive(Debug, Clone, Copy)]
pub(super) struct Body {
    pub half_x: f32,
    pub half_z: f32,
    /// Foot and top of the wall.
    pub y0: f32,
    pub y1: f32,
}

impl Body {
    /// Metres of wall on a side.
    pub fn width(&self, side: Side) -> f32 {
        match side {
            Side::West | Side::East => self.half_z * 2.0,
            Side::North | Side::South => self.half_x * 2.0,
        }
    }

    /// A box on a wall: `u` from the middle of the wall to the middle of the box, from `y` upwards; `size` is width, height
    /// and how far it stands out.
    pub fn on_wall(&self, solid: &mut Solid, side: Side, u: f32, y: f32, size: Vec3) {
        let (low, high) = (u - size.x * 0.5, u + size.x * 0.5);
        let sunk = 0.1;
        let (min, max) = match side {
            Side::West => ((-self.half_x - size.z, low), (-self.half_x + sunk, high)),
            Side::East => ((self.half_x - sunk, low), (self.half_x + size.z, high)),
            Side::North => ((low, -self.half_z - size.z), (high, -self.half_z + sunk)),
            Side::South => ((low, self.half_z - sunk), (high, self.half_z + size.z)),
        };
        solid.cuboid(Vec3::new(min.0, y, min.1), Vec3::new(max.0, y + size.y, max.1));
    }

    /// A ledge all around, like a sill that does not end.
    pub fn ledge(&self, solid: &mut Solid, y: f32, height: f32, out: f32) {
        let (x, z) = (self.half_x + out, self.half_z + out);
        solid.cuboid(Vec3::new(-x, y, -z), Vec3::new(x, y + height, z));
    }
}

/// Windows in rows, with a sill under each row, from the floor `first` up.
pub(super) fn windows(solid: &mut Solid, body: &Body, side: Side, storey: f32, first: usize, spacing: f32) {
    let width = body.width(side);
    let bays = (width / spacing) as usize;
    let floors = ((body.y1 - body.y0) / storey + 0.01) as usize;
    for floor in first..floors {
        let y = body.y0 + floor as f32 * storey;
        body.on_wall(solid, side, 0.0, y + 0.75, Vec3::new(width * 0.96, 0.12, 0.14));
        for bay in 0..bays {
            let u = (bay as f32 + 0.5) * width / bays as f32 - width * 0.5;
            body.on_wall(solid, side, u, y + 0.95, Vec3::new(1.15, storey * 0.52, 0.06));
        }
    }
}

/// The ground floor: a door with a step, and shop windows or an awning beside it.
pub(super) fn ground_floor(solid: &mut Solid, body: &Body, side: Side, shop: bool) {
    let width = body.width(side);
    let door = -width * 0.28;
    body.on_wall(solid, side, door, body.y0, Vec3::new(1.1, 2.2, 0.08));
    body.on_wall(solid, side, door, body.y0, Vec3::new(1.5, 0.16, 0.5));
    if shop {
        body.on_wall(solid, side, width * 0.15, body.y0 + 0.5, Vec3::new(width * 0.5, 1.7, 0.07));
        body.on_wall(solid, side, width * 0.15, body.y0 + 2.4, Vec3::new(width * 0.56, 0.14, 0.9));
    } else {
        for u in [0.02, 0.32] {
            body.on_wall(solid, side, width * u, body.y0 + 0.9, Vec3::new(1.15, 1.5, 0.06));
        }
    }
}

/// A ledge for every storey, as glass towers and slabs have.
pub(super) fn ledges(solid: &mut Solid, body: &Body, storey: f32, every: usize) {
    let floors = ((body.y1 - body.y0) / storey + 0.01) as usize;
    for floor in (1..floors).step_by(every.max(1)) {
        body.ledge(solid, body.y0 + floor as f32 * storey - 0.2, 0.4, 0.18);
    }
}

/// Upright fins up the whole wall.
pub(super) fn fins(solid: &mut Solid, body: &Body, side: Side, spacing: f32) {
    let width = body.width(side);
    let bays = (width / spacing) as usize;
    for bay in 0..=bays {
        let u = (bay as f32 / bays.max(1) as f32 - 0.5) * (width - 0.6);
        body.on_wall(solid, side, u, body.y0, Vec3::new(0.3, body.y1 - body.y0, 0.35));
    }
}

/// Balconies: a slab and a rail for each, on the bays of one side.
pub(super) fn balconies(solid: &mut Solid, body: &Body, side: Side, storey: f32, spacing: f32) {
    let width = body.width(side);
    let bays = (width / spacing) as usize;
    let floors = ((body.y1 - body.y0) / storey + 0.01) as usize;
    for floor in 1..floors {
        let y = body.y0 + floor as f32 * storey;
        for bay in 0..bays {
            let u = (bay as f32 + 0.5) * width / bays as f32 - width * 0.5;
            body.on_wall(solid, side, u, y - 0.1, Vec3::new(spacing * 0.6, 1.0, 1.1));
        }
    }
}
