//! The picture: drawn in bands, read as colours, depths and items.

use homcull_simd::{Kernel, Level, Mask, Simd};

use super::sink::{CountSink, DrawSink, TileItems};
use crate::error::{Error, Result};
use crate::hash::Hash;
use crate::occlusion::{PlacedRows, take};
use crate::raster::{Band, Engine, Grid, Queues, RasterCounts, Surface, prefetch_mesh};
use crate::scene::PreparedScene;
use crate::view::{View, Viewport};

/// Where nothing is drawn: 0x00BBGGRR.
pub const BACKGROUND: i32 = 0x00D8_C4B0;

/// A picture of one size, reused from frame to frame.
pub struct Canvas {
    grid: Grid,
    level: Level,
    floors: Vec<[f32; 16]>,
    tiles: Vec<f32>,
    cover: Vec<[u64; 16]>,
    items: Vec<TileItems>,
    /// Row by row from the top left, 0x00BBGGRR.
    image: Vec<i32>,
    queues: Vec<Box<Queues>>,
}

impl Canvas {
    /// A canvas of this size, drawn at a SIMD level.
    ///
    /// # Errors
    /// [`Error::SimdLevel`] when the CPU lacks it.
    pub fn new(viewport: Viewport, level: Level) -> Result<Canvas> {
        if !level.is_available() {
            return Err(Error::SimdLevel(level.name().into()));
        }
        let grid = Grid::new(viewport);
        let tiles = grid.tiles_x() * grid.tiles_y();
        Ok(Canvas {
            grid,
            level,
            floors: vec![[0.0; 16]; tiles],
            tiles: vec![f32::INFINITY; grid.tile_stride() * grid.tiles_y()],
            cover: vec![[0; 16]; tiles],
            items: vec![TileItems::EMPTY; tiles],
            image: vec![BACKGROUND; grid.width() as usize * grid.height() as usize],
            queues: Vec::new(),
        })
    }

