//! A stand-in for a measurement, for whoever has none at hand.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

use fmm_friction::CoulombViscous;
use fmm_model::Oscillator;
use fmm_sim::{Engine, Exact, Sampling, Scenario};
use fmm_uq::Distribution;

/// Writes the velocity of 10.391 kg on 1982 N/m after a release at 15 mm, with μ = 0.25 and β = 0.02 s/m under 14 N, as
/// a vibrometer with 0.2 mm/s of noise gives it at 1 kHz.
pub fn write(path: &Path) -> Result<(), Box<dyn Error>> {
    let law = CoulombViscous::new(0.25, 0.02)?;
    let scenario = Scenario::new(Oscillator::new(10.391, 1982.0)?, law, 14.0)?.starting_at(0.015, 0.0)?;
    let sampling = Sampling::uniform(1e-3, 1500)?;
    let motion = Exact.run(&scenario, &sampling)?;

    let noise = Distribution::normal(0.0, 2e-4)?;
    let mut random = 0_u32;
    let mut text = String::from("# stand-in for a vibrometer, 1 kHz\ntime (s),velocity (m/s)\n");
    for (i, velocity) in motion.velocity().values().iter().enumerate() {
        // Numerical Recipes' generator is plenty for a noise that only has to look like one, the same every time.
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let noise = noise.quantile((f64::from(random) + 0.5) / 2.0_f64.powi(32))?;
        writeln!(text, "{:.3},{:.6}", sampling.time(i), velocity + noise)?;
    }
    std::fs::write(path, text)?;
    Ok(())
}
