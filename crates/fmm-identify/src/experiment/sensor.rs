//! Sensor of an experiment: its low-pass filter and its delay.

use std::f64::consts::{PI, TAU};

use fmm_model::ModelError;

use crate::error::IdentifyError;

/// Sensor of an experiment: what lies between the motion and the record besides gain and offset.
///
/// The default passes the motion on as it is. A low-pass filter rounds the kink of a velocity and the jump of an
/// acceleration at every reversal; a fit that does not know of it takes that for friction. The delay of a sensor does
/// not show in a free vibration, whose beginning is unknown anyway: it moves the times that are reported, such as that
/// of the stop.
///
/// ```
/// use fmm_identify::Sensor;
///
/// // Butterworth of second order at 44 Hz, 5 ms late.
/// let sensor = Sensor::default().with_low_pass(2, 44.0)?.with_delay(5e-3)?;
/// assert_eq!((sensor.delay(), sensor.low_pass()), (5e-3, Some((2, Some(44.0)))));
/// // The same order, with a corner that the record has to tell.
/// assert_eq!(Sensor::default().with_free_low_pass(2)?.low_pass(), Some((2, None)));
/// # Ok::<(), fmm_identify::IdentifyError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sensor {
    low_pass: Option<LowPass>,
    delay: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct LowPass {
    order: usize,
    /// Hz; `None` if it is to be found.
    corner: Option<f64>,
}

/// Highest order of a filter.
const HIGHEST_ORDER: usize = 8;
/// Corner of a free filter to begin with, in frequencies of the motion.
const FIRST_CORNER: f64 = 20.0;

impl Sensor {
    /// The same with a Butterworth low-pass filter of `order` (1 to 8) whose `corner` frequency (Hz, −3 dB) is known.
    ///
    /// # Errors
    /// [`IdentifyError::OutOfRange`], and [`IdentifyError::InvalidInput`] for a corner that is not positive.
    pub fn with_low_pass(self, order: usize, corner: f64) -> Result<Self, IdentifyError> {
        let corner = ModelError::require_positive("corner frequency of the sensor", corner, "Hz")?;
        Ok(Self { low_pass: Some(LowPass { order: checked(order)?, corner: Some(corner) }), ..self })
    }

    /// The same with a Butterworth low-pass filter of `order` (1 to 8) whose corner frequency is fitted.
    ///
    /// # Errors
    /// [`IdentifyError::OutOfRange`].
    pub fn with_free_low_pass(self, order: usize) -> Result<Self, IdentifyError> {
        Ok(Self { low_pass: Some(LowPass { order: checked(order)?, corner: None }), ..self })
    }

    /// The same with records that are `delay` (s) late.
    ///
    /// # Errors
    /// [`IdentifyError::InvalidInput`] for a delay that is negative or not finite.
    pub fn with_delay(self, delay: f64) -> Result<Self, IdentifyError> {
        Ok(Self { delay: ModelError::require_not_negative("delay of the sensor", delay, "s")?, ..self })
    }

    /// Delay of records (s).
    pub fn delay(&self) -> f64 {
        self.delay
    }

    /// Order and corner frequency (Hz) of the low-pass filter; no corner if it is fitted, and none at all without a
    /// filter.
    pub fn low_pass(&self) -> Option<(usize, Option<f64>)> {
        self.low_pass.map(|filter| (filter.order, filter.corner))
    }

    /// True if the corner of the filter is fitted.
    pub(crate) fn has_free_corner(&self) -> bool {
        self.low_pass.is_some_and(|filter| filter.corner.is_none())
    }

    /// Corner frequency (Hz) to begin with for a motion of this `frequency` (Hz); `None` without a filter.
    pub(crate) fn first_corner(&self, frequency: f64) -> Option<f64> {
        self.low_pass.map(|filter| filter.corner.unwrap_or(FIRST_CORNER * frequency))
    }

