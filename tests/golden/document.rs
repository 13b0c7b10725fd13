//! Documents: their digest, their files and their comparison.

use std::path::PathBuf;

use serde_json::{Map, Value, json};

/// Relative difference of two numbers that are taken as equal (1).
///
/// Other processors sum in another order and have other vectors, so that a fit ends at another place within its
/// tolerances.
const RELATIVE: f64 = 1e-6;

/// Numbers below this are rounding errors: no quantity here is that small in its unit.
const ZERO: f64 = 1e-13;

/// Longest list that is kept as it is.
const LONG: usize = 32;

/// Words of a sentence. Its numbers are compared, and its words only where all digits are.
const SENTENCE: usize = 4;

/// Keys whose values belong to a machine, a moment or a version; the friction curve, whose last linearisation is within
/// a twentieth of its uncertainty, has tests of its own.
const LEFT_OUT: [&str; 8] = ["friction_curve", "seconds", "path", "version", "command", "generator", "sha256", "note"];

/// Compares `documents` with the file `name`, or writes it.
pub(crate) fn golden(name: &str, documents: impl IntoIterator<Item = (String, Value)>) {
    let found: Map<String, Value> = documents.into_iter().map(|(key, value)| (key, digest(value))).collect();
    let found = Value::Object(found);
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("../../tests/data/golden/{name}.json"));
    let how = std::env::var("FMM_GOLDEN").unwrap_or_default();
    if how == "write" {
        return std::fs::write(&path, format!("{}\n", serde_json::to_string_pretty(&found).unwrap())).unwrap();
    }
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut comparison = Comparison { is_exact: how == "exact", differences: Vec::new() };
    comparison.compare(name, &serde_json::from_str(&text).unwrap(), &found);
    let differences = comparison.differences;
    assert!(differences.is_empty(), "{} differences from {name}.json:\n{}", differences.len(), differences.join("\n"));
}

/// `value` without what is left out, with long series as their count, first, last, sum and sum of squares.
fn digest(value: Value) -> Value {
    match value {
        Value::Object(fields) => {
            let fields = fields.into_iter().filter(|(key, _)| !LEFT_OUT.contains(&key.as_str()));
            fields.map(|(key, value)| (key, digest(value))).collect()
        }
        Value::Array(values) if values.len() > LONG => series(values),
        Value::Array(values) => values.into_iter().map(digest).collect(),
        Value::String(_) | Value::Number(_) | Value::Bool(_) | Value::Null => value,
    }
}

fn series(values: Vec<Value>) -> Value {
    let count = values.len();
    if values.iter().all(Value::is_object) {
        let mut columns: Map<String, Value> = Map::new();
        for value in values {
            let Value::Object(fields) = value else { continue };
            for (key, value) in fields {
                columns.entry(key).or_insert_with(|| json!([])).as_array_mut().unwrap().push(value);
            }
        }
        return json!({ "count": count, "columns": digest(columns.into()) });
    }
    let first = values.iter().find_map(Value::as_array).map(Vec::len);
    if first.is_some() && values.iter().all(|value| value.as_array().map(Vec::len) == first) {
        let column = |i: usize| digest(values.iter().map(|value| value[i].clone()).collect());
        return json!({ "count": count, "columns": (0..first.unwrap_or(0)).map(column).collect::<Vec<_>>() });
    }
    let numbers: Vec<f64> = values.iter().filter_map(Value::as_f64).collect();
    let others: Vec<Value> = values.iter().filter(|value| !value.is_number()).cloned().collect();
    let (first, last) = (digest(values[0].clone()), digest(values[count - 1].clone()));
    let mut document = json!({ "count": count, "first": first, "last": last });
    if !numbers.is_empty() {
        document["numbers"] = numbers.len().into();
        document["sum"] = numbers.iter().sum::<f64>().into();
        document["sum_of_squares"] = numbers.iter().map(|number| number * number).sum::<f64>().into();
    }
    if others.iter().any(|other| !other.is_null()) {
        let mut distinct: Vec<String> = others.iter().map(ToString::to_string).collect();
        distinct.sort();
        distinct.dedup();
        document["distinct"] = distinct.into_iter().take(LONG).collect();
    }
    document
}

struct Comparison {
    is_exact: bool,
    differences: Vec<String>,
}

