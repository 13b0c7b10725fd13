//! Section 7.4: friction that falls exponentially with the speed, Table 5, Figs 23 and 24.

use fmm_fit::Fit;
use fmm_friction::{Berger, SlidingLaw};
use fmm_uq::Observations;

use super::{Known, LOAD_5, Release, fit_panels, largest, rms, seed, value};
use crate::printed::TABLE_5;
use crate::ring_down::Viscous;
use crate::{Chapter, Criterion, Found, Settings, Target};
use fmm_cli::figure::{Panel, Role};

/// White noise of the tests (m/s).
const NOISE: f64 = 5e-4;
/// Where the thesis begins its fits.
const START: [(&str, f64); 3] = [("coefficient", 0.2), ("excess_coefficient", 0.2), ("decay", 5.0)];
const KNOWN: Known = Known { viscous: Viscous::Line, load: LOAD_5 };

pub(super) fn add(chapter: &mut Chapter, settings: &Settings<'_>) -> Found<()> {
    levels(chapter)?;
    clean(chapter)?;
    let rows = noisy(chapter, settings)?;
    table(chapter, &rows);
    finding(chapter, &rows);
    figures(chapter, settings, &rows)
}

fn release(row: &[f64; 5]) -> Release<'_> {
    Release { viscous: Viscous::Line, law: &row[2..], load: LOAD_5, displacement: row[0] }
}

/// Static and dynamic friction by the last row of Table 5.
fn levels(chapter: &mut Chapter) -> Found<()> {
    let row = TABLE_5[TABLE_5.len() - 1];
    let law = Berger::new(row[2], row[3], row[4])?;
    let last_digit = "last printed digit; 16 mm row";
    chapter.target(
        Target::new("A12", "static level μ₀ + μ₁", "1", law.breakaway(), Criterion::near(0.489, 5e-4))
            .printed("0.49")
            .note(last_digit),
    );
    // At 10 m/s the excess is below 1e-12.
    chapter.target(
        Target::new("A12", "dynamic level, at large speed", "1", law.coefficient(10.0), Criterion::near(0.228, 5e-4))
            .printed("0.23")
            .note(last_digit),
    );
    chapter.target(
        Target::new("A12", "Fig. 24, coefficient at 0.2 m/s", "1", law.coefficient(0.2), Criterion::near(0.376, 5e-4))
            .note("reference to its last digit; 16 mm row"),
    );
    Ok(())
}

/// μ₀, μ₁, α that a fit found.
fn found(fit: &Fit) -> Found<[f64; 3]> {
    Ok([value(fit, START[0].0)?, value(fit, START[1].0)?, value(fit, START[2].0)?])
}

fn clean(chapter: &mut Chapter) -> Found<()> {
    let mut errors = Vec::new();
    for row in &TABLE_5 {
        let fit = KNOWN.fit::<Berger>(&release(row).record::<Berger>(0.0, 0)?, &START)?;
        errors.extend(found(&fit)?.iter().zip(&row[2..]).map(|(ours, truth)| ours / truth - 1.0));
    }
    chapter.target(
        Target::new(
            "C8",
            "Table 5, μ₀, μ₁, α found less truth, clean, largest share",
            "1",
            largest(errors),
            Criterion::AtMost(1e-4),
        )
        .note("printed rows as truth at 8.604 N; started where A5 starts"),
    );
    Ok(())
}

/// One row of Table 5 as truth, with what tests with noise give.
struct Row {
    truth: [f64; 3],
    displacement: f64,
    /// With the true initial velocity held.
    tests: Vec<[f64; 3]>,
    /// With the initial velocity found.
    free: Vec<[f64; 3]>,
    /// Standard uncertainty of each in one test.
    uncertainty: [f64; 3],
    /// Correlation of μ₀ and μ₁ in one test.
    correlation: f64,
}

impl Row {
    fn errors(&self, j: usize) -> Vec<f64> {
        self.tests.iter().map(|test| test[j] - self.truth[j]).collect()
    }

    fn free_errors(&self, j: usize) -> Vec<f64> {
        self.free.iter().map(|test| test[j] - self.truth[j]).collect()
    }

    /// Relative errors of the static level.
    fn level_errors(&self) -> Vec<f64> {
        let truth = self.truth[0] + self.truth[1];
        self.tests.iter().map(|test| (test[0] + test[1]) / truth - 1.0).collect()
    }
}

