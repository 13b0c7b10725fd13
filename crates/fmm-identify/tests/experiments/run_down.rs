//! Motion without a spring: coast-downs and spin-downs against their closed forms.

use fmm_friction::{Coulomb, CoulombViscous};
use fmm_identify::{
    Candidate, Comparison, Experiment, FrictionCurve, Identification, IdentifyError, Inquiry, Known, Machine,
    Preparation, Warning, identify, search,
};
use fmm_record::{Quantity, Record};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};

/// Deceleration a + c v + q v² of a run, of a in m/s², c in 1/s and q in 1/m.
#[derive(Clone, Copy)]
struct Losses {
    a: f64,
    c: f64,
    q: f64,
}

impl Losses {
    /// Speed (m/s) and path (m) of a run from `v0` (m/s) after `t` (s) in closed form, until it rests.
    ///
    /// ```text
    /// v = (√Δ tan(φ − √Δ t/2) − c)/2q,   tan φ = (2 q v₀ + c)/√Δ,   Δ = 4 a q − c² > 0
    /// v = (√−Δ tanh(φ + √−Δ t/2) …,      or a straight line in eᶜᵗ for q = 0
    /// ```
    fn motion(self, v0: f64, t: f64) -> (f64, f64) {
        let Self { a, c, q } = self;
        if q == 0.0 {
            let rest = if c > 0.0 { (1.0 + c * v0 / a).ln() / c } else { v0 / a };
            let t = t.min(rest);
            return if c > 0.0 {
                let fallen = -(-c * t).exp_m1();
                (v0 - (v0 + a / c) * fallen, (v0 + a / c) * fallen / c - a / c * t)
            } else {
                (v0 - a * t, v0 * t - 0.5 * a * t * t)
            };
        }
        let delta = 4.0 * a * q - c * c;
        if delta > 0.0 {
            let root = delta.sqrt();
            let angle = |v: f64| ((2.0 * q * v + c) / root).atan();
            let t = t.min(2.0 / root * (angle(v0) - angle(0.0)));
            let phase = angle(v0) - 0.5 * root * t;
            let path = ((phase.cos() / angle(v0).cos()).ln() - 0.5 * c * t) / q;
            return ((root * phase.tan() - c) / (2.0 * q), path);
        }
        // Two real roots of a + c v + q v²: logarithms.
        let root = (-delta).sqrt();
        let (high, low) = ((-c + root) / (2.0 * q), (-c - root) / (2.0 * q));
        let share = |v: f64| (v - high) / (v - low);
        let t = t.min((share(v0) / share(0.0)).ln() / root);
        let now = share(v0) * (-root * t).exp();
        let v = (high - low * now) / (1.0 - now);
        (v, high * t + ((1.0 - now) / (1.0 - share(v0))).ln() / q)
    }
}

const CASES: [Losses; 4] = [
    Losses { a: 0.1, c: 0.0, q: 0.0 },
    Losses { a: 0.1, c: 0.004, q: 0.0 },
    Losses { a: 0.1, c: 0.002, q: 4e-4 },
    Losses { a: 0.02, c: 0.02, q: 4e-4 },
];

fn noisy(values: impl Iterator<Item = f64>, sigma: f64, seed: u64) -> Vec<f64> {
    let (mut random, normal) = (ChaCha8Rng::seed_from_u64(seed), Normal::new(0.0, sigma).unwrap());
    values.map(|value| value + normal.sample(&mut random)).collect()
}

/// A run from `v0` (m/s) at `rate` (Hz) for `duration` (s), with noise of standard deviation `sigma`.
fn run(losses: Losses, v0: f64, quantity: Quantity, sigma: f64, seed: u64) -> Record {
    let (rate, count) = (10.0, 3000);
    let at = |i: usize| {
        let (v, x) = losses.motion(v0.abs(), i as f64 / rate);
        v0.signum() * if quantity == Quantity::Velocity { v } else { x }
    };
    let values = noisy((0..count).map(at), sigma, seed);
    Record::sampled(rate, values, quantity, if quantity == Quantity::Velocity { "m/s" } else { "m" }).unwrap()
}

fn experiment(record: &Record) -> Experiment {
    Experiment::run_down(record, &Preparation::default()).unwrap()
}

