//! Cost of a fit by a law of many shapes, and whether it ends in the lowest minimum.
//!
//! Records of known truth are fitted as the crates do when nothing is asked for, and once more from the truth.

use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::time::Instant;

use fmm_fit::{Minimizer, Options, Residuals as _, solve};
use fmm_friction::{BoucWen, Dahl, LawFamily, LuGre, MakkarDixon, Role, ShiftedMakkarDixon, Stribeck};
use fmm_identify::{Candidate, Experiment, Inquiry, Machine, Preparation, Problem, Terms};
use fmm_model::Oscillator;
use fmm_record::{Quantity, Record};
use fmm_sim::Sampling;
use serde_json::{Value, json};

use super::law::Law;
use super::thesis::largest;
use super::{Found, Random, noise};

/// Samples of a record.
const SAMPLES: usize = 3000;
/// By so much of itself (1) a sum of squares may lie above another and be the same: at a valley's end, steps are
/// longer.
const SAME: f64 = 1e-6;

/// A law whose fits are timed.
#[derive(Debug)]
pub(crate) struct Fits {
    pub(crate) name: &'static str,
    law: &'static str,
    held: &'static [(&'static str, f64)],
    values: fn(Scales, &mut Random) -> Vec<f64>,
    fit: Fitting,
}

/// Fits of a family beside terms to a record, as the crate begins them and from the truth if it is given.
type Fitting = fn(&Terms, &[Experiment], Option<&[f64]>) -> Found<Ended>;

/// Scales of a motion by a law per unit of mass.
#[derive(Debug, Clone, Copy)]
struct Scales {
    /// ω₀ (rad/s).
    angular: f64,
    /// Largest speed (m/s).
    speed: f64,
    /// Friction level (m/s²).
    level: f64,
}

/// How two fits of a record have ended.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ended {
    /// Time on all threads (s).
    seconds: f64,
    /// Trial steps of all searches.
    steps: usize,
    /// Sum of squares, and that of the fit from the truth, if the law is the true one.
    squares: f64,
    from_truth: Option<f64>,
}

/// The laws.
pub(crate) const FITS: &[Fits] = &[
    Fits::of::<Dahl>("dahl", "dahl-held", &[("exponent", 1.0)], dahl),
    Fits::of::<Dahl>("dahl", "dahl", &[], dahl_of_any_exponent),
    Fits::of::<LuGre>("lugre", "lugre-held", &[("exponent", 2.0)], lugre),
    Fits::of::<LuGre>("lugre", "lugre", &[], lugre_of_any_exponent),
    Fits::of::<BoucWen>("bouc_wen", "bouc_wen-held", &[("amplitude", 1.0)], bouc_wen),
    Fits::of::<BoucWen>("bouc_wen", "bouc_wen", &[], bouc_wen),
    Fits::of::<MakkarDixon>("makkar_dixon", "makkar_dixon", &[], makkar_dixon),
    Fits::of::<ShiftedMakkarDixon>("makkar_dixon_shifted", "makkar_dixon_shifted", &[], makkar_dixon),
    Fits::of::<Stribeck>("stribeck", "stribeck", &[], stribeck),
];

fn dahl(scales: Scales, random: &mut Random) -> Vec<f64> {
    vec![scales.level, scales.presliding(random), 1.0]
}

fn dahl_of_any_exponent(scales: Scales, random: &mut Random) -> Vec<f64> {
    vec![scales.level, scales.presliding(random), random.uniform(0.5, 2.0)]
}

fn lugre(scales: Scales, random: &mut Random) -> Vec<f64> {
    let [sliding, breakaway, fall_speed, _, viscous] = scales.falling(random);
    let stiffness = scales.presliding(random);
    let damping = 2.0 * random.uniform(0.0, 1.0) * stiffness.sqrt();
    vec![sliding, breakaway, fall_speed, 2.0, stiffness, damping, viscous]
}

fn lugre_of_any_exponent(scales: Scales, random: &mut Random) -> Vec<f64> {
    let exponent = random.uniform(0.5, 2.0);
    let mut values = lugre(scales, random);
    values[3] = exponent;
    values
}

