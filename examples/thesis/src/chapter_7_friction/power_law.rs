//! Eq. 7.2 and Fig. 20: a power law through Table 4, regressed on the printed digits.

use fmm_fit::{Bounds, Dual, FTest, Fit, Options, Parameter, Scalar, curve, solve};

use super::largest;
use crate::printed::{EQUATION_7_2, TABLE_4};
use crate::{Chapter, Criterion, Found, Target};
use fmm_cli::figure::{Panel, Role};

pub(super) fn add(chapter: &mut Chapter) -> Found<()> {
    let columns = TABLE_4.iter().map(|row| (row.1, row.2));
    let (linear, mean): (Vec<[f64; 2]>, Vec<[f64; 2]>) = columns.unzip();
    let mean = Column::of(&mean)?;
    let linear = Column::of(&linear)?;
    let excess = 100.0 * (mean.printed_squares() / mean.squares() - 1.0);
    let source = "mean-c column";
    chapter.target(
        Target::new(
            "B4",
            "Eq. 7.2, sum of squares with printed coefficients above the least",
            "%",
            excess,
            Criterion::AtMost(1.0),
        )
        .note(format!("{source}: {:.3e} over {:.3e}", mean.printed_squares(), mean.squares())),
    );
    let worst = largest(mean.residuals_of(printed));
    chapter.target(
        Target::new("B4", "Eq. 7.2, largest distance of the printed curve", "1", worst, Criterion::near(0.0042, 5e-5))
            .note(format!("{source}; reference to its last digit")),
    );
    let names = ["a", "b", "c"];
    for (j, text) in ["0.311", "0.2116", "0.03148"].into_iter().enumerate() {
        let uncertainty = mean.free.standard_uncertainty(j).ok_or("a coefficient is not determined")?;
        chapter.target(
            Target::new("B4", format!("Eq. 7.2, {}", names[j]), "", mean.free.as_fit().values()[j], Criterion::Shown)
                .printed(text)
                .note(format!("{source}; standard uncertainty {uncertainty:.2}: not determined, so not required")),
        );
    }
    table(chapter, &linear, &mean);
    finding(chapter, &linear, &mean)?;
    figure(chapter, &linear, &mean);
    Ok(())
}

/// Eq. 7.2 as printed.
fn printed(v: f64) -> f64 {
    let [a, b, c] = EQUATION_7_2;
    a * v.powf(b) + c
}

/// The power law μ = a v^b + c with the least sum of squares.
struct PowerLaw(Fit);

impl PowerLaw {
    /// The law through coefficients (1) at velocities (m/s), its constant c within bounds that contain 0.
    fn fit(velocity: &[f64], coefficient: &[f64], offset: Bounds) -> Found<Self> {
        let parameters = ["a", "b", "c"].map(|name| Parameter::new(name, name, "1"));
        let [a, b, c] = parameters;
        let law = |v: f64, [a, b, c]: [Dual<3>; 3]| a * Dual::from(v).powf(b) + c;
        let problem = curve(velocity, coefficient, [a, b, c.bounded(offset)], law)?;
        Ok(Self(solve(&problem, &[0.3, 0.2, 0.0], &Options::default())?))
    }

    fn as_fit(&self) -> &Fit {
        &self.0
    }

    fn standard_uncertainty(&self, j: usize) -> Option<f64> {
        self.0.estimates()[j].standard_uncertainty()
    }

    fn value(&self, v: f64) -> f64 {
        let values = self.0.values();
        values[0] * v.powf(values[1]) + values[2]
    }
}

/// A column of Table 4 with its fits.
struct Column {
    velocity: Vec<f64>,
    coefficient: Vec<f64>,
    free: PowerLaw,
    without_offset: PowerLaw,
}

impl Column {
    fn of(rows: &[[f64; 2]]) -> Found<Self> {
        let coefficient: Vec<f64> = rows.iter().map(|row| row[0]).collect();
        let velocity: Vec<f64> = rows.iter().map(|row| row[1]).collect();
        Ok(Self {
            free: PowerLaw::fit(&velocity, &coefficient, Bounds::UNBOUNDED)?,
            without_offset: PowerLaw::fit(&velocity, &coefficient, Bounds::new(0.0, 0.0)?)?,
            velocity,
            coefficient,
        })
    }

    fn squares(&self) -> f64 {
        self.free.as_fit().sum_of_squares()
    }

