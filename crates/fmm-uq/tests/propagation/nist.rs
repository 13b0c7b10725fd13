//! NIST Statistical Reference Datasets, univariate summary statistics.

use fmm_uq::Observations;
use serde_json::Value;

fn data(set: &Value) -> Vec<f64> {
    if let Some(digits) = set["digits"].as_str() {
        return digits.chars().map(|digit| f64::from(digit.to_digit(10).unwrap())).collect();
    }
    if let Some(values) = set["data"].as_array() {
        return values.iter().map(|value| value.as_f64().unwrap()).collect();
    }
    let (first, low, high) = match set["name"].as_str().unwrap() {
        "NumAcc2" => (1.2, 1.1, 1.3),
        "NumAcc3" => (1_000_000.2, 1_000_000.1, 1_000_000.3),
        "NumAcc4" => (10_000_000.2, 10_000_000.1, 10_000_000.3),
        other => panic!("no data for {other}"),
    };
    std::iter::once(first).chain([low, high].into_iter().cycle().take(1000)).collect()
}

#[test]
fn certified_values() {
    let oracle: Value = serde_json::from_str(include_str!("../data/nist_strd_univariate.json")).unwrap();
    for set in oracle["datasets"].as_array().unwrap() {
        let (name, values) = (set["name"].as_str().unwrap(), data(set));
        assert_eq!(values.len() as u64, set["n"].as_u64().unwrap(), "{name}");
        let found = Observations::new(&values).unwrap();
        // The data of NumAcc3 and 4 lose digits when they become numbers of 53 bits: 9.46 and 8.25 are left.
        let digits: f64 = match name {
            "NumAcc3" => 9.4,
            "NumAcc4" => 8.2,
            _ => 13.0,
        };
        let certified = |key: &str| set["certified"][key].as_str().unwrap().parse::<f64>().unwrap();
        for (what, found, expected, digits) in [
            ("mean", found.mean(), certified("mean"), 14.0),
            ("sd", found.standard_deviation(), certified("sd"), digits),
            ("r1", found.lag_one_autocorrelation(), certified("lag1_autocorrelation"), digits.min(12.0)),
        ] {
            let error = -(found / expected - 1.0).abs().log10();
            assert!(error >= digits, "{name}: {what} {found}, not {expected}: {error:.2} digits");
        }
    }
}
