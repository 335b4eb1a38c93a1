//! The boiler house's steel: columns, girders, joists, bracing, decks, walls and the top girders that the boiler hangs from.

use glam::{DVec3, Mat3, Vec3};

use super::super::solid::{Solid, upright_to};
use super::super::stock::{Rank, Stock};
use super::plan::{BAY, Deck, Plan, Room, STOREY, Use};
use super::site::{HALF, QUARTER, Site, THREE_QUARTERS, along};

const STEEL: [u8; 3] = [112, 132, 138];
const PLATE: [u8; 3] = [124, 122, 116];
const CONCRETE: [u8; 3] = [168, 164, 154];
const GALVANIZED: [u8; 3] = [146, 150, 150];
const CLADDING: [u8; 3] = [168, 186, 196];
/// Depth of a girder, and of the deck above it, in metres.
const GIRDER: f32 = 0.7;
const DECK: f32 = 0.1;

/// Shapes of the frame.
pub(super) struct Steel {
    column: u32,
    splice: u32,
    girder: u32,
    bolts: u32,
    joists: u32,
    brace: u32,
    plate: u32,
    slab: u32,
    grating: u32,
    wall: u32,
    cladding: u32,
}

impl Steel {
    pub fn new(stock: &mut Stock) -> Steel {
        Steel {
            column: stock.shape(column()),
            splice: stock.shape(splice()),
            girder: stock.shape(girder()),
            bolts: stock.shape(bolts()),
            joists: stock.shape(joists()),
            brace: stock.shape(brace()),
            plate: stock.shape(tiles(8, 0.03)),
            slab: stock.shape(tiles(3, 0.0)),
            grating: stock.shape(grating()),
            wall: stock.shape(wall()),
            cladding: stock.shape(cladding()),
        }
    }
}

/// An I section along x from `x0` to `x1`, its top at `y`.
fn section(solid: &mut Solid, x0: f32, x1: f32, y: f32, depth: f32, width: f32, thick: f32) {
    let half = width * 0.5;
    solid.cuboid(Vec3::new(x0, y - thick, -half), Vec3::new(x1, y, half));
    solid.cuboid(Vec3::new(x0, y - depth + thick, -thick * 0.5), Vec3::new(x1, y - thick, thick * 0.5));
    solid.cuboid(Vec3::new(x0, y - depth, -half), Vec3::new(x1, y - depth + thick, half));
}

/// A six-sided bolt head that points along z, from the plane `z` on.
fn bolt(solid: &mut Solid, at: Vec3, length: f32) {
    let mut head = Solid::default();
    head.column(6, glam::Vec2::ZERO, (0.0, 0.03), (length, 0.03));
    solid.join(&head, upright_to(Vec3::Z), at);
}

fn column() -> Solid {
    let mut solid = Solid::default();
    let top = STOREY as f32;
    for x in [-0.23, 0.19] {
        solid.cuboid(Vec3::new(x, 0.0, -0.25), Vec3::new(x + 0.04, top, 0.25));
    }
    solid.cuboid(Vec3::new(-0.19, 0.0, -0.02), Vec3::new(0.19, top, 0.02));
    solid.cuboid(Vec3::new(-0.19, 3.9, -0.24), Vec3::new(0.19, 3.93, 0.24));
    solid.cuboid(Vec3::new(-0.3, 0.0, -0.3), Vec3::new(0.3, 0.05, 0.3));
    solid
}

/// Plates and bolts over the joint of two columns.
fn splice() -> Solid {
    let mut solid = Solid::default();
    for z in [-1.0f32, 1.0] {
        let mut side = Solid::default();
        for x in [-0.24f32, 0.24] {
            let (a, b) = (x.min(x * 1.1), x.max(x * 1.1));
            side.cuboid(Vec3::new(a, 0.6, 0.02), Vec3::new(b, 1.2, 0.23));
        }
        for k in 0..8 {
            let (x, y) = (if k % 2 == 0 { -0.1 } else { 0.1 }, 0.66 + (k / 2) as f32 * 0.14);
            bolt(&mut side, Vec3::new(x, y, 0.02), 0.06);
        }
        let turn = if z > 0.0 { Mat3::IDENTITY } else { HALF };
        solid.join(&side, turn, Vec3::ZERO);
    }
    solid
}

/// A girder along x over a bay, from the column line on, with stiffeners; its top is at 0.
fn girder() -> Solid {
    let mut solid = Solid::default();
    section(&mut solid, 0.23, BAY as f32 - 0.23, -DECK, GIRDER, 0.32, 0.03);
    for k in 1..4 {
        let x = k as f32 * BAY as f32 * 0.25;
        for (a, b) in [(-0.15, -0.015), (0.015, 0.15)] {
            solid.cuboid(Vec3::new(x - 0.01, -DECK - GIRDER + 0.03, a), Vec3::new(x + 0.01, -DECK - 0.03, b));
        }
    }
    solid
}

