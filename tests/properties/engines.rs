//! Driven stick-slip: both engines for sliding laws find the same motion, the same derivatives and no event too few.

use fmm_friction::{AccelerationCoulomb, CoulombStatic};
use fmm_model::{Damping, Dual, Oscillator, Scalar};
use fmm_sim::{Engine, EventKind, Exact, Excitation, RungeKutta, Sampling, Scenario, Trajectory};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Inputs of a driven machine: m, k, c, μ_d, μ_s, x₀, v₀, a wave (amplitude, Ω, φ), a blow (peak, duration), a ramp and
/// a belt.
const INPUTS: usize = 14;
const NAMES: [&str; INPUTS] =
    ["m", "k", "c", "mu_d", "mu_s", "x0", "v0", "amplitude", "angular", "phase", "peak", "duration", "rate", "belt"];

type Inputs = [f64; INPUTS];

/// A machine near 1 kg and 1 N/m with friction of a tenth to one newton, driven below, near and above its resonance.
fn draw(random: &mut ChaCha8Rng) -> Inputs {
    let mut between = |low: f64, high: f64| random.random_range(low..high);
    let sliding = between(0.1, 0.6);
    [
        between(0.5, 2.0),
        between(0.5, 2.0),
        between(0.0, 0.4),
        sliding,
        sliding * between(1.0, 1.8),
        between(-2.0, 2.0),
        between(-1.0, 1.0),
        between(0.2, 1.5),
        between(0.2, 3.0),
        between(-3.0, 3.0),
        between(-3.0, 3.0),
        between(0.2, 1.5),
        between(-0.1, 0.1),
        between(-0.3, 0.3),
    ]
}

fn scenario<D: Scalar>(inputs: &Inputs) -> Scenario<D, CoulombStatic<D>> {
    let input = |index: usize| D::variable(inputs[index], index);
    let machine = Oscillator::new(input(0), input(1)).unwrap().with_damping(Damping::linear(input(2)).unwrap());
    let law = CoulombStatic::new(input(3), input(4)).unwrap();
    Scenario::new(machine, law, D::from(1.0))
        .and_then(|scenario| scenario.starting_at(input(5), input(6)))
        .unwrap()
        .driven_by(Excitation::harmonic(input(7), input(8), input(9)).unwrap())
        .driven_by(Excitation::half_sine(input(10), input(11)).unwrap())
        .driven_by(Excitation::ramp(input(12)).unwrap())
        .driven_by(Excitation::belt(input(13)).unwrap())
}

fn sampling() -> Sampling {
    Sampling::uniform(0.05, 401).unwrap()
}

/// True if a decision was so narrow that rounding may turn it.
fn is_narrow(motion: &Trajectory) -> bool {
    let decides = |kind| matches!(kind, EventKind::Reversal | EventKind::Stop);
    motion.events().iter().any(|event| decides(event.kind) && event.margin().abs() < 1e-6)
}

/// The greatest difference of two motions, relative to 1 m and 1 m/s.
fn difference(a: &Trajectory, b: &Trajectory) -> f64 {
    let of = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    of(a.position().values(), b.position().values()).max(of(a.velocity().values(), b.velocity().values()))
}

#[test]
fn both_engines_find_the_same_motion() {
    let mut random = ChaCha8Rng::seed_from_u64(311);
    let (mut events, mut narrow, mut stops) = (0, 0, 0);
    for _ in 0..1000 {
        let inputs = draw(&mut random);
        let scenario = scenario::<f64>(&inputs);
        let Ok(exact) = Exact.run(&scenario, &sampling()) else { continue };
        let stepped = RungeKutta::default().run(&scenario, &sampling()).unwrap();
        if is_narrow(&exact) {
            narrow += 1;
            continue;
        }
        let kinds =
            |motion: &Trajectory| motion.events().iter().map(|event| (event.kind, event.next)).collect::<Vec<_>>();
        assert_eq!(kinds(&exact), kinds(&stepped), "{inputs:?}");
        // A slow approach to zero velocity magnifies the 1e-13 of the stepped motion in its times.
        for (a, b) in exact.events().iter().zip(stepped.events()) {
            assert!((a.time - b.time).abs() < 1e-7, "{inputs:?}: {} against {} s", a.time, b.time);
        }
        assert!(difference(&exact, &stepped) < 1e-9, "{inputs:?}: {:e}", difference(&exact, &stepped));
        events += exact.events().len();
        stops += exact.events().iter().filter(|event| event.kind == EventKind::Stop).count();
    }
    assert!(events > 6000 && stops > 1000 && narrow < 20, "{events} events, {stops} stops, {narrow} narrow");
}

