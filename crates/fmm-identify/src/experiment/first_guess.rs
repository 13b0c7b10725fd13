//! Start values out of peaks and zero crossings, without any input from the user.

use std::f64::consts::{FRAC_PI_2, PI};

use fmm_record::Quantity;

/// Oscillation as the eye sees it: one extremum per half swing, and how fast they follow each other.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Oscillation {
    /// Time (s), counted from the first sample, and value of each extremum, in order, alternating about the centre.
    pub(crate) extrema: Vec<(f64, f64)>,
    /// Frequency between zero crossings (Hz), if there are enough.
    pub(crate) frequency: Option<f64>,
}

/// Start values for one record.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FirstGuess {
    /// ω_d (rad/s).
    angular: f64,
    /// Centre of the record, in its unit.
    offset: f64,
    /// Amplitude of each half swing, in the unit of the record.
    pub(crate) amplitudes: Vec<f64>,
    /// Time (s) and value of the first extremum, and value of the second.
    first: (f64, f64, f64),
    quantity: Quantity,
}

/// Dissipation read off the amplitudes under one hypothesis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Dissipation {
    /// c/m (1/s).
    pub(crate) damping: f64,
    /// F/m (unit of acceleration).
    pub(crate) friction: f64,
}

/// Number of turning points from which on their centre is known well enough to see the amplitudes fall.
const ENOUGH_TURNS: usize = 4;
/// Shifts of the centre by friction, as shares of the amplitude, to begin with where the amplitudes do not tell.
const SHARES: [f64; 6] = [0.0, 0.03, 0.06, 0.12, 0.2, 0.3];

/// Slope and intercept of the least-squares line through `points`; `None` for fewer than two distinct abscissae.
fn line(points: impl Iterator<Item = (f64, f64)> + Clone) -> Option<(f64, f64)> {
    let count = points.clone().count() as f64;
    let mean = |of: fn((f64, f64)) -> f64| points.clone().map(of).sum::<f64>() / count;
    let (x_mean, y_mean) = (mean(|point| point.0), mean(|point| point.1));
    let squares: f64 = points.clone().map(|(x, _)| (x - x_mean).powi(2)).sum();
    let products: f64 = points.map(|(x, y)| (x - x_mean) * (y - y_mean)).sum();
    let slope = products / squares;
    slope.is_finite().then_some((slope, y_mean - slope * x_mean))
}

impl FirstGuess {
    /// Start values of a record that oscillates; none with fewer than two extrema.
    pub(crate) fn of(oscillation: &Oscillation, quantity: Quantity) -> Option<Self> {
        let extrema = &oscillation.extrema;
        let (first, second) = (*extrema.first()?, *extrema.get(1)?);
        // Turning points follow each other by exactly half a period whatever the friction; they are the peaks of a
        // displacement and the crossings of a velocity. Crossings of a displacement are shifted by friction.
        let half_period = if quantity == Quantity::Displacement {
            line(extrema.iter().enumerate().map(|(i, (time, _))| (i as f64, *time))).map(|(slope, _)| slope)
        } else {
            oscillation.frequency.map(|frequency| 0.5 / frequency)
        };
        let half_period = half_period.unwrap_or(second.0 - first.0);
        // Half the difference of neighbouring extrema of opposite sign is an amplitude; a third one between them
        // takes the decay out of their mean.
        let centres = extrema.windows(3).map(|three| 0.25 * (three[0].1 + three[2].1) + 0.5 * three[1].1);
        let count = centres.len();
        let offset = if count > 0 { centres.sum::<f64>() / count as f64 } else { 0.5 * (first.1 + second.1) };
        let amplitudes = extrema.iter().map(|(_, value)| (value - offset).abs()).collect();
        (half_period > 0.0).then_some(Self {
            angular: PI / half_period,
            offset,
            amplitudes,
            first: (first.0, first.1, second.1),
            quantity,
        })
    }

