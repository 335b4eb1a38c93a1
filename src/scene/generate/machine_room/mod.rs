//! The machine room (after thesis 8.4.2, a submarine's auxiliary machine room): engines, turbines, pumps, pipes and gratings
//! in a framed hull, strakes as long as the room beside bolts of a centimetre.
//!
//! Hull, decks, machines' bodies and pipes must be there; heads, doors and gauges are details; flanges, valves, hangers and
//! branches fill up the number of triangles. The room grows by bays of some 70,000 triangles. About 50 ms a million.

mod auxiliary;
mod deck;
mod engine;
mod hull;
mod machines;
mod parts;
mod plan;
mod runs;
mod walk;

use glam::{DVec3, Vec3};

use super::Generated;
use super::stock::Spare;
use parts::Room;
use plan::{FEWEST_BAYS, Kind, Plan, ROW};

pub(super) fn build(seed: u64, triangles: u64) -> Generated {
    let mut bays = FEWEST_BAYS;
    let mut room = offer(seed, bays);
    while room.stock.triangles() < triangles + triangles / 100 {
        // Bays beyond the first few offer alike: some less than the average, so that the last steps are by one.
        let each = room.stock.triangles() / bays as u64;
        let missing = (triangles - triangles.min(room.stock.triangles())) * 9 / 10 / each;
        bays += (missing as usize).max(1);
        room = offer(seed, bays);
    }
    let length = f64::from(room.plan.length());
    // A strum box in the bilge, where nobody misses or minds it.
    let position = DVec3::new(length - 0.8, -2.4, 0.0);
    let spare = Spare { name: "strum_box", position, radius: 0.15, height: 0.3, color: parts::paint::STEEL };
    let path = walk::walk(&room.plan);
    let scene = room.stock.settle("machine-room", triangles, seed, &spare);
    Generated { scene, path, frames: 240 }
}

/// Everything that a room of so many bays may have.
fn offer(seed: u64, bays: usize) -> Room {
    let mut room = Room::new(Plan::new(seed, bays), seed);
    hull::hull(&mut room);
    deck::decks(&mut room);
    rows(&mut room);
    runs::runs(&mut room);
    auxiliary::auxiliaries(&mut room);
    room
}

/// The machines in their two rows.
fn rows(room: &mut Room) {
    let stock = &mut room.stock;
    let kinds = [
        (Kind::Diesel, engine::diesel(stock)),
        (Kind::Turbine, machines::turbine(stock)),
        (Kind::Evaporator, machines::evaporator(stock)),
        (Kind::Compressor, machines::compressor(stock)),
    ];
    let screen = machines::screen(stock);
    let crossing = room.plan.crossing();
    for x in room.plan.gaps().into_iter().filter(|&x| x != crossing) {
        for side in [1.0, -1.0] {
            screen.place(room, Vec3::new(x, 0.0, ROW * side), side);
        }
    }
    for slot in room.plan.slots.clone() {
        if let Some((_, machine)) = kinds.iter().find(|(kind, _)| *kind == slot.kind) {
            machine.place(room, Vec3::new(slot.x, 0.0, ROW * slot.side), slot.side);
        }
    }
}
