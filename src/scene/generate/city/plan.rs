//! The plan: twelve districts in four columns and three rows, their blocks, and the streets between them.
//!
//! Streets run straight through the city on lines that districts share; avenues part the districts and go around the whole.
//! Coordinates are metres, x to the east and z to the south, with the middle of the city at the origin.

use glam::DVec2;

/// Width of a street between two blocks of a district.
pub(super) const STREET: f64 = 14.0;
/// Width of an avenue between districts and around the city.
pub(super) const AVENUE: f64 = 24.0;

/// How the blocks of a district are built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Style {
    /// Houses wall to wall around a courtyard.
    Terraces,
    /// Square towers that step back.
    Towers,
    /// Round towers.
    Rounds,
    /// Long parallel slabs.
    Slabs,
    /// Detached houses in gardens.
    Villas,
    /// Halls with sawtooth roofs, tanks and chimneys.
    Halls,
    /// One large building with columns and a dome.
    Civic,
}

/// How roofs are shaped where the style leaves a choice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Roof {
    /// Flat, with a parapet.
    Flat,
    /// Two slopes.
    Gable,
    /// Four slopes to a point or a small platform.
    Hip,
}

/// What makes a district itself.
#[derive(Debug, Clone, Copy)]
pub(super) struct District {
    pub name: &'static str,
    pub style: Style,
    /// Fewest and most storeys.
    pub floors: (usize, usize),
    /// Metres of a storey.
    pub storey: f32,
    /// Metres of street front that a house of a terrace takes, least and most.
    pub front: (f64, f64),
    pub roof: Roof,
    /// Metres between trees along the streets.
    pub trees: f64,
    /// Walls.
    pub tones: [[u8; 3]; 3],
}

/// Row by row from the north-west.
#[rustfmt::skip]
pub(super) const DISTRICTS: [District; 12] = [
    District { name: "docks", style: Style::Halls, floors: (2, 3), storey: 4.5, front: (20.0, 30.0), roof: Roof::Flat, trees: 40.0, tones: [[142, 122, 108], [120, 126, 130], [158, 134, 110]] },
    District { name: "rows", style: Style::Terraces, floors: (2, 3), storey: 3.0, front: (6.0, 8.0), roof: Roof::Gable, trees: 22.0, tones: [[168, 98, 80], [184, 120, 96], [150, 90, 78]] },
    District { name: "gardens", style: Style::Villas, floors: (1, 2), storey: 2.9, front: (10.0, 14.0), roof: Roof::Gable, trees: 9.0, tones: [[214, 204, 184], [196, 182, 160], [222, 214, 204]] },
    District { name: "campus", style: Style::Slabs, floors: (3, 5), storey: 3.6, front: (12.0, 16.0), roof: Roof::Flat, trees: 12.0, tones: [[188, 176, 160], [170, 130, 110], [200, 196, 188]] },
    District { name: "old-town", style: Style::Terraces, floors: (3, 5), storey: 3.2, front: (7.0, 12.0), roof: Roof::Gable, trees: 30.0, tones: [[206, 180, 138], [194, 150, 118], [216, 200, 172]] },
    District { name: "finance", style: Style::Towers, floors: (16, 36), storey: 3.5, front: (18.0, 26.0), roof: Roof::Flat, trees: 20.0, tones: [[120, 138, 156], [96, 112, 132], [150, 160, 168]] },
    District { name: "boulevards", style: Style::Terraces, floors: (5, 7), storey: 3.4, front: (12.0, 18.0), roof: Roof::Hip, trees: 10.0, tones: [[220, 208, 184], [212, 196, 166], [226, 218, 202]] },
    District { name: "estate", style: Style::Slabs, floors: (8, 13), storey: 2.8, front: (14.0, 18.0), roof: Roof::Flat, trees: 14.0, tones: [[186, 186, 180], [170, 176, 182], [198, 186, 168]] },
    District { name: "civic", style: Style::Civic, floors: (3, 4), storey: 4.5, front: (20.0, 30.0), roof: Roof::Hip, trees: 11.0, tones: [[222, 216, 200], [210, 200, 180], [230, 226, 216]] },
    District { name: "market", style: Style::Terraces, floors: (2, 4), storey: 3.3, front: (8.0, 14.0), roof: Roof::Hip, trees: 16.0, tones: [[198, 160, 110], [176, 138, 104], [208, 186, 150]] },
    District { name: "station", style: Style::Towers, floors: (7, 14), storey: 3.4, front: (16.0, 24.0), roof: Roof::Flat, trees: 18.0, tones: [[164, 156, 146], [140, 132, 126], [180, 168, 150]] },
    District { name: "riverside", style: Style::Rounds, floors: (12, 22), storey: 3.2, front: (18.0, 24.0), roof: Roof::Flat, trees: 12.0, tones: [[176, 190, 196], [200, 204, 204], [150, 172, 184]] },
];

