//! Buildings: each fills a plot with a body (roof, setbacks, chimneys) and offers its fronts as details.

use glam::{DVec3, Vec2, Vec3};

use super::super::super::random::Random;
use super::super::solid::Solid;
use super::super::stock::{Rank, Stock};
use super::facade::{Body, SIDES, Side, balconies, fins, ground_floor, ledges, windows};
use super::plan::{District, Plot, Roof};

/// Height of the pavement above the road.
pub(super) const KERB: f32 = 0.15;

/// Where a building goes and what it belongs to.
pub(super) struct Site<'a> {
    pub stock: &'a mut Stock,
    pub random: &'a mut Random,
    pub district: &'a District,
    /// Begins the names of the objects.
    pub label: String,
    /// Tallest roof so far, in metres.
    pub top: &'a mut f32,
}

impl Site<'_> {
    fn floors(&mut self) -> usize {
        self.random.between(self.district.floors.0, self.district.floors.1)
    }

    /// The body of so many floors on a plot.
    fn body(&self, plot: Plot, floors: usize) -> Body {
        let half = (plot.size() * 0.5).as_vec2();
        Body { half_x: half.x, half_z: half.y, y0: 0.0, y1: floors as f32 * self.district.storey }
    }

    fn place(&mut self, rank: Rank, kind: &str, plot: Plot, solid: Solid, color: [u8; 3]) {
        let middle = plot.middle();
        let position = DVec3::new(middle.x, f64::from(KERB), middle.y);
        self.stock.place_new(rank, format!("{}/{kind}", self.label), solid, position, color);
    }

    fn reach(&mut self, y: f32) {
        *self.top = self.top.max(y + KERB);
    }

    fn tone(&mut self) -> [u8; 3] {
        let (tone, shade) = (self.district.tones[self.random.below(3)], self.random.below(20) as u8);
        tone.map(|c| c.saturating_sub(shade))
    }
}

/// The same colour, darker: window glass and sills beside their wall.
fn darker(color: [u8; 3]) -> [u8; 3] {
    color.map(|c| (u16::from(c) * 5 / 8) as u8)
}

/// A house of a terrace; `front` is the side on the street.
pub(super) fn terrace_house(site: &mut Site, plot: Plot, front: Side) {
    let (floors, color) = (site.floors(), site.tone());
    let body = site.body(plot, floors);
    let (x, z, top) = (body.half_x, body.half_z, body.y1);
    let mut solid = Solid::default();
    solid.cuboid(Vec3::new(-x, -0.3, -z), Vec3::new(x, top, z));
    body.on_wall(&mut solid, front, 0.0, top - 0.45, Vec3::new(body.width(front), 0.35, 0.3));
    let height = roof(&mut solid, site.district.roof, &body, site.random.range(0.8, 1.2) as f32);
    let chimneys = site.random.between(1, 2);
    for k in 0..chimneys {
        let at = x.min(z) * (0.3 + 0.3 * k as f32);
        solid.block(at, top, -at * 0.5, Vec3::new(0.7, height + 0.9, 0.7));
    }
    site.reach(top + height + 0.9);
    site.place(Rank::Must, "house", plot, solid, color);
    let mut details = Solid::default();
    let shop = site.random.chance(0.4);
    ground_floor(&mut details, &body, front, shop);
    windows(&mut details, &body, front, site.district.storey, 1, 2.9);
    site.place(Rank::Detail, "front", plot, details, darker(color));
    let mut back = Solid::default();
    windows(&mut back, &body, opposite(front), site.district.storey, 0, 4.2);
    site.place(Rank::Detail, "back", plot, back, darker(color));
}

fn opposite(side: Side) -> Side {
    match side {
        Side::West => Side::East,
        Side::East => Side::West,
        Side::North => Side::South,
        Side::South => Side::North,
    }
}

