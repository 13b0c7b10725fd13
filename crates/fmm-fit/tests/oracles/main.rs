//! Fits whose results others computed: NIST's reference data, Moré, Garbow and Hillstrom's problems, published
//! problems with bounds.

mod bands;
mod bounded;
mod design;
mod free_vibration;
mod harness;
mod joint;
mod landscape;
mod linear;
mod mgh;
mod pinene;
mod profile;
mod regression;
mod robust;
mod sensitivity;
mod strd;
mod strd_models;
