//! Run-down: a motion without a spring, which friction alone slows down.

use std::f64::consts::TAU;
use std::ops::Range;

use fmm_model::ModelError;
use fmm_record::{Examination, Quantity, Record, noise, quantisation_step};

use super::{Experiment, FEWEST_SAMPLES, ring_down, usable};
use crate::error::IdentifyError;
use crate::experiment::first_guess::{Dissipation, FirstGuess};
use crate::experiment::preparation::COARSE;
use crate::experiment::{Offset, Preparation, RecordSummary};
use crate::linear_algebra::Span;

/// Parts into which a record is divided to see how its speed goes.
const PARTS: usize = 200;
/// Fewest samples of a part that tell a speed by positions.
const FEWEST_POSITIONS: usize = 4;
/// Standard deviations of the speed of a part by which it differs from another beyond chance.
const BEYOND_CHANCE: f64 = 4.0;
/// Share of the first speed by which a speed has to rise to be that of another run (1). Origin: chosen; on the roads of
/// public records, which rise and fall, coasting vehicles gain up to 32 %.
const PUSHED: f64 = 0.5;
/// Largest zero of a tachometer over the first speed (1). Origin: chosen; a speed that stays and is larger is none.
const LARGEST_ZERO: f64 = 0.05;
/// Share of the record at its end that tells a rest (1).
const END: f64 = 0.1;

impl Experiment {
    /// A run-down: the part of a `record` of displacement or velocity in which a machine without a spring is slowed down
    /// by nothing but its friction, such as the coast-down of a vehicle or the spin-down of a rotor.
    ///
    /// If the record begins with a drive that holds or raises the speed, it is used from where the speed begins to
    /// fall; if the machine is pushed again, until then. Samples that are unequally spaced are fitted at their times.
    /// Angles are positions in radians, and a mass of such a machine is its moment of inertia in kg m².
    ///
    /// A run-down shows friction per mass over the speed, and no stiffness. The offset of a speed is fitted if the
    /// record ends at rest, and zero otherwise, as it cannot be told from friction ([`Offset::Rest`] is the mean at
    /// rest); that of a position is its zero. Over one run the speed falls with the time: friction that changes during
    /// it looks like friction that depends on the speed.
    ///
    /// Runs in both directions show a constant force as well, such as that of a slope, and with quadratic damping the
    /// velocity of the wind: both are fitted as soon as the records have both directions.
    ///
    /// ```
    /// use fmm_friction::CoulombViscous;
    /// use fmm_identify::{Experiment, Known, Machine, Preparation, identify};
    /// use fmm_record::{Quantity, Record};
    ///
    /// // A rotor of 0.02 kg m², with 5 mN m and 0.1 mN m s, from 300 rad/s: F/m = 0.25 rad/s², c/m = 0.005 1/s.
    /// let speed = |t: f64| (300.0 + 50.0) * (-0.005 * t).exp() - 50.0;
    /// let speeds = (0..3000).map(|i| speed(0.1 * f64::from(i))).collect();
    /// let record = Record::sampled(10.0, speeds, Quantity::Velocity, "rad/s")?;
    ///
    /// let run = Experiment::run_down(&record, &Preparation::default())?;
    /// let rotor = Machine::of_mass(Known::new(0.02, 1e-5)?)?;
    /// let found = identify::<CoulombViscous>(&rotor, &[run])?;
    /// assert!((found.finding("friction_per_mass").unwrap().value() - 0.25).abs() < 1e-9);
    /// assert!((found.finding("damping_per_mass").unwrap().value() - 0.005).abs() < 1e-11);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`IdentifyError::WrongRecord`] for another quantity, [`IdentifyError::TooFew`], and
    /// [`IdentifyError::NotSeen`] if nothing moves, if the speed does not fall, or if the offset is to be that of a
    /// rest that there is not.
    pub fn run_down(record: &Record, preparation: &Preparation) -> Result<Self, IdentifyError> {
        let quantity = record.quantity();
        if !matches!(quantity, Quantity::Displacement | Quantity::Velocity) {
            return Err(IdentifyError::wrong_quantity("a run-down", "a displacement or a velocity", quantity));
        }
        let (record, gain_uncertainty, clock_uncertainty) = usable(record, preparation)?;
        if begins_anew(&record) {
            return Err(IdentifyError::not_seen(
                "the angle begins anew after each turn; add a turn at each of its jumps, as unwrap of NumPy and MATLAB \
                 does for angles in rad",
            ));
        }
        let seen = Speeds::of(&record);
        // Who says where to begin or to end knows what is there.
        let release = if preparation.from.is_none() { seen.release() } else { None };
        let seen = seen.since(release);
        let pushed = seen.pushed();
        let seen = seen.until(pushed);
        let (from, to) = (release.unwrap_or(record.start()), pushed.unwrap_or(record.end()));
        let record = record.crop(from, to)?;
        let guess = seen.guess(&record)?;
        let rest = guess.rest;
        let record = if rest.is_some() { before_last_step(record)? } else { record };
        let held_offset = match (preparation.offset, quantity) {
            (Offset::Fixed(value), _) => {
                Some(ModelError::require_finite("offset", value, "in the unit of the record")?)
            }
            (Offset::Rest, Quantity::Velocity) => Some(rest.ok_or(IdentifyError::no_rest())?.1),
            (Offset::Fitted, Quantity::Velocity) if rest.is_some() => None,
            _ => Some(0.0),
        };
        let examination = Examination::of(&record);
        let spikes = if record.is_equally_spaced() { examination.spikes() } else { &[] };
        let kept = ring_down::without(record.len(), spikes.iter().map(|spike| spike.index..spike.index + spike.count));
        let amplitudes = match quantity {
            Quantity::Velocity => (guess.speed, seen.last().abs()),
            _ => (guess.path, guess.path),
        };
        let summary = RecordSummary {
            samples: kept.iter().map(Range::len).sum(),
            held_offset,
            gain_uncertainty,
            clock_uncertainty,
            release,
            amplitudes,
            resolution: examination.resolution(),
            rest_from: rest.map(|(time, _)| time),
            spikes: spikes.iter().map(|spike| spike.count).sum(),
            saturation: examination.saturation(),
            further_releases: pushed.into_iter().collect(),
            is_run_down: true,
            ..RecordSummary::unseen(&record, 0.5 / record.duration(), record.noise())
        };
        let first_guess = FirstGuess::of_driven(summary.frequency, 0.0, amplitudes.0, record.values()[0], quantity);
        Ok(Self { run_down: Some(guess), ..Self::bare(record.clone(), kept, first_guess, summary) })
    }

