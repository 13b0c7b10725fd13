//! Hysteresis loops: force over displacement, cycle by cycle, without a law.

use fmm_fit::{LinearRegression, Weighting};

use crate::experiment::force::ForceRecord;
use fmm_model::Estimated;

/// One cycle of a motion to and fro, from a reversal to the next but one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceLoop {
    /// Times of its first and last sample (s).
    pub span: [f64; 2],
    /// Least and greatest position (m, or the unit of position).
    pub range: [f64; 2],
    /// ∮ F dx, the energy that the cycle takes up (J, or the unit of the force times that of position).
    pub energy: Estimated,
    /// The energy over the length of the way, which is the mean friction of the cycle, in the unit of the force.
    pub friction: Estimated,
    /// Rise of the force with the position, by the unit of force per position, beside a level of friction and a zero;
    /// its uncertainty takes all that these three leave for noise.
    pub stiffness: Estimated,
}

/// Fewest samples of a cycle.
const FEWEST: usize = 8;

impl ForceRecord {
    /// The hysteresis loops of this record, one for each whole cycle between reversals; empty if there is none.
    ///
    /// Uncertainties are those by the noise between neighbouring samples, taken to be white; a zero of the force does
    /// not matter, as the mean force of each loop is left out.
    ///
    /// ```
    /// use fmm_identify::ForceRecord;
    ///
    /// // 12 N of friction and a spring of 500 N/m over 20 mm to and fro.
    /// let times: Vec<f64> = (0..4000).map(|i| 0.001 * f64::from(i)).collect();
    /// let positions: Vec<f64> = times.iter().map(|t| 0.02 * (6.0 * t).sin()).collect();
    /// let velocities: Vec<f64> = times.iter().map(|t| 0.12 * (6.0 * t).cos()).collect();
    /// let moved = positions.iter().zip(&velocities);
    /// let forces: Vec<f64> = moved.map(|(x, v)| 12.0 * v.signum() + 500.0 * x + 3.0).collect();
    /// let record = ForceRecord::of_positions(&times, &positions, &forces)?.with_velocities(&velocities)?;
    /// for cycle in record.loops() {
    ///     assert!((cycle.energy.value - 4.0 * 0.02 * 12.0).abs() < 1e-2);
    ///     assert!((cycle.friction.value - 12.0).abs() < 0.1);
    ///     assert!((cycle.stiffness.value - 500.0).abs() < 1.0);
    /// }
    /// # Ok::<(), fmm_identify::IdentifyError>(())
    /// ```
    pub fn loops(&self) -> Vec<ForceLoop> {
        let reversals = self.reversals();
        reversals.windows(3).filter_map(|turns| self.cycle(turns[0], turns[2])).collect()
    }

    /// Rows with which the motion goes on in the other direction; rests in between count to the direction before.
    pub(crate) fn reversals(&self) -> Vec<usize> {
        let mut reversals = Vec::new();
        if self.is_timeless {
            return reversals;
        }
        let mut before = 0.0;
        for (row, velocity) in self.velocities().iter().enumerate() {
            if velocity.abs() > self.motion.rest_speed {
                if velocity * before < 0.0 {
                    reversals.push(row);
                }
                before = *velocity;
            }
        }
        reversals
    }

    /// The loop of the samples from `first` to `last`.
    fn cycle(&self, first: usize, last: usize) -> Option<ForceLoop> {
        if last - first < FEWEST {
            return None;
        }
        let (x, f) = (&self.positions()[first..=last], &self.forces()[first..=last]);
        let count = x.len();
        let mean = f.iter().sum::<f64>() / count as f64;
        // ∫ F dx by trapezoids is a sum of the forces by these weights.
        let weight = |i: usize| 0.5 * (x[(i + 1).min(count - 1)] - x[i.saturating_sub(1)]);
        let energy: f64 = (0..count).map(|i| weight(i) * (f[i] - mean)).sum();
        let noise = self.noise();
        let uncertainty = noise * (0..count).map(|i| weight(i).powi(2)).sum::<f64>().sqrt();
        let way: f64 = x.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
        let [low, high] = [f64::min, f64::max].map(|end: fn(f64, f64) -> f64| x.iter().copied().fold(x[0], end));
        let ones = vec![1.0; count];
        let directions: Vec<f64> = self.velocities()[first..=last].iter().map(|v| v.signum()).collect();
        let columns = [("zero", &ones[..]), ("stiffness", x), ("level", &directions[..])];
        let regression = LinearRegression::fit(&columns, f, Weighting::Equal).ok()?;
        Some(ForceLoop {
            span: [self.times()[first], self.times()[last]],
            range: [low, high],
            energy: Estimated { value: energy, uncertainty },
            friction: Estimated { value: energy / way, uncertainty: uncertainty / way },
            stiffness: Estimated {
                value: regression.coefficients()[1],
                uncertainty: regression.standard_uncertainty(1)?,
            },
        })
    }
}