/// The end plates of a girder with their bolts.
fn bolts() -> Solid {
    let mut solid = Solid::default();
    for x in [0.3f32, BAY as f32 - 0.54] {
        solid.cuboid(Vec3::new(x, -0.72, -0.05), Vec3::new(x + 0.24, -0.18, 0.05));
        for k in 0..8 {
            let (u, v) = (x + 0.07 + 0.1 * (k % 2) as f32, -0.66 + (k / 2) as f32 * 0.14);
            bolt(&mut solid, Vec3::new(u, v, 0.05), 0.05);
        }
    }
    solid
}

/// Three small beams along x under a bay's deck.
fn joists() -> Solid {
    let mut solid = Solid::default();
    for k in 1..4 {
        let mut joist = Solid::default();
        section(&mut joist, 0.1, BAY as f32 - 0.1, -DECK, 0.3, 0.16, 0.02);
        solid.join(&joist, Mat3::IDENTITY, Vec3::Z * (k as f32 * BAY as f32 * 0.25));
    }
    solid
}

/// Crossed diagonals between two columns along x, with a plate in the middle.
fn brace() -> Solid {
    let mut solid = Solid::default();
    let (run, rise) = (BAY - 0.6, STOREY - 1.0);
    let length = libm::sqrt(run * run + rise * rise);
    let (c, s) = ((run / length) as f32, (rise / length) as f32);
    for up in [1.0f32, -1.0] {
        let mut bar = Solid::default();
        let half = length as f32 * 0.5;
        bar.cuboid(Vec3::new(-half, -0.08, -0.09), Vec3::new(half, -0.06, 0.09));
        bar.cuboid(Vec3::new(-half, -0.06, -0.01), Vec3::new(half, 0.08, 0.01));
        let turn = Mat3::from_cols(Vec3::new(c, s * up, 0.0), Vec3::new(-s * up, c, 0.0), Vec3::Z);
        solid.join(&bar, turn, Vec3::new(BAY as f32 * 0.5, STOREY as f32 * 0.5 - 0.1, 0.02 * up));
    }
    let middle = Vec3::new(BAY as f32 * 0.5, STOREY as f32 * 0.5 - 0.1, 0.0);
    solid.cuboid(middle - Vec3::new(0.35, 0.35, 0.04), middle + Vec3::new(0.35, 0.35, 0.04));
    solid
}

/// A deck over a bay of n x n plates, in both axes from the column lines on.
fn tiles(n: usize, gap: f32) -> Solid {
    let mut solid = Solid::default();
    let side = BAY as f32 / n as f32;
    for k in 0..n * n {
        let min = Vec3::new((k % n) as f32 * side + gap * 0.5, -DECK, (k / n) as f32 * side + gap * 0.5);
        solid.cuboid(min, min + Vec3::new(side - gap, DECK, side - gap));
    }
    solid
}

/// A quarter of a bay's grating: bars along x every 7 cm.
fn grating() -> Solid {
    let mut solid = Solid::default();
    let side = BAY as f32 * 0.5;
    let bars = (side / 0.07) as usize;
    for k in 0..bars {
        let z = (k as f32 + 0.5) * side / bars as f32;
        solid.cuboid(Vec3::new(0.0, -0.05, z - 0.004), Vec3::new(side, 0.0, z + 0.004));
    }
    for k in 0..10 {
        let x = (k as f32 + 0.5) * side / 10.0;
        solid.cuboid(Vec3::new(x - 0.006, -0.02, 0.0), Vec3::new(x + 0.006, -0.004, side));
    }
    solid
}

/// A wall of blocks along x between two columns, with pilasters and a coping.
fn wall() -> Solid {
    let mut solid = Solid::default();
    let (end, top) = (BAY as f32, STOREY as f32 - GIRDER - DECK);
    solid.cuboid(Vec3::new(0.25, 0.0, -0.1), Vec3::new(end - 0.25, top, 0.1));
    for k in 0..4 {
        solid.block(end * (0.2 + 0.2 * k as f32), 0.0, 0.0, Vec3::new(0.3, top - 0.1, 0.3));
    }
    solid.cuboid(Vec3::new(0.25, 1.2, -0.12), Vec3::new(end - 0.25, 1.3, 0.12));
    solid
}

