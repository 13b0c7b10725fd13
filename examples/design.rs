//! Predicted uncertainties of designs beside the scatter of simulated refits and friction curves:
//! `cargo run --release --example design -- [--refits 1000] [--curves 200]`.
//!
//! Every refit is one of records with fresh noise, begun at the truth, by the joint problem of the library; every curve
//! is of such records too. What it showed is in docs/study.md. The time that a plan takes for each candidate is printed
//! as well.

use std::error::Error;
use std::f64::consts::TAU;
use std::time::Instant;

use clap::Parser;
use fmm_fit::{Options, Residuals, solve};
use fmm_friction::{Berger, CoulombViscous, LawFamily, SlidingLaw, Stribeck};
use fmm_identify::design::{DesignPrediction, Guess, Plan, PlannedSensor, PlannedTest};
use fmm_identify::{Candidate, Experiment, FrictionCurve, Known, Machine, Preparation, Problem};
use fmm_model::Oscillator;
use fmm_record::{Quantity, Record};
use fmm_sim::{Sampling, Scenario, Trajectory, simulate_into};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};

/// Predicted uncertainties beside the scatter of refits.
#[derive(Debug, Parser)]
#[command(name = "design")]
struct Arguments {
    /// Refits of each design
    #[arg(long, default_value_t = 1000)]
    refits: u64,
    /// Friction curves of each design
    #[arg(long, default_value_t = 200)]
    curves: u64,
}

const MASS: f64 = 10.391;
const STIFFNESS: f64 = 1982.0;
/// The load of the machine (N), of which those of tests are multiples.
const LOAD: f64 = 14.0;
/// White noise (m/s), samples a second, and samples.
const NOISE: f64 = 1e-4;
const RATE: f64 = 1000.0;
const SAMPLES: usize = 2000;

/// A release (m) under a load (N).
type Test = (f64, f64);

fn planned((release, load): Test) -> Result<PlannedTest, Box<dyn Error>> {
    let sensor = PlannedSensor::new(Quantity::Velocity, NOISE)?;
    let test = PlannedTest::release(release, sensor, RATE, SAMPLES as f64 / RATE)?;
    Ok(test.under_load(Known::exact(load)?)?.named(format!("{release} m, {load} N")))
}

fn machine() -> Result<Machine, Box<dyn Error>> {
    Ok(Machine::of_mass(Known::exact(MASS)?)?.with_normal_load(Known::exact(LOAD)?)?)
}

/// The velocity of a test without noise.
fn motion<F: LawFamily>(law: &[f64], (release, load): Test) -> Result<Vec<f64>, Box<dyn Error>> {
    let scenario = Scenario::new(Oscillator::new(MASS, STIFFNESS)?, F::at(law)?, load)?.starting_at(release, 0.0)?;
    let mut trajectory = Trajectory::new();
    simulate_into::<F, _>(&scenario, &Sampling::uniform(1.0 / RATE, SAMPLES)?, None, &mut trajectory)?;
    Ok(trajectory.velocity().values().to_vec())
}

