//! Friction over speed without a law, from records whose curve is known.

use fmm_friction::{CoulombViscous, ExponentialPair, LawFamily, MakkarDixon, PowerLaw, RegularisedStribeck, Stribeck};
use fmm_identify::{
    Candidate, Comparison, Experiment, FrictionCurve, FrictionLevel, Inquiry, Known, Machine, Preparation, Source,
    search,
};
use fmm_model::Oscillator;
use fmm_record::{Quantity, Record};
use fmm_sim::{Engine, Exact, RungeKutta, Sampling, Scenario};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};

use crate::simulated::{self, INTERVAL, Motion, machine, record};

/// Velocity (m/s) of 2 Hz, F/m = 0.3 m/s² and c/m of this `damping` (1/s), released at 20 mm, at `rate` (Hz), noise
/// left out.
fn velocity(damping: f64, rate: f64) -> Vec<f64> {
    let law = CoulombViscous::new(0.3, damping).unwrap();
    let scenario = Scenario::new(Oscillator::per_unit_mass(2.0).unwrap(), law, 1.0).unwrap();
    let sampling = Sampling::uniform(1.0 / rate, (2.6 * rate) as usize).unwrap();
    let motion = Exact.run(&scenario.starting_at(0.02, 0.0).unwrap(), &sampling).unwrap();
    motion.velocity().values().to_vec()
}

fn noisy(values: &[f64], noise: f64, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let normal = Normal::new(0.0, noise).unwrap();
    values.iter().map(|value| value + normal.sample(&mut random)).collect()
}

fn ring_down(values: Vec<f64>, rate: f64, unit: &str) -> Experiment {
    let record = Record::sampled(rate, values, Quantity::Velocity, unit).unwrap();
    Experiment::ring_down(&record, &Preparation::default()).unwrap()
}

fn curve(values: Vec<f64>, rate: f64) -> FrictionCurve {
    FrictionCurve::of(&Machine::per_unit_mass(), &[ring_down(values, rate, "m/s")]).unwrap()
}

fn require_within(level: &FrictionLevel, truth: f64, times: f64) {
    let distance = (level.value() - truth).abs();
    assert!(distance <= times * level.uncertainty(), "{level} is not {truth}");
}

/// Constant friction: the curve is flat, and its mean over the path is the level.
#[test]
fn constant_friction_gives_a_flat_curve() {
    let curve = curve(noisy(&velocity(0.0, 400.0), 5e-4, 1), 400.0);
    assert_eq!((curve.unit(), curve.speed_unit(), curve.is_whole()), ("m/s²", "m/s", true));
    for level in curve.levels() {
        require_within(&level, 0.3, 2.6);
    }
    let mean = curve.mean_over_path();
    require_within(&mean, 0.3, 2.0);
    assert!(mean.uncertainty() < 2e-3 * 0.3, "{mean}");
    assert!(curve.limits().is_empty(), "{:?}", curve.limits());
    assert_eq!((curve.at(-1e-9), curve.at(1.01 * curve.speeds()[14])), (None, None));
    assert_eq!(curve.at(0.0), Some(curve.at_rest()));
}

/// Of records with other noise, intervals at each speed hold the true line as often as they say, and bands wherever it
/// lies.
#[test]
fn intervals_hold_the_true_line() {
    const SEEDS: u64 = 12;
    let clean = velocity(0.3, 400.0);
    let (mut inside, mut all, mut whole) = (0, 0, 0_u64);
    for seed in 0..SEEDS {
        let curve = curve(noisy(&clean, 1e-3, 10 + seed), 400.0);
        let truth = |speed: f64| 0.3 + 0.3 * speed;
        for (speed, level) in curve.speeds().iter().zip(curve.levels()) {
            let (low, high) = level.interval(0.95).unwrap();
            inside += u64::from((low..=high).contains(&truth(*speed)));
            all += 1;
        }
        let band = curve.band(0.95).unwrap();
        let holds = |(speed, (low, high)): (&f64, &(f64, f64))| (*low..=*high).contains(&truth(*speed));
        whole += u64::from(curve.speeds().iter().zip(&band).all(holds));
    }
    assert!(100 * inside > 88 * all, "{inside} of {all}");
    assert!(whole >= SEEDS - 2, "{whole} of {SEEDS}");
}

/// Damping that is declared is not part of the curve, and its uncertainty is that of the slope.
#[test]
fn declared_damping_is_taken_out() {
    let values = noisy(&velocity(0.3, 400.0), 2e-4, 3);
    let machine = Machine::per_unit_mass().with_damping(Known::new(0.3, 0.01).unwrap()).unwrap();
    let curve = FrictionCurve::of(&machine, &[ring_down(values, 400.0, "m/s")]).unwrap();
    assert!(!curve.is_whole());
    for level in curve.levels() {
        require_within(&level, 0.3, 2.6);
    }
    let top = curve.speeds()[14];
    assert!(curve.at_top_speed().uncertainty() > 0.009 * top, "{}", curve.at_top_speed());
    let by_damping = contribution(&curve.at_top_speed(), Source::Damping);
    assert!((by_damping / (0.01 * top) - 1.0).abs() < 0.1, "{by_damping} of {}", 0.01 * top);
}

