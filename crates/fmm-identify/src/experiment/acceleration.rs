//! Ring-down recorded by an accelerometer: the velocity that shows its half cycles, and the jumps where dry
//! friction reverses.

use std::f64::consts::PI;
use std::ops::Range;

use fmm_record::{Quantity, Record, Swings, noise};
use nalgebra::{DMatrix, DVector};

use crate::experiment::first_guess::FirstGuess;

/// The velocity of an `acceleration`, less what drifts more slowly than a period; `None` if nothing swings.
///
/// Of a record that ends in rest, the rest tells the offset and that the velocity is zero. Otherwise the integral of an
/// offset is a slope, and that of noise a walk: both are in the mean over a period, the motion is not.
pub(super) fn velocity_of(acceleration: &Record) -> Option<Record> {
    if let Some((offset, rest)) = offset_of_rest(acceleration) {
        let velocity = acceleration.shifted(offset).ok()?.integrate(0.0).ok()?;
        let at_rest = velocity.values()[rest];
        let values = velocity.values().iter().enumerate();
        let values = values.map(|(at, value)| if at < rest { value - at_rest } else { 0.0 }).collect();
        return Record::new(velocity.start(), velocity.interval(), values, Quantity::Velocity, velocity.unit()).ok();
    }
    let period = acceleration.rate() / Swings::of(acceleration).frequency()?;
    let velocity = acceleration.shifted(acceleration.mean()).ok()?.integrate(0.0).ok()?;
    let values = velocity.values();
    let half = (0.5 * period).round() as usize;
    if half == 0 || values.len() < 4 * half {
        return None;
    }
    let mut sums = vec![0.0; values.len() + 1];
    for (index, value) in values.iter().enumerate() {
        sums[index + 1] = sums[index] + value;
    }
    // The window has the length of a period, its ends count half.
    let mean = |at: usize| {
        let inner = sums[at + half] - sums[at + 1 - half];
        (inner + 0.5 * (values[at - half] + values[at + half])) / (2 * half) as f64
    };
    let (first, last) = (half, values.len() - 1 - half);
    let slope = |from: usize, to: usize| (mean(to) - mean(from)) / (to - from).max(1) as f64;
    let slopes = (slope(first, (first + 2 * half).min(last)), slope(last.saturating_sub(2 * half).max(first), last));
    let drift = |at: usize| {
        if at < first {
            mean(first) - slopes.0 * (first - at) as f64
        } else if at > last {
            mean(last) + slopes.1 * (at - last) as f64
        } else {
            mean(at)
        }
    };
    let values = values.iter().enumerate().map(|(at, value)| value - drift(at)).collect();
    Record::new(velocity.start(), velocity.interval(), values, Quantity::Velocity, velocity.unit()).ok()
}

/// Mean of the last eighth of an `acceleration` and the first sample of the rest that it is part of; `None` if it moves
/// there.
fn offset_of_rest(acceleration: &Record) -> Option<(f64, usize)> {
    /// Standard deviations of a mean.
    const FAR: f64 = 5.0;
    /// Samples over which a mean shows motion.
    const FEW: usize = 8;
    let values = acceleration.values();
    let rest = &values[values.len() - values.len() / 8..];
    if rest.len() < FEW {
        return None;
    }
    let largest = values.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
    let (first, second) = rest.split_at(rest.len() / 2);
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let level = mean(rest);
    let noise = noise(values).max(1e-9 * largest);
    let spread = (rest.iter().map(|value| (value - level).powi(2)).sum::<f64>() / rest.len() as f64).sqrt();
    let moves = (mean(first) - mean(second)).abs() > FAR * noise / (0.25 * rest.len() as f64).sqrt();
    if moves || spread > 1.5 * noise {
        return None;
    }
    let is_moving = |few: &[f64]| (mean(few) - level).abs() > FAR * noise / (FEW as f64).sqrt();
    let last = values.windows(FEW).rposition(is_moving)?;
    Some((level, (last + FEW).min(values.len() - 1)))
}

/// The time (s) at which a `velocity` changes its sign, as near to `time` (s) as it does within a quarter of a half
/// swing; `time` if it does not. A crossing of the centre of two peaks lies off where the one is much smaller than the
/// other.
fn zero_near(velocity: &Record, time: f64, guess: &FirstGuess) -> f64 {
    let place = (time - velocity.start()) * velocity.rate();
    let reach = 0.125 * velocity.rate() / guess.frequency();
    let values = velocity.values();
    let (low, high) = ((place - reach).max(0.0) as usize, ((place + reach).max(0.0) as usize).min(values.len() - 1));
    let changes = (low..high).filter(|&at| values[at] * values[at + 1] < 0.0);
    let times = changes.map(|at| at as f64 + values[at] / (values[at] - values[at + 1]));
    let nearest = times.min_by(|a, b| (a - place).abs().total_cmp(&(b - place).abs()));
    nearest.map_or(time, |place| velocity.start() + place * velocity.interval())
}

/// Samples on either side of a jump over which a sensor may smear it. Origin: chosen; anti-aliasing filters near half
/// the sampling rate ring for about as many.
const SMEARED: f64 = 3.0;

/// Acceleration around reversals: it jumps there or not, and its white noise.
struct AroundReversals {
    is_smooth: bool,
    noise: f64,
}

