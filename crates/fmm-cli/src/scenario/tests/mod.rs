//! Scenarios: the bundled scenario files, the reference solutions written as scenarios, and scenarios that should be
//! refused.

use std::path::{Path, PathBuf};

use fmm_friction::{Coulomb, LawFamily, OwnLaw, SpeedFormula};
use serde_json::Value;

mod references;
mod refusals;

use super::{Motion, Plan, Simulation};

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(name)
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn run(scenario: &str) -> Result<Motion, Box<dyn std::error::Error>> {
    Simulation::read(scenario, &[])?.run()
}

/// The document of `--json`.
fn document(scenario: &Value) -> Value {
    let motion = run(&scenario.to_string()).unwrap_or_else(|error| panic!("{scenario}: {error}"));
    serde_json::from_str(&serde_json::to_string(&motion).unwrap()).unwrap()
}

#[test]
fn the_scenario_files_run_and_keep_their_energy() {
    let mut count = 0;
    for entry in std::fs::read_dir(folder("examples/scenarios")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.display();
        let scenario = Simulation::read(&read(&path), &[]).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(!scenario.title.is_empty() && !scenario.description.is_empty(), "{name} does not say what it is");
        let motion = scenario.run().unwrap_or_else(|error| panic!("{name}: {error}"));
        // A coast-down starts and stops.
        let fewest = if scenario.title.contains("vehicle") { 2 } else { 4 };
        assert!(motion.events.len() >= fewest, "{name}: {} events", motion.events.len());
        let work = motion.energy.work.as_ref().expect("all of them record the work");
        let most = |values: &[f64]| values.iter().fold(0.0f64, |most, value| most.max(value.abs()));
        let scale = most(&motion.energy.total) + most(&work.external) + most(&work.friction);
        // Closed forms balance to rounding, integrated motions to the default tolerance of their engine times the
        // number of their steps.
        let relative = match motion.engine {
            "exact" => 1e-12,
            "runge_kutta" => 1e-10,
            _ => 1e-8,
        };
        let off = most(&work.balance);
        assert!(off <= relative * scale, "{name}: {off:e} J of {scale:e} J are not accounted for ({})", motion.engine);
        for event in motion.events.iter().filter(|event| event.kind == "zero_velocity" && motion.samples.z.is_empty()) {
            assert_eq!(event.margin <= 0.0, event.next == "stick", "{name}: margin {} at {} s", event.margin, event.t);
        }
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

/// x = A cn(Ω t), Ω² = ω² (1 + k₃ A²), m = k₃ A² ω²/2Ω²: with k₃ A² = 3 every half period lasts 2 K(3/8)/Ω, Ω = 2 ω.
#[test]
fn a_spring_that_hardens_keeps_its_period() {
    let complete = 1.760_568_811_771_95;
    let motion = run(r#"{"oscillator": {"mass": 2, "stiffness": 50, "restoring": {"polynomial": {"cubic": 12}}},
            "initial": {"position": 0.5}, "duration": 2}"#);
    let motion = motion.unwrap();
    assert!(motion.events.len() > 5, "{} events", motion.events.len());
    for (index, event) in motion.events.iter().enumerate() {
        let expected = index as f64 * 2.0 * complete / 10.0;
        assert!((event.t - expected).abs() < 1e-10, "{} s for {expected} s", event.t);
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
        (r#"{"coulomb": {"μ": 0.1}}"#, vec!["auto", "exact", "runge_kutta", "thesis", "moreau"]),
        (
            r#"{"berger": {"coefficient": 0.1, "MU1": 0.1, "decay": 3}}"#,
            vec!["auto", "runge_kutta", "thesis", "moreau"],
        ),
        (
            r#"{"smoothed": {"law": {"coulomb": {"mu": 0.1}}, "width": 0.01}}"#,
            vec!["auto", "runge_kutta", "thesis", "moreau"],
        ),
        (r#"{"acceleration_coulomb": {"mu1": 0.2, "mu2": 0.1}}"#, vec!["auto", "exact", "runge_kutta", "thesis"]),
        (r#"{"dahl": {"mu": 0.1, "sigma": 1e4}}"#, vec!["auto", "bristle"]),
        (r#"{"maxwell_slip": {"stiffness": [1e4], "level": [0.1]}}"#, vec!["auto", "exact", "bristle"]),
        (
            r#"{"gms": {"mu_c": 0.1, "mu_s": 0.15, "v_s": 0.1, "attraction": 10, "stiffness": [1e4, 2e4], "share": [0.5, 0.5]}}"#,
            vec!["auto", "bristle"],
        ),
    ];
    for (law, possible) in laws {
        for engine in ["auto", "exact", "runge_kutta", "bristle", "thesis", "moreau"] {
            let scenario = with(&format!(
                r#""law": {law}, "initial": {{"velocity": 0.1}}, "duration": 0.5, "output": {{"rate": 1000}}, "engine": "{engine}""#
            ));
            match run(&scenario) {
                Ok(motion) => {
                    assert!(possible.contains(&engine), "{law} by {engine}");
                    assert!(engine == "auto" || engine == motion.engine, "{engine} is {}", motion.engine);
                    let steps = ["thesis", "moreau"].contains(&engine);
                    assert_eq!(motion.energy.work.is_none(), steps, "{law} by {engine}");
                    assert_eq!(motion.samples.z.is_empty(), !possible.contains(&"bristle"), "{law} by {engine}");
                }
                Err(error) => {
                    assert!(!possible.contains(&engine), "{law} by {engine}: {error}");
                    let (said, engines) = (error.to_string(), format!("; its engines are {}", possible.join(", ")));
                    assert!(said.contains("cannot take the law "), "{law} by {engine}: {said}");
                    assert!(said.ends_with(&engines), "{law} by {engine}: {said}");
                }
            }
        }
    }
    let loose = run(&with(
        r#""law": {"berger": {"mu0": 1, "mu1": 1, "alpha": 3}}, "initial": {"velocity": 0.5}, "duration": 1, "engine": "runge_kutta", "tolerance": 1e-4"#,
    ));
    let off = loose.unwrap().energy.work.unwrap().balance.iter().fold(0.0f64, |most, off| most.max(off.abs()));
    assert!(off > 1e-12 && off < 1e-2, "a tolerance of 1e-4 leaves {off:e} J of 1.25 J");
}

/// Coulomb's law as one of one's own.
#[derive(Debug)]
struct Flat;

impl SpeedFormula for Flat {
    fn coefficients(&self, arguments: &[Vec<f64>]) -> Vec<f64> {
        arguments[1].clone()
    }
}

#[test]
fn a_law_of_ones_own_moves_as_the_same_law_of_the_catalogue() {
    let own: &[&'static OwnLaw] =
        &[Box::leak(Box::new(OwnLaw::new("flat", Coulomb::PARAMETERS.to_vec(), Box::new(Flat)).unwrap()))];
    let with = |law: &str| {
        format!(
            r#"{{"oscillator": {{"mass": 2, "stiffness": 800}}, "normal_load": 10, "initial": {{"position": 0.03}},
                "law": {law}, "duration": 1.6}}"#
        )
    };
    let run = |law: &str| Simulation::read(&with(law), own).unwrap().run().unwrap();
    let (flat, coulomb) = (run(r#"{"flat": {"coefficient": 0.2}}"#), run(r#"{"coulomb": {"mu": 0.2}}"#));
    assert_eq!((flat.engine, coulomb.engine), ("runge_kutta", "exact"));
    for (own, listed) in flat.samples.x.iter().zip(&coulomb.samples.x) {
        assert!((own - listed).abs() < 1e-9 * 0.03, "{own} m and {listed} m");
    }
    let smoothed = run(r#"{"smoothed": {"law": {"flat": {"mu": 0.2}}, "smoothing_width": 1e-3}}"#);
    assert!((smoothed.samples.x[100] - coulomb.samples.x[100]).abs() < 1e-4);
    let wrong = |law: &str| Simulation::read(&with(law), own).map(|_| ()).unwrap_err().to_string();
    assert!(wrong(r#"{"flatt": {}}"#).contains("the laws are flat, viscous"));
    assert!(wrong(r#"{"flat": {}}"#).contains("the law flat needs coefficient"));
}

/// The friction that figures draw is that of the law, and of the work.
#[test]
fn friction_along_the_motion_is_that_of_the_law() {
    let scenario = Simulation::read(&read(&folder("examples/scenarios/berger_16mm.json")), &[]).unwrap();
    // 8.604351 N times 0.228 + 0.261 exp(−2.852 · 0.2).
    let force = scenario.friction(-0.2, &[], false);
    assert!((force + 8.604_351 * 0.375_543).abs() < 1e-5, "{force} N");
    assert_eq!((scenario.law, scenario.belt), ("berger", 0.0));
    let level = scenario.run().unwrap().events[1].static_level;
    assert!((level - 8.604_351 * 0.489).abs() < 1e-12, "{level} N");

    let pendulum = Simulation::read(&read(&folder("examples/scenarios/pendulum.json")), &[]).unwrap();
    assert_eq!((scenario.units(), pendulum.units()), (["m", "m/s", "N"], ["rad", "rad/s", "N m"]));

    let scenario = Simulation::read(&read(&folder("examples/scenarios/lugre_ring_down.json")), &[]).unwrap();
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
