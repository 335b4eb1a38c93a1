//! The cases: what is extreme in each, and how it is built.

use glam::{DMat4, DVec3, DVec4, Mat3, Vec3, Vec3Swizzles};

use super::shapes::{Lens, Shapes, parallel, turn};
use super::{Known, Setup, StabilityCase, Subject};
use crate::error::Result;
use crate::scene::Facing;
use crate::view::{ClipSpace, DepthRange, View, Viewport};

pub(super) const fn pictures(name: &'static str, about: &'static str, make: fn() -> Result<Setup>) -> StabilityCase {
    StabilityCase { name, about, subject: Subject::Pictures(make) }
}

/// All cases, in the table's order.
pub fn cases() -> Vec<StabilityCase> {
    let mut cases = depth_range();
    cases.extend(places());
    cases.extend(triangles());
    cases.extend(boxes());
    cases.extend(sizes());
    cases.extend(transforms());
    cases.extend(magnitudes());
    cases.extend(super::questions::questions());
    cases
}

fn town(seed: u64, lens: Lens, scale: f32, origin: DVec3) -> Result<Setup> {
    let mut s = Shapes::new(seed);
    s.origin = origin;
    s.town(scale);
    Ok(Setup { views: lens.at_town(f64::from(scale), origin)?, scene: s.scene })
}

fn town_at(width: u32, height: u32) -> Result<Setup> {
    town(1, Lens { size: (width, height), ..Lens::PLAIN }, 1.0, DVec3::ZERO)
}

fn depth_range() -> Vec<StabilityCase> {
    vec![
        pictures("near-far-1e9", "near 1e-3, far 1e6", || {
            town(1, Lens { near: 1e-3, far: Some(1e6), ..Lens::PLAIN }, 1.0, DVec3::ZERO)
        }),
        pictures("infinite-far", "things of equal size on the screen, from 1 to 1e8 units away", || {
            let mut s = Shapes::new(2);
            s.town(1.0);
            for i in 0..9 {
                let distance = 10f32.powi(i);
                let at = Vec3::new(s.range(-0.3, 0.3), s.range(0.0, 0.3), -1.0) * distance;
                s.cuboid(at - Vec3::splat(0.05 * distance), at + Vec3::splat(0.05 * distance));
            }
            Ok(Setup { views: Lens::PLAIN.at_town(1.0, DVec3::ZERO)?, scene: s.scene })
        }),
        pictures("near-1e-6", "a near plane of 1e-6, and things next to it", || {
            let mut s = Shapes::new(3);
            s.town(1.0);
            for i in 0..6 {
                let distance = 10f32.powi(-i);
                let at = Vec3::new(3.0 + s.range(-0.2, 0.2) * distance, 2.0, 58.0 - distance);
                s.cuboid(at - Vec3::splat(0.05 * distance), at + Vec3::splat(0.05 * distance));
            }
            let lens = Lens { near: 1e-6, ..Lens::PLAIN };
            Ok(Setup { views: lens.at_town(1.0, DVec3::ZERO)?, scene: s.scene })
        }),
        pictures("far-cuts-triangles", "a far plane through walls, ground and boxes", || {
            town(4, Lens { far: Some(61.0), ..Lens::PLAIN }, 1.0, DVec3::ZERO)
        }),
        pictures("beyond-far", "most objects wholly beyond the far plane", || {
            town(5, Lens { far: Some(12.0), ..Lens::PLAIN }, 1.0, DVec3::ZERO)
        }),
        pictures("thin-frustum", "near and far 1e-4 apart", || {
            town(6, Lens { near: 40.0, far: Some(40.0001), ..Lens::PLAIN }, 1.0, DVec3::ZERO)
        }),
        pictures("fov-0.1", "a lens of 0.1 degrees, from 60 km", || {
            let mut s = Shapes::new(7);
            s.town(1.0);
            let lens = Lens { fov: 0.1, ..Lens::PLAIN };
            let eyes = [DVec3::new(0.0, 2e3, 6e4), DVec3::new(4e4, 500.0, -4e4), DVec3::new(3.0, 2.0, 58.0)];
            let views = eyes.iter().map(|&eye| lens.look(eye, DVec3::Y * 5.0)).collect::<Result<_>>()?;
            Ok(Setup { scene: s.scene, views })
        }),
        pictures("fov-179", "a lens of 179 degrees", || town(8, Lens { fov: 179.0, ..Lens::PLAIN }, 1.0, DVec3::ZERO)),
        pictures("fov-179.99", "a lens of 179.99 degrees", || {
            town(8, Lens { fov: 179.99, near: 1e-3, ..Lens::PLAIN }, 1.0, DVec3::ZERO)
        }),
    ]
}

