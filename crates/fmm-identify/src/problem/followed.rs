//! Friction over the speed by a fitted law, which another law can follow before it is fitted itself.

use fmm_fit::{EvaluationError, Options, Residuals, solve};
use fmm_model::Parameter;

use crate::machine::Terms;
use crate::machine::term::Term;
use crate::quantities::table::Table;

/// Retarding force per mass over the speed, of a law with the damping beside it, in the units of a record.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FrictionCurve {
    points: Vec<Point>,
}

/// Friction per mass at one speed, which grows or falls.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Point {
    speed: f64,
    losing: bool,
    friction: f64,
}

/// Speeds at which a curve is known, each once while it grows and once while it falls.
const SPEEDS: u32 = 40;

impl FrictionCurve {
    /// The curve of a law in `table` with `terms` by fitted `values`, up to the `peak` speed; `None` if the law states
    /// none. The speeds lie closer near rest, where laws bend.
    pub(crate) fn of(table: &Table, terms: &Terms, values: &[f64], peak: f64) -> Option<Self> {
        let at = |(step, losing): (u32, bool)| {
            let speed = peak * (f64::from(step) / f64::from(SPEEDS)).powi(2);
            let friction = friction(table, terms, values, speed, losing)?;
            friction.is_finite().then_some(Point { speed, losing, friction })
        };
        let points = (1..=SPEEDS).flat_map(|step| [(step, false), (step, true)]).map(at);
        Some(Self { points: points.collect::<Option<_>>()? })
    }

    /// The values of a law in `table` with `terms` that follow this curve best, of those that a search from `starts`
    /// finds; what lies outside damping and law is left as it is. `None` if the law states no curve.
    pub(crate) fn followed(
        &self,
        table: &Table,
        terms: &Terms,
        parameters: &[Parameter],
        starts: &[Vec<f64>],
    ) -> Option<Vec<f64>> {
        let (first, last) = (table.oscillator, table.shared);
        let fits = starts.iter().filter_map(|start| {
            let problem = Following { curve: self, table, terms, parameters: &parameters[first..last], all: start };
            let fit = solve(&problem, &start[first..last], &Options::default()).ok()?;
            Some((fit.sum_of_squares(), start, fit.values().to_vec()))
        });
        let (_, start, shared) = fits.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let mut values = start.clone();
        values[first..last].copy_from_slice(&shared);
        Some(values)
    }
}

/// Friction per mass of a law in `table` with `terms` by fitted `values`.
pub(crate) fn friction(table: &Table, terms: &Terms, values: &[f64], speed: f64, losing: bool) -> Option<f64> {
    let beside = |term: Term| terms.place(term).map_or(0.0, |place| values[table.oscillator + place]);
    let further = beside(Term::QuadraticDamping) + beside(Term::CubicDamping) * speed;
    let damping = beside(Term::LinearDamping) + further * speed;
    let steady = table.family.steady(&values[table.of_law()], speed, losing)?;
    let power = beside(Term::PowerDamping) * speed.powf(beside(Term::PowerExponent));
    Some(steady + damping * speed + power)
}

/// The least-squares problem of a law that follows a curve.
struct Following<'a> {
    curve: &'a FrictionCurve,
    table: &'a Table,
    terms: &'a Terms,
    parameters: &'a [Parameter],
    /// All values of the law's fit; those of damping and law are replaced.
    all: &'a [f64],
}

impl Residuals for Following<'_> {
    fn parameters(&self) -> &[Parameter] {
        self.parameters
    }

    fn len(&self) -> usize {
        self.curve.points.len()
    }

    fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        let mut values = self.all.to_vec();
        values[self.table.oscillator..self.table.shared].copy_from_slice(p);
        for (residual, point) in residuals.iter_mut().zip(&self.curve.points) {
            let friction = friction(self.table, self.terms, &values, point.speed, point.losing);
            *residual = friction.unwrap_or(f64::NAN) - point.friction;
        }
        Ok(())
    }
}
