//! Where pipes run: in lanes under the floors along x and z, in racks beside column lines, up the shafts; trays and conduits.
//!
//! Along x pipes hang lower than along z, and lanes keep beside the column lines, so that runs cross without meeting. A run is
//! one piece of the stock: from its first bend to its last it is there or not.

use glam::{DVec3, Mat3};

use super::super::stock::Rank;
use super::frame::in_shaft;
use super::pipes::{LANE, RACKS, SIZES, UNDERSIDE, overhang};
use super::plan::{BAY, Plan, Room, STOREY, Use};
use super::site::{HALF, Site, along};

/// Colours of what flows: steam and hot water in lagging, water, condensate, oil, gas, air, fire water, drains.
const MEDIA: [[u8; 3]; 8] = [
    [196, 198, 200],
    [206, 204, 198],
    [92, 140, 104],
    [120, 164, 178],
    [142, 104, 70],
    [206, 178, 70],
    [132, 156, 186],
    [178, 64, 52],
];
/// Metres from the column line to the middle of a rack.
const RACK: f64 = 0.44;
const HANGER: [u8; 3] = [98, 104, 106];
const WHEEL: [u8; 3] = [176, 40, 36];

/// All pipes of a unit.
pub(super) fn pipes(site: &mut Site) {
    let plan = site.plan;
    for floor in 0..plan.floors {
        for (along_x, lines) in [(true, plan.bays_z), (false, plan.bays_x)] {
            for line in 0..lines {
                for high in [false, true] {
                    lane(site, Lane { along_x, line, high, floor });
                }
                trays(site, along_x, line, floor);
                if line > 0 {
                    racks(site, along_x, line, floor);
                }
            }
        }
    }
    for j in 0..plan.bays_z {
        for i in 0..plan.bays_x {
            if plan.use_of(i, j) == Use::Shaft {
                risers(site, i, j);
            }
        }
    }
    all_conduits(site);
}

/// A lane of pipes beside a column line on a floor: at the low or the high side of a row of bays.
#[derive(Clone, Copy)]
struct Lane {
    along_x: bool,
    line: usize,
    high: bool,
    floor: usize,
}

impl Lane {
    fn is_boiler(&self, plan: &Plan, bay: usize) -> bool {
        let (i, j) = if self.along_x { (bay, self.line) } else { (self.line, bay) };
        plan.use_of(i, j) == Use::Boiler
    }

    fn bays(&self, plan: &Plan) -> usize {
        if self.along_x { plan.bays_x } else { plan.bays_z }
    }

    /// The point of the lane at a column line (or a part of a bay past it), `across` into the lane and `y` above the floor.
    fn at(&self, plan: &Plan, bay: f64, across: f64, y: f32) -> DVec3 {
        let bays = DVec3::new(plan.bays_x as f64, 0.0, plan.bays_z as f64);
        let side = if self.high { BAY - LANE.0 - LANE.1 } else { LANE.0 };
        let (u, v) = (bay * BAY, self.line as f64 * BAY + side + across);
        let (x, z) = if self.along_x { (u, v) } else { (v, u) };
        DVec3::new(x, plan.level(self.floor) + f64::from(y), z) - bays * BAY * 0.5
    }
}

/// Fills a lane with runs, each of some bays and some pipes side by side.
fn lane(site: &mut Site, lane: Lane) {
    let plan = site.plan;
    let bays = lane.bays(plan);
    let mut bay = usize::from(site.random.chance(0.25));
    while bay < bays {
        let longest = (bay..bays).take_while(|&k| !lane.is_boiler(plan, k)).count();
        if longest == 0 {
            bay += 1;
            continue;
        }
        let length = site.random.between(2, 6).min(longest);
        run(site, lane, bay, length);
        bay += length + usize::from(site.random.chance(0.3));
    }
}

fn run(site: &mut Site, lane: Lane, first: usize, length: usize) {
    site.begin();
    let (hung, heavy) = (usize::from(!lane.along_x), site.random.chance(0.4));
    let mut across = 0.0;
    loop {
        let size = if heavy { site.random.between(3, 6) } else { site.random.between(0, 4) };
        let width = f64::from(SIZES[size].0) * 2.0;
        if across + width > LANE.1 {
            break;
        }
        strand(site, lane, first, length, across + width * 0.5, size);
        across += width + 0.14 + site.random.range(0.0, 0.42);
    }
    let trapeze = site.shapes.pipes.trapezes[hung];
    for bay in first..first + length {
        // What is built to hang beside z growing is beside x shrinking once it lies along z.
        let across = if lane.along_x { 0.0 } else { LANE.1 };
        let at = lane.at(site.plan, bay as f64, across, 0.0);
        site.put(Rank::Fill, "hanger", trapeze, at, along(lane.along_x), HANGER);
    }
    site.end();
}

