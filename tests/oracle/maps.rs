//! Maps of covered samples, and the overlap test of figure 5.3 on them, counted anew at every look.

use homcull::geometry::SampleRect;
use homcull::occlusion::PyramidShape;

use super::random::Random;

/// Which samples are covered.
#[derive(Clone)]
pub struct Map {
    pub width: usize,
    pub height: usize,
    covered: Vec<bool>,
}

impl Map {
    pub fn covered(&self, x: usize, y: usize) -> bool {
        self.covered[y * self.width + x]
    }

    pub fn open(&mut self, x: usize, y: usize) {
        self.covered[y * self.width + x] = false;
    }

    /// Uncovered samples of a rectangle inside the map.
    pub fn holes(&self, r: SampleRect) -> usize {
        let row = |y: i32| (r.x0..=r.x1).filter(|&x| !self.covered(x as usize, y as usize)).count();
        (r.y0..=r.y1).map(row).sum()
    }

    pub fn all_covered(&self, r: SampleRect) -> bool {
        self.holes(r) == 0
    }
}

pub fn full(width: usize, height: usize) -> Map {
    Map { width, height, covered: vec![true; width * height] }
}

/// Regions of all densities, so that every level has opaque, transparent and mixed pixels.
pub fn random(r: &mut Random) -> Map {
    let (width, height) = [(160, 96), (131, 77), (64, 64), (9, 5), (1, 70), (200, 33)][r.below(6)];
    let mut map = full(width, height);
    let side = [8, 16, 32][r.below(3)];
    let across = width.div_ceil(side);
    let densities: Vec<f64> = (0..across * height.div_ceil(side))
        .map(|_| [0.0, 0.1, 0.5, 0.9, 0.97, 0.99, 1.0, 1.0, 1.0][r.below(9)])
        .collect();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        if !r.chance(densities[y / side * across + x / side]) {
            map.open(x, y);
        }
    }
    map
}

pub fn random_rect(r: &mut Random, map: &Map) -> SampleRect {
    let mut range = |size: usize, most: usize| {
        let length = 1 + r.below(most.min(size));
        let from = r.below(size - length + 1);
        (from as i32, (from + length - 1) as i32)
    };
    let most = [4, 12, 40, 200];
    let (x0, x1) = range(map.width, most[map.width % 4]);
    let (y0, y1) = range(map.height, 60);
    SampleRect { x0, y0, x1, y1 }
}

/// What the test goes by.
pub struct Rules {
    pub shape: PyramidShape,
    /// Width and height of every level.
    pub sizes: Vec<(usize, usize)>,
    pub active: (usize, usize),
    /// By level above the finest active one.
    pub opacity: Vec<f64>,
    pub transparency: Vec<f64>,
    pub predicts: bool,
    viewport: (usize, usize),
}

/// What a test found.
#[derive(Debug, PartialEq)]
pub struct Found {
    pub passed: bool,
    pub level: usize,
}

/// `T' = 1 - D (1 - T) / 4` and `t' = D t / 4`, level by level.
pub fn by_recursion(t: f64, low: f64, d: f64) -> (Vec<f64>, Vec<f64>) {
    let mut opacity = vec![t];
    let mut transparency = vec![low];
    for level in 0..15 {
        opacity.push(1.0 - d * (1.0 - opacity[level]) / 4.0);
        transparency.push(d * transparency[level] / 4.0);
    }
    (opacity, transparency)
}

impl Rules {
    pub fn new(map: &Map, shape: PyramidShape) -> Rules {
        let cut = |size: usize, side: u32| size.div_ceil(side as usize);
        let mut sizes = vec![(cut(map.width, shape.block[0]), cut(map.height, shape.block[1]))];
        while let Some(&(w, h)) = sizes.last()
            && (w, h) != (1, 1)
            && w.div_ceil(2) >= shape.minimal[0] as usize
            && h.div_ceil(2) >= shape.minimal[1] as usize
        {
            sizes.push((w.div_ceil(2), h.div_ceil(2)));
        }
        Rules {
            shape,
            active: (0, sizes.len() - 1),
            sizes,
            opacity: vec![1.0; 16],
            transparency: vec![0.0; 16],
            predicts: true,
            viewport: (map.width, map.height),
        }
    }

    fn side(&self, level: usize) -> (usize, usize) {
        ((self.shape.block[0] as usize) << level, (self.shape.block[1] as usize) << level)
    }

