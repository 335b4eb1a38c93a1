//! Triangles that wait until sixteen of a kind are there. Since what they do to a surface commutes, when a queue runs
//! out cannot be seen in the result.

use homcull_simd::{Mask, Simd};

use super::convex::PartialBlocks;
use super::each::each;
use super::medium::MediumBlocks;
use super::transform::{ScreenVertices, lanes, lanes_mut};

/// Sixteen triangles in registers. Corners are in the order that has positive area on the screen.
#[derive(Clone, Copy)]
pub(crate) struct Lanes<S: Simd> {
    /// Subpixels.
    pub x: [S::I; 3],
    pub y: [S::I; 3],
    /// Reversed depth of the nearest and the farthest corner.
    pub near: S::F,
    pub far: S::F,
    /// Screen x, y, w and depth of the three corners before the division.
    pub clip: [[S::F; 3]; 4],
    pub id: S::I,
}

/// Up to 31 triangles, by component.
#[repr(C, align(64))]
pub(crate) struct Queue {
    pub len: usize,
    x: [[i32; 32]; 3],
    y: [[i32; 32]; 3],
    near: [f32; 32],
    far: [f32; 32],
    clip: [[[f32; 32]; 3]; 4],
    id: [i32; 32],
}

impl Queue {
    fn new() -> Queue {
        Queue {
            len: 0,
            x: [[0; 32]; 3],
            y: [[0; 32]; 3],
            near: [0.0; 32],
            far: [0.0; 32],
            clip: [[[0.0; 32]; 3]; 4],
            id: [0; 32],
        }
    }

    /// Appends the triangles of the mask. There must be room: fewer than sixteen wait. `EXACT` queues keep what planes need.
    #[inline(always)]
    pub fn push<S: Simd, const EXACT: bool>(&mut self, s: S, k: Mask, t: &Lanes<S>) {
        let at = self.len..self.len + 16;
        for q in 0..3 {
            s.compress_i(k, t.x[q], lanes_mut(&mut self.x[q][at.clone()]));
            s.compress_i(k, t.y[q], lanes_mut(&mut self.y[q][at.clone()]));
        }
        s.compress_f(k, t.far, lanes_mut(&mut self.far[at.clone()]));
        if EXACT {
            s.compress_f(k, t.near, lanes_mut(&mut self.near[at.clone()]));
            for c in 0..4 {
                for q in 0..3 {
                    s.compress_f(k, t.clip[c][q], lanes_mut(&mut self.clip[c][q][at.clone()]));
                }
            }
            s.compress_i(k, t.id, lanes_mut(&mut self.id[at]));
        }
        self.len += k.count_ones() as usize;
    }

    /// The first sixteen places, and how many of them are triangles; these leave the queue.
    #[inline(always)]
    pub fn pop<S: Simd, const EXACT: bool>(&mut self, s: S) -> (Mask, Lanes<S>) {
        let taken = self.len.min(16);
        let mut out = Lanes {
            x: each!(3, q => s.load_i(lanes(&self.x[q][..16]))),
            y: each!(3, q => s.load_i(lanes(&self.y[q][..16]))),
            far: s.load_f(lanes(&self.far[..16])),
            near: s.splat_f(0.0),
            clip: [[s.splat_f(0.0); 3]; 4],
            id: s.splat_i(0),
        };
        if EXACT {
            out.near = s.load_f(lanes(&self.near[..16]));
            out.clip = each!(4, c => each!(3, q => s.load_f(lanes(&self.clip[c][q][..16]))));
            out.id = s.load_i(lanes(&self.id[..16]));
        }
        self.len -= taken;
        if self.len > 0 {
            self.move_down::<EXACT>();
        }
        ((0xFFFF_u32 >> (16 - taken)) as Mask, out)
    }

    #[inline(always)]
    fn move_down<const EXACT: bool>(&mut self) {
        for q in 0..3 {
            self.x[q].copy_within(16.., 0);
            self.y[q].copy_within(16.., 0);
        }
        self.far.copy_within(16.., 0);
        if EXACT {
            self.near.copy_within(16.., 0);
            self.id.copy_within(16.., 0);
            for corner in self.clip.iter_mut().flatten() {
                corner.copy_within(16.., 0);
            }
        }
    }
}

/// The working memory of one thread's rasterizer: reused from frame to frame, empty between calls.
pub(crate) struct Queues {
    pub vertices: ScreenVertices,
    pub small: Queue,
    pub large: Queue,
    pub partial: PartialBlocks,
    pub medium: MediumBlocks,
}

impl Queues {
    pub fn new() -> Box<Queues> {
        Box::new(Queues {
            vertices: ScreenVertices::new(),
            small: Queue::new(),
            large: Queue::new(),
            partial: PartialBlocks::new(),
            medium: MediumBlocks::new(),
        })
    }
}