fn noisy(chapter: &mut Chapter, settings: &Settings<'_>) -> Found<Vec<Row>> {
    let tests = settings.repetitions(20, 6);
    let mut rows = Vec::new();
    for (i, row) in TABLE_5.iter().enumerate() {
        let record = |test: usize| release(row).record::<Berger>(NOISE, seed(settings, 5, i, test));
        let velocity = release(row).velocity::<Berger>()?[0];
        let fit = |test: usize| KNOWN.fit_holding::<Berger>(&record(test)?, velocity, &START);
        let fits = (0..tests).map(fit).collect::<Found<Vec<_>>>()?;
        let exact = KNOWN.fit_holding::<Berger>(&release(row).record::<Berger>(0.0, 0)?, velocity, &START)?;
        let fit = |test: usize| found(&KNOWN.fit::<Berger>(&record(test)?, &START)?);
        let free = (0..tests).map(fit).collect::<Found<Vec<_>>>()?;
        let place =
            START.map(|(name, _)| exact.estimates().iter().position(|estimate| estimate.name() == name).unwrap_or(0));
        let uncertainty = place.map(|j| exact.unit_covariance(j, j).map(|variance| NOISE * variance.sqrt()));
        let [Some(floor), Some(excess), Some(decay)] = uncertainty else {
            return Err("Eq. 7.4 is not determined".into());
        };
        rows.push(Row {
            truth: [row[2], row[3], row[4]],
            displacement: row[0],
            tests: fits.iter().map(found).collect::<Found<_>>()?,
            free,
            uncertainty: [floor, excess, decay],
            correlation: exact.correlation(place[0], place[1]).ok_or("μ₀ and μ₁ are not determined")?,
        });
        settings.done(0.5 + 0.35 * (i + 1) as f64 / TABLE_5.len() as f64);
    }
    let all = |errors: &dyn Fn(&Row) -> Vec<f64>| rows.iter().flat_map(errors).collect::<Vec<_>>();
    let note = || {
        format!(
            "{} simulated tests, 0.5 mm/s of noise, true v₀ held; a spread: a test may be off by twice as much",
            6 * tests
        )
    };
    let level = 100.0 * rms(&all(&Row::level_errors));
    chapter.target(
        Target::new("C8", "Table 5, μ₀ + μ₁ of a test less truth, rms", "%", level, Criterion::AtMost(1.0))
            .note(note()),
    );
    for (j, (name, unit, limit)) in [("μ₀", "1", 0.05), ("μ₁", "1", 0.05), ("α", "s/m", 1.5)].into_iter().enumerate()
    {
        let told = rms(&rows.iter().map(|row| row.uncertainty[j]).collect::<Vec<_>>());
        let quantity = format!("Table 5, {name}, standard uncertainty of a test, rms of 6 rows");
        let target = Target::new("C8", quantity, unit, told, Criterion::AtMost(limit));
        chapter.target(target.note("linear, at the truth, 0.5 mm/s of noise, v₀ held"));
        let errors = all(&|row: &Row| row.errors(j));
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        let quantity = format!("Table 5, {name}, mean of all tests less truth");
        chapter.target(Target::new("C8", quantity, unit, mean, Criterion::near(0.0, limit)).note(note()));
        let [held, free] = [rms(&errors), rms(&all(&|row: &Row| row.free_errors(j)))];
        let quantity = format!("Table 5, {name} of a test less truth, rms");
        let why = format!("not linear, so more than the uncertainty; {free:.3} with v₀ found");
        chapter.target(Target::new("C8", quantity, unit, held, Criterion::Shown).note(why));
    }
    Ok(rows)
}

fn table(chapter: &mut Chapter, rows: &[Row]) {
    let cells = rows.iter().map(|row| {
        let mut cells = vec![format!("{}", row.displacement)];
        for j in 0..3 {
            let values: Vec<f64> = row.tests.iter().map(|test| test[j]).collect();
            cells.push(format!("{}", row.truth[j]));
            cells.push(mean_and_spread(&values));
        }
        let levels: Vec<f64> = row.tests.iter().map(|test| test[0] + test[1]).collect();
        cells.push(format!("{:.3}", row.truth[0] + row.truth[1]));
        cells.push(mean_and_spread(&levels));
        cells.push(format!("{:.4}", row.correlation));
        cells
    });
    chapter.table(
        "Table 5 as a round trip at 8.604 N: the thesis' rows as truth, and mean ± standard deviation of simulated tests with 0.5 mm/s of \
         noise",
        &["x₀ / mm", "μ₀", "tests", "μ₁", "tests", "α / (s/m)", "tests", "μ₀ + μ₁", "tests", "correlation of μ₀ and μ₁"],
        cells.collect(),
    );
}

