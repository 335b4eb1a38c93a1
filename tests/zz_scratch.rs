mod oracle;
use glam::{DVec3, Vec3};
use homcull::raster::Facing;
use oracle::exact::Transform;
use oracle::float::{Answer, Triangle, center};
use oracle::random::Random;
use oracle::scenes::*;
use oracle::state::*;
#[test]
fn worst() {
    let mut r = Random::new(99);
    let mut hist = [0usize; 12];
    let mut worst = 0;
    for round in 0..60000 {
        let mut lens = camera(&mut r, DVec3::ZERO);
        lens.far = None;
        let view = lens.view(viewport(100, 70)).unwrap();
        let ahead = (lens.target - lens.eye).normalize();
        let right = ahead.cross(lens.up).normalize();
        let up = right.cross(ahead);
        let k = lens.near;
        let e = 10f64.powf(r.range(-6.0, -2.0));
        let t: [Vec3; 3] = std::array::from_fn(|i| {
            let z = match (i, round % 3) {
                (0, _) => k * (1.0 + e),
                (1, _) => k * r.range(-3.0, 1.0),
                (_, 0) => k * (1.0 + r.range(0.0, e)),
                _ => k * r.range(0.5, 4.0),
            };
            (ahead * z + right * r.range(-2.0 * k, 2.0 * k) + up * r.range(-2.0 * k, 2.0 * k)).as_vec3()
        });
        let transform = Transform::new(&view, DVec3::ZERO);
        let Some(f) = Triangle::new(t.map(|v| transform.vertex(None, v).clip.map(f64::from))) else { continue };
        let mut b = Builder::new();
        b.triangles(&[t], Facing::Both);
        let d = draw(homcull_simd::Level::best(), &view, &b.prepared());
        let (mut missing, mut extra) = (0, 0);
        for (i, c) in d.covered().iter().enumerate() {
            let a = f.at(center(i as u32 % 100), center(i as u32 / 100), 1.5);
            missing += usize::from(a == Answer::Inside && !c);
            extra += usize::from(a == Answer::Outside && *c);
        }
        if missing + extra > 0 {
            hist[(missing + extra).ilog2() as usize] += 1;
        }
        if missing + extra > worst {
            worst = missing + extra;
            println!("round {round}: missing {missing} extra {extra}\n{lens:?}\n{t:?}");
            println!("{:?}", t.map(|v| transform.vertex(None, v).clip));
        }
    }
    println!("{hist:?}");
}
