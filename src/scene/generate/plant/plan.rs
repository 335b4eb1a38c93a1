//! The plan of the plant: bays and storeys of the boiler house, the boiler's shaft, aisles, and what each bay is for.
//!
//! A unit is a boiler house with all that belongs to it; units stand side by side along z. Coordinates are metres about the
//! middle of a unit's ground floor: x from the turbine hall (negative) to the stack (positive), y up. Within a bay, the strips
//! along the column lines are for aisles and hung pipes, and the middle is for equipment, risers and stairs.

use glam::{DVec2, DVec3};

use super::super::super::random::mix;

/// Metres between column lines, and from floor to floor.
pub(super) const BAY: f64 = 8.0;
pub(super) const STOREY: f64 = 5.0;
/// Width of an aisle, and how far its middle is from the column line beside it.
pub(super) const AISLE: f64 = 1.8;
pub(super) const BESIDE: f64 = 1.5;
/// Metres below the walk's floor that its bridges take.
pub(super) const BRIDGE: f64 = 2.1;
/// Metres that must be free above an aisle's floor.
const HEADROOM: f64 = 2.45;

/// Bays along x and z, and storeys, from the smallest plant to the one that UNC's was.
const SIZES: [[usize; 3]; 12] = [
    [3, 3, 3],
    [3, 3, 4],
    [4, 3, 5],
    [4, 4, 5],
    [5, 4, 6],
    [5, 5, 7],
    [6, 5, 8],
    [6, 6, 9],
    [7, 6, 10],
    [7, 7, 12],
    [8, 7, 13],
    [8, 8, 15],
];

/// A box in a unit's space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Room {
    pub min: DVec3,
    pub max: DVec3,
}

impl Room {
    pub fn new(min: [f64; 3], max: [f64; 3]) -> Room {
        Room { min: min.into(), max: max.into() }
    }

    pub fn meets(&self, other: &Room) -> bool {
        self.min.cmplt(other.max).all() && other.min.cmplt(self.max).all()
    }
}

/// What a column of bays is for, over all storeys.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Use {
    /// The boiler hangs here.
    Boiler,
    /// Floors, with equipment on them.
    Floors,
    /// Open from bottom to top, for risers.
    Shaft,
    /// Stairs between walls.
    Stairs,
}

/// What a bay's floor is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Deck {
    Plate,
    Grating,
    Open,
}

/// A straight aisle on every floor: its middle line and the axis along it (true for x).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Aisle {
    pub from: DVec2,
    pub to: DVec2,
    pub along_x: bool,
}

impl Aisle {
    fn along_x(z: f64, x0: f64, x1: f64) -> Aisle {
        Aisle { from: DVec2::new(x0, z), to: DVec2::new(x1, z), along_x: true }
    }

    fn along_z(x: f64, z0: f64, z1: f64) -> Aisle {
        Aisle { from: DVec2::new(x, z0), to: DVec2::new(x, z1), along_x: false }
    }

    /// The ground that the aisle covers, as (x, z) corners.
    pub fn ground(&self) -> (DVec2, DVec2) {
        let half = if self.along_x { DVec2::new(0.0, AISLE * 0.5) } else { DVec2::new(AISLE * 0.5, 0.0) };
        (self.from - half, self.to + half)
    }
}

/// One unit's plan, and how many there are.
#[derive(Debug, Clone)]
pub(super) struct Plan {
    pub seed: u64,
    pub bays_x: usize,
    pub bays_z: usize,
    pub floors: usize,
    pub units: usize,
    /// Bays before the boiler and behind it (along x), and on either side.
    pub front: usize,
    pub rear: usize,
    pub side: usize,
    /// The floor that the walk is on.
    pub walk_floor: usize,
    pub aisles: Vec<Aisle>,
    /// The flue and the bunkers: nothing else may be there.
    pub solids: Vec<Room>,
}