/// Without noise the losses come back to many digits, from speeds and from positions, in both directions.
#[test]
fn losses_are_those_of_the_closed_form() {
    let law = Candidate::named("coulomb_viscous + quadratic").unwrap();
    for losses in CASES {
        for (v0, quantity) in [(30.0, Quantity::Velocity), (-30.0, Quantity::Velocity), (30.0, Quantity::Displacement)]
        {
            let run = experiment(&run(losses, v0, quantity, 0.0, 1));
            let found = Inquiry::of(&Machine::per_unit_mass(), &[run]).candidate(&law).unwrap();
            let value = |name: &str| found.finding(name).unwrap().value();
            let off = [
                value("friction_per_mass") / losses.a - 1.0,
                (value("damping_per_mass") - losses.c) * 30.0 / losses.a,
                (value("quadratic_damping_per_mass") - losses.q) * 900.0 / losses.a,
            ];
            assert!(off.iter().all(|off| off.abs() < 1e-6), "{off:?} from {v0} by {quantity}: {found}");
        }
    }
}

fn value(found: &Identification, name: &str) -> f64 {
    found.finding(name).unwrap_or_else(|| panic!("no {name}: {found}")).value()
}

/// The number of standard uncertainties that a finding is off.
fn off(found: &Identification, name: &str, truth: f64) -> f64 {
    let finding = found.finding(name).unwrap_or_else(|| panic!("no {name}: {found}"));
    (finding.value() - truth) / finding.uncertainty().unwrap_or(f64::MIN_POSITIVE)
}

/// The search finds the losses that there are, and nothing beside them.
#[test]
fn losses_are_found_without_a_law() {
    for (losses, law, seed) in [
        (CASES[0], "coulomb", 1),
        (CASES[1], "coulomb_viscous", 2),
        (CASES[2], "coulomb_viscous + quadratic", 3),
        (Losses { a: 0.1, c: 0.0, q: 4e-4 }, "coulomb + quadratic", 4),
    ] {
        let found =
            search(&Machine::per_unit_mass(), &[experiment(&run(losses, 30.0, Quantity::Velocity, 0.02, seed))]);
        let found: Comparison = found.unwrap();
        let best = found.preferred();
        assert_eq!(best.law(), law, "{found}");
        assert!(off(best, "friction_per_mass", losses.a).abs() < 3.0, "{best}");
    }
}

/// The curve of friction over the speed holds the sum of all losses.
#[test]
fn the_curve_holds_the_losses() {
    let losses = CASES[2];
    let runs = [experiment(&run(losses, 30.0, Quantity::Velocity, 0.02, 5))];
    let curve = FrictionCurve::of(&Machine::per_unit_mass(), &runs).unwrap();
    for (speed, level) in curve.speeds().iter().zip(curve.levels()).filter(|(speed, _)| (3.0..27.0).contains(*speed)) {
        let truth = losses.a + losses.c * speed + losses.q * speed * speed;
        let (low, high) = level.interval(0.999).unwrap();
        assert!(low <= truth && truth <= high, "{truth} at {speed} m/s: [{low}, {high}]");
    }
}

/// Speed of a vehicle (m/s) with these losses on a `slope` (m/s²) in `wind` (m/s), by small steps.
fn on_a_road(losses: Losses, slope: f64, wind: f64, v0: f64) -> impl Fn(usize) -> f64 {
    let rate = move |v: f64| {
        let drag = losses.q * ((v - wind).abs() * (v - wind));
        slope - losses.a * v.signum() - losses.c * v - drag
    };
    let h = 1e-2;
    let mut speeds = vec![v0];
    let mut v = v0;
    for step in 1..=10_000 {
        let k1 = rate(v);
        let k2 = rate(v + 0.5 * h * k1);
        let k3 = rate(v + 0.5 * h * k2);
        let k4 = rate(v + h * k3);
        v += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        if step % 20 == 0 {
            speeds.push(v);
        }
    }
    move |i| speeds[i]
}

/// Slope and wind are the difference of the directions, as no run alone shows them.
#[test]
fn slope_and_wind_are_told_by_both_directions() {
    let losses = Losses { a: 0.12, c: 0.0, q: 4e-4 };
    let (slope, wind) = (0.03, 3.0);
    let runs: Vec<Experiment> = [(30.0, 1), (-30.0, 2), (25.0, 3), (-25.0, 4)]
        .into_iter()
        .map(|(v0, seed)| {
            let at = on_a_road(losses, slope, wind, v0);
            let values = noisy((0..450).map(at), 0.02, seed);
            experiment(&Record::sampled(5.0, values, Quantity::Velocity, "m/s").unwrap())
        })
        .collect();
    let machine = Machine::of_mass(Known::new(1200.0, 6.0).unwrap()).unwrap();
    let law = Candidate::named("coulomb + quadratic").unwrap();
    let found = Inquiry::of(&machine, &runs).candidate(&law).unwrap();
    // What wind does to the machine at rest is a part of the slope.
    let slope_with_wind = slope + losses.q * wind * wind;
    for (name, truth) in [
        ("friction_per_mass", losses.a),
        ("quadratic_damping_per_mass", losses.q),
        ("slope_per_mass", slope_with_wind),
        ("wind", wind),
    ] {
        assert!(off(&found, name, truth).abs() < 3.0, "{name}, {truth}: {found}");
    }
    assert!((value(&found, "slope_force") / 1200.0 / slope_with_wind - 1.0).abs() < 0.1, "{found}");
    assert!(!found.warnings().contains(&Warning::OneDirection), "{found}");
    // One direction alone calls it friction, and says so.
    let alone = Inquiry::of(&machine, &runs[..1]).candidate(&law).unwrap();
    assert!(alone.warnings().contains(&Warning::OneDirection), "{alone}");
    assert!(alone.finding("wind").is_none() && off(&alone, "friction_per_mass", losses.a).abs() > 10.0, "{alone}");
}