/// Adds a roof and returns its height.
fn roof(solid: &mut Solid, kind: Roof, body: &Body, steep: f32) -> f32 {
    let (x, z, top) = (body.half_x + 0.25, body.half_z + 0.25, body.y1);
    let rise = x.min(z) * 0.7 * steep;
    let outline = |x: f32, z: f32| [Vec2::new(-x, -z), Vec2::new(-x, z), Vec2::new(x, z), Vec2::new(x, -z)];
    match kind {
        Roof::Flat => {
            parapet(solid, body, 0.9);
            0.9
        }
        Roof::Gable => {
            solid.gable(Vec3::new(-x, top, -z), Vec3::new(x, top + rise, z));
            rise
        }
        Roof::Hip => {
            let (cut, rise) = (x.min(z) * 0.62, rise.min(3.2));
            solid.loft(&outline(x, z), top, &outline(x - cut, z - cut), top + rise);
            rise
        }
    }
}

/// A low wall around a flat roof.
fn parapet(solid: &mut Solid, body: &Body, height: f32) {
    let (x, z, y) = (body.half_x, body.half_z, body.y1);
    for s in [-1.0f32, 1.0] {
        let (a, b) = (s * x, s * (x - 0.3));
        solid.cuboid(Vec3::new(a.min(b), y, -z), Vec3::new(a.max(b), y + height, z));
        let (a, b) = (s * z, s * (z - 0.3));
        solid.cuboid(Vec3::new(-x + 0.3, y, a.min(b)), Vec3::new(x - 0.3, y + height, a.max(b)));
    }
}

/// Lift houses, tanks and ducts on a flat roof.
fn roof_plant(site: &mut Site, plot: Plot, body: &Body, color: [u8; 3]) {
    let mut solid = Solid::default();
    for _ in 0..site.random.between(3, 6) {
        let mut along = |half: f32| site.random.range(-0.6, 0.6) as f32 * half;
        let (x, z) = (along(body.half_x), along(body.half_z));
        let size = Vec3::new(
            site.random.range(1.0, 3.5) as f32,
            site.random.range(0.8, 2.8) as f32,
            site.random.range(1.0, 3.5) as f32,
        );
        solid.block(x, body.y1, z, size);
    }
    solid.column(8, Vec2::new(body.half_x * 0.4, body.half_z * 0.4), (body.y1, 1.2), (body.y1 + 2.2, 1.2));
    site.reach(body.y1 + 2.8);
    site.place(Rank::Detail, "roof", plot, solid, darker(color));
}

/// A tower on a podium, stepping back two or three times.
pub(super) fn tower(site: &mut Site, plot: Plot) {
    let (floors, color) = (site.floors(), site.tone());
    let storey = site.district.storey;
    let podium = site.body(plot, floors.min(3));
    let steps = site.random.between(2, 3);
    let mut tiers = vec![podium];
    for step in 1..=steps {
        let last = tiers[tiers.len() - 1];
        let shrink = if step == 1 { 2.0 } else { 1.6 };
        let top = if step == steps { floors } else { floors * step / steps + 1 };
        let tier = Body {
            half_x: (last.half_x - shrink).max(3.0),
            half_z: (last.half_z - shrink).max(3.0),
            y0: last.y1,
            y1: (top as f32 * storey).max(last.y1 + storey),
        };
        tiers.push(tier);
    }
    let mut solid = Solid::default();
    for tier in &tiers {
        let foot = if tier.y0 > 0.0 { tier.y0 } else { -0.3 };
        solid.cuboid(Vec3::new(-tier.half_x, foot, -tier.half_z), Vec3::new(tier.half_x, tier.y1, tier.half_z));
    }
    let crown = tiers[tiers.len() - 1];
    parapet(&mut solid, &crown, 1.2);
    solid.block(0.0, crown.y1, 0.0, Vec3::new(crown.half_x, 3.0, crown.half_z));
    if site.random.chance(0.35) {
        solid.column(6, Vec2::ZERO, (crown.y1 + 3.0, 0.35), (crown.y1 + 14.0, 0.0));
        site.reach(crown.y1 + 14.0);
    }
    site.reach(crown.y1 + 3.0);
    site.place(Rank::Must, "tower", plot, solid, color);
    let upright = site.random.chance(0.5);
    for (k, tier) in tiers.iter().enumerate() {
        let mut skin = Solid::default();
        ledges(&mut skin, tier, storey, 1);
        if upright && k > 0 {
            SIDES.iter().for_each(|&side| fins(&mut skin, tier, side, 3.6));
        }
        site.place(Rank::Detail, &format!("skin_{k}"), plot, skin, darker(color));
    }
    let mut lobby = Solid::default();
    SIDES.iter().for_each(|&side| ground_floor(&mut lobby, &podium, side, true));
    site.place(Rank::Detail, "lobby", plot, lobby, darker(color));
    roof_plant(site, plot, &crown, color);
}

