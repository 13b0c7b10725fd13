//! A nonlinear reference data set of NIST, against quadrature.

use fmm_fit::posterior::Sampler;
use fmm_fit::{Bounds, Parameter, Scalar, curve};

use crate::problems::{assert_moments, fitted, moments_by_quadrature};

/// BoxBOD: six points, two parameters and a valley that bends, so that a plane approximation is far off
/// (<https://www.itl.nist.gov/div898/strd/nls/data/boxbod.shtml>). Towards a large rate the density does not vanish:
/// the bound cuts it.
#[test]
fn box_bod_is_that_of_quadrature() {
    let (x, y) = ([1.0, 2.0, 3.0, 5.0, 7.0, 10.0], [109.0, 149.0, 149.0, 191.0, 213.0, 224.0]);
    let parameters = [
        Parameter::new("ultimate_demand", "b1", "mg/l").bounded(Bounds::new(100.0, 400.0).unwrap()),
        Parameter::new("rate", "b2", "1/d").bounded(Bounds::new(0.05, 2.0).unwrap()),
    ];
    let problem = curve(&x, &y, parameters, |x, [a, b]| a - a * (-b * x).exp()).unwrap();
    let fit = fitted(&problem, &[100.0, 0.75]);
    // Certified: 213.80940889 and 0.54723748542.
    assert!((fit.values()[0] - 213.809_408_89).abs() < 1e-6 && (fit.values()[1] - 0.547_237_485_42).abs() < 1e-9);
    let log_density = |[a, b]: [f64; 2]| {
        let square: f64 = x.iter().zip(&y).map(|(x, y)| (a * (1.0 - (-b * x).exp()) - y).powi(2)).sum();
        -3.0 * square.ln()
    };
    let exact = moments_by_quadrature([(100.0, 400.0), (0.05, 2.0)], log_density);
    let posterior = Sampler::default().with_draws(5000).sample(&problem, &fit).unwrap();
    println!("{posterior}");
    for (marginal, exact) in posterior.marginals().iter().zip(exact) {
        assert_moments(marginal, exact);
    }
}
