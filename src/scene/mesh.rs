//! Triangle meshes as they are loaded: positions and indices, checked once.

use glam::Vec3;

use crate::error::{Error, Result};
use crate::geometry::Aabb;

/// A triangle mesh. Every index is in range and every position finite: [`Mesh::new`] sees to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    bounds: Aabb,
}

impl Mesh {
    /// Takes positions (local space, metres) and triangles (indices into them; counter-clockwise is the front).
    /// Neither needs to be there: a mesh without triangles draws nothing.
    ///
    /// # Errors
    /// [`Error::Mesh`] naming `name`, and the vertex or triangle at fault.
    pub fn new(name: &str, positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Mesh> {
        let fail = |reason: String| Err(Error::Mesh { object: name.into(), reason });
        if let Some(i) = positions.iter().position(|p| !p.is_finite()) {
            return fail(format!("vertex {i} is not finite: {}", positions[i]));
        }
        let n = positions.len();
        if u32::try_from(n).is_err() || u32::try_from(triangles.len()).is_err() {
            return fail("more than 4294967295 vertices or triangles".into());
        }
        if let Some(t) = triangles.iter().position(|t| t.iter().any(|&i| i as usize >= n)) {
            return fail(format!("triangle {t} has indices {:?}, but there are {n} vertices", triangles[t]));
        }
        Ok(Mesh::from_checked(positions, triangles))
    }

    /// What [`Mesh::new`] would accept, from code that took it from a checked mesh or built it.
    pub(crate) fn from_checked(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
        debug_assert!(triangles.iter().flatten().all(|&i| (i as usize) < positions.len()));
        let bounds = Aabb::around(triangles.iter().flatten().map(|&i| positions[i as usize]));
        Mesh { positions, triangles, bounds }
    }

    /// Local-space positions, in metres.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Indices into the positions, three a triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The tightest box around the vertices that triangles use; empty without triangles.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }
}
