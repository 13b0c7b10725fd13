//! Any finite input ends in a finite motion or in an error that says why, never in a panic, a NaN or a hang.

use fmm_friction::CoulombStatic;
use fmm_model::{Damping, Dual, Oscillator, Scalar};
use fmm_sim::{Engine, Exact, Sampling, Scenario, SimulationError, Thesis, Trajectory};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::case::log_uniform;

/// Mass, stiffness, damping, sliding and static coefficient, load, position, velocity, interval.
type Inputs = [f64; 9];

/// Each input of either a human size or any size within 10^±`reach`; those that may be zero are sometimes.
fn draw(random: &mut ChaCha8Rng, reach: f64) -> Inputs {
    let mut inputs = [0.0; 9];
    for (index, input) in inputs.iter_mut().enumerate() {
        let reach = if random.random_bool(0.5) { reach } else { 3.0 };
        let magnitude = log_uniform(random, -reach, reach);
        let zero = (2..8).contains(&index) && random.random_bool(0.15);
        let negative = (6..8).contains(&index) && random.random_bool(0.5);
        *input = if zero {
            0.0
        } else if negative {
            -magnitude
        } else {
            magnitude
        };
    }
    if random.random_bool(0.3) {
        inputs[4] = inputs[3];
    }
    inputs[4] = inputs[3].max(inputs[4]);
    // A free interval makes most motions either stand still or reverse a million times; few cases need that.
    if random.random_bool(0.98) {
        let period = ((inputs[0].log10() - inputs[1].log10()) / 2.0).clamp(-290.0, 290.0);
        inputs[8] = 10f64.powf(period + random.random_range(-4.0..2.0));
    }
    inputs
}

fn scenario<D: Scalar>(inputs: &Inputs) -> Scenario<D, CoulombStatic<D>> {
    let input = |index: usize| D::variable(inputs[index], index);
    let machine = Oscillator::new(input(0), input(1)).unwrap().with_damping(Damping::linear(input(2)).unwrap());
    let law = CoulombStatic::new(input(3), input(4)).unwrap();
    Scenario::new(machine, law, input(5)).and_then(|scenario| scenario.starting_at(input(6), input(7))).unwrap()
}

/// Nothing in the motion is infinite or not a number; a margin is infinite only where nothing can hold.
fn is_finite<D: Scalar>(motion: &Trajectory<D>) -> bool {
    let finite = |number: D| {
        number.value().is_finite() && (0..D::DIRECTIONS).all(|direction| number.partial(direction).is_finite())
    };
    let samples = [motion.position(), motion.velocity()].into_iter().all(|samples| {
        samples.values().iter().all(|value| value.is_finite())
            && (0..D::DIRECTIONS).all(|direction| samples.partial(direction).unwrap().iter().all(|d| d.is_finite()))
    });
    samples
        && motion.events().iter().all(|event| {
            finite(event.time)
                && finite(event.position)
                && finite(event.velocity)
                && event.load.is_finite()
                && event.static_level.is_finite()
                && !event.margin().is_nan()
        })
}

/// Runs `count` cases within 10^±`reach` and returns the shares that gave a motion and that were refused.
fn survive<D: Scalar>(engine: &impl Engine<D, CoulombStatic<D>>, seed: u64, count: usize, reach: f64) -> (f64, f64) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut motion = Trajectory::new();
    let mut refused = 0;
    for _ in 0..count {
        let inputs = draw(&mut random, reach);
        let samples = random.random_range(1..8);
        let window = random.random_range(0..3)..samples + 4;
        let sampling = Sampling::uniform(inputs[8], samples + 4).unwrap().window(window).unwrap();
        let case = || format!("[m, k, c, μ, μ_s, N, x₀, v₀, Δt] = {inputs:?} in SI units, {sampling:?}");
        match engine.run_into(&scenario::<D>(&inputs), &sampling, &mut motion) {
            Ok(()) => {
                let (last, end) = (motion.events().last().unwrap().time.value(), sampling.end());
                assert!(last <= end, "event at {last:e} s after the last sample at {end:e} s: {}", case());
                assert!(is_finite(&motion), "{motion:?}: {}", case());
            }
            Err(
                SimulationError::NotFinite { .. }
                | SimulationError::Exhausted { .. }
                | SimulationError::NoClosedForm { .. },
            ) => refused += 1,
            Err(error) => panic!("{error}: {}", case()),
        }
    }
    let refused = f64::from(refused) / count as f64;
    (1.0 - refused, refused)
}

#[test]
fn exact_motion_is_finite_or_refused() {
    let (moved, refused) = survive::<f64>(&Exact, 81, 30_000, 300.0);
    assert!(moved > 0.3 && refused > 0.05, "{moved} moved, {refused} refused");
}

#[test]
fn thesis_motion_is_finite_or_refused() {
    let (moved, refused) = survive::<f64>(&Thesis::A3, 82, 10_000, 300.0);
    assert!(moved > 0.3 && refused > 0.05, "{moved} moved, {refused} refused");
}

/// Derivatives have larger and smaller sizes than values, by the product of two inputs or so: a narrower range, within
/// which nothing may be refused that plain numbers can do.
#[test]
fn exact_derivatives_are_finite() {
    let (moved, _) = survive::<Dual<8>>(&Exact, 83, 5000, 12.0);
    assert!(moved > 0.9, "{moved} moved");
}
