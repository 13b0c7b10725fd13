//! The rows of the table by repeated fits.

use std::ops::ControlFlow;
use std::time::Instant;

use fmm_fit::{Estimate, Fit, Options, Refit, Residuals, WithFixed};
use fmm_sim::Thesis;
use fmm_uq::{MonteCarlo, OutputSample};

use super::{Problem, ROWS, VARIED, inputs, problem};
use crate::Found;
use crate::kicks::Kicks;
use crate::printed::MACHINE_DEVIATIONS;

/// One row by Monte Carlo.
#[derive(Debug)]
pub struct Row {
    /// Which of the [`ROWS`].
    pub name: &'static str,
    /// Coefficient and initial position (m) of each fit.
    pub sample: OutputSample,
    /// How long it took (s).
    pub seconds: f64,
}

/// All rows by the exact motion, `trials` fits each, from the `fit` of `problem`; `watch` is told how many fits are
/// done.
///
/// # Errors
/// If a fit fails.
pub fn exact_rows(
    problem: &Problem,
    fit: &Fit,
    trials: u64,
    seed: u64,
    watch: &(dyn Fn(u64) + Sync),
) -> Found<Vec<Row>> {
    let refit = Refit::prepare(problem, fit)?.varying(&VARIED.map(|(name, _)| name))?.expecting(&MACHINE_DEVIATIONS)?;
    rows([trials; 4], seed, watch, |x| Ok(refit.estimates(x)?))
}

/// All rows by the thesis' Euler motion, each with its number of `trials`.
///
/// The sum of squares of that motion jumps wherever a stop moves to another sample, so that one start alone, the
/// thesis' own, ends beside the minimum; `kicks` more starts about the best values so far find it.
///
/// # Errors
/// If a fit fails.
pub fn euler_rows(trials: [u64; 4], seed: u64, kicks: usize, watch: &(dyn Fn(u64) + Sync)) -> Found<Vec<Row>> {
    let problem = problem(&Thesis::A3)?.by_thesis::<fmm_friction::Coulomb>();
    rows(trials, seed, watch, |x| euler_fit(&problem, kicks, x))
}

/// Coefficient and initial position by the thesis' Euler motion, with mass, stiffness and damping held at `values`.
fn euler_fit(problem: &Problem, kicks: usize, values: &[f64]) -> Found<Vec<f64>> {
    let held = WithFixed::new(problem, values.iter().copied().enumerate())?;
    let mut start = problem.values().to_vec();
    start[..values.len()].copy_from_slice(values);
    let reach = problem.parameters().iter().map(|parameter| match parameter.name() {
        "coefficient" => 5e-4,
        "initial_position" => 5e-5,
        _ => 0.0,
    });
    // A search that ends at a jump does not get further with another radius, but from another start.
    let options =
        Options::default().with_restarts(0).with_polish_steps(0).with_cost_tolerance(1e-9).with_step_tolerance(1e-8);
    let kicks = Kicks { rounds: 1, count: kicks, seed: 0 };
    let best = kicks.lowest(&held, &start, &reach.collect::<Vec<f64>>(), options)?;
    let found = |name| best.estimate(name).map(Estimate::value).ok_or("no such parameter");
    Ok(vec![found("coefficient")?, found("initial_position")?])
}

/// All rows with `model`, which gives coefficient and initial position.
fn rows(
    trials: [u64; 4],
    seed: u64,
    watch: &(dyn Fn(u64) + Sync),
    model: impl Fn(&[f64]) -> Found<Vec<f64>> + Sync,
) -> Found<Vec<Row>> {
    let mut before = 0;
    let one = |(name, trials): (&'static str, u64)| {
        let progress = |progress: fmm_uq::Progress| {
            watch(before + progress.done);
            ControlFlow::Continue(())
        };
        let began = Instant::now();
        let run = MonteCarlo::new(&inputs(name)?, trials)?.with_seed(seed).with_progress(&progress);
        let sample = run.run(&model)?;
        before += trials;
        Ok(Row { name, sample, seconds: began.elapsed().as_secs_f64() })
    };
    ROWS.into_iter().zip(trials).map(one).collect()
}
