//! Experiments besides a ring-down seen by a faithful sensor: accelerations, filters, driven motion, and several kinds
//! together.

mod acceleration;
mod design;
mod driven;
mod driven_curve;
mod force;
mod force_curves;
mod force_models;
mod friction_curve;
mod friction_over_position;
mod impact;
mod joint;
mod no_friction;
mod noisy_motion;
mod run_down;
mod same_statement;
mod simulated;
mod springs;
mod unequal_times;
mod unseen_damping;
