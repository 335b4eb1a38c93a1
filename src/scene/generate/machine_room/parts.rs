//! Machines as lists of parts, each an instance of a mesh that all machines of the kind share; and who places them.

use glam::{Mat3, Vec2, Vec3};

use super::super::solid::Solid;
use super::super::stock::{Rank, Stock};
use super::plan::Plan;

/// The stock with a running number, so that names are unique.
pub(super) struct Room {
    pub stock: Stock,
    pub plan: Plan,
    pub seed: u64,
    count: usize,
}

impl Room {
    pub fn new(plan: Plan, seed: u64) -> Room {
        Room { stock: Stock::default(), plan, seed, count: 0 }
    }

    fn name(&mut self, kind: &str) -> String {
        self.count += 1;
        format!("{kind}_{}", self.count)
    }

    /// Places a shape.
    pub fn put(&mut self, rank: Rank, kind: &str, mesh: u32, (turn, at): (Mat3, Vec3), color: [u8; 3]) {
        let name = self.name(kind);
        self.stock.place_turned(rank, name, mesh, turn, at.as_dvec3(), color);
    }

    /// Places a shape with the piece before.
    pub fn add(&mut self, kind: &str, mesh: u32, (turn, at): (Mat3, Vec3), color: [u8; 3]) {
        let name = self.name(kind);
        self.stock.attach(name, mesh, turn, at.as_dvec3(), color);
    }

    /// Places a solid that is used once.
    pub fn put_new(&mut self, rank: Rank, kind: &str, solid: Solid, at: Vec3, color: [u8; 3]) {
        let name = self.name(kind);
        let mesh = self.stock.shape(solid);
        self.stock.place(rank, name, mesh, at.as_dvec3(), color);
    }
}

struct Part {
    rank: Rank,
    kind: &'static str,
    mesh: u32,
    turn: Mat3,
    at: Vec3,
    color: [u8; 3],
}

/// A machine about its own place on the deck: x along the room, y up, z away from the middle aisle.
#[derive(Default)]
pub(super) struct Assembly {
    parts: Vec<Part>,
}

impl Assembly {
    /// Adds a part that is there once.
    pub fn once(&mut self, stock: &mut Stock, rank: Rank, kind: &'static str, solid: Solid, color: [u8; 3]) {
        self.many(stock, rank, kind, solid, color, &[(Mat3::IDENTITY, Vec3::ZERO)]);
    }

    /// Adds a part at each of several places.
    pub fn many(
        &mut self,
        stock: &mut Stock,
        rank: Rank,
        kind: &'static str,
        solid: Solid,
        color: [u8; 3],
        places: &[(Mat3, Vec3)],
    ) {
        let mesh = stock.shape(solid);
        self.parts.extend(places.iter().map(|&(turn, at)| Part { rank, kind, mesh, turn, at, color }));
    }

    /// Places the machine on `side`.
    pub fn place(&self, room: &mut Room, at: Vec3, side: f32) {
        let about = facing(side);
        for part in &self.parts {
            let place = (about * part.turn, about * part.at + at);
            room.put(part.rank, part.kind, part.mesh, place, part.color);
        }
    }
}

/// Turns what is made for starboard to `side`: half a turn about y to port.
pub(super) fn facing(side: f32) -> Mat3 {
    Mat3::from_diagonal(Vec3::new(side, 1.0, side))
}

/// A turn about x, by the right hand, in degrees.
pub(super) fn tilted(degrees: f32) -> Mat3 {
    let angle = degrees.to_radians();
    let (s, c) = (libm::sinf(angle), libm::cosf(angle));
    Mat3::from_cols(Vec3::X, Vec3::new(0.0, c, s), Vec3::new(0.0, -s, c))
}

/// A turn about y, by the right hand, in radians.
pub(super) fn about_y(angle: f32) -> Mat3 {
    let (s, c) = (libm::sinf(angle), libm::cosf(angle));
    Mat3::from_cols(Vec3::new(c, 0.0, -s), Vec3::Y, Vec3::new(s, 0.0, c))
}

/// Tubes of six sides along y in a bundle of `radius`, from 0 to `length`, a pitch apart: 20 triangles each.
pub(super) fn tubes(radius: f32, pitch: f32, length: f32) -> Solid {
    let (mut solid, reach) = (Solid::default(), (radius / pitch) as i32);
    for (i, j) in (-reach..=reach).flat_map(|i| (-reach..=reach).map(move |j| (i, j))) {
        let at = Vec2::new(i as f32, j as f32) * pitch;
        if at.length() < radius - pitch * 0.4 {
            solid.column(6, at, (0.0, pitch * 0.35), (length, pitch * 0.35));
        }
    }
    solid
}

/// A convex outline of (y, z), counter-clockwise with y to the right and z up the page, drawn out from `x0` to `x1`:
/// 4n - 4 triangles.
pub(super) fn extrude(solid: &mut Solid, x0: f32, x1: f32, outline: &[Vec2]) {
    let ring = |x: f32| outline.iter().map(|p| Vec3::new(x, p.x, p.y)).collect::<Vec<_>>();
    solid.skin(&[ring(x0), ring(x1)]);
}

/// Joins what is made about y so that its axis lies along x, its foot at `at`.
pub(super) fn along_x(solid: &mut Solid, part: &Solid, at: Vec3) {
    solid.join(part, super::super::solid::upright_to(Vec3::X), at);
}

/// The paints.
pub(super) mod paint {
    pub const SHELL: [u8; 3] = [206, 210, 196];
    pub const FRAMES: [u8; 3] = [188, 196, 180];
    pub const BULKHEAD: [u8; 3] = [200, 206, 190];
    pub const DOOR: [u8; 3] = [150, 160, 150];
    pub const PLATE: [u8; 3] = [112, 116, 116];
    pub const GRATING: [u8; 3] = [98, 102, 106];
    pub const BEAM: [u8; 3] = [124, 130, 124];
    pub const RAIL: [u8; 3] = [216, 178, 52];
    pub const ENGINE: [u8; 3] = [112, 144, 124];
    pub const HEAD: [u8; 3] = [92, 112, 102];
    pub const COVER: [u8; 3] = [176, 178, 174];
    pub const DARK: [u8; 3] = [66, 72, 74];
    pub const STEEL: [u8; 3] = [142, 146, 150];
    pub const LAGGING: [u8; 3] = [202, 200, 192];
    pub const TURBO: [u8; 3] = [128, 116, 102];
    pub const GENERATOR: [u8; 3] = [84, 108, 138];
    pub const CABINET: [u8; 3] = [164, 170, 172];
    pub const WHEEL: [u8; 3] = [186, 48, 40];
    pub const BRASS: [u8; 3] = [178, 142, 70];
    pub const MOTOR: [u8; 3] = [70, 112, 128];
    pub const LAMP: [u8; 3] = [250, 248, 232];
    pub const CABLE: [u8; 3] = [54, 54, 58];
    pub const SEA: [u8; 3] = [64, 128, 92];
    pub const FRESH: [u8; 3] = [74, 122, 170];
    pub const FUEL: [u8; 3] = [138, 94, 56];
    pub const OIL: [u8; 3] = [206, 136, 48];
    pub const FIRE: [u8; 3] = [182, 58, 46];
    pub const AIR: [u8; 3] = [128, 170, 200];
    pub const BILGE: [u8; 3] = [82, 80, 78];
    pub const STEAM: [u8; 3] = [186, 188, 192];
}
