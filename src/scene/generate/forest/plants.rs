//! The plants of the wood: what they are made of, and how they are placed.
//!
//! Boughs of broad leaves are balls of leaves around a limb's end; firs have tiers of drooping branches with leaflets on
//! both sides. Leaves are open, all else is closed solids.

use glam::{DVec3, Mat3, Vec2, Vec3};

use super::super::super::random::Random;
use super::super::solid::{Solid, circle, upright_to};
use super::super::stock::{Rank, Stock};

/// A sort of plant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Oak,
    Fir,
    Sapling,
    Bush,
    Fern,
}

impl Kind {
    const ALL: [Kind; 5] = [Kind::Oak, Kind::Fir, Kind::Sapling, Kind::Bush, Kind::Fern];

    /// Of a hundred plots, those that each kind has, but for ferns.
    const SHARES: [usize; 4] = [24, 16, 28, 32];

    pub fn any(random: &mut Random) -> Kind {
        let mut at = random.below(100);
        for (kind, share) in Kind::ALL.into_iter().zip(Kind::SHARES) {
            if at < share {
                return kind;
            }
            at -= share;
        }
        Kind::Bush
    }

    pub fn low(random: &mut Random) -> Kind {
        if random.chance(0.4) { Kind::Sapling } else { Kind::Bush }
    }

    fn name(self) -> &'static str {
        match self {
            Kind::Oak => "oak",
            Kind::Fir => "fir",
            Kind::Sapling => "sapling",
            Kind::Bush => "bush",
            Kind::Fern => "fern",
        }
    }

    /// Colours of leaves, before they vary.
    fn green(self) -> [u8; 3] {
        match self {
            Kind::Oak => [78, 122, 44],
            Kind::Fir => [40, 82, 52],
            Kind::Sapling => [104, 142, 56],
            Kind::Bush => [66, 106, 50],
            Kind::Fern => [96, 136, 60],
        }
    }
}

/// Shapes that differ, of each kind.
const VARIANTS: usize = 3;

/// One shape of a plant: the mesh of its wood, if it has any, those of its boughs, and their triangles.
struct Shape {
    wood: Option<u32>,
    boughs: Vec<u32>,
    triangles: u64,
}

/// All shapes, by kind.
pub(super) struct Plants {
    shapes: Vec<[Shape; VARIANTS]>,
}

impl Plants {
    pub fn new(stock: &mut Stock, seed: u64) -> Plants {
        let mut shape = |kind: Kind, variant: u64| {
            let mut random = Random::keyed(seed, 0xf0 + variant * 16 + kind as u64);
            let plant = match kind {
                Kind::Oak => oak(&mut random),
                Kind::Fir => fir(&mut random),
                Kind::Sapling => sapling(&mut random),
                Kind::Bush => bush(&mut random),
                Kind::Fern => fern(&mut random),
            };
            let triangles = plant.wood.len() + plant.boughs.iter().map(Solid::len).sum::<usize>();
            let wood = (plant.wood.len() > 0).then(|| stock.shape(plant.wood));
            let boughs = plant.boughs.into_iter().map(|bough| stock.shape(bough)).collect();
            Shape { wood, boughs, triangles: triangles as u64 }
        };
        Plants { shapes: Kind::ALL.map(|kind| [0, 1, 2].map(|variant| shape(kind, variant))).into() }
    }

    /// Triangles of a plot's plant and fern, on the mean.
    pub fn mean(&self) -> f64 {
        let of =
            |kind: Kind| self.shapes[kind as usize].iter().map(|s| s.triangles).sum::<u64>() as f64 / VARIANTS as f64;
        let plants = Kind::ALL.into_iter().zip(Kind::SHARES).map(|(kind, share)| of(kind) * share as f64 / 100.0);
        plants.sum::<f64>() + of(Kind::Fern)
    }

    /// How far a plant of size 1 keeps from the way, in metres.
    pub fn clearance(&self, kind: Kind) -> f64 {
        match kind {
            Kind::Oak => 1.3,
            Kind::Fir => 3.4,
            Kind::Sapling => 2.4,
            Kind::Bush => 2.3,
            Kind::Fern => 1.6,
        }
    }

