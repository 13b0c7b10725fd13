//! u(μ), three ways.

use fmm_fit::{StraightLine, Weighting};

use super::computed::{Computed, KICKS};
use crate::printed::{MACHINE_DEVIATIONS, TABLE_1, TABLE_3};
use crate::table_3::{ROWS, Row, TRUTH, VARIED};
use crate::{Chapter, Criterion, Drawing, Found, Settings, Target};
use fmm_cli::figure;

/// u(μ) of each row from derivatives in 256-bit arithmetic and the printed standard deviations (10⁻⁶).
const GOLDEN: [f64; 4] = [67.517, 5.732, 237.63, 247.10];
/// Units of derivatives by mass, stiffness and damping.
const PER_UNIT: [&str; 3] = ["1/kg", "m/N", "m/(N s)"];
/// Relative and assumed: standard uncertainties of the normal load and of the common scale of m, k and c.
const ASSUMED: [f64; 2] = [1e-3, 1e-3];

/// By the implicit function theorem at the fit.
pub(super) fn by_derivatives(chapter: &mut Chapter, computed: &Computed) -> Found<()> {
    let exact = computed.sensitivities.uncertainties()?;
    let printed = ["63.9", "20.9", "236", "248"];
    let claims = [
        (Some(0.06), "6 %: what the grid of the thesis' motion makes of this row"),
        (None, "not claimed: the printed value is the noise of the grid (E12)"),
        (Some(0.01), "1 %: 100 000 trials scatter by 0.2 %, and the printed digits by 0.2 %"),
        (Some(0.01), "1 %, as for c"),
    ];
    for (j, (claim, note)) in claims.into_iter().enumerate() {
        let criterion = claim.map_or(Criterion::Shown, |share| Criterion::within(1e6 * TABLE_3[j].deviation, share));
        let quantity = format!("u(μ) by {}, exact derivatives", ROWS[j]);
        chapter.target(Target::new("A15", quantity, "10⁻⁶", 1e6 * exact[j], criterion).printed(printed[j]).note(note));
    }
    for (j, golden) in GOLDEN.into_iter().enumerate() {
        let quantity = format!("u(μ) by {}, golden", ROWS[j]);
        chapter.target(
            Target::new("A15", quantity, "10⁻⁶", 1e6 * exact[j], Criterion::within(golden, 1.2e-4))
                .note("differences in 256-bit arithmetic, of which four or five digits are stated"),
        );
    }
    let identity = computed.sensitivities.scale_identity();
    chapter.target(
        Target::new("A16", "m ∂μ/∂m + k ∂μ/∂k + c ∂μ/∂c", "1", identity, Criterion::near(TRUTH, 1e-8))
            .note("μ itself, as a record shows only k/m, c/m and μ N/m; derivatives hold eight digits"),
    );
    let rows = VARIED.iter().enumerate().map(|(j, (name, _))| {
        vec![
            (*name).to_owned(),
            format!("{:+.6e} {}", computed.sensitivities.machine[j], PER_UNIT[j]),
            MACHINE_DEVIATIONS[j].to_string(),
            format!("{:.3e}", exact[j]),
            format!("{:.1}", 100.0 * (exact[j] / exact[3]).powi(2)),
        ]
    });
    chapter.table(
        "Eq. 5.4 with exact derivatives of the fit",
        &["x", "∂μ/∂x", "u(x), Table 2", "u(μ)", "share of the variance / %"],
        rows.collect(),
    );
    Ok(())
}

/// By fits on machines drawn at random.
pub(super) fn by_refits(chapter: &mut Chapter, computed: &Computed, settings: &Settings<'_>) -> Found<()> {
    let exact_claims = [(66.0, 0.05), (5.8, 0.05), (240.0, 0.02), (247.0, 0.02)];
    refits(chapter, "exact motion", &computed.exact, exact_claims, settings)?;
    // Of the k row a factor of two, 7.5 to 30, about its middle.
    let euler_claims = [(78.0, 0.25), (18.75, 0.6), (236.0, 0.02), (248.0, 0.02)];
    refits(chapter, "thesis' motion", &computed.euler, euler_claims, settings)?;

    let linear = computed.sensitivities.uncertainties()?;
    let sampled = computed.exact.iter().zip(&computed.euler).zip(&computed.restarted);
    let mut rows = Vec::new();
    for ((printed, linear), ((exact, euler), restarted)) in TABLE_3.iter().zip(linear).zip(sampled) {
        let u = |row: &Row| row.sample.standard_uncertainty(0).map(|u| format!("{u:.3e}"));
        let mean = |row: &Row| row.sample.estimate(0).map(|mean| format!("{mean:.6}"));
        let rounded = format!("{linear:.3e}");
        rows.push(vec![
            exact.name.to_owned(),
            format!("{:.2e}", printed.deviation),
            rounded,
            u(exact)?,
            u(euler)?,
            u(restarted)?,
            printed.mean.to_string(),
            mean(exact)?,
            mean(euler)?,
        ]);
    }
    let trials = |rows: &[Row]| rows.iter().map(|row| row.sample.trials()).max().unwrap_or(0);
    chapter.table(
        format!(
            "Table 3, u(μ) and mean of μ, beside derivatives, up to {} fits a row of the exact motion, up to {} of the thesis' Euler \
             motion from its own start, and {} of it from {} starts (μ = {TRUTH}, seed {})",
            trials(&computed.exact),
            trials(&computed.euler),
            trials(&computed.restarted),
            KICKS + 1,
            settings.seed()
        ),
        &["row", "thesis", "derivatives", "exact", "Euler", "restarted", "mean, thesis", "exact", "Euler"],
        rows,
    );
    let u = |rows: &[Row]| rows[1].sample.standard_uncertainty(0);
    chapter.finding(
        "The k row of Table 3 is the noise of a time grid",
        format!(
            "k moves μ by {:.2e} only. In the thesis' motion a stop snaps to the next millisecond, its sum of squares jumps, and \
             the search ends beside the minimum: {:.1e} here, {:.2e} printed. The same motion searched from {} starts gives {:.1e}, \
             the exact motion {:.2e}.",
            linear[1],
            u(&computed.euler)?,
            TABLE_3[1].deviation,
            KICKS + 1,
            u(&computed.restarted)?,
            u(&computed.exact)?
        ),
        &["E12"],
    );
    Ok(())
}

