//! Layers: what adds up over all that was submitted, whether hidden or not.
//!
//! **Fusion of translucent occluders** (Zhang 1998, 4.4): several translucent surfaces together may let next to no light
//! through. Each adds its *optical depth* `floor(-256 log2(1 - a))` to the samples that it covers, an integer, so that order does not
//! matter; a sample is *fused*, and counts as covered, once the sum reaches that of a given opacity. It keeps the farthest depth
//! of its layers: what lies between two panes is not behind both, and is visible. Opaque is a bit of its own, never a sum.
//!
//! **Luminance** of occluders, by block, for thresholds raised by contrast (5.3.2): the mean over the samples of every
//! layer.
//!
//! Invariant: sums and minima over the set submitted, without any early-out, hence the same bits in any order and any pieces.
//! Cost: a second rasterization of what adds to layers. The depth of a fused sample may move away as layers are added.

use homcull_simd::{Kernel, Mask, Simd};

use super::buffer::Occluder;
use super::contrast::Luminance;
use super::map::TileSamples;
use super::progressive::PlacedRows;
use super::pyramid_build::Coverage;
use super::query::{DepthReading, rect_word};
use crate::error::{Error, Result};
use crate::geometry::SampleRect;
use crate::raster::{Band, Engine, Grid, PreparedMeshes, Queues, RasterCounts, Sink, Surface};
use crate::view::View;

/// Optical depth that halves what comes through.
const HALVING: f64 = 256.0;

/// The optical depth of one surface of an opacity from 0 to 1: `floor(-256 log2(1 - a))`, 65535 at most. An opacity that is no
/// number, or not above 0, has none. Opaque surfaces are not told by it: [`Occluder::opaque`] is.
pub fn optical_depth(opacity: f64) -> u16 {
    if opacity.is_nan() {
        return 0;
    }
    // The conversion ends at 0 and at 65535.
    (-HALVING * libm::log2(1.0 - opacity.min(1.0))).floor() as u16
}

/// The least sum of optical depths that lets no more through than an opacity above 0 and below 1 does.
fn fusing_depth(opacity: f64) -> Result<u16> {
    match opacity > 0.0 && opacity < 1.0 {
        true => Ok((-HALVING * libm::log2(1.0 - opacity)).ceil().max(1.0) as u16),
        false => Err(Error::parameter("fusion", opacity, "an opacity above 0 and below 1")),
    }
}

/// The layers of one view.
pub(crate) struct Layers {
    grid: Grid,
    /// From what sum on samples are fused; `None` where layers are not fused.
    fuse_at: Option<u16>,
    /// Sums of optical depths, farthest depths, and where there are any: what is not touched means nothing.
    optical: Vec<[[u16; 64]; 16]>,
    far: Vec<TileSamples>,
    touched: Vec<[u64; 16]>,
    fused: Vec<[u64; 16]>,
    /// Empty where contrast is not asked for.
    luminance: Vec<[Luminance; 16]>,
    /// A surface that hides nothing: 0, and +infinity outside the viewport.
    floors: Vec<[f32; 16]>,
    tiles: Vec<f32>,
}

impl Layers {
    /// Layers that fuse at an opacity, or sum luminance, or both; `None` when neither is asked for.
    ///
    /// # Errors
    /// [`Error::Parameter`] when the opacity is not above 0 and below 1.
    pub fn new(grid: Grid, fusion: Option<f64>, contrast: bool) -> Result<Option<Box<Layers>>> {
        let fuse_at = fusion.map(fusing_depth).transpose()?;
        if fuse_at.is_none() && !contrast {
            return Ok(None);
        }
        let tiles = grid.tiles_x() * grid.tiles_y();
        let fused = if fuse_at.is_some() { tiles } else { 0 };
        let mut floors = vec![[0.0; 16]; tiles];
        for (tile, floors) in floors.iter_mut().enumerate() {
            for (block, floor) in floors.iter_mut().enumerate() {
                let (bx, by) = (tile % grid.tiles_x() * 4 + block % 4, tile / grid.tiles_x() * 4 + block / 4);
                if grid.padding(bx, by) == !0 {
                    *floor = f32::INFINITY;
                }
            }
        }
        let mut strips = vec![f32::INFINITY; grid.tile_stride() * grid.tiles_y()];
        for row in strips.chunks_mut(grid.tile_stride()) {
            row[..grid.tiles_x()].fill(0.0);
        }
        Ok(Some(Box::new(Layers {
            grid,
            fuse_at,
            optical: vec![[[0; 64]; 16]; fused],
            far: vec![TileSamples([[[0.0; 16]; 4]; 16]); fused],
            touched: vec![[0; 16]; fused],
            fused: vec![[0; 16]; fused],
            luminance: vec![[Luminance::default(); 16]; if contrast { tiles } else { 0 }],
            floors,
            tiles: strips,
        })))
    }

