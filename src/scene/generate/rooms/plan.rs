//! The plan: open space as boxes in whole eighths of a metre, and the openings where they touch.
//!
//! A storey has a strip of rooms and the stairwell in the west, a cross corridor beside it, and wings to the east: a corridor each, with
//! a row of rooms on both sides. Walls between rooms stand upon each other, and doors keep clear of windows, so that planes of one
//! wall cut few others.

use glam::DVec3;

use super::super::super::random::Random;
use super::super::super::{Cell, Cells, Portal};

/// Units of the plan in a metre.
pub(super) const UNIT: f64 = 8.0;
/// Thickness of walls and slabs; height of a storey, and of its open space.
const WALL: i32 = 2;
pub(super) const STOREY: i32 = 24;
const CLEAR: i32 = 22;
/// Height of doors and of the tops of windows, and of window sills above the floor.
const HEAD: i32 = 17;
const SILL: i32 = 7;
/// Widths of doors and windows.
const DOOR: i32 = 8;
const WINDOW: i32 = 10;
/// Where rooms of the west strip, the cross corridor and the wings begin and end, in x.
pub(super) const STRIP: [i32; 2] = [WALL, 34];
pub(super) const CROSS: [i32; 2] = [36, 56];
const WINGS: i32 = 58;
/// Depths of a room and a corridor of a wing, and of both rows with their walls.
const DEPTH: i32 = 40;
const PASSAGE: i32 = 18;
const PITCH: i32 = 2 * DEPTH + PASSAGE + 3 * WALL;
/// The stairwell's length, and where in it a flight begins and ends, in z.
const STAIRWELL: i32 = 56;
pub(super) const FLIGHT: [i32; 2] = [12, 48];
/// How far a slab's opening reaches along the flight, from its upper end.
const OPENING: i32 = 28;
/// The two halves of the stairwell, in x.
pub(super) const HALVES: [[i32; 2]; 2] = [[4, 16], [20, 32]];
/// Open space around the building.
const AROUND: i32 = 512;

/// A corner, in units.
pub(super) type Point = [i32; 3];

/// What a box of open space is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Room,
    Corridor,
    Stairwell,
    Doorway,
    Window,
    /// Between two storeys of the stairwell.
    Slab,
    Outside,
}

/// A box of open space.
#[derive(Debug, Clone)]
pub(super) struct Space {
    pub name: String,
    pub kind: Kind,
    pub storey: usize,
    pub min: Point,
    pub max: Point,
    /// Faces behind which there is nothing, so that they have no surface: bit `2 axis + side`.
    pub open: u8,
}

/// Where two boxes touch and are open to each other: a rectangle without size along `axis`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Opening {
    /// The box on the lesser side first.
    pub spaces: [usize; 2],
    pub axis: usize,
    pub min: Point,
    pub max: Point,
}

/// A building.
pub(super) struct Plan {
    pub spaces: Vec<Space>,
    pub openings: Vec<Opening>,
    /// Openings of each space, by number.
    pub links: Vec<Vec<usize>>,
    pub storeys: usize,
    pub wings: usize,
    /// The corner of the outer walls; the other is 0.
    pub outer: Point,
}

/// A point of the plan in the world.
pub(super) fn metres(p: Point) -> DVec3 {
    DVec3::from_array(p.map(|c| f64::from(c) / UNIT))
}

/// The height of a storey's floor.
pub(super) fn floor(storey: usize) -> i32 {
    WALL + STOREY * storey as i32
}

/// The z of the middle of a wing's corridor.
pub(super) fn passage(wing: usize) -> i32 {
    WALL + PITCH * wing as i32 + DEPTH + WALL + PASSAGE / 2
}

