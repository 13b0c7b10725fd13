//! Numbers stored by their bits: text in decimals loses the last digit with some readers, and infinities with most.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// One number or a vector of them.
pub(crate) trait Bits: Sized {
    type Stored: Serialize + for<'a> Deserialize<'a>;
    fn store(&self) -> Self::Stored;
    fn restore(stored: Self::Stored) -> Self;
}

impl Bits for f64 {
    type Stored = u64;
    fn store(&self) -> u64 {
        self.to_bits()
    }
    fn restore(stored: u64) -> Self {
        Self::from_bits(stored)
    }
}

impl Bits for Vec<f64> {
    type Stored = Vec<u64>;
    fn store(&self) -> Vec<u64> {
        self.iter().map(|value| value.to_bits()).collect()
    }
    fn restore(stored: Vec<u64>) -> Self {
        stored.into_iter().map(f64::from_bits).collect()
    }
}

pub(crate) fn serialize<T: Bits, S: Serializer>(value: &T, serializer: S) -> Result<S::Ok, S::Error> {
    value.store().serialize(serializer)
}

pub(crate) fn deserialize<'a, T: Bits, D: Deserializer<'a>>(deserializer: D) -> Result<T, D::Error> {
    Ok(T::restore(T::Stored::deserialize(deserializer)?))
}
