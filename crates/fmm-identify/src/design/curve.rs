//! Friction curve that planned tests would show.

use std::sync::Arc;

use fmm_fit::design::{DesignCase, DesignUncertainty, Information};
use fmm_model::{ModelError, Rounded};

use crate::design::local::{Local, design_error};
use crate::design::planned_test::Load;
use crate::design::{Guess, Plan, PlannedTest};
use crate::error::IdentifyError;
use crate::friction_curve::FrictionCurve;
use crate::friction_curve::expected::Expected;
use crate::friction_curve::path::Path;

/// Friction over the speed as planned tests would show it, without a law: the [`FrictionCurve`] of their records, before
/// they are made.
///
/// The levels of the curve stand in place of the law of the guess, with its friction of steady sliding and its damping
/// as their values, from rest to the highest speed of all tests. The information of tests adds up; frequency, errors of
/// gains and of a declared damping are found beside the levels, and the prior of curves is that of every curve. It is
/// the curve of records whose noise is zero in the mean.
///
/// ```
/// use fmm_identify::design::{Aim, Guess, Plan, PlannedCurve, PlannedSensor, PlannedTest};
/// use fmm_identify::{Candidate, Known, Machine};
/// use fmm_record::Quantity;
///
/// let machine = Machine::of_mass(Known::exact(10.391)?)?.with_normal_load(Known::exact(14.0)?)?;
/// let guess = Guess::new(machine, &Candidate::named("coulomb_viscous")?, 2.198, &[0.25, 0.02], &[])?;
/// let sensor = PlannedSensor::new(Quantity::Velocity, 1e-4)?;
/// let tests = [0.008, 0.022].map(|x| PlannedTest::release(x, sensor, 1000.0, 2.0)).into_iter();
/// let plan = Plan::new(guess, tests.collect::<Result<_, _>>()?)?;
///
/// let curve: PlannedCurve = plan.curve()?;
/// let u = |tests: &[usize]| Ok::<_, fmm_identify::IdentifyError>(curve.predict(tests)?.at(0.002).unwrap().uncertainty());
/// assert!(u(&[0, 1])? < u(&[0])?.min(u(&[1])?));
/// assert_eq!(plan.best(&Aim::FrictionAt(0.002), 1)?.measurements().len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct PlannedCurve {
    expected: Expected,
    /// Plan of the same tests by the levels.
    by_levels: Plan,
    paths: Vec<Path>,
}

impl PlannedCurve {
    /// Curve of the tests of `plan` if the shared parameters have these `values`.
    pub(super) fn of(plan: &Plan, values: &[f64]) -> Result<Self, IdentifyError> {
        let Plan { guess, tests, inputs, layout, .. } = plan;
        let local = Local { guess, layout, inputs, values };
        if !layout.is_per_mass() {
            return Err(IdentifyError::contradiction(
                "friction over speed without a law is planned for free motions of a machine of known mass or stiffness, \
                 or per unit mass: give one of them, or aim at a finding of the law",
            ));
        }
        let path = |test: &PlannedTest| {
            require_same_machine(test)?;
            if local.experiment(test)?.drive().is_some() {
                return Err(IdentifyError::wrong_record(format!(
                    "{}: friction over speed without a law is planned for free motions, not for driven ones; leave it \
                     out, or aim at a finding of the law",
                    test.name()
                )));
            }
            local.path_of(test)
        };
        let paths = tests.iter().map(path).collect::<Result<Vec<_>, _>>()?;
        let expected = Expected::of(guess.machine, layout, values, &Path::of_all(paths.iter()));
        let expected = expected.ok_or_else(|| {
            IdentifyError::contradiction(format!(
                "{} with these values states no friction over the speed; guess by a law that does, such as \
                 coulomb_viscous or stribeck",
                guess.model.law_name()
            ))
        })?;
        let beside = layout.terms.beside_friction();
        let of_term = |term| layout.terms.place(term).map(|place| values[layout.oscillator + place]);
        let terms: Vec<f64> = beside.iter().filter_map(of_term).collect();
        let of_levels = values[..layout.oscillator].iter().copied().chain(terms).chain(expected.values()).collect();
        let levels = Guess::of(guess.machine, expected.law(beside)?, guess.position.clone(), of_levels)?;
        Ok(Self { by_levels: Plan::new(levels, tests.clone())?, expected, paths })
    }

    /// Highest speed of all tests, to which the curve reaches (m/s, or that of the [`Guess`]).
    pub fn top_speed(&self) -> f64 {
        self.expected.top()
    }

    /// The curve of the chosen tests (indices may repeat) together.
    ///
    /// Errors of gains and of a declared damping are part of the contribution of the residuals. A set that does not
    /// reach the top speed has there what the prior says of a curve that continues.
    ///
    /// # Errors
    /// [`IdentifyError::OutOfRange`] for a place beyond the tests.
    pub fn predict(&self, tests: &[usize]) -> Result<FrictionCurve, IdentifyError> {
        let information = self.by_levels.information(tests)?;
        let path = Path::of_all(tests.iter().map(|place| &self.paths[*place]));
        Ok(self.expected.curve(&information, self.by_levels.layout.law, &path))
    }

    /// Refuses a `speed` that no test reaches.
    pub(super) fn require_reached(&self, speed: f64) -> Result<(), IdentifyError> {
        let speed = ModelError::require_not_negative("the speed of a friction that is asked for", speed, "m/s")?;
        let top = self.top_speed();
        if speed > top {
            let allowed = format!(
                "no more than {}, the highest speed of all tests; ask for less, or plan a larger release",
                Rounded::significant(top, 4)
            );
            return Err(IdentifyError::not_allowed("the speed of a friction that is asked for", speed, &allowed));
        }
        Ok(())
    }

    /// The tests as candidates for little uncertainty of friction at `speed`.
    pub(super) fn case(self, speed: f64) -> Result<DesignCase, IdentifyError> {
        let Self { expected, by_levels: Plan { guess, known, of_tests, layout, .. }, .. } = self;
        let asked = Arc::new(FrictionAt { expected, first: layout.law, speed });
        let case = DesignCase::of_uncertainty(known, of_tests, asked);
        case.map_err(|source| design_error(guess.model.law_name(), source))
    }
}

/// Refuses a `test` of the machine under another load, or with something added: its friction is another curve.
fn require_same_machine(test: &PlannedTest) -> Result<(), IdentifyError> {
    if test.load == Load::OfMachine && test.added_mass.is_none() && test.added_stiffness.is_none() {
        return Ok(());
    }
    Err(IdentifyError::contradiction(format!(
        "{}: friction over speed without a law is that of one machine under its own load; leave out loads, masses and \
         springs of tests and the lifted contact, or aim at a finding of the law",
        test.name()
    )))
}

/// Friction at a speed, as what is to become certain.
#[derive(Debug)]
struct FrictionAt {
    expected: Expected,
    first: usize,
    speed: f64,
}

impl DesignUncertainty for FrictionAt {
    fn logarithm(&self, information: &Information) -> f64 {
        self.expected.logarithm(information, self.first, self.speed)
    }
}
