//! The cases that ask single questions: boxes, matrices and sizes that are no such thing.

use super::cases::world_matrix;
use super::shapes::Lens;
use super::{StabilityCase, Subject};
use crate::error::{Error, Result};
use crate::geometry::Aabb;
use crate::occlusion::{BoxSet, OcclusionBuffer, ProjectedBoxes, Verdict, Visible};
use crate::raster::PreparedMeshes;
use crate::scene::Facing;
use crate::view::{ClipSpace, View, Viewport};
use glam::{DMat4, DVec3, DVec4, Vec3};

pub(super) fn questions() -> Vec<StabilityCase> {
    let answers = |name, about, ask| StabilityCase { name, about, subject: Subject::Answers(ask) };
    vec![
        answers("boxes-of-nan", "boxes with NaN and infinities count as visible, empty ones as outside", nan_boxes),
        answers("singular-matrices", "matrices that are no views are typed errors", singular_matrices),
        answers("impossible-sizes", "sizes of 0 and beyond 16384 are typed errors", impossible_sizes),
    ]
}

fn nan_boxes() -> Vec<(&'static str, bool)> {
    let unit = Aabb { min: Vec3::new(-1.0, -1.0, -9.0), max: Vec3::new(1.0, 1.0, -8.0) };
    let with = |f: &dyn Fn(&mut Aabb)| {
        let mut b = unit;
        f(&mut b);
        b
    };
    let visible: Vec<(&'static str, Aabb)> = vec![
        ("NaN in min.x", with(&|b| b.min.x = f32::NAN)),
        ("NaN in max.z", with(&|b| b.max.z = f32::NAN)),
        ("NaN everywhere", with(&|b| (b.min, b.max) = (Vec3::NAN, Vec3::NAN))),
        ("an infinite side", with(&|b| b.max.y = f32::INFINITY)),
        ("all of space", with(&|b| (b.min, b.max) = (Vec3::NEG_INFINITY, Vec3::INFINITY))),
        ("all that f32 can say", with(&|b| (b.min, b.max) = (Vec3::MIN, Vec3::MAX))),
    ];
    let hidden: Vec<(&'static str, Aabb)> = vec![
        ("a box behind the wall", unit),
        ("the empty box", Aabb::EMPTY),
        ("a box turned inside out", with(&|b| std::mem::swap(&mut b.min, &mut b.max))),
    ];
    let ask = || -> Result<Vec<(&'static str, bool)>> {
        let view = Lens::PLAIN.look(DVec3::ZERO, -DVec3::Z)?;
        let mut buffer = OcclusionBuffer::new(view.viewport());
        buffer.begin(&view)?;
        let wall = [(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)].map(|(x, y)| Vec3::new(x, y, -5.0));
        buffer.submit_triangles(&wall, &[[0, 1, 2], [0, 2, 3]], DVec3::ZERO, Facing::Both)?;
        let mut out = Vec::new();
        let mut all = Vec::new();
        for (name, b) in visible.iter().chain(&hidden) {
            all.push(*b);
            let verdict = buffer.test(*b, DVec3::ZERO)?;
            let should = visible.iter().any(|v| v.0 == *name);
            out.push((*name, verdict.is_hidden() != should));
            if should {
                out.push((*name, verdict == Verdict::Visible(Visible::NearPlane)));
            }
        }
        let mut projected = ProjectedBoxes::new();
        buffer.project(&BoxSet::new(&all), DVec3::ZERO, &mut projected)?;
        let mut flags = Vec::new();
        buffer.test_projected(&projected, 0..projected.len(), &all, DVec3::ZERO, &mut flags)?;
        for (i, (name, _)) in visible.iter().enumerate() {
            let at = projected.boxes().iter().position(|b| b.id() == i as u32);
            out.push((*name, at.is_some_and(|at| !flags[at])));
        }
        Ok(out)
    };
    ask().unwrap_or_else(|_| vec![("setting the boxes up", false)])
}

