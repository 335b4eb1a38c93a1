//! Which samples a triangle covers: against the exact evaluation at every sample, and no cracks or double hits between
//! neighbours, through the near plane too.

mod oracle;

use glam::{DMat4, DVec3, DVec4, Mat3, Vec3};
use homcull::raster::Facing;
use homcull::view::{Camera, ClipSpace, DepthRange, View};
use oracle::exact::{Transform, Vertex, covered_samples};
use oracle::float::{Answer, Triangle, center};
use oracle::random::Random;
use oracle::scenes::{Builder, CUBOID, KINDS, camera, cuboid_corners, flat_triangle, flat_view, viewport};
use oracle::state::{Drawn, State, draw, for_levels, picture, submitted};

const FACINGS: [Facing; 3] = [Facing::Front, Facing::Back, Facing::Both];

/// How often each sample is covered, exactly.
fn hits(view: &View, triangles: &[([Vertex; 3], Facing)]) -> Vec<u32> {
    let (w, h) = (view.viewport().width(), view.viewport().height());
    let mut hits = vec![0; (w * h) as usize];
    for (t, facing) in triangles {
        covered_samples(t, *facing, w, h, |x, y| hits[(y * w + x) as usize] += 1);
    }
    hits
}

/// Draws the scene at every level, into a canvas and into an occlusion buffer.
fn drawn(what: &str, view: &View, scene: &homcull::scene::PreparedScene) -> (Drawn, State) {
    for_levels(what, |level| {
        let buffer = submitted(level, view, &scene.meshes, &scene.occluders);
        (draw(level, view, scene), State::of(&buffer, view))
    })
}

#[track_caller]
fn covers(what: &str, (canvas, state): &(Drawn, State), should: &[bool]) {
    for (whose, is) in [("canvas", canvas.covered()), ("occlusion buffer", state.covered.clone())] {
        if let Some(p) = picture(canvas.width, canvas.height, &is, should) {
            panic!("{what}: {whose}\n{p}");
        }
    }
}

/// Samples that triangles cover, each time counted.
fn fragments((canvas, _): &(Drawn, State)) -> u64 {
    canvas.fragments.iter().sum()
}

#[test]
fn one_triangle_covers_exactly_the_samples_of_the_integer_evaluation() {
    let mut r = Random::new(1);
    let sizes = [(64, 64), (1, 1), (7, 5), (33, 31), (100, 1), (1, 100), (257, 129)];
    for round in 0..1400 {
        let kind = round % KINDS;
        let (w, h) = sizes[if round % 10 == 0 { r.below(7) } else { 0 }];
        let view = flat_view(viewport(w, h));
        let facing = FACINGS[r.below(3)];
        let corners = flat_triangle(&mut r, kind, w, h);
        let mut b = Builder::new();
        b.triangles(&[corners], facing);
        let what = format!("round {round}, kind {kind}, {w}x{h}, {facing:?}, {corners:?}");
        let transform = Transform::new(&view, DVec3::ZERO);
        let t = corners.map(|v| transform.vertex(None, v));
        assert!(t.iter().all(|v| !v.clipped), "{what}: not for this test");
        let hits = hits(&view, &[(t, facing)]);
        let drawn = drawn(&what, &view, &b.prepared());
        covers(&what, &drawn, &hits.iter().map(|&n| n > 0).collect::<Vec<_>>());
        assert_eq!(fragments(&drawn), u64::from(hits.iter().sum::<u32>()), "{what}: fragments");
    }
}

#[test]
fn many_triangles_cover_exactly_the_union_of_theirs() {
    let mut r = Random::new(2);
    for round in 0..60 {
        let (w, h) = [(257, 129), (96, 96), (130, 40)][round % 3];
        let view = flat_view(viewport(w, h));
        let transform = Transform::new(&view, DVec3::ZERO);
        let (mut b, mut all) = (Builder::new(), Vec::new());
        for object in 0..4 {
            let facing = FACINGS[object % 3];
            let most = if round % 2 == 0 { 10 } else { 120 };
            let soup: Vec<[Vec3; 3]> = (0..most)
                .map(|_| {
                    let kind = [0, 1, 2, 3, 7, 8, 9, 10][r.below(8)];
                    flat_triangle(&mut r, kind, w, h)
                })
                .collect();
            all.extend(soup.iter().map(|t| (t.map(|v| transform.vertex(None, v)), facing)));
            b.triangles(&soup, facing);
        }
        let what = format!("round {round}");
        let should: Vec<bool> = hits(&view, &all).iter().map(|&n| n > 0).collect();
        covers(&what, &drawn(&what, &view, &b.prepared()), &should);
    }
}

