//! Plan: the tests that may be made, their information, and the best set of them.

use fmm_fit::design::{ChosenDesign, DesignCase, DesignCriterion, DesignSearch, Information};

use crate::design::inputs::{Input, Inputs};
use crate::design::local::{self, Local};
use crate::design::prediction::Quantity;
use crate::design::{DesignPrediction, Guess, PlannedCurve, PlannedTest};
use crate::error::IdentifyError;
use crate::finding::{Finding, Origin};
use crate::quantities::derived::derived;
use crate::quantities::table::Table;

/// The tests that may be made on a machine, with the information of each.
///
/// The information of a test is that of the problem that it would be, of [`Problem`](crate::Problem), at the guessed
/// values: its exact Jacobian, less what its own initial state and offset take. Mass, load and gain are known with an
/// error, which is a further parameter: that of mass, damping and load of the machine is one for all tests, that of a
/// load, a mass or a spring of a test one for all tests with the same, that of a gain one for all tests by the same
/// sensor. Repeats therefore do not reduce such an error.
///
/// ```
/// use fmm_identify::design::{Aim, Guess, Plan, PlannedSensor, PlannedTest};
/// use fmm_identify::{Candidate, Known, Machine};
/// use fmm_record::Quantity;
///
/// let machine = Machine::of_mass(Known::exact(10.391)?)?.with_normal_load(Known::exact(14.0)?)?;
/// let guess = Guess::new(machine, &Candidate::named("coulomb_viscous")?, 2.198, &[0.25, 0.002], &[])?;
/// let sensor = PlannedSensor::new(Quantity::Velocity, 1e-4)?;
/// let tests = [0.008, 0.016, 0.022].map(|x| PlannedTest::release(x, sensor, 1000.0, 2.0)).into_iter();
/// let plan = Plan::new(guess, tests.collect::<Result<_, _>>()?)?;
///
/// let best = plan.best(&Aim::finding("mu"), 2)?;
/// let u = |tests: &[usize]| Ok::<_, fmm_identify::IdentifyError>(plan.predict(tests)?.finding("mu").unwrap().uncertainty().unwrap());
/// assert!(u(best.measurements())? <= u(&[2, 2])? && u(&[2, 2])? < u(&[0, 0])?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Plan {
    pub(super) guess: Guess,
    pub(super) tests: Vec<PlannedTest>,
    pub(super) inputs: Inputs,
    pub(super) layout: Table,
    pub(super) known: Information,
    pub(super) of_tests: Vec<Information>,
}

/// Aim of a plan: the uncertainty that is to become small.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Aim {
    /// u of the finding of this name (c-optimal).
    Finding(String),
    /// The generalised variance of all parameters that tests share (D-optimal).
    Determinant,
    /// The mean square of the relative standard uncertainties of all parameters that tests share (A-optimal).
    MeanVariance,
    /// u of the friction at this speed (m/s, or that of the [`Guess`]; 0 is at rest) as a
    /// [`FrictionCurve`](crate::FrictionCurve) of the tests would have it, without a law: see [`PlannedCurve`]. What a
    /// pilot told of its law does not count.
    FrictionAt(f64),
}

impl Aim {
    /// u of the finding called `name`.
    pub fn finding(name: impl Into<String>) -> Self {
        Self::Finding(name.into())
    }
}

impl Plan {
    /// The plan of these `tests`, whose findings `guess` predicts.
    ///
    /// # Errors
    /// [`IdentifyError::Missing`] without a test, [`IdentifyError::Contradiction`] for a test that the machine does not
    /// allow, and [`IdentifyError::Simulation`] if a test cannot be simulated at the guess.
    pub fn new(guess: Guess, tests: Vec<PlannedTest>) -> Result<Self, IdentifyError> {
        if tests.is_empty() {
            return Err(IdentifyError::missing("there is no test to choose from; give at least one"));
        }
        let inputs = Inputs::of(&guess.machine, &tests);
        let frequency = guess.values[0];
        let (layout, _) = local::layout(&guess.model, &guess.machine, &guess.position, frequency)?;
        let shared = guess.parameters.len();
        let order = shared + inputs.len();
        let failed = |source| local::design_error(guess.model.law_name(), source);
        let embedded: Vec<f64> = (0..shared * order).map(|at| f64::from(at / order == at % order)).collect();
        let mut known = guess.measured.transformed(&embedded).map_err(failed)?;
        for place in shared..order {
            known = known.with_known(place, 1.0).map_err(failed)?;
        }
        for (place, parameter) in guess.parameters.iter().enumerate().filter(|(_, one)| one.bounds().is_fixed()) {
            /// Standard uncertainty of a fixed value over the value (1). Origin: far below any other, far above rounding.
            const FIXED: f64 = 1e-9;
            let value = parameter.bounds().lower().abs();
            known = known.with_known(place, FIXED * if value > 0.0 { value } else { 1.0 }).map_err(failed)?;
        }
        let mut plan = Self { guess, tests, inputs, layout, known, of_tests: Vec::new() };
        plan.of_tests = plan.information_at(&plan.guess.values)?;
        Ok(plan)
    }

