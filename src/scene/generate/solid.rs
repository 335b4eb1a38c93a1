//! Closed solids, the bricks of the generators: outward faces counter-clockwise, every edge shared by two triangles.
//!
//! Each call adds one closed surface (`join` those of another), so a mesh of any number of them is watertight piece by piece and can be drawn with
//! its front faces alone. Coordinates are metres in f32 about the object's own position; trigonometry is `libm`'s.

use glam::{Mat3, Vec2, Vec3};

use super::super::Mesh;

/// A mesh in the making.
#[derive(Debug, Clone, Default)]
pub(super) struct Solid {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// Where each closed surface begins in both.
    surfaces: Vec<(usize, usize)>,
}

impl Solid {
    /// How many triangles so far.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Parts of at most `most` triangles each, in the order of building; a single closed surface is never cut.
    pub fn split(self, most: usize) -> Vec<Solid> {
        let mut parts = vec![Solid::default()];
        let ends = self.surfaces.iter().skip(1).copied().chain([(self.positions.len(), self.triangles.len())]);
        for (&(p, t), (p_end, t_end)) in self.surfaces.iter().zip(ends) {
            let full = parts.last().is_some_and(|part| part.len() > 0 && part.len() + t_end - t > most);
            if full {
                parts.push(Solid::default());
            }
            if let Some(part) = parts.last_mut() {
                let shift = part.begin();
                part.positions.extend_from_slice(&self.positions[p..p_end]);
                let moved = |corner: u32| corner - p as u32 + shift;
                part.triangles.extend(self.triangles[t..t_end].iter().map(|triangle| triangle.map(moved)));
            }
        }
        parts
    }

    /// Marks the beginning of a closed surface, and returns the index of its first vertex.
    fn begin(&mut self) -> u32 {
        self.surfaces.push((self.positions.len(), self.triangles.len()));
        self.positions.len() as u32
    }

    /// The mesh.
    pub fn mesh(self) -> Mesh {
        Mesh::from_checked(self.positions, self.triangles)
    }

    /// A box: 12 triangles.
    pub fn cuboid(&mut self, min: Vec3, max: Vec3) -> &mut Solid {
        let corners =
            [Vec2::new(min.x, min.z), Vec2::new(min.x, max.z), Vec2::new(max.x, max.z), Vec2::new(max.x, min.z)];
        self.prism(&corners, min.y, max.y)
    }

    /// A box on the plane `y`, around (x, z), with its full sizes.
    pub fn block(&mut self, x: f32, y: f32, z: f32, size: Vec3) -> &mut Solid {
        let half = Vec3::new(size.x * 0.5, 0.0, size.z * 0.5);
        let at = Vec3::new(x, y, z);
        self.cuboid(at - half, at + half + Vec3::Y * size.y)
    }

    /// A convex outline of (x, z), counter-clockwise seen from above, raised from `y0` to `y1`: 4n - 4 triangles.
    pub fn prism(&mut self, outline: &[Vec2], y0: f32, y1: f32) -> &mut Solid {
        self.loft(outline, y0, outline, y1)
    }

    /// Between two outlines of equal number: 4n - 4 triangles.
    pub fn loft(&mut self, low: &[Vec2], y0: f32, high: &[Vec2], y1: f32) -> &mut Solid {
        let (first, n) = (self.begin(), low.len() as u32);
        self.positions.extend(low.iter().map(|p| Vec3::new(p.x, y0, p.y)));
        self.positions.extend(high.iter().map(|p| Vec3::new(p.x, y1, p.y)));
        self.band(first, first + n, n);
        self.caps(first, first + n, n);
        self
    }

    /// From an outline to a point: 2n - 2 triangles.
    pub fn spire(&mut self, outline: &[Vec2], y0: f32, apex: Vec3) -> &mut Solid {
        let (first, n) = (self.begin(), outline.len() as u32);
        self.positions.extend(outline.iter().map(|p| Vec3::new(p.x, y0, p.y)));
        self.positions.push(apex);
        self.triangles.extend((0..n).map(|i| [first + i, first + (i + 1) % n, first + n]));
        self.triangles.extend((1..n.saturating_sub(1)).map(|i| [first, first + i + 1, first + i]));
        self
    }

