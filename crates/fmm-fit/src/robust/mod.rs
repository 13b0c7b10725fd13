//! Fits that outliers do not spoil.

pub(crate) mod loss;
pub(crate) mod m_covariance;
pub(crate) mod problem;
pub(crate) mod robust_fit;
