//! Meeting a number of triangles: a generator offers more pieces than it may use, the stock picks whole ones.
//!
//! What must be there comes first, then details and fillings in a shuffled order, so that what is left out is missing
//! evenly. The last object is built to fit: closed solids have an even number of triangles, so every even target is met
//! exactly and an odd one by one less.

use glam::{DVec3, Mat3, Vec2};

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

struct Piece {
    rank: Rank,
    object: Object,
}

/// Meshes, and the pieces made of them.
#[derive(Default)]
pub(super) struct Stock {
    meshes: Vec<Mesh>,
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
        self.triangles += self.meshes[mesh as usize].triangles().len() as u64;
        let (rotation, facing) = (Mat3::IDENTITY, Facing::Front);
        self.pieces
            .push(Piece { rank, object: Object { name, mesh, rotation, position, facing, color, opacity: 1.0 } });
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

    /// The scene of `triangles`, with the object that makes up the count at `spare`.
    pub fn settle(self, name: &str, triangles: u64, seed: u64, spare: DVec3) -> Scene {
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
        self.meshes[piece.object.mesh as usize].triangles().len() as u64
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

    fn collect(self, name: &str, chosen: &[bool], left: u64, spare: DVec3) -> Scene {
        let mut scene = Scene { name: name.into(), ..Scene::default() };
        let mut meshes: Vec<Option<Mesh>> = self.meshes.into_iter().map(Some).collect();
        let mut places = vec![0; meshes.len()];
        for (piece, _) in self.pieces.into_iter().zip(chosen).filter(|(_, chosen)| **chosen) {
            let mut object = piece.object;
            let old = object.mesh as usize;
            if let Some(mesh) = meshes[old].take() {
                places[old] = scene.meshes.len() as u32;
                scene.meshes.push(mesh);
            }
            object.mesh = places[old];
            scene.objects.push(object);
        }
        if let Some(solid) = exactly(left) {
            let mesh = scene.meshes.len() as u32;
            scene.meshes.push(solid.mesh());
            let (rotation, facing, color) = (Mat3::IDENTITY, Facing::Front, [186, 172, 148]);
            let object =
                Object { name: "monument".into(), mesh, rotation, position: spare, facing, color, opacity: 1.0 };
            scene.objects.push(object);
        }
        scene
    }
}

/// An obelisk of so many triangles, an even number: a spire of n sides has 2n - 2; two triangles are a plate.
fn exactly(triangles: u64) -> Option<Solid> {
    let mut solid = Solid::default();
    match triangles {
        0 | 1 => return None,
        2 => solid.patch(Vec2::splat(-0.5), Vec2::splat(0.5), 0.02),
        n => solid.spire(&circle(n as usize / 2 + 1, Vec2::ZERO, 0.6), 0.0, glam::Vec3::Y * 4.0),
    };
    Some(solid)
}
