//! Friction of each half swing from the energies at its turning points.

use std::f64::consts::PI;

use fmm_model::{ModelError, Oscillator};
use fmm_record::{Quantity, Record, noise};

use crate::error::IdentifyError;
use crate::estimators::half_swings::{bridged, check_reversals, reversals};
use crate::experiment::Experiment;
use fmm_model::Estimated;

/// What one half swing lost.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct HalfSwing {
    /// First and last time (s).
    pub span: (f64, f64),
    /// Position at either (m).
    pub turns: (f64, f64),
    /// Stored energy lost (J).
    pub loss: f64,
    /// What the damping of the machine took of it (J).
    pub damped: f64,
    /// Friction force that took the rest (N).
    pub friction: Estimated,
}

/// Friction of each half swing between `reversals`, times of zero velocity (s), of a velocity `record` without offset
/// that begins at `initial_position` (m).
///
/// ```text
/// F = (E_j − E_{j+1} − ∫F_c(v) v dt)/|x_j − x_{j+1}|,       E = potential energy at a turning point
/// ```
///
/// Where the velocity is zero all energy is in the spring, so that no acceleration is needed, and only an integral of
/// the record. Noise of standard deviation σ adds up in it: u²(x) = σ² h t. The uncertainties take that into account,
/// for a linear spring; those of neighbouring half swings are correlated. Per unit mass
/// ([`Oscillator::per_unit_mass`]) F is F/m.
///
/// # Errors
/// [`IdentifyError::WrongRecord`], [`IdentifyError::OutOfRange`], [`IdentifyError::TooFew`] below one,
/// [`IdentifyError::InvalidInput`].
pub fn half_swing_losses(
    record: &Record,
    oscillator: &Oscillator,
    initial_position: f64,
    reversals: &[f64],
) -> Result<Vec<HalfSwing>, IdentifyError> {
    let quantity = record.quantity();
    if quantity != Quantity::Velocity {
        return Err(IdentifyError::velocity_needed("the energy at turning points", quantity));
    }
    let initial_position = ModelError::require_finite("initial position", initial_position, "m")?;
    check_reversals(record, reversals)?;
    let turns = integrated(record, record.values(), initial_position, 0.0, reversals, oscillator);
    let steps = Steps::walk(record, noise(record.values()), reversals);
    losses(&turns, &steps, Centre::Known, oscillator)
}

/// Friction of each half swing of a prepared ring-down, whose position is not known from elsewhere: as
/// [`half_swing_losses`], with the centre of the motion from the turning points themselves.
///
/// ```text
/// centre at x_{j+1} = (x_j + 2 x_{j+1} + x_{j+2})/4
/// ```
///
/// For a displacement it is their mean, unless the preparation holds an offset. The position that a velocity integrates
/// to drifts, by its offset (the slope of the line through these centres) and by whatever is slow in the instrument;
/// there each half swing has the mean of the centres around it. A difference of friction between the two directions is
/// then not seen. `oscillator` holds stiffness, mass and damping in the unit of the record; per unit mass F is F/m.
///
/// ```
/// use fmm_friction::Coulomb;
/// use fmm_identify::{Preparation, Experiment, half_swing_losses_of};
/// use fmm_model::Oscillator;
/// use fmm_record::{Quantity, Record};
/// use fmm_sim::{Engine, Exact, Sampling, Scenario};
///
/// let machine = Oscillator::per_unit_mass(2.0)?;
/// let scenario = Scenario::new(machine, Coulomb::new(0.1)?, 1.0)?.starting_at(0.02, 0.0)?;
/// let motion = Exact.run(&scenario, &Sampling::uniform(1e-3, 4000)?)?;
/// let values = motion.velocity().values().iter().map(|v| v + 0.003).collect();
/// let decay = Experiment::ring_down(&Record::new(0.0, 1e-3, values, Quantity::Velocity, "m/s")?, &Preparation::default())?;
///
/// for half_swing in half_swing_losses_of(&decay, &machine)? {
///     assert!((half_swing.friction.value / 0.1 - 1.0).abs() < 0.02, "{half_swing:?}");
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`IdentifyError::TooFew`] if the centre cannot be found.
pub fn half_swing_losses_of(decay: &Experiment, oscillator: &Oscillator) -> Result<Vec<HalfSwing>, IdentifyError> {
    decay.require_free("the energy of turning points")?;
    let record = decay.record();
    if record.quantity() == Quantity::Displacement {
        let (offset, centre) = match decay.fixed_offset() {
            Some(offset) => (offset, Centre::Known),
            None => (0.0, Centre::Constant),
        };
        let turns = measured(decay, offset, oscillator);
        let steps = Steps::Independent(decay.turning_point_uncertainty());
        return losses(&turns, &steps, centre, oscillator);
    }
    let mut times = reversals(decay);
    // A record that begins within a half swing has no turning point there.
    if times.len() > 2 && times[1] - times[0] < 0.9 * (times[2] - times[1]) {
        times.remove(0);
    }
    let values = bridged(decay);
    let turns_about = |offset: f64| integrated(record, &values, 0.0, offset, &times, oscillator);
    // The damping works on the velocity, not on its offset.
    let offset = decay.fixed_offset().unwrap_or_else(|| drift(&turns_about(0.0)));
    losses(&turns_about(offset), &Steps::walk(record, decay.white_noise(), &times), Centre::Local, oscillator)
}

