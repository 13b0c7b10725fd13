//! Laws projected on the friction over the speed that records show: their misfit, and where a fit by them begins.

use std::ops::Range;
use std::time::Instant;

use fmm_fit::{Estimate, EvaluationError, Options, Residuals, solve};
use fmm_friction::CoulombViscous;
use fmm_model::{Bounds, Parameter, Restoring};
use nalgebra::{DMatrix, DVector};

use crate::candidate::Candidate;
use crate::error::IdentifyError;
use crate::experiment::Experiment;
use crate::friction_curve::fit::{Levelled, Settled, problems_of_levels};
use crate::friction_curve::levels::{KNOTS, LEVELS};
use crate::friction_curve::likelihood::Linearised;
use crate::friction_curve::rules::{
    ENOUGH, EVEN, EXPLAINED, LOST, MOST_ITERATIONS, MOST_STEPS_OF_PROJECTION, PROMISED,
};
use crate::machine::term::Term;
use crate::machine::{Machine, Terms};
use crate::problem::Problem;
use crate::problem::starts::Fitted;
use crate::quantities::table::Table;
use crate::threads::on_all_threads;

/// Friction over the speed as records show it near one curve, without a law.
///
/// ```text
/// D(θ) = (b(θ) − b̂)ᵀ Λ (b(θ) − b̂)
/// ```
///
/// b(θ) are the levels of a law, b̂ those that fit best, Λ their precision with all else integrated out. D is the
/// misfit of the law beside the best curve of all, as a fit to the records would have it, without a simulation.
pub(crate) struct ShownFriction {
    /// Terms beside it: a bent spring, and a change during the records.
    pub(crate) terms: Terms,
    /// The residuals beside it are no noise.
    pub(crate) is_structured: bool,
    top: f64,
    /// Names of all parameters of the curve's problem, those of the terms beside the curve, and the first level.
    names: Vec<String>,
    beside: Range<usize>,
    first: usize,
    settled: Settled,
    /// R with RᵀR = Λ, and R b̂.
    root: DMatrix<f64>,
    best: DVector<f64>,
    /// Fit by Coulomb and viscous friction, with the same terms.
    line: Vec<f64>,
    /// Least sum of squares that a curve was seen to leave, with these terms.
    squares: f64,
}

/// A law on the friction that records show.
#[derive(Debug, Clone)]
pub(crate) struct Projected {
    /// D, beside the best curve of all in variances of the noise (1).
    pub(crate) misfit: f64,
    /// The friction over the speed tells all parameters of the law, so that D is its misfit.
    pub(crate) shows_all: bool,
    /// Values of a fit to the records that begins there.
    pub(crate) start: Vec<f64>,
}

impl ShownFriction {
    /// The friction over the speed that `experiments` on `machine` share, with `terms` beside it.
    ///
    /// # Errors
    /// As for a curve, and where it has not settled before the `end`.
    pub(crate) fn of(
        machine: &Machine,
        terms: Terms,
        experiments: &[Experiment],
        end: Option<Instant>,
    ) -> Result<Self, IdentifyError> {
        let Levelled { problem, values, top, scale, line, line_squares, .. } =
            Levelled::of(Table::form(machine), machine, &terms, experiments, end)?;
        let problem = problem.simulated_roughly();
        let settled = Settled::of(&problem, values, scale, MOST_STEPS_OF_PROJECTION, end)?;
        let squares = line_squares.min(settled.near.sum_of_squares());
        let is_structured = settled.near.excess(&problem).is_some();
        let eigen = settled.likelihood.precision.clone().symmetric_eigen();
        let least = LOST * eigen.eigenvalues.max();
        let roots = eigen.eigenvalues.map(|value| if value > least { value.sqrt() } else { 0.0 });
        let inverse = roots.map(|root| if root > 0.0 { root.recip() } else { 0.0 });
        let best = inverse.component_mul(&eigen.eigenvectors.tr_mul(&settled.likelihood.information));
        let root = DMatrix::from_diagonal(&roots) * eigen.eigenvectors.transpose();
        let names = problem.parameters().iter().map(|parameter| parameter.name().to_owned()).collect();
        let (first, beside) = (problem.table.law, problem.table.oscillator..problem.table.law);
        Ok(Self { terms, is_structured, top, names, beside, first, settled, root, best, line, squares })
    }