impl Plan {
    /// The plan of some size: step 0 is the least.
    pub fn new(seed: u64, step: usize) -> Plan {
        let storeys = (1 + (step + 1) / 3).min(12);
        let wings = 1 + step / 3;
        let length = 100 + 80 * step.div_ceil(3) as i32;
        let outer = [WINGS + length + WALL, STOREY * storeys as i32 + WALL, WALL + PITCH * wings as i32];
        let (spaces, openings, links) = (Vec::new(), Vec::new(), Vec::new());
        let mut plan = Plan { spaces, openings, links, storeys, wings, outer };
        let outside = plan.outside();
        let mut below = None;
        for storey in 0..storeys {
            let cross = plan.cross_corridor(storey, outside);
            let well = plan.stairwell(storey, cross, below);
            plan.strip(seed, storey, cross, outside);
            (0..wings).for_each(|wing| plan.wing(seed, [storey, wing], cross, outside));
            below = Some(well);
        }
        plan
    }

    /// The cells and portals of the building.
    pub fn cells(&self) -> Cells {
        let cell = |s: &Space| Cell { name: s.name.clone(), min: metres(s.min), max: metres(s.max) };
        let portal = |o: &Opening| Portal { cells: o.spaces.map(|s| s as u32), min: metres(o.min), max: metres(o.max) };
        Cells::from_checked(self.spaces.iter().map(cell).collect(), self.openings.iter().map(portal).collect())
    }

    /// A corner where nobody walks.
    pub fn niche(&self) -> Point {
        [CROSS[1] - 3, floor(0), self.outer[2] - 2 * WALL - 3]
    }

    fn add(&mut self, name: String, kind: Kind, storey: usize, min: Point, max: Point) -> usize {
        self.spaces.push(Space { name, kind, storey, min, max, open: 0 });
        self.links.push(Vec::new());
        self.spaces.len() - 1
    }

    /// Opens two boxes to each other, the lesser first.
    fn open(&mut self, spaces: [usize; 2], axis: usize, min: Point, max: Point) {
        spaces.iter().for_each(|&s| self.links[s].push(self.openings.len()));
        self.openings.push(Opening { spaces, axis, min, max });
    }

    /// An opening through the wall or slab between two boxes, the lesser first: its ranges along the other axes are those of
    /// `min` and `max`.
    fn pierce(&mut self, name: String, kind: Kind, sides: [usize; 2], axis: usize, mut min: Point, mut max: Point) {
        let storey = self.spaces[sides[0]].storey.max(self.spaces[sides[1]].storey);
        (min[axis], max[axis]) = (self.spaces[sides[0]].max[axis], self.spaces[sides[1]].min[axis]);
        let through = self.add(name, kind, storey, min, max);
        let flat = |mut p: Point, at: i32| {
            p[axis] = at;
            p
        };
        self.open([sides[0], through], axis, flat(min, min[axis]), flat(max, min[axis]));
        self.open([through, sides[1]], axis, flat(min, max[axis]), flat(max, max[axis]));
    }

    /// A door from `u` on, along the horizontal axis that is not `axis`.
    fn door(&mut self, name: String, sides: [usize; 2], axis: usize, u: i32, width: i32) {
        let y = floor(self.spaces[sides[0]].storey.max(self.spaces[sides[1]].storey));
        self.pierce(name, Kind::Doorway, sides, axis, [u, y, u], [u + width, y + HEAD, u + width]);
    }

    /// A window of a storey, likewise.
    fn window(&mut self, storey: usize, sides: [usize; 2], axis: usize, u: i32) {
        let (y, inside) = (floor(storey), if self.spaces[sides[0]].kind == Kind::Outside { 1 } else { 0 });
        let name = format!("{}/window_{axis}", self.spaces[sides[inside]].name);
        self.pierce(name, Kind::Window, sides, axis, [u, y + SILL, u], [u + WINDOW, y + HEAD, u + WINDOW]);
    }

