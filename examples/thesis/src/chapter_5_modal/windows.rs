//! Fits over five cycles and over more: Table 1's damping, Eq. 5.5, and the factor between equivalent and
//! instantaneous.

use fmm_fit::{StraightLine, Weighting};
use fmm_identify::{Experiment, Offset, Preparation};

use super::regressions::table_1_line;
use super::simulated::{machine, motion, record, rms};
use crate::printed::{EQUATION_5_5, INSTANTANEOUS_SLOPE, MACHINE, TABLE_1};
use crate::windows::{WindowFit, Windows};
use crate::{Chapter, Criterion, Found, Settings, Target};

/// The window of each row of Table 1 that begins at its printed velocity.
pub(super) struct Column {
    /// Peak velocity with which the window begins, and mean over the peaks that begin its cycles (m/s).
    velocities: [Vec<f64>; 2],
    /// Damping (N s/m).
    pub(super) damping: Vec<f64>,
}

/// Which velocity a line is drawn over.
#[derive(Clone, Copy)]
enum Over {
    FirstPeak,
    MeanPeak,
}

impl Column {
    /// Fits `cycles` of the vibration of a machine with `quadratic` damping (N s²/m²), through the first sample as in
    /// A1.
    fn of(quadratic: f64, cycles: usize) -> Found<Self> {
        let [mass, ..] = MACHINE;
        // One more cycle, so that the last peak of the window is seen.
        let seconds = (cycles as f64 + 1.0) / machine(quadratic)?.natural_frequency();
        let fit = |velocity: f64| -> Found<WindowFit> {
            let motion = motion(machine(quadratic)?, (0.0, velocity), seconds)?;
            let record = record(motion.velocity().values(), 0.0, 0)?;
            let decay = Experiment::ring_down(&record, &Preparation::default().offset(Offset::Fixed(0.0)))?;
            let windows = Windows::of_cycles(cycles).through_first_sample().fit(&decay)?;
            Ok(windows.into_iter().next().ok_or("no window")?)
        };
        let fits = TABLE_1.iter().map(|row| fit(1e-3 * row.velocity)).collect::<Found<Vec<_>>>()?;
        Ok(Self {
            velocities: [
                fits.iter().map(|fit| fit.first_peak_velocity).collect(),
                fits.iter().map(|fit| fit.mean_peak_velocity).collect(),
            ],
            damping: fits.iter().map(|fit| mass * fit.damping.value).collect(),
        })
    }

    fn line(&self, over: Over) -> Found<StraightLine> {
        Ok(StraightLine::fit(&self.velocities[over as usize], &self.damping, Weighting::Equal)?)
    }

    /// Root mean square of the differences from Table 1's damping (N s/m).
    fn deviation(&self) -> f64 {
        let squares = self.damping.iter().zip(TABLE_1).map(|(ours, row)| (ours - row.damping).powi(2));
        (squares.sum::<f64>() / TABLE_1.len() as f64).sqrt()
    }
}

/// Damping (N s/m) of the five-cycle windows of Table 1, with the instantaneous law that Eq. 5.5 needs and with that of
/// A5.
pub(super) fn of_few_cycles(chapter: &mut Chapter, settings: &Settings<'_>) -> Found<[Column; 2]> {
    let laws = [INSTANTANEOUS_SLOPE, EQUATION_5_5[0]];
    let mut rows = Vec::new();
    let mut five = Vec::new();
    let spans = [(5, "5 cycles (5.4)"), (11, "5 s (A1)"), (98, "45 s (5.1)")];
    for (index, (cycles, name)) in spans.into_iter().enumerate() {
        for quadratic in laws {
            let column = Column::of(quadratic, cycles)?;
            let (first, mean) = (column.line(Over::FirstPeak)?, column.line(Over::MeanPeak)?);
            let text = |line: &StraightLine| format!("{:.4} V + {:.4}", line.slope(), line.intercept());
            rows.push(vec![
                name.to_owned(),
                format!("{quadratic:.4}"),
                text(&first),
                text(&mean),
                format!("{:.4}", column.deviation()),
            ]);
            if cycles == 5 {
                five.push(column);
            }
        }
        settings.done(0.3 + 0.5 * (index + 1) as f64 / spans.len() as f64);
    }
    chapter.table(
        "Fits to simulated records that begin at Table 1's velocities: damping (N s/m) as a line in the peak velocity V (m/s), \
         printed as 0.437 V + 0.2005",
        &["fitted", "c₂ / (N s²/m²)", "over the first peak", "over the mean peak", "rms from Table 1 / (N s/m)"],
        rows,
    );
    let Ok([right, appendix]) = <[Column; 2]>::try_from(five) else { return Err("two columns are expected".into()) };
    lines(chapter, [&right, &appendix])?;
    table_1(chapter, [&right, &appendix]);
    Ok([right, appendix])
}

