//! Measured force along a measured motion: joints, tribometers, dampers.

pub(crate) mod direction;
mod loops;
mod measured;
mod onset;
mod smoothed;
mod speed_curve;

use fmm_fit::median_deviation;
use fmm_model::ModelError;

pub use loops::ForceLoop;
pub(crate) use measured::AveragedNoise;
pub use onset::Onset;
pub use speed_curve::SpeedBin;

use crate::error::IdentifyError;
use crate::experiment::force::measured::Measured;
use crate::experiment::force::smoothed::Smoothed;
use crate::law::along::MeasuredMotion;

/// A force (or torque) measured along a motion that something outside prescribes. Samples need not be equally spaced.
///
/// ```
/// use fmm_identify::ForceRecord;
///
/// // Positions in rad, torques in N m; without velocities they follow from the positions.
/// let record = ForceRecord::of_positions(&[0.0, 0.1, 0.25, 0.3], &[0.0, 0.01, 0.04, 0.05], &[0.0, 0.8, 1.1, 1.1])?
///     .in_units("rad", "N m");
/// assert_eq!((record.len(), record.position_unit()), (4, "rad"));
/// assert!((record.velocities()[3] - 0.2).abs() < 1e-12);
/// # Ok::<(), fmm_identify::IdentifyError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ForceRecord {
    pub(crate) motion: MeasuredMotion,
    /// The series behind the motion; none for steady states and for a part of a record.
    measured: Measured,
    pub(crate) forces: Vec<f64>,
    pub(crate) loads: Option<Vec<f64>>,
    /// Channels that were measured beside the force, by name.
    pub(crate) channels: Vec<(String, Vec<f64>)>,
    position_unit: String,
    force_unit: String,
    /// True for steady states, of which neither time nor position is known.
    is_timeless: bool,
}

/// Fewest samples of a record: a parabola through three gives the velocity.
const FEWEST_SAMPLES: usize = 3;
/// Share of the largest speed up to which a contact is taken to rest by default (1).
const REST: f64 = 1e-3;
/// Deviations of the noise of the velocity (1) up to which it may rest: of 20 samples one has another direction beyond.
const REST_BY_NOISE: f64 = 2.0;

impl ForceRecord {
    /// A record of `positions` (m) and `forces` (N) at `times` (s). Noise and steps of the positions are averaged over
    /// as many samples as a cubic follows; velocities and accelerations are the slopes of these cubics. Give measured
    /// ones where there are some.
    ///
    /// # Errors
    /// [`IdentifyError::Contradiction`] if the lists differ in length, [`IdentifyError::OutOfRange`] if the times do
    /// not ascend, [`IdentifyError::TooFew`], [`IdentifyError::InvalidInput`] for a number that is not finite, and
    /// [`IdentifyError::NotSeen`] if nothing moves.
    pub fn of_positions(times: &[f64], positions: &[f64], forces: &[f64]) -> Result<Self, IdentifyError> {
        require_times(times)?;
        require_series(times, positions, "position", "m")?;
        require_series(times, forces, "force", "N")?;
        let positions = Some(Smoothed::of(times, positions));
        Self::along(times, Measured { positions, ..Measured::default() }, forces).moving()
    }

    /// A record of which `velocities` (m/s) were measured beside the `forces` (N) at `times` (s), and no positions:
    /// these are the sum of the velocities, from 0.
    ///
    /// # Errors
    /// Those of [`of_positions`](Self::of_positions).
    pub fn of_velocities(times: &[f64], velocities: &[f64], forces: &[f64]) -> Result<Self, IdentifyError> {
        require_times(times)?;
        require_series(times, velocities, "velocity", "m/s")?;
        require_series(times, forces, "force", "N")?;
        let velocities = Some(Smoothed::of(times, velocities));
        Self::along(times, Measured { velocities, ..Measured::default() }, forces).moving()
    }

