//! Functions of time that are a line, waves and a free decay, and the first zero of one.

use fmm_model::Scalar;

use crate::error::SimulationError;
use crate::mechanics::decay::Ahead;
use crate::mechanics::{Decay, ForceWave, Piece};
use crate::scenario::State;

/// cosine · cos(angular τ) + sine · sin(angular τ).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wave<D> {
    pub(crate) angular: D,
    pub(crate) cosine: D,
    pub(crate) sine: D,
}

/// constant + slope τ + Σ waves + h(τ), with h the free decay from `free` at τ = 0.
///
/// Position, velocity and acceleration of a linear machine, the load on a contact that holds, and every linear
/// combination of these are such curves, so one search for a first zero serves all events.
#[derive(Debug, Clone)]
pub(crate) struct Curve<'a, D> {
    pub(crate) constant: D,
    pub(crate) slope: D,
    pub(crate) waves: Vec<Wave<D>>,
    /// The free decay and its state at τ = 0.
    pub(crate) decay: Option<(&'a Decay<D>, State<D>)>,
}

/// Value, slope and curvature of a curve at one time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Jet {
    pub(crate) value: f64,
    pub(crate) slope: f64,
    pub(crate) curvature: f64,
    /// Bounds of |second| and |third derivative| from that time on.
    pub(crate) most_curvature: f64,
    pub(crate) most_jerk: f64,
    /// Sum of the magnitudes of the terms, whose rounding the value carries.
    pub(crate) size: f64,
}

impl<'a, D: Scalar> Curve<'a, D> {
    /// A line.
    #[cfg(test)]
    pub(crate) fn line(constant: D, slope: D) -> Self {
        Self { constant, slope, waves: Vec::new(), decay: None }
    }

    /// The force of `piece`, with τ counted from `time`.
    pub(crate) fn force(piece: &Piece<D>, time: D) -> Self {
        let (constant, slope) = piece.line(time);
        let wave = |wave: &ForceWave<D>| {
            let (sin, cos) = wave.sin_cos(time);
            Wave { angular: wave.angular, cosine: wave.amplitude * cos, sine: -wave.amplitude * sin }
        };
        // Without waves nothing is collected, which is most of the time.
        let waves = if piece.waves.is_empty() { Vec::new() } else { piece.waves.iter().map(wave).collect() };
        Self { constant, slope, waves, decay: None }
    }

    /// The curve plus a free decay from `state`.
    pub(crate) fn decaying(mut self, decay: &'a Decay<D>, state: State<D>) -> Self {
        self.decay = Some((decay, state));
        self
    }

    /// True for a constant plus a decay, in its derivatives too.
    pub(crate) fn is_free(&self) -> bool {
        let level = || (0..D::DIRECTIONS).all(|direction| self.slope.partial(direction) == 0.0);
        self.waves.is_empty() && self.slope.value() == 0.0 && level()
    }

    /// True if the curve without derivatives is a constant plus a decay.
    pub(crate) fn is_plainly_free(&self) -> bool {
        self.frequencies().next().is_none() && self.slope.value() == 0.0
    }

    /// Angular frequencies (rad/s) of the waves, except those that exist in derivatives only.
    pub(crate) fn frequencies(&self) -> impl Iterator<Item = f64> {
        let is_there = |wave: &&Wave<D>| wave.cosine.value() != 0.0 || wave.sine.value() != 0.0;
        self.waves.iter().filter(is_there).map(|wave| wave.angular.value())
    }

    /// The value at τ = 0.
    pub(crate) fn now(&self) -> D {
        let free = self.decay.map_or(D::from(0.0), |(_, state)| state.position);
        self.waves.iter().fold(self.constant + free, |sum, wave| sum + wave.cosine)
    }

    /// The slope at τ = 0.
    pub(crate) fn slope_now(&self) -> D {
        let free = self.decay.map_or(D::from(0.0), |(_, state)| state.velocity);
        self.waves.iter().fold(self.slope + free, |sum, wave| sum + wave.sine * wave.angular)
    }

