//! Dahl, `LuGre` and Maxwell slip on simulated records of known truth: what a ring-down says of presliding.

use fmm_friction::{Dahl, LawFamily, LuGre, MaxwellSlipOf};
use fmm_identify::{
    Candidate, Comparison, Experiment, Identification, Known, Machine, Offset, Preparation, Terms, compare,
};
use fmm_record::Record;
use fmm_sim::Sampling;

use super::{candidates, side_by_side};
use crate::printed::{LOADS, MACHINE};
use crate::ring_down::{self, INTERVAL, Viscous, over_time, velocity_record, with_noise};
use crate::{Chapter, Criterion, Found, Settings, Target};
use fmm_cli::figure::{Panel, Role};

/// Normal load (N), displacement (m), white noise (m/s), and samples of a record.
const LOAD: f64 = LOADS[1];
const RELEASE: f64 = -0.016;
const NOISE: f64 = 5e-4;
const SAMPLES: usize = 2400;

/// A law with the values that a record was simulated with.
struct Truth {
    name: &'static str,
    /// In words.
    values: &'static str,
    record: Record,
    /// Findings of its own law with their true values, and units.
    findings: Vec<(&'static str, f64, &'static str)>,
}

impl Truth {
    fn of<F: LawFamily>(
        name: &'static str,
        values: &'static str,
        law: &[f64],
        findings: &[(&'static str, f64, &'static str)],
        seed: u64,
    ) -> Found<Self> {
        let scenario = ring_down::scenario::<F>(ring_down::machine(Viscous::Mean)?, law, LOAD, (RELEASE, 0.0))?;
        let motion = ring_down::motion::<F>(&scenario, &Sampling::uniform(INTERVAL, SAMPLES)?)?;
        let record = velocity_record(with_noise(motion.velocity().values(), NOISE, seed)?)?;
        Ok(Self { name, values, record, findings: findings.to_vec() })
    }

    /// One of each law, all of which hold about 2 N over some hundredths of a millimetre.
    fn all(seed: u64) -> Found<[Self; 3]> {
        let [mass, ..] = MACHINE;
        Ok([
            Self::of::<Dahl>(
                "Dahl",
                "μ = 0.25, σ = 12.5 /mm",
                &[0.25, 1.25e4, 1.0],
                &[("mu", 0.25, "1"), ("contact_stiffness", 1.25e4 * LOAD, "N/m")],
                seed,
            )?,
            Self::of::<LuGre>(
                "LuGre",
                "μ_c = 0.23, μ_s = 0.40, v_s = 50 mm/s, σ₀ = 20 /mm, σ₁ = 20 s/m",
                &[0.23, 0.40, 0.05, 1.0, 2e4, 20.0, 0.0],
                &[
                    ("sliding_mu", 0.23, "1"),
                    ("static_friction_per_mass", 0.40 * LOAD / mass, "m/s²"),
                    ("stribeck_speed", 0.05, "m/s"),
                    ("contact_stiffness", 2e4 * LOAD, "N/m"),
                    ("contact_bristle_damping_per_mass", 20.0 * LOAD / mass, "1/s"),
                ],
                seed + 1,
            )?,
            Self::of::<MaxwellSlipOf<2>>(
                "Maxwell slip",
                "w₁ = 0.15, κ₁ = 15 /mm, w₂ = 0.10, κ₂ = 2 /mm",
                &[0.15, 1.5e4, 0.10, 2e3],
                &[
                    ("level_1_mu", 0.15, "1"),
                    ("contact_stiffness_1", 1.5e4 * LOAD, "N/m"),
                    ("level_2_mu", 0.10, "1"),
                    ("contact_stiffness_2", 2e3 * LOAD, "N/m"),
                ],
                seed + 2,
            )?,
        ])
    }

    fn decay(&self) -> Found<Experiment> {
        Ok(Experiment::ring_down(&self.record, &Preparation::default().offset(Offset::Fixed(0.0)))?)
    }
}

