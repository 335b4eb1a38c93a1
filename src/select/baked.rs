//! Baked visibility (Zhang 1998, 7.5): what is visible from the points of a grid, by area, as `homcull bake` found it.
//!
//! At run time the eye is snapped onto the nearest point within reach, and the objects seen from there are the candidates, the
//! largest first; elsewhere the distance decides. A bake only chooses occluders: a wrong one costs culling, never correctness.
//!
//! **The file**, little-endian: the magic `HOMBAKE\n`; u32 version (1), u32 objects; u64 hash of the scene; u32 cells along x, y,
//! z, u32 samples along a cube face's side; f64 least corner, greatest corner, near distance. Then a u32 for each point: how
//! many objects it sees, or why it was skipped (0xFFFFFFFF enclosed, 0xFFFFFFFE back sides). Then those objects, point by
//! point: u32 id, u32 samples of the cube; most samples first, ties by id. Last a u64 over all words before it and their
//! number. Every change of a word changes the sum.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use glam::{DVec3, UVec3};

use super::ViewGrid;
use crate::error::{Error, Result};
use crate::hash::Hash;
use crate::scene::PreparedScene;

/// How a bake begins.
pub(crate) const MAGIC: [u8; 8] = *b"HOMBAKE\n";
const VERSION: u32 = 1;
/// Bytes of a header.
pub(crate) const HEADER: usize = 96;

/// What was baked, and how.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BakeHeader {
    /// [`crate::scene::Scene::hash`].
    pub scene: u64,
    /// Objects of the scene.
    pub objects: u32,
    /// The view points.
    pub grid: ViewGrid,
    /// Samples along the side of a cube face.
    pub side: u32,
    /// Near distance of the cube, in metres.
    pub near: f64,
}

/// What there is to see from a view point.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Sight {
    /// Objects and the samples of the cube that show them: most samples first, ties by id.
    Seen(Vec<(u32, u32)>),
    /// Skipped: enclosed by one object alone, as inside a wall.
    Enclosed,
    /// Skipped: mostly sides that are never drawn, as inside a building or below the ground.
    BackSides,
}

pub(crate) const ENCLOSED: u32 = u32::MAX;
pub(crate) const BACK_SIDES: u32 = u32::MAX - 1;

impl BakeHeader {
    /// The header's bytes, under this magic.
    pub(crate) fn encode(&self, magic: [u8; 8]) -> Vec<u8> {
        let (cells, (min, max)) = (self.grid.cells(), self.grid.corners());
        let mut out = magic.to_vec();
        for word in [VERSION, self.objects] {
            out.extend(word.to_le_bytes());
        }
        out.extend(self.scene.to_le_bytes());
        for word in [cells.x, cells.y, cells.z, self.side] {
            out.extend(word.to_le_bytes());
        }
        for v in [min.x, min.y, min.z, max.x, max.y, max.z, self.near] {
            out.extend(v.to_le_bytes());
        }
        debug_assert_eq!(out.len(), HEADER);
        out
    }

    fn decode(bytes: &[u8; HEADER]) -> std::result::Result<BakeHeader, String> {
        let at = Fields(bytes);
        let version = at.u32(8);
        if version != VERSION {
            return Err(format!("has version {version}; this program reads {VERSION}"));
        }
        let cells = UVec3::new(at.u32(24), at.u32(28), at.u32(32));
        let [min, max] = [40, 64].map(|i| DVec3::new(at.f64(i), at.f64(i + 8), at.f64(i + 16)));
        let grid = ViewGrid::new(cells, min, max).map_err(|e| e.to_string())?;
        Ok(BakeHeader { scene: at.u64(16), objects: at.u32(12), grid, side: at.u32(36), near: at.f64(88) })
    }
}

/// Little-endian numbers at places that are there.
struct Fields<'a>(&'a [u8]);

impl Fields<'_> {
    fn bytes<const N: usize>(&self, at: usize) -> [u8; N] {
        let mut out = [0; N];
        out.copy_from_slice(&self.0[at..at + N]);
        out
    }

    fn u32(&self, at: usize) -> u32 {
        u32::from_le_bytes(self.bytes(at))
    }

    fn u64(&self, at: usize) -> u64 {
        u64::from_le_bytes(self.bytes(at))
    }

    fn f64(&self, at: usize) -> f64 {
        f64::from_le_bytes(self.bytes(at))
    }
}

