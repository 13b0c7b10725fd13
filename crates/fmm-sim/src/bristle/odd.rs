//! Test that a law is the mirror image of itself, as the engine takes it to be.

use fmm_friction::{BristleLaw, Regime};
use fmm_model::Scalar;

use crate::SimulationError;

/// What rounding may make of the two sides, relative to them.
const ROUNDING: f64 = 1e-9;

/// Looks at `law` over ten decades of speed and some states within its bounds, each with its mirror image.
///
/// # Errors
/// [`SimulationError::NotOdd`] if rate or coefficient are not opposite.
pub(super) fn require_odd<D: Scalar, L: BristleLaw<D> + ?Sized>(law: &L) -> Result<(), SimulationError> {
    let size = law.states();
    let mut buffers = [(); 2].map(|()| (vec![D::from(0.0); size], vec![D::from(0.0); size]));
    for part in [0.0, 0.3, 0.7] {
        for decade in -8..=2 {
            let speed = 10f64.powi(decade);
            let [ahead, back] = &mut buffers;
            let mut coefficients = [0.0; 2];
            for ((sign, (state, rate)), coefficient) in [(1.0, ahead), (-1.0, back)].into_iter().zip(&mut coefficients)
            {
                for (index, z) in state.iter_mut().enumerate() {
                    // Neighbouring elements lean to opposite sides.
                    let side = if index % 2 == 0 { sign } else { -sign };
                    *z = D::from(law.bound(index).value() * part * side);
                }
                law.rate(D::from(sign * speed), state, Regime::ALL_HOLD, rate);
                *coefficient = law.coefficient(D::from(sign * speed), state, rate).value();
            }
            let [(_, ahead), (_, back)] = &buffers;
            let rates = ahead.iter().zip(back).map(|(a, b)| (a.value(), b.value()));
            let differs = |(a, b): (f64, f64)| (a + b).abs() > ROUNDING * (a.abs() + b.abs());
            if rates.chain([(coefficients[0], coefficients[1])]).any(differs) {
                return Err(SimulationError::NotOdd { velocity: speed });
            }
        }
    }
    Ok(())
}