pub(super) fn add(chapter: &mut Chapter, settings: &Settings<'_>) -> Found<()> {
    let [mass, _, damping] = MACHINE;
    let machine = Machine::of_mass(Known::exact(mass)?)?
        .with_damping(Known::exact(damping)?)?
        .with_normal_load(Known::exact(LOAD)?)?;
    // The viscous part of LuGre is the machine's own, which is known.
    let [coulomb, dahl, lugre, maxwell] = candidates(&Terms::default())?;
    let candidates = [coulomb, dahl, lugre.holding("damping_per_mass", 0.0)?, maxwell];
    let truths = Truth::all(settings.seed().wrapping_mul(1_000_003).wrapping_add(91_000))?;
    let compared = |index: usize| -> Found<(Comparison, Vec<Candidate>, usize)> {
        // The first candidate has no state; the others come in the order of the truths.
        let own = index + 1;
        let dry_and_own = || vec![candidates[0].clone(), candidates[own].clone()];
        let (fitted, own) = if settings.is_quick() { (dry_and_own(), 1) } else { (candidates.to_vec(), own) };
        Ok((compare(&machine, &[truths[index].decay()?], &fitted)?, fitted, own))
    };
    let (mut rows, mut leads, mut shifts) = (Vec::new(), Vec::new(), Vec::new());
    for ((index, truth), compared) in truths.iter().enumerate().zip(side_by_side(truths.len(), &compared)) {
        let (comparison, fitted, own) = compared?;
        rows.extend(rows_of(truth, &comparison, &fitted));
        targets(chapter, truth, &comparison.identifications()[own])?;
        leads.push(format!("{:.0} ({})", lead(&comparison, own), truth.name));
        shifts.push(format!("{:+.2} % ({})", 100.0 * shift(&comparison, own)?, truth.name));
        if index == 1 {
            figure(chapter, truth, &comparison, own)?;
        }
        settings.done(0.2 * (index + 1) as f64);
    }
    chapter.table(
        format!("Ring-downs from 16 mm at {LOAD:.3} N, simulated with {} mm/s of noise and fitted", 1e3 * NOISE),
        &["truth", "values", "fitted by", "rms residual / (mm/s)", "Akaike less best", "f₀ / Hz", "preferred"],
        rows,
    );
    chapter.finding(
        "Of a machine whose mass and damping are known, a simulated ring-down tells the laws with a state apart and gives their parameters.",
        format!(
            "Exponents are held. The law that made the record is preferred; the next best of those that were fitted has an Akaike criterion \
             higher by {} (LuGre's law has that of Dahl as a case). Dry friction in its place puts the natural frequency off by {}, because the \
             contact is a spring wherever the motion turns. Whether a contact obeys one of these laws, such a record does not prove.",
            leads.join(", "),
            shifts.join(", ")
        ),
        &[],
    );
    Ok(())
}

/// How much better the criterion of the law at `own` is than that of the best other one.
fn lead(comparison: &Comparison, own: usize) -> f64 {
    let scores = comparison.scores();
    let others = scores.iter().enumerate().filter(|(other, _)| *other != own).map(|(_, score)| *score);
    others.fold(f64::INFINITY, f64::min) - scores[own]
}

/// How far the natural frequency is off with dry friction in place of the law at `own`, relative.
fn shift(comparison: &Comparison, own: usize) -> Found<f64> {
    let frequency = |index: usize| comparison.identifications()[index].finding("natural_frequency_hz");
    let (dry, own) = (frequency(0).ok_or("no frequency")?, frequency(own).ok_or("no frequency")?);
    Ok(dry.value() / own.value() - 1.0)
}

fn rows_of(truth: &Truth, comparison: &Comparison, candidates: &[Candidate]) -> Vec<Vec<String>> {
    let least = comparison.scores().iter().copied().fold(f64::INFINITY, f64::min);
    let fits = comparison.identifications().iter().zip(comparison.scores()).zip(candidates);
    let row = |((found, score), candidate): ((&Identification, &f64), &Candidate)| {
        let preferred = if score - least > 0.0 { "" } else { "yes" };
        vec![
            truth.name.to_owned(),
            truth.values.to_owned(),
            candidate.name(),
            format!("{:.3}", 1e3 * found.rms_residual()),
            format!("{:.0}", score - least),
            found
                .finding("natural_frequency_hz")
                .map_or_else(|| "–".to_owned(), |finding| format!("{:.4}", finding.value())),
            preferred.to_owned(),
        ]
    };
    fits.map(row).collect()
}

fn targets(chapter: &mut Chapter, truth: &Truth, found: &Identification) -> Found<()> {
    for (name, value, unit) in &truth.findings {
        let finding = found.finding(name).ok_or_else(|| format!("{} has no {name}", truth.name))?;
        let u = finding.uncertainty().ok_or_else(|| format!("{name} of {} is not determined", truth.name))?;
        let quantity = format!("{} fitted to its own record, {}", truth.name, name.replace('_', " "));
        chapter.target(
            Target::new("F1", quantity, unit, finding.value(), Criterion::near(*value, 4.0 * u))
                .note(format!("truth within 4 u, u = {u:.1e}")),
        );
    }
    Ok(())
}

fn figure(chapter: &mut Chapter, truth: &Truth, comparison: &Comparison, own: usize) -> Found<()> {
    let decay = truth.decay()?;
    let decays = std::slice::from_ref(&decay);
    let record = decay.record();
    let mut velocities = Panel::new("", "velocity / (mm/s)", 280.0).with(
        Role::Measured,
        "simulated record",
        over_time(record.values(), 1e3),
    );
    let mut residuals = Panel::new("time / s", "record − fit / (mm/s)", 240.0);
    for (law, role, found) in [
        ("dry friction", Role::Residual, &comparison.identifications()[0]),
        (truth.name, Role::Fitted, &comparison.identifications()[own]),
    ] {
        let model = found.model(decays, 0).ok_or("the fitted motion cannot be drawn")?;
        let left: Vec<f64> = record.values().iter().zip(&model).map(|(record, fit)| record - fit).collect();
        velocities = velocities.with(role, format!("fit by {law}"), over_time(&model, 1e3));
        residuals = residuals.with(role, law, over_time(&left, 1e3));
    }
    chapter.figure(
        "presliding",
        format!(
            "A ring-down with {} ({}) at {LOAD:.3} N from 16 mm, fitted by dry friction and by its own law. The record is simulated, with white \
             noise of {} mm/s.",
            truth.name,
            truth.values,
            1e3 * NOISE
        ),
        &[velocities, residuals],
    );
    Ok(())
}
