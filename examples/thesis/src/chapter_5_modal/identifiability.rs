//! Mass, stiffness and damping as far as a free vibration tells them.

use fmm_fit::{Estimate, Fit, Options, Residuals as _, solve};
use fmm_model::{Damping, Oscillator};

use super::simulated::{a1, a1_of_stiffness, motion, record};
use crate::printed::{MACHINE, TABLE_1};
use crate::ring_down::INTERVAL;
use crate::{Chapter, Criterion, Found, Settings, Target};

/// Duration that A1 fits (s).
pub(super) const WINDOW: f64 = 5.0;
/// White noise of the vibrometer as assumed here (m/s).
pub(super) const NOISE: f64 = 5e-4;
/// Masses (kg) and stiffnesses (N/m) from which the fit of A1 is begun; its own is the second, and the first is what
/// it probably was.
const STARTS: [[f64; 2]; 7] =
    [[10.4, 1980.0], [14.4, 1980.0], [10.4, 1500.0], [12.0, 2500.0], [8.0, 1500.0], [5.0, 950.0], [20.0, 2000.0]];
/// Velocity of Table 1 at 10 mm (m/s).
const VELOCITY: f64 = 0.129;
/// Damping of A1's start (N s/m).
const START_DAMPING: f64 = 0.27;

/// Rank, null direction, start values, and the fit with one of the three held.
pub(super) fn of_free_vibrations(chapter: &mut Chapter, settings: &Settings<'_>) -> Found<()> {
    rank(chapter)?;
    starts(chapter, settings)?;
    with_stiffness_held(chapter)
}

/// The machine with these numbers.
fn linear([mass, stiffness, damping]: [f64; 3]) -> Found<Oscillator> {
    Ok(Oscillator::new(mass, stiffness)?.with_damping(Damping::linear(damping)?))
}

fn value(fit: &Fit, name: &str) -> Found<f64> {
    Ok(fit.estimate(name).map(Estimate::value).ok_or_else(|| format!("no parameter {name}"))?)
}

fn rank(chapter: &mut Chapter) -> Found<()> {
    let clean = motion(linear(MACHINE)?, (0.0, VELOCITY), WINDOW)?;
    let record = record(clean.velocity().values(), 0.0, 0)?;
    let problem = a1(&record, MACHINE)?;
    let fit = solve(&problem, problem.values(), &Options::default())?;
    let singular = fit.singular_values();
    let ratio = match singular {
        [largest, .., smallest] => smallest / largest,
        _ => f64::NAN,
    };
    chapter.target(
        Target::new("C5", "rank of the Jacobian in m, k, c, x₀", "1", fit.rank() as f64, Criterion::near(3.0, 0.0))
            .note("3 of 4"),
    );
    chapter.target(
        Target::new("C5", "smallest over largest singular value", "1", ratio, Criterion::AtMost(1e-7))
            .note("zero but for rounding; differences as in A1 leave 3e−8"),
    );
    let mut changes: f64 = 0.0;
    let mut residuals = [vec![0.0; problem.len()], vec![0.0; problem.len()]];
    problem.evaluate(problem.values(), &mut residuals[0], None).map_err(|error| error.to_string())?;
    for factor in [0.5, 2.0] {
        let mut scaled = problem.values().to_vec();
        scaled[..3].iter_mut().for_each(|value| *value *= factor);
        problem.evaluate(&scaled, &mut residuals[1], None).map_err(|error| error.to_string())?;
        let [before, after] = &residuals;
        changes = before.iter().zip(after).fold(changes, |most, (a, b)| most.max((a - b).abs()));
    }
    chapter.target(
        Target::new(
            "C5",
            "change of the residuals if m, k, c are halved or doubled",
            "m/s",
            changes,
            Criterion::AtMost(0.0),
        )
        .note("bit for bit"),
    );
    let direction = fit.null_directions().first();
    let missing = direction.map_or(f64::NAN, |direction| {
        direction.components()[..3].iter().fold(0.0f64, |most, component| most.max((component - 1.0).abs()))
    });
    chapter.target(
        Target::new("C5", "null direction less (1, 1, 1) in ln m, ln k, ln c", "1", missing, Criterion::AtMost(1e-6))
            .note("half of the digits of the Jacobian"),
    );
    let participants: Vec<_> = direction
        .into_iter()
        .flat_map(fmm_fit::NullDirection::participants)
        .map(|(name, share)| format!("{name} {share:+.6}"))
        .collect();
    chapter.finding(
        "A free vibration does not tell m, k and c, but k/m and c/m",
        format!(
            "The Jacobian of A1's fit in m, k, c and x₀ has rank {} of {}, with singular values {}. The direction that \
             the record does not see is {} in relative changes: mass, stiffness and damping may be multiplied by one factor. \
             A mass or a stiffness has to come from elsewhere; an error of 1 % in it is 1 % in every coefficient of friction.",
            fit.rank(),
            fit.free_count(),
            singular.iter().map(|value| format!("{value:.1e}")).collect::<Vec<_>>().join(", "),
            participants.join(", ")
        ),
        &["E8"],
    );
    Ok(())
}

