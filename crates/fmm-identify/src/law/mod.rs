//! A law family as a value: what must know its type is the simulation alone, and all else is compiled once for all
//! laws.

pub(crate) mod along;
pub(crate) mod dimension;
pub(crate) mod member;
pub(crate) mod naming;

use std::marker::PhantomData;

use fmm_fit::EvaluationError;
use fmm_friction::{LawFamily, LawKind, LawParameter, OwnLaw, Role, SlidingLaw, SpecialCase};
use fmm_model::{Oscillator, Scalar};
use fmm_sim::{Engine, Excitation, Sampling, Scenario, Thesis, Trajectory};

use dimension::is_coefficient;
use member::{Members, Of};

/// Directions of derivative that one simulation carries; a law with more parameters takes several.
pub(crate) const DIRECTIONS: usize = 6;
/// Directions of derivative that cost hardly more than none.
pub(crate) const FEW: usize = 2;

/// Inputs of a simulation: machine, load and initial state as they are, the law as plain parameter values.
#[derive(Debug, Clone)]
pub(crate) struct Motion<D> {
    pub(crate) oscillator: Oscillator<D>,
    /// One value per parameter of the law.
    pub(crate) law: Vec<D>,
    pub(crate) normal_load: D,
    /// Distance in time (s) of the factors of a load that changes, and these (1).
    pub(crate) change: Option<(f64, Vec<D>)>,
    /// Curvature of the load over the position, over the load in the middle (1/m²).
    pub(crate) curvature: Option<D>,
    /// Position and velocity at the beginning.
    pub(crate) initial: [D; 2],
    pub(crate) force: Option<Excitation<D>>,
    /// Relative tolerance (1) of an engine that integrates, if not the one that it has by itself.
    pub(crate) tolerance: Option<f64>,
}

impl<D: Scalar> Motion<D> {
    /// The scenario of it by a `law` of its values.
    fn scenario<L>(&self, law: L) -> Result<Scenario<D, L>, EvaluationError> {
        Ok(self.without_law()?.with_law(law))
    }

    /// All of the scenario but its law, compiled once for all laws.
    fn without_law(&self) -> Result<Scenario<D, ()>, EvaluationError> {
        let scenario = Scenario::new(self.oscillator, (), self.normal_load)?;
        let scenario = match &self.change {
            Some((interval, factors)) => {
                let loads: Vec<D> = factors.iter().map(|factor| self.normal_load * *factor).collect();
                scenario.under_sampled_load(*interval, loads)?
            }
            None => scenario,
        };
        let scenario = match self.curvature {
            Some(curvature) => scenario.under_curved_load(curvature)?,
            None => scenario,
        };
        let scenario = scenario.starting_at(self.initial[0], self.initial[1])?;
        Ok(match &self.force {
            Some(force) => scenario.driven_by(force.clone()),
            None => scenario,
        })
    }
}

impl Motion<f64> {
    /// Simulates it by family `F` and the Euler method of the thesis.
    pub(crate) fn simulate_by_thesis<F: LawFamily>(
        &self,
        sampling: &Sampling,
        trajectory: &mut Trajectory<f64>,
    ) -> Result<(), EvaluationError>
    where
        F::At<f64>: SlidingLaw<f64>,
    {
        Ok(Thesis::A3.run_into(&self.scenario(F::at(&self.law)?)?, sampling, trajectory)?)
    }
}

/// The simulation of a motion by one family.
pub(crate) type Simulate<'a, D> =
    &'a (dyn Fn(&Motion<D>, &Sampling, &mut Trajectory<D>) -> Result<(), EvaluationError> + Sync);

/// Name, parameters and simulations of a law family, or of a law that is known at run time only.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Law {
    pub(crate) name: &'static str,
    pub(crate) parameters: &'static [LawParameter],
    pub(crate) special_cases: &'static [SpecialCase],
    pub(crate) members: &'static dyn Members,
    /// True if static levels of their own are fitted.
    fits_breakaway: bool,
}

impl Law {
    /// Family `F`.
    pub(crate) const fn of<F: LawFamily>() -> Self {
        Self {
            name: F::NAME,
            parameters: F::PARAMETERS,
            special_cases: F::SPECIAL_CASES,
            members: &Of::<F>(PhantomData),
            fits_breakaway: false,
        }
    }

