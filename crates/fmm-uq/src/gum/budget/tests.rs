use super::*;
use crate::{Taylor, propagate};

fn inputs(uncertainties: &[(&str, f64, f64)]) -> Inputs {
    let input =
        |&(name, u, nu): &(&str, f64, f64)| Input::new(name, 0.0, u, "m").unwrap().with_degrees_of_freedom(nu).unwrap();
    Inputs::new(uncertainties.iter().map(input)).unwrap()
}

fn sum(x: &[Taylor]) -> Taylor {
    x.iter().fold(Taylor::from(0.0), |sum, &x| sum + x)
}

#[test]
fn contributions_add_in_squares() {
    let budget = propagate(&inputs(&[("a", 3.0, 5.0), ("b", 4.0, f64::INFINITY)]), |x| x[0] - x[1]).unwrap();
    assert_eq!(budget.standard_uncertainty(), 5.0);
    let rows: Vec<_> = budget.contributions().map(|row| (row.sensitivity, row.uncertainty)).collect();
    assert_eq!(rows, [(1.0, 3.0), (-1.0, 4.0)]);
    // (5/3)⁴ · 5 by hand.
    assert!((budget.effective_degrees_of_freedom().unwrap() - 3125.0 / 81.0).abs() < 1e-12);
}

#[test]
fn shares_add_up_to_one_and_may_be_negative() {
    let correlated =
        inputs(&[("a", 3.0, f64::INFINITY), ("b", 1.0, f64::INFINITY)]).with_correlations(&[("a", "b", -0.6)]).unwrap();
    let budget = propagate(&correlated, sum).unwrap();
    // u² = 9 + 1 − 2·0.6·3 = 6.4, of which a has 9 − 1.8 and b 1 − 1.8.
    assert!((budget.standard_uncertainty().powi(2) - 6.4).abs() < 1e-14);
    let shares: Vec<f64> = budget.contributions().map(|row| row.share).collect();
    assert!((shares[0] - 1.125).abs() < 1e-15 && (shares[1] + 0.125).abs() < 1e-15, "{shares:?}");
}

#[test]
fn a_flat_model_is_flagged() {
    // JCGM 101:2008, 9.4 with x₁ = x₂ = 0: the true uncertainty is 5e-5, and the first-order one is zero.
    let flat = inputs(&[("x1", 0.005, f64::INFINITY), ("x2", 0.005, f64::INFINITY)]);
    let budget = propagate(&flat, |x| x[0] * x[0] + x[1] * x[1]).unwrap();
    assert!((budget.linearisation() == Linearisation::ZeroUncertainty));
    assert_eq!((budget.standard_uncertainty(), budget.effective_degrees_of_freedom()), (0.0, None));
    assert!(
        matches!(budget.expanded(0.95), Err(UncertaintyError::NoAnswer { what }) if what.contains("linear approximation"))
    );
    assert!(budget.to_string().contains("linear approximation"), "{budget}");
}

#[test]
fn constants_have_no_uncertainty_and_no_flag() {
    let budget = propagate(&inputs(&[("a", 0.0, 5.0)]), |x| x[0] + 2.0).unwrap();
    assert!(!(budget.linearisation() == Linearisation::ZeroUncertainty));
    assert_eq!(budget.effective_degrees_of_freedom(), Some(f64::INFINITY));
    assert_eq!(budget.expanded(0.95).unwrap().uncertainty, 0.0);
}

#[test]
fn cancellation_to_rounding_is_zero() {
    let full =
        inputs(&[("a", 0.1, f64::INFINITY), ("b", 0.3, f64::INFINITY)]).with_correlations(&[("a", "b", 1.0)]).unwrap();
    let budget = propagate(&full, |x| x[0] * 3.0 - x[1]).unwrap();
    assert_eq!((budget.standard_uncertainty(), budget.linearisation()), (0.0, Linearisation::Adequate));
    // What else they do keeps the flag: it is not seen along the one direction in which these two vary.
    let more = inputs(&[("a", 0.1, f64::INFINITY), ("b", 0.3, f64::INFINITY), ("c", 0.2, f64::INFINITY)]);
    let more = more.with_correlations(&[("a", "b", 1.0)]).unwrap();
    let budget = propagate(&more, |x| x[0] * 3.0 - x[1] + x[0] * x[1] * x[2] * x[2]).unwrap();
    assert_eq!((budget.standard_uncertainty(), budget.linearisation()), (0.0, Linearisation::ZeroUncertainty));
}

#[test]
fn correlated_inputs_of_finite_degrees_of_freedom_have_no_effective_ones() {
    let three = [("a", 1.0, 4.0), ("b", 1.0, f64::INFINITY), ("c", 1.0, f64::INFINITY)];
    let harmful = inputs(&three).with_correlations(&[("a", "b", 0.1)]).unwrap();
    let budget = propagate(&harmful, sum).unwrap();
    assert_eq!(budget.effective_degrees_of_freedom(), None);
    assert!(
        matches!(budget.expanded(0.95), Err(UncertaintyError::NoAnswer { what }) if what.contains("Welch-Satterthwaite"))
    );
    // b has no part in the result, so that its correlation has none either.
    assert_eq!(propagate(&harmful, |x| x[0]).unwrap().effective_degrees_of_freedom(), Some(4.0));
    let harmless = inputs(&three).with_correlations(&[("b", "c", 0.5)]).unwrap();
    // u² = 1 + 1 + 1 + 2·0.5 = 4, so ν_eff = 4²/(1/4) = 64.
    let effective = propagate(&harmless, sum).unwrap().effective_degrees_of_freedom().unwrap();
    assert!((effective - 64.0).abs() < 1e-12, "{effective}");
}

#[test]
fn whole_degrees_of_freedom_survive_truncation() {
    for nu in 1..=200 {
        let alone = inputs(&[("a", 0.1, f64::from(nu)), ("b", 0.0, 1.0)]);
        let expanded = propagate(&alone, |x| x[0] * 0.3 + x[1]).unwrap().expanded(0.95).unwrap();
        assert_eq!(expanded.degrees_of_freedom, f64::from(nu));
    }
}

#[test]
fn squares_of_extreme_contributions_stay_in_range() {
    for size in [1e-200, 1e200] {
        let extreme = inputs(&[("a", 3.0 * size, 5.0), ("b", 4.0 * size, 5.0)]);
        let u = propagate(&extreme, sum).unwrap().standard_uncertainty();
        assert!((u / size - 5.0).abs() < 1e-14, "u = {u} m");
    }
}

#[test]
fn an_uncertainty_out_of_range_is_refused() {
    let huge = inputs(&[("a", 1.5e308, 5.0), ("b", 1.5e308, 5.0)]);
    let message = propagate(&huge, sum).unwrap_err().to_string();
    assert!(message.starts_with("the standard uncertainty of the result"), "{message}");
}

#[test]
fn covariance_needs_the_same_inputs() {
    let one = inputs(&[("a", 3.0, f64::INFINITY), ("b", 4.0, f64::INFINITY)]);
    let (plus, minus) = (propagate(&one, sum).unwrap(), propagate(&one, |x| x[0] - x[1]).unwrap());
    assert_eq!(plus.covariance_with(&minus).unwrap(), 9.0 - 16.0);
    let other = propagate(&inputs(&[("a", 3.0, 5.0), ("b", 4.0, 5.0)]), sum).unwrap();
    assert!(matches!(plus.covariance_with(&other), Err(UncertaintyError::Inputs { .. })));
}
