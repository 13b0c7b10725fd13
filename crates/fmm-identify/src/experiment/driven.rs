//! Driven motion: the response to a measured force or a measured motion of the base.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use fmm_model::ModelError;
use fmm_record::{Examination, Quantity, Record};

use super::{Drive, Driven, Experiment, ring_down, usable};
use crate::error::IdentifyError;
use crate::experiment::first_guess::{Dissipation, FirstGuess};
use crate::experiment::{Offset, Preparation, RecordSummary};
use crate::linear_algebra::Span;

impl Experiment {
    /// A driven motion: the `response` of the machine to `drive`, both on one time axis. The drive must be known during
    /// all of the response.
    ///
    /// A static level of its own, which a ring-down does not tell, is fitted as soon as an experiment is driven.
    ///
    /// ```
    /// use fmm_friction::CoulombViscous;
    /// use fmm_identify::{Drive, Experiment, Machine, Preparation, identify};
    /// # use fmm_model::Oscillator;
    /// # use fmm_record::{Quantity, Record};
    /// # use fmm_sim::{Engine, Exact, Excitation, Sampling, Scenario};
    ///
    /// // A force (N) and the velocity that answers it, at 1 kHz; here simulated ones.
    /// # let force: Vec<f64> = (0..3000).map(|i| 12.0 * (0.011 * f64::from(i)).sin()).collect();
    /// # let scenario = Scenario::new(Oscillator::new(10.391, 1982.0)?, CoulombViscous::new(0.25, 0.1)?, 14.0)?;
    /// # let scenario = scenario.driven_by(Excitation::sampled_force(1e-3, force.clone())?);
    /// # let motion = Exact.run(&scenario, &Sampling::uniform(1e-3, 3000)?)?;
    /// # let velocity = motion.velocity().values().to_vec();
    /// let force = Record::new(0.0, 1e-3, force, Quantity::Force, "N")?;
    /// let response = Record::new(0.0, 1e-3, velocity, Quantity::Velocity, "m/s")?;
    ///
    /// let experiment = Experiment::driven(&response, Drive::force(&force)?, &Preparation::default())?;
    /// // A measured force tells mass and stiffness as well.
    /// let found = identify::<CoulombViscous>(&Machine::unknown(), &[experiment])?;
    /// assert!((found.finding("mass").unwrap().value() - 10.391).abs() < 1e-6);
    /// assert!((found.finding("friction_force").unwrap().value() - 3.5).abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`IdentifyError::WrongRecord`] for a response that is neither displacement nor velocity,
    /// [`IdentifyError::TooFew`], and [`IdentifyError::NotSeen`] if the drive does not last as long, nothing moves, or
    /// the offset is to be that of a rest.
    pub fn driven(response: &Record, drive: Drive, preparation: &Preparation) -> Result<Self, IdentifyError> {
        let quantity = response.quantity();
        if !matches!(quantity, Quantity::Displacement | Quantity::Velocity) {
            let (subject, needed) = ("the response of a driven machine", "a displacement or a velocity");
            return Err(IdentifyError::wrong_quantity(subject, needed, quantity));
        }
        let (record, gain_uncertainty, clock_uncertainty) = usable(response, preparation)?;
        let first = record.values()[0];
        drive.require_within(record.start(), record.end())?;
        let held_offset = match preparation.offset {
            Offset::Fitted => None,
            Offset::Rest => return Err(IdentifyError::no_rest()),
            Offset::Fixed(value) => Some(ModelError::require_finite("offset", value, "in the unit of the record")?),
        };
        let examination = Examination::of(record);
        let (record, spikes) = (examination.record(), examination.spikes());
        let kept = ring_down::without(record.len(), spikes.iter().map(|spike| spike.index..spike.index + spike.count));
        let swings = examination.swings();
        let mean = record.mean();
        let amplitude = record.values().iter().fold(0.0f64, |most, value| most.max((value - mean).abs()));
        // A ramp does not oscillate; its whole duration stands for half a period.
        let frequency = swings.frequency().unwrap_or(0.5 / record.duration());
        let noise = examination.noise();
        let mut values = drive.values_from(record.start(), 0.0);
        values.resize(values.len().max(record.len()), 0.0);
        let guess = DrivenGuess::of(record, &drive, &values, frequency, noise);
        let summary = RecordSummary {
            samples: kept.iter().map(Range::len).sum(),
            held_offset,
            gain_uncertainty,
            clock_uncertainty,
            half_swings: swings.peaks().len(),
            amplitudes: (amplitude, amplitude),
            resolution: examination.resolution(),
            spikes: spikes.iter().map(|spike| spike.count).sum(),
            saturation: examination.saturation(),
            is_driven: true,
            ..RecordSummary::unseen(record, frequency, noise)
        };
        let guess_of_response = FirstGuess::of_driven(frequency, mean, amplitude, first, quantity);
        let peaks = swings.peaks().iter().map(|peak| (peak.time, peak.value)).collect();
        Ok(Self {
            peaks,
            driven: Some(Driven { drive, guess, is_at_rest: false }),
            ..Self::bare(examination.into_record(), kept, guess_of_response, summary)
        })
    }
}

