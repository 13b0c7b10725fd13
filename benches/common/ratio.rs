//! Ratios of criterion's medians: of one run, they are worth more than times on a machine that others use too.

/// Criterion's median of the benchmark `group/name` of this run (ns), if it was measured.
pub(crate) fn median(benchmark: &str) -> Option<f64> {
    // A bench lies in target/release/deps.
    let bench = std::env::current_exe().ok()?;
    let path = bench.ancestors().nth(3)?.join("criterion").join(benchmark).join("new").join("estimates.json");
    let estimates: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(path).ok()?).ok()?;
    estimates["median"]["point_estimate"].as_f64()
}

/// Prints how many times as long one benchmark takes as another, beside what is wanted.
pub(crate) fn print_ratio(slow: &str, fast: &str, wanted: &str) {
    if let (Some(slow_time), Some(fast_time)) = (median(slow), median(fast)) {
        let wanted = if wanted.is_empty() { String::new() } else { format!(" (wanted: {wanted})") };
        println!("{slow} / {fast} = {:.2}{wanted}", slow_time / fast_time);
    }
}
