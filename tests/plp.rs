//! Prioritized-layered projection: its octree against brute force, its budget, its heuristics; and that cPLP keeps the picture, where the
//! gem's own listing does not.
#![cfg(feature = "cli")]

mod oracle;

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use homcull::cull::plp::PlpFrame;
use homcull::cull::vfc::World;
use homcull::cull::{CellKind, Heuristic, Method, PlpCells, PlpParameters, VisibleSet};
use homcull::draw::Canvas;
use homcull::geometry::Aabb;
use homcull::measure::report::WalkReport;
use homcull::measure::walk::{WalkOptions, walk};
use homcull::raster::Facing;
use homcull::scene::{Octree, OctreeLimits, PreparedScene, Scene, parse};
use homcull::view::{Camera, View};
use homcull::workers::Workers;
use homcull_simd::Level;
use oracle::random::Random;
use oracle::scenes::{Builder, city, viewport};
use oracle::state::for_levels;
use oracle::verdicts::{samples, world};

fn octree(scene: &PreparedScene, triangles: u32) -> Octree {
    Octree::build(scene, &OctreeLimits { triangles, ..OctreeLimits::default() })
}

fn random_octrees(seed: u64) -> impl Iterator<Item = (Scene, PreparedScene, Octree)> {
    let mut r = Random::new(seed);
    (0..12).map(move |round| {
        let eye = Vec3::new(r.float(-900.0, 900.0), 0.0, r.float(-9.0, 9.0));
        let scene = city(&mut r, eye, 10 + 15 * round);
        let prepared = PreparedScene::new(&scene).unwrap();
        let octree = octree(&prepared, [3, 12, 60][round % 3]);
        (scene, prepared, octree)
    })
}

fn touch(a: Aabb, b: Aabb) -> bool {
    a.min.cmple(b.max).all() && b.min.cmple(a.max).all()
}

#[test]
fn leaves_know_all_that_touch_them_and_fill_the_cube() {
    for (_, _, octree) in random_octrees(1) {
        assert!(octree.len() > 8);
        let boxes = octree.bounds();
        let volume = |b: Aabb| b.size().as_dvec3().to_array().iter().product::<f64>();
        let (parts, whole) = (boxes.iter().map(|&b| volume(b)).sum::<f64>(), volume(octree.cube()));
        assert!((parts / whole - 1.0).abs() < 1e-6, "{parts} of {whole}");
        for leaf in 0..octree.len() as u32 {
            let b = boxes[leaf as usize];
            let others = (0..octree.len() as u32).filter(|&o| o != leaf && touch(b, boxes[o as usize]));
            assert_eq!(octree.neighbours(leaf), others.collect::<Vec<_>>(), "leaf {leaf}");
            assert_eq!(octree.leaf_at(b.center()), Some(leaf));
            assert_eq!(octree.leaf_at(b.min), Some(leaf), "the upper leaf holds the plane");
            let sides = (0..3).fold(0, |m, a| {
                let at = |upper: bool| {
                    if upper { b.max[a] == octree.cube().max[a] } else { b.min[a] == octree.cube().min[a] }
                };
                m | u8::from(at(false)) << a | u8::from(at(true)) << (a + 3)
            });
            assert_eq!(octree.boundary(leaf), sides);
        }
        assert_eq!(octree.leaf_at(octree.cube().max + Vec3::ONE), None);
    }
}

/// Whether any of a triangle lies in a box: what clipping to its six sides leaves.
fn clipped_is_there(triangle: [DVec3; 3], min: DVec3, max: DVec3) -> bool {
    let (low, high) = triangle.iter().fold((triangle[0], triangle[0]), |(l, h), &p| (l.min(p), h.max(p)));
    if high.cmplt(min).any() || low.cmpgt(max).any() {
        return false;
    }
    let mut polygon = triangle.to_vec();
    for axis in 0..3 {
        for (side, sign) in [(min[axis], 1.0), (max[axis], -1.0)] {
            let inside = |p: DVec3| (p[axis] - side) * sign;
            let mut kept = Vec::new();
            for (i, &q) in polygon.iter().enumerate() {
                let p = polygon[(i + polygon.len() - 1) % polygon.len()];
                let (a, b) = (inside(p), inside(q));
                if (a < 0.0) != (b < 0.0) {
                    kept.push(p + (q - p) * (a / (a - b)));
                }
                if b >= 0.0 {
                    kept.push(q);
                }
            }
            polygon = kept;
        }
    }
    !polygon.is_empty()
}