    /// Nothing has been submitted.
    pub fn clear(&mut self) {
        self.touched.fill([0; 16]);
        self.fused.fill([0; 16]);
        self.luminance.fill([Luminance::default(); 16]);
    }

    /// True when layers are fused.
    pub fn fuses(&self) -> bool {
        self.fuse_at.is_some()
    }

    /// Fused samples, one word a block.
    pub fn fused(&self) -> Option<&[[u64; 16]]> {
        self.fuse_at.map(|_| &self.fused[..])
    }

    /// Luminance, one sum a block.
    pub fn luminance(&self) -> Option<&[[Luminance; 16]]> {
        (!self.luminance.is_empty()).then_some(&self.luminance[..])
    }

    /// The depth of a fused sample; 0 for any other.
    pub fn depth(&self, tile: usize, block: usize, sample: usize) -> f32 {
        match self.fused() {
            Some(fused) if fused[tile][block] >> sample & 1 != 0 => self.far[tile].0[block].as_flattened()[sample],
            _ => 0.0,
        }
    }

    /// The depth test without background, with fused samples: true when no covered sample of the rectangle (not empty, inside
    /// the viewport) is at `z` or farther. What counts is the nearer of the opaque and the fused depth.
    #[inline(always)]
    pub fn covered_is_nearer<S: Simd>(
        &self,
        s: S,
        coverage: Coverage<'_>,
        r: SampleRect,
        z: f32,
        reading: DepthReading,
    ) -> bool {
        let map = coverage.map;
        for by in r.y0 >> 3..=r.y1 >> 3 {
            for bx in r.x0 >> 3..=r.x1 >> 3 {
                let (tile, block) = self.grid.place(bx as usize, by as usize);
                let floor = map.floors[tile][block];
                let covered = coverage.word(tile, block);
                let word = rect_word(r, bx, by) & covered;
                if floor > z || word == 0 {
                    continue;
                }
                let asked = if reading == DepthReading::PerBlock { covered } else { word };
                let (fused, cover) = (self.fused[tile][block], map.cover[tile][block]);
                for i in 0..4 {
                    let part = |word: u64| (word >> (16 * i)) as Mask;
                    let floor = s.splat_f(floor);
                    let own = s.max_f(floor, s.load_f(&map.samples[tile].0[block][i]));
                    let far = s.load_f(&self.far[tile].0[block][i]);
                    let opaque = s.blend_f(part(cover), floor, own);
                    let depth = s.blend_f(part(fused), opaque, s.max_f(opaque, far));
                    if s.ge_f(s.splat_f(z), depth) & part(asked) != 0 {
                        return false;
                    }
                }
            }
        }
        true
    }
}

/// Adds occluders to layers: translucent ones where they are fused, and the luminance of all that occlude.
pub(crate) struct SubmitLayers<'a> {
    pub view: &'a View,
    pub layers: &'a mut Layers,
    pub queues: &'a mut Queues,
    pub meshes: &'a PreparedMeshes,
    pub occluders: &'a [Occluder],
    /// Tiles whose coverage or luminance changed.
    pub dirty: &'a mut [bool],
}

impl Kernel for SubmitLayers<'_> {
    type Output = RasterCounts;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> RasterCounts {
        let SubmitLayers { view, layers, queues, meshes, occluders, dirty } = self;
        let (fuses, sums) = (layers.fuse_at.is_some(), !layers.luminance.is_empty());
        let sink = LayerSink {
            surface: Surface { band: Band::whole(layers.grid), blocks: &mut layers.floors, tiles: &mut layers.tiles },
            fuse_at: layers.fuse_at.unwrap_or(u16::MAX),
            optical: &mut layers.optical,
            far: &mut layers.far,
            touched: &mut layers.touched,
            fused: &mut layers.fused,
            luminance: &mut layers.luminance,
            dirty,
            layer: Layer { optical_depth: 0, luminance: 0 },
        };
        let mut engine = Engine { simd: s, sink, queues, counts: RasterCounts::default(), cluster_test: false };
        let mut placed = PlacedRows::new(view);
        for o in occluders {
            let optical_depth = if fuses && !o.opaque { o.optical_depth } else { 0 };
            if optical_depth == 0 && !(sums && o.opaque) {
                continue;
            }
            engine.sink.layer = Layer { optical_depth, luminance: o.luminance };
            engine.draw(meshes, &placed.placement(o));
            // The queues do not know which layer a triangle belongs to.
            engine.flush();
        }
        engine.counts
    }
}