fn places() -> Vec<StabilityCase> {
    vec![
        pictures("world-at-1e7", "a town placed 1e7 from the origin", || {
            town(11, Lens::PLAIN, 1.0, DVec3::new(1e7, -2e7, 3e7))
        }),
        pictures("world-at-1e9", "a town placed 1e9 from the origin", || {
            town(12, Lens::PLAIN, 1.0, DVec3::new(1.3e9, 1.1e9, -2.7e9))
        }),
        pictures("vertices-at-1e7", "a town of f32 vertices 1e7 from the origin, in steps of 1", || {
            let mut s = Shapes::new(13);
            s.shift = Vec3::new(1e7, 0.0, -1e7);
            s.town(10.0);
            let views = Lens::PLAIN.at_town(10.0, s.shift.as_dvec3())?;
            Ok(Setup { scene: s.scene, views })
        }),
        pictures("two-towns-2e7-apart", "boxes about an origin 1e7 away, where f32 steps by 1", || far_town(2e7)),
        pictures("two-towns-2e9-apart", "boxes about an origin 1e9 away, where f32 steps by 64", || far_town(2e9)),
        pictures("walls-beside-the-eye-2e9-apart", "boxes wider than what they hold, by the rounding of f32", || {
            let mut s = Shapes::new(15);
            // The origin of the boxes is then 1e9 away, and their f32 halfway between two numbers at x = 32.
            s.placed(DVec3::X * 2e9, Vec3::ONE);
            s.placed(DVec3::Z * 50.0, Vec3::ONE);
            // Walls a little to the right and to the left that reach far beyond all that is in view, and a screen ahead: boxes
            // that hold the eye once they are rounded, nearest where they end behind it.
            s.placed(DVec3::new(32.8, 0.0, -480.0), Vec3::new(0.4, 1000.0, 500.0));
            s.placed(DVec3::new(31.2, 0.0, -480.0), Vec3::new(0.1, 1000.0, 500.0));
            s.placed(DVec3::new(32.0, 0.0, -20.0), Vec3::new(400.0, 400.0, 0.5));
            s.placed(DVec3::new(32.0, -4.0, -10.0), Vec3::new(30.0, 0.5, 45.0));
            let mut views = Vec::new();
            for i in 0..8 {
                let eye = DVec3::new(31.6 + 0.1 * f64::from(i), 0.0, 0.3);
                for dx in [-0.2, -0.01, 0.01, 0.2] {
                    views.push(Lens::PLAIN.look(eye, eye + DVec3::new(dx, 0.0, -1.0))?);
                }
            }
            Ok(Setup { scene: s.scene, views })
        }),
        pictures("from-a-matrix-at-1e6", "OpenGL, Direct3D and Vulkan matrices over world positions, 1e6 away", || {
            let origin = DVec3::new(1e6, 0.0, -1e6);
            let mut s = Shapes::new(16);
            s.origin = origin;
            s.town(1.0);
            let mut views = Vec::new();
            for space in [ClipSpace::OPENGL, ClipSpace::DIRECT3D, ClipSpace::VULKAN, ClipSpace::REVERSED] {
                let eye = origin + DVec3::new(3.0, 2.0, 58.0);
                views.push(View::new(world_matrix(eye, space), space, Viewport::new(160, 120)?)?);
            }
            Ok(Setup { scene: s.scene, views })
        }),
        pictures("behind-the-eye", "all objects behind the eye, or above and beside it", || {
            let mut s = Shapes::new(17);
            for i in 0..60 {
                let at = s.point(Vec3::new(-40.0, -10.0, 0.2), Vec3::new(40.0, 10.0, 60.0));
                let half = s.point(Vec3::splat(0.05), Vec3::new(2.0, 2.0, 0.19));
                let reach = if i % 4 == 0 { Vec3::new(0.0, 40.0, 0.0) } else { Vec3::ZERO };
                s.cuboid(at + reach - half, at + reach + half);
            }
            let views = [[0.0, 0.0, -1.0], [0.3, 0.1, -1.0], [0.0, 0.9, -0.1]]
                .map(|d: [f64; 3]| Lens::PLAIN.look(DVec3::ZERO, DVec3::from_array(d)));
            Ok(Setup { scene: s.scene, views: views.into_iter().collect::<Result<_>>()? })
        }),
    ]
}