fn starts(chapter: &mut Chapter, settings: &Settings<'_>) -> Found<()> {
    let clean = motion(linear(MACHINE)?, (0.0, VELOCITY), WINDOW)?;
    let record = record(clean.velocity().values(), NOISE, settings.seed())?;
    let mut rows = Vec::new();
    let mut found = Vec::new();
    for [mass, stiffness] in STARTS {
        let problem = a1(&record, [mass, stiffness, START_DAMPING])?;
        let fit = solve(&problem, problem.values(), &Options::default())?;
        let [m, k, c] = [value(&fit, "mass")?, value(&fit, "stiffness")?, value(&fit, "damping")?];
        // A1's sum is in mm/s, and lsqnonlin halves none; the halved one is what a cost usually is.
        let cost = 0.5e6 * fit.sum_of_squares();
        rows.push(vec![
            format!("{mass}, {stiffness}"),
            format!("{m:.4}"),
            format!("{k:.2}"),
            format!("{c:.5}"),
            format!("{cost:.6}"),
            format!("{:.6}", k / m),
            format!("{:.8}", c / m),
        ]);
        found.push([cost, k / m, c / m, m]);
    }
    chapter.table(
        format!(
            "Fit of m, k, c and x₀ from several starts to one simulated record ({WINDOW} s, Table 2, {} mm/s of noise)",
            1e3 * NOISE
        ),
        &[
            "start m / kg, k / (N/m)",
            "m / kg",
            "k / (N/m)",
            "c / (N s/m)",
            "cost / (mm/s)²",
            "k/m / (1/s²)",
            "c/m / (1/s)",
        ],
        rows,
    );
    let spread = |j: usize| {
        let (low, high) = found.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), values: &[f64; 4]| {
            (low.min(values[j]), high.max(values[j]))
        });
        high / low - 1.0
    };
    for (j, (quantity, limit)) in [("cost", 1e-10), ("k/m", 1e-8), ("c/m", 1e-6)].into_iter().enumerate() {
        let quantity = format!("spread of {quantity} over the starts");
        chapter.target(
            Target::new("C5", quantity, "1", spread(j), Criterion::AtMost(limit))
                .note("one minimum, however far apart m and k end"),
        );
    }
    chapter.finding(
        "Every start gives its own mass, and the same fit",
        format!(
            "Masses from {:.2} to {:.2} kg fit the record with one and the same cost; k/m = {:.4} 1/s² and c/m = {:.6} 1/s in \
             all of them.",
            found.iter().fold(f64::INFINITY, |low, values| low.min(values[3])),
            found.iter().fold(0.0, |high: f64, values| high.max(values[3])),
            found[0][1],
            found[0][2]
        ),
        &["E8", "E9"],
    );
    Ok(())
}

/// The truths of Tables 1 and 2 back from clean records, with the stiffness known.
fn with_stiffness_held(chapter: &mut Chapter) -> Found<()> {
    let errors = |truth: [f64; 3], velocity: f64, by_thesis: bool| -> Found<[f64; 2]> {
        let clean = motion(linear(truth)?, (0.0, velocity), WINDOW)?;
        let record = record(clean.velocity().values(), 0.0, 0)?;
        let problem = a1_of_stiffness(&record, [1.02 * truth[0], truth[1], START_DAMPING])?;
        let problem = if by_thesis { problem.by_thesis::<fmm_friction::Coulomb>() } else { problem };
        let fit = solve(&problem, problem.values(), &Options::default())?;
        Ok([value(&fit, "mass")? / truth[0] - 1.0, value(&fit, "damping")? / truth[2] - 1.0])
    };
    let mut worst = [0.0f64; 3];
    for row in TABLE_1 {
        let truth = [row.mass, row.stiffness, row.damping];
        let [m, c] = errors(truth, 1e-3 * row.velocity, false)?;
        let [euler, _] = errors(truth, 1e-3 * row.velocity, true)?;
        let all = [m, c, euler - euler_error(truth)];
        worst.iter_mut().zip(all).for_each(|(worst, error)| *worst = worst.max(error.abs()));
    }
    let target =
        |quantity, ours, limit, note: &str| Target::new("C4", quantity, "1", ours, Criterion::AtMost(limit)).note(note);
    let note = "largest of nine clean records with the truths of Table 1";
    chapter.target(target("error of m with k held, exact motion", worst[0], 1e-6, note));
    chapter.target(target("error of c with k held, exact motion", worst[1], 1e-6, note));
    let [m, c] = errors(MACHINE, VELOCITY, true)?;
    let note = "a clean record of Table 2's machine; m by (ω Δt)²/12 + c Δt/2m";
    chapter.target(target("error of m with k held, thesis' Euler motion", m.abs(), 3e-5, note));
    chapter.target(target("error of c with k held, thesis' Euler motion", c.abs(), 2e-5, "the same record"));
    let note = "nine clean records: 2.6e−5 to 3.2e−5, as c grows";
    chapter.target(target("the Euler error of m less its closed form, Table 1", worst[2], 1e-6, note));
    Ok(())
}

/// By how much a semi-implicit Euler motion that fits a period has too large a mass, relative.
///
/// ```text
/// 2 √(1 − ε) cos ω′Δt = 2 − (ω Δt)² − ε,   ε = c Δt/m     so that   (ω′/ω)² ≈ 1 + (ω Δt)²/12 + ε/2
/// ```
fn euler_error([mass, stiffness, damping]: [f64; 3]) -> f64 {
    stiffness / mass * INTERVAL * INTERVAL / 12.0 + 0.5 * damping / mass * INTERVAL
}
