//! The view: a view-projection matrix, its convention folded away in f64, relative to the eye.

use glam::{DMat3, DMat4, DVec3, DVec4};

use crate::error::{Error, Result};

/// Largest width or height of a viewport, in samples.
pub const MAX_SIDE: u32 = 16384;

/// Width and height in samples, each 1 to [`MAX_SIDE`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Viewport {
    width: u32,
    height: u32,
}

impl Viewport {
    /// # Errors
    /// [`Error::Size`] unless each side is 1 to [`MAX_SIDE`].
    pub fn new(width: u32, height: u32) -> Result<Viewport> {
        let side = 1..=MAX_SIDE;
        if side.contains(&width) && side.contains(&height) {
            Ok(Viewport { width, height })
        } else {
            Err(Error::Size { width: width.into(), height: height.into() })
        }
    }

    /// In samples.
    pub fn width(self) -> u32 {
        self.width
    }

    /// In samples.
    pub fn height(self) -> u32 {
        self.height
    }
}

/// What clip-space z means to the caller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DepthRange {
    /// z/w is 1 at the near plane and 0 at the far plane or infinity.
    Reversed,
    /// z/w is 0 at the near plane and 1 at the far plane (Direct3D, Vulkan, Metal, wgpu).
    ZeroToOne,
    /// z/w is -1 at the near plane and 1 at the far plane (OpenGL).
    MinusOneToOne,
}

/// The caller's clip-space convention. x points right; w is positive in front of the viewer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ClipSpace {
    /// What z means.
    pub depth: DepthRange,
    /// True when clip-space y points down the screen (Vulkan without a flipped viewport).
    pub y_down: bool,
}

impl ClipSpace {
    /// Reversed depth, y up: homcull's own.
    pub const REVERSED: ClipSpace = ClipSpace { depth: DepthRange::Reversed, y_down: false };
    /// OpenGL: z from -1 to 1, y up.
    pub const OPENGL: ClipSpace = ClipSpace { depth: DepthRange::MinusOneToOne, y_down: false };
    /// Direct3D, Metal and wgpu: z from 0 to 1, y up.
    pub const DIRECT3D: ClipSpace = ClipSpace { depth: DepthRange::ZeroToOne, y_down: false };
    /// Vulkan: z from 0 to 1, y down.
    pub const VULKAN: ClipSpace = ClipSpace { depth: DepthRange::ZeroToOne, y_down: true };
}

/// One view: where the eye is, and the affine rows that take a point relative to the eye to the screen.
///
/// `x` and `y` are in subpixels (1/256 sample) times `w`, origin at the top left of the viewport, y down; `depth` is
/// reversed depth times `w`; `near` is `w - depth`, which is at least 0 beyond the near plane. All in f64: nothing is
/// subtracted per vertex (SEMANTICS, *Samples, facing, transform*).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    eye: DVec3,
    viewport: Viewport,
    /// x, y, w, depth, near; each over (point - eye, 1).
    rows: [DVec4; 5],
}

impl View {
    /// A view from a view-projection matrix over world positions, `clip = m * (p, 1)`, perspective or orthographic.
    ///
    /// The eye of a perspective matrix is recovered in f64; an orthographic matrix counts distances from the middle of its
    /// near plane.
    ///
    /// # Errors
    /// [`Error::View`] when the matrix has a number that is not finite, or is singular.
    pub fn new(view_projection: DMat4, clip_space: ClipSpace, viewport: Viewport) -> Result<View> {
        let rows = screen_rows(view_projection, clip_space, viewport)?;
        let perspective = rows[2].truncate().length() > 0.0;
        // Perspective: x = y = w = 0. Orthographic: the middle of the screen on the near plane.
        let (a, b, c) = if perspective {
            (rows[0], rows[1], rows[2])
        } else {
            let (cx, cy) = (f64::from(viewport.width) * 128.0, f64::from(viewport.height) * 128.0);
            (rows[0] - rows[2] * cx, rows[1] - rows[2] * cy, rows[4])
        };
        let eye = solve(a, b, c).ok_or_else(|| Error::View("the view-projection matrix is singular".into()))?;
        Ok(View { eye, viewport, rows: rows.map(|r| recenter(r, eye)) })
    }