    /// The value a time `elapsed` after τ = 0.
    pub(crate) fn at(&self, elapsed: D) -> D {
        let mut value = self.constant + self.slope * elapsed;
        for wave in &self.waves {
            let (sin, cos) = (wave.angular * elapsed).sin_cos();
            value = value + wave.cosine * cos + wave.sine * sin;
        }
        if let Some((decay, state)) = self.decay {
            value += decay.advance(state, elapsed).position;
        }
        value
    }

    /// Value and slope together, which share all but a few operations.
    pub(crate) fn state(&self, elapsed: D) -> State<D> {
        let forced = self.forced_state(elapsed);
        let Some((decay, free)) = self.decay else { return forced };
        let free = decay.advance(free, elapsed);
        State { position: forced.position + free.position, velocity: forced.velocity + free.velocity }
    }

    /// Value and slope without the free decay.
    pub(crate) fn forced_state(&self, elapsed: D) -> State<D> {
        let mut state = State { position: self.constant + self.slope * elapsed, velocity: self.slope };
        for wave in &self.waves {
            let (sin, cos) = (wave.angular * elapsed).sin_cos();
            state.position = state.position + wave.cosine * cos + wave.sine * sin;
            state.velocity += (wave.sine * cos - wave.cosine * sin) * wave.angular;
        }
        state
    }

    /// The derivative with respect to time.
    pub(crate) fn derivative(&self) -> Self {
        let wave = |wave: &Wave<D>| Wave {
            angular: wave.angular,
            cosine: wave.sine * wave.angular,
            sine: -wave.cosine * wave.angular,
        };
        Self {
            constant: self.slope,
            slope: D::from(0.0),
            waves: self.waves.iter().map(wave).collect(),
            decay: self.decay.map(|(decay, state)| (decay, decay.derivative(state))),
        }
    }

    /// `factor` times the curve plus `shift`.
    pub(crate) fn scaled(mut self, factor: D, shift: D) -> Self {
        self.constant = self.constant * factor + shift;
        self.slope *= factor;
        for wave in &mut self.waves {
            wave.cosine *= factor;
            wave.sine *= factor;
        }
        self.decay = self.decay.map(|(decay, state)| {
            (decay, State { position: state.position * factor, velocity: state.velocity * factor })
        });
        self
    }

    /// A curve without decay, without derivatives.
    pub(crate) fn plain_without_decay(&self) -> Curve<'static, f64> {
        let wave = |wave: &Wave<D>| Wave {
            angular: wave.angular.value(),
            cosine: wave.cosine.value(),
            sine: wave.sine.value(),
        };
        let waves = self.waves.iter().map(wave).collect();
        Curve { constant: self.constant.value(), slope: self.slope.value(), waves, decay: None }
    }

    /// The jet of the curve without derivatives.
    pub(crate) fn plain_jet(&self, elapsed: f64) -> Jet {
        match self.decay {
            Some((decay, _)) => self.plain(&decay.plain()).jet(elapsed),
            None => self.plain_without_decay().jet(elapsed),
        }
    }

    /// The curve without derivatives; `decay` is the decay without derivatives.
    pub(crate) fn plain<'b>(&self, decay: &'b Decay<f64>) -> Curve<'b, f64> {
        let free = self
            .decay
            .map(|(_, state)| (decay, State { position: state.position.value(), velocity: state.velocity.value() }));
        Curve { decay: free, ..self.plain_without_decay() }
    }
}