    /// Stand-in for these of a driven motion, which begins at `first` and swings about `offset` by `amplitude` at
    /// this `frequency` (Hz).
    pub(crate) fn of_driven(frequency: f64, offset: f64, amplitude: f64, first: f64, quantity: Quantity) -> Self {
        let (angular, amplitudes) = (2.0 * PI * frequency, vec![amplitude]);
        Self { angular, offset, amplitudes, first: (0.0, first, 2.0 * offset - first), quantity }
    }

    /// Frequency of the damped vibration (Hz).
    pub(crate) fn frequency(&self) -> f64 {
        self.angular / (2.0 * PI)
    }

    /// F/m from the loss of amplitude per half swing, and c/m from the ratio of successive amplitudes.
    ///
    /// ```text
    /// displacement:  aₙ₊₁ = q aₙ − (1 + q) F/(m ω²)
    /// velocity:      Vₙ₊₁ = q Vₙ − 2 F/(m ω)
    /// ```
    fn dissipation(&self, ratio: f64, loss: f64) -> Dissipation {
        let friction = match self.quantity {
            Quantity::Displacement => loss * self.angular * self.angular / (1.0 + ratio),
            _ => 0.5 * loss * self.angular,
        };
        Dissipation { damping: -2.0 * ratio.ln() * self.angular / PI, friction: friction.max(0.0) }
    }

    /// True if the amplitudes depend on an offset that they cannot tell: the turning points of a displacement that
    /// turns only a few times.
    fn is_ambiguous(&self) -> bool {
        self.quantity == Quantity::Displacement && self.amplitudes.len() < ENOUGH_TURNS
    }

    /// Offset of the record, in its unit, under one hypothesis.
    pub(crate) fn offset(&self, dissipation: Dissipation) -> f64 {
        if !self.is_ambiguous() {
            return self.offset;
        }
        // Two turning points lie symmetric to the centre of the swing between them, which friction shifts.
        let (_, first, second) = self.first;
        f64::midpoint(first, second) - (first - second).signum() * dissipation.friction / self.angular.powi(2)
    }

    /// Every hypothesis that the amplitudes allow: dry friction alone, viscous damping alone, and both, from the
    /// line through the amplitude sequence.
    pub(crate) fn hypotheses(&self) -> Vec<Dissipation> {
        let amplitudes = &self.amplitudes;
        if self.is_ambiguous() {
            let friction = |share: &f64| share * amplitudes[0] * self.angular.powi(2);
            return SHARES.iter().map(|share| Dissipation { damping: 0.0, friction: friction(share) }).collect();
        }
        let numbered = amplitudes.iter().enumerate().map(|(i, amplitude)| (i as f64, *amplitude));
        let mut hypotheses = Vec::new();
        if let Some((slope, _)) = line(numbered.clone()) {
            hypotheses.push(self.dissipation(1.0, (-slope).max(0.0)));
        }
        let logarithms = numbered.filter(|(_, amplitude)| *amplitude > 0.0).map(|(i, amplitude)| (i, amplitude.ln()));
        if let Some((slope, _)) = line(logarithms) {
            hypotheses.push(self.dissipation(slope.min(0.0).exp(), 0.0));
        }
        // Amplitudes a quarter of the record apart: the noise of a single one then hardly tilts the line.
        let stride = (amplitudes.len() / 4).max(1);
        let pairs = amplitudes.iter().zip(amplitudes.iter().skip(stride)).map(|(before, after)| (*before, *after));
        if let Some((slope, intercept)) = line(pairs).filter(|(slope, _)| *slope > 0.0 && *slope < 1.0) {
            let ratio = slope.powf(1.0 / stride as f64);
            let loss = -intercept * (1.0 - ratio) / (1.0 - slope);
            if loss > 0.0 {
                hypotheses.push(self.dissipation(ratio, loss));
            }
        }
        hypotheses
    }

    /// f₀ (Hz), undamped, given the damping.
    pub(crate) fn natural_frequency(&self, dissipation: Dissipation) -> f64 {
        self.angular.hypot(0.5 * dissipation.damping) / (2.0 * PI)
    }