    /// A gable roof over a rectangle, its ridge along the longer side: 8 triangles.
    pub fn gable(&mut self, min: Vec3, max: Vec3) -> &mut Solid {
        let along_x = max.x - min.x >= max.z - min.z;
        let (mx, mz) = ((min.x + max.x) * 0.5, (min.z + max.z) * 0.5);
        let base = [(min.x, min.z), (min.x, max.z), (max.x, max.z), (max.x, min.z)];
        let ridge = if along_x { [(min.x, mz), (max.x, mz)] } else { [(mx, max.z), (mx, min.z)] };
        let first = self.begin();
        self.positions.extend(base.map(|(x, z)| Vec3::new(x, min.y, z)));
        self.positions.extend(ridge.map(|(x, z)| Vec3::new(x, max.y, z)));
        // The base counter-clockwise from above is a b c d; the ridge runs from the side between p and q to the other.
        let [a, b, c, d, r, s] = [0, 1, 2, 3, 4, 5].map(|i| first + i);
        let [p, q, t, u] = if along_x { [a, b, c, d] } else { [b, c, d, a] };
        self.triangles.extend([[p, q, r], [q, t, s], [q, s, r], [t, u, s], [u, p, r], [u, r, s]]);
        self.triangles.extend([[a, d, c], [a, c, b]]);
        self
    }

    /// A column or cone frustum of `n` sides around (x, z): 4n - 4 triangles, 2n - 2 when it ends in a point.
    pub fn column(&mut self, n: usize, at: Vec2, (y0, r0): (f32, f32), (y1, r1): (f32, f32)) -> &mut Solid {
        if r1 > 0.0 {
            self.loft(&circle(n, at, r0), y0, &circle(n, at, r1), y1)
        } else {
            self.spire(&circle(n, at, r0), y0, Vec3::new(at.x, y1, at.y))
        }
    }

    /// A skin over `rings` of equal number, at least two, with both ends capped: 2n(k - 1) + 2n - 4 triangles for k rings of n.
    /// Rings are convex, and turn by the right hand about the way from one to the next.
    pub fn skin(&mut self, rings: &[Vec<Vec3>]) -> &mut Solid {
        let (first, n) = (self.begin(), rings.first().map_or(0, Vec::len) as u32);
        self.positions.extend(rings.iter().flatten());
        for k in 1..rings.len() as u32 {
            self.band(first + (k - 1) * n, first + k * n, n);
        }
        let last = first + (rings.len() as u32).saturating_sub(1) * n;
        self.caps(first, last, n);
        self
    }

    /// A skin over at least three `rings` whose last joins the first, as a tyre: 2nk triangles. Rings as for [`Solid::skin`].
    pub fn hoop(&mut self, rings: &[Vec<Vec3>]) -> &mut Solid {
        let (first, n, count) = (self.begin(), rings.first().map_or(0, Vec::len) as u32, rings.len() as u32);
        self.positions.extend(rings.iter().flatten());
        for k in 0..count {
            self.band(first + k * n, first + (k + 1) % count * n, n);
        }
        self
    }

    /// Turned on a lathe of `n` sides about the y axis: a profile of at least two (radius, y) from the bottom to the top. An
    /// end of radius 0 is a point, any other is capped; 2n triangles for each step without a point, n for one with it.
    pub fn lathe(&mut self, n: usize, profile: &[(f32, f32)]) -> &mut Solid {
        let first = self.begin();
        let points = |end: Option<&(f32, f32)>| end.is_some_and(|&(radius, _)| radius <= 0.0);
        let (foot, head) = (points(profile.first()), points(profile.last()));
        let body = &profile[usize::from(foot)..profile.len() - usize::from(head)];
        for &(radius, y) in body {
            self.positions.extend(circle(n, Vec2::ZERO, radius).iter().map(|p| Vec3::new(p.x, y, p.y)));
        }
        let n = n as u32;
        for k in 1..body.len() as u32 {
            self.band(first + (k - 1) * n, first + k * n, n);
        }
        let last = first + (body.len() as u32).saturating_sub(1) * n;
        self.end(profile.first().filter(|_| foot), first, n, false);
        self.end(profile.last().filter(|_| head), last, n, true);
        self
    }

