//! Coverage of the friction curve by noise and kind of friction: simulated motions with known curves.
//!
//! ```text
//! cargo run --release --example friction_curve -- --seeds 100
//! ```
//!
//! Each machine has a frequency, a number of half cycles and a curve of its own. `--tuning` takes the seeds on which
//! the rules of the curve were chosen; the others are the published ones. `--motion` takes driven motions and impacts
//! in place of ring-downs.

use std::error::Error;
use std::f64::consts::{PI, TAU};
use std::time::Instant;

use clap::{Parser, ValueEnum};
use fmm_friction::SlidingLaw;
use fmm_identify::{Drive, Experiment, FrictionCurve, FrictionLevel, IdentifyError, ImpactTrial, Machine, Preparation};
use fmm_model::{Oscillator, Scalar};
use fmm_record::{Quantity, Record};
use fmm_sim::{Engine, Excitation, RungeKutta, Sampling, Scenario};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal, Uniform};

/// Kinds of friction over the speed, each with a viscous part; the last is in no catalogue.
const KINDS: [&str; 6] = ["constant", "stribeck", "berger", "lorentzian", "hyperbolic", "two falls and drag"];

/// Speeds over the top speed (1) at which widths are stated.
const STATED: [f64; 4] = [0.0, 0.035, 0.16, 0.57];

#[derive(Parser)]
struct Arguments {
    /// Machines of each kind at each noise.
    #[arg(long, default_value_t = 10)]
    seeds: u64,
    /// Noise over the top speed, in percent.
    #[arg(long, value_delimiter = ',', default_values_t = [0.05, 0.2, 2.0, 5.0])]
    noise: Vec<f64>,
    /// Kinds by their number from 0 on.
    #[arg(long, value_delimiter = ',', default_values_t = 0..KINDS.len())]
    kinds: Vec<usize>,
    /// The seeds on which the rules were chosen.
    #[arg(long)]
    tuning: bool,
    /// Motion of each machine.
    #[arg(long, value_enum, default_value = "ring-down")]
    motion: Motion,
    /// Static level above the friction at the lowest speeds, in percent.
    #[arg(long, default_value_t = 0.0)]
    static_excess: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Motion {
    RingDown,
    /// A base that sweeps through the resonance.
    Base,
    /// A force that sweeps through the resonance.
    Force,
    /// The blow of a hammer.
    Impact,
}

/// Friction over the speed, relative to the sliding level and the top speed, times a scale.
#[derive(Debug, Clone, Copy)]
struct Truth {
    kind: usize,
    scale: f64,
    top: f64,
    /// Level at rest over the sliding level, less one.
    excess: f64,
    fall: f64,
    viscous: f64,
    /// Static level over that at the lowest speeds (1).
    holding: f64,
}

impl<D: Scalar> SlidingLaw<D> for Truth {
    fn coefficient(&self, speed: D) -> D {
        let s = speed / self.top;
        let x = s / self.fall;
        let viscous = if self.kind == 5 { s * s } else { s } * self.viscous;
        let one = D::from(1.0);
        let falling = match self.kind {
            0 => D::from(0.0),
            1 => (-(x * x)).exp(),
            2 => (-x).exp(),
            3 => one / (x * x + 1.0),
            4 => one / (x + 1.0),
            _ => (-x).exp() * 0.6 + (-(x * x) / 16.0).exp() * 0.4,
        };
        (falling * self.excess + viscous + 1.0) * self.scale
    }