    /// True if it is a run-down.
    pub(crate) fn is_run_down(&self) -> bool {
        self.run_down.is_some()
    }
}

/// A `record` that ends at rest, up to the last change of a position by more than a step of the converter, where its
/// steps exceed the noise: at rest all samples are rounded alike, and are not as many observations.
fn before_last_step(record: Record) -> Result<Record, IdentifyError> {
    let (noise, values) = (record.noise(), record.values());
    let step = quantisation_step(values).filter(|step| *step > COARSE * noise);
    let Some(step) = step.filter(|_| record.quantity() == Quantity::Displacement) else { return Ok(record) };
    let is_far = |value: &f64| values.last().is_some_and(|level| (value - level).abs() > 1.5 * step);
    let last = values.iter().rposition(is_far).filter(|last| *last >= FEWEST_SAMPLES);
    Ok(match last {
        Some(last) => record.crop(record.start(), record.time(last))?,
        None => record,
    })
}

/// True if it is an angle in rad that jumps back by whole turns as it goes on.
fn begins_anew(record: &Record) -> bool {
    let steps = || record.values().windows(2).map(|pair| pair[1] - pair[0]);
    let rest = |step: f64| step - TAU * (step / TAU).round();
    let path: f64 = steps().map(rest).sum();
    let is_jump = |step: f64| (step / TAU).round() * path < 0.0;
    // Where a step is a large part of a turn, a turn more or less does not show.
    let are_small = steps().all(|step| rest(step).abs() < 0.25 * TAU);
    record.unit() == "rad" && are_small && steps().any(is_jump)
}

/// True if these are run-downs, and none of them has a spring; `None` if some of them are.
pub(crate) fn are_run_downs(experiments: &[Experiment]) -> Option<bool> {
    let first = experiments.first()?.is_run_down();
    experiments.iter().all(|experiment| experiment.is_run_down() == first).then_some(first)
}

/// True if these are run-downs of both directions.
pub(crate) fn have_both_directions(experiments: &[Experiment]) -> bool {
    let is_forward = |experiment: &Experiment| experiment.run_down.as_ref().map(|guess| guess.initial.1 > 0.0);
    let mut directions = experiments.iter().filter_map(is_forward);
    directions.next().is_some_and(|first| directions.any(|other| other != first))
}

