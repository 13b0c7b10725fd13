//! Friction of each half cycle from the energies at its turning points.

use fmm_model::Oscillator;
use fmm_record::Record;

use crate::Found;

/// Friction force (N) of each half cycle between `reversals`, times of zero velocity (s), of a velocity `record`
/// without offset that begins at `initial_position` (m) at time 0.
///
/// ```text
/// F = (E_j − E_{j+1} − ∫F_c(v) v dt)/|x_j − x_{j+1}|,       E = potential energy at a turning point
/// ```
///
/// Where the velocity is zero all energy is in the spring: no acceleration is needed, and only an integral of the
/// record. Noise of standard deviation σ adds up in it: u²(x) = σ² h t.
pub(super) fn friction_of_half_cycles(
    record: &Record,
    oscillator: &Oscillator,
    initial_position: f64,
    reversals: &[f64],
) -> Found<Vec<f64>> {
    let damping = oscillator.damping();
    let power: Vec<f64> = record.values().iter().map(|v| v * damping.force(*v)).collect();
    let turn = |time: &f64| {
        (
            initial_position + integral(record.values(), record.interval(), *time),
            integral(&power, record.interval(), *time),
        )
    };
    let turns: Vec<(f64, f64)> = reversals.iter().map(turn).collect();
    let friction = |pair: &[(f64, f64)]| {
        let [(first, work_before), (last, work_after)] = [pair[0], pair[1]];
        let distance = (last - first).abs();
        if !(distance > 0.0) {
            return Err(format!("nothing moves between two reversals at {first} m").into());
        }
        let loss = oscillator.potential_energy(first) - oscillator.potential_energy(last);
        Ok((loss - (work_after - work_before)) / distance)
    };
    turns.windows(2).map(friction).collect()
}

/// The integral of samples, `interval` (s) apart, by the trapezoidal rule up to `time` (s).
fn integral(samples: &[f64], interval: f64, time: f64) -> f64 {
    let at = time / interval;
    let whole = (at.max(0.0) as usize).min(samples.len().saturating_sub(2));
    let sum: f64 = samples[..=whole].windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).sum();
    let (before, after) = (samples[whole], samples[whole + 1]);
    let part = (at - whole as f64).clamp(0.0, 1.0);
    interval * (sum + part * (before + 0.5 * part * (after - before)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chapter_6_energy::{Example, friction};
    use crate::ring_down::tests::{close, statistics};
    use crate::ring_down::{velocity_record, with_noise};

    /// Each half cycle by the energies at its ends: 0.0005, 0.004 and 0.04 N as a mean over the half cycles.
    #[test]
    fn friction_of_each_half_cycle() {
        const REPETITIONS: u64 = 200;
        let example = Example::new().unwrap();
        let forces = |noise: f64, seed: u64| {
            let values = with_noise(example.contact.velocity().values(), noise, seed).unwrap();
            let (oscillator, position) = (example.scenario.oscillator(), example.scenario.initial().position);
            let record = velocity_record(values).unwrap();
            friction_of_half_cycles(&record, oscillator, position, &example.reversals).unwrap()
        };
        let clean = forces(0.0, 0);
        assert_eq!(clean.len(), 6);
        for force in &clean {
            // The trapezoidal rule over the kink of the velocity is off by h² F/4m at most.
            assert!((force - friction()).abs() < 4e-4, "{force} N");
        }
        for (noise, printed) in [(1e-5, 0.0005), (1e-4, 0.004), (1e-3, 0.040)] {
            let all: Vec<_> = (0..REPETITIONS).map(|seed| forces(noise, seed)).collect();
            let mut deviations = 0.0;
            for j in 0..clean.len() {
                let (mean, deviation) = statistics(&all.iter().map(|forces| forces[j]).collect::<Vec<_>>());
                assert!((mean - friction()).abs() < 4e-4 + 0.3 * deviation, "half cycle {j}: {mean} N");
                deviations += deviation / clean.len() as f64;
            }
            close(deviations, printed, 0.2, &format!("{noise} m/s: std (N)"));
        }
    }
}
