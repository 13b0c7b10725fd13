//! The resolution of a converter.

/// The step of the lattice on which all of `values` lie, in their unit; `None` if they lie on none.
///
/// The step is the smallest difference between values that occur, or a whole fraction of it down to an eighth,
/// such that all differences are multiples of it within 5 % (so that a lattice printed with few digits is still
/// one). Evidence is needed: at least eight different values, or every value occurring twice on average. A constant
/// record has none.
///
/// Of more than 131 072 samples, as many are looked at, evenly spread.
///
/// ```
/// use fmm_record::quantisation_step;
///
/// // A converter of 12 bits over ±10 V.
/// let lsb = 20.0 / 4096.0;
/// let volts: Vec<f64> = (0..1000).map(|i| 0.3 + ((f64::from(i) * 0.01).sin() / lsb).round() * lsb).collect();
/// assert!((quantisation_step(&volts).unwrap() - lsb).abs() < 1e-12);
///
/// let smooth: Vec<f64> = (0..1000).map(|i| (f64::from(i) * 0.01).sin()).collect();
/// assert_eq!(quantisation_step(&smooth), None);
/// ```
pub fn quantisation_step(values: &[f64]) -> Option<f64> {
    const MOST: usize = 1 << 17;
    const ENOUGH: usize = 8;
    const FRACTIONS: usize = 8;
    let mut sorted: Vec<f64> = values.iter().step_by(values.len().div_ceil(MOST).max(1)).copied().collect();
    let samples = sorted.len();
    sorted.sort_unstable_by(f64::total_cmp);
    let largest = sorted.first()?.abs().max(sorted.last()?.abs());
    // Values that differ by rounding only are the same.
    let rounding = 16.0 * f64::EPSILON * largest;
    sorted.dedup_by(|next, kept| *next - *kept <= rounding);
    if sorted.len() < 2 || (sorted.len() < ENOUGH && 2 * sorted.len() > samples) {
        return None;
    }
    let smallest = sorted.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    (1..=FRACTIONS).find_map(|fraction| lattice(&sorted, smallest / fraction as f64, rounding))
}

/// The step of the lattice through `sorted` that is near `step`, refined on the way as the distances grow; `None` if
/// a value misses the lattice.
fn lattice(sorted: &[f64], step: f64, rounding: f64) -> Option<f64> {
    const TOLERANCE: f64 = 0.05;
    let first = *sorted.first()?;
    let (mut step, mut index) = (step, 0.0);
    for pair in sorted.windows(2) {
        let difference = pair[1] - pair[0];
        let steps = (difference / step).round();
        if (difference - steps * step).abs() > TOLERANCE * step + rounding || step <= 4.0 * rounding {
            return None;
        }
        index += steps;
        step = (pair[1] - first) / index;
    }
    Some(step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::synthetic::Noise;

    #[cfg(feature = "mat")]
    #[test]
    fn fork_has_the_step_of_its_converter() {
        let step = quantisation_step(crate::tests::synthetic::fork().values()).unwrap();
        assert!((step - 5.083_2e-3).abs() < 1e-7, "{step} V");
    }

    #[test]
    fn lattice_is_found_from_multiples_and_from_rounded_print() {
        // Only even and threefold multiples of 0.1 occur next to each other.
        let sparse: Vec<f64> = (0..40).flat_map(|i| [0.5 * f64::from(i), 0.5 * f64::from(i) + 0.2]).collect();
        assert!((quantisation_step(&sparse).unwrap() - 0.1).abs() < 1e-12);
        let printed: Vec<f64> = (0..500).map(|i| (f64::from(i % 200) * 5.0832e-3 * 1e4).round() / 1e4).collect();
        let step = quantisation_step(&printed).unwrap();
        assert!((step - 5.0832e-3).abs() < 1e-6, "{step}");
    }

    #[test]
    fn arbitrary_numbers_lie_on_no_lattice() {
        for count in [0, 1, 2, 3, 7, 8, 20, 1000, 200_000] {
            let mut random = Noise::new(count as u64);
            let values: Vec<f64> = (0..count).map(|_| random.normal()).collect();
            assert_eq!(quantisation_step(&values), None, "{count} values");
        }
        assert_eq!(quantisation_step(&[1.0; 100]), None);
    }

    #[test]
    fn two_levels_at_rest_are_a_lattice() {
        let values: Vec<f64> = (0..100).map(|i| if i % 3 == 0 { 1.25 } else { 1.5 }).collect();
        assert_eq!(quantisation_step(&values), Some(0.25));
    }
}
