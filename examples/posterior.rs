//! Cost and calibration of a posterior: effective draws a second, and ranks of true values over simulated
//! ring-downs.
//!
//! `cargo run --release --example posterior -- [RECORDS]`; the times are of one thread.

use std::error::Error;
use std::time::{Duration, Instant};

use fmm_fit::posterior::{Calibration, Posterior, Prior, Sampler};
use fmm_fit::{Options, ResidualVariance, Residuals, Weighted, solve};
use fmm_friction::{Berger, CoulombViscous, LawFamily};
use fmm_identify::Problem;
use fmm_model::Oscillator;
use fmm_record::{Quantity, Record};
use fmm_sim::{Sampling, Scenario, Trajectory, simulate_into};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};

/// The machine of the thesis: m (kg), k (N/m), normal load (N).
const MACHINE: [(&str, f64); 3] = [("mass", 10.391), ("stiffness", 1982.0), ("normal_load", 14.0)];
/// Samples at 1 kHz, and their noise (m/s).
const SAMPLES: usize = 1501;
const NOISE: f64 = 1e-3;

/// The velocity by the law of these `values`, released at `position` (m) with `velocity` (m/s), with noise.
fn record<F: LawFamily>(
    values: &[f64],
    position: f64,
    velocity: f64,
    seed: u64,
) -> Result<Record, Box<dyn Error + Send + Sync>> {
    let scenario = Scenario::new(Oscillator::new(MACHINE[0].1, MACHINE[1].1)?, F::at::<f64>(values)?, MACHINE[2].1)?;
    let mut motion = Trajectory::new();
    simulate_into::<F, _>(
        &scenario.starting_at(position, velocity)?,
        &Sampling::uniform(1e-3, SAMPLES)?,
        None,
        &mut motion,
    )?;
    let noise = Normal::new(0.0, NOISE)?.sample_iter(ChaCha8Rng::seed_from_u64(seed));
    let values = motion.velocity().values().iter().zip(noise).map(|(v, noise)| v + noise).collect();
    Ok(Record::new(0.0, 1e-3, values, Quantity::Velocity, "m/s")?)
}

/// A problem with these parameters of the law, the initial state and the `others` free.
fn problem<F: LawFamily>(
    record: &Record,
    law: &[(&'static str, f64)],
    others: &[(&'static str, f64)],
) -> Result<Problem<'static>, Box<dyn Error + Send + Sync>> {
    let mut problem = Problem::declared::<F>(record, &[&MACHINE, law, others].concat())?;
    for (name, _) in law.iter().chain(others) {
        problem = problem.free(name)?;
    }
    Ok(problem)
}

fn report(name: &str, posterior: &Posterior, spent: Duration) {
    let fewest = posterior.marginals().iter().map(|m| m.bulk_effective_size().min(m.tail_effective_size()));
    let fewest = fewest.fold(f64::INFINITY, f64::min);
    println!(
        "{posterior}\n{name}: {:.0} effective draws a second, {:.2} s\n",
        fewest / spent.as_secs_f64(),
        spent.as_secs_f64()
    );
}

/// Processor time of this thread so far, as Linux counts it.
fn processor_time() -> Option<Duration> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().next()?.parse().ok().map(Duration::from_nanos)
}

fn timed<F: LawFamily>(name: &str, law: &[(&'static str, f64)]) -> Result<(), Box<dyn Error + Send + Sync>> {
    let values: Vec<f64> = law.iter().map(|(_, value)| *value).collect();
    let record = record::<F>(&values, 0.022, 0.0, 1)?;
    let others = [("initial_position", 0.022), ("initial_velocity", 0.0), ("offset", 0.0)];
    let problem = problem::<F>(&record, law, &others)?;
    let fit = solve(&problem, problem.values(), &Options::default())?;
    let (begun, clock) = (processor_time(), Instant::now());
    let posterior = Sampler::default().with_check_steps(0).sample(&problem, &fit)?;
    let spent = processor_time().zip(begun).map_or_else(|| clock.elapsed(), |(end, begun)| end.saturating_sub(begun));
    report(name, &posterior, spent);
    Ok(())
}

fn main() -> Result<(), Box<dyn Error + Send + Sync>> {
    let records = std::env::args().nth(1).map_or(Ok(500), |text| text.parse())?;
    timed::<CoulombViscous>("Coulomb and viscous, 5 free", &[("coefficient", 0.25), ("viscous", 0.05)])?;
    timed::<Berger>("Berger, 6 free", &[("coefficient", 0.12), ("excess_coefficient", 0.08), ("decay", 15.0)])?;

    let law = [("coefficient", 0.25), ("viscous", 0.05)];
    let state = [("initial_position", 0.022), ("initial_velocity", 0.0)];
    let start = problem::<CoulombViscous>(&record::<CoulombViscous>(&[0.25, 0.05], 0.022, 0.0, 0)?, &law, &state)?;
    let sampler = Sampler::default()
        .with_prior("coefficient", Prior::log_normal(0.25, 0.1)?)
        .with_prior("viscous", Prior::uniform(0.0, 0.2)?)
        .with_prior("initial_position", Prior::normal(0.022, 2e-4)?)
        .with_prior("initial_velocity", Prior::normal(0.0, 2e-3)?)
        .with_variance(ResidualVariance::Unit)
        .with_chains(2)
        .with_draws(200)
        .with_warm_up(100)
        .with_check_steps(0);
    let names = ["coefficient", "viscous", "initial_position", "initial_velocity"];
    let places = names.map(|name| start.parameters().iter().position(|parameter| parameter.name() == name));
    let calibration = Calibration::of(&sampler, start.parameters(), records, |truth, seed| {
        let value = |place: usize| places[place].map_or(f64::NAN, |index| truth[index]);
        let record = record::<CoulombViscous>(&[value(0), value(1)], value(2), value(3), seed)
            .map_err(fmm_fit::EvaluationError::from_boxed)?;
        let law = [(names[0], value(0)), (names[1], value(1))];
        let state = [(names[2], value(2)), (names[3], value(3))];
        let problem = problem::<CoulombViscous>(&record, &law, &state).map_err(fmm_fit::EvaluationError::from_boxed)?;
        let count = problem.len();
        Ok(Weighted::new(problem, vec![NOISE; count])?)
    })?;
    println!("{calibration}");
    Ok(())
}
