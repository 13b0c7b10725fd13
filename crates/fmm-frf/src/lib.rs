//! Frequency response of machines with friction: impact tests, modes, and backbones of decays.
//!
//! ```
//! use fmm_frf::{Baseline, SingleDegreeOfFreedom, impulse};
//!
//! // A half-sine impact of 1000 N and 2.2 ms, sampled at 10 kHz.
//! let force: Vec<f64> = (0..=22).map(|i| 1000.0 * (std::f64::consts::PI * f64::from(i) / 22.0).sin()).collect();
//! let given = impulse(&force, 1e-4, Baseline::Keep)?;
//! assert!((given - 1.398_18).abs() < 5e-6);
//!
//! // It made a machine with friction answer with a receptance of 5.1e-3 m/N at most.
//! let machine = SingleDegreeOfFreedom::new(10.391, 0.0, 1982.0)?;
//! let friction = machine.friction_after_impact(given, 5.1e-3)?;
//! assert!((friction - 0.7502).abs() < 5e-5);
//! # Ok::<(), fmm_frf::FrfError>(())
//! ```
//!
//! # Which item
//!
//! | question | answer |
//! |---|---|
//! | how large was the impact, and was it one? | [`impulse`], [`Pulse`] |
//! | what is the response? | [`TrialAverage`] with an [`Estimator`], [`Coherence`], uncertainties from the trials |
//! | noise between impacts, responses longer than the record? | [`ForceWindow`], [`ExponentialWindow`] |
//! | in which form? | [`FrequencyResponse`]: receptance, mobility, accelerance; delays; bands |
//! | which modes? | [`FrequencyResponse::resonances`], [`RationalFit`] |
//! | which modes does a structure have, and which shapes? | `ModalFit` of each `MeasuredResponse` (feature `modes`) |
//! | which modes does a decay have, and how do frequency and damping depend on the amplitude? | [`decay_modes`], [`Backbone`] and its [`Suggestion`]; [`IsolatedMode`] takes one out |
//! | how much friction? | [`SingleDegreeOfFreedom::friction_after_impact`], [`CoulombLine`] |
//! | is it friction at all? | [`FrictionSpectrum`]: odd harmonics, against the linear response of [`SingleDegreeOfFreedom`] |
//!
//! # Estimators and fits
//!
//! * **[`Estimator::H1`]** unless there is a reason: after a [`ForceWindow`] the noise is that of the response, which
//!   it averages out. [`Estimator::H2`] where the force is the noisy channel, such as at resonances of a shaker;
//!   [`Estimator::Hv`] where both are; [`Estimator::MeanOfRatios`] to repeat the thesis, in a band where every trial
//!   has force.
//! * **[`RationalFit`]** fits complex values, with other modes as a background. It fits a *linear* mode: the damping
//!   that it finds in a response with friction depends on the impact.
//! * **Windows**: `None` for a motion that stops within the record, as it does with friction. An [`ExponentialWindow`]
//!   is for linear machines that ring longer: the added damping is subtracted.
//! * **Do not average impacts of different strength** on a machine with friction: it is another machine each time.
//!
//! # Units and conventions
//!
//! Everything is in SI units, frequencies are in Hz, and the time dependence is e^{+iωt}: a passive machine has a
//! receptance of negative imaginary part. Lines are whole multiples of rate/length. At zero frequency a mobility has no
//! receptance, which is an error and not an infinity.
//!
//! # Guarantees
//!
//! * A trial is added as a whole or, with an error that names sample or line, not at all.
//! * Adding a trial allocates nothing; estimates can be read at any time and more trials added after.
//! * A quotient by zero at a line is an error with the frequency. A coherence states the number of its
//!   averages; with fewer than two it [means nothing](Coherence::is_meaningful).
//!
//! # Cost
//!
//! A trial is two real transforms, n log n for n samples: 5 ns a sample up to some 10⁴, 17 ns for 330 000, on a Xeon at
//! 2.8 GHz.
//! Any length works, but a prime is ten times as slow as its neighbours: cut such a record by a sample. Estimates are a
//! pass over the lines, and a [band](AverageOptions::within) keeps memory to its lines.
//!
//! # Neighbours
//!
//! [`fmm-record`](https://docs.rs/fmm-record) reads the two channels; [`fmm-identify`](https://docs.rs/fmm-identify)
//! fits friction to the impacts themselves, by the complex mobility or in time. The closed forms here are good to about
//! half a percent and give its start values.
//!
//! # Features
//!
//! Both are off by default.
//!
//! * `modes`: many modes at once, by factorisations and eigenvalues of the crate nalgebra.
//! * `serde`: responses and oscillators are written and read, and checked as their constructors do; modes and resonances
//!   are written.

mod average;
mod channel;
mod decay;
mod error;
mod friction;
mod impulse;
mod modal;
#[cfg(feature = "modes")]
mod modes;
mod response;
#[cfg(feature = "serde")]
mod serialised;

pub use average::{AverageOptions, Coherence, Estimator, ExponentialWindow, ForceWindow, Taper, TrialAverage};
pub use channel::{Baseline, Channel};
pub use decay::{
    Backbone, BackboneOptions, BackbonePoint, DampingTerm, DampingTermKind, DecayMode, IsolatedMode, Suggestion,
    decay_modes,
};
pub use error::FrfError;
pub use fmm_model::{Estimated, ModelError};
pub use fmm_record::Complex64;
pub use friction::{CoulombLine, FrictionSpectrum, Harmonic, coulomb_impact_duration};
pub use impulse::{Hit, Pulse, impulse};
pub use modal::{Background, RationalFit};
#[cfg(feature = "modes")]
pub use modes::{
    DiagramPole, MeasuredResponse, ModalFit, ModalOptions, Mode, Pole, Residue, ShapePoint, StabilisationDiagram,
};
pub use response::{FrequencyResponse, Resonance, ResponseForm, SingleDegreeOfFreedom};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
