//! A free vibration in closed form: with (k/m, c/m, x₀, v₀) everything is determined, with (m, k, c, x₀, v₀) the
//! scale of the first three is not.

use fmm_fit::{EstimateStatus, Fit, Options, Outcome, solve};
use fmm_model::{Bounds, Parameter, Scalar};
use serde_json::Value;

use crate::harness::{Formula, FormulaProblem, digits, number, numbers};

struct FreeVibration {
    step: f64,
    data: Vec<f64>,
}

/// Velocity (m/s) of x″ + c x′ + k x = 0 at time `t`.
pub(crate) fn velocity<D: Scalar>(t: f64, k: D, c: D, x0: D, v0: D) -> D {
    let rate = c * 0.5;
    let angular = (k - rate * rate).sqrt();
    let (sin, cos) = (angular * t).sin_cos();
    (-rate * t).exp() * (v0 * cos - (k * x0 + rate * v0) / angular * sin)
}

impl Formula for FreeVibration {
    fn residual<D: Scalar>(&self, i: usize, p: &[D]) -> D {
        let t = i as f64 * self.step;
        let model = match p {
            [k, c, x0, v0] => velocity(t, *k, *c, *x0, *v0),
            _ => velocity(t, p[1] / p[0], p[2] / p[0], p[3], p[4]),
        };
        (model - self.data[i]) * 1000.0
    }
}

fn problem(parameters: Vec<Parameter>, is_exact: bool) -> (FormulaProblem<FreeVibration>, Value) {
    let file: Value = serde_json::from_str(include_str!("../data/free_vibration.json")).unwrap();
    let oracle = file["free_vibration"].clone();
    let formula = FreeVibration { step: number(&oracle["dt"]), data: numbers(&oracle["data"]) };
    (FormulaProblem { count: formula.data.len(), formula, parameters, is_exact }, oracle)
}

#[test]
fn determined_parameters_with_uncertainties_and_correlations() {
    let names =
        [("stiffness", "k", "1/s²"), ("damping", "c", "1/s"), ("displacement", "x0", "m"), ("velocity", "v0", "m/s")];
    let parameters = names.map(|(name, symbol, unit)| Parameter::new(name, symbol, unit)).to_vec();
    for (is_exact, wanted) in [(true, 10.0), (false, 8.0)] {
        let (problem, oracle) = problem(parameters.clone(), is_exact);
        let fit = solve(&problem, &numbers(&oracle["x0"]), &Options::default()).unwrap();
        println!("{fit}");
        assert!(digits(fit.values(), &numbers(&oracle["params"])) >= wanted, "values {:?}", fit.values());
        for j in 0..4 {
            let uncertainty = fit.estimates()[j].standard_uncertainty().unwrap();
            let expected = number(&oracle["sd"][j]);
            assert!((uncertainty / expected - 1.0).abs() < 1e-8, "u({}) = {uncertainty}, not {expected}", names[j].0);
            for i in 0..4 {
                let (value, expected) = (fit.correlation(i, j).unwrap(), number(&oracle["correlation"][i][j]));
                assert!((value - expected).abs() < 1e-7, "correlation({i}, {j}) = {value}, not {expected}");
            }
        }
        // Student's t with 596 degrees of freedom: t(0.975) = 1.963 95.
        let (low, high) = fit.interval("stiffness", 0.95).unwrap();
        let reach = 1.963_952 * number(&oracle["sd"][0]);
        assert!((0.5 * (high - low) / reach - 1.0).abs() < 1e-5, "interval [{low}, {high}]");
    }
}

fn undetermined(start: &[f64], is_exact: bool) -> Fit {
    let bounded = |name, symbol, unit, lower, upper| {
        Parameter::new(name, symbol, unit).bounded(Bounds::new(lower, upper).unwrap())
    };
    let parameters = vec![
        bounded("mass", "m", "kg", 1.0, 100.0),
        bounded("stiffness", "k", "N/m", 0.0, 3000.0),
        bounded("damping", "c", "N s/m", 0.0, 100.0),
        bounded("displacement", "x0", "m", -0.012, 0.012),
        bounded("velocity", "v0", "m/s", 0.0, 1.0),
    ];
    let (problem, _) = problem(parameters, is_exact);
    solve(&problem, start, &Options::default()).unwrap()
}

#[test]
fn the_scale_of_mass_stiffness_and_damping_is_not_determined() {
    for is_exact in [true, false] {
        for start in [[14.4, 1980.0, 0.27, 1e-4, 0.1], [10.0, 1500.0, 0.2, 1e-4, 0.1], [8.0, 1400.0, 0.1, 0.0, 0.1]] {
            let fit = undetermined(&start, is_exact);
            println!("{fit}");
            assert!(fit.outcome().is_success(), "{}", fit.outcome());
            assert_ne!(fit.outcome(), Outcome::NoFreeParameters);
            assert_eq!((fit.rank(), fit.free_count()), (4, 5), "singular values {:?}", fit.singular_values());
            let [direction] = fit.null_directions() else { panic!("{} directions", fit.null_directions().len()) };
            for (component, expected) in direction.components().iter().zip([1.0, 1.0, 1.0, 0.0, 0.0]) {
                assert!((component - expected).abs() < 1e-6, "components {:?}", direction.components());
            }
            assert_eq!(
                direction.to_string(),
                "mass, stiffness and damping can be scaled together without changing the residuals; \
                 only their ratios are determined"
            );
            for estimate in &fit.estimates()[..3] {
                assert_eq!(estimate.status(), EstimateStatus::Undetermined, "{}", estimate.name());
                assert_eq!(estimate.standard_uncertainty(), None);
            }
            // The ratios and the rest are those of the determined form.
            let p = fit.values();
            assert!((p[1] / p[0] / 190.740_316_974_299_94 - 1.0).abs() < 1e-9, "k/m = {} 1/s²", p[1] / p[0]);
            assert!((p[2] / p[0] / 0.026_388_083_556_376_315 - 1.0).abs() < 1e-7, "c/m = {} 1/s", p[2] / p[0]);
            let uncertainty = fit.estimates()[4].standard_uncertainty().unwrap();
            assert!((uncertainty / 3.385_632_835_041_063e-5 - 1.0).abs() < 1e-6, "u(v₀) = {uncertainty} m/s");
            assert_eq!(fit.degrees_of_freedom(), 596);
        }
    }
}
