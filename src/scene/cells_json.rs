//! Cells and portals as JSON files, `NAME.cells.json` beside `NAME.obj`:
//!
//! ```json
//! {"cells": [{"name": "hall", "min": [0, 0, 0], "max": [5, 3, 4]}, {"name": "study", "min": [5, 0, 0], "max": [9, 3, 4]}],
//!  "portals": [{"cells": [0, 1], "min": [5, 0, 1], "max": [5, 2, 2]}]}
//! ```
//!
//! Boxes in the model's units; a portal is a rectangle in the common face of two cells, given by number. `name` may be left
//! out, and so may `portals`. Fields that are not known are left alone.

use std::path::Path;

use serde_json::Value;

use super::{Cell, Cells, Portal};
use crate::error::{Error, Result};
use crate::view::{field, read_json, vector};

/// Reads cells and portals.
///
/// # Errors
/// [`Error::File`] when the file cannot be read; [`Error::Format`] naming the line of a syntax error, the key that is missing or of
/// the wrong kind, or the cell or portal that [`Cells::new`] refuses.
pub fn load_cells(path: &Path) -> Result<Cells> {
    let fail = |reason| Error::Format { path: path.into(), line: None, reason };
    let (cells, portals) = parse(&read_json(path)?).map_err(fail)?;
    Cells::new(cells, portals).map_err(|e| fail(e.to_string()))
}

fn parse(value: &Value) -> std::result::Result<(Vec<Cell>, Vec<Portal>), String> {
    let list = |name: &str| field(value, "", name)?.as_array().ok_or(format!("'{name}' must be an array"));
    let cells = list("cells")?.iter().enumerate().map(|(i, cell)| {
        let place = format!("cells[{i}].");
        let corner = |name: &str| vector(field(cell, &place, name)?, &format!("{place}{name}"));
        let name = match cell.get("name") {
            None => i.to_string(),
            Some(Value::String(name)) => name.clone(),
            Some(other) => return Err(format!("'{place}name' must be a string, not {other}")),
        };
        Ok(Cell { name, min: corner("min")?, max: corner("max")? })
    });
    let cells = cells.collect::<std::result::Result<Vec<_>, _>>()?;
    if value.get("portals").is_none() {
        return Ok((cells, Vec::new()));
    }
    let portals = list("portals")?.iter().enumerate().map(|(i, portal)| {
        let place = format!("portals[{i}].");
        let corner = |name: &str| vector(field(portal, &place, name)?, &format!("{place}{name}"));
        let numbers = field(portal, &place, "cells")?.as_array().filter(|n| n.len() == 2);
        let number = |n: &Value| n.as_u64().and_then(|n| u32::try_from(n).ok());
        let both = numbers.and_then(|n| Some([number(&n[0])?, number(&n[1])?]));
        let cells = both.ok_or_else(|| format!("'{place}cells' must be the numbers of two cells"))?;
        Ok(Portal { cells, min: corner("min")?, max: corner("max")? })
    });
    Ok((cells, portals.collect::<std::result::Result<Vec<_>, String>>()?))
}
