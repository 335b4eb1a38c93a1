//! How an engine embeds the occlusion buffer: its own scene, its own threads, no feature of this crate.
//!
//! ```sh
//! cargo run --release --no-default-features --example embed
//! ```
//!
//! A street runs away from the viewer between two rows of houses, and every house has a yard full of crates behind it. What
//! is made once is made once ([`Street::new`]); a frame begins a view, projects all boxes, and then either draws chosen occluders
//! and tests everything against them ([`one_pass`]), or culls progressively ([`progressive`]), where everything seen
//! occludes what is behind it. All memory of a frame is kept for the next, but for the short lists of jobs.

use glam::{DVec3, Mat3, Vec3};
use homcull::error::Result;
use homcull::geometry::Aabb;
use homcull::occlusion::{
    BandJob, BoxSet, Occluder, Occluders, OcclusionBuffer, ProgressiveJob, ProjectedBoxes, Verdict,
};
use homcull::raster::{Facing, MeshId, PreparedMeshes};
use homcull::view::{Camera, View, Viewport};

/// Threads of the engine's own.
const THREADS: usize = 2;
/// Triangles of the occluders that one pass draws, at most: the budget of this engine.
const OCCLUDER_TRIANGLES: u32 = 240;
/// What is this large in every direction, in metres, may be chosen.
const LARGE: f32 = 4.0;
const HOUSES: usize = 40;
const CRATES_A_YARD: usize = 50;

/// What the engine keeps for the culler: made when the level is loaded.
struct Street {
    meshes: PreparedMeshes,
    occluders: Vec<Occluder>,
    /// By id, about the origin of the street, which is that of the world.
    bounds: Vec<Aabb>,
    boxes: BoxSet,
}

impl Street {
    fn new() -> Result<Street> {
        let mut meshes = PreparedMeshes::new();
        let (corners, triangles) = unit_cube();
        let cube = meshes.add(&corners, &triangles)?;
        let mut street = Street { meshes, occluders: Vec::new(), bounds: Vec::new(), boxes: BoxSet::default() };
        for house in 0..HOUSES {
            let side = if house % 2 == 0 { -1.0 } else { 1.0 };
            let z = -12.0 * (house / 2) as f64;
            street.add(cube, DVec3::new(side * 12.0, 4.0, z - 8.0), Vec3::new(8.0, 8.0, 11.5));
            for i in 0..CRATES_A_YARD {
                let (row, column) = ((i % 10) as f64, (i / 10) as f64);
                let at = DVec3::new(side * (18.0 + 1.5 * column), 0.5, z - 13.0 + row);
                street.add(cube, at, Vec3::ONE);
            }
        }
        street.boxes = BoxSet::new(&street.bounds);
        Ok(street)
    }

    /// Places the cube with its middle at `position`. Sizes go into the matrix; a vertex is `rotation * v + position`.
    fn add(&mut self, mesh: MeshId, position: DVec3, size: Vec3) {
        let rotation = Some(Mat3::from_diagonal(size));
        let (facing, opaque, optical_depth, luminance) = (Facing::Front, true, 0, 0);
        self.occluders.push(Occluder { mesh, position, rotation, facing, opaque, optical_depth, luminance });
        let middle = position.as_vec3();
        // One step outwards: the sum above is rounded, and a box must hold what is drawn.
        self.bounds.push(Aabb { min: middle - size * 0.5, max: middle + size * 0.5 }.outwards());
    }

    fn world(&self) -> Occluders<'_> {
        Occluders { meshes: &self.meshes, occluders: &self.occluders, bounds: &self.bounds, origin: DVec3::ZERO }
    }
}

/// What the engine keeps from frame to frame.
struct Frame {
    buffer: OcclusionBuffer,
    boxes: ProjectedBoxes,
    chosen: Vec<Occluder>,
    flags: Vec<bool>,
}

impl Frame {
    fn new(viewport: Viewport) -> Frame {
        let buffer = OcclusionBuffer::new(viewport);
        Frame { buffer, boxes: ProjectedBoxes::new(), chosen: Vec::new(), flags: Vec::new() }
    }
}

