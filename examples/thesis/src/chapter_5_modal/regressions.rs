//! Regressions over the printed numbers.

use fmm_fit::{StraightLine, Weighting};
use fmm_model::Oscillator;
use fmm_uq::Observations;

use crate::printed::{EQUATION_5_5, FreeVibration, MACHINE, MACHINE_DEVIATIONS, TABLE_1};
use crate::{Chapter, Criterion, Found, Target};

/// The line through damping against velocity (m/s) in Table 1.
pub(super) fn table_1_line() -> Found<StraightLine> {
    let velocity = TABLE_1.map(|row| 1e-3 * row.velocity);
    Ok(StraightLine::fit(&velocity, &TABLE_1.map(|row| row.damping), Weighting::Equal)?)
}

/// Eq. 5.5, Table 2, the product m k, the natural frequency.
pub(super) fn of_printed_numbers(chapter: &mut Chapter) -> Found<()> {
    frequency(chapter)?;
    line(chapter)?;
    table_2(chapter)?;
    let product = Observations::new(&TABLE_1.map(|row| row.mass * row.stiffness))?;
    let a1 = 10.4 * 1980.0;
    chapter.target(
        Target::new("B5", "mean of m k over Table 1", "kg N/m", product.mean(), Criterion::near(20_599.0, 8.0))
            .note("a free fit keeps m k near its start, as only k/m is measured"),
    );
    chapter.target(
        Target::new("B5", "scatter of m k", "kg N/m", product.standard_deviation(), Criterion::AtMost(8.0))
            .note("0.04 %; the rounding of k alone makes 3 kg N/m"),
    );
    chapter.finding(
        "The start m = 14.4 kg in A1 is probably a misprint of 10.4 kg",
        format!(
            "m k of Table 1's rows is {:.0} ± {:.0} kg N/m; 10.4 kg · 1980 N/m = {a1:.0}, 14.4 kg · 1980 N/m = {:.0}. A fit \
             moves across the direction that it sees and keeps m k where it began.",
            product.mean(),
            product.standard_deviation(),
            14.4 * 1980.0
        ),
        &["E9"],
    );
    Ok(())
}

fn frequency(chapter: &mut Chapter) -> Found<()> {
    let frequency = Oscillator::new(MACHINE[0], MACHINE[1])?.natural_frequency();
    chapter.target(
        Target::new("A8", "natural frequency", "Hz", frequency, Criterion::near(2.2, 0.05))
            .printed("2.2")
            .note("from Table 2; 5.1 says \"about 2 Hz\", 8.3 says 2.2 Hz"),
    );
    chapter.target(
        Target::new("A8", "natural frequency, golden", "Hz", frequency, Criterion::near(2.198_078_935_2, 1e-9))
            .note("√(k/m)/2π in other arithmetic, eleven digits"),
    );
    let of = |row: &FreeVibration| Oscillator::new(row.mass, row.stiffness).map(|machine| machine.natural_frequency());
    let (first, last) = (of(&TABLE_1[0])?, of(&TABLE_1[TABLE_1.len() - 1])?);
    let stiffness = |row: &FreeVibration| MACHINE[0] * row.stiffness / row.mass;
    chapter.finding(
        "The falling mass of Table 1 is a rising frequency",
        format!(
            "k/m rises from {first:.4} Hz at 4 mm to {last:.4} Hz at 22 mm, {:+.2} %. A mass does not change with the \
             amplitude; with {} kg throughout, k goes from {:.1} to {:.1} N/m: the springs harden.",
            100.0 * (last / first - 1.0),
            MACHINE[0],
            stiffness(&TABLE_1[0]),
            stiffness(&TABLE_1[TABLE_1.len() - 1])
        ),
        &["E8"],
    );
    Ok(())
}

fn line(chapter: &mut Chapter) -> Found<()> {
    let line = table_1_line()?;
    let r_squared = line.regression().r_squared().ok_or("no R²")?;
    let [slope, intercept, printed_r_squared] = EQUATION_5_5;
    let half = "0.5 %: the rows are rounded to 0.001 N s/m";
    chapter.target(
        Target::new("B1", "slope of c over V", "N s²/m²", line.slope(), Criterion::within(slope, 5e-3))
            .printed("0.437")
            .note(half),
    );
    chapter.target(
        Target::new("B1", "intercept of c over V", "N s/m", line.intercept(), Criterion::within(intercept, 5e-3))
            .printed("0.2005")
            .note(half),
    );
    chapter.target(
        Target::new("B1", "R² of c over V", "1", r_squared, Criterion::near(printed_r_squared, 1e-3))
            .printed("0.997")
            .note("the nine rows of Table 1"),
    );
    let u = |u: Option<f64>| u.ok_or("a line has no uncertainty");
    chapter.finding(
        "Eq. 5.5 is the regression on Table 1's own rows",
        format!(
            "c = {:.4}({:.0}) V + {:.4}({:.0}), R² = {r_squared:.4}; printed {slope} V + {intercept}, R² = {printed_r_squared}. \
             V is a peak velocity, so the line is an equivalent damping, not a law of the instantaneous velocity.",
            line.slope(),
            1e4 * u(line.slope_uncertainty())?,
            line.intercept(),
            1e4 * u(line.intercept_uncertainty())?
        ),
        &[],
    );
    Ok(())
}

