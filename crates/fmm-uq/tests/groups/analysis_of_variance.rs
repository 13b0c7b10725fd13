//! Analysis of variance against certified values and another program.

use fmm_uq::AnalysisOfVariance;
use serde_json::Value;

use crate::{document, groups, list, near, number};

/// Digits that agree, 15 at most.
fn digits(found: f64, expected: f64) -> f64 {
    if found == expected { 15.0 } else { (-((found / expected - 1.0).abs()).log10()).min(15.0) }
}

/// Observation j of a treatment is its first, a tenth less for odd j and a tenth more for even j.
fn simon_and_lesage(set: &Value) -> Vec<Vec<f64>> {
    let (constant, replicates) = (number(&set["constant"]), number(&set["replicates"]) as i32);
    let observation = |first: f64, j: i32| {
        let more = match j {
            0 => 0.0,
            odd if odd % 2 == 1 => -1.0,
            _ => 1.0,
        };
        // As reading the printed number rounds it.
        format!("{constant}.{}", first + more).parse::<f64>().unwrap()
    };
    let treatment = |first: &f64| (0..replicates).map(|j| observation(*first, j)).collect();
    list(&set["first_tenths"]).iter().map(treatment).collect()
}

/// All eleven sets of NIST. A constant of 10⁶ or 10¹² takes the digits that f64 cannot hold beside it: of 10¹² + 0.4
/// four remain, and exact fractions of the rounded observations have no more.
#[test]
fn certified_analyses_of_variance() {
    let document = document(include_str!("../data/nist_strd_anova.json"));
    let sets = document["sets"].as_array().unwrap();
    assert_eq!(sets.len(), 11);
    for set in sets {
        let observations = if set["groups"].is_array() { groups(&set["groups"]) } else { simon_and_lesage(set) };
        let found = AnalysisOfVariance::of(&observations).unwrap();
        let certified = &set["certified"];
        let (between, within) = found.mean_squares();
        let pairs = [
            (found.between(), "between_sum"),
            (found.within(), "within_sum"),
            (between, "between_mean"),
            (within, "within_mean"),
            (found.f(), "f"),
            (found.r_squared(), "r_squared"),
            (found.residual_standard_deviation(), "residual_sd"),
        ];
        let least = pairs.map(|(found, name)| digits(found, number(&certified[name]))).into_iter().fold(15.0, f64::min);
        let name = set["name"].as_str().unwrap();
        println!("{name}: {least:.1} digits");
        // What is left of the certified digits when the observations become f64; of 15 the last is at the mercy of a
        // few roundings.
        let attainable = number(&set["attainable_digits"]).min(14.0);
        assert!(least >= attainable - 0.1, "{name}: {least} digits, of {attainable}");
        let p_value = number(&set["p_value"]);
        // As the certified F is known, times the exponent of the tail.
        let tolerance = 10_f64.powf(-attainable) * found.observations() as f64 + 1e-12;
        assert!(near(found.p_value(), p_value, tolerance), "{name}: {} and {p_value}", found.p_value());
        assert_eq!(found.degrees_of_freedom(), (number(&certified["df"][0]), number(&certified["df"][1])));
    }
}

/// Groups of one to three observations, against statsmodels and SciPy.
#[test]
fn groups_of_unequal_numbers() {
    let document = document(include_str!("../data/precision.json"));
    let case = &document["unbalanced"];
    let found = AnalysisOfVariance::of(&groups(&case["groups"])).unwrap();
    for (found, name) in [
        (found.between(), "between_sum"),
        (found.within(), "within_sum"),
        (found.f(), "f"),
        (found.p_value(), "p_value"),
        (found.residual_standard_deviation(), "s_r"),
    ] {
        assert!(near(found, number(&case[name]), 1e-11), "{name}: {found}, not {}", case[name]);
    }
}
