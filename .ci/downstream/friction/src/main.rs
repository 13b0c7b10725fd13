//! A contact whose friction falls with speed feeds an oscillation; above which speed does it damp instead?

use fmm_friction::{LawError, LawFamily, SlidingLaw, Stribeck};
use fmm_model::{Dual, Scalar};

fn main() -> Result<(), LawError> {
    for parameter in Stribeck::PARAMETERS {
        println!("{}", parameter.parameter());
    }
    // μ_c, μ_s, v_s, δ and β as constants; only the speed carries a derivative.
    let law = Stribeck::at(&[0.10, 0.16, 0.02, 1.0, 0.5].map(Dual::<1>::from))?;
    let slope = |speed: f64| law.coefficient(Dual::variable(speed, 0)).partial(0);

    // The slope has one zero; halve the interval that holds it.
    let (mut falls, mut rises) = (0.0, 1.0);
    while rises - falls > 1e-9 {
        let middle = 0.5 * (falls + rises);
        if slope(middle) < 0.0 { falls = middle } else { rises = middle }
    }
    let lowest = law.coefficient(Dual::from(rises)).value();
    println!(
        "damps from {rises:.4} m/s on, where the coefficient is {lowest:.4}; it takes {} to leave rest",
        law.breakaway().value()
    );

    // β = (μ_s − μ_c)/v_s exp(−v/v_s) at the zero.
    let expected = 0.02 * f64::ln(0.06 / 0.02 / 0.5);
    assert!((rises - expected).abs() < 1e-8, "{rises} m/s, not {expected} m/s");
    Ok(())
}