#[test]
fn a_perspective_view_covers_the_samples_that_the_documented_transform_says() {
    let mut r = Random::new(3);
    let mut covered = 0;
    for round in 0..250 {
        // Far from the world's origin f32 positions would not do: the transform's order of operations is what counts.
        let position = [DVec3::ZERO, DVec3::new(1e6, -3e5, 7e6), DVec3::new(0.1, 0.2, 0.3)][round % 3];
        let eye = position + DVec3::new(r.range(-5.0, 5.0), r.range(-5.0, 5.0), r.range(-5.0, 5.0));
        let mut lens = camera(&mut r, eye);
        lens.far = None;
        let view = lens.view(viewport(120, 90)).unwrap();
        let transform = Transform::new(&view, position);
        let rotation = (round % 2 == 1).then(|| {
            let (s, c) = r.range(0.0, std::f64::consts::TAU).sin_cos();
            let (s, c) = (s as f32 * 1.3, c as f32 * 1.3);
            Mat3::from_cols(Vec3::new(c, s, 0.0), Vec3::new(-s, c, 0.0), Vec3::new(0.1, 0.2, -1.1))
        });
        let facing = FACINGS[r.below(3)];
        let mut soup = Vec::new();
        while soup.len() < 24 {
            let p = |r: &mut Random, s: f64| Vec3::new(r.float(-s, s), r.float(-s, s), r.float(-s, s));
            let a = p(&mut r, 12.0);
            let size = [0.01, 0.3, 3.0, 30.0][r.below(4)];
            let t = [a, a + p(&mut r, size), a + p(&mut r, size)];
            if t.iter().all(|&v| !transform.vertex(rotation, v).clipped) {
                soup.push(t);
            }
        }
        let mut b = Builder::new();
        let object = b.triangles(&soup, facing);
        object.position = position;
        object.rotation = rotation.unwrap_or(Mat3::IDENTITY);
        let all: Vec<_> = soup.iter().map(|t| (t.map(|v| transform.vertex(rotation, v)), facing)).collect();
        let should: Vec<bool> = hits(&view, &all).iter().map(|&n| n > 0).collect();
        covered += should.iter().filter(|&&c| c).count();
        let what = format!("round {round}, {lens:?}, {facing:?}");
        covers(&what, &drawn(&what, &view, &b.prepared()), &should);
    }
    assert!(covered > 100_000, "{covered} samples: the views show next to nothing");
}

/// A net of nx times ny quads over a rectangle, its inner points moved at random; each quad cut along either diagonal.
fn net(
    r: &mut Random,
    nx: usize,
    ny: usize,
    low: (f64, f64),
    high: (f64, f64),
    jitter: f64,
) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (dx, dy) = ((high.0 - low.0) / nx as f64, (high.1 - low.1) / ny as f64);
    let mut positions = Vec::new();
    for y in 0..=ny {
        for x in 0..=nx {
            let inner = x > 0 && y > 0 && x < nx && y < ny;
            let j = if inner { jitter } else { 0.0 };
            let px = low.0 + dx * (x as f64 + r.range(-j, j));
            let py = low.1 + dy * (y as f64 + r.range(-j, j));
            positions.push(Vec3::new(px as f32, py as f32, 0.5));
        }
    }
    let mut triangles = Vec::new();
    for y in 0..ny {
        for x in 0..nx {
            let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| ((y + j) * (nx + 1) + x + i) as u32);
            triangles.extend(if r.chance(0.5) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
        }
    }
    (positions, triangles)
}

#[test]
fn every_sample_of_a_tiled_screen_is_drawn_exactly_once() {
    let mut r = Random::new(4);
    for round in 0..60 {
        let (w, h) = [(128, 96), (264, 136), (40, 32)][round % 3];
        let view = flat_view(viewport(w, h));
        let (nx, ny) = [(1, 1), (3, 2), (17, 13), (60, 40), (200, 3), (2, 1)][r.below(6)];
        let beyond = [0.0, 5.3, 4000.0, 32_000.0][r.below(4)];
        let ends = ((-beyond, -beyond), (f64::from(w) + beyond, f64::from(h) + beyond));
        // At 0.45 some quads fold: area of the wrong sign must cancel, which only a one-sided count shows. Not here.
        let (positions, triangles) = net(&mut r, nx, ny, ends.0, ends.1, 0.2);
        let mut b = Builder::new();
        b.add(positions, triangles, Facing::Both);
        let what = format!("round {round}, {w}x{h}, net {nx}x{ny}, {beyond} samples beyond the screen");
        let drawn = drawn(&what, &view, &b.prepared());
        covers(&what, &drawn, &vec![true; (w * h) as usize]);
        assert_eq!(fragments(&drawn), u64::from(w * h), "{what}: fragments, for one a sample");
    }
}

