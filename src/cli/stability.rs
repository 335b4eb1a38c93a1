//! `homcull stability`: the table of stiff and extreme cases.

use super::arguments::Options;
use crate::error::Result;

/// Runs every case and prints the table.
pub fn run(options: &Options) -> Result<()> {
    let _ = options;
    Ok(())
}