    /// The same with what else acts: the terms that explain most of the residuals, again and again as long as these are
    /// no noise and some terms promise to explain some of them and explain enough; `None` if nothing does.
    pub(crate) fn beside(&self, machine: &Machine, experiments: &[Experiment], end: Option<Instant>) -> Option<Self> {
        const FURTHER: [&[Term]; 3] =
            [&[Term::CubicSpring], &[Term::CubicSpring, Term::QuinticSpring], &[Term::Change]];
        let mut tried: Vec<Self> = Vec::new();
        let mut found: Option<usize> = None;
        loop {
            let shown = found.map_or(self, |place| &tried[place]);
            let is_free = |term: &&Term| !term.is_spring() || machine.restoring() == Restoring::Linear;
            let further =
                FURTHER.map(|terms| terms.iter().filter(is_free).copied().fold(shown.terms.clone(), Terms::with));
            let further = further.into_iter().filter(|terms| shown.is_structured && *terms != shown.terms);
            let further: Vec<Terms> = further.collect();
            let is_new = |terms: &&Terms| tried.iter().all(|one| one.terms != **terms);
            let new = further.iter().filter(is_new).cloned().collect();
            let new = on_all_threads(new, |terms| {
                // What cannot be told beforehand is tried.
                let promised = shown.promised(machine, &terms, experiments).unwrap_or(f64::INFINITY);
                (promised >= PROMISED).then(|| Self::of(machine, terms, experiments, end).ok())?
            });
            tried.extend(new.into_iter().flatten());
            let shown = found.map_or(self, |place| &tried[place]);
            let worth = |place: &usize| {
                let added = tried[*place].terms.iter().count() - shown.terms.iter().count();
                tried[*place].gain(shown) - EXPLAINED * added as f64
            };
            // A change follows much that is none: it counts if nothing is left to explain.
            let is_idle = |one: &Self| one.terms.has(Term::Change) && one.is_structured;
            let counts = |place: &usize| further.contains(&tried[*place].terms) && !is_idle(&tried[*place]);
            let best = (0..tried.len()).filter(counts).filter(|place| worth(place) > 0.0);
            match best.max_by(|a, b| worth(a).total_cmp(&worth(b))) {
                Some(best) => found = Some(best),
                None => return found.map(|place| tried.swap_remove(place)),
            }
        }
    }

    /// Residuals that are independent (1).
    fn independent(&self) -> f64 {
        self.settled.near.residuals().len() as f64 / self.settled.near.correlation().max(1.0)
    }

    /// Fall of −2 ln L beside `other`, for as many residuals as are independent (1). A curve that has not settled may
    /// promise more than it keeps: what counts is the sum of squares that it was seen to leave.
    fn gain(&self, other: &Self) -> f64 {
        self.independent() * (other.squares / self.squares).ln()
    }

    /// The fall for each further one of `terms`, as one step of least squares promises it.
    fn promised(&self, machine: &Machine, terms: &Terms, experiments: &[Experiment]) -> Option<f64> {
        let (problem, _) = problems_of_levels(Table::form(machine), machine, terms, experiments, self.top).ok()?;
        let known = |parameter: &Parameter| {
            let place = self.names.iter().position(|name| name == parameter.name());
            place.map_or(0.0, |place| self.settled.values[place])
        };
        let values: Vec<f64> = problem.parameters().iter().map(known).collect();
        let first = problem.table.law;
        let near = Linearised::of(&problem.simulated_roughly(), &values, first).ok()?;
        let fall = self.independent() * (self.settled.near.least_squares() / near.least_squares()).ln();
        let added = terms.iter().count().saturating_sub(self.terms.iter().count());
        Some(fall / added as f64).filter(|fall| !fall.is_nan())
    }

