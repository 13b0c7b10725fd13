//! Uncertainty of a sampled pulse: of its impulse and of its time.

use std::ops::Range;

/// Standard uncertainties of a pulse that is known at samples only, seen with noise.
///
/// ```text
/// J = h Σ fᵢ,   tₒ = h Σ tᵢ fᵢ / J                                                                       (1)
/// var J = h² Σ_ends (s²/720 + q²/30240) + h² n σ²                                                         (2)
/// ```
///
/// (1) are impulse and centre of the samples joined by straight lines. With samples every h that lie anywhere against
/// the pulse, neither is off on average, whatever the pulse: the mean of h Σ f(t₀ + i h) over t₀ is ∫ f dt. How far one
/// such sum is off comes from the ends of the pulse, where it begins with a slope (s, in N per interval) or a curvature
/// (q, in N per interval squared): by h s B₂(φ)/2 and h q B₃(φ)/6, with Bernoulli's polynomials of the part φ of an
/// interval that lies between the end and the next sample (Euler's and Maclaurin's formula). With φ anywhere these have
/// the variances |B₄|/4! = 1/720 and
/// |B₆|/6! = 1/30240 of (2). The n samples add the noise σ. A half sine has s = π F₀/n and is left with u(J)/J = 0.67/n² (n
/// intervals, either end for itself), where the worst case is 0.82/n².
///
/// A pulse that an anti-aliasing filter rounds before it is sampled is known better than that.
///
/// # References
/// F. W. J. Olver et al., NIST Digital Library of Mathematical Functions, 2.10(i), 24.2 and 24.13,
/// <https://dlmf.nist.gov>.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SampledPulse {
    /// Standard uncertainty of the impulse (N s).
    pub(crate) impulse: f64,
    /// Standard uncertainty of the time at which the impulse acts (s).
    pub(crate) time: f64,
}

impl SampledPulse {
    /// Uncertainties by a `force` (N) sampled every `interval` (s), with this `noise` (N). It is zero but for `hits`, the
    /// ranges within which the hammer is in contact.
    pub(crate) fn of(force: &[f64], hits: &[Range<usize>], interval: f64, noise: f64) -> Self {
        let sum: f64 = force.iter().sum();
        let moment: f64 = force.iter().enumerate().map(|(i, f)| i as f64 * f).sum();
        let centre = moment / sum;
        let (mut variance, mut of_moment) = (0.0, 0.0);
        let mut add = |position: f64, added: f64| {
            variance += added;
            of_moment += added * (position - centre).powi(2);
        };
        for hit in hits {
            let inside = &force[hit.clone()];
            add(hit.start as f64 - 0.5, variance_of_end(inside.iter()));
            add(hit.end as f64 - 0.5, variance_of_end(inside.iter().rev()));
            hit.clone().for_each(|i| add(i as f64, noise * noise));
        }
        Self { impulse: interval * variance.sqrt(), time: interval * of_moment.sqrt() / sum.abs() }
    }
}

/// Variance (N²) that one end gives to the sum of the samples; the samples are those of the pulse from that end on.
fn variance_of_end<'a>(mut inside: impl Iterator<Item = &'a f64>) -> f64 {
    let (slope, curvature) = match (inside.next(), inside.next(), inside.next()) {
        // The end lies half an interval before the first of them, more or less: there the slope is one difference of
        // differences less than in the middle between the first two.
        (Some(a), Some(b), Some(c)) => (3.0 * b - 2.0 * a - c, c - 2.0 * b + a),
        // All of a pulse this short may rise in one interval.
        (a, b, _) => ([a, b].into_iter().flatten().fold(0.0f64, |most, f| most.max(f.abs())), 0.0),
    };
    slope * slope / 720.0 + curvature * curvature / 30240.0
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// Mean square of the errors of sum and centre over all places of the samples, by what is stated, each as a root.
    fn errors_by_stated(pulse: impl Fn(f64) -> f64, impulse: f64, intervals: f64) -> [f64; 2] {
        const PLACES: usize = 2000;
        let mut sums = [0.0; 4];
        for place in 0..PLACES {
            let phase = (place as f64 + 0.5) / PLACES as f64;
            let count = (intervals - phase).floor() as usize + 1;
            let mut force = vec![0.0; count + 2];
            (0..count).for_each(|i| force[i + 1] = pulse((i as f64 + phase) / intervals));
            let found = SampledPulse::of(&force, std::slice::from_ref(&(1..count + 1)), 1.0, 0.0);
            let sum: f64 = force.iter().sum();
            let centre = force.iter().enumerate().map(|(i, f)| (i as f64 - 1.0 + phase) * f).sum::<f64>() / sum;
            let errors = [sum - impulse * intervals, centre - 0.5 * intervals, found.impulse, found.time];
            sums.iter_mut().zip(errors).for_each(|(sum, error)| *sum += error * error);
        }
        [(sums[0] / sums[2]).sqrt(), (sums[1] / sums[3]).sqrt()]
    }

    #[test]
    fn errors_of_sampling_are_those_stated() {
        // With whole intervals both ends lie alike: the sum errs √2 times as much as of ends that have nothing to do
        // with each other, and the centre not at all. Halfway between, the errors of the two ends do the reverse.
        for (intervals, low, high) in [(10.0, 1.3, 1.5), (18.0, 1.3, 1.5), (18.25, 0.8, 1.2), (34.3, 0.8, 1.2)] {
            let [sum, centre] = errors_by_stated(|t| (PI * t).sin(), 2.0 / PI, intervals);
            assert!(
                (low..high).contains(&sum),
                "half sine over {intervals}: the sum errs {sum} times as much as stated"
            );
            assert!(centre < 1.3, "half sine over {intervals}: the centre errs {centre} times as much as stated");
            // What has no kink is stated on the safe side.
            let [sum, centre] = errors_by_stated(|t| (PI * t).sin().powi(2), 0.5, intervals);
            assert!(sum < 1.0 && centre < 1.0, "squared sine over {intervals}: {sum} and {centre}");
        }
    }

    #[test]
    fn noise_counts_by_the_samples() {
        let force = [0.0, 3.0, 4.0, 3.0, 0.0];
        let without = SampledPulse::of(&force, std::slice::from_ref(&(1..4)), 0.1, 0.0);
        let with = SampledPulse::of(&force, std::slice::from_ref(&(1..4)), 0.1, 2.0);
        assert!((with.impulse.powi(2) - without.impulse.powi(2) - 0.01 * 3.0 * 4.0).abs() < 1e-12);
        // The two at the sides move the centre, one interval each way.
        let added = 0.01 * 2.0 * 4.0 / 100.0;
        assert!((with.time.powi(2) - without.time.powi(2) - added).abs() < 1e-12);
        // Of two samples and of one there is no curvature to see.
        let short = SampledPulse::of(&[0.0, 2.0, 0.0], std::slice::from_ref(&(1..2)), 1.0, 0.0);
        assert!((short.impulse - (2.0f64 * 4.0 / 720.0).sqrt()).abs() < 1e-12);
    }
}
