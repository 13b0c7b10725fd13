//! Serialised form of responses, of which only a valid one is made again.
//!
//! Complex values are pairs of real and imaginary part, as JSON has no number for them.

use std::borrow::Cow;

use fmm_record::Complex64;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::response::{FrequencyResponse, ResponseForm, SingleDegreeOfFreedom};

/// Fields of a response as they are written.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Response<'a> {
    form: ResponseForm,
    frequencies_hz: Cow<'a, [f64]>,
    /// Real and imaginary part (SI unit of the form) at each frequency.
    values: Vec<[f64; 2]>,
    /// Decay rate (1/s) of the exponential window behind the values.
    #[serde(default)]
    decay_rate: f64,
}

impl Serialize for FrequencyResponse {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let values = self.values().iter().map(|value| [value.re, value.im]).collect();
        let frequencies_hz = self.frequencies().into();
        Response { form: self.form(), frequencies_hz, values, decay_rate: self.decay_rate() }.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for FrequencyResponse {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let Response { form, frequencies_hz, values, decay_rate } = Response::deserialize(deserializer)?;
        if !(decay_rate >= 0.0 && decay_rate.is_finite()) {
            let what = "the decay rate of a window is finite and not negative";
            return Err(D::Error::custom(format!("{what}, but {decay_rate} 1/s was written")));
        }
        let values = values.into_iter().map(|[re, im]| Complex64::new(re, im)).collect();
        let response = Self::new(form, frequencies_hz.into_owned(), values).map_err(D::Error::custom)?;
        Ok(response.behind_window(decay_rate))
    }
}

/// Coefficients of an oscillator as they are written.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Oscillator {
    /// m (kg).
    mass: f64,
    /// c (N s/m).
    damping: f64,
    /// k (N/m).
    stiffness: f64,
}

impl Serialize for SingleDegreeOfFreedom {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (mass, damping, stiffness) = (self.mass(), self.damping(), self.stiffness());
        Oscillator { mass, damping, stiffness }.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for SingleDegreeOfFreedom {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let Oscillator { mass, damping, stiffness } = Oscillator::deserialize(deserializer)?;
        Self::new(mass, damping, stiffness).map_err(D::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_response_comes_back_as_it_was() {
        let machine = SingleDegreeOfFreedom::new(10.391, 0.275, 1982.0).unwrap();
        let text = serde_json::to_string(&machine).unwrap();
        assert_eq!(serde_json::from_str::<SingleDegreeOfFreedom>(&text).unwrap(), machine, "{text}");
        let response = machine.frequency_response(ResponseForm::Mobility, &[0.5, 1.0, 2.2]).unwrap();
        for response in [response.clone(), response.behind_window(0.7)] {
            let text = serde_json::to_string(&response).unwrap();
            assert_eq!(serde_json::from_str::<FrequencyResponse>(&text).unwrap(), response, "{text}");
        }
    }

    #[test]
    fn what_is_no_response_is_refused() {
        for (fields, words) in [
            (r#""frequencies_hz": [1.0, 2.0], "values": [[1.0, 0.0]]"#, "one value for each"),
            (r#""frequencies_hz": [2.0, 1.0], "values": [[1.0, 0.0], [1.0, 0.0]]"#, "increasing"),
            (r#""frequencies_hz": [1.0], "values": [[1.0, 0.0]], "decay_rate": -1.0"#, "not negative"),
            (r#""frequencies_hz": [1.0], "values": [[1.0, 0.0]], "delay": 0.0"#, "unknown field"),
        ] {
            let text = format!(r#"{{"form": "mobility", {fields}}}"#);
            let error = serde_json::from_str::<FrequencyResponse>(&text).unwrap_err().to_string();
            assert!(error.contains(words), "{fields}: {error}");
        }
        let text = r#"{"mass": 0.0, "damping": 0.1, "stiffness": 1.0}"#;
        let error = serde_json::from_str::<SingleDegreeOfFreedom>(text).unwrap_err().to_string();
        assert!(error.contains("mass"), "{error}");
    }
}