impl Plan {
    /// The `step`-th plan, each larger than the one before: after the full size come more units.
    pub fn new(seed: u64, step: usize) -> Plan {
        let [bays_x, bays_z, floors] = SIZES[step.min(SIZES.len() - 1)];
        let front = [1, 2, 3][usize::from(bays_x > 5) + usize::from(bays_x > 7)];
        let rear = if bays_x > 6 { 2 } else { 1 };
        let side = if bays_z > 5 { 2 } else { 1 };
        let mut plan = Plan {
            seed,
            bays_x,
            bays_z,
            floors,
            units: 1 + step.saturating_sub(SIZES.len() - 1),
            front,
            rear,
            side,
            walk_floor: (floors * 3).div_ceil(5),
            aisles: Vec::new(),
            solids: Vec::new(),
        };
        plan.aisles = plan.lay_aisles();
        plan.solids = vec![plan.flue(), plan.bunkers()];
        plan
    }

    /// The column line number `i` along x, 0 at the front.
    pub fn line_x(&self, i: usize) -> f64 {
        (i as f64 - self.bays_x as f64 * 0.5) * BAY
    }

    /// The column line number `i` along z.
    pub fn line_z(&self, i: usize) -> f64 {
        (i as f64 - self.bays_z as f64 * 0.5) * BAY
    }

    /// Height of a floor.
    pub fn level(&self, floor: usize) -> f64 {
        floor as f64 * STOREY
    }

    /// Top of the house's steel.
    pub fn top(&self) -> f64 {
        self.level(self.floors)
    }

    /// The boiler's shaft, column line to column line, from the first floor up.
    pub fn shaft(&self) -> Room {
        let (x0, x1) = (self.line_x(self.front), self.line_x(self.bays_x - self.rear));
        let (z0, z1) = (self.line_z(self.side), self.line_z(self.bays_z - self.side));
        Room::new([x0, 0.0, z0], [x1, self.top(), z1])
    }

    /// The flue duct, out of the boiler's rear at the height of the second and third floors, below the walk's.
    pub fn flue(&self) -> Room {
        let shaft = self.shaft();
        let half = (shaft.max.z - shaft.min.z) * 0.3;
        let high = if self.floors > 6 { 2.0 } else { 1.0 };
        let below = self.level(self.walk_floor) - BRIDGE;
        let (y0, y1) = (STOREY * high + 0.7, (STOREY * (high + 1.0) + 3.6).min(below));
        Room::new([shaft.max.x - 1.0, y0, -half], [self.line_x(self.bays_x) + 4.0, y1, half])
    }

    /// The coal bunkers in the first bays, above the walk's floor; small plants have none.
    pub fn bunkers(&self) -> Room {
        let (x, z) = (self.line_x(0), self.line_z(0));
        let low = self.level(self.walk_floor + 1);
        let high = if self.front > 1 { self.level(self.floors - 1) } else { low };
        Room::new([x + 0.4, low + 0.2, z + 0.4], [x + BAY - 0.4, high - 1.0, -z - 0.4])
    }

    fn lay_aisles(&self) -> Vec<Aisle> {
        let shaft = self.shaft();
        let (x0, x1) = (self.line_x(0) + BESIDE, self.line_x(self.bays_x) - BESIDE);
        let (z0, z1) = (self.line_z(0) + BESIDE, self.line_z(self.bays_z) - BESIDE);
        let (bx0, bx1) = (shaft.min.x - BESIDE, shaft.max.x + BESIDE);
        let (bz0, bz1) = (shaft.min.z - BESIDE, shaft.max.z + BESIDE);
        let half = AISLE * 0.5;
        let middle = self.line_z(self.bays_z / 2) + BESIDE;
        let mut aisles = vec![
            // Before the boiler from wall to wall, and around it.
            Aisle::along_z(bx0, z0 - BESIDE, z1 + BESIDE),
            Aisle::along_x(bz1, bx0 + half, bx1 - half),
            Aisle::along_x(bz0, bx0 + half, bx1 - half),
            Aisle::along_z(bx1, bz0 - half, bz1 + half),
            // From the boiler's rear out through the wall.
            Aisle::along_x(middle, bx1 + half, x1 + BESIDE),
        ];
        if self.bays_x > 4 {
            aisles.push(Aisle::along_z(x1 - 0.1, z0 - half, middle - half));
            aisles.push(Aisle::along_z(x1 - 0.1, middle + half, z1 + half));
            aisles.push(Aisle::along_x(z0, bx0 + half, x1 - 0.1 - half));
            aisles.push(Aisle::along_x(z1, bx0 + half, x1 - 0.1 - half));
        }
        if self.front > 1 {
            aisles.push(Aisle::along_z(x0, z0 - half, z1 + half));
            for z in [z0, middle, z1] {
                aisles.push(Aisle::along_x(z, x0 + half, bx0 - half));
            }
        }
        if self.side > 1 {
            let across = self.line_x(self.front + 1) + BESIDE;
            aisles.push(Aisle::along_z(across, z0 + half, bz0 - half));
            aisles.push(Aisle::along_z(across, bz1 + half, z1 - half));
        }
        aisles
    }

