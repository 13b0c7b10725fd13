//! Section 7.2: one coefficient per test, Figs 18 and 19, and Table 4 as a round trip.

use fmm_friction::Coulomb;
use fmm_record::{EndRule, Smoothing};
use fmm_uq::Observations;

use super::{Known, LOAD_4, Release, fit_panels, largest, rms, seed, value};
use crate::printed::{MACHINE, TABLE_4};
use crate::ring_down::{INTERVAL, Viscous, over_time, velocity_record};
use crate::{Chapter, Criterion, Found, Settings, Target};
use fmm_cli::figure::{Panel, Role};

/// White noise of the round trip (m/s).
const NOISE: f64 = 2e-4;
/// Where the thesis begins its fits.
const START: [(&str, f64); 1] = [("coefficient", 0.1)];

pub(super) fn add(chapter: &mut Chapter, settings: &Settings<'_>) -> Found<()> {
    round_trip(chapter, settings)?;
    mean_against_line(chapter)?;
    fixed_velocity(chapter, settings)?;
    let [_, stiffness, damping] = MACHINE;
    chapter.finding(
        "Eq. 7.1 prints one sign of the friction, and is not the Euler method that it is called.",
        format!(
            "The sign is that of x′, and x takes the new x′: the method is semi-implicit, as in A4. Read as explicit Euler it would have a \
             damping of c − k Δt = {:.2} N s/m and grow.",
            damping - stiffness * INTERVAL
        ),
        &["E18"],
    );
    figures(chapter, settings)
}

/// Table 4 as truth, for each of its two columns.
fn round_trip(chapter: &mut Chapter, settings: &Settings<'_>) -> Found<()> {
    // Five as in the thesis.
    let tests = settings.repetitions(5, 3);
    let mut cells: Vec<Vec<String>> = TABLE_4.iter().map(|row| vec![format!("{}", row.0)]).collect();
    for (number, (column, viscous)) in [("linear c", Viscous::Line), ("mean c", Viscous::Mean)].into_iter().enumerate()
    {
        let (mut clean, mut noisy, mut single) = (Vec::new(), Vec::new(), Vec::new());
        for (i, row) in TABLE_4.iter().enumerate() {
            let truth = if viscous == Viscous::Line { row.1[0] } else { row.2[0] };
            let release = Release { viscous, law: &[truth], load: LOAD_4, displacement: row.0 };
            let known = Known { viscous, load: LOAD_4 };
            let found = |noise: f64, test: usize| -> Found<f64> {
                let record = release.record::<Coulomb>(noise, seed(settings, number as u64, i, test))?;
                value(&known.fit::<Coulomb>(&record, &START)?, "coefficient")
            };
            let exact = found(0.0, 0)?;
            let scattered = (0..tests).map(|test| found(NOISE, test)).collect::<Found<Vec<_>>>()?;
            single.extend(scattered.iter().map(|found| found / truth - 1.0));
            let scattered = Observations::new(&scattered)?.mean();
            clean.push(exact / truth - 1.0);
            noisy.push(scattered / truth - 1.0);
            cells[i].extend([format!("{truth:.3}"), format!("{exact:.6}"), format!("{scattered:.5}")]);
        }
        let quantity = |of: &str| format!("Table 4, {column}, μ found less truth, {of}");
        chapter.target(
            Target::new("C7", quantity("clean, largest of 15"), "%", 100.0 * largest(clean), Criterion::AtMost(0.01))
                .note("printed μ as truth at 14 N; 1 kHz, from the highest velocity to rest, v₀ free"),
        );
        chapter.target(
            Target::new(
                "C7",
                quantity("0.2 mm/s of noise, mean of tests, largest of 15"),
                "%",
                100.0 * largest(noisy.iter().copied()),
                Criterion::AtMost(0.1),
            )
            .note(format!("{tests} tests of each displacement; rms of a single test {:.3} %", 100.0 * rms(&single))),
        );
    }
    chapter.table(
        "Table 4 as a round trip at 14 N: coefficient of the thesis as truth, found without noise and as a mean of tests with 0.2 mm/s of it",
        &["x₀ / mm", "linear c, truth", "clean", "noisy", "mean c, truth", "clean", "noisy"],
        cells,
    );
    Ok(())
}

/// Coefficients that the two dampings give for one record.
fn mean_against_line(chapter: &mut Chapter) -> Found<()> {
    let mut differences = Vec::new();
    for row in &TABLE_4 {
        let release = Release { viscous: Viscous::Line, law: &[row.1[0]], load: LOAD_4, displacement: row.0 };
        let mean = Known { viscous: Viscous::Mean, load: LOAD_4 };
        let fit = mean.fit::<Coulomb>(&release.record::<Coulomb>(0.0, 0)?, &START)?;
        differences.push(value(&fit, "coefficient")? - row.1[0]);
    }
    let worst = largest(differences.iter().copied());
    chapter.target(
        Target::new("C7", "μ by mean c less μ by linear c, same record, largest", "1", worst, Criterion::AtMost(5e-4))
            .note("below the last printed digit: the two columns of Table 4 may differ by it and no more"),
    );
    let (row, ours) = TABLE_4.iter().zip(&differences).find(|(row, _)| row.0 == 13.0).ok_or("Table 4 lacks a row")?;
    let others = TABLE_4.iter().filter(|row| row.0 != 13.0).map(|row| row.1[0] - row.2[0]);
    chapter.finding(
        "The two coefficients of the 13 mm row of Table 4 cannot come from the same data.",
        format!(
            "Printed are {:.3} with linear and {:.3} with mean damping; from one record they would differ by {:+.5}, and by \
             {worst:.5} at most in any row. All other rows differ by {:.3} at most. Table 5 has no row of 13 mm at all.",
            row.1[0],
            row.2[0],
            -ours,
            largest(others)
        ),
        &["E27", "E28"],
    );
    Ok(())
}

