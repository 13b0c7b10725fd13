//! Start values of a fit to ring-downs.

use std::f64::consts::PI;

use fmm_fit::{Estimate, Fit};
use fmm_friction::{LawParameter, Role};
use fmm_model::Parameter;

use super::Problem;
use crate::candidate::Candidate;
use crate::experiment::Experiment;
use crate::experiment::first_guess::Dissipation;
use crate::experiment::reference;
use crate::experiment::run_down::{are_run_downs, slope};
use crate::law::Law;
use crate::law::dimension::{Scales, is_coefficient, is_force};
use crate::machine::term::Term;
use crate::quantities::rows::{Knowledge, Place, Row};
use crate::quantities::table::mass_of_stiffness;

/// Start value of the excess of a static level, as a share of the sliding one (1).
const FIRST_STATIC_EXCESS: f64 = 0.2;

/// A fit by a law with its terms, near which another fit of the same records may begin.
#[derive(Debug, Clone)]
pub(crate) struct Fitted {
    pub(crate) model: Candidate,
    pub(crate) fit: Fit,
}

/// Shares of the largest speed over which friction may fall, at which a law begins, and the fall over its level (1).
const FALLS: [f64; 4] = [0.02, 0.06, 0.2, 0.5];
const FALL: f64 = 0.3;

