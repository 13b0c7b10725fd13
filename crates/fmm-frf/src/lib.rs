//! Impact tests in the frequency domain: the [`impulse`] of a blow, the three forms of a [`FrequencyResponse`], the
//! closed form of a linear [`SingleDegreeOfFreedom`], and the friction force behind a receptance that grows with
//! the impulse.
//!
//! Everything is in SI units, frequencies are in Hz, and the time dependence is e^{+iωt}: a passive machine has a
//! receptance of negative imaginary part.
//!
//! ```
//! use fmm_frf::{Baseline, SingleDegreeOfFreedom, friction_force_of_coulomb_impact, impulse};
//!
//! // A half-sine blow of 1000 N and 2.2 ms, sampled at 10 kHz.
//! let force: Vec<f64> = (0..=22).map(|i| 1000.0 * (std::f64::consts::PI * f64::from(i) / 22.0).sin()).collect();
//! let blow = impulse(&force, 1e-4, Baseline::Keep)?;
//! assert!((blow - 1.398_18).abs() < 5e-6);
//!
//! // It made a machine with friction answer with a receptance of 5.1e-3 m/N at most.
//! let machine = SingleDegreeOfFreedom::new(10.391, 0.0, 1982.0)?;
//! let friction = friction_force_of_coulomb_impact(blow, 10.391, machine.natural_angular_frequency(), 5.1e-3)?;
//! assert!((friction - 0.7502).abs() < 5e-5);
//! # Ok::<(), fmm_frf::FrfError>(())
//! ```

mod coulomb_impact;
mod error;
mod impulse;
mod oscillator;
mod response;

pub use coulomb_impact::{
    coulomb_impact_duration, friction_force_of_coulomb_impact, peak_receptance_of_coulomb_impact,
};
pub use error::FrfError;
pub use impulse::{Baseline, impulse, impulse_of_record};
pub use num_complex::Complex64;
pub use oscillator::SingleDegreeOfFreedom;
pub use response::{FrequencyResponse, ResponseForm};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
