//! What an occlusion buffer holds: its size and counts, coverage and depth of samples, a hash, a picture in text.

use super::buffer::OcclusionBuffer;
use super::depth::Depth;
use super::depth_estimation::DepthEstimationBuffer;
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

    /// The reversed depth that stands for the occluders at a sample; `None` outside the viewport. In the no-background Z-buffer it is
    /// the effective depth, 0 where nothing covers the sample; a far boundary has +infinity where no occluder is. Without
    /// depth it is +infinity where the sample is covered, else 0.
    pub fn depth_at(&self, x: u32, y: u32) -> Option<f32> {
        let covered = self.covered(x, y)?;
        Some(match &self.depth {
            Depth::Nothing if covered => f32::INFINITY,
            Depth::Nothing => 0.0,
            Depth::InMap => {
                let (tile, block) = self.map.grid.place(x as usize / 8, y as usize / 8);
                self.effective(tile, block, (y as usize % 8) * 8 + x as usize % 8)
            }
            Depth::Estimation(buffer) => buffer.at(x as i32, y as i32),
            Depth::Plane(plane) => plane.depth(),
        })
    }

    /// The depth estimation buffer, where depth is kept in one.
    pub fn depth_estimation(&self) -> Option<&DepthEstimationBuffer> {
        if let Depth::Estimation(buffer) = &self.depth { Some(buffer) } else { None }
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

    /// A hash of coverage and of the depths kept: of what the state means, not of how it came about.
    pub fn state_hash(&self) -> u64 {
        let (grid, coverage) = (self.map.grid, self.coverage());
        let mut hash = crate::hash::Hash::default();
        for by in 0..grid.blocks_y() {
            for bx in 0..grid.blocks_x() {
                let (tile, block) = grid.place(bx, by);
                hash.add(coverage.word(tile, block));
                for sample in (0..64).filter(|_| self.depth.is_in_map()) {
                    hash.add(self.effective(tile, block, sample).to_bits().into());
                }
            }
        }
        match &self.depth {
            Depth::Nothing | Depth::InMap => {}
            Depth::Estimation(buffer) => buffer.depths().iter().for_each(|z| hash.add(z.to_bits().into())),
            Depth::Plane(plane) => hash.add(plane.depth().to_bits().into()),
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
