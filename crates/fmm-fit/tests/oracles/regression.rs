//! NIST's linear reference data by the regressions, and a thesis' lines.

use fmm_fit::{LinearRegression, Polynomial, Weighting};
use serde_json::Value;

use crate::harness::{digits, number, numbers};

struct Agreement {
    coefficients: f64,
    uncertainties: f64,
    sum_of_squares: f64,
    r_squared: f64,
}

fn agreement(regression: &LinearRegression, set: &Value) -> Agreement {
    let uncertainties: Vec<f64> =
        (0..regression.coefficients().len()).map(|j| regression.standard_uncertainty(j).unwrap()).collect();
    let r_squared = regression.r_squared().unwrap();
    assert_eq!(regression.degrees_of_freedom() as u64, set["dof"].as_u64().unwrap());
    Agreement {
        coefficients: digits(regression.coefficients(), &numbers(&set["params"])),
        uncertainties: digits(&uncertainties, &numbers(&set["sd"])),
        sum_of_squares: digits(&[regression.sum_of_squares()], &[number(&set["rss"])]),
        r_squared: if set["r_squared"].is_null() { 15.0 } else { digits(&[r_squared], &[number(&set["r_squared"])]) },
    }
}

fn sets() -> Vec<Value> {
    let files = [include_str!("../data/nist_strd_linear.json"), include_str!("../data/nist_strd_linear_more.json")];
    let read = |text: &str| -> Vec<Value> {
        let file: Value = serde_json::from_str(text).unwrap();
        file["datasets"].as_object().unwrap().values().cloned().collect()
    };
    files.into_iter().flat_map(read).collect()
}

/// Exact data leave no residual but rounding; its digits mean nothing.
fn is_exact(set: &Value) -> bool {
    number(&set["rss"]) == 0.0
}

#[test]
fn certified_values_to_the_last_digits() {
    let sets = sets();
    assert_eq!(sets.len(), 11);
    for set in &sets {
        let name = set["name"].as_str().unwrap();
        let y = numbers(&set["y"]);
        let rows: Vec<Vec<f64>> = set["x"].as_array().unwrap().iter().map(numbers).collect();
        let count = set["params"].as_array().unwrap().len();
        let column = |j: usize| rows.iter().map(|row| row[j]).collect::<Vec<f64>>();
        let found = match set["design"].as_str().unwrap() {
            "1,x1..x6" => {
                let columns: Vec<Vec<f64>> = std::iter::once(vec![1.0; y.len()]).chain((0..6).map(column)).collect();
                let named: Vec<(&str, &[f64])> = columns.iter().map(|column| ("b", column.as_slice())).collect();
                agreement(&LinearRegression::fit(&named, &y, Weighting::Equal).unwrap(), set)
            }
            "x (no intercept)" => {
                agreement(&LinearRegression::fit(&[("slope", &column(0))], &y, Weighting::Equal).unwrap(), set)
            }
            _ => agreement(Polynomial::fit(&column(0), &y, count - 1, Weighting::Equal).unwrap().regression(), set),
        };
        println!(
            "{name:<9} coefficients {:4.1}, uncertainties {:4.1}, S {:4.1}, R² {:4.1} digits",
            found.coefficients, found.uncertainties, found.sum_of_squares, found.r_squared
        );
        // The decimals of the data, rounded to floating-point numbers, leave 13 digits of Wampler2 and Pontius, 14 of
        // Filip.
        assert!(found.coefficients >= 13.0, "{name}: coefficients to {:.1} digits", found.coefficients);
        assert!(found.r_squared >= 13.0, "{name}: R² to {:.1} digits", found.r_squared);
        if !is_exact(set) {
            // Those of Filip come from a factor with a condition of 1e5.
            assert!(found.uncertainties >= 10.0, "{name}: uncertainties to {:.1} digits", found.uncertainties);
            assert!(found.sum_of_squares >= 12.0, "{name}: S to {:.1} digits", found.sum_of_squares);
        }
    }
}

/// Powers of x as columns, without the frame of a polynomial: what the rounding of the powers leaves.
#[test]
fn powers_as_columns_keep_what_their_rounding_leaves() {
    for set in sets() {
        let (name, design) = (set["name"].as_str().unwrap(), set["design"].as_str().unwrap());
        if !design.starts_with("1,x,") {
            continue;
        }
        let count = set["params"].as_array().unwrap().len();
        let x: Vec<f64> = set["x"].as_array().unwrap().iter().map(|row| number(&row[0])).collect();
        let powers: Vec<Vec<f64>> =
            (0..count).map(|k| x.iter().map(|x| x.powi(i32::try_from(k).unwrap())).collect()).collect();
        let named: Vec<(&str, &[f64])> = powers.iter().map(|column| ("b", column.as_slice())).collect();
        let regression = LinearRegression::fit(&named, &numbers(&set["y"]), Weighting::Equal).unwrap();
        let found = agreement(&regression, &set);
        println!("{name:<9} coefficients {:4.1}, uncertainties {:4.1} digits", found.coefficients, found.uncertainties);
        // Filip's powers are alike to ten digits.
        let wanted = if name == "filip" { 7.0 } else { 13.0 };
        assert!(found.coefficients >= wanted, "{name}: {:.1} digits", found.coefficients);
    }
}
