//! Effect of fixed values on estimates, against fits repeated with the fixed values moved.

use fmm_fit::{Derivatives, EvaluationError, FitError, Options, Residuals, Sensitivity, solve};
use fmm_model::{Bounds, Parameter, Scalar};
use serde_json::Value;

use crate::harness::{Formula, FormulaProblem, digits, numbers};
use crate::strd_models::Dataset;

/// A set with some of its parameters held at given values.
fn problem(set: &Value, fixed: &[(usize, f64)], is_exact: bool) -> (FormulaProblem<Dataset>, Vec<f64>) {
    let formula = Dataset::read(set);
    let mut start = numbers(&set["refined"]);
    let mut parameters = crate::harness::parameters(start.len(), &Value::Null, &Value::Null);
    for &(j, value) in fixed {
        start[j] = value;
        parameters[j] = parameters[j].clone().bounded(Bounds::new(value, value).unwrap());
    }
    (FormulaProblem { count: formula.len(), formula, parameters, is_exact }, start)
}

/// Derivatives of all values by the fixed value number `moved`, by fits at four neighbouring values:
/// (8 (f₁ − f₋₁) − (f₂ − f₋₂)) / 12 h, whose error is of the order of h⁴.
fn refitted(set: &Value, fixed: &[(usize, f64)], moved: usize) -> Vec<f64> {
    let h = 1e-4 * fixed[moved].1.abs();
    let values = |by: f64| {
        let mut fixed = fixed.to_vec();
        fixed[moved].1 += by;
        let (problem, start) = problem(set, &fixed, true);
        solve(&problem, &start, &Options::default()).unwrap().values().to_vec()
    };
    let [a, b, c, d] = [-2.0 * h, -h, h, 2.0 * h].map(values);
    (0..a.len()).map(|j| (8.0 * (c[j] - b[j]) - (d[j] - a[j])) / (12.0 * h)).collect()
}

/// The inputs are held up to a tenth away from where they would fit, so that the residuals are large.
#[test]
fn derivatives_are_those_of_repeated_fits() {
    let [sets, _] = crate::strd::files();
    let cases: [(&str, &[(usize, f64)]); 5] = [
        ("ENSO", &[(3, 44.0), (6, 26.5)]),
        ("Chwirut2", &[(2, 0.0125)]),
        ("Kirby2", &[(1, -0.13)]),
        ("Gauss1", &[(3, 68.0), (6, 180.0)]),
        ("Misra1a", &[(1, 5e-4)]),
    ];
    let mut tried = 0;
    for (name, fixed) in cases {
        let set = &sets["datasets"][name];
        if set.is_null() {
            continue;
        }
        tried += 1;
        for is_exact in [true, false] {
            let (problem, start) = problem(set, fixed, is_exact);
            let fit = solve(&problem, &start, &Options::default()).unwrap();
            let exact = Sensitivity::of(&problem, &fit).unwrap();
            let first_order = Sensitivity::first_order(&problem, &fit).unwrap();
            for (moved, (input, _)) in fixed.iter().enumerate() {
                let estimated: Vec<usize> = (0..start.len()).filter(|j| !exact.inputs().contains(j)).collect();
                let all = refitted(set, fixed, moved);
                let reference: Vec<f64> = estimated.iter().map(|&j| all[j]).collect();
                let of = |sensitivity: &Sensitivity| -> Vec<f64> {
                    estimated.iter().map(|&j| sensitivity.coefficient(j, *input).unwrap()).collect()
                };
                let agreement = digits(&of(&exact), &reference);
                let rough = digits(&of(&first_order), &reference);
                println!(
                    "{name} by b{}: {agreement:.1} digits exact, {rough:.1} to first order ({is_exact})",
                    input + 1
                );
                // Without derivatives these are differences of differences, of waves in one case.
                let wanted = if is_exact { 7.0 } else { 3.5 };
                assert!(agreement >= wanted, "{name} by b{}: {agreement:.1} digits", input + 1);
                assert!(rough < agreement, "{name}: the terms in the residuals should matter");
                assert_eq!(exact.coefficient(*input, *input), None);
            }
        }
    }
    assert!(tried >= 3, "only {tried} of the sets are there");
}

/// Half a swing with Coulomb friction in closed form; parameters m, k, c, N, μ, x₀.
struct Swing;