/// Corrugated sheet along x over a bay and a storey, outside the columns on the side of positive z.
fn cladding() -> Solid {
    let mut solid = Solid::default();
    let (end, top) = (BAY as f32, STOREY as f32);
    solid.cuboid(Vec3::new(0.0, -0.2, 0.3), Vec3::new(end, top - 0.2, 0.34));
    for k in 0..16 {
        let x = (k as f32 + 0.25) * end / 16.0;
        solid.cuboid(Vec3::new(x, -0.2, 0.34), Vec3::new(x + end / 32.0, top - 0.2, 0.39));
    }
    for y in [0.6, 2.4, 4.2] {
        solid.cuboid(Vec3::new(0.0, y, 0.2), Vec3::new(end, y + 0.12, 0.3));
    }
    solid
}

/// All steel of a unit.
pub(super) fn frame(site: &mut Site) {
    let plan = site.plan;
    for floor in 0..plan.floors {
        for j in 0..=plan.bays_z {
            for i in 0..=plan.bays_x {
                node(site, i, j, floor);
            }
        }
        for j in 0..plan.bays_z {
            for i in 0..plan.bays_x {
                decks(site, i, j, floor);
                walls(site, i, j, floor);
            }
        }
    }
    roof(site);
}

/// A boiler hangs between these lines: no column or girder there.
pub(super) fn in_shaft(plan: &Plan, i: usize, j: usize) -> bool {
    let low = plan.front < i && i < plan.bays_x - plan.rear;
    low && plan.side < j && j < plan.bays_z - plan.side
}

/// The column from a floor to the next, and the girders from its head along x and z.
fn node(site: &mut Site, i: usize, j: usize, floor: usize) {
    let plan = site.plan;
    let steel = &site.shapes.steel;
    if in_shaft(plan, i, j) {
        return;
    }
    let at = DVec3::new(plan.line_x(i), plan.level(floor), plan.line_z(j));
    let stands = Room::new([at.x - 0.2, at.y, at.z - 0.2], [at.x + 0.2, at.y + STOREY, at.z + 0.2]);
    if !plan.meets_solid(&stands) {
        site.put(Rank::Must, "column", steel.column, at, Mat3::IDENTITY, STEEL);
        site.put(Rank::Fill, "splice", steel.splice, at, Mat3::IDENTITY, STEEL);
    }
    let head = at + DVec3::Y * STOREY;
    for along_x in [true, false] {
        let (next_i, next_j) = if along_x { (i + 1, j) } else { (i, j + 1) };
        if next_i > plan.bays_x || next_j > plan.bays_z || in_shaft(plan, next_i, next_j) {
            continue;
        }
        // Lines that the shaft's inside parts are bridged nowhere.
        if crosses_shaft(plan, i, j, along_x) {
            continue;
        }
        let end = DVec3::new(plan.line_x(next_i), head.y, plan.line_z(next_j));
        let room = Room { min: head - DVec3::new(0.1, 0.8, 0.1), max: end + DVec3::new(0.1, 0.0, 0.1) };
        if plan.meets_solid(&room) {
            continue;
        }
        site.put(Rank::Must, "girder", steel.girder, head, along(along_x), STEEL);
        site.put(Rank::Fill, "bolts", steel.bolts, head, along(along_x), STEEL);
    }
}

/// True for a girder whose both ends are on the shaft's lines but which runs through the shaft.
fn crosses_shaft(plan: &Plan, i: usize, j: usize, along_x: bool) -> bool {
    let (x0, x1) = (plan.front, plan.bays_x - plan.rear);
    let (z0, z1) = (plan.side, plan.bays_z - plan.side);
    if along_x { (x0..x1).contains(&i) && z0 < j && j < z1 } else { (z0..z1).contains(&j) && x0 < i && i < x1 }
}

/// The deck of a bay, with what carries it. The ground floor is one slab.
fn decks(site: &mut Site, i: usize, j: usize, floor: usize) {
    let plan = site.plan;
    let steel = &site.shapes.steel;
    let at = DVec3::new(plan.line_x(i), plan.level(floor), plan.line_z(j));
    if floor == 0 {
        site.put(Rank::Must, "slab", steel.slab, at, Mat3::IDENTITY, CONCRETE);
        return;
    }
    let deck = plan.deck(i, j, floor);
    let room = Room { min: at - DVec3::Y * 0.4, max: at + DVec3::new(BAY, 0.0, BAY) };
    if deck == Deck::Open || plan.meets_solid(&room) {
        return;
    }
    // Joists run along z: a turn about y takes the bay's corner along.
    let corner = at + DVec3::new(0.0, 0.0, BAY);
    site.put(Rank::Must, "joists", steel.joists, corner, QUARTER, STEEL);
    if deck == Deck::Plate {
        let (mesh, color) = if plan.is_main(floor) { (steel.slab, CONCRETE) } else { (steel.plate, PLATE) };
        site.put(Rank::Must, "plate", mesh, at, Mat3::IDENTITY, color);
        return;
    }
    let color = site.worn(GALVANIZED);
    let rank = if plan.has_firm_gratings() { Rank::Must } else { Rank::Fill };
    site.begin();
    for k in 0..4 {
        let quarter = DVec3::new((k % 2) as f64, 0.0, (k / 2) as f64) * BAY * 0.5;
        site.put(rank, "grating", steel.grating, at + quarter, Mat3::IDENTITY, color);
    }
    site.end();
}

