//! Where a unit is being built: its plan, the shapes to build with, and the stock that takes the pieces.

use glam::{DVec3, Mat3, Vec3};

use super::super::super::random::Random;
use super::super::solid::Solid;
use super::super::stock::{Rank, Stock};
use super::boiler::Boiler;
use super::frame::Steel;
use super::machines::Machines;
use super::pipes::Pipes;
use super::plan::{Plan, Room};
use super::walkway::Ways;

/// A quarter turn about y: x to -z, z to x.
pub(super) const QUARTER: Mat3 = Mat3::from_cols(Vec3::NEG_Z, Vec3::Y, Vec3::X);
/// Half a turn about y.
pub(super) const HALF: Mat3 = Mat3::from_cols(Vec3::NEG_X, Vec3::Y, Vec3::NEG_Z);
/// Three quarter turns about y: x to z, z to -x.
pub(super) const THREE_QUARTERS: Mat3 = Mat3::from_cols(Vec3::Z, Vec3::Y, Vec3::NEG_X);

/// The turn of what is built along x.
pub(super) fn along(along_x: bool) -> Mat3 {
    if along_x { Mat3::IDENTITY } else { THREE_QUARTERS }
}

/// A turn after a stretch along the shape's own x.
pub(super) fn stretched(turn: Mat3, x: f64) -> Mat3 {
    turn * Mat3::from_diagonal(Vec3::new(x as f32, 1.0, 1.0))
}

/// Cuts a length into parts of about `part` metres: how many, and how long each is.
pub(super) fn parts(length: f64, part: f64) -> (usize, f64) {
    let count = (length / part).round().max(1.0);
    (count as usize, length / count)
}

/// All that is placed many times.
pub(super) struct Shapes {
    pub steel: Steel,
    pub ways: Ways,
    pub pipes: Pipes,
    pub machines: Machines,
    pub boiler: Boiler,
}

impl Shapes {
    pub fn new(stock: &mut Stock) -> Shapes {
        Shapes {
            steel: Steel::new(stock),
            ways: Ways::new(stock),
            pipes: Pipes::new(stock),
            machines: Machines::new(stock),
            boiler: Boiler::new(stock),
        }
    }
}

/// A unit in the making.
pub(super) struct Site<'a> {
    pub stock: &'a mut Stock,
    pub plan: &'a Plan,
    pub shapes: &'a Shapes,
    pub random: Random,
    /// The middle of the unit's ground floor, in the world.
    origin: DVec3,
    label: String,
    count: usize,
    /// Pieces placed since [`Site::begin`], or none if each stands for itself.
    group: Option<usize>,
}

impl<'a> Site<'a> {
    pub fn new(stock: &'a mut Stock, plan: &'a Plan, shapes: &'a Shapes, unit: usize, origin: DVec3) -> Site<'a> {
        let random = Random::keyed(plan.seed, 0x91a7_0000 + unit as u64);
        let label = format!("unit_{}", unit + 1);
        Site { stock, plan, shapes, random, origin, label, count: 0, group: None }
    }

    /// Places a shared shape, turned first; `at` is in the unit's space.
    pub fn put(&mut self, rank: Rank, kind: &str, mesh: u32, at: DVec3, turn: Mat3, color: [u8; 3]) {
        let name = format!("{}/{kind}_{}", self.label, self.count);
        self.count += 1;
        let joins = self.group.is_some_and(|placed| placed > 0);
        if joins {
            self.stock.attach(name, mesh, turn, self.origin + at, color);
        } else {
            self.stock.place_turned(rank, name, mesh, turn, self.origin + at, color);
        }
        self.group = self.group.map(|placed| placed + 1);
    }

    /// Until [`Site::end`], what is put is taken or left as one, by the rank of the first: a run of pipes has no gaps.
    pub fn begin(&mut self) {
        self.group = Some(0);
    }

    pub fn end(&mut self) {
        self.group = None;
    }

    /// Places a shape that is used once.
    pub fn build(&mut self, rank: Rank, kind: &str, solid: Solid, at: DVec3, color: [u8; 3]) {
        let mesh = self.stock.shape(solid);
        self.put(rank, kind, mesh, at, Mat3::IDENTITY, color);
    }

    /// A colour a little darker than another, now and then.
    pub fn worn(&mut self, color: [u8; 3]) -> [u8; 3] {
        let shade = self.random.below(22) as u8;
        color.map(|c| c.saturating_sub(shade))
    }

    /// True when nobody walks there and no duct, bunker or boiler is in the way.
    pub fn is_free(&self, room: &Room) -> bool {
        !self.plan.meets_solid(room) && !self.plan.meets_aisle(room)
    }
}
