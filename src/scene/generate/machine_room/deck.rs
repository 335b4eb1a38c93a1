//! What is walked on: gratings in the aisles, plates under machines, catwalks and bridges with their rails, the stair.

use glam::{Mat3, Vec2, Vec3};

use super::super::piping::{beam, grating, ladder, rail, rod, stairs};
use super::super::solid::Solid;
use super::super::stock::Rank;
use super::parts::{Room, paint};
use super::plan::{AISLE, BAY, END, FRAME, OPENING, SIDE, STAIR, UPPER, half_width};

/// Metres between the bearing bars of a grating.
const PITCH: f32 = 0.055;

/// Shapes laid again and again.
struct Panels {
    /// FRAME long, half the middle aisle wide.
    middle: u32,
    /// FRAME long, a side aisle wide.
    side: u32,
    /// A bay of the plates under machines, and along the hull below and above.
    plates: [u32; 3],
    /// Plates of the same sizes as the gratings.
    cover: [u32; 2],
    beam: u32,
    joist: u32,
}

pub(super) fn decks(room: &mut Room) {
    let panels = Panels::new(room);
    let length = room.plan.length();
    let frames = (length / FRAME).round() as usize;
    for frame in 1..frames {
        let at = Vec3::new(frame as f32 * FRAME, 0.0, 0.0);
        room.put(Rank::Must, "deck/beam", panels.beam, (Mat3::IDENTITY, at), paint::BEAM);
    }
    for bay in 0..room.plan.bays {
        lay_bay(room, &panels, bay);
    }
    ends(room);
    catwalks(room);
    for side in [1.0, -1.0] {
        bridge_rails(room, side);
    }
    ways_up(room);
}

impl Panels {
    fn new(room: &mut Room) -> Panels {
        let plate = |z0: f32, z1: f32| {
            let mut solid = Solid::default();
            solid.cuboid(Vec3::new(0.0, -0.02, z0), Vec3::new(BAY - 0.01, 0.0, z1));
            // Raised coaming along the aisle.
            solid.cuboid(Vec3::new(0.0, 0.0, z0), Vec3::new(BAY - 0.01, 0.04, z0 + 0.02));
            solid.cuboid(Vec3::new(0.0, 0.0, z1 - 0.02), Vec3::new(BAY - 0.01, 0.04, z1));
            solid
        };
        let reach = half_width(-0.15);
        let mut ibeam = Solid::default();
        for (y0, y1, half) in [(-0.08, -0.06, 0.05), (-0.3, -0.08, 0.006), (-0.32, -0.3, 0.05)] {
            ibeam.cuboid(Vec3::new(-half, y0, -reach), Vec3::new(half, y1, reach));
        }
        let mut joist = Solid::default();
        joist.cuboid(Vec3::new(0.0, -0.06, -0.02), Vec3::new(BAY, -0.036, 0.02));
        let chequer = |wide: f32| {
            let mut solid = Solid::default();
            solid.block(0.0, -0.02, 0.0, Vec3::new(FRAME - 0.01, 0.02, wide));
            for x in [-0.3, 0.3] {
                solid.block(x, 0.0, 0.0, Vec3::new(0.02, 0.008, 0.12));
            }
            solid
        };
        Panels {
            cover: [AISLE - 0.01, SIDE.1 - SIDE.0].map(|wide| room.stock.shape(chequer(wide))),
            middle: room.stock.shape(grating(Vec2::new(FRAME - 0.01, AISLE - 0.01), PITCH)),
            side: room.stock.shape(grating(Vec2::new(FRAME - 0.01, SIDE.1 - SIDE.0), PITCH)),
            plates: [
                room.stock.shape(plate(AISLE, SIDE.0 - 0.01)),
                room.stock.shape(plate(SIDE.1 + 0.01, half_width(0.0))),
                room.stock.shape(plate(SIDE.1 + 0.01, half_width(UPPER))),
            ],
            beam: room.stock.shape(ibeam),
            joist: room.stock.shape(joist),
        }
    }
}

