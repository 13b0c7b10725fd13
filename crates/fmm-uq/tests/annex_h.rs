//! The worked examples of JCGM 100:2008, Annex H. Figures with more digits than the printed ones were recomputed
//! from the same inputs in an independent program.

use fmm_uq::{Budget, Dual, DualNum, Input, Inputs, coverage_factor, propagate};

/// Independent figures carry 12 digits; both sides round a dozen times.
const RELATIVE: f64 = 1e-11;

fn close(what: &str, found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{what}: {found}, not {expected}");
}

/// H.1, end gauge calibration: length of a gauge block of 50 mm at 20 °C, in nm.
fn gauge_block() -> Budget {
    let input =
        |name, value, u, unit, nu| Input::new(name, value, u, unit).unwrap().with_degrees_of_freedom(nu).unwrap();
    let inputs = Inputs::new([
        input("l_S", 50_000_623.0, 25.0, "nm", 18.0),
        input("d", 215.0, 9.7, "nm", 25.6),
        input("α_S", 1.15e-5, 1.2e-6, "1/K", f64::INFINITY),
        input("θ", -0.1, 0.41, "K", f64::INFINITY),
        input("δα", 0.0, 5.8e-7, "1/K", 50.0),
        input("δθ", 0.0, 0.029, "K", 2.0),
    ])
    .unwrap();
    let length = |x: &[Dual]| x[0] + x[1] - x[0] * (x[4] * x[3] + x[2] * x[5]);
    propagate(&inputs, length).unwrap().named("length", "nm")
}

#[test]
fn gauge_block_uncertainty_and_contributions() {
    let budget = gauge_block();
    assert_eq!(budget.estimate(), 50_000_838.0);
    close("u_c (nm)", budget.standard_uncertainty(), 31.710_609_640_4, RELATIVE);
    assert_eq!(budget.standard_uncertainty().round(), 32.0, "printed: 32 nm");
    let expected = [25.0, 9.7, 0.0, 0.0, 2.900_036_134, 16.675_207_770_5];
    for (row, expected) in budget.contributions().zip(expected) {
        close(row.input.name(), row.uncertainty, expected, RELATIVE);
    }
    let shares: f64 = budget.contributions().map(|row| row.share).sum();
    close("sum of shares", shares, 1.0, 1e-15);
}

#[test]
fn gauge_block_degrees_of_freedom_and_expanded_uncertainty() {
    let budget = gauge_block();
    close("ν_eff", budget.effective_degrees_of_freedom().unwrap(), 16.656_062_703, 1e-10);
    let expanded = budget.expanded(0.99).unwrap();
    assert_eq!(expanded.degrees_of_freedom, 16.0);
    close("k₉₉", expanded.coverage_factor, 2.920_781_622_43, RELATIVE);
    close("U₉₉ (nm)", expanded.uncertainty, 92.619_765_873_7, RELATIVE);
    assert_eq!(expanded.uncertainty.round(), 93.0, "printed: 93 nm");
    let interpolated = coverage_factor(0.99, budget.effective_degrees_of_freedom().unwrap()).unwrap();
    close("k₉₉ at ν_eff itself", interpolated, 2.905_647_323_91, RELATIVE);
}

#[test]
fn gauge_block_as_a_table() {
    let expected = "\
length = 50000838 nm, u = 31.7 nm, ν_eff = 16.7

input     value       u  unit     ν  sensitivity  |c| u   share
l_S    50000623      25    nm    18            1     25  62.2 %
d           215     9.7    nm  25.6            1    9.7   9.4 %
α_S     1.15e-5  1.2e-6   1/K     ∞            0      0   0.0 %
θ          -0.1    0.41     K     ∞            0      0   0.0 %
δα            0  5.8e-7   1/K    50      5000000    2.9   0.8 %
δθ            0   0.029     K     2         -575   16.7  27.7 %
";
    assert_eq!(gauge_block().to_string(), expected);
}

/// Five simultaneous readings of V (V), I (A) and φ (rad), Table H.2.
const READINGS: [[f64; 5]; 3] = [
    [5.007, 4.994, 5.005, 4.990, 4.999],
    [0.019_663, 0.019_639, 0.019_640, 0.019_685, 0.019_678],
    [1.0456, 1.0438, 1.0468, 1.0428, 1.0433],
];