/// Slope of the line through the centres of the motion (unit of velocity); 0 for fewer than two centres.
fn drift(turns: &[Turn]) -> f64 {
    let centres = || turns.windows(3).map(|three| (three[1].time, three_point_centre(three)));
    let count = centres().count() as f64;
    let mean = centres().fold((0.0, 0.0), |sum, (time, centre)| (sum.0 + time / count, sum.1 + centre / count));
    let squares: f64 = centres().map(|(time, _)| (time - mean.0).powi(2)).sum();
    let products: f64 = centres().map(|(time, centre)| (time - mean.0) * (centre - mean.1)).sum();
    if squares > 0.0 { products / squares } else { 0.0 }
}

fn three_point_centre(three: &[Turn]) -> f64 {
    three.iter().zip(THREE_POINTS).map(|(turn, weight)| weight * turn.position).sum()
}

/// Weights of three turning points in the centre of the motion: no loss per half swing disturbs it.
const THREE_POINTS: [f64; 3] = [0.25, 0.5, 0.25];

/// A turning point.
#[derive(Debug, Clone, Copy)]
struct Turn {
    time: f64,
    position: f64,
    /// Work of the damping force on the way to the next (J).
    damped: f64,
}

/// How the turning points lie about the force-free position.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Centre {
    /// About zero.
    Known,
    /// About a constant.
    Constant,
    /// About something that changes slowly.
    Local,
}

/// How the errors of the positions arise.
enum Steps {
    /// Each on its own, with this standard uncertainty.
    Independent(f64),
    /// Steps of these standard deviations, which add up.
    Walk(Vec<f64>),
}

impl Steps {
    fn walk(record: &Record, noise: f64, times: &[f64]) -> Self {
        let mut previous = record.start();
        let step = |time: &f64| {
            let duration = (time - previous).max(0.0);
            previous = *time;
            noise * (record.interval() * duration).sqrt()
        };
        Self::Walk(times.iter().map(step).collect())
    }

    /// Standard uncertainty of the sum of the positions with these weights.
    fn uncertainty(&self, weights: &[f64]) -> f64 {
        match self {
            Self::Independent(u) => u * weights.iter().map(|w| w * w).sum::<f64>().sqrt(),
            Self::Walk(steps) => {
                // A step moves all positions after it.
                let mut sum = 0.0;
                let squares = weights.iter().zip(steps).rev().map(|(weight, step)| {
                    sum += weight;
                    (sum * step).powi(2)
                });
                squares.sum::<f64>().sqrt()
            }
        }
    }
}

/// Turning points of a velocity: its integral, by straight lines between the samples.
fn integrated(
    record: &Record,
    values: &[f64],
    initial: f64,
    offset: f64,
    reversals: &[f64],
    oscillator: &Oscillator,
) -> Vec<Turn> {
    let damping = oscillator.damping();
    let h = record.interval();
    let mut area = Cumulative::new(h, values.iter().map(|v| v - offset));
    let mut work = Cumulative::new(h, values.iter().map(|v| (v - offset) * damping.force(v - offset)));
    let at: Vec<(f64, f64, f64)> = reversals
        .iter()
        .map(|time| {
            let since = time - record.start();
            (*time, initial + area.up_to(since), work.up_to(since))
        })
        .collect();
    let next = |i: usize| at.get(i + 1).map_or(0.0, |after| after.2 - at[i].2);
    at.iter().enumerate().map(|(i, &(time, position, _))| Turn { time, position, damped: next(i) }).collect()
}