/// A round tower with a ring at every storey.
pub(super) fn round_tower(site: &mut Site, plot: Plot) {
    let (floors, color) = (site.floors(), site.tone());
    let (storey, radius) = (site.district.storey, (plot.size().min_element() * 0.5) as f32);
    let sides = site.random.between(10, 14);
    let top = floors as f32 * storey;
    let mut solid = Solid::default();
    solid.column(sides, Vec2::ZERO, (-0.3, radius), (storey * 1.5, radius));
    solid.column(sides, Vec2::ZERO, (storey * 1.5, radius * 0.86), (top, radius * 0.86));
    solid.column(sides, Vec2::ZERO, (top, radius * 0.6), (top + 2.5, radius * 0.5));
    site.reach(top + 2.5);
    site.place(Rank::Must, "tower", plot, solid, color);
    for (k, floors) in (2..floors).collect::<Vec<_>>().chunks(6).enumerate() {
        let mut rings = Solid::default();
        for &floor in floors {
            let y = floor as f32 * storey;
            rings.column(sides, Vec2::ZERO, (y - 0.15, radius * 0.95), (y + 0.15, radius * 0.95));
        }
        site.place(Rank::Detail, &format!("rings_{k}"), plot, rings, darker(color));
    }
}

/// A long slab: balconies on one side, windows on the other, stairwells on its roof.
pub(super) fn slab(site: &mut Site, plot: Plot) {
    let (floors, color) = (site.floors(), site.tone());
    let body = site.body(plot, floors);
    let mut solid = Solid::default();
    solid.cuboid(Vec3::new(-body.half_x, -0.3, -body.half_z), Vec3::new(body.half_x, body.y1, body.half_z));
    parapet(&mut solid, &body, 0.8);
    for x in [-0.5, 0.5] {
        solid.block(body.half_x * x, body.y1, 0.0, Vec3::new(3.0, 2.6, 4.0));
    }
    site.reach(body.y1 + 2.6);
    site.place(Rank::Must, "slab", plot, solid, color);
    let storey = site.district.storey;
    let mut sunny = Solid::default();
    balconies(&mut sunny, &body, Side::South, storey, 6.5);
    site.place(Rank::Detail, "balconies", plot, sunny, color.map(|c| c.saturating_add(20)));
    let mut shady = Solid::default();
    windows(&mut shady, &body, Side::North, storey, 0, 5.4);
    site.place(Rank::Detail, "windows", plot, shady, darker(color));
    let mut around = Solid::default();
    ledges(&mut around, &body, storey, 1);
    site.place(Rank::Detail, "ledges", plot, around, darker(color));
}

/// A detached house with a gable roof, a porch and a garage.
pub(super) fn villa(site: &mut Site, plot: Plot) {
    let (floors, color) = (site.floors(), site.tone());
    let house = plot.inset(plot.size().min_element() * 0.2);
    let body = site.body(house, floors);
    let mut solid = Solid::default();
    solid.cuboid(Vec3::new(-body.half_x, -0.3, -body.half_z), Vec3::new(body.half_x, body.y1, body.half_z));
    let rise = roof(&mut solid, site.district.roof, &body, 0.9);
    solid.block(body.half_x * 0.5, body.y1, 0.0, Vec3::new(0.7, rise + 0.6, 0.7));
    solid.block(-body.half_x - 1.4, -0.3, 0.0, Vec3::new(2.8, 2.7, 4.6));
    site.reach(body.y1 + rise + 0.6);
    site.place(Rank::Must, "villa", house, solid, color);
    let mut details = Solid::default();
    for side in SIDES {
        windows(&mut details, &body, side, site.district.storey, 0, 3.4);
    }
    body.on_wall(&mut details, Side::South, 0.0, 2.3, Vec3::new(3.0, 0.15, 1.6));
    site.place(Rank::Detail, "details", house, details, darker(color));
}

