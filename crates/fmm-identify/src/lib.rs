//! Friction parameters out of measured ring-downs, driven motions, hammer blows and forces along motions, with their
//! uncertainty and what the record could not tell.
//!
//! A [`Record`](fmm_record::Record) of a machine that vibrates freely or is driven is prepared ([`Experiment`]), what
//! is known of the machine is stated ([`Machine`]), and as many laws as the record asks for ([`search`]), several
//! ([`compare`]) or one ([`identify`]) are fitted to it by simulating the motion exactly, through every reversal and
//! stop.
//!
//! ```
//! use fmm_friction::CoulombViscous;
//! use fmm_identify::{Known, Machine, Preparation, Experiment, identify};
//! use fmm_model::Oscillator;
//! use fmm_record::{Quantity, Record};
//! use fmm_sim::{Engine, Exact, Sampling, Scenario};
//!
//! // A stand-in for a measurement: 10.391 kg, 1982 N/m, 0.25 · 14 N of friction, released at 15 mm, 1 kHz.
//! let machine = Oscillator::new(10.391, 1982.0)?;
//! let scenario = Scenario::new(machine, CoulombViscous::new(0.25, 0.02)?, 14.0)?.starting_at(0.015, 0.0)?;
//! let velocity = Exact.run(&scenario, &Sampling::uniform(1e-3, 1500)?)?.velocity().values().to_vec();
//!
//! let record = Record::new(0.0, 1e-3, velocity, Quantity::Velocity, "m/s")?;
//! let decay = Experiment::ring_down(&record, &Preparation::default())?;
//! let machine = Machine::of_mass(Known::new(10.391, 0.005)?)?.with_normal_load(Known::new(14.0, 0.014)?)?;
//! let found = identify::<CoulombViscous>(&machine, &[decay])?;
//!
//! let mu = found.finding("mu").unwrap();
//! assert!((mu.value() - 0.25).abs() < 1e-9);
//! // Without noise only mass and load are uncertain: 0.25 · √((0.005/10.391)² + 0.001²).
//! assert!((mu.uncertainty().unwrap() - 2.774e-4).abs() < 1e-6);
//! let (low, high) = mu.interval(0.95).unwrap();
//! println!("μ lies between {low:.4} and {high:.4} with 95 %");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Which item
//!
//! | question | answer |
//! |---|---|
//! | Which start values do I give? | none; they come from the peaks and crossings of the record |
//! | What can a free vibration show? | frequency, damping per mass and friction per mass; not the mass |
//! | How do I get μ? | give a mass or a stiffness, and the normal load, with their uncertainties |
//! | Which law? | [`search`] tries as many as the record asks for, [`compare`] those given, and both say when it does not decide; [`Candidate`] chooses one by its name |
//! | How much friction at which speed, before any law? | [`FrictionCurve`], with intervals |
//! | Damping of the machine beside the law? | known: [`Machine::with_damping`]; to be found: [`Candidate::with`] and [`Terms`] |
//! | A time limit, threads, options of the solver, a look at every step? | [`Inquiry`] |
//! | Several records? | give them together: the law and the frequency are shared, initial states and offsets are not |
//! | An accelerometer? | its record is a ring-down like any other; a filter of the sensor is stated or fitted, [`Sensor`] |
//! | A shaker, a motor, a moving base? | [`Experiment::driven`] with the measured [`Drive`]; its gain and a delay of the response can be fitted |
//! | Experiments of several kinds, without contact, under other loads? | one slice: [`Experiment::without_contact`], [`Experiment::with_load_factor`] |
//! | Is friction in proportion to the load? | [`FrictionOverLoad`], of runs at several loads that may differ |
//! | A static level? | a slow force through the breakaway, [`Experiment::driven`]; a ring-down does not tell it |
//! | How does damping depend on velocity? | [`fmm_frf::Backbone`]: frequency and damping over the amplitude |
//! | Friction out of impacts of a hammer? | [`ImpactTrial`], and [`Experiment::impact`] for the motion or [`Experiment::mobility`] for its spectrum |
//! | A force measured along a motion: a joint, a tribometer, a damper? | [`ForceRecord`] in [`identify`] and [`compare`]; [`Terms`] lists what acts beside friction |
//! | The same without a law? | [`ForceRecord::friction_over_speed`] and [`friction_over_speed_and_load`](ForceRecord::friction_over_speed_and_load), [`ForceRecord::loops`], [`ForceRecord::onsets`] |
//! | What if mass, stiffness or damping were others? | [`Problem::declared`] with [`Sensitivity`](fmm_fit::Sensitivity) or [`Refit`](fmm_fit::Refit) |
//! | Which test next? | [`design::Plan`]: what [`PlannedTest`](design::PlannedTest)s would tell beside what is known, and which set of them is best |
//! | Between which values does it lie? | [`Finding::interval`], by Student's t with the degrees of freedom of all that is uncertain |
//! | Does value ± k u mislead? | [`Identification::profiles`] |
//! | What makes it uncertain? | [`Finding::budget`]: residuals, mass or stiffness, load, gain, other laws |
//! | What is probable, where a bound or a bend makes value ± u wrong? | `Identification::posterior` (feature `sampler`) |
//! | Are the uncertainties to be trusted? | read the [`warnings`](Identification::warnings): they name what breaks them |
//!
//! # Units and conventions
//!
//! Findings are in the units that follow from the record's: of a velocity in m/s, friction per mass in m/s²; of one in
//! V, in V/s. A gyroscope whose gain is not known gives a friction all the same, in its own unit. A load makes
//! coefficients of forces, and nothing else does. Times are on the time axis of the record.
//!
//! # Guarantees
//!
//! * Nothing is smoothed, and what was left out (rest before the release, spikes) is in the
//!   [summary](Experiment::summary) and in the warnings.
//! * Parameters that the record does not tell apart have no uncertainty, but a warning that names them. A static level
//!   of its own is held, and a warning says so.
//! * How a fit ends is in the result. Errors are for what does not let it begin.
//! * The same records and options give the same bits, on any number of threads.
//!
//! # Cost
//!
//! In proportion to samples and records. Of 1500 samples, on an AMD EPYC (`cargo bench --bench growth`): 3 ms to
//! prepare, 1 ms for Coulomb's law, 1.5 ms with a viscous part, and 22 ms for Berger's; laws of more parameters are
//! fitted from many starts, Stribeck's with a free exponent in 0.25 s of 3000 samples on two threads. Hold what is
//! known: it is quicker, and better determined.
//! [`compare`] costs the sum of its candidates.
//! 25 000 samples of a force along a motion take 50 ms by Dahl's law with a viscous part and a zero.
//! [`search`] takes 30 ms of 3000 samples where a simple law is right, and 1 s to 5 s on two threads where it is not.
//!
//! # Features
//!
//! `rayon` is on by default, the others are off.
//!
//! * `rayon`: the starts and derivatives of a fit by a law without a closed form, and the laws of a search, on all
//!   threads of the current pool, with the same result.
//! * `sampler`: the posterior of an identification, its intervals beside the others, and predictive checks.
//! * `serde`: findings, comparisons and reports serialise.
//! * `schemars`: so do their JSON schemas.
//!
//! # Neighbours
//!
//! [`fmm-record`](https://docs.rs/fmm-record) reads the files, [`fmm-sim`](https://docs.rs/fmm-sim) simulates,
//! [`fmm-fit`](https://docs.rs/fmm-fit) fits, [`fmm-frf`](https://docs.rs/fmm-frf) looks at blows without a law;
//! [`fmm-uq`](https://docs.rs/fmm-uq) propagates uncertainties through anything.

#![cfg_attr(docsrs, feature(doc_cfg))]

mod candidate;
pub mod design;
mod error;
mod experiment;
mod finding;
mod fit;
mod friction_curve;
mod identification;
mod judgement;
mod law;
mod linear_algebra;
mod machine;
#[cfg(feature = "sampler")]
pub mod posterior;
mod problem;
mod quantities;
mod report;
mod residuals;
mod threads;
mod warning;
#[cfg(feature = "serde")]
mod written;

pub use candidate::Candidate;
pub use error::IdentifyError;
pub use experiment::force::{ForceLoop, ForceRecord, Onset, SpeedBin};
pub use experiment::{
    Drive, Experiment, Experiments, ImpactSummary, ImpactTrial, Offset, Preparation, RecordSummary, Sensor,
};
pub use finding::{Finding, Origin, Source};
pub use friction_curve::{FrictionCurve, FrictionLevel};
pub use identification::{FittedMotion, Identification, Profile, Profiles, Validation};
pub use judgement::{Comparison, FrictionOverLoad, Inquiry, ScoreTest, Unseen, compare, identify, search};
pub use machine::{Known, Machine, Terms};
pub use problem::Problem;
pub use warning::{Severity, Warning};

/// The README's example, run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