/// Block sizes of the district columns (along x) and rows (along z).
const WIDTHS: [f64; 4] = [62.0, 54.0, 68.0, 58.0];
const DEPTHS: [f64; 3] = [56.0, 64.0, 52.0];

/// A rectangle on the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plot {
    pub min: DVec2,
    pub max: DVec2,
}

impl Plot {
    pub fn size(self) -> DVec2 {
        self.max - self.min
    }

    pub fn middle(self) -> DVec2 {
        (self.min + self.max) * 0.5
    }

    /// Without a margin on every side.
    pub fn inset(self, margin: f64) -> Plot {
        Plot { min: self.min + margin, max: self.max - margin }
    }
}

/// A block: its plot, kerb to kerb, and the plot out to the middle of the streets around it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    pub district: usize,
    /// Place within the district, row by row.
    pub number: usize,
    pub plot: Plot,
    pub cell: Plot,
}

/// Where everything is.
pub(super) struct Plan {
    pub blocks: Vec<Block>,
    /// The middle lines of the streets that run along z, and of those along x, borders included.
    pub lines_x: Vec<f64>,
    pub lines_z: Vec<f64>,
}

impl Plan {
    /// Districts of `columns` x `rows` blocks.
    pub fn new(columns: usize, rows: usize) -> Plan {
        let (spans_x, lines_x) = axis(&WIDTHS, columns);
        let (spans_z, lines_z) = axis(&DEPTHS, rows);
        let mut blocks = Vec::new();
        for (j, z) in spans_z.iter().enumerate() {
            for (i, x) in spans_x.iter().enumerate() {
                blocks.push(Block {
                    district: j / rows * WIDTHS.len() + i / columns,
                    number: j % rows * columns + i % columns,
                    plot: Plot { min: DVec2::new(x.0, z.0), max: DVec2::new(x.1, z.1) },
                    cell: Plot {
                        min: DVec2::new(lines_x[i], lines_z[j]),
                        max: DVec2::new(lines_x[i + 1], lines_z[j + 1]),
                    },
                });
            }
        }
        // District by district, as one reads a map.
        blocks.sort_by_key(|b| (b.district, b.number));
        Plan { blocks, lines_x, lines_z }
    }

    /// The rectangle within the border avenues' middle lines.
    pub fn bounds(&self) -> Plot {
        let ends = |lines: &[f64]| (lines[0], lines[lines.len() - 1]);
        let (x, z) = (ends(&self.lines_x), ends(&self.lines_z));
        Plot { min: DVec2::new(x.0, z.0), max: DVec2::new(x.1, z.1) }
    }
}

/// Spans of the blocks along one axis, and the middle lines of the streets before, between and after them.
fn axis(sizes: &[f64], blocks: usize) -> (Vec<(f64, f64)>, Vec<f64>) {
    let (mut spans, mut lines, mut at) = (Vec::new(), Vec::new(), 0.0);
    for &size in sizes {
        for block in 0..blocks {
            let street = if block == 0 { AVENUE } else { STREET };
            lines.push(at + street * 0.5);
            spans.push((at + street, at + street + size));
            at += street + size;
        }
    }
    lines.push(at + AVENUE * 0.5);
    let shift = (at + AVENUE) * 0.5;
    (spans.iter().map(|s| (s.0 - shift, s.1 - shift)).collect(), lines.iter().map(|l| l - shift).collect())
}