    /// A record of steady states without a time: `forces` (N) at `velocities` (m/s), such as a measured Stribeck curve.
    /// Their numbers stand for times, and nothing accelerates. Laws of the speed are fitted to it; a law with internal
    /// state, and a term that depends on time or position, is refused.
    ///
    /// ```
    /// use fmm_identify::{Candidate, ForceRecord, Machine, compare};
    ///
    /// let velocities: Vec<f64> = (1..40).map(|i| 0.01 * f64::from(i)).collect();
    /// let forces: Vec<f64> = velocities.iter().map(|v| 2.0 + 30.0 * v).collect();
    /// let record = ForceRecord::of_speeds(&velocities, &forces)?;
    /// let compared = compare(&Machine::per_unit_mass(), &[record.clone()], &[Candidate::named("coulomb + linear")?])?;
    /// assert!((compared.preferred().finding("friction_force").unwrap().value() - 2.0).abs() < 1e-9);
    /// assert!(compare(&Machine::per_unit_mass(), &[record], &[Candidate::named("dahl")?]).is_err());
    /// # Ok::<(), fmm_identify::IdentifyError>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`of_positions`](Self::of_positions).
    pub fn of_speeds(velocities: &[f64], forces: &[f64]) -> Result<Self, IdentifyError> {
        let times: Vec<f64> = (0..velocities.len()).map(|number| number as f64).collect();
        require_times(&times)?;
        require_series(&times, velocities, "velocity", "m/s")?;
        require_series(&times, forces, "force", "N")?;
        let velocities = Some(Smoothed::plain(&times, velocities.to_vec()));
        let mut record = Self::along(&times, Measured { velocities, ..Measured::default() }, forces).moving()?;
        let nothing = vec![0.0; times.len()];
        (record.motion.positions, record.motion.accelerations) = (nothing.clone(), nothing);
        record.is_timeless = true;
        Ok(record)
    }

    /// Forces along what was `measured` of a motion.
    fn along(times: &[f64], measured: Measured, forces: &[f64]) -> Self {
        let motion = measured.motion(times, 0.0);
        let (position_unit, force_unit) = ("m".to_owned(), "N".to_owned());
        let (forces, loads, channels) = (forces.to_vec(), None, Vec::new());
        Self { motion, measured, forces, loads, channels, position_unit, force_unit, is_timeless: false }
    }

    /// This record with the motion by what was measured of it, and at rest where its speed may be noise alone.
    fn moving(mut self) -> Result<Self, IdentifyError> {
        let times = std::mem::take(&mut self.motion.times);
        self.motion = self.measured.motion(&times, 0.0);
        let largest = self.velocities().iter().fold(0.0, |largest: f64, velocity| largest.max(velocity.abs()));
        ModelError::require_finite("velocity", largest, "m/s")?;
        if largest == 0.0 {
            return Err(IdentifyError::no_motion(self.motion.positions[0], "m"));
        }
        let other = self.measured.noisier(&times);
        let squares = other.velocities.iter().zip(self.velocities()).map(|(a, b)| (a - b).powi(2));
        let noise = (squares.sum::<f64>() / times.len() as f64).sqrt();
        self.motion.rest_speed = (REST * largest).max(REST_BY_NOISE * noise);
        Ok(self)
    }

    /// This record with measured `velocities` (m/s), of which noise and steps are averaged as those of the positions;
    /// accelerations are the slopes of their cubics.
    ///
    /// # Errors
    /// Those of [`of_positions`](Self::of_positions), and [`IdentifyError::Contradiction`] for velocities that go with
    /// the slope of the positions, but are more than three times or less than a third of it, or of the other sign.
    pub fn with_velocities(mut self, velocities: &[f64]) -> Result<Self, IdentifyError> {
        require_series(&self.motion.times, velocities, "velocity", "m/s")?;
        self.require_slope(velocities)?;
        self.measured.velocities = Some(Smoothed::of(self.times(), velocities));
        self.moving()
    }

    /// Refuses velocities that are another multiple of the slope of the positions than noise and drift can make of
    /// them.
    fn require_slope(&self, velocities: &[f64]) -> Result<(), IdentifyError> {
        /// Correlation of both from which on the multiple tells.
        const ALIKE: f64 = 0.9;
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let slopes = &self.motion.velocities;
        let (both, square) = (product(velocities, slopes), product(slopes, slopes));
        let ratio = both / square;
        let is_alike = both.abs() > ALIKE * (square * product(velocities, velocities)).sqrt();
        if is_alike && !(1.0 / 3.0..=3.0).contains(&ratio) {
            return Err(IdentifyError::contradiction(format!(
                "the velocities are {ratio:.3} times the slope of the positions; state both in units and signs that \
                 belong together"
            )));
        }
        Ok(())
    }

    /// This record with measured `accelerations` (m/s²), their noise averaged.
    ///
    /// # Errors
    /// Those of [`of_positions`](Self::of_positions).
    pub fn with_accelerations(mut self, accelerations: &[f64]) -> Result<Self, IdentifyError> {
        require_series(&self.motion.times, accelerations, "acceleration", "m/s²")?;
        self.measured.accelerations = Some(Smoothed::of(self.times(), accelerations));
        self.moving()
    }

