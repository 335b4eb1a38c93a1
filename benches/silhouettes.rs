//! What simplifying occluders anew for every view would cost (thesis 7.2, figure 7.2): finding a silhouette, against
//! drawing what it would save.
//!
//! `silhouette_edges` is a lower bound of view-dependent simplification: triangles are sorted into those that face the
//! eye and those that do not, and the edges between them are listed; they are neither joined into rings nor
//! triangulated. `whole` draws the ball as an occluder, `tenth` draws its conservative stand-in of a tenth of the
//! triangles. An iteration is one ball in one view; items are its triangles.

use std::cell::RefCell;

use divan::Bencher;
use divan::counter::ItemsCount;
use glam::{DVec3, Vec3};
use homcull::occlusion::{Occluder, OcclusionBuffer};
use homcull::raster::{Facing, PreparedMeshes};
use homcull::scene::Mesh;
use homcull::scene::lod::simplify_occluder;
use homcull::view::{Camera, Viewport};

fn main() {
    divan::main();
}

/// Triangles of the balls.
const SIZES: [usize; 3] = [240, 2208, 19_680];

/// A ball ten units before the eye, about 200 pixels wide on 1280x1024.
fn ball(triangles: usize) -> Mesh {
    let m = (triangles as f64 / 4.0).sqrt().ceil() as usize;
    let n = 2 * m;
    let mut positions = Vec::new();
    for j in 0..=m {
        for i in 0..n {
            let (s, c) = (i as f64 / n as f64 * std::f64::consts::TAU).sin_cos();
            let (t, d) = (j as f64 / m as f64 * std::f64::consts::PI).sin_cos();
            positions.push((DVec3::new(t * c, d, t * s) + DVec3::new(0.0, 0.0, -10.0)).as_vec3());
        }
    }
    let at = |i: usize, j: usize| {
        let pole = j == 0 || j == m;
        (j * n + if pole { 0 } else { i % n }) as u32
    };
    let mut out = Vec::new();
    for i in 0..n {
        for j in 0..m {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            out.extend([[a, b, c], [a, c, d]].into_iter().filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]));
        }
    }
    // Poles are one corner each.
    let pole = positions[0];
    positions[1..n].fill(pole);
    Mesh::new("ball", positions, out).expect("a ball is a mesh")
}

/// The two triangles of every edge.
fn edges(mesh: &Mesh) -> Vec<[u32; 2]> {
    let directed = |(t, c): (usize, &[u32; 3])| {
        [(c[0], c[1]), (c[1], c[2]), (c[2], c[0])].map(|(a, b)| (a.min(b), a.max(b), t as u32))
    };
    let mut all: Vec<(u32, u32, u32)> = mesh.triangles().iter().enumerate().flat_map(directed).collect();
    all.sort_unstable();
    all.chunk_by(|e, f| (e.0, e.1) == (f.0, f.1)).filter_map(|uses| Some([uses.first()?.2, uses.get(1)?.2])).collect()
}

#[divan::bench(args = SIZES)]
fn silhouette_edges(bencher: Bencher<'_, '_>, triangles: usize) {
    let mesh = ball(triangles);
    let edges = edges(&mesh);
    // Planes are made beforehand, as a program would.
    let planes: Vec<[f32; 4]> = mesh
        .triangles()
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| mesh.positions()[i as usize]);
            let n: Vec3 = (b - a).cross(c - a);
            [n.x, n.y, n.z, -n.dot(a)]
        })
        .collect();
    let (mut faces, mut found) = (vec![false; planes.len()], Vec::with_capacity(edges.len()));
    bencher.counter(ItemsCount::new(planes.len())).bench_local(|| {
        let eye = divan::black_box(Vec3::ZERO);
        for (face, p) in faces.iter_mut().zip(&planes) {
            *face = p[0] * eye.x + p[1] * eye.y + p[2] * eye.z + p[3] > 0.0;
        }
        found.clear();
        for (e, [s, t]) in edges.iter().enumerate() {
            if faces[*s as usize] != faces[*t as usize] {
                found.push(e as u32);
            }
        }
        found.len()
    });
}

fn draw(bencher: Bencher<'_, '_>, mesh: &Mesh, items: usize) {
    let viewport = Viewport::new(1280, 1024).expect("a size");
    let camera = Camera { eye: DVec3::ZERO, target: -DVec3::Z, up: DVec3::Y, fov_y_deg: 60.0, near: 0.1, far: None };
    let view = camera.view(viewport).expect("a view");
    let mut meshes = PreparedMeshes::new();
    let id = meshes.add(mesh.positions(), mesh.triangles()).expect("a mesh");
    let (optical_depth, luminance) = (0, 0);
    let occluder = Occluder {
        mesh: id,
        position: DVec3::ZERO,
        rotation: None,
        facing: Facing::Both,
        opaque: true,
        optical_depth,
        luminance,
    };
    // Cleared before each, which is not timed: a sample is one iteration.
    let buffer = RefCell::new(OcclusionBuffer::new(viewport));
    bencher
        .counter(ItemsCount::new(items))
        .with_inputs(|| buffer.borrow_mut().begin(&view).expect("a view of the buffer's size"))
        .bench_local_values(|()| buffer.borrow_mut().submit(&meshes, &[occluder]).expect("a prepared mesh"));
}

#[divan::bench(args = SIZES, sample_size = 1)]
fn whole(bencher: Bencher<'_, '_>, triangles: usize) {
    let mesh = ball(triangles);
    draw(bencher, &mesh, mesh.triangles().len());
}

#[divan::bench(args = SIZES, sample_size = 1)]
fn tenth(bencher: Bencher<'_, '_>, triangles: usize) {
    let mesh = ball(triangles);
    draw(bencher, &simplify_occluder(&mesh, Facing::Both, 0.1).inside, mesh.triangles().len());
}
