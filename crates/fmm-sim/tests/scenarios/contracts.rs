//! A law that breaks its promises is refused, not used on half of its range.

use fmm_friction::{BristleLaw, Regime};
use fmm_model::{Oscillator, Scalar};
use fmm_sim::{Bristle, Engine, PrescribedMotion, Sampling, Scenario, SimulationError, friction_along};

/// Dahl's law with another level in each direction.
struct OneSided {
    positive: f64,
    negative: f64,
}

impl<D: Scalar> BristleLaw<D> for OneSided {
    fn states(&self) -> usize {
        1
    }
    fn rate(&self, velocity: D, state: &[D], _: Regime, rate: &mut [D]) {
        let level = if velocity.value() < 0.0 { -self.negative } else { self.positive };
        rate[0] = velocity * (D::from(1.0) - state[0] * 1e4 / level);
    }
    fn coefficient(&self, _: D, state: &[D], _: &[D]) -> D {
        state[0] * 1e4
    }
    fn bound(&self, _: usize) -> D {
        D::from(self.positive.max(self.negative) / 1e4)
    }
}

#[test]
fn a_law_that_is_not_odd_is_refused() {
    let scenario = |law| {
        let scenario: Scenario<f64, _> = Scenario::new(Oscillator::new(1.0, 100.0).unwrap(), law, 1.0).unwrap();
        scenario.starting_at(0.1, 0.0).unwrap()
    };
    let sampling = Sampling::uniform(1e-3, 300).unwrap();
    let odd = scenario(OneSided { positive: 0.2, negative: 0.2 });
    assert!(Bristle::default().run(&odd, &sampling).is_ok());
    let law = OneSided { positive: 0.2, negative: 0.3 };
    let path = PrescribedMotion::at_speed(&[0.0, 1e-4, -1e-4], 1e-3).unwrap();
    assert!(matches!(friction_along(&law, 1.0, &path), Err(SimulationError::OutOfRange { .. })));
    let refused = Bristle::default().run(&scenario(law), &sampling);
    assert!(matches!(refused, Err(SimulationError::OutOfRange { .. })), "{refused:?}");
}