    /// What a bay is for, on all floors. Corner bays have the stairs.
    pub fn use_of(&self, i: usize, j: usize) -> Use {
        let within = |k: usize, low: usize, high: usize| (low..high).contains(&k);
        let boiler = within(i, self.front, self.bays_x - self.rear) && within(j, self.side, self.bays_z - self.side);
        if boiler {
            return Use::Boiler;
        }
        if (i, j) == (self.bays_x - 1, 0) || (self.bays_z > 4 && (i, j) == (0, self.bays_z - 1)) {
            return Use::Stairs;
        }
        let draw = mix(self.seed ^ mix((i * 64 + j) as u64 ^ 0xba7)) % 100;
        if draw < 26 { Use::Shaft } else { Use::Floors }
    }

    /// True for a bay with the boiler beside it or at its corner.
    fn borders_shaft(&self, i: usize, j: usize) -> bool {
        let x = self.front..=self.bays_x - self.rear + 1;
        let z = self.side..=self.bays_z - self.side + 1;
        x.contains(&(i + 1)) && z.contains(&(j + 1))
    }

    /// True for every fourth floor, a main floor with slabs throughout; the walk is midway between two.
    pub fn is_main(&self, floor: usize) -> bool {
        floor % 4 == (self.walk_floor + 2) % 4
    }

    /// Whether machines stand on gratings too, which then must be there: small plants have no triangles for it.
    pub fn has_firm_gratings(&self) -> bool {
        self.bays_x > 4
    }

    /// The deck of a bay on a floor.
    pub fn deck(&self, i: usize, j: usize, floor: usize) -> Deck {
        match self.use_of(i, j) {
            Use::Boiler | Use::Shaft => Deck::Open,
            Use::Stairs => Deck::Open,
            Use::Floors if self.is_main(floor) => Deck::Plate,
            Use::Floors => {
                // Around the boiler there is more to look through than at the walls.
                let (plates, gratings) = if self.borders_shaft(i, j) { (24, 60) } else { (46, 70) };
                match mix(self.seed ^ mix((floor * 4096 + i * 64 + j) as u64)) % 100 {
                    draw if draw < plates => Deck::Plate,
                    draw if draw < gratings => Deck::Grating,
                    _ => Deck::Open,
                }
            }
        }
    }

    /// True when a box meets a duct or a bunker.
    pub fn meets_solid(&self, room: &Room) -> bool {
        self.solids.iter().any(|s| s.meets(room))
    }

    /// True when a box hinders somebody who walks on an aisle of any floor.
    pub fn meets_aisle(&self, room: &Room) -> bool {
        let low = (room.min.y - HEADROOM) / STOREY;
        let first = (low.floor() + 1.0).max(1.0);
        let within = first * STOREY < room.max.y;
        within
            && self.aisles.iter().any(|aisle| {
                let (min, max) = aisle.ground();
                min.x < room.max.x && room.min.x < max.x && min.y < room.max.z && room.min.z < max.y
            })
    }
}