fn far_town(apart: f64) -> Result<Setup> {
    let mut s = Shapes::new(14);
    s.placed(DVec3::X * apart, Vec3::splat(10.0));
    s.town(1.0);
    for i in 0..40 {
        let half = s.point(Vec3::splat(0.1), Vec3::new(2.0, 4.0, 2.0));
        let at = s.point(Vec3::new(-45.0, 0.0, -45.0), Vec3::new(45.0, 4.0, 45.0));
        s.placed(at.as_dvec3(), half).facing = if i % 2 == 0 { Facing::Front } else { Facing::Both };
    }
    let mut views = Lens::PLAIN.at_town(1.0, DVec3::ZERO)?;
    views.extend(Lens::PLAIN.at_town(1.0, DVec3::new(0.47, 0.0, 0.31))?);
    Ok(Setup { scene: s.scene, views })
}

/// A perspective over world positions, looking along -z and a little to the right, in some convention.
pub(super) fn world_matrix(eye: DVec3, space: ClipSpace) -> DMat4 {
    let ahead = DVec3::new(-0.1, 0.05, -1.0).normalize();
    let right = ahead.cross(DVec3::Y).normalize();
    let up = right.cross(ahead);
    let row = |v: DVec3, k: f64| (v * k).extend(-v.dot(eye) * k);
    let (near, far) = (0.1, 500.0);
    let w = row(ahead, 1.0);
    // Reversed: near (far / d - 1) / (far - near) times d.
    let reversed = w * (-near / (far - near)) + DVec4::W * (near * far / (far - near));
    let y = row(up, if space.y_down { -1.6 } else { 1.6 });
    let z = match space.depth {
        DepthRange::Reversed => reversed,
        DepthRange::ZeroToOne => w - reversed,
        DepthRange::MinusOneToOne => w - reversed * 2.0,
    };
    DMat4::from_cols(row(right, 1.2), y, z, w).transpose()
}

