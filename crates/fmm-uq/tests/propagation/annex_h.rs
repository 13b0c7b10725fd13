//! The worked examples of JCGM 100:2008, Annex H. Figures with more digits than the printed ones were recomputed
//! from the same inputs in an independent program.

use fmm_model::coverage_factor;
use fmm_uq::{Budget, Gum, Input, Inputs, Linearisation, Observations, Propagation, Scalar, Taylor, propagate};

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
    let length = |x: &[Taylor]| x[0] + x[1] - x[0] * (x[4] * x[3] + x[2] * x[5]);
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
quantity  estimate  unit  distribution  type  divisor       u     ν        c  unit of c  |c| u   share
l_S       50000623  nm    t             B           1      25    18        1  1             25  62.2 %
d              215  nm    t             B           1     9.7  25.6        1  1            9.7   9.4 %
α_S        1.15e-5  1/K   normal        B           1  1.2e-6     ∞        0  nm·K           0   0.0 %
θ             -0.1  K     normal        B           1    0.41     ∞        0  nm/K           0   0.0 %
δα               0  1/K   t             B           1  5.8e-7    50  5000000  nm·K         2.9   0.8 %
δθ               0  K     t             B           1   0.029     2     -575  nm/K        16.7  27.7 %

length = 50000838 nm, u = 32 nm
U = 67 nm (k = 2.12, 95 %, ν_eff = 16.7)
warning: the model is curved; to second order u = 33.9 nm
";
    assert_eq!(gauge_block().to_string(), expected);
}

#[test]
fn gauge_block_to_second_order() {
    let budget = gauge_block();
    let terms = budget.second_order().unwrap();
    close("u_c to second order (nm)", terms.standard_uncertainty, 33.911_149_526_8, RELATIVE);
    assert_eq!(terms.standard_uncertainty.round(), 34.0, "printed: 34 nm");
    assert_eq!(terms.correction, 0.0, "the products have independent factors");
    assert_eq!(budget.linearisation(), Linearisation::UncertaintyDiffers(terms));
    assert_eq!(budget.expanded_to_second_order(0.99).unwrap().degrees_of_freedom, 16.0);
}

/// The inputs before they were put together, with distributions as the guide describes them.
#[test]
fn gauge_block_from_its_original_inputs() {
    use fmm_uq::Distribution;
    let normal = |name, value, u, nu| Input::new(name, value, u, "").unwrap().with_degrees_of_freedom(nu).unwrap();
    let limits = |name: &str, half: f64| Input::of(name, Distribution::rectangular(-half, half).unwrap(), "").unwrap();
    let inputs = Inputs::new([
        normal("l_S", 50_000_623.0, 25.0, 18.0),
        normal("d0", 215.0, 5.8, 24.0),
        normal("d1", 0.0, 3.9, 5.0),
        normal("d2", 0.0, 6.7, 8.0),
        Input::of("α_S", Distribution::rectangular(9.5e-6, 13.5e-6).unwrap(), "").unwrap(),
        normal("θ", -0.1, 0.2, f64::INFINITY),
        Input::of("Δ", Distribution::arc_sine(-0.5, 0.5).unwrap(), "").unwrap(),
        limits("δα", 1e-6).with_degrees_of_freedom(50.0).unwrap(),
        limits("δθ", 0.05).with_degrees_of_freedom(2.0).unwrap(),
    ])
    .unwrap();
    let length = |x: &[Taylor]| x[0] + x[1] + x[2] + x[3] - x[0] * (x[7] * (x[5] + x[6]) + x[4] * x[8]);
    let budget = propagate(&inputs, length).unwrap();
    close("u_c (nm)", budget.standard_uncertainty(), 31.663_879_111, RELATIVE);
    close("ν_eff", budget.effective_degrees_of_freedom().unwrap(), 16.751_855_737_6, 1e-10);
}

/// Five simultaneous readings of V (V), I (A) and φ (rad), Table H.2.
const READINGS: [[f64; 5]; 3] = [
    [5.007, 4.994, 5.005, 4.990, 4.999],
    [0.019_663, 0.019_639, 0.019_640, 0.019_685, 0.019_678],
    [1.0456, 1.0438, 1.0468, 1.0428, 1.0433],
];

fn impedance_inputs() -> Inputs {
    let [v, i, phi] = &READINGS;
    Inputs::from_observations(&[("V", "V", v), ("I", "A", i), ("φ", "rad", phi)]).unwrap()
}

/// H.2, simultaneous resistance and reactance: R, X and Z in Ω.
fn impedance<D: Scalar>(x: &[D]) -> [D; 3] {
    let (sin, cos) = x[2].sin_cos();
    let z = x[0] / x[1];
    [z * cos, z * sin, z]
}

