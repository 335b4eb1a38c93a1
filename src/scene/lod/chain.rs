//! Static levels of detail of a mesh (thesis 7.2, 8.4), for drawing and as occluders: not conservative.
//!
//! Each level has about half the triangles of the one before, simplified by quadric error metrics (crate
//! `meshoptimizer-rs`), small components going altogether as in Erikson and Manocha's. A level's error is the sum of
//! the errors of the steps that led to it, in units of the mesh; which level stands in is decided by that error
//! projected to the screen, in pixels: the *LOD scale*. Made once, the same everywhere. The errors are the simplifier's
//! estimates, not bounds: measured deviations are several times as large, so what such an occluder hides is an error to
//! be measured, never a guarantee. Cost: n log n.

use glam::Vec3;
use meshoptimizer_rs::{Positions, SimplifyOptions, SimplifySettings, Workspace, simplify};

use super::super::Mesh;
use super::parts::weld;
use crate::error::{Error, Result};

/// Levels at most, the mesh itself among them: five, as for the power plant (8.4.3).
const LEVELS: usize = 5;
/// Fewer triangles are not worth another level.
const FEW: usize = 8;
/// A level with more than this share of the last one's triangles is not worth its memory.
const WORTH: f64 = 0.8;

/// A level of detail.
#[derive(Debug, Clone, PartialEq)]
pub struct LodLevel {
    /// The mesh to draw.
    pub mesh: Mesh,
    /// Estimated deviation from the original surface, in units of the mesh; 0 for the mesh itself.
    pub error: f64,
}

/// The levels of a mesh, from the mesh itself to the coarsest.
#[derive(Debug, Clone, PartialEq)]
pub struct LodChain {
    levels: Vec<LodLevel>,
}

impl LodChain {
    /// Makes the levels of a mesh; `name` is for errors.
    ///
    /// # Errors
    /// [`Error::Mesh`] when the simplifier refuses the mesh: its extent overflows, or it needs more than a gigabyte.
    pub fn new(name: &str, mesh: &Mesh) -> Result<LodChain> {
        let fail =
            |e: meshoptimizer_rs::Error| Error::Mesh { object: name.into(), reason: format!("level of detail: {e}") };
        // Corners are joined where positions are: the simplifier takes what is apart for a seam, and keeps it.
        let (positions, triangles) = weld(mesh);
        let packed: Vec<[f32; 3]> = positions.iter().map(|p| p.to_array()).collect();
        let view = Positions::from_packed(&packed);
        let mut workspace = Workspace::default();
        let mut indices: Vec<u32> = triangles.as_flattened().to_vec();
        let mut levels = vec![LodLevel { mesh: mesh.clone(), error: 0.0 }];
        let mut error = 0.0;
        while levels.len() < LEVELS && indices.len() / 3 > FEW {
            let settings = SimplifySettings {
                target_index_count: indices.len() / 6 * 3,
                target_error: f32::MAX,
                options: SimplifyOptions::ERROR_ABSOLUTE | SimplifyOptions::PRUNE,
            };
            let simplified = simplify(&indices, view, settings, &mut workspace).map_err(fail)?;
            if simplified.indices.is_empty() || simplified.indices.len() as f64 > indices.len() as f64 * WORTH {
                break;
            }
            error += f64::from(simplified.error);
            indices = simplified.indices;
            levels.push(LodLevel { mesh: part(&positions, &indices), error });
        }
        Ok(LodChain { levels })
    }

    /// From the mesh itself to the coarsest. Never empty.
    pub fn levels(&self) -> &[LodLevel] {
        &self.levels
    }

    /// Number of the coarsest level whose error is at most `lod_scale` pixels, where a unit of the mesh is at most
    /// `pixels_a_unit` pixels long.
    ///
    /// 0, the mesh itself, where nothing coarser is near enough, and where either is no number.
    pub fn choose(&self, pixels_a_unit: f64, lod_scale: f64) -> usize {
        self.levels.iter().rposition(|level| level.error * pixels_a_unit <= lod_scale).unwrap_or(0)
    }
}

/// Some triangles, with the positions that they use.
fn part(positions: &[Vec3], indices: &[u32]) -> Mesh {
    let mut used = indices.to_vec();
    used.sort_unstable();
    used.dedup();
    let slot = |i: &u32| used.partition_point(|u| u < i) as u32;
    let triangles = indices.chunks_exact(3).map(|t| [slot(&t[0]), slot(&t[1]), slot(&t[2])]).collect();
    Mesh::from_checked(used.iter().map(|&i| positions[i as usize]).collect(), triangles)
}
