//! The plant (after thesis 8.4.3, CHC and the gem, which walked UNC's): a coal-fired power plant of 12,748,510 triangles.
//!
//! Steel, decks, aisles, boiler, flue and halls must be there; runs of pipes, risers, valves, trays and machines, some half of
//! all triangles, make up the number, each run whole or not at all. All of it is a stock of a few hundred meshes placed some
//! 30,000 times, so that the full size takes a tenth of a second and a few megabytes. High depth complexity everywhere inside;
//! the walk begins and ends outside, as CHC's had its stretches with all of the model in view, and with none.

mod boiler;
mod flue;
mod frame;
mod machines;
mod pipes;
mod plan;
mod runs;
mod site;
mod walk;
mod walkway;
mod yard;

use glam::DVec3;

use super::Generated;
use super::stock::{Spare, Stock};
use plan::Plan;
use site::{Shapes, Site};

/// Metres between the middles of units beyond the house's own depth.
const APART: f64 = 124.0;
/// Of ten thousand triangles on offer, how many are taken at most: a fuller choice leaves the plant evenly furnished.
const TAKEN: u64 = 9_700;

pub(super) fn build(seed: u64, triangles: u64) -> Generated {
    let mut step = 0;
    let (mut plan, mut stock) = offer(seed, step);
    while stock.triangles() * TAKEN / 10_000 < triangles {
        step += 1;
        (plan, stock) = offer(seed, step);
    }
    // A vent on the yard, outside of the transfer tower.
    let position = DVec3::new(plan.line_x(0) - 20.0, 0.0, plan.line_z(0) - 30.0);
    let spare = Spare { name: "vent", position, radius: 0.8, height: 5.0, color: [150, 156, 160] };
    let scene = stock.settle("plant", triangles, seed, &spare);
    Generated { scene, path: walk::walk(&plan), frames: 240 }
}

/// Everything that a plant of some size may have.
fn offer(seed: u64, step: usize) -> (Plan, Stock) {
    let plan = Plan::new(seed, step);
    let mut stock = Stock::default();
    let shapes = Shapes::new(&mut stock);
    let apart = plan.line_z(plan.bays_z) * 2.0 + APART;
    for unit in 0..plan.units {
        // The walked unit is in the middle of all.
        let place = (unit as f64 * 0.5).ceil() * if unit % 2 == 0 { 1.0 } else { -1.0 };
        let mut site = Site::new(&mut stock, &plan, &shapes, unit, DVec3::Z * (place * apart));
        yard::yard(&mut site);
        frame::frame(&mut site);
        boiler::boiler(&mut site);
        flue::flue(&mut site);
        walkway::walkways(&mut site);
        runs::pipes(&mut site);
        machines::machines(&mut site);
    }
    (plan, stock)
}