fn results(inputs: &Inputs) -> Propagation {
    Gum::new(inputs).propagate(impedance).unwrap()
}

#[test]
fn impedance_from_correlated_means() {
    let inputs = impedance_inputs();
    for (pair, expected) in
        [(("V", "I"), -0.355_311_219_817), (("V", "φ"), 0.857_624_210_84), (("I", "φ"), -0.645_111_217_689)]
    {
        close("input correlation", inputs.correlation(pair.0, pair.1).unwrap(), expected, 1e-9);
    }
    let propagation = results(&inputs);
    let results = propagation.outputs();
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
    let stepped = Gum::new(&impedance_inputs()).propagate_by_differences(impedance::<f64>).unwrap();
    for (i, j, expected) in [(0, 1, -0.588_429_784_424), (0, 2, -0.485_259_224_21), (1, 2, 0.992_511_648_949)] {
        close("correlation of results", results(&impedance_inputs()).correlation(i, j), expected, 1e-9);
        // A difference over u(I) of a quotient is off by (u/I)², 2e-7; cancellation in R raises that.
        close("correlation of results by differences", stepped.correlation(i, j), expected, 1e-5);
    }
}

#[test]
fn simultaneous_means_have_their_common_degrees_of_freedom() {
    for budget in results(&impedance_inputs()).outputs() {
        close("ν_eff", budget.effective_degrees_of_freedom().unwrap(), 4.0, 1e-10);
    }
}

/// The second approach of H.2.4: the results evaluated for each set of readings, and then averaged.
#[test]
fn impedance_from_each_set_of_readings() {
    let sets: Vec<[f64; 3]> = (0..5).map(|k| impedance(&READINGS.map(|readings| readings[k]))).collect();
    let column = |j: usize| Observations::new(&sets.iter().map(|set| set[j]).collect::<Vec<_>>()).unwrap();
    let expected = [
        (127.731_630_483, 0.071_273_543_178_6),
        (219.846_894_603, 0.295_489_085_61),
        (254.260_049_587, 0.236_247_501_704),
    ];
    for (j, (mean, u)) in expected.into_iter().enumerate() {
        close("mean (Ω)", column(j).mean(), mean, RELATIVE);
        close("u (Ω)", column(j).standard_uncertainty(), u, 1e-9);
    }
    close("r(R, X)", column(0).correlation(&column(1)).unwrap(), -0.588_276_855_797, 1e-9);
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
    let propagation = results(&inputs);
    let [resistance, reactance, impedance] = propagation.outputs() else { panic!("three results") };
    close("u(R) (Ω)", resistance.standard_uncertainty(), 0.069_978_727_988_4, 1e-10);
    close("u(X) (Ω)", reactance.standard_uncertainty(), 0.295_716_826_846, 1e-10);
    close("u(Z) (Ω)", impedance.standard_uncertainty(), 0.236_602_971_835, 1e-10);
}

/// H.3: the correction of a thermometer at 30 °C from a line fitted to eleven, whose parameters are correlated.
#[test]
fn thermometer_calibration() {
    let parameter = |name, value, u| Input::new(name, value, u, "°C").unwrap().with_degrees_of_freedom(9.0).unwrap();
    let inputs = Inputs::new([
        parameter("y1", -0.171_203_790_131, 0.002_877_597_835_16),
        parameter("y2", 0.002_182_697_739_89, 0.000_667_938_773_228),
    ])
    .unwrap()
    .with_correlations(&[("y1", "y2", -0.930_429_603_093)])
    .unwrap()
    .with_ensemble(&["y1", "y2"], 9.0)
    .unwrap();
    let budget = propagate(&inputs, |x| x[0] + x[1] * (30.0 - 20.0)).unwrap();
    // The inputs are given to 12 digits, and cancellation takes one.
    close("b(30) (°C)", budget.estimate(), -0.149_376_812_732, 1e-10);
    close("u (°C)", budget.standard_uncertainty(), 0.004_138_595_752_85, 1e-10);
    close("ν_eff", budget.effective_degrees_of_freedom().unwrap(), 9.0, 1e-12);
}

/// An ensemble that is not all of the uncertainty: its share of the variance counts squared (JCGM 100:2008, G.4.1).
#[test]
fn an_ensemble_counts_by_the_square_of_its_share() {
    let normal = |name: &str| Input::new(name, 1.0, 0.1, "m").unwrap();
    let inputs = Inputs::new([normal("a"), normal("b"), normal("c")]).unwrap().with_ensemble(&["a", "b"], 9.0).unwrap();
    let budget = propagate(&inputs, |x| x[0] + x[1] + x[2]).unwrap();
    // Two thirds of the variance: 9/(2/3)².
    close("ν_eff", budget.effective_degrees_of_freedom().unwrap(), 20.25, 1e-12);
}
