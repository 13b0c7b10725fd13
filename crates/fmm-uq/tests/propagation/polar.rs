//! JCGM 102:2011, 9.3: Cartesian to polar coordinates.

use fmm_uq::{Gum, Input, Inputs, MonteCarlo, Scalar};
use serde_json::Value;

fn polar<D: Scalar>(x: &[D]) -> [D; 2] {
    [(x[0] * x[0] + x[1] * x[1]).sqrt(), x[1].atan2(x[0])]
}

#[test]
fn polar_coordinates() {
    let oracle: Value = serde_json::from_str(include_str!("../data/jcgm102_polar.json")).unwrap();
    let trials = 1_000_000;
    for row in oracle["rows"].as_array().unwrap() {
        let [x1, r] = ["x1", "r"].map(|key| row[key].as_f64().unwrap());
        let what = format!("x1 = {x1}, r = {r}");
        let inputs =
            Inputs::new([Input::new("X1", x1, 0.01, "m").unwrap(), Input::new("X2", 0.0, 0.01, "m").unwrap()]).unwrap();
        let inputs = inputs.with_correlations(&[("X1", "X2", r)]).unwrap();

        let linear = Gum::new(&inputs).propagate(polar).unwrap();
        let first = &row["guf_first_order"];
        for (k, (y, u)) in [("y1", "u1"), ("y2", "u2")].into_iter().enumerate() {
            let budget = &linear.outputs()[k];
            assert_eq!(budget.estimate(), first[y].as_f64().unwrap(), "{what}");
            assert!((budget.standard_uncertainty() / first[u].as_f64().unwrap() - 1.0).abs() < 1e-14, "{what}");
        }
        assert!((linear.correlation(0, 1) - r).abs() < 1e-14, "{what}");
        // Correlation moves the angle by 9 % of its uncertainty even ten standard uncertainties from the origin.
        assert_eq!(linear.outputs()[1].linearisation().is_suspect(), x1 < 0.1 || r > 0.0, "{what}");

        let sample = MonteCarlo::new(&inputs, trials).unwrap().run(polar).unwrap();
        let exact = &row["exact"];
        for (k, (y, u)) in [("y1", "u1"), ("y2", "u2")].into_iter().enumerate() {
            let [error_y, error_u] = sample.standard_errors(k).unwrap();
            let (found_y, found_u) = (sample.estimate(k).unwrap(), sample.standard_uncertainty(k).unwrap());
            assert!((found_y - exact[y].as_f64().unwrap()).abs() < 5.0 * error_y, "{what}: {y} = {found_y}");
            assert!((found_u - exact[u].as_f64().unwrap()).abs() < 5.0 * error_u, "{what}: {u} = {found_u}");
        }
        // 1/√M bounds the standard error of a correlation coefficient for these light-tailed outputs.
        let found = sample.correlation(0, 1).unwrap();
        assert!((found - exact["r12"].as_f64().unwrap()).abs() < 5e-3, "{what}: r = {found}");
    }
}

/// Bivariate normal: k² = −2 ln(1 − p) for the ellipse; for independent outputs the square has (2Φ(k) − 1)² = p.
#[test]
fn regions_of_normal_outputs() {
    let inputs =
        Inputs::new([Input::new("a", 1.0, 0.1, "m").unwrap(), Input::new("b", 2.0, 3.0, "m").unwrap()]).unwrap();
    let correlated = inputs.clone().with_correlations(&[("a", "b", 0.8)]).unwrap();
    let run = |inputs: &Inputs| MonteCarlo::new(inputs, 400_000).unwrap().run(|x| [x[0], x[1]]).unwrap();
    let (independent, correlated) = (run(&inputs), run(&correlated));
    let expected = (-2.0 * 0.05f64.ln()).sqrt();
    // Standard error √(p (1 − p)/M)/g with the density g = k exp(−k²/2) of the radius: 0.0028.
    for sample in [&independent, &correlated] {
        let k = sample.ellipsoid(0.95).unwrap().coverage_factor;
        assert!((k - expected).abs() < 0.014, "{k}, not {expected}");
    }
    let square = independent.rectangle(0.95).unwrap();
    // Φ(k) = (1 + √0.95)/2 at k = 2.2365; density of the larger of two 4 φ(k) (2Φ(k) − 1) = 0.128.
    assert!((square.coverage_factor - 2.2365).abs() < 0.014, "{}", square.coverage_factor);
    assert!((square.standard_uncertainties[1] - 3.0).abs() < 0.017);
    let twice = MonteCarlo::new(&inputs, 10_000).unwrap().run(|x| [x[0], 2.0 * x[0]]).unwrap();
    assert!(twice.ellipsoid(0.95).is_err() && twice.rectangle(0.95).is_ok());
    assert!((twice.correlation(0, 1).unwrap() - 1.0).abs() < 1e-12);
}

