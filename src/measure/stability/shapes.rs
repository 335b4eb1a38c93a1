//! What the cases are built of: boxes, quads, balls, towns; cameras; and numbers from a seed.

use glam::{DMat4, DVec3, DVec4, Mat3, Vec3};

use crate::error::Result;
use crate::hash::Hash;
use crate::scene::{Facing, Mesh, Object, Scene};
use crate::view::{Camera, ClipSpace, View, Viewport};

/// A scene being put together.
pub(super) struct Shapes {
    pub scene: Scene,
    /// Added to the position of every object.
    pub origin: DVec3,
    /// Added to every vertex.
    pub shift: Vec3,
    random: Hash,
}

/// Counter-clockwise from outside; bit `axis` of a corner's number chooses the greater side.
const CUBOID: [[u32; 3]; 12] = [
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
];

impl Shapes {
    pub fn new(seed: u64) -> Shapes {
        let mut random = Hash::default();
        random.add(seed);
        Shapes { scene: Scene::default(), origin: DVec3::ZERO, shift: Vec3::ZERO, random }
    }

    /// In `low` to `high`, an f32 so that what is stored is what was meant.
    pub fn range(&mut self, low: f32, high: f32) -> f32 {
        self.random.add(1);
        let unit = (self.random.value() >> 40) as f32 / 16_777_216.0;
        low + (high - low) * unit
    }

    pub fn point(&mut self, low: Vec3, high: Vec3) -> Vec3 {
        Vec3::new(self.range(low.x, high.x), self.range(low.y, high.y), self.range(low.z, high.z))
    }

    /// An object with a mesh of its own; vertices that are not finite leave it empty.
    pub fn add(&mut self, positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> &mut Object {
        let id = self.scene.objects.len();
        let positions: Vec<Vec3> = positions.into_iter().map(|p| p + self.shift).collect();
        let mesh = Mesh::new("stability", positions, triangles);
        self.scene.meshes.push(mesh.unwrap_or_else(|_| Mesh::from_checked(Vec::new(), Vec::new())));
        self.scene.objects.push(Object {
            name: format!("object {id}"),
            mesh: id as u32,
            rotation: Mat3::IDENTITY,
            position: self.origin,
            facing: Facing::Both,
            color: [(id * 37 % 251) as u8, (id * 91 % 241) as u8, (id * 17 % 239) as u8],
            opacity: 1.0,
        });
        &mut self.scene.objects[id]
    }

    pub fn triangles(&mut self, triangles: &[[Vec3; 3]]) -> &mut Object {
        let indices = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        self.add(triangles.as_flattened().to_vec(), indices)
    }

    pub fn cuboid(&mut self, min: Vec3, max: Vec3) -> &mut Object {
        let corner =
            |n: usize| Vec3::from_array(std::array::from_fn(|i| if n >> i & 1 != 0 { max[i] } else { min[i] }));
        self.add((0..8).map(corner).collect(), CUBOID.to_vec())
    }

    /// The same by its middle and half size, placed by its position.
    pub fn placed(&mut self, middle: DVec3, half: Vec3) -> &mut Object {
        let object = self.cuboid(-half, half);
        object.position += middle;
        object
    }

    pub fn quad(&mut self, corner: Vec3, a: Vec3, b: Vec3) -> &mut Object {
        self.add(vec![corner, corner + a, corner + a + b, corner + b], vec![[0, 1, 2], [0, 2, 3]])
    }

    /// A closed ball of `rings` times twice as many quads.
    pub fn ball(&mut self, middle: Vec3, radius: f32, rings: u32) -> &mut Object {
        let around = 2 * rings;
        let vertex = |i: u32| {
            let (ring, turn) = (f64::from(i / around), f64::from(i % around));
            let (polar, angle) =
                (std::f64::consts::PI * ring / f64::from(rings), std::f64::consts::TAU * turn / f64::from(around));
            let (sine, y) = (libm::sin(polar), libm::cos(polar));
            let p = DVec3::new(sine * libm::cos(angle), y, -sine * libm::sin(angle));
            middle + p.as_vec3() * radius
        };
        let positions = (0..(rings + 1) * around).map(vertex).collect();
        let quad = |i: u32| {
            let (ring, turn) = (i / around, i % around);
            let at = |r: u32, t: u32| r * around + t % around;
            let (a, b, c, d) = (at(ring, turn), at(ring + 1, turn), at(ring + 1, turn + 1), at(ring, turn + 1));
            [[a, b, c], [a, c, d]]
        };
        self.add(positions, (0..rings * around).flat_map(quad).collect())
    }

    /// A town within 50 units of the middle, on the plane y = 0: two walls that hide much, blocks of all sizes, some turned, a
    /// ground that they stand on.
    pub fn town(&mut self, scale: f32) {
        let v = |x: f32, y: f32, z: f32| Vec3::new(x, y, z) * scale;
        self.quad(v(-60.0, 0.0, 60.0), v(120.0, 0.0, 0.0), v(0.0, 0.0, -120.0)).facing = Facing::Front;
        self.cuboid(v(-30.0, 0.0, -1.0), v(30.0, 25.0, 1.0)).facing = Facing::Front;
        self.cuboid(v(10.0, 0.0, -40.0), v(12.0, 20.0, 40.0)).facing = Facing::Front;
        for i in 0..70 {
            let middle = self.point(Vec3::new(-50.0, 0.0, -50.0), Vec3::new(50.0, 0.0, 50.0));
            let half = self.point(Vec3::splat(0.05), Vec3::new(3.0, 6.0, 3.0));
            let middle = (middle + Vec3::Y * half.y) * scale;
            let object = match i % 5 {
                0 => {
                    let object = self.placed(middle.as_dvec3(), half * scale);
                    object.rotation = turn(f64::from(i));
                    object
                }
                1 => self.placed(middle.as_dvec3(), half * scale),
                _ => self.cuboid(middle - half * scale, middle + half * scale),
            };
            object.facing = if i % 3 == 0 { Facing::Both } else { Facing::Front };
        }
    }
}

/// A turn about the vertical, in radians.
pub(super) fn turn(angle: f64) -> Mat3 {
    let (sine, cosine) = (libm::sin(angle) as f32, libm::cos(angle) as f32);
    Mat3::from_cols(Vec3::new(cosine, 0.0, -sine), Vec3::Y, Vec3::new(sine, 0.0, cosine))
}

/// How a camera sees.
#[derive(Clone, Copy)]
pub(super) struct Lens {
    pub size: (u32, u32),
    pub fov: f64,
    pub near: f64,
    pub far: Option<f64>,
}

impl Lens {
    /// What nothing is extreme about.
    pub const PLAIN: Lens = Lens { size: (160, 120), fov: 60.0, near: 0.1, far: None };

