//! One coefficient for all levels: Figs 36 to 41.

use fmm_frf::SingleDegreeOfFreedom;
use fmm_friction::Coulomb;
use fmm_identify::{Candidate, Experiment, Identification, ImpactTrial, Inquiry, Known, Machine, Terms, identify};
use fmm_uq::Observations;

use super::blows::{Blow, INTERVAL, NOISE, Spectra, Test, peak_receptance};
use super::forces::{pulse, velocity_curve};
use super::receptance::SHOWN;
use super::{COEFFICIENT, LOAD, linear, parts};
use crate::{Chapter, Criterion, Found, Settings, Target, printed};
use fmm_cli::figure::{Panel, Role};

/// Assumed relative uncertainty of the hammer's calibration (1).
const HAMMER: f64 = 0.02;

pub(super) fn add(
    chapter: &mut Chapter,
    blows: &[Blow],
    tests: &[Test],
    spectra: &mut Spectra,
    settings: &Settings<'_>,
) -> Found<()> {
    let machine = known_machine()?;
    let mut rows = Vec::new();
    for (index, (test, blow)) in tests.iter().zip(blows).enumerate() {
        let level = format!("{:.0} N", test.level.peak);
        let found = identify::<Coulomb>(&machine, &mobilities(&test.trials)?)?;
        let (mu, u) = coefficient(&found)?;
        chapter.target(
            Target::new(
                "C15",
                format!("μ from complex mobility, 1 Hz to 4 Hz, {level}"),
                "1",
                mu,
                Criterion::within(COEFFICIENT, 1e-3),
            )
            .printed("0.113")
            .note(format!("{} noisy trials, u = {u:.1e}", test.trials.len())),
        );
        let [dry, viscous] = closed_forms(blow, spectra)?;
        chapter.target(
            Target::new(
                "C15",
                format!("μ from the peak by π J/(8 F m ω), {level}"),
                "1",
                dry,
                Criterion::within(COEFFICIENT, 0.03),
            )
            .note("no noise; viscous damping counts as friction"),
        );
        chapter.target(
            Target::new(
                "C15",
                format!("μ from the peak with viscous damping, {level}"),
                "1",
                viscous,
                Criterion::within(COEFFICIENT, 0.01),
            )
            .note("no noise; the highest line is not quite the peak"),
        );
        let single = test
            .impulses()
            .into_iter()
            .zip(test.peaks()?)
            .map(|(impulse, peak)| Ok(linear()?.friction_after_impact(impulse, peak)? / LOAD));
        let single = Observations::new(&single.collect::<Found<Vec<_>>>()?)?;
        rows.push(vec![
            level,
            format!("{mu:.6} ± {u:.6}"),
            format!("{:.5} ± {:.5}", single.mean(), single.standard_deviation()),
            format!("{viscous:.4}"),
            format!("{dry:.4}"),
        ]);
        figures(chapter, test, &found, spectra, index)?;
        settings.done(0.4 + 0.15 * (index + 1) as f64);
    }
    let trials: Vec<ImpactTrial> = tests.iter().flat_map(|test| test.trials.iter().cloned()).collect();
    let free = known_machine_without_damping()?;
    let damped = Terms::default().with_linear_damping();
    let joint =
        Inquiry::of(&free, &mobilities(&trials)?).candidate(&Candidate::of::<Coulomb>().with(damped.clone()))?;
    joint_fit(chapter, &joint, trials.len(), &mut rows)?;
    chapter.table(
        "μ of the simulated blows, truth 0.113 at 6.67 N: fits of the complex mobility, and closed forms of the highest line",
        &["level", "fit", "closed form with c, trials (mean ± s)", "the same, no noise", "π J/(8 F m ω), no noise"],
        rows,
    );
    uncertainty(chapter, &tests[1].trials)
}

/// The machine of Table 2 and the load, without uncertainty.
pub(super) fn known_machine() -> Found<Machine> {
    machine_with(|value, _| Known::exact(value))
}

