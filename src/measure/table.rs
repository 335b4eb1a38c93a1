//! Text tables for terminals and pipes: aligned, plain ASCII apart from what the cells bring.
//!
//! Columns may stand in named groups; a group's name is centred between dashes over its columns, so
//! that twenty narrow columns stay readable at a glance. Widths are counted in characters. Every
//! row ends at its last visible character. Cost: one pass over the cells.

use std::fmt;

/// To which side of its column a cell keeps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// Text.
    Left,
    /// Figures.
    Right,
}

#[derive(Debug, Clone)]
struct Column {
    head: String,
    align: Align,
    /// Whether a group starts here.
    starts_group: bool,
}

#[derive(Debug, Clone)]
struct Group {
    name: String,
    /// Its columns, as indices.
    columns: std::ops::Range<usize>,
}

/// A table under construction; its [`fmt::Display`] is the finished text, with a last line end.
///
/// ```
/// use homcull::measure::table::Table;
/// let mut table = Table::new().left("scene").right("triangles");
/// table.row(["city", "312524"]);
/// table.row(["plant", "12748510"]);
/// assert_eq!(table.to_string(), "scene  triangles\ncity      312524\nplant   12748510\n");
/// ```
#[derive(Debug, Clone, Default)]
pub struct Table {
    columns: Vec<Column>,
    groups: Vec<Group>,
    rows: Vec<Vec<String>>,
    notes: Vec<String>,
}

/// Spaces between columns of one group.
const GAP: usize = 1;
/// Spaces between groups, and between all columns of a table without groups.
const GROUP_GAP: usize = 2;

impl Table {
    /// A table without columns.
    pub fn new() -> Table {
        Table::default()
    }

    /// Adds a column of text on its own.
    pub fn left(self, head: impl Into<String>) -> Table {
        self.column(head.into(), Align::Left, true)
    }

    /// Adds a column of figures on its own.
    pub fn right(self, head: impl Into<String>) -> Table {
        self.column(head.into(), Align::Right, true)
    }

    /// Adds columns of figures under one name; nothing if there are none.
    pub fn group(mut self, name: impl Into<String>, heads: &[&str]) -> Table {
        let first = self.columns.len();
        for (place, head) in heads.iter().enumerate() {
            self = self.column((*head).to_string(), Align::Right, place == 0);
        }
        if !heads.is_empty() {
            self.groups.push(Group { name: name.into(), columns: first..self.columns.len() });
        }
        self
    }

    fn column(mut self, head: String, align: Align, starts_group: bool) -> Table {
        self.columns.push(Column { head, align, starts_group });
        self
    }

    /// Adds a row. Missing cells stay empty, cells beyond the last column are not shown.
    pub fn row(&mut self, cells: impl IntoIterator<Item = impl Into<String>>) {
        self.rows.push(cells.into_iter().map(Into::into).collect());
    }

    /// Adds a line under the table.
    pub fn note(&mut self, line: impl Into<String>) {
        self.notes.push(line.into());
    }

    /// The width of each column: its widest cell or head, and room for the names of the groups.
    fn widths(&self) -> Vec<usize> {
        let mut widths: Vec<usize> = self.columns.iter().map(|column| width(&column.head)).collect();
        for row in &self.rows {
            for (widest, cell) in widths.iter_mut().zip(row) {
                *widest = (*widest).max(width(cell));
            }
        }
        for group in &self.groups {
            let short = width(&group.name).saturating_sub(span(&widths[group.columns.clone()]));
            widths[group.columns.start] += short;
        }
        widths
    }

    fn write_groups(&self, f: &mut fmt::Formatter<'_>, widths: &[usize]) -> fmt::Result {
        let mut line = String::new();
        for group in &self.groups {
            let before: usize = widths[..group.columns.start].iter().sum::<usize>()
                + self.columns[1..=group.columns.start].iter().map(gap_before).sum::<usize>();
            line.push_str(&" ".repeat(before.saturating_sub(width(&line))));
            line.push_str(&framed(&group.name, span(&widths[group.columns.clone()])));
        }
        writeln!(f, "{}", line.trim_end())
    }

    fn write_row<'a>(
        &self,
        f: &mut fmt::Formatter<'_>,
        widths: &[usize],
        cells: impl Iterator<Item = &'a str>,
    ) -> fmt::Result {
        let mut line = String::new();
        for (index, ((column, &column_width), cell)) in self.columns.iter().zip(widths).zip(cells).enumerate() {
            if index > 0 {
                line.push_str(&" ".repeat(gap_before(column)));
            }
            let padding = " ".repeat(column_width.saturating_sub(width(cell)));
            match column.align {
                Align::Left => line.extend([cell, &padding]),
                Align::Right => line.extend([&padding, cell]),
            }
        }
        writeln!(f, "{}", line.trim_end())
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let widths = self.widths();
        if !self.groups.is_empty() {
            self.write_groups(f, &widths)?;
        }
        if !self.columns.is_empty() {
            self.write_row(f, &widths, self.columns.iter().map(|column| column.head.as_str()))?;
        }
        for row in &self.rows {
            self.write_row(f, &widths, row.iter().map(String::as_str))?;
        }
        self.notes.iter().try_for_each(|note| writeln!(f, "{note}"))
    }
}

fn gap_before(column: &Column) -> usize {
    if column.starts_group { GROUP_GAP } else { GAP }
}

/// The width of adjoining columns of one group.
fn span(widths: &[usize]) -> usize {
    widths.iter().sum::<usize>() + GAP * widths.len().saturating_sub(1)
}

fn width(text: &str) -> usize {
    text.chars().count()
}

/// `name` in the middle of `span` characters, dashes to both sides if they fit on both.
fn framed(name: &str, span: usize) -> String {
    let room = span.saturating_sub(width(name));
    let (before, after) = (room / 2, room - room / 2);
    if before < 2 {
        return format!("{}{name}{}", " ".repeat(before), " ".repeat(after));
    }
    format!("{} {name} {}", "-".repeat(before - 1), "-".repeat(after - 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_keep_right_and_text_left() {
        let mut table = Table::new().left("name").group("ms", &["a", "b"]).right("n");
        table.row(["x", "1.5", "10", "7"]);
        table.row(["longer", "22.25", "3", ""]);
        let expected = ["        -- ms --", "name        a  b  n", "x         1.5 10  7", "longer  22.25  3"];
        assert_eq!(table.to_string().lines().collect::<Vec<_>>(), expected);
    }

    #[test]
    fn a_long_group_name_widens_its_columns() {
        let mut table = Table::new().left("m").group("wrong pixels", &["a"]);
        table.row(["x", "1"]);
        assert_eq!(table.to_string(), "   wrong pixels\nm             a\nx             1\n");
    }

    #[test]
    fn rows_that_are_too_short_or_too_long_do_no_harm() {
        let mut table = Table::new().left("a").right("b");
        table.row(["1"]);
        table.row(["1", "2", "3"]);
        assert_eq!(table.to_string(), "a  b\n1\n1  2\n");
        assert_eq!(Table::new().group("none", &[]).to_string(), "");
    }
}
