//! The scene of figure 7.3: good occluders that are relatively far away, behind many near ones that are redundant.
//!
//! Before the viewer stands a screen (C) as tall as he is, close behind it a crowd of balls (D, E, F, ...), all hidden by the screen; far
//! behind two great walls (A, B) side by side, and behind these a field of towers that nothing else hides. Sizes in metres; the
//! viewer strafes before the screen.

use glam::{DVec3, Mat3, Vec3};

use crate::raster::Facing;
use crate::scene::{Generated, Mesh, Object, Scene};
use crate::view::{CameraPath, PathKey};

/// Rings and sides of a ball: 528 triangles.
const RINGS: u32 = 12;
const SIDES: u32 = 24;
/// Balls behind the screen, across, up and deep.
const CROWD: [i32; 3] = [7, 2, 3];
/// Towers behind the walls, across and deep; balls drawn out so many times sideways and upwards.
const FIELD: [i32; 2] = [24, 16];
const TOWER: [f32; 2] = [4.0, 30.0];

/// Builds the scene and its walk.
pub(super) fn build() -> Generated {
    let mut scene = Scene { name: "figure-7.3".into(), ..Scene::default() };
    let mut block = |name: &str, min: [f32; 3], max: [f32; 3], color| {
        let center = (Vec3::from(min) + Vec3::from(max)) * 0.5;
        let mesh = cuboid(Vec3::from(min) - center, Vec3::from(max) - center);
        scene.meshes.push(mesh);
        let mesh = scene.meshes.len() as u32 - 1;
        scene.objects.push(object(name.into(), mesh, center.as_dvec3(), color));
    };
    block("ground", [-90.0, -0.5, -150.0], [90.0, 0.0, 10.0], [116, 122, 110]);
    block("A", [-44.0, 0.0, -41.0], [0.5, 40.0, -40.0], [168, 128, 104]);
    block("B", [-0.5, 0.0, -42.0], [44.0, 40.0, -41.0], [150, 116, 96]);
    block("C", [-2.6, 0.0, -6.1], [2.6, 2.0, -6.0], [96, 116, 140]);
    scene.meshes.push(ball());
    let mesh = scene.meshes.len() as u32 - 1;
    let [across, up, deep] = CROWD;
    for i in 0..across * up * deep {
        let (x, y, z) = (i % across - across / 2, i / across % up, i / (across * up));
        let at = DVec3::new(f64::from(x) * 0.55, 0.4 + f64::from(y) * 0.7, -7.0 - f64::from(z) * 0.7);
        scene.objects.push(object(format!("ball_{i}"), mesh, at, [190, 170, 90]));
    }
    let [across, deep] = FIELD;
    for i in 0..across * deep {
        let (x, z) = (i % across, i / across);
        let at = DVec3::new(f64::from(x * 2 + 1 - across) * 1.5, 9.0, -56.0 - f64::from(z) * 6.0);
        let rotation = Mat3::from_diagonal(Vec3::new(TOWER[0], TOWER[1], TOWER[0]));
        scene.objects.push(Object { rotation, ..object(format!("tower_{i}"), mesh, at, [110, 150, 110]) });
    }
    Generated { scene, path: walk(), frames: 24 }
}

/// From side to side before the screen, looking past it.
fn walk() -> CameraPath {
    let key = |x: f64| PathKey { eye: DVec3::new(x, 1.7, 0.0), target: DVec3::new(0.0, 1.7, -40.0) };
    CameraPath { fov_y_deg: 60.0, near: 0.1, far: None, up: DVec3::Y, keys: [-1.0, 0.0, 1.0].map(key).to_vec() }
}

fn object(name: String, mesh: u32, position: DVec3, color: [u8; 3]) -> Object {
    Object { name, mesh, rotation: Mat3::IDENTITY, position, facing: Facing::Front, color, opacity: 1.0 }
}

/// A box of twelve triangles, seen from outside.
fn cuboid(min: Vec3, max: Vec3) -> Mesh {
    let pick = |bit: u32, axis: usize| if bit == 0 { min[axis] } else { max[axis] };
    let corners = (0..8u32).map(|i| Vec3::new(pick(i & 1, 0), pick(i >> 1 & 1, 1), pick(i >> 2, 2))).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh::from_checked(corners, triangles)
}

/// A ball of 0.3 m: poles, and rings between.
fn ball() -> Mesh {
    let radius = 0.3;
    let mut positions = vec![Vec3::new(0.0, -radius, 0.0), Vec3::new(0.0, radius, 0.0)];
    for ring in 1..RINGS {
        let up = std::f32::consts::PI * ring as f32 / RINGS as f32;
        for side in 0..SIDES {
            let around = std::f32::consts::TAU * side as f32 / SIDES as f32;
            let out = libm::sinf(up);
            positions.push(Vec3::new(libm::cosf(around) * out, -libm::cosf(up), libm::sinf(around) * out) * radius);
        }
    }
    let at = |ring: u32, side: u32| 2 + (ring - 1) * SIDES + side % SIDES;
    let mut triangles = Vec::new();
    for side in 0..SIDES {
        triangles.push([0, at(1, side), at(1, side + 1)]);
        triangles.push([1, at(RINGS - 1, side + 1), at(RINGS - 1, side)]);
        for ring in 1..RINGS - 1 {
            let (a, b) = (at(ring, side), at(ring, side + 1));
            let (c, d) = (at(ring + 1, side), at(ring + 1, side + 1));
            triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    Mesh::from_checked(positions, triangles)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Six times the volume inside, positive when triangles are counter-clockwise from outside; and whether it is closed.
    fn volume(mesh: &Mesh) -> f32 {
        let p = |i: u32| mesh.positions()[i as usize];
        let mut edges: Vec<(u32, u32)> =
            mesh.triangles().iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
        edges.sort_unstable();
        for &(a, b) in &edges {
            assert_eq!(edges.iter().filter(|&&e| e == (b, a)).count(), 1, "edge {a} {b}");
        }
        mesh.triangles().iter().map(|&[a, b, c]| p(a).dot(p(b).cross(p(c)))).sum()
    }

    #[test]
    fn solids_are_closed_and_seen_from_outside() {
        let volume_of_cube = volume(&cuboid(Vec3::splat(-1.0), Vec3::splat(1.0)));
        assert!((volume_of_cube - 48.0).abs() < 1e-3, "{volume_of_cube}");
        let of_ball = volume(&ball());
        let exact = 8.0 * std::f32::consts::PI * 0.027;
        assert!(of_ball > 0.9 * exact && of_ball < exact, "{of_ball} of {exact}");
    }
}
