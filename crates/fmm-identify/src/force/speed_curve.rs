//! Friction over the speed, as a record of forces shows it without a law.

use fmm_fit::{effective_count, median_deviation};

use crate::{Estimated, ForceRecord};

/// Friction at about one speed: half the difference between the median forces of the two directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedBin {
    /// Median speed (m/s, or by the unit of position).
    pub speed: f64,
    /// Friction, in the unit of the force.
    pub friction: Estimated,
    /// What does not change with the direction, half the sum of the two medians, in the same unit: the zero of the sensor, gravity, or
    /// levels that differ by direction.
    pub offset: Estimated,
    /// Samples in it, of both directions.
    pub samples: usize,
}

/// Samples of one direction below which a bin says nothing.
const FEWEST: usize = 8;
/// A median of normal noise scatters so many times as much as a mean, √(π/2).
const MEDIAN: f64 = 1.253_314_137_315_500_3;

impl ForceRecord {
    /// Friction in up to `count` bins of speed with as many samples each, slow ones first; without those that only one direction
    /// passes. Uncertainties take the scatter within a bin for noise, of which neighbouring samples share what their correlation says;
    /// a force that is bent within a bin, or differs from pass to pass, is in them.
    ///
    /// ```
    /// use fmm_identify::ForceRecord;
    ///
    /// // 12 N and 30 N s/m along a slide, with a sensor whose zero is 3 N off.
    /// let times: Vec<f64> = (0..4000).map(|i| 0.001 * f64::from(i)).collect();
    /// let velocities: Vec<f64> = times.iter().map(|t| 0.06 * (3.0 * t).cos()).collect();
    /// let forces: Vec<f64> = velocities.iter().map(|v| 12.0 * v.signum() + 30.0 * v + 3.0).collect();
    /// let record = ForceRecord::of_velocities(&times, &velocities, &forces)?;
    /// for bin in record.friction_over_speed(10) {
    ///     assert!((bin.friction.value - 12.0 - 30.0 * bin.speed).abs() < 0.05);
    ///     assert!((bin.offset.value - 3.0).abs() < 0.05);
    /// }
    /// # Ok::<(), fmm_identify::IdentifyError>(())
    /// ```
    pub fn friction_over_speed(&self, count: usize) -> Vec<SpeedBin> {
        let moves = |row: &usize| self.velocities()[*row].abs() > self.motion.rest_speed;
        let mut rows: Vec<usize> = (0..self.len()).filter(moves).collect();
        let speed = |row: &usize| self.velocities()[*row].abs();
        rows.sort_by(|a, b| speed(a).total_cmp(&speed(b)));
        let size = rows.len().div_ceil(count.max(1)).max(1);
        rows.chunks(size).filter_map(|rows| self.bin(rows)).collect()
    }

    /// The bin of the samples `rows`, slow ones first.
    fn bin(&self, rows: &[usize]) -> Option<SpeedBin> {
        let [forth, back] = [1.0, -1.0].map(|sign| {
            let mut rows: Vec<usize> =
                rows.iter().copied().filter(|row| self.velocities()[*row] * sign > 0.0).collect();
            rows.sort_unstable();
            rows
        });
        let (forth, back) = (self.median(&forth)?, self.median(&back)?);
        let uncertainty = 0.5 * forth.uncertainty.hypot(back.uncertainty);
        let half = |value: f64| Estimated { value: 0.5 * value, uncertainty };
        Some(SpeedBin {
            speed: self.velocities()[rows[rows.len() / 2]].abs(),
            friction: half(forth.value - back.value),
            offset: half(forth.value + back.value),
            samples: rows.len(),
        })
    }

    /// The median force of the samples `rows`, which ascend.
    fn median(&self, rows: &[usize]) -> Option<Estimated> {
        if rows.len() < FEWEST {
            return None;
        }
        let forces: Vec<f64> = rows.iter().map(|row| self.forces()[*row]).collect();
        let mut sorted = forces.clone();
        sorted.sort_by(f64::total_cmp);
        let middle = sorted.len() / 2;
        let value =
            if sorted.len().is_multiple_of(2) { 0.5 * (sorted[middle - 1] + sorted[middle]) } else { sorted[middle] };
        let left: Vec<f64> = forces.iter().map(|force| force - value).collect();
        let (told, deviation) = (effective_count(&left).unwrap_or(1.0), median_deviation(&left, 0)?);
        Some(Estimated { value, uncertainty: MEDIAN * deviation / told.sqrt() })
    }
}
