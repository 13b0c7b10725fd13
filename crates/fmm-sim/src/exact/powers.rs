//! Samples of one half cycle from a table of powers, vectorised over time.

use fmm_model::{Scalar, widest};

use crate::error::SimulationError;
use crate::mechanics::Decay;
use crate::scenario::{Sampling, State};
use crate::trajectory::{Recorder, Samples};

/// zʲ = exp((−a + iω)Δt)ʲ for j from 0 on, real and imaginary parts apart.
///
/// All half cycles of a run have one decay, so that one table serves every sample: position and velocity are linear
/// combinations of the two parts, and so are their derivatives once j Δt is allowed as a factor.
pub(super) struct Powers {
    /// Real and imaginary parts, a stride of either at a time.
    strides: Vec<[[f64; STRIDE]; 2]>,
    /// Time between samples (s).
    interval: f64,
}

/// Longest run of samples written from one closed-form state.
const LONGEST: usize = 256;
/// Powers that are found by doubling; the rest follow in strides of this many. Either way rounding grows to at
/// most 16 ulp.
const STRIDE: usize = 16;

impl Powers {
    /// Powers for the half cycles of `decay` at the times of `sampling`; `None` if it does not oscillate or the times
    /// are not uniform.
    pub(super) fn for_swings<D: Scalar>(decay: &Decay<D>, sampling: &Sampling) -> Option<Self> {
        let (half_cycle, interval) = (decay.half_cycle?, sampling.interval()?);
        let longest = (half_cycle.duration.value() / interval).min(sampling.count() as f64) as usize + 1;
        Some(Self::new(decay.rate.value(), half_cycle.angular.value(), interval, longest))
    }

    /// Powers for at least `longest` samples, or [`LONGEST`] if that is less.
    pub(super) fn new(rate: f64, angular: f64, interval: f64, longest: usize) -> Self {
        let power = |exponent: usize| {
            let time = exponent as f64 * interval;
            let (sin, cos) = (angular * time).sin_cos();
            let envelope = (-rate * time).exp();
            (envelope * cos, envelope * sin)
        };
        let (first, stride) = (Self::first_stride(power(1)), power(STRIDE));
        let count = longest.clamp(1, LONGEST).div_ceil(STRIDE);
        let mut strides = Vec::with_capacity(count);
        widest(
            #[inline(always)]
            || {
                let [mut real, mut imaginary] = first;
                for _ in 0..count {
                    strides.push([real, imaginary]);
                    for (re, im) in real.iter_mut().zip(&mut imaginary) {
                        (*re, *im) = (*re * stride.0 - *im * stride.1, *re * stride.1 + *im * stride.0);
                    }
                }
            },
        );
        Self { strides, interval }
    }

    /// The powers from 0 on of the first, real parts and imaginary parts.
    fn first_stride(one: (f64, f64)) -> [[f64; STRIDE]; 2] {
        let [mut real, mut imaginary] = [[0.0; STRIDE]; 2];
        real[0] = 1.0;
        let mut factor = one;
        let mut known = 1;
        while known < STRIDE {
            for j in 0..known {
                real[known + j] = real[j] * factor.0 - imaginary[j] * factor.1;
                imaginary[known + j] = real[j] * factor.1 + imaginary[j] * factor.0;
            }
            factor = (factor.0 * factor.0 - factor.1 * factor.1, 2.0 * factor.0 * factor.1);
            known *= 2;
        }
        [real, imaginary]
    }

    pub(super) fn len(&self) -> usize {
        self.strides.len() * STRIDE
    }

    /// Writes the samples before `end` of a motion that goes on freely about `centre` from `free` at `start`.
    ///
    /// # Errors
    /// [`SimulationError::NotFinite`].
    pub(super) fn write<D: Scalar>(
        &self,
        recorder: &mut Recorder<D>,
        end: f64,
        decay: &Decay<D>,
        (centre, free): (D, State<D>),
        start: D,
    ) -> Result<(), SimulationError> {
        let Some(half_cycle) = decay.half_cycle else { return Ok(()) };
        let wave = Wave { rate: decay.rate, angular: half_cycle.angular, interval: self.interval };
        let channels = recorder.sampling.channels();
        let stop = recorder.sampling.index_at_or_after(end);
        while recorder.written < stop {
            let anchor = recorder.sampling.time(recorder.written);
            let (cos, sin) = decay.turn(wave.angular, -start + anchor);
            let turned = |cosine: D, sine: D| (cosine * cos + sine * sin, sine * cos - cosine * sin);
            let range = recorder.written..stop.min(recorder.written + self.len());
            recorder.written = range.end;
            let mut is_finite = true;
            if channels.position() {
                let (cosine, sine) = turned(free.position, (free.velocity + wave.rate * free.position) / wave.angular);
                is_finite &= (centre.value().abs() + cosine.value().abs() + sine.value().abs()).is_finite();
                self.write_wave(&mut recorder.trajectory.position, range.clone(), &wave, centre, cosine, sine);
            }
            if channels.velocity() {
                let (cosine, sine) = turned(free.velocity, -decay.pull(free) / wave.angular);
                is_finite &= (cosine.value().abs() + sine.value().abs()).is_finite();
                self.write_wave(&mut recorder.trajectory.velocity, range, &wave, D::from(0.0), cosine, sine);
            }
            if !is_finite {
                return Err(SimulationError::NotFinite { time: anchor });
            }
        }
        Ok(())
    }