/// Covariance of two means of five readings each.
fn covariance(a: &[f64; 5], b: &[f64; 5]) -> f64 {
    let mean = |x: &[f64; 5]| x.iter().sum::<f64>() / 5.0;
    let products = a.iter().zip(b).map(|(p, q)| (p - mean(a)) * (q - mean(b)));
    products.sum::<f64>() / (4.0 * 5.0)
}

fn impedance_inputs() -> Inputs {
    let u = READINGS.map(|x| covariance(&x, &x).sqrt());
    let r = |i: usize, j: usize| covariance(&READINGS[i], &READINGS[j]) / (u[i] * u[j]);
    let [v, i, phi] = READINGS.map(|x| x.iter().sum::<f64>() / 5.0);
    let mean = |name, value, u, unit| Input::new(name, value, u, unit).unwrap().with_degrees_of_freedom(4.0).unwrap();
    Inputs::new([mean("V", v, u[0], "V"), mean("I", i, u[1], "A"), mean("φ", phi, u[2], "rad")])
        .unwrap()
        .with_correlations(&[("V", "I", r(0, 1)), ("V", "φ", r(0, 2)), ("I", "φ", r(1, 2))])
        .unwrap()
}

/// H.2, simultaneous resistance and reactance: R, X and Z in Ω.
fn impedance(inputs: &Inputs) -> [Budget; 3] {
    let models: [fn(&[Dual]) -> Dual; 3] =
        [|x| x[0] / x[1] * x[2].cos(), |x| x[0] / x[1] * x[2].sin(), |x| x[0] / x[1]];
    models.map(|model| propagate(inputs, model).unwrap())
}

#[test]
fn impedance_from_correlated_means() {
    let inputs = impedance_inputs();
    for (pair, expected) in
        [(("V", "I"), -0.355_311_219_817), (("V", "φ"), 0.857_624_210_84), (("I", "φ"), -0.645_111_217_689)]
    {
        close("input correlation", inputs.correlation(pair.0, pair.1).unwrap(), expected, 1e-9);
    }
    let results = impedance(&inputs);
    let estimates = [127.732_169_928, 219.846_511_913, 254.259_701_948];
    let uncertainties = [0.071_071_407_397, 0.295_581_677_359, 0.236_336_130_082];
    for i in 0..3 {
        close("estimate (Ω)", results[i].estimate(), estimates[i], RELATIVE);
        // The means of the readings lose four digits to their offset, and u(R) another in cancellation.
        close("u (Ω)", results[i].standard_uncertainty(), uncertainties[i], 1e-9);
    }
}

#[test]
fn impedance_results_are_correlated_in_turn() {
    let results = impedance(&impedance_inputs());
    for (i, j, expected) in [(0, 1, -0.588_429_784_424), (0, 2, -0.485_259_224_21), (1, 2, 0.992_511_648_949)] {
        let covariance = results[i].covariance_with(&results[j]).unwrap();
        let r = covariance / (results[i].standard_uncertainty() * results[j].standard_uncertainty());
        close("correlation of results", r, expected, 1e-9);
    }
}

#[test]
fn impedance_has_no_effective_degrees_of_freedom() {
    for budget in impedance(&impedance_inputs()) {
        assert_eq!(budget.effective_degrees_of_freedom(), None);
    }
}

#[test]
fn impedance_from_the_printed_correlations_differs_in_the_last_digit() {
    let mean = |name, value, u, unit| Input::new(name, value, u, unit).unwrap();
    let inputs = Inputs::new([
        mean("V", 4.999, 0.0032, "V"),
        mean("I", 0.019_661, 9.5e-6, "A"),
        mean("φ", 1.044_46, 0.000_75, "rad"),
    ])
    .unwrap()
    .with_correlations(&[("V", "I", -0.36), ("V", "φ", 0.86), ("I", "φ", -0.65)])
    .unwrap();
    let [resistance, reactance, impedance] = impedance(&inputs);
    close("u(R) (Ω)", resistance.standard_uncertainty(), 0.069_978_727_988_4, 1e-10);
    close("u(X) (Ω)", reactance.standard_uncertainty(), 0.295_716_826_846, 1e-10);
    close("u(Z) (Ω)", impedance.standard_uncertainty(), 0.236_602_971_835, 1e-10);
}