/// What is being added.
#[derive(Clone, Copy)]
struct Layer {
    optical_depth: u16,
    luminance: u8,
}

struct LayerSink<'a> {
    surface: Surface<'a>,
    fuse_at: u16,
    optical: &'a mut [[[u16; 64]; 16]],
    far: &'a mut [TileSamples],
    touched: &'a mut [[u64; 16]],
    fused: &'a mut [[u64; 16]],
    luminance: &'a mut [[Luminance; 16]],
    dirty: &'a mut [bool],
    layer: Layer,
}

impl LayerSink<'_> {
    #[inline(always)]
    fn add<S: Simd>(&mut self, s: S, tile: usize, block: usize, word: u64, depths: [S::F; 4]) {
        let grid = self.surface.band.grid;
        let (bx, by) = (tile % grid.tiles_x() * 4 + block % 4, tile / grid.tiles_x() * 4 + block / 4);
        let word = word & !grid.padding(bx, by);
        if let Some(luminance) = self.luminance.get_mut(tile) {
            let samples = u64::from(word.count_ones());
            luminance[block] += Luminance { sum: samples * u64::from(self.layer.luminance), samples };
            self.dirty[tile] = true;
        }
        if self.layer.optical_depth != 0 {
            self.add_optical(s, tile, block, word, depths);
        }
    }

    #[inline(always)]
    fn add_optical<S: Simd>(&mut self, s: S, tile: usize, block: usize, word: u64, depths: [S::F; 4]) {
        let before = self.touched[tile][block];
        self.touched[tile][block] = before | word;
        let far = &mut self.far[tile].0[block];
        for i in 0..4 {
            let old = s.blend_f((before >> (16 * i)) as Mask, s.splat_f(f32::INFINITY), s.load_f(&far[i]));
            let new = s.blend_f((word >> (16 * i)) as Mask, old, s.min_f(old, depths[i]));
            s.store_f(new, &mut far[i]);
        }
        let mut reached = 0;
        for (i, sum) in self.optical[tile][block].iter_mut().enumerate() {
            let old = if before >> i & 1 != 0 { *sum } else { 0 };
            let added = if word >> i & 1 != 0 { self.layer.optical_depth } else { 0 };
            *sum = old.saturating_add(added);
            reached |= u64::from(*sum >= self.fuse_at) << i;
        }
        if reached != self.fused[tile][block] {
            self.fused[tile][block] = reached;
            self.dirty[tile] = true;
        }
    }
}

impl<'a> Sink<'a> for LayerSink<'a> {
    const EXACT: bool = false;

    #[inline(always)]
    fn surface(&mut self) -> &mut Surface<'a> {
        &mut self.surface
    }

    #[inline(always)]
    fn expect(&self, _tile: usize, _block: usize) {}

    #[inline(always)]
    fn whole<S: Simd>(&mut self, s: S, tile: usize, blocks: Mask, floors: S::F, far: S::F) -> S::F {
        let mut depths = [0.0; 16];
        s.store_f(far, &mut depths);
        let mut blocks = blocks;
        while blocks != 0 {
            let block = blocks.trailing_zeros() as usize;
            blocks &= blocks - 1;
            self.add(s, tile, block, !0, [s.splat_f(depths[block]); 4]);
        }
        floors
    }

    #[inline(always)]
    fn samples<S: Simd>(&mut self, s: S, tile: usize, block: usize, word: u64, depths: [S::F; 4], _id: u32) -> f32 {
        self.add(s, tile, block, word, depths);
        -1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn optical_depth_is_rounded_down_and_total() {
        assert_eq!([0.5, 0.75, 0.875].map(optical_depth), [256, 512, 768]);
        assert_eq!(optical_depth(0.5 + 1e-9), 256);
        assert_eq!(optical_depth(0.5 - 1e-9), 255);
        assert_eq!([0.0, -1.0, f64::NAN, f64::NEG_INFINITY, 1e-4].map(optical_depth), [0; 5]);
        assert_eq!([1.0, 2.0, f64::INFINITY].map(optical_depth), [65535; 3]);
    }

    #[test]
    fn halves_fuse_as_their_product_does() {
        // Two panes of one half let a quarter through.
        assert_eq!(fusing_depth(0.75).unwrap(), 512);
        assert_eq!(fusing_depth(0.75 + 1e-9).unwrap(), 513);
        assert_eq!(fusing_depth(1e-12).unwrap(), 1);
        assert!(fusing_depth(1.0 - f64::EPSILON).unwrap() < u16::MAX);
        for bad in [0.0, 1.0, -0.5, f64::NAN, f64::INFINITY] {
            assert!(fusing_depth(bad).is_err(), "{bad}");
        }
    }
}
