//! The excitations of a scenario, cut into pieces of time in which the force is a line plus waves.

use std::borrow::Cow;
use std::f64::consts::{FRAC_PI_2, PI};

use fmm_model::Scalar;

use crate::scenario::{Excitation, SampledLoad, Scenario, Source};

/// amplitude · cos(angular · (t − since) + phase), with t counted from the start of the simulation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ForceWave<D> {
    pub(crate) amplitude: D,
    pub(crate) angular: D,
    pub(crate) phase: D,
    /// Beginning of a pulse (s): the angle of a short pulse a long time after the start would be mostly rounding.
    since: D,
}

impl<D: Scalar> ForceWave<D> {
    /// Sine and cosine of the angle at `time` (s).
    pub(crate) fn sin_cos(&self, time: D) -> (D, D) {
        (self.angular * (time - self.since) + self.phase).sin_cos()
    }
}

/// The force and the normal load between two knots.
#[derive(Debug, Clone)]
pub(crate) struct Piece<D> {
    /// Start (s).
    pub(crate) start: f64,
    /// End (s); infinite for the last piece.
    pub(crate) end: f64,
    force: D,
    slope: D,
    pub(crate) waves: Vec<ForceWave<D>>,
    /// Normal load at the beginning (N), and its slope (N/s).
    load: D,
    load_slope: D,
}

impl<D: Scalar> Piece<D> {
    /// A force (N) at time 0 that grows by `slope` (N/s) for ever.
    pub(crate) fn line_from_zero(force: D, slope: D) -> Self {
        let zero = D::from(0.0);
        Self { start: 0.0, end: f64::INFINITY, force, slope, waves: Vec::new(), load: zero, load_slope: zero }
    }

    /// Straight part of the force at `time` (N), and its slope (N/s).
    pub(crate) fn line(&self, time: D) -> (D, D) {
        (self.force + self.slope * (time - self.start), self.slope)
    }

    /// Normal load at `time` (N), and its slope (N/s).
    pub(crate) fn normal_load(&self, time: D) -> (D, D) {
        (self.load + self.load_slope * (time - self.start), self.load_slope)
    }

    /// Angular frequencies (rad/s) of the waves that there are, those that exist in derivatives only left out: steps
    /// must not depend on them.
    pub(crate) fn frequencies(&self) -> impl Iterator<Item = f64> {
        self.waves.iter().filter(|wave| wave.amplitude.value() != 0.0).map(|wave| wave.angular.value())
    }

    /// True if the force without derivatives is constant.
    pub(crate) fn is_constant(&self) -> bool {
        self.waves.is_empty() && self.slope.value() == 0.0
    }

    /// The force (N) at `time`, if it is constant, in its derivatives too.
    pub(crate) fn constant_force(&self, time: D) -> Option<D> {
        let (force, slope) = self.line(time);
        let is_level = || (0..D::DIRECTIONS).all(|direction| slope.partial(direction) == 0.0);
        (self.is_constant() && is_level()).then_some(force)
    }

    /// True if there is no force.
    pub(crate) fn is_free(&self) -> bool {
        self.is_constant() && self.force.value() == 0.0
    }

    /// The force at `time` (N).
    pub(crate) fn force(&self, time: f64) -> D {
        self.force_at(D::from(time))
    }

    /// Writes the Taylor coefficients of the force (N) in time since `time` (s) in units of `unit` (s) into `series`.
    pub(crate) fn series(&self, time: f64, unit: f64, series: &mut [D]) {
        series.fill(D::from(0.0));
        let (force, slope) = self.line(D::from(time));
        if let [constant, linear, ..] = series {
            (*constant, *linear) = (force, slope * unit);
        }
        for wave in &self.waves {
            let (sin, cos) = wave.sin_cos(D::from(time));
            let (mut sin, mut cos) = (wave.amplitude * sin, wave.amplitude * cos);
            for (order, term) in series.iter_mut().enumerate() {
                *term += cos;
                let factor = wave.angular * (unit / (order + 1) as f64);
                (sin, cos) = (cos * factor, -(sin * factor));
            }
        }
    }

    /// The force at a `time` that may have derivatives (N).
    pub(crate) fn force_at(&self, time: D) -> D {
        let mut force = self.line(time).0;
        for wave in &self.waves {
            force += wave.amplitude * wave.sin_cos(time).1;
        }
        force
    }
}

/// All excitations of a scenario, and its normal load.
pub(crate) struct Forcing<'a, D> {
    excitations: &'a [Excitation<D>],
    mass: D,
    normal_load: D,
    sampled_load: Option<&'a SampledLoad<D>>,
    /// Times at which the force or the normal load changes its formula, ascending; the first is 0.
    knots: Cow<'static, [f64]>,
}

impl<'a, D: Scalar> Forcing<'a, D> {
    pub(crate) fn of<L: ?Sized>(scenario: &'a Scenario<D, L>) -> Self {
        let loads = (scenario.normal_load(), scenario.sampled_load());
        Self::new(scenario.excitations(), scenario.oscillator().mass(), loads)
    }