impl Formula for Swing {
    fn residual<D: Scalar>(&self, i: usize, p: &[D]) -> D {
        let [mass, stiffness, damping, load, friction, start] = [p[0], p[1], p[2], p[3], p[4], p[5]];
        let t = 2e-3 * i as f64;
        let rate = damping / mass * 0.5;
        let angular = (stiffness / mass - rate * rate).sqrt();
        // From x₀ at rest towards the middle, about the position where spring and friction balance.
        let swing = start - friction * load / stiffness;
        let (sin, _) = (angular * t).sin_cos();
        let velocity = -swing * (stiffness / mass) / angular * (-rate * t).exp() * sin;
        let data = -0.01 * 13.81 * (13.81 * t).sin() + 1e-3 * (((i * 37) % 101) as f64 / 50.0 - 1.0);
        (velocity - data) * 1000.0
    }
}

/// A problem that leaves the columns of its fixed parameters as no numbers.
struct Unfilled<'a, P>(&'a P);

impl<P: Residuals> Residuals for Unfilled<'_, P> {
    fn parameters(&self) -> &[Parameter] {
        self.0.parameters()
    }
    fn len(&self) -> usize {
        self.0.len()
    }
    fn evaluate(
        &self,
        p: &[f64],
        residuals: &mut [f64],
        mut jacobian: Option<&mut [f64]>,
    ) -> Result<(), EvaluationError> {
        self.0.evaluate(p, residuals, jacobian.as_deref_mut())?;
        if let Some(jacobian) = jacobian {
            for (parameter, column) in self.parameters().iter().zip(jacobian.chunks_exact_mut(self.len())) {
                if parameter.bounds().is_fixed() {
                    column.fill(f64::NAN);
                }
            }
        }
        Ok(())
    }
    fn derivatives(&self) -> Derivatives {
        self.0.derivatives().min(Derivatives::Free)
    }
}

/// The residuals depend on k/m, c/m, μ N/k and x₀ only. Scaling all masses, stiffnesses, dampings and loads changes
/// nothing, and scaling m, k and c scales μ: m ∂μ/∂m + k ∂μ/∂k + c ∂μ/∂c = μ, while N ∂μ/∂N = −μ.
#[test]
fn scales_have_their_identities() {
    let fixed =
        |name, symbol, unit, value: f64| Parameter::new(name, symbol, unit).bounded(Bounds::new(value, value).unwrap());
    for is_exact in [true, false] {
        let parameters = vec![
            fixed("mass", "m", "kg", 10.391),
            fixed("stiffness", "k", "N/m", 1982.0),
            fixed("damping", "c", "N s/m", 0.275),
            fixed("load", "N", "N", 7.2),
            Parameter::new("friction", "μ", "1").bounded(Bounds::NOT_NEGATIVE),
            // Position and friction shift the same: only their difference is determined, so one of them is fixed.
            fixed("position", "x₀", "m", 0.0105),
        ];
        let problem = FormulaProblem { formula: Swing, count: 110, parameters, is_exact };
        let start = [10.391, 1982.0, 0.275, 7.2, 0.1, 0.0105];
        let fit = solve(&problem, &start, &Options::default()).unwrap();
        let friction = fit.estimate("friction").unwrap().value();
        assert!(friction > 0.05 && fit.sum_of_squares() > 10.0, "μ = {friction}, S = {}", fit.sum_of_squares());
        let sensitivity = Sensitivity::of(&problem, &fit).unwrap();
        let scaled = |name: &str| {
            let value = fit.estimate(name).unwrap().value();
            value * sensitivity.coefficient_of("friction", name).unwrap()
        };
        // Rounding and truncation of differences, 1e-10, on terms fifty times as large as their sum; without
        // derivatives those of differences of differences.
        let tolerance = if is_exact { 1e-8 } else { 1e-5 };
        let sum = scaled("mass") + scaled("stiffness") + scaled("damping");
        assert!((sum / friction - 1.0).abs() < tolerance, "m ∂μ/∂m + k ∂μ/∂k + c ∂μ/∂c = {sum}, not {friction}");
        assert!((scaled("load") / friction + 1.0).abs() < tolerance, "N ∂μ/∂N = {}", scaled("load"));
        println!("{sensitivity}");
        let unfilled = Sensitivity::of(&Unfilled(&problem), &fit).unwrap();
        for &input in sensitivity.inputs() {
            let (coefficient, stepped) = (sensitivity.coefficient(4, input), unfilled.coefficient(4, input));
            let error = stepped.unwrap() / coefficient.unwrap() - 1.0;
            assert!(error.abs() < tolerance, "by differences the coefficient of input {input} is off by {error}");
        }

        // Fully correlated relative uncertainties of one per cent of m, k and c are one of μ.
        let one_percent = |j: usize| if j < 3 { 0.01 * start[j] } else { 0.0 };
        let inputs = sensitivity.inputs();
        let parts = inputs.iter().map(|&j| sensitivity.coefficient(4, j).unwrap() * one_percent(j));
        let uncertainty = parts.clone().sum::<f64>().abs();
        assert!((uncertainty / (0.01 * friction) - 1.0).abs() < 1e-4, "u(μ) = {uncertainty}");
        // Independent ones add their squares.
        let expected = parts.map(|part| part * part).sum::<f64>().sqrt();
        let found = sensitivity.propagated_uncertainty(4, &inputs.iter().map(|&j| one_percent(j)).collect::<Vec<_>>());
        assert!((found.unwrap() / expected - 1.0).abs() < 1e-14);
    }
}

