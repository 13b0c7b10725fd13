//! Inputs that no record determines, drawn beside the parameters of a fit.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::experiment::Experiment;
use crate::identification::Identification;
use crate::machine::Machine;
use crate::problem::Problem;
use crate::quantities::derived::values_of_findings;
use crate::quantities::table::Table;

/// Knowledge of scale, load and gain, which multiply the fitted values, with normal priors by its standard
/// uncertainties. Inputs of the motion itself are fitted, and so among the draws.
pub(super) struct KnownInputs<'a> {
    machine: Machine,
    table: &'a Table,
    gain_uncertainty: f64,
}

impl<'a> KnownInputs<'a> {
    pub(super) fn of(found: &Identification, problem: &'a Problem<'a>, experiments: &[Experiment]) -> Self {
        let gain = experiments.iter().map(|experiment| experiment.summary().gain_uncertainty).fold(0.0, f64::max);
        Self { machine: *found.machine(), table: problem.quantities(), gain_uncertainty: gain }
    }

    /// The values of all findings for one draw of the fitted ones.
    pub(super) fn findings(&self, draw: &[f64], random: &mut ChaCha8Rng) -> Vec<f64> {
        let mut normal = || -> f64 { StandardNormal.sample(random) };
        // A gain that is wrong by more than its own size is no gain.
        let gain = (1.0 + self.gain_uncertainty * normal()).max(f64::EPSILON);
        let machine = self.machine.with_scale_and_load_moved([normal(), normal()]);
        values_of_findings(&machine, self.table, draw, [gain, 1.0])
    }
}
