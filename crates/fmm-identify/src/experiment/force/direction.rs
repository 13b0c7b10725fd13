//! Sign of a measured force, and the ways in which its contact goes.

use crate::experiment::force::speed_curve::median;
use crate::experiment::force::{ForceRecord, deviation};

/// Share of the deviation of the force (1) from which on negative friction is no matter of noise or time: the force of
/// a spring that is seen early by a hundredth of a period makes 0.07.
const DRIVING: f64 = 0.1;

impl ForceRecord {
    /// This record with all forces of the other sign: those that drive the contact in place of those by which it
    /// reacts, or the other way round.
    ///
    /// ```
    /// use fmm_identify::ForceRecord;
    ///
    /// let (times, velocities) = ([0.0, 0.1, 0.2, 0.3], [0.1, 0.2, -0.2, -0.1]);
    /// let reaction = ForceRecord::of_velocities(&times, &velocities, &[-3.0, -3.0, 3.0, 3.0])?;
    /// assert_eq!(reaction.driving_friction(), Some(-3.0));
    /// assert_eq!(reaction.with_turned_sign().driving_friction(), None);
    /// # Ok::<(), fmm_identify::IdentifyError>(())
    /// ```
    #[must_use]
    pub fn with_turned_sign(mut self) -> Self {
        self.forces.iter_mut().for_each(|force| *force = -*force);
        self
    }

    /// True if nothing ever goes back, as in a rotation in one direction.
    pub fn goes_one_way(&self) -> bool {
        let moves = |sign: f64| self.velocities().iter().any(|velocity| velocity * sign > self.motion.rest_speed);
        !(moves(1.0) && moves(-1.0))
    }

    /// Friction in the mean of the way, in the unit of the force, if it is negative beyond doubt, so that the force
    /// drives the motion that it should brake; `None` otherwise. It is the median over the [`loops`](Self::loops), or
    /// else half the difference between the mean forces of the two directions.
    pub fn driving_friction(&self) -> Option<f64> {
        let mut loops: Vec<f64> = self.loops().iter().map(|cycle| cycle.friction.value).collect();
        let own = std::slice::from_ref(self);
        let friction = if loops.is_empty() { mean_friction(own)? } else { median(&mut loops) };
        (friction < -DRIVING * deviation(own)).then_some(friction)
    }
}

/// Half the difference between the mean forces of the two directions in all `records`, or the mean force along the only
/// one; `None` if nothing moves.
pub(crate) fn mean_friction(records: &[ForceRecord]) -> Option<f64> {
    let means = [1.0, -1.0].map(|sign| {
        let (mut sum, mut count) = (0.0, 0_usize);
        for record in records {
            for (force, velocity) in record.forces().iter().zip(record.velocities()) {
                if velocity * sign > record.motion.rest_speed {
                    sum += sign * force;
                    count += 1;
                }
            }
        }
        (count > 0).then(|| sum / count as f64)
    });
    match means {
        [Some(forth), Some(back)] => Some(0.5 * (forth + back)),
        [one, other] => one.or(other),
    }
}