/// The targets of one kind of refits: references (10⁻⁶) and relative tolerances.
fn refits(
    chapter: &mut Chapter,
    motion: &str,
    rows: &[Row],
    claims: [(f64, f64); 4],
    settings: &Settings<'_>,
) -> Found<()> {
    let printed = ["63.9", "20.9", "236", "248"];
    for (j, (row, (reference, share))) in rows.iter().zip(claims).enumerate() {
        let trials = row.sample.trials();
        // A standard deviation of M trials scatters by 1/√(2 M).
        let scatter = 1.0 / (2.0 * trials as f64).sqrt();
        let share = if settings.is_quick() { share + 3.0 * scatter } else { share };
        let quick = if settings.is_quick() { ": few, so three times that is added to the tolerance" } else { "" };
        let note = format!("{trials} fits, whose u scatters by {:.1} %{quick}", 100.0 * scatter);
        let u = 1e6 * row.sample.standard_uncertainty(0)?;
        let quantity = format!("u(μ) by {}, refits of the {motion}", row.name);
        chapter.target(
            Target::new("C6", quantity, "10⁻⁶", u, Criterion::within(reference, share)).printed(printed[j]).note(note),
        );
    }
    Ok(())
}

/// With what Eq. 5.4 leaves out.
pub(super) fn budgets(chapter: &mut Chapter, computed: &Computed) -> Found<()> {
    let alone = computed.sensitivities.budget()?.standard_uncertainty();
    let correlated = computed.sensitivities.correlated_budget()?.standard_uncertainty();
    let extended = computed.sensitivities.extended_budget(ASSUMED[0], ASSUMED[1])?;
    let rows =
        extended.contributions().map(|part| vec![part.input.name().to_owned(), format!("{:.3e}", part.uncertainty)]);
    chapter.table(
        format!(
            "Budget with the correlations of Table 1, and with {} % of the load and of the scale (both assumed): u = {:.3e}",
            100.0 * ASSUMED[0],
            extended.standard_uncertainty()
        ),
        &["input", "u(μ)"],
        rows.collect(),
    );
    let velocity = TABLE_1.map(|row| row.velocity);
    let line = StraightLine::fit(&velocity, &TABLE_1.map(|row| row.damping), Weighting::Equal)?;
    let scatter = line.regression().residual_standard_deviation().ok_or("no scatter")?;
    chapter.finding(
        "Eq. 5.4 takes m, k and c as independent, and the trend of c as chance",
        format!(
            "With the correlations that Table 1's columns have, u_c is {correlated:.2e} instead of {alone:.2e}. But the spread of c is \
             the trend of Eq. 5.5: about it c scatters by {scatter:.4} N s/m, which is {:.1e} in μ. What is left out may be the largest: \
             {} % of the normal load, or of the scale of m, k and c that no record shows, is {:.1e} in μ.",
            scatter * computed.sensitivities.machine[2].abs(),
            100.0 * ASSUMED[0],
            TRUTH * ASSUMED[0]
        ),
        &["E8"],
    );
    Ok(())
}

/// The density of μ with all three varied.
pub(super) fn figure_11(chapter: &mut Chapter, computed: &Computed) -> Found<()> {
    let all = &computed.exact[3].sample;
    chapter.drawings.push(Drawing {
        name: "figure_11",
        caption: format!(
            "Fig. 11: density of the fitted coefficient of friction with mass, stiffness and damping varied together; {} fits of the \
             exact motion to a simulated record of μ = {TRUTH}, standard deviation {:.3e}.",
            all.trials(),
            all.standard_uncertainty(0)?
        ),
        svg: figure::histogram("coefficient of friction", "refits", all.values(0)?),
    });
    Ok(())
}
