//! Thermal isomerisation of alpha-pinene: five rates from eight samples of five concentrations that follow linear
//! differential equations.

use fmm_fit::{Options, solve};
use fmm_model::Scalar;
use serde_json::Value;

use crate::harness::{Formula, FormulaProblem, digits, number, numbers, parameters};

struct Pinene {
    times: Vec<f64>,
    data: Vec<Vec<f64>>,
}

/// The five concentrations at time `t`, from 100 of the first alone, in closed form.
fn concentrations<D: Scalar>(t: f64, b: &[D]) -> [D; 5] {
    let [b1, b2, b3, b4, b5] = [b[0], b[1], b[2], b[3], b[4]];
    let decay = |rate: D| (-rate * t).exp();
    let one = D::from(1.0);
    let s = b1 + b2;
    // The third and fifth follow the first and two decays of their own, whose rates are the roots of l² − q l + b₃ b₅.
    let third = b2 * 100.0 / (b3 + b4 - s - b5 * b4 / (b5 - s));
    let fifth = b4 * third / (b5 - s);
    let half = (b3 + b4 + b5) * 0.5;
    let root = (half * half - b3 * b5).sqrt();
    let rates = [half + root, half - root];
    let sum = -fifth / b4;
    let first = (-third - sum * (b5 - rates[1])) / (rates[1] - rates[0]);
    let weights = [first, sum - first];
    let own = |rate: usize| weights[rate] * (b5 - rates[rate]);
    [
        decay(s) * 100.0,
        b1 * 100.0 / s * (one - decay(s)),
        third * decay(s) + own(0) * decay(rates[0]) + own(1) * decay(rates[1]),
        b3 * (third * (one - decay(s)) / s
            + own(0) * (one - decay(rates[0])) / rates[0]
            + own(1) * (one - decay(rates[1])) / rates[1]),
        fifth * decay(s) + b4 * (weights[0] * decay(rates[0]) + weights[1] * decay(rates[1])),
    ]
}

impl Formula for Pinene {
    fn residual<D: Scalar>(&self, i: usize, b: &[D]) -> D {
        concentrations(self.times[i / 5], b)[i % 5] - self.data[i / 5][i % 5]
    }
}

#[test]
fn rates_of_alpha_pinene() {
    let file: Value = serde_json::from_str(include_str!("../data/ode_fits.json")).unwrap();
    let oracle = &file["alpha_pinene"];
    for is_exact in [true, false] {
        for start in oracle["starts"].as_array().unwrap() {
            let data = oracle["y"].as_array().unwrap().iter().map(numbers).collect();
            let formula = Pinene { times: numbers(&oracle["t"]), data };
            let not_negative = Value::from(vec![0.0; 5]);
            let parameters = parameters(5, &not_negative, &Value::Null);
            let problem = FormulaProblem { formula, count: 40, parameters, is_exact };
            let fit = solve(&problem, &numbers(start), &Options::default()).unwrap();
            println!("{fit}");
            assert!(fit.outcome().is_success(), "{}", fit.outcome());
            let wanted = if is_exact { 10.0 } else { 8.0 };
            let agreement = digits(fit.values(), &numbers(&oracle["params"]));
            assert!(agreement >= wanted, "{agreement:.1} digits from {start}");
            let uncertainties: Vec<f64> =
                fit.estimates().iter().map(|estimate| estimate.standard_uncertainty().unwrap()).collect();
            assert!(digits(&uncertainties, &numbers(&oracle["sd"])) >= 8.0, "{uncertainties:?}");
            assert!((fit.sum_of_squares() / number(&oracle["sumsq"]) - 1.0).abs() < 1e-12);
        }
    }
}
