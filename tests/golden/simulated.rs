//! Findings out of simulated experiments, by the library.
//!
//! All calls of the crates stand here, so that a renamed function touches one file.

use std::f64::consts::PI;

use fmm_fit::{Options, solve};
use fmm_friction::{Berger, Coulomb, CoulombStatic, CoulombViscous, LawFamily};
use fmm_identify::{Candidate, Drive, Experiment, ImpactTrial, Inquiry, Known, Machine, Preparation, Sensor, Terms};
use fmm_model::{Damping, Oscillator};
use fmm_record::{Quantity, Record};
use fmm_sim::{Channels, Exact, Excitation, Sampling, Scenario, Trajectory, simulate_into};
use fmm_thesis::table_3::{Sensitivities, exact_rows, problem};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use serde_json::{Value, json};

const MASS: f64 = 10.391;
const STIFFNESS: f64 = 1982.0;
const LOAD: f64 = 14.0;

fn motion<F: LawFamily>(
    law: &[f64],
    damping: f64,
    load: f64,
    release: f64,
    force: Option<&[f64]>,
    interval: f64,
    samples: usize,
) -> Trajectory {
    let machine = Oscillator::new(MASS, STIFFNESS).unwrap().with_damping(Damping::linear(damping).unwrap());
    let scenario = Scenario::new(machine, F::at(law).unwrap(), load).unwrap().starting_at(release, 0.0).unwrap();
    let scenario = match force {
        Some(force) => scenario.driven_by(Excitation::sampled_force(interval, force).unwrap()),
        None => scenario,
    };
    let mut trajectory = Trajectory::new();
    let sampling = Sampling::uniform(interval, samples).unwrap().keeping(Channels::All);
    simulate_into::<F, _>(&scenario, &sampling, None, &mut trajectory).unwrap();
    trajectory
}

fn record(values: &[f64], noise: f64, seed: u64, quantity: Quantity, unit: &str, interval: f64) -> Record {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
    let values = values.iter().map(|value| value + noise * draw()).collect();
    Record::new(0.0, interval, values, quantity, unit).unwrap()
}

fn machine() -> Machine {
    let machine = Machine::of_mass(Known::new(MASS, 0.0049).unwrap()).unwrap();
    machine.with_normal_load(Known::new(LOAD, 0.07).unwrap()).unwrap()
}

/// A finding document of law `F`.
fn found<F: LawFamily>(machine: &Machine, terms: &Terms, experiments: &[Experiment]) -> Value {
    serde_json::to_value(
        Inquiry::of(machine, experiments).candidate(&Candidate::of::<F>().with(terms.clone())).unwrap(),
    )
    .unwrap()
}

