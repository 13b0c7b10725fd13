//! The same problem with a part of its records, or within narrower bounds: what a search begins with.

use std::borrow::Cow;
use std::f64::consts::PI;

use fmm_friction::{Reparametrisation, Role};
use fmm_model::Bounds;
use fmm_record::Quantity;

use super::Problem;
use crate::candidate::Candidate;
use crate::experiment::Experiment;
use crate::experiment::reference;
use crate::problem::idle::Idle;

/// Samples of a record, and of each of its periods, that are enough to search with. With fewer, a run takes as long,
/// and the last fit begins farther from its end.
const ENOUGH_SAMPLES: usize = 3000;
const SAMPLES_PER_SWING: f64 = 24.0;

/// The ring-downs with so few of their samples that a search among many starts is quick and yet sees every swing;
/// `None` if they have no more.
pub(crate) fn thinned(experiments: &[Experiment]) -> Option<Vec<Experiment>> {
    let stride = |decay: &Experiment| {
        let swings = decay.record().duration() * decay.guess.frequency();
        let enough = ENOUGH_SAMPLES.max((SAMPLES_PER_SWING * swings) as usize);
        decay.record().len() / enough
    };
    let stride = experiments.iter().map(stride).min().filter(|stride| *stride > 1)?;
    experiments.iter().map(|decay| decay.thinned(stride)).collect()
}

impl Problem<'_> {
    /// The ring-downs up to a `share` of their duration (1), for a fit in which a small error of the period does not
    /// yet add up.
    pub(crate) fn beginnings(&self, share: f64) -> Vec<Experiment> {
        self.experiments.iter().map(|experiment| experiment.beginning(share)).collect()
    }

    /// The ring-downs with [few of their samples](thinned).
    pub(crate) fn thinned(&self) -> Option<Vec<Experiment>> {
        thinned(&self.experiments)
    }

    /// The ring-downs up to their last peaks, if they are displacements and that leaves something out.
    pub(crate) fn up_to_last_peaks(&self) -> Option<Vec<Experiment>> {
        if reference(&self.experiments).record().quantity() != Quantity::Displacement {
            return None;
        }
        let shortened = self.experiments.iter().map(Experiment::up_to_last_peak).collect::<Vec<_>>();
        let any = shortened.iter().any(Option::is_some);
        let complete = shortened
            .into_iter()
            .zip(self.experiments.iter())
            .map(|(short, whole)| short.unwrap_or_else(|| whole.clone()));
        any.then(|| complete.collect())
    }

    /// The ring-downs between their reversals, if they are accelerations and that leaves enough.
    pub(crate) fn between_reversals(&self) -> Option<Vec<Experiment>> {
        self.experiments.iter().map(Experiment::between_reversals).collect()
    }

    /// The same problem with laws that bend at no less than 1e-4 of the largest speed, and contacts on which the
    /// machine would vibrate at no more than 300 times its own frequency, and with exponents of no less than 0.02:
    /// beyond, a law is to the records as good as one that leaps, and its motion takes far longer to simulate.
    pub(crate) fn bending_in_sight(mut self) -> Self {
        const SLOWEST: f64 = 1e-4;
        const STIFFEST: f64 = 1e5;
        const LEAST_EXPONENT: f64 = 0.02;
        let slowest = SLOWEST * reference(&self.experiments).scales().1;
        let stiffest = STIFFEST * (2.0 * PI * reference(&self.experiments).guess.frequency()).powi(2);
        let is_per_mass = self.table.is_per_mass();
        for (index, law) in self.law().fitted().enumerate() {
            let powers = self.law().powers(law);
            let parameter = &mut self.parameters[self.table.law + index];
            let bounds = parameter.bounds();
            let value = powers.at_speed(slowest);
            let bounds = match powers.of_speed().filter(|_| law.role() == Role::Shape) {
                Some(power) if power > 0.0 => Bounds::new(bounds.lower().max(value), bounds.upper()),
                Some(_) => Bounds::new(bounds.lower(), bounds.upper().min(value)),
                None if law.parameter().name() == "exponent" => {
                    Bounds::new(bounds.lower().max(LEAST_EXPONENT), bounds.upper())
                }
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

    /// The same problem for a search, with simulations to a relative tolerance of 1e-10: to that of the fit itself,
    /// motions by laws of the sliding speed take twice as long.
    pub(crate) fn simulated_roughly(self) -> Self {
        Self { tolerance: Some(1e-10), ..self }
    }

    /// The same problem with other records of the same kind and number.
    pub(crate) fn with_records<'b>(&self, experiments: &'b [Experiment]) -> Problem<'b> {
        let mut problem = Problem {
            machine: self.machine,
            experiments: Cow::Borrowed(experiments),
            parameters: self.parameters.clone(),
            table: self.table.clone(),
            prior: self.prior.clone(),
            blocks: Vec::new(),
            weights: self.weights.clone(),
            noise: self.noise,
            tolerance: self.tolerance,
            euler: self.euler,
            declared: self.declared.clone(),
            forces: None,
            idle: Idle::default(),
        };
        problem.blocks = problem.blocks_of_records();
        problem
    }

    /// The same problem by parameters that a fit finds in fewer steps; `None` for a law without such parameters, and
    /// where one that only this problem has is held.
    pub(crate) fn recast(&self) -> Option<Problem<'_>> {
        let recast = Candidate { law: self.law().members.recast()?.family, ..self.candidate() };
        Problem::of(&recast, self.machine, self.records()).ok()
    }

    /// The values of this problem where those of the [recast](Self::recast) one have been `found`.
    pub(crate) fn of_recast(&self, found: &[f64]) -> Option<Vec<f64>> {
        let Reparametrisation { family, values } = self.law().members.recast()?;
        let (before, rest) = found.split_at(self.table.law);
        let (of_law, own) = rest.split_at(family.fitted().count());
        Some([before, &values(of_law).ok()?, own].concat())
    }
}

