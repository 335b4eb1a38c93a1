//! Benchmark scenes: a folder with `scene.bin`, `views.bin` and, for exact answers, `ref_WxH.bin`.
//!
//! All three are little-endian and tightly packed. Counts are believed only as far as the file has bytes for them, so a
//! damaged file costs no memory. Reading costs about 1 ms a megabyte.

use std::path::{Path, PathBuf};

use glam::{DVec3, Mat3, Vec3};

use super::model::palette;
use super::{Facing, Mesh, Object, Scene};
use crate::error::{Error, Result};
use crate::view::MAX_SIDE;

/// A benchmark scene and the views it was measured from.
#[derive(Debug, Clone, PartialEq)]
pub struct Benchmark {
    /// One object a mesh, world-space positions, front faces only; named `object_00000` and so on.
    pub scene: Scene,
    /// Column-major view-projections over world positions, OpenGL clip space.
    pub views: Vec<[f32; 16]>,
    /// Nominal width of the views, in samples.
    pub width: u32,
    /// Nominal height of the views, in samples.
    pub height: u32,
}

/// Exact answers at one resolution, from an independent z-buffer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reference {
    /// Pixels of each object that show, `[view][object]`.
    pub visible_pixels: Vec<u32>,
    /// Pixels that each object covers, hidden or not, `[view][object]`.
    pub covered_pixels: Vec<u32>,
    /// Bit 0: the box meets the frustum; 1: hidden by the ideal rectangle test; 2: hidden by the ideal box test.
    pub flags: Vec<u8>,
    /// How many objects.
    pub objects: usize,
    /// How many views.
    pub views: usize,
}

/// What a [`Reference`] says about one object in one view.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReferenceAnswer {
    /// Pixels that show.
    pub visible_pixels: u32,
    /// Pixels covered, hidden or not.
    pub covered_pixels: u32,
    /// The object's box meets the frustum.
    pub in_frustum: bool,
    /// An ideal test of the box's screen rectangle calls it hidden.
    pub hidden_by_rectangle: bool,
    /// An ideal test of the box's own faces calls it hidden.
    pub hidden_by_box: bool,
}

impl Reference {
    /// The answer about an object in a view; `None` when there is no such object or view.
    pub fn answer(&self, view: usize, object: usize) -> Option<ReferenceAnswer> {
        if view >= self.views || object >= self.objects {
            return None;
        }
        let i = view * self.objects + object;
        let flags = *self.flags.get(i)?;
        Some(ReferenceAnswer {
            visible_pixels: *self.visible_pixels.get(i)?,
            covered_pixels: *self.covered_pixels.get(i)?,
            in_frustum: flags & 1 != 0,
            hidden_by_rectangle: flags & 2 != 0,
            hidden_by_box: flags & 4 != 0,
        })
    }
}

/// Reads `scene.bin` and `views.bin` of a folder.
///
/// # Errors
/// [`Error::File`] when a file cannot be read; [`Error::Format`] naming the file and what is wrong in it: too short, too
/// long, a count beyond the file's size, an index out of range, a number that is not finite.
pub fn load_benchmark(folder: &Path) -> Result<Benchmark> {
    let scene = read_scene(folder)?;
    let mut file = Bytes::open(folder.join("views.bin"))?;
    let count = file.count("views", 64)?;
    let (width, height) = (file.u32("the width")?, file.u32("the height")?);
    if ![width, height].iter().all(|side| (1..=MAX_SIDE).contains(side)) {
        return file.fail(format!("size {width}x{height}: each side must be 1 to {MAX_SIDE}"));
    }
    let mut views = Vec::with_capacity(count.min(file.left() / 64));
    for view in 0..count {
        let mut matrix = [0.0; 16];
        for number in &mut matrix {
            *number = file.f32(|| format!("view {view}"))?;
        }
        views.push(matrix);
    }
    file.end()?;
    Ok(Benchmark { scene, views, width, height })
}

/// Reads `ref_WIDTHxHEIGHT.bin` of a folder; `None` when there is no such file. `objects` and `views` are those of the
/// benchmark, which the file must agree with.
///
/// # Errors
/// [`Error::File`] when the file is there but cannot be read; [`Error::Format`] when it is of another scene or damaged.
pub fn load_reference(
    folder: &Path,
    width: u32,
    height: u32,
    objects: usize,
    views: usize,
) -> Result<Option<Reference>> {
    let path = folder.join(format!("ref_{width}x{height}.bin"));
    if !path.exists() {
        return Ok(None);
    }
    let mut file = Bytes::open(path)?;
    let counts = (file.u32("the number of views")? as usize, file.u32("the number of objects")? as usize);
    if counts != (views, objects) {
        let (v, o) = counts;
        return file.fail(format!("answers {v} views of {o} objects, but the scene has {views} of {objects}"));
    }
    let answers = views as u128 * objects as u128;
    if answers * 9 != file.left() as u128 {
        let left = file.left();
        return file.fail(format!("{views} views of {objects} objects take {} bytes, not {left}", answers * 9));
    }
    let answers = views * objects;
    let visible_pixels = file.u32s(answers, "visible pixels")?;
    let covered_pixels = file.u32s(answers, "covered pixels")?;
    let flags = file.take(answers, "flags")?.to_vec();
    Ok(Some(Reference { visible_pixels, covered_pixels, flags, objects, views }))
}

