//! Requirements on the elements of [`MaxwellSlip`](crate::MaxwellSlip) and [`Gms`](crate::Gms).

use alloc::format;

use fmm_model::{Bounds, Parameter, Scalar};

use crate::{LawError, LawParameter, Regime, Role};

/// Checks pairs of a stiffness κᵢ (1/m) and a second number, called `name` and `symbol`: all positive and finite, and
/// no more pairs than a regime can tell apart.
pub(crate) fn check<D: Scalar>(elements: &[(D, D)], name: &str, symbol: &str) -> Result<(), LawError> {
    if elements.is_empty() || elements.len() > Regime::CAPACITY {
        return Err(LawError::ElementCount { got: elements.len(), most: Regime::CAPACITY });
    }
    for (index, (stiffness, second)) in elements.iter().enumerate() {
        positive("stiffness", "κ", "1/m", index, *stiffness)?;
        positive(name, symbol, "1", index, *second)?;
    }
    Ok(())
}

fn positive<D: Scalar>(name: &str, symbol: &str, unit: &'static str, index: usize, value: D) -> Result<D, LawError> {
    let number = index + 1;
    let parameter = Parameter::named(format!("{name}_{number}"), format!("{symbol}_{number}"), unit);
    LawParameter::new(parameter.bounded(Bounds::POSITIVE), Role::Level).check(value)
}

/// −1 for a negative velocity, else 1.
pub(crate) fn direction<D: Scalar>(velocity: D) -> f64 {
    if velocity.value() < 0.0 { -1.0 } else { 1.0 }
}
