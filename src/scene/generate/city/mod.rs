//! The city (after thesis 8.4.1 and CHC): twelve districts that differ, where the thesis had twelve copies of London.
//!
//! Bodies of buildings and ground must be there; fronts, roofs, trees, cars and lamps make up the number of triangles. High
//! depth complexity in the streets, none at the border looking out. A million triangles take about 50 ms.

mod building;
mod facade;
mod plan;
mod street;
mod walk;

use glam::{DVec2, DVec3, Vec2};

use super::super::random::Random;
use super::Generated;
use super::solid::Solid;
use super::stock::{Rank, Spare, Stock};
use building::{Site, civic, hall, round_tower, slab, terrace_house, tower, villa};
use facade::Side;
use plan::{Block, DISTRICTS, Plan, Plot, Style};
use street::{Furniture, ground};

/// Metres of pavement between kerb and house.
const PAVEMENT: f64 = 3.2;
/// Metres from the front of a terrace to its back.
const DEEP: f64 = 11.0;
/// Of ten thousand triangles on offer, how many are taken at most: a fuller choice leaves the city evenly furnished.
const TAKEN: u64 = 9_400;

pub(super) fn build(seed: u64, triangles: u64) -> Generated {
    // Districts grow by a column or a row of blocks until there is enough to choose from.
    let mut step = 1;
    let (mut plan, mut stock, mut top) = offer(seed, step);
    while stock.triangles() * TAKEN / 10_000 < triangles {
        let missing = libm::sqrt(triangles as f64 / stock.triangles() as f64);
        step = (step + 1).max((step as f64 * missing * 0.9) as usize);
        (plan, stock, top) = offer(seed, step);
    }
    let border = plan.bounds();
    let position = DVec3::new(border.min.x - 20.0, 0.0, border.middle().y);
    let scene = stock.settle("city", triangles, seed, &Spare::obelisk(position));
    Generated { scene, path: walk::walk(&plan, f64::from(top)), frames: 240 }
}

/// Everything that a city of some size may have, and its tallest roof.
fn offer(seed: u64, step: usize) -> (Plan, Stock, f32) {
    let plan = Plan::new(1 + step / 2, 1 + (step - 1) / 2);
    let mut stock = Stock::default();
    let furniture = Furniture::new(&mut stock);
    let mut top = 0.0;
    for block in &plan.blocks {
        let district = &DISTRICTS[block.district];
        let mut random = Random::keyed(seed, (block.district * 0x1_0000 + block.number) as u64);
        let label = format!("{}/{}", district.name, block.number);
        ground(&mut stock, block, &label);
        build_block(&mut stock, &mut random, block, &label, &mut top, &furniture);
        furniture.line(&mut stock, &mut random, block, &label);
    }
    outskirts(&mut stock, plan.bounds());
    furniture.country(&mut stock, &mut Random::keyed(seed, u64::MAX), plan.bounds(), plan.blocks.len() * 2);
    (plan, stock, top)
}

/// Grass all around, in eight plates.
fn outskirts(stock: &mut Stock, city: Plot) {
    let out = city.inset(-400.0);
    let (xs, zs) = ([out.min.x, city.min.x, city.max.x, out.max.x], [out.min.y, city.min.y, city.max.y, out.max.y]);
    for k in (0..9).filter(|&k| k != 4) {
        let (i, j) = (k % 3, k / 3);
        let size = DVec2::new(xs[i + 1] - xs[i], zs[j + 1] - zs[j]);
        let mut grass = Solid::default();
        grass.patch(Vec2::ZERO, size.as_vec2(), 0.0);
        stock.place_new(Rank::Must, format!("outskirts_{k}"), grass, DVec3::new(xs[i], 0.0, zs[j]), [112, 136, 84]);
    }
}

fn build_block(
    stock: &mut Stock,
    random: &mut Random,
    block: &Block,
    label: &str,
    top: &mut f32,
    furniture: &Furniture,
) {
    let district = &DISTRICTS[block.district];
    let plot = block.plot.inset(PAVEMENT);
    // Now and then a block is left open as a park.
    if random.chance(0.06) && block.number > 0 {
        furniture.yard(stock, random, plot, label, false);
        furniture.yard(stock, random, plot, &format!("{label}/park"), false);
        return;
    }
    let lots = match district.style {
        Style::Terraces => terraces(random, plot, district.front),
        Style::Towers | Style::Rounds => grid(plot, 2, 2, 5.0),
        Style::Slabs => grid(plot, 1, 3, 7.0),
        Style::Villas => grid(plot, 4, 3, 1.5),
        Style::Halls => grid(plot, 1, 2, 6.0),
        Style::Civic => grid(plot, 1, 1, 0.0),
    };
    for (k, &(lot, front)) in lots.iter().enumerate() {
        let label = format!("{label}/{k}");
        let mut site = Site { stock, random, district, label, top };
        match district.style {
            Style::Terraces => terrace_house(&mut site, lot, front),
            Style::Towers => tower(&mut site, lot),
            Style::Rounds => round_tower(&mut site, lot),
            Style::Slabs => slab(&mut site, lot),
            Style::Villas => villa(&mut site, lot),
            Style::Halls => hall(&mut site, lot),
            Style::Civic => civic(&mut site, lot),
        }
    }
    if district.style == Style::Terraces {
        furniture.yard(stock, random, plot.inset(DEEP + 2.0), label, district.name == "market");
    }
}

/// Equal lots with gaps between them; they face south.
fn grid(plot: Plot, columns: usize, rows: usize, gap: f64) -> Vec<(Plot, Side)> {
    let count = DVec2::new(columns as f64, rows as f64);
    let size = (plot.size() - (count - 1.0) * gap) / count;
    let lot = |k: usize| {
        let at = DVec2::new((k % columns) as f64, (k / columns) as f64);
        let min = plot.min + at * (size + gap);
        (Plot { min, max: min + size }, Side::South)
    };
    (0..columns * rows).map(lot).collect()
}

/// Lots wall to wall along the four edges of a block, around a courtyard; the north and south rows have the corners.
fn terraces(random: &mut Random, plot: Plot, front: (f64, f64)) -> Vec<(Plot, Side)> {
    let mut lots = Vec::new();
    let (min, max) = (plot.min, plot.max);
    for (side, z0) in [(Side::North, min.y), (Side::South, max.y - DEEP)] {
        for (a, b) in cuts(random, min.x, max.x, front) {
            lots.push((Plot { min: DVec2::new(a, z0), max: DVec2::new(b, z0 + DEEP) }, side));
        }
    }
    for (side, x0) in [(Side::West, min.x), (Side::East, max.x - DEEP)] {
        for (a, b) in cuts(random, min.y + DEEP, max.y - DEEP, front) {
            lots.push((Plot { min: DVec2::new(x0, a), max: DVec2::new(x0 + DEEP, b) }, side));
        }
    }
    lots
}

/// Cuts a length into fronts: as many as fit, each a little longer or shorter.
fn cuts(random: &mut Random, from: f64, to: f64, front: (f64, f64)) -> Vec<(f64, f64)> {
    let mut widths = Vec::new();
    let mut sum = 0.0;
    while sum < to - from - front.0 * 0.5 {
        let width = random.range(front.0, front.1);
        widths.push(width);
        sum += width;
    }
    let (scale, mut at) = ((to - from) / sum, from);
    let cut = |width: f64| {
        let start = at;
        at += width * scale;
        (start, at)
    };
    widths.into_iter().map(cut).collect()
}
