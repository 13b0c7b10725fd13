//! Numerical tools of this crate: spectra, small linear fits, order statistics.

pub(crate) mod fourier;
pub(crate) mod least_squares;
pub(crate) mod line_search;
pub(crate) mod order;
pub(crate) mod real_transform;