    /// Closes a ring by a point on the axis, or by a cap.
    fn end(&mut self, point: Option<&(f32, f32)>, ring: u32, n: u32, upward: bool) {
        let mut face = |a: u32, b: u32, c: u32| self.triangles.push(if upward { [a, b, c] } else { [a, c, b] });
        if let Some(&(_, y)) = point {
            let apex = self.positions.len() as u32;
            self.positions.push(Vec3::Y * y);
            (0..n).for_each(|i| face(ring + i, ring + (i + 1) % n, apex));
        } else {
            (1..n.saturating_sub(1)).for_each(|i| face(ring, ring + i, ring + i + 1));
        }
    }

    /// Closes a first and a last ring of `n` vertices.
    fn caps(&mut self, first: u32, last: u32, n: u32) {
        for i in 1..n.saturating_sub(1) {
            self.triangles.push([first, first + i + 1, first + i]);
            self.triangles.push([last, last + i, last + i + 1]);
        }
    }

    /// The faces between two rings of `n` vertices.
    fn band(&mut self, low: u32, high: u32, n: u32) {
        for i in 0..n {
            let j = (i + 1) % n;
            let (a, b, c, d) = (low + i, low + j, high + i, high + j);
            self.triangles.extend([[a, b, d], [a, d, c]]);
        }
    }

    /// Adds the surfaces of another solid, turned (not mirrored) and then shifted.
    pub fn join(&mut self, part: &Solid, turn: Mat3, shift: Vec3) -> &mut Solid {
        let (first, faces) = (self.positions.len(), self.triangles.len());
        self.surfaces.extend(part.surfaces.iter().map(|&(p, t)| (p + first, t + faces)));
        self.positions.extend(part.positions.iter().map(|&p| turn * p + shift));
        self.triangles.extend(part.triangles.iter().map(|triangle| triangle.map(|i| i + first as u32)));
        self
    }

    /// A flat rectangle that faces up, not closed: 2 triangles of ground.
    pub fn patch(&mut self, min: Vec2, max: Vec2, y: f32) -> &mut Solid {
        let first = self.begin();
        let corners = [(min.x, min.y), (min.x, max.y), (max.x, max.y), (max.x, min.y)];
        self.positions.extend(corners.map(|(x, z)| Vec3::new(x, y, z)));
        self.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        self
    }

    /// A flat four-sided face, counter-clockwise from its front, not closed: 2 triangles. Corners that are there already are shared.
    pub fn quad(&mut self, corners: [Vec3; 4]) -> &mut Solid {
        if self.surfaces.is_empty() {
            self.begin();
        }
        let [a, b, c, d] = corners.map(|p| {
            let known = self.positions.iter().rposition(|&q| q == p);
            known.unwrap_or_else(|| {
                self.positions.push(p);
                self.positions.len() - 1
            }) as u32
        });
        self.triangles.extend([[a, b, c], [a, c, d]]);
        self
    }

    /// A surface over a grid of heights, facing up: vertex (i, j) is `grid(i, j)`, with x growing by i and z by j.
    pub fn sheet(&mut self, cells: u32, grid: impl Fn(u32, u32) -> Vec3) -> &mut Solid {
        let (first, row) = (self.begin(), cells + 1);
        self.positions.extend((0..row * row).map(|k| grid(k % row, k / row)));
        for j in 0..cells {
            for i in 0..cells {
                let a = first + j * row + i;
                let (b, c, d) = (a + row, a + row + 1, a + 1);
                self.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        self
    }
}

/// A regular outline of `n` corners, counter-clockwise from above.
pub(super) fn circle(n: usize, at: Vec2, radius: f32) -> Vec<Vec2> {
    let corner = |i: usize| {
        let angle = std::f64::consts::TAU * (i as f64 + 0.5) / n as f64;
        at + Vec2::new(libm::sin(angle) as f32, libm::cos(angle) as f32) * radius
    };
    (0..n).map(corner).collect()
}

/// The rotation that takes the y axis, along which solids are made, to the unit vector `axis`; exact for the six along the axes.
pub(super) fn upright_to(axis: Vec3) -> Mat3 {
    if axis == Vec3::Y {
        return Mat3::IDENTITY;
    }
    let aside = if axis.y.abs() > 0.9 { Vec3::X } else { Vec3::Y };
    let x = aside.cross(axis).normalize();
    Mat3::from_cols(x, axis, x.cross(axis))
}
