//! Least squares of a few unknowns.

pub(crate) mod gauss_newton;
pub(crate) mod triangle;
