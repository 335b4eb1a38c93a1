//! The occluder database and static selection (Zhang 1998, 7.1 and 7.3): what may occlude, and what of it is chosen.
#![cfg(feature = "bvh")]

mod oracle;

use glam::{DVec3, Vec3};
use homcull::cull::{HomParameters, Method, OccluderSources, Update};
use homcull::geometry::Aabb;
use homcull::measure::walk::{WalkOptions, walk};
use homcull::occlusion::Occluder;
use homcull::raster::{Facing, MeshId, PreparedMeshes};
use homcull::scene::{PreparedScene, parse};
use homcull::select::{Criterion, Measure, OccluderDatabase, Order, StaticCriteria, StaticSelection, WalkMemory};
use homcull::view::View;
use homcull::workers::Workers;
use homcull::{Error, Level};
use oracle::random::Random;
use oracle::scenes::{Builder, camera, city, viewport};

fn choose(database: &OccluderDatabase, level: Level, view: &View, order: Order, limit: u64) -> Vec<u32> {
    let mut chosen = Vec::new();
    database.choose(level, view, order, limit, &|_| true, &mut WalkMemory::default(), &mut chosen);
    chosen
}

/// How far inside the frustum a box reaches, by its best corner at each plane, relative to the terms' size: above 0 it may
/// meet the frustum, below it cannot. Rows are those of the view, in f64.
fn reach(view: &View, b: Aabb, origin: DVec3) -> f64 {
    let [x, y, w, depth, near] = *view.rows();
    let (right, bottom) = (f64::from(view.viewport().width()) * 256.0, f64::from(view.viewport().height()) * 256.0);
    let planes = [near, x, w * right - x, y, w * bottom - y, depth];
    let corners = oracle::scenes::cuboid_corners(b.min, b.max).map(|c| c.as_dvec3() + origin - view.eye());
    let best = |plane: &glam::DVec4| {
        let terms = |c: DVec3| (plane.truncate() * c).to_array().into_iter().chain([plane.w]);
        let size: f64 = corners.iter().map(|&c| terms(c).map(f64::abs).sum::<f64>()).fold(0.0, f64::max);
        corners.iter().map(|&c| terms(c).sum::<f64>()).fold(f64::MIN, f64::max) / size.max(1e-300)
    };
    planes.iter().map(best).fold(f64::MAX, f64::min)
}

#[test]
fn a_walk_through_the_tree_chooses_what_a_sort_of_everything_would() {
    let mut r = Random::new(71);
    for round in 0..12 {
        let eye = Vec3::new(r.float(-20.0, 20.0), r.float(0.0, 8.0), r.float(-20.0, 20.0));
        let scene = PreparedScene::new(&city(&mut r, eye, 300)).unwrap();
        let view = camera(&mut r, eye.as_dvec3()).view(viewport(320, 200)).unwrap();
        let database = OccluderDatabase::of_scene(&scene, |id| id % 5 != 3);
        let about = (view.eye() - scene.origin).as_vec3();
        for (measure, limit) in [(Measure::Center, 400), (Measure::Nearest, 150), (Measure::Center, u64::MAX)] {
            let chosen = choose(&database, Level::best(), &view, Order::Distance(measure), limit);
            let key = |id: u32| {
                let b = scene.bounds[id as usize];
                let distance = match measure {
                    Measure::Center => (b.min * 0.5 + b.max * 0.5 - about).length_squared(),
                    Measure::Nearest => (about.clamp(b.min, b.max) - about).length_squared(),
                };
                (distance, id)
            };
            assert!(chosen.is_sorted_by(|&a, &b| key(a) < key(b)), "round {round}: not nearest first");
            let total: u64 = chosen.iter().map(|&id| u64::from(scene.triangles(id))).sum();
            assert!(total <= limit || chosen.len() == 1, "round {round}: {total} triangles");
            let last = chosen.last().map(|&id| key(id));
            for id in 0..scene.bounds.len() as u32 {
                let inside = reach(&view, scene.bounds[id as usize], scene.origin);
                let taken = chosen.contains(&id);
                assert!(!taken || (id % 5 != 3 && inside > -1e-5), "round {round}: object {id} at {inside}");
                let must = id % 5 != 3 && inside > 1e-5 && last.is_some_and(|last| key(id) < last);
                assert!(taken || !must, "round {round}: nearer object {id} is left out");
                let fits = total + u64::from(scene.triangles(id)) <= limit;
                let next = id % 5 != 3 && inside > 1e-5 && limit == u64::MAX;
                assert!(taken || !(next && fits), "round {round}: object {id} would fit");
            }
        }
    }
}

