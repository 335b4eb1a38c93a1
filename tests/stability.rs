//! Stiff and extreme cases hold what ordinary ones do.
#![cfg(feature = "bvh")]

use std::collections::HashSet;

use homcull::measure::stability::{StabilityRow, cases, run_case, table};
use homcull_simd::Level;

#[test]
fn every_stiff_and_extreme_case_holds() {
    for level in Level::ALL.into_iter().filter(|l| !l.is_available()) {
        println!("SIMD level {} absent: not tested", level.name());
    }
    let rows: Vec<StabilityRow> = cases().iter().map(|case| run_case(case).unwrap()).collect();
    let text = table(&rows).to_string();
    println!("{text}");
    assert!(rows.iter().all(StabilityRow::ok), "\n{text}");
    assert!(rows.iter().all(|r| r.false_culls == 0 && r.levels_equal && r.levels > 0 && r.depth_share <= 1.0));
}

#[test]
fn the_cases_look_at_something() {
    let names: HashSet<&str> = cases().iter().map(|c| c.name).collect();
    assert_eq!(names.len(), cases().len(), "a name stands twice");
    assert!(names.len() >= 25 && cases().iter().all(|c| !c.about.is_empty() && !c.name.contains(' ')));
    // A case in which nothing is hidden, or no depth can be compared, would hold for the wrong reason.
    for name in ["near-far-1e9", "world-at-1e9", "two-towns-2e7-apart", "33x31", "orthographic", "mirrored", "ties"] {
        let case = cases().into_iter().find(|c| c.name == name).unwrap();
        let row = run_case(&case).unwrap();
        assert!(row.hidden > 10 && row.visible > 10, "{name}: {} hidden, {} visible", row.hidden, row.visible);
        assert!(row.samples > 500, "{name}: {} depths compared", row.samples);
        assert!(row.depth_bound > 0.0 && row.depth_share > 0.0, "{name}");
    }
}

#[test]
fn a_case_is_the_same_every_time() {
    let case = cases().into_iter().find(|c| c.name == "needles").unwrap();
    let [a, b] = [run_case(&case).unwrap(), run_case(&case).unwrap()];
    let figures = |r: &StabilityRow| (r.hidden, r.visible, r.samples, r.depth_error.to_bits(), r.depth_share.to_bits());
    assert_eq!(figures(&a), figures(&b));
}
