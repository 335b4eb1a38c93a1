//! Levels of detail and conservative simplification of occluders (thesis 7.2): what is inside stays inside, for every
//! viewer.
//!
//! The oracles share no code with the library: winding numbers by solid angles in f64 (Van Oosterom and Strackee 1983),
//! integers for convex solids, and the pictures of original and stand-in, sample by sample.
#![cfg(all(feature = "lod", feature = "bvh"))]

mod oracle;

use glam::{DVec3, Vec3};
use homcull::draw::Canvas;
use homcull::raster::Facing;
use homcull::scene::Mesh;
use homcull::scene::lod::{
    Enclosure, LodChain, Merge, OccluderLevels, Open, SimplifiedOccluder, merge_coplanar, price_within,
    simplify_occluder,
};
use homcull::view::{Camera, View, pixels_a_unit};
use homcull_simd::Level;
use oracle::float;
use oracle::random::Random;
use oracle::scenes::{Builder, CUBOID, cuboid_corners, direction, viewport};

type Triangle = [Vec3; 3];

fn corners(mesh: &Mesh) -> Vec<Triangle> {
    mesh.triangles().iter().map(|t| t.map(|i| mesh.positions()[i as usize])).collect()
}

fn mesh(triangles: &[Triangle]) -> Mesh {
    let indices = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Mesh::new("test", triangles.as_flattened().to_vec(), indices).unwrap()
}