fn bouc_wen(scales: Scales, random: &mut Random) -> Vec<f64> {
    let (stiffness, exponent) = (scales.presliding(random), random.uniform(1.0, 2.0));
    let sum = (stiffness / scales.level).powf(exponent);
    let ratio = random.uniform(-0.5, 0.5);
    vec![stiffness, 1.0, sum / (1.0 + ratio), ratio * sum / (1.0 + ratio), exponent]
}

fn makkar_dixon(scales: Scales, random: &mut Random) -> Vec<f64> {
    let Scales { angular, speed, level } = scales;
    let rise = random.log_uniform(20.0, 100.0) / speed;
    let fall = random.log_uniform(2.0, 10.0) / speed;
    let level_rise = random.log_uniform(20.0, 100.0) / speed;
    vec![random.uniform(0.1, 0.5) * level, rise, fall, level, level_rise, random.uniform(0.0, 0.01) * angular]
}

fn stribeck(scales: Scales, random: &mut Random) -> Vec<f64> {
    scales.falling(random).to_vec()
}

impl Scales {
    /// Presliding stiffness, 3 to 100 times that of the spring (1/s²).
    fn presliding(self, random: &mut Random) -> f64 {
        random.log_uniform(3.0, 100.0) * self.angular.powi(2)
    }

    /// Values of a Stribeck curve.
    fn falling(self, random: &mut Random) -> [f64; 5] {
        let Self { angular, speed, level } = self;
        let (excess, fall_speed) = (random.uniform(0.05, 0.5), random.log_uniform(0.02, 0.3));
        let (exponent, viscous) = (random.uniform(0.5, 2.0), random.uniform(0.0, 0.01));
        [level, level * (1.0 + excess), fall_speed * speed, exponent, viscous * angular]
    }
}

/// Fits by a family as the crate begins them, and from the `truth`.
fn fit<F: LawFamily>(terms: &Terms, decays: &[Experiment], truth: Option<&[f64]>) -> Found<Ended> {
    let machine = Machine::per_unit_mass();
    let (begun, mut steps) = (Instant::now(), 0);
    let candidate = Candidate::of::<F>().with(terms.clone());
    let count = |_: &str, _: &Minimizer| {
        steps += 1;
        ControlFlow::Continue(())
    };
    let found = Inquiry::of(&machine, decays).observed_by(count).candidate(&candidate)?;
    let seconds = begun.elapsed().as_secs_f64();
    let problem = Problem::of(&candidate, machine, decays)?;
    let from = |truth: &[f64]| -> Found<f64> {
        // A hum that the preparation has found in the noise is none in truth.
        let truth = truth.iter().chain(std::iter::repeat(&0.0));
        let bounded = truth.zip(problem.parameters()).map(|(value, parameter)| parameter.bounds().clamp(*value));
        let options = Options::default().with_max_iterations(200);
        Ok(solve(&problem, &bounded.collect::<Vec<_>>(), &options)?.sum_of_squares())
    };
    Ok(Ended { seconds, steps, squares: found.fit().sum_of_squares(), from_truth: truth.map(from).transpose()? })
}