fn triangles() -> Vec<StabilityCase> {
    vec![
        pictures("needles", "triangles 1e-4 wide and 200 long, a thousandth of a sample and less", || {
            let mut s = Shapes::new(21);
            s.town(1.0);
            for _ in 0..60 {
                let (a, b) =
                    (s.point(Vec3::splat(-60.0), Vec3::splat(60.0)), s.point(Vec3::splat(-60.0), Vec3::splat(60.0)));
                let wide = s.point(Vec3::splat(-1e-4), Vec3::splat(1e-4));
                s.triangles(&[[a, b, b + wide], [a, a + wide, b], [a, b + (b - a) * 20.0, b + wide]]);
            }
            Ok(Setup { views: Lens::PLAIN.at_town(1.0, DVec3::ZERO)?, scene: s.scene })
        }),
        pictures("zero-area", "triangles without area, by index and by position, alone and among others", || {
            let mut s = Shapes::new(22);
            for i in 0..40 {
                let p = s.point(Vec3::splat(-9.0), Vec3::splat(9.0));
                let d = s.point(Vec3::splat(-3.0), Vec3::splat(3.0));
                match i % 4 {
                    0 => s.triangles(&[[p, p, p], [p, p + d, p]]),
                    1 => s.triangles(&[[p, p + d, p + d * 2.0], [p + d, p, p + d * 0.5]]),
                    2 => s.add(vec![p, p + d, p + d.yzx()], vec![[0, 0, 1], [1, 1, 1], [0, 1, 2]]),
                    _ => s.add(vec![p, p + d, p - d.zxy()], vec![[0, 1, 2], [0, 2, 1]]),
                };
            }
            let eyes = [DVec3::new(0.0, 0.0, 25.0), DVec3::new(14.0, 9.0, 0.5), DVec3::ZERO];
            let views = eyes.iter().map(|&e| Lens::PLAIN.look(e, DVec3::new(0.1, 0.2, -1.0))).collect::<Result<_>>()?;
            Ok(Setup { scene: s.scene, views })
        }),
        pictures("sub-sample", "boxes and meshes of triangles smaller than a sample", || {
            let mut s = Shapes::new(23);
            for _ in 0..150 {
                let at = s.point(Vec3::new(-8.0, -6.0, -40.0), Vec3::new(8.0, 6.0, -5.0));
                let half = s.point(Vec3::splat(1e-4), Vec3::splat(0.03));
                s.cuboid(at - half, at + half);
            }
            // A wall of 80 x 60 quads, half a sample each at its distance: it hides what is behind it.
            let n = 80;
            let grid: Vec<Vec3> =
                (0..=n * n).map(|i| Vec3::new((i % n) as f32 * 0.1 - 4.0, (i / n) as f32 * 0.1 - 4.0, -22.0)).collect();
            let quads = (0..n * (n - 1)).filter(|i| i % n != n - 1);
            s.add(grid, quads.flat_map(|i| [[i, i + 1, i + n + 1], [i, i + n + 1, i + n]]).collect());
            let views = [60.0, 20.0].map(|fov| Lens { fov, ..Lens::PLAIN }.look(DVec3::ZERO, -DVec3::Z));
            Ok(Setup { scene: s.scene, views: views.into_iter().collect::<Result<_>>()? })
        }),
        pictures("ten-million-samples", "triangles of 1e7 samples and more, most of them off the screen", || {
            let mut s = Shapes::new(24);
            s.town(1.0);
            s.quad(Vec3::new(-900.0, -900.0, -56.0), Vec3::X * 2000.0, Vec3::Y * 2000.0);
            s.quad(Vec3::new(-9e5, -1.0, 9e5), Vec3::X * 2e6, Vec3::Z * -2e6);
            let view =
                Lens { size: (4096, 2560), ..Lens::PLAIN }.look(DVec3::new(3.0, 2.0, 58.0), DVec3::new(0.0, 5.0, 0.0));
            Ok(Setup { scene: s.scene, views: vec![view?] })
        }),
        pictures("edge-on", "planes through the eye, and tilted off it by next to nothing", || {
            let mut s = Shapes::new(25);
            s.town(1.0);
            for (i, tilt) in [0.0, 1e-7, -1e-7, 1e-5, -1e-4, 1e-3].into_iter().enumerate() {
                let z = 50.0 - 4.0 * i as f32;
                s.quad(Vec3::new(-20.0, 2.0, z), Vec3::X * 40.0, Vec3::new(0.0, tilt * 3.0, -3.0));
                s.quad(Vec3::new(3.0, -5.0, z), Vec3::Y * 20.0, Vec3::new(tilt * 3.0, 0.0, -3.0));
            }
            s.quad(Vec3::new(-90.0, 2.0, 90.0), Vec3::X * 200.0, Vec3::Z * -200.0);
            let eye = DVec3::new(3.0, 2.0, 58.0);
            let views = [DVec3::new(0.0, 0.0, -1.0), DVec3::new(0.2, 0.0, -1.0), DVec3::new(0.1, 0.3, -1.0)]
                .map(|d| Lens::PLAIN.look(eye, eye + d));
            Ok(Setup { scene: s.scene, views: views.into_iter().collect::<Result<_>>()? })
        }),
        pictures("vertices-at-w-0", "corners on the eye's plane, on the near plane, and next to both", || {
            let mut s = Shapes::new(26);
            s.cuboid(Vec3::new(-30.0, -30.0, -60.0), Vec3::new(30.0, 30.0, -50.0));
            let close = [
                0.0,
                1e-30,
                -1e-30,
                1e-10,
                -1e-10,
                1e-7,
                -1e-7,
                -0.1,
                -0.1f32.next_up(),
                -0.1f32.next_down(),
                -0.100_001,
            ];
            for i in 0..66 {
                let a = s.point(Vec3::new(-2.0, -2.0, 0.0), Vec3::new(2.0, 2.0, 0.0)) * [1.0, 1e-3, 1e-6][i / 22];
                let (b, c) = (
                    s.point(Vec3::new(-9.0, -9.0, -30.0), Vec3::new(9.0, 9.0, 3.0)),
                    s.point(Vec3::new(-9.0, -9.0, -30.0), Vec3::new(9.0, 9.0, 3.0)),
                );
                s.triangles(&[[Vec3::new(a.x, a.y, close[i % 11]), b * 0.3, c * 0.3]]);
            }
            let views = [DVec3::new(0.0, 0.0, -1.0), DVec3::new(1e-9, 0.0, -1.0), DVec3::new(0.4, -0.3, -1.0)]
                .map(|d| Lens::PLAIN.look(DVec3::ZERO, d));
            Ok(Setup { scene: s.scene, views: views.into_iter().collect::<Result<_>>()? })
        }),
        pictures("ties", "coplanar duplicates of quads, walls and boxes", || ties(false)),
        pictures("ties-in-reverse", "the same, with the objects' order turned round", || ties(true)),
        pictures("slivers-of-planes", "planes that fall away so fast that a sample spans their whole depth", || {
            let mut s = Shapes::new(28);
            for i in 0..60 {
                let a = s.point(Vec3::new(-3.0, -3.0, -6.0), Vec3::new(3.0, 3.0, -0.2));
                let along = a * [10.0, 300.0, 1e5][i % 3] + s.point(Vec3::splat(-0.01), Vec3::splat(0.01));
                let beside = s.point(Vec3::splat(-0.5), Vec3::splat(0.5));
                s.triangles(&[[a, along, a + beside], [a, a + beside, along * 0.5]]);
            }
            let eye = DVec3::new(0.4, -0.3, 0.5);
            let views = [1.0, 0.3].map(|d| Lens::PLAIN.look(eye, eye + DVec3::new(d - 0.6, 0.1, -1.0)));
            Ok(Setup { scene: s.scene, views: views.into_iter().collect::<Result<_>>()? })
        }),
    ]
}

