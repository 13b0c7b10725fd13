//! Exact derivatives through events, against differences in 256-bit arithmetic.

use fmm_friction::Berger;
use fmm_model::{Damping, Dual, Oscillator, Scalar};
use fmm_sim::{Engine, Event, Exact, RungeKutta, Sampling, Scenario, Trajectory};
use serde_json::Value;

use crate::oracle::{Gradient, INPUTS, number, numbers, read, scenario};

/// Compares all derivatives of a motion, `inputs` naming the directions, with those of the file.
fn agrees<D: Scalar>(file: &Value, inputs: &[&str], motion: &Trajectory<D>) {
    let tolerance = number(&file["tolerance"]["rel"]);
    let times = numbers(&file["t"]);
    let index = |time: f64| (time * 1e3).round() as usize;
    for (direction, input) in inputs.iter().enumerate() {
        let expected = &file["sensitivities"][input];
        let agree = |what: &str, got: &[f64], expected: &[f64]| {
            assert_eq!(got.len(), expected.len(), "number of {what} in {input}");
            // The files give derivatives of either size; relative means relative to the largest of a column.
            let scale = expected.iter().fold(0.0f64, |scale, value| scale.max(value.abs()));
            for (i, (got, expected)) in got.iter().zip(expected).enumerate() {
                let error = (got - expected).abs() / scale.max(f64::MIN_POSITIVE);
                assert!(error <= tolerance, "{what} {i} in {input}: {got:e} against {expected:e}");
            }
        };
        let sampled = |column: Option<&[f64]>| times.iter().map(|t| column.unwrap()[index(*t)]).collect::<Vec<_>>();
        agree("dx", &sampled(motion.position().partial(direction)), &numbers(&expected["dx"]));
        agree("dv", &sampled(motion.velocity().partial(direction)), &numbers(&expected["dv"]));
        let events = |of: fn(&Event<D>) -> D| {
            motion.events().iter().map(|event| of(event).partial(direction)).collect::<Vec<_>>()
        };
        agree("dt of event", &events(|event| event.time), &numbers(&expected["dt_event"]));
        agree("dx of event", &events(|event| event.position), &numbers(&expected["dx_event"]));
    }
}

#[test]
fn coulomb_and_viscous() {
    let file = read("sens_coulomb_viscous");
    let scenario = scenario::<Gradient>(&file["params"]);
    let sampling = Sampling::uniform(1e-3, 1501).unwrap();
    agrees(&file, &INPUTS, &Exact.run(&scenario, &sampling).unwrap());
    agrees(&file, &INPUTS, &RungeKutta::default().run(&scenario, &sampling).unwrap());
}

#[test]
fn berger() {
    const INPUTS: [&str; 9] = ["m", "k", "c1", "c2", "mu0", "mu1", "alpha", "x0", "v0"];
    let file = read("sens_berger");
    let input = |direction: usize| Dual::<9>::variable(number(&file["params"][INPUTS[direction]]), direction);
    let damping = Damping::new(input(2), input(3)).unwrap();
    let machine = Oscillator::new(input(0), input(1)).unwrap().with_damping(damping);
    let law = Berger::new(input(4), input(5), input(6)).unwrap();
    let scenario = Scenario::new(machine, law, Dual::from(number(&file["params"]["N"]))).unwrap();
    let scenario = scenario.starting_at(input(7), input(8)).unwrap();
    let motion = RungeKutta::default().run(&scenario, &Sampling::uniform(1e-3, 1501).unwrap()).unwrap();
    agrees(&file, &INPUTS, &motion);
}
