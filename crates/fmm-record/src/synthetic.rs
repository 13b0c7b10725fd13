//! Records for the tests of this crate: made up with known truth, and the measured ones of the repository.

use std::f64::consts::PI;

use crate::{Quantity, Record};

/// Reproducible random numbers: a 64-bit congruential generator (Knuth's constants).
pub(crate) struct Noise(u64);

impl Noise {
    pub(crate) fn new(seed: u64) -> Self {
        let mut noise = Self(seed ^ 0x9E37_79B9_7F4A_7C15);
        noise.next();
        noise
    }

    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 16
    }

    /// Uniform in (0, 1).
    pub(crate) fn uniform(&mut self) -> f64 {
        ((self.next() & 0xFFFF_FFFF) as f64 + 0.5) / 4_294_967_296.0
    }

    /// Normal with mean 0 and standard deviation 1 (Box and Muller).
    pub(crate) fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (2.0 * PI * self.uniform()).cos()
    }
}

/// Free decay of an oscillator with dry friction, in closed form per half swing.
///
/// ```text
/// x″ + ω² x = −ω² d sign(x′)
/// ```
///
/// Released from `amplitude` at `release` (s); it stops where a swing ends with |x| ≤ d.
#[derive(Clone, Copy)]
pub(crate) struct CoulombDecay {
    pub(crate) frequency: f64,
    pub(crate) amplitude: f64,
    /// d, half of what each half swing loses.
    pub(crate) deadband: f64,
    pub(crate) release: f64,
}

impl CoulombDecay {
    /// Displacement and velocity at time `t` (s).
    pub(crate) fn state(&self, t: f64) -> (f64, f64) {
        let w = 2.0 * PI * self.frequency;
        let phase = w * (t - self.release).max(0.0);
        // Half swing k goes from ±(A − 2kd) to the other side; motion ends when the turning point lies within d.
        let last = ((self.amplitude - self.deadband) / (2.0 * self.deadband)).ceil().max(0.0);
        let k = (phase / PI).floor();
        let side = |k: f64| if k % 2.0 == 0.0 { 1.0 } else { -1.0 };
        if k >= last {
            return (side(last) * (self.amplitude - 2.0 * last * self.deadband), 0.0);
        }
        let from = self.amplitude - 2.0 * k * self.deadband;
        let (sin, cos) = (phase - k * PI).sin_cos();
        let swing = from - self.deadband;
        (side(k) * (self.deadband + swing * cos), -side(k) * w * swing * sin)
    }

    /// Time at which motion ends (s).
    pub(crate) fn stop(&self) -> f64 {
        let last = ((self.amplitude - self.deadband) / (2.0 * self.deadband)).ceil().max(0.0);
        self.release + last / (2.0 * self.frequency)
    }
}

/// A record of `f` over `duration` (s) at `rate` (Hz), plus `offset` and noise.
pub(crate) fn sampled(
    rate: f64,
    duration: f64,
    quantity: Quantity,
    noise: f64,
    mut f: impl FnMut(f64) -> f64,
) -> Record {
    let mut random = Noise::new(7);
    let count = (rate * duration) as u32;
    let values = (0..count).map(|i| f(f64::from(i) / rate) + noise * random.normal()).collect();
    Record::sampled(rate, values, quantity, "1").unwrap()
}

/// The same record as a converter of step `step` gives it.
pub(crate) fn quantised(record: &Record, step: f64) -> Record {
    let values = record.values().iter().map(|value| (value / step).round() * step).collect();
    Record::new(record.start(), record.interval(), values, record.quantity(), record.unit()).unwrap()
}

fn measured(name: &str) -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/data").join(name)
}

/// Numbers of a plain comma separated file; the readers have tests of their own and may be switched off.
fn column(name: &str, column: usize) -> Vec<f64> {
    let text = std::fs::read_to_string(measured(name)).unwrap();
    text.lines().skip(1).map(|line| line.split(',').nth(column).unwrap().parse().unwrap()).collect()
}

/// Path of the fork's file.
#[cfg(feature = "mat")]
pub(crate) fn fork_path() -> std::path::PathBuf {
    measured("BrowserForkCompoundFirst1.mat")
}

/// Free swing of a bicycle fork, gyro voltage, 1 kHz, 30 s.
#[cfg(feature = "mat")]
pub(crate) fn fork() -> Record {
    let file = crate::mat::read(fork_path()).unwrap();
    Record::sampled(1000.0, file.array("data").unwrap().values().to_vec(), Quantity::Velocity, "V").unwrap()
}

/// Torsional swing of a bicycle wheel, angular velocity, 500 Hz, 2 s.
pub(crate) fn wheel() -> Record {
    Record::sampled(500.0, column("bicycle_wheel_radial_gyro.csv", 1), Quantity::Velocity, "rad/s").unwrap()
}

/// Free swing of a pendulum, angle about π, 1 kHz, 55 s.
pub(crate) fn pendulum() -> Record {
    let angle = column("single_pendulum_55s_1khz.csv", 1);
    Record::sampled(1000.0, angle, Quantity::Displacement, "rad").unwrap()
}

/// Velocity of the same.
pub(crate) fn pendulum_velocity() -> Record {
    let velocity = column("single_pendulum_55s_1khz.csv", 2);
    Record::sampled(1000.0, velocity, Quantity::Velocity, "rad/s").unwrap()
}
