//! The example `simulate`: its scenario files, the reference solutions written as scenarios, and scenarios that should be
//! refused.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

#[path = "../../examples/simulate/mod.rs"]
mod simulation;

use simulation::{CATALOGUE, Motion, Plan, ScenarioError, Simulation};

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn run(scenario: &str) -> Result<Motion, ScenarioError> {
    Simulation::read(scenario)?.run()
}

/// The document of `--json`.
fn document(scenario: &Value) -> Value {
    let motion = run(&scenario.to_string()).unwrap_or_else(|error| panic!("{scenario}: {error}"));
    serde_json::from_str(&serde_json::to_string(&motion).unwrap()).unwrap()
}

fn refused(scenario: &str) -> String {
    run(scenario).expect_err(scenario).to_string()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(0.0)
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(number).collect()
}

#[test]
fn the_scenario_files_run_and_keep_their_energy() {
    let mut count = 0;
    for entry in std::fs::read_dir(folder("examples/scenarios")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.display();
        let scenario = Simulation::read(&read(&path)).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(!scenario.title().is_empty() && !scenario.description().is_empty(), "{name} does not say what it is");
        let motion = scenario.run().unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(motion.events.len() > 3, "{name}: {} events", motion.events.len());
        let work = motion.energy.work.as_ref().expect("all of them record the work");
        let most = |values: &[f64]| values.iter().fold(0.0f64, |most, value| most.max(value.abs()));
        let scale = most(&motion.energy.total) + most(&work.external) + most(&work.friction);
        // Closed forms balance to rounding, integrated motions to the default tolerance of their engine times the number of
        // their steps.
        let relative = match motion.engine {
            "exact" => 1e-12,
            "runge_kutta" => 1e-10,
            _ => 1e-8,
        };
        let off = most(&work.balance);
        assert!(off <= relative * scale, "{name}: {off:e} J of {scale:e} J are not accounted for ({})", motion.engine);
        // Sampled elsewhere, the motion is the same.
        let end = motion.samples.t[motion.samples.t.len() - 1];
        let sparse = scenario.run_at(&Plan::at(vec![0.0, end], end).unwrap()).unwrap();
        assert_eq!(sparse.events.len(), motion.events.len(), "{name}");
        for (one, other) in sparse.events.iter().zip(&motion.events) {
            assert!((one.t - other.t).abs() <= 1e-12 * end, "{name}: {} s and {} s", one.t, other.t);
        }
        count += 1;
    }
    assert!(count >= 10, "{count} scenarios");
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
    let file: Value = serde_json::from_str(&read(&folder("tests/data/friction").join(format!("{name}.json")))).unwrap();
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
    let file: Value = serde_json::from_str(&read(&folder("tests/data/friction/power_law_free_decay.json"))).unwrap();
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
    let file: Value = serde_json::from_str(&read(&folder("tests/data/friction/coulomb_ties.json"))).unwrap();
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

/// A load whose peak passes the static level by a nanonewton breaks away, and one that stays below it does not, whatever the
/// samples.
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

const MACHINE: &str = r#""oscillator": {"mass": 10, "stiffness": 2000}"#;

fn with(rest: &str) -> String {
    format!("{{{MACHINE}, {rest}}}")
}

#[test]
fn what_is_left_out_has_its_default() {
    let short = run(&with(r#""initial": {"velocity": 0.1}, "duration": 0.5"#)).unwrap();
    assert_eq!((short.engine, short.samples.t.len(), short.samples.t[0]), ("exact", 1000, 0.0));
    assert!((short.samples.t[999] - 0.5).abs() < 1e-15, "{} s", short.samples.t[999]);
    // Without friction the energy stays; 0.05 J in rounding steps of a few swings.
    assert!((short.energy.total[999] - 0.05).abs() < 1e-15, "{} J", short.energy.total[999]);

    // The end is the last time; a rate counts its duration in.
    let one = run(&with(r#""output": {"times": [0.25, 0.25, 0.75]}"#)).unwrap();
    assert_eq!(one.samples.t, [0.25, 0.25, 0.75]);
    let rate = run(&with(r#""duration": 0.3, "output": {"rate": 10}"#)).unwrap();
    assert_eq!(rate.samples.t.len(), 4);
    assert!((rate.samples.t[3] - 0.3).abs() < 1e-15);
    // Events between the last sample and the end count, those beyond do not.
    let law = r#""law": {"coulomb": {"mu": 0.1}}, "initial": {"velocity": 0.1}"#;
    let half = std::f64::consts::PI / 200f64.sqrt();
    for (duration, events) in [(0.4 * half, 1), (0.5 * half, 2), (1.4 * half, 2), (1.5 * half, 3)] {
        for output in [r#"{"rate": 7}"#, r#"{"times": [0]}"#] {
            let motion = run(&with(&format!(r#"{law}, "duration": {duration}, "output": {output}"#))).unwrap();
            assert_eq!(motion.events.len(), events, "{duration} s, {output}");
        }
    }
}

#[test]
fn damping_and_restoring_force_are_what_they_say() {
    let run = |machine: &str| {
        run(&format!(r#"{{"oscillator": {{"mass": 1, "stiffness": 100, {machine}}}, "initial": {{"position": 0.5}}, "duration": 2}}"#)).unwrap()
    };
    let same = |one: &Motion, other: &Motion| {
        // Two Runge-Kutta runs at 1e-13 of the amplitude per step, some hundred steps.
        one.samples.x.iter().zip(&other.samples.x).all(|(one, other)| (one - other).abs() < 1e-10)
    };
    let line = run(r#""damping": {"peak_velocity_line": {"intercept": 0.2005, "slope": 0.437}}"#);
    let slope = 3.0 * std::f64::consts::PI / 8.0 * 0.437;
    assert!(same(&line, &run(&format!(r#""damping": {{"linear": 0.2005, "quadratic": {slope}}}"#))));
    let power = |exponent| run(&format!(r#""damping": {{"power": {{"coefficient": 0.3, "exponent": {exponent}}}}}"#));
    assert!(same(&power(3), &run(r#""damping": {"cubic": 0.3}"#)));
    assert!(same(&power(2), &run(r#""damping": {"quadratic": 0.3}"#)));
    assert!(!same(&power(2), &run(r#""damping": {"quadratic": 0.31}"#)));
    // A pendulum of 0.5 rad is slower than its small swings by about 0.5²/16 = 1.6 %.
    let swing = |motion: &Motion| motion.events[1].t * 10.0 / std::f64::consts::PI;
    assert!((swing(&run(r#""restoring": "linear""#)) - 1.0).abs() < 1e-12);
    let pendulum = swing(&run(r#""restoring": {"sine": {"length": 1.0}}"#));
    assert!((pendulum - 1.0157).abs() < 1e-3, "{pendulum}");
}

#[test]
fn every_engine_answers_its_laws_and_refuses_the_others() {
    let laws = [
        (r#"{"coulomb": {"μ": 0.1}}"#, vec!["auto", "exact", "runge_kutta", "thesis"]),
        (r#"{"berger": {"coefficient": 0.1, "MU1": 0.1, "decay": 3}}"#, vec!["auto", "runge_kutta", "thesis"]),
        (r#"{"smoothed": {"law": {"coulomb": {"mu": 0.1}}, "width": 0.01}}"#, vec!["auto", "runge_kutta", "thesis"]),
        (r#"{"dahl": {"mu": 0.1, "sigma": 1e4}}"#, vec!["auto", "bristle"]),
        (r#"{"maxwell_slip": {"stiffness": [1e4], "level": [0.1]}}"#, vec!["auto", "exact", "bristle"]),
        (
            r#"{"gms": {"mu_c": 0.1, "mu_s": 0.15, "v_s": 0.1, "attraction": 10, "stiffness": [1e4, 2e4], "share": [0.5, 0.5]}}"#,
            vec!["auto", "bristle"],
        ),
    ];
    for (law, possible) in laws {
        for engine in ["auto", "exact", "runge_kutta", "bristle", "thesis"] {
            let scenario = with(&format!(
                r#""law": {law}, "initial": {{"velocity": 0.1}}, "duration": 0.5, "output": {{"rate": 1000}}, "engine": "{engine}""#
            ));
            match run(&scenario) {
                Ok(motion) => {
                    assert!(possible.contains(&engine), "{law} by {engine}");
                    assert!(engine == "auto" || engine == motion.engine, "{engine} is {}", motion.engine);
                    assert_eq!(motion.energy.work.is_some(), engine != "thesis", "{law} by {engine}");
                    assert_eq!(motion.samples.z.is_empty(), !possible.contains(&"bristle"), "{law} by {engine}");
                }
                Err(ScenarioError::Engine { possible: said, .. }) => {
                    assert!(!possible.contains(&engine), "{law} by {engine}");
                    assert_eq!(said, possible.join(", "), "{law} by {engine}");
                }
                Err(error) => panic!("{law} by {engine}: {error}"),
            }
        }
    }
    let said = refused(&with(r#""duration": 1, "engine": "euler""#));
    assert!(said.contains("unknown variant `euler`") && said.contains("`runge_kutta`"), "{said}");
    let said = refused(&with(r#""duration": 1, "engine": "exact", "tolerance": 1e-9"#));
    assert!(said.contains("runge_kutta and bristle"), "{said}");
    let loose = run(&with(
        r#""law": {"berger": {"mu0": 1, "mu1": 1, "alpha": 3}}, "initial": {"velocity": 0.5}, "duration": 1, "engine": "runge_kutta", "tolerance": 1e-4"#,
    ));
    let off = loose.unwrap().energy.work.unwrap().balance.iter().fold(0.0f64, |most, off| most.max(off.abs()));
    assert!(off > 1e-12 && off < 1e-2, "a tolerance of 1e-4 leaves {off:e} J of 1.25 J");
}

#[test]
fn no_key_means_two_parameters() {
    for entry in CATALOGUE {
        let slots = (entry.slots)();
        for (index, slot) in slots.iter().enumerate() {
            assert!(
                slot.is(slot.name) && slot.is(slot.symbol) || slot.symbol.is_empty(),
                "{} {}",
                entry.name,
                slot.name
            );
            for key in slot.keys() {
                assert!(key.is_ascii(), "{}: {key}", entry.name);
                let others = slots[index + 1..].iter().filter(|other| other.is(&key)).count();
                assert_eq!(others, 0, "{}: {key} is {} and another", entry.name, slot.name);
            }
        }
    }
    let keys = ["coefficient", "excess_coefficient", "decay"].map(String::from);
    let berger = CATALOGUE.iter().find(|entry| entry.name == "berger").unwrap();
    for (slot, (name, symbol)) in (berger.slots)().iter().zip(keys.iter().zip(["mu0", "mu1", "alpha"])) {
        assert!(slot.keys().contains(name) && slot.is(symbol), "{name}");
    }
}

/// A value for each law, one parameter being left out or misspelt.
#[test]
fn every_law_says_what_it_needs() {
    for entry in CATALOGUE {
        let name = entry.name;
        let said = refused(&with(&format!(r#""law": {{"{name}": {{"nonsense": 1}}}}, "duration": 1"#)));
        assert!(said.contains("no parameter \"nonsense\""), "{said}");
        for slot in (entry.slots)() {
            assert!(said.contains(slot.name), "{name}: {said}");
        }
        let said = refused(&with(&format!(r#""law": {{"{name}": {{}}}}, "duration": 1"#)));
        let first = (entry.slots)().into_iter().find(|slot| slot.default.is_none()).unwrap();
        assert!(said.contains(&format!("needs {}", first.description())), "{name}: {said}");
    }
}

#[test]
fn unknown_names_are_answered_with_the_valid_ones() {
    let said = refused(&with(r#""law": {"colomb": {"mu": 0.1}}, "duration": 1"#));
    assert!(said.contains("no law \"colomb\""), "{said}");
    for entry in CATALOGUE {
        assert!(said.contains(entry.name), "{said}");
    }
    for (scenario, wrong, valid) in [
        (
            with(r#""friction": 1, "duration": 1"#),
            "`friction`",
            vec!["`law`", "`normal_load`", "`excitation`", "`output`"],
        ),
        (with(r#""duration": 1, "initial": {"x": 1}"#), "`x`", vec!["`position`", "`velocity`"]),
        (
            with(r#""duration": 1, "excitation": [{"hammer": {}}]"#),
            "`hammer`",
            vec!["`half_sine`", "`sampled_force`", "`belt`"],
        ),
        (
            with(r#""duration": 1, "excitation": [{"ramp": {"rate": 1, "peak": 1}}]"#),
            "`peak`",
            vec!["`rate`", "`delay`"],
        ),
        (with(r#""duration": 1, "output": {"every": 1}"#), "`every`", vec!["`times`", "`rate`"]),
        (
            r#"{"oscillator": {"mass": 1, "k": 1}, "duration": 1}"#.to_owned(),
            "`k`",
            vec!["`mass`", "`stiffness`", "`damping`", "`restoring`"],
        ),
        (
            r#"{"oscillator": {"mass": 1, "stiffness": 1, "damping": {"viscous": 1}}, "duration": 1}"#.to_owned(),
            "`viscous`",
            vec!["`linear`", "`quadratic`", "`cubic`", "`power`", "`peak_velocity_line`"],
        ),
    ] {
        let said = refused(&scenario);
        assert!(said.contains(wrong), "{said}");
        for name in valid {
            assert!(said.contains(name), "{name}: {said}");
        }
    }
}

#[test]
fn wrong_values_are_answered_with_what_would_be_right() {
    let law = |law: &str| with(&format!(r#""law": {law}, "duration": 1"#));
    for (scenario, said) in [
        ("mass = 1".to_owned(), "cannot be read"),
        (String::new(), "cannot be read"),
        (with(r#""duration": 1e999"#), "number out of range"),
        (with(r#""duration": NaN"#), "cannot be read"),
        (with(r#""duration": 1, "duration": 2"#), "duplicate field `duration`"),
        (with(""), "cannot be read"),
        (r#"{"oscillator": {"mass": 1, "stiffness": 1}}"#.to_owned(), "needs a duration"),
        (r#"{"oscillator": {"mass": 1}, "duration": 1}"#.to_owned(), "missing field `stiffness`"),
        (r#"{"oscillator": {"mass": -1, "stiffness": 1}, "duration": 1}"#.to_owned(), "mass must be positive and finite, but is -1 kg"),
        (r#"{"oscillator": {"mass": 1, "stiffness": 1, "damping": {"linear": 1, "peak_velocity_line": {"intercept": 1, "slope": 1}}}, "duration": 1}"#.to_owned(), "not by both ways"),
        (r#"{"oscillator": {"mass": 1, "stiffness": 1, "restoring": {"sine": {"length": 0}}}, "duration": 1}"#.to_owned(), "must be positive"),
        (with(r#""duration": 0"#), "duration must be positive"),
        (with(r#""duration": -1, "output": {"times": [0]}"#), "duration must be positive"),
        (with(r#""normal_load": -1, "duration": 1"#), "normal load must be zero or positive"),
        (with(r#""output": {"times": []}"#), "at least 1"),
        (with(r#""duration": 1, "output": {"times": []}"#), "at least 1"),
        (with(r#""output": {"times": [0, 2, 1]}"#), "time 2 is 1 s after 2 s"),
        (with(r#""output": {"times": [-1, 2]}"#), "time 0 is -1 s"),
        (with(r#""duration": 1, "output": {"rate": 0}"#), "rate of the output must be positive"),
        (with(r#""duration": 1, "output": {"rate": 1e8}"#), "100000001 samples were asked for"),
        (with(r#""duration": 1e300, "output": {"rate": 1e300}"#), "samples were asked for"),
        (with(r#""duration": 1, "excitation": [{"half_sine": {"peak": 1, "duration": 0}}]"#), "pulse duration must be positive"),
        (with(r#""duration": 1, "excitation": [{"half_sine": {"peak": 1}}]"#), "missing field `duration`"),
        (law("{}"), "an object with one key"),
        (law("[1]"), "an object with one key"),
        (law(r#"{"coulomb": 0.1}"#), "an object with one key"),
        (law(r#"{"coulomb": {"mu": 0.1}, "viscous": {"viscous": 1}}"#), "an object with one key"),
        (law(r#"{"coulomb": {"mu": "high"}}"#), "expected a number"),
        (law(r#"{"coulomb": {"mu": 0.1, "mu": 0.2}}"#), "duplicate field `mu`"),
        (law(r#"{"coulomb": {"mu": 0.1, "coefficient": 0.2}}"#), "coefficient twice"),
        (law(r#"{"coulomb": {"mu": -0.1}}"#), "coulomb: coefficient must lie in [0, inf]"),
        (law(r#"{"coulomb": {"mu": [0.1]}}"#), "must be a number"),
        (law(r#"{"coulomb_static": {"mu_d": 0.2, "mu_s": 0.1}}"#), "must not be below"),
        (law(r#"{"maxwell_slip": {"stiffness": 1, "level": [1]}}"#), "must be a list of numbers"),
        (law(r#"{"maxwell_slip": {"stiffness": [1, 2], "level": [1]}}"#), "2 stiffnesses and 1 others"),
        (law(r#"{"maxwell_slip": {"stiffness": [], "level": []}}"#), "1 to 64"),
        (law(r#"{"smoothed": {"law": {"coulomb": {}}, "width": 1}}"#), "coulomb needs coefficient"),
        (law(r#"{"smoothed": {"law": 1, "width": 1}}"#), "must be a law"),
        (law(r#"{"smoothed": {"law": {"dahl": {"mu": 1, "sigma": 1}}, "width": 1}}"#), "cannot be smoothed"),
        (law(r#"{"smoothed": {"law": {"acceleration_coulomb": {"mu1": 1, "mu2": 1}}, "width": 1}}"#), "depends on the acceleration"),
    ] {
        let message = refused(&scenario);
        assert!(message.contains(said), "{scenario} gave: {message}");
    }
    let deep = format!("{}{}", r#"{"smoothed": {"law": "#.repeat(100_000), "1");
    assert!(refused(&law(&deep)).contains("recursion limit"));
}

/// The friction that figures draw is that of the law, and of the work.
#[test]
fn friction_along_the_motion_is_that_of_the_law() {
    let scenario = Simulation::read(&read(&folder("examples/scenarios/berger_16mm.json"))).unwrap();
    // 8.604351 N times 0.228 + 0.261 exp(−2.852 · 0.2).
    let force = scenario.friction(-0.2, &[], false);
    assert!((force + 8.604_351 * 0.375_543).abs() < 1e-5, "{force} N");
    assert_eq!((scenario.law(), scenario.belt()), ("berger", 0.0));

    let scenario = Simulation::read(&read(&folder("examples/scenarios/lugre_ring_down.json"))).unwrap();
    let motion = scenario.run().unwrap();
    let (samples, work) = (&motion.samples, motion.energy.work.unwrap());
    let power = |index: usize| scenario.friction(samples.v[index], &[samples.z[0][index]], false) * samples.v[index];
    for index in 20..60 {
        let (step, gained) =
            (samples.t[index + 1] - samples.t[index - 1], work.friction[index + 1] - work.friction[index - 1]);
        // Simpson's rule over two samples of 1 ms; its error falls with the fifth power of the step.
        let simpson = (power(index - 1) + 4.0 * power(index) + power(index + 1)) / 6.0 * step;
        assert!((simpson / gained - 1.0).abs() < 1e-5, "{simpson} J against {gained} J at {} s", samples.t[index]);
    }
}
