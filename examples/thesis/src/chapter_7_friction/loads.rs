//! The normal loads that Tables 4 and 5 go with: their highest velocities tell.

use fmm_fit::{EvaluationError, Options, Residuals, solve};
use fmm_friction::{Berger, Coulomb, LawFamily};
use fmm_model::{Bounds, Parameter};

use super::{Known, LOAD_4, LOAD_5, Release, largest, rms, value};
use crate::printed::{TABLE_4, TABLE_5};
use crate::ring_down::Viscous;
use crate::{Chapter, Criterion, Found, Target};
use fmm_cli::figure::{Panel, Role};

/// The loads that are tried (N).
const LOADS: [f64; 2] = [LOAD_4, LOAD_5];

pub(super) fn add(chapter: &mut Chapter) -> Found<()> {
    chapter.target(
        Target::new("A17", "normal load in A4 to A6, 0.8771 kg", "N", LOAD_5, Criterion::near(8.6044, 5e-5))
            .note("last digit; the text says 14 N"),
    );
    let linear: Vec<Row> =
        TABLE_4.iter().map(|row| Row { displacement: row.0, peak: row.1[1], law: vec![row.1[0]] }).collect();
    let mean: Vec<Row> =
        TABLE_4.iter().map(|row| Row { displacement: row.0, peak: row.2[1], law: vec![row.2[0]] }).collect();
    let five: Vec<Row> =
        TABLE_5.iter().map(|row| Row { displacement: row[0], peak: row[1], law: row[2..].to_vec() }).collect();
    let four = Residue::of::<Coulomb>(&linear, Viscous::Line)?;
    let four_mean = Residue::of::<Coulomb>(&mean, Viscous::Mean)?;
    let five_residue = Residue::of::<Berger>(&five, Viscous::Line)?;
    table_4(chapter, &linear, &four, &four_mean);
    let equivalent = table_5(chapter, &five, &five_residue)?;
    finding(chapter, &four, &five_residue, equivalent);
    figure(chapter, [&linear, &five], [&four, &five_residue]);
    Ok(())
}

/// A row of a table: initial displacement (mm), highest velocity (m/s), values of the law.
struct Row {
    displacement: f64,
    peak: f64,
    law: Vec<f64>,
}

/// Differences of simulated highest velocities from the printed ones.
struct Residue {
    /// Ours less printed (mm/s) for each of [`LOADS`].
    left: [Vec<f64>; 2],
    /// The one load that suits all rows best, with its standard uncertainty (N).
    best: (f64, f64),
    /// Differences that it leaves, root mean square (mm/s).
    rest: f64,
}

impl Residue {
    fn of<F: LawFamily>(rows: &[Row], viscous: Viscous) -> Found<Self> {
        let problem = PeakVelocities::<F> {
            rows,
            viscous,
            load: [Parameter::new("normal_load", "N", "N").bounded(Bounds::POSITIVE)],
            family: std::marker::PhantomData,
        };
        let at = |load: f64| -> Found<Vec<f64>> {
            let mut left = vec![0.0; rows.len()];
            problem.evaluate(&[load], &mut left, None).map_err(EvaluationError::into_boxed)?;
            Ok(left)
        };
        let fit = solve(&problem, &[10.0], &Options::default())?;
        let uncertainty = fit.estimates()[0].standard_uncertainty().ok_or("the load is not determined")?;
        Ok(Self {
            left: [at(LOADS[0])?, at(LOADS[1])?],
            best: (fit.values()[0], uncertainty),
            rest: rms(fit.residuals()),
        })
    }
}

/// Highest velocities of a table's rows (mm/s), ours less printed, as a function of one load.
struct PeakVelocities<'a, F> {
    rows: &'a [Row],
    viscous: Viscous,
    load: [Parameter; 1],
    family: std::marker::PhantomData<fn() -> F>,
}

impl<F: LawFamily> Residuals for PeakVelocities<'_, F> {
    fn parameters(&self) -> &[Parameter] {
        &self.load
    }

    fn len(&self) -> usize {
        self.rows.len()
    }

    fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        for (left, row) in residuals.iter_mut().zip(self.rows) {
            let release = Release { viscous: self.viscous, law: &row.law, load: p[0], displacement: row.displacement };
            *left = 1e3 * (release.peak::<F>().map_err(EvaluationError::from_boxed)? - row.peak);
        }
        Ok(())
    }
}