/// Turning points of a displacement; the work of the damping is that of a sine.
fn measured(decay: &Experiment, offset: f64, oscillator: &Oscillator) -> Vec<Turn> {
    let peaks = decay.peaks();
    let turn = |(i, &(time, value)): (usize, &(f64, f64))| {
        let damped = peaks.get(i + 1).map_or(0.0, |&(end, next)| {
            let speed = 0.5 * PI * (next - value).abs() / (end - time);
            0.5 * oscillator.damping().cycle_equivalent(speed) * speed * speed * (end - time)
        });
        Turn { time, position: value - offset, damped }
    };
    peaks.iter().enumerate().map(turn).collect()
}

/// The integral of samples by the trapezoidal rule, up to times that increase.
struct Cumulative<I> {
    interval: f64,
    rest: I,
    index: f64,
    before: f64,
    after: f64,
    sum: f64,
}

impl<I: Iterator<Item = f64>> Cumulative<I> {
    fn new(interval: f64, mut samples: I) -> Self {
        let before = samples.next().unwrap_or(0.0);
        let after = samples.next().unwrap_or(before);
        Self { interval, rest: samples, index: 0.0, before, after, sum: 0.0 }
    }

    fn up_to(&mut self, time: f64) -> f64 {
        let at = time / self.interval;
        while self.index + 1.0 <= at {
            let Some(next) = self.rest.next() else { break };
            self.sum += 0.5 * (self.before + self.after);
            (self.before, self.after, self.index) = (self.after, next, self.index + 1.0);
        }
        let part = (at - self.index).clamp(0.0, 1.0);
        self.interval * (self.sum + part * (self.before + 0.5 * part * (self.after - self.before)))
    }
}

/// Centre of the motion in half swing `j` as weights of the turning points.
fn centre_weights(count: usize, centre: Centre, j: usize) -> Vec<f64> {
    let mut weights = vec![0.0; count];
    let centres = match centre {
        Centre::Known => 0..0,
        Centre::Constant => 0..count - 2,
        // Those at either end of the half swing, as far as they exist.
        Centre::Local => j.saturating_sub(1)..(j + 1).min(count - 2),
    };
    let share = 1.0 / centres.len() as f64;
    for first in centres {
        for (weight, part) in weights[first..].iter_mut().zip(THREE_POINTS) {
            *weight += share * part;
        }
    }
    weights
}

fn losses(
    turns: &[Turn],
    steps: &Steps,
    centre: Centre,
    oscillator: &Oscillator,
) -> Result<Vec<HalfSwing>, IdentifyError> {
    let needed = match centre {
        Centre::Known => 1,
        Centre::Constant | Centre::Local => 2,
    };
    let found = turns.len().saturating_sub(1);
    if found < needed {
        return Err(IdentifyError::too_few_half_swings(found, needed));
    }
    let half_swing = |(j, pair): (usize, &[Turn])| {
        let [from, to] = [pair[0], pair[1]];
        let at_middle = centre_weights(turns.len(), centre, j);
        let middle: f64 = at_middle.iter().zip(turns).map(|(weight, turn)| weight * turn.position).sum();
        let (first, last) = (from.position - middle, to.position - middle);
        let loss = oscillator.potential_energy(first) - oscillator.potential_energy(last);
        let distance = (last - first).abs();
        if !(distance > 0.0 && distance.is_finite()) {
            return Err(IdentifyError::amplitude(from.time, 0.5 * distance, "between turning points"));
        }
        // F is k/2 |x_j + x_{j+1} − 2 centre| less the damping, for a linear spring.
        let mut weights: Vec<f64> = at_middle.iter().map(|weight| -oscillator.stiffness() * weight).collect();
        weights[j] += 0.5 * oscillator.stiffness();
        weights[j + 1] += 0.5 * oscillator.stiffness();
        let friction = Estimated { value: (loss - from.damped) / distance, uncertainty: steps.uncertainty(&weights) };
        Ok(HalfSwing { span: (from.time, to.time), turns: (first, last), loss, damped: from.damped, friction })
    };
    turns.windows(2).enumerate().map(half_swing).collect()
}
