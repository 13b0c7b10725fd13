//! Plain loop of a ring-down under Coulomb friction by its closed form: the least that the exact engine's work can
//! cost.
//!
//! One machine, one law, one channel, uniform samples, no force, and no input that could be wrong. Reversals and the
//! stop are kept with time and position, as the engine keeps them.

use std::f64::consts::PI;

/// Powers that are found by doubling; the rest follow in strides of this many.
const STRIDE: usize = 16;
/// Longest run of samples from one closed-form state.
const LONGEST: usize = 256;

/// A machine with viscous damping and Coulomb friction, and where it starts.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RingDown {
    /// m (kg).
    pub(crate) mass: f64,
    /// k (N/m).
    pub(crate) stiffness: f64,
    /// c (N s/m).
    pub(crate) damping: f64,
    /// N μ (N).
    pub(crate) friction: f64,
    /// x₀ (m).
    pub(crate) position: f64,
    /// v₀ (m/s), not zero.
    pub(crate) velocity: f64,
}

/// Room that is used again.
#[derive(Debug)]
pub(crate) struct Room {
    real: [f64; LONGEST],
    imaginary: [f64; LONGEST],
    /// Time (s) and position (m) of each zero of the velocity.
    pub(crate) zeros: Vec<(f64, f64)>,
}

impl Room {
    pub(crate) const fn new() -> Self {
        Self { real: [0.0; LONGEST], imaginary: [0.0; LONGEST], zeros: Vec::new() }
    }

    /// Fills the table of exp((−a + iω)Δt)ʲ, `count` of them.
    fn fill(&mut self, rate: f64, angular: f64, interval: f64, count: usize) {
        let Self { real, imaginary, .. } = self;
        let (sin, cos) = (angular * interval).sin_cos();
        let envelope = (-rate * interval).exp();
        let (mut re, mut im) = (envelope * cos, envelope * sin);
        (real[0], imaginary[0]) = (1.0, 0.0);
        let mut known = 1;
        while known < count.next_multiple_of(STRIDE) {
            let step = known.min(STRIDE);
            for j in 0..step {
                let (from, to) = (known - step + j, known + j);
                real[to] = real[from] * re - imaginary[from] * im;
                imaginary[to] = real[from] * im + imaginary[from] * re;
            }
            if known < STRIDE {
                (re, im) = (re * re - im * im, 2.0 * re * im);
            }
            known += step;
        }
    }
}

impl RingDown {
    /// Writes the velocities at `interval` (s) from t = 0 on into `out`.
    pub(crate) fn run(&self, interval: f64, out: &mut [f64], room: &mut Room) {
        let rate = self.damping / (2.0 * self.mass);
        let square = self.stiffness / self.mass;
        let angular = (square - rate * rate).sqrt();
        let edge = self.friction / self.stiffness;
        let half_swing = PI / angular;
        let ratio = (-rate * half_swing).exp();
        let longest = ((half_swing / interval) as usize + 2).min(LONGEST);
        room.fill(rate, angular, interval, longest);
        room.zeros.clear();
        let (mut x, mut v, mut begin, mut written) = (self.position, self.velocity, 0.0, 0);
        loop {
            let centre = if v == 0.0 { edge * x.signum() } else { -edge * v.signum() };
            let from = x - centre;
            let advance = |elapsed: f64| {
                let (sin, cos) = (angular * elapsed).sin_cos();
                let envelope = (-rate * elapsed).exp();
                let (cosine, sine) = (envelope * cos, envelope * sin / angular);
                (from * cosine + (v + rate * from) * sine, v * cosine - (rate * v + square * from) * sine)
            };
            let duration = if v == 0.0 {
                half_swing
            } else {
                let sign = v.signum();
                (angular * v * sign).atan2((rate * v + square * from) * sign) / angular
            };
            let end = begin + duration;
            let stop = ((end / interval) as usize + 1).min(out.len());
            while written < stop {
                let (position, velocity) = advance(written as f64 * interval - begin);
                let sine = -(rate * velocity + square * position) / angular;
                let run = written..stop.min(written + longest);
                for ((out, re), im) in out[run.clone()].iter_mut().zip(&room.real).zip(&room.imaginary) {
                    *out = velocity * re + sine * im;
                }
                written = run.end;
            }
            x = centre + if v == 0.0 { -from * ratio } else { advance(duration).0 };
            (v, begin) = (0.0, end);
            room.zeros.push((end, x));
            if written == out.len() || x.abs() <= edge {
                out[written..].fill(0.0);
                return;
            }
        }
    }
}