#[test]
fn a_triangle_is_in_every_leaf_that_it_touches() {
    let mut checked = 0;
    for (scene, prepared, octree) in random_octrees(2) {
        let listed: Vec<BTreeSet<u32>> =
            (0..octree.len() as u32).map(|l| octree.objects(l).iter().copied().collect()).collect();
        let (mut surely, mut maybe) = (vec![0; octree.len()], vec![0; octree.len()]);
        for (id, object) in scene.objects.iter().enumerate() {
            let mesh = &scene.meshes[object.mesh as usize];
            let mut near = vec![false; octree.len()];
            for t in mesh.triangles() {
                let corner = |i: u32| object.rotation.as_dmat3() * mesh.positions()[i as usize].as_dvec3();
                let triangle = t.map(|i| corner(i) + (object.position - prepared.origin));
                let size = triangle.iter().fold(1.0f64, |s, p| s.max(p.abs().max_element()));
                let slack = DVec3::splat(size * 1e-6);
                for (leaf, b) in octree.bounds().iter().enumerate() {
                    let (min, max) = (b.min.as_dvec3(), b.max.as_dvec3());
                    if clipped_is_there(triangle, min + slack, max - slack) {
                        surely[leaf] += 1;
                        assert!(listed[leaf].contains(&(id as u32)), "object {id} touches leaf {leaf}");
                    }
                    if clipped_is_there(triangle, min - slack, max + slack) {
                        (maybe[leaf], near[leaf]) = (maybe[leaf] + 1, true);
                    }
                    checked += 1;
                }
            }
            let far = (0..octree.len()).find(|&l| listed[l].contains(&(id as u32)) && !near[l]);
            assert_eq!(far, None, "object {id} is in a leaf that it does not touch");
        }
        for leaf in 0..octree.len() {
            assert!((surely[leaf]..=maybe[leaf]).contains(&octree.triangles(leaf as u32)), "leaf {leaf}");
        }
    }
    assert!(checked > 100_000, "{checked}");
}

#[test]
fn a_box_shows_its_sides_and_so_does_a_sheet() {
    let (size, middle) = (Vec3::new(16.0, 8.0, 2.0), Vec3::new(30.0, -4.0, 7.0));
    let mut b = Builder::new();
    b.cuboid(middle - size * 0.5, middle + size * 0.5, Facing::Front);
    let sheet = [Vec3::ZERO, Vec3::X * 6.0, Vec3::new(6.0, 4.0, 0.0), Vec3::Y * 4.0];
    b.triangles(&[[sheet[0], sheet[1], sheet[2]], [sheet[0], sheet[2], sheet[3]]], Facing::Both);
    b.triangles(&[[Vec3::ZERO, Vec3::X, Vec3::X * 2.0]], Facing::Both);
    let quarter = b.cuboid(-size * 0.5, size * 0.5, Facing::Front);
    quarter.rotation = glam::Mat3::from_cols(Vec3::Y, -Vec3::X, Vec3::Z);
    let areas = homcull::scene::shown_areas(&b.prepared());
    let of_box = Vec3::new(size.y * size.z, size.z * size.x, size.x * size.y);
    let turned = Vec3::new(of_box.y, of_box.x, of_box.z);
    assert_eq!(areas, [of_box, Vec3::Z * 24.0, Vec3::ZERO, turned]);
}

fn frame(level: Level, world: &World<'_>, parameters: &PlpParameters) -> PlpFrame {
    PlpFrame::new(level, Arc::new(PlpCells::new(world.scene, parameters)))
}

/// A frame of cPLP, and its picture.
fn cplp(frame: &mut PlpFrame, world: &World<'_>, view: &View, parameters: &PlpParameters) -> (VisibleSet, Canvas) {
    let mut canvas = Canvas::new(view.viewport(), Level::best()).unwrap();
    let set = frame.cplp(world, view, parameters, &mut canvas).unwrap();
    (set, canvas)
}

/// The picture of everything.
fn picture(view: &View, scene: &PreparedScene) -> Canvas {
    let mut canvas = Canvas::new(view.viewport(), Level::best()).unwrap();
    let all: Vec<u32> = (0..scene.occluders.len() as u32).collect();
    canvas.draw(view, scene, &all, 1, |_| ()).unwrap();
    canvas
}