#[test]
fn a_z_plane_takes_what_reaches_nearer_and_nothing_else() {
    let mut r = Random::new(72);
    let eye = Vec3::new(3.0, 2.0, -4.0);
    let scene = PreparedScene::new(&city(&mut r, eye, 400)).unwrap();
    let view = camera(&mut r, eye.as_dvec3()).view(viewport(320, 200)).unwrap();
    let database = OccluderDatabase::of_scene(&scene, |_| true);
    let forward = view.rows()[2].truncate().normalize().as_vec3();
    let chosen = choose(&database, Level::best(), &view, Order::ZPlane { forward, distance: 12.0 }, u64::MAX);
    assert!(!chosen.is_empty());
    for id in 0..scene.bounds.len() as u32 {
        let b = scene.bounds[id as usize];
        let corners = oracle::scenes::cuboid_corners(b.min, b.max);
        let nearest = corners
            .map(|c| (c.as_dvec3() + scene.origin - eye.as_dvec3()).dot(forward.as_dvec3()))
            .into_iter()
            .fold(1e9, f64::min);
        let inside = reach(&view, b, scene.origin);
        let taken = chosen.contains(&id);
        assert!(!taken || (nearest < 12.001 && inside > -1e-5), "object {id} reaches {nearest}");
        assert!(taken || nearest > 11.999 || inside < 1e-5, "object {id} reaches {nearest} and is left out");
    }
}

#[test]
fn every_level_chooses_the_same() {
    let mut r = Random::new(73);
    let scene = PreparedScene::new(&city(&mut r, Vec3::ZERO, 500)).unwrap();
    let database = OccluderDatabase::of_scene(&scene, |_| true);
    for _ in 0..6 {
        let view = camera(&mut r, DVec3::ZERO).view(viewport(320, 200)).unwrap();
        let list: Vec<u32> = (0..scene.bounds.len() as u32 + 40).rev().collect();
        let choices = Level::ALL.into_iter().filter(|l| l.is_available()).map(|level| {
            let mut in_order = Vec::new();
            database.choose_in_order(level, &view, &list, 700, &mut in_order);
            (choose(&database, level, &view, Order::Distance(Measure::Center), 700), in_order)
        });
        let choices: Vec<_> = choices.collect();
        assert!(choices.iter().all(|c| *c == choices[0]), "{choices:?}");
        let (_, in_order) = &choices[0];
        assert!(in_order.is_sorted_by(|a, b| a > b), "a list is taken in its own order");
        assert!(in_order.iter().all(|&id| reach(&view, scene.bounds[id as usize], scene.origin) > -1e-5));
    }
}

#[test]
fn the_first_occluder_is_taken_however_large_and_candidates_may_be_turned_down() {
    let mut b = Builder::new();
    for z in 1..=3 {
        b.cuboid(Vec3::new(-1.0, -1.0, -10.0 * z as f32), Vec3::new(1.0, 1.0, 1.0 - 10.0 * z as f32), Facing::Both);
    }
    let scene = b.prepared();
    let database = OccluderDatabase::of_scene(&scene, |_| true);
    let mut r = Random::new(1);
    let mut camera = camera(&mut r, DVec3::ZERO);
    (camera.target, camera.up, camera.far) = (-DVec3::Z, DVec3::Y, None);
    let view = camera.view(viewport(64, 64)).unwrap();
    let order = Order::Distance(Measure::Center);
    assert_eq!(choose(&database, Level::best(), &view, order, 5), [0]);
    assert_eq!(choose(&database, Level::best(), &view, order, 24), [0, 1]);
    let mut chosen = Vec::new();
    database.choose(Level::best(), &view, order, 12, &|id| id != 0, &mut WalkMemory::default(), &mut chosen);
    assert_eq!(chosen, [1]);
}