/// One pipe of a run with its ends.
fn strand(site: &mut Site, lane: Lane, first: usize, length: usize, across: f64, size: usize) {
    let plan = site.plan;
    let (hung, radius) = (usize::from(!lane.along_x), SIZES[size].0);
    let y = UNDERSIDE[hung] + radius;
    let medium = site.random.below(MEDIA.len());
    let color = site.worn(MEDIA[medium]);
    let kind = if medium < 2 { 1 } else { 2 * usize::from(site.random.chance(0.35)) };
    let turn = along(lane.along_x);
    for bay in first..first + length {
        let at = lane.at(plan, bay as f64, across, y);
        let end = lane.at(plan, bay as f64 + 1.0, across, y);
        let mesh = site.shapes.pipes.spools[size][kind];
        if !plan.meets_solid(&Room { min: at, max: end + DVec3::splat(0.01) }) {
            site.put(Rank::Fill, "pipe", mesh, at, turn, color);
        }
    }
    // The run is a bend shorter at both ends of what is hung beyond it; ends lie within the next bay or outside the wall.
    for (bay, back) in [(first, true), (first + length, false)] {
        let at = lane.at(plan, bay as f64, across, y);
        let reach = f64::from(overhang(radius) + radius) * if back { -1.0 } else { 1.0 };
        let tip = at + if lane.along_x { DVec3::X * reach } else { DVec3::Z * reach };
        let room = Room { min: at.min(tip), max: at.max(tip) };
        let (low, high) = (DVec3::splat(f64::from(radius)) + DVec3::Y * f64::from(y), DVec3::splat(f64::from(radius)));
        let below = Room { min: room.min - low + DVec3::Y * 0.05, max: room.max + high };
        if plan.meets_solid(&below) || into_shaft(plan, tip) {
            continue;
        }
        let turn = if back { turn * HALF } else { turn };
        let shapes = &site.shapes.pipes;
        let ([body, wheel], up) = (shapes.ends_down[size][hung], shapes.ends_up[size][hung]);
        if site.is_free(&below) && site.random.chance(0.3) {
            site.put(Rank::Fill, "valve", body, at, turn, color);
            site.put(Rank::Fill, "wheel", wheel, at, turn, WHEEL);
        } else if lane.floor + 1 < plan.floors {
            site.put(Rank::Fill, "bend", up, at, turn, color);
        }
    }
}

fn into_shaft(plan: &Plan, at: DVec3) -> bool {
    let shaft = plan.shaft();
    let inner = Room { min: shaft.min + 1.2, max: shaft.max - 1.2 };
    inner.meets(&Room { min: at - 0.01, max: at + 0.01 })
}

/// A cable tray through the middles of a row of bays, in stretches; risers have the shafts.
fn trays(site: &mut Site, along_x: bool, line: usize, floor: usize) {
    let plan = site.plan;
    let middle = Lane { along_x, line, high: false, floor };
    let tray = site.shapes.pipes.tray;
    let y = if along_x { 2.46 } else { 2.58 };
    let mut open = false;
    for bay in 0..middle.bays(plan) {
        let (i, j) = if along_x { (bay, line) } else { (line, bay) };
        let at = middle.at(plan, bay as f64, BAY * 0.5 - LANE.0 + if along_x { -0.8 } else { 0.8 }, y);
        let end = middle.at(plan, bay as f64 + 1.0, BAY * 0.5 - LANE.0, y);
        let bounds = Room { min: at.min(end) - 0.3, max: at.max(end) + 0.3 };
        let usable = plan.use_of(i, j) == Use::Floors && !plan.meets_solid(&bounds);
        let goes_on = if open { site.random.chance(0.8) } else { site.random.chance(0.45) };
        match (open, usable && goes_on) {
            (_, false) => site.end(),
            (false, true) => site.begin(),
            (true, true) => {}
        }
        open = usable && goes_on;
        if !open {
            continue;
        }
        site.put(Rank::Fill, "tray", tray, at, along(along_x), HANGER);
    }
    site.end();
}