    pub fn look(&self, eye: DVec3, target: DVec3) -> Result<View> {
        let Lens { size, fov, near, far } = *self;
        let camera = Camera { eye, target, up: DVec3::Y, fov_y_deg: fov, near, far };
        camera.view(Viewport::new(size.0, size.1)?)
    }

    /// Four looks at a town.
    pub fn at_town(&self, scale: f64, origin: DVec3) -> Result<Vec<View>> {
        [
            ([3.0, 2.0, 58.0], [-4.0, 5.0, 0.0]),
            ([-20.5, 1.7, 12.25], [40.0, 1.0, -7.0]),
            ([45.0, 40.0, -48.0], [0.0, 0.0, 0.0]),
            ([11.0, 3.0, 55.0], [11.0, 3.0, 0.0]),
        ]
        .iter()
        .map(|&(eye, target): &([f64; 3], [f64; 3])| {
            self.look(DVec3::from_array(eye) * scale + origin, DVec3::from_array(target) * scale + origin)
        })
        .collect()
    }
}

/// A parallel view from `eye` along `ahead`, half as wide as `half`, as deep as `depth`.
pub(super) fn parallel(eye: DVec3, ahead: DVec3, half: f64, depth: f64, size: (u32, u32)) -> Result<View> {
    let ahead = ahead.normalize();
    let right = ahead.cross(DVec3::Y).normalize();
    let up = right.cross(ahead);
    let aspect = f64::from(size.0) / f64::from(size.1);
    let rows: [DVec4; 4] = [
        (right / half).extend(-eye.dot(right) / half),
        (up * aspect / half).extend(-eye.dot(up) * aspect / half),
        (-ahead / depth).extend(1.0 + eye.dot(ahead) / depth),
        DVec4::W,
    ];
    let m = DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose();
    View::new(m, ClipSpace::REVERSED, Viewport::new(size.0, size.1)?)
}
