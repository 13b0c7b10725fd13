//! Profile intervals of NIST's sets, which others have computed too.

use fmm_fit::{Options, ProfileEnd, ProfileInterval, ResidualVariance, solve};
use serde_json::Value;

use crate::harness::{FormulaProblem, digits, numbers, parameters};
use crate::strd_models::Dataset;

/// Null in the file means an open end.
#[test]
fn intervals_agree_with_the_reference() {
    let file: Value = serde_json::from_str(include_str!("../data/profile_ci.json")).unwrap();
    let [sets, _] = crate::strd::files();
    let (mut worst, mut evaluations, mut count) = (15.0f64, 0, 0);
    for (name, intervals) in file["intervals"].as_object().unwrap() {
        let set = &sets["datasets"][name];
        let formula = Dataset::read(set);
        let start = numbers(&set["start2"]);
        let parameters = parameters(start.len(), &Value::Null, &Value::Null);
        let problem = FormulaProblem { count: formula.len(), formula, parameters, is_exact: true };
        let fit = solve(&problem, &start, &Options::default()).unwrap();
        for interval in intervals.as_array().unwrap() {
            let parameter = format!("b{}", interval["param"].as_u64().unwrap());
            // The second is that of one standard deviation of a normal distribution, erf(1/√2).
            for (label, level) in [("0.9500", 0.95), ("0.6827", 0.682_689_492_137_085_9)] {
                let variance = ResidualVariance::Estimated;
                let found = ProfileInterval::of(&problem, &fit, &parameter, level, variance, &Options::default());
                let found = found.unwrap_or_else(|error| panic!("{name} {parameter}: {error}"));
                for (end, reference) in
                    [found.lower(), found.upper()].into_iter().zip(interval[label].as_array().unwrap())
                {
                    match (end, reference.as_f64()) {
                        (ProfileEnd::At(value), Some(reference)) => {
                            let digits = digits(&[value], &[reference]);
                            println!("{name} {parameter} {label}: {value:.12e} ({reference:.12e}), {digits:.1} digits");
                            worst = worst.min(digits);
                        }
                        (ProfileEnd::Open, None) => {}
                        other => panic!("{name} {parameter} {label}: {other:?}"),
                    }
                }
                evaluations += found.residual_evaluations();
                count += 1;
            }
        }
    }
    println!("{count} intervals, {evaluations} residuals, {worst:.1} digits at worst");
    // The reference itself is good to about eight digits.
    assert!(worst > 6.5, "{worst} digits at worst");
}