fn table_4(chapter: &mut Chapter, rows: &[Row], linear: &Residue, mean: &Residue) {
    for (column, residue) in [("linear c", linear), ("mean c", mean)] {
        let left = &residue.left[0];
        let quantity = |of: &str| format!("Table 4, {column}, v_max at 14 N less printed, {of}");
        let note = "release at rest, first quarter swing; reading the displacement to 0.2 mm alone is 2.8 mm/s";
        chapter.target(
            Target::new("A13", quantity("rms of 15 rows"), "mm/s", rms(left), Criterion::AtMost(1.6)).note(note),
        );
        chapter.target(Target::new(
            "A13",
            quantity("largest"),
            "mm/s",
            largest(left.iter().copied()),
            Criterion::AtMost(3.3),
        ));
    }
    let contrast = rms(&linear.left[1]);
    chapter.target(
        Target::new(
            "A13",
            "Table 4, linear c, the same at 8.604 N, rms",
            "mm/s",
            contrast,
            Criterion::near(9.76, 0.05),
        )
        .note("six times as much as at 14 N: not the load of this table"),
    );
    let cells = rows.iter().enumerate().map(|(i, row)| {
        let velocity = |left: &[f64]| format!("{:.1} ({:+.1})", 1e3 * row.peak + left[i], left[i]);
        vec![
            format!("{}", row.displacement),
            format!("{:.3}", row.law[0]),
            format!("{:.0}", 1e3 * row.peak),
            velocity(&linear.left[0]),
            velocity(&mean.left[0]),
            velocity(&linear.left[1]),
        ]
    });
    chapter.table(
        format!(
            "Table 4: highest velocity / (mm/s) from rest, and ours less printed; best single load {:.2} N",
            linear.best.0
        ),
        &["x₀ / mm", "μ", "thesis", "14 N, linear c", "14 N, mean c", "8.604 N, linear c"],
        cells.collect(),
    );
}

/// Adds the rows of Table 5; gives the mean ratio of the Coulomb equivalents to Table 4.
fn table_5(chapter: &mut Chapter, rows: &[Row], residue: &Residue) -> Found<f64> {
    let [at_14, at_8] = &residue.left;
    let quantity = |of: &str, load: &str| format!("Table 5, v_peak at {load} N less printed, {of}");
    let note = "release at rest, first quarter swing";
    chapter.target(
        Target::new("A14", quantity("rms of 6 rows", "8.604"), "mm/s", rms(at_8), Criterion::AtMost(2.1)).note(note),
    );
    let worst = largest(at_8.iter().copied());
    chapter.target(Target::new("A14", quantity("largest", "8.604"), "mm/s", worst, Criterion::AtMost(3.1)));
    chapter.target(
        Target::new("A14", quantity("rms", "14"), "mm/s", rms(at_14), Criterion::near(13.0, 0.1))
            .note("six times as much: not the load of this table"),
    );
    let mut ratios = Vec::new();
    let mut cells = Vec::new();
    for (i, row) in rows.iter().enumerate() {
        let truth = Release { viscous: Viscous::Line, law: &row.law, load: LOAD_5, displacement: row.displacement };
        let known = Known { viscous: Viscous::Line, load: LOAD_4 };
        let record = truth.record::<Berger>(0.0, 0)?;
        let start = [("coefficient", 0.2)];
        let equivalent = value(&known.fit_holding_velocity::<Coulomb>(&record, &start)?, "coefficient")?;
        let with_velocity = value(&known.fit::<Coulomb>(&record, &start)?, "coefficient")?;
        let four = TABLE_4.iter().find(|four| four.0 == row.displacement).ok_or("Table 4 lacks a row")?;
        let printed = four.1[0];
        ratios.push(equivalent / printed);
        cells.push(vec![
            format!("{}", row.displacement),
            format!("{:.0}", 1e3 * row.peak),
            format!("{:.1} ({:+.1})", 1e3 * row.peak + at_8[i], at_8[i]),
            format!("{:.1} ({:+.1})", 1e3 * row.peak + at_14[i], at_14[i]),
            format!("{with_velocity:.4}"),
            format!("{equivalent:.4}"),
            format!("{printed:.3}"),
            format!("{:.3}", equivalent / printed),
        ]);
    }
    chapter.table(
        format!(
            "Table 5: highest velocity / (mm/s) from rest, ours less printed, and the one coefficient at 14 N that fits the \
             motion of the row at 8.604 N; best single load {:.2} N",
            residue.best.0
        ),
        &["x₀ / mm", "thesis", "8.604 N", "14 N", "Coulomb μ at 14 N, v₀ free", "v₀ held", "Table 4", "ratio of these two"],
        cells,
    );
    let ratio = ratios.iter().sum::<f64>() / ratios.len() as f64;
    chapter.target(
        Target::new(
            "C9",
            "Coulomb equivalent of Table 5 over Table 4, mean",
            "1",
            ratio,
            Criterion::near(1.035, 0.002),
        )
        .note("simulated rows of Table 5 at 8.604 N, one coefficient fitted at 14 N as in A4, initial velocity held"),
    );
    let spread = largest(ratios.iter().map(|row| row - ratio));
    chapter.target(
        Target::new("C9", "the same, largest departure of a row", "1", spread, Criterion::AtMost(0.0025))
            .note("the third digit of Table 4 alone is 0.002 of it"),
    );
    Ok(ratio)
}