    /// Information of each test at these `values` of the shared parameters.
    fn information_at(&self, values: &[f64]) -> Result<Vec<Information>, IdentifyError> {
        let Self { guess, tests, inputs, layout, .. } = self;
        let local = Local { guess, layout, inputs, values };
        let of_test = |test| {
            local.information(test).map_err(|error| match error {
                IdentifyError::Simulation { law, source } => IdentifyError::simulation(
                    law,
                    fmm_fit::EvaluationError::message(format!("{}: {source}", test.name())),
                ),
                other => other,
            })
        };
        tests.iter().map(of_test).collect()
    }

    /// The tests that may be made.
    pub fn tests(&self) -> &[PlannedTest] {
        &self.tests
    }

    /// The expected values of the findings.
    pub fn guess(&self) -> &Guess {
        &self.guess
    }

    /// Information of the chosen tests (indices may repeat) plus prior knowledge, as a prediction of the findings.
    ///
    /// # Errors
    /// [`IdentifyError::OutOfRange`] for a place beyond the tests.
    pub fn predict(&self, tests: &[usize]) -> Result<DesignPrediction, IdentifyError> {
        let information = self.information(tests)?;
        DesignPrediction::new(&self.guess, self.quantities(&self.guess.values), information)
    }

    pub(crate) fn information(&self, tests: &[usize]) -> Result<Information, IdentifyError> {
        let mut information = self.known.clone();
        for place in tests {
            let Some(of_test) = self.of_tests.get(*place) else {
                let allowed = format!("below {}, the number of tests", self.tests.len());
                return Err(IdentifyError::not_allowed("the place of a test", *place as f64, &allowed));
            };
            information.add(of_test).map_err(|source| local::design_error(self.guess.model.law_name(), source))?;
        }
        Ok(information)
    }

    /// All findings: parameters that tests share, then quantities that follow from them and the machine.
    pub(crate) fn quantities(&self, values: &[f64]) -> Vec<Quantity> {
        let (shared, order) = (self.guess.parameters.len(), self.guess.parameters.len() + self.inputs.len());
        let force = self.inputs.find(Input::ForceChannel);
        let fitted = self.guess.parameters.iter().enumerate().map(|(index, parameter)| {
            let mut gradient = vec![0.0; order];
            gradient[index] = 1.0;
            if let Some((place, u)) = force.filter(|_| self.layout.is_scaled_by_force(index)) {
                gradient[shared + place] = u * values[index];
            }
            Quantity { parameter: parameter.clone(), value: values[index], gradient, is_fitted: true }
        });
        let followed = derived(&self.guess.machine, &self.layout, values).into_iter().map(|one| {
            let mut gradient = vec![0.0; order];
            let (own, by_inputs) = one.gradient.split_at(shared);
            gradient[..shared].copy_from_slice(own);
            // Gains belong to the tests, not to the parameters.
            let inputs = [Some(Input::Scale), Some(Input::NormalLoad), None, Some(Input::ForceChannel)];
            for (input, slope) in inputs.into_iter().zip(by_inputs) {
                if let Some((place, u)) = input.and_then(|input| self.inputs.find(input)) {
                    gradient[shared + place] += u * slope;
                }
            }
            Quantity { parameter: one.parameter, value: one.value, gradient, is_fitted: false }
        });
        fitted.chain(followed).collect()
    }