/// A hall with a sawtooth roof, gates, and a chimney or tanks beside it.
pub(super) fn hall(site: &mut Site, plot: Plot) {
    let (floors, color) = (site.floors(), site.tone());
    let body = site.body(plot, floors);
    let (x, z, top) = (body.half_x, body.half_z, body.y1);
    let mut solid = Solid::default();
    solid.cuboid(Vec3::new(-x, -0.3, -z), Vec3::new(x, top, z));
    let teeth = (x / 3.0) as usize + 1;
    for tooth in 0..teeth {
        let (a, b) = (tooth as f32 / teeth as f32, (tooth as f32 + 0.92) / teeth as f32);
        let (a, b) = ((a * 2.0 - 1.0) * x, (b * 2.0 - 1.0) * x);
        let outline = |right: f32| [Vec2::new(a, -z), Vec2::new(a, z), Vec2::new(right, z), Vec2::new(right, -z)];
        solid.loft(&outline(b), top, &outline(a + 0.4), top + 2.2);
    }
    if site.random.chance(0.5) {
        solid.column(10, Vec2::new(x * 0.7, z * 0.5), (top, 1.1), (top + 16.0, 0.7));
        site.reach(top + 16.0);
    }
    site.reach(top + 2.2);
    site.place(Rank::Must, "hall", plot, solid, color);
    let mut details = Solid::default();
    for side in SIDES {
        let gates = (body.width(side) / 9.0) as usize;
        for gate in 0..gates {
            let u = ((gate as f32 + 0.5) / gates as f32 - 0.5) * body.width(side);
            body.on_wall(&mut details, side, u, 0.0, Vec3::new(3.6, 3.8, 0.12));
            body.on_wall(&mut details, side, u, 4.2, Vec3::new(4.4, 0.15, 1.4));
        }
        body.on_wall(&mut details, side, 0.0, top - 1.6, Vec3::new(body.width(side) * 0.9, 1.0, 0.08));
    }
    site.place(Rank::Detail, "gates", plot, details, darker(color));
}

/// A large building with steps, a row of columns, wings and a dome.
pub(super) fn civic(site: &mut Site, plot: Plot) {
    let (floors, color) = (site.floors(), site.tone());
    let body = site.body(plot.inset(5.0), floors);
    let (x, z, top) = (body.half_x, body.half_z, body.y1);
    let mut solid = Solid::default();
    solid.cuboid(Vec3::new(-x, -0.3, -z), Vec3::new(x, top, z));
    let rise = roof(&mut solid, Roof::Hip, &body, 0.8);
    let drum = x.min(z) * 0.36;
    solid.column(16, Vec2::ZERO, (top, drum), (top + rise + 4.0, drum));
    for (k, (low, high)) in [(1.0, 0.86), (0.86, 0.55), (0.55, 0.0)].into_iter().enumerate() {
        let y = top + rise + 4.0 + k as f32 * drum * 0.33;
        solid.column(16, Vec2::ZERO, (y, drum * low), (y + drum * 0.33, drum * high));
    }
    site.reach(top + rise + 4.0 + drum);
    site.place(Rank::Must, "hall", plot, solid, color);
    for side in SIDES {
        let mut row = Solid::default();
        let count = (body.width(side) / 4.5) as usize;
        for k in 0..3 {
            body.on_wall(&mut row, side, 0.0, k as f32 * 0.2, Vec3::new(body.width(side), 0.2, 3.4 - k as f32 * 0.4));
        }
        for k in 0..=count {
            let u = (k as f32 / count.max(1) as f32 - 0.5) * (body.width(side) - 1.2);
            let at = match side {
                Side::West => Vec2::new(-x - 2.0, u),
                Side::East => Vec2::new(x + 2.0, u),
                Side::North => Vec2::new(u, -z - 2.0),
                Side::South => Vec2::new(u, z + 2.0),
            };
            row.column(8, at, (0.6, 0.5), (top - 1.2, 0.42));
        }
        body.on_wall(&mut row, side, 0.0, top - 1.2, Vec3::new(body.width(side) + 1.0, 1.2, 2.8));
        site.place(Rank::Detail, &format!("columns_{side:?}").to_lowercase(), plot, row, color);
        let mut panes = Solid::default();
        windows(&mut panes, &body, side, site.district.storey, 0, 4.5);
        site.place(Rank::Detail, &format!("windows_{side:?}").to_lowercase(), plot, panes, darker(color));
    }
}
