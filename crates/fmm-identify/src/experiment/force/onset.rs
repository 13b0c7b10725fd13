//! Onset of sliding: presliding stiffness and breakaway level, without a law.

use fmm_fit::{Polynomial, Weighting};

use crate::experiment::force::ForceRecord;
use crate::experiment::force::speed_curve::median;
use fmm_model::Estimated;

/// The onset of sliding after a rest or a reversal, as the force over the displacement from there shows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Onset {
    /// Time of its first sample (s).
    pub begin: f64,
    /// The sign of the velocity that follows (±1).
    pub direction: f64,
    /// Rise of the force with the displacement where that begins, by the unit of force per position: the presliding
    /// stiffness. After a reversal Dahl's law has up to twice the stiffness of its bristles there, elements have all of
    /// theirs.
    pub stiffness: Estimated,
    /// The force along the direction at which the contact breaks away, in the unit of the force: the largest middle one
    /// of three samples before it slides, so that it is as much too small as the force rises in a sample; what does
    /// not change with the direction is in it.
    pub breakaway: Estimated,
    /// Median force along the direction in the later half of the samples, while the contact slides, in the same unit.
    pub sliding: Estimated,
    /// The displacement in which the force would rise to the sliding one by the presliding stiffness (m, or the unit of
    /// position).
    pub displacement: f64,
}

/// Fewest samples of the rise, and of the sliding behind it.
const FEWEST: usize = 6;
/// Share of the rise over which its first slope is taken (1).
const SLOPE: f64 = 0.5;
/// Way before sliding, in presliding displacements (1).
const BEFORE: f64 = 4.0;

impl ForceRecord {
    /// The onsets of sliding that this record shows by enough samples: of a slow ramp, or of a slow motion to and fro.
    /// A motion that is over the presliding in fewer than six samples shows none.
    ///
    /// ```
    /// use fmm_identify::ForceRecord;
    ///
    /// // Pulled at 10 µm/s: an elastic rise of 2 N/µm to 9 N, then 6 N.
    /// let times: Vec<f64> = (0..300).map(|i| 0.01 * f64::from(i)).collect();
    /// let positions: Vec<f64> = times.iter().map(|t| 1e-5 * t).collect();
    /// let forces: Vec<f64> = positions.iter().map(|x| if *x <= 4.5e-6 { 2e6 * x } else { 6.0 }).collect();
    /// let onsets = ForceRecord::of_positions(&times, &positions, &forces)?.onsets();
    /// assert_eq!(onsets.len(), 1);
    /// assert!((onsets[0].stiffness.value / 2e6 - 1.0).abs() < 1e-6);
    /// assert!((onsets[0].breakaway.value - 9.0).abs() < 0.25 && (onsets[0].sliding.value - 6.0).abs() < 1e-9);
    /// # Ok::<(), fmm_identify::IdentifyError>(())
    /// ```
    pub fn onsets(&self) -> Vec<Onset> {
        if self.is_timeless() {
            return Vec::new();
        }
        let mut turns = vec![0];
        turns.extend(self.reversals());
        turns.push(self.len());
        turns.windows(2).filter_map(|ends| self.onset(ends[0], ends[1])).collect()
    }

    /// The onset in the samples from `first` to before `last`, which go one way.
    fn onset(&self, first: usize, last: usize) -> Option<Onset> {
        let (x, f) = (&self.positions()[first..last], &self.forces()[first..last]);
        let count = x.len();
        if count < 2 * FEWEST {
            return None;
        }
        let direction = (x[count - 1] - x[0]).signum();
        let along: Vec<f64> = f.iter().map(|force| force * direction).collect();
        let way: Vec<f64> = x.iter().map(|position| (position - x[0]) * direction).collect();
        let noise = self.noise();
        let sliding = median(&mut along[count / 2..].to_vec());
        let rise = sliding - along[0];
        if !(rise > FEWEST as f64 * noise) {
            return None;
        }
        // A rest before the ramp shows no slope.
        let is_rising = |force: &f64| (force - along[0]) <= SLOPE * rise;
        let rising = along.iter().take_while(|force| is_rising(force)).count();
        if rising < FEWEST {
            return None;
        }
        // A parabola: bristles let the slope fall from the beginning.
        let parabola = Polynomial::fit(&way[..rising], &along[..rising], 2, Weighting::Equal).ok()?;
        let stiffness = parabola.coefficients()[1];
        let displacement = rise / stiffness;
        let settled = way.iter().position(|way| *way > BEFORE * displacement)?;
        if !(stiffness > 0.0) || count - settled < FEWEST {
            return None;
        }
        // The middle of three: a single sample is no level.
        let breakaway = along[..settled].windows(3).map(|three| median(&mut three.to_vec())).fold(sliding, f64::max);
        let by_noise = |samples: f64| noise / samples.sqrt();
        Some(Onset {
            begin: self.times()[first],
            direction,
            stiffness: Estimated { value: stiffness, uncertainty: parabola.regression().standard_uncertainty(1)? },
            breakaway: Estimated { value: breakaway, uncertainty: by_noise(1.0) },
            sliding: Estimated { value: sliding, uncertainty: by_noise(0.5 * count as f64) },
            displacement,
        })
    }
}