impl Problem<'_> {
    /// True if a measured force or motion drives one of the records.
    pub(crate) fn is_driven(&self) -> bool {
        self.experiments.iter().any(|experiment| experiment.drive().is_some())
    }

    /// True if the law or the terms beside it have more to find than levels and a viscous part.
    pub(crate) fn is_elaborate(&self) -> bool {
        self.table.law > self.table.oscillator
            || self.law().fitted().filter(|parameter| is_force(parameter.role())).count() > 1
            || self.law().fitted().any(|parameter| self.law().bends(parameter))
    }

    /// Start values, one set per hypothesis that the law can express, each inside the bounds.
    pub(crate) fn starts(&self) -> Vec<Vec<f64>> {
        let has_level = self.law().fitted().any(|parameter| is_force(parameter.role()));
        let has_slope = self.has_linear_damping() || self.drags();
        let reference = reference(&self.experiments);
        let hypotheses = reference.hypotheses();
        let expressible = |dissipation: &&Dissipation| {
            (has_level || dissipation.friction == 0.0) && (has_slope || dissipation.damping == 0.0)
        };
        let mut starts: Vec<_> =
            hypotheses.iter().filter(expressible).map(|hypothesis| self.start(*hypothesis)).collect();
        if self.is_driven() {
            let neutral: Vec<Experiment> =
                self.experiments.iter().map(|experiment| experiment.clone().begun_neutral()).collect();
            let problem = self.with_records(&neutral);
            starts.extend(hypotheses.iter().filter(expressible).map(|hypothesis| problem.start(*hypothesis)));
        }
        if starts.is_empty() {
            starts.extend(hypotheses.first().map(|hypothesis| self.start(*hypothesis)));
        }
        self.with_corners(starts)
    }

    /// The `starts` with corners of the spring where there may be some: a distance that no motion shows, and a spring
    /// that does not change there, say nothing of where to go.
    fn with_corners(&self, starts: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        let length = reference(&self.experiments).scales().0;
        let at = |term: Term| self.table.shared(Place::Term(term));
        let corners: Vec<Vec<(usize, f64)>> = match (at(Term::Stop), at(Term::StopRatio), at(Term::Gap)) {
            (Some(distance), Some(ratio), _) => {
                let pairs = [0.3, 0.6, 0.85].into_iter().flat_map(|share| [(share, 0.5), (share, 2.0)]);
                pairs.map(|(share, stiffness)| vec![(distance, share * length), (ratio, stiffness)]).collect()
            }
            (.., Some(gap)) => [0.01, 0.05, 0.2].map(|share| vec![(gap, share * length)]).to_vec(),
            _ => return starts,
        };
        let moved = |start: &Vec<f64>, changes: &[(usize, f64)]| {
            let mut start = start.clone();
            for (index, value) in changes {
                start[*index] = *value;
            }
            start
        };
        starts.iter().flat_map(|start| corners.iter().map(|changes| moved(start, changes))).collect()
    }

    fn has_linear_damping(&self) -> bool {
        self.terms().has_linear_damping() || self.law().has_slope()
    }

    /// True for run-downs whose only damping is that with the square of the speed.
    fn drags(&self) -> bool {
        let is_drag = self.terms().has(Term::QuadraticDamping) && !self.has_linear_damping();
        is_drag && are_run_downs(&self.experiments) == Some(true)
    }

    /// Start values under one hypothesis.
    fn start(&self, dissipation: Dissipation) -> Vec<f64> {
        let reference = reference(&self.experiments);
        let frequency = reference
            .driven_guess()
            .map_or_else(|| reference.natural_frequency(dissipation, &self.machine), |guess| guess.frequency);
        // An unknown mass starts at 1 kg unless a force tells it; nothing in a free vibration says better.
        let mut forced = self.experiments.iter().filter(|experiment| experiment.is_forced());
        let guess = forced.find_map(Experiment::driven_guess).map_or(1.0, |guess| guess.mass);
        let known = |row: &Row| match row.knowledge {
            Knowledge::Prior { value, .. } | Knowledge::Fixed(value) => Some(value),
            Knowledge::Free => None,
        };
        let rows = &self.table.rows;
        let mass = rows.iter().find(|row| row.place == Place::Mass).and_then(known).unwrap_or(guess);
        let of_oscillator = |row: &Row| match row.place {
            Place::Frequency => frequency,
            Place::Mass => mass,
            Place::Stiffness => mass / mass_of_stiffness(1.0, frequency),
            Place::Slope => slope(&self.experiments),
            _ => 0.0,
        };
        let mut start: Vec<f64> =
            rows[..self.table.oscillator].iter().map(|row| known(row).unwrap_or_else(|| of_oscillator(row))).collect();
        let force_per_mass = if self.table.is_per_mass() { 1.0 } else { mass };
        let of_law = Dissipation {
            friction: dissipation.friction * force_per_mass,
            damping: dissipation.damping * force_per_mass,
        };
        self.push_dissipation(of_law, 1.0, &mut start);
        for row in &rows[self.table.shared..] {
            let experiment = &self.experiments[row.record.unwrap_or(0)];
            let (position, velocity) = experiment.first_state(dissipation);
            start.push(known(row).unwrap_or_else(|| match row.place {
                Place::Position => position,
                Place::Velocity => velocity,
                Place::Offset => experiment.first_offset(dissipation),
                Place::Disturbance(at) => experiment.nuisances[at].start(),
                Place::Corner => experiment.first_corner().unwrap_or(0.0),
                _ => 0.0,
            }));
        }
        self.clamped(&start)
    }

    /// The `values` of a fit to the same records by sensors that do not filter, with corners to begin with.
    pub(crate) fn behind_sensors(&self, values: &[f64]) -> Vec<f64> {
        let mut values = values.iter().copied();
        let start = self.table.rows.iter().map(|row| match (row.place, row.record) {
            (Place::Corner, Some(record)) => self.experiments[record].first_corner().unwrap_or(0.0),
            _ => values.next().unwrap_or(0.0),
        });
        let start: Vec<f64> = start.collect();
        self.clamped(&start)
    }

    /// The values of a `fit` by their names, with zeros for what it does not have.
    pub(crate) fn extended(&self, fit: &Fit) -> Vec<f64> {
        let value = |parameter: &Parameter| fit.estimate(parameter.name()).map_or(0.0, Estimate::value);
        self.clamped(&self.parameters.iter().map(value).collect::<Vec<_>>())
    }

    /// The `start` with the findings of a `special` case of the law: its level, and all that has a name in both. Parts
    /// above a level, and terms that the special case lacks, are zero; parameters at whose values the law is the
    /// special case have these, or the nearest within their bounds; where no bound keeps them from a limit, those of
    /// the start.
    pub(crate) fn nested(&self, special: &Fitted, start: &[f64]) -> Vec<f64> {
        let (law, other) = (self.law(), &special.model.law);
        let level = |law: &Law| {
            let parameter = law.level().and_then(|level| law.fitted().nth(level))?;
            Some(self.table.units.fitted(parameter, self.table.form).name().to_owned())
        };
        let (own_level, their_level) = (level(law), level(other));
        let case = law.special_cases.iter().find(|case| Some(case.law()) == other.dry_name());
        let found = |name: &str| special.fit.estimate(name).map(Estimate::value);
        let of_law: Vec<&LawParameter> = law.fitted().collect();
        let needed = |row: &Row, parameter: &Parameter| {
            let Place::Law(number) = row.place else { return None };
            let own = of_law[number].parameter().name();
            let (_, value) = case?.needed().iter().find(|(name, _)| *name == own)?;
            Some(parameter.bounds().clamp(*value)).filter(|value| value.is_finite())
        };
        let values = self.table.rows.iter().zip(&self.parameters).zip(start).map(|((row, parameter), start)| {
            let is_level = own_level.as_deref() == Some(parameter.name());
            let counterpart = their_level.as_deref().filter(|_| is_level);
            let needed = || needed(row, parameter);
            let known = found(parameter.name()).or_else(needed).or_else(|| counterpart.and_then(found));
            let missing = || match row.place {
                Place::Law(number) => match of_law[number].role() {
                    Role::LevelAbove | Role::Excess => 0.0,
                    _ => *start,
                },
                Place::Term(_) | Place::Channel(_) => 0.0,
                _ => *start,
            };
            known.unwrap_or_else(missing)
        });
        self.clamped(&values.collect::<Vec<_>>())
    }

    /// Start values that continue a fit of `simple`, which has a level and a viscous part: the same losses, put into
    /// the law in as many ways as it offers.
    pub(crate) fn continued(&self, simple: &Problem<'_>, values: &[f64]) -> Vec<Vec<f64>> {
        let (oscillator, of_law) = (&values[..simple.table.oscillator], &values[simple.table.of_law()]);
        let dissipation = Dissipation { friction: of_law[0], damping: of_law[1] };
        // A damper and Coulomb friction lose the same in a swing if F = π/4 c V.
        let as_friction =
            dissipation.friction + 0.25 * PI * dissipation.damping * 0.5 * reference(&self.experiments).scales().1;
        let all_friction = Dissipation { friction: as_friction, damping: 0.0 };
        let half = Dissipation { friction: as_friction, damping: 0.5 * dissipation.damping };
        let mut starts = Vec::new();
        let sharpnesses: &[f64] =
            if self.law().fitted().any(|parameter| self.law().bends(parameter)) { &[1.0, 8.0, 0.125] } else { &[1.0] };
        for sharpness in sharpnesses {
            let shares = if self.has_linear_damping() { vec![dissipation, half] } else { vec![all_friction] };
            for share in shares {
                let mut start = oscillator.to_vec();
                self.push_dissipation(share, *sharpness, &mut start);
                start.extend_from_slice(&values[simple.table.shared..]);
                starts.extend(self.apart(&start));
            }
        }
        starts
    }

    /// Start values near a fit of `simple`: its losses, put into the law in as many ways as it offers, and friction
    /// that falls with the speed over some share of the largest one.
    pub(crate) fn near(&self, simple: &Problem<'_>, values: &[f64]) -> Vec<Vec<f64>> {
        if self.table.oscillator != simple.table.oscillator || !self.is_elaborate() {
            return self.starts();
        }
        let (oscillator, of_law) = (&values[..simple.table.oscillator], &values[simple.table.of_law()]);
        let dissipation = Dissipation { friction: of_law[0], damping: of_law[1] };
        let falls = if self.law().fitted().any(|parameter| self.law().bends(parameter)) { &FALLS[..] } else { &[0.2] };
        let falling = falls.iter().map(|share| {
            let sharpness = self.law().bend().map_or(1.0, |typical| typical / share);
            let mut start = oscillator.to_vec();
            self.push_dissipation_with(dissipation, sharpness, Some(FALL), &mut start);
            start.extend_from_slice(&values[simple.table.shared..]);
            self.clamped(&start)
        });
        falling.chain(self.continued(simple, values)).collect()
    }

    /// The `start` with values of the law that lie [apart](crate::law::Law::apart), each within its bounds.
    fn apart(&self, start: &[f64]) -> Vec<Vec<f64>> {
        let of_law = self.table.of_law();
        let moved = |law: Vec<f64>| [&start[..of_law.start], &law, &start[of_law.end..]].concat();
        let starts = self.law().apart(&start[of_law.clone()]).into_iter().map(moved);
        starts.map(|start| self.clamped(&start)).collect()
    }

    /// Pushes start values of the damping beside the law and of the law.
    fn push_dissipation(&self, dissipation: Dissipation, sharpness: f64, start: &mut Vec<f64>) {
        self.push_dissipation_with(dissipation, sharpness, None, start);
    }

    /// Like [`push_dissipation`](Self::push_dissipation), with the excess of the friction at rest as a share of the
    /// level, if it is given.
    fn push_dissipation_with(
        &self,
        dissipation: Dissipation,
        sharpness: f64,
        excess: Option<f64>,
        start: &mut Vec<f64>,
    ) {
        let (length, speed) = reference(&self.experiments).scales();
        let Dissipation { friction, damping } = dissipation;
        start.extend(self.terms().iter().map(|term| match term {
            Term::LinearDamping => damping,
            // A run-down shows a drag as damping.
            Term::QuadraticDamping if self.drags() => damping / speed,
            Term::QuadraticDamping | Term::PowerDamping => 0.1 * (damping + friction / speed) / speed,
            Term::CubicDamping => 0.1 * (damping + friction / speed) / (speed * speed),
            Term::PowerExponent => 2.0,
            Term::Stop => 0.5 * length,
            Term::StopRatio => 1.0,
            _ => 0.0,
        }));
        let scales = Scales { length, speed, friction, damping, sharpness };
        start.extend(self.law().fitted().map(|parameter| match (parameter.role(), excess) {
            (Role::Excess | Role::LevelAbove, Some(excess)) => excess * friction,
            (Role::Breakaway, _) => FIRST_STATIC_EXCESS * friction,
            (Role::Level, Some(_)) if is_coefficient(parameter) => friction,
            _ => scales.typical(self.law(), parameter),
        }));
    }

    /// The `start`, each value within its bounds.
    pub(crate) fn clamped(&self, start: &[f64]) -> Vec<f64> {
        start.iter().zip(&self.parameters).map(|(value, parameter)| parameter.bounds().clamp(*value)).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use fmm_fit::{Options, Residuals};

    use super::super::tests::decays;
    use super::*;
    use crate::fit::stages::Begin;
    use crate::identification::Identification;
    use crate::machine::Machine;

    /// A law that becomes another one at some of its values begins with the misfit that this has ended with, or a little
    /// more where bounds keep it from a limit.
    #[test]
    fn a_law_begins_where_its_special_case_has_ended() {
        let decays = decays();
        let problem = |candidate: &Candidate| Problem::of(candidate, Machine::per_unit_mass(), &decays).unwrap();
        let cases = [
            ("coulomb_viscous", "berger+linear", 1e-6),
            ("coulomb_viscous", "stribeck", 1e-6),
            ("coulomb", "power_law", 1e-6),
            ("coulomb_viscous", "exponential_pair+linear", 0.2),
        ];
        for (special, law, rise) in cases {
            let [special, law] = [special, law].map(|name| Candidate::named(name).unwrap());
            assert!(special.is_nested_in(&law), "{} in {}", special.name(), law.name());
            let options = Options::default();
            let ended =
                Identification::of(&problem(&special), Begin::Anywhere, &options, &mut |_| ControlFlow::Continue(()));
            let ended = ended.unwrap();
            // No limit becomes a value where nothing bounds it.
            let unbounded = problem(&law);
            let start = unbounded.nested(&ended.fitted, &unbounded.starts()[0]);
            assert!(start.iter().all(|value| value.is_finite()), "{}: {start:?}", law.name());
            let own = unbounded.bending_in_sight();
            let start = own.nested(&ended.fitted, &own.starts()[0]);
            let mut residuals = vec![0.0; own.len()];
            own.evaluate(&start, &mut residuals, None).unwrap();
            let begun: f64 = residuals.iter().map(|residual| residual * residual).sum();
            let before = ended.fit().sum_of_squares();
            assert!((begun / before - 1.0).abs() < rise, "{}: {begun:e} after {before:e}", law.name());
        }
    }
}
