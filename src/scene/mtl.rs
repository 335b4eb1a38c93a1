//! Material libraries (MTL): as much as a culler needs, the diffuse colour and the opacity.
//!
//! tobj's own reader panics on `Kd 0.5`, so this one is ours. Every statement that says nothing about colour or opacity is
//! passed over.

use std::collections::HashMap;
use std::path::Path;

use crate::error::{Error, Result};

/// What a material says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Material {
    /// `Kd`, taken as sRGB; `None` where the file gives no colour as numbers.
    pub color: Option<[u8; 3]>,
    /// `d`, or 1 less `Tr`, the least of them, at least 0; 0 where a `map_d` or a halo says that it varies.
    pub opacity: f32,
}

impl Default for Material {
    fn default() -> Self {
        Material { color: None, opacity: 1.0 }
    }
}

/// Reads a library into `materials`; of several materials of one name the first counts.
///
/// # Errors
/// [`Error::File`] when it cannot be read, [`Error::Format`] with the line of a malformed number or a nameless material.
pub(crate) fn load(path: &Path, materials: &mut HashMap<String, Material>) -> Result<()> {
    let bytes = std::fs::read(path).map_err(|e| Error::file(path, e))?;
    let text = String::from_utf8_lossy(&bytes);
    let mut current: Option<(String, Material)> = None;
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let fail = |reason: String| Error::Format { path: path.into(), line: Some(index + 1), reason };
        if word == "newmtl" {
            keep(materials, current.take());
            if rest.trim().is_empty() {
                return Err(fail("newmtl without a name".into()));
            }
            current = Some((rest.trim().to_owned(), Material::default()));
        } else if let Some((_, material)) = &mut current {
            statement(material, word, rest).map_err(fail)?;
        }
    }
    keep(materials, current);
    Ok(())
}

impl Material {
    /// Of several statements the one that lets most through counts.
    fn let_through(&mut self, opacity: f32) {
        self.opacity = self.opacity.min(opacity).max(0.0);
    }
}

fn keep(materials: &mut HashMap<String, Material>, material: Option<(String, Material)>) {
    if let Some((name, material)) = material {
        materials.entry(name).or_insert(material);
    }
}

fn statement(material: &mut Material, word: &str, rest: &str) -> std::result::Result<(), String> {
    let rest = rest.split('#').next().unwrap_or_default();
    let mut words = rest.split_whitespace();
    match word {
        "Kd" => {
            // `Kd spectral FILE` and `Kd xyz X Y Z` are colours that we cannot name.
            if matches!(words.clone().next(), Some("spectral" | "xyz")) {
                return Ok(());
            }
            let numbers = words.map(number).collect::<std::result::Result<Vec<f32>, String>>()?;
            let rgb = match *numbers {
                [r] => [r; 3],
                [r, g, b] => [r, g, b],
                _ => return Err(format!("Kd takes one number or three, not {}", numbers.len())),
            };
            material.color = Some(rgb.map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8));
        }
        "d" => {
            let halo = words.clone().next() == Some("-halo");
            let opacity = number(words.nth(usize::from(halo)).unwrap_or_default())?;
            material.let_through(if halo { 0.0 } else { opacity });
        }
        "Tr" => material.let_through(1.0 - number(words.next().unwrap_or_default())?),
        "map_d" => material.let_through(0.0),
        _ => {}
    }
    Ok(())
}

fn number(word: &str) -> std::result::Result<f32, String> {
    let number = word.parse().ok().filter(|n: &f32| n.is_finite());
    number.ok_or_else(|| format!("'{}' is not a finite number", word.escape_debug()))
}