    /// Writes e^(−aτ) (`cosine` cos ωτ + `sine` sin ωτ) + `offset` at τ = 0, Δt, 2Δt, … into `range`.
    fn write_wave<D: Scalar>(
        &self,
        samples: &mut Samples<D>,
        range: std::ops::Range<usize>,
        wave: &Wave<D>,
        offset: D,
        cosine: D,
        sine: D,
    ) {
        widest(
            #[inline(always)]
            || {
                let (c, s, o) = (cosine.value(), sine.value(), offset.value());
                self.fill_with(&mut samples.values[range.clone()], |re, im, _| o + (c * re + s * im));
                for direction in 0..D::DIRECTIONS {
                    let (rate, angular) = (wave.rate.partial(direction), wave.angular.partial(direction));
                    let (c0, s0, o0) = (cosine.partial(direction), sine.partial(direction), offset.partial(direction));
                    let out = &mut samples.partial_mut(direction)[range.clone()];
                    if rate == 0.0 && angular == 0.0 {
                        self.fill_with(out, |re, im, _| o0 + (c0 * re + s0 * im));
                    } else {
                        // ∂/∂a and ∂/∂ω of the wave, per interval: τ times the wave itself turned and scaled.
                        let (c1, s1) =
                            ((angular * s - rate * c) * wave.interval, -(rate * s + angular * c) * wave.interval);
                        self.fill_with(out, |re, im, j| o0 + ((c0 + c1 * j) * re + (s0 + s1 * j) * im));
                    }
                }
            },
        );
    }

    /// Fills `out`, which is not longer than the table, with the result of `of` for each power, real and imaginary
    /// part, and its exponent.
    ///
    /// In strides, the last one found whole and cut: with a loop over all of `out`, which every half cycle gives
    /// another length, a ring-down took a seventh longer.
    #[expect(clippy::inline_always, reason = "it must be compiled where it is called, for the vectors there are")]
    #[inline(always)]
    fn fill_with(&self, out: &mut [f64], of: impl Fn(f64, f64, f64) -> f64) {
        let (whole, rest) = out.as_chunks_mut::<STRIDE>();
        let (before, after) = self.strides.split_at(whole.len());
        let mut first = 0.0;
        for (out, powers) in whole.iter_mut().zip(before) {
            *out = stride_of(powers, first, &of);
            first += STRIDE as f64;
        }
        if let Some(powers) = after.first() {
            rest.copy_from_slice(&stride_of(powers, first, &of)[..rest.len()]);
        }
    }
}

/// Result of `of` for each power of a stride that begins with the exponent `first`.
#[expect(clippy::inline_always, reason = "it must be compiled where it is called, for the vectors there are")]
#[inline(always)]
fn stride_of([re, im]: &[[f64; STRIDE]; 2], first: f64, of: &impl Fn(f64, f64, f64) -> f64) -> [f64; STRIDE] {
    let mut numbers = [0.0; STRIDE];
    for j in 0..STRIDE {
        numbers[j] = of(re[j], im[j], first + j as f64);
    }
    numbers
}

/// Rate and angular frequency of a wave, and the time between its samples (s).
struct Wave<D> {
    rate: D,
    angular: D,
    interval: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmm_model::Dual;

    #[test]
    fn powers_are_exact_to_rounding() {
        let powers = Powers::new(0.7, 13.8, 1e-3, 1000);
        assert_eq!(powers.len(), LONGEST);
        let powers = powers.strides.iter().flat_map(|[real, imaginary]| real.iter().zip(imaginary));
        for (j, (real, imaginary)) in powers.enumerate() {
            let time = j as f64 * 1e-3;
            let (sin, cos) = (13.8 * time).sin_cos();
            let envelope = (-0.7 * time).exp();
            assert!((real - envelope * cos).abs() < 5e-15, "power {j}");
            assert!((imaginary - envelope * sin).abs() < 5e-15, "power {j}");
        }
        assert_eq!(Powers::new(0.7, 13.8, 1e-3, 3).len(), STRIDE);
    }

    /// A wave whose decay, frequency, centre and parts depend on inputs alone and together, beside the formula at each
    /// sample.
    #[test]
    fn waves_have_the_derivatives_of_their_formula() {
        type Number = Dual<4>;
        let interval = 1e-2;
        let number = |value: f64, slopes: [f64; 4]| {
            let input = |direction: usize| Number::variable(0.0, direction) * slopes[direction];
            (0..4).fold(Number::from(value), |sum, direction| sum + input(direction))
        };
        let rate = number(0.7, [1.0, 0.0, 0.0, 0.4]);
        let angular = number(13.8, [0.0, 1.0, 0.0, -0.6]);
        let offset = number(0.3, [0.1, 0.2, 1.0, 0.5]);
        let (cosine, sine) = (number(0.9, [0.3, -0.2, 0.7, 1.1]), number(-0.4, [0.8, 0.6, -0.9, 1.3]));
        let powers = Powers::new(0.7, 13.8, interval, 1000);
        let mut samples = Samples::<Number>::new();
        samples.reset(50).unwrap();
        // Two whole strides and a part of one.
        powers.write_wave(&mut samples, 5..45, &Wave { rate, angular, interval }, offset, cosine, sine);
        for j in 0..40 {
            let time = j as f64 * interval;
            let (sin, cos) = (angular * time).sin_cos();
            let expected = (-rate * time).exp() * (cosine * cos + sine * sin) + offset;
            let got = samples.get(5 + j);
            assert!((got.value() - expected.value()).abs() < 1e-13, "sample {j}: {got:?} in place of {expected:?}");
            for direction in 0..4 {
                let error = got.partial(direction) - expected.partial(direction);
                assert!(error.abs() < 1e-13, "sample {j}: {got:?} in place of {expected:?}");
            }
        }
    }
}