    /// This record with a measured normal load (N) at every sample, so that the levels of a law are coefficients.
    ///
    /// # Errors
    /// Those of [`of_positions`](Self::of_positions), and for a load that is negative or zero throughout.
    pub fn under_loads(mut self, loads: &[f64]) -> Result<Self, IdentifyError> {
        require_series(&self.motion.times, loads, "normal load", "N")?;
        for load in loads {
            ModelError::require_not_negative("normal load", *load, "N")?;
        }
        let largest = loads.iter().fold(0.0, |largest: f64, load| largest.max(*load));
        ModelError::require_positive("largest normal load", largest, "N")?;
        self.loads = Some(loads.to_vec());
        Ok(self)
    }

    /// This record with `values` of a channel called `name` that was measured beside the force, of which the force
    /// holds a share: the actuator of a brake, the other end of a band, a second load cell. Hum and noise are averaged
    /// over `seconds` around each sample, by the cubic of least squares; with 0 the values stay as they are. Noise that
    /// is left in them makes shares a little too small.
    ///
    /// # Errors
    /// Those of [`of_positions`](Self::of_positions), and [`IdentifyError::Contradiction`] for a name that is there or
    /// a time that is neither 0 nor between five samples and the whole record.
    pub fn with_channel(mut self, name: &str, values: &[f64], seconds: f64) -> Result<Self, IdentifyError> {
        require_series(&self.motion.times, values, "channel", "of a force")?;
        if self.channels.iter().any(|(other, _)| other == name) {
            return Err(IdentifyError::contradiction(format!("there is a channel called {name:?} already")));
        }
        let values = if seconds == 0.0 {
            values.to_vec()
        } else {
            let width = (0.5 * seconds / self.interval()).round() as usize;
            let refused = || {
                IdentifyError::contradiction(format!(
                    "a channel cannot be averaged over {seconds} s in a record of {} samples every {} s",
                    self.len(),
                    self.interval()
                ))
            };
            Smoothed::by_cubics(&self.motion.times, values, width).ok_or_else(refused)?.values
        };
        self.channels.push((name.to_owned(), values));
        Ok(self)
    }

    /// This record taken to be at rest up to `speed` (m/s), where a law that leaps has no value of friction. The
    /// default is a thousandth of the largest speed.
    ///
    /// # Errors
    /// [`IdentifyError::InvalidInput`] if the speed is negative or not finite.
    pub fn resting_up_to(mut self, speed: f64) -> Result<Self, IdentifyError> {
        self.motion.rest_speed = ModelError::require_not_negative("speed of rest", speed, "m/s")?;
        Ok(self)
    }

    /// This record in other units than m and N, such as `"rad"` and `"N m"`: the numbers stay as they are.
    #[must_use]
    pub fn in_units(mut self, position: &str, force: &str) -> Self {
        (self.position_unit, self.force_unit) = (position.to_owned(), force.to_owned());
        self
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.motion.times.len()
    }

    /// True for a record without samples, which cannot be made.
    pub fn is_empty(&self) -> bool {
        self.motion.times.is_empty()
    }

    /// Times (s).
    pub fn times(&self) -> &[f64] {
        &self.motion.times
    }

    /// Positions (m, or the unit given).
    pub fn positions(&self) -> &[f64] {
        &self.motion.positions
    }

    /// Velocities (m/s, or by the unit given), measured or of the positions.
    pub fn velocities(&self) -> &[f64] {
        &self.motion.velocities
    }

    /// Forces (N, or the unit given).
    pub fn forces(&self) -> &[f64] {
        &self.forces
    }

    /// Unit of the positions.
    pub fn position_unit(&self) -> &str {
        &self.position_unit
    }

    /// Unit of the forces.
    pub fn force_unit(&self) -> &str {
        &self.force_unit
    }

    /// True for steady states without a time, [`of_speeds`](Self::of_speeds).
    pub fn is_timeless(&self) -> bool {
        self.is_timeless
    }

    /// Refuses the record beside others whose positions and forces are in these `units`.
    pub(crate) fn require_units(&self, units: [&str; 2]) -> Result<(), IdentifyError> {
        let own = [self.position_unit(), self.force_unit()];
        if own == units {
            return Ok(());
        }
        let [[position, force], [own_position, own_force]] = [units, own];
        Err(IdentifyError::wrong_record(format!(
            "the records are in different units: {position} and {force} beside {own_position} and {own_force}"
        )))
    }