fn machine_with(known: impl Fn(f64, f64) -> Result<Known, fmm_model::ModelError>) -> Found<Machine> {
    let ([mass, stiffness, damping], u) = (printed::MACHINE, printed::MACHINE_DEVIATIONS);
    Ok(Machine::of_mass_and_stiffness(known(mass, u[0])?, known(stiffness, u[1])?)?
        .with_damping(known(damping, u[2])?)?
        .with_normal_load(known(LOAD, 0.0)?)?)
}

/// The same machine with a damping that is to be found.
fn known_machine_without_damping() -> Found<Machine> {
    let [mass, stiffness, _] = printed::MACHINE;
    let machine = Machine::of_mass_and_stiffness(Known::exact(mass)?, Known::exact(stiffness)?)?;
    Ok(machine.with_normal_load(Known::exact(LOAD)?)?)
}

/// The complex mobilities in the band that the thesis shows.
pub(super) fn mobilities(trials: &[ImpactTrial]) -> Found<Vec<Experiment>> {
    Ok(trials.iter().map(|trial| Experiment::mobility(trial, Some(SHOWN))).collect::<Result<_, _>>()?)
}

/// Fitted velocity (m/s) of every sample of the first of `trials`.
pub(super) fn fitted_velocity(found: &Identification, trials: &[ImpactTrial]) -> Found<Vec<f64>> {
    let model = found.model(&mobilities(trials)?, 0).ok_or("the fitted motion cannot be drawn")?;
    let mut velocity = vec![0.0; trials[0].velocity().len()];
    velocity[trials[0].motion()].copy_from_slice(&model);
    Ok(velocity)
}

/// μ with its standard uncertainty.
fn coefficient(found: &Identification) -> Found<(f64, f64)> {
    value(found, "mu")
}

fn value(found: &Identification, name: &str) -> Found<(f64, f64)> {
    let finding = found.finding(name).ok_or_else(|| format!("no finding {name}"))?;
    Ok((finding.value(), finding.uncertainty().ok_or_else(|| format!("{name} is not determined"))?))
}

/// μ from the highest line of a blow without noise, by dry friction alone and with viscous damping.
fn closed_forms(blow: &Blow, spectra: &mut Spectra) -> Found<[f64; 2]> {
    let machine = linear()?;
    let (_, peak) = peak_receptance(&spectra.mobility(&blow.force, blow.velocity())?)?;
    let undamped = SingleDegreeOfFreedom::new(machine.mass(), 0.0, machine.stiffness())?;
    let impulse = blow.level.impulse;
    Ok([undamped.friction_after_impact(impulse, peak)? / LOAD, machine.friction_after_impact(impulse, peak)? / LOAD])
}

fn joint_fit(chapter: &mut Chapter, joint: &Identification, trials: usize, rows: &mut Vec<Vec<String>>) -> Found<()> {
    let [mass, ..] = printed::MACHINE;
    let ((mu, u), (per_mass, of_per_mass)) = (coefficient(joint)?, value(joint, "damping_per_mass")?);
    let (damping, of_damping) = (mass * per_mass, mass * of_per_mass);
    chapter.target(
        Target::new("C15", "μ of all levels together, c free", "1", mu, Criterion::within(COEFFICIENT, 1e-3))
            .printed("0.113")
            .note(format!(
                "u = {u:.1e}; c = {damping:.4} ± {of_damping:.4} N s/m for a truth of {}",
                printed::MACHINE[2]
            )),
    );
    rows.push(vec![
        "all, c free".to_owned(),
        format!("{mu:.6} ± {u:.6}"),
        "–".to_owned(),
        "–".to_owned(),
        "–".to_owned(),
    ]);
    chapter.finding(
        "Blows of different impulse tell dry friction from viscous damping, which one blow hardly does.",
        format!(
            "All {trials} trials together give μ = {mu:.5} ± {u:.5} with c = {damping:.4} ± {of_damping:.4} N s/m, both found; the thesis holds c."
        ),
        &[],
    );
    Ok(())
}