/// The `acceleration` of this `noise` around reversals at `times` (s); it is smooth if it shows that it jumps at none
/// of them by more than twice the noise, which a sample beside a jump does not show.
///
/// Around each of them it is fitted by a vibration whose amplitude changes, and a step s:
///
/// ```text
/// a(τ) = a₀ + (a₁ + a₂ τ) cos ωτ + a₃ sin ωτ + s sgn τ
/// ```
///
/// Friction makes steps against the acceleration at all of them. Jumps between few samples look like noise, of which
/// the residuals have less.
fn around_reversals(times: &[f64], noise: f64, guess: &FirstGuess, acceleration: &Record) -> AroundReversals {
    /// Part of the way to the next reversals that is fitted (1). Origin: what a sensor smears there is left out.
    const PART: f64 = 0.9;
    /// Standard uncertainties that a hidden step may have (1). Origin: one in 44 by chance.
    const REACH: f64 = 2.0;
    /// Step over noise that no sample shows (1). Origin: half of it is the noise.
    const HIDDEN: f64 = 2.0;
    let half_period = 0.5 / guess.frequency();
    let (mut weights, mut steps, mut squares, mut freedom) = (0.0, 0.0, 0.0, 0.0);
    for time in times {
        let place = (time - acceleration.start()) * acceleration.rate();
        let reach = PART * half_period * acceleration.rate();
        let beside = |at: &usize| (*at as f64 - place).abs() > SMEARED;
        let (low, high) = ((place - reach).ceil().max(0.0) as usize, (place + reach).max(0.0) as usize + 1);
        let samples: Vec<usize> = (low..high.min(acceleration.len())).filter(beside).collect();
        let row = |at: usize| {
            let part = (at as f64 - place) / (half_period * acceleration.rate());
            let (sine, cosine) = (PI * part).sin_cos();
            [1.0, cosine, part * cosine, sine, part.signum()]
        };
        let shapes = DMatrix::from_fn(samples.len(), 5, |at, column| row(samples[at])[column]);
        let values = DVector::from_fn(samples.len(), |at, _| acceleration.values()[samples[at]]);
        let Some(inverse) = shapes.tr_mul(&shapes).cholesky().map(|cholesky| cholesky.inverse()) else { continue };
        let fitted = &inverse * shapes.tr_mul(&values);
        squares += (values - shapes * &fitted).norm_squared();
        freedom += samples.len() as f64 - 5.0;
        let weight = inverse[(4, 4)].recip();
        weights += weight;
        steps += weight * fitted[4] * fitted[1].signum();
    }
    if !(freedom > 0.0) {
        return AroundReversals { is_smooth: false, noise };
    }
    let scatter = (squares / freedom).sqrt();
    let noise = noise.min(scatter);
    // The function sgn steps by two.
    let (step, uncertainty) = (2.0 * steps.abs() / weights, 2.0 * scatter / weights.sqrt());
    AroundReversals { is_smooth: step + REACH * uncertainty < HIDDEN * noise, noise }
}

/// The samples beside the changes of sign of a `velocity` near its `crossings` (s), the release and the stop among
/// them, in order, if its `acceleration` jumps there, with the noise of the acceleration, at most `noise`.
pub(super) fn jumps(
    crossings: &[f64],
    noise: f64,
    guess: &FirstGuess,
    velocity: &Record,
    acceleration: &Record,
) -> (Vec<Range<usize>>, f64) {
    /// Standard deviations of the time of a jump.
    const DEVIATIONS: f64 = 4.0;
    /// Part of a half cycle beside a jump that is left out at most for a sensor (1). Origin: chosen; with few samples
    /// what is left must show the motion.
    const MOST: f64 = 0.15;
    let times: Vec<f64> = crossings.iter().map(|time| zero_near(velocity, *time, guess)).collect();
    let half_period = 0.5 / guess.frequency();
    let AroundReversals { is_smooth, noise } = around_reversals(&times, noise, guess, acceleration);
    let smeared = SMEARED.min(MOST * half_period * velocity.rate());
    // A release at a turning point is one, and so is the stop. Before the first crossing that shows there may be
    // others.
    let before = |first: &f64| ((first - velocity.start()) / half_period + 0.5).max(1.0) as usize;
    let first = times.first().map(|first| (1..=before(first)).rev().map(move |k| first - k as f64 * half_period));
    let earlier: Vec<f64> = first.into_iter().flatten().collect();
    let stop = times.last().map(|last| last + half_period);
    let angular = 2.0 * PI * guess.frequency();
    // Of a velocity that was integrated over about a period.
    let uncertain = noise * (2.0 * half_period * velocity.interval()).sqrt();
    let earlier_count = earlier.len();
    let range = |(turn, time): (usize, f64)| {
        let amplitude = guess.amplitudes.get(turn.saturating_sub(earlier_count)).or(guess.amplitudes.last());
        let amplitude = amplitude.copied().unwrap_or(f64::INFINITY);
        let time_uncertain = (uncertain / (angular * amplitude)).min(0.1 * half_period);
        let reach = smeared + DEVIATIONS * time_uncertain * velocity.rate();
        let place = (time - velocity.start()) * velocity.rate();
        let end = (place + reach).floor().max(-1.0) + 1.0;
        (place - reach).ceil().max(0.0) as usize..(end as usize).min(velocity.len())
    };
    let shown = earlier_count..earlier_count + times.len();
    let all = earlier.into_iter().chain(times).chain(stop).enumerate();
    // A release and a stop jump without friction too.
    let jumps = all.filter(|(turn, _)| !is_smooth || !shown.contains(turn));
    (jumps.map(range).filter(|range| !range.is_empty()).collect(), noise)
}