/// The sum of bytes: over their words, the last filled up with zeros, and their number.
pub(crate) fn checksum(bytes: &[u8]) -> u64 {
    let mut hash = Hash::default();
    for chunk in bytes.chunks(8) {
        let mut word = [0; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        hash.add(u64::from_le_bytes(word));
    }
    hash.add(bytes.len() as u64);
    hash.value()
}

/// Writes a bake: the sights of all points, in order.
pub(crate) fn write_bake(out: &mut dyn Write, header: &BakeHeader, sights: &[Sight]) -> io::Result<()> {
    let mut bytes = header.encode(MAGIC);
    for sight in sights {
        let word = match sight {
            Sight::Seen(seen) => seen.len() as u32,
            Sight::Enclosed => ENCLOSED,
            Sight::BackSides => BACK_SIDES,
        };
        bytes.extend(word.to_le_bytes());
    }
    for sight in sights {
        if let Sight::Seen(seen) = sight {
            for &(object, samples) in seen {
                bytes.extend(object.to_le_bytes());
                bytes.extend(samples.to_le_bytes());
            }
        }
    }
    let sum = checksum(&bytes);
    bytes.extend(sum.to_le_bytes());
    out.write_all(&bytes)
}

/// A bake that was read.
#[derive(Debug, Clone, PartialEq)]
pub struct BakedVisibility {
    header: BakeHeader,
    /// The sight of each point: a range of the lists, or why there is none.
    points: Vec<std::result::Result<(usize, usize), u32>>,
    objects: Vec<u32>,
    samples: Vec<u32>,
}

impl BakedVisibility {
    /// Reads a bake of this scene.
    ///
    /// # Errors
    /// [`Error::File`] when it cannot be read; [`Error::Format`] naming the file when it is none, is cut short or longer than it
    /// should be, does not have its sum, or is of another version or scene.
    pub fn load(path: &Path, scene: &PreparedScene) -> Result<BakedVisibility> {
        let bytes = fs::read(path).map_err(|e| Error::file(path, e))?;
        BakedVisibility::decode(&bytes, scene).map_err(|reason| Error::Format { path: path.into(), line: None, reason })
    }

    fn decode(bytes: &[u8], scene: &PreparedScene) -> std::result::Result<BakedVisibility, String> {
        if !bytes.starts_with(&MAGIC) {
            return Err("is no bake of homcull".into());
        }
        // A damaged length asks for more than there is, too.
        let short = || format!("is cut short or damaged: its {} bytes are too few", bytes.len());
        let (header, rest) = bytes.split_first_chunk::<HEADER>().ok_or_else(short)?;
        let header = BakeHeader::decode(header)?;
        let n = header.grid.points();
        let table = rest.get(..4 * n).ok_or_else(short)?;
        let words = |bytes: &[u8]| -> Vec<u32> { bytes.chunks_exact(4).map(|c| Fields(c).u32(0)).collect() };
        let (mut points, mut end) = (Vec::with_capacity(n), 0usize);
        for word in words(table) {
            points.push(match word {
                ENCLOSED | BACK_SIDES => Err(word),
                count => Ok((end, end.saturating_add(count as usize))),
            });
            if let Some(Ok((_, to))) = points.last() {
                end = *to;
            }
        }
        let lists = rest[4 * n..].get(..end.saturating_mul(8)).ok_or_else(short)?;
        let (content, sum) = bytes.split_at(HEADER + 4 * n + lists.len());
        match sum.len() {
            8 => {}
            0..8 => return Err(short()),
            _ => return Err(format!("is {} bytes longer than it should be", sum.len() - 8)),
        }
        if Fields(sum).u64(0) != checksum(content) {
            return Err("is damaged: its sum is wrong".into());
        }
        if (header.scene, header.objects as usize) != (scene.hash, scene.occluders.len()) {
            return Err("was baked from another scene".into());
        }
        let lists = words(lists);
        let of = |part: usize| lists.iter().copied().skip(part).step_by(2).collect::<Vec<u32>>();
        let (objects, samples) = (of(0), of(1));
        match objects.iter().find(|&&id| id >= header.objects) {
            Some(id) => Err(format!("names object {id}, but there are {}", header.objects)),
            None => Ok(BakedVisibility { header, points, objects, samples }),
        }
    }

    /// What was baked, and how.
    pub fn header(&self) -> &BakeHeader {
        &self.header
    }

    /// What is seen from a point of the grid.
    pub fn sight(&self, point: usize) -> Sight {
        match self.points[point] {
            Ok((from, to)) => Sight::Seen(
                self.objects[from..to].iter().copied().zip(self.samples[from..to].iter().copied()).collect(),
            ),
            Err(ENCLOSED) => Sight::Enclosed,
            Err(_) => Sight::BackSides,
        }
    }

    /// The objects seen from a point of the grid, those with most samples first; none from a skipped point.
    pub fn objects(&self, point: usize) -> &[u32] {
        self.points[point].map_or(&[], |(from, to)| &self.objects[from..to])
    }

    /// The point that an eye snaps onto: the nearest that was not skipped, at most `snap` diagonals of a cell away.
    pub fn snap(&self, eye: DVec3, snap: f32) -> Option<usize> {
        self.header.grid.nearest(eye, self.reach(snap), |point| self.points[point].is_ok())
    }

    /// The points [around](ViewGrid::around) an eye that were not skipped, at most `snap` diagonals of a cell away.
    pub fn around(&self, eye: DVec3, snap: f32) -> Vec<usize> {
        let (grid, reach) = (&self.header.grid, self.reach(snap));
        let usable = |p: &usize| self.points[*p].is_ok() && grid.point(*p).distance(eye) <= reach;
        grid.around(eye).into_iter().filter(usable).collect()
    }

    fn reach(&self, snap: f32) -> f64 {
        self.header.grid.cell_size().length() * f64::from(snap)
    }
}