fn lines(chapter: &mut Chapter, [right, appendix]: [&Column; 2]) -> Found<()> {
    let note = "0.1 %: V is the mean of the five peaks that begin the cycles";
    let line = right.line(Over::MeanPeak)?;
    let slope_of = |line: &StraightLine, reference| (line.slope(), Criterion::within(reference, 1e-3));
    let intercept = |line: &StraightLine| (line.intercept(), Criterion::within(EQUATION_5_5[1], 1e-3));
    let (ours, criterion) = slope_of(&line, 0.4372);
    chapter.target(
        Target::new("C1", "slope of five-cycle fits, c₂ = 0.5148", "N s²/m²", ours, criterion)
            .printed("0.437")
            .note(note),
    );
    let (ours, criterion) = intercept(&line);
    chapter.target(Target::new("C1", "their intercept", "N s/m", ours, criterion).printed("0.2005").note(note));
    let line = appendix.line(Over::MeanPeak)?;
    let (ours, criterion) = slope_of(&line, 0.3711);
    chapter.target(
        Target::new("C2", "slope of five-cycle fits, c₂ = 0.437 as in A5", "N s²/m²", ours, criterion)
            .printed("0.437")
            .note("what the thesis would have measured if A5's law were right"),
    );
    let (ours, criterion) = intercept(&line);
    chapter.target(Target::new("C2", "their intercept", "N s/m", ours, criterion).printed("0.2005").note(note));
    chapter.target(
        Target::new(
            "C3",
            "rms of Table 1's c from five-cycle fits",
            "N s/m",
            right.deviation(),
            Criterion::AtMost(2.5e-3),
        )
        .note("first peak at the printed velocity, c₂ = 0.5148; Table 1 scatters by 0.0018 about its own line"),
    );
    let slopes = |column: &Column| -> Found<[f64; 2]> {
        Ok([column.line(Over::FirstPeak)?.slope(), column.line(Over::MeanPeak)?.slope()])
    };
    let ([a, b], [c, d]) = (slopes(appendix)?, slopes(right)?);
    let scatter = rms(table_1_line()?.regression().residuals());
    chapter.finding(
        "A5 takes an equivalent damping for an instantaneous one: wrong by 8/(3π)",
        format!(
            "A damping of c₂|v| is worth 8/(3π) c₂ V over a cycle of peak V, so the line 0.437 V needs c₂ = 0.437 · 3π/8 = \
             {INSTANTANEOUS_SLOPE:.4} N s²/m². Refits over five cycles confirm it: with c₂ = 0.437 they give a slope of {a:.3} \
             (first peak) to {b:.3} (mean peak), {:.4} N s/m from Table 1; with {INSTANTANEOUS_SLOPE:.4} they give {c:.3} to \
             {d:.3} and {:.4} N s/m, as much as Table 1 scatters about its own line, {scatter:.4}.",
            appendix.deviation(),
            right.deviation()
        ),
        &["E23"],
    );
    Ok(())
}

fn table_1(chapter: &mut Chapter, columns: [&Column; 2]) {
    let text = |(index, row): (usize, &crate::printed::FreeVibration)| {
        vec![
            row.displacement.to_string(),
            row.velocity.to_string(),
            row.mass.to_string(),
            row.stiffness.to_string(),
            format!("{:.1}", MACHINE[0] * row.stiffness / row.mass),
            format!("{:.4}", (row.stiffness / row.mass).sqrt() / std::f64::consts::TAU),
            format!("{:.3}", row.damping),
            format!("{:.3}", columns[0].damping[index]),
            format!("{:.3}", columns[1].damping[index]),
        ]
    };
    let headings = [
        "x₀ / mm",
        "V / (mm/s)",
        "m / kg",
        "k / (N/m)",
        "k at 10.391 kg",
        "f₀ / Hz",
        "c / (N s/m)",
        "simulated, c₂ = 0.5148",
        "c₂ = 0.437",
    ];
    chapter.table(
        "Table 1; only f₀ and c/m of it are measured. Beside c: five-cycle fits to simulated records",
        &headings,
        TABLE_1.iter().enumerate().map(text).collect(),
    );
}
