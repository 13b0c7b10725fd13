//! Sources of the uncertainty of a finding, against closed forms.

use std::f64::consts::TAU;

use fmm_friction::{Coulomb, CoulombViscous};
use fmm_identify::{
    Candidate, Experiment, Finding, Identification, Inquiry, Known, Machine, Preparation, Source, Terms, compare,
    identify,
};
use fmm_record::{Quantity, Record};
use fmm_sim::{Sampling, Scenario, simulate};
use fmm_uq::{Budget, Contribution};

use crate::records::{LOAD, RELEASES, machine, noisy, velocity};

const MASS: f64 = 10.391;
const SAMPLES: usize = 1500;

fn motion() -> Vec<f64> {
    velocity::<Coulomb>(machine(), &[0.2], RELEASES[1], SAMPLES)
}

/// u by this source alone, and its degrees of freedom.
fn part(finding: &Finding, source: Source) -> (f64, f64) {
    let name = finding.parameter().name();
    let budget = finding.budget().unwrap();
    let found = budget.contributions().find(|part| part.input.name() == source.to_string());
    let part = found.unwrap_or_else(|| panic!("{name}: no {source}"));
    (part.uncertainty, part.input.degrees_of_freedom())
}

/// The parts make the whole: u² = Σ uᵢ², the shares 1, and ν that of Welch and Satterthwaite, G.4.1.
fn adds_up(found: &Identification) {
    for finding in found.findings() {
        let name = finding.parameter().name();
        let budget = finding.budget();
        let parts: Vec<Contribution<'_>> = budget.iter().flat_map(Budget::contributions).collect();
        let Some(u) = finding.uncertainty() else {
            assert!(parts.is_empty(), "{name}");
            continue;
        };
        let sum = |of: &dyn Fn(&Contribution<'_>) -> f64| parts.iter().map(of).sum::<f64>();
        assert!((sum(&|part| part.uncertainty.powi(2)) / (u * u) - 1.0).abs() < 1e-12, "{name}: {parts:?}");
        assert!((sum(&|part| part.share) - 1.0).abs() < 1e-12, "{name}: {parts:?}");
        let freedom = u.powi(4) / sum(&|part| part.uncertainty.powi(4) / part.input.degrees_of_freedom());
        assert!((finding.degrees_of_freedom() / freedom - 1.0).abs() < 1e-9, "{name}: {freedom}");
    }
}

/// μ = m f/N: each part is μ times the relative uncertainty of its source.
#[test]
fn a_coefficient_by_mass_load_and_gain() {
    let (u_mass, u_load, u_gain) = (0.003 * MASS, 0.002 * LOAD, 0.001);
    let machine = Machine::of_mass(Known::new(MASS, u_mass).unwrap()).unwrap();
    let machine = machine.with_normal_load(Known::new(LOAD, u_load).unwrap()).unwrap();
    let values = noisy(&motion(), 3).record().values().to_vec();
    let record = Record::new(0.0, 1e-3, values, Quantity::Velocity, "m/s").unwrap();
    let decay = Experiment::ring_down(&record, &Preparation::default().gain_uncertainty(u_gain)).unwrap();
    let found = identify::<Coulomb>(&machine, &[decay]).unwrap();
    adds_up(&found);
    let [mu, per_mass] = ["mu", "friction_per_mass"].map(|name| found.finding(name).unwrap());
    let (noise, _) = part(per_mass, Source::Residuals);
    let expected = [
        (Source::Residuals, noise / per_mass.value()),
        (Source::Mass, 0.003),
        (Source::NormalLoad, 0.002),
        (Source::Gain, 0.001),
    ];
    assert_eq!(mu.budget().unwrap().inputs().as_slice().len(), expected.len());
    for (source, relative) in expected {
        let (u, _) = part(mu, source);
        assert!((u / mu.value() / relative - 1.0).abs() < 1e-9, "{source}: {u}");
    }
    assert_eq!(part(mu, Source::Residuals).1, found.fit().degrees_of_freedom() as f64);
    assert_eq!(part(mu, Source::NormalLoad).1, f64::INFINITY);
}

/// A clock that is wrong by a thousandth moves each finding by its part of the clock, whatever the record is of; what is
/// a ratio of two times stays.
#[test]
fn a_clock_moves_what_goes_with_time() {
    const U: f64 = 1e-3;
    let law = CoulombViscous::new(0.2, 0.05).unwrap();
    let scenario = Scenario::new(machine(), law, LOAD).unwrap().starting_at(RELEASES[1], 0.0).unwrap();
    let motion = simulate(&scenario, &Sampling::uniform(1e-3, SAMPLES).unwrap()).unwrap();
    let by_mass = Machine::of_mass(Known::exact(MASS).unwrap()).unwrap();
    let by_stiffness = Machine::of_stiffness(Known::exact(1982.0).unwrap()).unwrap();
    for (quantity, unit, values) in [
        (Quantity::Displacement, "m", motion.position().values()),
        (Quantity::Velocity, "m/s", motion.velocity().values()),
    ] {
        for machine in [by_mass, by_stiffness] {
            let found = |interval: f64| {
                let record = Record::new(0.0, interval, values.to_vec(), quantity, unit).unwrap();
                let decay = Experiment::ring_down(&record, &Preparation::default().clock_uncertainty(U)).unwrap();
                identify::<CoulombViscous>(&machine, &[decay]).unwrap()
            };
            let [right, slow] = [1e-3, 1e-3 * (1.0 + U)].map(found);
            for name in [
                "natural_frequency_hz",
                "damping_per_mass",
                "friction_per_mass",
                "friction_force",
                "damping",
                "damping_ratio",
                "quality_factor",
                "logarithmic_decrement",
                "time_constant",
                "initial_position",
            ] {
                let [one, other] = [&right, &slow].map(|found| found.finding(name).unwrap());
                let budget = one.budget();
                let mut parts = budget.iter().flat_map(Budget::contributions);
                let u = parts
                    .find(|part| part.input.name() == Source::Clock.to_string())
                    .map_or(0.0, |part| part.uncertainty);
                let moved = (other.value() - one.value()).abs();
                let off = (u - moved) / (U * one.value().abs());
                assert!(off.abs() < 0.01, "{quantity} {name} = {}: {u}, moved by {moved}", one.value());
            }
        }
    }
}

/// ζ = c/(2mω₀), Q = 1/(2ζ), δ = 2πζ/√(1 − ζ²) and τ = 2m/c beside the damping that makes them, with its uncertainty.
#[test]
fn damping_is_stated_in_four_more_ways() {
    let values = velocity::<CoulombViscous>(machine(), &[0.2, 0.05], RELEASES[1], SAMPLES);
    let found = identify::<CoulombViscous>(&Machine::per_unit_mass(), &[noisy(&values, 6)]).unwrap();
    adds_up(&found);
    let of = |name: &str| {
        let finding = found.finding(name).unwrap();
        (finding.value(), finding.uncertainty().unwrap())
    };
    let ((frequency, _), (damping, u)) = (of("natural_frequency_hz"), of("damping_per_mass"));
    let ratio = damping / (2.0 * TAU * frequency);
    let expected = [
        ("damping_ratio", ratio),
        ("quality_factor", 0.5 / ratio),
        ("logarithmic_decrement", TAU * ratio / (1.0 - ratio * ratio).sqrt()),
        ("time_constant", 2.0 / damping),
    ];
    for (name, value) in expected {
        let (own, own_u) = of(name);
        assert!((own / value - 1.0).abs() < 1e-12, "{name}: {own} instead of {value}");
        // The frequency is known too well to matter.
        assert!((own_u / own / (u / damping) - 1.0).abs() < 1e-3, "{name}: {own_u}");
    }
    let dry = identify::<Coulomb>(&Machine::per_unit_mass(), &[noisy(&motion(), 6)]).unwrap();
    assert!(dry.finding("damping_ratio").is_none());
}

/// F = k f/ω²: of a known stiffness the noise comes in by the frequency as well.
#[test]
fn a_force_by_stiffness() {
    let stiffness = Known::new(1982.0, 2.0).unwrap();
    let found = identify::<Coulomb>(&Machine::of_stiffness(stiffness).unwrap(), &[noisy(&motion(), 4)]).unwrap();
    adds_up(&found);
    let [force, mass] = ["friction_force", "mass"].map(|name| found.finding(name).unwrap());
    for finding in [force, mass] {
        let by_stiffness = part(finding, Source::Stiffness).0 / finding.value();
        assert!((by_stiffness - 2.0 / 1982.0).abs() < 1e-9, "{by_stiffness}");
    }
    // m = k/(2π f₀)².
    let frequency = found.finding("natural_frequency_hz").unwrap();
    let by_noise = part(mass, Source::Residuals).0 / mass.value();
    let expected = 2.0 * frequency.uncertainty().unwrap() / frequency.value();
    assert!((by_noise / expected - 1.0).abs() < 1e-9, "{by_noise} instead of {expected}");
}

/// A damping of the machine that is too large takes from friction what it takes; the record tells a part of it. Of the
/// error of the damping u_r²/(u_r² + u²) stays, for u_r by the record alone.
#[test]
fn friction_beside_a_known_damping() {
    const U: f64 = 0.05;
    let machine = |damping: f64, u: f64| {
        let machine = Machine::of_mass(Known::exact(MASS).unwrap()).unwrap();
        machine.with_damping(Known::new(damping, u).unwrap()).unwrap()
    };
    let decays = [noisy(&motion(), 5)];
    let found = identify::<Coulomb>(&machine(0.1, U), &decays).unwrap();
    adds_up(&found);
    let force = |damping: f64| {
        let found = identify::<Coulomb>(&machine(damping, 0.0), &decays).unwrap();
        found.finding("friction_force").unwrap().value()
    };
    let free = Terms::default().with_linear_damping().with_damping_of_any_sign();
    let both =
        Inquiry::of(&machine(0.0, 0.0), &decays).candidate(&Candidate::of::<Coulomb>().with(free.clone())).unwrap();
    let of_record = MASS * both.finding("damping_per_mass").unwrap().uncertainty().unwrap();
    let (u, _) = part(found.finding("friction_force").unwrap(), Source::Damping);
    let held = 0.5 * (force(0.05) - force(0.15));
    let expected = held * of_record * of_record / (of_record * of_record + U * U);
    assert!((u / expected - 1.0).abs() < 0.05, "{u} instead of {expected}");
}

/// The effect of a law that is not excluded is a part of its own, and the parts still make the whole.
#[test]
fn laws_that_are_left_are_a_part() {
    let decays = [noisy(&motion()[..400], 6)];
    let comparison = compare(&Machine::per_unit_mass(), &decays, &fmm_identify::Candidate::standard()).unwrap();
    assert!(comparison.not_excluded().count() > 1);
    let preferred = comparison.preferred();
    adds_up(preferred);
    let friction = preferred.finding("friction_per_mass").unwrap();
    let ((others, _), (noise, _)) = (part(friction, Source::OtherLaws), part(friction, Source::Residuals));
    assert!(others > 0.0 && noise < friction.uncertainty().unwrap());
}