    /// Draws objects into a cleared picture. The order changes nothing but the time: nearest first is fastest. `run` gets one job
    /// a band and must call [`DrawJob::run`] on each, on any threads; the picture does not depend on `bands`.
    ///
    /// # Errors
    /// [`Error::View`] when the view is of another size.
    pub fn draw(
        &mut self,
        view: &View,
        scene: &PreparedScene,
        objects: &[u32],
        bands: usize,
        run: impl FnOnce(&mut [DrawJob<'_>]),
    ) -> Result<RasterCounts> {
        let level = self.level;
        let mut jobs: Vec<DrawJob<'_>> = (self.bands(view, bands)?.into_iter())
            .map(|band| DrawJob { level, view, scene, objects, counts: RasterCounts::default(), work: Some(band) })
            .collect();
        run(&mut jobs);
        let mut total = RasterCounts::default();
        for job in &mut jobs {
            job.run();
            total += job.counts;
        }
        Ok(total)
    }

    /// The picture cut into bands, as many as asked for or as there are rows of tiles, each to be drawn by one thread.
    ///
    /// # Errors
    /// [`Error::View`] when the view is of another size.
    pub(crate) fn bands(&mut self, view: &View, bands: usize) -> Result<Vec<BandDraw<'_>>> {
        if Grid::new(view.viewport()) != self.grid {
            return Err(Error::View("the canvas and the view differ in size".into()));
        }
        let grid = self.grid;
        let bands = bands.clamp(1, grid.tiles_y());
        while self.queues.len() < bands {
            self.queues.push(Queues::new());
        }
        let (mut floors, mut tiles) = (&mut self.floors[..], &mut self.tiles[..]);
        let (mut cover, mut items, mut image) = (&mut self.cover[..], &mut self.items[..], &mut self.image[..]);
        let cut = grid.bands(bands).zip(&mut self.queues).map(|(band, queues)| {
            let n = band.tiles();
            let rows = (band.last_row() - band.first_row() + 1) as usize;
            let strips = (band.tile_y1 - band.tile_y0) * grid.tile_stride();
            let surface = Surface { band, blocks: take(&mut floors, n), tiles: take(&mut tiles, strips) };
            let sink = DrawSink { surface, cover: take(&mut cover, n), items: take(&mut items, n) };
            BandDraw { sink, queues, image: take(&mut image, rows * grid.width() as usize) }
        });
        Ok(cut.collect())
    }

    /// The level that it is drawn at.
    #[cfg(feature = "bvh")]
    pub(crate) fn level(&self) -> Level {
        self.level
    }

    /// The samples that each of the objects covers, hidden or not: what their depth complexity is counted from. Nothing is
    /// drawn, but what the canvas showed is lost.
    ///
    /// # Errors
    /// [`Error::View`] when the view is of another size.
    pub fn count_fragments(&mut self, view: &View, scene: &PreparedScene, objects: &[u32]) -> Result<Vec<u64>> {
        if Grid::new(view.viewport()) != self.grid {
            return Err(Error::View("the canvas and the view differ in size".into()));
        }
        let surface = Surface { band: Band::whole(self.grid), blocks: &mut self.floors, tiles: &mut self.tiles };
        let mut queues = Queues::new();
        Ok(self.level.run(CountFragments { view, scene, objects, surface, queues: &mut queues }))
    }

    /// Width in samples.
    pub fn width(&self) -> usize {
        self.grid.width() as usize
    }

    /// Height in samples.
    pub fn height(&self) -> usize {
        self.grid.height() as usize
    }

    /// The colours, row by row from the top left, 0x00BBGGRR.
    pub fn image(&self) -> &[i32] {
        &self.image
    }

    /// Reversed depth and triangle number at a sample; `None` where nothing is drawn.
    #[inline]
    pub fn item(&self, x: usize, y: usize) -> Option<(f32, u32)> {
        let (tile, block) = self.grid.place(x / 8, y / 8);
        let sample = (y % 8) * 8 + x % 8;
        let drawn = self.cover[tile][block] >> sample & 1 != 0;
        let items = &self.items[tile];
        drawn
            .then(|| (items.depth[block][sample / 16][sample % 16], items.item[block][sample / 16][sample % 16] as u32))
    }

    /// Samples that show each object, by id: the exact item buffer (thesis 8.3.1). `counts` has one place an object.
    pub fn count_items(&self, scene: &PreparedScene, counts: &mut [u32]) {
        counts.fill(0);
        let mut object = Object::NONE;
        self.for_each_block(|drawn, items, block| {
            let mut drawn = drawn;
            while drawn != 0 {
                let sample = drawn.trailing_zeros() as usize;
                drawn &= drawn - 1;
                let triangle = items.item[block][sample / 16][sample % 16] as u32;
                counts[object.find(scene, triangle) as usize] += 1;
            }
        });
    }

    /// A hash of colour, depth bits and object id of every sample: equal for equal pictures of one size.
    pub fn hash(&self, scene: &PreparedScene) -> u64 {
        let mut hash = Hash::default();
        let mut object = Object::NONE;
        self.for_each_block(|drawn, items, block| {
            hash.add(drawn);
            for sample in 0..64 {
                if drawn >> sample & 1 != 0 {
                    let (depth, triangle) =
                        (items.depth[block][sample / 16][sample % 16], items.item[block][sample / 16][sample % 16]);
                    hash.add(u64::from(depth.to_bits()) << 32 | u64::from(object.find(scene, triangle as u32)));
                }
            }
        });
        for pair in self.image.chunks(2) {
            hash.add(pair.iter().fold(0, |a, &c| a << 32 | u64::from(c as u32)));
        }
        hash.value()
    }

    /// Samples that differ in colour, depth bits or object from those of a picture of the same size.
    pub fn differing_samples(&self, other: &Canvas, scene: &PreparedScene) -> u64 {
        let mut differing = 0;
        let (mut ours, mut theirs) = (Object::NONE, Object::NONE);
        for y in 0..self.height() {
            for x in 0..self.width() {
                let same = match (self.item(x, y), other.item(x, y)) {
                    (Some((z, t)), Some((oz, ot))) => {
                        z.to_bits() == oz.to_bits() && (t == ot || ours.find(scene, t) == theirs.find(scene, ot))
                    }
                    (None, None) => true,
                    _ => false,
                };
                let at = y * self.width() + x;
                differing += u64::from(!same || self.image[at] != other.image[at]);
            }
        }
        differing
    }

    /// True when two pictures of one size are equal in colour, depth bits and triangle at every sample.
    pub fn equals(&self, other: &Canvas) -> bool {
        let block_equal = |tile: usize, block: usize| {
            let drawn = self.cover[tile][block];
            let (a, b) = (&self.items[tile], &other.items[tile]);
            let bits = |v: &TileItems, i: usize, l: usize| (v.depth[block][i][l].to_bits(), v.item[block][i][l]);
            let equal = |i: usize| (0..16).all(|l| drawn >> (16 * i + l) & 1 == 0 || bits(a, i, l) == bits(b, i, l));
            drawn == other.cover[tile][block] && (0..4).all(equal)
        };
        self.image == other.image && (0..self.cover.len()).all(|tile| (0..16).all(|block| block_equal(tile, block)))
    }

    /// Calls with the drawn samples of every block inside the viewport, the tile's items, and the block's place there.
    fn for_each_block(&self, mut f: impl FnMut(u64, &TileItems, usize)) {
        for by in 0..self.grid.blocks_y() {
            for bx in 0..self.grid.blocks_x() {
                let (tile, block) = self.grid.place(bx, by);
                f(self.cover[tile][block] & !self.grid.padding(bx, by), &self.items[tile], block);
            }
        }
    }
}

/// The object of the last triangle looked up: neighbours mostly share it.
struct Object {
    id: u32,
    from: u32,
    to: u32,
}

impl Object {
    const NONE: Object = Object { id: 0, from: 0, to: 0 };

