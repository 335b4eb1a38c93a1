//! Cells and portals (Luebke and Georges 1995): boxes of open space, and the rectangles through which one sees from one into the next.
//!
//! Invariant, checked by [`Cells::new`]: boxes do not overlap; a portal is a rectangle in the common face of its two cells. What
//! cannot be checked is the promise that makes portals exact: the rest of a cell's faces is covered by what is drawn
//! opaque, or nothing but objects outside all cells lies beyond it. 100 bytes a cell and a portal.

use glam::DVec3;

use crate::error::{Error, Result};

/// A box of open space, in world coordinates. Faces belong to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// What it is called, for people.
    pub name: String,
    /// The smallest corner.
    pub min: DVec3,
    /// The greatest corner.
    pub max: DVec3,
}

/// An opening between two cells: an axis-aligned rectangle, open both ways.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Portal {
    /// Numbers of the two cells; in [`Cells`], the one on the lesser side of the plane first.
    pub cells: [u32; 2],
    /// The smallest corner.
    pub min: DVec3,
    /// The greatest corner: equal to the smallest along one axis, which the rectangle faces.
    pub max: DVec3,
}

impl Portal {
    /// The axis that it faces: the one along which it has no size.
    pub fn axis(&self) -> usize {
        (0..3).find(|&k| self.min[k] == self.max[k]).unwrap_or(0)
    }
}

/// Cells with the portals between them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Cells {
    cells: Vec<Cell>,
    portals: Vec<Portal>,
    /// Portal numbers, cell by cell.
    links: Vec<u32>,
    /// Where the portals of each cell begin in `links`, and the end.
    first_link: Vec<u32>,
}

impl Cells {
    /// Takes cells, and portals that name them by number.
    ///
    /// # Errors
    /// [`Error::Parameter`] naming `cells[i]` or `portals[i]`: a number that is not finite; a box without volume; two boxes that
    /// overlap; a portal of a cell that is not there, to its own cell, that is no rectangle, or does not lie in
    /// the common face of both.
    pub fn new(cells: Vec<Cell>, mut portals: Vec<Portal>) -> Result<Cells> {
        for (i, cell) in cells.iter().enumerate() {
            let finite = cell.min.is_finite() && cell.max.is_finite();
            if !finite || !cell.min.cmplt(cell.max).all() {
                return fail_cell(i, cell, "its min must be less than its max, in finite numbers");
            }
        }
        if let Some((i, j)) = overlapping(&cells) {
            return fail_cell(i, &cells[i], &format!("overlaps cells[{j}] '{}'", cells[j].name));
        }
        for (i, portal) in portals.iter_mut().enumerate() {
            let fail = |p: &Portal, reason: String| {
                Err(Error::parameter(format!("portals[{i}]"), format!("{} to {}", p.min, p.max), reason))
            };
            let [a, b] = portal.cells;
            if let Some(&absent) = portal.cells.iter().find(|&&c| c as usize >= cells.len()) {
                return fail(portal, format!("there is no cells[{absent}], only {} cells", cells.len()));
            }
            if a == b {
                return fail(portal, format!("joins cells[{a}] to itself"));
            }
            let flat = (0..3).filter(|&k| portal.min[k] == portal.max[k]).count();
            if flat != 1 || !portal.min.cmple(portal.max).all() || !portal.min.is_finite() || !portal.max.is_finite() {
                return fail(
                    portal,
                    "must be a rectangle: min equal to max along one axis, less along the others".into(),
                );
            }
            let axis = portal.axis();
            if cells[a as usize].max[axis] != portal.min[axis] {
                portal.cells = [b, a];
            }
            let in_faces = [0, 1].map(|side| holds(&cells[portal.cells[side] as usize], side, portal));
            if let Some(side) = in_faces.iter().position(|&held| !held) {
                let cell = portal.cells[side];
                let name = &cells[cell as usize].name;
                return fail(
                    portal,
                    format!("does not lie in the face of cells[{cell}] '{name}' towards the other cell"),
                );
            }
        }
        Ok(Cells::from_checked(cells, portals))
    }

    /// What [`Cells::new`] would accept, the lesser cell of each portal first, from code that built it so.
    pub(crate) fn from_checked(cells: Vec<Cell>, portals: Vec<Portal>) -> Cells {
        let mut first_link = vec![0u32; cells.len() + 1];
        portals.iter().flat_map(|p| p.cells).for_each(|c| first_link[c as usize + 1] += 1);
        for c in 0..cells.len() {
            first_link[c + 1] += first_link[c];
        }
        let mut next = first_link.clone();
        let mut links = vec![0; 2 * portals.len()];
        for (i, portal) in portals.iter().enumerate() {
            for c in portal.cells {
                links[next[c as usize] as usize] = i as u32;
                next[c as usize] += 1;
            }
        }
        Cells { cells, portals, links, first_link }
    }

    /// The cells, by number.
    pub fn cells(&self) -> &[Cell] {
        &self.cells
    }

    /// All portals.
    pub fn portals(&self) -> &[Portal] {
        &self.portals
    }

    /// The portals of a cell, each with the number of the cell beyond it.
    pub fn portals_of(&self, cell: u32) -> impl Iterator<Item = (&Portal, u32)> {
        let links = &self.links[self.first_link[cell as usize] as usize..self.first_link[cell as usize + 1] as usize];
        links.iter().map(move |&p| {
            let portal = &self.portals[p as usize];
            (portal, if portal.cells[0] == cell { portal.cells[1] } else { portal.cells[0] })
        })
    }

    /// The box around all cells, as its smallest and greatest corners; infinite the wrong way round without cells.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        self.cells.iter().fold(none, |(min, max), c| (min.min(c.min), max.max(c.max)))
    }
}

fn fail_cell<T>(i: usize, cell: &Cell, reason: &str) -> Result<T> {
    Err(Error::parameter(format!("cells[{i}]"), &cell.name, reason))
}

/// Whether a portal lies in the face towards the other cell of its cell on one side: 0 the lesser, 1 the greater.
fn holds(cell: &Cell, side: usize, portal: &Portal) -> bool {
    let axis = portal.axis();
    let face = if side == 0 { cell.max[axis] } else { cell.min[axis] };
    let along = |k: usize| k == axis || (cell.min[k] <= portal.min[k] && portal.max[k] <= cell.max[k]);
    face == portal.min[axis] && (0..3).all(along)
}

/// Two cells with common volume, if there are. A sweep along x: quadratic only where many share their x.
fn overlapping(cells: &[Cell]) -> Option<(usize, usize)> {
    let mut order: Vec<usize> = (0..cells.len()).collect();
    order.sort_by(|&a, &b| cells[a].min.x.total_cmp(&cells[b].min.x).then(a.cmp(&b)));
    let mut open: Vec<usize> = Vec::new();
    for i in order {
        let cell = &cells[i];
        open.retain(|&j| cells[j].max.x > cell.min.x);
        let overlap = |j: usize| cell.min.cmplt(cells[j].max).all() && cells[j].min.cmplt(cell.max).all();
        if let Some(&j) = open.iter().find(|&&j| overlap(j)) {
            return Some((i.max(j), i.min(j)));
        }
        open.push(i);
    }
    None
}
