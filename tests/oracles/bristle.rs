//! Laws with internal state: decays event by event, stick-slip of a pulled block, breakaway, hysteresis loops.

use fmm_friction::{BoucWen, BristleLaw, Dahl, LuGre, MaxwellSlip, Regime};
use fmm_model::{Damping, Dual, Oscillator, Scalar};
use fmm_sim::{Bristle, Engine, EventKind, Excitation, PrescribedMotion, Sampling, Scenario, friction_along};
use serde_json::Value;

use crate::oracle::{number, numbers, read};

/// The motions are smooth but for their events, so that the method is far better than what the files ask of any method.
const MARGIN: f64 = 0.1;

fn machine(params: &Value) -> Oscillator {
    let damping = Damping::new(number(&params["c1"]), number(&params["c2"])).unwrap();
    Oscillator::new(number(&params["m"]), number(&params["k"])).unwrap().with_damping(damping)
}

fn lugre(params: &Value, exponent: f64) -> LuGre {
    let value = |name: &str| number(&params[name]);
    let [sliding, breakaway, fall_speed] = ["Fc", "Fs", "vs"].map(value);
    let [stiffness, damping, viscous] = ["sigma0", "sigma1", "sigma2"].map(value);
    LuGre::new(sliding, breakaway, fall_speed, exponent, stiffness, damping, viscous).unwrap()
}

/// Compares a free decay under `law` with the file: events, samples, deflections and works.
fn decays<L: BristleLaw<f64>>(file: &Value, law: L, [time, position, velocity]: [f64; 3]) {
    let start = &file["initial"];
    let scenario = Scenario::new(machine(&file["params"]), law, 1.0)
        .unwrap()
        .starting_at(number(&start["x"]), number(&start["v"]))
        .unwrap();
    let samples = &file["samples"];
    let times = numbers(&samples["t"]);
    let motion = Bristle::default().run(&scenario, &Sampling::at(times.clone()).unwrap().with_work()).unwrap();

    let expected = file["events"].as_array().unwrap();
    assert_eq!(motion.events().len(), expected.len());
    for (event, expected) in motion.events().iter().zip(expected) {
        let off = (event.time - number(&expected["t"]), event.position - number(&expected["x"]));
        assert!(off.0.abs() <= time, "{:?} at {} s is {:e} s off", event.kind, event.time, off.0);
        assert!(off.1.abs() <= position, "{:?} at {} s is {:e} m off", event.kind, event.time, off.1);
        let kind = match event.kind {
            EventKind::Start => "start".to_owned(),
            EventKind::Yield(element) => format!("yield{element}"),
            _ => "zero_velocity".to_owned(),
        };
        assert_eq!(kind, expected["kind"].as_str().unwrap(), "at {} s", event.time);
    }
    let deflections = (0..motion.states().len()).map(|state| (format!("z{state}"), motion.states()[state].values()));
    let plain = |(name, values): (String, _)| (if samples[&name].is_null() { "z".to_owned() } else { name }, values);
    let mut columns: Vec<(String, &[f64], f64)> =
        deflections.map(plain).map(|(name, values)| (name, values, position)).collect();
    columns.push(("x".to_owned(), motion.position().values(), position));
    columns.push(("v".to_owned(), motion.velocity().values(), velocity));
    let works: Vec<_> = (0..times.len()).map(|index| motion.work(index).unwrap()).collect();
    let friction: Vec<f64> = works.iter().map(|work| work.friction).collect();
    let viscous: Vec<f64> = works.iter().map(|work| work.viscous).collect();
    // Forces of up to 20 N.
    columns.push(("W_friction".to_owned(), &friction, 20.0 * position));
    columns.push(("W_viscous".to_owned(), &viscous, 20.0 * position));
    for (name, got, tolerance) in columns {
        for ((at, got), expected) in times.iter().zip(got).zip(numbers(&samples[&name])) {
            let off = got - expected;
            assert!(off.abs() <= tolerance, "{name} at {at} s is off by {off:e}");
        }
    }
}