    /// Five boxes around the building: west, east, north, south, above.
    fn outside(&mut self) -> [usize; 4] {
        let [x, y, z] = self.outer;
        let (far, top) = (AROUND, y + AROUND);
        let mut add = |name: &str, open: u8, min: Point, max: Point| {
            let space = self.add(format!("outside/{name}"), Kind::Outside, 0, min, max);
            self.spaces[space].open = open;
            space
        };
        let west = add("west", 0b11_10_01, [-far, 0, -far], [0, top, z + far]);
        let east = add("east", 0b11_10_10, [x, 0, -far], [x + far, top, z + far]);
        let north = add("north", 0b01_10_00, [0, 0, -far], [x, top, 0]);
        let south = add("south", 0b10_10_00, [0, 0, z], [x, top, z + far]);
        let above = add("above", 0b00_10_00, [0, y, 0], [x, top, z]);
        for (sides, at) in [([west, north], 0), ([north, east], x)] {
            self.open(sides, 0, [at, 0, -far], [at, top, 0]);
        }
        for (sides, at) in [([west, south], 0), ([south, east], x)] {
            self.open(sides, 0, [at, 0, z], [at, top, z + far]);
        }
        for (sides, at) in [([west, above], 0), ([above, east], x)] {
            self.open(sides, 0, [at, y, 0], [at, top, z]);
        }
        for (sides, at) in [([north, above], 0), ([above, south], z)] {
            self.open(sides, 2, [0, y, at], [x, top, at]);
        }
        [west, east, north, south]
    }

    fn cross_corridor(&mut self, storey: usize, [_, _, north, south]: [usize; 4]) -> usize {
        let (y, end) = (floor(storey), self.outer[2] - WALL);
        let name = format!("{storey}/cross");
        let cross = self.add(name, Kind::Corridor, storey, [CROSS[0], y, WALL], [CROSS[1], y + CLEAR, end]);
        if storey == 0 {
            self.door("0/entrance".into(), [north, cross], 2, CROSS[0] + 6, DOOR);
        } else {
            self.window(storey, [north, cross], 2, CROSS[0] + 6);
        }
        self.window(storey, [cross, south], 2, CROSS[0] + 6);
        cross
    }

    /// The stairwell of a storey, open to that of the storey below where its flight comes up.
    fn stairwell(&mut self, storey: usize, cross: usize, below: Option<usize>) -> usize {
        let (y, end) = (floor(storey), WALL + STAIRWELL);
        let name = format!("{storey}/stairwell");
        let well = self.add(name, Kind::Stairwell, storey, [STRIP[0], y, WALL], [STRIP[1], y + CLEAR, end]);
        self.door(format!("{storey}/stairwell/door_0"), [well, cross], 0, WALL + 1, DOOR);
        self.door(format!("{storey}/stairwell/door_1"), [well, cross], 0, end - 1 - DOOR, DOOR);
        if let Some(below) = below {
            let [x0, x1] = HALVES[(storey - 1) % 2];
            let z = if storey % 2 == 1 { [FLIGHT[1] - OPENING, FLIGHT[1]] } else { [FLIGHT[0], FLIGHT[0] + OPENING] };
            let name = format!("{storey}/stairwell/slab");
            self.pierce(name, Kind::Slab, [below, well], 1, [x0, 0, z[0]], [x1, 0, z[1]]);
        }
        well
    }

    /// The rooms of the west strip.
    fn strip(&mut self, seed: u64, storey: usize, cross: usize, [west, ..]: [usize; 4]) {
        let y = floor(storey);
        let ranges = cuts(&mut Random::keyed(seed, 1), WALL + STAIRWELL + WALL, self.outer[2] - WALL);
        let mut random = Random::keyed(seed, 0x1000 + storey as u64);
        for (k, [z0, z1]) in ranges.into_iter().enumerate() {
            let name = format!("{storey}/west/{k}");
            let room = self.add(name.clone(), Kind::Room, storey, [STRIP[0], y, z0], [STRIP[1], y + CLEAR, z1]);
            self.door(format!("{name}/door"), [room, cross], 0, z0 + 2, DOOR);
            if random.chance(0.7) {
                self.window(storey, [west, room], 0, z1 - 4 - WINDOW);
            }
        }
    }