fn finding(chapter: &mut Chapter, four: &Residue, five: &Residue, ratio: f64) {
    let [static_level, dynamic] = {
        let row = TABLE_5[TABLE_5.len() - 1];
        [row[2] + row[3], row[2]].map(|mu| mu * LOAD_5 / LOAD_4)
    };
    chapter.finding(
        "Two normal forces: 14 N for Table 4 and 8.604 N for Table 5. Coefficients of the two tables are on different scales.",
        format!(
            "The printed highest velocities are left over with an rms of {:.2} mm/s by Table 4 at 14 N and {:.2} at 8.604 N, by \
             Table 5 with {:.2} at 8.604 N and {:.1} at 14 N. The single loads that suit best are {:.2} ± {:.2} N (rms {:.2} \
             mm/s) and {:.2} ± {:.2} N (rms {:.2} mm/s). One Coulomb coefficient for each row of Table 5, taken at 14 N, is \
             {ratio:.3} times that of Table 4 in every row: the friction force is the same in both tables, and a coefficient is \
             worth nothing without its load. Static 0.49 and dynamic 0.23 of Table 5 are {static_level:.2} and {dynamic:.2} on \
             the scale of 14 N. Which load was the true one no velocity can tell, as only μ N/m shows in it.",
            rms(&four.left[0]),
            rms(&four.left[1]),
            rms(&five.left[1]),
            rms(&five.left[0]),
            four.best.0,
            four.best.1,
            four.rest,
            five.best.0,
            five.best.1,
            five.rest,
        ),
        &["E25"],
    );
    let highest = TABLE_4.iter().map(|row| row.1[1]).fold(0.0, f64::max);
    chapter.finding(
        "Section 7.2 takes a coefficient for a velocity, and names the wrong table and equation.",
        format!(
            "The highest peak velocity of Table 4 is {highest:.3} m/s; the text's 0.267 is the coefficient of that row. \
             \"Table 2\" for the highest velocities is Table 4, \"Equation 5.3\" for the linear damping is Eq. 5.5."
        ),
        &["E13", "E15", "E16"],
    );
}

fn figure(chapter: &mut Chapter, tables: [&[Row]; 2], residues: [&Residue; 2]) {
    let panels = tables.into_iter().zip(residues).zip([4, 5]).map(|((rows, residue), number)| {
        let points =
            |left: &[f64]| rows.iter().zip(left).map(|(row, left)| (row.displacement, *left)).collect::<Vec<_>>();
        Panel::new("initial displacement / mm", format!("Table {number}, ours − thesis / (mm/s)"), 260.0)
            .with(Role::FittedPoints, "14 N", points(&residue.left[0]))
            .with(Role::ResidualPoints, "8.604 N", points(&residue.left[1]))
    });
    chapter.figure(
        "tables_4_5_loads",
        "Two normal forces. Highest velocity of a simulated release from rest with the printed coefficients, less the printed \
         highest velocity, for Table 4 (top, Coulomb) and Table 5 (bottom, Eq. 7.4), at the load of the text and at that of the \
         programs A4 to A6.",
        &panels.collect::<Vec<_>>(),
    );
}
