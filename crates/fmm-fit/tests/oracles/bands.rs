//! Bands of a nonlinear fit against values computed with 40 digits.

use fmm_fit::{Options, solve};
use serde_json::Value;

use crate::harness::{FormulaProblem, numbers, parameters};
use crate::strd::files;
use crate::strd_models::Dataset;

/// x, value, u, and half widths at 95 %: of confidence, of the simultaneous band, and for a new observation; Misra1a by
/// mpmath with Jacobian and covariance at the refined minimum, quantiles by scipy.stats 1.17.
const EXPECTED: [[f64; 6]; 3] = [
    [
        50.0,
        6.483_199_310_950_8,
        0.011_682_423_109_635,
        0.025_453_813_352_873,
        0.032_565_658_445_533,
        0.223_429_382_943_01,
    ],
    [
        450.0,
        52.401_140_948_282,
        0.033_964_324_984_881,
        0.074_001_907_028_046,
        0.094_678_184_175_55,
        0.233_985_202_076_94,
    ],
    [1000.0, 101.106_076_686_39, 0.153_260_848_236_34, 0.333_926_702_424_11, 0.427_226_474_329_4, 0.400_973_609_030_61],
];

#[test]
fn bands_of_misra1a() {
    let [sets, _] = files();
    let all = sets["datasets"].as_object().unwrap();
    let set: &Value = all.values().find(|set| set["name"] == "Misra1a").unwrap();
    let formula = Dataset::read(set);
    let problem = FormulaProblem {
        count: formula.len(),
        formula,
        parameters: parameters(2, &Value::Null, &Value::Null),
        is_exact: true,
    };
    let fit = solve(&problem, &numbers(&set["start1"]), &Options::default()).unwrap();
    let model = |x: f64, p: &[f64]| p[0] * (1.0 - (-p[1] * x).exp());
    for [x, value, u, confidence, simultaneous, observation] in EXPECTED {
        let decay = (-fit.values()[1] * x).exp();
        let gradient = [1.0 - decay, fit.values()[0] * x * decay];
        let exact = fit.predict(model(x, fit.values()), &gradient).unwrap();
        let differences = fit.predict_by_differences(|p| model(x, p)).unwrap();
        // The exact gradient keeps the digits of the covariance, ten; central differences are good to ε^⅔ of the value.
        for (prediction, tolerance) in [(exact, 1e-9), (differences, 1e-8)] {
            let half = |interval: Option<(f64, f64)>| interval.map(|(lower, upper)| 0.5 * (upper - lower)).unwrap();
            let found = [
                prediction.value(),
                prediction.standard_uncertainty(),
                half(prediction.confidence(0.95)),
                half(prediction.simultaneous(0.95)),
                half(prediction.observation(0.95, 1.0)),
            ];
            for (found, expected) in found.into_iter().zip([value, u, confidence, simultaneous, observation]) {
                assert!((found / expected - 1.0).abs() < tolerance, "at {x}: {found} instead of {expected}");
            }
        }
    }
}