/// Constant force per mass by which run-downs of both directions slow down differently, to begin a fit with.
pub(crate) fn slope(experiments: &[Experiment]) -> f64 {
    let runs = || experiments.iter().filter_map(|experiment| experiment.run_down.as_ref());
    let mean = |is_meant: &dyn Fn(&RunDownGuess) -> bool| {
        let of_runs = runs().filter(|run| is_meant(run)).map(|run| run.slowed);
        let (sum, count) = of_runs.fold((0.0, 0.0), |(sum, count), one| (sum + one, count + 1.0));
        sum / f64::max(count, 1.0)
    };
    0.5 * (mean(&|run| run.initial.1 < 0.0) - mean(&|run| run.initial.1 > 0.0))
}

/// Start values of a run-down.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RunDownGuess {
    /// Position and velocity at the first sample.
    pub(crate) initial: (f64, f64),
    /// Losses to begin a fit with: those found, all of them as friction, and all of them as damping.
    pub(crate) hypotheses: Vec<Dissipation>,
    /// Mean deceleration.
    slowed: f64,
    /// Time (s) from which on the machine rests, and the mean velocity there.
    pub(super) rest: Option<(f64, f64)>,
    /// Path of the run, and its largest speed.
    pub(crate) path: f64,
    pub(crate) speed: f64,
}

/// Velocities over the time as parts of a record show them.
struct Speeds {
    /// Time in the middle (s), mean velocity and beginning (s) of each part.
    parts: Vec<(f64, f64, f64)>,
    /// Standard deviation of the noise of a part.
    noise: f64,
    /// 1 or −1, the direction of the fastest part.
    direction: f64,
}

