//! Responses in Universal Files: data sets 58 of function type 4.

use std::f64::consts::TAU;

use fmm_record::uff::{Abscissa, Axis, DataSet, DataType, FunctionType, Header, Ordinate, UffFile};
use fmm_record::{Complex64, Quantity, WrittenUnit};

use super::measured::MeasuredResponse;
use crate::error::FrfError;
use crate::response::{FrequencyResponse, ResponseForm};

/// Number of the function coherence in the format.
const COHERENCE: FunctionType = FunctionType(6);
/// Largest deviation of a line from a grid of equal steps, in steps, for which the grid is written (1). Origin: the six
/// digits that the format has for a step.
const EVEN: f64 = 1e-6;

impl MeasuredResponse {
    /// All frequency responses of a Universal File, but for lines at zero frequency; with a number of `averages` and
    /// the coherence of the same places in the file, each has its uncertainty.
    ///
    /// Form and units are those that the file states. Where it states none, or others, `known` has the form and the
    /// factor that turns its numbers into the SI unit of that form.
    ///
    /// # Errors
    /// [`FrfError::Mismatch`] without a frequency response, for one that is not complex, and for units that are not
    /// known; [`FrfError::Values`] for numbers that are not finite or frequencies that do not increase; otherwise
    /// those of [`MeasuredResponse::with_coherence_values`].
    pub fn of_universal(
        file: &UffFile,
        known: Option<(ResponseForm, f64)>,
        averages: Option<f64>,
    ) -> Result<Vec<Self>, FrfError> {
        let of_kind = |kind: FunctionType| file.sets().iter().filter(move |set| set.header.function == kind);
        let mut found = Vec::new();
        for set in of_kind(FunctionType::FREQUENCY_RESPONSE) {
            let measured = response(set, known)?;
            let is_of_this = |other: &&DataSet| {
                let (one, other) = (&set.header, &other.header);
                one.response == other.response && one.reference == other.reference
            };
            let coherence = of_kind(COHERENCE).find(is_of_this);
            found.push(match (averages, coherence.map(|set| (set, set.ordinate()))) {
                (Some(averages), Some((other, Ordinate::Real(values)))) if values.len() == set.ordinate().len() => {
                    let lines = other.abscissae().zip(values).filter(|(frequency, _)| *frequency != 0.0);
                    let values: Vec<f64> = lines.map(|(_, value)| *value).collect();
                    measured.with_coherence_values(&values, averages)?
                }
                _ => measured,
            });
        }
        if found.is_empty() {
            let kinds: Vec<String> = file.sets().iter().map(|set| set.header.function.to_string()).collect();
            let what = "the file has no frequency response (function type 4) among its data sets 58";
            return Err(FrfError::mismatch(format!("{what}, which are: {}", kinds.join(", "))));
        }
        Ok(found)
    }

    /// A data set 58 of function type 4 with this response; the format has six digits for frequencies.
    ///
    /// ```
    /// use fmm_frf::{Complex64, FrequencyResponse, MeasuredResponse, ResponseForm};
    /// use fmm_record::uff::{Form, UffFile, write_to};
    ///
    /// let values = vec![Complex64::new(1.0, -2.0), Complex64::new(0.5, -1.0)];
    /// let response = FrequencyResponse::new(ResponseForm::Accelerance, vec![0.5, 1.0], values)?;
    /// let measured = MeasuredResponse::new(response);
    /// let mut bytes = Vec::new();
    /// write_to(&mut bytes, &[measured.data_set()?], Form::Ascii).unwrap();
    /// assert_eq!(MeasuredResponse::of_universal(&UffFile::parse(&bytes).unwrap(), None, None)?, [measured]);
    /// # Ok::<(), fmm_frf::FrfError>(())
    /// ```
    ///
    /// # Errors
    /// [`FrfError::TooFew`] without lines.
    pub fn data_set(&self) -> Result<DataSet, FrfError> {
        let (frequencies, quantity) = (self.values().frequencies(), self.values().form().quantity());
        let Some(&start) = frequencies.first() else {
            return Err(FrfError::too_few("a data set needs at least one line"));
        };
        let unit = match quantity {
            Quantity::Displacement => "m",
            Quantity::Velocity => "m/s",
            _ => "m/s^2",
        };
        let mut header = Header::default();
        header.function = FunctionType::FREQUENCY_RESPONSE;
        (header.response, header.reference) = (self.response().clone(), self.reference().clone());
        header.abscissa = Axis::new(DataType::FREQUENCY, "Frequency", "Hz");
        header.ordinate = Axis::new(quantity.into(), "", unit);
        header.denominator = Axis::new(DataType::EXCITATION_FORCE, "Force", "N");
        let last = frequencies[frequencies.len() - 1];
        let step = (last - start) / (frequencies.len() - 1).max(1) as f64;
        let is_even =
            |(index, frequency): (usize, &f64)| (start + step * index as f64 - frequency).abs() <= EVEN * step;
        let abscissa = if frequencies.iter().enumerate().all(is_even) {
            Abscissa::Even { start, step }
        } else {
            Abscissa::Uneven(frequencies.to_vec())
        };
        let ordinate = Ordinate::Complex(self.values().values().iter().map(|value| [value.re, value.im]).collect());
        DataSet::new(header, abscissa, ordinate).map_err(|error| FrfError::values(error.to_string()))
    }
}