/// Panics unless cPLP's set holds all that shows, the front alone found it, and the picture is that of everything.
fn cplp_shows_all(what: &str, view: &View, scene: &PreparedScene, parameters: &PlpParameters) -> PlpFrame {
    let world = World::new(scene);
    let (shown, _) = samples(view, scene);
    for_levels(what, |level| {
        let mut frame = frame(level, &world, parameters);
        let mut canvas = Canvas::new(view.viewport(), level).unwrap();
        let set = frame.cplp(&world, view, parameters, &mut canvas).unwrap();
        let strays = frame.strays();
        for (id, &count) in shown.iter().enumerate().filter(|(_, count)| **count > 0) {
            let id = id as u32;
            assert!(set.objects.contains(&id), "{what}: object {id} shows {count} samples, but is hidden, {view:?}");
            let beside = count <= 2 && strays.contains(&id) || !scene.bounds[id as usize].is_finite();
            assert!(!strays.contains(&id) || beside, "{what}: object {id} with {count} samples is a stray, {view:?}");
        }
        set.objects
    });
    let mut frame = frame(Level::best(), &world, parameters);
    let (_, canvas) = cplp(&mut frame, &world, view, parameters);
    assert!(canvas.equals(&picture(view, scene)), "{what}: the picture is another one, {view:?}");
    frame
}

#[test]
fn cplp_shows_all_that_shows_in_random_cities() {
    let mut r = Random::new(3);
    for round in 0..48 {
        let (view, mut scene) = world(&mut r, round, 90);
        scene.occluders.iter_mut().step_by(7).for_each(|o| o.opaque = false);
        let heuristic = [Heuristic::Solidity, Heuristic::Layer][round / 2 % 2];
        let (budget, leaf) = ([0, 100, 400][round % 3], [5, 40, 2000][round / 3 % 3]);
        let parameters = PlpParameters { budget, heuristic, leaf, ..PlpParameters::default() };
        cplp_shows_all(&format!("round {round}"), &view, &scene, &parameters);
    }
}

#[test]
fn an_eye_outside_that_looks_obliquely_sees_what_is_in_the_corner_of_its_view() {
    let mut r = Random::new(4);
    let scene = PreparedScene::new(&city(&mut r, Vec3::ZERO, 120)).unwrap();
    let (mut seen, mut many) = (0, 0);
    for round in 0..24 {
        // The whole reaches 300 around the origin: the nearest leaf is behind the eye, or beside its view.
        let angle = r.range(0.0, 6.2);
        let eye = DVec3::new(angle.cos(), r.range(-0.3, 0.3), angle.sin()) * r.range(310.0, 900.0);
        let target = DVec3::new(r.range(-60.0, 60.0), r.range(-300.0, 300.0), r.range(-60.0, 60.0));
        let aside = (target - eye).cross(DVec3::Y).normalize() * r.range(-200.0, 200.0);
        let (fov_y_deg, near) = (r.range(8.0, 40.0), [0.1, 250.0][round % 2]);
        let camera = Camera { eye, target: target + aside, up: DVec3::Y, fov_y_deg, near, far: None };
        let view = camera.view(viewport(96, 64)).unwrap();
        let parameters = PlpParameters { budget: 0, leaf: 6, ..PlpParameters::default() };
        let frame = cplp_shows_all(&format!("round {round}"), &view, &scene, &parameters);
        assert!(frame.cells().len() > 256, "{} leaves", frame.cells().len());
        seen += usize::from(samples(&view, &scene).0.iter().any(|&n| n > 0));
        many += usize::from(frame.projected().len() > 256);
    }
    assert!(seen > 12 && many > 0, "{seen} of 24 views see anything, {many} have projected more than 256 leaves");
}

#[test]
fn of_two_fronts_in_one_pixel_neither_hides_the_other() {
    // A pane of glass with slits, and another behind it, all in one pixel: what shows is behind both.
    let mut r = Random::new(5);
    for round in 0..40 {
        let mut b = Builder::new();
        for _ in 0..30 {
            let z = r.float(-40.0, -2.0);
            let half = Vec3::new(r.float(0.001, 0.4), r.float(0.001, 0.4), r.float(0.0, 0.2)) * -z * 0.2;
            let middle = Vec3::new(r.float(-0.02, 0.02) * z, r.float(-0.02, 0.02) * z, z);
            b.cuboid(middle - half, middle + half, Facing::Both);
        }
        let camera =
            Camera { eye: DVec3::ZERO, target: -DVec3::Z, up: DVec3::Y, fov_y_deg: 5.0, near: 0.1, far: Some(100.0) };
        let parameters = PlpParameters { budget: 0, leaf: 4, ..PlpParameters::default() };
        for size in [(1, 1), (2, 3)] {
            let view = camera.view(viewport(size.0, size.1)).unwrap();
            cplp_shows_all(&format!("round {round}"), &view, &b.prepared(), &parameters);
        }
    }
}

