//! Integral and derivative of a record.

use fmm_model::Unit;

use crate::calculus::Smoothing;
use crate::error::RecordError;
use crate::numerics::Sum;
use crate::record::Record;

impl Record {
    /// The integral over time by the trapezoidal rule, beginning at `initial`: acceleration becomes velocity,
    /// velocity becomes displacement.
    ///
    /// ```text
    /// y_0 = initial,        y_i = y_{i−1} + h (x_{i−1} + x_i)/2
    /// ```
    ///
    /// An offset of the record becomes a slope of its integral; remove it before. The unit is multiplied by s:
    /// `m/s²` becomes `m/s`, `rad/s` becomes `rad`, `V` becomes `V s`.
    ///
    /// ```
    /// use fmm_record::{Quantity, Record};
    ///
    /// let velocity = Record::new(0.0, 0.1, vec![0.0, 1.0, 2.0], Quantity::Velocity, "m/s")?;
    /// let position = velocity.integrate(5.0)?;
    /// assert!((position.values()[2] - 5.2).abs() < 1e-15);
    /// assert_eq!((position.quantity(), position.unit()), (Quantity::Displacement, "m"));
    /// # Ok::<(), fmm_record::RecordError>(())
    /// ```
    ///
    /// # Errors
    /// [`RecordError::Unsupported`] unless this is acceleration or velocity, [`RecordError::Options`] if `initial` is
    /// not finite, [`RecordError::Values`] if the integral overflows.
    pub fn integrate(&self, initial: f64) -> Result<Self, RecordError> {
        let quantity = self.quantity().integral()?;
        if !initial.is_finite() {
            return Err(RecordError::options(format!("an initial value must be finite, but is {initial}")));
        }
        let series = self.equally_spaced();
        let half = 0.5 * series.interval();
        let mut sum = Sum::default();
        sum.add(initial);
        let mut previous: Option<f64> = None;
        let values = series
            .values()
            .iter()
            .map(|value| {
                if let Some(previous) = previous.replace(*value) {
                    sum.add(half * (previous + value));
                }
                sum.value()
            })
            .collect();
        let unit = unit_of(self).times(&Unit::of("s")).to_string();
        Self::new(series.start(), series.interval(), values, quantity, unit)
    }

    /// The derivative in time by central differences: displacement becomes velocity, velocity becomes acceleration.
    ///
    /// ```text
    /// y_i = (x_{i+1} − x_{i−1})/(2h),        y_0 = (−3x_0 + 4x_1 − x_2)/(2h), and so at the end
    /// ```
    ///
    /// The error is h²/6 times the third derivative (h²/3 at the ends); white noise of standard deviation σ becomes
    /// σ/(√2 h), so smooth before. The unit is divided by s: `m` becomes `m/s`, `m/s` becomes
    /// `m/s²`, `V s` becomes `V`.
    ///
    /// # Errors
    /// [`RecordError::Unsupported`] unless this is displacement or velocity, [`RecordError::TooShort`] below three
    /// samples, [`RecordError::Values`] if the derivative overflows.
    pub fn differentiate(&self) -> Result<Self, RecordError> {
        self.differentiate_smoothed_by(&Smoothing::None)
    }

    /// The derivative in time after `smoothing`: as [`Record::differentiate`] with [`Smoothing::slope`].
    ///
    /// # Errors
    /// Those of [`Record::differentiate`] and [`Smoothing::apply`].
    pub fn differentiate_smoothed_by(&self, smoothing: &Smoothing) -> Result<Self, RecordError> {
        let quantity = self.quantity().derivative()?;
        let series = self.equally_spaced();
        let slopes = smoothing.slope(series.values())?.into_iter().map(|slope| slope / series.interval()).collect();
        let unit = unit_of(self).per(&Unit::of("s")).to_string();
        Self::new(series.start(), series.interval(), slopes, quantity, unit)
    }

    /// The record after `smoothing`.
    ///
    /// # Errors
    /// Those of [`Smoothing::apply`].
    pub fn smoothed_by(&self, smoothing: &Smoothing) -> Result<Self, RecordError> {
        let series = self.equally_spaced();
        Ok(series.derived(series.start(), smoothing.apply(series.values())?))
    }
}

