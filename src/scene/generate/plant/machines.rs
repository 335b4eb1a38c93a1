//! Machines on the decks, in the middles of bays: pumps, exchangers, vessels, fans, cabinets, each with its own piping.

use glam::{DVec3, Mat3, Vec2, Vec3};

use super::super::piping::{bolts, flange, ladder, pipe, rail, rod, valve, vessel};
use super::super::solid::{Solid, upright_to};
use super::super::stock::{Rank, Stock};
use super::plan::{BAY, Deck, Room, Use};
use super::site::{HALF, QUARTER, Site, THREE_QUARTERS};

const WHEEL: [u8; 3] = [176, 40, 36];
const TONES: [[u8; 3]; 6] =
    [[84, 122, 148], [96, 136, 108], [186, 188, 186], [150, 142, 124], [170, 104, 66], [126, 130, 136]];
/// Height of the pipes that leave machines upward, under the lowest runs.
const CONNECT: f32 = 2.4;

/// Shapes of machines: what is painted, and the handwheels.
pub(super) struct Machines {
    kinds: Vec<(&'static str, u32, Option<u32>)>,
    cabinets: u32,
    drums: u32,
}

impl Machines {
    pub fn new(stock: &mut Stock) -> Machines {
        let mut kinds = Vec::new();
        let made: [(&str, (Solid, Solid)); 6] = [
            ("pump", pumps(0.28)),
            ("pump", pumps(0.36)),
            ("exchanger", exchanger()),
            ("vessel", upright_vessel()),
            ("fan", fan()),
            ("manifold", manifold()),
        ];
        for (name, (body, wheels)) in made {
            let wheels = (wheels.len() > 0).then(|| stock.shape(wheels));
            kinds.push((name, stock.shape(body), wheels));
        }
        Machines { kinds, cabinets: stock.shape(cabinets()), drums: stock.shape(drums()) }
    }
}

/// A motor along x with ribs, its feet on 0 and its shaft at `height`.
fn motor(solid: &mut Solid, at: Vec3, radius: f32, length: f32) {
    let mut body = Solid::default();
    body.lathe(16, &[(radius * 0.5, 0.0), (radius, 0.06), (radius, length - 0.1), (radius * 0.7, length)]);
    for k in 0..9 {
        let y = length * (0.15 + 0.08 * k as f32);
        body.column(16, Vec2::ZERO, (y, radius * 1.1), (y + 0.012, radius * 1.1));
    }
    solid.join(&body, upright_to(Vec3::X), at);
    solid.block(at.x + length * 0.5, 0.0, at.z, Vec3::new(length * 0.7, at.y - radius * 0.7, radius * 1.5));
    solid.block(at.x + length * 0.5, at.y + radius * 0.9, at.z, Vec3::new(0.25, 0.2, 0.22));
}

/// Two pumps with their motors on a base, suction and delivery up to the runs, with valves.
fn pumps(radius: f32) -> (Solid, Solid) {
    let (mut solid, mut wheels) = (Solid::default(), Solid::default());
    solid.block(0.0, 0.0, 0.0, Vec3::new(2.8, 0.18, 2.6));
    for z in [-0.65f32, 0.65] {
        let height = 0.25 + radius * 1.4;
        motor(&mut solid, Vec3::new(0.1, height, z), radius, 1.1);
        rod(&mut solid, 10, 0.05, Vec3::new(-0.4, height, z), Vec3::new(0.15, height, z));
        let mut casing = Solid::default();
        casing.lathe(18, &[(radius * 0.5, 0.0), (radius * 1.2, 0.08), (radius * 1.25, 0.2), (radius * 0.5, 0.34)]);
        bolts(&mut casing, 10, radius * 1.1, 0.022, (0.04, 0.3));
        solid.join(&casing, upright_to(Vec3::NEG_X), Vec3::new(-0.4, height, z));
        solid.block(-0.55, 0.15, z, Vec3::new(0.3, height - 0.25, radius * 1.2));
        let thick = radius * 0.38;
        let delivery = [Vec3::new(-0.58, height, z), Vec3::new(-0.58, CONNECT, z)];
        pipe(&mut solid, 12, thick, &delivery, (0.0, 1));
        let out = Vec3::new(-1.25, height, z);
        pipe(&mut solid, 12, thick, &[Vec3::new(-0.7, height, z), out, Vec3::new(-1.25, CONNECT, z)], (thick * 3.0, 5));
        for (at, y) in [(Vec3::new(-0.58, 0.0, z), 1.55), (Vec3::new(-1.25, 0.0, z), 1.5)] {
            let [body, wheel] = valve(thick);
            let turn = Mat3::from_cols(Vec3::Y, Vec3::NEG_X, Vec3::Z);
            solid.join(&body, turn, at + Vec3::Y * y);
            wheels.join(&wheel, turn, at + Vec3::Y * y);
            solid.join(&flange(14, thick, 8), Mat3::IDENTITY, at + Vec3::Y * 2.2);
        }
    }
    (solid, wheels)
}

/// Two shells over each other on saddles, with nozzles.
fn exchanger() -> (Solid, Solid) {
    let (mut solid, mut wheels) = (Solid::default(), Solid::default());
    for (y, radius) in [(0.62f32, 0.36), (1.6, 0.36)] {
        let mut shell = Solid::default();
        vessel(&mut shell, 18, radius, 2.8);
        for (k, at) in [0.35f32, 0.45, 2.3, 2.4].into_iter().enumerate() {
            shell.column(20, Vec2::ZERO, (at, radius * 1.22), (at + 0.05, radius * 1.22));
            if k % 2 == 1 {
                bolts(&mut shell, 16, radius * 1.13, 0.02, (at - 0.14, at + 0.09));
            }
        }
        solid.join(&shell, upright_to(Vec3::X), Vec3::new(-1.4, y, 0.0));
        for x in [-0.7, 0.6] {
            solid.block(x, y - 0.62, 0.0, Vec3::new(0.16, 0.5, 0.6));
            let nozzle = Vec3::new(x + 0.2, y, 0.0);
            rod(&mut solid, 10, 0.09, nozzle, nozzle + Vec3::Y * 0.5);
        }
    }
    for (x, z) in [(-1.0f32, 0.0f32), (1.15, 0.0)] {
        let from = Vec3::new(x, 1.6, z);
        let points = [from, from + Vec3::Z * 0.75, Vec3::new(x, CONNECT, 0.75)];
        pipe(&mut solid, 12, 0.09, &points, (0.25, 5));
        let [body, wheel] = valve(0.09);
        let turn = Mat3::from_cols(Vec3::Y, Vec3::Z, Vec3::X);
        solid.join(&body, turn, Vec3::new(x, 2.1, 0.75));
        wheels.join(&wheel, turn, Vec3::new(x, 2.1, 0.75));
    }
    (solid, wheels)
}

/// An upright vessel on legs with a ladder, a manhole and gauges.
fn upright_vessel() -> (Solid, Solid) {
    let mut solid = Solid::default();
    let mut body = Solid::default();
    vessel(&mut body, 22, 0.85, 2.0);
    for y in [0.6, 1.4] {
        body.column(22, Vec2::ZERO, (y, 0.87), (y + 0.05, 0.87));
    }
    solid.join(&body, Mat3::IDENTITY, Vec3::Y * 0.35);
    for (x, z) in [(-0.6, -0.6), (0.6, -0.6), (-0.6, 0.6), (0.6, 0.6)] {
        solid.block(x, 0.0, z, Vec3::new(0.14, 0.9, 0.14));
        solid.block(x, 0.0, z, Vec3::new(0.3, 0.03, 0.3));
    }
    let mut manhole = flange(18, 0.24, 12);
    manhole.column(18, Vec2::ZERO, (-0.4, 0.24), (0.0, 0.24));
    solid.join(&manhole, upright_to(Vec3::X), Vec3::new(1.1, 1.3, 0.0));
    ladder(&mut solid, Vec3::new(0.0, 0.0, 1.05), 2.3, Vec3::Z);
    for k in 0..3 {
        let at = Vec3::new(-1.15, 0.7 + 0.4 * k as f32, 0.4 - 0.4 * k as f32);
        pipe(&mut solid, 10, 0.05, &[at + Vec3::X * 0.5, at, Vec3::new(at.x, CONNECT, at.z)], (0.15, 4));
        solid.join(&flange(12, 0.05, 6), Mat3::IDENTITY, at + Vec3::Y * 0.5);
    }
    (solid, Solid::default())
}

/// A fan with its scroll, motor and an inlet duct.
fn fan() -> (Solid, Solid) {
    let mut solid = Solid::default();
    solid.block(0.0, 0.0, 0.0, Vec3::new(2.8, 0.2, 2.2));
    let mut scroll = Solid::default();
    scroll.column(28, Vec2::ZERO, (-0.35, 0.85), (0.35, 0.85));
    for y in [-0.38, 0.33] {
        scroll.column(28, Vec2::ZERO, (y, 0.9), (y + 0.05, 0.9));
    }
    scroll.lathe(20, &[(0.42, 0.35), (0.5, 0.6), (0.62, 0.7)]);
    bolts(&mut scroll, 20, 0.87, 0.02, (-0.41, 0.41));
    solid.join(&scroll, upright_to(Vec3::NEG_X), Vec3::new(-0.4, 1.15, 0.0));
    solid.cuboid(Vec3::new(-0.75, 1.15, 0.2), Vec3::new(-0.05, CONNECT, 0.85));
    for y in [1.9, 2.2] {
        solid.cuboid(Vec3::new(-0.8, y, 0.15), Vec3::new(0.0, y + 0.05, 0.9));
    }
    motor(&mut solid, Vec3::new(0.35, 1.15, 0.0), 0.36, 1.0);
    rail(&mut solid, Vec3::new(-1.3, 0.2, 1.05), Vec3::new(1.3, 0.2, 1.05));
    (solid, Solid::default())
}

/// A header with branches side by side, each with its valve.
fn manifold() -> (Solid, Solid) {
    let (mut solid, mut wheels) = (Solid::default(), Solid::default());
    for (y, radius) in [(0.5f32, 0.14), (2.0, 0.11)] {
        let mut header = Solid::default();
        vessel(&mut header, 14, radius, 2.8);
        solid.join(&header, upright_to(Vec3::X), Vec3::new(-1.4, y, 0.0));
    }
    for k in 0..5 {
        let x = -1.1 + 0.55 * k as f32;
        rod(&mut solid, 10, 0.055, Vec3::new(x, 0.5, 0.0), Vec3::new(x, 2.0, 0.0));
        let [body, wheel] = valve(0.055);
        let turn = Mat3::from_cols(Vec3::Y, Vec3::Z, Vec3::X);
        solid.join(&body, turn, Vec3::new(x, 1.25, 0.0));
        wheels.join(&wheel, turn, Vec3::new(x, 1.25, 0.0));
    }
    for x in [-1.2, 1.2] {
        solid.block(x, 0.0, -0.25, Vec3::new(0.1, 2.2, 0.1));
        solid.block(x, 0.3, -0.1, Vec3::new(0.08, 0.08, 0.4));
        solid.block(x, 1.85, -0.1, Vec3::new(0.08, 0.08, 0.4));
    }
    (solid, wheels)
}

/// A row of cabinets with doors, handles and lamps.
fn cabinets() -> Solid {
    let mut solid = Solid::default();
    for k in 0..3 {
        let x = -1.0 + k as f32;
        solid.block(x, 0.0, 0.0, Vec3::new(0.96, 2.1, 0.7));
        solid.block(x, 0.12, 0.36, Vec3::new(0.86, 1.9, 0.03));
        solid.block(x + 0.36, 1.0, 0.39, Vec3::new(0.04, 0.2, 0.05));
        for j in 0..5 {
            solid.block(x, 1.85 + 0.025 * j as f32, 0.38, Vec3::new(0.5, 0.01, 0.03));
        }
    }
    solid
}

/// A few drums and a crate.
fn drums() -> Solid {
    let mut solid = Solid::default();
    for (x, z) in [(-0.5, -0.3), (0.15, -0.4), (-0.2, 0.35)] {
        solid.lathe(14, &[(0.28, 0.0), (0.3, 0.03), (0.28, 0.28), (0.3, 0.3), (0.28, 0.32), (0.3, 0.87), (0.28, 0.9)]);
        let last = std::mem::take(&mut solid);
        solid.join(&last, Mat3::IDENTITY, Vec3::new(-x, 0.0, -z));
    }
    solid.block(0.9, 0.0, 0.2, Vec3::new(0.8, 0.7, 1.1));
    solid
}

/// Machines on the decks of a unit.
pub(super) fn machines(site: &mut Site) {
    let plan = site.plan;
    for floor in 0..plan.floors {
        for j in 0..plan.bays_z {
            for i in 0..plan.bays_x {
                let stands = match (plan.use_of(i, j), floor) {
                    (Use::Floors, 0) => true,
                    (Use::Floors, _) => match plan.deck(i, j, floor) {
                        Deck::Plate => true,
                        Deck::Grating => plan.has_firm_gratings(),
                        Deck::Open => false,
                    },
                    _ => false,
                };
                let corner = DVec3::new(plan.line_x(i), plan.level(floor), plan.line_z(j));
                let at = corner + DVec3::new(BAY * 0.5, 0.0, BAY * 0.5);
                let reach = DVec3::new(1.45, 0.0, 1.45);
                let room = Room { min: at - reach, max: at + reach + DVec3::Y * 2.4 };
                if stands && site.random.chance(0.9) && site.is_free(&room) {
                    machine(site, at);
                }
            }
        }
    }
}

fn machine(site: &mut Site, at: DVec3) {
    let turn = [Mat3::IDENTITY, QUARTER, HALF, THREE_QUARTERS][site.random.below(4)];
    let tone = TONES[site.random.below(TONES.len())];
    let color = site.worn(tone);
    let shapes = &site.shapes.machines;
    let kinds = shapes.kinds.len();
    let (cabinets, drums) = (shapes.cabinets, shapes.drums);
    match site.random.below(kinds + 3) {
        k if k < kinds => {
            let (name, body, wheels) = site.shapes.machines.kinds[k];
            site.begin();
            site.put(Rank::Fill, name, body, at, turn, color);
            if let Some(wheels) = wheels {
                site.put(Rank::Fill, "wheel", wheels, at, turn, WHEEL);
            }
            site.end();
        }
        k if k == kinds => site.put(Rank::Fill, "drums", drums, at, turn, [64, 96, 150]),
        _ => site.put(Rank::Fill, "cabinets", cabinets, at, turn, [178, 184, 180]),
    }
}
