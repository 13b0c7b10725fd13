//! The reference solutions, written as scenarios.

use serde_json::{Value, json};

use super::{document, folder, read};

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(0.0)
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(number).collect()
}

fn file(name: &str) -> Value {
    serde_json::from_str(&read(&folder("tests/data/friction").join(name).with_extension("json"))).unwrap()
}

/// A reference solution as a scenario: law, normal load and excitation by their JSON.
fn scenario(file: &Value, law: &Value, normal_load: f64, excitation: &Value) -> Value {
    let parameter = |name: &str| number(&file["params"][name]);
    let linear = parameter("c1") + 2.0 * parameter("zeta") * (parameter("m") * parameter("k")).sqrt();
    let mut scenario = json!({
        "oscillator": {
            "mass": parameter("m"), "stiffness": parameter("k"),
            "damping": {"linear": linear, "quadratic": parameter("c2")}
        },
        "normal_load": normal_load, "excitation": excitation,
        "initial": {"position": parameter("x0"), "velocity": parameter("v0")},
    });
    if !law.is_null() {
        scenario["law"] = law.clone();
    }
    if file["initial"].is_object() {
        scenario["initial"] =
            json!({"position": number(&file["initial"]["x"]), "velocity": number(&file["initial"]["v"])});
    }
    if file["t_end"].is_number() {
        scenario["duration"] = file["t_end"].clone();
    }
    if file["samples"].is_object() {
        scenario["output"] = json!({"times": file["samples"]["t"]});
    }
    scenario
}

fn events_agree(name: &str, file: &Value, got: &Value) {
    let tolerance = &file["tolerance"];
    let [time, position, velocity] = ["abs_t_s", "abs_x_m", "abs_v_m_s"].map(|key| number(&tolerance[key]));
    let (got, expected) = (got["events"].as_array().unwrap(), file["events"].as_array().unwrap());
    assert_eq!(got.len(), expected.len(), "{name}: number of events");
    for (index, (got, expected)) in got.iter().zip(expected).enumerate() {
        // The last reversals of a creeping contact, below 1e-12 m, have a tolerance of their own.
        let time = if index < 10 { time } else { time.max(number(&tolerance["last_events_abs_t_s"])) };
        for (key, most, unit) in [("t", time, "s"), ("x", position, "m"), ("v", velocity, "m/s")] {
            let off = number(&got[key]) - number(&expected[key]);
            assert!(off.abs() <= most, "{name}: {key} of event {index} {got} is {off:e} {unit} off");
        }
        assert_eq!(got["kind"], expected["kind"], "{name}: event {index} {got}");
        let next = &expected["next_mode"];
        let (phase, next) = match next.as_array().map(Vec::as_slice) {
            // Direction and the elements that slide.
            Some([direction, Value::Array(_)]) => (&Value::Null, direction),
            Some([phase, direction]) => (phase, direction),
            Some([stick]) => (&Value::Null, stick),
            _ => (&Value::Null, next),
        };
        assert_eq!((&got["next"], &got["phase"]), (next, phase), "{name}: event {index} {got}");
    }
}

fn samples_agree(name: &str, file: &Value, got: &Value) {
    let tolerance = &file["tolerance"];
    let [position, velocity] = [["abs_x_m", "abs_x"], ["abs_v_m_s", "abs_v"]]
        .map(|keys| keys.map(|key| number(&tolerance[key])).into_iter().sum::<f64>());
    let expected = &file["samples"];
    let agree = |got: &Value, key: &str, most: &dyn Fn(f64) -> f64| {
        let (got, expected) = (numbers(got), numbers(&expected[key]));
        assert_eq!(got.len(), expected.len(), "{name}: samples of {key}");
        for (index, (got, expected)) in got.iter().zip(&expected).enumerate() {
            let off = got - expected;
            assert!(off.abs() <= most(*expected), "{name}: {key} {got} of sample {index} is {off:e} off");
        }
    };
    agree(&got["samples"]["t"], "t", &|_| 0.0);
    agree(&got["samples"]["x"], "x", &|_| position);
    agree(&got["samples"]["v"], "v", &|_| velocity);
    for (state, key) in ["z", "z0", "z1", "z2", "z3"].iter().enumerate().filter(|(_, key)| expected[**key].is_array()) {
        agree(&got["samples"]["z"][state.saturating_sub(1)], key, &|_| position);
    }
    // Powers are integrated along the same motion, whose forces are below 20 N.
    let energy = |expected: f64| 20.0 * velocity * (1.0 + expected.abs());
    for (key, name) in [("friction", "W_friction"), ("viscous", "W_viscous"), ("external", "W_external")] {
        if expected[name].is_array() {
            agree(&got["energy"][key], name, &energy);
        }
    }
}

