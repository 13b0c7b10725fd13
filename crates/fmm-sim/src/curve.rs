//! Functions of time that are a line, waves and a free decay: all that a linear machine does between two events.

use fmm_model::Scalar;

use crate::State;
use crate::decay::{Ahead, Decay};
use crate::drive::Piece;

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
    decay: Option<(&'a Decay<D>, State<D>)>,
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
        let wave = |wave: &crate::drive::Harmonic<D>| {
            let (sin, cos) = wave.sin_cos(time);
            Wave { angular: wave.angular, cosine: wave.amplitude * cos, sine: -wave.amplitude * sin }
        };
        // Without waves nothing is collected, which is most of the time.
        let waves = if piece.waves().is_empty() { Vec::new() } else { piece.waves().iter().map(wave).collect() };
        Self { constant, slope, waves, decay: None }
    }

    /// The same with a free decay from `state` added.
    pub(crate) fn decaying(mut self, decay: &'a Decay<D>, state: State<D>) -> Self {
        self.decay = Some((decay, state));
        self
    }

    /// Whether it has no part but a constant and a decay, in its derivatives neither.
    pub(crate) fn is_free(&self) -> bool {
        let level = || (0..D::DIRECTIONS).all(|direction| self.slope.partial(direction) == 0.0);
        self.waves.is_empty() && self.slope.value() == 0.0 && level()
    }

    /// Whether the curve without derivatives has no part but a constant and a decay.
    pub(crate) fn is_plainly_free(&self) -> bool {
        self.frequencies().next().is_none() && self.slope.value() == 0.0
    }

    /// Angular frequencies (rad/s) of the waves that there are, those that exist in derivatives only left out.
    pub(crate) fn frequencies(&self) -> impl Iterator<Item = f64> {
        let is_there = |wave: &&Wave<D>| wave.cosine.value() != 0.0 || wave.sine.value() != 0.0;
        self.waves.iter().filter(is_there).map(|wave| wave.angular.value())
    }

    /// The free decay and its state at τ = 0.
    pub(crate) fn free(&self) -> Option<(&'a Decay<D>, State<D>)> {
        self.decay
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

    /// The same curve without derivatives; `decay` is that of the curve without derivatives.
    pub(crate) fn plain<'b>(&self, decay: &'b Decay<f64>) -> Curve<'b, f64> {
        let free = self
            .decay
            .map(|(_, state)| (decay, State { position: state.position.value(), velocity: state.velocity.value() }));
        Curve { decay: free, ..self.plain_without_decay() }
    }
}

impl Curve<'_, f64> {
    /// The same curve, known to begin at zero and not to fall. Its free part gives up what rounding has left of the
    /// value, and of a slope that does not exceed `noise`: at the rate of a fast decay, that would outlive what is to
    /// come.
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
