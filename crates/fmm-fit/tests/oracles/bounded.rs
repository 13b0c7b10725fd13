//! Problems with a bound that is active at the minimum.
use fmm_fit::{FitError, Options, solve};
use serde_json::Value;

use crate::harness::{Formula, FormulaProblem, at_least, digits, number, numbers, parameters};
use crate::strd_models::Dataset;
use fmm_model::Scalar;

/// As below without derivatives: a step across a pole, as MGH10 has one at every abscissa, is no reason to stop.
#[test]
fn bounded_reference_data_without_derivatives_end_nowhere_else() {
    let files: [Value; 2] = [include_str!("../data/bounded_strd.json"), include_str!("../data/bounded_strd_more.json")]
        .map(|file| serde_json::from_str(file).unwrap());
    let all_sets = crate::strd::files();
    let mut succeeded = 0;
    for problem in files.iter().flat_map(|file| file["problems"].as_object().unwrap().values()) {
        let name = problem["dataset"].as_str().unwrap();
        let set = all_sets.iter().find_map(|sets| sets["datasets"].get(name)).unwrap();
        for start in ["start1", "start2"] {
            let formula = Dataset::read(set);
            let parameters = parameters(numbers(&problem["params"]).len(), &problem["lower"], &problem["upper"]);
            let inside: Vec<f64> =
                numbers(&set[start]).iter().zip(&parameters).map(|(value, p)| p.bounds().clamp(*value)).collect();
            let fit = FormulaProblem { count: formula.len(), formula, parameters, is_exact: false };
            let fit = solve(&fit, &inside, &Options::default()).unwrap();
            let (sum, best) = (fit.sum_of_squares(), number(&problem["rss"]));
            let digits = digits(fit.values(), &numbers(&problem["params"]));
            println!("{name}/{start}: {digits:.1} digits, S {sum:.6e} ({best:.6e}), {}", fit.outcome());
            // With derivatives these end in other local minima too.
            let has_others =
                ["Lanczos3/start1", "MGH17/start1", "Thurber/start2"].contains(&&*format!("{name}/{start}"));
            assert!(digits >= 6.0 || has_others || !fit.outcome().is_success(), "{name}/{start}: S = {sum}");
            succeeded += usize::from(fit.outcome().is_success());
        }
    }
    assert!(succeeded >= 53, "{succeeded} of 54");
}

/// NIST's sets with one parameter bounded two standard uncertainties away from its free value. Starts outside are
/// moved to the nearest point inside.
#[test]
fn bounded_reference_data_end_exactly_on_the_bound() {
    let files: [Value; 2] = [include_str!("../data/bounded_strd.json"), include_str!("../data/bounded_strd_more.json")]
        .map(|file| serde_json::from_str(file).unwrap());
    let all_sets = crate::strd::files();
    let (mut agreement, mut on_bound, mut evaluations) = (vec![], 0, 0);
    for problem in files.iter().flat_map(|file| file["problems"].as_object().unwrap().values()) {
        let name = problem["dataset"].as_str().unwrap();
        let set = all_sets.iter().find_map(|sets| sets["datasets"].get(name)).unwrap();
        let reference = numbers(&problem["params"]);
        for start in ["start1", "start2"] {
            let formula = Dataset::read(set);
            let label = format!("{}/{start}", formula.name);
            let parameters = parameters(reference.len(), &problem["lower"], &problem["upper"]);
            let inside: Vec<f64> =
                numbers(&set[start]).iter().zip(&parameters).map(|(value, p)| p.bounds().clamp(*value)).collect();
            let fit = FormulaProblem { count: formula.len(), formula, parameters, is_exact: true };
            let fit = solve(&fit, &inside, &Options::default()).unwrap();
            let active = problem["active_index"].as_u64().unwrap() as usize;
            let is_on_bound = fit.estimates()[active].status().is_at_bound();
            let digits = digits(fit.values(), &reference);
            println!(
                "{label:<16} {digits:5.1} digits, on the bound: {is_on_bound}, {} residuals, S {:.6e} ({:.6e}), {}",
                fit.residual_evaluations(),
                fit.sum_of_squares(),
                number(&problem["rss"]),
                fit.outcome()
            );
            agreement.push(digits);
            on_bound += usize::from(is_on_bound);
            evaluations += fit.residual_evaluations();
            // The residuals of Lanczos1 are rounding noise, and so is their gradient.
            if digits >= 10.0 && name != "Lanczos1" {
                let expected = number(&problem["gradient_half_rss"][active]);
                let multiplier = fit.estimates()[active].multiplier().unwrap();
                // A sum of terms a million times larger than itself, as in Bennett5, keeps so many of their digits.
                assert!((multiplier / expected - 1.0).abs() < 1e-6, "{label}: {multiplier} instead of {expected}");
            }
        }
    }
    println!(
        "{} of {} to 10 digits, {on_bound} on the bound, {evaluations} residuals",
        at_least(&agreement, 10.0),
        agreement.len()
    );
    assert_eq!(agreement.len(), 54);
    // Lanczos3/1, MGH17/1 and Thurber/2 end in other local minima, on the bound as well.
    assert!(at_least(&agreement, 10.0) >= 51);
    assert_eq!(on_bound, 54);
}

