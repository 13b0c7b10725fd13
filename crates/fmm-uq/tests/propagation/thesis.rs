//! The uncertainty analysis of a friction coefficient whose figures are printed in a thesis.

use fmm_uq::{Gum, Input, Inputs, Observations, propagate};
use serde_json::Value;

fn oracle() -> Value {
    serde_json::from_str(include_str!("../data/thesis_chapter5_uncertainty.json")).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

#[test]
fn machine_parameters_over_nine_amplitudes() {
    let oracle = oracle();
    let (table, recomputed) = (&oracle["table1"], &oracle["table1_recomputed"]);
    let rows = ["m", "k", "c"].map(|key| Observations::new(&numbers(&table[key])).unwrap());
    let (means, deviations) = (numbers(&recomputed["mean"]), numbers(&recomputed["sd_n_minus_1"]));
    for ((row, mean), sd) in rows.iter().zip(means).zip(deviations) {
        assert!((row.mean() / mean - 1.0).abs() < 1e-11);
        assert!((row.standard_deviation() / sd - 1.0).abs() < 1e-10, "{}", row.standard_deviation());
    }
    let expected = numbers(&recomputed["correlation_mk_mc_kc"]);
    for ((i, j), r) in [(0, 1), (0, 2), (1, 2)].into_iter().zip(expected) {
        assert!((rows[i].correlation(&rows[j]).unwrap() - r).abs() < 1e-10);
    }
}

/// The contributions of mass, stiffness and damping, and what the correlation that was left out adds: 15 %.
#[test]
fn combined_uncertainty_of_the_friction_coefficient() {
    let oracle = oracle();
    let (lpu, sd) = (&oracle["reproduction"]["lpu"], numbers(&oracle["table2"]["sd"]));
    let c = ["m", "k", "c"].map(|key| lpu["c_i"][key].as_f64().unwrap());
    let input = |k: usize, name, unit| Input::new(name, 0.0, sd[k], unit).unwrap();
    let inputs = Inputs::new([input(0, "m", "kg"), input(1, "k", "N/m"), input(2, "c", "N s/m")]).unwrap();
    let r = numbers(&oracle["table1_recomputed"]["correlation_mk_mc_kc"]);
    let correlated = inputs.clone().with_correlations(&[("m", "k", r[0]), ("m", "c", r[1]), ("k", "c", r[2])]).unwrap();
    // The sensitivities are printed with four digits.
    for (inputs, key) in [(&inputs, "uc"), (&correlated, "uc_with_table1_correlation")] {
        let budget = propagate(inputs, |x| x[0] * c[0] + x[1] * c[1] + x[2] * c[2]).unwrap();
        let expected = lpu[key].as_f64().unwrap();
        assert!((budget.standard_uncertainty() / expected - 1.0).abs() < 1e-3, "{}", budget.standard_uncertainty());
    }
    let erratum = &oracle["erratum"];
    let parts = ["m", "k", "c"].map(|key| erratum["correct_contribution"][key].as_f64().unwrap());
    let unit = |name, u| Input::new(name, 0.0, u, "1").unwrap();
    let inputs = Inputs::new([unit("m", parts[0]), unit("k", parts[1]), unit("c", parts[2])]).unwrap();
    let sum = Gum::new(&inputs).first_order_only().propagate(|x| x[0] + x[1] + x[2]).unwrap().single().unwrap();
    let expected = erratum["uc_from_contributions"].as_f64().unwrap();
    assert!((sum.standard_uncertainty() / expected - 1.0).abs() < 1e-11);
}
