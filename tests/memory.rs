//! Ten million samples: the whole job in bounded memory.

use fmm_friction::CoulombViscous;
use fmm_identify::{Experiment, Machine, Preparation, identify};
use fmm_model::Oscillator;
use fmm_record::{Quantity, Record};
use fmm_sim::{Channels, Engine, Exact, Sampling, Scenario};

const SAMPLES: usize = 10_000_000;
/// One double per sample (MB).
const COLUMN: usize = SAMPLES * 8 / 1_000_000;
/// The record, its prepared copy, a copy to judge its noise by, the residuals now and at a trial point, six columns of
/// derivatives, and as much again as two columns for everything else.
const LIMIT: usize = 13 * COLUMN;

/// Largest memory that the process has used so far (MB), where the system tells.
fn peak_memory() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<usize>().ok()? / 1000)
}

#[test]
fn ten_million_samples() {
    // 2 Hz at 1 MHz for 10 s.
    let interval = 1e-6;
    let law = CoulombViscous::new(0.1, 0.05).unwrap();
    let scenario = Scenario::new(Oscillator::per_unit_mass(2.0).unwrap(), law, 1.0).unwrap();
    let sampling = Sampling::uniform(interval, SAMPLES).unwrap().keeping(Channels::Velocity);
    let motion = Exact.run(&scenario.starting_at(0.03, 0.0).unwrap(), &sampling).unwrap();
    // Noise of 1 mm/s, deterministic: the record must not be so smooth that any fit is exact.
    let mut state = 1_u64;
    let mut noise = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let values = motion.velocity().values().iter().map(|v| v + 3.5e-3 * noise()).collect();
    drop(motion);
    let record = Record::new(0.0, interval, values, Quantity::Velocity, "m/s").unwrap();

    let decay = Experiment::ring_down(&record, &Preparation::default()).unwrap();
    let found = identify::<CoulombViscous>(&Machine::per_unit_mass(), &[decay]).unwrap();
    for (name, truth) in [("natural_frequency_hz", 2.0), ("friction_per_mass", 0.1), ("damping_per_mass", 0.05)] {
        let finding = found.finding(name).unwrap();
        let error = (finding.value() - truth) / finding.uncertainty().unwrap();
        assert!(error.abs() < 5.0, "{name} is {error} standard uncertainties off\n{found}");
    }
    if let Some(peak) = peak_memory() {
        assert!(peak < LIMIT, "{peak} MB were used, the limit is {LIMIT} MB");
    }
}