fn contribution(level: &FrictionLevel, source: Source) -> f64 {
    level.contributions().iter().filter(|(own, _)| *own == source).fold(0.0, |u: f64, (_, part)| u.hypot(*part))
}

/// A declared uncertainty has its relative part of each level, all parts make the uncertainty, and a curve that is kept
/// as its levels is the same curve.
#[test]
fn an_uncertainty_has_its_sources() {
    let known = |value: f64, relative: f64| Known::new(value, relative * value).unwrap();
    let machine = Machine::of_mass(known(10.0, 2e-3)).unwrap().with_normal_load(known(20.0, 5e-3)).unwrap();
    let record = ring_down(noisy(&velocity(0.3, 400.0), 1e-3, 6), 400.0, "m/s");
    let curve = FrictionCurve::of(&machine, &[record]).unwrap();
    let values: Vec<f64> = curve.levels().iter().map(FrictionLevel::value).collect();
    for level in curve.levels().iter().chain([&curve.mean_over_path()]) {
        for (source, relative) in [(Source::Mass, 2e-3), (Source::NormalLoad, 5e-3)] {
            let part = contribution(level, source) / (relative * level.value());
            assert!((part - 1.0).abs() < 1e-2, "{source}: {part} in {level}");
        }
        let all = level.contributions().iter().fold(0.0, |u: f64, (_, part)| u.hypot(*part));
        assert!((all / level.uncertainty() - 1.0).abs() < 1e-3, "{all} in {level}");
    }
    for speed in [0.0, 0.003, 0.05, 0.17, curve.speeds()[14]] {
        let kept = FrictionCurve::through(curve.speeds(), &values, speed).unwrap();
        assert!((kept / curve.at(speed).unwrap().value() - 1.0).abs() < 1e-6, "at {speed}");
    }
    assert_eq!(FrictionCurve::through(curve.speeds(), &values, 1.0), None);
    assert_eq!(FrictionCurve::through(curve.speeds(), &values[1..], 0.05), None);
}

