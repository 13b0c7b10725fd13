//! Numbers as bytes: real or whole, of one to eight bytes, in either order.

/// Order of the bytes in a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ByteOrder {
    /// The least significant byte first, as on most machines.
    #[default]
    Little,
    /// The most significant byte first.
    Big,
}

impl ByteOrder {
    /// The whole number without a sign in up to eight bytes.
    pub(crate) fn unsigned(self, bytes: &[u8]) -> u64 {
        let add = |word: u64, byte: &u8| word << 8 | u64::from(*byte);
        match self {
            Self::Little => bytes.iter().rev().fold(0, add),
            Self::Big => bytes.iter().fold(0, add),
        }
    }
}

/// Storage of a number.
#[derive(Debug, Clone, Copy)]
#[cfg(any(feature = "mat", feature = "npy"))]
pub(crate) struct Number {
    kind: Kind,
    pub(crate) width: usize,
    order: ByteOrder,
}

/// Meaning of the bits of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg(any(feature = "mat", feature = "npy"))]
pub(crate) enum Kind {
    Real,
    Signed,
    Unsigned,
}

#[cfg(any(feature = "mat", feature = "npy"))]
impl Number {
    /// Storage in `width` bytes; `None` for a width that numbers of this kind do not have.
    pub(crate) fn of(kind: Kind, width: usize, order: ByteOrder) -> Option<Self> {
        let is_known = if kind == Kind::Real { matches!(width, 4 | 8) } else { matches!(width, 1 | 2 | 4 | 8) };
        is_known.then_some(Self { kind, width, order })
    }

    /// The number in `bytes`, which are as many as its width. (Whole numbers beyond 2⁵³ are rounded.)
    pub(crate) fn value(self, bytes: &[u8]) -> f64 {
        let word = self.order.unsigned(bytes);
        match self.kind {
            Kind::Real if self.width == 4 => f64::from(f32::from_bits(word as u32)),
            Kind::Real => f64::from_bits(word),
            Kind::Unsigned => word as f64,
            Kind::Signed => {
                let unused = 64 - 8 * self.width as u32;
                ((word << unused).cast_signed() >> unused) as f64
            }
        }
    }

    /// All numbers in `bytes`, one behind the other.
    pub(crate) fn values(self, bytes: &[u8]) -> Vec<f64> {
        bytes.chunks_exact(self.width).map(|bytes| self.value(bytes)).collect()
    }
}
