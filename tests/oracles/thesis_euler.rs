//! The thesis' integrator, literally, and how it converges to the exact motion.

use fmm_friction::{Berger, Coulomb, MakkarDixon, SlidingLaw};
use fmm_model::{Damping, Oscillator};
use fmm_sim::{Engine, Exact, Sampling, Scenario, Thesis};

use serde_json::Value;

use crate::oracle::{number, numbers, read, scenario};

#[test]
fn reproduces_the_appendix() {
    let file = read("thesis_euler");
    let tolerance = (number(&file["tolerance"]["rel"]), number(&file["tolerance"]["abs_v"]));
    let mut cases = 0;
    for case in file["references"].as_array().unwrap() {
        let params = &case["params"];
        let parameter = |name: &str| number(&params[name]);
        match case["kind"].as_str().unwrap() {
            "coulomb" => agrees(case, Thesis::A3, Coulomb::new(parameter("mu")).unwrap(), tolerance),
            "berger" => {
                let law = Berger::new(parameter("mu0"), parameter("mu1"), parameter("alpha")).unwrap();
                agrees(case, Thesis::A3, law, tolerance);
            }
            "tanh" => {
                let [g1, g2, g3, g4, g5] = numbers(&params["gamma"])[..] else { panic!("five parameters") };
                agrees(case, Thesis::A6, MakkarDixon::five(g1, g2, g3, g4, g5).unwrap(), tolerance);
            }
            other => panic!("unknown kind {other}"),
        }
        cases += 1;
    }
    assert_eq!(cases, 4, "cases in the file");
}

fn agrees<L: SlidingLaw<f64>>(case: &Value, engine: Thesis, law: L, (relative, absolute): (f64, f64)) {
    let (code, params) = (case["code"].as_str().unwrap(), &case["params"]);
    let linear = number(&params["c"]) + number(&params["c1"]);
    let damping = Damping::new(linear, number(&params["A"]) + number(&params["c2"])).unwrap();
    let machine = Oscillator::new(number(&params["m"]), number(&params["k"])).unwrap().with_damping(damping);
    let scenario = Scenario::new(machine, law, number(&params["N"]))
        .and_then(|scenario| scenario.starting_at(number(&case["x0"]), number(&case["v0"])))
        .unwrap();
    let steps = number(&case["steps"]) as usize;
    let motion = engine.run(&scenario, &Sampling::uniform(number(&case["dt"]), steps + 1).unwrap()).unwrap();
    let velocity = motion.velocity().values();

    let every = number(&case["every"]) as usize;
    for (i, expected) in numbers(&case["v"]).iter().enumerate() {
        let error = (velocity[i * every] - expected).abs();
        assert!(error <= absolute + relative * expected.abs(), "{code}: sample {} is {error:e} m/s off", i * every);
    }
    let (sum, sum_of_squares) = (velocity.iter().sum::<f64>(), velocity.iter().map(|v| v * v).sum::<f64>());
    assert!((sum / number(&case["sum_v"]) - 1.0).abs() < 1e-10, "{code}: sum of the velocities {sum}");
    assert!((sum_of_squares / number(&case["sum_v2"]) - 1.0).abs() < 1e-11, "{code}: {sum_of_squares}");
    let first_zero = velocity.iter().position(|v| *v == 0.0);
    assert_eq!(first_zero, case["first_zero_index"].as_u64().map(|index| index as usize), "{code}: first zero");
    let stop = first_zero.map(|index| velocity_time(index, number(&case["dt"])));
    assert_eq!(motion.rest().map(|rest| rest.time), stop, "{code}: stop");
}

fn velocity_time(index: usize, interval: f64) -> f64 {
    index as f64 * interval
}

/// First order, with the very errors that the reference lists; 2 % covers the samples at which it was compared.
#[test]
fn converges_with_first_order() {
    let file = read("thesis_euler");
    let scenario = scenario::<f64>(&read("coulomb_viscous_free_decay_mc")["params"]);
    let mut errors = Vec::new();
    for row in file["convergence_to_exact"]["rows"].as_array().unwrap() {
        let step = number(&row["dt"]);
        let stride = (1e-3 / step).round() as usize;
        let sampling = Sampling::uniform(step, 1500 * stride + 1).unwrap();
        let exact = Exact.run(&scenario, &Sampling::uniform(1e-3, 1501).unwrap()).unwrap();
        let euler = Thesis::A3.run(&scenario, &sampling).unwrap();
        let error = (0..=1500)
            .map(|i| (euler.velocity().values()[i * stride] - exact.velocity().values()[i]).abs())
            .fold(0.0, f64::max);
        assert!((error / number(&row["max_abs_v_err"]) - 1.0).abs() < 0.02, "step {step} s: error {error:e} m/s");
        errors.push((step, error));
    }
    let (first, last) = (errors[0], errors[errors.len() - 1]);
    let order = (first.1 / last.1).log2() / (first.0 / last.0).log2();
    assert!((order - 1.0).abs() < 0.02, "observed order {order}");
}