/// The reference solution of this name, by the default engine, through the document.
fn agrees(name: &str, law: impl Fn(&Value) -> Value, normal_load: &str, excitation: impl Fn(&Value) -> Value) {
    let file = file(name);
    let parameters = &file["params"];
    let load = if normal_load.is_empty() { 1.0 } else { number(&parameters[normal_load]) };
    let got = document(&scenario(&file, &law(parameters), load, &excitation(parameters)));
    if file["events"].is_array() {
        events_agree(name, &file, &got);
    }
    samples_agree(name, &file, &got);
}

fn nothing(_: &Value) -> Value {
    json!([])
}

#[test]
fn references_of_constant_levels() {
    let force = |p: &Value| json!({"coulomb": {"F": p["F"]}});
    agrees("coulomb_free_decay", force, "", nothing);
    agrees("coulomb_viscous_free_decay_mc", |p| json!({"coulomb": {"mu": p["mu"]}}), "N", nothing);
    agrees(
        "accel_hysteretic_free_decay",
        |p| json!({"acceleration_coulomb": {"mu1": p["mu1"], "mu2": p["mu2"]}}),
        "N",
        nothing,
    );
    let blow = |p: &Value| json!([{"half_sine": {"peak": p["P"], "duration": p["T_pulse"]}}]);
    agrees("impact_half_sine_low", |p| json!({"coulomb": {"mu": p["F"]}}), "", blow);
    agrees("impact_half_sine_medium", force, "", blow);
    let levels = |sliding: &'static str| move |p: &Value| json!({"coulomb_static": {"sliding_coefficient": p[sliding], "mu_s": p["Fs"]}});
    agrees("breakaway_ramp", levels("Fd"), "", |p| json!([{"ramp": {"rate": p["ramp_rate"]}}]));
    agrees("belt_static_kinetic", levels("Fk"), "", |p| json!([{"belt": {"velocity": p["vb"]}}]));
    let wave = |p: &Value| {
        let phase = number(&p["phi"]);
        json!([{"harmonic": {"amplitude": p["P"], "angular_frequency": p["Omega"], "phase": phase}}])
    };
    for name in ["forced_stick_slip_r03", "forced_stick_slip_r05", "forced_non_stop"] {
        agrees(name, force, "", wave);
    }
    let elements = |p: &Value| json!({"maxwell_slip": {"stiffness": p["k_i"], "level": p["W_i"]}});
    agrees("maxwell_slip_free_decay", elements, "", nothing);
}

#[test]
fn references_that_depend_on_the_speed() {
    let berger = |p: &Value| json!({"berger": {"mu0": p["mu0"], "mu1": p["mu1"], "alpha": p["alpha"]}});
    agrees("berger_free_decay_16mm", berger, "N", nothing);
    let stribeck =
        |p: &Value| json!({"stribeck": {"Fc": p["Fc"], "Fs": p["Fs"], "vs": p["vs"], "delta": 2, "F2": p["F2"]}});
    agrees("stribeck_gauss_free_decay", stribeck, "", nothing);
    agrees("quadratic_drag_free_decay", |_| Value::Null, "", nothing);
    let gamma = |p: &Value| {
        let gamma = |index: usize| p["gamma"][index].clone();
        json!({"gamma1": gamma(0), "gamma2": gamma(1), "gamma3": gamma(2), "gamma4": gamma(3), "gamma5": gamma(4)})
    };
    agrees("makkar_dixon_raw_free_decay", |p| json!({"makkar_dixon": gamma(p)}), "N", nothing);
    agrees("makkar_dixon_shifted_free_decay", |p| json!({"makkar_dixon_shifted": gamma(p)}), "N", nothing);
}