/// Standard deviation of the friction per mass over refits, and how many of them ended well.
fn scatter<F: LawFamily>(law: &[f64], tests: &[Test], refits: u64) -> Result<(f64, usize), Box<dyn Error>> {
    let clean = tests.iter().map(|test| motion::<F>(law, *test)).collect::<Result<Vec<_>, _>>()?;
    let normal = Normal::new(0.0, NOISE)?;
    let mut found = Vec::new();
    for seed in 0..refits {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut decays = Vec::with_capacity(tests.len());
        for (values, (_, load)) in clean.iter().zip(tests) {
            let values = values.iter().map(|value| value + normal.sample(&mut random)).collect();
            let record = Record::sampled(RATE, values, Quantity::Velocity, "m/s")?;
            decays.push(Experiment::ring_down(&record, &Preparation::default())?.with_load_factor(load / LOAD)?);
        }
        let problem = Problem::of(&Candidate::of::<F>(), machine()?, &decays)?;
        // Frequency and law, then what belongs to each record.
        let mut start = vec![(STIFFNESS / MASS).sqrt() / TAU];
        let force = LOAD / MASS;
        start.extend(F::PARAMETERS.iter().zip(law).map(|(parameter, value)| match parameter.role() {
            fmm_friction::Role::Shape => *value,
            _ => value * force,
        }));
        let mut releases = tests.iter().map(|(release, _)| *release);
        for parameter in &problem.parameters()[start.len()..] {
            // A record in which a hum was seen by chance has parameters of that as well.
            let is_position = parameter.name().starts_with("initial_position");
            start.push(if is_position { releases.next().unwrap_or(0.0) } else { 0.0 });
        }
        let fit = solve(&problem, &start, &Options::default())?;
        if fit.outcome().is_success() {
            found.push(fit.values()[1]);
        }
    }
    let count = found.len() as f64;
    let mean = found.iter().sum::<f64>() / count;
    Ok(((found.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt(), found.len()))
}

fn predicted<F: LawFamily>(law: &[f64], tests: &[Test]) -> Result<DesignPrediction, Box<dyn Error>> {
    let frequency = (STIFFNESS / MASS).sqrt() / TAU;
    let guess = Guess::new(machine()?, &Candidate::of::<F>(), frequency, law, &[])?;
    let candidates = tests.iter().map(|test| planned(*test)).collect::<Result<Vec<_>, _>>()?;
    let plan = Plan::new(guess, candidates)?;
    Ok(plan.predict(&(0..tests.len()).collect::<Vec<_>>())?)
}

fn report<F: LawFamily>(name: &str, law: &[f64], tests: &[Test], refits: u64) -> Result<(), Box<dyn Error>> {
    let prediction = predicted::<F>(law, tests)?;
    let finding = prediction.finding("friction_per_mass").ok_or("the law has a level")?;
    let u = finding.uncertainty().ok_or("the tests determine it")?;
    let (scatter, ended) = scatter::<F>(law, tests, refits)?;
    let ratio = scatter / u;
    println!(
        "{name:<44} {:>9.4} % {:>9.4} % {ratio:>8.4} {ended:>6}",
        100.0 * u / finding.value(),
        100.0 * scatter / finding.value()
    );
    Ok(())
}

/// Releases (m) of the plan of friction curves, and speeds (m/s) at which friction is asked for.
const RELEASES: [f64; 2] = [0.012, 0.022];
const SPEEDS: [f64; 4] = [0.0, 0.002, 0.02, 0.1];

/// Predicted and found uncertainties of friction at some speeds, without a law, by each test and by both.
fn report_curves<F: LawFamily>(name: &str, law: &[f64], curves: u64) -> Result<(), Box<dyn Error>>
where
    F::At<f64>: SlidingLaw<f64>,
{
    let frequency = (STIFFNESS / MASS).sqrt() / TAU;
    let guess = Guess::new(machine()?, &Candidate::of::<F>(), frequency, law, &[])?;
    let sensor = PlannedSensor::new(Quantity::Velocity, NOISE)?;
    let tests = RELEASES.iter().map(|release| PlannedTest::release(*release, sensor, RATE, SAMPLES as f64 / RATE));
    let plan = Plan::new(guess, tests.collect::<Result<_, _>>()?)?;
    let (planned, normal) = (plan.curve()?, Normal::new(0.0, NOISE)?);
    for set in [&[0][..], &[1], &[0, 1]] {
        let predicted = planned.predict(set)?;
        let clean: Vec<Vec<f64>> =
            set.iter().map(|place| motion::<F>(law, (RELEASES[*place], LOAD))).collect::<Result<_, _>>()?;
        let mut found = Vec::new();
        for seed in 0..curves {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let decay = |values: &Vec<f64>| {
                let values = values.iter().map(|value| value + normal.sample(&mut random)).collect();
                let record = Record::sampled(RATE, values, Quantity::Velocity, "m/s")?;
                Ok(Experiment::ring_down(&record, &Preparation::default())?)
            };
            let decays = clean.iter().map(decay).collect::<Result<Vec<_>, Box<dyn Error>>>()?;
            found.extend(FrictionCurve::of(&machine()?, &decays));
        }
        for speed in SPEEDS {
            let level = predicted.at(speed).ok_or("the tests reach it")?;
            let mut levels: Vec<(f64, f64)> =
                found.iter().filter_map(|curve| curve.at(speed)).map(|one| (one.value(), one.uncertainty())).collect();
            let (count, truth) = (levels.len() as f64, F::at(law)?.coefficient(speed));
            let rms = |of: &dyn Fn(&(f64, f64)) -> f64| {
                100.0 / truth * (levels.iter().map(|one| of(one).powi(2)).sum::<f64>() / count).sqrt()
            };
            let (off, all) = (rms(&|(value, _)| value - truth), rms(&|(_, u)| *u));
            levels.sort_by(|a, b| a.1.total_cmp(&b.1));
            let median = levels[levels.len() / 2].1;
            println!(
                "| {name} | {} | {} | {:.3} | {:.3} | {all:.3} | {off:.3} | {count} |",
                set.iter().map(|place| format!("{} mm", 1e3 * RELEASES[*place])).collect::<Vec<_>>().join(", "),
                1e3 * speed,
                100.0 * level.uncertainty() / truth,
                100.0 * median / truth,
            );
        }
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let Arguments { refits, curves } = Arguments::parse();
    report_curves::<CoulombViscous>("coulomb_viscous", &[0.25, 0.02], curves)?;
    report_curves::<Stribeck>("stribeck", &[0.25, 0.3, 0.06, 2.0, 0.05], curves)?;
    let berger = [0.228, 0.261, 2.852];
    let viscous = [0.25, 0.002];
    println!("{:<44} {:>11} {:>11} {:>8} {:>6}", "design", "predicted", "scatter", "ratio", "fits");
    report::<Berger>("berger, 3 × 16 mm at 14 N", &berger, &[(0.016, 14.0); 3], refits)?;
    let designed = [(0.016, 3.5), (0.016, 14.0), (0.022, 3.5)];
    report::<Berger>("berger, the best three", &berger, &designed, refits)?;
    report::<Berger>("berger, 22 mm at 7 N and 14 N", &berger, &[(0.022, 7.0), (0.022, 14.0)], refits)?;
    report::<CoulombViscous>("coulomb + viscous, 22 mm at 14 N", &viscous, &[(0.022, 14.0)], refits)?;
    report::<CoulombViscous>(
        "coulomb + viscous, 16 mm at 3.5 N and 14 N",
        &viscous,
        &[(0.016, 3.5), (0.016, 14.0)],
        refits,
    )?;

    let tests: Vec<Test> = (0..100).map(|i| (0.01 + 1e-4 * f64::from(i), 14.0)).collect();
    let shortest = (0..5).map(|_| {
        let begin = Instant::now();
        predicted::<Berger>(&berger, &tests).map(|_| begin.elapsed().as_secs_f64() / tests.len() as f64)
    });
    let shortest = shortest.collect::<Result<Vec<_>, _>>()?.into_iter().fold(f64::INFINITY, f64::min);
    println!("{:.3} ms a candidate, berger, {SAMPLES} samples, one thread", 1e3 * shortest);
    Ok(())
}
