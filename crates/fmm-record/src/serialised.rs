//! Serialised form of a record, of which only a valid one is made again.

use std::borrow::Cow;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::error::RecordError;
use crate::record::Record;
use crate::units::Quantity;

/// Fields of a record as they are written.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written<'a> {
    quantity: Quantity,
    unit: Cow<'a, str>,
    /// Time of the first sample (s).
    start_s: f64,
    /// Time between samples (s), the mean one of unequal times.
    interval_s: f64,
    /// Times since the first sample (s), if they are unequally spaced.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    elapsed_s: Option<Cow<'a, [f64]>>,
    values: Cow<'a, [f64]>,
}

impl Serialize for Record {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let written = Written {
            quantity: self.quantity(),
            unit: self.unit().into(),
            start_s: self.start(),
            interval_s: self.interval(),
            elapsed_s: self.elapsed().map(|elapsed| Cow::Borrowed(&elapsed[..])),
            values: self.values().into(),
        };
        written.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Record {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Written::deserialize(deserializer)?.record().map_err(D::Error::custom)
    }
}

impl Written<'_> {
    /// The record that was written.
    fn record(self) -> Result<Record, RecordError> {
        let unit = self.unit.into_owned();
        let mut record = Record::new(self.start_s, self.interval_s, self.values.into_owned(), self.quantity, unit)?;
        let Some(elapsed) = self.elapsed_s else { return Ok(record) };
        if elapsed.len() != record.len() {
            let what = format!("{} times were given for {} values", elapsed.len(), record.len());
            return Err(RecordError::time(None, what));
        }
        if let Some(index) = (1..elapsed.len()).find(|index| elapsed[*index] <= elapsed[index - 1]) {
            return Err(RecordError::not_increasing(index, elapsed[index], elapsed[index - 1]));
        }
        if elapsed[0] != 0.0 || elapsed.iter().any(|time| !time.is_finite()) {
            return Err(RecordError::time(
                Some(0),
                "times since the first sample begin at 0 and are finite".to_owned(),
            ));
        }
        record.elapsed = Some(elapsed.as_ref().into());
        Ok(record)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_comes_back_as_it_was() {
        let equal = Record::new(1.5, 1e-3, vec![0.1, 0.2, 0.3], Quantity::Velocity, "m/s").unwrap();
        let times = [0.0, 0.1, 0.25, 0.3];
        let unequal = Record::at_times(&times, vec![0.0, 1.0, 2.5, 3.0], Quantity::Displacement, "mm").unwrap();
        for record in [equal, unequal] {
            let text = serde_json::to_string(&record).unwrap();
            assert_eq!(serde_json::from_str::<Record>(&text).unwrap(), record, "{text}");
        }
    }

    #[test]
    fn what_is_no_record_is_refused() {
        let written = |fields: &str| format!(r#"{{"quantity": "velocity", "unit": "m/s", "start_s": 0.0, {fields}}}"#);
        for (fields, words) in [
            (r#""interval_s": 0.0, "values": [1.0]"#, "interval"),
            (r#""interval_s": 1.0, "values": []"#, "no"),
            (r#""interval_s": 1.0, "elapsed_s": [0.0], "values": [1.0, 2.0]"#, "1 times were given for 2 values"),
            (r#""interval_s": 1.0, "elapsed_s": [0.0, 0.0], "values": [1.0, 2.0]"#, "time"),
            (r#""interval_s": 1.0, "elapsed_s": [1.0, 2.0], "values": [1.0, 2.0]"#, "begin at 0"),
            (r#""interval_s": 1.0, "values": [1.0], "rate": 3"#, "unknown field"),
        ] {
            let error = serde_json::from_str::<Record>(&written(fields)).unwrap_err().to_string();
            assert!(error.contains(words), "{fields}: {error}");
        }
    }
}
