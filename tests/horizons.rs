//! Statements about occlusion horizons: what they hide is hidden, however the camera is turned, and they hide most of a city.
#![cfg(feature = "cli")]

mod oracle;

use glam::{DVec2, DVec3, Mat3, Vec3};
use homcull::cull::Method;
use homcull::cull::horizons::{Horizon, Limits, Prism};
use homcull::geometry::Aabb;
use homcull::measure::walk::{WalkOptions, walk};
use homcull::raster::Facing;
use homcull::scene::{PreparedScene, parse};
use homcull::select::Prisms;
use homcull::view::{Camera, View, Viewport};
use homcull::workers::Workers;
use homcull_simd::Level;
use oracle::random::Random;
use oracle::scenes::{Builder, orthographic};

/// A house of the oracle: an upright box around `middle`, turned about the vertical by an angle.
#[derive(Debug, Clone, Copy)]
struct House {
    middle: DVec3,
    half: DVec3,
    angle: f64,
}

impl House {
    fn random(r: &mut Random) -> House {
        let (away, about) = (r.range(4.0, 90.0), r.range(0.0, 6.3));
        House {
            middle: DVec3::new(away * about.cos(), r.range(-12.0, 12.0), away * about.sin()),
            half: DVec3::new(r.range(0.5, 12.0), r.range(1.0, 20.0), r.range(0.5, 12.0)),
            angle: r.range(0.0, 3.2),
        }
    }

    fn prism(&self) -> Prism {
        let (sin, cos) = self.angle.sin_cos();
        let corner = |x: f64, z: f64| {
            let (x, z) = (x * self.half.x, z * self.half.z);
            DVec2::new(self.middle.x + x * cos - z * sin, self.middle.z + x * sin + z * cos)
        };
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        Prism { corners, low: self.middle.y - self.half.y, high: self.middle.y + self.half.y }
    }

    /// Where the way from the eye, at 0, to a point first meets the house: 1 is at the point.
    fn met(&self, point: DVec3) -> Option<f64> {
        let (sin, cos) = self.angle.sin_cos();
        let own = |v: DVec3| DVec3::new(v.x * cos + v.z * sin, v.y, v.z * cos - v.x * sin);
        let (from, way) = (own(-self.middle), own(point));
        let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
        for axis in 0..3 {
            let sides = [-self.half[axis], self.half[axis]].map(|side| (side - from[axis]) / way[axis]);
            enter = enter.max(sides[0].min(sides[1]));
            leave = leave.min(sides[0].max(sides[1]));
        }
        (enter <= leave).then_some(enter)
    }
}

#[test]
fn every_point_of_a_hidden_box_lies_behind_a_prism() {
    let mut r = Random::new(1);
    let (mut hidden, mut behind) = (0, 0);
    for _ in 0..150 {
        let houses: Vec<House> = (0..25).map(|_| House::random(&mut r)).collect();
        let mut horizon = Horizon::default();
        horizon.begin(&Limits::around(DVec3::ZERO, 1e-3));
        houses.iter().for_each(|house| horizon.add(&house.prism()));
        let mut boxes: Vec<(f64, DVec3, DVec3)> = (0..300)
            .map(|_| {
                let (away, about, size) = (r.range(2.0, 160.0), r.range(0.0, 6.3), r.range(0.01, 6.0));
                let low = DVec3::new(away * about.cos(), r.range(-20.0, 20.0), away * about.sin());
                let high = low + DVec3::new(size, r.range(0.1, 6.0), size);
                let near = low.max(-high).max(DVec3::ZERO);
                (DVec2::new(near.x, near.z).length(), low, high)
            })
            .collect();
        boxes.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, low, high) in boxes {
            let point = |r: &mut Random| {
                low + (high - low) * DVec3::new(r.range(0.0, 1.0), r.range(0.0, 1.0), r.range(0.0, 1.0))
            };
            let corners = (0..8).map(|k| DVec3::select(glam::BVec3::new(k & 1 > 0, k & 2 > 0, k & 4 > 0), low, high));
            let mut points: Vec<DVec3> = corners.collect();
            points.extend((0..40).map(|_| point(&mut r)));
            let all = points.iter().all(|&p| houses.iter().any(|house| house.met(p).is_some_and(|t| t < 1.0)));
            behind += u32::from(all);
            if horizon.hides(low, high) {
                hidden += 1;
                assert!(all, "{low} to {high} is seen between {houses:?}");
            }
        }
    }
    println!("{hidden} boxes are hidden, of {behind} that are");
    assert!(hidden * 10 > behind * 6, "most of what is hidden is found: {hidden} of {behind}");
}