/// Derivatives in all fourteen inputs, event times included, against central differences of the same engine: where the
/// events are the same on both sides, h² of the third derivative and 1e-13/h of rounding leave 1e-5 of the largest.
fn derivatives_agree<E>(engine: &E, seed: u64, count: usize)
where
    E: Engine<f64, CoulombStatic<f64>> + Engine<Dual<INPUTS>, CoulombStatic<Dual<INPUTS>>>,
{
    const STEP: f64 = 1e-5;
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (mut compared, mut breakaways) = (0, 0);
    for _ in 0..count {
        let inputs = draw(&mut random);
        let Ok(plain) = engine.run(&scenario::<f64>(&inputs), &sampling()) else { continue };
        let dual = engine.run(&scenario::<Dual<INPUTS>>(&inputs), &sampling()).unwrap();
        assert_eq!(dual.position().values(), plain.position().values(), "{inputs:?}: values of dual numbers");
        assert_eq!(dual.velocity().values(), plain.velocity().values(), "{inputs:?}: values of dual numbers");
        for direction in 0..INPUTS {
            let side = |sign: f64| {
                let mut moved = inputs;
                moved[direction] += sign * STEP;
                engine.run(&scenario::<f64>(&moved), &sampling()).ok()
            };
            let (Some(above), Some(below)) = (side(1.0), side(-1.0)) else { continue };
            let kinds = |motion: &Trajectory| motion.events().iter().map(|event| event.next).collect::<Vec<_>>();
            if kinds(&above) != kinds(&plain) || kinds(&below) != kinds(&plain) {
                continue;
            }
            let slopes = |of: fn(&Trajectory) -> Vec<f64>| -> Vec<f64> {
                of(&above).iter().zip(of(&below)).map(|(a, b)| (a - b) / (2.0 * STEP)).collect()
            };
            let positions = slopes(|motion| motion.position().values().to_vec());
            let times = slopes(|motion| motion.events().iter().map(|event| event.time).collect());
            let scale = positions.iter().chain(&times).fold(1.0f64, |scale, slope| scale.max(slope.abs()));
            if scale > 20.0 {
                // Near a tangency differences are not of second order any more.
                continue;
            }
            let of_time: Vec<f64> = dual.events().iter().map(|event| event.time.partial(direction)).collect();
            let got = dual.position().partial(direction).unwrap().iter().chain(&of_time);
            for (got, slope) in got.zip(positions.iter().chain(&times)) {
                let off = (got - slope).abs() / scale;
                assert!(off < 1e-5, "{inputs:?}: d/d{} is {got}, the difference {slope}", NAMES[direction]);
            }
            compared += 1;
        }
        breakaways += plain.events().iter().filter(|event| event.kind == EventKind::Breakaway).count();
    }
    assert!(compared > 10 * count && breakaways > count / 2, "{compared} directions, {breakaways} breakaways");
}

#[test]
fn the_exact_engine_has_the_derivatives_of_its_differences() {
    derivatives_agree(&Exact, 312, 150);
}

#[test]
fn the_stepping_engine_has_the_derivatives_of_its_differences() {
    derivatives_agree(&RungeKutta::default(), 313, 60);
}

/// Mirrored inputs give the mirrored motion, to the last bit.
#[test]
fn mirrored_forces_give_the_mirrored_motion() {
    let mut random = ChaCha8Rng::seed_from_u64(314);
    for _ in 0..200 {
        let inputs = draw(&mut random);
        let mut mirrored = inputs;
        for index in [5, 6, 7, 10, 12, 13] {
            mirrored[index] = -inputs[index];
        }
        let pair = |engine: &dyn Fn(&Scenario<f64, CoulombStatic>) -> Option<Trajectory>| {
            Some((engine(&scenario(&inputs))?, engine(&scenario(&mirrored))?))
        };
        let exact = pair(&|scenario| Exact.run(scenario, &sampling()).ok());
        let stepped = pair(&|scenario| RungeKutta::default().run(scenario, &sampling()).ok());
        for (motion, image) in exact.into_iter().chain(stepped) {
            let negated: Vec<f64> = image.position().values().iter().map(|x| -x).collect();
            assert_eq!(motion.position().values(), negated, "{}: {inputs:?}", motion.engine());
            let times = |motion: &Trajectory| motion.events().iter().map(|event| event.time).collect::<Vec<_>>();
            assert_eq!(times(&motion), times(&image), "{}: {inputs:?}", motion.engine());
        }
    }
}

