//! Meeting a number of triangles: a generator offers more pieces than it may use, the stock picks whole ones.
//!
//! What must be there comes first, then details and fillings in a shuffled order, so that what is left out is missing
//! evenly. The last object is built to fit: closed solids have an even number of triangles, so every even target is met
//! exactly and an odd one by one less.

use std::ops::Range;

use glam::{DVec3, Mat3, Vec2, Vec3};

use super::super::random::Random;
use super::super::{Facing, Mesh, Object, Scene};
use super::solid::{Solid, circle};

/// How much a piece is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rank {
    /// The scene is not itself without it.
    Must,
    /// Fine detail of something that must be there.
    Detail,
    /// Furniture, plants: any number will do.
    Fill,
}

/// Triangles of a detail, at most: fronts of large buildings are culled in parts.
const DETAIL: usize = 240;

/// Objects that are taken together or not at all.
struct Piece {
    rank: Rank,
    objects: Range<usize>,
}

/// The object of an even number of triangles that makes up the count: a cone of any number of sides.
pub(super) struct Spare {
    pub name: &'static str,
    pub position: DVec3,
    /// Metres.
    pub radius: f32,
    /// Metres.
    pub height: f32,
    pub color: [u8; 3],
}

/// Meshes, and the pieces made of them.
#[derive(Default)]
pub(super) struct Stock {
    meshes: Vec<Mesh>,
    objects: Vec<Object>,
    pieces: Vec<Piece>,
    triangles: u64,
}

impl Stock {
    /// A shape to place any number of times.
    pub fn shape(&mut self, solid: Solid) -> u32 {
        self.meshes.push(solid.mesh());
        self.meshes.len() as u32 - 1
    }

    /// Places a shape, or offers to.
    pub fn place(&mut self, rank: Rank, name: String, mesh: u32, position: DVec3, color: [u8; 3]) {
        self.place_turned(rank, name, mesh, Mat3::IDENTITY, position, color);
    }

    /// Places a shape turned by a rotation, or offers to.
    pub fn place_turned(&mut self, rank: Rank, name: String, mesh: u32, turn: Mat3, position: DVec3, color: [u8; 3]) {
        let at = self.objects.len();
        self.pieces.push(Piece { rank, objects: at..at });
        self.attach(name, mesh, turn, position, color);
    }

    /// Places a shape that comes and goes with the piece placed last.
    pub fn attach(&mut self, name: String, mesh: u32, rotation: Mat3, position: DVec3, color: [u8; 3]) {
        self.triangles += self.meshes[mesh as usize].triangles().len() as u64;
        self.objects.push(Object { name, mesh, rotation, position, facing: Facing::Front, color, opacity: 1.0 });
        if let Some(piece) = self.pieces.last_mut() {
            piece.objects.end = self.objects.len();
        }
    }

    /// Places a shape that is used once; nothing for an empty one. Details of more than [`DETAIL`] triangles become several
    /// objects, `name_0` and so on.
    pub fn place_new(&mut self, rank: Rank, name: String, solid: Solid, position: DVec3, color: [u8; 3]) {
        if rank == Rank::Detail && solid.len() > DETAIL {
            for (k, part) in solid.split(DETAIL).into_iter().enumerate() {
                let mesh = self.shape(part);
                self.place(rank, format!("{name}_{k}"), mesh, position, color);
            }
        } else if solid.len() > 0 {
            let mesh = self.shape(solid);
            self.place(rank, name, mesh, position, color);
        }
    }

    /// Triangles of all that is on offer.
    pub fn triangles(&self) -> u64 {
        self.triangles
    }

    /// Triangles of the pieces that must be there.
    pub fn must(&self) -> u64 {
        let musts = self.pieces.iter().filter(|p| p.rank == Rank::Must);
        musts.map(|p| self.size(p)).sum()
    }

    /// The scene of `triangles`, with the object that makes up the count.
    pub fn settle(self, name: &str, triangles: u64, seed: u64, spare: &Spare) -> Scene {
        let mut random = Random::keyed(seed, 0x5707);
        let mut left = triangles - triangles % 2;
        let mut chosen = vec![false; self.pieces.len()];
        self.choose(Rank::Must, 0, &mut left, &mut chosen, None);
        // A quarter of the rest is for fillings, so that streets are not bare where walls are rich.
        self.choose(Rank::Detail, left / 4, &mut left, &mut chosen, Some(&mut random));
        self.choose(Rank::Fill, 0, &mut left, &mut chosen, Some(&mut random));
        self.choose(Rank::Detail, 0, &mut left, &mut chosen, Some(&mut random));
        self.collect(name, &chosen, left, spare)
    }

    fn size(&self, piece: &Piece) -> u64 {
        let objects = self.objects[piece.objects.clone()].iter();
        objects.map(|object| self.meshes[object.mesh as usize].triangles().len() as u64).sum()
    }

    fn choose(&self, rank: Rank, keep: u64, left: &mut u64, chosen: &mut [bool], random: Option<&mut Random>) {
        let mut order: Vec<usize> = (0..self.pieces.len()).filter(|&i| self.pieces[i].rank == rank).collect();
        if let Some(random) = random {
            random.shuffle(&mut order);
        }
        for i in order {
            let size = self.size(&self.pieces[i]);
            if !chosen[i] && size + keep <= *left {
                chosen[i] = true;
                *left -= size;
            }
        }
    }

    fn collect(self, name: &str, chosen: &[bool], left: u64, spare: &Spare) -> Scene {
        let mut scene = Scene { name: name.into(), ..Scene::default() };
        let mut meshes: Vec<Option<Mesh>> = self.meshes.into_iter().map(Some).collect();
        let mut places = vec![0; meshes.len()];
        let taken =
            self.pieces.iter().zip(chosen).flat_map(|(piece, &chosen)| piece.objects.clone().map(move |_| chosen));
        for (mut object, _) in self.objects.into_iter().zip(taken).filter(|(_, taken)| *taken) {
            let old = object.mesh as usize;
            if let Some(mesh) = meshes[old].take() {
                places[old] = scene.meshes.len() as u32;
                scene.meshes.push(mesh);
            }
            object.mesh = places[old];
            scene.objects.push(object);
        }
        if let Some(solid) = spare.exactly(left) {
            let mesh = scene.meshes.len() as u32;
            scene.meshes.push(solid.mesh());
            let (name, position, color) = (spare.name.into(), spare.position, spare.color);
            let (rotation, facing) = (Mat3::IDENTITY, Facing::Front);
            scene.objects.push(Object { name, mesh, rotation, position, facing, color, opacity: 1.0 });
        }
        scene
    }
}

impl Spare {
    /// A monument in the open.
    pub fn obelisk(position: DVec3) -> Spare {
        Spare { name: "monument", position, radius: 0.6, height: 4.0, color: [186, 172, 148] }
    }

    /// A cone of so many triangles, an even number: a spire of n sides has 2n - 2; two triangles are a plate.
    fn exactly(&self, triangles: u64) -> Option<Solid> {
        let mut solid = Solid::default();
        match triangles {
            0 | 1 => return None,
            2 => solid.patch(Vec2::splat(-0.5), Vec2::splat(0.5), 0.02),
            n => solid.spire(&circle(n as usize / 2 + 1, Vec2::ZERO, self.radius), 0.0, Vec3::Y * self.height),
        };
        Some(solid)
    }
}