fn table_2(chapter: &mut Chapter) -> Found<()> {
    let column = |of: fn(&FreeVibration) -> f64| Observations::new(&TABLE_1.each_ref().map(of));
    let (mass, stiffness, damping) =
        (column(|row| row.mass)?, column(|row| row.stiffness)?, column(|row| row.damping)?);
    let row = |quantity: &str, unit, ours, criterion, printed: &str, note: &str| {
        Target::new("B2", quantity, unit, ours, criterion).printed(printed).note(note)
    };
    let digit = "half of the last printed digit";
    let rounded = "whole N/m in Table 1 leave half a unit of the mean; half of the last digit of s";
    let (m, k) = (&mass, &stiffness);
    chapter.target(row("mean m", "kg", m.mean(), Criterion::near(MACHINE[0], 5e-4), "10.391", digit));
    let deviation = m.standard_deviation();
    chapter.target(row("s(m)", "kg", deviation, Criterion::near(MACHINE_DEVIATIONS[0], 5e-5), "0.0049", digit));
    chapter.target(row("mean k", "N/m", k.mean(), Criterion::near(MACHINE[1], 0.5), "1982", rounded));
    let deviation = k.standard_deviation();
    chapter.target(row("s(k)", "N/m", deviation, Criterion::near(MACHINE_DEVIATIONS[1], 0.05), "1.3", rounded));
    let (mean, deviation) = (damping.mean(), damping.standard_deviation());
    let mismatch = "required is what Table 1 gives, which is not what Table 2 prints (E7)";
    chapter.target(
        Target::new("B3", "mean c", "N s/m", mean, Criterion::near(0.273_667, 5e-6)).printed("0.275").note(mismatch),
    );
    chapter.target(
        Target::new("B3", "s(c)", "N s/m", deviation, Criterion::near(0.036_325, 5e-6))
            .printed("0.0341")
            .note(mismatch),
    );
    let share = 100.0 * MACHINE_DEVIATIONS[2] / MACHINE[2];
    chapter.target(
        Target::new("A10", "s(c) of mean c", "%", share, Criterion::near(12.0, 0.5))
            .printed("12")
            .note("from Table 2; half of the last printed digit"),
    );
    let rows = [("m / kg", &mass, 4, 0), ("k / (N/m)", &stiffness, 1, 1), ("c / (N s/m)", &damping, 4, 2)];
    let rows = rows.map(|(name, ours, decimals, j)| {
        vec![
            name.to_owned(),
            MACHINE[j].to_string(),
            format!("{:.decimals$}", ours.mean()),
            MACHINE_DEVIATIONS[j].to_string(),
            format!("{:.*}", decimals + 1, ours.standard_deviation()),
        ]
    });
    chapter.table(
        "Table 2, and mean and standard deviation of the nine rows of Table 1",
        &["", "mean, thesis", "ours", "s, thesis", "ours"],
        rows.to_vec(),
    );
    // Table 1 with one more row, so that ten have the printed mean, and so that they scatter least.
    let count = TABLE_1.len() as f64;
    let needed = (count + 1.0) * MACHINE[2] - count * mean;
    let with = |twelfth: f64| {
        let rows: Vec<f64> = TABLE_1.iter().map(|row| row.damping).chain([twelfth]).collect();
        Observations::new(&rows).map(|rows| rows.standard_deviation())
    };
    chapter.finding(
        "Table 2's damping is not that of Table 1",
        format!(
            "The nine rows give {mean:.4} and {deviation:.4} N s/m, {:.1} % of the mean; printed are {} and {}. The row of \
             12 mm that the text announces is missing, but none explains it: {needed:.3} N s/m would give the mean, far above its \
             neighbours, with s = {:.4}, and no value at all gives less than {:.4}.",
            100.0 * deviation / mean,
            MACHINE[2],
            MACHINE_DEVIATIONS[2],
            with(needed)?,
            with(mean)?
        ),
        &["E6", "E7"],
    );
    Ok(())
}
