//! Numbers as the hexadecimal digits of their bits, so that no format rounds them on the way.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serializer};

/// Digits of one number.
const DIGITS: usize = 16;

pub(crate) fn serialize<S: Serializer>(values: &[f64], serializer: S) -> Result<S::Ok, S::Error> {
    const HEXADECIMAL: &[u8; 16] = b"0123456789abcdef";
    let mut text = String::with_capacity(values.len() * DIGITS);
    for value in values {
        let bits = value.to_bits();
        text.extend((0..DIGITS).rev().map(|digit| char::from(HEXADECIMAL[(bits >> (4 * digit)) as usize & 15])));
    }
    serializer.serialize_str(&text)
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<f64>, D::Error> {
    let text = String::deserialize(deserializer)?;
    let whole = text.as_bytes().chunks_exact(DIGITS);
    if !whole.remainder().is_empty() {
        return Err(D::Error::custom(format!("{} hexadecimal digits are no whole number of values", text.len())));
    }
    let value = |digits: &[u8]| {
        digits.iter().try_fold(0_u64, |bits, &digit| Some(bits << 4 | u64::from(char::from(digit).to_digit(16)?)))
    };
    let values = whole.map(|digits| value(digits).map(f64::from_bits)).collect::<Option<Vec<f64>>>();
    values.ok_or_else(|| D::Error::custom("values must be hexadecimal digits"))
}