    /// Starts of a fit of `problem`: its law projected, or near Coulomb and viscous friction if it states no friction
    /// over the speed. What the friction over the speed does not tell is that of the `others` of the same name, or
    /// for a law with internal state one of several values.
    pub(crate) fn starts(&self, problem: &Problem<'_>, others: &[&Fitted]) -> Vec<Vec<f64>> {
        self.starts_at(&self.projected(problem, others), problem, others)
    }

    /// The same where the law was `projected`.
    pub(crate) fn starts_at(
        &self,
        projected: &[Projected],
        problem: &Problem<'_>,
        others: &[&Fitted],
    ) -> Vec<Vec<f64>> {
        let Some(best) = projected.first() else { return self.near(problem, others) };
        let count = if problem.table.family.is_of_speed() { 1 } else { projected.len() };
        let even = projected.iter().take(count).filter(|one| one.misfit < best.misfit + EVEN);
        even.map(|one| one.start.clone()).collect()
    }

    /// Place of a parameter of the terms beside the curve; `None` for others.
    fn beside_place(&self, parameter: &Parameter) -> Option<usize> {
        let place = self.names.iter().position(|name| name == parameter.name())?;
        self.beside.contains(&place).then_some(place)
    }

    fn near(&self, problem: &Problem<'_>, others: &[&Fitted]) -> Vec<Vec<f64>> {
        let simple = Candidate::of::<CoulombViscous>().with(self.terms.clone());
        let Ok(simple) = Problem::of(&simple, problem.machine, problem.experiments()) else { return problem.starts() };
        let of_others = |(value, parameter): (&f64, &Parameter)| {
            let mut estimates = others.iter().flat_map(|other| other.fit.estimates());
            estimates.find(|estimate| estimate.name() == parameter.name()).map_or(*value, Estimate::value)
        };
        let shared = problem.table.oscillator..problem.table.shared;
        let near = problem.near(&simple, &self.line).into_iter().map(|mut start| {
            let taken: Vec<f64> = start.iter().zip(problem.parameters()).map(of_others).collect();
            start[shared.clone()].copy_from_slice(&taken[shared.clone()]);
            for (value, parameter) in start.iter_mut().zip(problem.parameters()) {
                *value = self.beside_place(parameter).map_or(*value, |place| self.settled.values[place]);
            }
            problem.clamped(&start)
        });
        near.collect()
    }

    /// The law of `problem` at all ends of the search for where its friction over the speed is most probable, that first;
    /// empty for a law that states none.
    pub(crate) fn projected(&self, problem: &Problem<'_>, others: &[&Fitted]) -> Vec<Projected> {
        let shared = problem.table.oscillator..problem.table.shared;
        let starts = self.near(problem, others);
        let mut parameters = problem.parameters()[shared.clone()].to_vec();
        for parameter in &mut parameters {
            let known = self.beside_place(parameter).map(|place| self.settled.values[place]);
            if let Some(bounds) = known.and_then(|value| Bounds::new(value, value).ok()) {
                *parameter = parameter.clone().bounded(bounds);
            }
        }
        let projection = Projection { shown: self, table: &problem.table, parameters: &parameters };
        let options = Options::default().with_max_iterations(MOST_ITERATIONS).with_cost_tolerance(ENOUGH);
        let options = options.with_polish_steps(0).with_restarts(0).with_jacobian_check(false);
        let shows_all = projection.shows_all(starts.iter().map(|start| &start[shared.clone()]));
        let end = |start: &Vec<f64>| {
            let fit = solve(&projection, &start[shared.clone()], &options).ok()?;
            let start = self.begun(problem, start, fit.values(), &projection.levels(fit.values())?);
            Some(Projected { misfit: fit.sum_of_squares(), shows_all, start })
        };
        let mut ends: Vec<Projected> = starts.iter().filter_map(end).collect();
        ends.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
        ends
    }