    fn breakaway(&self) -> D {
        self.coefficient(D::from(0.0)) * self.holding
    }
}

/// A machine with its record.
struct Case {
    truth: Truth,
    record: Record,
    /// Force, or acceleration of the base.
    drive: Vec<f64>,
    motion: Motion,
    /// Speeds without noise (m/s).
    speeds: Vec<f64>,
}

impl Case {
    fn draw(arguments: &Arguments, kind: usize, seed: u64, noise: f64) -> Result<Self, Box<dyn Error>> {
        let mut random = ChaCha8Rng::seed_from_u64(1_000_000 * kind as u64 + seed);
        let mut between = |low: f64, high: f64| Uniform::new(low, high).map(|range| range.sample(&mut random));
        let frequency = between(1.0, 5.0)?;
        let half_cycles = between(8.0, 40.0)?;
        let (amplitude, omega) = (0.02, TAU * frequency);
        let truth = Truth {
            kind,
            scale: amplitude / half_cycles * omega * omega / 2.0,
            top: amplitude * omega,
            excess: between(0.1, 1.0)?,
            fall: between(0.05, 0.4)?,
            viscous: between(0.0, 0.5)?,
            holding: 1.0 + arguments.static_excess / 100.0,
        };
        let rate = 200.0 * frequency;
        let samples = (half_cycles * 100.0) as usize + 50;
        let scenario = Scenario::new(Oscillator::per_unit_mass(frequency)?, truth, 1.0)?;
        let most = truth.scale * (1.0 + truth.excess) * truth.holding;
        let at = |i: usize| i as f64 / samples as f64;
        let drive: Vec<f64> = match arguments.motion {
            Motion::RingDown => Vec::new(),
            // From 0.7 to 1.3 of the natural frequency.
            Motion::Base | Motion::Force => {
                let phase = |i: usize| TAU * (0.7 + 0.3 * at(i)) * at(i) * samples as f64 / 200.0;
                (0..samples).map(|i| 2.0 * most * phase(i).sin()).collect()
            }
            // A tenth of a period after some rest.
            Motion::Impact => {
                let pulse = |i: usize| if (60..80).contains(&i) { (PI * (i - 60) as f64 / 20.0).sin() } else { 0.0 };
                (0..samples).map(|i| truth.top * omega * 2.5 * pulse(i)).collect()
            }
        };
        let scenario = match arguments.motion {
            Motion::RingDown => scenario.starting_at(amplitude, 0.0)?,
            Motion::Base => {
                scenario.driven_by(Excitation::sampled_force(1.0 / rate, drive.iter().map(|a| -a).collect::<Vec<_>>())?)
            }
            _ => scenario.driven_by(Excitation::sampled_force(1.0 / rate, drive.clone())?),
        };
        let motion = RungeKutta::new(1e-12)?.run(&scenario, &Sampling::uniform(1.0 / rate, samples)?)?;
        let speeds: Vec<f64> = motion.velocity().values().iter().map(|v| v.abs()).collect();
        let normal = Normal::new(0.0, speeds.iter().copied().fold(0.0, f64::max) * noise)?;
        let values = motion.velocity().values().iter().map(|v| v + normal.sample(&mut random)).collect();
        let record = Record::sampled(rate, values, Quantity::Velocity, "m/s")?;
        Ok(Self { truth, speeds, record, drive, motion: arguments.motion })
    }

