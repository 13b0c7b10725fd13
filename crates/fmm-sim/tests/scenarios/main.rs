//! Scenarios as a user writes them: what each promises, and what is refused.

mod accelerations;
mod contracts;
mod derivatives;
mod duals;
mod hands;
mod limits;
mod loads;
mod memory;
mod prescribed;
mod rest;
mod springs;
mod steps;
mod weak_springs;