    /// Values of a fit of `problem` whose damping and law have the values `of_law` and these `levels`; what the curve's
    /// problem does not have is that of `start`.
    fn begun(&self, problem: &Problem<'_>, start: &[f64], of_law: &[f64], levels: &[f64; LEVELS]) -> Vec<f64> {
        let shared = problem.table.oscillator..problem.table.shared;
        let values = &self.settled.values;
        let change = DVector::from_fn(LEVELS, |i, _| levels[i] - values[self.first + i]);
        let moved = self.settled.near.moved(values, &self.settled.likelihood.step(&change), 1.0);
        let value = |(place, parameter): (usize, &Parameter)| {
            if shared.contains(&place) && self.beside_place(parameter).is_none() {
                return of_law[place - shared.start];
            }
            let known = self.names.iter().position(|name| name == parameter.name());
            known.map_or(start[place], |known| moved[known])
        };
        problem.clamped(&problem.parameters().iter().enumerate().map(value).collect::<Vec<_>>())
    }
}

/// Friction of the law of a `table` by fitted `values`, with the damping beside it, at a `speed` that grows or, if it
/// is `losing`, falls, in the unit of its forces; `None` for a law that states none.
pub(super) fn friction(table: &Table, values: &[f64], speed: f64, losing: bool) -> Option<f64> {
    let beside = |term: Term| table.terms.place(term).map_or(0.0, |place| values[table.oscillator + place]);
    let further = beside(Term::QuadraticDamping) + beside(Term::CubicDamping) * speed;
    let damping = beside(Term::LinearDamping) + further * speed;
    let steady = table.family.steady(&values[table.of_law()], speed, losing)?;
    let power = beside(Term::PowerDamping) * speed.powf(beside(Term::PowerExponent));
    Some(steady + damping * speed + power)
}

/// Levels up to `top` of that friction, in the mean over growing and falling speeds; that at rest is the one just above.
pub(super) fn levels(table: &Table, values: &[f64], top: f64) -> Option<[f64; LEVELS]> {
    /// Lowest speed over the top speed (1). Origin: far below the first knot.
    const SLOW: f64 = 1e-5;
    let mut levels = [0.0; LEVELS];
    for (level, knot) in levels.iter_mut().zip(KNOTS) {
        let at = |losing| friction(table, values, knot.max(SLOW) * top, losing);
        *level = 0.5 * (at(false)? + at(true)?);
    }
    Some(levels)
}

/// The least-squares problem of a law on the friction that records show.
struct Projection<'a> {
    shown: &'a ShownFriction,
    table: &'a Table,
    /// Parameters of the damping and the law.
    parameters: &'a [Parameter],
}

impl Projection<'_> {
    /// b(θ) of damping and law by the values θ.
    fn levels(&self, values: &[f64]) -> Option<[f64; LEVELS]> {
        let mut all = vec![0.0; self.table.oscillator];
        all.extend_from_slice(values);
        levels(self.table, &all, self.shown.top)
    }

    /// True if a steady motion shows all parameters of the law: at all these values friction is the same for a growing and for a
    /// falling speed, and at some of them each parameter changes it.
    fn shows_all<'v>(&self, mut all: impl Iterator<Item = &'v [f64]> + Clone) -> bool {
        let is_even = |values: &[f64]| {
            let all = [&vec![0.0; self.table.oscillator], values].concat();
            let at = |losing| friction(self.table, &all, 0.1 * self.shown.top, losing);
            at(false) == at(true)
        };
        let acts = |values: &[f64], place: usize| {
            let mut changed = values.to_vec();
            changed[place] = self.parameters[place].bounds().clamp(1.5 * changed[place]);
            self.levels(&changed) != self.levels(values)
        };
        let is_free =
            |values: &[f64], place: usize| !self.parameters[place].bounds().is_fixed() && values[place] != 0.0;
        all.clone().all(is_even)
            && all.any(|values| {
                (0..values.len()).filter(|place| is_free(values, *place)).all(|place| acts(values, place))
            })
    }
}

