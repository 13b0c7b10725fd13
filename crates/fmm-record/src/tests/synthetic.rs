//! Records for the tests of this crate: made up with known truth, and the measured ones of the repository.

use std::f64::consts::PI;

use crate::record::Record;
use crate::units::Quantity;

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

/// Free decay of an oscillator with dry friction, in closed form per half cycle.
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
    /// d, half of what each half cycle loses.
    pub(crate) deadband: f64,
    pub(crate) release: f64,
}

impl CoulombDecay {
    /// Displacement and velocity at time `t` (s).
    pub(crate) fn state(&self, t: f64) -> (f64, f64) {
        let w = 2.0 * PI * self.frequency;
        let phase = w * (t - self.release).max(0.0);
        // Half cycle k goes from ±(A − 2kd) to the other side; motion ends when the turning point lies within d.
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

/// Free decay of an oscillator with viscous damping and friction that may depend on speed or creep before it slides.
///
/// ```text
/// x″ + ω² x = −c x′ − q |x′| x′ − F(x′, z),        F = F_c (1 + s exp(−|x′|/v_s)) sign(x′), or F_c z with z′ = x′ (1 − z sign(x′))/l
/// ```
///
/// The second is the law of Dahl. It is released from 1 at time 0.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Decay {
    pub(crate) frequency: f64,
    /// F_c/ω², half of what a half cycle loses.
    pub(crate) deadband: f64,
    /// c/(2ω).
    pub(crate) damping: f64,
    /// q.
    pub(crate) quadratic: f64,
    /// s.
    pub(crate) rise: f64,
    /// v_s/ω.
    pub(crate) speed: f64,
    /// l.
    pub(crate) creep: Option<f64>,
}

impl Decay {
    /// Displacement and velocity/ω at intervals of `interval` (s), by Runge and Kutta's method, with stops.
    pub(crate) fn states(&self, interval: f64, count: usize) -> Vec<(f64, f64)> {
        // In units of 1/ω.
        let span = 2.0 * PI * self.frequency * interval;
        let steps = (span / 0.01).ceil().max(1.0);
        let h = span / steps;
        let level = |v: f64| self.deadband * (1.0 + self.rise * (-v.abs() / self.speed).exp());
        // While it slides one way, friction has that side.
        let slope = |[x, v, z]: [f64; 3], side: f64| {
            let friction = if self.creep.is_some() { self.deadband * z } else { level(v) * side };
            let creep = self.creep.map_or(0.0, |length| v * (1.0 - z * v.signum()) / length);
            [v, -x - (2.0 * self.damping + self.quadratic * v.abs()) * v - friction, creep]
        };
        let (mut state, mut side) = ([1.0_f64, 0.0, 0.0], 0.0_f64);
        let mut states = Vec::with_capacity(count);
        for _ in 0..count {
            states.push((state[0], state[1]));
            for _ in 0..steps as usize {
                if self.creep.is_none() && side == 0.0 {
                    if state[0].abs() <= level(0.0) {
                        state[1] = 0.0;
                        break;
                    }
                    side = -state[0].signum();
                }
                let along = |slope: [f64; 3], h: f64| std::array::from_fn(|i| state[i] + h * slope[i]);
                let a = slope(state, side);
                let b = slope(along(a, h / 2.0), side);
                let c = slope(along(b, h / 2.0), side);
                let d = slope(along(c, h), side);
                state = std::array::from_fn(|i| state[i] + h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]));
                if self.creep.is_none() && state[1] * side < 0.0 {
                    (state[1], side) = (0.0, 0.0);
                }
            }
        }
        states
    }

    /// One of the laws with random parameters, which comes to rest, or nearly, after about `half_cycles`.
    pub(crate) fn random(random: &mut Noise, half_cycles: f64) -> Self {
        let share = random.uniform();
        let smooth = Self {
            frequency: 2.2,
            deadband: share * 0.5 / half_cycles,
            damping: (1.0 - share) * 0.7 / half_cycles,
            quadratic: 0.0,
            rise: 0.0,
            speed: 1.0,
            creep: None,
        };
        match random.next() % 6 {
            0 => Self { damping: 0.0, deadband: 0.5 / half_cycles, ..smooth },
            1 => Self { damping: 0.7 / half_cycles, deadband: 0.0, ..smooth },
            2 => Self { rise: random.uniform(), speed: 0.02 + 0.3 * random.uniform(), ..smooth },
            // Down to 1/3 to 1/12, as 1/(1 + 4qk/3).
            3 => Self { damping: 0.0, deadband: 0.0, quadratic: (1.5 + 7.0 * share) / half_cycles, ..smooth },
            4 => Self { creep: Some(0.002 + 0.1 * random.uniform()), ..smooth },
            _ => smooth,
        }
    }
}