#[test]
fn what_comes_out_of_order_or_around_the_eye_is_never_hidden() {
    let mut horizon = Horizon::default();
    horizon.begin(&Limits::around(DVec3::ZERO, 1e-3));
    let wall = House { middle: DVec3::X * 10.0, half: DVec3::new(0.5, 50.0, 50.0), angle: 0.0 };
    horizon.add(&wall.prism());
    let at = |x: f64| (DVec3::new(x, 0.0, -1.0), DVec3::new(x + 1.0, 1.0, 1.0));
    assert!(!horizon.hides(at(5.0).0, at(5.0).1), "before the wall");
    assert!(horizon.hides(at(60.0).0, at(60.0).1), "behind it");
    assert!(!horizon.hides(at(5.0).0, at(5.0).1), "before it, out of order");
    assert!(!horizon.hides(DVec3::splat(-1.0), DVec3::splat(70.0)), "around the eye");
    horizon.add(&Prism { corners: [DVec2::NAN; 4], low: 0.0, high: f64::INFINITY });
    assert!(!horizon.hides(DVec3::splat(f64::NAN), DVec3::splat(f64::NAN)));
    assert!(!horizon.hides(DVec3::new(80.0, f64::NEG_INFINITY, 0.0), DVec3::new(81.0, 1.0, 1.0)));
}

/// Views from places, turned, pitched and rolled at random.
fn turned(r: &mut Random, eyes: &[DVec3]) -> Vec<View> {
    let one = |&eye: &DVec3| {
        let (yaw, pitch, roll) = (r.range(0.0, 6.3), r.range(-1.5, 1.5), r.range(-3.1, 3.1));
        let ahead = DVec3::new(pitch.cos() * yaw.cos(), pitch.sin(), pitch.cos() * yaw.sin());
        let side = ahead.cross(DVec3::Y).normalize();
        let up = side.cross(ahead) * roll.cos() + side * roll.sin();
        let fov_y_deg = r.range(25.0, 110.0);
        let camera = Camera { eye, target: eye + ahead, up, fov_y_deg, near: 0.1, far: None };
        camera.view(Viewport::new(320, 256).unwrap()).unwrap()
    };
    eyes.iter().map(one).collect()
}

/// Walks with horizons beside everything in the frustum: equal pictures. Gives the share of objects left out.
#[track_caller]
fn keeps_the_picture(what: &str, scene: &PreparedScene, views: &[View]) -> f64 {
    let methods = ["vfc", "horizons"].map(|name| Method::parse(name).unwrap());
    let workers = Workers::new(1).unwrap();
    let options = WalkOptions { level: Level::best(), workers: &workers, repetitions: 1, exact: true };
    let report = walk(what, scene, views, &methods, &options, |_| Ok(())).unwrap();
    assert_eq!(report.runs[1].wrongly_culled_objects(), Some(0), "{what}");
    assert_eq!(report.runs[1].image_hash, report.runs[0].image_hash, "{what}");
    let drawn: Vec<f64> = report.runs.iter().map(|run| run.mean(report.pixels()).objects_drawn).collect();
    1.0 - drawn[1] / drawn[0]
}

#[test]
fn the_picture_of_the_city_stays_the_same_however_the_camera_is_turned() {
    let mut r = Random::new(2);
    let generated = parse("city:triangles=20000").unwrap();
    let scene = PreparedScene::new(&generated.scene).unwrap();
    let cameras = generated.path.sample(24).unwrap();
    let straight: Vec<View> =
        cameras.iter().map(|camera| camera.view(Viewport::new(320, 256).unwrap()).unwrap()).collect();
    let culled = keeps_the_picture("along the walk", &scene, &straight);
    assert!(culled > 0.3, "{culled} of the objects are hidden along the walk");
    let eyes: Vec<DVec3> = cameras.iter().map(|camera| camera.eye).collect();
    let turned = keeps_the_picture("turned", &scene, &turned(&mut r, &eyes));
    println!("hidden along the walk {culled:.3}, turned {turned:.3}");
}