impl Residuals for Projection<'_> {
    fn parameters(&self) -> &[Parameter] {
        self.parameters
    }

    fn len(&self) -> usize {
        LEVELS
    }

    fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        let levels =
            self.levels(p).ok_or_else(|| EvaluationError::message("the law states no friction over the speed"))?;
        let levels = DVector::from_row_slice(&levels);
        residuals.copy_from_slice((&self.shown.root * levels - &self.shown.best).as_slice());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use fmm_friction::Stribeck;
    use fmm_model::Oscillator;
    use fmm_record::{Quantity, Record};
    use fmm_sim::{Sampling, Scenario, simulate};

    use super::*;
    use crate::experiment::Preparation;

    /// Decay of a machine of 2 Hz whose spring has a share `cubic` of k x² (1/m²), with friction of 0.3 m/s² that is
    /// 0.1 m/s² larger at rest and falls over 0.05 m/s.
    fn decay(cubic: f64) -> [Experiment; 1] {
        let law = Stribeck::new(0.3, 0.4, 0.05, 2.0, 0.2).unwrap();
        let machine = Oscillator::per_unit_mass(2.0).unwrap();
        let machine = machine.with_restoring(Restoring::polynomial(cubic, 0.0).unwrap());
        let scenario = Scenario::new(machine, law, 1.0).unwrap();
        let motion =
            simulate(&scenario.starting_at(0.03, 0.0).unwrap(), &Sampling::uniform(2e-3, 1500).unwrap()).unwrap();
        let noise = |i: usize| 6e-4 * (((i * i * 7919) % 10_007) as f64 / 10_007.0 - 0.5);
        let velocity = motion.velocity().values().iter().enumerate().map(|(i, v)| v + noise(i)).collect();
        let record = Record::new(0.0, 2e-3, velocity, Quantity::Velocity, "m/s").unwrap();
        [Experiment::ring_down(&record, &Preparation::default()).unwrap()]
    }

    /// A term promises much where it acts, and what chance explains where it does not.
    #[test]
    fn a_term_that_acts_promises_to_explain() {
        let machine = Machine::per_unit_mass();
        let promised = |cubic: f64, term: Term| {
            let decays = decay(cubic);
            let shown = ShownFriction::of(&machine, Terms::NONE, &decays, None).unwrap();
            shown.promised(&machine, &Terms::NONE.with(term), &decays).unwrap()
        };
        let chance = [Term::CubicSpring, Term::Change].map(|term| promised(0.0, term));
        assert!(chance.iter().all(|fall| (0.0..8.0).contains(fall)), "{chance:?}");
        let bent = promised(200.0, Term::CubicSpring);
        assert!(bent > EXPLAINED, "{bent}");
    }

    /// The law of the decay begins close to its friction, and a straight line is excluded.
    #[test]
    fn a_law_begins_on_the_friction_that_the_record_shows() {
        let decays = decay(0.0);
        let machine = Machine::per_unit_mass();
        let shown = ShownFriction::of(&machine, Terms::NONE, &decays, None).unwrap();
        let problem = |candidate| Problem::of(&candidate, machine, &decays).unwrap();
        let own = problem(Candidate::of::<Stribeck>().holding("exponent", 2.0).unwrap());
        let projected = shown.projected(&own, &[]).remove(0);
        assert!(projected.misfit < 40.0, "{}", projected.misfit);
        for speed in [0.01, 0.05, 0.2, 0.35] {
            let truth = 0.3 + 0.1 * (-(speed / 0.05f64).powi(2)).exp() + 0.2 * speed;
            let found = friction(&own.table, &projected.start, speed, false).unwrap();
            assert!((found / truth - 1.0).abs() < 0.02, "{found} in place of {truth} at {speed}");
        }
        assert!((projected.start[0] - 2.0).abs() < 1e-4, "{}", projected.start[0]);
        let line = shown.projected(&problem(Candidate::of::<CoulombViscous>()), &[]).remove(0);
        assert!(line.misfit > projected.misfit + 100.0, "{} beside {}", line.misfit, projected.misfit);
    }
}
