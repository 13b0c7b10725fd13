//! Predicted uncertainties of five designs beside the scatter of simulated refits:
//! `cargo run --release --example design -- [--refits 1000]`.
//!
//! Every refit is one of records with fresh noise, begun at the truth, by the joint problem of the library. What it
//! showed is in docs/study.md. The time that a plan takes for each candidate is printed as well.

use std::error::Error;
use std::f64::consts::TAU;
use std::time::Instant;

use clap::Parser;
use fmm_fit::{Options, Residuals, solve};
use fmm_friction::{Berger, CoulombViscous, LawFamily};
use fmm_identify::{
    Candidate, DesignPrediction, Experiment, Guess, Known, Machine, Plan, PlannedSensor, PlannedTest, Preparation,
    Problem,
};
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

fn main() -> Result<(), Box<dyn Error>> {
    let Arguments { refits } = Arguments::parse();
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
