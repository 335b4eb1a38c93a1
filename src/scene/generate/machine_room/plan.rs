//! The room's measures, in metres: x runs forward from the after bulkhead, y up from the deck plates, z to starboard.
//!
//! A pressure hull of circular section, framed every 0.8 m, in bays of four frames. Across, from the middle outward: the middle
//! aisle, a row of machines, the side aisle with the catwalk above it, and the auxiliaries along the hull.

use super::super::super::random::Random;

/// Inner radius of the hull's plating, and how high its axis lies above the deck plates.
pub(super) const RADIUS: f32 = 5.4;
pub(super) const AXIS: f32 = 1.9;
/// How far frames stand in from the plating.
pub(super) const FRAME_DEPTH: f32 = 0.28;
/// From frame to frame, and of a bay.
pub(super) const FRAME: f32 = 0.8;
pub(super) const BAY: f32 = 3.2;
/// Between a bulkhead and the first bay: a cross aisle below, a bridge above.
pub(super) const END: f32 = 1.6;
/// Height of the catwalks and bridges.
pub(super) const UPPER: f32 = 3.2;
/// Half the middle aisle; the middle of the rows of machines; the side aisle from and to; all to either side.
pub(super) const AISLE: f32 = 1.0;
pub(super) const ROW: f32 = 1.8;
pub(super) const SIDE: (f32, f32) = (2.72, 3.78);
/// Where the stair stands in the starboard side aisle: its head at the after bridge, and its foot.
pub(super) const STAIR: (f32, f32) = (1.6, 4.2);
/// Where the starboard catwalk begins, beyond the opening for the stair.
pub(super) const OPENING: f32 = 4.8;
/// Fewest bays: the stair and two pairs of machines.
pub(super) const FEWEST_BAYS: usize = 4;

/// What stands in a slot of a row of machines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Two bays: a diesel engine and its generator.
    Diesel,
    /// Two bays: a steam turbine, its gear and a generator.
    Turbine,
    /// Two bays: a distilling plant.
    Evaporator,
    /// One bay: an air compressor.
    Compressor,
}

/// A machine's place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slot {
    pub kind: Kind,
    /// Middle of the machine.
    pub x: f32,
    /// Half the length of the slot.
    pub half: f32,
    /// 1 to starboard, -1 to port.
    pub side: f32,
}

/// How long the room is, and which machine stands where.
#[derive(Debug, Clone)]
pub(super) struct Plan {
    pub bays: usize,
    pub slots: Vec<Slot>,
}

impl Plan {
    /// A room of so many bays, at least [`FEWEST_BAYS`].
    pub fn new(seed: u64, bays: usize) -> Plan {
        let mut slots = Vec::new();
        for (number, side) in [(0, 1.0), (1, -1.0)] {
            let mut random = Random::keyed(seed, 0x100 + number);
            for pair in 0..bays / 2 {
                // Diesels where the walk begins; the rest by the seed.
                let kind = match (pair, random.below(8)) {
                    (0, _) | (_, 0..=2) => Kind::Diesel,
                    (_, 3..=5) => Kind::Turbine,
                    _ => Kind::Evaporator,
                };
                slots.push(Slot { kind, x: END + (pair as f32 * 2.0 + 1.0) * BAY, half: BAY, side });
            }
            if bays % 2 == 1 {
                let x = END + (bays as f32 - 0.5) * BAY;
                slots.push(Slot { kind: Kind::Compressor, x, half: BAY * 0.5, side });
            }
        }
        Plan { bays, slots }
    }

    /// From bulkhead to bulkhead.
    pub fn length(&self) -> f32 {
        self.bays as f32 * BAY + 2.0 * END
    }

    /// After end of a bay.
    pub fn bay(&self, bay: usize) -> f32 {
        END + bay as f32 * BAY
    }

    /// The gaps between two machines of a row, both rows alike.
    pub fn gaps(&self) -> Vec<f32> {
        let last = if self.bays % 2 == 1 { self.bays / 2 } else { self.bays / 2 - 1 };
        (1..=last).map(|pair| self.bay(2 * pair)).collect()
    }

    /// The gap between two machines, to cross from aisle to aisle: some 0.6 of the way forward.
    pub fn crossing(&self) -> f32 {
        let pairs = self.bays / 2;
        let gap = (pairs as f32 * 0.6).round().clamp(1.0, (pairs - 1) as f32);
        self.bay(2 * gap as usize)
    }
}

/// Half the width between the frames at a height.
pub(super) fn half_width(y: f32) -> f32 {
    let (r, up) = (RADIUS - FRAME_DEPTH, y - AXIS);
    (r * r - up * up).max(0.0).sqrt()
}