fn mean_and_spread(values: &[f64]) -> String {
    Observations::new(values)
        .map_or_else(|_| "–".to_owned(), |values| format!("{:.4} ± {:.4}", values.mean(), values.standard_deviation()))
}

fn finding(chapter: &mut Chapter, rows: &[Row]) {
    let spread = |j: usize| rms(&rows.iter().flat_map(|row| row.errors(j)).collect::<Vec<_>>());
    let trend = |j: usize| {
        let values = || TABLE_5.iter().map(|row| row[j]);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    };
    let level = |row: &[f64; 5]| row[2] + row[3];
    let level_spread = rms(&rows
        .iter()
        .flat_map(|row| row.tests.iter().map(|test| test[0] + test[1] - row.truth[0] - row.truth[1]))
        .collect::<Vec<_>>());
    chapter.finding(
        "Of the three columns of Table 5 only the sum μ₀ + μ₁ is told by a test; their trends with the displacement are not.",
        format!(
            "With 0.5 mm/s of noise a test tells μ₀ to {:.3}, μ₁ to {:.3}, α to {:.2} s/m, with a correlation of μ₀ and μ₁ of {:.4} or \
             stronger; over the table μ₀ changes by {:.3}, μ₁ by {:.3}. The sum is told to {level_spread:.4} and rises from {:.3} to {:.3}. \
             α, printed without a unit, is in s/m.",
            spread(0),
            spread(1),
            spread(2),
            rows.iter().fold(-1.0f64, |weakest, row| weakest.max(row.correlation)),
            trend(2),
            trend(3),
            level(&TABLE_5[0]),
            level(&TABLE_5[TABLE_5.len() - 1]),
        ),
        &["E28"],
    );
}

fn figures(chapter: &mut Chapter, settings: &Settings<'_>, rows: &[Row]) -> Found<()> {
    let last = TABLE_5.len() - 1;
    let row = &TABLE_5[last];
    let record = release(row).record::<Berger>(NOISE, seed(settings, 5, last, 0))?;
    let fit = KNOWN.fit::<Berger>(&record, &START)?;
    let [floor, excess, decay] = found(&fit)?;
    chapter.figure(
        "figure_23",
        format!(
            "Fig. 23. Fit of Eq. 7.4 to a test of 16 mm. The record is simulated: μ₀ = {}, μ₁ = {}, α = {} s/m at 8.604 N, white noise of 0.5 \
             mm/s; found {floor:.3}, {excess:.3} and {decay:.2} s/m.",
            row[2], row[3], row[4]
        ),
        &fit_panels(&record, &fit),
    );
    let curve = |[floor, excess, decay]: [f64; 3], fastest: f64| -> Found<Vec<(f64, f64)>> {
        let law = Berger::new(floor, excess, decay)?;
        Ok((0..=100).map(|i| fastest * f64::from(i) / 100.0).map(|v| (v, law.coefficient(v))).collect())
    };
    let mut printed = Panel::new("speed / (m/s)", "coefficient at 8.604 N", 280.0);
    for row in TABLE_5.iter().take(last) {
        printed = printed.with(Role::Reference, "Table 5, 10 to 15 mm", curve([row[2], row[3], row[4]], 1.5)?);
    }
    let mut tests = Panel::new("speed / (m/s)", "coefficient at 8.604 N", 280.0).with(
        Role::Measured,
        "truth, 16 mm",
        curve(rows[last].truth, 1.5)?,
    );
    for test in rows[last].tests.iter().take(5) {
        tests = tests.with(Role::Fitted, "five simulated tests", curve(*test, 1.5)?);
    }
    let tested = [(row[1], curve(rows[last].truth, row[1])?[100].1)];
    printed = printed.with(Role::Fitted, "Table 5, 16 mm", curve(rows[last].truth, 1.5)?).with(
        Role::FittedPoints,
        "fastest in the test",
        tested,
    );
    chapter.figure(
        "figure_24",
        "Fig. 24. Coefficient against speed by Eq. 7.4. Top: the printed rows of Table 5, far beyond the speeds of the tests. Bottom: five \
         fits to simulated tests of 16 mm with 0.5 mm/s of noise; where there were no speeds they tell little.",
        &[printed, tests.with(Role::ResidualPoints, "fastest in the test", tested)],
    );
    Ok(())
}