fn singular_matrices() -> Vec<(&'static str, bool)> {
    let Ok(size) = Viewport::new(64, 48) else { return vec![("a viewport of 64x48", false)] };
    let good = world_matrix(DVec3::new(1.0, 2.0, 3.0), ClipSpace::OPENGL);
    let replaced = |row: usize, with: DVec4| {
        let mut rows = [good.row(0), good.row(1), good.row(2), good.row(3)];
        rows[row] = with;
        DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose()
    };
    let refused = |m: DMat4| matches!(View::new(m, ClipSpace::OPENGL, size), Err(Error::View(_)));
    let lens = |fov: f64, near: f64, far: Option<f64>| {
        let lens = Lens { size: (64, 48), fov, near, far };
        matches!(lens.look(DVec3::ZERO, DVec3::Z), Err(Error::View(_)))
    };
    let look = |eye: DVec3, target: DVec3| matches!(Lens::PLAIN.look(eye, target), Err(Error::View(_)));
    vec![
        ("a sound matrix is taken", !refused(good)),
        ("all zeros", refused(DMat4::ZERO)),
        ("x is 0", refused(replaced(0, DVec4::ZERO))),
        ("y is 0", refused(replaced(1, DVec4::ZERO))),
        ("w is 0", refused(replaced(3, DVec4::ZERO))),
        ("x is y", refused(replaced(0, good.row(1)))),
        ("x is w", refused(replaced(0, good.row(3)))),
        ("NaN", refused(replaced(2, DVec4::splat(f64::NAN)))),
        ("an infinity", refused(replaced(1, DVec4::splat(f64::INFINITY)))),
        ("numbers of 1e308", refused(good * 1e308)),
        ("z is 0", refused(replaced(2, DVec4::ZERO))),
        ("about the eye: all zeros", View::from_eye(DVec3::ZERO, DMat4::ZERO, ClipSpace::OPENGL, size).is_err()),
        (
            "about the eye: w is 0",
            View::from_eye(DVec3::ZERO, replaced(3, DVec4::ZERO), ClipSpace::OPENGL, size).is_err(),
        ),
        ("an eye at NaN", View::from_eye(DVec3::NAN, good, ClipSpace::OPENGL, size).is_err()),
        ("fov 0", lens(0.0, 0.1, None)),
        ("fov 180", lens(180.0, 0.1, None)),
        ("fov NaN", lens(f64::NAN, 0.1, None)),
        ("near 0", lens(60.0, 0.0, None)),
        ("near below 0", lens(60.0, -1.0, None)),
        ("near NaN", lens(60.0, f64::NAN, None)),
        ("near infinite", lens(60.0, f64::INFINITY, None)),
        ("far before near", lens(60.0, 1.0, Some(0.5))),
        ("far at near", lens(60.0, 1.0, Some(1.0))),
        ("far NaN", lens(60.0, 1.0, Some(f64::NAN))),
        ("the target is the eye", look(DVec3::ONE, DVec3::ONE)),
        ("up along the view", look(DVec3::ZERO, DVec3::Y)),
        ("a target at infinity", look(DVec3::ZERO, DVec3::INFINITY)),
    ]
}

fn impossible_sizes() -> Vec<(&'static str, bool)> {
    let refused = |w, h| matches!(Viewport::new(w, h), Err(Error::Size { .. }));
    let view = Lens { size: (64, 48), ..Lens::PLAIN }.look(DVec3::ZERO, DVec3::Z);
    let other = Viewport::new(48, 64).map(OcclusionBuffer::new);
    let mut meshes = PreparedMeshes::new();
    let mut answers = vec![
        ("0x0", refused(0, 0)),
        ("0x1", refused(0, 1)),
        ("1x0", refused(1, 0)),
        ("16385x1", refused(16385, 1)),
        ("1x16385", refused(1, 16385)),
        ("200000x200000", refused(200_000, 200_000)),
        ("the greatest u32", refused(u32::MAX, u32::MAX)),
        ("16384x16384 is taken", Viewport::new(16384, 16384).is_ok()),
        ("1x1 is taken", Viewport::new(1, 1).is_ok()),
        ("a vertex at NaN", meshes.add(&[Vec3::NAN], &[]).is_err()),
        ("an index out of range", meshes.add(&[Vec3::ZERO], &[[0, 0, 1]]).is_err()),
    ];
    if let (Ok(view), Ok(mut buffer)) = (view, other) {
        let unit = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        answers.push(("a test before any view", matches!(buffer.test(unit, DVec3::ZERO), Err(Error::View(_)))));
        answers.push(("a view of another size", matches!(buffer.begin(&view), Err(Error::View(_)))));
    } else {
        answers.push(("a view of 64x48 and a buffer of 48x64", false));
    }
    answers
}