/// The slope per sample by central differences, by a parabola at the ends.
pub(crate) fn central_differences(x: &[f64]) -> Result<Vec<f64>, RecordError> {
    let n = x.len();
    if n < 3 {
        return Err(RecordError::TooShort { operation: "a derivative", needed: 3, length: n });
    }
    let at_end = |end: f64, next: f64, third: f64| 0.5 * (4.0 * (next - end) - (third - end));
    let mut slopes = Vec::with_capacity(n);
    slopes.push(at_end(x[0], x[1], x[2]));
    slopes.extend(x.windows(3).map(|around| 0.5 * (around[2] - around[0])));
    slopes.push(-at_end(x[n - 1], x[n - 2], x[n - 3]));
    Ok(slopes)
}

/// The unit of a record, which may be empty, or have a square without its sign.
fn unit_of(record: &Record) -> Unit {
    let unit = record.unit();
    if unit.is_empty() { Unit::default() } else { Unit::of(&unit.replace("/s2", "/s²")) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Quantity;

    fn sampled(quantity: Quantity, unit: &str, f: impl Fn(f64) -> f64) -> Record {
        Record::new(1.0, 1e-3, (0..2001).map(|i| f(1.0 + 1e-3 * f64::from(i))).collect(), quantity, unit).unwrap()
    }

    #[test]
    fn derivative_has_the_error_that_the_formula_states() {
        let (w, h) = (13.8, 1e-3);
        let position = sampled(Quantity::Displacement, "mm", |t| (w * t).sin());
        let velocity = position.differentiate().unwrap();
        assert_eq!((velocity.quantity(), velocity.unit()), (Quantity::Velocity, "mm/s"));
        // h²/6 w³ inside, h²/3 w³ at the ends, and a little for the fifth derivative.
        let (inside, end) = (h * h / 6.0 * w.powi(3) * 1.001, h * h / 3.0 * w.powi(3) * 1.001);
        for (i, (t, v)) in velocity.times().zip(velocity.values()).enumerate() {
            let error = (v - w * (w * t).cos()).abs();
            assert!(error < if i % 2000 == 0 { end } else { inside }, "{error} mm/s at {t} s");
        }
        assert_eq!(velocity.differentiate().unwrap().unit(), "mm/s²");
    }

    #[test]
    fn integral_undoes_the_derivative_of_a_parabola() {
        let velocity = sampled(Quantity::Velocity, "rad/s", |t| 3.0 * t - 1.0);
        let angle = velocity.integrate(0.5).unwrap();
        assert_eq!((angle.quantity(), angle.unit()), (Quantity::Displacement, "rad"));
        for (t, x) in angle.times().zip(angle.values()) {
            // The trapezoidal rule is exact for a line; what remains is rounding.
            assert!((x - (0.5 + 1.5 * (t * t - 1.0) - (t - 1.0))).abs() < 1e-14, "{x} rad at {t} s");
        }
        let back = angle.differentiate().unwrap();
        for (v, original) in back.values().iter().zip(velocity.values()) {
            assert!((v - original).abs() < 1e-11, "{v} rad/s against {original} rad/s");
        }
    }

    #[test]
    fn units_follow_their_rule_both_ways() {
        for (unit, integral) in [("m/s²", "m/s"), ("m/s^2", "m/s"), ("m/s", "m"), ("V", "V s"), ("", "s")] {
            assert_eq!(sampled(Quantity::Velocity, unit, |t| t).integrate(0.0).unwrap().unit(), integral);
        }
        for (unit, derivative) in [("m", "m/s"), ("m/s", "m/s²"), ("V s", "V"), ("", "1/s")] {
            assert_eq!(sampled(Quantity::Velocity, unit, |t| t).differentiate().unwrap().unit(), derivative);
        }
    }

    #[test]
    fn what_has_no_integral_or_derivative_is_refused() {
        for quantity in [Quantity::Force, Quantity::Other, Quantity::Displacement] {
            let error = sampled(quantity, "", |t| t).integrate(0.0).unwrap_err().to_string();
            assert_eq!(
                error,
                format!("a record of {quantity} cannot be integrated; only acceleration and velocity can")
            );
        }
        for quantity in [Quantity::Force, Quantity::Other, Quantity::Acceleration] {
            let error = sampled(quantity, "", |t| t).differentiate().unwrap_err().to_string();
            let expected = "cannot be differentiated; only displacement and velocity can";
            assert_eq!(error, format!("a record of {quantity} {expected}"));
        }
        let short = Record::new(0.0, 1.0, vec![1.0, 2.0], Quantity::Velocity, "m/s").unwrap();
        assert!(matches!(short.differentiate(), Err(RecordError::TooShort { needed: 3, length: 2, .. })));
        assert!(short.integrate(f64::NAN).is_err());
    }
}