impl Curve<'_, f64> {
    /// The curve, known to begin at zero and not to fall. Its free part takes up the rounding of the value, and that of
    /// a slope that does not exceed `noise`. Beside a fast decay the rounding would outlast the motion.
    pub(crate) fn risen_from_zero(mut self, noise: f64) -> Self {
        let forced = self.forced_state(0.0);
        if let Some((decay, free)) = &mut self.decay {
            free.position = -forced.position;
            if forced.velocity + free.velocity <= noise {
                free.velocity = -forced.velocity;
                let forced_curvature =
                    self.waves.iter().map(|wave| wave.cosine * wave.angular * wave.angular).sum::<f64>();
                if !(decay.derivative(*free).velocity > forced_curvature) {
                    free.velocity += noise;
                }
            }
        }
        self
    }

    /// Value, derivatives and their bounds at `elapsed`.
    pub(crate) fn jet(&self, elapsed: f64) -> Jet {
        let mut jet = Jet {
            value: self.constant + self.slope * elapsed,
            slope: self.slope,
            curvature: 0.0,
            most_curvature: 0.0,
            most_jerk: 0.0,
            size: self.constant.abs() + (self.slope * elapsed).abs(),
        };
        for wave in &self.waves {
            let (sin, cos) = (wave.angular * elapsed).sin_cos();
            let square = wave.angular * wave.angular;
            let amplitude = wave.cosine.hypot(wave.sine);
            jet.value += wave.cosine * cos + wave.sine * sin;
            jet.slope += (wave.sine * cos - wave.cosine * sin) * wave.angular;
            jet.curvature -= (wave.cosine * cos + wave.sine * sin) * square;
            jet.most_curvature += amplitude * square;
            jet.most_jerk += amplitude * square * wave.angular;
            // The angle itself is rounded, to as many ulp as it has turns.
            jet.size += amplitude * (1.0 + wave.angular * elapsed);
        }
        if let Some((decay, free)) = self.decay {
            let Ahead { derivatives, most } = decay.ahead(free, elapsed);
            jet.value += derivatives[0];
            jet.slope += derivatives[1];
            jet.curvature += derivatives[2];
            jet.most_curvature += most[2];
            jet.most_jerk += most[3];
            jet.size += most[0];
        }
        jet
    }
}

/// Greatest number of steps of all searches of a run: a contact that holds under a wave for a million periods is no
/// record.
pub(crate) const SEARCH_BUDGET: usize = 5_000_000;

/// Rounding of a value, in units of the sum of the magnitudes of its terms.
pub(crate) const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Greatest distance below zero, in units of the sum of the terms, at which a curve may begin that is known to rise
/// from zero: its terms are rounded sums.
const AT_ZERO: f64 = 1e-12;

/// The first time in (0, `limit`] at which `curve`, positive until then, reaches zero.
///
/// From each point the curve lies above its tangent less the parabola of its greatest curvature ahead. The search goes
/// to where that lower bound reaches zero, which the curve cannot do before, so that no zero is missed however close
/// two of them are. Near a simple zero this is Newton's method from the near side, and converges as fast.
///
/// A zero at the start does not count if the curve rises from it. If it neither rises nor is positive, the start is the
/// zero.
///
/// # Errors
/// [`SimulationError::Exhausted`] if `budget` steps are not enough.
pub(crate) fn first_zero(curve: &Curve<f64>, limit: f64, budget: &mut usize) -> Result<Option<f64>, SimulationError> {
    let mut elapsed = 0.0;
    loop {
        let Jet { value, slope, curvature, most_curvature, most_jerk, size } = curve.jet(elapsed);
        if !(value.is_finite() && slope.is_finite() && most_curvature.is_finite()) {
            return Err(SimulationError::NotFinite { time: elapsed });
        }
        let level = 1e-13 * (most_curvature * size).sqrt();
        let (rises, falls) = (slope > level, slope < -level);
        let bends = !falls && curvature > 1e-13 * most_curvature;
        if elapsed == 0.0 && value < -(if rises || bends { AT_ZERO } else { ROUNDING }) * size {
            return Ok(Some(0.0));
        }
        let low = value <= ROUNDING * size;
        if low && slope < 0.0 && elapsed > 0.0 {
            return Ok(Some(elapsed));
        }
        let value = value.max(0.0);
        // The positive root of value + slope h − most_curvature h²/2, without cancellation.
        let root = (slope * slope + 2.0 * most_curvature * value).sqrt();
        let mut step = if slope > 0.0 { (slope + root) / most_curvature } else { 2.0 * value / (root - slope) };
        if most_curvature == 0.0 {
            // A straight line.
            step = if slope < 0.0 { value / -slope } else { f64::INFINITY };
        } else if low && !rises {
            // It starts from zero with hardly any slope: the curvature decides.
            if !bends {
                return Ok((elapsed == 0.0 || slope < 0.0).then_some(elapsed));
            }
            step = step.max(curvature / most_jerk.max(f64::MIN_POSITIVE));
        }
        let next = elapsed + step;
        if !(next < limit) {
            return Ok(at_limit(curve, elapsed, limit));
        }
        if next <= elapsed {
            return Ok(Some(elapsed));
        }
        elapsed = next;
        *budget = budget.checked_sub(1).ok_or_else(|| SimulationError::event_budget(SEARCH_BUDGET, limit))?;
    }
}