    /// A wing of a storey: its corridor, and a row of rooms on both sides.
    fn wing(&mut self, seed: u64, [storey, wing]: [usize; 2], cross: usize, outside: [usize; 4]) {
        let [_, east, north, south] = outside;
        let (y, middle, x1) = (floor(storey), passage(wing), self.outer[0] - WALL);
        let (z0, z1) = (middle - PASSAGE / 2, middle + PASSAGE / 2);
        let name = format!("{storey}/wing_{wing}");
        let corridor =
            self.add(format!("{name}/corridor"), Kind::Corridor, storey, [WINGS, y, z0], [x1, y + CLEAR, z1]);
        self.door(format!("{name}/gate"), [cross, corridor], 0, z0 + 2, PASSAGE - 4);
        self.window(storey, [corridor, east], 0, z0 + 4);
        for row in 0..2 {
            let z = if row == 0 { [z0 - WALL - DEPTH, z0 - WALL] } else { [z1 + WALL, z1 + WALL + DEPTH] };
            let facade = match row {
                0 if wing == 0 => Some(north),
                1 if wing + 1 == self.wings => Some(south),
                _ => None,
            };
            let key = (2 * wing + row) as u64;
            let label = format!("{name}/{}", ["north", "south"][row]);
            let row = Row { storey, row, label, z, corridor, facade, east };
            self.row(&row, &mut Random::keyed(seed, 0x2000 + key), seed ^ key << 20);
        }
    }

    /// A row of rooms; `shared` decides what all storeys have in common.
    fn row(&mut self, row: &Row, shared: &mut Random, seed: u64) {
        let (y, end) = (floor(row.storey), self.outer[0] - WALL);
        let mut random = Random::keyed(seed, 0x3000 + row.storey as u64);
        let mut last: Option<usize> = None;
        for (k, [x0, x1]) in cuts(shared, WINGS, end).into_iter().enumerate() {
            let name = format!("{}/{k}", row.label);
            let room = self.add(name.clone(), Kind::Room, row.storey, [x0, y, row.z[0]], [x1, y + CLEAR, row.z[1]]);
            let turned = shared.chance(0.5);
            let (door, window) = if turned { (x1 - 2 - DOOR, x0 + 4) } else { (x0 + 2, x1 - 4 - WINDOW) };
            let ordered = |other: usize, after: bool| if after { [room, other] } else { [other, room] };
            self.door(format!("{name}/door"), ordered(row.corridor, row.row == 0), 2, door, DOOR);
            if let Some(outside) = row.facade.filter(|_| random.chance(0.75)) {
                self.window(row.storey, ordered(outside, row.row == 1), 2, window);
            }
            if let Some(last) = last.filter(|_| random.chance(0.35)) {
                self.door(format!("{name}/through"), [last, room], 0, row.z[0] + 16, DOOR);
            }
            if x1 == end {
                self.window(row.storey, [room, row.east], 0, row.z[0] + 26);
            }
            last = Some(room);
        }
    }
}

/// What the rooms of a row have in common.
struct Row {
    storey: usize,
    /// 0 north of the corridor, 1 south.
    row: usize,
    label: String,
    z: [i32; 2],
    corridor: usize,
    /// What is outside its windows, if it has any.
    facade: Option<usize>,
    east: usize,
}

/// Cuts a length into rooms with walls between.
fn cuts(random: &mut Random, from: i32, to: i32) -> Vec<[i32; 2]> {
    let (mut out, mut at) = (Vec::new(), from);
    while at + 26 <= to {
        let width = random.between(26, 46) as i32;
        let end = if at + width + WALL + 26 > to { to } else { at + width };
        out.push([at, end]);
        at = end + WALL;
    }
    out
}