#[test]
fn glass_and_nothing_are_in_no_database() {
    let mut b = Builder::new();
    b.cuboid(Vec3::ZERO, Vec3::ONE, Facing::Both);
    b.cuboid(Vec3::ZERO, Vec3::ONE, Facing::Both).opacity = 0.0;
    b.triangles(&[], Facing::Both);
    let database = OccluderDatabase::of_scene(&b.prepared(), |_| true);
    assert_eq!((0..4).map(|id| database.contains(id)).collect::<Vec<_>>(), [true, false, false, false]);
    assert_eq!(database.len(), 1);
    // Nor is what has no finite box about the scene's origin.
    b.0.objects[0].position = DVec3::splat(1e300);
    assert!(OccluderDatabase::of_scene(&b.prepared(), |_| true).is_empty());
}

/// A wall of 4 by 3 metres, and a flat box in front of it.
fn wall_and_clock(gap: f32) -> Builder {
    let mut b = Builder::new();
    b.cuboid(Vec3::new(-2.0, 0.0, -0.3), Vec3::new(2.0, 3.0, 0.0), Facing::Front);
    b.cuboid(Vec3::new(-0.25, 1.5, gap), Vec3::new(0.25, 2.0, gap + 0.03), Facing::Front);
    b
}

fn redundant(b: &Builder) -> Vec<u32> {
    let criteria = StaticCriteria { size: None, ..StaticCriteria::default() };
    let selection = StaticSelection::new(&b.prepared(), &criteria).unwrap();
    (0..b.0.objects.len() as u32).filter(|&id| selection.flags(id, Criterion::Redundancy)).collect()
}

#[test]
fn a_clock_on_a_wall_is_redundant_and_one_in_front_of_it_is_not() {
    assert_eq!(redundant(&wall_and_clock(0.0)), [1]);
    assert_eq!(redundant(&wall_and_clock(2.0)), [0u32; 0]);
}

#[test]
fn a_wall_of_glass_makes_nothing_redundant() {
    let mut b = wall_and_clock(0.0);
    b.0.objects[0].opacity = 0.0;
    assert_eq!(redundant(&b), [0u32; 0]);
}

#[test]
fn of_equal_boards_back_to_back_the_first_stays() {
    let mut b = Builder::new();
    for _ in 0..3 {
        b.cuboid(Vec3::ZERO, Vec3::new(2.0, 3.0, 0.05), Facing::Both);
    }
    assert_eq!(redundant(&b), [1, 2]);
}

#[test]
fn a_post_on_the_ground_is_not_redundant() {
    let mut b = Builder::new();
    b.cuboid(Vec3::new(-20.0, -1.0, -20.0), Vec3::new(20.0, 0.0, 20.0), Facing::Front);
    b.cuboid(Vec3::ZERO, Vec3::new(0.2, 4.0, 0.2), Facing::Front);
    // A mat is.
    b.cuboid(Vec3::new(3.0, 0.0, 3.0), Vec3::new(4.0, 0.02, 4.0), Facing::Front);
    assert_eq!(redundant(&b), [2]);
}

#[test]
fn a_turned_scene_far_out_has_the_same_redundant_objects() {
    let mut b = wall_and_clock(0.0);
    for object in &mut b.0.objects {
        object.position = DVec3::new(3.0e7, -2.0e6, 5.0e7);
    }
    assert_eq!(redundant(&b), [1]);
}