#[cfg(test)]
mod tests {
    use fmm_fit::Residuals;
    use fmm_friction::{BoucWen, BoucWenByLevel, Coulomb, LawFamily, LuGre, MakkarDixon, PowerLaw};

    use super::super::tests::decays;
    use super::*;
    use crate::machine::{Machine, Terms};

    /// Every parameter that is bounded otherwise in sight, with its lower and upper bound.
    fn bounded_in_sight(problem: &Problem<'_>) -> Vec<(String, f64, f64)> {
        let sight = problem.clone().bending_in_sight();
        let pairs = sight.parameters().iter().zip(problem.parameters());
        let bounded = pairs.filter(|(seen, before)| seen.bounds() != before.bounds()).map(|(seen, _)| {
            let bounds = seen.bounds();
            (seen.name().to_owned(), bounds.lower(), bounds.upper())
        });
        bounded.collect()
    }

    #[test]
    fn laws_bend_in_sight() {
        let decays = decays();
        let slowest = 1e-4 * decays[0].scales().1;
        let stiffest = 1e5 * (2.0 * PI * decays[0].guess.frequency()).powi(2);
        let machine = Machine::per_unit_mass();
        let lugre = Problem::of(&Candidate::of::<LuGre>(), machine, &decays).unwrap();
        let by_speed = ("stribeck_speed".to_owned(), slowest, f64::INFINITY);
        let by_stiffness = ("contact_stiffness_per_mass".to_owned(), f64::MIN_POSITIVE, stiffest);
        assert_eq!(bounded_in_sight(&lugre), [by_speed.clone(), by_stiffness]);
        // Where the mass is found as well, a stiffness is no square of a frequency.
        let lugre = Problem::of(&Candidate::of::<LuGre>(), Machine::unknown(), &decays).unwrap();
        assert_eq!(bounded_in_sight(&lugre), [by_speed]);
        let makkar = Problem::of(&Candidate::of::<MakkarDixon>(), machine, &decays).unwrap();
        let below = |name: &str, lower: f64| (name.to_owned(), lower, slowest.recip());
        let expected = [below("rise", f64::MIN_POSITIVE), below("fall", f64::MIN_POSITIVE), below("level_rise", 0.0)];
        assert_eq!(bounded_in_sight(&makkar), expected);
        let power = Problem::of(&Candidate::of::<PowerLaw>(), machine, &decays).unwrap();
        assert_eq!(bounded_in_sight(&power), [("exponent".to_owned(), 0.02, 1.0)]);
        // What is held keeps its value.
        let held = Terms::default().holding("rise", 1e9).unwrap();
        let makkar = Problem::of(&Candidate::of::<MakkarDixon>().with(held), machine, &decays).unwrap();
        assert_eq!(bounded_in_sight(&makkar), expected[1..]);
    }

    #[test]
    fn each_record_has_its_beginning() {
        let decays = decays();
        let problem = Problem::of(&Candidate::of::<Coulomb>(), Machine::per_unit_mass(), &decays).unwrap();
        let beginnings = problem.beginnings(0.9);
        assert_eq!(beginnings.len(), decays.len());
        for (beginning, whole) in beginnings.iter().zip(&decays) {
            let (got, expected) = (beginning.record().duration(), 0.9 * whole.record().duration());
            assert!((got - expected).abs() <= whole.record().interval(), "{got} s in place of {expected} s");
        }
    }

    #[test]
    fn a_recast_problem_is_the_same_by_other_values() {
        let decays = decays();
        let machine = Machine::per_unit_mass();
        let problem = Problem::of(&Candidate::of::<BoucWen>(), machine, &decays).unwrap();
        let recast = problem.recast().unwrap();
        assert_eq!(recast.name(), BoucWenByLevel::NAME);
        let law = [2000.0, 1.0, 0.3, 0.5, 1.65];
        let mut found = recast.starts()[0].clone();
        found[1..6].copy_from_slice(&law);
        let values = problem.of_recast(&found).unwrap();
        assert_eq!(values[1..6], BoucWenByLevel::at(&law).unwrap().values());
        let residuals = |problem: &Problem<'_>, p: &[f64]| {
            let mut residuals = vec![0.0; problem.len()];
            problem.evaluate(p, &mut residuals, None).unwrap();
            residuals
        };
        assert_eq!(residuals(&problem, &values), residuals(&recast, &found));
        assert!(Problem::of(&Candidate::of::<Coulomb>(), machine, &decays).unwrap().recast().is_none());
        let holding = |name: &str| {
            let held = Terms::default().holding(name, 1.0).unwrap();
            Problem::of(&Candidate::of::<BoucWen>().with(held), machine, &decays).unwrap().recast().is_some()
        };
        assert!(holding("amplitude") && !holding("gamma"), "gamma is no parameter of the recast law");
    }
}
