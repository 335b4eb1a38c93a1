//! What the library drew, as plain lists; at every SIMD level; and pictures of differences.

use std::fmt::Write;

use glam::DVec3;
use homcull::draw::Canvas;
use homcull::occlusion::{Occluder, OcclusionBuffer, OcclusionSettings};
use homcull::raster::{PreparedMeshes, RasterCounts};
use homcull::scene::PreparedScene;
use homcull::view::View;
use homcull_simd::Level;

/// The levels of this CPU; those that it lacks are named, never passed over in silence.
pub fn levels() -> Vec<Level> {
    let (here, absent): (Vec<_>, Vec<_>) = Level::ALL.into_iter().partition(|l| l.is_available());
    for level in absent {
        println!("SIMD level {} absent: not tested", level.name());
    }
    here
}

/// Runs at every level of this CPU, demands what the scalar level gives, and returns that.
#[track_caller]
pub fn for_levels<T: Difference>(what: &str, run: impl Fn(Level) -> T) -> T {
    let gold = run(Level::Scalar);
    for level in levels() {
        if level != Level::Scalar
            && let Some(difference) = run(level).difference(&gold)
        {
            panic!("{what}: {} differs from scalar\n{difference}", level.name());
        }
    }
    gold
}

/// How something differs from what it should be.
pub trait Difference {
    fn difference(&self, should: &Self) -> Option<String>;
}

#[track_caller]
pub fn same<T: Difference>(what: &str, is: &T, should: &T) {
    if let Some(difference) = is.difference(should) {
        panic!("{what}\n{difference}");
    }
}

impl<T: PartialEq + std::fmt::Debug> Difference for Vec<T> {
    fn difference(&self, should: &Self) -> Option<String> {
        if self.len() != should.len() {
            return Some(format!("{} elements, should be {}", self.len(), should.len()));
        }
        let at = (0..self.len()).find(|&i| self[i] != should[i])?;
        Some(format!("element {at} is {:?}, should be {:?}", self[at], should[at]))
    }
}

impl<A: Difference, B: Difference> Difference for (A, B) {
    fn difference(&self, should: &Self) -> Option<String> {
        self.0.difference(&should.0).or_else(|| self.1.difference(&should.1))
    }
}

/// Effective depths and coverage of an occlusion buffer.
#[derive(Clone)]
pub struct State {
    pub width: u32,
    pub height: u32,
    pub covered: Vec<bool>,
    /// Bits of the effective depths.
    pub depth: Vec<u32>,
}

impl State {
    pub fn of(buffer: &OcclusionBuffer, view: &View) -> State {
        let (width, height) = (view.viewport().width(), view.viewport().height());
        let all = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        assert_eq!((buffer.depth_at(width, 0), buffer.covered(0, height)), (None, None));
        State {
            width,
            height,
            covered: all().map(|(x, y)| buffer.covered(x, y).unwrap()).collect(),
            depth: all().map(|(x, y)| buffer.depth_at(x, y).unwrap().to_bits()).collect(),
        }
    }
}

impl Difference for State {
    fn difference(&self, should: &Self) -> Option<String> {
        let cover = picture(self.width, self.height, &self.covered, &should.covered);
        cover.map(|p| format!("coverage\n{p}")).or_else(|| {
            let at = (0..self.depth.len()).find(|&i| self.depth[i] != should.depth[i])?;
            let (x, y) = (at as u32 % self.width, at as u32 / self.width);
            let [is, should] = [self, should].map(|s| f32::from_bits(s.depth[at]));
            Some(format!("depth at ({x}, {y}) is {is:e}, should be {should:e}"))
        })
    }
}

/// What a canvas shows.
#[derive(Clone)]
pub struct Drawn {
    pub width: u32,
    pub height: u32,
    pub image: Vec<i32>,
    /// Bits of the depth and the triangle, where something is drawn.
    pub items: Vec<Option<(u32, u32)>>,
    pub counts: RasterCounts,
    /// Samples that triangles cover, hidden or not, by object.
    pub fragments: Vec<u64>,
}