fn tolerances(file: &Value) -> [f64; 3] {
    ["abs_t_s", "abs_x_m", "abs_v_m_s"].map(|name| MARGIN * number(&file["tolerance"][name]))
}

#[test]
fn dahl() {
    let file = read("dahl_free_decay");
    let params = &file["params"];
    decays(&file, Dahl::new(number(&params["Fc"]), number(&params["sigma0"]), 1.0).unwrap(), tolerances(&file));
}

#[test]
fn lugre_with_a_falling_level() {
    let file = read("lugre_free_decay");
    decays(&file, lugre(&file["params"], 1.0), tolerances(&file));
}

/// The file's own tolerances are for closed forms; times are good to what the engine promises of them.
#[test]
fn maxwell_slip() {
    let file = read("maxwell_slip_free_decay");
    decays(&file, elements(&file["params"]), [1e-11, 1e-12, 1e-11]);
}

fn elements(params: &Value) -> MaxwellSlip {
    let elements: Vec<_> = numbers(&params["k_i"]).into_iter().zip(numbers(&params["W_i"])).collect();
    MaxwellSlip::new(&elements).unwrap()
}

/// A spring whose other end moves at constant velocity is the same as a force that grows at constant rate.
#[test]
fn pulled_block() {
    let file = read("lugre_pulled_block");
    let (params, samples) = (&file["params"], &file["samples"]);
    let pull = number(&params["k"]) * number(&params["v_pull"]);
    let scenario = Scenario::new(machine(params), lugre(params, 2.0), 1.0).unwrap();
    let scenario = scenario.driven_by(Excitation::ramp(pull).unwrap());
    let times = numbers(&samples["t"]);
    let motion = Bristle::default().run(&scenario, &Sampling::at(times.clone()).unwrap()).unwrap();
    for (name, got, key) in [("x", motion.position(), "abs_x"), ("v", motion.velocity(), "abs_v")] {
        let tolerance = 1e-2 * number(&file["tolerance"][key]);
        for ((at, got), expected) in times.iter().zip(got.values()).zip(numbers(&samples[name])) {
            let off = got - expected;
            assert!(off.abs() <= tolerance, "{name} at {at} s is off by {off:e}");
        }
    }
    let onsets = numbers(&file["slip_onset_v_0p05"]);
    let motion = Bristle::default().run(&scenario, &Sampling::at(onsets.clone()).unwrap()).unwrap();
    for (at, v) in onsets.iter().zip(motion.velocity().values()) {
        // An acceleration below 1 m/s².
        assert!((v - 0.05).abs() <= 1e-2 * number(&file["tolerance"]["abs_t"]), "{v} m/s at {at} s");
    }
}

/// The faster the force grows, the less breakaway needs.
#[test]
fn breakaway_depends_on_the_rate() {
    let file = read("lugre_breakaway_rate");
    let params = &file["params"];
    let relative = number(&file["tolerance"]["rel"]);
    let law = lugre(params, 2.0);
    let machine = Oscillator::new(number(&params["m"]), 0.0).unwrap();
    for row in file["rows"].as_array().unwrap() {
        let rate = number(&row["rate_N_s"]);
        let scenario = Scenario::new(machine, law, 1.0).unwrap().driven_by(Excitation::ramp(rate).unwrap());
        let times = [number(&row["t_max_friction"]), number(&row["t_at_v_0p01"])];
        let motion = Bristle::default().run(&scenario, &Sampling::at(times).unwrap()).unwrap();
        let (v, z) = (motion.velocity().values(), motion.states()[0].values());
        let agree = |what: &str, got: f64, expected: f64| {
            assert!((got / expected - 1.0).abs() < relative, "{rate} N/s: {what} is {got}, not {expected}");
        };
        agree("velocity", v[1], 0.01);
        agree("deflection", z[1], number(&row["z"]));
        let mut z_rate = [0.0];
        law.rate(v[0], &z[..1], Regime::ALL_HOLD, &mut z_rate);
        agree("friction", law.coefficient(v[0], &z[..1], &z_rate), number(&row["max_friction_force"]));
    }
}