    /// Offers a plant; its objects are taken together.
    #[allow(clippy::too_many_arguments)] // what, where and how wanted
    pub fn place(
        &self,
        stock: &mut Stock,
        random: &mut Random,
        rank: Rank,
        kind: Kind,
        count: u64,
        position: DVec3,
        turn: Mat3,
    ) {
        let shape = &self.shapes[kind as usize][random.below(VARIANTS)];
        let name = format!("{}_{count}", kind.name());
        let hue = random.range(-14.0, 14.0);
        let bark = 84 + random.below(20) as u8;
        if let Some(wood) = shape.wood {
            let (name, color) = (format!("{name}/wood"), [bark, bark - 16, bark - 34]);
            stock.place_turned(rank, name, wood, turn, position, color);
        }
        for (k, &mesh) in shape.boughs.iter().enumerate() {
            let light = random.range(-12.0, 12.0);
            let [r, g, b] = kind.green().map(f64::from);
            let color = [r + light + hue, g + light, b + light - hue * 0.5].map(|c| c as u8);
            let name = format!("{name}/leaves_{k}");
            if k == 0 && shape.wood.is_none() {
                stock.place_turned(rank, name, mesh, turn, position, color);
            } else {
                stock.attach(name, mesh, turn, position, color);
            }
        }
    }
}

/// A plant in the making, its foot at 0, in metres.
#[derive(Default)]
struct Plant {
    wood: Solid,
    boughs: Vec<Solid>,
}

impl Plant {
    /// A limb to the middle of a ball of leaves, and the ball.
    fn bough(&mut self, random: &mut Random, foot: Vec3, middle: Vec3, radius: f64, leaves: &Leaves) {
        limb(&mut self.wood, foot, middle, radius as f32 * 0.06);
        let mut bough = Solid::default();
        for _ in 0..leaves.number {
            let out = direction(random);
            // Most of them near the surface, where the light is; flatter than a ball.
            let reach = radius * libm::sqrt(random.range(0.15, 1.0));
            let at = middle + out * Vec3::new(1.0, 0.75, 1.0) * reach as f32;
            let along = (direction(random) + out * 0.6 + Vec3::NEG_Y * 0.35).normalize();
            let up = (direction(random) * 0.8 + out * 0.5 + Vec3::Y).normalize();
            leaf(&mut bough, at, along, up, leaves.length * random.range(0.75, 1.25));
        }
        self.boughs.push(bough);
    }
}

/// Leaves of a bough, and their length in metres.
struct Leaves {
    number: usize,
    length: f64,
}

/// A tree of which the eye sees the trunk, and the crown from below: 13 m high.
fn oak(random: &mut Random) -> Plant {
    let mut plant = Plant::default();
    let lean = direction(random) * Vec3::new(0.5, 0.0, 0.5);
    let (foot, fork, top) = (Vec3::NEG_Y * 0.3, Vec3::Y * 4.5 + lean, Vec3::Y * 10.0 + lean * 2.0);
    tube(&mut plant.wood, 9, &[(foot, 0.42), (Vec3::Y * 0.5, 0.3), (fork, 0.24), (top, 0.08)]);
    let leaves = Leaves { number: 150, length: 0.46 };
    let turn = random.range(0.0, TAU);
    for k in 0..9 {
        let rise = k as f64 / 8.0;
        let foot = fork.lerp(top, rise as f32 * 0.9);
        let reach = (3.3 - 2.2 * rise) * random.range(0.8, 1.15);
        // The golden angle from bough to bough.
        let angle = turn + f64::from(k) * 2.4;
        let way = Vec3::new(libm::sin(angle) as f32, 0.0, libm::cos(angle) as f32) * reach as f32;
        let middle = foot + way + Vec3::Y * random.range(0.8, 2.2) as f32;
        let radius = random.range(1.5, 1.9);
        plant.bough(random, foot, middle, radius, &leaves);
    }
    plant
}

/// A young tree with leaves down to the knee: 5 m high.
fn sapling(random: &mut Random) -> Plant {
    let mut plant = Plant::default();
    let top = Vec3::Y * 4.2 + direction(random) * 0.3;
    tube(&mut plant.wood, 6, &[(Vec3::NEG_Y * 0.2, 0.07), (top, 0.02)]);
    let leaves = Leaves { number: 110, length: 0.27 };
    for k in 0..5 {
        let foot = top * (0.2 + 0.18 * k as f32);
        let angle = f64::from(k) * 2.4 + random.range(0.0, 0.8);
        let reach = 0.75 - 0.12 * f64::from(k);
        let way = Vec3::new(libm::sin(angle) as f32, 0.5, libm::cos(angle) as f32) * reach as f32;
        let radius = random.range(0.7, 0.95);
        plant.bough(random, foot, foot + way, radius, &leaves);
    }
    plant
}

/// Leaves from the ground to above a person's head, for the most part.
fn bush(random: &mut Random) -> Plant {
    let mut plant = Plant::default();
    let leaves = Leaves { number: 120, length: 0.24 };
    for k in 0..3 {
        let angle = f64::from(k) * 2.1 + random.range(0.0, 0.6);
        let way = Vec3::new(libm::sin(angle) as f32, 0.0, libm::cos(angle) as f32) * 0.55;
        let middle = way + Vec3::Y * random.range(0.65, 1.35) as f32;
        let radius = random.range(0.75, 0.95);
        plant.bough(random, Vec3::NEG_Y * 0.1, middle, radius, &leaves);
    }
    plant
}

