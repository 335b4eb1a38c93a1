//! Stiff and extreme cases: what the guarantees (*Total input*, *Image identity*, *Determinism*) are held against.
//!
//! Each case builds a small scene and looks at it in some views, at every SIMD level of the CPU. Asked is that nothing
//! panics; that no object which the item buffer of the full draw shows is called hidden, by queries against the full
//! buffer, by progressive culling in one band or several, or by any hom method through the hierarchy; that the picture drawn
//! from what all of them left over equals the full one, bit for bit; that all levels give the same states, verdicts and
//! pictures; that occluders are nowhere kept nearer than drawn; and that the drawn depth is right.
//!
//! **The depth's bound** is derived for every sample (`depth.rs`), from what the library documents. The truth is the ray
//! through the sample's centre met with the *unsnapped* triangle's plane, in f64. Against it stand
//! - rounding in the transform: a row `r` of a vertex errs by at most `8 u S` with `u = 2^-24` and
//!   `S = sum |r_i| (|p_i| + |R||v|) + |r_w|` (three roundings in `R v`, one in the subtraction, one of the coefficient, one
//!   in the product, two in the sums). With `z = A x + B y + C` the true plane and `b'` the barycentrics of the
//!   rounded triangle, depth errs by exactly `sum b'_i (dZ_i - A dX_i - B dY_i - C dW_i)`: bounded term by term;
//! - f32 sums in a tile: `8 u (z + 62 g)`, `g` the change of depth from sample to sample;
//! - snapping: half a subpixel times the gradient, though the plane is that of the homogeneous corners: it moves coverage only;
//! - the clamp to the rounded depths of the corners, and the rounding of f64 itself.
//!
//! Samples within 1/128 of a sample of an edge, or within twice what rounding may move the edge, are left out, as are those
//! where rounding may turn the triangle over. A drawn sample as far *outside* its triangle is a stray, and a fault.
//!
//! Cost: some ten draws a view and level; the whole table takes seconds, the 16384x16384 case 1.1 GB for a moment.

mod cases;
mod depth;
mod judge;
mod questions;
mod shapes;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use homcull_simd::Level;

use super::table::Table;
use crate::cull::vfc::World;
use crate::error::{Error, Result};
use crate::scene::{PreparedScene, Scene};
use crate::view::View;

pub use cases::cases;

/// One stiff or extreme case.
#[derive(Debug, Clone, Copy)]
pub struct StabilityCase {
    /// Its name, without spaces.
    pub name: &'static str,
    /// What is extreme in it.
    pub about: &'static str,
    subject: Subject,
}

/// What a case looks at.
#[derive(Debug, Clone, Copy)]
enum Subject {
    /// A scene in views: pictures, states and verdicts.
    Pictures(fn() -> Result<Setup>),
    /// The occlusion buffer alone, where a canvas would be too large: the answers are known by construction.
    Buffer(fn() -> Result<Known>),
    /// Questions with one right answer each.
    Answers(fn() -> Vec<(&'static str, bool)>),
}

/// A scene and its views, all of one size.
struct Setup {
    scene: Scene,
    views: Vec<View>,
}

/// A scene of which is known what is hidden.
struct Known {
    scene: Scene,
    view: View,
    /// By object id.
    hidden: Vec<bool>,
}

/// What a case showed.
#[derive(Debug, Clone, Default)]
pub struct StabilityRow {
    /// The case's name.
    pub name: &'static str,
    /// Objects of the scene, or questions asked.
    pub objects: usize,
    /// Views looked at.
    pub views: usize,
    /// Objects hidden, over all views, by queries against the full buffer.
    pub hidden: u64,
    /// Objects visible, by the same.
    pub visible: u64,
    /// Objects that the item buffer shows but some test called hidden, over views and levels. Must be 0.
    pub false_culls: u64,
    /// Whether all SIMD levels gave the same bits and verdicts.
    pub levels_equal: bool,
    /// How many levels there were.
    pub levels: usize,
    /// Samples whose depth was compared.
    pub samples: u64,
    /// The largest error of a drawn depth, relative to the depth.
    pub depth_error: f64,
    /// The bound at that sample, relative to the depth.
    pub depth_bound: f64,
    /// The largest share of its own bound that an error took. Must be at most 1.
    pub depth_share: f64,
    /// Milliseconds.
    pub ms: f64,
    /// What went wrong, in words; empty for a case that holds.
    pub failures: Vec<String>,
}

impl StabilityRow {
    /// True when the case holds.
    pub fn ok(&self) -> bool {
        self.failures.is_empty()
    }
}

/// Runs a case. What goes wrong, a panic included, is in the row's `failures`.
///
/// # Errors
/// [`Error::Parameter`] naming the case when the library refuses its scene or a view.
pub fn run_case(case: &StabilityCase) -> Result<StabilityRow> {
    let start = Instant::now();
    let mut row = StabilityRow { name: case.name, levels_equal: true, ..StabilityRow::default() };
    let ran = catch_unwind(AssertUnwindSafe(|| {
        let mut row = row.clone();
        run(case, &mut row).map(|()| row)
    }));
    match ran {
        Ok(done) => row = done.map_err(|e| Error::parameter("case", case.name, e.to_string()))?,
        Err(panic) => {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message");
            row.failures.push(format!("panicked: {text}"));
        }
    }
    row.ms = start.elapsed().as_secs_f64() * 1e3;
    Ok(row)
}

fn run(case: &StabilityCase, row: &mut StabilityRow) -> Result<()> {
    match case.subject {
        Subject::Pictures(make) => {
            let Setup { scene, views } = make()?;
            let prepared = PreparedScene::new(&scene)?;
            let world = World::new(&prepared);
            (row.objects, row.views) = (scene.objects.len(), views.len());
            judge::pictures(&scene, &world, &views, &levels(), row)
        }
        Subject::Buffer(make) => {
            let known = make()?;
            (row.objects, row.views) = (known.scene.objects.len(), 1);
            judge::buffer(&known, &levels(), row)
        }
        Subject::Answers(ask) => {
            let answers = ask();
            row.objects = answers.len();
            row.levels = levels().len();
            row.failures.extend(answers.iter().filter(|a| !a.1).map(|a| a.0.to_owned()));
            Ok(())
        }
    }
}

/// The levels of this CPU.
fn levels() -> Vec<Level> {
    Level::ALL.into_iter().filter(|l| l.is_available()).collect()
}

/// The rows as a table; what went wrong stands under it.
pub fn table(rows: &[StabilityRow]) -> Table {
    let mut table = Table::new()
        .left("case")
        .group("scene", &["objects", "views"])
        .group("verdicts", &["hidden", "visible", "false culls"])
        .right("levels equal")
        .group("depth", &["samples", "largest error", "its bound", "of bound"])
        .right("ms")
        .right("ok");
    for row in rows {
        let compared = row.samples > 0;
        let small = |v: f64| if compared { format!("{v:.1e}") } else { "-".into() };
        table.row([
            row.name.to_owned(),
            row.objects.to_string(),
            row.views.to_string(),
            row.hidden.to_string(),
            row.visible.to_string(),
            row.false_culls.to_string(),
            if row.levels_equal { format!("{} yes", row.levels) } else { "NO".into() },
            row.samples.to_string(),
            small(row.depth_error),
            small(row.depth_bound),
            if compared { format!("{:.2}", row.depth_share) } else { "-".into() },
            format!("{:.0}", row.ms),
            if row.ok() { "ok".into() } else { "FAILED".into() },
        ]);
    }
    for row in rows {
        for failure in &row.failures {
            table.note(format!("{}: {failure}", row.name));
        }
    }
    table
}
