//! Sums of squares with many minima.

use fmm_fit::{EvaluationError, MultiStart, Options, Residuals, solve};
use fmm_model::{Bounds, Parameter};
use serde_json::Value;

use crate::harness::{number, numbers};

/// A mass on a spring with Coulomb friction, as the thesis integrates it: semi-implicit Euler at 1 ms, a stop being
/// looked for in the step after a change of sign. The sum of squares jumps wherever that step changes.
struct StickSlip {
    velocity: Vec<f64>,
    parameters: Vec<Parameter>,
}

const STEP: f64 = 1e-3;
const MASS: f64 = 10.391;
const STIFFNESS: f64 = 1982.0;
const DAMPING: f64 = 0.275;
const LOAD: f64 = 14.0;
const INITIAL_VELOCITY: f64 = 0.196;

impl Residuals for StickSlip {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn len(&self) -> usize {
        self.velocity.len()
    }
    /// In mm/s.
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        let friction = p[0] * LOAD;
        let (mut x, mut v, mut before) = (p[1], INITIAL_VELOCITY, 1.0);
        for (r, velocity) in residuals.iter_mut().zip(&self.velocity) {
            *r = (velocity - v) * 1e3;
            let is_sliding = v * before > 0.0;
            before = v;
            if !is_sliding && x.abs() < friction / STIFFNESS {
                v = 0.0;
                continue;
            }
            let sign = if is_sliding { v.signum() } else { (-x).signum() };
            v += (-sign * friction - DAMPING * v - STIFFNESS * x) / MASS * STEP;
            x += v * STEP;
        }
        Ok(())
    }
}

fn stick_slip() -> Vec<(StickSlip, Value)> {
    let file: Value = serde_json::from_str(include_str!("../data/stick_slip_landscape.json")).unwrap();
    let friction = Parameter::new("friction", "μ", "1").bounded(Bounds::new(0.0, 1.0).unwrap());
    let position = Parameter::new("position", "x₀", "m").bounded(Bounds::new(-2e-3, 2e-3).unwrap());
    let case = |case: &Value| {
        let velocity = numbers(&case["data_m_per_s"]);
        (StickSlip { velocity, parameters: vec![friction.clone(), position.clone()] }, case["best"].clone())
    };
    file["cases"].as_array().unwrap().iter().map(case).collect()
}

/// The best known minima were the lowest of 325 fits each, from all over the place.
#[test]
fn stick_slip_records_are_fitted_at_their_best_minimum() {
    let (mut alone, mut together) = (0, 0);
    for (record, (problem, best)) in stick_slip().into_iter().enumerate() {
        let known = number(&best["sumsq_mm2_s2"]);
        for (seed, start) in [[0.2, 0.0], [0.4, 1e-3], [0.1, -1e-3], [0.25, 1e-4]].into_iter().enumerate() {
            let single = solve(&problem, &start, &Options::default()).unwrap();
            let search = MultiStart::around(problem.parameters(), &start, 255, seed as u64);
            let lowest = search.solve(&problem).unwrap();
            println!(
                "record {record} from {start:?}: one start {:.4}, many {:.6} ({known:.6}) at {:?}",
                single.sum_of_squares(),
                lowest.sum_of_squares(),
                lowest.values(),
            );
            alone += usize::from(single.sum_of_squares() < known * (1.0 + 1e-9));
            together += usize::from(lowest.sum_of_squares() < known * (1.0 + 1e-9));
        }
    }
    println!("best minimum from {alone} of 12 single starts, {together} of 12 with many");
    assert_eq!(together, 12);
}
