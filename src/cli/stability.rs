//! `homcull stability`: the table of stiff and extreme cases.

use serde_json::{Value, json};

use super::arguments::Options;
use super::progress;
use crate::error::{Error, Result};
use crate::measure::json::write_json;
use crate::measure::stability::{StabilityRow, cases, run_case, table};

/// Runs every case and prints the table, or writes it as JSON.
///
/// # Errors
/// [`Error::Parameter`] naming the first case that fails, after the table has been printed or written.
pub fn run(options: &Options) -> Result<()> {
    let cases = cases();
    let bar = progress::bar(cases.len(), "stability", options.quiet);
    let mut rows = Vec::new();
    for case in &cases {
        rows.push(run_case(case)?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    match &options.json {
        Some(target) => write_json(target, &json!({ "cases": rows.iter().map(report).collect::<Vec<Value>>() }))?,
        None if options.quiet => {}
        None => say!("{}", table(&rows).to_string().trim_end()),
    }
    let failed: Vec<&StabilityRow> = rows.iter().filter(|r| !r.ok()).collect();
    match failed.first() {
        None => Ok(()),
        Some(first) => {
            let why = first.failures.first().map_or("", String::as_str);
            let reason = format!("{} of {} cases fail: {why}", failed.len(), rows.len());
            Err(Error::parameter("case", first.name, reason))
        }
    }
}

fn report(row: &StabilityRow) -> Value {
    json!({
        "name": row.name,
        "objects": row.objects,
        "views": row.views,
        "hidden": row.hidden,
        "visible": row.visible,
        "false_culls": row.false_culls,
        "levels": row.levels,
        "levels_equal": row.levels_equal,
        "depth_samples": row.samples,
        "largest_depth_error": row.depth_error,
        "depth_error_bound": row.depth_bound,
        "largest_share_of_bound": row.depth_share,
        "ms": row.ms,
        "ok": row.ok(),
        "failures": row.failures,
    })
}
