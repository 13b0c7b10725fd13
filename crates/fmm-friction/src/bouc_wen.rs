//! The Bouc-Wen model: a hysteresis loop with an adjustable shape.

use fmm_model::{Bounds, Parameter, Scalar};

use crate::expansion::{Expansion, is_whole, is_whole_with_derivatives, product, raise};
use crate::family::law_family;
use crate::power::power;
use crate::{BoucWenByLevel, BristleLaw, LawError, LawFamily, LawParameter, Regime, Role};

/// The part of the bound within which the series of a power that is not whole is no good.
const NEAR_ZERO: f64 = 0.2;

law_family! {
    /// The Bouc-Wen model of hysteresis.
    ///
    /// ```text
    /// F = N κ z,    dz/dt = v (A − (β sgn(v z) + γ) |z|ⁿ)
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | κ | `stiffness` | 1/m | coefficient per z |
    /// | A | `amplitude` | 1 | slope of z over the displacement at z = 0 |
    /// | β | `beta` | 1/mⁿ | shape of the loop |
    /// | γ | `gamma` | 1/mⁿ | shape of the loop, −β < γ ≤ β |
    /// | n | `exponent` | 1 | sharpness of the bend, ≥ 1 |
    ///
    /// The state z (m) stays within |z| ≤ (A/(β + γ))^(1/n); sliding, the coefficient tends to κ times that. Scaling A,
    /// β and γ against κ leaves the force as it is, so a fit holds A = 1. With n = 1, γ = 0 this is
    /// [`Dahl`](crate::Dahl) with i = 1, σ = κ A and μ = κ A/β; for n → ∞ it becomes one element of
    /// [`MaxwellSlip`](crate::MaxwellSlip).
    ///
    /// At z = 0 the rate has, for γ ≠ 0, only n − 1 continuous derivatives over z.
    ///
    /// # References
    /// Y. K. Wen, "Method for random vibration of hysteretic systems", J. Engineering Mechanics Division ASCE 102
    /// (1976) 249.
    ///
    /// M. Ismail, F. Ikhouane, J. Rodellar, "The hysteresis Bouc-Wen model, a survey", Arch. Computational Methods in
    /// Engineering 16 (2009) 161, doi 10.1007/s11831-009-9031-8.
    pub struct BoucWen, "bouc_wen", bristle {
        stiffness: LawParameter::positive("stiffness", "κ", "1/m", Role::Level).typically(50.0),
        amplitude: LawParameter::positive("amplitude", "A", "1", Role::Shape),
        beta: LawParameter::positive("beta", "β", "1/m^n", Role::Shape).typically(25.0),
        gamma: LawParameter::new(Parameter::new("gamma", "γ", "1/m^n"), Role::Shape),
        exponent: LawParameter::new(
            Parameter::new("exponent", "n", "1").bounded(Bounds::POSITIVE.at_least(1.0)),
            Role::Shape,
        ),
    }

    /// `stiffness` κ (1/m), `amplitude` A (1), `beta` β and `gamma` γ (1/mⁿ), `exponent` n (1).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if a parameter lies outside its bounds or is not finite, [`LawError::NotDissipative`]
    /// unless −β < γ ≤ β.
    pub fn new {
        let (loading, unloading) = (beta.value() + gamma.value(), beta.value() - gamma.value());
        if loading <= 0.0 || unloading < 0.0 {
            return Err(LawError::NotDissipative { beta: beta.value(), gamma: gamma.value() });
        }
    }
    fitted by BoucWenByLevel
    special cases [crate::SpecialCase::only("dahl", &[("exponent", 1.0)]), crate::SpecialCase::of("coulomb")]
    tried [crate::SearchStage::FurtherPresliding.trial().damped().fixing(&[("amplitude", 1.0)])]
}

impl<D: Scalar> BristleLaw<D> for BoucWen<D> {
    fn states(&self) -> usize {
        1
    }

    fn rate(&self, velocity: D, state: &[D], _regime: Regime, rate: &mut [D]) {
        let ahead = if velocity.value() < 0.0 { -state[0] } else { state[0] };
        let softening = if ahead.value() < 0.0 {
            (self.gamma - self.beta) * power(-ahead, self.exponent)
        } else {
            (self.gamma + self.beta) * power(ahead, self.exponent)
        };
        rate[0] = velocity * (self.amplitude - softening);
    }

    fn coefficient(&self, _velocity: D, state: &[D], _rate: &[D]) -> D {
        self.stiffness * state[0]
    }

    fn bound(&self, _index: usize) -> D {
        (self.amplitude / (self.beta + self.gamma)).powf(D::from(1.0) / self.exponent)
    }

    fn steady_coefficient(&self, _speed: D) -> Option<D> {
        Some(self.stiffness * self.bound(0))
    }

    fn expand(&self, order: usize, series: &mut Expansion<D>) -> bool {
        series.coefficient[order] = self.stiffness * series.state[order];
        if series.held {
            return true;
        }
        let deflection = series.state[0].value();
        let near_zero = deflection.abs() < NEAR_ZERO * self.bound(0).value();
        if is_whole_with_derivatives(self.exponent) || near_zero && !is_whole(self.exponent) {
            return false;
        }
        let (sign, shape) =
            if deflection < 0.0 { (-1.0, self.gamma - self.beta) } else { (1.0, self.gamma + self.beta) };
        let [size, slope, powers, room, ..] = &mut series.room;
        size[order] = series.state[order] * sign;
        raise(size, self.exponent, powers, room, order);
        let softening = shape * powers[order];
        slope[order] = if order == 0 { self.amplitude - softening } else { -softening };
        series.rate[order] = product(&series.velocity, slope, order);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rate(law: &BoucWen, velocity: f64, state: f64) -> f64 {
        let mut rate = [0.0];
        law.rate(velocity, &[state], Regime::ALL_HOLD, &mut rate);
        rate[0]
    }

    /// n = 2 on a monotone path from rest: z = z_m tanh(A x/z_m) with z_m = √(A/(β + γ)).
    #[test]
    fn follows_the_closed_form_of_exponent_two() {
        let law = BoucWen::new(2e4, 1.0, 6e8, 4e8, 2.0).unwrap();
        let most = 1e9f64.powf(-0.5);
        assert!((law.bound(0) - most).abs() < 1e-20, "{} m", law.bound(0));
        for x in [0.0, 1e-6, 2e-5, 1e-4] {
            let tanh = f64::tanh(x / most);
            let slope = rate(&law, 1.0, most * tanh);
            assert!((slope - (1.0 - tanh * tanh)).abs() < 1e-15, "x = {x} m: {slope}");
        }
    }

    /// Against the deflection the loop is stiffer: with γ = β it unloads on a straight line.
    #[test]
    fn unloads_as_gamma_says() {
        let law = BoucWen::new(1.0, 1.0, 5e3, 5e3, 1.0).unwrap();
        assert_eq!(rate(&law, -0.1, 5e-5), -0.1);
        assert_eq!(rate(&law, 0.1, 5e-5), 0.05);
    }

    #[test]
    fn loops_that_create_energy_are_refused() {
        let refused = |beta: f64, gamma: f64| BoucWen::new(1.0, 1.0, beta, gamma, 1.0).unwrap_err().to_string();
        assert_eq!(refused(1.0, 2.0), "a Bouc-Wen loop needs −β < γ ≤ β, but β = 1 and γ = 2");
        assert_eq!(refused(1.0, -1.0), "a Bouc-Wen loop needs −β < γ ≤ β, but β = 1 and γ = -1");
        assert!(BoucWen::new(1.0, 1.0, 1.0, 0.5, 0.9).is_err());
    }
}