/// The response of a data set.
fn response(set: &DataSet, known: Option<(ResponseForm, f64)>) -> Result<MeasuredResponse, FrfError> {
    let name = set.header.response.to_string();
    let Ordinate::Complex(values) = set.ordinate() else {
        return Err(FrfError::mismatch(format!("the frequency response of {name} has no imaginary part")));
    };
    let (form, scale) = match known {
        Some(known) => known,
        None => stated(&set.header, &name)?,
    };
    let hertz = hertz(&set.header.abscissa.unit).ok_or_else(|| {
        FrfError::mismatch(format!(
            "the frequencies of {name} are in \"{}\"; known are Hz, kHz and rad/s",
            set.header.abscissa.unit
        ))
    })?;
    let lines = set.abscissae().zip(values).filter(|(frequency, _)| *frequency != 0.0);
    let (frequencies, values) =
        lines.map(|(frequency, [re, im])| (frequency * hertz, Complex64::new(*re, *im) * scale)).unzip();
    let response = FrequencyResponse::new(form, frequencies, values)?;
    Ok(MeasuredResponse::new(response).between(set.header.response.clone(), set.header.reference.clone()))
}

/// Hertz in a unit of frequency, Hz if it is not written.
pub(super) fn hertz(unit: &str) -> Option<f64> {
    match unit.trim().to_ascii_lowercase().as_str() {
        "" | "hz" => Some(1.0),
        "khz" => Some(1e3),
        "rad/s" => Some(TAU.recip()),
        _ => None,
    }
}

/// Form and factor to its SI unit, as a header states them.
fn stated(header: &Header, name: &str) -> Result<(ResponseForm, f64), FrfError> {
    let unit = |axis: &Axis, si: &str| -> Result<Option<WrittenUnit>, FrfError> {
        // Some programs write the unit of the quotient.
        let text = axis.unit.trim();
        let text = text.strip_suffix("/N").unwrap_or(text);
        if text.is_empty() {
            return Ok(None);
        }
        let known: Option<WrittenUnit> = text.parse().ok();
        known.filter(|unit| si.is_empty() || unit.si() == si).map(Some).ok_or_else(|| {
            let what = format!("the unit \"{}\" of the frequency response of {name} is not known", axis.unit);
            FrfError::mismatch(format!("{what}; give its form and the factor to SI units"))
        })
    };
    let numerator = unit(&header.ordinate, "")?;
    let quantity = match header.ordinate.data_type.quantity() {
        Quantity::Other => numerator.as_ref().map_or(Quantity::Other, WrittenUnit::quantity),
        stated => stated,
    };
    let form = match quantity {
        Quantity::Displacement => ResponseForm::Receptance,
        Quantity::Velocity => ResponseForm::Mobility,
        Quantity::Acceleration => ResponseForm::Accelerance,
        _ => {
            let what = format!("the file does not say whether the frequency response of {name} is one of");
            return Err(FrfError::mismatch(format!("{what} displacement, velocity or acceleration; give its form")));
        }
    };
    if numerator.as_ref().is_some_and(|unit| unit.quantity() != quantity) {
        let what = format!("the frequency response of {name} is one of {quantity} by its type");
        return Err(FrfError::mismatch(format!("{what}, but its unit is {}; give its form", header.ordinate.unit)));
    }
    let force = unit(&header.denominator, "N")?;
    let factor = |unit: Option<WrittenUnit>| unit.map_or(1.0, |unit| unit.factor());
    Ok((form, factor(numerator) / factor(force)))
}
