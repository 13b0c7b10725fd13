//! Inputs that no record determines, drawn beside the parameters of a fit.

use fmm_fit::{Fit, Options, solve};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::error::IdentifyError;
use crate::experiment::{Drive, Experiment};
use crate::identification::Identification;
use crate::machine::Machine;
use crate::problem::Problem;
use crate::quantities::derived::values_of_findings;
use crate::quantities::layout::Layout;

/// What is known of machine and instruments, with normal priors by their standard uncertainties.
///
/// Scale, load and gains multiply what was fitted. A damping that is held, and the mass beside a measured force, are
/// inputs of the fit itself: the draws are moved by what the fit moves by, in proportion.
pub(super) struct KnownInputs<'a> {
    machine: Machine,
    layout: &'a Layout,
    gain_uncertainty: f64,
    /// Change of all fitted values by one standard uncertainty of each input of the fit.
    shifts: Vec<Vec<f64>>,
}

impl<'a> KnownInputs<'a> {
    pub(super) fn of(
        found: &Identification,
        problem: &'a Problem<'a>,
        experiments: &[Experiment],
    ) -> Result<Self, IdentifyError> {
        let has_force = experiments.iter().any(|experiment| experiment.drive().is_some_and(Drive::is_force));
        let machine = *found.machine();
        let mut shifts = Vec::new();
        for (_, ends) in machine.inputs_moved(has_force) {
            let [below, above] = ends.map(|(_, machine)| -> Result<Fit, IdentifyError> {
                let law = found.family();
                let problem = Problem::of(law, machine, found.terms().clone(), experiments)?;
                solve(&problem, found.fit().values(), &Options::default())
                    .map_err(|source| IdentifyError::Fit { law: law.name, source })
            });
            let (below, above) = (below?, above?);
            shifts.push(above.values().iter().zip(below.values()).map(|(a, b)| 0.5 * (a - b)).collect());
        }
        let gain = experiments.iter().map(|experiment| experiment.summary().gain_uncertainty).fold(0.0, f64::max);
        let machine = if has_force { machine.with_exact_scale() } else { machine };
        Ok(Self { machine, layout: problem.layout(), gain_uncertainty: gain, shifts })
    }

    /// The values of all findings for one draw of the fitted ones.
    pub(super) fn findings(&self, draw: &[f64], random: &mut ChaCha8Rng) -> Vec<f64> {
        let mut normal = || -> f64 { StandardNormal.sample(random) };
        // A gain that is wrong by more than its own size is no gain.
        let gains =
            [self.gain_uncertainty, self.layout.force_uncertainty].map(|u| (1.0 + u * normal()).max(f64::EPSILON));
        let machine = self.machine.with_scale_and_load_moved([normal(), normal()]);
        let mut values = draw.to_vec();
        for shift in &self.shifts {
            let by = normal();
            values.iter_mut().zip(shift).for_each(|(value, shift)| *value += by * shift);
        }
        values_of_findings(&machine, self.layout, &values, gains)
    }
}
