//! What an experiment found: a table with units, curves, and statements; and how these are printed and written.
//!
//! A statement sets the thesis's claim beside what the figures say; whether it is borne out is computed where they are.

use std::fmt;
use std::io;

use serde_json::{Map, Value, json};

use crate::error::Result;
use crate::measure::report_number::{NO_FIGURE, count, digits3};
use crate::measure::report_target::Target;
use crate::measure::table::Table;

/// The result of an experiment.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Findings {
    /// What the columns are.
    pub columns: Vec<Column>,
    /// As many cells each as there are columns.
    pub rows: Vec<Vec<Cell>>,
    /// Charts, drawn side by side.
    pub panels: Vec<Panel>,
    /// The thesis's claims, held against the figures.
    pub statements: Vec<Statement>,
}

/// A column of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Column {
    /// Its name in words; files write it with underscores.
    pub name: &'static str,
    /// What it is counted in; empty for text and plain numbers.
    pub unit: &'static str,
}

/// A figure of the table.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// A name.
    Text(String),
    /// A whole number.
    Count(u64),
    /// Any other number; one that is not finite is unknown.
    Figure(f64),
    /// Nothing to say here.
    Unknown,
}

/// A chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// What it shows, above it; may be empty.
    pub title: String,
    /// To the right.
    pub x: Axis,
    /// Upwards, from zero.
    pub y: Axis,
    /// Curves of one name have one colour in all panels.
    pub curves: Vec<Curve>,
}

/// An axis of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Its name, with the unit.
    pub name: String,
    /// How values are laid out.
    pub scale: Scale,
}

/// How values are laid out along an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scale {
    /// Evenly.
    Plain,
    /// Every doubling of this value takes the same room.
    Doubling(f64),
}

/// Points joined by lines.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// What the legend calls it.
    pub name: String,
    /// From left to right; those that are not finite are left out.
    pub points: Vec<(f64, f64)>,
    /// Whether it is a limit to compare with, drawn dashed in black.
    pub limit: bool,
}

/// A claim of the thesis, and what was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Statement {
    /// Where the thesis says so, or who does.
    pub section: &'static str,
    /// What it says, as a half sentence after "that".
    pub claim: &'static str,
    /// What the figures say, as a half sentence after "here".
    pub found: String,
    /// Whether they bear the claim out.
    pub holds: bool,
}

impl Axis {
    /// An axis of evenly laid out values.
    pub fn plain(name: impl Into<String>) -> Axis {
        Axis { name: name.into(), scale: Scale::Plain }
    }

    /// An axis of doublings of a value.
    pub fn doubling(name: impl Into<String>, from: f64) -> Axis {
        Axis { name: name.into(), scale: Scale::Doubling(from) }
    }
}

impl Curve {
    /// A curve of something measured.
    pub fn new(name: impl Into<String>, points: Vec<(f64, f64)>) -> Curve {
        Curve { name: name.into(), points, limit: false }
    }

    /// A level from one end of the chart to the other, to compare with.
    pub fn limit(name: impl Into<String>, from: f64, to: f64, level: f64) -> Curve {
        Curve { name: name.into(), points: vec![(from, level), (to, level)], limit: true }
    }
}

impl Findings {
    /// The table as text: heads, units under them, rows.
    pub fn table(&self) -> String {
        let mut table = Table::new();
        for (i, column) in self.columns.iter().enumerate() {
            let is_text = self.rows.iter().any(|row| matches!(row.get(i), Some(Cell::Text(_))));
            table = if is_text { table.left(column.name) } else { table.right(column.name) };
        }
        table.row(self.columns.iter().map(|column| column.unit));
        for row in &self.rows {
            table.row(row.iter().map(Cell::shown));
        }
        table.to_string()
    }

    /// The result as JSON: columns with units, rows by column name, statements. `about` says what it was measured on.
    pub fn json(&self, about: Value) -> Value {
        let columns: Vec<Value> =
            self.columns.iter().map(|column| json!({"name": column.key(), "unit": column.unit})).collect();
        let rows: Vec<Value> = self
            .rows
            .iter()
            .map(|row| {
                let cells = self.columns.iter().zip(row).map(|(column, cell)| (column.key(), cell.json()));
                Value::Object(cells.collect::<Map<String, Value>>())
            })
            .collect();
        let statements: Vec<Value> = self
            .statements
            .iter()
            .map(|s| json!({"section": s.section, "claim": s.claim, "found": s.found, "holds": s.holds}))
            .collect();
        let mut value = about;
        value["columns"] = json!(columns);
        value["rows"] = json!(rows);
        value["statements"] = json!(statements);
        value
    }

    /// Writes the table as comma-separated values, names in the first row, unknown cells empty.
    ///
    /// # Errors
    /// [`crate::Error::File`] with the target and the system's reason.
    pub fn write_csv(&self, target: &Target) -> Result<()> {
        target.write(|out| {
            let mut rows = csv::Writer::from_writer(out);
            rows.write_record(self.columns.iter().map(|column| column.key())).map_err(io::Error::from)?;
            for row in &self.rows {
                rows.write_record(row.iter().map(Cell::whole)).map_err(io::Error::from)?;
            }
            rows.flush()
        })
    }
}

impl Column {
    /// A column of figures in a unit, or of names without one.
    pub const fn new(name: &'static str, unit: &'static str) -> Column {
        Column { name, unit }
    }

    /// Its name in files.
    fn key(&self) -> String {
        self.name.replace([' ', '-'], "_")
    }
}

impl Cell {
    /// A name.
    pub fn text(text: impl Into<String>) -> Cell {
        Cell::Text(text.into())
    }

    fn shown(&self) -> String {
        match self {
            Cell::Text(text) => text.clone(),
            Cell::Count(n) => count(*n as f64),
            Cell::Figure(x) if x.abs() >= 1000.0 => count(*x),
            Cell::Figure(x) if x.to_string().len() <= 4 => x.to_string(), // chosen, like a threshold
            Cell::Figure(x) => digits3(*x),
            Cell::Unknown => NO_FIGURE.into(),
        }
    }

    fn whole(&self) -> String {
        match self {
            Cell::Text(text) => text.clone(),
            Cell::Count(n) => n.to_string(),
            Cell::Figure(x) if x.is_finite() => x.to_string(),
            Cell::Figure(_) | Cell::Unknown => String::new(),
        }
    }

    fn json(&self) -> Value {
        match self {
            Cell::Text(text) => json!(text),
            Cell::Count(n) => json!(n),
            Cell::Figure(x) => json!(x), // null when not finite
            Cell::Unknown => Value::Null,
        }
    }
}

impl fmt::Display for Statement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = if self.holds { "Borne out" } else { "NOT borne out" };
        let source = match of_thesis(self.section) {
            true => format!("The thesis ({}) claims", self.section),
            false => format!("{} claim", self.section),
        };
        write!(f, "{source} that {}. {verdict}: here {}.", self.claim, self.found)
    }
}

/// Whether a claim's section is one of the thesis: those are numbers alone, other papers are named.
pub(super) fn of_thesis(section: &str) -> bool {
    section.starts_with(|c: char| c.is_ascii_digit())
}