/// Sampling four times as finely leaves what was sampled before as it was, within 1e-13 of metres and metres per
/// second.
#[test]
fn more_samples_change_nothing() {
    let mut random = ChaCha8Rng::seed_from_u64(315);
    let fine = Sampling::uniform(0.0125, 1601).unwrap();
    for _ in 0..200 {
        let inputs = draw(&mut random);
        let scenario = scenario::<f64>(&inputs);
        let pair = |engine: &dyn Fn(&Sampling) -> Option<Trajectory>| Some((engine(&sampling())?, engine(&fine)?));
        let exact = pair(&|sampling| Exact.run(&scenario, sampling).ok());
        let stepped = pair(&|sampling| RungeKutta::default().run(&scenario, sampling).ok());
        for (coarse, fine) in exact.into_iter().chain(stepped) {
            for (index, x) in coarse.position().values().iter().enumerate() {
                let off = (fine.position().values()[4 * index] - x).abs();
                assert!(off < 1e-13 * (1.0 + x.abs()), "{}: {off:e} m: {inputs:?}", coarse.engine());
            }
            assert_eq!(coarse.events().len(), fine.events().len());
        }
    }
}

/// A peak of the load 1e-9 N above the static level breaks the contact away, one 1e-9 N below does not, however short
/// it is and wherever the samples lie.
#[test]
fn no_peak_of_the_load_is_missed() {
    let machine = Oscillator::new(10.391, 1982.0).unwrap().with_damping(Damping::linear(0.275).unwrap());
    let level = 2.5;
    let sampling = Sampling::uniform(1.7, 4).unwrap();
    for (excess, events) in [(1e-9, true), (-1e-9, false)] {
        let peak = level + excess;
        let forces = [
            Excitation::harmonic(peak, 3.0, 1.0).unwrap(),
            Excitation::harmonic(peak, 3000.0, 1.0).unwrap(),
            Excitation::half_sine(-peak, 1e-6).unwrap().delayed(0.3).unwrap(),
            Excitation::sampled_force(1e-7, vec![0.0, peak, 0.0]).unwrap().delayed(0.9).unwrap(),
        ];
        for force in forces {
            let scenario = Scenario::new(machine, CoulombStatic::new(1.75, level).unwrap(), 1.0).unwrap();
            let scenario = scenario.driven_by(force.clone());
            for motion in [Exact.run(&scenario, &sampling), RungeKutta::default().run(&scenario, &sampling)] {
                let motion = motion.unwrap();
                let found = motion.events().iter().any(|event| event.kind == EventKind::Breakaway);
                assert_eq!(found, events, "{}: {excess} N beyond the level under {force:?}", motion.engine());
            }
        }
    }
}

/// Two levels in either order: the engines agree through gaining, steady and losing speed.
#[test]
fn both_engines_agree_on_two_levels() {
    let mut random = ChaCha8Rng::seed_from_u64(316);
    let (mut compared, mut changes) = (0, 0);
    for _ in 0..300 {
        let inputs = draw(&mut random);
        let machine = Oscillator::new(inputs[0], inputs[1]).unwrap();
        let machine = machine.with_damping(Damping::linear(inputs[2]).unwrap());
        let law = AccelerationCoulomb::new(inputs[3], inputs[3] * random.random_range(0.5..1.5)).unwrap();
        let scenario =
            Scenario::new(machine, law, 1.0).and_then(|case| case.starting_at(inputs[5], inputs[6])).unwrap();
        let scenario = scenario.driven_by(Excitation::harmonic(inputs[7], inputs[8], inputs[9]).unwrap());
        let (Ok(exact), Ok(stepped)) =
            (Exact.run(&scenario, &sampling()), RungeKutta::default().run(&scenario, &sampling()))
        else {
            continue;
        };
        if is_narrow(&exact) {
            continue;
        }
        let kinds =
            |motion: &Trajectory| motion.events().iter().map(|event| (event.kind, event.next)).collect::<Vec<_>>();
        assert_eq!(kinds(&exact), kinds(&stepped), "{inputs:?} {law:?}");
        assert!(difference(&exact, &stepped) < 1e-8, "{inputs:?} {law:?}: {:e}", difference(&exact, &stepped));
        changes += exact.events().iter().filter(|event| event.kind == EventKind::BranchChange).count();
        compared += 1;
    }
    assert!(compared > 150 && changes > 1000, "{compared} motions, {changes} changes");
}
