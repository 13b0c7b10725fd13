//! Groups against certified values, published examples, other programs, and simulated laboratories.

mod analysis_of_variance;
mod consensus;
mod precision;
mod wrong_input;

use serde_json::Value;

fn document(text: &str) -> Value {
    serde_json::from_str(text).expect("data of the tests are JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn list(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

fn near(found: f64, expected: f64, relative: f64) -> bool {
    (found - expected).abs() <= relative * expected.abs()
}

fn groups(value: &Value) -> Vec<Vec<f64>> {
    value.as_array().unwrap().iter().map(list).collect()
}