/// A ring-down as somebody might record it, with what is true of it.
#[derive(Debug, Clone)]
pub(crate) struct Recorded {
    pub(crate) record: Record,
    pub(crate) decay: Decay,
    /// Duration of the rest before it (s).
    pub(crate) rest: f64,
}

impl Recorded {
    /// Of 3 to 30 half cycles in velocity or displacement, with or without rest at both ends, noise of 0.1 % to 3 %
    /// and, sometimes, a converter of few bits.
    pub(crate) fn random(seed: u64) -> Self {
        let random = &mut Noise::new(seed);
        let half_cycles = 3.0 + 27.0 * random.uniform().powi(2);
        let decay = Decay::random(random, half_cycles);
        let rest = if random.uniform() < 0.5 { 0.0 } else { 0.3 + random.uniform() };
        let duration = rest + half_cycles / 4.4 * (0.7 + 1.5 * random.uniform());
        let rate = 200.0 * 10f64.powf(random.uniform());
        let noise = 1e-3 * 30f64.powf(random.uniform());
        let (before, count) = ((rest * rate) as usize, (duration * rate) as usize);
        let states = decay.states(rate.recip(), count - before);
        let displacement = random.uniform() < 0.5;
        let offset = random.normal();
        // What is held has the displacement from which it is released.
        let held = (if displacement { 1.0 } else { 0.0 }, 0.0);
        let value = |(x, v): (f64, f64)| if displacement { x } else { v };
        let values = std::iter::repeat_n(value(held), before).chain(states.into_iter().map(value));
        let values: Vec<f64> = values.map(|value| offset + value + noise * random.normal()).collect();
        let quantity = if displacement { Quantity::Displacement } else { Quantity::Velocity };
        let record = Record::sampled(rate, values, quantity, "1").unwrap();
        let record = if random.uniform() < 0.3 { quantised(&record, 0.005) } else { record };
        Self { record, decay, rest }
    }
}

/// A record of `f` over `duration` (s) at `rate` (Hz), plus `offset` and noise.
pub(crate) fn sampled(rate: f64, duration: f64, quantity: Quantity, noise: f64, f: impl FnMut(f64) -> f64) -> Record {
    sampled_by(&mut Noise::new(7), rate, duration, quantity, noise, f)
}

/// The same with noise of one's own.
pub(crate) fn sampled_by(
    random: &mut Noise,
    rate: f64,
    duration: f64,
    quantity: Quantity,
    noise: f64,
    mut f: impl FnMut(f64) -> f64,
) -> Record {
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
    let file = crate::open(fork_path()).unwrap();
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

/// The second column, or the only one, of a file among the test data of this crate.
fn tested(name: &str) -> Vec<f64> {
    let text = std::fs::read_to_string(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name));
    text.unwrap().lines().skip(1).map(|line| line.split(',').next_back().unwrap().parse().unwrap()).collect()
}

/// A simulated velocity with hum of 3.8 % of its peak, 1 kHz, 3 s.
pub(crate) fn with_hum() -> Record {
    Record::sampled(1000.0, tested("hum7.csv"), Quantity::Velocity, "m/s").unwrap()
}

/// A simulated velocity that is released twice, 1 kHz, 4 s.
pub(crate) fn released_twice() -> Record {
    Record::sampled(1000.0, tested("two_v.csv"), Quantity::Velocity, "m/s").unwrap()
}

/// Free swing of a small pendulum from 66 mrad to rest, encoder, 1 kHz, 6 s; its half period falls by 12 %.
pub(crate) fn small_pendulum() -> Record {
    Record::sampled(1000.0, tested("small_pendulum_1khz.csv"), Quantity::Displacement, "counts").unwrap()
}

/// The measured records of the repository.
pub(crate) fn measured_records() -> Vec<Record> {
    let records = vec![wheel(), pendulum(), pendulum_velocity(), small_pendulum()];
    #[cfg(feature = "mat")]
    let records = [records, vec![fork()]].concat();
    records
}
