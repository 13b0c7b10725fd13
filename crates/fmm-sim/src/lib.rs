//! Simulation of an oscillator with a sliding contact, through every stop and reversal, with its gradient.
//!
//! ```
//! use fmm_friction::Coulomb;
//! use fmm_model::{Damping, Oscillator};
//! use fmm_sim::{Engine, Exact, Sampling, Scenario};
//!
//! // The Monte Carlo case of the thesis: 10.391 kg, 1982 N/m, 0.275 N s/m, μ = 0.15 at 7.2 N.
//! let machine = Oscillator::new(10.391, 1982.0)?.with_damping(Damping::linear(0.275)?);
//! let scenario = Scenario::new(machine, Coulomb::new(0.15)?, 7.2)?.starting_at(0.0, 0.101)?;
//! let motion = Exact.run(&scenario, &Sampling::uniform(1e-3, 1501)?)?;
//!
//! let rest = motion.rest().expect("friction stops it");
//! assert!((rest.time - 1.473_110_373_941).abs() < 1e-12);
//! assert!((rest.position - 0.000_176_949_878).abs() < 1e-12);
//! assert_eq!(motion.half_cycles(), 7);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Which engine
//!
//! Stick and slip form a hybrid automaton. While the contact slips in one direction the equation of motion is smooth;
//! when the relative velocity reaches zero the load on the contact decides whether it sticks or slips back. There is no
//! velocity dead zone and no smoothed signum; the set of loads that stick is closed, |load| ≤ static level. All laws of
//! the sliding speed share the automaton; engines differ in the method for one phase of sliding.
//!
//! | engine | for | method | not for |
//! |---|---|---|---|
//! | [`Exact`] | piecewise linear laws on a linear machine | closed form between events; event times in closed form or by steps that provably miss none | nonlinear damping, a pendulum, resonance without damping, no spring or next to none |
//! | [`RungeKutta`] | any law of the sliding speed, any machine | order 8 from event to event, landing on each, to a tolerance | cases that [`Exact`] takes |
//! | [`Bristle`] | laws with internal state | Taylor series or other explicit steps, and an L-stable collocation method where the law is stiff, landing on every zero of the velocity and every yield | [`MaxwellSlip`](fmm_friction::MaxwellSlip) on a linear machine, which [`Exact`] can do |
//! | [`Moreau`] | cross-check | time stepping of the set-valued law, of first order | fits: no derivatives |
//! | [`Thesis`] | reproduction of the thesis only | the appendix' semi-implicit Euler, branch for branch | fits: its sum of squares jumps |
//!
//! The first three give gradients in every input, through every event: [`Exact`] to rounding, the others to the
//! accuracy that their pages state. [`simulate`] takes the engine that suits the law; [`Trajectory::engine`] names it.
//! External actions are [`Excitation`]s, which add up; a release or a push is an initial state. The [`Work`] done by
//! friction, damping and excitation comes along on request. A contact along a prescribed motion needs no engine:
//! [`friction_along`]. A loop that has the force of a controller, or of a larger model, moves a machine by a [`Stepper`].
//!
//! # Scenarios of common machines
//!
//! | machine | scenario |
//! |---|---|
//! | a bias force, a prestressed spring | [`Excitation::constant`]; x = 0 is still the force-free position of the spring |
//! | an incline of angle β | [`Excitation::constant`] of m g sin β, normal load m g cos β |
//! | a vertical machine | an incline with β = 90°, and the load that presses the contact |
//! | two contacts of one law in parallel | one contact, its normal load the sum of both |
//! | two contacts of levels μ₁ and μ₂ under N₁ and N₂ | one law with the sum of the forces and a load of 1: `Coulomb::new(μ₁ N₁ + μ₂ N₂)`, or a user's [`SlidingLaw`](fmm_friction::SlidingLaw) that adds two |
//! | a contact beside an oil film, c N s/m | [`Damping::linear`](fmm_model::Damping::linear) of the machine, as long as the counterface stands still |
//! | two bristle contacts | elements of one [`MaxwellSlip`](fmm_friction::MaxwellSlip), or a user's [`BristleLaw`](fmm_friction::BristleLaw) with the states of both |
//! | a block without a spring | a stiffness of zero |
//! | a spring pulled at its other end with velocity v | [`Excitation::ramp`] of k v |
//! | a counterface whose velocity b′ varies, on a linear machine | x counted from the counterface, under an [`Excitation::function`] of −m b″ − c b′ − k b; the work of friction is unchanged, that of force and damping is not |
//! | a normal load that varies, with a law of the sliding speed | [`Scenario::under_sampled_load`] |
//! | a normal load that grows or falls with the square of the position | [`Scenario::under_curved_load`] |
//! | bristles that an earlier motion has left bent | [`Scenario::with_deflection`] |
//! | any force over time | [`Excitation::function`], or [`Excitation::sampled_force`] |
//!
//! ```
//! use fmm_friction::CoulombStatic;
//! use fmm_model::Oscillator;
//! use fmm_sim::{Excitation, Sampling, Scenario, simulate};
//!
//! // 2 kg on an incline of 30° with 0.3 and 0.4, on a spring of 500 N/m that is free of force at the start.
//! let (weight, angle) = (2.0 * 9.81, 30f64.to_radians());
//! let law = CoulombStatic::new(0.3, 0.4)?;
//! let scenario = Scenario::new(Oscillator::new(2.0, 500.0)?, law, weight * angle.cos())?
//!     .driven_by(Excitation::constant(weight * angle.sin())?);
//! let rest = *simulate(&scenario, &Sampling::uniform(1e-3, 2000)?)?.rest().expect("friction holds it");
//! // It slides to 2 (m g sin β − μ N)/k and stays.
//! assert!((rest.position - 2.0 * (weight * angle.sin() - 0.3 * weight * angle.cos()) / 500.0).abs() < 1e-15);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Units and conventions
//!
//! SI units; x = 0 is the force-free position of the spring, t = 0 the initial state. Per unit mass, stiffness, damping
//! and force are those by the mass. A sample at the time of an event holds the state after it, its acceleration
//! included, which jumps there: at a reversal by twice the friction force over the mass.
//!
//! # Guarantees
//!
//! * *Events* are in order and carry their [`margin`](Event::margin), the distance of the load from the static level.
//!   [`Exact`] misses none and decides ties by comparing the numbers as they are; [`RungeKutta`] and [`Bristle`] land
//!   on each zero of their polynomials, which Bernstein coefficients prove to be all.
//! * *Derivatives* include those of the event times. They do not show that the number of half cycles may change; a
//!   margin near zero warns of it.
//! * *Errors* are typed: a motion with too many events or steps for any record, or one that leaves the range of
//!   numbers, is an error, not an endless run, a panic or a NaN.
//! * *The same arguments give the same bits*, in any order of calls and on any thread.
//!
//! # Cost
//!
//! On an AMD EPYC (Zen 4), by half cycles and samples, least of many calls (`cargo bench --bench growth`):
//!
//! | engine | a half cycle | a sample | two derivatives beside the values |
//! |---|---|---|---|
//! | [`Exact`] | 0.03 µs | 0.3 ns | 1.6 to 2.2 times as long |
//! | [`RungeKutta`] | 13 µs to 16 µs; to 1e-10 half of it | 1 to 18 ns | 1.6 to 2.2 times |
//! | [`Bristle`] | 11 µs to 23 µs for Dahl, 45 µs to 54 µs for stiff LuGre | 30 ns | 1.6 to 2 times |
//! | [`Thesis`], [`Moreau`] | - | 16 ns, 27 ns | none |
//!
//! While a measured force acts, [`Exact`] goes from sample to sample of the force, 0.3 µs each.
//! [`run_into`](Engine::run_into) uses the memory of a [`Trajectory`] again; [`Sampling::keeping`] leaves out the
//! channel that is not wanted, or adds the acceleration ([`Channels::All`]): 0.6 ns a sample of a free motion with
//! [`Exact`], elsewhere one evaluation of the force and the law, 15 to 55 ns.
//!
//! # Neighbours
//!
//! [`fmm-friction`](https://docs.rs/fmm-friction) has the laws, [`fmm-model`](https://docs.rs/fmm-model) the machine;
//! [`fmm-identify`](https://docs.rs/fmm-identify) fits motions to records. There are no features.

mod automaton;
mod bristle;
mod dormand_prince;
mod error;
mod exact;
mod fixed_step;
mod mechanics;
mod runge_kutta;
mod scenario;
mod simulate;
mod stepper;
#[cfg(test)]
mod tests;
mod trajectory;

pub use bristle::{Bristle, FrictionPoint, PrescribedMotion, friction_along, friction_from};
pub use error::SimulationError;
pub use exact::Exact;
pub use fixed_step::{Moreau, Thesis};
pub use runge_kutta::RungeKutta;
pub use scenario::{Channels, Direction, Event, EventKind, Excitation, Mode, Sampling, Scenario, State};
pub use simulate::{simulate, simulate_into};
pub use stepper::{Force, Stepped, Stepper};
pub use trajectory::{Energy, Engine, Samples, Trajectory, Work};

/// The README's example, run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
