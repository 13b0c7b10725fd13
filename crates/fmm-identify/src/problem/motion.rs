//! Motion that the rows of a table describe.

use fmm_fit::EvaluationError;
use fmm_model::{Damping, Oscillator, Scalar};
use fmm_sim::Excitation;

use crate::experiment::Experiment;
use crate::law::Motion;
use crate::law::naming::Form;
use crate::machine::term::Term;
use crate::machine::{Machine, Scale};
use crate::quantities::rows::Place;
use crate::quantities::table::{Table, mass_of_stiffness};

impl Table {
    /// The mass (kg) by the shared `values`, where the `machine` or the motion tells it.
    pub(crate) fn mass<D: Scalar>(&self, machine: &Machine, values: &[D]) -> Option<D> {
        let fitted = |place| self.shared(place).map(|index| values[index]);
        match machine.scale() {
            _ if !self.is_per_mass() => fitted(Place::Mass),
            Scale::Mass(known) => Some(fitted(Place::Mass).unwrap_or(D::from(known.value()))),
            Scale::Stiffness(known) => {
                let stiffness = fitted(Place::Stiffness).unwrap_or(D::from(known.value()));
                Some(mass_of_stiffness(stiffness, values[0]))
            }
            _ => None,
        }
    }

    /// The motion of one `experiment`, of the shared `values` with its own behind them, in the order of the rows.
    pub(crate) fn motion<D: Scalar>(
        &self,
        machine: &Machine,
        record: usize,
        experiment: &Experiment,
        values: &[D],
    ) -> Result<Motion<D>, EvaluationError> {
        let fitted = |place| self.shared(place).map(|index| values[index]);
        let mass = self.mass(machine, values);
        let oscillator = match self.form {
            Form::PerMass => match fitted(Place::Frequency) {
                Some(frequency) => Oscillator::per_unit_mass(frequency)?,
                None => Oscillator::new(D::from(1.0), D::from(0.0))?,
            },
            _ => Oscillator::new(values[0], values[1])?,
        };
        let known = machine.damping().map(|damping| D::from(damping.value()));
        let damping = fitted(Place::MachineDamping).or(known).unwrap_or(D::from(0.0));
        let damping = mass.filter(|_| self.is_per_mass()).map_or(damping, |mass| damping / mass);
        let beside = |term: Term| fitted(Place::Term(term));
        let per_mass = |term: Term| beside(term).map_or(D::from(0.0), |value| value * oscillator.mass());
        let damping = beside(Term::LinearDamping).map_or(damping, |linear| damping + linear * oscillator.mass());
        let quadratic = fitted(Place::QuadraticDamping).unwrap_or(D::from(0.0)) + per_mass(Term::QuadraticDamping);
        let mut damping = Damping::of_any_sign(damping, quadratic)?;
        if self.terms.has(Term::CubicDamping) {
            damping = damping.with_cubic(per_mass(Term::CubicDamping))?;
        }
        if let Some(exponent) = beside(Term::PowerExponent) {
            damping = damping.with_power(per_mass(Term::PowerDamping), exponent)?;
        }
        if let Some(wind) = fitted(Place::Wind) {
            damping = damping.with_wind(wind)?;
        }
        let own = |place| self.own(record, place).map(|index| values[index - self.own[record] + self.shared]);
        let force = match experiment.drive() {
            None => fitted(Place::Slope).map(Excitation::constant).transpose()?,
            Some(drive) => {
                let one = D::from(1.0);
                let mut per = match (drive.is_force(), self.is_per_mass()) {
                    (true, true) => mass.map_or(one, |mass| one / mass),
                    (true, false) => one,
                    (false, _) => oscillator.mass(),
                };
                if let Some(gain) = own(Place::DriveGain) {
                    per /= gain;
                }
                let known = D::from(experiment.sensor().delay());
                let delay = own(Place::Delay).map_or(known, |delay| delay + known);
                Some(drive.excitation(experiment.record().start(), delay, per)?)
            }
        };
        let change = beside(Term::Change).map(|change| changing(experiment, change, beside(Term::CurvedChange)));
        let load = fitted(Place::NormalLoad).unwrap_or(D::from(1.0));
        // N (1 + β (x² − ⟨x²⟩)) as a load in the middle and its curvature.
        let in_middle = beside(Term::Position).map(|curvature| D::from(1.0) - curvature * self.deflections.mean_square);
        let curvature = beside(Term::Position).zip(in_middle).map(|(curvature, middle)| curvature / middle);
        let load = in_middle.map_or(load, |middle| load * middle);
        Ok(Motion {
            oscillator: oscillator
                .with_damping(damping)
                .with_restoring(self.terms.spring(machine.restoring(), beside)?),
            law: self.family.values(&values[self.of_law()]),
            normal_load: load * experiment.load_factor(),
            change,
            curvature,
            initial: [Place::Position, Place::Velocity].map(|place| own(place).unwrap_or(D::from(0.0))),
            force,
            tolerance: None,
        })
    }
}

/// Straight pieces of a load that changes, which are within 1e-4 of an exponential of 0.8 over them.
const PIECES: usize = 24;

/// Distance in time (s) of load factors (1), and these over their mean on the path slid, for a `change` (1/s) that
/// slows down at a rate of `slowing` (1/s):
///
/// ```text
/// exp(w τ φ(r τ)),     φ(x) = (1 − e⁻ˣ)/x,     τ = t − ⟨t⟩
/// ```
fn changing<D: Scalar>(experiment: &Experiment, change: D, slowing: Option<D>) -> (f64, Vec<D>) {
    let shares = experiment.path_shares();
    let mean_time: f64 = shares.iter().map(|(time, share)| time * share).sum();
    let factor = |time: f64| {
        let time = time - mean_time;
        let linear = change * time;
        slowing.map_or(linear, |slowing| linear * slowed(slowing * time)).exp()
    };
    let mean = shares.iter().fold(D::from(0.0), |sum, (time, share)| sum + factor(*time) * *share);
    let end = shares.last().map_or(0.0, |(time, _)| *time) + experiment.guess.frequency().recip();
    let interval = end / PIECES as f64;
    (interval, (0..=PIECES).map(|piece| factor(piece as f64 * interval) / mean).collect())
}

/// φ(x) = (1 − e⁻ˣ)/x, near zero by its series.
fn slowed<D: Scalar>(x: D) -> D {
    /// |x| below which five terms of the series are exact to 1e-12 (1).
    const SMALL: f64 = 0.01;
    if x.value().abs() < SMALL {
        return [120.0, -24.0, 6.0, -2.0, 1.0].into_iter().fold(D::from(0.0), |sum, by: f64| sum * x + by.recip());
    }
    (D::from(1.0) - (-x).exp()) / x
}