#[test]
fn boxes_are_judged_by_size_locality_aspect_and_triangles() {
    let mut b = Builder::new();
    // The scene is 1000 metres long.
    b.cuboid(Vec3::ZERO, Vec3::new(1000.0, 1.0, 1.0), Facing::Front);
    b.cuboid(Vec3::new(0.0, 50.0, 0.0), Vec3::new(0.3, 50.3, 0.3), Facing::Front);
    b.cuboid(Vec3::new(0.0, 60.0, 0.0), Vec3::new(5.0, 65.0, 5.0), Facing::Front);
    let many: Vec<[Vec3; 3]> = (0..40)
        .map(|i| [Vec3::new(0.0, 70.0 + i as f32 * 0.1, 0.0), Vec3::new(9.0, 75.0, 0.0), Vec3::new(0.0, 70.0, 9.0)])
        .collect();
    b.triangles(&many, Facing::Both);
    let scene = b.prepared();
    let criteria = StaticCriteria { complexity: Some(39), redundancy: None, ..StaticCriteria::for_estimation_buffer() };
    let selection = StaticSelection::new(&scene, &criteria).unwrap();
    let flagged =
        |id| Criterion::ALL.into_iter().filter(|&c| selection.flags(id, c)).map(Criterion::name).collect::<Vec<_>>();
    assert_eq!(flagged(0), ["locality", "aspect"]);
    assert_eq!(flagged(1), ["size"]);
    assert_eq!(flagged(2), [""; 0]);
    assert_eq!(flagged(3), ["complexity"]);
    assert_eq!((selection.candidates(), selection.kept(), selection.rejected_by(Criterion::Size)), (4, 1, 1));
    assert!(selection.admits(2) && !selection.admits(3));
}

#[test]
fn criteria_are_parameters_of_hom() {
    let parameters = |text: &str| Method::parse(text).map(|m| m.parameters());
    let all = parameters("hom").unwrap();
    assert!(all.contains(&("database".into(), "all".into())), "{all:?}");
    let set = parameters("hom:database=static,static-size=0.01,static-redundancy=off,static-complexity=7").unwrap();
    for (key, value) in
        [("static-size", "0.01"), ("static-redundancy", "off"), ("static-complexity", "7"), ("static-aspect", "off")]
    {
        assert!(set.contains(&(key.into(), value.into())), "{set:?}");
    }
    for wrong in [
        "database=some",
        "static-size=0.1",
        "database=static,static-size=2",
        "database=static,static-aspect=0.5",
        "database=static,static-complexity=-1",
        "database=static,static-beauty=1",
    ] {
        let error = parameters(&format!("hom:{wrong}")).unwrap_err();
        assert!(matches!(error, Error::Parameter { .. }), "{wrong}: {error:?}");
    }
}

/// Every method draws the picture of everything in the frustum.
fn keep_the_picture(scene: &PreparedScene, views: &[View], methods: &[&str]) {
    let methods: Vec<Method> = methods.iter().map(|m| Method::parse(m).unwrap()).collect();
    let workers = Workers::new(1).unwrap();
    let options = WalkOptions { level: Level::best(), workers: &workers, repetitions: 1, exact: true };
    let report = walk("scene", scene, views, &methods, &options, |_| Ok(())).unwrap();
    for run in &report.runs {
        let wrong: u32 = run.frames.iter().filter_map(|f| f.wrongly_culled).sum();
        let pixels: u64 = run.frames.iter().filter_map(|f| f.wrong_pixels).sum();
        assert_eq!((wrong, pixels), (0, 0), "{} {:?}", run.method, run.parameters);
        assert_eq!(run.image_hash, report.runs[0].image_hash, "{} {:?}", run.method, run.parameters);
    }
}