impl Fits {
    const fn of<F: LawFamily>(
        law: &'static str,
        name: &'static str,
        held: &'static [(&'static str, f64)],
        values: fn(Scales, &mut Random) -> Vec<f64>,
    ) -> Self {
        Self { name, law, held, values, fit: fit::<F> }
    }

    /// True if record number `record` is of the law. Two in four are of a contact with Stribeck's curve and no
    /// presliding, which most laws cannot describe.
    pub(crate) fn is_own(&self, record: u64) -> bool {
        record % 4 < 2 || self.law == "stribeck"
    }

    /// Both fits of record number `record`.
    pub(crate) fn run(&self, record: u64) -> Found<Ended> {
        let is_own = self.is_own(record);
        let (law, values): (_, fn(Scales, &mut Random) -> Vec<f64>) =
            if is_own { (self.law, self.values) } else { ("stribeck", stribeck) };
        let mut random = Random::of(&format!("speed/{law}"), record);
        let frequency = random.log_uniform(1.0, 5.0);
        let angular = std::f64::consts::TAU * frequency;
        let release = random.log_uniform(1e-3, 0.05);
        let half_cycles = random.log_uniform(6.0, 40.0);
        let level = angular.powi(2) * release / (2.0 * half_cycles);
        let scales = Scales { angular, speed: angular * release, level };
        let law = Law::named(law).ok_or("no such law")?;
        let values = values(scales, &mut random);
        let interval = 1.1 * half_cycles * 0.5 / frequency / SAMPLES as f64;
        let sampling = Sampling::uniform(interval, SAMPLES)?;
        let motion = law.simulate(Oscillator::per_unit_mass(frequency)?, &values, 1.0, release, &sampling)?;
        let (channel, quantity, unit) = match record % 2 {
            0 => (motion.velocity(), Quantity::Velocity, "m/s"),
            _ => (motion.position(), Quantity::Displacement, "m"),
        };
        let mut measured = channel.values().to_vec();
        let deviation = largest(&measured) / random.log_uniform(100.0, 1000.0);
        noise::white(&mut measured, deviation, &mut random);
        let record = Record::new(0.0, interval, measured, quantity, unit)?;
        let decay = Experiment::ring_down(&record, &Preparation::default())?;

        let mut terms = Terms::default();
        for (name, value) in self.held {
            terms = terms.holding(*name, *value)?;
        }
        let above = |(parameter, value): (&fmm_friction::LawParameter, &f64)| {
            if parameter.role() == Role::LevelAbove { *value - level } else { *value }
        };
        let fitted = law.parameters.iter().zip(&values).map(above);
        let truth: Vec<f64> = std::iter::once(frequency).chain(fitted).chain([release, 0.0, 0.0]).collect();
        (self.fit)(&terms, &[decay], is_own.then_some(truth.as_slice()))
    }
}

/// One row a law: time, trial steps, and where the fits have ended beside those from the truth.
pub(crate) fn table(fits: &[(&Fits, Vec<Ended>)]) -> String {
    let mut text = format!(
        "{:<26}{:>8}{:>10}{:>10}{:>8}{:>8}{:>8}{:>8}\n",
        "law", "records", "median s", "largest s", "steps", "lower", "same", "higher"
    );
    for (law, ended) in fits {
        let mut seconds: Vec<f64> = ended.iter().map(|ended| ended.seconds).collect();
        let mut steps: Vec<usize> = ended.iter().map(|ended| ended.steps).collect();
        seconds.sort_by(f64::total_cmp);
        steps.sort_unstable();
        let Some(last) = seconds.last() else { continue };
        let count = |is: fn(&Ended) -> bool| ended.iter().filter(|ended| is(ended)).count();
        let lower = count(|ended| ended.from_truth.is_some_and(|truth| ended.squares < truth * (1.0 - SAME)));
        let higher = count(|ended| ended.from_truth.is_some_and(|truth| ended.squares > truth * (1.0 + SAME)));
        let known = count(|ended| ended.from_truth.is_some());
        let middle = ended.len() / 2;
        let _ = writeln!(
            text,
            "{:<26}{:>8}{:>10.3}{:>10.3}{:>8}{:>8}{:>8}{:>8}",
            law.name,
            ended.len(),
            seconds[middle],
            last,
            steps[middle],
            lower,
            known - lower - higher,
            higher
        );
    }
    text
}

/// The same as a document, record by record.
pub(crate) fn document(fits: &[(&Fits, Vec<Ended>)]) -> Value {
    let of_record = |ended: &Ended| {
        json!({
            "seconds": ended.seconds, "steps": ended.steps,
            "sum_of_squares": ended.squares, "from_truth": ended.from_truth,
        })
    };
    fits.iter()
        .map(|(law, ended)| json!({ "law": law.name, "records": ended.iter().map(of_record).collect::<Value>() }))
        .collect()
}