/// Compares forces or states along the path of `entry` with its points.
fn loops<L: BristleLaw<f64>>(law: &L, entry: &Value) {
    let points = entry["points"].as_array().unwrap();
    let mut path = vec![0.0];
    path.extend(points.iter().map(|point| number(&point["x"])));
    for speed in [1e-5, 1.0, 1e3] {
        let got = friction_along(law, 1.0, &PrescribedMotion::at_speed(&path, speed).unwrap()).unwrap();
        assert_eq!((got.len(), got[0].force, got[0].position), (path.len(), 0.0, 0.0));
        for (got, point) in got[1..].iter().zip(points) {
            let (got, expected, absolute) = if point["F"].is_null() {
                (got.states[0], &point["z"], 1e-17)
            } else {
                (got.force, &point["F"], 1e-13)
            };
            let expected = number(expected);
            let off = (got - expected).abs();
            assert!(off <= 1e-12 * expected.abs() + absolute, "{got} instead of {expected} at {point}, {speed} m/s");
        }
    }
}

#[test]
fn quasi_static_loops() {
    let file = read("quasi_static_loops");
    let laws = &file["laws"];
    let value = |law: &str, name: &str| number(&laws[law]["params"][name]);
    loops(&Dahl::new(value("dahl", "Fc"), value("dahl", "sigma0"), 1.0).unwrap(), &laws["dahl"]);
    for name in ["bouc_wen_n1", "bouc_wen_n2"] {
        let [amplitude, beta, gamma, exponent] = ["A", "beta", "gamma", "n"].map(|parameter| value(name, parameter));
        loops(&BoucWen::new(1.0, amplitude, beta, gamma, exponent).unwrap(), &laws[name]);
    }
    loops(&elements(&laws["maxwell_slip"]["params"]), &laws["maxwell_slip"]);
}

#[test]
fn lugre_at_constant_velocity() {
    let file = read("quasi_static_loops");
    let entry = &file["laws"]["lugre_constant_velocity"];
    let law = lugre(&entry["params"], 2.0);
    for point in entry["points"].as_array().unwrap() {
        let [v, t, z, force] = ["v", "t", "z", "F"].map(|name| number(&point[name]));
        let got = friction_along(&law, 1.0, &PrescribedMotion::at_speed(&[0.0, v * t], v).unwrap()).unwrap();
        let off = ((got[1].states[0] / z - 1.0).abs(), (got[1].force / force - 1.0).abs());
        assert!(off.0 < 1e-12 && off.1 < 1e-12, "{v} m/s after {t} s: {:e} and {:e}", off.0, off.1);
    }
}

/// F = F_c (1 − exp(−σ x/F_c)) on the way out; on the way back over half of it, 1 + F/F_c falls by exp(−σ x/2F_c).
#[test]
fn loops_have_derivatives_in_the_path_and_the_law() {
    let [level, stiffness, reach] = [1.75, 1e5, 2e-5];
    let number = |value, direction| Dual::<3>::variable(value, direction);
    let law = Dahl::new(number(level, 0), number(stiffness, 1), Dual::from(1.0)).unwrap();
    let far = number(reach, 2);
    let path = PrescribedMotion::at_speed(&[Dual::from(0.0), far, far * 0.5], Dual::from(0.3)).unwrap();
    let points = friction_along(&law, Dual::from(1.0), &path).unwrap();
    let force = |level: Dual<3>, stiffness: Dual<3>, x: Dual<3>| {
        let out = level * (Dual::from(1.0) - (-(stiffness * x / level)).exp());
        (out, level * ((-(stiffness * x / level * 0.5)).exp() * (out / level + 1.0) - 1.0))
    };
    let (out, back) = force(number(level, 0), number(stiffness, 1), far);
    for (got, expected) in [(points[1].force, out), (points[2].force, back)] {
        for direction in 0..3 {
            let error = got.partial(direction) / expected.partial(direction) - 1.0;
            assert!(error.abs() < 1e-11, "direction {direction}: {got:?} instead of {expected:?}");
        }
    }
}