/// The residuals of the published problems, by name.
struct Published(String);

impl Formula for Published {
    fn residual<D: Scalar>(&self, i: usize, p: &[D]) -> D {
        match (self.0.as_str(), i) {
            ("hs01" | "hs02", 0) => (p[1] - p[0] * p[0]) * 10.0,
            ("hs01" | "hs02", _) => D::from(1.0) - p[0],
            ("hs38", i) => crate::mgh::wood(i, p),
            (_, i) => {
                let t = -4.0 + 8.0 * i as f64 / 99.0;
                let model = p[0] * (-t).exp() * (-(p[1] - t).exp()).exp();
                model - (-0.5 * t * t).exp() / std::f64::consts::TAU.sqrt()
            }
        }
    }
}

#[test]
fn published_problems_reach_their_minima() {
    let file: Value = serde_json::from_str(include_str!("../data/bounded_published.json")).unwrap();
    for (name, problem) in file["problems"].as_object().unwrap() {
        let reference = numbers(&problem["params"]);
        let parameters = parameters(reference.len(), &problem["lower"], &problem["upper"]);
        let start = numbers(&problem["x0"]);
        let count = match name.as_str() {
            "hs38" => 6,
            "lsqnonlin_doc_gumbel" => 100,
            _ => 2,
        };
        let problem_of = FormulaProblem { formula: Published(name.clone()), count, parameters, is_exact: true };
        if problem["x0_note"].is_string() {
            let refused = solve(&problem_of, &start, &Options::default());
            assert!(matches!(refused, Err(FitError::OutOfRange { .. })), "{name} starts outside");
        }
        let inside: Vec<f64> =
            start.iter().zip(&problem_of.parameters).map(|(value, p)| p.bounds().clamp(*value)).collect();
        let fit = solve(&problem_of, &inside, &Options::default()).unwrap();
        println!("{name}: {:?}, S {:e}, {}", fit.values(), fit.sum_of_squares(), fit.outcome());
        assert!(fit.outcome().is_success(), "{name}: {}", fit.outcome());
        // Problem 2 of Hock and Schittkowski has three stationary points on its bound; the start is nearest to one
        // that is a local minimum and not the best.
        let sums: Vec<f64> = match problem["stationary_points_on_bound"].as_array() {
            Some(points) => points[..2].iter().map(|point| number(&point["sumsq"])).collect(),
            None => vec![number(&problem["sumsq"])],
        };
        let error = |sum: &f64| (fit.sum_of_squares() - sum).abs();
        let nearest = sums.iter().map(error).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-12, "{name}: S = {}", fit.sum_of_squares());
    }
}