/// The thesis' fit begins at the highest sample and holds it as initial velocity.
fn fixed_velocity(chapter: &mut Chapter, settings: &Settings<'_>) -> Found<()> {
    const LOUD: f64 = 1e-3;
    let tests = settings.repetitions(40, 10);
    let known = Known { viscous: Viscous::Mean, load: LOAD_4 };
    let smoothing = Smoothing::MovingAverage { span: 5, ends: EndRule::Shrinking };
    let mut cells = Vec::new();
    let mut texts = Vec::new();
    for (i, row) in TABLE_4.iter().enumerate().filter(|(_, row)| [8.0, 22.0].contains(&row.0)) {
        let truth = row.2[0];
        let release = Release { viscous: Viscous::Mean, law: &[truth], load: LOAD_4, displacement: row.0 };
        let mut errors: [Vec<f64>; 3] = Default::default();
        for test in 0..tests {
            // The record begins before the top, so that the highest sample is one of many.
            let record = release.before_top::<Coulomb>(LOUD, seed(settings, 2, i, test))?;
            for (errors, smoothed) in errors.iter_mut().zip([None, Some(&smoothing)]) {
                let record = smoothed.map_or_else(|| Ok(record.clone()), |smoothing| record.smoothed_by(smoothing))?;
                let cut = from_highest(record.values())?;
                let fit = known.fit_holding_velocity::<Coulomb>(&cut, &START)?;
                errors.push(100.0 * (value(&fit, "coefficient")? / truth - 1.0));
            }
            let fit = known.fit::<Coulomb>(&from_highest(record.values())?, &START)?;
            errors[2].push(100.0 * (value(&fit, "coefficient")? / truth - 1.0));
        }
        let [held, smoothed, free] = errors.map(|errors| Observations::new(&errors));
        let (held, smoothed, free) = (held?, smoothed?, free?);
        let text = |of: &Observations| format!("{:+.3} ± {:.3}", of.mean(), of.standard_deviation());
        cells.push(vec![format!("{}", row.0), text(&held), text(&smoothed), text(&free)]);
        texts.push(format!("{:+.2} % at {} mm ({:+.2} % smoothed)", held.mean(), row.0, smoothed.mean()));
        let quantity = format!("μ found less truth, v₀ free, 1 mm/s of noise, {} mm, mean", row.0);
        // Four standard uncertainties of the mean; the bias itself is below 0.01 %.
        let criterion = Criterion::near(0.0, 4.0 * free.standard_uncertainty() + 0.01);
        chapter
            .target(Target::new("C7", quantity, "%", free.mean(), criterion).note(format!("{tests} simulated tests")));
    }
    chapter.table(
        format!(
            "Coefficient less truth / %, mean ± standard deviation of {tests} simulated tests with 1 mm/s of noise"
        ),
        &["x₀ / mm", "v₀ held at the highest sample", "the same, smoothed over 5", "v₀ free"],
        cells,
    );
    chapter.finding(
        "Holding the initial velocity at the highest sample of a noisy record makes the coefficient too large.",
        format!(
            "The highest of many noisy samples is above the motion. With 1 mm/s of noise it costs {}; with the velocity free no \
             bias is left.",
            texts.join(" and ")
        ),
        &[],
    );
    Ok(())
}

/// The part of `values` from the highest on, as a record.
fn from_highest(values: &[f64]) -> Found<fmm_record::Record> {
    // The first swing holds it.
    let highest = (0..values.len().min(300)).max_by(|&i, &j| values[i].total_cmp(&values[j])).unwrap_or(0);
    velocity_record(values[highest..].to_vec())
}

fn figures(chapter: &mut Chapter, settings: &Settings<'_>) -> Found<()> {
    let row = TABLE_4[10];
    let release = Release { viscous: Viscous::Mean, law: &[row.2[0]], load: LOAD_4, displacement: row.0 };
    let test = |test: usize| release.record::<Coulomb>(5e-4, seed(settings, 3, 10, test));
    let mut velocities = Panel::new("time / s", "velocity / (mm/s)", 260.0);
    let mut departures = Panel::new("time / s", "test − mean of five / (mm/s)", 200.0);
    let tests = (0..5).map(test).collect::<Found<Vec<_>>>()?;
    let mean = |i: usize| tests.iter().map(|test| test.values()[i]).sum::<f64>() / tests.len() as f64;
    for test in &tests {
        velocities = velocities.with(Role::Measured, "five simulated tests", over_time(test.values(), 1e3));
        let left: Vec<f64> = test.values().iter().enumerate().map(|(i, v)| v - mean(i)).collect();
        departures = departures.with(Role::Residual, "departures of the tests", over_time(&left, 1e3));
    }
    chapter.figure(
        "figure_18",
        "Fig. 18. Five tests of 18 mm. Simulated, as no records are published: μ = 0.261 at 14 N, white noise of 0.5 mm/s. They \
         show what repeatability would look like if noise were all that differs.",
        &[velocities, departures],
    );
    let record = &tests[0];
    let known = Known { viscous: Viscous::Mean, load: LOAD_4 };
    let fit = known.fit::<Coulomb>(record, &START)?;
    chapter.figure(
        "figure_19",
        format!(
            "Fig. 19. Fit of one coefficient to a test of 18 mm, from the highest velocity on. The record is simulated: μ = 0.261 at \
             14 N, white noise of 0.5 mm/s; found μ = {:.5}.",
            value(&fit, "coefficient")?
        ),
        &fit_panels(record, &fit),
    );
    Ok(())
}
