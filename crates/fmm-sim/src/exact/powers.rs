//! Samples of one swing from a table of powers, vectorised over time.

use fmm_model::Scalar;
use pulp::Arch;

use crate::decay::Decay;
use crate::recorder::Recorder;
use crate::{Samples, Sampling, State};

/// zʲ = exp((−a + iω)Δt)ʲ for j from 0 on, real and imaginary parts apart.
///
/// All swings of a run have the same decay, so one table serves every sample: position and velocity are linear
/// combinations of the two parts, and so are their derivatives once j Δt is allowed as a factor.
pub(super) struct Powers {
    /// Real parts, then as many imaginary parts.
    parts: Vec<f64>,
    /// Time between samples (s).
    interval: f64,
}

/// Longest run of samples written from one closed-form state.
const LONGEST: usize = 256;
/// Powers that are found by doubling; the rest follow in strides of this many. Either way rounding grows to at
/// most 16 ulp.
const STRIDE: usize = 16;

impl Powers {
    /// Powers for the swings of `decay` at the times of `sampling`; `None` if it does not oscillate or the times are not
    /// uniform.
    pub(super) fn for_swings<D: Scalar>(decay: &Decay<D>, sampling: &Sampling) -> Option<Self> {
        let (half_swing, interval) = (decay.half_swing()?, sampling.interval()?);
        let longest = (half_swing.duration.value() / interval).min(sampling.count() as f64) as usize + 1;
        Some(Self::new(decay.rate().value(), half_swing.angular.value(), interval, longest))
    }

    /// Powers for at least `longest` samples, or [`LONGEST`] if that is less.
    pub(super) fn new(rate: f64, angular: f64, interval: f64, longest: usize) -> Self {
        let count = longest.clamp(1, LONGEST).next_multiple_of(STRIDE);
        let mut parts = vec![0.0; 2 * count];
        let power = |exponent: usize| {
            let time = exponent as f64 * interval;
            let (sin, cos) = (angular * time).sin_cos();
            let envelope = (-rate * time).exp();
            (envelope * cos, envelope * sin)
        };
        let (one, stride) = (power(1), power(STRIDE));
        let (real, imaginary) = parts.split_at_mut(count);
        Arch::new().dispatch(
            #[inline(always)]
            || Self::fill(real, imaginary, one, stride),
        );
        Self { parts, interval }
    }

    /// Fills the table from the first power and that of the stride.
    #[expect(clippy::inline_always, reason = "it must be compiled where it is called, for the vectors there are")]
    #[inline(always)]
    fn fill(real: &mut [f64], imaginary: &mut [f64], one: (f64, f64), stride: (f64, f64)) {
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
        let (mut reals, mut imaginaries) = (real.chunks_exact_mut(STRIDE), imaginary.chunks_exact_mut(STRIDE));
        let (Some(mut re), Some(mut im)) = (reals.next(), imaginaries.next()) else { return };
        for (later_re, later_im) in reals.zip(imaginaries) {
            for j in 0..STRIDE {
                later_re[j] = re[j] * stride.0 - im[j] * stride.1;
                later_im[j] = re[j] * stride.1 + im[j] * stride.0;
            }
            (re, im) = (later_re, later_im);
        }
    }

    pub(super) fn len(&self) -> usize {
        self.parts.len() / 2
    }

    /// The powers, real and imaginary part of each.
    fn powers(&self) -> impl Iterator<Item = (&f64, &f64)> {
        let (real, imaginary) = self.parts.split_at(self.len());
        real.iter().zip(imaginary)
    }

    /// Writes the next `count` samples, the motion about `centre` being in `state` at the first.
    pub(super) fn write<D: Scalar>(
        &self,
        recorder: &mut Recorder<D>,
        count: usize,
        decay: &Decay<D>,
        centre: D,
        state: State<D>,
    ) {
        let Some(half_swing) = decay.half_swing() else { return };
        let wave = Wave { rate: decay.rate(), angular: half_swing.angular, interval: self.interval };
        let range = recorder.written..recorder.written + count;
        let channels = recorder.sampling.channels();
        if channels.position() {
            let sine = (state.velocity + decay.rate() * state.position) / wave.angular;
            self.write_wave(recorder.trajectory.position_mut(), range.clone(), &wave, centre, state.position, sine);
        }
        if channels.velocity() {
            let sine = -decay.pull(state) / wave.angular;
            self.write_wave(recorder.trajectory.velocity_mut(), range, &wave, D::from(0.0), state.velocity, sine);
        }
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
        Arch::new().dispatch(
            #[inline(always)]
            || self.write_wave_here(samples, range, wave, offset, cosine, sine),
        );
    }

    #[expect(clippy::inline_always, reason = "it must be compiled where it is called, for the vectors there are")]
    #[inline(always)]
    fn write_wave_here<D: Scalar>(
        &self,
        samples: &mut Samples<D>,
        range: std::ops::Range<usize>,
        wave: &Wave<D>,
        offset: D,
        cosine: D,
        sine: D,
    ) {
        let (c, s, o) = (cosine.value(), sine.value(), offset.value());
        let powers = || self.powers();
        for (out, (re, im)) in samples.values_mut()[range.clone()].iter_mut().zip(powers()) {
            *out = o + (c * re + s * im);
        }
        for direction in 0..D::DIRECTIONS {
            let (rate, angular) = (wave.rate.partial(direction), wave.angular.partial(direction));
            let (c0, s0, o0) = (cosine.partial(direction), sine.partial(direction), offset.partial(direction));
            let out = &mut samples.partial_mut(direction)[range.clone()];
            if rate == 0.0 && angular == 0.0 {
                for (out, (re, im)) in out.iter_mut().zip(powers()) {
                    *out = o0 + (c0 * re + s0 * im);
                }
            } else {
                // ∂/∂a and ∂/∂ω of the wave, per interval: τ times the wave itself turned and scaled.
                let (c1, s1) = ((angular * s - rate * c) * wave.interval, -(rate * s + angular * c) * wave.interval);
                for (j, (out, (re, im))) in out.iter_mut().zip(powers()).enumerate() {
                    let j = j as f64;
                    *out = o0 + ((c0 + c1 * j) * re + (s0 + s1 * j) * im);
                }
            }
        }
    }
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

    #[test]
    fn powers_are_exact_to_rounding() {
        let powers = Powers::new(0.7, 13.8, 1e-3, 1000);
        assert_eq!(powers.len(), LONGEST);
        for (j, (real, imaginary)) in powers.powers().enumerate() {
            let time = j as f64 * 1e-3;
            let (sin, cos) = (13.8 * time).sin_cos();
            let envelope = (-0.7 * time).exp();
            assert!((real - envelope * cos).abs() < 5e-15, "power {j}");
            assert!((imaginary - envelope * sin).abs() < 5e-15, "power {j}");
        }
        assert_eq!(Powers::new(0.7, 13.8, 1e-3, 3).len(), STRIDE);
    }
}
