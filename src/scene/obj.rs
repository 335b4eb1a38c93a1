//! Wavefront OBJ models, read by tobj, with its traps mended.
//!
//! `obj_scan` checks the text first and takes out what tobj stumbles over; tobj parses the rest and gives each object its
//! own vertices; polygons are triangulated here (`polygon`), since tobj only makes fans; materials are read by `mtl`.
//! Winding is whatever the source had, so every face is two-sided. 1.7 million triangles take about a second.

use std::collections::HashMap;
use std::io::Read;
use std::path::Path;

use glam::{DVec3, Mat3, Vec3};

use super::model::palette;
use super::mtl::{self, Material};
use super::obj_scan::{Part, Scan, scan};
use super::polygon::triangulate;
use super::{Facing, Mesh, Object, Scene};
use crate::error::{Error, Result};

/// Loads an OBJ with its material libraries. Units are the file's.
///
/// Every `o` statement begins an object, and so does every `g` name within it (named `object/group`); a group that comes
/// back is the same object. An object of several materials becomes one per material, named `object/material`. Faces without a name are of an object named after
/// the file. A `Kd` becomes the object's colour; `d` and `Tr` its
/// [`opacity`](Object::opacity), and a `map_d` makes that 0. Lines, points and curves are left out. A library that is not there leaves its materials
/// without colour; so do unknown names.
///
/// # Errors
/// [`Error::File`] when a file cannot be read. [`Error::Format`] with file and line for what is malformed, not finite or
/// out of range; without a line when the model has no triangles.
pub fn load_obj(path: &Path) -> Result<Scene> {
    let text = std::fs::read(path).map_err(|e| Error::file(path, e))?;
    let scan = scan(path, &text)?;
    drop(text);
    let materials = load_libraries(path, &scan)?;
    let fail = |reason: String| Error::Format { path: path.into(), line: None, reason };
    let models = parse(&scan).map_err(|e| fail(format!("tobj: {e}")))?;
    let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let scene = assemble(stem, &scan, models, &materials)?;
    if scene.objects.is_empty() { Err(fail("has no triangles".into())) } else { Ok(scene) }
}

fn parse(scan: &Scan) -> std::result::Result<Vec<tobj::Model>, tobj::LoadError> {
    let mut text = scan.vertices.as_slice().chain(scan.faces.as_slice());
    // The scanned text names no materials.
    let no_library = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    tobj::load_obj_buf(&mut text, &tobj::LoadOptions::default(), no_library).map(|(models, _)| models)
}

/// Positions and triangles of one part, from however many models tobj made of it.
#[derive(Default)]
struct Pieces {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl Pieces {
    fn add(&mut self, mesh: tobj::Mesh) {
        let first = self.positions.len() as u32;
        self.positions.extend(mesh.positions.chunks_exact(3).map(|p| Vec3::new(p[0], p[1], p[2])));
        let mut face = Vec::new();
        let mut rest = mesh.indices.as_slice();
        let mut arities = mesh.face_arities.iter();
        while !rest.is_empty() {
            // No arities at all means triangles only.
            let arity = arities.next().map_or(3, |&n| n as usize).clamp(1, rest.len());
            let (corners, after) = rest.split_at(arity);
            rest = after;
            face.clear();
            face.extend(corners.iter().map(|&i| first + i));
            triangulate(&self.positions, &face, &mut self.triangles);
        }
    }
}

fn assemble(
    stem: String,
    scan: &Scan,
    models: Vec<tobj::Model>,
    materials: &HashMap<String, Material>,
) -> Result<Scene> {
    let mut parts: Vec<Pieces> = scan.parts.iter().map(|_| Pieces::default()).collect();
    for model in models {
        if let Some(pieces) = model.name.parse::<usize>().ok().and_then(|id| parts.get_mut(id)) {
            pieces.add(model.mesh);
        }
    }
    let mut materials_of: HashMap<(usize, &str), usize> = HashMap::new();
    for part in &scan.parts {
        *materials_of.entry((part.object, &part.name)).or_default() += 1;
    }
    let mut scene = Scene { name: stem, ..Scene::default() };
    for (part, pieces) in scan.parts.iter().zip(parts).filter(|(_, pieces)| !pieces.triangles.is_empty()) {
        let name = object_name(&scene.name, part, scan, materials_of[&(part.object, part.name.as_str())]);
        let id = scene.objects.len();
        let material = part.material.and_then(|m| materials.get(&scan.materials[m])).copied().unwrap_or_default();
        scene.meshes.push(Mesh::new(&name, pieces.positions, pieces.triangles)?);
        scene.objects.push(Object {
            name,
            mesh: id as u32,
            rotation: Mat3::IDENTITY,
            position: DVec3::ZERO,
            facing: Facing::Both,
            color: material.color.unwrap_or_else(|| palette(id as u64)),
            opacity: material.opacity,
        });
    }
    Ok(scene)
}

fn object_name(stem: &str, part: &Part, scan: &Scan, materials: usize) -> String {
    let name = if part.name.is_empty() { stem } else { &part.name };
    match part.material {
        Some(material) if materials > 1 => format!("{name}/{}", scan.materials[material]),
        _ => name.to_owned(),
    }
}

/// Reads what the `mtllib` statements name, beside the OBJ: the whole rest of the line as one name if there is such a
/// file, else word by word.
fn load_libraries(path: &Path, scan: &Scan) -> Result<HashMap<String, Material>> {
    let mut materials = HashMap::new();
    let folder = path.parent().unwrap_or(Path::new(""));
    for line in &scan.libraries {
        let whole = folder.join(line);
        if whole.is_file() {
            mtl::load(&whole, &mut materials)?;
            continue;
        }
        for library in line.split_whitespace().map(|word| folder.join(word)).filter(|file| file.is_file()) {
            mtl::load(&library, &mut materials)?;
        }
    }
    Ok(materials)
}