    /// A view whose matrix is already relative to the eye: `clip = m * (p - eye, 1)`. Keeps full precision far from the origin.
    ///
    /// # Errors
    /// As for [`View::new`].
    pub fn from_eye(eye: DVec3, eye_relative: DMat4, clip_space: ClipSpace, viewport: Viewport) -> Result<View> {
        if !eye.is_finite() {
            return Err(Error::View("the eye must be at a finite position".into()));
        }
        let rows = screen_rows(eye_relative, clip_space, viewport)?;
        Ok(View { eye, viewport, rows })
    }

    /// World position of the eye (for an orthographic view, the middle of the near plane).
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// Size in samples.
    pub fn viewport(&self) -> Viewport {
        self.viewport
    }

    /// The same view at another size of the sample grid.
    pub fn resized(&self, viewport: Viewport) -> View {
        let mut view = *self;
        view.viewport = viewport;
        view.rows[0] *= f64::from(viewport.width) / f64::from(self.viewport.width);
        view.rows[1] *= f64::from(viewport.height) / f64::from(self.viewport.height);
        view
    }

    /// The middle of the near rectangle, about the eye; `None` when it cannot be computed.
    pub(crate) fn near_center(&self) -> Option<DVec3> {
        self.near_point(f64::from(self.viewport.width) * 128.0, f64::from(self.viewport.height) * 128.0, 0.0)
    }

    /// The point at a place of the screen, in subpixels, where the row `near` has a value: on the near plane for 0. About the eye;
    /// `None` when it cannot be computed.
    pub(crate) fn near_point(&self, x: f64, y: f64, near: f64) -> Option<DVec3> {
        let [rx, ry, w, _, beyond] = self.rows;
        solve(rx - w * x, ry - w * y, beyond - DVec4::W * near)
    }

    /// The point that all rays of the view come from, about the eye; `None` for an orthographic view.
    #[cfg(feature = "bvh")]
    pub(crate) fn center(&self) -> Option<DVec3> {
        let [x, y, w, ..] = self.rows;
        solve(x, y, w)
    }

    /// Where the rays of a perspective view meet, about the eye; `None` where they are parallel.
    #[cfg(feature = "bvh")]
    pub(crate) fn projection_center(&self) -> Option<DVec3> {
        solve(self.rows[0], self.rows[1], self.rows[2])
    }

    /// The rows x, y, w, depth and near over (point - eye, 1); see the type's documentation for their units.
    pub fn rows(&self) -> &[DVec4; 5] {
        &self.rows
    }
}

fn screen_rows(m: DMat4, clip_space: ClipSpace, viewport: Viewport) -> Result<[DVec4; 5]> {
    if !m.is_finite() {
        return Err(Error::View("the view-projection matrix has a number that is not finite".into()));
    }
    if m.determinant() == 0.0 {
        return Err(Error::View("the view-projection matrix is singular".into()));
    }
    let (x, y, z, w) = (m.row(0), m.row(1), m.row(2), m.row(3));
    let (kx, ky) = (f64::from(viewport.width) * 128.0, f64::from(viewport.height) * 128.0);
    let y = if clip_space.y_down { -y } else { y };
    let (depth, near) = match clip_space.depth {
        DepthRange::Reversed => (z, w - z),
        DepthRange::ZeroToOne => (w - z, z),
        DepthRange::MinusOneToOne => ((w - z) * 0.5, (w + z) * 0.5),
    };
    let rows = [(x + w) * kx, (w - y) * ky, w, depth, near];
    if !rows.iter().all(|r| r.is_finite()) {
        return Err(Error::View("the view-projection matrix overflows".into()));
    }
    Ok(rows)
}

/// The point where three affine rows are 0; `None` when they do not meet in one finite point.
fn solve(a: DVec4, b: DVec4, c: DVec4) -> Option<DVec3> {
    // Rows scaled to unit length: the determinant then measures angles alone.
    let unit = |r: DVec4| r / r.truncate().length();
    let (a, b, c) = (unit(a), unit(b), unit(c));
    let m = DMat3::from_cols(a.truncate(), b.truncate(), c.truncate()).transpose();
    let ok = m.is_finite() && m.determinant().abs() > 1e-12;
    let p = if ok { m.inverse() * -DVec3::new(a.w, b.w, c.w) } else { DVec3::NAN };
    p.is_finite().then_some(p)
}

fn recenter(row: DVec4, eye: DVec3) -> DVec4 {
    row.truncate().extend(row.truncate().dot(eye) + row.w)
}