/// Regions of the linear approximation hold the share of trials that they are stated for.
#[test]
fn linear_regions_hold_their_share() {
    let model = |x: &[f64]| [x[0] + 2.0 * x[1], x[0] - x[1] + 3.0];
    let two = |nu: f64| {
        let inputs = Inputs::new(["a", "b"].map(|name| Input::new(name, 1.0, 0.1, "m").unwrap())).unwrap();
        let inputs = inputs.with_correlations(&[("a", "b", 0.4)]).unwrap();
        if nu.is_finite() { inputs.with_ensemble(&["a", "b"], nu).unwrap() } else { inputs }
    };
    for nu in [f64::INFINITY, 5.0] {
        let inputs = two(nu);
        let linear = Gum::new(&inputs).propagate_by_differences(model).unwrap();
        let trials = MonteCarlo::new(&inputs, 400_000).unwrap().run(model).unwrap();
        let (ellipsoid, rectangle) = (linear.ellipsoid(0.95).unwrap(), linear.rectangle(0.95).unwrap());
        let determinant = {
            let c = &ellipsoid.covariance;
            c[0][0] * c[1][1] - c[0][1] * c[1][0]
        };
        let inside = |row: [f64; 2], region: &fmm_uq::Region, elliptic: bool| {
            let d = [row[0] - region.centre[0], row[1] - region.centre[1]];
            let (c, u, k) = (&region.covariance, &region.standard_uncertainties, region.coverage_factor);
            if elliptic {
                let square = c[1][1] * d[0] * d[0] - 2.0 * c[0][1] * d[0] * d[1] + c[0][0] * d[1] * d[1];
                square / determinant <= k * k
            } else {
                d[0].abs() <= k * u[0] && d[1].abs() <= k * u[1]
            }
        };
        let pairs: Vec<[f64; 2]> =
            trials.values(0).unwrap().iter().zip(trials.values(1).unwrap()).map(|(a, b)| [*a, *b]).collect();
        let share = |region: &fmm_uq::Region, elliptic: bool| {
            pairs.iter().filter(|pair| inside(**pair, region, elliptic)).count() as f64 / pairs.len() as f64
        };
        // Five standard deviations of a share of 400 000.
        let found = share(&ellipsoid, true);
        assert!((found - 0.95).abs() < 0.0018, "ν {nu}: the ellipsoid holds {found}");
        let found = share(&rectangle, false);
        assert!((0.95 - 0.0018..0.97).contains(&found), "ν {nu}: the rectangle holds {found}");
    }
    // 5.991 is the 95 % quantile of χ² with two degrees of freedom, −2 ln 0.05.
    let linear = Gum::new(&two(f64::INFINITY)).propagate_by_differences(model).unwrap();
    let k = linear.ellipsoid(0.95).unwrap().coverage_factor;
    assert!((k * k / (-2.0 * 0.05f64.ln()) - 1.0).abs() < 1e-9, "{k}");
    let same = Gum::new(&two(f64::INFINITY)).propagate_by_differences(|x| [x[0], 2.0 * x[0]]).unwrap();
    assert!(matches!(same.ellipsoid(0.95), Err(fmm_uq::UncertaintyError::NoAnswer { .. })));
    assert!(same.rectangle(0.95).is_ok() && same.rectangle(1.0).is_err());
}
