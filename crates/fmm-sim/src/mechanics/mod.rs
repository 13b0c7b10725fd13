//! Mechanics that the engines share: forces over time, the linear machine in closed form, contact and spring.

mod contact;
mod crossing;
mod curve;
mod decay;
mod forcing;
mod spring;
mod steady;

pub(crate) use contact::{Branches, Levels, Sliding, holds_for_good, load, normal_load, rounding};
pub(crate) use crossing::{crossing, first_crossing};
pub(crate) use curve::{Curve, ROUNDING, SEARCH_BUDGET, Wave, first_zero};
pub(crate) use decay::Decay;
pub(crate) use forcing::{ForceWave, Forcing, Piece};
pub(crate) use spring::{Corner, Range, Spring, WEAK_SPRING};
pub(crate) use steady::SteadyReserve;
