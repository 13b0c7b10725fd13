//! Fits whose results others computed: NIST's reference data, Moré, Garbow and Hillstrom's problems, published
//! problems with bounds.

mod bounded;
mod free_vibration;
mod harness;
mod linear;
mod mgh;
mod strd;
mod strd_models;