fn lay_bay(room: &mut Room, panels: &Panels, bay: usize) {
    let x = room.plan.bay(bay);
    for side in [1.0, -1.0] {
        // Plates are turned about the bay's middle, so that port is as starboard.
        let (turn, shift) = (super::parts::facing(side), if side < 0.0 { BAY - 0.01 } else { 0.0 });
        for (k, y) in [0.0, 0.0, UPPER].into_iter().enumerate() {
            let at = Vec3::new(x + shift, y, 0.0);
            room.put(Rank::Must, "deck/plate", panels.plates[k], (turn, at), paint::PLATE);
        }
        for z in [AISLE, SIDE.0, SIDE.1, 0.02] {
            let at = Vec3::new(x, 0.0, z * side);
            room.put(Rank::Fill, "deck/joist", panels.joist, (Mat3::IDENTITY, at), paint::BEAM);
        }
        for panel in 0..4 {
            let x = x + (panel as f32 + 0.5) * FRAME;
            let middle = (SIDE.0 + SIDE.1) * 0.5 * side;
            let place = |y: f32, z: f32| (Mat3::IDENTITY, Vec3::new(x, y, z));
            // Gratings over what is worked on in the bilge, plates elsewhere.
            let mut floor = |open: bool, y: f32, z: f32, [grating, cover]: [u32; 2]| {
                let (kind, mesh, color) =
                    if open { ("deck/grating", grating, paint::GRATING) } else { ("deck/cover", cover, paint::PLATE) };
                room.put(Rank::Must, kind, mesh, place(y, z), color);
            };
            floor(panel % 2 == 1, 0.0, AISLE * 0.5 * side, [panels.middle, panels.cover[0]]);
            floor(panel == 2, 0.0, middle, [panels.side, panels.cover[1]]);
            if side < 0.0 || x > OPENING {
                floor(panel != 2, UPPER, middle, [panels.side, panels.cover[1]]);
            }
        }
    }
}

/// The cross aisles and the bridges above them, at both ends.
fn ends(room: &mut Room) {
    let panel = room.stock.shape(grating(Vec2::new(END - 0.2, FRAME - 0.01), PITCH));
    let length = room.plan.length();
    for (y, kind) in [(0.0, "deck/grating"), (UPPER, "bridge/grating")] {
        let count = (half_width(y) * 2.0 / FRAME) as usize;
        for k in 0..count {
            let z = (k as f32 + 0.5 - count as f32 * 0.5) * FRAME;
            for x in [END * 0.5 + 0.08, length - END * 0.5 - 0.08] {
                room.put(Rank::Must, kind, panel, (Mat3::IDENTITY, Vec3::new(x, y, z)), paint::GRATING);
            }
        }
    }
    let reach = half_width(UPPER - 0.3);
    for x in [0.2, END, length - END, length - 0.2] {
        let mut solid = Solid::default();
        beam(&mut solid, Vec3::new(0.0, -0.14, -reach), Vec3::new(0.0, -0.14, reach), Vec2::new(0.012, 0.18));
        beam(&mut solid, Vec3::new(0.0, -0.045, -reach), Vec3::new(0.0, -0.045, reach), Vec2::new(0.09, 0.014));
        beam(&mut solid, Vec3::new(0.0, -0.235, -reach), Vec3::new(0.0, -0.235, reach), Vec2::new(0.09, 0.014));
        room.put_new(Rank::Must, "bridge/beam", solid, Vec3::new(x, UPPER, 0.0), paint::BEAM);
    }
}

