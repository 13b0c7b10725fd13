//! Work done by friction, damping and excitation, and the balance of energy that it must close.

use fmm_model::Scalar;

use crate::SimulationError;

/// Powers (W) of friction, damping and excitation at one instant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Power<D> {
    pub(crate) friction: D,
    pub(crate) viscous: D,
    pub(crate) external: D,
}

/// Work done since the start of a motion.
///
/// ```text
/// W_friction = ∫ F_f (x′ − v_b) dt,   W_viscous = ∫ F_c x′ dt,   W_external = ∫ (f x′ − F_f v_b) dt
/// E_kinetic + E_potential + W_friction + W_viscous − W_external = constant
/// ```
///
/// With v_b the velocity of the counterface. Friction of a bristle law also stores energy, so that its work may fall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Work<D = f64> {
    /// Dissipated by friction (J).
    pub friction: D,
    /// Dissipated by the damping of the machine (J).
    pub viscous: D,
    /// Done by forces from outside, the counterface included (J).
    pub external: D,
}

/// Gauss-Legendre nodes on (0, 1) and weights, order 14.
const NODES: [(f64, f64); 7] = [
    (0.025_446_043_828_620_757, 0.064_742_483_084_434_85),
    (0.129_234_407_200_302_77, 0.139_852_695_744_638_32),
    (0.297_077_424_311_301_4, 0.190_915_025_252_559_46),
    (0.5, 0.208_979_591_836_734_7),
    (0.702_922_575_688_698_5, 0.190_915_025_252_559_46),
    (0.870_765_592_799_697_2, 0.139_852_695_744_638_32),
    (0.974_553_956_171_379_2, 0.064_742_483_084_434_85),
];

/// Pieces of one run are no more than this; a motion that needs more is not resolved by its samples anyway.
pub(crate) const PIECE_BUDGET: usize = 2_000_000;

impl<D: Scalar> Work<D> {
    pub(crate) fn none() -> Self {
        let zero = D::from(0.0);
        Self { friction: zero, viscous: zero, external: zero }
    }

    /// Adds the integral of `power` from `begin` to `end` (s), in pieces no longer than `scale`, of which `budget` is
    /// what is left.
    ///
    /// # Errors
    /// [`SimulationError::Exhausted`] if there are more pieces.
    pub(crate) fn add(
        &mut self,
        begin: f64,
        end: f64,
        scale: f64,
        budget: &mut usize,
        power: &mut impl FnMut(f64) -> Power<D>,
    ) -> Result<(), SimulationError> {
        if !(end > begin) {
            return Ok(());
        }
        let pieces = ((end - begin) / scale).ceil().max(1.0);
        *budget =
            budget.checked_sub(pieces as usize).ok_or_else(|| SimulationError::piece_budget(PIECE_BUDGET, end))?;
        let step = (end - begin) / pieces;
        for piece in 0..pieces as usize {
            let start = begin + piece as f64 * step;
            for (node, weight) in NODES {
                let power = power(start + node * step);
                self.friction += power.friction * (weight * step);
                self.viscous += power.viscous * (weight * step);
                self.external += power.external * (weight * step);
            }
        }
        Ok(())
    }

    /// Whether all of it is within the range of the number type.
    pub(crate) fn is_finite(&self) -> bool {
        [self.friction, self.viscous, self.external].into_iter().all(|work| work.value().is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A polynomial of degree 13 is integrated exactly, a sine to rounding.
    #[test]
    fn the_quadrature_is_of_order_14() {
        let mut work = Work::<f64>::none();
        let mut budget = 3;
        work.add(0.0, 2.0, 1.0, &mut budget, &mut |t| Power { friction: t.powi(13), viscous: t.sin(), external: 1.0 })
            .unwrap();
        assert!((work.friction / (2f64.powi(14) / 14.0) - 1.0).abs() < 1e-14, "{}", work.friction);
        assert!((work.viscous - (1.0 - 2f64.cos())).abs() < 1e-15, "{}", work.viscous);
        assert!((work.external - 2.0).abs() < 1e-15, "{}", work.external);
        work.add(3.0, 3.0, 1.0, &mut budget, &mut |_| unreachable!("an empty interval has no work")).unwrap();
        assert_eq!(budget, 1);
        let error = work.add(0.0, 1e9, 1e-9, &mut budget, &mut |_| unreachable!("too many pieces")).unwrap_err();
        assert!(matches!(error, SimulationError::Exhausted { .. }), "{error}");
    }
}