/// Start values of a driven motion: the equation of motion in its weak form, by linear least squares.
///
/// ```text
/// m ∫w x″ + c ∫w x′ + k ∫w x + F ∫w sgn x′ + κ ∫w = ∫w f        w = sin² πτ on overlapping windows
/// ```
///
/// Integration by parts moves the derivatives to w. κ stands for the offset of a displacement, or for the unknown
/// position at the beginning of a velocity. Of a base, f is its acceleration with the sign reversed and m is 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DrivenGuess {
    /// m (kg); 1 of a base.
    pub(crate) mass: f64,
    /// Natural frequency (Hz).
    pub(crate) frequency: f64,
    /// c/m (1/s).
    pub(crate) damping: f64,
    /// F/m (unit of acceleration).
    pub(crate) friction: f64,
    /// Position and velocity at the first sample.
    pub(crate) initial: (f64, f64),
    /// Offset of the record, in its unit.
    pub(crate) offset: f64,
    /// Largest speed.
    speed: f64,
    /// First value of the record, and whether that is a position.
    first: f64,
    tells_position: bool,
}

/// Overlapping windows in a record at least, and windows in a period.
const WINDOWS: f64 = 24.0;
const WINDOWS_PER_PERIOD: f64 = 1.5;

impl DrivenGuess {
    fn of(record: &Record, drive: &Drive, force: &[f64], frequency: f64, noise: f64) -> Self {
        let interval = record.interval();
        let is_displacement = record.quantity() == Quantity::Displacement;
        let values = record.values();
        let position: Vec<f64> = if is_displacement {
            values.to_vec()
        } else {
            let mut sum = 0.0;
            let mut before = values[0];
            let integrate = |value: &f64| {
                sum += 0.5 * interval * (before + value);
                before = *value;
                sum
            };
            values.iter().map(integrate).collect()
        };
        let force_at = |index: usize| {
            let place = index as f64 * interval / drive.record().interval();
            let (first, share) = (place.floor() as usize, place.fract());
            let at = |index: usize| force.get(index).or(force.last()).copied().unwrap_or(0.0);
            at(first) + share * (at(first + 1) - at(first))
        };
        let length = (record.duration() / WINDOWS).min(1.0 / (WINDOWS_PER_PERIOD * frequency));
        let samples = ((length / interval) as usize).clamp(8.min(values.len() / 2), values.len() - 1);
        let slowest = 3.0 * noise;
        // Columns: inertia, damping, stiffness, friction, constant, force.
        let mut columns: [Vec<f64>; 6] = std::array::from_fn(|_| Vec::new());
        let mut begin = 0;
        while begin + samples < values.len() {
            let mut sums = [0.0; 6];
            for k in 0..=samples {
                let tau = PI * k as f64 / samples as f64;
                let per_time = PI / (samples as f64 * interval);
                let (w, slope, bend) =
                    (tau.sin().powi(2), per_time * (2.0 * tau).sin(), 2.0 * per_time * per_time * (2.0 * tau).cos());
                let x = position[begin + k];
                let direction = if is_displacement {
                    let (low, high) = ((begin + k).saturating_sub(2), (begin + k + 2).min(values.len() - 1));
                    let change = values[high] - values[low];
                    if change.abs() > slowest { change.signum() } else { 0.0 }
                } else if values[begin + k].abs() > slowest {
                    values[begin + k].signum()
                } else {
                    0.0
                };
                let terms = [bend * x, -slope * x, w * x, w * direction, w, w * force_at(begin + k)];
                sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term * interval);
            }
            columns.iter_mut().zip(sums).for_each(|(column, sum)| column.push(sum));
            begin += (samples / 4).max(1);
        }
        let found = solved(&columns, drive.is_force());
        let [mass, damping, stiffness, friction, constant] = found;
        let plausible = TAU * frequency;
        let per_mass = |value: f64| if mass > 0.0 { value / mass } else { value };
        let stiffness = per_mass(stiffness);
        let angular = if stiffness > 0.0 { stiffness.sqrt() } else { plausible };
        let shift = per_mass(constant) / (angular * angular);
        let velocity = if is_displacement { (values[1] - values[0]) / interval } else { values[0] };
        let most = values.iter().fold(0.0f64, |most, value| most.max((value - values[0]).abs()));
        let speed = if is_displacement { plausible * most } else { most };
        let (initial, offset) = if is_displacement { (values[0] + shift, -shift) } else { (shift, 0.0) };
        Self {
            mass: if mass > 0.0 { mass } else { 1.0 },
            frequency: angular / TAU,
            damping: per_mass(damping).max(0.0),
            friction: per_mass(friction).max(0.0),
            initial: (initial, velocity),
            offset,
            speed,
            first: values[0],
            tells_position: is_displacement,
        }
    }

    /// Start values of an experiment that has no record yet.
    pub(super) fn planned(frequency: f64) -> Self {
        Self {
            mass: 1.0,
            frequency,
            damping: 0.0,
            friction: 0.0,
            initial: (0.0, 0.0),
            offset: 0.0,
            speed: 0.0,
            first: 0.0,
            tells_position: false,
        }
    }

    /// The same begun at rest where the spring is free of force.
    pub(crate) fn neutral(&self) -> Self {
        let offset = if self.tells_position { self.first } else { 0.0 };
        Self { initial: (0.0, 0.0), offset, ..*self }
    }

    /// Losses to begin a fit with: those found, all of them as friction, and all of them as damping.
    pub(crate) fn hypotheses(&self) -> Vec<Dissipation> {
        let Self { damping, friction, frequency, .. } = *self;
        let speed = self.speed.max(f64::MIN_POSITIVE);
        // A damper and Coulomb friction lose the same in a swing if F = π/4 c V.
        let equivalent = 0.25 * PI * speed;
        let least = 0.01 * TAU * frequency;
        vec![
            Dissipation { damping, friction },
            Dissipation { damping: 0.0, friction: friction + equivalent * damping },
            Dissipation { damping: (damping + friction / equivalent).max(least), friction: 0.0 },
        ]
    }
}

/// m, c, k, F and κ; m is 1 unless the force tells it.
fn solved(columns: &[Vec<f64>; 6], tells_mass: bool) -> [f64; 5] {
    let known = usize::from(!tells_mass);
    let unknowns = &columns[known..5];
    let rest: Vec<f64> = if tells_mass {
        columns[5].clone()
    } else {
        columns[5].iter().zip(&columns[0]).map(|(force, inertia)| force - inertia).collect()
    };
    let mut found = [1.0; 5];
    found[known..].copy_from_slice(&Span::of(unknowns.to_vec()).steps(&rest));
    found
}