/// Edge beams, hangers and the inner rail of both catwalks, bay by bay.
fn catwalks(room: &mut Room) {
    let mut edge = Solid::default();
    beam(&mut edge, Vec3::new(0.0, -0.11, 0.0), Vec3::new(BAY, -0.11, 0.0), Vec2::new(0.014, 0.2));
    beam(&mut edge, Vec3::new(0.0, -0.2, 0.0), Vec3::new(BAY, -0.2, 0.0), Vec2::new(0.08, 0.014));
    let edge = room.stock.shape(edge);
    let mut fence = Solid::default();
    rail(&mut fence, Vec3::ZERO, Vec3::X * BAY);
    let fence = room.stock.shape(fence);
    let mut strut = Solid::default();
    beam(&mut strut, Vec3::new(0.0, -0.12, SIDE.0), Vec3::new(0.0, -0.12, half_width(UPPER)), Vec2::new(0.06, 0.12));
    rod(&mut strut, 8, 0.03, Vec3::new(0.0, -0.15, SIDE.0 + 0.1), Vec3::new(0.0, -1.0, half_width(UPPER - 1.0)));
    let strut = room.stock.shape(strut);
    for bay in 0..room.plan.bays {
        let x = room.plan.bay(bay);
        for side in [1.0, -1.0] {
            let place = |dx: f32, z: f32| (Mat3::IDENTITY, Vec3::new(x + dx, UPPER, z * side));
            room.put(Rank::Must, "catwalk/edge", edge, place(0.0, SIDE.0), paint::BEAM);
            room.put(Rank::Must, "catwalk/edge", edge, place(0.0, SIDE.1), paint::BEAM);
            room.put(Rank::Must, "catwalk/rail", fence, place(0.0, SIDE.0), paint::RAIL);
            let turn = super::parts::facing(side);
            for dx in [0.4, 2.0] {
                let clear = side < 0.0 || x + dx > OPENING;
                if clear {
                    room.put(Rank::Must, "catwalk/strut", strut, (turn, Vec3::new(x + dx, UPPER, 0.0)), paint::BEAM);
                }
            }
        }
    }
    // Around the opening for the stair.
    let mut guard = Solid::default();
    rail(&mut guard, Vec3::new(0.0, 0.0, SIDE.0), Vec3::new(0.0, 0.0, SIDE.1));
    let at = Vec3::new(OPENING + 0.02, UPPER, 0.0);
    room.put_new(Rank::Must, "catwalk/rail", guard, at, paint::RAIL);
}

/// The rail along the room's side of a bridge, open to the catwalks; half of it to each side.
fn bridge_rails(room: &mut Room, side: f32) {
    let length = room.plan.length();
    for x in [END, length - END] {
        let mut fence = Solid::default();
        rail(&mut fence, Vec3::ZERO, Vec3::Z * SIDE.0 * side);
        room.put_new(Rank::Must, "bridge/rail", fence, Vec3::new(x, UPPER, 0.0), paint::RAIL);
    }
}

/// The stair from the starboard side aisle to the after bridge, and ladders into the bilge.
fn ways_up(room: &mut Room) {
    let z = (SIDE.0 + SIDE.1) * 0.5;
    let mut solid = Solid::default();
    let (foot, top) = (Vec3::new(STAIR.1 - STAIR.0, -UPPER, 0.0), Vec3::ZERO);
    stairs(&mut solid, foot, top, SIDE.1 - SIDE.0 - 0.25);
    room.put_new(Rank::Must, "stair", solid, Vec3::new(STAIR.0, UPPER, z), paint::RAIL);
    let mut down = Solid::default();
    ladder(&mut down, Vec3::ZERO, 2.3, Vec3::X);
    let down = room.stock.shape(down);
    let length = room.plan.length();
    for x in [0.3, length - 0.3] {
        for side in [-4.1, 4.1] {
            let (turn, at) = (Mat3::IDENTITY, Vec3::new(x, UPPER - 0.1, side));
            room.put(Rank::Detail, "ladder", down, (turn, at - Vec3::Y * 2.3), paint::RAIL);
        }
    }
}
