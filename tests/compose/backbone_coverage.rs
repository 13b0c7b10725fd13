//! Coverage of a backbone over random machines: points within their uncertainties, terms and springs that are there.
//!
//! The figures in `docs/study.md` are those of these seeds; the uncertainties were set on others.

use std::f64::consts::{PI, TAU};

use fmm_frf::DampingTermKind::{self, Coulomb, Linear, Quadratic};
use fmm_frf::{Backbone, BackboneOptions};
use fmm_friction::Stribeck;
use fmm_model::{Damping, Oscillator, Restoring};
use fmm_record::{Quantity, Record};
use fmm_sim::{Sampling, Scenario, simulate};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal, Uniform};

const SEEDS: std::ops::Range<u64> = 1000..1040;
/// m.
const AMPLITUDE: f64 = 1e-2;

/// A law with the terms that are true of it, and whether the spring is curved.
struct Cell {
    name: &'static str,
    terms: &'static [DampingTermKind],
    /// Static friction exceeds sliding friction.
    falls: bool,
    is_curved: bool,
}

/// A record, and the machine that made it.
struct Case {
    record: Record,
    f0: f64,
    cubic: f64,
    levels: [f64; 3],
    /// μ_s/μ_c and the Stribeck speed.
    fall: (f64, f64),
}

impl Case {
    /// A machine of 1 Hz to 5 Hz, 8 to 40 half cycles, 100 to 200 samples a period, noise of 0.05 % to 2 %; a
    /// displacement or a velocity, which ends before the stop or with four cycles of rest.
    fn new(cell: &Cell, seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut between = |a: f64, b: f64| -> f64 { Uniform::new(a, b).unwrap().sample(&mut random) };
        let f0 = between(0.0, 5f64.ln()).exp();
        let half_cycles = between(8f64.ln(), 40f64.ln()).exp();
        let noise = between(5e-4f64.ln(), 2e-2f64.ln()).exp();
        let per_period = between(100.0, 200.0);
        let (is_velocity, rests) = (between(0.0, 1.0) < 0.5, between(0.0, 1.0) < 0.5);
        let (loss, drag, part) = (between(0.5, 3.0), between(0.3, 2.0), between(0.7, 0.95));
        let hardening = between(0.02, 0.1).copysign(between(-1.0, 1.0));
        let fall = if cell.falls { (between(1.2, 1.6), between(0.1, 0.4)) } else { (1.0, 1.0) };
        let omega = TAU * f0;
        let speed = omega * AMPLITUDE;
        let cubic = if cell.is_curved { hardening / (0.75 * AMPLITUDE * AMPLITUDE) } else { 0.0 };
        let has = |kind| cell.terms.contains(&kind);
        let ratio = if has(Linear) { (1.0 + loss).ln() / (half_cycles * PI) } else { 0.0 };
        // Each half cycle x → q x − (1 + q) d; none is left after the last.
        let kept = (-PI * ratio).exp();
        let all: f64 =
            if has(Linear) { (1.0 - kept) / (kept.powf(-half_cycles) - 1.0) / (1.0 + kept) } else { 0.5 / half_cycles };
        let share = if has(Quadratic) { 0.7 } else { 1.0 };
        let friction = if has(Coulomb) { share * all * AMPLITUDE * omega * omega } else { 0.0 };
        let quadratic = if has(Quadratic) { drag * 1.5 * friction / (speed * speed) } else { 0.0 };
        let levels = [friction, 2.0 * omega * ratio, quadratic];
        let restoring = if cell.is_curved { Restoring::polynomial(cubic, 0.0).unwrap() } else { Restoring::Linear };
        let machine = Oscillator::per_unit_mass(f0).unwrap().with_restoring(restoring);
        let machine = machine.with_damping(Damping::new(levels[1], quadratic).unwrap());
        let law = Stribeck::new(friction, fall.0 * friction, fall.1 * speed, 2.0, 0.0).unwrap();
        let scenario = Scenario::new(machine, law, 1.0).unwrap().starting_at(AMPLITUDE, 0.0).unwrap();
        let samples = ((0.8 * half_cycles + 6.0) * per_period) as usize;
        let interval = 1.0 / (f0 * per_period);
        let motion = simulate(&scenario, &Sampling::uniform(interval, samples).unwrap()).unwrap();
        let positions = motion.position().values();
        let stop = positions.windows(2).rposition(|pair| (pair[0] - pair[1]).abs() > 1e-15).unwrap();
        let end = match (has(Coulomb), rests) {
            (false, _) => 0.5 * half_cycles * per_period,
            (true, false) => part * stop as f64,
            (true, true) => stop as f64 + 4.0 * per_period,
        };
        let (values, quantity, unit, peak) = if is_velocity {
            (motion.velocity().values(), Quantity::Velocity, "m/s", speed)
        } else {
            (positions, Quantity::Displacement, "m", AMPLITUDE)
        };
        let noisy = |value: &f64| {
            let draw: f64 = StandardNormal.sample(&mut random);
            value + noise * peak * draw
        };
        let values = values.iter().take(end as usize).map(noisy).collect();
        let record = Record::sampled(1.0 / interval, values, quantity, unit).unwrap();
        Self { record, f0, cubic, levels, fall: (fall.0, fall.1 * speed) }
    }

