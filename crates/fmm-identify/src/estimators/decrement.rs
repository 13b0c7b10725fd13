//! Damping and friction from the decrement of the amplitudes, cycle by cycle.

use std::f64::consts::PI;

use fmm_record::{Peak, Quantity};

use crate::error::IdentifyError;
use crate::experiment::Experiment;
use fmm_model::Estimated;

/// What one cycle lost, read both as damping and as friction.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Decrement {
    /// Time of the middle of the cycle (s), on the time axis of the record.
    pub time: f64,
    /// V, peak velocity of the cycle: the geometric mean of the amplitudes before and after it (unit of the record, or
    /// that per second for a displacement).
    pub peak_velocity: f64,
    /// δ, logarithmic decrement (1).
    pub logarithmic: Estimated,
    /// c/m (1/s) if all of the loss is viscous.
    pub damping: Estimated,
    /// F/m if all of the loss is dry friction (unit of `peak_velocity` per second).
    pub friction: Estimated,
}

/// Half swings that a decrement needs: an amplitude is half the distance of two turning points, and two are compared.
const FEWEST: usize = 4;

/// The decrement of each cycle of `decay`, from peaks that are fitted by sines through all samples near them
/// ([`Swings`](fmm_record::Swings)).
///
/// ```text
/// A_j = |e_{j+1} − e_j|/2                   amplitude between two turning points e: no offset
/// δ   = ln(A_j/A_{j+2}),      T from their times
/// c/m = 2 δ/T                               viscous: equal ratios
/// F/m = π (V_j − V_{j+2})/(2 T)             dry friction: equal differences; V = A, or 2π A/T of a displacement
/// u(e) = 1.5 σ/√n                           σ white noise of the record, n samples within ±1/12 period
/// ```
///
/// For viscous damping the first is the same at all amplitudes, for dry friction the second is. A damping with a
/// quadratic part gives a line in V, see [`Damping::cycle_equivalent`](fmm_model::Damping::cycle_equivalent).
///
/// Cycles follow each other without a gap. Neighbours share an amplitude, so the errors of their decrements have a
/// correlation of −1/2. The uncertainty is that of the noise; slow disturbances and a gain that is not linear add to
/// it.
///
/// ```
/// use fmm_friction::Viscous;
/// use fmm_identify::{Preparation, Experiment, decrements};
/// # use fmm_model::Oscillator;
/// # use fmm_record::{Quantity, Record};
/// # use fmm_sim::{Engine, Exact, Sampling, Scenario};
///
/// // A velocity record of a machine with c/m = 0.05 1/s.
/// # let scenario = Scenario::new(Oscillator::per_unit_mass(2.0)?, Viscous::new(0.05)?, 1.0)?;
/// # let motion = Exact.run(&scenario.starting_at(0.02, 0.0)?, &Sampling::uniform(1e-3, 10_000)?)?;
/// # let record = Record::new(0.0, 1e-3, motion.velocity().values().to_vec(), Quantity::Velocity, "m/s")?;
/// let decay = Experiment::ring_down(&record, &Preparation::default())?;
/// let cycles = decrements(&decay)?;
/// assert!(cycles.iter().all(|cycle| (cycle.damping.value / 0.05 - 1.0).abs() < 1e-3));
/// // Dry friction would not grow weaker from cycle to cycle: e^(−0.025 · 7.5) = 0.83.
/// assert!((cycles[15].friction.value / cycles[0].friction.value - 0.83).abs() < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// The line through them is [`StraightLine`](fmm_fit::StraightLine); for quadratic damping its intercept is c₁/m and
/// its slope 8/(3π) c₂/m:
///
/// ```
/// use std::f64::consts::PI;
///
/// use fmm_fit::{StraightLine, Weighting};
/// use fmm_identify::{Preparation, Experiment, decrements};
/// use fmm_model::{Damping, Oscillator};
/// # use fmm_friction::Coulomb;
/// # use fmm_record::{Quantity, Record};
/// # use fmm_sim::{Engine, RungeKutta, Sampling, Scenario};
///
/// // A velocity record of a machine with c = 0.2005 + 0.5148 |v|.
/// let machine = Oscillator::new(10.391, 1982.0)?.with_damping(Damping::new(0.2005, 0.5148)?);
/// # let scenario = Scenario::new(machine, Coulomb::new(0.0)?, 0.0)?.starting_at(0.0, 0.25)?;
/// # let motion = RungeKutta::new(1e-11)?.run(&scenario, &Sampling::uniform(1e-3, 30_000)?)?;
/// # let record = Record::new(0.0, 1e-3, motion.velocity().values().to_vec(), Quantity::Velocity, "m/s")?;
/// let cycles = decrements(&Experiment::ring_down(&record, &Preparation::default())?)?;
/// let velocity: Vec<f64> = cycles.iter().map(|cycle| cycle.peak_velocity).collect();
/// let damping: Vec<f64> = cycles.iter().map(|cycle| 10.391 * cycle.damping.value).collect();
/// let line = StraightLine::fit(&velocity, &damping, Weighting::Equal)?;
/// assert!((line.intercept() / 0.2005 - 1.0).abs() < 0.01);
/// assert!((line.slope() / (8.0 / (3.0 * PI) * 0.5148) - 1.0).abs() < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`IdentifyError::TooFew`] below four, [`IdentifyError::NotSeen`] where turning points do not alternate.
pub fn decrements(decay: &Experiment) -> Result<Vec<Decrement>, IdentifyError> {
    decay.require_free("the decrement")?;
    let peaks = decay.peaks();
    if peaks.len() < FEWEST {
        return Err(IdentifyError::too_few_half_swings(peaks.len(), FEWEST));
    }
    let displacement = decay.record().quantity() == Quantity::Displacement;
    let rising = (peaks[1].1 - peaks[0].1).signum();
    let mut amplitudes = Vec::with_capacity(peaks.len() - 1);
    for (j, pair) in peaks.windows(2).enumerate() {
        let [(from, first), (to, second)] = [pair[0], pair[1]];
        let sign = if j.is_multiple_of(2) { rising } else { -rising };
        let (time, amplitude) = (f64::midpoint(from, to), 0.5 * sign * (second - first));
        if !(amplitude > 0.0 && amplitude.is_finite()) {
            return Err(IdentifyError::amplitude(time, amplitude, decay.record().unit()));
        }
        amplitudes.push((time, amplitude));
    }
    // Half the difference of two turning points scatters by 1/√2 of one.
    let u = decay.turning_point_uncertainty() / 2f64.sqrt();
    let starts = amplitudes.iter().step_by(2).zip(amplitudes.iter().skip(2).step_by(2));
    let decrement = |((begin, before), (end, after)): (&(f64, f64), &(f64, f64))| {
        let period = end - begin;
        let to_velocity = if displacement { 2.0 * PI / period } else { 1.0 };
        let logarithmic = Estimated { value: (before / after).ln(), uncertainty: (u / before).hypot(u / after) };
        let loss = Estimated { value: before - after, uncertainty: u * 2f64.sqrt() };
        Decrement {
            time: f64::midpoint(*begin, *end),
            peak_velocity: to_velocity * (before * after).sqrt(),
            logarithmic,
            damping: logarithmic.scaled(2.0 / period),
            friction: loss.scaled(0.5 * PI * to_velocity / period),
        }
    };
    Ok(starts.map(decrement).collect())
}

impl Experiment {
    /// Standard deviation of what cannot be fitted: white noise and the rounding of the converter, in the unit of the
    /// record.
    pub(crate) fn white_noise(&self) -> f64 {
        self.summary().noise.hypot(self.summary().resolution.unwrap_or(0.0) / 12f64.sqrt())
    }

    /// u(e) of a fitted turning point, in the unit of the record.
    pub(crate) fn turning_point_uncertainty(&self) -> f64 {
        Peak::standard_uncertainty(self.white_noise(), self.summary().rate / self.summary().frequency)
    }
}
