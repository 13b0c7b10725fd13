//! The flexure as the thesis leaves it to be guessed: none of its dimensions is printed.

use fmm_model::{Flexure, LeafSpring, Scalar};

use crate::Found;

/// A deflection (m) and how many times smaller the parasitic motion is, as printed in section 4.2.
pub(super) const PRINTED_RATIO: (f64, f64) = (0.004, 230.0);
/// Largest deflection of the tests (m), by section 4.1.
pub(super) const LARGEST: f64 = 0.022;
/// Stress at that deflection (Pa), by section 4.1.
pub(super) const ALLOWED_STRESS: f64 = 70.4e6;
/// Yield stress over allowed stress, by section 4.1.
pub(super) const SAFETY: f64 = 6.0;

/// Four leaves, by section 3.1.
const LEAVES: u32 = 4;
/// Width and thickness (m) of stock sizes in inches, and the elastic modulus of steel (Pa), that fit Table 2 and
/// section 4.1.
const WIDTH: f64 = 4.0 * 0.0254;
const THICKNESS: f64 = 0.0254 / 16.0;
const ELASTIC_MODULUS: f64 = 205e9;

/// The machine's flexure: length by the printed ratio; width, thickness and modulus inferred. Its thickness and length
/// are the variables 0 and 1 of a number type with derivatives.
pub(super) fn inferred<D: Scalar>() -> Found<Flexure<D>> {
    let (deflection, ratio) = PRINTED_RATIO;
    let length = Flexure::length_for_motion_ratio(deflection, ratio)?;
    let (thickness, length) = (D::variable(THICKNESS, 0), D::variable(length, 1));
    Ok(Flexure::new(LEAVES, LeafSpring::new(length, D::from(WIDTH), thickness, D::from(ELASTIC_MODULUS))?)?)
}