    /// f (Hz) of the spring at an amplitude (m).
    fn frequency(&self, amplitude: f64) -> f64 {
        let stiffening = self.cubic * amplitude * amplitude;
        self.f0 * (1.0 + 0.75 * stiffening + 3.0 / 128.0 * stiffening * stiffening).sqrt()
    }

    /// c_eq/m (1/s) by the energy that a cycle of this velocity amplitude (m/s) loses.
    fn damping(&self, velocity: f64) -> f64 {
        let [friction, linear, quadratic] = self.levels;
        let steps = 200;
        let force = |sine: f64| {
            let excess = (self.fall.0 - 1.0) * (-(velocity * sine / self.fall.1).powi(2)).exp();
            sine * (friction * (1.0 + excess) + (linear + quadratic * velocity * sine) * velocity * sine)
        };
        let sum: f64 = (0..steps).map(|i| force(((f64::from(i) + 0.5) / f64::from(steps) * 0.5 * PI).sin())).sum();
        2.0 * sum / f64::from(steps) / velocity
    }
}

/// Under every law at most a tenth of the points is off by more than two standard uncertainties; the curves that are
/// suggested run through the points; springs that are not there are named in at most 2 of 40 records, and the true
/// terms are among those that are not excluded in at least 36.
#[test]
fn points_terms_and_springs_are_those_of_random_machines() {
    let cell = |name, terms| Cell { name, terms, falls: false, is_curved: false };
    for cell in [
        cell("viscous", &[Linear]),
        cell("coulomb", &[Coulomb]),
        cell("coulomb_viscous", &[Coulomb, Linear]),
        cell("coulomb + quadratic", &[Coulomb, Quadratic]),
        Cell { falls: true, ..cell("stribeck", &[Coulomb]) },
        Cell { is_curved: true, ..cell("coulomb + cubic spring", &[Coulomb]) },
        Cell { is_curved: true, ..cell("coulomb_viscous + cubic spring", &[Coulomb, Linear]) },
    ] {
        let Cell { name, is_curved, .. } = cell;
        let (mut rows, mut off_frequency, mut off_damping) = (0.0, 0.0, 0.0);
        let (mut springs, mut falling, mut decided, mut contained, mut apart) = (0, 0, 0, 0, 0.0);
        for seed in SEEDS {
            let case = Case::new(&cell, seed);
            let backbone = Backbone::of(&case.record, &BackboneOptions::default()).unwrap();
            let suggestion = backbone.suggestion();
            for point in backbone.points() {
                let amplitude = point.amplitude.value;
                let (f, c) = (point.frequency, point.damping);
                let truth = case.frequency(amplitude);
                let is_off = |off: f64, u: f64| f64::from(u8::from(off.abs() > 2.0 * u));
                rows += 1.0;
                off_frequency += is_off(f.value - truth, f.uncertainty);
                off_damping += is_off(c.value - case.damping(TAU * truth * amplitude), c.uncertainty);
                let said = suggestion.frequency_at(amplitude).unwrap_or(f.value);
                let velocity = TAU * f.value * amplitude;
                // No sum of terms runs through the points of falling friction.
                let follows = f64::from(u8::from(!suggestion.falls));
                apart += follows
                    * is_off(f.value - said, f.uncertainty)
                        .max(is_off(c.value - suggestion.damping_at(velocity), c.uncertainty));
            }
            springs += u32::from(suggestion.spring.len() > 1);
            falling += u32::from(suggestion.falls);
            let is_true = |model: &str| {
                let terms = model.split(" + ").filter(|term| !term.ends_with("spring"));
                terms.collect::<Vec<_>>().join(" + ")
                    == name.trim_end_matches(" + cubic spring").replace("stribeck", "coulomb")
            };
            let is_named = is_true(&suggestion.model());
            decided += u32::from(is_named && suggestion.others.is_empty());
            contained += u32::from(is_named || suggestion.others.iter().any(|other| is_true(other)));
        }
        let share = [off_frequency, off_damping, apart].map(|count| 100.0 * count / rows);
        println!(
            "{}: {rows} points, off by 2 u: f {:.1} %, c {:.1} %, from the curves {:.1} %; {springs} springs, {falling} fall, terms decided \
             {decided}, contained {contained}",
            name, share[0], share[1], share[2]
        );
        assert!(rows > 300.0 && share.iter().all(|share| *share < 10.0), "{name}: {rows} points, {share:?} %");
        assert!(if is_curved { springs >= 36 } else { springs <= 2 }, "{name}: {springs} springs");
        assert!(if name == "stribeck" { falling >= 20 } else { falling <= 2 }, "{name}: {falling} fall");
        assert!(contained >= 36, "{name}: {contained}");
    }
}
