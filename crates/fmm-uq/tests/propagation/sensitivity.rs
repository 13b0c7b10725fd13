//! Variance shares of functions whose shares are known.

use std::f64::consts::PI;

use fmm_uq::{Distribution, Input, Inputs, UncertaintyError, VarianceShare};

fn rectangular(count: usize, low: f64, high: f64) -> Inputs {
    let input = |k| Input::of(format!("x{k}"), Distribution::rectangular(low, high).unwrap(), "1").unwrap();
    Inputs::new((0..count).map(input)).unwrap()
}

fn check(shares: &[VarianceShare], first: &[f64], total: &[f64]) {
    for ((share, first), total) in shares.iter().zip(first).zip(total) {
        let found = format!("{share:?}, not {first} and {total}");
        assert!((share.first_order - first).abs() < 5.0 * share.first_order_error + 1e-12, "{found}");
        assert!((share.total - total).abs() < 5.0 * share.total_error + 1e-12, "{found}");
        assert!(share.first_order_error < 0.02 && share.total_error < 0.02, "{found}");
    }
}

/// sin x₀ + 7 sin² x₁ + 0.1 x₂⁴ sin x₀ (T. Ishigami, T. Homma, 1990).
#[test]
fn ishigami() {
    let inputs = rectangular(3, -PI, PI);
    let model = |x: &[f64]| x[0].sin() + 7.0 * x[1].sin().powi(2) + 0.1 * x[2].powi(4) * x[0].sin();
    let (a, b) = (7.0, 0.1);
    let v0 = 0.5 * (1.0 + b * PI.powi(4) / 5.0f64).powi(2);
    let (v1, v02) = (a * a / 8.0, b * b * PI.powi(8) * (1.0 / 18.0 - 1.0 / 50.0));
    let v = v0 + v1 + v02;
    let shares = VarianceShare::of_all(&inputs, 100_000, 1, 0.0, model).unwrap();
    check(&shares, &[v0 / v, v1 / v, 0.0], &[(v0 + v02) / v, v1 / v, v02 / v]);
}

/// Π (|4x − 2| + a)/(1 + a) (A. Saltelli, I. M. Sobol', 1995).
#[test]
fn product_function() {
    let a = [0.0, 1.0, 4.5, 9.0];
    let inputs = rectangular(4, 0.0, 1.0);
    let model = |x: &[f64]| x.iter().zip(a).map(|(x, a)| ((4.0 * x - 2.0).abs() + a) / (1.0 + a)).product::<f64>();
    let own = a.map(|a: f64| 1.0 / (3.0 * (1.0 + a).powi(2)));
    let all: f64 = own.iter().map(|v| 1.0 + v).product();
    let first = own.map(|v| v / (all - 1.0));
    let total = own.map(|v| v / (1.0 + v) * all / (all - 1.0));
    check(&VarianceShare::of_all(&inputs, 100_000, 2, 0.0, model).unwrap(), &first, &total);
}

#[test]
fn rows_that_fail_are_left_out_as_a_whole() {
    let inputs = rectangular(2, 0.0, 1.0);
    // x₀ and x₁ each cut at 0.9 leave x₀ + 2 x₁ with the shares 1/5 and 4/5.
    let model = |x: &[f64]| if x[0] < 0.9 && x[1] < 0.9 { Ok(x[0] + 2.0 * x[1]) } else { Err("beyond") };
    let shares = VarianceShare::of_all(&inputs, 50_000, 3, 0.5, model).unwrap();
    check(&shares, &[0.2, 0.8], &[0.2, 0.8]);
    let refused = VarianceShare::of_all(&inputs, 50_000, 3, 0.1, model);
    assert!(
        matches!(refused, Err(UncertaintyError::Model { ref what, .. }) if what.contains("of 50000 rows")),
        "{refused:?}"
    );
    assert!(VarianceShare::of_all(&inputs, 9000, 3, 0.0, |x: &[f64]| x[0]).is_err());
    assert!(VarianceShare::of_all(&inputs, 50_000, 3, f64::NAN, |x: &[f64]| x[0]).is_err());
    assert!(VarianceShare::of_all(&inputs, 50_000, 3, 0.0, |_: &[f64]| 1.0).is_err());
    let correlated = inputs.with_correlations(&[("x0", "x1", 0.1)]).unwrap();
    let refused = VarianceShare::of_all(&correlated, 50_000, 3, 0.0, |x: &[f64]| x[0]);
    assert!(matches!(refused, Err(UncertaintyError::NoAnswer { what }) if what.contains("independent inputs")));
}