/// Of a record with a drive that holds the speed, and one that drives it again, the run between them is used, whichever
/// drive is the faster.
#[test]
fn the_run_is_found_between_drives() {
    let losses = CASES[1];
    for gain in [2.0, 4.0] {
        let at = |i: usize| match 0.1 * i as f64 {
            t if t < 20.0 => 30.0 * (t / 10.0).min(1.0),
            t if t < 150.0 => losses.motion(30.0, t - 20.0).0,
            t => losses.motion(30.0, 130.0).0 + gain * (t - 150.0),
        };
        let record = Record::sampled(10.0, noisy((0..1600).map(at), 0.02, 6), Quantity::Velocity, "m/s").unwrap();
        let run = experiment(&record);
        let summary = run.summary();
        assert!(summary.release.is_some_and(|time| (19.5..23.0).contains(&time)), "{summary}");
        assert!((147.0..150.5).contains(&summary.to) && summary.further_releases.len() == 1, "{summary}");
        let found = identify::<CoulombViscous>(&Machine::per_unit_mass(), &[run]).unwrap();
        assert!(off(&found, "friction_per_mass", losses.a).abs() < 3.0, "{found}");
    }
}

/// A rotor at rest shows the zero of its tachometer; its losses are torques.
#[test]
fn a_rotor_ends_at_rest() {
    let losses = Losses { a: 2.5, c: 0.02, q: 0.0 };
    let zero = 0.7;
    let values = noisy((0..1500).map(|i| losses.motion(300.0, 0.1 * f64::from(i)).0 + zero), 0.2, 7);
    let record = Record::sampled(10.0, values, Quantity::Velocity, "rad/s").unwrap();
    let run = experiment(&record);
    assert!(run.summary().rest_from.is_some() && run.summary().held_offset.is_none(), "{}", run.summary());
    let machine = Machine::of_mass(Known::new(0.02, 1e-4).unwrap()).unwrap();
    let found = identify::<CoulombViscous>(&machine, &[run]).unwrap();
    assert!(off(&found, "offset", zero).abs() < 3.0, "{found}");
    let torque = found.finding("friction_force").unwrap();
    assert_eq!(torque.parameter().unit(), "N m");
    assert_eq!(found.finding("damping").unwrap().parameter().unit(), "N m s/rad");
    assert!((torque.value() - 0.05).abs() < 3.0 * torque.uncertainty().unwrap(), "{found}");
    // 0.5 % of the inertia, and little beside it.
    assert!((torque.uncertainty().unwrap() / 0.05 / 5e-3 - 1.0).abs() < 0.2, "{found}");
}

/// A coarse encoder at rest shows the same step again and again, which is no friction beside that of the motion.
#[test]
fn an_encoder_at_rest_tells_nothing_more() {
    let losses = Losses { a: 2.5, c: 0.01, q: 0.0 };
    let step = std::f64::consts::TAU / 3600.0;
    for phase in [0.2, 0.45, 0.7] {
        let angle = |i: u32| ((losses.motion(20.0, f64::from(i) / 200.0).1 / step) + phase).round() * step;
        let record = Record::sampled(200.0, (0..2000).map(angle).collect(), Quantity::Displacement, "rad").unwrap();
        let run = experiment(&record);
        assert!(run.summary().to < 7.7 && run.summary().noise > 0.1 * step, "{}", run.summary());
        let found = search(&Machine::per_unit_mass(), &[run]).unwrap();
        let best = found.preferred();
        assert_eq!(best.law(), "coulomb_viscous", "{found}");
        assert!(off(best, "friction_per_mass", losses.a).abs() < 3.0, "{best}");
    }
}

