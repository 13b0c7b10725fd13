//! Ratios of criterion's medians with their goals: of one run, they are worth more than times on a machine that others
//! use too.

use std::ops::{Bound, RangeBounds};

/// Criterion's median of the benchmark `group/name` of this run (ns), if it was measured.
pub(crate) fn median(benchmark: &str) -> Option<f64> {
    // A bench lies in target/release/deps.
    let bench = std::env::current_exe().ok()?;
    let path = bench.ancestors().nth(3)?.join("criterion").join(benchmark).join("new").join("estimates.json");
    let estimates: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(path).ok()?).ok()?;
    estimates["median"]["point_estimate"].as_f64()
}

/// Prints a number as a row of a Markdown table: what it is, its value, its goal (`..` for none), and whether that is
/// missed.
pub(crate) fn print_row(what: &str, value: f64, goal: impl RangeBounds<f64>) {
    let wanted = match (goal.start_bound(), goal.end_bound()) {
        (Bound::Included(least), _) => format!("at least {least}"),
        (_, Bound::Included(most)) => format!("at most {most}"),
        _ => "-".to_owned(),
    };
    let missed = if goal.contains(&value) { "" } else { ", missed" };
    // Three significant digits, and whole numbers above a hundred.
    let digits = (2.0 - value.abs().max(1e-3).log10().floor()).clamp(0.0, 5.0) as usize;
    println!("| {what} | {value:.digits$} | {wanted}{missed} |");
}

/// The row of how many times as long one benchmark takes as another, where both were measured.
pub(crate) fn print_ratio(slow: &str, fast: &str, goal: impl RangeBounds<f64>) {
    if let (Some(slow_time), Some(fast_time)) = (median(slow), median(fast)) {
        print_row(&format!("`{slow}` / `{fast}`"), slow_time / fast_time, goal);
    }
}
