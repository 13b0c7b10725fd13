//! Figures 8, 9 and 12.

use fmm_fit::{Options, solve};

use super::drag::COMPLETE;
use super::identifiability::NOISE;
use super::regressions::table_1_line;
use super::simulated::{a1_of_stiffness, machine, motion, record, rms, samples};
use super::windows::Column;
use crate::printed::{INSTANTANEOUS_SLOPE, MACHINE, TABLE_1};
use crate::ring_down::INTERVAL;
use crate::{Chapter, Found, Settings};
use fmm_cli::figure::{Panel, Role, label};

/// Release of the record of Figs 8 and 9 (m), that of program A1.
const RELEASE: f64 = 0.02;
/// Cycles that are left out after the release, and that Fig. 9 shows.
const LEFT_OUT: f64 = 5.0;
const CLOSE: f64 = 3.0;
/// Where Fig. 9 begins (s).
const CLOSE_FROM: f64 = 20.0;

/// Figs 8 and 9: the fit of a linear damping to a record whose damping is not.
pub(super) fn complete_test(chapter: &mut Chapter, settings: &Settings<'_>) -> Found<()> {
    let machine = machine(INSTANTANEOUS_SLOPE)?;
    let period = 1.0 / machine.natural_frequency();
    let whole = motion(machine, (-RELEASE, 0.0), LEFT_OUT * period + COMPLETE)?;
    let velocity = whole.velocity().values();
    let whole = record(velocity, NOISE, settings.seed())?;
    // From the velocity peak a quarter of a cycle after the fifth.
    let skipped = samples((LEFT_OUT + 0.25) * period);
    let peak = velocity[skipped - 100..skipped + 100].iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
    let first = skipped - 100 + peak.map_or(100, |(index, _)| index);
    let record = whole.crop(whole.time(first), whole.end())?;
    let problem = a1_of_stiffness(&record, MACHINE)?;
    let fit = solve(&problem, problem.values(), &Options::default())?;

    let curves = |from: f64, to: f64| {
        let indices = samples(from) - 1..samples(to).min(record.len());
        let point = |value: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
            indices.clone().map(|index| (index as f64 * INTERVAL, value(index))).collect()
        };
        let measured = point(&|index| record.values()[index]);
        let fitted = point(&|index| record.values()[index] + fit.residuals()[index]);
        let residual = point(&|index| -1e3 * fit.residuals()[index]);
        let time = label("time", "s");
        [
            Panel::new(time.clone(), label("velocity", "m/s"), 300.0)
                .with(Role::Measured, "simulated record", measured)
                .with(Role::Fitted, "linear damping, fitted", fitted),
            Panel::new(time, label("residual", "mm/s"), 200.0).with(Role::Residual, "record less fit", residual),
        ]
    };
    let truth = format!(
        "The record is simulated: 20 mm, the first five cycles left out, c = 0.2005 + 0.5148 |v|, {} mm/s of white noise.",
        1e3 * NOISE
    );
    chapter.figure(
        "figure_8",
        format!(
            "Fig. 8: fit of m, c and x₀ with a linear damping to a complete test; residual {:.2} mm/s rms. {truth}",
            1e3 * rms(fit.residuals())
        ),
        &curves(0.0, COMPLETE),
    );
    chapter.figure(
        "figure_9",
        format!("Fig. 9: three cycles of Fig. 8. {truth}"),
        &curves(CLOSE_FROM, CLOSE_FROM + CLOSE * period),
    );
    Ok(())
}

/// Fig. 12: Table 1's damping, its line, and what five-cycle fits give with either law.
pub(super) fn figure_12(chapter: &mut Chapter, [right, appendix]: &[Column; 2]) -> Found<()> {
    let line = table_1_line()?;
    let velocity = TABLE_1.map(|row| 1e-3 * row.velocity);
    let points = |damping: &[f64]| -> Vec<(f64, f64)> { velocity.into_iter().zip(damping.iter().copied()).collect() };
    let less_line = |damping: &[f64]| -> Vec<(f64, f64)> {
        velocity.into_iter().zip(damping).map(|(v, c)| (v, 1e3 * (c - line.value(v)))).collect()
    };
    let printed = TABLE_1.map(|row| row.damping);
    let regression = velocity.map(|v| line.value(v));
    let x_label = label("peak velocity", "m/s");
    let panels = [
        Panel::new(x_label.clone(), label("damping c", "N s/m"), 420.0)
            .with(Role::Points, "Table 1, as printed", points(&printed))
            .with(
                Role::Fitted,
                format!("regression: {:.4} V + {:.4}", line.slope(), line.intercept()),
                points(&regression),
            )
            .with(Role::Residual, "five-cycle fits, c₂ = 0.437 (A5)", points(&appendix.damping)),
        Panel::new(x_label, label("c less line", "10⁻³ N s/m"), 300.0)
            .with(Role::Points, "Table 1, as printed", less_line(&printed))
            .with(Role::Fitted, "five-cycle fits, c₂ = 0.5148", less_line(&right.damping)),
    ];
    chapter.figure(
        "figure_12",
        "Fig. 12: damping against peak velocity. Points are the printed rows of Table 1, the red line above is the regression on \
         them, and below is what is left after it. Five-cycle fits are to simulated records without noise, whose \
         instantaneous damping is 0.2005 + c₂ |v|.",
        &panels,
    );
    Ok(())
}