impl Comparison {
    fn compare(&mut self, path: &str, expected: &Value, found: &Value) {
        match (expected, found) {
            (Value::Object(expected), Value::Object(found)) => {
                for (key, value) in expected {
                    match found.get(key) {
                        // A sum loses digits where its terms cancel: those of the root of the sum of squares remain.
                        Some(sum) if key == "sum" && !self.is_exact => {
                            let size = expected.get("sum_of_squares").and_then(Value::as_f64).unwrap_or(0.0);
                            let count = expected.get("numbers").and_then(Value::as_f64).unwrap_or(1.0);
                            let limit = RELATIVE * (count * size).sqrt();
                            let numbers = value.as_f64().zip(sum.as_f64());
                            self.differ(path, key, value, sum, numbers.is_some_and(|(a, b)| (a - b).abs() <= limit));
                        }
                        Some(found) => self.compare(&format!("{path}.{key}"), value, found),
                        None => self.differ(path, key, value, "nothing", false),
                    }
                }
                for (key, value) in found.iter().filter(|(key, _)| !expected.contains_key(*key)) {
                    self.differ(path, key, "nothing", value, false);
                }
            }
            (Value::Array(expected), Value::Array(found)) => {
                self.differ(path, "length", expected.len(), found.len(), expected.len() == found.len());
                for (i, (expected, found)) in expected.iter().zip(found).enumerate() {
                    self.compare(&format!("{path}[{i}]"), expected, found);
                }
            }
            (Value::Number(a), Value::Number(b)) if a.is_f64() && b.is_f64() && !self.is_exact => {
                let is_equal = a.as_f64().zip(b.as_f64()).is_some_and(|(a, b)| are_close(a, b));
                self.differ(path, "", expected, found, is_equal);
            }
            (Value::String(a), Value::String(b)) if a.split_whitespace().count() >= SENTENCE && !self.is_exact => {
                let (a, b) = (numbers(a), numbers(b));
                let is_equal = a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| are_close(*a, *b));
                self.differ(path, "", expected, found, is_equal);
            }
            _ => self.differ(path, "", expected, found, expected == found),
        }
    }

    fn differ(
        &mut self,
        path: &str,
        key: &str,
        expected: impl std::fmt::Display,
        found: impl std::fmt::Display,
        is_equal: bool,
    ) {
        if !is_equal {
            let key = if key.is_empty() { String::new() } else { format!(".{key}") };
            self.differences.push(format!("{path}{key}: expected {expected}, found {found}"));
        }
    }
}

fn are_close(a: f64, b: f64) -> bool {
    (a - b).abs() <= RELATIVE * a.abs().max(b.abs()) || a.abs().max(b.abs()) < ZERO
}

/// The numbers of a sentence in ascending order, as other words may change theirs.
fn numbers(sentence: &str) -> Vec<f64> {
    let is_other = |c: char| !(c.is_ascii_digit() || matches!(c, '.' | '-' | 'e'));
    let words = sentence.split(is_other).map(|word| word.trim_matches(|c: char| !c.is_ascii_digit()));
    let mut numbers: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
    numbers.sort_by(f64::total_cmp);
    numbers
}

#[test]
fn series_are_digested_and_differences_are_named() {
    let series: Vec<Value> = (0..40).map(|i| json!({ "x": f64::from(i), "mode": "slip" })).collect();
    let value = digest(json!({ "samples": series, "seconds": 3.0, "few": [1, 2] }));
    let x = json!({ "count": 40, "numbers": 40, "first": 0.0, "last": 39.0, "sum": 780.0, "sum_of_squares": 20540.0 });
    assert_eq!(value["samples"]["columns"]["x"], x);
    assert!(value.get("seconds").is_none() && value["few"] == json!([1, 2]));
    let differences = |expected: Value, found: Value, is_exact| {
        let mut comparison = Comparison { is_exact, differences: Vec::new() };
        comparison.compare("a", &expected, &found);
        comparison.differences
    };
    let near = (json!({ "x": 1.0, "say": "it was 2.5 of 3 m" }), json!({ "x": 1.000_000_1, "say": "3 m, not 2.5 m" }));
    assert!(differences(near.0.clone(), near.1.clone(), false).is_empty());
    assert_eq!(differences(near.0, near.1, true).len(), 2);
    let far = differences(json!({ "x": [1.0, 2] }), json!({ "x": [1.1, 3], "y": null }), false);
    assert_eq!(
        far,
        ["a.x[0]: expected 1.0, found 1.1", "a.x[1]: expected 2, found 3", "a.y: expected nothing, found null"]
    );
}