/// Tiers of branches from the ground up: 10 m high, three tiers an object.
fn fir(random: &mut Random) -> Plant {
    let mut plant = Plant::default();
    let top = Vec3::Y * 10.0;
    tube(&mut plant.wood, 7, &[(Vec3::NEG_Y * 0.3, 0.2), (top, 0.02)]);
    for part in 0..4 {
        let mut bough = Solid::default();
        for tier in part * 3..part * 3 + 3 {
            let rise = f64::from(tier) / 12.0;
            let (reach, y) = (2.3 * (1.0 - rise) + 0.25, 0.5 + 9.2 * rise);
            let branches = 13 - tier / 2;
            let turn = random.range(0.0, TAU);
            for k in 0..branches {
                let angle = turn + TAU * f64::from(k) / f64::from(branches) + random.range(-0.15, 0.15);
                let out = Vec3::new(libm::sin(angle) as f32, -0.32, libm::cos(angle) as f32);
                let reach = reach * random.range(0.85, 1.1);
                let leaflets = 2 + (reach * 2.6) as usize;
                for n in 0..leaflets {
                    let at = Vec3::Y * y as f32 + out * (reach * (n as f64 + 0.3) / leaflets as f64) as f32;
                    let side = Vec3::new(out.z, 0.0, -out.x) * if n % 2 == 0 { 0.55 } else { -0.55 };
                    let along = (out + side).normalize();
                    leaf(&mut bough, at, along, Vec3::Y + direction(random) * 0.4, random.range(0.6, 0.85));
                }
            }
        }
        plant.boughs.push(bough);
    }
    plant
}

/// Fronds in a ring, knee-high.
fn fern(random: &mut Random) -> Plant {
    let mut fronds = Solid::default();
    let turn = random.range(0.0, TAU);
    for k in 0..14 {
        let angle = turn + TAU * f64::from(k) / 14.0 + random.range(-0.15, 0.15);
        let out = Vec3::new(libm::sin(angle) as f32, random.range(0.3, 1.1) as f32, libm::cos(angle) as f32);
        leaf(&mut fronds, Vec3::ZERO, out.normalize(), Vec3::Y, random.range(0.5, 0.8));
    }
    Plant { wood: Solid::default(), boughs: vec![fronds] }
}

/// A leaf from `at` along a unit vector: a rhombus 0.6 as wide as long, its halves raised from the midrib towards `up`.
fn leaf(solid: &mut Solid, at: Vec3, along: Vec3, up: Vec3, length: f64) {
    let length = length as f32;
    let side = cross(along, up).normalize_or_zero() * (0.3 * length);
    let lift = up * (0.09 * length);
    let (middle, tip) = (at + along * (0.45 * length) + lift, at + along * length);
    solid.sheet(1, |u, v| match (u, v) {
        (0, 0) => at,
        (0, _) => middle - side,
        (_, 0) => middle + side,
        _ => tip,
    });
}

/// A limb that thins to a third: a tube of four sides.
fn limb(wood: &mut Solid, from: Vec3, to: Vec3, radius: f32) {
    tube(wood, 4, &[(from, radius), (to, radius / 3.0)]);
}

/// A tube of `sides` through points with their radii; its rings are parallel, level where it stands upright.
fn tube(wood: &mut Solid, sides: usize, points: &[(Vec3, f32)]) {
    let (first, last) = (points[0].0, points[points.len() - 1].0);
    let way = (last - first).normalize_or(Vec3::Y);
    let turn = upright_to(if way.y > 0.8 { Vec3::Y } else { way });
    let ring = |&(at, radius): &(Vec3, f32)| {
        circle(sides, Vec2::ZERO, radius).iter().map(|p| turn * Vec3::new(p.x, 0.0, p.y) + at).collect()
    };
    let rings: Vec<Vec<Vec3>> = points.iter().map(ring).collect();
    wood.skin(&rings);
}

const TAU: f64 = std::f64::consts::TAU;

/// A direction, every one as likely as any other.
fn direction(random: &mut Random) -> Vec3 {
    let (y, angle) = (random.range(-1.0, 1.0), random.range(0.0, TAU));
    let r = libm::sqrt(1.0 - y * y);
    Vec3::new((r * libm::sin(angle)) as f32, y as f32, (r * libm::cos(angle)) as f32)
}

fn cross(a: Vec3, b: Vec3) -> Vec3 {
    Vec3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}