/// The bound reaches zero at or after `limit`: the limit is a zero only if the curve has come down to it there.
fn at_limit(curve: &Curve<f64>, elapsed: f64, limit: f64) -> Option<f64> {
    if !limit.is_finite() || elapsed >= limit {
        return None;
    }
    let Jet { value, slope, size, .. } = curve.jet(limit);
    (value <= ROUNDING * size && slope < 0.0).then_some(limit)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(constant: f64, angular: f64, cosine: f64, sine: f64) -> Curve<'static, f64> {
        let mut curve = Curve::line(constant, 0.0);
        curve.waves.push(Wave { angular, cosine, sine });
        curve
    }

    fn zero(curve: &Curve<f64>, limit: f64) -> Option<f64> {
        first_zero(curve, limit, &mut 10_000).unwrap()
    }

    #[test]
    fn finds_the_first_of_two_close_zeros_and_none_that_is_not_there() {
        // 1 + δ + cos τ touches −δ or misses zero by δ at π.
        for gap in [1e-3, 1e-6, 1e-9, 1e-12] {
            let first = zero(&wave(1.0 - gap, 1.0, 1.0, 0.0), 10.0).expect("two zeros around π");
            let expected = (gap - 1.0f64).acos();
            // cos is flat there: an error of 1e-15 in the value moves the zero by 1e-15/√(2 δ).
            assert!((first - expected).abs() < 2e-15 / (2.0 * gap).sqrt() + 1e-15, "δ = {gap}: {first}");
            assert_eq!(zero(&wave(1.0 + gap, 1.0, 1.0, 0.0), 1000.0), None, "δ = {gap}");
        }
    }

    #[test]
    fn leaves_a_zero_at_the_start_behind() {
        // sin τ rises from zero; 1 − cos τ has no slope there.
        let sine = zero(&wave(0.0, 2.0, 0.0, 1.0), 10.0).unwrap();
        assert!((sine - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        let mut cosine = wave(1.0, 1.0, -1.0, 0.0);
        cosine.slope = -0.01;
        let mut lifted = cosine.clone();
        lifted.slope = 0.0;
        assert_eq!(zero(&lifted, 6.0), None);
        assert_eq!(zero(&wave(0.0, 1.0, 0.0, -1.0), 10.0), Some(0.0), "it falls from zero");
        // 1 − cos τ − τ/2 falls from zero although it bends upwards.
        let mut bent = wave(1.0, 1.0, -1.0, 0.0);
        bent.slope = -0.5;
        assert_eq!(zero(&bent, 10.0), Some(0.0));
    }

    #[test]
    fn lines_need_one_division() {
        assert_eq!(zero(&Curve::line(3.0, -2.0), 10.0), Some(1.5));
        assert_eq!(zero(&Curve::line(3.0, -2.0), 1.5), Some(1.5));
        assert_eq!(zero(&Curve::line(3.0, -2.0), 1.4), None);
        assert_eq!(zero(&Curve::line(3.0, 0.0), f64::INFINITY), None);
        assert_eq!(zero(&Curve::line(0.0, 1.0), f64::INFINITY), None);
    }

    #[test]
    fn an_endless_search_ends_with_an_error() {
        let error = first_zero(&wave(1.5, 1e9, 1.0, 0.0), 1e9, &mut 1000).unwrap_err();
        assert!(matches!(error, SimulationError::Exhausted { .. }), "{error}");
    }
}