    /// The tests and what `aim` asks for if the shared parameters have these `values`, relative to its value where that
    /// is not zero.
    fn case(&self, aim: &Aim, values: &[f64]) -> Result<DesignCase, IdentifyError> {
        let quantities = self.quantities(values);
        let relative = |quantity: &Quantity| {
            let size = if quantity.value == 0.0 { 1.0 } else { quantity.value.abs() };
            quantity.gradient.iter().map(|slope| slope / size).collect::<Vec<f64>>()
        };
        let combinations = match aim {
            Aim::Finding(name) => {
                let found = quantities.iter().find(|quantity| quantity.parameter.name() == name);
                let names =
                    || quantities.iter().map(|quantity| quantity.parameter.name()).collect::<Vec<_>>().join(", ");
                let found = found.ok_or_else(|| IdentifyError::UnknownName {
                    what: format!("no test finds anything called {name:?}; the findings are: {}", names()),
                })?;
                vec![relative(found)]
            }
            Aim::Determinant | Aim::MeanVariance => {
                let free = |quantity: &&Quantity| quantity.is_fitted && !quantity.parameter.bounds().is_fixed();
                quantities.iter().filter(free).map(relative).collect()
            }
            Aim::FrictionAt(speed) => return PlannedCurve::of(self, values)?.case(*speed),
        };
        let of_tests = if values == self.guess.values { self.of_tests.clone() } else { self.information_at(values)? };
        let case = DesignCase::new(self.known.clone(), of_tests, combinations);
        case.map_err(|source| local::design_error(self.guess.model.law_name(), source))
    }

    /// Friction over the speed that the tests would show without a law, at the guess.
    ///
    /// # Errors
    /// [`IdentifyError::WrongRecord`] for a driven test, [`IdentifyError::Contradiction`] for one under another load or
    /// with a mass or a spring of its own, and for a law that states no friction over the speed.
    pub fn curve(&self) -> Result<PlannedCurve, IdentifyError> {
        PlannedCurve::of(self, &self.guess.values)
    }

    /// The search for tests that make the `aim` small, at the guess.
    ///
    /// # Errors
    /// [`IdentifyError::UnknownName`] for a finding that no test has; of a friction at a speed those of
    /// [`curve`](Self::curve), and [`IdentifyError::OutOfRange`] for a speed that no test reaches.
    pub fn search(&self, aim: &Aim) -> Result<DesignSearch, IdentifyError> {
        self.robust_search(aim, std::slice::from_ref(&self.guess.values))
    }

    /// The search for tests that make the `aim` small over several `samples` of the shared values, such as
    /// [`Guess::draws`]: the mean of the logarithm of u, unless it is asked for the
    /// [worst](DesignSearch::for_worst_case).
    ///
    /// # Errors
    /// Those of [`search`](Self::search), [`IdentifyError::Missing`] without a sample or for one of another number of
    /// values, and [`IdentifyError::Simulation`] if a test cannot be simulated at one.
    pub fn robust_search(&self, aim: &Aim, samples: &[Vec<f64>]) -> Result<DesignSearch, IdentifyError> {
        let shared = self.guess.parameters.len();
        if let Some(sample) = samples.iter().find(|sample| sample.len() != shared) {
            let given = sample.len();
            return Err(IdentifyError::missing(format!(
                "a sample has {given} values; the tests share {shared} parameters"
            )));
        }
        if samples.is_empty() {
            return Err(IdentifyError::missing(
                "there is no sample of the values to be robust over; give at least one",
            ));
        }
        if let Aim::FrictionAt(speed) = aim {
            self.curve()?.require_reached(*speed)?;
        }
        let cases = samples.iter().map(|sample| self.case(aim, sample)).collect::<Result<Vec<_>, _>>()?;
        let criterion = match aim {
            Aim::Determinant => DesignCriterion::Determinant,
            Aim::Finding(_) | Aim::MeanVariance | Aim::FrictionAt(_) => DesignCriterion::MeanVariance,
        };
        let search = DesignSearch::new(cases, criterion);
        search.map_err(|source| local::design_error(self.guess.model.law_name(), source))
    }

    /// The best set of this many tests at the guess; a test may be in it more than once.
    ///
    /// # Errors
    /// Those of [`search`](Self::search), and [`IdentifyError::OutOfRange`] for none or more than 1000.
    pub fn best(&self, aim: &Aim, tests: usize) -> Result<ChosenDesign, IdentifyError> {
        self.search(aim)?.best(tests).map_err(|error| number(tests as f64, &error))
    }