#[test]
fn the_budget_is_kept_and_more_of_it_takes_more() {
    let mut r = Random::new(6);
    for round in 0..16 {
        let (view, scene) = world(&mut r, round, 120);
        let world = World::new(&scene);
        let (shown, _) = samples(&view, &scene);
        for cells in [CellKind::Octree, CellKind::Bvh] {
            let heuristic = [Heuristic::Solidity, Heuristic::Layer][round % 2];
            let of = |budget| PlpParameters { budget, heuristic, cells, leaf: 20 };
            let mut frame = frame(Level::best(), &world, &of(0));
            let mut before: BTreeSet<u32> = BTreeSet::new();
            for budget in [0, 12, 50, 100, 300, 700, u64::MAX] {
                let set = frame.plp(&world, &view, &of(budget));
                let taken: BTreeSet<u32> = set.objects.iter().copied().collect();
                assert!(world.triangles(&set.objects) <= budget || set.objects.len() == 1, "{budget}");
                assert_eq!(taken.len(), set.objects.len(), "an object is taken once");
                assert!(before.is_subset(&taken), "what fits a smaller budget fits a larger one");
                before = taken;
            }
            let missing = (0..shown.len() as u32).find(|o| shown[*o as usize] > 2 && !before.contains(o));
            assert_eq!(missing, None, "without a budget all is found, {cells:?}, round {round}");
        }
    }
}

#[test]
fn plp_and_cplp_take_turns_and_remember_nothing() {
    let mut r = Random::new(7);
    let scene = PreparedScene::new(&city(&mut r, Vec3::ZERO, 100)).unwrap();
    let world = World::new(&scene);
    let small = PlpParameters { budget: 150, leaf: 20, ..PlpParameters::default() };
    let layers = PlpParameters { heuristic: Heuristic::Layer, ..small };
    let mut shared = frame(Level::best(), &world, &small);
    for round in 0..12 {
        let size = [(64, 48), (33, 20)][round / 4 % 2];
        let eye = DVec3::new(r.range(-9.0, 9.0), 2.0, r.range(-9.0, 9.0));
        let view = oracle::scenes::camera(&mut r, eye).view(viewport(size.0, size.1)).unwrap();
        let parameters = if round % 3 == 0 { layers } else { small };
        let mut fresh = frame(Level::best(), &world, &parameters);
        if round % 2 == 0 {
            assert_eq!(shared.plp(&world, &view, &parameters), fresh.plp(&world, &view, &parameters));
        } else {
            let [a, b] = [&mut shared, &mut fresh].map(|f| cplp(f, &world, &view, &parameters));
            assert!(a.0 == b.0 && a.1.equals(&b.1));
        }
    }
}

#[test]
fn odd_scenes_are_walked_like_others() {
    let eye = DVec3::new(0.0, 0.0, 30.0);
    let camera = Camera { eye, target: DVec3::ZERO, up: DVec3::Y, fov_y_deg: 60.0, near: 0.1, far: None };
    let view = camera.view(viewport(40, 30)).unwrap();
    let cuboids = |n: usize, at: &dyn Fn(usize) -> Vec3, half: f32| {
        let mut b = Builder::new();
        (0..n).for_each(|i| {
            b.cuboid(at(i) - half, at(i) + half, Facing::Both);
        });
        b
    };
    let mut huge = Builder::new();
    let far = 1e9;
    huge.triangles(
        &[[Vec3::new(-far, -far, -5.0), Vec3::new(far, -far, -5.0), Vec3::new(0.0, far, -5.0)]],
        Facing::Both,
    );
    huge.cuboid(Vec3::splat(-1.0), Vec3::ONE, Facing::Both);
    let mut endless = cuboids(3, &|i| Vec3::splat(i as f32), 0.5);
    endless.0.objects[1].position = DVec3::splat(1e300);
    let mut bare = cuboids(2, &|_| Vec3::ZERO, 1.0);
    bare.add(Vec::new(), Vec::new(), Facing::Both);
    let scenes = [
        ("nothing", Builder::new()),
        ("one object", cuboids(1, &|_| Vec3::ZERO, 1.0)),
        ("one point", cuboids(300, &|_| Vec3::ZERO, 0.0)),
        ("one place", cuboids(2000, &|_| Vec3::new(0.3, 0.1, 0.2), 1.0)),
        ("one line", cuboids(500, &|i| Vec3::X * (i as f32 - 250.0) * 0.1, 0.2)),
        ("far from the origin", cuboids(50, &|i| Vec3::new(3e7, i as f32, 0.0), 1.0)),
        ("one huge triangle", huge),
        ("an object without end", endless),
        ("an object without triangles", bare),
    ];
    for (name, scene) in scenes {
        let scene = scene.prepared();
        let world = World::new(&scene);
        for triangles in [0, 1, 1000] {
            let octree = octree(&scene, triangles);
            assert!(octree.bytes() < 100_000_000, "{name}: {} bytes in {} leaves", octree.bytes(), octree.len());
            assert!(octree.depth() <= homcull::scene::MAX_OCTREE_DEPTH);
        }
        let parameters = PlpParameters { leaf: 16, ..PlpParameters::default() };
        cplp_shows_all(name, &view, &scene, &parameters);
        for cells in [CellKind::Octree, CellKind::Bvh] {
            let parameters = PlpParameters { cells, ..parameters };
            let set = frame(Level::best(), &world, &parameters).plp(&world, &view, &parameters);
            let (shown, _) = samples(&view, &scene);
            assert!((0..shown.len()).all(|o| shown[o] == 0 || set.objects.contains(&(o as u32))), "{name}");
        }
    }
}

