//! Tests that would have told more: the thesis' own ring-downs as a plan.

use fmm_identify::design::{Aim, Guess, Plan, PlannedSensor, PlannedTest};
use fmm_identify::{Candidate, Known, Machine};
use fmm_model::Oscillator;
use fmm_record::Quantity;

use crate::printed::{LOADS, MACHINE, TABLE_5};
use crate::{Chapter, Criterion, Found, Target};
use fmm_cli::figure::{Panel, Role, label};

/// White noise (m/s), samples a second, and length of a record (s).
const NOISE: f64 = 5e-4;
const RATE: f64 = 1000.0;
const DURATION: f64 = 2.0;
/// Initial displacements (mm) from the least to the largest of the thesis.
const RELEASES: std::ops::RangeInclusive<u32> = 8..=22;
/// The load of Table 5 among the loads that the thesis used (N).
const OF_TABLE_5: usize = 1;

/// The candidates: every displacement under every load of the thesis, load by load.
fn plan() -> Found<Plan> {
    let [mass, stiffness, _] = MACHINE;
    let [.., floor, excess, decay] = TABLE_5[TABLE_5.len() - 1];
    let load = Known::exact(LOADS[OF_TABLE_5])?;
    let machine = Machine::of_mass(Known::exact(mass)?)?.with_normal_load(load)?;
    let frequency = Oscillator::new(mass, stiffness)?.natural_frequency();
    let guess = Guess::new(machine, &Candidate::named("berger")?, frequency, &[floor, excess, decay], &[])?;
    let sensor = PlannedSensor::new(Quantity::Velocity, NOISE)?;
    let mut tests = Vec::new();
    for load in LOADS {
        for release in RELEASES {
            let test = PlannedTest::release(1e-3 * f64::from(release), sensor, RATE, DURATION)?;
            tests.push(test.under_load(Known::exact(load)?)?.named(format!("{release} mm at {load:.2} N")));
        }
    }
    Ok(Plan::new(guess, tests)?)
}

/// Place of a test among the candidates.
fn place(load: usize, release: u32) -> usize {
    load * RELEASES.count() + (release - RELEASES.start()) as usize
}

pub(super) fn add(chapter: &mut Chapter) -> Found<()> {
    let plan = plan()?;
    let made: Vec<usize> = TABLE_5.iter().map(|row| place(OF_TABLE_5, row[0] as u32)).collect();
    let best = plan.best(&Aim::finding("mu"), made.len())?;
    let u = |set: &[usize]| -> Found<f64> {
        Ok(100.0 * plan.predict(set)?.relative_uncertainty("mu").ok_or("the tests do not determine μ₀")?)
    };
    let (ours, theirs) = (u(best.measurements())?, u(&made)?);
    let chosen: Vec<String> =
        best.counts().iter().map(|(test, count)| format!("{count} × {}", plan.tests()[*test].name())).collect();
    let target = Target::new(
        "F4",
        "u(μ₀) of the best six tests over that of Table 5's six",
        "1",
        ours / theirs,
        Criterion::AtMost(0.5),
    );
    chapter.target(target.note(format!("predicted: {ours:.2} % and {theirs:.2} %")));
    let (least, most) = (u(&made[..1])?, u(&made[made.len() - 1..])?);
    chapter.finding(
        "Six tests at other displacements and loads would have told μ₀ better than the six of Table 5.",
        format!(
            "By itself the test at 10 mm of Table 5 tells μ₀ to {least:.0} %, that at 16 mm to {most:.0} % (Berger's law of its last row, {} mm/s \
             of noise, one law for all tests), and all six together to {theirs:.1} %. The best six of the thesis' own displacements and loads \
             tell it to {ours:.2} %: {}. One load alone leaves μ₀ and μ₁ to be exchanged for each other (r = {:.4} after Table 5's tests).",
            1e3 * NOISE,
            chosen.join(", "),
            plan.predict(&made)?.correlation("mu", "excess_mu")?.unwrap_or(f64::NAN)
        ),
        &[],
    );
    figure(chapter, &plan, &made, &best.counts())
}

fn figure(chapter: &mut Chapter, plan: &Plan, made: &[usize], best: &[(usize, usize)]) -> Found<()> {
    /// Uncertainties (%) above are out of the picture.
    const IN_SIGHT: f64 = 60.0;
    let mut panel = Panel::new("initial displacement / mm", label("u(μ₀)/μ₀ by one test", "%"), 360.0);
    let at = |test: usize| -> Found<Option<(f64, f64)>> {
        let u = plan.predict(&[test])?.relative_uncertainty("mu").map(|u| 100.0 * u);
        let release = f64::from(RELEASES.start() + (test % RELEASES.count()) as u32);
        Ok(u.filter(|u| *u < IN_SIGHT).map(|u| (release, u)))
    };
    let points = |tests: &mut dyn Iterator<Item = usize>| -> Found<Vec<(f64, f64)>> {
        let found = tests.map(at).collect::<Found<Vec<_>>>()?;
        Ok(found.into_iter().flatten().collect())
    };
    for (load, role) in [(0, Role::Reference), (OF_TABLE_5, Role::Measured), (LOADS.len() - 1, Role::Fitted)] {
        let curve = points(&mut RELEASES.map(|release| place(load, release)))?;
        panel = panel.with(role, format!("under {:.2} N", LOADS[load]), curve);
    }
    let panel = panel.with(Role::Points, "the tests of Table 5", points(&mut made.iter().copied())?).with(
        Role::FittedPoints,
        "in the best six",
        points(&mut best.iter().map(|(test, _)| *test))?,
    );
    chapter.figure(
        "next_tests",
        format!(
            "Predicted relative uncertainty of μ₀ by one ring-down of {DURATION} s against its initial displacement, with white noise of {} mm/s: \
             Berger's law of the last row of Table 5.",
            1e3 * NOISE
        ),
        &[panel],
    );
    Ok(())
}