#[test]
fn whatever_the_database_the_picture_stays() {
    let generated = parse("city:triangles=20000").unwrap();
    let scene = PreparedScene::new(&generated.scene).unwrap();
    let views: Vec<View> =
        generated.path.sample(4).unwrap().iter().map(|c| c.view(viewport(320, 256)).unwrap()).collect();
    let methods = [
        "vfc",
        "hom:rest=0",
        "hom:rest=0,database=static",
        "hom:rest=0,database=static,static-size=0.5,occluder-triangles=500",
        "hom:rest=0,database=static,static-locality=0.1,static-aspect=3,select=nearest",
        "hom:rest=0,database=static,select=zplane,z=40",
    ];
    keep_the_picture(&scene, &views, &methods);
}

#[test]
fn given_meshes_occlude_and_must_fit_their_boxes() {
    let mut b = Builder::new();
    // Behind a wall that is made of a thousand slats stands a box.
    let slat = |i: usize| {
        let y = i as f32 * 0.01 - 5.0;
        [Vec3::new(-5.0, y, -10.0), Vec3::new(5.0, y, -10.0), Vec3::new(5.0, y + 0.01, -10.0)]
    };
    let other = |i: usize| slat(i).map(|v| Vec3::new(-v.x, -v.y, v.z));
    let slats: Vec<[Vec3; 3]> = (0..1000).flat_map(|i| [slat(i), other(i)]).collect();
    b.triangles(&slats, Facing::Both);
    b.cuboid(Vec3::new(-1.0, -1.0, -20.0), Vec3::new(1.0, 1.0, -19.0), Facing::Both);
    let scene = b.prepared();
    let mut meshes = PreparedMeshes::new();
    let board = [
        Vec3::new(-5.0, -5.0, -10.0),
        Vec3::new(5.0, -5.0, -10.0),
        Vec3::new(5.0, 5.0, -10.0),
        Vec3::new(-5.0, 5.0, -10.0),
    ];
    let mesh = meshes.add(&board, &[[0, 1, 2], [0, 2, 3]]).unwrap();
    let occluder = Occluder {
        mesh,
        position: DVec3::ZERO,
        rotation: None,
        facing: Facing::Both,
        opaque: true,
        optical_depth: 0,
        luminance: 0,
    };
    let given = |occluder, boxes: &[Aabb]| {
        OccluderDatabase::of_meshes(meshes.clone(), vec![occluder], boxes.into(), DVec3::ZERO)
    };
    let bounds = Aabb::around(board);
    assert!(matches!(given(occluder, &[]), Err(Error::Parameter { name, .. }) if name == "bounds"));
    let unknown = Occluder { mesh: MeshId::from_index(1), ..occluder };
    assert!(matches!(given(unknown, &[bounds]), Err(Error::Parameter { name, .. }) if name == "occluder"));

    use homcull::cull::hom::{self, HomFrame};
    let world = homcull::cull::vfc::World::new(&scene);
    let parameters = HomParameters { rest: 0, occluder_triangles: 2, ..HomParameters::new(Update::Once) };
    let mut camera = camera(&mut Random::new(1), DVec3::ZERO);
    (camera.target, camera.up, camera.far) = (-DVec3::Z, DVec3::Y, None);
    let view = camera.view(viewport(64, 64)).unwrap();
    let mut frame = HomFrame::new(&view, Level::best(), &parameters).unwrap();
    let sources = OccluderSources::with_database(given(occluder, &[bounds]).unwrap(), &scene, &parameters);
    frame.set_sources(std::sync::Arc::new(sources));
    let frame = hom::select_occluders(&world, Level::best(), &view, &parameters, frame).unwrap();
    assert_eq!(frame.chosen(), [0]);
    let workers = Workers::new(1).unwrap();
    let frame = hom::draw_occluders(&world, &workers, frame).unwrap();
    let (set, frame) = hom::cull(&world, &workers, &parameters, hom::build_pyramid(frame)).unwrap();
    assert_eq!(frame.buffer.counts().triangles, 2, "the board was drawn, not the slats");
    assert_eq!(set.objects, [0], "the box behind the board is hidden");
}