#[test]
fn the_picture_of_cities_of_turned_boxes_stays_the_same() {
    let mut r = Random::new(3);
    for round in 0..12 {
        let mut b = Builder::new();
        for _ in 0..120 {
            let half = Vec3::new(r.float(1.0, 6.0), r.float(1.0, 14.0), r.float(1.0, 6.0));
            let facing = [Facing::Front, Facing::Both][r.below(2)];
            let object = b.cuboid(-half, half, facing);
            object.position = DVec3::new(r.range(-90.0, 90.0), r.range(-4.0, 8.0), r.range(-90.0, 90.0));
            // A far one of the rounds lies a long way from the world's origin.
            object.position += DVec3::new(4e5, 100.0, -3e5) * (round % 2) as f64;
            object.rotation = Mat3::from_rotation_y(r.float(0.0, 6.3)) * Mat3::from_diagonal(Vec3::new(1.0, 1.3, 0.8));
            if r.chance(0.1) {
                object.opacity = 0.5;
            }
        }
        let scene = b.prepared();
        let shift = DVec3::new(4e5, 100.0, -3e5) * (round % 2) as f64;
        let eyes: Vec<DVec3> = (0..6)
            .map(|_| shift + DVec3::new(r.range(-80.0, 80.0), r.range(-9.0, 30.0), r.range(-80.0, 80.0)))
            .collect();
        keeps_the_picture(&format!("round {round}"), &scene, &turned(&mut r, &eyes));
    }
}

#[test]
fn prisms_lie_inside_closed_opaque_upright_objects_alone() {
    let mut b = Builder::new();
    let (low, high) = (Vec3::ZERO, Vec3::new(4.0, 9.0, 3.0));
    b.cuboid(low, high, Facing::Front);
    b.cuboid(low, high, Facing::Back);
    b.cuboid(low, high, Facing::Front).opacity = 0.9;
    b.cuboid(low, high, Facing::Front).rotation = Mat3::from_rotation_x(0.2);
    b.cuboid(low, high, Facing::Both).rotation = Mat3::from_rotation_y(0.2);
    let open = b.cuboid(low, high, Facing::Both).mesh as usize;
    let mesh = &b.0.meshes[open];
    let opened = mesh.triangles()[1..].to_vec();
    b.0.meshes[open] = homcull::scene::Mesh::new("open", mesh.positions().to_vec(), opened).unwrap();
    let scene = b.prepared();
    let prisms = Prisms::new(&scene).unwrap();
    let found: Vec<usize> = (0..6).map(|object| prisms.of(object).len()).collect();
    assert_eq!(found, [1, 0, 0, 0, 1, 0]);
    let Aabb { min, max } = prisms.of(0)[0];
    assert!(min.cmpgt(low).all() && max.cmplt(high).all(), "strictly inside");
    assert!((min - low).max_element() < 0.01 && (high - max).max_element() < 0.01, "and nearly all of it");
}

#[test]
fn where_it_does_not_apply_it_says_so_or_culls_nothing() {
    let workers = Workers::new(1).unwrap();
    let options = WalkOptions { level: Level::best(), workers: &workers, repetitions: 1, exact: true };
    let mut b = Builder::new();
    b.triangles(&[[Vec3::X, Vec3::Y, Vec3::Z]], Facing::Both);
    let views = turned(&mut Random::new(5), &[DVec3::splat(4.0)]);
    let error = walk("a leaf", &b.prepared(), &views, &[Method::Horizons], &options, |_| Ok(())).unwrap_err();
    assert!(error.to_string().starts_with("method 'horizons': no object has a closed"), "{error}");
    let view = View::new(
        orthographic(&mut Random::new(4), DVec3::ZERO),
        homcull::view::ClipSpace::REVERSED,
        Viewport::new(64, 64).unwrap(),
    );
    assert_eq!(Limits::of(&view.unwrap()), None, "a parallel view has no eye");
}
