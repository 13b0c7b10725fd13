//! The same problem with a part of its records, or within narrower bounds: what a search begins with.

use std::f64::consts::PI;

use fmm_friction::{Recast, Role};
use fmm_model::Bounds;
use fmm_record::Quantity;

use super::{Problem, blocks};
use crate::Experiment;
use crate::experiment::reference;

/// Samples of a record, and of each of its periods, that are enough to search with.
const ENOUGH_SAMPLES: usize = 1500;
const SAMPLES_PER_SWING: f64 = 24.0;

impl Problem<'_> {
    /// The ring-downs up to a `share` of their duration (1), for a fit in which a small error of the period does not yet add up.
    pub(crate) fn beginnings(&self, share: f64) -> Vec<Experiment> {
        self.decays.iter().map(|decay| decay.beginning(share)).collect()
    }

    /// The ring-downs with so few of their samples that a search among many starts is quick and yet sees every swing; `None` if
    /// they have no more.
    pub(crate) fn thinned(&self) -> Option<Vec<Experiment>> {
        let stride = |decay: &Experiment| {
            let swings = decay.record().duration() * decay.guess().frequency();
            let enough = ENOUGH_SAMPLES.max((SAMPLES_PER_SWING * swings) as usize);
            decay.record().len() / enough
        };
        let stride = self.decays.iter().map(stride).min().filter(|stride| *stride > 1)?;
        self.decays.iter().map(|decay| decay.thinned(stride)).collect()
    }

    /// The ring-downs up to their last peaks, if they are displacements and that leaves something out.
    pub(crate) fn up_to_last_peaks(&self) -> Option<Vec<Experiment>> {
        if reference(self.decays).record().quantity() != Quantity::Displacement {
            return None;
        }
        let shortened = self.decays.iter().map(Experiment::up_to_last_peak).collect::<Vec<_>>();
        let any = shortened.iter().any(Option::is_some);
        let complete =
            shortened.into_iter().zip(self.decays).map(|(short, whole)| short.unwrap_or_else(|| whole.clone()));
        any.then(|| complete.collect())
    }

    /// The same problem with laws that bend at no less than 1e-4 of the largest speed, and contacts on which the machine would vibrate at
    /// no more than 300 times its own frequency: beyond, a law is to the records as good as one that leaps, and its motion takes far
    /// longer to simulate.
    pub(crate) fn bending_in_sight(mut self) -> Self {
        const SLOWEST: f64 = 1e-4;
        const STIFFEST: f64 = 1e5;
        let slowest = SLOWEST * reference(self.decays).scales().1;
        let stiffest = STIFFEST * (2.0 * PI * reference(self.decays).guess().frequency()).powi(2);
        let is_per_mass = self.layout.oscillator == 1;
        for (index, law) in self.law().fitted().enumerate() {
            let powers = self.law().powers(law);
            let parameter = &mut self.parameters[self.layout.law + index];
            let bounds = parameter.bounds();
            let value = powers.at_speed(slowest);
            let bounds = match powers.of_speed().filter(|_| law.role() == Role::Shape) {
                Some(power) if power > 0.0 => Bounds::new(bounds.lower().max(value), bounds.upper()),
                Some(_) => Bounds::new(bounds.lower(), bounds.upper().min(value)),
                None => match powers.at_stiffness(stiffest).filter(|_| law.role() == Role::Level && is_per_mass) {
                    Some(value) => Bounds::new(bounds.lower(), bounds.upper().min(value)),
                    None => continue,
                },
            };
            // One that is held elsewhere stays so.
            if let Ok(bounds) = bounds {
                *parameter = parameter.clone().bounded(bounds);
            }
        }
        self
    }

    /// The same problem with other records of the same kind and number.
    pub(crate) fn with_records<'b>(&self, decays: &'b [Experiment]) -> Problem<'b> {
        Problem {
            machine: self.machine,
            terms: self.terms.clone(),
            decays,
            parameters: self.parameters.clone(),
            layout: self.layout.clone(),
            blocks: blocks(&self.layout, decays),
            weights: self.weights.clone(),
        }
    }

    /// The same problem by parameters that a fit finds in fewer steps; `None` for a law without such parameters, and where one that only
    /// this problem has is held.
    pub(crate) fn recast(&self) -> Option<Self> {
        let recast = (self.law().recast)()?;
        Self::of(recast.family, self.machine, self.terms.clone(), self.decays).ok()
    }

    /// The values of this problem where those of the [recast](Self::recast) one have been `found`.
    pub(crate) fn of_recast(&self, found: &[f64]) -> Option<Vec<f64>> {
        let Recast { family, values } = (self.law().recast)()?;
        let (before, rest) = found.split_at(self.layout.law);
        let (of_law, own) = rest.split_at(family.fitted().count());
        Some([before, &values(of_law).ok()?, own].concat())
    }
}