    fn curve(&self) -> Result<FrictionCurve, IdentifyError> {
        let drive = |quantity, unit| Record::sampled(self.record.rate(), self.drive.clone(), quantity, unit);
        let preparation = Preparation::default();
        let (machine, experiment) = match self.motion {
            Motion::RingDown => (Machine::per_unit_mass(), Experiment::ring_down(&self.record, &preparation)?),
            Motion::Base => {
                let base = Drive::base(&drive(Quantity::Acceleration, "m/s^2")?)?;
                (Machine::per_unit_mass(), Experiment::driven(&self.record, base, &preparation)?)
            }
            Motion::Force => {
                let force = Drive::force(&drive(Quantity::Force, "N")?)?;
                (Machine::unknown(), Experiment::driven(&self.record, force, &preparation)?)
            }
            Motion::Impact => {
                let trial = ImpactTrial::prepare(&drive(Quantity::Force, "N")?, &self.record)?;
                (Machine::unknown(), Experiment::impact(&trial)?)
            }
        };
        FrictionCurve::of(&machine, &[experiment])
    }
}

/// Counts and widths of one kind at one noise.
#[derive(Default)]
struct Cell {
    rest: (usize, usize),
    low: (usize, usize),
    moving: (usize, usize),
    band: (usize, usize),
    path: (usize, usize),
    widths: [Vec<f64>; STATED.len()],
    times: Vec<f64>,
    failed: usize,
    limited: usize,
}

fn count(of: &mut (usize, usize), holds: bool) {
    of.0 += usize::from(holds);
    of.1 += 1;
}

fn holds(level: &FrictionLevel, truth: f64) -> bool {
    level.interval(0.95).is_some_and(|(low, high)| low <= truth && truth <= high)
}

impl Cell {
    fn take(&mut self, case: &Case) {
        let begin = Instant::now();
        let curve = match case.curve() {
            Ok(curve) => curve,
            Err(error) => {
                eprintln!("{}: {error}", KINDS[case.truth.kind]);
                self.failed += 1;
                return;
            }
        };
        self.times.push(begin.elapsed().as_secs_f64());
        self.limited += usize::from(!curve.limits().is_empty());
        let mut is_inside = true;
        let top = curve.speeds().last().copied().unwrap_or_default();
        let band = curve.band(0.95).unwrap_or_default();
        for ((speed, level), (low, high)) in curve.speeds().iter().zip(curve.levels()).zip(band) {
            let truth: f64 = case.truth.coefficient(*speed);
            let of = match speed / top {
                0.0 => &mut self.rest,
                s if s < 0.03 => &mut self.low,
                _ => &mut self.moving,
            };
            count(of, holds(&level, truth));
            is_inside &= low <= truth && truth <= high;
        }
        count(&mut self.band, is_inside);
        count(&mut self.path, holds(&curve.mean_over_path(), mean_over_path(case)));
        for (widths, s) in self.widths.iter_mut().zip(STATED) {
            widths.extend(curve.at(s * top).map(|level| level.uncertainty() / case.truth.scale));
        }
    }

    fn print(&mut self, noise: f64, kind: &str) {
        let percent = |(held, all): (usize, usize)| 100.0 * held as f64 / all.max(1) as f64;
        let widths = self.widths.each_mut().map(|widths| format!("{:.2}", 100.0 * median(widths)));
        println!(
            "| {noise} | {kind} | {:.1} | {:.1} | {:.1} | {:.1} | {:.1} | {} | {:.2} | {}/{} |",
            percent(self.rest),
            percent(self.low),
            percent(self.moving),
            percent(self.band),
            percent(self.path),
            widths.join(", "),
            median(&mut self.times),
            self.failed,
            self.limited
        );
    }

    fn add(&mut self, other: Self) {
        for (sum, part) in [
            (&mut self.rest, other.rest),
            (&mut self.low, other.low),
            (&mut self.moving, other.moving),
            (&mut self.band, other.band),
            (&mut self.path, other.path),
        ] {
            sum.0 += part.0;
            sum.1 += part.1;
        }
        for (all, widths) in self.widths.iter_mut().zip(other.widths) {
            all.extend(widths);
        }
        self.times.extend(other.times);
        self.failed += other.failed;
        self.limited += other.limited;
    }
}

/// True friction in the mean over the path, by a motion without noise.
fn mean_over_path(case: &Case) -> f64 {
    let (mut energy, mut path) = (0.0, 0.0);
    for &speed in &case.speeds {
        let friction: f64 = case.truth.coefficient(speed);
        energy += friction * speed;
        path += speed;
    }
    energy / path
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    println!(
        "| noise (%) | friction | holds at rest (%) | to 3 % of the top speed | above | whole curve | mean over the path \
         | u at {STATED:?} of the top speed (% of sliding) | time (s) | failed/limited |\n|---|---|---|---|---|---|---|---|---|---|"
    );
    for noise in arguments.noise.iter().copied() {
        let mut all = Cell::default();
        for &kind in &arguments.kinds {
            let mut cell = Cell::default();
            for seed in 0..arguments.seeds {
                cell.take(&Case::draw(&arguments, kind, 2 * seed + u64::from(!arguments.tuning), noise / 100.0)?);
            }
            cell.print(noise, KINDS[kind]);
            all.add(cell);
        }
        all.print(noise, "all");
    }
    Ok(())
}
