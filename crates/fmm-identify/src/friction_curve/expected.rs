//! Friction curve that is expected of records before they are made.

use fmm_fit::design::Information;
use nalgebra::{DMatrix, DVector};

use crate::candidate::Candidate;
use crate::error::IdentifyError;
use crate::friction_curve::fit::CurveFit;
use crate::friction_curve::level::FrictionLevel;
use crate::friction_curve::levels::{LEVELS, Levels, TOP_SPEED, weights};
use crate::friction_curve::mixture::{Posterior, Prior};
use crate::friction_curve::path::Path;
use crate::friction_curve::projection::levels;
use crate::friction_curve::sources::Sources;
use crate::friction_curve::{FrictionCurve, factored, scale};
use crate::law::naming::Form;
use crate::linear_algebra::inverse;
use crate::machine::{Machine, Terms};
use crate::quantities::table::Table;

/// Friction over the speed by a law with values, about which a curve of records would lie.
///
/// ```text
/// η = Λ b
/// ```
///
/// b are the levels of the law, Λ the precision that the records give to levels; their noise is zero in the mean.
#[derive(Debug, Clone)]
pub(crate) struct Expected {
    machine: Machine,
    /// Table of the law.
    table: Table,
    frequency: f64,
    top: f64,
    /// Mean friction over the path, in which prior and levels are relative.
    scale: f64,
    levels: DVector<f64>,
    prior: Prior,
}

impl Expected {
    /// Friction on `machine` of the law of a `table` with forces per mass, by shared `values` of which the first is the
    /// frequency, for records with this `path`; `None` for a law that states no friction over the speed, or none at all.
    pub(crate) fn of(machine: Machine, table: &Table, values: &[f64], path: &Path) -> Option<Self> {
        let top = path.top();
        let levels = DVector::from(levels(table, values, top)?.to_vec());
        let scale = DVector::from(path.weights(top).to_vec()).dot(&levels);
        let is_friction = scale > 0.0 && scale.is_finite();
        is_friction.then(|| Self {
            machine,
            table: table.clone(),
            frequency: values[0],
            top,
            scale,
            levels: levels / scale,
            prior: Prior::new(),
        })
    }

    /// Highest speed.
    pub(crate) fn top(&self) -> f64 {
        self.top
    }

    /// The levels as a law, with these terms `beside` it.
    pub(crate) fn law(&self, beside: Terms) -> Result<Candidate, IdentifyError> {
        Ok(Candidate::of::<Levels>().with(beside.holding(TOP_SPEED, self.top)?))
    }

    /// Values of that law as it is fitted.
    pub(crate) fn values(&self) -> impl Iterator<Item = f64> + '_ {
        self.levels.iter().map(|level| level * self.scale).chain([self.top])
    }

    /// ln of u over friction at `speed`, by `information` of which the levels begin at the place `first`.
    pub(crate) fn logarithm(&self, information: &Information, first: usize, speed: f64) -> f64 {
        let weights = weights(speed / self.top);
        let (_, _, of_factor) = scale(&self.machine, Form::PerMass, &self.table.units, self.frequency);
        let square = of_factor.iter().map(|(_, relative)| relative * relative).sum();
        let parts = factored(self.posterior(&precision(information, first)).marginal(&weights), 1.0, square);
        let friction = self.levels.iter().zip(weights).map(|(level, weight)| level * weight).sum::<f64>().abs();
        let u = FrictionLevel::new(&parts, f64::INFINITY, String::new()).uncertainty();
        (u / if friction > 0.0 { friction } else { 1.0 }).ln()
    }

    /// The curve by that information of records with this `path`.
    pub(crate) fn curve(&self, information: &Information, first: usize, path: &Path) -> FrictionCurve {
        let precision = precision(information, first);
        let posterior = self.posterior(&precision);
        let fit = CurveFit {
            top: self.top,
            scale: self.scale,
            sources: Sources::of(&posterior, &precision, &[], self.scale),
            posterior,
            freedom: f64::INFINITY,
            frequency: self.frequency,
            path: path.weights(self.top),
            slowest: path.slowest(),
            excess: None,
            limit_near_rest: None,
        };
        FrictionCurve::of_fit(fit, Form::PerMass, &self.machine, &self.table.units, &[])
    }

    fn posterior(&self, precision: &DMatrix<f64>) -> Posterior {
        let precision = precision * (self.scale * self.scale);
        self.prior.posterior(&precision, &(&precision * &self.levels))
    }
}

/// Λ of levels from the place `first` on, all else integrated out: Λ_bb − Λ_bn Λ_nn⁻ Λ_nb.
fn precision(information: &Information, first: usize) -> DMatrix<f64> {
    let rest: Vec<usize> = (0..information.order()).filter(|place| !(first..first + LEVELS).contains(place)).collect();
    let of_rest = DMatrix::from_fn(rest.len(), rest.len(), |i, j| information.element(rest[i], rest[j]));
    let mixed = DMatrix::from_fn(rest.len(), LEVELS, |i, j| information.element(rest[i], first + j));
    let inverse = DMatrix::from_row_slice(rest.len(), rest.len(), &inverse(&of_rest));
    let own = DMatrix::from_fn(LEVELS, LEVELS, |i, j| information.element(first + i, first + j));
    let left = own - mixed.tr_mul(&(inverse * &mixed));
    0.5 * (&left + left.transpose())
}
