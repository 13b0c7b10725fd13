//! A clamp of 50 g is screwed to the platform of a machine: how far does that detune it?

use fmm_model::{Damping, Dual, ModelError, Oscillator, Scalar};

fn main() -> Result<(), ModelError> {
    // 10.391 kg on leaf springs of 1982 N/m, with 0.275 N s/m of damping; the mass is what we ask about.
    let mass = Dual::<1>::variable(10.391, 0);
    let machine = Oscillator::new(mass, Dual::from(1982.0))?.with_damping(Damping::linear(0.275)?);

    let frequency = machine.natural_frequency();
    let clamp = 0.050;
    println!("natural frequency {:.5} Hz, with the clamp {:+.5} Hz", frequency.value(), clamp * frequency.partial(0));
    println!("damping ratio {:.3e}", machine.damping_ratio().value());

    // f = √(k/m)/2π, so that ∂f/∂m = −f/(2 m).
    let expected = -frequency.value() / (2.0 * mass.value());
    assert!((frequency.partial(0) - expected).abs() < 1e-15, "{} Hz/kg", frequency.partial(0));

    // The real change differs by the second order, 3/8 f (Δm/m)² = 2e-5 Hz.
    let heavier = Oscillator::new(10.391 + clamp, 1982.0)?.natural_frequency();
    let change = heavier - frequency.value();
    assert!((change - clamp * frequency.partial(0)).abs() < 2e-5, "{change} Hz");
    Ok(())
}