#[test]
fn references_with_bristles() {
    let dahl = |p: &Value| json!({"dahl": {"coefficient": p["Fc"], "sigma": p["sigma0"]}});
    agrees("dahl_free_decay", dahl, "", nothing);
    let lugre = |p: &Value| {
        let delta = p["delta"].as_f64().unwrap_or(2.0);
        json!({"lugre": {
            "Fc": p["Fc"], "Fs": p["Fs"], "vs": p["vs"], "delta": delta,
            "sigma0": p["sigma0"], "sigma1": p["sigma1"], "sigma2": p["sigma2"]
        }})
    };
    agrees("lugre_free_decay", lugre, "", nothing);
    let pull = |p: &Value| json!([{"ramp": {"rate": number(&p["k"]) * number(&p["v_pull"])}}]);
    agrees("lugre_pulled_block", lugre, "", pull);
}

#[test]
fn turning_points_of_the_power_law() {
    let file = file("power_law_free_decay");
    let p = &file["params"];
    let mut scenario =
        scenario(&file, &json!({"power_law": {"a": p["a"], "p": p["p"], "b": p["b"]}}), number(&p["N"]), &json!([]));
    scenario["duration"] = json!(1.1);
    let got = document(&scenario);
    let turns = file["turning_points"].as_array().unwrap();
    assert!(got["events"].as_array().unwrap().len() > turns.len());
    for (event, turn) in got["events"].as_array().unwrap()[1..].iter().zip(turns) {
        let off = [number(&event["t"]) - number(&turn["t"]), number(&event["x"]) - number(&turn["x"])];
        let most = ["abs_t_s", "abs_x_m"].map(|key| number(&file["tolerance"][key]));
        assert!(off[0].abs() <= most[0] && off[1].abs() <= most[1], "{event} is {off:?} (s, m) off");
    }
}

#[test]
fn ties_are_exact() {
    let file = file("coulomb_ties");
    for case in file["cases"].as_array().unwrap() {
        let mut scenario = scenario(case, &json!({"coulomb": {"mu": case["params"]["F"]}}), 1.0, &json!([]));
        scenario["duration"] = json!(1);
        let got = document(&scenario);
        let events = got["events"].as_array().unwrap();
        let stop = events.last().unwrap();
        assert_eq!(number(&stop["x"]), number(&case["x_stop"]), "{}", case["label"]);
        assert_eq!(stop["next"], "stick", "{}", case["label"]);
        assert_eq!(events.len() - 1, number(&case["n_half_swings"]) as usize, "{}", case["label"]);
    }
}

/// A load whose peak passes the static level by a nanonewton breaks away, and one that stays below it does not,
/// whatever the samples.
#[test]
fn a_nanonewton_decides() {
    for (peak, kinds) in [(2.5 + 1e-9, vec!["start", "breakaway+", "zero_velocity"]), (2.5 - 1e-9, vec!["start"])] {
        let got = document(&json!({
            "oscillator": {"mass": 10.391, "stiffness": 1982, "damping": {"linear": 0.275}},
            "law": {"coulomb_static": {"mu_d": 1.75, "mu_s": 2.5}},
            "excitation": [{"half_sine": {"peak": peak, "duration": 2.0}}],
            "duration": 3, "output": {"times": [0, 2.9]}
        }));
        let got: Vec<&str> =
            got["events"].as_array().unwrap().iter().filter_map(|event| event["kind"].as_str()).collect();
        assert_eq!(got[..got.len().min(3)], kinds, "a peak of {peak} N");
    }
}
