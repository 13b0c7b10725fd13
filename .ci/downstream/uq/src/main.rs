//! A coefficient of friction from the loss of amplitude per half swing: budget, interval, and a Monte Carlo beside it.

use std::error::Error;

use fmm_uq::{Input, Inputs, Linearisation, MonteCarlo, Scalar, propagate};

/// μ = k ΔA/(2 N).
fn coefficient<D: Scalar>(x: &[D]) -> D {
    x[0] * x[1] / (x[2] * 2.0)
}

fn main() -> Result<(), Box<dyn Error>> {
    let inputs = Inputs::new([
        Input::new("stiffness", 1982.0, 12.0, "N/m")?,
        Input::new("amplitude_loss", 1.77e-3, 2.0e-5, "m")?.with_degrees_of_freedom(5.0)?,
        Input::new("normal_load", 6.67, 0.05, "N")?,
    ])?;
    let budget = propagate(&inputs, coefficient)?.named("friction_coefficient", "1");
    let interval = budget.expanded(0.95)?;
    println!("{budget}\nμ = {:.4} ± {:.4} (95 %)", interval.estimate, interval.uncertainty);

    // Relative uncertainties add up in squares: 0.605 %, 1.130 % and 0.750 % make 1.485 %.
    let relative = budget.standard_uncertainty() / budget.estimate();
    assert!((relative - 0.014_85).abs() < 5e-6, "{relative}");
    assert_eq!((interval.degrees_of_freedom, budget.linearisation()), (14.0, Linearisation::Adequate));

    let run = MonteCarlo::new(&inputs, 20_000)?;
    let trials = run.run(coefficient)?;
    let width = trials.symmetric_interval(0, 0.95)?.width();
    // Student's t of 5 degrees of freedom has longer tails than the budget foresees: up to a tenth.
    assert!((1.0..1.15).contains(&(width / (2.0 * interval.uncertainty))), "{width}");

    #[cfg(feature = "serde")]
    {
        // Half of the trials on another machine, back as text: the same bits.
        let part = |index| run.run_blocks(run.shard(index, 2), coefficient);
        let text = serde_json::to_string(&part(1)?)?;
        let merged = part(0)?.merge(serde_json::from_str(&text)?)?;
        assert_eq!(run.finish(merged)?, trials);
    }
    Ok(())
}