/// Uncertainty of μ when mass, stiffness, damping and hammer are known as well as they are.
fn uncertainty(chapter: &mut Chapter, trials: &[ImpactTrial]) -> Found<()> {
    let trials = &trials[..1];
    let u = |machine: &Machine, trials: &[ImpactTrial]| -> Found<f64> {
        let (mu, u) = coefficient(&identify::<Coulomb>(machine, &mobilities(trials)?)?)?;
        Ok(100.0 * u / mu)
    };
    let machine = machine_with(Known::new)?;
    let noise = u(&known_machine()?, trials)?;
    let inputs = u(&machine, trials)?;
    let calibration = u(&machine, &[trials[0].clone().with_calibration_uncertainty(HAMMER)?])?;
    chapter.finding(
        "Three digits of a coefficient need a damping that is known; the height of a peak needs a hammer that is known as well.",
        format!(
            "One trial of 1000 N gives μ with a standard uncertainty of {noise:.2} % if all else is exact, {inputs:.2} % with the standard deviations \
             of Table 2, and {calibration:.2} % with a hammer calibrated to an assumed {:.0} %: the fit sees the impulse in the motion. A peak is \
             proportional to J and to 1/μ, and off by the {:.0} %.",
            100.0 * HAMMER,
            100.0 * HAMMER
        ),
        &[],
    );
    Ok(())
}

fn figures(
    chapter: &mut Chapter,
    test: &Test,
    found: &Identification,
    spectra: &mut Spectra,
    index: usize,
) -> Found<()> {
    let (names, numbers) = [
        (["figure_36", "figure_37"], [36, 37]),
        (["figure_38", "figure_39"], [38, 39]),
        (["figure_40", "figure_41"], [40, 41]),
    ][index];
    let trial = &test.trials[0];
    let velocity = fitted_velocity(found, &test.trials)?;
    let (mu, _) = coefficient(found)?;
    let simulated = format!(
        "The record is simulated: μ = {COEFFICIENT} at {LOAD} N, white noise of {} mm/s; found from {} trials: μ = {mu:.5}.",
        1e3 * NOISE,
        test.trials.len()
    );
    let left: Vec<f64> = trial.velocity().iter().zip(&velocity).map(|(record, fit)| record - fit).collect();
    let forces = Panel::new("time / ms", "force / N", 200.0).with(Role::Measured, "simulated force", pulse(trial));
    let velocities = Panel::new("", "velocity / (mm/s)", 280.0)
        .with(Role::Measured, "simulated record", velocity_curve(trial.velocity()))
        .with(Role::Fitted, "fit", velocity_curve(&velocity));
    let residuals =
        Panel::new("time / s", "record − fit / (mm/s)", 180.0).with(Role::Residual, "residual", velocity_curve(&left));
    let rest = found.motions()[0].stop_time().map_or_else(
        || "It does not come to rest.".to_owned(),
        |time| format!("It rests {:.2} s after the blow.", time - INTERVAL * trial.begin() as f64),
    );
    chapter.figure(
        names[0],
        format!(
            "Fig. {}. Force and velocity of a trial of the {} level. {simulated} {rest}",
            numbers[0], test.level.name
        ),
        &[forces, velocities, residuals],
    );
    let record = test.mobilities[0].within(SHOWN.0, SHOWN.1)?;
    let model = spectra.mobility_of_pulse(trial, &velocity)?.within(SHOWN.0, SHOWN.1)?;
    let curves = [(Role::Measured, "simulated record", &record), (Role::Fitted, "fit", &model)];
    chapter.figure(
        names[1],
        format!("Fig. {}. Real and imaginary part of the mobility of that trial. {simulated}", numbers[1]),
        &parts("mobility", "mm/(N s)", 1e3, &curves),
    );
    Ok(())
}
