//! Rooms: a building of storeys, corridors and rooms with walls of real thickness, doorways, windows, a stairwell and furniture,
//! with its cells and portals (lecture, *Portal Culling*).
//!
//! Open space is a set of boxes ([`plan`]): rooms, corridors, doorways, window openings, and the outside. Walls are what is
//! left: their surfaces are the faces of the boxes without the portals ([`shell`]), on planes that neighbours share,
//! so they have no crack and no T-junction, and the boxes are the cells exactly. Walls must be there; furniture makes up the
//! number of triangles. A number too small for the least building gives walls with gaps, and then no cells.

mod furniture;
mod plan;
mod shell;
mod walk;

use super::super::random::Random;
use super::Generated;
use super::stock::{Spare, Stock};
use furniture::Furniture;
use plan::{Plan, metres};

/// Of a hundred triangles on offer, how many are taken at most: a fuller choice leaves the rooms evenly furnished.
const TAKEN: u64 = 90;

pub(super) fn build(seed: u64, triangles: u64) -> Generated {
    let mut step = 0;
    let (mut plan, mut stock) = offer(seed, step);
    while stock.triangles() * TAKEN / 100 < triangles {
        // Rooms grow as the cube of the step.
        let missing = libm::cbrt(triangles as f64 / stock.triangles() as f64);
        step = (step + 1).max(((step + 2) as f64 * missing * 0.85) as usize);
        (plan, stock) = offer(seed, step);
    }
    let spare =
        Spare { name: "hat_stand", position: metres(plan.niche()), radius: 0.2, height: 1.7, color: [96, 72, 52] };
    let whole = stock.must() <= triangles;
    let mut scene = stock.settle("rooms", triangles, seed, &spare);
    scene.cells = whole.then(|| plan.cells());
    Generated { scene, path: walk::walk(&plan), frames: 240 }
}

/// Everything that a building of some size may have.
fn offer(seed: u64, step: usize) -> (Plan, Stock) {
    let plan = Plan::new(seed, step);
    let mut stock = Stock::default();
    shell::shell(&mut stock, &plan);
    let furniture = Furniture::new(&mut stock);
    for (number, space) in plan.spaces.iter().enumerate() {
        let mut random = Random::keyed(seed, 0x00F0_0000 + number as u64);
        furniture.furnish(&mut stock, &mut random, &plan, number, space);
    }
    (plan, stock)
}
