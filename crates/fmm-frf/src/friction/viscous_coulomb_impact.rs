//! The height of a receptance peak with dry friction and viscous damping together.

use crate::{
    FrfError, ModelError, SingleDegreeOfFreedom, friction_force_of_coulomb_impact, peak_receptance_of_coulomb_impact,
};

/// Peak of the receptance (m/N) of a `machine` with viscous damping and a `friction_force` F (N) after an `impulse` J
/// (N s).
///
/// ```text
/// |H| = h(q)/(c ω₀),   h(q) = 1 − ln(1 + q)/q,   q = π c J/(4 m F)                                     (1)
/// ```
///
/// # Derivation
/// Both together take a from the slope of the amplitude that [`peak_receptance_of_coulomb_impact`] has and β A from its
/// size, with a = 2F/(π m ω₀) and β = c/2m:
///
/// ```text
/// A′ = −β A − a,   A(t) = (A₀ + a/β) e^{−βt} − a/β,   T = ln(1 + q)/β,   q = β A₀/a                    (2)
/// ```
///
/// Half the area under A is |X(ω₀)| = (A₀ − a T)/2β, and A₀ = J/(m ω₀). Without friction it is 1/(c ω₀), the peak of
/// the linear machine; without damping q is zero and h(q) = q/2. A simulated
/// peak of the machine of the thesis' chapter 8 is 0.2 % to 0.5 % above (1), as it is above the formula without damping
/// where there is none; ignoring its c costs 1.3 % to 2.7 %.
///
/// ```
/// use fmm_frf::{SingleDegreeOfFreedom, peak_receptance_of_viscous_coulomb_impact};
///
/// // High impact of chapter 8; a simulation gives 5.7933e-3 m/N, and the formula without damping 5.9541e-3 m/N.
/// let machine = SingleDegreeOfFreedom::new(10.391, 0.275, 1982.0)?;
/// let peak = peak_receptance_of_viscous_coulomb_impact(1.64, &machine, 0.113 * 6.67)?;
/// assert!((peak / 5.7933e-3 - 1.0).abs() < 2.5e-3);
/// # Ok::<(), fmm_frf::FrfError>(())
/// ```
///
/// # Errors
/// [`ModelError::NotPositive`](crate::ModelError::NotPositive) for any argument, or for a result out of range.
pub fn peak_receptance_of_viscous_coulomb_impact(
    impulse: f64,
    machine: &SingleDegreeOfFreedom,
    friction_force: f64,
) -> Result<f64, FrfError> {
    let (mass, omega) = (machine.mass(), machine.natural_angular_frequency());
    let undamped = peak_receptance_of_coulomb_impact(impulse, mass, omega, friction_force)?;
    // q/2 is the peak without viscous damping, by that without friction.
    let q = 2.0 * undamped * machine.damping() * omega;
    Ok(ModelError::require_positive("peak receptance", undamped * share(q), "m/N")?)
}

/// Kinetic friction force (N) out of a measured peak of the receptance (m/N) of a `machine` whose viscous damping is
/// known, the inverse of [`peak_receptance_of_viscous_coulomb_impact`].
///
/// ```
/// use fmm_frf::{SingleDegreeOfFreedom, friction_force_of_viscous_coulomb_impact};
///
/// let machine = SingleDegreeOfFreedom::new(10.391, 0.275, 1982.0)?;
/// let friction = friction_force_of_viscous_coulomb_impact(1.64, &machine, 5.7933e-3)?;
/// assert!((friction / (0.113 * 6.67) - 1.0).abs() < 2.5e-3);
/// # Ok::<(), fmm_frf::FrfError>(())
/// ```
///
/// # Errors
/// [`ModelError::NotPositive`](crate::ModelError::NotPositive) for any argument, and for the friction force if the peak
/// is as high as the machine's own damping allows without friction, or higher.
pub fn friction_force_of_viscous_coulomb_impact(
    impulse: f64,
    machine: &SingleDegreeOfFreedom,
    peak_receptance: f64,
) -> Result<f64, FrfError> {
    let (mass, omega) = (machine.mass(), machine.natural_angular_frequency());
    let undamped = friction_force_of_coulomb_impact(impulse, mass, omega, peak_receptance)?;
    let height = peak_receptance * machine.damping() * omega;
    if height >= 1.0 {
        return Err(ModelError::NotPositive { quantity: "friction force", value: 0.0, unit: "N" }.into());
    }
    // h rises and bends down, so that Newton's steps from the left never pass the root; h(q) < q/2 puts 2h there.
    let mut q = 2.0 * height;
    for _ in 0..200 {
        let step = (height - 0.5 * q * share(q)) / slope(q);
        if !(step > 1e-15 * q) {
            break;
        }
        q += step;
    }
    // |H| of the formula without damping is q/2 where the measured one is h(q).
    Ok(ModelError::require_positive("friction force", undamped * share(q), "N")?)
}