    /// A law that is known at run time only.
    pub(crate) fn own(law: &'static OwnLaw) -> Self {
        Self { name: law.name(), parameters: law.parameters(), special_cases: &[], members: law, fits_breakaway: false }
    }

    /// Friction of steady sliding by the law of these [`fitted`](Self::fitted) values, in their unit of force, at a
    /// `speed` that grows or, if it is `losing`, falls; `None` if the family does not say.
    pub(crate) fn steady(&self, fitted: &[f64], speed: f64, losing: bool) -> Option<f64> {
        self.members.steady(&self.values(fitted), speed, losing)
    }

    /// True if it is one of the sliding speed, without internal state.
    pub(crate) fn is_of_speed(&self) -> bool {
        matches!(self.members.kind(), LawKind::Sliding | LawKind::PiecewiseLinear)
    }

    /// True if its motion has a closed form from event to event.
    pub(crate) fn is_piecewise_linear(&self) -> bool {
        self.members.kind() == LawKind::PiecewiseLinear
    }

    /// The same law with its static level fitted, as what it lies above the sliding level by.
    pub(crate) const fn with_breakaway(self) -> Self {
        Self { fits_breakaway: true, ..self }
    }

    /// The same law with its static level held at the sliding one.
    pub(crate) const fn with_held_breakaway(self) -> Self {
        Self { fits_breakaway: false, ..self }
    }

    /// The static level that is held; `None` if it is fitted or has none of its own.
    pub(crate) fn held_breakaway(&self) -> impl Iterator<Item = &'static LawParameter> + use<> {
        let is_held = !self.fits_breakaway;
        self.parameters.iter().filter(move |parameter| is_held && parameter.role() == Role::Breakaway)
    }

    /// The parameters that records are fitted by: of ring-downs all but static levels, on which the motion depends only
    /// in where it stops. They are held at the sliding level.
    pub(crate) fn fitted(&self) -> impl Iterator<Item = &'static LawParameter> + use<> {
        let is_all = self.fits_breakaway;
        self.parameters.iter().filter(move |parameter| is_all || parameter.role() != Role::Breakaway)
    }

    /// The place of its sliding level among the [`fitted`](Self::fitted) parameters: of several levels the one that is
    /// called so, or else the first.
    pub(crate) fn level(&self) -> Option<usize> {
        let is_level = |parameter: &LawParameter| parameter.role() == Role::Level && is_coefficient(parameter);
        let is_named = |parameter: &LawParameter| {
            is_level(parameter) && matches!(parameter.parameter().name(), "coefficient" | "sliding_coefficient")
        };
        self.fitted().position(is_named).or_else(|| self.fitted().position(is_level))
    }

    /// The share of the largest speed at which the law typically bends, of the first parameter that says so; `None` for
    /// laws without.
    pub(crate) fn bend(&self) -> Option<f64> {
        self.fitted().filter(|parameter| parameter.role() == Role::Shape).find_map(|parameter| {
            self.powers(parameter).of_speed().map(|power| parameter.typical().powf(power.recip()))
        })
    }

    /// Name of what is left of it without its viscous part; `None` if that is nothing.
    pub(crate) fn dry_name(&self) -> Option<&'static str> {
        let is_slope = |parameter: &LawParameter| parameter.role() == Role::Slope;
        let slopes = self.parameters.iter().filter(|parameter| is_slope(parameter)).count();
        match (slopes, self.parameters.len() - slopes, self.special_cases) {
            (1, 0, _) => None,
            // A level beside the slope is Coulomb's law.
            (1, 1, [case]) => Some(case.law()),
            _ => Some(self.name),
        }
    }

    /// True if it has a viscous part.
    pub(crate) fn has_slope(&self) -> bool {
        self.parameters.iter().any(|parameter| parameter.role() == Role::Slope)
    }

    /// Values for all parameters from those of the [`fitted`](Self::fitted) ones: static levels are put in, and a level
    /// that may not lie below another is that with what it is above it.
    pub(crate) fn values<D: Scalar>(&self, fitted: &[D]) -> Vec<D> {
        let level = self.level().map_or(D::from(0.0), |level| fitted[level]);
        let mut values = fitted.iter();
        let value = |parameter: &LawParameter| match parameter.role() {
            Role::Breakaway if !self.fits_breakaway => Some(level),
            Role::Breakaway | Role::LevelAbove => values.next().map(|excess| level + *excess),
            _ => values.next().copied(),
        };
        self.parameters.iter().filter_map(value).collect()
    }
}
