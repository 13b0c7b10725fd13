//! The drag term of section 5.2: what a record of 5 s and one of 45 s say of it.

use fmm_fit::{Fit, Options, solve};
use fmm_identify::Problem;

use super::identifiability::{NOISE, WINDOW};
use super::simulated::{a1_of_stiffness, machine, motion, place, record, rms};
use crate::printed::{INSTANTANEOUS_SLOPE, MACHINE, TABLE_1};
use crate::{Chapter, Found};

/// The length that the text gives (s).
pub(super) const COMPLETE: f64 = 45.0;

/// Results of fits without and with a drag term to a record of this length.
struct Outcome {
    seconds: f64,
    /// Misfit (m/s) and damping (N s/m) of the linear fit.
    linear: [f64; 2],
    /// Drag coefficient (N s²/m²) of the other, and its standard uncertainty with noise.
    quadratic: [f64; 2],
}

impl Outcome {
    fn of(seconds: f64) -> Found<Self> {
        let peak = 1e-3 * TABLE_1[TABLE_1.len() - 1].velocity;
        let motion = motion(machine(INSTANTANEOUS_SLOPE)?, (0.0, peak), seconds)?;
        let record = record(motion.velocity().values(), 0.0, 0)?;
        let fitted =
            |problem: &Problem<'_>| -> Found<Fit> { Ok(solve(problem, problem.values(), &Options::default())?) };
        let linear = a1_of_stiffness(&record, MACHINE)?;
        let without = fitted(&linear)?;
        let damping = without.values()[place(&linear, "damping")?];
        let quadratic = linear.free("quadratic_damping")?;
        let with = fitted(&quadratic)?;
        let drag = place(&quadratic, "quadratic_damping")?;
        let unit = with.unit_covariance(drag, drag).ok_or("the drag is not determined")?;
        Ok(Self {
            seconds,
            linear: [rms(without.residuals()), damping],
            quadratic: [with.values()[drag], NOISE * unit.sqrt()],
        })
    }
}

/// Section 5.2: an air drag was tried and dropped, and came back as Eq. 5.5.
pub(super) fn of_the_leaf_springs(chapter: &mut Chapter) -> Found<()> {
    let [short, long] = [Outcome::of(WINDOW)?, Outcome::of(COMPLETE)?];
    let row = |outcome: &Outcome| {
        let Outcome { seconds, linear: [misfit, damping], quadratic: [drag, u] } = outcome;
        vec![
            seconds.to_string(),
            format!("{damping:.4}"),
            format!("{:.3}", 1e3 * misfit),
            format!("{drag:.4}"),
            format!("{u:.4}"),
        ]
    };
    chapter.table(
        format!(
            "A record with drag (c₂ = {INSTANTANEOUS_SLOPE:.4} N s²/m², from 283 mm/s), fitted without and with it; u at {} mm/s of \
             white noise",
            1e3 * NOISE
        ),
        &["fitted / s", "linear fit: c / (N s/m)", "misfit / (mm/s)", "with drag: c₂ / (N s²/m²)", "u(c₂) / (N s²/m²)"],
        vec![row(&short), row(&long)],
    );
    chapter.finding(
        "The drag term that section 5.2 discards is Eq. 5.5",
        format!(
            "A force c₂ v|v| is a damping that grows as 8/(3π) c₂ V, the line of Eq. 5.5. In {} s a linear damping fits a record \
             with drag to {:.3} mm/s, far below the noise, and c₂ is known to ±{:.2} N s²/m² only: no wonder that it \"offered no \
             change\". In {} s the misfit is {:.1} mm/s and u(c₂) {:.4} N s²/m²: the windows were too short.",
            short.seconds,
            1e3 * short.linear[0],
            short.quadratic[1],
            long.seconds,
            1e3 * long.linear[0],
            long.quadratic[1]
        ),
        &["E24"],
    );
    Ok(())
}