/// Bracing, cladding and block walls on the lines at a bay's low sides, and at the outer walls.
fn walls(site: &mut Site, i: usize, j: usize, floor: usize) {
    let plan = site.plan;
    let y = plan.level(floor);
    let (x, z) = (plan.line_x(i), plan.line_z(j));
    // (corner, along x, outward turn) of the four sides; inner lines belong to the bay beyond them.
    let mut sides = vec![(DVec3::new(x, y, z), true, j == 0), (DVec3::new(x, y, z), false, i == 0)];
    if j + 1 == plan.bays_z {
        sides.push((DVec3::new(x, y, z + BAY), true, true));
    }
    if i + 1 == plan.bays_x {
        sides.push((DVec3::new(x + BAY, y, z), false, true));
    }
    for (corner, along_x, outer) in sides {
        let (length, thick) = if along_x { (DVec3::X, DVec3::Z) } else { (DVec3::Z, DVec3::X) };
        let (low, high) = (DVec3::Y * 0.1 - thick * 0.2, length * BAY + thick * 0.2 + DVec3::Y * (STOREY - 0.8));
        let room = Room { min: corner + low, max: corner + high };
        let draw = site.random.below(100);
        if !site.is_free(&room) || plan.use_of(i, j) == Use::Boiler {
            continue;
        }
        let steel = &site.shapes.steel;
        if outer && draw < 30 {
            outside(site, corner, along_x);
        } else if outer && draw < 55 {
            site.put(Rank::Must, "brace", steel.brace, corner, along(along_x), STEEL);
        } else if !outer && draw < 13 && plan.deck(i, j, floor) == Deck::Plate && crossing_free(plan, i, j, along_x) {
            let color = site.worn(CONCRETE);
            let wall = site.shapes.steel.wall;
            site.put(Rank::Must, "wall", wall, corner, along(along_x), color);
        }
    }
}

/// Inner walls do not stand in the boiler's shaft.
fn crossing_free(plan: &Plan, i: usize, j: usize, along_x: bool) -> bool {
    let beyond = if along_x { (i, j.wrapping_sub(1)) } else { (i.wrapping_sub(1), j) };
    plan.use_of(beyond.0, beyond.1) != Use::Boiler
}

/// Sheet on the outside of the outer wall that begins at `corner`.
fn outside(site: &mut Site, corner: DVec3, along_x: bool) {
    // The sheet is on the side of positive z; turned by half it runs backwards from the other end.
    let positive = if along_x { corner.z > 0.0 } else { corner.x > 0.0 };
    let (at, turn) = match (along_x, positive) {
        (true, true) => (corner, Mat3::IDENTITY),
        (true, false) => (corner + DVec3::X * BAY, HALF),
        (false, true) => (corner + DVec3::Z * BAY, QUARTER),
        (false, false) => (corner, THREE_QUARTERS),
    };
    let (mesh, color) = (site.shapes.steel.cladding, site.worn(CLADDING));
    site.put(Rank::Must, "cladding", mesh, at, turn, color);
}

/// Deep girders over the shaft, which the boiler hangs from, and a roof over the outer bays.
fn roof(site: &mut Site) {
    let plan = site.plan;
    let shaft = plan.shaft();
    let length = (shaft.max.z - shaft.min.z) as f32;
    for i in plan.front..=plan.bays_x - plan.rear {
        let mut solid = Solid::default();
        section(&mut solid, 0.0, length, 0.0, 2.6, 0.9, 0.08);
        for k in 0..(length / 2.0) as usize {
            let x = (k as f32 + 0.5) * 2.0;
            solid.cuboid(Vec3::new(x - 0.02, -2.5, -0.4), Vec3::new(x + 0.02, -0.1, 0.4));
        }
        let mut turned = Solid::default();
        turned.join(&solid, THREE_QUARTERS, Vec3::ZERO);
        let at = DVec3::new(plan.line_x(i), plan.top() + 2.6, shaft.min.z);
        site.build(Rank::Must, "top_girder", turned, at, STEEL);
    }
    for j in 0..plan.bays_z {
        for i in 0..plan.bays_x {
            let at = DVec3::new(plan.line_x(i), plan.top() + 0.1, plan.line_z(j));
            if plan.use_of(i, j) != Use::Boiler {
                let slab = site.shapes.steel.slab;
                site.put(Rank::Must, "roof", slab, at, Mat3::IDENTITY, CLADDING);
            }
        }
    }
}