/// A speed that stays above zero, such as one that a drive takes over, is no rest that shows the zero of the sensor.
#[test]
fn a_speed_that_stays_is_no_rest() {
    let at = |i: usize| (30.0 - 0.1 * i as f64).max(10.0);
    let record = Record::sampled(10.0, noisy((0..400).map(at), 0.02, 9), Quantity::Velocity, "m/s").unwrap();
    let run = experiment(&record);
    let summary = run.summary();
    assert!(summary.rest_from.is_none() && summary.held_offset == Some(0.0), "{summary}");
}

/// Samples at any times are fitted at them.
#[test]
fn unequal_times_are_used() {
    let losses = CASES[1];
    let times: Vec<f64> = (0..400).map(|i| 0.5 * f64::from(i) + 0.2 * (f64::from(i) * 7.3).sin()).collect();
    let values = noisy(times.iter().map(|t| losses.motion(30.0, *t).0), 0.02, 8);
    let record = Record::at_times(&times, values, Quantity::Velocity, "m/s").unwrap();
    let found = identify::<CoulombViscous>(&Machine::per_unit_mass(), &[experiment(&record)]).unwrap();
    assert!(off(&found, "friction_per_mass", losses.a).abs() < 3.0, "{found}");
    assert!(off(&found, "damping_per_mass", losses.c).abs() < 3.0, "{found}");
}

/// Nineteen intervals of twenty hold the truth.
#[test]
fn intervals_hold_as_often_as_they_say() {
    let losses = CASES[1];
    let inside = |seed: u64| {
        let run = experiment(&run(losses, 30.0, Quantity::Velocity, 0.05, seed));
        let found = identify::<CoulombViscous>(&Machine::per_unit_mass(), &[run]).unwrap();
        let (low, high) = found.interval("friction_per_mass", 0.95).unwrap();
        low <= losses.a && losses.a <= high
    };
    let share = (0..200).filter(|seed| inside(9000 + seed)).count();
    assert!((181..=198).contains(&share), "{share} of 200");
}

/// An angle that begins anew after each turn is refused with what to do; one that goes on by large steps is not.
#[test]
fn an_angle_that_begins_anew_is_named() {
    let of = |of_angle: &dyn Fn(f64) -> f64, rate: f64| {
        let angle = |i: u32| of_angle(CASES[0].motion(20.0, f64::from(i) / rate).1);
        let record =
            Record::sampled(rate, noisy((0..1500).map(angle), 1e-3, 3), Quantity::Displacement, "rad").unwrap();
        Experiment::run_down(&record, &Preparation::default())
    };
    for sign in [1.0, -1.0] {
        let error = of(&|angle| (sign * angle).rem_euclid(std::f64::consts::TAU), 40.0).unwrap_err().to_string();
        assert!(error.contains("begins anew"), "{error}");
        for rate in [40.0, 5.0, 3.0] {
            assert!(of(&|angle| sign * angle, rate).is_ok(), "{rate}");
        }
    }
}

#[test]
fn what_is_no_run_down_is_refused() {
    let record = |at: &dyn Fn(f64) -> f64, quantity, unit: &str| {
        let values = noisy((0..500).map(|i| at(0.1 * f64::from(i))), 1e-3, 1);
        Record::sampled(10.0, values, quantity, unit).unwrap()
    };
    let of = |record: &Record| Experiment::run_down(record, &Preparation::default());
    let rising = record(&|t| 1.0 + t, Quantity::Velocity, "m/s");
    assert!(matches!(of(&rising), Err(IdentifyError::NotSeen { .. })), "{:?}", of(&rising));
    let acceleration = record(&|t| 1.0 - t, Quantity::Acceleration, "m/s²");
    assert!(matches!(of(&acceleration), Err(IdentifyError::WrongRecord { .. })));
    let falling = of(&record(&|t| 60.0 - t, Quantity::Velocity, "m/s")).unwrap();
    let stiff = Machine::of_stiffness(Known::exact(1.0).unwrap()).unwrap();
    let error = identify::<Coulomb>(&stiff, std::slice::from_ref(&falling)).unwrap_err().to_string();
    assert!(error.contains("no spring"), "{error}");
    let swing = record(&|t| (-0.05 * t).exp() * (2.0 * t).cos(), Quantity::Velocity, "m/s");
    let swing = Experiment::ring_down(&swing, &Preparation::default()).unwrap();
    let error = identify::<Coulomb>(&Machine::per_unit_mass(), &[falling, swing]).unwrap_err().to_string();
    assert!(error.contains("fit them apart"), "{error}");
}
