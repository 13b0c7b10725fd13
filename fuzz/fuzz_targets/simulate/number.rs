//! Finite numbers out of bytes: mostly those that a laboratory would write down, sometimes any at all.

use arbitrary::Arbitrary;

/// A number that is not negative.
#[derive(Debug, Clone, Copy, Arbitrary)]
pub(crate) enum Number {
    /// Zero, and numbers that tie with each other exactly.
    Whole(u8),
    /// Three digits and an exponent between −4 and 3.
    Everyday(u16),
    /// The same with an exponent between −128 and 127.
    Odd(u16, i8),
    /// The bits of any finite number.
    Bits(u64),
}

impl Number {
    pub(crate) fn value(self) -> f64 {
        match self {
            Self::Whole(number) => f64::from(number % 8),
            Self::Everyday(digits) => f64::from(1 + digits / 8) / 8192.0 * 10f64.powi(i32::from(digits % 8) - 4),
            Self::Odd(digits, exponent) => f64::from(1 + u32::from(digits)) / 65536.0 * 10f64.powi(i32::from(exponent)),
            Self::Bits(bits) => {
                let number = f64::from_bits(bits).abs();
                if number.is_finite() { number } else { 1.0 }
            }
        }
    }

    /// The number, or 1 in the place of zero.
    pub(crate) fn positive(self) -> f64 {
        let value = self.value();
        if value > 0.0 { value } else { 1.0 }
    }

    /// True if derivatives with respect to it and to others like it stay within the range of the number type.
    pub(crate) fn is_everyday(self) -> bool {
        matches!(self, Self::Whole(_) | Self::Everyday(_))
    }
}

/// A number of either sign.
#[derive(Debug, Clone, Copy, Arbitrary)]
pub(crate) struct Signed {
    pub(crate) magnitude: Number,
    negative: bool,
}

impl Signed {
    pub(crate) fn value(self) -> f64 {
        let magnitude = self.magnitude.value();
        if self.negative { -magnitude } else { magnitude }
    }
}