fn ties(reverse: bool) -> Result<Setup> {
    let mut s = Shapes::new(27);
    for i in 0..8 {
        let z = -10.0 - 3.0 * i as f32;
        for j in 0..4 {
            let x = -6.0 + 2.5 * j as f32 + 0.3 * i as f32;
            s.quad(Vec3::new(x, -3.0, z), Vec3::X * 3.0, Vec3::Y * 5.0);
            s.quad(Vec3::new(x, -3.0, z), Vec3::X * 3.0, Vec3::Y * 5.0);
            s.quad(Vec3::new(x + 0.5, -2.0, z), Vec3::X * 1.5, Vec3::Y * 2.0);
            // A box whose face lies in the quad's plane, in front of it and behind.
            s.cuboid(Vec3::new(x, -3.0, z - 1.0), Vec3::new(x + 3.0, 2.0, z));
            s.cuboid(Vec3::new(x, -2.0, z), Vec3::new(x + 1.0, -1.0, z + 0.5)).facing = Facing::Front;
        }
    }
    if reverse {
        s.scene.objects.reverse();
    }
    let eyes = [DVec3::ZERO, DVec3::new(-4.0, 1.0, 3.0)];
    let mut views: Vec<View> = eyes.iter().map(|&e| Lens::PLAIN.look(e, e - DVec3::Z)).collect::<Result<_>>()?;
    views.push(parallel(DVec3::ZERO, -DVec3::Z, 8.0, 50.0, (160, 120))?);
    Ok(Setup { scene: s.scene, views })
}

