//! What an occlusion buffer holds: its size and counts, coverage and depth of samples, a hash, a picture in text.

use super::buffer::OcclusionBuffer;
use crate::raster::RasterCounts;

impl OcclusionBuffer {
    /// Width and height in samples.
    pub fn size(&self) -> (u32, u32) {
        (self.map.grid.width() as u32, self.map.grid.height() as u32)
    }

    /// What the rasterizer did since the view began.
    pub fn counts(&self) -> RasterCounts {
        self.counts
    }

    /// The effective reversed depth at a sample, 0 where nothing covers it; `None` outside the viewport.
    pub fn depth_at(&self, x: u32, y: u32) -> Option<f32> {
        let grid = self.map.grid;
        if x >= grid.width() as u32 || y >= grid.height() as u32 {
            return None;
        }
        let (tile, block) = grid.place(x as usize / 8, y as usize / 8);
        Some(self.effective(tile, block, (y as usize % 8) * 8 + x as usize % 8))
    }

    /// True when an occluder covers the sample; `None` outside the viewport.
    pub fn covered(&self, x: u32, y: u32) -> Option<bool> {
        let grid = self.map.grid;
        if x >= grid.width() as u32 || y >= grid.height() as u32 {
            return None;
        }
        let (tile, block) = grid.place(x as usize / 8, y as usize / 8);
        Some(self.coverage().word(tile, block) >> ((y % 8) * 8 + x % 8) & 1 != 0)
    }

    /// The effective depth of a sample, of opaque or fused occluders, whichever is nearer.
    fn effective(&self, tile: usize, block: usize, sample: usize) -> f32 {
        let fused = self.layers.as_ref().map_or(0.0, |layers| layers.depth(tile, block, sample));
        self.map.view().effective(tile, block, sample).max(fused)
    }

    /// A hash of coverage and effective depths: of what the state means, not of how it came about.
    pub fn state_hash(&self) -> u64 {
        let (grid, coverage) = (self.map.grid, self.coverage());
        let mut hash = crate::hash::Hash::default();
        for by in 0..grid.blocks_y() {
            for bx in 0..grid.blocks_x() {
                let (tile, block) = grid.place(bx, by);
                hash.add(coverage.word(tile, block));
                for sample in 0..64 {
                    hash.add(self.effective(tile, block, sample).to_bits().into());
                }
            }
        }
        hash.value()
    }

    /// The buffer as text, one character a block of samples: ` ` open, `.` up to half covered, `+` more, `#` whole.
    pub fn to_ascii(&self) -> String {
        let (grid, coverage) = (self.map.grid, self.coverage());
        let mut out = String::new();
        for by in 0..grid.blocks_y() {
            for bx in 0..grid.blocks_x() {
                let (tile, block) = grid.place(bx, by);
                let samples = (!grid.padding(bx, by)).count_ones();
                let holes = coverage.word(tile, block).count_zeros();
                out.push(match (holes, samples - holes) {
                    (0, _) => '#',
                    (_, 0) => ' ',
                    (holes, covered) if covered > holes => '+',
                    _ => '.',
                });
            }
            out.push('\n');
        }
        out
    }
}
