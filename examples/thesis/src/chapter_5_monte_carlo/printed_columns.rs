//! Meaning of the columns of Table 3, by arithmetic alone.

use super::computed::Computed;
use crate::printed::{MACHINE_DEVIATIONS, TABLE_3};
use crate::table_3::VARIED;
use crate::{Chapter, Criterion, Target};
use fmm_cli::figure::label;

/// Columns 3 to 5 as printed.
pub(super) fn of_table_3(chapter: &mut Chapter, computed: &Computed) {
    let deviations = [TABLE_3[0], TABLE_3[1], TABLE_3[2]].map(|row| row.deviation);
    let [mass, stiffness, damping] = deviations;
    let combined = deviations.iter().map(|u| u * u).sum::<f64>().sqrt();
    chapter.target(
        Target::new("A9", "u_c from column 3", "10⁻⁴", 1e4 * combined, Criterion::near(2.45, 5e-3))
            .printed("2.45")
            .note("the root of the sum of squares; half of the last printed digit"),
    );
    let columns = [TABLE_3[0], TABLE_3[1], TABLE_3[2]].map(|row| row.sensitivity_and_product.unwrap_or([f64::NAN; 2]));
    chapter.target(
        Target::new("A10", "column 5, c over k", "1", columns[2][1] / columns[1][1], Criterion::near(3.44, 5e-3))
            .printed("3.44")
            .note("half of the last printed digit; the column means nothing, see below"),
    );
    let rows = VARIED.iter().enumerate().map(|(j, (name, unit))| {
        let [sensitivity, product] = columns[j];
        vec![
            label(name, unit),
            format!("{sensitivity:.2e}"),
            format!("{:.2e}", deviations[j] * MACHINE_DEVIATIONS[j]),
            format!("{:.2e}", deviations[j] / MACHINE_DEVIATIONS[j]),
            format!("{:.4e}", computed.sensitivities.machine[j]),
            format!("{product:.2e}"),
            format!("{:.2e}", deviations[j].powi(2) * MACHINE_DEVIATIONS[j]),
        ]
    });
    chapter.table(
        "Table 3's \"sensitivity\" is u(μ) u(x), not u(μ)/u(x) as Eq. 5.3 has it, and its \"product\" u(μ)² u(x)",
        &["x", "printed", "u(μ) u(x)", "u(μ)/u(x)", "∂μ/∂x, exact", "\"product\"", "u(μ)² u(x)"],
        rows.collect(),
    );
    let shares = deviations.map(|u| 100.0 * (u / combined).powi(2));
    chapter.finding(
        "Table 3's columns 4 and 5 are the wrong products",
        format!(
            "Column 4 is u(μ) times u(x), where Eq. 5.3 divides; column 5 is u(μ)² u(x), and should be column 3 again. \"3.44 times \
             larger than the next (stiffness)\" follows from it. By column 3, c is {:.1} times m, the next, and {:.0} times k; \
             the shares of the variance are {:.1}, {:.1} and {:.1} % for m, k and c.",
            damping / mass,
            damping / stiffness,
            shares[0],
            shares[1],
            shares[2]
        ),
        &["E10", "E11"],
    );
    chapter.finding(
        "Table 3 was not made by A3 as printed",
        format!(
            "A3 takes its distributions from the tests at 6, 8 and 10 mm. Column 4 over column 3 gives back what was used: {:.5} kg, \
             {:.3} N/m and {:.4} N s/m, the standard deviations of Table 2 before rounding. The load of A3, 7.2 N, is that of no chapter.",
            columns[0][0] / mass,
            columns[1][0] / stiffness,
            columns[2][0] / damping
        ),
        &["E26"],
    );
}