fn boxes() -> Vec<StabilityCase> {
    vec![
        pictures("boxes-around-the-eye", "the eye inside boxes of 1e-6 to 1e4 units", || {
            let mut s = Shapes::new(31);
            s.town(1.0);
            let eye = Vec3::new(3.0, 2.0, 58.0);
            for i in -6..=4 {
                let half = Vec3::splat(10f32.powi(i)) * s.point(Vec3::splat(0.5), Vec3::splat(1.5));
                s.cuboid(eye - half, eye + half).facing = if i < 4 { Facing::Front } else { Facing::Both };
            }
            let views = [0.0, 1.0, 3.0].map(|a: f64| {
                let at = eye.as_dvec3();
                Lens::PLAIN.look(at, at + DVec3::new(libm::sin(a), -0.05, -libm::cos(a)))
            });
            Ok(Setup { scene: s.scene, views: views.into_iter().collect::<Result<_>>()? })
        }),
        pictures("boxes-across-the-near-plane", "a near plane of 4 through boxes, walls and ground", || {
            let mut s = Shapes::new(32);
            s.town(1.0);
            for i in 0..40 {
                let at = s.point(Vec3::new(-4.0, -1.0, 51.0), Vec3::new(9.0, 5.0, 59.0));
                let half = s.point(Vec3::splat(0.02), Vec3::splat(0.8));
                s.cuboid(at - half, at + half).facing = if i % 2 == 0 { Facing::Front } else { Facing::Both };
            }
            let lens = Lens { near: 4.0, ..Lens::PLAIN };
            Ok(Setup { views: lens.at_town(1.0, DVec3::ZERO)?, scene: s.scene })
        }),
        pictures("long-walls-beside-the-eye", "walls of 2e4 units that begin behind the eye", || {
            let mut s = Shapes::new(33);
            for (x, y) in [(0.3, 0.0), (-0.3, 0.0), (2.0, 1.0), (-5.0, 0.0), (0.0, -1.0)] {
                let (low, high) = (Vec3::new(x, y - 3.0, -1e4), Vec3::new(x + 0.05, y + 3.0, 1e4));
                let (low, high) =
                    if x == 0.0 { (Vec3::new(-9.0, -1.2, -1e4), Vec3::new(9.0, -1.0, 1e4)) } else { (low, high) };
                s.cuboid(low, high);
            }
            s.cuboid(Vec3::new(-20.0, -20.0, -41.0), Vec3::new(20.0, 20.0, -40.0));
            for _ in 0..60 {
                let at = s.point(Vec3::new(-9.0, -2.0, -70.0), Vec3::new(9.0, 3.0, -1.0));
                s.cuboid(at - Vec3::splat(0.2), at + Vec3::splat(0.2));
            }
            let views = [DVec3::new(0.0, 0.0, -1.0), DVec3::new(0.3, 0.1, -1.0), DVec3::new(1.0, 0.0, -0.2)]
                .map(|d| Lens { near: 0.01, ..Lens::PLAIN }.look(DVec3::ZERO, d));
            Ok(Setup { scene: s.scene, views: views.into_iter().collect::<Result<_>>()? })
        }),
        pictures("flat-boxes", "boxes without thickness along one axis, two, or all three", || {
            let mut s = Shapes::new(34);
            s.town(1.0);
            for i in 0..60 {
                let at = s.point(Vec3::new(-40.0, 0.0, -40.0), Vec3::new(40.0, 10.0, 57.0));
                let d = s.point(Vec3::splat(0.5), Vec3::splat(6.0));
                let (a, b) = [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::Z), (Vec3::Z, Vec3::X)][i % 3];
                match i % 12 {
                    9 => s.triangles(&[[at, at + a * d, at + a * d * 0.5]]),
                    10 => s.triangles(&[[at, at, at]]),
                    _ => s.quad(at, a * d, b * d),
                };
            }
            Ok(Setup { views: Lens::PLAIN.at_town(1.0, DVec3::ZERO)?, scene: s.scene })
        }),
        pictures(
            "inside-a-closed-mesh",
            "the eye in a ball that hides all, in one whose inside is not drawn, and outside",
            || {
                let mut s = Shapes::new(35);
                s.town(1.0);
                s.ball(Vec3::new(3.0, 2.0, 58.0), 5.0, 12);
                s.ball(Vec3::new(-20.5, 1.7, 12.25), 4.0, 12).facing = Facing::Front;
                s.ball(Vec3::new(11.0, 3.0, 45.0), 2.0, 12).facing = Facing::Back;
                Ok(Setup { views: Lens::PLAIN.at_town(1.0, DVec3::ZERO)?, scene: s.scene })
            },
        ),
        pictures("translucent", "half of the objects must not occlude", || {
            let mut s = Shapes::new(36);
            s.town(1.0);
            s.scene.objects.iter_mut().step_by(2).for_each(|o| o.opacity = 0.5);
            Ok(Setup { views: Lens::PLAIN.at_town(1.0, DVec3::ZERO)?, scene: s.scene })
        }),
    ]
}

fn sizes() -> Vec<StabilityCase> {
    let buffer = Subject::Buffer(largest);
    vec![
        pictures("1x1", "a single sample", || town_at(1, 1)),
        pictures("7x5", "less than a block", || town_at(7, 5)),
        pictures("33x31", "a tile and a column, a tile but a row", || town_at(33, 31)),
        pictures("1919x1079", "an odd display", || town_at(1919, 1079)),
        pictures("16384x64", "the widest view", || strip(16384, 64)),
        pictures("64x16384", "the tallest view", || strip(64, 16384)),
        StabilityCase { name: "16384x16384", about: "the largest occlusion buffer, 1.1 GB", subject: buffer },
    ]
}

fn strip(width: u32, height: u32) -> Result<Setup> {
    let mut s = Shapes::new(41);
    s.town(1.0);
    let fov = if width > height { 0.6 } else { 120.0 };
    let lens = Lens { size: (width, height), fov, ..Lens::PLAIN };
    let views = vec![lens.look(DVec3::new(3.0, 2.0, 58.0), DVec3::new(-4.0, 5.0, 0.0))?];
    Ok(Setup { scene: s.scene, views })
}

