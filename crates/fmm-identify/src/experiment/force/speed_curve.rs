//! Friction over the speed, as a record of forces shows it without a law.

use fmm_fit::{effective_count, median_deviation};

use crate::experiment::force::ForceRecord;
use fmm_model::Estimated;

/// Friction at about one speed: half the difference between the median forces of the two directions, or, of a motion
/// that goes one way, the median force along it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedBin {
    /// Median speed (m/s, or by the unit of position).
    pub speed: f64,
    /// Friction, in the unit of the force.
    pub friction: Estimated,
    /// Force that does not change with the direction, half the sum of the two medians, in the same unit: the zero of
    /// the sensor, gravity, or levels that differ by direction; `None` of a motion that goes one way, where it is in
    /// the friction.
    pub offset: Option<Estimated>,
    /// Median normal load (N); `None` where none was measured.
    pub load: Option<f64>,
    /// Samples in it, of both directions.
    pub samples: usize,
}

impl SpeedBin {
    /// Friction over the load (1), the coefficient; `None` where no load was measured or there is none.
    pub fn coefficient(&self) -> Option<Estimated> {
        let load = self.load.filter(|load| *load > 0.0)?;
        Some(self.friction.scaled(1.0 / load))
    }

    /// Speed over load (m/s/N), which is the Hersey number of Stribeck's plot but for the viscosity and a length.
    pub fn speed_by_load(&self) -> Option<f64> {
        self.load.filter(|load| *load > 0.0).map(|load| self.speed / load)
    }
}

/// Samples of one direction below which a bin says nothing.
const FEWEST: usize = 8;
/// A median of normal noise scatters so many times as much as a mean, √(π/2).
const MEDIAN: f64 = 1.253_314_137_315_500_3;

impl ForceRecord {
    /// Friction in up to `count` bins of speed with as many samples each, slow ones first; without those that only one
    /// of two directions passes. Uncertainties take the scatter within a bin for noise, of which neighbouring samples
    /// share what their correlation says; a force that is bent within a bin, or differs from pass to pass, is in them.
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
    ///     assert!((bin.offset.unwrap().value - 3.0).abs() < 0.05);
    /// }
    /// # Ok::<(), fmm_identify::IdentifyError>(())
    /// ```
    pub fn friction_over_speed(&self, count: usize) -> Vec<SpeedBin> {
        self.bins((0..self.len()).collect(), count)
    }

    /// Like [`friction_over_speed`](Self::friction_over_speed), for up to `loads` groups of the measured normal load
    /// with as many samples each, light ones first: Stribeck's plot, friction by load over speed by load. Without a
    /// measured load there is one group.
    ///
    /// ```
    /// use fmm_identify::ForceRecord;
    ///
    /// // µ = 0.1 + 20 v/N: boundary and full-film lubrication, at 50 N and at 100 N.
    /// let times: Vec<f64> = (0..8000).map(|i| 0.001 * f64::from(i)).collect();
    /// let velocities: Vec<f64> = times.iter().map(|t| 0.06 * (3.0 * t).cos()).collect();
    /// let loads: Vec<f64> = times.iter().map(|t| if *t < 4.0 { 50.0 } else { 100.0 }).collect();
    /// let force = |v: f64, load: f64| load * v.signum() * (0.1 + 20.0 * v.abs() / load);
    /// let forces: Vec<f64> = velocities.iter().zip(&loads).map(|(v, load)| force(*v, *load)).collect();
    /// let record = ForceRecord::of_velocities(&times, &velocities, &forces)?.under_loads(&loads)?;
    /// for bin in record.friction_over_speed_and_load(8, 2) {
    ///     let (coefficient, by_load) = (bin.coefficient().unwrap().value, bin.speed_by_load().unwrap());
    ///     assert!((coefficient - 0.1 - 20.0 * by_load).abs() < 1e-3);
    /// }
    /// # Ok::<(), fmm_identify::IdentifyError>(())
    /// ```
    pub fn friction_over_speed_and_load(&self, count: usize, loads: usize) -> Vec<SpeedBin> {
        let mut rows: Vec<usize> = (0..self.len()).collect();
        let Some(measured) = &self.loads else { return self.bins(rows, count) };
        rows.sort_by(|a, b| measured[*a].total_cmp(&measured[*b]));
        let size = rows.len().div_ceil(loads.max(1)).max(1);
        rows.chunks(size).flat_map(|rows| self.bins(rows.to_vec(), count)).collect()
    }

    /// Bins of the speed of those of `rows` that slide, with as many samples each.
    fn bins(&self, mut rows: Vec<usize>, count: usize) -> Vec<SpeedBin> {
        let speed = |row: &usize| self.velocities()[*row].abs();
        rows.retain(|row| speed(row) > self.motion.rest_speed);
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
        let (friction, offset) = match (self.median(&forth), self.median(&back)) {
            (Some(forth), Some(back)) => {
                let uncertainty = 0.5 * forth.uncertainty.hypot(back.uncertainty);
                let half = |value: f64| Estimated { value: 0.5 * value, uncertainty };
                (half(forth.value - back.value), Some(half(forth.value + back.value)))
            }
            (Some(forth), None) if self.goes_one_way() => (forth, None),
            (None, Some(back)) if self.goes_one_way() => (Estimated { value: -back.value, ..back }, None),
            _ => return None,
        };
        let load = |loads: &Vec<f64>| median(&mut rows.iter().map(|row| loads[*row]).collect::<Vec<_>>());
        Some(SpeedBin {
            speed: self.velocities()[rows[rows.len() / 2]].abs(),
            friction,
            offset,
            load: self.loads.as_ref().map(load),
            samples: rows.len(),
        })
    }

    /// The median force of the samples `rows`, which ascend.
    fn median(&self, rows: &[usize]) -> Option<Estimated> {
        if rows.len() < FEWEST {
            return None;
        }
        let forces: Vec<f64> = rows.iter().map(|row| self.forces()[*row]).collect();
        let value = median(&mut forces.clone());
        let left: Vec<f64> = forces.iter().map(|force| force - value).collect();
        let (told, deviation) = (effective_count(&left).unwrap_or(1.0), median_deviation(&left, 0)?);
        Some(Estimated { value, uncertainty: MEDIAN * deviation / told.sqrt() })
    }
}

/// The median of `values`, of which there is one at least; they are sorted by it.
pub(super) fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len().is_multiple_of(2) { 0.5 * (values[middle - 1] + values[middle]) } else { values[middle] }
}
