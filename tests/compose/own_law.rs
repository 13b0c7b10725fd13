//! A friction law of one's own, written outside the crates: simulated, differentiated, fitted and compared.

use fmm_friction::{Affine, LawError, LawFamily, LawParameter, LawVisitor, PiecewiseLinearLaw, Role, SlidingLaw};
use fmm_identify::{Candidate, Experiment, Machine, Preparation, compare};
use fmm_model::{Bounds, Oscillator, Parameter, Scalar};
use fmm_record::{Quantity, Record};
use fmm_sim::{Engine, Exact, Sampling, Scenario};

use crate::measurement::white;

/// A coefficient that doubles over half a metre per second: μ (1 + v/v₀).
#[derive(Debug, Clone, Copy)]
struct Rising<D = f64>(D);

/// v₀ (m/s).
const DOUBLING: f64 = 0.5;

impl LawFamily for Rising {
    const NAME: &'static str = "rising";
    const PARAMETERS: &'static [LawParameter] =
        &[LawParameter::new(Parameter::new("coefficient", "μ", "1").bounded(Bounds::NOT_NEGATIVE), Role::Level)];
    type At<D: Scalar> = Rising<D>;

    fn at<D: Scalar>(values: &[D]) -> Result<Rising<D>, LawError> {
        let [coefficient] = Self::checked(values)?;
        Ok(Rising(coefficient))
    }

    fn visit<D: Scalar, V: LawVisitor<D, Rising<D>>>(visitor: V) -> V::Output {
        visitor.piecewise_linear()
    }
}

impl<D: Scalar> SlidingLaw<D> for Rising<D> {
    fn coefficient(&self, speed: D) -> D {
        self.affine().coefficient(speed)
    }
    fn breakaway(&self) -> D {
        self.0
    }
}

impl<D: Scalar> PiecewiseLinearLaw<D> for Rising<D> {
    fn affine(&self) -> Affine<D> {
        Affine { level: self.0, slope: self.0 / DOUBLING, breakaway: self.0 }
    }
}

#[test]
fn is_identified_and_preferred_to_what_it_is_not() {
    let scenario = Scenario::new(Oscillator::per_unit_mass(2.0).unwrap(), Rising(0.2), 1.0).unwrap();
    let motion = Exact.run(&scenario.starting_at(0.02, 0.0).unwrap(), &Sampling::uniform(1e-3, 3000).unwrap()).unwrap();
    let noise = white(1e-4, 1, 3000);
    let values = motion.velocity().values().iter().zip(noise).map(|(v, noise)| v + noise).collect();
    let record = Record::new(0.0, 1e-3, values, Quantity::Velocity, "m/s").unwrap();

    let decay = Experiment::ring_down(&record, &Preparation::default()).unwrap();
    let [viscous, coulomb, _] = Candidate::standard();
    let candidates = [viscous, coulomb, Candidate::of::<Rising>()];
    let comparison = compare(&Machine::per_unit_mass(), &[decay], &candidates).unwrap();
    assert_eq!((comparison.preferred().law(), comparison.is_decided()), ("rising", true), "{comparison}");
    let friction = comparison.preferred().finding("friction_per_mass").unwrap();
    let error = (friction.value() - 0.2) / friction.uncertainty().unwrap();
    assert!(error.abs() < 3.0, "F/m is {error} standard uncertainties off\n{comparison}");
}