/// Racks beside an inner column line, in stretches between the aisles that cross it.
fn racks(site: &mut Site, along_x: bool, line: usize, floor: usize) {
    let plan = site.plan;
    let below = Lane { along_x, line, high: false, floor };
    let side = if site.random.chance(0.5) { RACK } else { -RACK };
    let (turn, header) = (along(along_x), site.shapes.pipes.header);
    let point = |bay: usize| below.at(plan, bay as f64, side - LANE.0, 0.0);
    let kind = site.random.below(RACKS.len());
    let colors = [0, 1].map(|_| MEDIA[site.random.below(MEDIA.len())]);
    let mut open = false;
    for bay in 0..below.bays(plan) {
        let (at, end) = (point(bay), point(bay + 1));
        let (i, j) = if along_x { (bay, line) } else { (line, bay) };
        let beyond = if along_x { (i, j - 1) } else { (i - 1, j) };
        let uses = [plan.use_of(i, j), plan.use_of(beyond.0, beyond.1)];
        let room = Room { min: at.min(end) - 0.15, max: at.max(end) + DVec3::new(0.15, 2.4, 0.15) };
        let usable = uses.iter().all(|&u| u == Use::Floors || u == Use::Shaft) && site.is_free(&room);
        let goes_on = usable && site.random.chance(if open { 0.85 } else { 0.6 });
        if goes_on && !open {
            site.begin();
            site.put(Rank::Fill, "header", header, at, turn, colors[0]);
        }
        if goes_on {
            for (mesh, color) in site.shapes.pipes.racks[kind].into_iter().zip(colors) {
                site.put(Rank::Fill, "rack", mesh, at, turn, color);
            }
        }
        if open && !goes_on {
            site.put(Rank::Fill, "header", header, at, turn, colors[0]);
            site.end();
        }
        open = goes_on;
    }
    if open {
        site.put(Rank::Fill, "header", header, point(below.bays(plan)), turn, colors[0]);
    }
    site.end();
}

/// Pipes up a shaft, each over some storeys.
fn risers(site: &mut Site, i: usize, j: usize) {
    let plan = site.plan;
    let corner = DVec3::new(plan.line_x(i) + 2.65, 0.0, plan.line_z(j) + 2.65);
    for k in 0..9 {
        let place = DVec3::new((k % 3) as f64 * 1.25, 0.0, (k / 3) as f64 * 1.25);
        let size = site.random.between(1, 6);
        let medium = site.random.below(MEDIA.len());
        let color = site.worn(MEDIA[medium]);
        let lagging = usize::from(medium < 2);
        let mut floor = site.random.below(3);
        while floor < plan.floors {
            let storeys = site.random.between(2, 7).min(plan.floors - floor);
            riser(site, corner + place, (floor, storeys), size, (color, lagging));
            floor += storeys + site.random.between(0, 2);
        }
    }
}

fn riser(
    site: &mut Site,
    place: DVec3,
    (first, storeys): (usize, usize),
    size: usize,
    (color, lagging): ([u8; 3], usize),
) {
    let plan = site.plan;
    site.begin();
    let radius = f64::from(SIZES[size].0);
    let quarter = [Mat3::IDENTITY, super::site::QUARTER, HALF, super::site::THREE_QUARTERS][site.random.below(4)];
    for floor in first..first + storeys {
        let at = place + DVec3::Y * plan.level(floor);
        let room = Room { min: at - DVec3::new(radius, 0.0, radius), max: at + DVec3::new(radius, STOREY, radius) };
        if plan.meets_solid(&room) {
            continue;
        }
        let valved = site.random.chance(0.22);
        let shapes = &site.shapes.pipes;
        let (straight, [body, wheel]) = (shapes.uprights[size][lagging], shapes.valved[size]);
        if valved {
            site.put(Rank::Fill, "riser_valve", body, at, quarter, color);
            site.put(Rank::Fill, "wheel", wheel, at, quarter, WHEEL);
        } else {
            site.put(Rank::Fill, "riser", straight, at, quarter, color);
        }
    }
    let top = place + DVec3::Y * plan.level(first + storeys);
    let turn = site.shapes.pipes.turns[size];
    let room = Room { min: top - 0.3, max: top + DVec3::new(0.3, 1.5, 0.3) };
    if first + storeys < plan.floors && !plan.meets_solid(&room) {
        site.put(Rank::Fill, "riser_bend", turn, top, quarter, color);
    }
    site.end();
}

/// Conduits up about half of the columns.
fn all_conduits(site: &mut Site) {
    let plan = site.plan;
    let conduits = site.shapes.pipes.conduits;
    for floor in 0..plan.floors {
        for j in 0..=plan.bays_z {
            for i in 0..=plan.bays_x {
                let at = DVec3::new(plan.line_x(i) + 0.27, plan.level(floor), plan.line_z(j) - 0.15);
                let room = Room { min: at - 0.1, max: at + DVec3::new(0.1, STOREY - 0.1, 0.5) };
                if site.random.chance(0.5) && !in_shaft(plan, i, j) && site.is_free(&room) {
                    site.put(Rank::Fill, "conduits", conduits, at, Mat3::IDENTITY, HANGER);
                }
            }
        }
    }
}
