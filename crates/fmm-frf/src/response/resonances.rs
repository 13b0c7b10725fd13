//! Resonances: lines of a response that stand out.

use crate::response::FrequencyResponse;

/// A local maximum of the magnitude.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Resonance {
    /// Frequency (Hz) of the line.
    pub frequency: f64,
    /// Magnitude (unit of the response) of the line.
    pub magnitude: f64,
    /// Prominence (dB): the least descent from the peak before the magnitude rises above it; to the ends of the
    /// response if nothing does.
    pub prominence: f64,
}

impl FrequencyResponse {
    /// The local maxima of a response that stand out by at least `prominence` (dB), in the order of their frequencies.
    ///
    /// The first and the last line do not count, and of equal neighbours only one does. It takes time in proportion to
    /// the number of lines, whatever they are. [`RationalFit`](crate::RationalFit) finds the frequency between the
    /// lines, and the damping.
    ///
    /// ```
    /// use fmm_frf::{ResponseForm, SingleDegreeOfFreedom};
    ///
    /// let lines: Vec<f64> = (0..80).map(|i| f64::from(i) / 8.0).collect();
    /// let machine = SingleDegreeOfFreedom::new(10.391, 8.0, 1982.0)?;
    /// let found = machine.frequency_response(ResponseForm::Receptance, &lines)?.resonances(6.0);
    /// assert_eq!(found.len(), 1);
    /// assert_eq!(found[0].frequency, 2.25);
    /// # Ok::<(), fmm_frf::FrfError>(())
    /// ```
    pub fn resonances(&self, prominence: f64) -> Vec<Resonance> {
        let heights: Vec<f64> = self.values().iter().map(|value| 20.0 * value.norm().log10()).collect();
        let before = lowest_since_higher(heights.iter().copied(), |earlier, height| earlier <= height);
        let mut after = lowest_since_higher(heights.iter().rev().copied(), |earlier, height| earlier < height);
        after.reverse();
        let mut found = Vec::new();
        for (line, neighbours) in heights.windows(3).enumerate().map(|(i, neighbours)| (i + 1, neighbours)) {
            let height = neighbours[1];
            let stands_out = height - before[line].max(after[line]);
            if height >= neighbours[0] && height > neighbours[2] && stands_out >= prominence {
                let (frequency, magnitude) = (self.frequencies()[line], self.values()[line].norm());
                found.push(Resonance { frequency, magnitude, prominence: stands_out });
            }
        }
        found
    }
}

/// For each height the lowest one back to the last that it does not pass, itself included.
fn lowest_since_higher(heights: impl Iterator<Item = f64>, passes: impl Fn(f64, f64) -> bool) -> Vec<f64> {
    let mut lowest = Vec::new();
    // Heights not passed yet, each with the lowest since the one before it.
    let mut standing: Vec<(f64, f64)> = Vec::new();
    for height in heights {
        let mut low = height;
        while let Some((_, since)) = standing.pop_if(|(earlier, _)| passes(*earlier, height)) {
            low = low.min(since);
        }
        lowest.push(low);
        standing.push((height, low));
    }
    lowest
}

#[cfg(test)]
mod tests {
    use fmm_record::Complex64;

    use super::*;
    use crate::response::ResponseForm;

    fn prominences(decibels: &[f64]) -> Vec<(f64, f64)> {
        let lines = (0..decibels.len()).map(|i| i as f64).collect();
        let values = decibels.iter().map(|height| Complex64::new(10f64.powf(height / 20.0), 0.0)).collect();
        let response = FrequencyResponse::new(ResponseForm::Mobility, lines, values).unwrap();
        response.resonances(0.5).iter().map(|found| (found.frequency, found.prominence)).collect()
    }

    #[test]
    fn prominence_is_the_way_down_to_something_higher() {
        let found = prominences(&[0.0, 10.0, 4.0, 7.0, 6.0, 20.0, 3.0, 5.0, 5.0, 1.0]);
        let expected = [(1.0, 6.0), (3.0, 1.0), (5.0, 19.0), (8.0, 2.0)];
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (found, expected) in found.iter().zip(expected) {
            assert!(found.0 == expected.0 && (found.1 - expected.1).abs() < 1e-12, "{found:?}, not {expected:?}");
        }
    }

    #[test]
    fn ends_and_plains_are_no_resonances() {
        assert!(prominences(&[9.0, 5.0, 5.0, 5.0, 9.0]).is_empty());
        assert!(prominences(&[]).is_empty() && prominences(&[1.0]).is_empty());
        // A line without any response is a floor like any other.
        assert_eq!(prominences(&[f64::NEG_INFINITY, 3.0, f64::NEG_INFINITY]), [(1.0, f64::INFINITY)]);
    }
}