#[test]
fn what_is_not_determined_or_at_a_bound_is_said() {
    let free = |name, symbol, unit| Parameter::new(name, symbol, unit);
    let fixed =
        |name, symbol, unit, value: f64| Parameter::new(name, symbol, unit).bounded(Bounds::new(value, value).unwrap());
    // Friction and position shift the same; the rest is fixed.
    let parameters = vec![
        fixed("mass", "m", "kg", 10.391),
        free("stiffness", "k", "N/m"),
        fixed("damping", "c", "N s/m", 0.275),
        fixed("load", "N", "N", 7.2),
        free("friction", "μ", "1"),
        free("position", "x₀", "m"),
    ];
    let problem = FormulaProblem { formula: Swing, count: 110, parameters: parameters.clone(), is_exact: true };
    let start = [10.391, 1982.0, 0.275, 7.2, 0.1, 0.0105];
    let fit = solve(&problem, &start, &Options::default()).unwrap();
    assert_eq!(fit.rank(), 2);
    let sensitivity = Sensitivity::of(&problem, &fit).unwrap();
    // Only the natural frequency is seen, so that k follows m and c.
    let stiffness = fit.estimate("stiffness").unwrap().value();
    let scaled = |name: &str| {
        fit.estimate(name).unwrap().value() * sensitivity.coefficient_of("stiffness", name).unwrap() / stiffness
    };
    let sum = scaled("mass") + scaled("damping");
    assert!((sum - 1.0).abs() < 1e-8, "d ln k = {sum} d ln (m, c)");
    assert_eq!(sensitivity.coefficient_of("friction", "mass"), None, "not determined");

    let mut at_bound = parameters.clone();
    at_bound[4] = free("friction", "μ", "1").bounded(Bounds::new(0.0, 0.01).unwrap());
    at_bound[5] = fixed("position", "x₀", "m", 0.0105);
    let problem = FormulaProblem { parameters: at_bound, ..problem };
    let fit = solve(&problem, &[10.391, 1982.0, 0.275, 7.2, 0.005, 0.0105], &Options::default()).unwrap();
    assert!(fit.estimate("friction").unwrap().status().is_at_bound());
    let sensitivity = Sensitivity::of(&problem, &fit).unwrap();
    assert_eq!(sensitivity.coefficient_of("friction", "mass"), Some(0.0));
    assert!(sensitivity.coefficient_of("stiffness", "mass").unwrap() > 0.0);

    assert_eq!(sensitivity.propagated_uncertainty(1, &[0.1]), None, "four inputs");
    assert_eq!(sensitivity.propagated_uncertainty(0, &[0.1; 4]), None, "an input itself");

    let cut =
        solve(&problem, &start.map(|v| if v == 0.1 { 0.005 } else { v }), &Options::default().with_max_iterations(1));
    let cut = cut.unwrap();
    assert!(matches!(Sensitivity::of(&problem, &cut), Err(FitError::NoMinimum { .. })));
    let other =
        FormulaProblem { formula: Swing, count: 109, parameters: problem.parameters().to_vec(), is_exact: true };
    assert!(matches!(Sensitivity::of(&other, &fit), Err(FitError::OtherFit { .. })));
}