/// h(q)/(q/2) = 2 (q − ln(1 + q))/q², from 1 at q = 0 downwards.
fn share(q: f64) -> f64 {
    if q < 1e-2 {
        // 2 Σ (−q)ⁿ/(n + 2), where the difference would cancel.
        (0..9).rev().fold(0.0, |sum, n| 2.0 / f64::from(n + 2) - q * sum)
    } else {
        2.0 * (q - q.ln_1p()) / (q * q)
    }
}

/// dh/dq = (ln(1 + q) − q/(1 + q))/q².
fn slope(q: f64) -> f64 {
    if q < 1e-2 {
        // Σ (−q)ⁿ (n + 1)/(n + 2).
        (0..9).rev().fold(0.0, |sum, n| f64::from(n + 1) / f64::from(n + 2) - q * sum)
    } else {
        (q.ln_1p() - q / (1.0 + q)) / (q * q)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_is_one() {
        for damping in [0.0, 1e-6, 0.275, 8.0] {
            let machine = SingleDegreeOfFreedom::new(10.391, damping, 1982.0).unwrap();
            for friction in [1e-2, 0.75, 40.0] {
                let peak = peak_receptance_of_viscous_coulomb_impact(1.42, &machine, friction).unwrap();
                let found = friction_force_of_viscous_coulomb_impact(1.42, &machine, peak).unwrap();
                // Where friction is small beside damping, the peak hardly knows of it.
                let blur = 1e-14 / (1.0 - peak * damping * machine.natural_angular_frequency());
                assert!((found / friction - 1.0).abs() < blur, "c = {damping}: {found} N, not {friction} N");
            }
        }
    }

    #[test]
    fn both_limits_are_those_of_one_kind_of_damping() {
        let machine = |damping| SingleDegreeOfFreedom::new(2.0, damping, 50.0).unwrap();
        let coulomb = peak_receptance_of_coulomb_impact(1.3, 2.0, 5.0, 0.7).unwrap();
        let found = peak_receptance_of_viscous_coulomb_impact(1.3, &machine(0.0), 0.7).unwrap();
        assert!((found / coulomb - 1.0).abs() < 1e-15, "{found} m/N, not {coulomb} m/N");
        let found = peak_receptance_of_viscous_coulomb_impact(1.3, &machine(0.4), 1e-9).unwrap();
        assert!((found * 0.4 * 5.0 - 1.0).abs() < 1e-7, "{found} m/N, not 1/(c ω₀)");
        assert!(friction_force_of_viscous_coulomb_impact(1.3, &machine(0.4), 0.5).is_err(), "no friction left");
    }

    /// Across the switch from series to formula nothing jumps by more than the formula's rounding, 2ε/q.
    #[test]
    fn series_and_formula_meet() {
        let (below, above) = (1e-2 * (1.0 - 1e-15), 1e-2);
        assert!((share(below) - share(above)).abs() < 1e-13, "{} and {}", share(below), share(above));
        assert!((slope(below) - slope(above)).abs() < 1e-13, "{} and {}", slope(below), slope(above));
    }
}