    fn find(&mut self, scene: &PreparedScene, triangle: u32) -> u32 {
        if !(self.from..self.to).contains(&triangle) {
            self.id = scene.object_of(triangle);
            (self.from, self.to) = (scene.first_triangle[self.id as usize], scene.first_triangle[self.id as usize + 1]);
        }
        self.id
    }
}

/// One band's share of [`Canvas::draw`]. May run on any thread.
pub struct DrawJob<'a> {
    level: Level,
    view: &'a View,
    scene: &'a PreparedScene,
    objects: &'a [u32],
    work: Option<BandDraw<'a>>,
    counts: RasterCounts,
}

/// A band of a picture, to be drawn.
pub(crate) struct BandDraw<'a> {
    pub sink: DrawSink<'a>,
    pub queues: &'a mut Queues,
    /// Its rows of the image.
    pub image: &'a mut [i32],
}

impl DrawJob<'_> {
    /// Draws the band. A second call does nothing.
    pub fn run(&mut self) {
        if let Some(work) = self.work.take() {
            self.counts = self.level.run(DrawBand { view: self.view, scene: self.scene, objects: self.objects, work });
        }
    }
}

struct DrawBand<'a> {
    view: &'a View,
    scene: &'a PreparedScene,
    objects: &'a [u32],
    work: BandDraw<'a>,
}

impl Kernel for DrawBand<'_> {
    type Output = RasterCounts;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> RasterCounts {
        let DrawBand { view, scene, objects, work } = self;
        let BandDraw { mut sink, queues, image } = work;
        clear(&mut sink);
        let mut engine = Engine { simd: s, sink, queues, counts: RasterCounts::default(), cluster_test: true };
        let mut placed = PlacedRows::new(view);
        for (i, &object) in objects.iter().enumerate() {
            for (distance, stage) in [(12, 2), (8, 1), (4, 0)] {
                if let Some(&o) = objects.get(i + distance) {
                    prefetch_mesh(&scene.meshes, scene.occluders[o as usize].mesh, stage);
                }
            }
            let mut placement = placed.placement(&scene.occluders[object as usize]);
            placement.first_triangle = scene.first_triangle[object as usize];
            engine.draw(&scene.meshes, &placement);
        }
        engine.flush();
        shade(s, &engine.sink, &scene.colors, image);
        engine.counts
    }
}

struct CountFragments<'a> {
    view: &'a View,
    scene: &'a PreparedScene,
    objects: &'a [u32],
    surface: Surface<'a>,
    queues: &'a mut Queues,
}