#[test]
fn a_fan_of_needles_is_drawn_exactly_once() {
    let mut r = Random::new(5);
    for round in 0..30 {
        let (w, h) = (160, 120);
        let view = flat_view(viewport(w, h));
        let n = [3, 17, 400, 3000][round % 4];
        let hub = (r.range(20.0, 140.0), r.range(20.0, 100.0));
        let mut positions = vec![Vec3::new(hub.0 as f32, hub.1 as f32, 0.5)];
        for i in 0..n {
            let (s, c) = (std::f64::consts::TAU * i as f64 / n as f64).sin_cos();
            positions.push(Vec3::new((hub.0 + 500.0 * c) as f32, (hub.1 + 500.0 * s) as f32, 0.5));
        }
        let triangles = (0..n as u32).map(|i| [0, 1 + i, 1 + (i + 1) % n as u32]).collect();
        let mut b = Builder::new();
        b.add(positions, triangles, Facing::Both);
        let what = format!("round {round}, {n} needles about {hub:?}");
        let drawn = drawn(&what, &view, &b.prepared());
        covers(&what, &drawn, &vec![true; (w * h) as usize]);
        assert_eq!(fragments(&drawn), u64::from(w * h), "{what}: fragments, for one a sample");
    }
}

/// A ball of triangles: a cube's faces cut into squares and pushed out.
fn ball(n: usize, radius: f64, middle: DVec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (mut positions, mut triangles) = (Vec::<Vec3>::new(), Vec::new());
    let mut number = std::collections::HashMap::new();
    let mut vertex = |p: DVec3| {
        let v = (p.normalize() * radius + middle).as_vec3();
        *number.entry(v.to_array().map(f32::to_bits)).or_insert_with(|| {
            positions.push(v);
            positions.len() as u32 - 1
        })
    };
    let corners = cuboid_corners(Vec3::splat(-1.0), Vec3::splat(1.0));
    for pair in CUBOID.chunks(2) {
        // A pair is [a, b, c], [a, c, d]: the square a b c d.
        let [a, b, d] = [pair[0][0], pair[0][1], pair[1][2]].map(|i| corners[i as usize].as_dvec3());
        let at = |i: usize, j: usize| a + (b - a) * (i as f64 / n as f64) + (d - a) * (j as f64 / n as f64);
        for i in 0..n {
            for j in 0..n {
                let q = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| vertex(at(i, j)));
                triangles.extend([[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
            }
        }
    }
    (positions, triangles)
}

#[test]
fn a_closed_mesh_has_no_cracks_and_no_double_hits() {
    let mut r = Random::new(6);
    for round in 0..40 {
        let mut lens = camera(&mut r, DVec3::ZERO);
        lens.far = None;
        let view = lens.view(viewport(152, 112)).unwrap();
        let ahead = (lens.target - lens.eye).normalize();
        let (positions, triangles) = ball([1, 2, 5, 16][round % 4], r.range(0.5, 3.0), ahead * r.range(4.0, 9.0));
        let transform = Transform::new(&view, DVec3::ZERO);
        let vertices: Vec<Vertex> = positions.iter().map(|&v| transform.vertex(None, v)).collect();
        assert!(vertices.iter().all(|v| !v.clipped));
        let counted = |facing| {
            let all: Vec<_> = triangles.iter().map(|t| (t.map(|i| vertices[i as usize]), facing)).collect();
            hits(&view, &all)
        };
        let (front, back) = (counted(Facing::Front), counted(Facing::Back));
        // A closed surface is entered as often as it is left, at every sample: the oracle's own check.
        assert_eq!(front, back, "round {round}");
        let should: Vec<bool> = front.iter().map(|&n| n > 0).collect();
        for facing in FACINGS {
            let mut b = Builder::new();
            b.add(positions.clone(), triangles.clone(), facing);
            let what = format!("round {round}, {facing:?}, {lens:?}");
            let drawn = drawn(&what, &view, &b.prepared());
            covers(&what, &drawn, &should);
            if facing == Facing::Front {
                assert_eq!(fragments(&drawn), u64::from(front.iter().sum::<u32>()), "{what}: fragments");
            }
        }
    }
}

/// What f64 says of a scene's triangles, sample by sample; `None` too close to an edge. `rim` in subpixels.
fn float_cover(view: &View, triangles: &[Triangle], facing: Facing, rim: f64) -> Vec<Option<bool>> {
    let (w, h) = (view.viewport().width(), view.viewport().height());
    let samples = (0..h).flat_map(|y| (0..w).map(move |x| (center(x), center(y))));
    samples
        .map(|(x, y)| {
            let mut answer = Some(false);
            for t in triangles {
                match (t.at(x, y, rim), facing) {
                    (Answer::Outside, _) => {}
                    (_, Facing::Front) if t.orientation > 0.0 => {}
                    (_, Facing::Back) if t.orientation < 0.0 => {}
                    (Answer::Inside, _) => return Some(true),
                    (Answer::Rim, _) => answer = None,
                }
            }
            answer
        })
        .collect()
}

/// The triangle as the f32 transform has it, so that only snapping and clipping are in question.
fn from_f32(transform: &Transform, t: [Vec3; 3]) -> Option<Triangle> {
    Triangle::new(t.map(|v| transform.vertex(None, v).clip.map(f64::from)))
}

/// One subpixel and a half: a corner is at most 0.71 off, on the screen and on the clip planes.
const RIM: f64 = 1.5;

#[track_caller]
fn agrees_with_float(what: &str, drawn: &(Drawn, State), float: &[Option<bool>]) {
    let canvas = drawn.0.covered();
    let should: Vec<bool> = float.iter().zip(&canvas).map(|(f, &c)| f.unwrap_or(c)).collect();
    covers(what, drawn, &should);
}

fn clipped_soup_agrees(seed: u64, rounds: usize, corner: impl Fn(&mut Random, &Camera) -> DVec3) {
    let mut r = Random::new(seed);
    let (mut sure, mut clipped) = (0, 0);
    for round in 0..rounds {
        let mut lens = camera(&mut r, DVec3::ZERO);
        lens.far = None;
        let view = lens.view(viewport(100, 70)).unwrap();
        let facing = FACINGS[r.below(3)];
        let t = [(); 3].map(|()| corner(&mut r, &lens).as_vec3());
        let transform = Transform::new(&view, DVec3::ZERO);
        let Some(triangle) = from_f32(&transform, t) else { continue };
        let mut b = Builder::new();
        b.triangles(&[t], facing);
        let what = format!("round {round}, {lens:?}, {facing:?}, {t:?}");
        let drawn = drawn(&what, &view, &b.prepared());
        let float = float_cover(&view, &[triangle], facing, RIM);
        sure += float.iter().filter(|f| **f == Some(true)).count();
        clipped += drawn.0.counts.clipped;
        agrees_with_float(&what, &drawn, &float);
    }
    println!("{clipped} clipped triangles, {sure} samples inside");
    assert!(clipped as usize > rounds / 8 && sure > rounds * 20, "{clipped} clipped, {sure} samples inside");
}

#[test]
fn a_triangle_through_the_near_plane_covers_what_f64_says() {
    clipped_soup_agrees(7, 1500, |r, _| DVec3::new(r.range(-3.0, 3.0), r.range(-3.0, 3.0), r.range(-3.0, 3.0)));
}

#[test]
fn a_triangle_with_a_corner_just_beyond_the_near_plane_covers_what_f64_says() {
    // The cut edge is then a subpixel or two long, and snapping may turn it to any side.
    clipped_soup_agrees(8, 3000, |r, lens| {
        let ahead = (lens.target - lens.eye).normalize();
        let right = ahead.cross(lens.up).normalize();
        let up = right.cross(ahead);
        let z = match r.below(3) {
            0 => lens.near * (1.0 + r.range(0.0, 0.003)),
            1 => lens.near * (1.0 - r.range(0.0, 0.003)),
            _ => r.range(-3.0, 6.0),
        };
        let reach = if (0.0..2.0 * lens.near).contains(&z) { lens.near * 1.5 } else { 4.0 };
        lens.eye + ahead * z + right * r.range(-reach, reach) + up * r.range(-reach, reach)
    });
}

#[test]
fn a_cut_shorter_than_two_subpixels_takes_nothing_away() {
    // The first corner is a millionth beyond the near plane; snapped, the edge to its cut has any direction.
    let lens = Camera {
        eye: DVec3::ZERO,
        target: DVec3::new(-0.29918999987941686, 0.45383538975396764, -0.8393561717048483),
        up: DVec3::Y,
        fov_y_deg: 31.918217660910727,
        near: 0.20473621983895174,
        far: None,
    };
    let t = [
        Vec3::new(-0.373_193_62, -0.214_347_72, -0.226_792_35),
        Vec3::new(0.085_322_8, 0.270_264_3, -0.091_957_84),
        Vec3::new(0.120_924_86, 0.354_468_85, -0.741_180_7),
    ];
    let view = lens.view(viewport(100, 70)).unwrap();
    let triangle = from_f32(&Transform::new(&view, DVec3::ZERO), t).unwrap();
    let mut b = Builder::new();
    b.triangles(&[t], Facing::Both);
    let drawn = drawn("one cut triangle", &view, &b.prepared());
    agrees_with_float("one cut triangle", &drawn, &float_cover(&view, &[triangle], Facing::Both, RIM));
}

#[test]
fn a_triangle_beyond_the_guard_band_covers_what_f64_says() {
    // Far corners beside the eye lie a hundred thousand samples from the screen.
    clipped_soup_agrees(9, 1500, |r, lens| {
        let ahead = (lens.target - lens.eye).normalize();
        let right = ahead.cross(lens.up).normalize();
        let up = right.cross(ahead);
        let reach = 10f64.powf(r.range(-0.5, 4.0));
        lens.eye + ahead * lens.near * r.range(1.0, 3.0) + right * r.range(-reach, reach) + up * r.range(-reach, reach)
    });
}

#[test]
fn a_triangle_at_the_guard_band_does_not_depend_on_what_shares_its_cluster() {
    // w is 47 everywhere, and 47 * (1 / 47) is below 1 in f32: x / w is the guard band, x * (1 / w) is inside it.
    let (w, side) = (47.0, 64.0);
    let m = DMat4::from_cols(
        DVec4::new(2.0 * w / side, 0.0, 0.0, 0.0),
        DVec4::new(0.0, 2.0 * w / side, 0.0, 0.0),
        DVec4::new(0.0, 0.0, w, 0.0),
        DVec4::new(-w, -w, 0.0, w),
    );
    let space = ClipSpace { depth: DepthRange::Reversed, y_down: true };
    let view = View::from_eye(DVec3::ZERO, m, space, viewport(64, 64)).unwrap();
    let t = [
        Vec3::new(32_768.0, 18_459.62, 0.5),
        Vec3::new(67.3058, 1.146_686_7, 0.4),
        Vec3::new(6.080_073, 20.751_678, 0.3),
    ];
    let mut alone = Builder::new();
    alone.triangles(&[t], Facing::Both);
    // A triangle without area, whose corner lies far outside.
    let mut in_company = Builder::new();
    in_company.add(vec![t[0], t[1], t[2], Vec3::new(40_000.0, 0.0, 0.5)], vec![[0, 1, 2], [3, 3, 3]], Facing::Both);
    let alone = drawn("alone", &view, &alone.prepared());
    covers("in company, against alone", &drawn("in company", &view, &in_company.prepared()), &alone.0.covered());
}

/// A floor below the eye, cut into triangles, that the near plane cuts; `ends` of the net about the eye.
fn floor_view(r: &mut Random) -> (Camera, View) {
    let eye = DVec3::new(r.range(-0.5, 0.5), r.range(0.02, 0.6), r.range(-0.5, 0.5));
    let angle = r.range(0.0, std::f64::consts::TAU);
    let target = eye + DVec3::new(angle.cos(), r.range(-1.5, 0.2), angle.sin());
    let up = DVec3::new(r.range(-0.5, 0.5), 1.0, r.range(-0.5, 0.5));
    let lens = Camera { eye, target, up, fov_y_deg: r.range(40.0, 120.0), near: r.range(0.05, 0.5), far: None };
    let view = lens.view(viewport(160, 120)).unwrap();
    (lens, view)
}

#[test]
fn a_floor_through_the_near_plane_has_no_cracks_and_no_double_hits() {
    let mut r = Random::new(10);
    let (mut clipped, mut inside) = (0, 0);
    for round in 0..300 {
        let (lens, view) = floor_view(&mut r);
        let n = [1, 4, 12, 40][round % 4];
        // Farther out, f32 itself moves the cut by more than the rim.
        let reach = [1.5, 8.0, 60.0][r.below(3)];
        let (positions, triangles) = net(&mut r, n, n, (-reach, -reach), (reach, reach), 0.2);
        let positions: Vec<Vec3> = positions.iter().map(|p| Vec3::new(p.x, 0.0, p.y)).collect();
        let transform = Transform::new(&view, DVec3::ZERO);
        let outline = [(-reach, -reach), (reach, -reach), (reach, reach), (-reach, reach)]
            .map(|(x, z)| Vec3::new(x as f32, 0.0, z as f32));
        // The plane as a whole, in two triangles: the diagonal is no edge.
        let whole: Vec<Triangle> = [[0, 1, 2], [0, 2, 3], [1, 2, 3], [1, 3, 0]]
            .iter()
            .filter_map(|t| from_f32(&transform, t.map(|i: usize| outline[i])))
            .collect();
        let float = float_cover(&view, &whole, Facing::Both, 4.0);
        let mut b = Builder::new();
        b.add(positions, triangles, Facing::Both);
        let what = format!("round {round}, {lens:?}, net {n}x{n}, reach {reach}");
        let drawn = drawn(&what, &view, &b.prepared());
        agrees_with_float(&what, &drawn, &float);
        let covered = drawn.0.covered().iter().filter(|&&c| c).count() as u64;
        assert_eq!(fragments(&drawn), covered, "{what}: fragments, for one a sample");
        clipped += drawn.0.counts.clipped;
        inside += float.iter().filter(|f| **f == Some(true)).count();
    }
    println!("{clipped} clipped triangles, {inside} samples inside");
    assert!(clipped > 1000 && inside > 300_000, "{clipped} clipped, {inside} inside");
}

#[test]
fn neighbours_share_their_edge_wherever_it_is_cut() {
    // Two triangles at an edge, and the same two in objects of their own, so that clusters and groups of vertices differ.
    let mut r = Random::new(11);
    let mut clipped = 0;
    for round in 0..2000 {
        let mut lens = camera(&mut r, DVec3::ZERO);
        lens.far = None;
        let view = lens.view(viewport(80, 64)).unwrap();
        let ahead = (lens.target - lens.eye).normalize();
        let right = ahead.cross(lens.up).normalize();
        let up = right.cross(ahead);
        // A quadrilateral in a plane that the near plane cuts, counter-clockwise in that plane.
        let tilt = r.range(0.2, 1.4);
        let (s, c) = tilt.sin_cos();
        let across = right * r.range(0.5, 1.0) + up * r.range(-0.5, 0.5);
        let along = ahead * c + up * s;
        let middle = ahead * lens.near * r.range(0.2, 2.0);
        let size = 10f64.powf(r.range(-1.0, 2.5));
        let q = [0.3, 1.8, 3.4, 5.0].map(|a: f64| {
            let (s, c) = (a + r.range(-0.4, 0.4)).sin_cos();
            (middle + across * (size * c) + along * (size * s)).as_vec3()
        });
        let mut apart = Builder::new();
        apart.triangles(&[[q[0], q[1], q[2]]], Facing::Both);
        apart.triangles(&[[q[0], q[2], q[3]]], Facing::Both);
        let mut together = Builder::new();
        together.add(q.to_vec(), vec![[0, 1, 2], [0, 2, 3]], Facing::Both);
        let transform = Transform::new(&view, DVec3::ZERO);
        let whole: Vec<Triangle> = [[0, 1, 2], [0, 2, 3], [1, 2, 3], [1, 3, 0]]
            .iter()
            .filter_map(|t| from_f32(&transform, t.map(|i: usize| q[i])))
            .collect();
        let float = float_cover(&view, &whole, Facing::Both, 4.0);
        let what = format!("round {round}, {lens:?}, {q:?}");
        let drawn_together = drawn(&what, &view, &together.prepared());
        let drawn_apart = drawn(&what, &view, &apart.prepared());
        agrees_with_float(&what, &drawn_together, &float);
        covers(&what, &drawn_apart, &drawn_together.0.covered());
        let covered = drawn_together.0.covered().iter().filter(|&&c| c).count() as u64;
        for d in [&drawn_together, &drawn_apart] {
            assert_eq!(fragments(d), covered, "{what}: fragments, for one a sample");
        }
        clipped += drawn_together.0.counts.clipped;
    }
    println!("{clipped} clipped triangles");
    assert!(clipped > 1000, "{clipped} clipped triangles");
}
