//! A data set 58: a function of an abscissa.

use super::{Axis, DataType, FunctionType, Header};
use crate::{Record, RecordError};

/// A function as a data set 58 holds it. It has at least one point, and as many abscissae as ordinates.
///
/// Numbers are as in the file: they may be infinite or not a number, as the ratio of two spectra is where both
/// vanish. [`DataSet::record`] refuses those.
#[derive(Debug, Clone, PartialEq)]
pub struct DataSet {
    /// Labels, place and axes.
    pub header: Header,
    abscissa: Abscissa,
    ordinate: Ordinate,
    precision: Precision,
}

/// Abscissa of a function.
#[derive(Debug, Clone, PartialEq)]
pub enum Abscissa {
    /// At equal distances.
    Even {
        /// The first point.
        start: f64,
        /// Distance from point to point.
        step: f64,
    },
    /// Anywhere.
    Uneven(Vec<f64>),
}

/// The values of a function.
#[derive(Debug, Clone, PartialEq)]
pub enum Ordinate {
    /// Real numbers.
    Real(Vec<f64>),
    /// Complex numbers: real and imaginary part.
    Complex(Vec<[f64; 2]>),
}

impl Ordinate {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::Real(values) => values.len(),
            Self::Complex(values) => values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The precision in which values stand in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Precision {
    /// 32 bits; six digits in text.
    Single,
    /// 64 bits; 13 digits in text.
    #[default]
    Double,
}

impl DataSet {
    /// A function in double precision.
    ///
    /// # Errors
    /// [`RecordError::Values`] without points, [`RecordError::Options`] for other numbers of abscissae than of
    /// ordinates, or a start or step that are not finite.
    pub fn new(header: Header, abscissa: Abscissa, ordinate: Ordinate) -> Result<Self, RecordError> {
        if ordinate.is_empty() {
            let what = "a data set needs at least one point, but none were given".into();
            return Err(RecordError::Values { index: 0, what });
        }
        match &abscissa {
            Abscissa::Even { start, step } if !(start.is_finite() && step.is_finite()) => Err(RecordError::options(
                format!("an even abscissa must be finite, but starts at {start} with a step of {step}"),
            )),
            Abscissa::Uneven(values) if values.len() != ordinate.len() => {
                let (abscissae, ordinates) = (values.len(), ordinate.len());
                Err(RecordError::options(format!("{abscissae} abscissae were given for {ordinates} ordinates")))
            }
            _ => Ok(Self { header, abscissa, ordinate, precision: Precision::Double }),
        }
    }

    /// A record over time, in double precision, without a description or a place.
    pub fn of_record(record: &Record) -> Self {
        let header = Header {
            function: FunctionType::TIME_RESPONSE,
            abscissa: Axis::new(DataType::TIME, "Time", "s"),
            ordinate: Axis::new(record.quantity().into(), "", record.unit()),
            ..Header::default()
        };
        Self {
            header,
            abscissa: Abscissa::Even { start: record.start(), step: record.interval() },
            ordinate: Ordinate::Real(record.values().to_vec()),
            precision: Precision::Double,
        }
    }

    /// The same function, to be written in another precision.
    #[must_use]
    pub fn with_precision(mut self, precision: Precision) -> Self {
        self.precision = precision;
        self
    }

    /// Abscissa of its points, as the file states it.
    pub fn abscissa(&self) -> &Abscissa {
        &self.abscissa
    }

    /// Its values.
    pub fn ordinate(&self) -> &Ordinate {
        &self.ordinate
    }

    /// The precision in which its values stand in the file.
    pub fn precision(&self) -> Precision {
        self.precision
    }

    /// Number of points; at least one.
    pub fn len(&self) -> usize {
        self.ordinate.len()
    }

    /// Always false: a data set has at least one point. It stands here because `len` does.
    pub fn is_empty(&self) -> bool {
        self.ordinate.is_empty()
    }

    /// The abscissae of all points, as the file says them.
    pub fn abscissae(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        (0..self.len()).map(|index| match &self.abscissa {
            Abscissa::Even { start, step } => start + step * index as f64,
            Abscissa::Uneven(values) => values[index],
        })
    }

    /// Name: its description, or else the place of its response, as `3+Z`.
    pub fn name(&self) -> String {
        let description = &self.header.lines[0];
        if description.is_empty() { self.header.response.to_string() } else { description.clone() }
    }
}