    /// The time (s) after which what the filter remembers of the unknown motion before the record is below a millionth;
    /// 0 without a filter.
    pub(crate) fn settling(&self, frequency: f64) -> f64 {
        const FORGOTTEN: f64 = 14.0;
        let slowest = |filter: LowPass| {
            let corner = filter.corner.unwrap_or(0.5 * FIRST_CORNER * frequency);
            FORGOTTEN / (TAU * corner * (PI / (2.0 * filter.order as f64)).sin())
        };
        self.low_pass.map_or(0.0, slowest)
    }

    /// The filter with its corner at `corner` (Hz), for samples every `interval` (s).
    pub(crate) fn filter(&self, corner: f64, interval: f64) -> Filter {
        let order = self.low_pass.map_or(0, |filter| filter.order);
        Filter::butterworth(order, TAU * corner, interval)
    }
}

fn checked(order: usize) -> Result<usize, IdentifyError> {
    if (1..=HIGHEST_ORDER).contains(&order) {
        return Ok(order);
    }
    Err(IdentifyError::not_allowed("the order of a sensor's filter", order as f64, "1 to 8"))
}

/// Low-pass filter of sampled series, exact for series that are straight between their samples.
///
/// ```text
/// y″ + 2ζω y′ + ω² y = ω² u,      ζ = sin(π (2k + 1)/2n)
/// ```
///
/// Butterworth's poles in pairs, one after the other, after a real one if the order is odd.
#[derive(Debug, Clone)]
pub(crate) struct Filter {
    sections: Vec<Section>,
    states: Vec<[f64; 2]>,
    /// The input before, once there was one.
    before: Option<f64>,
    /// Samples a second.
    rate: f64,
}

#[derive(Debug, Clone, Copy)]
struct Section {
    angular: f64,
    /// True if it is a pair of poles, or a real one.
    is_pair: bool,
    /// Delay of an input that grows steadily (s): 2ζ/ω, of a real pole 1/ω.
    lag: f64,
    /// Transition of a free motion [y, y′] over an interval.
    step: [[f64; 2]; 2],
}

impl Section {
    fn new(angular: f64, damping: Option<f64>, interval: f64) -> Self {
        let step = match damping {
            None => [[(-angular * interval).exp(), 0.0], [0.0, 0.0]],
            Some(damping) => {
                let decay = damping * angular;
                let damped = angular * (1.0 - damping * damping).sqrt();
                let (sin, cos) = (damped * interval).sin_cos();
                let fall = (-decay * interval).exp();
                let by = decay / damped * sin;
                [
                    [fall * (cos + by), fall * sin / damped],
                    [-fall * angular * angular / damped * sin, fall * (cos - by)],
                ]
            }
        };
        let lag = damping.map_or(1.0, |damping| 2.0 * damping) / angular;
        Self { angular, is_pair: damping.is_some(), lag, step }
    }

    /// y and y′ after an interval in which the input grows from `from` to `to` at `slope`.
    fn advance(&self, [y, rate]: [f64; 2], from: f64, to: f64, slope: f64) -> [f64; 2] {
        let lag = self.lag * slope;
        let free = [y - (from - lag), rate - slope];
        let [a, b] = self.step;
        let value = a[0] * free[0] + a[1] * free[1] + to - lag;
        let rate = if self.is_pair { b[0] * free[0] + b[1] * free[1] + slope } else { self.angular * (to - value) };
        [value, rate]
    }
}

impl Filter {
    fn butterworth(order: usize, angular: f64, interval: f64) -> Self {
        let real = (order % 2 == 1).then(|| Section::new(angular, None, interval));
        let pairs = (0..order / 2).map(|k| {
            let damping = (PI * (2 * k + 1) as f64 / (2 * order) as f64).sin();
            Section::new(angular, Some(damping), interval)
        });
        let sections: Vec<Section> = real.into_iter().chain(pairs).collect();
        Self { states: vec![[0.0; 2]; sections.len()], sections, before: None, rate: interval.recip() }
    }