fn read_scene(folder: &Path) -> Result<Scene> {
    let mut file = Bytes::open(folder.join("scene.bin"))?;
    let count = file.count("objects", 32)?;
    let name = folder.file_name().map_or_else(|| folder.display().to_string(), |n| n.to_string_lossy().into_owned());
    let mut scene = Scene { name, ..Scene::default() };
    for id in 0..count {
        let name = format!("object_{id:05}");
        let mesh = read_mesh(&mut file, &name)?;
        scene.meshes.push(mesh);
        scene.objects.push(Object {
            name,
            mesh: id as u32,
            rotation: Mat3::IDENTITY,
            position: DVec3::ZERO,
            facing: Facing::Front,
            color: palette(id as u64),
            opacity: 1.0,
        });
    }
    file.end()?;
    Ok(scene)
}

fn read_mesh(file: &mut Bytes, name: &str) -> Result<Mesh> {
    let (vertices, triangles) = (file.u32(name)? as usize, file.u32(name)? as usize);
    let positions = file.take(vertices.saturating_mul(12), name)?;
    let positions: Vec<Vec3> = positions.chunks_exact(12).map(vec3).collect();
    let indices = file.take(triangles.saturating_mul(12), name)?;
    let indices = indices.chunks_exact(12).map(|t| [word(&t[..4]), word(&t[4..8]), word(&t[8..])]).collect();
    let corners = file.take(24, name)?;
    let (min, max) = (vec3(&corners[..12]), vec3(&corners[12..]));
    if triangles > 0 && !(min.is_finite() && max.is_finite() && min.cmple(max).all()) {
        return file.fail(format!("{name}: its box from {min} to {max} is none"));
    }
    match Mesh::new(name, positions, indices) {
        Err(Error::Mesh { reason, .. }) => file.fail(format!("{name}: {reason}")),
        other => other,
    }
}

fn word(bytes: &[u8]) -> u32 {
    u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])
}

fn vec3(bytes: &[u8]) -> Vec3 {
    let part = |i: usize| f32::from_bits(word(&bytes[i * 4..]));
    Vec3::new(part(0), part(1), part(2))
}

/// A file in memory that is read from front to back.
struct Bytes {
    path: PathBuf,
    bytes: Vec<u8>,
    at: usize,
}

impl Bytes {
    fn open(path: PathBuf) -> Result<Bytes> {
        let bytes = std::fs::read(&path).map_err(|e| Error::file(&path, e))?;
        Ok(Bytes { path, bytes, at: 0 })
    }

    fn fail<T>(&self, reason: String) -> Result<T> {
        Err(Error::Format { path: self.path.clone(), line: None, reason })
    }

    fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    fn take(&mut self, n: usize, what: &str) -> Result<&[u8]> {
        if n > self.left() {
            let (at, left) = (self.at, self.left());
            return self.fail(format!("ends within {what}: {n} bytes wanted at byte {at}, {left} there"));
        }
        self.at += n;
        Ok(&self.bytes[self.at - n..self.at])
    }

    fn u32(&mut self, what: &str) -> Result<u32> {
        self.take(4, what).map(word)
    }

    fn u32s(&mut self, n: usize, what: &str) -> Result<Vec<u32>> {
        Ok(self.take(n.saturating_mul(4), what)?.chunks_exact(4).map(word).collect())
    }

    /// A count of things of at least `size` bytes each, no more than the rest of the file can hold.
    fn count(&mut self, what: &str, size: usize) -> Result<usize> {
        let count = self.u32(&format!("the number of {what}"))? as usize;
        if count > self.left() / size {
            let left = self.left();
            return self.fail(format!("says {count} {what}, but only {left} bytes follow"));
        }
        Ok(count)
    }

    fn f32(&mut self, what: impl Fn() -> String) -> Result<f32> {
        let number = match self.take(4, "") {
            Ok(bytes) => f32::from_bits(word(bytes)),
            Err(_) => return self.fail(format!("ends within {}", what())),
        };
        if number.is_finite() { Ok(number) } else { self.fail(format!("{}: {number} is not finite", what())) }
    }

    fn end(&self) -> Result<()> {
        match self.left() {
            0 => Ok(()),
            n => self.fail(format!("{n} bytes too many at the end")),
        }
    }
}