    /// Standard deviation of what differs between neighbouring samples of the force, in its unit: its noise, or a step
    /// of its converter.
    pub(crate) fn noise(&self) -> f64 {
        // Of white noise a second difference has √6 times the deviation; of a median the deviation is 1.4826 times.
        let bends: Vec<f64> = self.forces.windows(3).map(|f| f[0] - 2.0 * f[1] + f[2]).collect();
        median_deviation(&bends, 0).unwrap_or(0.0) / 6.0_f64.sqrt()
    }

    /// The largest noise of its motion that was averaged; `None` if there was none.
    pub(crate) fn noise_of_motion(&self) -> Option<AveragedNoise> {
        self.measured.noise()
    }

    /// This record along the motions that its own could be as well, by the noise of what was measured of it, each with
    /// the weight (1) of its effects in a standard uncertainty; steady states have none.
    pub(crate) fn along_others(&self) -> Vec<(f64, Self)> {
        if self.is_timeless {
            return Vec::new();
        }
        let others = self.measured.others(self.times(), self.motion.rest_speed);
        others.into_iter().map(|(weight, motion)| (weight, Self { motion, ..self.clone() })).collect()
    }

    /// The time (s) between two samples, in the mean.
    pub(crate) fn interval(&self) -> f64 {
        (self.motion.times[self.len() - 1] - self.motion.times[0]) / (self.len() - 1) as f64
    }

    /// Its first quarter, if that is long enough to show several reversals; `None` otherwise.
    pub(crate) fn beginning(&self) -> Option<Self> {
        /// Fewest samples of a beginning,
        const FEWEST: usize = 2000;
        /// and fewest periods in it.
        const PERIODS: f64 = 2.0;
        let count = self.len() / 4;
        let cut = |values: &[f64]| values[..count].to_vec();
        let part = (count >= FEWEST).then(|| Self {
            motion: MeasuredMotion {
                times: cut(&self.motion.times),
                positions: cut(&self.motion.positions),
                velocities: cut(&self.motion.velocities),
                accelerations: cut(&self.motion.accelerations),
                rest_speed: self.motion.rest_speed,
            },
            measured: Measured::default(),
            forces: cut(&self.forces),
            loads: self.loads.as_deref().map(cut),
            channels: self.channels.iter().map(|(name, values)| (name.clone(), cut(values))).collect(),
            ..self.clone()
        })?;
        (part.period() * PERIODS <= count as f64).then_some(part)
    }

    /// The time (samples) from a reversal to the next but one, in the mean; all of it if there is none.
    pub(crate) fn period(&self) -> f64 {
        let moving = self.motion.velocities.iter().filter(|velocity| velocity.abs() > self.motion.rest_speed);
        let (mut reversals, mut before) = (0_u32, 0.0);
        for velocity in moving {
            reversals += u32::from(velocity * before < 0.0);
            before = *velocity;
        }
        2.0 * self.len() as f64 / f64::from(reversals + 1)
    }
}

/// Standard deviation of the forces of all `records`, in their unit; of motions that all go one way, where friction is
/// in the mean force, the root mean square.
pub(crate) fn deviation(records: &[ForceRecord]) -> f64 {
    let forces = || records.iter().flat_map(ForceRecord::forces);
    let count = forces().count() as f64;
    let mean = if records.iter().all(ForceRecord::goes_one_way) { 0.0 } else { forces().sum::<f64>() / count };
    (forces().map(|force| (force - mean).powi(2)).sum::<f64>() / count).sqrt()
}

fn require_times(times: &[f64]) -> Result<(), IdentifyError> {
    if times.len() < FEWEST_SAMPLES {
        return Err(IdentifyError::too_short(times.len(), FEWEST_SAMPLES));
    }
    ModelError::require_finite("time", times[0], "s")?;
    match times.windows(2).find(|pair| !(pair[1] > pair[0] && pair[1].is_finite())) {
        Some(pair) => {
            Err(IdentifyError::not_allowed("the time (s) of a sample", pair[1], &format!("after {} s", pair[0])))
        }
        None => Ok(()),
    }
}

fn require_series(
    times: &[f64],
    values: &[f64],
    quantity: &'static str,
    unit: &'static str,
) -> Result<(), IdentifyError> {
    if values.len() != times.len() {
        return Err(IdentifyError::contradiction(format!(
            "there are {} times, but {} values of {quantity}; give one for each",
            times.len(),
            values.len()
        )));
    }
    for value in values {
        ModelError::require_finite(quantity, *value, unit)?;
    }
    Ok(())
}