/// A wall over the left half, and boxes before it, behind it, beside it, across its edge, and between samples.
fn largest() -> Result<Known> {
    let mut s = Shapes::new(42);
    s.quad(Vec3::new(-100.0, -100.0, -10.0), Vec3::X * 100.0, Vec3::Y * 200.0);
    let mut hidden = vec![false];
    for i in 0..64 {
        let y = -4.0 + 0.125 * i as f32;
        let (x, z, is_hidden) =
            [(-3.0, -20.0, true), (-3.0, -8.0, false), (3.0, -20.0, false), (0.0, -20.0, false)][i % 4];
        let half = Vec3::splat(if i % 8 < 4 { 0.05 } else { 0.002 });
        s.cuboid(Vec3::new(x, y, z) - half, Vec3::new(x, y, z) + half);
        hidden.push(is_hidden);
    }
    // 1e-9 across where samples are 7e-4 apart: between four of them.
    let step = 2.0 * 10.0 / 16384.0;
    let at = Vec3::new(step * 2000.0, step * 3000.0, -10.0);
    s.cuboid(at - Vec3::splat(1e-9), at + Vec3::splat(1e-9));
    hidden.push(true);
    let view = Lens { size: (16384, 16384), fov: 90.0, ..Lens::PLAIN }.look(DVec3::ZERO, -DVec3::Z)?;
    Ok(Known { scene: s.scene, view, hidden })
}

fn transforms() -> Vec<StabilityCase> {
    vec![
        pictures("orthographic", "parallel views, level, from above, and from inside", || {
            let mut s = Shapes::new(51);
            s.town(1.0);
            let view = |eye: [f64; 3], ahead: [f64; 3], half, depth| {
                parallel(DVec3::from_array(eye), DVec3::from_array(ahead), half, depth, (160, 120))
            };
            let views = vec![
                view([0.0, 10.0, 80.0], [0.0, 0.0, -1.0], 50.0, 200.0)?,
                view([30.0, 60.0, 30.0], [-0.5, -1.0, -0.4], 40.0, 150.0)?,
                view([0.0, 5.0, 3.0], [0.3, -0.1, -1.0], 20.0, 30.0)?,
                view([0.0, 5.0, 1e6], [0.0, 0.0, -1.0], 50.0, 2e6)?,
            ];
            Ok(Setup { scene: s.scene, views })
        }),
        pictures("mirrored", "transforms that swap sides, with each facing", || {
            let mut s = Shapes::new(52);
            s.town(1.0);
            for (i, o) in s.scene.objects.iter_mut().enumerate().skip(3) {
                o.rotation = Mat3::from_diagonal(Vec3::new(-1.0, 1.0, 1.0)) * turn(0.1 * i as f64);
                o.facing = [Facing::Front, Facing::Back, Facing::Both][i % 3];
            }
            Ok(Setup { views: Lens::PLAIN.at_town(1.0, DVec3::ZERO)?, scene: s.scene })
        }),
        pictures("non-uniform-scale", "scales of 1e-3 by 1e3, shears, and a scale of 0", || {
            let mut s = Shapes::new(53);
            s.town(1.0);
            for i in 0..60 {
                let at = s.point(Vec3::new(-40.0, 0.0, -40.0), Vec3::new(40.0, 8.0, 50.0));
                let o = s.placed(at.as_dvec3(), Vec3::new(1e3, 2.0, 1e-3));
                let scale = Vec3::new(2e-3, 1.0, [1e3, 0.0, -2e3, 1e-30][i % 4]);
                let shear = Mat3::from_cols(Vec3::X, Vec3::new(0.3, 1.0, -0.7), Vec3::new(0.0, 0.2, 1.0));
                o.rotation = turn(i as f64) * shear * Mat3::from_diagonal(scale);
            }
            Ok(Setup { views: Lens::PLAIN.at_town(1.0, DVec3::ZERO)?, scene: s.scene })
        }),
        pictures("empty-meshes", "meshes without triangles, with unused vertices, and objects of nothing", || {
            let mut s = Shapes::new(54);
            s.town(1.0);
            for i in 0..20 {
                let p = s.point(Vec3::splat(-30.0), Vec3::splat(30.0));
                match i % 3 {
                    0 => s.add(Vec::new(), Vec::new()),
                    1 => s.add(vec![p, p + Vec3::X, p + Vec3::Y], Vec::new()),
                    // Vertices that no triangle uses are no part of the box.
                    _ => s.add(vec![Vec3::splat(1e30), p, p + Vec3::X * 3.0, p + Vec3::Y * 3.0], vec![[1, 2, 3]]),
                };
            }
            Ok(Setup { views: Lens::PLAIN.at_town(1.0, DVec3::ZERO)?, scene: s.scene })
        }),
        pictures("empty-scene", "no objects at all", || {
            Ok(Setup { scene: Shapes::new(55).scene, views: Lens::PLAIN.at_town(1.0, DVec3::ZERO)? })
        }),
    ]
}