impl Drawn {
    pub fn covered(&self) -> Vec<bool> {
        self.items.iter().map(Option::is_some).collect()
    }

    /// The reversed depth at a place in the list; 0 where nothing is drawn.
    pub fn depth(&self, at: usize) -> f32 {
        self.items[at].map_or(0.0, |(z, _)| f32::from_bits(z))
    }
}

/// Counts are left out: they may depend on order and bands. So are fragments, which go by the order.
impl Difference for Drawn {
    fn difference(&self, should: &Self) -> Option<String> {
        if let Some(p) = picture(self.width, self.height, &self.covered(), &should.covered()) {
            return Some(format!("coverage\n{p}"));
        }
        let at =
            (0..self.items.len()).find(|&i| self.items[i] != should.items[i] || self.image[i] != should.image[i])?;
        let (x, y) = (at as u32 % self.width, at as u32 / self.width);
        let show = |d: &Drawn| format!("{:?} #{:06x}", d.items[at].map(|(z, t)| (f32::from_bits(z), t)), d.image[at]);
        Some(format!("({x}, {y}) shows {}, should {}", show(self), show(should)))
    }
}

/// Draws objects of a scene in an order, in bands.
pub fn draw_in(level: Level, view: &View, scene: &PreparedScene, objects: &[u32], bands: usize) -> Drawn {
    let mut canvas = Canvas::new(view.viewport(), level).unwrap();
    let counts = canvas.draw(view, scene, objects, bands, |jobs| jobs.iter_mut().for_each(|j| j.run())).unwrap();
    let items = (0..canvas.height())
        .flat_map(|y| (0..canvas.width()).map(move |x| (x, y)))
        .map(|(x, y)| canvas.item(x, y).map(|(z, t)| (z.to_bits(), t)))
        .collect();
    let image = canvas.image().to_vec();
    Drawn {
        width: view.viewport().width(),
        height: view.viewport().height(),
        image,
        items,
        counts,
        fragments: canvas.count_fragments(view, scene, objects).unwrap(),
    }
}

pub fn draw(level: Level, view: &View, scene: &PreparedScene) -> Drawn {
    draw_in(level, view, scene, &ids(scene), 1)
}

pub fn ids(scene: &PreparedScene) -> Vec<u32> {
    (0..scene.occluders.len() as u32).collect()
}

/// A buffer that has begun the view.
pub fn begun(level: Level, view: &View, settings: OcclusionSettings) -> OcclusionBuffer {
    let mut buffer = OcclusionBuffer::with_level(view.viewport(), level, settings).unwrap();
    buffer.begin(view).unwrap();
    buffer
}

/// A buffer with all occluders of a list.
pub fn submitted(level: Level, view: &View, meshes: &PreparedMeshes, occluders: &[Occluder]) -> OcclusionBuffer {
    let mut buffer = begun(level, view, OcclusionSettings::default());
    buffer.submit(meshes, occluders).unwrap();
    buffer
}

/// Where two coverages differ: `#` both, `.` neither, `-` missing, `+` too much; a window around the first difference.
pub fn picture(width: u32, height: u32, is: &[bool], should: &[bool]) -> Option<String> {
    let first = (0..is.len()).find(|&i| is[i] != should[i])?;
    let (x, y) = (first as u32 % width, first as u32 / width);
    let wrong = (0..is.len()).filter(|&i| is[i] != should[i]).count();
    let mut out = format!("{wrong} samples differ, first ({x}, {y}); # both, - missing, + too much\n");
    for py in y.saturating_sub(8)..(y + 16).min(height) {
        for px in x.saturating_sub(40)..(x + 60).min(width) {
            let at = (py * width + px) as usize;
            out.push(match (is[at], should[at]) {
                (true, true) => '#',
                (false, false) => '.',
                (false, true) => '-',
                (true, false) => '+',
            });
        }
        let _ = writeln!(out, "  row {py}");
    }
    Some(out)
}

/// A point for messages.
pub fn point(v: DVec3) -> String {
    format!("({}, {}, {})", v.x, v.y, v.z)
}