    fn new(
        excitations: &'a [Excitation<D>],
        mass: D,
        (normal_load, sampled_load): (D, Option<&'a SampledLoad<D>>),
    ) -> Self {
        // A force and a load without a knot, such as those of one step of a stepper, take no memory.
        let is_line = |excitation: &Excitation<D>| {
            let is_ramp = matches!(excitation.source, Source::Ramp { .. }) && excitation.delay.value() == 0.0;
            is_ramp || matches!(excitation.source, Source::Harmonic { .. } | Source::Base { .. } | Source::Belt { .. })
        };
        if sampled_load.is_none() && excitations.iter().all(is_line) {
            return Self { excitations, mass, normal_load, sampled_load, knots: Cow::Borrowed(&[0.0]) };
        }
        let mut knots = vec![0.0];
        if let Some(SampledLoad { interval, values }) = sampled_load {
            knots.extend((0..values.len()).map(|index| index as f64 * interval));
        }
        for Excitation { source, delay } in excitations {
            let delay = delay.value();
            match source {
                Source::SampledForce { interval, values } => {
                    for index in 0..values.len() {
                        // A sample on the line through its neighbours is no knot, so that quiet parts cost nothing.
                        let straight = index > 0
                            && index + 1 < values.len()
                            && is_straight(values[index - 1], values[index], values[index + 1]);
                        if !straight {
                            knots.push(delay + index as f64 * interval);
                        }
                    }
                }
                Source::HalfSine { duration, .. } => knots.extend([delay, delay + duration.value()]),
                Source::Ramp { .. } => knots.push(delay),
                Source::Harmonic { .. } | Source::Base { .. } | Source::Belt { .. } => {}
            }
        }
        knots.sort_by(f64::total_cmp);
        knots.dedup();
        Self { excitations, mass, normal_load, sampled_load, knots: Cow::Owned(knots) }
    }

    /// True if the counterface moves, or may move in a derivative.
    pub(crate) fn has_belt(&self) -> bool {
        self.excitations.iter().any(|excitation| matches!(excitation.source, Source::Belt { .. }))
    }

    /// Velocity of the counterface (m/s).
    pub(crate) fn belt(&self) -> D {
        self.excitations.iter().fold(D::from(0.0), |sum, excitation| match excitation.source {
            Source::Belt { velocity } => sum + velocity,
            _ => sum,
        })
    }

    /// The forces (N) that jump at the beginning of the piece of this `index`, each with the derivatives of its time
    /// (s), whose value is zero.
    fn jumps(&self, index: usize) -> impl Iterator<Item = (D, D)> {
        let time = self.knots[index];
        let of = move |Excitation { source, delay }: &Excitation<D>| {
            let at = |knot: f64, force: Option<D>| {
                let force = force.filter(|force| knot == time && force.value() != 0.0);
                force.map(|force| (force, *delay - delay.value()))
            };
            match source {
                // A single sample has no duration.
                Source::SampledForce { interval, values } if values.len() > 1 => {
                    let last = delay.value() + (values.len() - 1) as f64 * interval;
                    [at(delay.value(), values.first().copied()), at(last, values.last().map(|force| -*force))]
                }
                Source::Ramp { force, .. } => [at(delay.value(), Some(*force)), None],
                _ => [None, None],
            }
        };
        self.excitations.iter().flat_map(of).flatten()
    }

    /// The impulse (N s), zero but for its derivatives, that a moving body has gained by the beginning of the piece of
    /// this `index` because a force has jumped at a time which has derivatives.
    pub(crate) fn impulse_of_jumps(&self, index: usize) -> D {
        let zero = D::from(0.0);
        if D::DIRECTIONS == 0 {
            return zero;
        }
        self.jumps(index).fold(zero, |sum, (force, late)| sum - late * force.value())
    }

    /// The derivatives of the time at which the force jumps at the beginning of the piece of this `index`, their value
    /// being zero; `None` if it does not jump.
    pub(crate) fn time_of_jump(&self, index: usize) -> Option<D> {
        self.jumps(index).max_by(|a, b| a.0.value().abs().total_cmp(&b.0.value().abs())).map(|(_, late)| late)
    }

    /// Number of pieces.
    pub(crate) fn pieces(&self) -> usize {
        self.knots.len()
    }

    /// The piece of this `index`.
    pub(crate) fn piece(&self, index: usize) -> Piece<D> {
        let start = self.knots[index];
        let end = self.knots.get(index + 1).copied().unwrap_or(f64::INFINITY);
        let middle = if end.is_finite() { start + 0.5 * (end - start) } else { f64::INFINITY };
        let zero = D::from(0.0);
        let mut piece =
            Piece { start, end, force: zero, slope: zero, waves: Vec::new(), load: self.normal_load, load_slope: zero };
        if let Some(SampledLoad { interval, values }) = self.sampled_load {
            let last = (values.len() - 1) as f64 * interval;
            let at = |time: f64| interpolated(values, *interval, 0.0, time.min(last));
            piece.load = at(start);
            if middle < last {
                piece.load_slope = (at(end) - at(start)) / (end - start);
            }
        }
        for Excitation { source, delay } in self.excitations {
            let begun = start >= delay.value();
            // How much later it is in derivatives.
            let late = *delay - delay.value();
            match source {
                Source::SampledForce { interval, values } => {
                    let position = (middle - delay.value()) / interval;
                    if position > 0.0 && position < values.len().saturating_sub(1) as f64 {
                        // From knot to knot, so that rounding of a knot's time does not move the force there.
                        let at = |time: f64| interpolated(values, *interval, delay.value(), time);
                        let slope = (at(end) - at(start)) / (end - start);
                        piece.force = piece.force + at(start) - slope * late;
                        piece.slope += slope;
                    }
                }
                Source::HalfSine { peak, duration } if begun && middle < (*delay + *duration).value() => {
                    let (angular, phase) = (D::from(PI) / *duration, D::from(-FRAC_PI_2));
                    piece.waves.push(ForceWave { amplitude: *peak, angular, phase, since: *delay });
                }
                Source::Ramp { force, rate } if begun => {
                    piece.force = piece.force + *force + *rate * (-*delay + start);
                    piece.slope += *rate;
                }
                Source::Harmonic { amplitude, angular, phase } => {
                    let (amplitude, angular, phase) = (*amplitude, *angular, *phase);
                    piece.waves.push(ForceWave { amplitude, angular, phase, since: zero });
                }
                Source::Base { amplitude, angular, phase } => {
                    let amplitude = self.mass * *amplitude * *angular * *angular;
                    piece.waves.push(ForceWave { amplitude, angular: *angular, phase: *phase, since: zero });
                }
                Source::HalfSine { .. } | Source::Ramp { .. } | Source::Belt { .. } => {}
            }
        }
        piece.waves.retain(|wave| wave.amplitude.value() != 0.0 || D::DIRECTIONS > 0);
        piece
    }
}

/// True if three samples lie on a line, with their derivatives.
fn is_straight<D: Scalar>(before: D, here: D, after: D) -> bool {
    let bend = |before: f64, here: f64, after: f64| after - here != here - before;
    !bend(before.value(), here.value(), after.value())
        && !(0..D::DIRECTIONS).any(|d| bend(before.partial(d), here.partial(d), after.partial(d)))
}

/// The sampled force (N) at `time`, which lies between its first and its last sample; exactly a sample at its own time.
fn interpolated<D: Scalar>(values: &[D], interval: f64, delay: f64, time: f64) -> D {
    let position = ((time - delay) / interval).max(0.0);
    let nearest = position.round() as usize;
    if nearest < values.len() && delay + nearest as f64 * interval == time {
        return values[nearest];
    }
    let left = (position as usize).min(values.len().saturating_sub(2));
    values[left] + (values[left + 1] - values[left]) * (position - left as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_follow_the_sum_of_all_forces() {
        let excitations = [
            Excitation::sampled_force(0.1, vec![0.0, 2.0, 4.0, 6.0, 1.0, 1.0, 1.0]).unwrap(),
            Excitation::half_sine(10.0, 0.25).unwrap().delayed(0.05).unwrap(),
            Excitation::ramp(3.0).unwrap(),
            Excitation::harmonic(1.5, 7.0, 0.3).unwrap(),
            Excitation::base(0.01, 20.0, 1.0).unwrap(),
            Excitation::belt(0.2).unwrap(),
        ];
        let drive: Forcing<f64> = Forcing::new(&excitations, 2.0, (0.0, None));
        // 0, the straight samples 1 and 2 left out, the pulse from 0.05 to 0.3, the last sample.
        assert_eq!(drive.pieces(), 6, "{:?}", drive.knots);
        assert_eq!(drive.belt(), 0.2);
        for index in 0..drive.pieces() {
            let piece = drive.piece(index);
            let end = if piece.end.is_finite() { piece.end } else { piece.start + 1.0 };
            for part in [0.1, 0.5, 0.9] {
                let t = piece.start + part * (end - piece.start);
                let sampled = match t {
                    t if t < 0.3 => 20.0 * t,
                    t if t < 0.4 => 6.0 - 50.0 * (t - 0.3),
                    t if t < 0.6 => 1.0,
                    _ => 0.0,
                };
                let pulse = if (0.05..0.3).contains(&t) { 10.0 * (PI * (t - 0.05) / 0.25).sin() } else { 0.0 };
                let waves = 1.5 * (7.0 * t + 0.3).cos() + 2.0 * 0.01 * 400.0 * (20.0 * t + 1.0).cos();
                let expected = sampled + pulse + 3.0 * t + waves;
                assert!((piece.force(t) - expected).abs() < 1e-13, "at {t} s: not {expected} N");
            }
        }
    }

    #[test]
    fn an_empty_record_is_no_force() {
        let excitations = [Excitation::<f64>::sampled_force(0.1, Vec::new()).unwrap()];
        assert!(Forcing::new(&excitations, 1.0, (0.0, None)).piece(0).is_free());
        assert!(Excitation::<f64>::sampled_force(0.1, vec![f64::NAN]).is_err());
        assert!(Excitation::<f64>::half_sine(1.0, 0.0).is_err());
        assert!(Excitation::<f64>::ramp(1.0).unwrap().delayed(-1.0).is_err());
    }
}
