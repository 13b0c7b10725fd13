//! Linear algebra of tall and of small matrices.

pub(crate) mod definite;
pub(crate) mod spectrum;
pub(crate) mod sums;
pub(crate) mod triangle;