impl Kernel for CountFragments<'_> {
    type Output = Vec<u64>;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Vec<u64> {
        let CountFragments { view, scene, objects, surface, queues } = self;
        surface.blocks.fill([0.0; 16]);
        surface.tiles.fill(0.0);
        let sink = CountSink { surface, fragments: 0 };
        let mut engine = Engine { simd: s, sink, queues, counts: RasterCounts::default(), cluster_test: false };
        let mut placed = PlacedRows::new(view);
        let mut out = Vec::with_capacity(objects.len());
        for &object in objects {
            let before = engine.sink.fragments;
            engine.draw(&scene.meshes, &placed.placement(&scene.occluders[object as usize]));
            engine.flush();
            out.push(engine.sink.fragments - before);
        }
        out
    }
}

/// Nothing is drawn; samples outside the viewport are taken, at +infinity.
pub(crate) fn clear(sink: &mut DrawSink<'_>) {
    let band = sink.surface.band;
    let grid = band.grid;
    sink.surface.blocks.fill([0.0; 16]);
    sink.cover.fill([0; 16]);
    for row in sink.surface.tiles.chunks_mut(grid.tile_stride()) {
        row[..grid.tiles_x()].fill(0.0);
    }
    for ty in band.tile_y0..band.tile_y1 {
        for tx in 0..grid.tiles_x() {
            if tx + 1 < grid.tiles_x() && ty + 1 < grid.tiles_y() {
                continue;
            }
            let tile = sink.surface.tile(tx as i32, ty as i32);
            for block in 0..16 {
                let padding = grid.padding(4 * tx + block % 4, 4 * ty + block / 4);
                if padding == !0 {
                    sink.surface.blocks[tile][block] = f32::INFINITY;
                } else if padding != 0 {
                    sink.cover[tile][block] = padding;
                    sink.items[tile].depth[block] = [[f32::INFINITY; 16]; 4];
                }
            }
        }
    }
}

/// Colours of the band's samples from the triangles they show. A block that shows one triangle alone, as most of a wall
/// does, is looked up once.
#[inline(always)]
pub(crate) fn shade<S: Simd>(s: S, sink: &DrawSink<'_>, colors: &[i32], image: &mut [i32]) {
    let band = sink.surface.band;
    let (width, rows) = (band.grid.width() as usize, (band.last_row() - band.first_row() + 1) as usize);
    for by in 0..rows.div_ceil(8) {
        for bx in 0..band.grid.blocks_x() {
            let (tile, block) = (by / 4 * band.grid.tiles_x() + bx / 4, by % 4 * 4 + bx % 4);
            let (columns, lines) = ((width - 8 * bx).min(8), (rows - 8 * by).min(8));
            let at_edge = columns < 8 || lines < 8;
            let padding = if at_edge { band.grid.padding(bx, by + band.tile_y0 * 4) } else { 0 };
            let drawn = sink.cover[tile][block] & !padding;
            let mut colored = [[0; 16]; 4];
            shade_block(s, &sink.items[tile].item[block], drawn, colors, &mut colored);
            let pixels = colored.as_flattened();
            for line in 0..lines {
                let (from, to) = (8 * line, (8 * by + line) * width + 8 * bx);
                if columns == 8 {
                    image[to..to + 8].copy_from_slice(&pixels[from..from + 8]);
                } else {
                    image[to..to + columns].copy_from_slice(&pixels[from..from + columns]);
                }
            }
        }
    }
}

#[inline(always)]
fn shade_block<S: Simd>(s: S, items: &[[i32; 16]; 4], drawn: u64, colors: &[i32], out: &mut [[i32; 16]; 4]) {
    let first = items[0][0];
    let mut same = drawn == !0;
    if same {
        for row in items {
            same &= s.eq_i(s.load_i(row), s.splat_i(first)) == !0;
        }
    }
    for i in 0..4 {
        let color = if same {
            s.splat_i(colors[first as usize])
        } else {
            s.gather_i((drawn >> (16 * i)) as Mask, colors, s.load_i(&items[i]), s.splat_i(BACKGROUND))
        };
        s.store_i(color, &mut out[i]);
    }
}