impl Speeds {
    fn of(record: &Record) -> Self {
        let (values, is_position) = (record.values(), record.quantity() == Quantity::Displacement);
        let fewest = if is_position { FEWEST_POSITIONS } else { 1 };
        let size = (values.len() / PARTS).max(fewest);
        let of_part = |first: usize| {
            let part = first..(first + size).min(values.len());
            let count = part.len() as f64;
            let mean = |of: &dyn Fn(usize) -> f64| part.clone().map(of).sum::<f64>() / count;
            let time = mean(&|index| record.time(index));
            let velocity = if is_position {
                let square = mean(&|index| (record.time(index) - time).powi(2));
                mean(&|index| (record.time(index) - time) * values[index]) / square
            } else {
                mean(&|index| values[index])
            };
            (time, velocity, record.time(first))
        };
        let whole = values.len() - values.len() % size;
        let parts: Vec<_> = (0..whole).step_by(size).map(of_part).collect();
        let velocities: Vec<f64> = parts.iter().map(|part| part.1).collect();
        let fastest = velocities.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0);
        Self { noise: noise(&velocities), direction: fastest.signum(), parts }
    }

    /// Speed of part `index` in the direction of the run.
    fn speed(&self, index: usize) -> f64 {
        self.direction * self.parts[index].1
    }

    fn last(&self) -> f64 {
        self.parts.last().map_or(0.0, |part| part.1)
    }

    /// Time (s) from which on the speed falls, if it was held or raised before.
    fn release(&self) -> Option<f64> {
        /// Fall before, over that of as long a time after, below which the speed was held (1). Origin: chosen.
        const HELD: f64 = 0.25;
        let top = |count: usize| {
            let most = (0..count).map(|index| self.speed(index)).fold(f64::NEG_INFINITY, f64::max);
            (0..count).rev().find(|index| self.speed(*index) >= most - BEYOND_CHANCE * self.noise)
        };
        let (mut count, mut last) = (self.parts.len(), top(self.parts.len())?);
        if last + 2 >= count {
            // What drives the machine again at the end is as fast as what drove it before.
            count = self.trough()?;
            last = top(count)?;
        }
        let after = self.speed(last) - self.speed((2 * last).min(count - 1));
        let held = last > 2 && self.speed(0) - self.speed(last) < HELD * after;
        // The release lies in one of two parts.
        (held && last + 2 < count).then(|| self.parts[last + 2].2)
    }

    /// The part with the lowest speed before a rise up to the end of the record, if the speed fell to it by as much as
    /// tells another run.
    fn trough(&self) -> Option<usize> {
        let mut lowest = self.parts.len().checked_sub(1)?;
        for index in (0..lowest).rev() {
            let fall = (BEYOND_CHANCE * 1.5 * self.noise).max(PUSHED * self.speed(index).abs());
            if self.speed(index) < self.speed(lowest) {
                lowest = index;
            } else if self.speed(index) > self.speed(lowest) + fall {
                return Some(lowest);
            }
        }
        None
    }

    /// Time (s) at which the speed is lowest before it rises again, if it does.
    fn pushed(&self) -> Option<f64> {
        let rise = (BEYOND_CHANCE * 1.5 * self.noise).max(PUSHED * self.speed(0).abs());
        let mut lowest = 0;
        for index in 0..self.parts.len() {
            if self.speed(index) < self.speed(lowest) {
                lowest = index;
            } else if self.speed(index) > self.speed(lowest) + rise {
                return Some(self.parts[lowest].2);
            }
        }
        None
    }

    fn since(mut self, time: Option<f64>) -> Self {
        self.parts.retain(|part| time.is_none_or(|time| part.2 >= time));
        self
    }

    fn until(mut self, time: Option<f64>) -> Self {
        self.parts.retain(|part| time.is_none_or(|time| part.2 < time));
        self
    }

    /// Time (s) from which on the machine rests, and the mean there; `None` if it does not.
    fn rest(&self) -> Option<(f64, f64)> {
        let count = self.parts.len();
        let end = ((END * count as f64) as usize).max(4);
        if count < 2 * end {
            return None;
        }
        let mean = |part: Range<usize>| part.clone().map(|i| self.parts[i].1).sum::<f64>() / part.len() as f64;
        let (before, after) = (mean(count - end..count - end / 2), mean(count - end / 2..count));
        let level = mean(count - end..count);
        // Two means of so many parts.
        let chance = BEYOND_CHANCE * self.noise * (2.0 / (end / 2) as f64).sqrt();
        let moves = |index: &usize| (self.parts[*index].1 - level).abs() > BEYOND_CHANCE * self.noise + chance;
        let first = (0..count).rev().find(moves).map_or(0, |index| index + 1);
        let is_zero = level.abs() <= LARGEST_ZERO * self.speed(0).abs();
        let stays = (before - after).abs() <= chance && first + end <= count + end / 2;
        (is_zero && stays).then(|| (self.parts[first].0, level))
    }

    /// Start values of the run in `record`.
    ///
    /// ```text
    /// v = v₀ − (F/m) t − (c/m) ∫v dt
    /// ```
    fn guess(&self, record: &Record) -> Result<RunDownGuess, IdentifyError> {
        let rest = self.rest();
        let until = rest.map_or(f64::INFINITY, |(time, _)| time);
        let moving: Vec<(f64, f64)> = (0..self.parts.len())
            .map(|index| (self.parts[index].0 - record.start(), self.speed(index)))
            .take_while(|(time, _)| time + record.start() <= until)
            .collect();
        let ends = moving.first().copied().zip(moving.last().copied());
        let falls = |((_, first), (_, last)): &((f64, f64), (f64, f64))| {
            *first > 0.0 && first - last > BEYOND_CHANCE * self.noise && record.len() >= FEWEST_SAMPLES
        };
        let ((_, first), (end, last)) = ends.filter(falls).ok_or_else(|| {
            IdentifyError::not_seen("the speed does not fall for long enough, so no run-down is seen in the record")
        })?;
        let mut path = 0.0;
        let mut paths = vec![0.0];
        for pair in moving.windows(2) {
            path += 0.5 * (pair[0].1 + pair[1].1) * (pair[1].0 - pair[0].0);
            paths.push(path);
        }
        let columns = vec![
            vec![1.0; moving.len()],
            moving.iter().map(|(time, _)| -time).collect(),
            paths.iter().map(|path| -path).collect(),
        ];
        let speeds: Vec<f64> = moving.iter().map(|(_, speed)| *speed).collect();
        let found = Span::of(columns).steps(&speeds);
        let (friction, damping) = (found[1].max(0.0), found[2].max(0.0));
        let slowed = (first - last) / end;
        let position = if record.quantity() == Quantity::Displacement { record.values()[0] } else { 0.0 };
        let hypotheses = vec![
            Dissipation { damping, friction },
            Dissipation { damping: 0.0, friction: slowed },
            Dissipation { damping: slowed / (0.5 * (first + last)), friction: 0.0 },
        ];
        let velocity = self.direction * found[0].max(0.5 * first);
        Ok(RunDownGuess { initial: (position, velocity), hypotheses, slowed, rest, path, speed: first })
    }
}