/// Ring-downs, driven motions and a blow by one law each, by themselves and together.
pub(crate) fn experiments() -> Vec<(String, Value)> {
    const INTERVAL: f64 = 1e-3;
    let preparation = Preparation::default();
    let ring_down = |values: &[f64], noise, seed, quantity, unit| {
        Experiment::ring_down(&record(values, noise, seed, quantity, unit, INTERVAL), &preparation).unwrap()
    };
    let viscous = [0.25, 0.0196];
    let release = motion::<CoulombViscous>(&viscous, 0.0, LOAD, 0.015, None, INTERVAL, 1500);
    let velocity = ring_down(release.velocity().values(), 1e-3, 1, Quantity::Velocity, "m/s");
    let acceleration = ring_down(release.acceleration().values(), 0.02, 2, Quantity::Acceleration, "m/s²");
    let displacement = ring_down(release.position().values(), 5e-6, 3, Quantity::Displacement, "m");
    let filtered = velocity.clone().seen_by(Sensor::default().with_free_low_pass(1).unwrap()).unwrap();

    let berger = [0.228, 0.261, 2.852];
    let berger = |load: f64, seed| {
        let motion = motion::<Berger>(&berger, 0.275, load, 0.016, None, INTERVAL, 2000);
        let decay = ring_down(motion.velocity().values(), 1e-4, seed, Quantity::Velocity, "m/s");
        decay.with_load_factor(load / LOAD).unwrap()
    };

    let angular = 0.9 * (STIFFNESS / MASS).sqrt();
    let drive = |amplitude: f64, samples: usize| -> Vec<f64> {
        (0..samples).map(|i| MASS * amplitude * angular.powi(2) * (angular * i as f64 * INTERVAL).cos()).collect()
    };
    let driven = |force: &[f64]| motion::<CoulombViscous>(&[0.25, 0.1], 0.0, LOAD, 0.0, Some(force), INTERVAL, 3000);
    let force = drive(8e-3, 3000);
    let by_force = Drive::force(&record(&force, 0.0, 0, Quantity::Force, "N", INTERVAL)).unwrap();
    let response = record(driven(&force).velocity().values(), 1e-3, 7, Quantity::Velocity, "m/s", INTERVAL);
    let by_force = Experiment::driven(&response, by_force.with_gain_uncertainty(0.01).unwrap(), &preparation).unwrap();
    let force = drive(2.6e-3, 3000);
    let base: Vec<f64> = force.iter().map(|force| -force / MASS).collect();
    let by_base = Drive::base(&record(&base, 0.0, 0, Quantity::Acceleration, "m/s²", INTERVAL)).unwrap();
    let response = record(driven(&force).velocity().values(), 1e-3, 8, Quantity::Velocity, "m/s", INTERVAL);
    let by_base = Experiment::driven(&response, by_base, &preparation).unwrap();

    let levels = [0.25, 0.32];
    let statics = |load: f64, release: f64, force: Option<&[f64]>| {
        motion::<CoulombStatic>(&levels, 0.8, load, release, force, INTERVAL, 2000)
    };
    let ramp: Vec<f64> = (0..2000).map(|i| 7.0 * f64::from(i) / 2000.0).collect();
    let lifted = statics(0.0, 0.022, None);
    let lifted = ring_down(lifted.velocity().values(), 1e-3, 4, Quantity::Velocity, "m/s").without_contact();
    let sliding = ring_down(statics(LOAD, 0.022, None).velocity().values(), 1e-3, 5, Quantity::Velocity, "m/s");
    let pushed = statics(LOAD, 0.0, Some(&ramp));
    let pushed = record(pushed.position().values(), 5e-6, 6, Quantity::Displacement, "m", INTERVAL);
    let ramp = Drive::force(&record(&ramp, 0.0, 0, Quantity::Force, "N", INTERVAL)).unwrap();
    let pushed = Experiment::driven(&pushed, ramp, &preparation).unwrap();

    let blow = Experiment::impact(&trial([0.98, 34e-4], 10_000, 1e-4, 11)).unwrap();
    let plain = Terms::default();
    let damped = Terms::default().with_linear_damping();
    let both = |machine: &Machine, experiment: &Experiment| {
        found::<CoulombViscous>(machine, &plain, std::slice::from_ref(experiment))
    };
    [
        ("velocity", both(&machine(), &velocity)),
        ("velocity per unit mass", both(&Machine::per_unit_mass(), &velocity)),
        ("acceleration", both(&machine(), &acceleration)),
        ("displacement", both(&machine(), &displacement)),
        ("low pass", both(&machine(), &filtered)),
        ("berger", found::<Berger>(&machine(), &damped, &[berger(LOAD, 9)])),
        ("berger under two loads", found::<Berger>(&machine(), &damped, &[berger(LOAD, 9), berger(0.5 * LOAD, 10)])),
        ("driven by a force", both(&Machine::unknown(), &by_force)),
        ("driven by a base", both(&machine(), &by_base)),
        ("lifted, sliding and pushed", found::<CoulombStatic>(&machine(), &damped, &[lifted, sliding, pushed])),
        ("blow as an experiment", found::<Coulomb>(&machine(), &damped, &[blow])),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into()
}

/// A blow of this impulse (N s) and duration (s) on the machine of the thesis under 6.67 N.
fn trial([impulse, duration]: [f64; 2], samples: usize, interval: f64, seed: u64) -> ImpactTrial {
    const BEFORE: usize = 100;
    let intervals = (duration / interval).round();
    let peak = impulse / interval * (0.5 * PI / intervals).tan();
    let at = |i: usize| if i < BEFORE { 0.0 } else { peak * (PI * (i - BEFORE) as f64 / intervals).sin() };
    let mut force: Vec<f64> = (0..=BEFORE + intervals as usize).map(at).collect();
    let machine = Oscillator::new(MASS, STIFFNESS).unwrap().with_damping(Damping::linear(0.275).unwrap());
    let scenario = Scenario::new(machine, Coulomb::new(0.113).unwrap(), 6.67).unwrap();
    let scenario = scenario.driven_by(Excitation::sampled_force(interval, force.clone()).unwrap());
    let sampling = Sampling::uniform(interval, samples).unwrap().keeping(Channels::Velocity);
    let mut trajectory = Trajectory::new();
    simulate_into::<Coulomb, _>(&scenario, &sampling, None, &mut trajectory).unwrap();
    force.resize(samples, 0.0);
    let force = record(&force, 0.5, 2 * seed + 1, Quantity::Force, "N", interval);
    let velocity = record(trajectory.velocity().values(), 2e-4, 2 * seed, Quantity::Velocity, "m/s", interval);
    ImpactTrial::prepare(&force, &velocity).unwrap()
}

/// Impacts of chapter 8 by their mobility and by their motion.
pub(crate) fn impacts() -> Vec<(String, Value)> {
    let levels = [[0.98, 34e-4], [1.42, 22e-4], [1.64, 18e-4]];
    let trials: Vec<ImpactTrial> =
        levels.into_iter().zip(21..).map(|(level, seed)| trial(level, 200_000, 1e-4, seed)).collect();
    let known = |value, u| Known::new(value, u).unwrap();
    let without_damping = |u: [f64; 4]| {
        let machine = Machine::of_mass_and_stiffness(known(MASS, u[0]), known(STIFFNESS, u[1])).unwrap();
        machine.with_normal_load(known(6.67, u[3])).unwrap()
    };
    let machine = |u: [f64; 4]| without_damping(u).with_damping(known(0.275, u[2])).unwrap();
    let exact = machine([0.0; 4]);
    let uncertain = machine([0.0049, 1.3, 0.0341, 0.01]);
    let mobilities = |trials: &[ImpactTrial]| -> Vec<Experiment> {
        trials.iter().map(|trial| Experiment::mobility(trial, Some((1.0, 4.0))).unwrap()).collect()
    };
    let motions = |trials: &[ImpactTrial]| -> Vec<Experiment> {
        trials.iter().map(|trial| Experiment::impact(trial).unwrap()).collect()
    };
    let (plain, damped) = (Terms::default(), Terms::default().with_linear_damping());
    let by =
        |machine: &Machine, terms: &Terms, experiments: &[Experiment]| found::<Coulomb>(machine, terms, experiments);
    let calibrated = [trials[0].clone().with_calibration_uncertainty(0.02).unwrap()];
    [
        ("mobility, low", by(&exact, &plain, &mobilities(&trials[..1]))),
        ("mobility, medium", by(&exact, &plain, &mobilities(&trials[1..2]))),
        ("mobility, high", by(&exact, &plain, &mobilities(&trials[2..]))),
        ("mobility, all, damping free", by(&without_damping([0.0; 4]), &damped, &mobilities(&trials))),
        ("mobility, uncertain machine and hammer", by(&uncertain, &plain, &mobilities(&calibrated))),
        ("time, medium", by(&exact, &plain, &motions(&trials[1..2]))),
        ("time, uncertain machine and hammer", by(&uncertain, &plain, &motions(&calibrated))),
        ("time, medium, viscous as well", found::<CoulombViscous>(&exact, &plain, &motions(&trials[1..2]))),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into()
}

/// Table 3 of the thesis by derivatives and by a few refits.
pub(crate) fn table_3() -> Vec<(String, Value)> {
    let problem = problem(&Exact).unwrap();
    let fit = solve(&problem, problem.values(), &Options::default()).unwrap();
    let sensitivities = Sensitivities::of(&problem, &fit).unwrap();
    let rows = exact_rows(&problem, &fit, 1000, 1, &|_| {}).unwrap();
    let row = |row: &fmm_thesis::table_3::Row| {
        let (mu, u) = (row.sample.estimate(0).unwrap(), row.sample.standard_uncertainty(0).unwrap());
        json!({ "row": row.name, "mu": mu, "u": u })
    };
    let of = |budget: fmm_uq::Budget| budget.standard_uncertainty();
    let derivatives = json!({
        "machine": sensitivities.machine,
        "load": sensitivities.load,
        "u": sensitivities.uncertainties().unwrap(),
        "u_correlated": of(sensitivities.correlated_budget().unwrap()),
        "u_extended": of(sensitivities.extended_budget(0.01, 0.002).unwrap()),
    });
    vec![("derivatives".to_owned(), derivatives), ("refits".to_owned(), rows.iter().map(row).collect())]
}