    fn residuals_of(&self, curve: impl Fn(f64) -> f64) -> Vec<f64> {
        self.velocity.iter().zip(&self.coefficient).map(|(v, mu)| curve(*v) - mu).collect()
    }

    fn printed_squares(&self) -> f64 {
        self.residuals_of(printed).iter().map(|left| left * left).sum()
    }

    fn points(&self) -> Vec<(f64, f64)> {
        self.velocity.iter().copied().zip(self.coefficient.iter().copied()).collect()
    }
}

fn table(chapter: &mut Chapter, linear: &Column, mean: &Column) {
    let fit = |name: &str, law: &PowerLaw| {
        let mut row = vec![name.to_owned()];
        for (j, value) in law.as_fit().values().iter().enumerate() {
            row.push(match law.standard_uncertainty(j) {
                Some(uncertainty) => format!("{value:.3} ± {uncertainty:.3}"),
                None => format!("{value}"),
            });
        }
        row.push(format!("{:.3e}", law.as_fit().sum_of_squares()));
        row
    };
    let [a, b, c] = EQUATION_7_2.map(|value| value.to_string());
    let as_printed = |name: &str, column: &Column| {
        vec![name.to_owned(), a.clone(), b.clone(), c.clone(), format!("{:.3e}", column.printed_squares())]
    };
    chapter.table(
        "Eq. 7.2, μ = a v^b + c, on the printed Table 4, with standard uncertainties",
        &["", "a", "b", "c", "sum of squares"],
        vec![
            as_printed("printed, on mean c", mean),
            fit("mean c, free", &mean.free),
            fit("mean c, c = 0", &mean.without_offset),
            as_printed("printed, on linear c", linear),
            fit("linear c, free", &linear.free),
            fit("linear c, c = 0", &linear.without_offset),
        ],
    );
}

fn finding(chapter: &mut Chapter, linear: &Column, mean: &Column) -> Found<()> {
    let test = FTest::of(mean.without_offset.as_fit(), mean.free.as_fit())?;
    let share = |j: usize| -> Found<f64> {
        let uncertainty = mean.free.standard_uncertainty(j).ok_or("a coefficient is not determined")?;
        Ok(100.0 * uncertainty / mean.free.as_fit().values()[j].abs())
    };
    chapter.finding(
        "The four digits of Eq. 7.2 mean nothing: only the curve is determined, and its constant is superfluous.",
        format!(
            "The standard uncertainties are {:.0} %, {:.0} % and {:.0} % of the three coefficients. On the other column of Table 4 \
             the best ones are {:.2}, {:.3} and {:.2}, quite another triple. Without a constant, {:.4} v^{:.4}, the sum of squares \
             grows by {:.1} % (F test p = {:.2}). The printed triple lies on the ridge of the mean-c column.",
            share(0)?,
            share(1)?,
            share(2)?,
            linear.free.as_fit().values()[0],
            linear.free.as_fit().values()[1],
            linear.free.as_fit().values()[2],
            mean.without_offset.as_fit().values()[0],
            mean.without_offset.as_fit().values()[1],
            100.0 * (mean.without_offset.as_fit().sum_of_squares() / mean.squares() - 1.0),
            test.p_value
        ),
        &["E33"],
    );
    Ok(())
}

fn figure(chapter: &mut Chapter, linear: &Column, mean: &Column) {
    let curve = |law: &dyn Fn(f64) -> f64| -> Vec<_> {
        (0..=100).map(|i| 0.08 + 0.205 * f64::from(i) / 100.0).map(|v| (v, law(v))).collect()
    };
    chapter.figure(
        "figure_20",
        "Fig. 20. Coefficient against highest velocity: the printed rows of Table 4, Eq. 7.2 as printed, and the least-squares curve \
         without a constant. No measurement is simulated here.",
        &[Panel::new("highest velocity / (m/s)", "coefficient of friction", 320.0)
            .with(Role::Points, "Table 4, mean c", mean.points())
            .with(Role::ResidualPoints, "Table 4, linear c, where it differs", {
                let differs = |point: &(f64, f64)| !mean.points().contains(point);
                linear.points().into_iter().filter(differs)
            })
            .with(Role::Fitted, "Eq. 7.2 as printed", curve(&printed))
            .with(Role::Reference, "a v^b, least squares", curve(&|v| mean.without_offset.value(v)))],
    );
}
