//! Disturbances beside the measured motion: hum and drift.

use std::f64::consts::TAU;

use fmm_model::Parameter;
use fmm_record::Hum;

/// A disturbance of known shape and unknown size, which is fitted with the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Nuisance {
    /// The cosine part of a line of constant amplitude, and where a fit may begin.
    Cosine(Hum),
    /// Its sine part.
    Sine(Hum),
    /// A Legendre polynomial of this degree over the record: slow drift.
    Drift(u32),
}

/// The parts of a slow drift.
pub(crate) const DRIFT: [Nuisance; 3] = [Nuisance::Drift(1), Nuisance::Drift(2), Nuisance::Drift(3)];

impl Nuisance {
    /// The lines of `hum`, two parts each.
    pub(crate) fn of_hum(hum: &[Hum]) -> impl Iterator<Item = Self> {
        hum.iter().flat_map(|line| [Self::Cosine(*line), Self::Sine(*line)])
    }

    /// The parameter of disturbance number `number` of a record in `unit`, called by the name of its record.
    pub(crate) fn parameter(&self, number: usize, record: &str, unit: &str) -> Parameter {
        let (name, symbol) = match self {
            Self::Cosine(_) => (format!("hum_cosine_{}", number / 2 + 1), "a"),
            Self::Sine(_) => (format!("hum_sine_{}", number / 2 + 1), "b"),
            Self::Drift(degree) => (format!("drift_{degree}"), "d"),
        };
        Parameter::named(format!("{name}{record}"), symbol, unit.to_owned())
    }

    /// Start value of a fit, in the unit of the record.
    pub(crate) fn start(&self) -> f64 {
        match self {
            Self::Cosine(line) => line.amplitude * line.phase.cos(),
            Self::Sine(line) => -line.amplitude * line.phase.sin(),
            Self::Drift(_) => 0.0,
        }
    }

    /// Its shape (1) at `time` (s) of a record from `start` to `end` (s).
    pub(crate) fn at(&self, time: f64, start: f64, end: f64) -> f64 {
        match self {
            Self::Cosine(line) => (TAU * line.frequency * (time - line.start)).cos(),
            Self::Sine(line) => (TAU * line.frequency * (time - line.start)).sin(),
            Self::Drift(degree) => legendre(*degree, 2.0 * (time - start) / (end - start) - 1.0),
        }
    }
}

/// P_n(x), by (k + 1) P_{k+1} = (2k + 1) x P_k − k P_{k−1}.
fn legendre(degree: u32, x: f64) -> f64 {
    let (mut before, mut value) = (0.0, 1.0);
    for k in 0..degree {
        let k = f64::from(k);
        (before, value) = (value, ((2.0 * k + 1.0) * x * value - k * before) / (k + 1.0));
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn legendre_polynomials_are_those_of_the_tables() {
        assert_eq!((legendre(0, 0.3), legendre(1, 0.3)), (1.0, 0.3));
        assert!((legendre(2, 0.3) - (3.0 * 0.09 - 1.0) / 2.0).abs() < 1e-15);
        assert!((legendre(3, 0.3) - (5.0 * 0.027 - 3.0 * 0.3) / 2.0).abs() < 1e-15);
    }

    /// Two parts make the line that was found.
    #[test]
    fn a_line_of_hum_begins_where_it_was_found() {
        let mut line = fmm_record::Examination::of(synthetic()).hum()[0];
        line.phase = 1.0;
        let parts: Vec<Nuisance> = Nuisance::of_hum(&[line]).collect();
        for time in [0.0, 0.123, 1.7] {
            let value: f64 = parts.iter().map(|part| part.start() * part.at(time, 0.0, 2.0)).sum();
            assert!((value - line.at(time)).abs() < 1e-12 * line.amplitude.max(1.0), "at {time} s");
        }
    }

    /// A decay with 50 Hz that goes on.
    fn synthetic() -> fmm_record::Record {
        let at = |t: f64| (-3.0 * t).exp() * (14.0 * t).sin() + 0.02 * (TAU * 50.0 * t).cos();
        let values = (0..4000).map(|i| at(1e-3 * f64::from(i))).collect();
        fmm_record::Record::new(0.0, 1e-3, values, fmm_record::Quantity::Velocity, "m/s").unwrap()
    }
}