    /// The best set of tests at the guess whose costs add up to no more than `budget`.
    ///
    /// # Errors
    /// Those of [`search`](Self::search), and [`IdentifyError::OutOfRange`] for a budget that pays for none or more
    /// than 1000.
    pub fn best_within(&self, aim: &Aim, budget: f64) -> Result<ChosenDesign, IdentifyError> {
        let costs: Vec<f64> = self.tests.iter().map(PlannedTest::cost).collect();
        self.search(aim)?.best_within(&costs, budget).map_err(|error| number(budget, &error))
    }
}

fn number(value: f64, error: &fmm_fit::FitError) -> IdentifyError {
    IdentifyError::OutOfRange { what: error.to_string(), value }
}

/// Growth of an uncertainty without a test, below which nothing is lost (1). Chosen.
const NOTABLE: f64 = 1.02;
/// Ratio of two losses above which the later finding, a derived one, is named (1). Chosen.
const ALIKE: f64 = 0.99;

impl Plan {
    /// A sentence for the test at `place` alone, beside prior knowledge.
    ///
    /// # Errors
    /// Those of [`predict`](Self::predict).
    pub fn sentence_alone(&self, place: usize) -> Result<String, IdentifyError> {
        let alone = self.predict(&[place])?;
        if let Some(direction) = alone.null_directions().first() {
            return Ok(format!("alone, {direction}"));
        }
        let relative = |finding: &&Finding| {
            let u = finding.uncertainty().filter(|_| matches!(finding.origin(), Origin::Fitted(_)))?;
            Some(u / finding.value().abs()).filter(|relative| relative.is_finite())
        };
        let mut known: Vec<(&str, f64)> = alone
            .findings()
            .iter()
            .filter_map(|finding| Some((finding.parameter().name(), relative(&finding)?)))
            .collect();
        known.sort_by(|a, b| a.1.total_cmp(&b.1));
        let little: Vec<&str> = known.iter().filter(|(_, u)| *u > 1.0).map(|(name, _)| *name).collect();
        if !little.is_empty() {
            return Ok(format!("alone, it gives little information on {}: u exceeds the value", little.join(", ")));
        }
        Ok(match known.as_slice() {
            [] => "alone, it determines everything".to_owned(),
            [.., (name, u)] => format!("alone, it determines everything, {name} least: u is {:.2} % of it", 100.0 * u),
        })
    }

    /// A sentence for each different test of a set on its contribution: the direction that would stay free without it,
    /// or the finding that would lose most. The sentences are in the order of the places.
    ///
    /// # Errors
    /// Those of [`predict`](Self::predict).
    pub fn sentences_of_each(&self, tests: &[usize]) -> Result<Vec<(usize, String)>, IdentifyError> {
        let whole = self.predict(tests)?;
        let mut places = tests.to_vec();
        places.sort_unstable();
        places.dedup();
        places
            .into_iter()
            .map(|place| {
                let others: Vec<usize> = tests.iter().copied().filter(|other| *other != place).collect();
                let without = self.predict(&others)?;
                Ok((place, sentence(&whole, &without)))
            })
            .collect()
    }
}

/// Loss without a test, as a sentence.
fn sentence(whole: &DesignPrediction, without: &DesignPrediction) -> String {
    if without.rank() < whole.rank() {
        let lost: Vec<String> = without.null_directions().iter().map(ToString::to_string).collect();
        return format!("without it, {}", lost.join("; "));
    }
    let ratio = |finding: &Finding| {
        let before = without.finding(finding.parameter().name())?.uncertainty()?;
        Some(before / finding.uncertainty()?).filter(|ratio| ratio.is_finite())
    };
    let mut most: Option<(&str, f64)> = None;
    for finding in whole.findings() {
        let Some(ratio) = ratio(finding) else { continue };
        if most.is_none_or(|(_, largest)| ratio > ALIKE * largest) {
            most = Some((finding.parameter().name(), ratio));
        }
    }
    match most {
        Some((name, ratio)) if ratio > NOTABLE => {
            format!("without it, u of {name} would be {ratio:.2} times as large, and of no other more")
        }
        _ => "without it, no uncertainty would be larger by more than 2 %".to_owned(),
    }
}
