//! Measured records: a uniformly sampled [`Record`] with its quantity and unit, readers that find it in a file, and its
//! examination before a model is fitted.
//!
//! ```
//! use fmm_record::{Examination, Quantity, Record};
//!
//! // A mass on a spring is let go at 0.5 s: 2.2 Hz, friction takes 5 % of the first height from every half cycle.
//! let velocity = |t: f64| {
//!     let half_cycles = (t - 0.5).max(0.0) * 4.4;
//!     let height = 0.975 - 0.05 * half_cycles.floor();
//!     if height > 0.0 { height * (std::f64::consts::PI * half_cycles).sin() } else { 0.0 }
//! };
//! let values = (0..8000).map(|i| 0.03 + velocity(f64::from(i) * 1e-3)).collect();
//! let examination = Examination::of(Record::sampled(1000.0, values, Quantity::Velocity, "m/s")?);
//!
//! let release = examination.release().expect("the record begins at rest");
//! assert!((release.rest_end - 0.5).abs() < 1e-4 && (release.offset - 0.03).abs() < 1e-12);
//!
//! let swings = examination.swings();
//! assert!((swings.frequency().unwrap() - 2.2).abs() < 1e-4);
//! let heights: Vec<f64> = swings.peaks().iter().map(|peak| (peak.value - release.offset).abs()).collect();
//! assert!((heights[0] - 0.975).abs() < 1e-4 && (heights[1] - 0.925).abs() < 1e-4);
//! assert!(examination.noise() < 1e-5);
//! # Ok::<(), fmm_record::RecordError>(())
//! ```
//!
//! # Which item
//!
//! | question | answer |
//! |---|---|
//! | what is in this file? | [`open()`]: channels with units and rates, and a [`Reading`] of each, the record with the choices that led to it; a [`Reader`] adds statements that the file lacks; module [`uff`] for functions that are no records |
//! | what did this channel measure, and in which unit? | [`Label`], the statement of the file; [`Request`], your statement; [`Meaning`], the answer |
//! | when does motion begin, how does it swing, how good is the record, is it one free vibration? | [`Examination`] |
//! | noise, resolution, limits of plain values? | [`noise`], [`quantisation_step`], [`saturation`] |
//! | another form of it? | [`Record::crop`], [`Record::scaled`], [`Record::shifted`], [`Record::smoothed_by`], [`Record::integrate`], [`Record::differentiate`] |
//! | which smoothing? | [`Smoothing`]: none for a fit, as it correlates the noise; polynomials for a derivative; a moving average to repeat what MATLAB's `smooth` or `movmean` did |
//!
//! # Units and conventions
//!
//! Times are in s, rates in Hz, values in the unit that the record states: a unit is a label, only [`Record::scaled`]
//! changes the numbers with it. A reader leaves the numbers as they are and says [`Quantity::Other`] unless the format
//! has a place for the quantity; [`Request::meaning`] reads `v [mm/s]` and the like, and refuses to guess.
//!
//! # Guarantees
//!
//! * A record has at least one sample, all finite, at equal intervals. Time stamps that are not uniform are an error
//!   with the first wrong stamp, unless they are asked for as they are ([`Reader::any_spacing`], [`Record::at_times`]).
//! * Nothing is repaired in silence: faults are reported, not removed, and no reader edits data. A file that
//!   contradicts itself is an error or, if its points are still readable, a warning.
//! * No reader allocates by a length that a header states, none panics on damaged bytes, and compressed data expand to
//!   256 MB at most.
//!
//! # Cost
//!
//! In proportion to the samples, whatever the span of a moving average; quantisation sorts at most 131 072 values. The
//! text reader keeps the columns in use only, the others read a file whole.
//!
//! # Features
//!
//! Text and Universal Files are always read. `mat`, on by default, reads MATLAB files of versions 4 to 7, `hdf5` those
//! of version 7.3, `npy` files of NumPy, `workbook` sheets of spreadsheets, `json` tables in JSON, `wav` sound, and
//! `gzip` any of them compressed. `serde` writes and reads records. A file whose reader is not compiled is refused with the name of the feature. Without
//! these features the crate depends on `fmm-model`, `realfft` and `thiserror` only.
//!
//! # Neighbours
//!
//! [`fmm-identify`](https://docs.rs/fmm-identify) identifies friction from a record,
//! [`fmm-frf`](https://docs.rs/fmm-frf) a frequency response from two.

#![cfg_attr(docsrs, feature(doc_cfg))]

mod calculus;
mod error;
mod examination;
mod files;
mod growing;
mod numerics;
mod record;
mod sampling;
#[cfg(feature = "serde")]
mod serialised;
mod spacing;
#[cfg(test)]
mod tests;
mod units;

pub use calculus::{EndRule, Smoothing};
pub use error::RecordError;
pub use examination::Examination;
pub use examination::further_release::FurtherRelease;
pub use examination::hum::Hum;
pub use examination::interruption::Interruption;
pub use examination::noise::{noise, quantisation_step};
pub use examination::offset_step::OffsetStep;
pub use examination::release::Release;
pub use examination::saturation::{Saturation, saturation};
pub use examination::second_mode::SecondMode;
pub use examination::spikes::Spike;
pub use examination::swings::{Crossing, Peak, Swings};
pub use examination::upsampling::Upsampling;
#[cfg(any(feature = "mat", feature = "npy"))]
pub use files::arrays::Array;
pub use files::reading::{Column, Reading};
pub use files::{Channel, DataFile, Format, Reader, open, uff};
pub use growing::GrowingRecord;
pub use numerics::spectrum::{RealTransform, Spectrum};
pub use realfft::num_complex::Complex64;
pub use record::Record;
pub use sampling::Sampling;
pub use units::label::Label;
pub use units::request::{Meaning, Request};
pub use units::{Quantity, WrittenUnit};

/// Runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
