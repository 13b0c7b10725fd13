//! The posterior of what was found in a record, in builds with the feature `posterior`.

#[cfg(feature = "posterior")]
mod corner;
#[cfg(feature = "posterior")]
mod sampled;
#[cfg(not(feature = "posterior"))]
mod unavailable;

#[cfg(feature = "posterior")]
pub(crate) use sampled::Posterior;
#[cfg(not(feature = "posterior"))]
pub(crate) use unavailable::Posterior;
