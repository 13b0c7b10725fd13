//! Exact derivatives through events, against differences in 256-bit arithmetic.

use fmm_sim::{Engine, Exact, Sampling};

use crate::oracle::{Gradient, INPUTS, number, numbers, read, scenario};

#[test]
fn coulomb_and_viscous() {
    let file = read("sens_coulomb_viscous");
    let tolerance = number(&file["tolerance"]["rel"]);
    let scenario = scenario::<Gradient>(&file["params"]);
    let times = numbers(&file["t"]);
    let motion = Exact.run(&scenario, &Sampling::uniform(1e-3, 1501).unwrap()).unwrap();
    let index = |time: f64| (time * 1e3).round() as usize;

    for (direction, input) in INPUTS.iter().enumerate() {
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
        let events = |of: fn(&fmm_sim::Event<Gradient>) -> Gradient| {
            motion.events().iter().map(|event| fmm_model::Scalar::partial(of(event), direction)).collect::<Vec<_>>()
        };
        agree("dt of event", &events(|event| event.time), &numbers(&expected["dt_event"]));
        agree("dx of event", &events(|event| event.position), &numbers(&expected["dx_event"]));
    }
}