    /// Appends what becomes of the next samples of `input` to `output`: the filtered series or, if it is wanted, its
    /// rate of change (1/s).
    pub(crate) fn run(&mut self, input: &[f64], wants_rate: bool, output: &mut Vec<f64>) {
        output.extend(input.iter().map(|value| self.next(*value, wants_rate)));
    }

    fn next(&mut self, value: f64, wants_rate: bool) -> f64 {
        let Some(before) = self.before.replace(value) else {
            self.states.fill([value, 0.0]);
            return if wants_rate { 0.0 } else { value };
        };
        let (mut from, mut to) = (before, value);
        let mut rate = 0.0;
        for (section, state) in self.sections.iter().zip(&mut self.states) {
            let after = section.advance(*state, from, to, (to - from) * self.rate);
            (from, to, rate) = (state[0], after[0], after[1]);
            *state = after;
        }
        if wants_rate { rate } else { to }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filtered(order: usize, corner: f64, interval: f64, input: impl Fn(f64) -> f64, rate: bool) -> Vec<f64> {
        let sensor = Sensor::default().with_low_pass(order, corner).unwrap();
        let values: Vec<f64> = (0..20_000).map(|i| input(f64::from(i) * interval)).collect();
        let mut output = Vec::new();
        sensor.filter(corner, interval).run(&values, rate, &mut output);
        output
    }

    /// A sine comes out with Butterworth's gain, 1/√(1 + (f/f_c)²ⁿ), at every order.
    #[test]
    fn a_sine_has_the_gain_of_butterworth() {
        for order in 1..=HIGHEST_ORDER {
            for frequency in [2.0, 10.0, 30.0] {
                let output = filtered(order, 10.0, 1e-4, |t| (TAU * frequency * t).sin(), false);
                // A whole number of periods, long after the beginning.
                let tail = &output[output.len() - 1000..];
                let (mut sine, mut cosine) = (0.0, 0.0);
                if frequency * 0.1 % 1.0 > 1e-9 {
                    continue;
                }
                for (i, value) in tail.iter().enumerate() {
                    let (s, c) = (TAU * frequency * 1e-4 * i as f64).sin_cos();
                    sine += value * s / 500.0;
                    cosine += value * c / 500.0;
                }
                let expected = (1.0 + (frequency / 10.0).powf(2.0 * order as f64)).sqrt().recip();
                let gain = sine.hypot(cosine);
                assert!((gain - expected).abs() < 5e-4, "order {order} at {frequency} Hz: {gain} for {expected}");
            }
        }
    }

    /// A ramp comes out late by the sum of 2ζ/ω, and the rate of change is that of the output.
    #[test]
    fn a_ramp_comes_out_late() {
        let output = filtered(2, 10.0, 1e-3, |t| 3.0 * t, false);
        let late = 2.0 * (0.25 * PI).sin() / (TAU * 10.0);
        assert!((output[3999] - 3.0 * (3.999 - late)).abs() < 1e-9, "{}", output[3999]);
        let rate = filtered(3, 10.0, 1e-3, |t| (3.0 * t).sin(), true);
        let value = filtered(3, 10.0, 1e-3, |t| (3.0 * t).sin(), false);
        for i in [1000, 2000, 3000] {
            let difference = (value[i + 1] - value[i - 1]) / 2e-3;
            assert!((rate[i] - difference).abs() < 1e-4, "{} {difference}", rate[i]);
        }
    }

    #[test]
    fn filters_that_cannot_be_are_refused() {
        assert!(Sensor::default().with_low_pass(0, 10.0).is_err() && Sensor::default().with_free_low_pass(9).is_err());
        assert!(Sensor::default().with_low_pass(2, 0.0).is_err() && Sensor::default().with_delay(-1.0).is_err());
    }
}