/// A closed surface over a torus of parameters, `at(u, v)` with both from 0 to 1: poles may coincide.
fn woven(n: usize, m: usize, at: impl Fn(f64, f64) -> DVec3) -> Mesh {
    let position = |i: usize, j: usize| at((i % n) as f64 / n as f64, (j % m) as f64 / m as f64).as_vec3();
    let mut out = Vec::new();
    for i in 0..n {
        for j in 0..m {
            let [a, b, c, d] = [position(i, j), position(i + 1, j), position(i + 1, j + 1), position(i, j + 1)];
            out.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh(&out)
}

fn torus(n: usize, m: usize, thick: f64) -> Mesh {
    woven(n, m, |u, v| {
        let (s, c) = (u * std::f64::consts::TAU).sin_cos();
        let (t, d) = (v * std::f64::consts::TAU).sin_cos();
        DVec3::new((1.0 + thick * d) * c, thick * t, -(1.0 + thick * d) * s)
    })
}

/// A ball of 2n(m - 1) triangles, its radius a function of the direction.
fn ball(n: usize, m: usize, radius: impl Fn(DVec3) -> f64) -> Mesh {
    let at = |i: usize, j: usize| {
        let (s, c) = ((i % n) as f64 / n as f64 * std::f64::consts::TAU).sin_cos();
        let (t, d) = (j as f64 / m as f64 * std::f64::consts::PI).sin_cos();
        let way = match j {
            0 => DVec3::Y,
            _ if j == m => -DVec3::Y,
            _ => DVec3::new(t * c, d, t * s),
        };
        (way * radius(way)).as_vec3()
    };
    let mut out = Vec::new();
    for i in 0..n {
        for j in 0..m {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            if j > 0 {
                out.push([a, b, c]);
            }
            if j + 1 < m {
                out.push([a, c, d]);
            }
        }
    }
    mesh(&out)
}

/// An upright prism over a ring of corners, its caps fans: where the ring is concave they fold over themselves, as
/// exporters write them.
fn prism(ring: &[(f32, f32)], height: f32) -> Mesh {
    let at = |i: usize, y: f32| Vec3::new(ring[i % ring.len()].0, y, ring[i % ring.len()].1);
    let mut out = Vec::new();
    for i in 0..ring.len() {
        let [a, b, c, d] = [at(i, 0.0), at(i + 1, 0.0), at(i + 1, height), at(i, height)];
        out.extend([[a, b, c], [a, c, d]]);
    }
    for i in 1..ring.len() - 1 {
        out.push([at(0, 0.0), at(i + 1, 0.0), at(i, 0.0)]);
        out.push([at(0, height), at(i, height), at(i + 1, height)]);
    }
    mesh(&out)
}

fn cuboid(min: Vec3, max: Vec3) -> Mesh {
    Mesh::new("box", cuboid_corners(min, max).to_vec(), CUBOID.to_vec()).unwrap()
}

fn joined(meshes: &[Mesh]) -> Mesh {
    mesh(&meshes.iter().flat_map(corners).collect::<Vec<_>>())
}

/// Closed solids of many kinds: convex, round, hollow, spiky, folded, crossing themselves, several in one.
fn solids() -> Vec<(&'static str, Mesh)> {
    let star: Vec<(f32, f32)> = (0..14)
        .map(|i| {
            let (s, c) = (-f64::from(i) / 14.0 * std::f64::consts::TAU).sin_cos();
            let r = if i % 2 == 0 { 2.0 } else { 0.7 };
            ((r * c) as f32, (r * s) as f32)
        })
        .collect();
    let stairs = [(0.0, 0.0), (0.0, 3.0), (1.0, 3.0), (1.0, 2.0), (2.0, 2.0), (2.0, 1.0), (3.0, 1.0), (3.0, 0.0)];
    let knobbly = |w: DVec3| 1.0 + 0.2 * (7.0 * w.x).sin() * (5.0 * w.y).cos() + 0.1 * (11.0 * w.z).sin();
    let knot = woven(60, 8, |u, v| {
        // A trefoil: its tube meets itself, for it is too thick.
        let t = u * std::f64::consts::TAU;
        let p = DVec3::new(t.sin() + 2.0 * (2.0 * t).sin(), t.cos() - 2.0 * (2.0 * t).cos(), -(3.0 * t).sin());
        let a = v * std::f64::consts::TAU;
        p + DVec3::new(a.cos() * p.y, -a.cos() * p.x, a.sin() * 2.0).normalize() * 0.9
    });
    vec![
        ("box", cuboid(Vec3::new(-3.0, 0.0, -1.0), Vec3::new(2.0, 7.0, 1.5))),
        ("slab", cuboid(Vec3::new(-3.0, 0.0, -4.0), Vec3::new(2.0, 0.02, 1.5))),
        ("ball", ball(24, 12, |_| 1.0)),
        ("knobbly ball", ball(24, 14, knobbly)),
        ("torus", torus(20, 10, 0.4)),
        ("thin torus", torus(24, 5, 0.03)),
        ("star", prism(&star, 1.0)),
        ("stairs", prism(&stairs, 0.5)),
        ("knot", knot),
        (
            "crossing boxes",
            joined(&[
                cuboid(Vec3::new(-2.0, -0.5, -0.5), Vec3::new(2.0, 0.5, 0.5)),
                cuboid(Vec3::new(-0.4, -3.0, -0.4), Vec3::new(0.4, 3.0, 0.6)),
            ]),
        ),
    ]
}

/// How often a closed surface winds about a point, by the solid angles of its triangles.
fn winding(surface: &[Triangle], p: DVec3) -> f64 {
    let angle = |t: &Triangle| {
        let [a, b, c] = t.map(|v| v.as_dvec3() - p);
        let (x, y, z) = (a.length(), b.length(), c.length());
        let above = a.dot(b.cross(c));
        2.0 * above.atan2(x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y)
    };
    surface.iter().map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

fn points_of(t: &Triangle, r: &mut Random) -> Vec<DVec3> {
    let [a, b, c] = t.map(|v| v.as_dvec3());
    let mut points = vec![a, b, c, (a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5, (a + b + c) / 3.0];
    for _ in 0..4 {
        let (u, v) = (r.range(0.0, 1.0), r.range(0.0, 1.0));
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        points.push(a + (b - a) * u + (c - a) * v);
    }
    points
}

#[test]
fn what_stands_in_for_a_solid_lies_inside_it() {
    let mut r = Random::new(1);
    for (name, solid) in solids() {
        let levels = OccluderLevels::new(&solid, Facing::Both, Merge::Inner);
        assert_eq!(levels.open, [], "{name} is closed");
        let surface = corners(&solid);
        let turned = if winding(&surface, inner_point(&levels)) < 0.0 { -1.0 } else { 1.0 };
        for part in &levels.closed {
            for level in &part.levels {
                for t in &level.triangles {
                    for p in points_of(t, &mut r) {
                        let w = winding(&surface, p) * turned;
                        assert!(
                            w > 0.5,
                            "{name}: {p} of {t:?}, of {} triangles, has winding number {w}",
                            level.triangles.len()
                        );
                    }
                }
            }
        }
    }
}

fn inner_point(levels: &OccluderLevels) -> DVec3 {
    let t = levels.closed[0].levels[0].triangles[0];
    (t[0] + t[1] + t[2]).as_dvec3() / 3.0
}

/// Depth and triangle at every sample of a view of one mesh.
fn picture(mesh: &Mesh, facing: Facing, view: &View) -> Vec<Option<f32>> {
    let mut builder = Builder::new();
    builder.add(mesh.positions().to_vec(), mesh.triangles().to_vec(), facing);
    let scene = builder.prepared();
    let mut canvas = Canvas::new(view.viewport(), Level::best()).unwrap();
    canvas.draw(view, &scene, &[0], 1, |jobs| jobs.iter_mut().for_each(|job| job.run())).unwrap();
    let (width, height) = (canvas.width(), canvas.height());
    (0..width * height).map(|k| canvas.item(k % width, k / width).map(|item| item.0)).collect()
}

/// Looks at a box from outside it, at a distance of `far` of its diagonals from its surface.
fn camera(mesh: &Mesh, way: DVec3, far: f64) -> Camera {
    let (min, max) = (mesh.bounds().min.as_dvec3(), mesh.bounds().max.as_dvec3());
    let (middle, radius) = ((min + max) * 0.5, (max - min).length() * 0.5);
    let distance = radius * (1.02 + far);
    let up = if way.y.abs() > 0.9 { DVec3::X } else { DVec3::Y };
    let fov = 2.0 * (radius / (distance * distance - radius * radius).sqrt().max(1e-9)).atan().to_degrees();
    Camera {
        eye: middle + way * distance,
        target: middle,
        up,
        fov_y_deg: fov.clamp(0.5, 140.0),
        near: radius * 0.005,
        far: None,
    }
}

/// What depth drawn in f32 rounds off, of itself: seen from afar, a stand-in is nearer to its original than that.
const ROUNDING: f32 = 1e-6;

/// Samples that the stand-in covers and the original does not cover, or only farther; and how many of them lie within
/// 1/256 pixel of an edge of the original.
fn counterexamples(original: &Mesh, standin: &Mesh, view: &View) -> (usize, usize) {
    let (a, b) = (picture(original, Facing::Both, view), picture(standin, Facing::Both, view));
    let width = view.viewport().width() as usize;
    let wrong: Vec<usize> = (0..a.len())
        .filter(|&k| b[k].is_some_and(|depth| a[k].is_none_or(|drawn| drawn < depth * (1.0 - ROUNDING))))
        .collect();
    if wrong.is_empty() {
        return (0, 0);
    }
    let triangles: Vec<float::Triangle> = corners(original)
        .into_iter()
        .filter_map(|t| float::Triangle::new(t.map(|p| float::clip(view, p.as_dvec3()))))
        .collect();
    let at_edge = |&&k: &&usize| {
        let (x, y) = (float::center((k % width) as u32), float::center((k / width) as u32));
        triangles.iter().any(|t| t.at(x, y, 1.0) == float::Answer::Rim)
    };
    (wrong.len(), wrong.iter().filter(at_edge).count())
}

#[test]
fn no_viewer_outside_sees_a_stand_in_where_he_does_not_see_its_solid() {
    let mut r = Random::new(2);
    let (mut samples, mut listed) = (0, 0);
    for (name, solid) in solids() {
        let levels = OccluderLevels::new(&solid, Facing::Both, Merge::Inner);
        let total = levels.closed_triangles();
        for budget in [total, total / 3, total / 10, 4] {
            let standin = levels.within(budget).inside;
            for k in 0..6 {
                let far = [0.0, 0.1, 0.5, 2.0, 30.0, 3000.0][k];
                let view = camera(&solid, direction(&mut r), far).view(viewport(96, 96)).unwrap();
                let (wrong, at_edge) = counterexamples(&solid, &standin, &view);
                assert_eq!(wrong, at_edge, "{name}, {budget} triangles, from {}", view.eye());
                samples += 96 * 96;
                listed += at_edge;
            }
        }
    }
    println!("{listed} of {samples} samples differ, all within 1/256 pixel of an edge of the original");
    assert!(listed * 10_000 < samples);
}

/// The ball keeps nine tenths; a torus, whose hole may not grow over, and a column of 156 triangles, which leaves 15, fall
/// short of that: their bounds only hold what is reached.
#[test]
fn a_tenth_of_a_round_solid_covers_most_of_it() {
    for (name, solid, least) in [
        ("ball", ball(48, 24, |_| 1.0), 0.9),
        ("torus", torus(48, 24, 0.4), 0.85),
        ("column", prism(&ring(40), 5.0), 0.84),
    ] {
        let simplified = simplify_occluder(&solid, Facing::Both, 0.1);
        let share = simplified.triangles() as f64 / solid.triangles().len() as f64;
        assert!(share <= 0.1, "{name}: {share} of the triangles");
        let kept = covered(&simplified.inside) / covered(&solid);
        println!("{name}: {} of {} triangles cover {kept:.3}", simplified.triangles(), solid.triangles().len());
        assert!(kept >= least && kept <= 1.0, "{name}: {kept} of the area");
    }
}

fn ring(n: usize) -> Vec<(f32, f32)> {
    (0..n)
        .map(|i| {
            let (s, c) = (-(i as f64) / n as f64 * std::f64::consts::TAU).sin_cos();
            (c as f32, s as f32)
        })
        .collect()
}

/// Samples covered, from the 26 directions of a cube's neighbours, far away.
fn covered(mesh: &Mesh) -> f64 {
    let box_of = cuboid(Vec3::splat(-6.0), Vec3::splat(6.0));
    let mut sum = 0;
    for n in (0..27).filter(|&n| n != 13) {
        let way = DVec3::new(f64::from(n / 9) - 1.0, f64::from(n / 3 % 3) - 1.0, f64::from(n % 3) - 1.0).normalize();
        let view = camera(&box_of, way, 100.0).view(viewport(160, 160)).unwrap();
        sum += picture(mesh, Facing::Both, &view).iter().flatten().count();
    }
    f64::from(sum as u32)
}

/// Figure 7.1: a building and its two diagonals.
#[test]
fn two_diagonals_stand_in_for_a_building_for_whom_walks_on_the_ground() {
    let building = cuboid(Vec3::new(-6.0, 0.0, -4.0), Vec3::new(6.0, 9.0, 4.0));
    let inside = Enclosure::of(&building, Facing::Both).unwrap();
    let diagonals = |size: f32| {
        let at = |x: f32, y: f32, z: f32| Vec3::new(x * 6.0 * size, 4.5 + y * 4.5 * size, z * 4.0 * size);
        let sheet = |z: f32| {
            let [a, b, c, d] = [at(-1.0, -1.0, -z), at(1.0, -1.0, z), at(1.0, 1.0, z), at(-1.0, 1.0, -z)];
            [[a, b, c], [a, c, d]]
        };
        [sheet(1.0), sheet(-1.0)].concat()
    };
    // As drawn in the figure they touch the walls, and larger ones stand out: neither is proven.
    assert!(diagonals(0.999).iter().all(|&t| inside.contains(t)));
    assert!(!diagonals(1.0).iter().any(|&t| inside.contains(t)));
    assert!(!diagonals(1.001).iter().any(|&t| inside.contains(t)));

    let sheets = mesh(&diagonals(0.999));
    for k in 0..24 {
        let (s, c) = (f64::from(k) * 0.27).sin_cos();
        // From afar each sheet covers its own parallel projection: that much at least, and no more than both together.
        let [one, other] = [4.0 * c + 6.0 * s, 4.0 * c - 6.0 * s].map(|side: f64| side.abs() * 18.0);
        let whole = c.abs() * 72.0 + 3.0 * 96.0 + s.abs() * 108.0;
        let steep = (one.max(other) / whole, (one + other) / whole);
        for (height, far, (least, most)) in
            [(0.0, 100.0, (0.99, 1.0)), (0.0, 2.0, (0.8, 1.0)), (3.0, 100.0, (steep.0 * 0.97, steep.1 * 1.03))]
        {
            let view = camera(&building, DVec3::new(c, height, s).normalize(), far).view(viewport(128, 128)).unwrap();
            let count = |mesh: &Mesh| picture(mesh, Facing::Both, &view).iter().flatten().count() as f64;
            let kept = count(&sheets) / count(&building);
            assert!(kept >= least && kept <= most, "{kept} of the building, looking along ({c}, {height}, {s})");
            let (wrong, at_edge) = counterexamples(&building, &sheets, &view);
            assert_eq!(wrong, at_edge);
        }
    }
    // From above they are two lines: what changes occlusion is the viewpoint, and never to the wrong side.
    let above = camera(&building, DVec3::Y, 100.0).view(viewport(128, 128)).unwrap();
    let lines = picture(&sheets, Facing::Both, &above).iter().flatten().count();
    assert!(lines * 20 < picture(&building, Facing::Both, &above).iter().flatten().count());

    // The library finds such sheets by itself.
    let four = OccluderLevels::new(&building, Facing::Both, Merge::Inner).within(4);
    assert!(four.inside.triangles().len() <= 4 && four.area[1] > 0.7 * four.area[0], "{four:?}");
}

#[test]
fn inside_a_tetrahedron_is_what_integers_say() {
    let mut r = Random::new(3);
    let mut counts = [0; 2];
    while counts[0] < 300 || counts[1] < 300 {
        let mut point = |most: i64| [0; 3].map(|_| r.below(2 * most as usize + 1) as i64 - most);
        let solid = [point(6), point(6), point(6), point(6)];
        let volume = orient(solid[0], solid[1], solid[2], solid[3]);
        if volume == 0 {
            continue;
        }
        let t = [point(3), point(3), point(3)];
        let faces = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];
        let strictly = |p: [i64; 3]| {
            (0..4).all(|i| {
                let f = faces[i].map(|k| solid[k]);
                orient(f[0], f[1], f[2], p).signum() * orient(f[0], f[1], f[2], solid[i]).signum() > 0
            })
        };
        let float = |p: [i64; 3]| Vec3::from_array(p.map(|x| x as f32));
        let shell = mesh(&faces.map(|f| f.map(|k| float(solid[k]))));
        let expected = t.iter().all(|&p| strictly(p));
        let enclosure = Enclosure::of(&shell, Facing::Both).unwrap();
        assert_eq!(enclosure.contains(t.map(float)), expected, "{t:?} in {solid:?}");
        counts[usize::from(expected)] += 1;
    }
}

fn orient(a: [i64; 3], b: [i64; 3], c: [i64; 3], d: [i64; 3]) -> i64 {
    let v = |p: [i64; 3]| [0, 1, 2].map(|i| p[i] - a[i]);
    let [p, q, s] = [v(b), v(c), v(d)];
    p[0] * (q[1] * s[2] - q[2] * s[1]) + p[1] * (q[2] * s[0] - q[0] * s[2]) + p[2] * (q[0] * s[1] - q[1] * s[0])
}

#[test]
fn what_is_not_closed_says_why() {
    let whole = cuboid(Vec3::ZERO, Vec3::ONE);
    let reasons = |mesh: &Mesh, facing: Facing| OccluderLevels::new(mesh, facing, Merge::Inner).open;
    assert_eq!(reasons(&whole, Facing::Both), []);
    assert_eq!(reasons(&whole, Facing::Front), []);
    assert_eq!(reasons(&whole, Facing::Back), [(Open::Orientation, 12)]);
    let open = mesh(&corners(&whole)[2..]);
    assert_eq!(reasons(&open, Facing::Both), [(Open::Border, 10)]);
    let inside_out = mesh(&corners(&whole).iter().map(|&[a, b, c]| [a, c, b]).collect::<Vec<_>>());
    assert_eq!(reasons(&inside_out, Facing::Front), [(Open::NoRoom, 12)]);
    assert_eq!(reasons(&inside_out, Facing::Both), []);
    let mut mixed = corners(&whole);
    mixed[3].swap(0, 1);
    assert_eq!(reasons(&mesh(&mixed), Facing::Front), [(Open::Orientation, 12)]);
    assert_eq!(reasons(&mesh(&mixed), Facing::Both), []);
    let [a, b, c, d] = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
    let card = mesh(&[[a, b, c], [a, c, d], [a, c, b], [a, d, c]]);
    // Both sides of a card that is drawn from both sides are one too many.
    assert_eq!(reasons(&card, Facing::Front), [(Open::NoRoom, 4)]);
    assert_eq!(reasons(&card, Facing::Both), [(Open::NoRoom, 4)]);
    assert_eq!(simplify_occluder(&card, Facing::Both, 1.0).open.triangles().len(), 2);
    assert_eq!(reasons(&Mesh::new("nothing", vec![], vec![]).unwrap(), Facing::Both), []);
}

#[test]
fn an_empty_or_degenerate_mesh_simplifies_to_nothing() {
    for m in [mesh(&[]), mesh(&[[Vec3::ONE; 3]]), mesh(&[[Vec3::ZERO, Vec3::X, Vec3::ZERO]])] {
        let simplified = simplify_occluder(&m, Facing::Both, 0.5);
        assert_eq!((simplified.triangles(), simplified.joined().triangles().len()), (0, 0));
        assert_eq!(LodChain::new("m", &m).unwrap().levels().len(), 1);
    }
    let far = cuboid(Vec3::splat(1e30), Vec3::splat(2e30));
    let simplified = simplify_occluder(&far, Facing::Both, 1.0);
    assert!(corners(&simplified.inside).iter().flatten().all(|p| p.cmpgt(Vec3::splat(1e30)).all()));
    let tiny = cuboid(Vec3::splat(1e-38), Vec3::splat(3e-38));
    assert!(simplify_occluder(&tiny, Facing::Both, 1.0).triangles() <= 12);
}

#[test]
fn one_price_buys_the_best_parts_of_a_scene() {
    let big = OccluderLevels::new(&cuboid(Vec3::ZERO, Vec3::splat(10.0)), Facing::Both, Merge::Inner);
    let small = OccluderLevels::new(&ball(16, 8, |_| 0.1), Facing::Both, Merge::Inner);
    let price = price_within([&big, &small], 12);
    let (of_big, of_small) = (big.at(price), small.at(price));
    assert!(of_big.triangles() + of_small.triangles() <= 12);
    assert!(of_big.area[1] > 0.95 * of_big.area[0], "{of_big:?}");
    assert_eq!(price_within([&big, &small], 0), f64::INFINITY);
    let all: SimplifiedOccluder = small.at(0.0);
    assert!(all.area[1] > 0.99 * all.area[0] && all.area[1] <= all.area[0]);
    for part in big.closed.iter().chain(&small.closed) {
        assert!(part.levels.windows(2).all(|l| l[0].price > l[1].price && l[0].area < l[1].area));
    }
}

/// A plane of n x n squares with integer corners, tilted so that it stays exact, and a hole in it if asked for.
fn plane(n: i32, hole: bool) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let side = n + 1;
    let position = |k: i32| Vec3::new((k % side) as f32, (k % side * 2 + k / side) as f32, (k / side) as f32);
    let mut triangles = Vec::new();
    for k in (0..side * side).filter(|k| k % side < n && k / side < n) {
        let middle = k % side == n / 2 && k / side == n / 2;
        if !(hole && middle) {
            let [a, b, c, d] = [k, k + 1, k + 1 + side, k + side].map(|i| i as u32);
            triangles.extend(if k % 3 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
        }
    }
    ((0..side * side).map(position).collect(), triangles)
}

/// Twice the area, seen from above, in whole units; every triangle turning the same way.
fn area(positions: &[Vec3], triangles: &[[u32; 3]]) -> i64 {
    let one = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| positions[i as usize]);
        let twice = (b.z - a.z) * (c.x - a.x) - (b.x - a.x) * (c.z - a.z);
        assert!(twice < 0.0, "a triangle has turned over");
        twice as i64
    };
    triangles.iter().map(one).sum()
}

#[test]
fn coplanar_triangles_merge_without_a_sample_changing() {
    let mut r = Random::new(4);
    for hole in [false, true] {
        let (positions, triangles) = plane(8, hole);
        let inner = merge_coplanar(&positions, &triangles, Merge::Inner);
        let outline = merge_coplanar(&positions, &triangles, Merge::Outline);
        assert_eq!(area(&positions, &inner.triangles), area(&positions, &triangles));
        assert_eq!(area(&positions, &outline.triangles), area(&positions, &triangles));
        let edges = if hole { 32 + 4 } else { 32 };
        assert_eq!((inner.triangles.len(), inner.outline), (edges - if hole { 0 } else { 2 }, 0), "{hole}");
        assert_eq!(outline.triangles.len(), if hole { 8 } else { 2 }, "{hole}");
        let before = Mesh::new("before", positions.clone(), triangles).unwrap();
        let after = Mesh::new("after", positions.clone(), inner.triangles).unwrap();
        for _ in 0..30 {
            let view = camera(&before, direction(&mut r), r.range(0.0, 3.0)).view(viewport(96, 96)).unwrap();
            let covered = |m: &Mesh| picture(m, Facing::Both, &view).iter().map(Option::is_some).collect::<Vec<_>>();
            assert!(covered(&before) == covered(&after), "from {}", view.eye());
        }
    }
    // A bent sheet keeps its bend.
    let (mut positions, triangles) = plane(4, false);
    positions.iter_mut().for_each(|p| p.y = if p.x > 2.0 { p.x - 2.0 } else { 0.0 });
    let outline = merge_coplanar(&positions, &triangles, Merge::Outline);
    assert_eq!((outline.triangles.len(), area(&positions, &outline.triangles)), (4, area(&positions, &triangles)));
}

#[test]
fn levels_of_detail_are_chosen_by_projected_error() {
    let chain = LodChain::new("ball", &ball(48, 24, |_| 1.0)).unwrap();
    let levels = chain.levels();
    assert!(levels.len() >= 4 && levels[0].error == 0.0);
    for pair in levels.windows(2) {
        let (finer, coarser) = (pair[0].mesh.triangles().len(), pair[1].mesh.triangles().len());
        assert!(coarser * 10 <= finer * 8 && coarser * 10 >= finer * 4, "{finer} to {coarser}");
        assert!(pair[0].error < pair[1].error);
    }
    assert_eq!(LodChain::new("ball", &ball(48, 24, |_| 1.0)).unwrap(), chain);
    assert_eq!(chain.choose(f64::INFINITY, 4.0), 0);
    assert_eq!(chain.choose(f64::NAN, 4.0), 0);
    assert_eq!(chain.choose(100.0, 0.0), 0);
    assert_eq!(chain.choose(1e-9, 1.0), levels.len() - 1);
    for (k, level) in levels.iter().enumerate().skip(1) {
        assert_eq!(chain.choose(1.0 / level.error * 0.999, 1.0), k);
        assert_eq!(chain.choose(1.0 / level.error * 1.001, 1.0), k - 1);
    }
}

#[test]
fn a_unit_ten_units_away_is_a_tenth_of_the_focal_length() {
    let camera = Camera {
        eye: DVec3::new(1000.0, 0.0, 0.0),
        target: DVec3::new(1000.0, 0.0, -1.0),
        up: DVec3::Y,
        fov_y_deg: 90.0,
        near: 0.1,
        far: None,
    };
    let view = camera.view(viewport(300, 200)).unwrap();
    let cube = |z: f32| cuboid(Vec3::new(-1.0, -1.0, z - 2.0), Vec3::new(1.0, 1.0, z)).bounds();
    let origin = DVec3::new(1000.0, 0.0, 0.0);
    assert!((pixels_a_unit(&view, cube(-10.0), origin) - 10.0).abs() < 1e-9);
    assert!((pixels_a_unit(&view, cube(-50.0), origin) - 2.0).abs() < 1e-9);
    assert_eq!(pixels_a_unit(&view, cube(1.0), origin), f64::INFINITY);
    assert_eq!(pixels_a_unit(&view, cube(20.0), origin), f64::INFINITY);
    assert_eq!(pixels_a_unit(&view, mesh(&[]).bounds(), origin), f64::INFINITY);
}