/// Occluders first, then all tests: for engines that know their occluders, or test from many systems at once. Gives how
/// many boxes are in the frustum, and how many of those are hidden.
fn one_pass(street: &Street, view: &View, frame: &mut Frame) -> Result<(usize, usize)> {
    let Frame { buffer, boxes, chosen, flags } = frame;
    buffer.begin(view)?;
    buffer.project(&street.boxes, DVec3::ZERO, boxes)?;
    boxes.sort();
    // The nearest of the large ones, under the budget, as one list: a call for each would wait for memory each time.
    chosen.clear();
    let mut triangles = 0;
    let is_large = |id: u32| street.bounds[id as usize].size().min_element() >= LARGE;
    for b in boxes.boxes().iter().filter(|b| is_large(b.id())) {
        let occluder = &street.occluders[b.id() as usize];
        triangles += street.meshes.triangles(occluder.mesh);
        if triangles > OCCLUDER_TRIANGLES {
            break;
        }
        chosen.push(*occluder);
    }
    buffer.submit_in_bands(&street.meshes, chosen, THREADS, |jobs| on_own_threads(jobs, BandJob::run))?;
    // Tests take the buffer by reference, so that any thread may test any part of the list.
    let buffer = &*buffer;
    buffer.test_projected(boxes, 0..boxes.len(), &street.bounds, DVec3::ZERO, flags)?;
    Ok((boxes.len(), flags.iter().filter(|&&hidden| hidden).count()))
}

/// Each box is tested against all that was seen before it, and drawn if it is seen: nothing has to be chosen.
fn progressive(street: &Street, view: &View, frame: &mut Frame) -> Result<(usize, usize)> {
    let Frame { buffer, boxes, flags, .. } = frame;
    buffer.begin(view)?;
    buffer.project(&street.boxes, DVec3::ZERO, boxes)?;
    boxes.sort();
    let run = |jobs: &mut [ProgressiveJob<'_>]| on_own_threads(jobs, ProgressiveJob::run);
    let seen = buffer.progressive(boxes, &street.world(), flags, THREADS, run)?;
    // Here the engine draws `boxes.boxes()[i].id()` wherever `flags[i]` is set, nearest first.
    Ok((boxes.len(), seen.hidden as usize))
}

/// The library brings jobs, the engine brings threads: here new ones, in an engine its job system.
fn on_own_threads<J: Send>(jobs: &mut [J], run: impl Fn(&mut J) + Sync) {
    std::thread::scope(|scope| {
        for job in jobs {
            scope.spawn(|| run(job));
        }
    });
}

/// The cube of size 1 about its middle, counter-clockwise in front.
fn unit_cube() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) - Vec3::splat(0.5);
    let faces: [[u32; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    ((0..8).map(corner).collect(), triangles)
}

fn main() -> Result<()> {
    let street = Street::new()?;
    // Any size will do, and any convention: a matrix of the engine's own goes in by `View::new` with its `ClipSpace`. For
    // pictures that stay the same, take the display's size.
    let viewport = Viewport::new(640, 360)?;
    let mut frame = Frame::new(viewport);
    println!("{} objects; the buffer has {} bytes", street.bounds.len(), OcclusionBuffer::bytes(viewport));
    println!("{:>8} {:>12} {:>18} {:>18}", "frame", "in frustum", "hidden, one pass", "hidden, progressive");
    let look = |step: f64| Camera {
        eye: DVec3::new(1.0, 1.7, 6.0 - step),
        target: DVec3::new(0.0, 1.7, -100.0),
        up: DVec3::Y,
        fov_y_deg: 60.0,
        near: 0.1,
        far: None,
    };
    for step in 0..6 {
        let view = look(f64::from(step) * 8.0).view(viewport)?;
        let (in_frustum, once) = one_pass(&street, &view, &mut frame)?;
        let (same, always) = progressive(&street, &view, &mut frame)?;
        assert_eq!(in_frustum, same);
        assert!(always >= once, "what more occluders hide, fewer do not show");
        println!("{step:>8} {in_frustum:>12} {once:>18} {always:>18}");
    }
    // Something that moves is asked about by itself, with a reason: a cat in a yard, another on the street.
    for (name, x) in [("in the yard", -20.0), ("on the street", 0.0)] {
        let cat = Aabb { min: Vec3::new(x - 0.2, 0.0, -60.2), max: Vec3::new(x + 0.2, 0.4, -59.8) };
        let verdict: Verdict = frame.buffer.test(cat, DVec3::ZERO)?;
        println!("a cat {name}: {} ({})", if verdict.is_hidden() { "hidden" } else { "visible" }, verdict.reason());
    }
    println!("\nThe last frame, a character a block of 8x8 samples:\n{}", frame.buffer.to_ascii());
    Ok(())
}