/// From record to record a level scatters by the part of the residuals, and by less than its whole uncertainty.
#[test]
fn levels_scatter_by_the_part_of_the_residuals() {
    const SEEDS: u64 = 30;
    let law = Stribeck::new(0.3, 0.42, 0.04, 2.0, 0.3).unwrap();
    let scenario = Scenario::new(Oscillator::per_unit_mass(2.0).unwrap(), law, 1.0).unwrap();
    let motion = RungeKutta::new(1e-12)
        .unwrap()
        .run(&scenario.starting_at(0.02, 0.0).unwrap(), &Sampling::uniform(1.0 / 300.0, 750).unwrap())
        .unwrap();
    let clean = motion.velocity().values();
    let curve = |seed: u64| {
        let record = ring_down(noisy(clean, 1e-3, 100 + seed), 300.0, "m/s");
        // A few do not settle.
        FrictionCurve::of(&Machine::per_unit_mass(), &[record]).ok()
    };
    let curves: Vec<FrictionCurve> = (0..SEEDS).filter_map(curve).collect();
    assert!(curves.len() > 24, "{}", curves.len());
    let speeds = [0.01, 0.03, 0.06, 0.12];
    let (mut by_residuals, mut by_all) = (0.0, 0.0);
    for speed in speeds {
        let levels: Vec<FrictionLevel> = curves.iter().map(|curve| curve.at(speed).unwrap()).collect();
        let count = levels.len() as f64;
        let mean = levels.iter().map(FrictionLevel::value).sum::<f64>() / count;
        let scatter = levels.iter().map(|level| (level.value() - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let square = |of: &dyn Fn(&FrictionLevel) -> f64| levels.iter().map(|one| of(one).powi(2)).sum::<f64>() / count;
        let ratio = scatter / square(&|level| contribution(level, Source::Residuals));
        // Three standard deviations of a variance of some 27 degrees of freedom, and what a linearisation leaves out.
        assert!((0.4..2.0).contains(&ratio), "{ratio} at {speed} m/s");
        by_residuals += ratio / speeds.len() as f64;
        by_all += scatter / square(&FrictionLevel::uncertainty) / speeds.len() as f64;
    }
    assert!((0.7..1.4).contains(&by_residuals) && by_all < 0.9, "{by_residuals}, {by_all}");
}

/// Two ring-downs share the curve: it reaches to the larger of their speeds and is known better.
#[test]
fn ring_downs_share_the_curve() {
    let values = velocity(0.3, 400.0);
    let one = ring_down(noisy(&values, 1e-3, 4), 400.0, "m/s");
    // From the first reversal on, half a period later.
    let later = values[100..].to_vec();
    let other = ring_down(noisy(&later, 1e-3, 5), 400.0, "m/s");
    let alone = FrictionCurve::of(&Machine::per_unit_mass(), std::slice::from_ref(&one)).unwrap();
    let both = FrictionCurve::of(&Machine::per_unit_mass(), &[one, other]).unwrap();
    assert!(both.at_rest().uncertainty() < alone.at_rest().uncertainty());
    assert!((both.speeds()[14] / alone.speeds()[14] - 1.0).abs() < 0.01);
    require_within(&both.at_rest(), 0.3, 2.6);
}

/// The record of an independent simulator: Coulomb and viscous friction, μ = 0.16844 and c/m = 0.0996 1/s.
struct Control {
    interval: f64,
    velocities: Vec<f64>,
}

const MASS: f64 = 11.805_157_7;
const LOAD: f64 = 14.713_691_5;

impl Control {
    fn read() -> Self {
        let text = include_str!("../../../../tests/data/trials/control.csv");
        let rows = text.lines().skip(1).filter_map(|line| line.split_once(','));
        let (times, velocities): (Vec<f64>, Vec<f64>) =
            rows.map(|(t, v)| (t.parse::<f64>().unwrap(), v.parse::<f64>().unwrap())).unzip();
        Self { interval: (times[times.len() - 1] - times[0]) / (times.len() - 1) as f64, velocities }
    }

    fn curve(&self) -> FrictionCurve {
        let machine = Machine::of_mass(Known::exact(MASS).unwrap()).unwrap();
        let machine = machine.with_normal_load(Known::exact(LOAD).unwrap()).unwrap();
        FrictionCurve::of(&machine, &[ring_down(self.velocities.clone(), 1.0 / self.interval, "m/s")]).unwrap()
    }
}

/// Whole resistance in the mean over the path to 0.3 %.
#[test]
fn the_mean_over_the_path_is_that_of_an_independent_simulation() {
    let control = Control::read();
    let curve = control.curve();
    let squares: f64 = control.velocities.iter().map(|v| v * v).sum();
    let path: f64 = control.velocities.iter().map(|v| v.abs()).sum();
    let truth = 0.168_44 + 0.0996 * MASS / LOAD * squares / path;
    let mean = curve.mean_over_path();
    assert!((mean.value() / truth - 1.0).abs() < 0.003, "{mean} in place of {truth}");
    require_within(&mean, truth, 2.6);
    require_within(&curve.at_rest(), 0.168_44, 2.6);
}

/// In mm/s the record gives the same curve, per mass.
#[test]
fn other_units_give_the_same_curve() {
    let values = noisy(&velocity(0.3, 400.0), 5e-4, 6);
    let metres = curve(values.clone(), 400.0);
    let millimetres = values.iter().map(|v| 1e3 * v).collect();
    let millimetres = FrictionCurve::of(&Machine::per_unit_mass(), &[ring_down(millimetres, 400.0, "mm/s")]).unwrap();
    assert_eq!(millimetres.unit(), "mm/s²");
    for (own, other) in metres.levels().iter().zip(millimetres.levels()) {
        assert!((other.value() / 1e3 - own.value()).abs() < 0.01 * own.uncertainty(), "{own} and {other}");
        assert!((other.uncertainty() / 1e3 / own.uncertainty() - 1.0).abs() < 0.01);
    }
}

/// Ten times as many samples of the same motion and of noise with the same spectrum give the same curve: repeated
/// samples are correlated, and count once.
#[test]
fn another_rate_gives_the_same_curve() {
    /// Pairs of records: the uncertainty of one changes by a third with its noise.
    const PAIRS: u64 = 6;
    let mut ratios = [1.0; 15];
    for pair in 0..PAIRS {
        let slow = curve(noisy(&velocity(0.3, 200.0), 5e-4, 7 + pair), 200.0);
        // Noise of the same density in frequency: √10 times as large.
        let fast = curve(noisy(&velocity(0.3, 2000.0), 10f64.sqrt() * 5e-4, 107 + pair), 2000.0);
        for ((own, other), ratio) in slow.levels().iter().zip(fast.levels()).zip(&mut ratios) {
            let both = own.uncertainty().hypot(other.uncertainty());
            assert!((own.value() - other.value()).abs() < 3.0 * both, "{own} and {other}");
            *ratio *= (other.uncertainty() / own.uncertainty()).powf(1.0 / PAIRS as f64);
        }
    }
    assert!(ratios.iter().all(|ratio| (0.75..1.33).contains(ratio)), "{ratios:?}");
}

/// Different loads are refused: the resistance of the machine does not follow them.
#[test]
fn runs_under_other_loads_are_refused() {
    let values = noisy(&velocity(0.3, 400.0), 5e-4, 9);
    let one = ring_down(values, 400.0, "m/s");
    let other = one.clone().with_load_factor(2.0).unwrap();
    let error = FrictionCurve::of(&Machine::per_unit_mass(), &[one, other]).unwrap_err();
    assert!(error.to_string().contains("under one load"), "{error}");
}

/// Searches of three records of the machine of the thesis without damping, under a contact of the law `F`.
fn searched<F: LawFamily>(law: &[f64], seeds: [u64; 3]) -> [Comparison; 3] {
    let initial = (0.022, 0.0);
    let load = simulated::LOAD;
    let motion = Motion { damping: 0.0, law, load, initial, force: None, samples: 3000, interval: INTERVAL };
    let velocity = motion.of::<F>().velocity().values().to_vec();
    let of_seed = |seed| {
        let record = record(&velocity, 1e-3, seed, Quantity::Velocity, "m/s");
        search(&machine(), &[Experiment::ring_down(&record, &Preparation::default()).unwrap()]).unwrap()
    };
    seeds.map(of_seed)
}

/// A curve is not smooth where a law rises within its first levels: such a law is fitted all the same, and wins where it
/// is true.
#[test]
fn a_law_that_rises_within_the_first_levels_is_not_excluded() {
    for found in searched::<RegularisedStribeck>(&[0.3, 0.2, 0.01, 0.02], [0, 1, 2]) {
        assert_eq!(found.preferred().law(), RegularisedStribeck::NAME, "{found}");
    }
}

/// Friction that is no function of the speed asks for a bent spring beside a curve. The law that is true is left without
/// one.
#[test]
fn a_law_that_does_not_show_a_bent_spring_is_left_without() {
    for found in searched::<ExponentialPair>(&[0.2, 0.3, 10.0, 50.0], [0, 4, 11]) {
        let preferred = found.preferred();
        assert!(preferred.law().starts_with(ExponentialPair::NAME) && !preferred.law().contains("spring"), "{found}");
        for (level, truth) in [("sliding_mu", 0.2), ("static_mu", 0.3)] {
            let (low, high) = preferred.interval(level, 0.95).unwrap();
            assert!((low..=high).contains(&truth), "{level} of {found}");
        }
    }
}

/// A long record of many half cycles tells more of the friction than a rough simulation: its curve settles all the same.
#[test]
fn the_curve_of_a_long_record_settles() {
    let rate = 45_000.0;
    let law = CoulombViscous::new(0.0142, 0.0377).unwrap();
    let scenario = Scenario::new(Oscillator::per_unit_mass(3.0).unwrap(), law, 1.0).unwrap();
    let sampling = Sampling::uniform(1.0 / rate, 300_000).unwrap();
    let motion = Exact.run(&scenario.starting_at(0.02, 0.0).unwrap(), &sampling).unwrap();
    for seed in 0..3 {
        let curve = curve(noisy(motion.velocity().values(), 4e-5, seed), rate);
        assert!(curve.limits().is_empty(), "{curve}");
        let mean = curve.mean_over_path();
        assert!(mean.uncertainty() < 6e-6 * mean.value(), "{curve}");
        require_within(&curve.at_rest(), 0.0142, 2.6);
    }
}

/// Friction that rises with a power of the speed: a law that explains the record with a level of its own at low speeds
/// contradicts the curve, and the true one does not.
#[test]
fn a_law_that_contradicts_the_curve_is_a_doubt() {
    let law = PowerLaw::new(0.5, 0.3, 0.0).unwrap();
    let scenario = Scenario::new(Oscillator::per_unit_mass(2.0).unwrap(), law, 1.0).unwrap();
    let sampling = Sampling::uniform(5e-3, 1400).unwrap();
    let motion = RungeKutta::default().run(&scenario.starting_at(0.04, 0.0).unwrap(), &sampling).unwrap();
    let experiments = [ring_down(noisy(motion.velocity().values(), 5e-4, 3), 200.0, "m/s")];
    let machine = Machine::per_unit_mass();
    let doubts = |candidate: Candidate| {
        let found = Inquiry::of(&machine, &experiments).among(&[candidate]).unwrap();
        let curve = FrictionCurve::beside(found.preferred(), &experiments).unwrap();
        assert!(curve.limits().is_empty(), "{curve}");
        curve.doubts().collect::<Vec<_>>().join("; ")
    };
    let contradicted = doubts(Candidate::of::<MakkarDixon>());
    assert!(contradicted.contains("makkar_dixon has") && contradicted.contains("from the curve"), "{contradicted}");
    assert_eq!(doubts(Candidate::of::<PowerLaw>()), "");
}
