//! Bounded nonlinear least squares for argmin, with covariance, rank and what the data could not tell.
