//! Small linear algebra and quantiles that least squares needs.

pub(crate) mod definite;
pub(crate) mod quantiles;
pub(crate) mod spectrum;
pub(crate) mod sums;
pub(crate) mod triangle;