fn magnitudes() -> Vec<StabilityCase> {
    vec![
        pictures("denormal-sizes", "boxes of 1e-40 units, meshes of 1e-42 scaled up, eyes next to them", || {
            let mut s = Shapes::new(61);
            s.town(1.0);
            for i in 0..30 {
                let at = s.point(Vec3::new(-30.0, 0.0, -30.0), Vec3::new(30.0, 9.0, 50.0));
                let o = s.placed(at.as_dvec3(), Vec3::splat([1e-40, 1e-42, 1e-45][i % 3]));
                if i % 2 == 0 {
                    o.rotation = Mat3::from_diagonal(Vec3::splat(1e38)) * turn(i as f64);
                }
            }
            s.placed(DVec3::new(3.0, 2.0, 58.0), Vec3::splat(1e-40));
            Ok(Setup { views: Lens::PLAIN.at_town(1.0, DVec3::ZERO)?, scene: s.scene })
        }),
        pictures("world-of-1e-30", "a whole town 1e-28 units wide", || {
            town(62, Lens { near: 1e-31, ..Lens::PLAIN }, 1e-30, DVec3::ZERO)
        }),
        pictures("world-of-1e15", "a whole town 1e17 units wide", || {
            town(63, Lens { near: 1e14, ..Lens::PLAIN }, 1e15, DVec3::ZERO)
        }),
        pictures("extents-of-1e30", "triangles of 1e30 units through an ordinary town", || {
            let mut s = Shapes::new(64);
            s.town(1.0);
            huge(&mut s, 1e30);
            Ok(Setup { views: Lens::PLAIN.at_town(1.0, DVec3::ZERO)?, scene: s.scene })
        }),
        pictures("transforms-that-overflow", "triangles of 3e38 units, and scales that make them infinite", || {
            let mut s = Shapes::new(65);
            s.town(1.0);
            for reach in [1e32, 1e34, 1e37, f32::MAX] {
                huge(&mut s, reach);
            }
            let first = s.scene.objects.len();
            huge(&mut s, 1e30);
            for o in &mut s.scene.objects[first..] {
                o.rotation = Mat3::from_diagonal(Vec3::splat(1e20));
            }
            Ok(Setup { views: Lens::PLAIN.at_town(1.0, DVec3::ZERO)?, scene: s.scene })
        }),
        pictures("positions-of-1e100", "objects placed where f32 has no numbers, and eyes there", || {
            let mut s = Shapes::new(66);
            s.town(1.0);
            s.placed(DVec3::X * 1e100, Vec3::ONE);
            s.placed(DVec3::Z * -1e39, Vec3::splat(3e38));
            let mut views = Lens::PLAIN.at_town(1.0, DVec3::ZERO)?;
            views.push(Lens::PLAIN.look(DVec3::X * 1e100, DVec3::X * 2e100 + DVec3::Z * 1e100)?);
            Ok(Setup { scene: s.scene, views })
        }),
    ]
}

/// Planes, a box and a needle that reach `reach` units.
fn huge(s: &mut Shapes, reach: f32) {
    s.quad(Vec3::new(-reach * 0.5, -0.5, reach * 0.5), Vec3::X * reach, Vec3::Z * -reach);
    s.quad(Vec3::new(-0.5 * reach, -0.5 * reach, -70.0), Vec3::X * reach, Vec3::Y * reach);
    s.triangles(&[[Vec3::new(-20.0, 0.0, 20.0), Vec3::new(-19.0, 3.0, 20.0), Vec3::new(-reach, reach, -reach)]]);
    // One triangle of ordinary size in the same mesh as a huge one.
    s.triangles(&[
        [Vec3::new(-5.0, 8.0, 30.0), Vec3::new(-2.0, 8.0, 30.0), Vec3::new(-4.0, 11.0, 30.0)],
        [Vec3::new(reach, 0.0, 0.0), Vec3::new(reach, reach, 0.0), Vec3::new(0.0, reach, reach)],
    ]);
    s.cuboid(Vec3::new(30.0, 0.0, -30.0), Vec3::new(31.0, reach, -29.0));
}
