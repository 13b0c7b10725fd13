//! A friction law of one's own, written outside the crates: simulated, differentiated, fitted and compared.

use fmm_friction::{
    Affine, Berger, LawError, LawFamily, LawParameter, LawVisitor, OwnLaw, PiecewiseLinearLaw, Role, SlidingLaw,
    SpeedFormula,
};
use fmm_identify::{Candidate, Experiment, IdentifyError, Machine, Preparation, compare, identify};
use fmm_model::{Bounds, Oscillator, Parameter, Scalar};
use fmm_record::{Quantity, Record};
use fmm_sim::{Engine, Exact, RungeKutta, Sampling, Scenario};

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

/// Berger's law with its decay in another unit: α in s/mm, so that a thousand of SI is one.
#[derive(Debug, Clone, Copy)]
struct InMillimetres<D, const KNOWN: bool>(Berger<D>);

struct InMillimetresOf<const KNOWN: bool>;

impl<const KNOWN: bool> LawFamily for InMillimetresOf<KNOWN> {
    const NAME: &'static str = "in_millimetres";
    const PARAMETERS: &'static [LawParameter] = &[
        LawParameter::new(Parameter::new("coefficient", "μ₀", "1").bounded(Bounds::NOT_NEGATIVE), Role::Level)
            .typically(0.7),
        LawParameter::new(Parameter::new("excess_coefficient", "μ₁", "1").bounded(Bounds::NOT_NEGATIVE), Role::Excess)
            .typically(0.6),
        LawParameter::new(
            Parameter::new("decay", "α", if KNOWN { "s/mm" } else { "s/furlong" }).bounded(Bounds::NOT_NEGATIVE),
            Role::Shape,
        )
        .typically(3.0),
    ];
    type At<D: Scalar> = InMillimetres<D, KNOWN>;

    fn at<D: Scalar>(values: &[D]) -> Result<InMillimetres<D, KNOWN>, LawError> {
        let [floor, excess, decay] = Self::checked(values)?;
        Ok(InMillimetres(Berger::new(floor, excess, decay * 1000.0)?))
    }

    fn visit<D: Scalar, V: LawVisitor<D, InMillimetres<D, KNOWN>>>(visitor: V) -> V::Output {
        visitor.sliding()
    }
}

impl<D: Scalar, const KNOWN: bool> SlidingLaw<D> for InMillimetres<D, KNOWN> {
    fn coefficient(&self, speed: D) -> D {
        self.0.coefficient(speed)
    }
    fn breakaway(&self) -> D {
        self.0.breakaway()
    }
}

/// The unit of a parameter says where its fit begins and what it scales with: a thousandth of the decay in s/m, and all
/// else the same.
#[test]
fn a_parameter_in_another_unit_is_the_same() {
    let scenario = Scenario::new(Oscillator::per_unit_mass(2.0).unwrap(), Berger::new(0.2, 0.15, 10.0).unwrap(), 1.0);
    let scenario = scenario.unwrap().starting_at(0.04, 0.0).unwrap();
    let motion = RungeKutta::default().run(&scenario, &Sampling::uniform(2e-3, 1500).unwrap()).unwrap();
    let values = motion.velocity().values().iter().zip(white(2e-4, 1, 1500)).map(|(v, noise)| v + noise).collect();
    let record = Record::new(0.0, 2e-3, values, Quantity::Velocity, "m/s").unwrap();
    let preparation = Preparation::default().gain_uncertainty(0.01);
    let decays = [Experiment::ring_down(&record, &preparation).unwrap()];
    let machine = Machine::per_unit_mass();
    let metres = identify::<Berger>(&machine, &decays).unwrap();
    let millimetres = identify::<InMillimetresOf<true>>(&machine, &decays).unwrap();
    assert!((millimetres.rms_residual() / metres.rms_residual() - 1.0).abs() < 1e-9, "{metres}\n{millimetres}");
    let [one, other] = [&metres, &millimetres].map(|found| found.finding("decay").unwrap());
    assert!((1000.0 * other.value() / one.value() - 1.0).abs() < 1e-4, "{one} beside {other}");
    let [one_u, other_u] = [one, other].map(|found| found.uncertainty().unwrap());
    assert!((1000.0 * other_u / one_u - 1.0).abs() < 1e-2, "{one_u} beside {other_u}");
    let refused = identify::<InMillimetresOf<false>>(&machine, &decays);
    assert!(
        matches!(refused, Err(IdentifyError::UnknownName { ref what }) if what.contains("s/furlong")),
        "{refused:?}"
    );
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

/// Berger's law by plain numbers.
#[derive(Debug)]
struct Falling;

impl SpeedFormula for Falling {
    fn coefficients(&self, arguments: &[Vec<f64>]) -> Vec<f64> {
        let [speed, floor, excess, decay] = arguments else { return Vec::new() };
        let at = |point: usize| floor[point] + excess[point] * (-decay[point] * speed[point]).exp();
        (0..speed.len()).map(at).collect()
    }
}

/// A law that is known at run time only is fitted like its family, by differences in place of derivatives.
#[test]
fn a_law_of_run_time_is_fitted_like_its_family() {
    let scenario = Scenario::new(Oscillator::per_unit_mass(2.0).unwrap(), Berger::new(0.2, 0.15, 10.0).unwrap(), 1.0);
    let scenario = scenario.unwrap().starting_at(0.04, 0.0).unwrap();
    let motion = RungeKutta::default().run(&scenario, &Sampling::uniform(2e-3, 1500).unwrap()).unwrap();
    let values = motion.velocity().values().iter().zip(white(2e-4, 1, 1500)).map(|(v, noise)| v + noise).collect();
    let record = Record::new(0.0, 2e-3, values, Quantity::Velocity, "m/s").unwrap();
    let decays = [Experiment::ring_down(&record, &Preparation::default()).unwrap()];
    let law = OwnLaw::new("falling", Berger::PARAMETERS.to_vec(), Box::new(Falling)).unwrap();
    let own = Candidate::own(Box::leak(Box::new(law)));
    let machine = Machine::per_unit_mass();
    let (own, family) = (compare(&machine, &decays, &[own]).unwrap(), identify::<Berger>(&machine, &decays).unwrap());
    let own = own.preferred();
    assert!((own.rms_residual() / family.rms_residual() - 1.0).abs() < 1e-9, "{own}\n{family}");
    for name in ["friction_per_mass", "excess_friction_per_mass", "decay"] {
        let [one, other] = [own, &family].map(|found| found.finding(name).unwrap());
        let [one_u, other_u] = [one, other].map(|found| found.uncertainty().unwrap());
        assert!((one.value() - other.value()).abs() < 1e-3 * other_u, "{one} beside {other}");
        assert!((one_u / other_u - 1.0).abs() < 1e-3, "{one_u} beside {other_u}");
    }
}