    /// Position and velocity at the first sample, going back from the first extremum without damping.
    pub(crate) fn initial_state(&self, dissipation: Dissipation) -> (f64, f64) {
        let omega = self.angular;
        let shift = dissipation.friction / (omega * omega);
        let (time, amplitude) = (self.first.0, self.first.1 - self.offset(dissipation));
        let (turning_time, turning_point) = if self.quantity == Quantity::Displacement {
            (time, amplitude)
        } else {
            let centre = -amplitude.signum() * shift;
            let phase = omega * time;
            if phase <= FRAC_PI_2 {
                return (centre - amplitude / omega * phase.sin(), amplitude * phase.cos());
            }
            (time - FRAC_PI_2 / omega, centre - amplitude / omega)
        };
        // Before a turning point the motion goes towards it, about a centre on its near side.
        let centre = -turning_point.signum() * shift;
        let (sin, cos) = (omega * turning_time).sin_cos();
        (centre + (turning_point - centre) * cos, (turning_point - centre) * omega * sin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmm_friction::CoulombViscous;
    use fmm_model::Oscillator;
    use fmm_sim::{Engine, Exact, Sampling, Scenario};

    /// Extrema and crossings of an exact motion of unit mass at 2 Hz.
    fn oscillation(damping: f64, friction: f64, displacement: bool, start: (f64, f64)) -> Oscillation {
        let law = CoulombViscous::new(friction, damping).unwrap();
        let scenario = Scenario::new(Oscillator::per_unit_mass(2.0).unwrap(), law, 1.0).unwrap();
        let scenario = scenario.starting_at(start.0, start.1).unwrap();
        let interval = 1e-4;
        let motion = Exact.run(&scenario, &Sampling::uniform(interval, 30_000).unwrap()).unwrap();
        let values = if displacement { motion.position().values() } else { motion.velocity().values() };
        let values: Vec<f64> = values.iter().map(|value| value + 0.3).collect();
        let (mut extrema, mut crossings) = (Vec::new(), Vec::new());
        for i in 1..values.len() - 1 {
            let time = i as f64 * interval;
            if (values[i] - values[i - 1]) * (values[i + 1] - values[i]) < 0.0 {
                extrema.push((time, values[i]));
            }
            if (values[i - 1] - 0.3) * (values[i] - 0.3) < 0.0 {
                crossings.push(time);
            }
        }
        let span = crossings[crossings.len() - 1] - crossings[0];
        Oscillation { extrema, frequency: Some((crossings.len() - 1) as f64 / (2.0 * span)) }
    }

    /// Both dissipations come back within a few percent, which is what a start value needs.
    #[test]
    fn both_dissipations_come_back() {
        for displacement in [false, true] {
            for start in [(0.01, 0.0), (0.002, 0.12), (-0.006, 0.1)] {
                let quantity = if displacement { Quantity::Displacement } else { Quantity::Velocity };
                let oscillation = oscillation(0.3, 0.08, displacement, start);
                let guess = FirstGuess::of(&oscillation, quantity).unwrap();
                let both = *guess.hypotheses().last().unwrap();
                assert!((both.damping / 0.3 - 1.0).abs() < 0.1, "c/m = {} 1/s", both.damping);
                assert!((both.friction / 0.08 - 1.0).abs() < 0.1, "F/m = {} m/s²", both.friction);
                let frequency = guess.natural_frequency(both);
                assert!((frequency / 2.0 - 1.0).abs() < 1e-3, "f = {frequency} Hz from {start:?}, {quantity}");
                assert!((guess.offset(both) - 0.3).abs() < 1e-3 * if displacement { 1.0 } else { 10.0 });
                let (position, velocity) = guess.initial_state(both);
                assert!((position - start.0).abs() < 1e-3, "x₀ = {position} m for {} m", start.0);
                assert!((velocity - start.1).abs() < 1e-2, "v₀ = {velocity} m/s for {} m/s", start.1);
            }
        }
    }

    #[test]
    fn a_single_extremum_gives_no_guess() {
        let oscillation = Oscillation { extrema: vec![(0.1, 1.0)], frequency: None };
        assert_eq!(FirstGuess::of(&oscillation, Quantity::Velocity), None);
    }
}