fn walked(generated: &str, frames: usize, size: (u32, u32), methods: &[&str]) -> WalkReport {
    let generated = parse(generated).unwrap();
    let scene = PreparedScene::new(&generated.scene).unwrap();
    let cameras = generated.path.sample(frames).unwrap();
    let views: Vec<View> = cameras.iter().map(|c| c.view(viewport(size.0, size.1)).unwrap()).collect();
    let methods: Vec<Method> = methods.iter().map(|m| Method::parse(m).unwrap()).collect();
    let workers = Workers::new(1).unwrap();
    let options = WalkOptions { level: Level::best(), workers: &workers, repetitions: 1, exact: true };
    walk("plp", &scene, &views, &methods, &options, |_| Ok(())).unwrap()
}

#[test]
fn cplp_keeps_the_picture_of_the_city_and_the_plant() {
    let methods = ["vfc", "cplp:budget=0,leaf=200", "cplp:budget=5000", "cplp:heuristic=layer,budget=5000,leaf=50"];
    for scene in ["city:triangles=20000", "plant:triangles=200000"] {
        let report = walked(scene, 5, (192, 128), &methods);
        for run in &report.runs {
            assert_eq!(run.wrongly_culled_objects(), Some(0), "{scene}: {:?}", run.parameters);
            assert_eq!(run.image_hash, report.runs[0].image_hash, "{scene}: {:?}", run.parameters);
        }
        let drawn = report.runs.iter().map(|run| run.mean(report.pixels()).triangles_drawn).collect::<Vec<_>>();
        assert!(drawn[1..].iter().all(|&d| d < drawn[0] * 0.65), "{scene}: there is much to cull: {drawn:?}");
    }
}

#[test]
fn solidity_shows_more_than_layers_for_the_same_budget() {
    for (scene, budget) in [("plant:triangles=1000000", 25_000), ("city:triangles=40000", 1500)] {
        let of = |heuristic: &str| format!("plp:budget={budget},leaf=4000,heuristic={heuristic}");
        let report = walked(scene, 4, (128, 96), &[&of("solidity"), &of("layer")]);
        let wrong = |i: usize| -> u64 { report.runs[i].frames.iter().filter_map(|f| f.wrong_pixels).sum() };
        assert!(wrong(0) * 3 < wrong(1) * 2, "{scene}: solidity {}, layer {}", wrong(0), wrong(1));
        let default = Method::parse("plp").unwrap().parameters();
        assert!(default.contains(&("heuristic".into(), "solidity".into())), "the better one is the default");
    }
}

#[test]
fn parameters_are_read_back_and_bad_ones_named() {
    let list = Method::parse("plp:budget=7,heuristic=layer,leaf=3").unwrap().parameters();
    let expected = [("budget", "7"), ("heuristic", "layer"), ("cells", "octree"), ("leaf", "3")];
    assert_eq!(list, expected.map(|(k, v)| (k.to_owned(), v.to_owned())));
    for wrong in ["plp:budget=-1", "plp:leaf=0", "plp:cells=kd", "plp:heuristic=best", "plp:x=1", "cplp:cells=bvh"] {
        let said = Method::parse(wrong).unwrap_err().to_string();
        let key = wrong.split([':', '=']).nth(1).unwrap();
        assert!(said.contains(key), "{wrong}: {said}");
    }
}