    /// The samples of a pixel, inside the viewport.
    pub fn pixel(&self, level: usize, x: usize, y: usize) -> SampleRect {
        let (m, n) = self.side(level);
        SampleRect {
            x0: (x * m) as i32,
            y0: (y * n) as i32,
            x1: ((x + 1) * m).min(self.viewport.0) as i32 - 1,
            y1: ((y + 1) * n).min(self.viewport.1) as i32 - 1,
        }
    }
}

fn common(a: SampleRect, b: SampleRect) -> SampleRect {
    SampleRect { x0: a.x0.max(b.x0), y0: a.y0.max(b.y0), x1: a.x1.min(b.x1), y1: a.y1.min(b.y1) }
}

fn is_empty(r: SampleRect) -> bool {
    r.x0 > r.x1 || r.y0 > r.y1
}

/// Pixels of a level that a rectangle touches, row by row.
fn touched(rules: &Rules, level: usize, r: SampleRect) -> Vec<(usize, usize)> {
    let (width, height) = rules.sizes[level];
    (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .filter(|&(x, y)| !is_empty(common(rules.pixel(level, x, y), r)))
        .collect()
}

/// `OverlapTest`, from the finest active level whose pixels exceed the rectangle's smaller side.
pub fn overlap_test(map: &Map, rules: &Rules, r: SampleRect) -> Found {
    let (width, height) = ((r.x1 - r.x0 + 1) as usize, (r.y1 - r.y0 + 1) as usize);
    let exceeds = |level: usize| {
        let (m, n) = rules.side(level);
        if width <= height { m > width } else { n > height }
    };
    let (finest, coarsest) = rules.active;
    let start = (finest..=coarsest).find(|&level| exceeds(level)).unwrap_or(coarsest);
    let mut lowest = start;
    for (x, y) in touched(rules, start, r) {
        if let Some(failed) = check_pixel(map, rules, start, x, y, r, &mut lowest) {
            return Found { passed: false, level: failed };
        }
    }
    Found { passed: true, level: lowest }
}

/// `CheckPixel`: the level at which it fails, if it does.
#[allow(clippy::if_same_then_else)] // one reason a line, as in figure 5.3
fn check_pixel(
    map: &Map,
    rules: &Rules,
    level: usize,
    x: usize,
    y: usize,
    r: SampleRect,
    lowest: &mut usize,
) -> Option<usize> {
    *lowest = level.min(*lowest);
    let (m, n) = rules.side(level);
    let samples = (m * n) as f64;
    let holes = map.holes(rules.pixel(level, x, y));
    // Below an opacity: more holes than it allows.
    let below = |opacity: f64| holes > ((1.0 - opacity) * samples + 1e-9).floor() as usize;
    let finest = rules.active.0;
    let inside = common(rules.pixel(level, x, y), r) == rules.pixel(level, x, y);
    if !below(rules.opacity[level - finest]) {
        None
    } else if level == finest {
        let seen = level > 0 || map.holes(common(rules.pixel(level, x, y), r)) > 0;
        seen.then_some(level)
    } else if below(rules.transparency[level - finest]) || holes == m * n {
        Some(level)
    } else if rules.predicts && inside && below(rules.opacity[0]) {
        Some(level)
    } else if rules.predicts && inside && (finest..level).any(|finer| below(rules.transparency[finer - finest])) {
        Some(level)
    } else {
        touched(rules, level - 1, r)
            .into_iter()
            .filter(|&(cx, cy)| (cx / 2, cy / 2) == (x, y))
            .find_map(|(cx, cy)| check_pixel(map, rules, level - 1, cx, cy, r, lowest))
    }
}

/// 1 less the lowest opacity among the touched pixels of a level; at level 0 a pixel is opaque if all that the rectangle touches of it is.
pub fn level_of_visibility(map: &Map, rules: &Rules, r: SampleRect, level: usize) -> f64 {
    let opacity = |(x, y)| {
        let pixel = rules.pixel(level, x, y);
        let samples = (pixel.x1 - pixel.x0 + 1) * (pixel.y1 - pixel.y0 + 1);
        let covered = level == 0 && map.all_covered(common(pixel, r));
        if covered { 1.0 } else { 1.0 - map.holes(pixel) as f64 / f64::from(samples) }
    };
    1.0 - touched(rules, level, r).into_iter().map(opacity).fold(1.0, f64::min)
}
