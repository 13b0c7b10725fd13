use super::*;

fn function<D: Scalar>(x: D, y: D) -> D {
    let (sin, cos) = (x * 0.7).sin_cos();
    let powers = x.powf(y) + y.powf(D::from(2.5)) * 0.1;
    let mut sum = x.exp() * sin + (y.ln() - cos) / x.sqrt() + powers * y.atan2(x) + (y - 0.3).tanh() - (-x) / (y + 1.0);
    sum += x.sin() * y.cos() + (x * 0.3).tan() - y.atan();
    sum += y.powf(1.5) * 0.1;
    sum -= x.log10() + y.powi(3) * 0.1;
    sum *= y.powi(-2);
    sum /= 0.5;
    sum
}

#[test]
fn values_and_slopes_are_those_of_other_numbers() {
    let (x, y) = (1.3, 2.1);
    let taylor = function(Taylor::variable(x, 0), Taylor::variable(y, 1));
    let dual = function(fmm_model::Dual::<2>::variable(x, 0), fmm_model::Dual::variable(y, 1));
    assert_eq!(taylor.value(), function(x, y));
    for direction in 0..2 {
        let error = taylor.partial(direction) / dual.partial(direction) - 1.0;
        assert!(error.abs() < 1e-14, "direction {direction}: {error}");
    }
}

/// The polynomial meets the function at a distance h up to the fourth order, of coefficients near 1.
#[test]
fn the_expansion_meets_the_function() {
    let (x, y) = (1.3, 2.1);
    let taylor = function(Taylor::variable(x, 0), Taylor::variable(y, 1));
    let power = |x: f64, n: usize| x.powi(i32::try_from(n).unwrap());
    for h in [1e-2_f64, 3e-3] {
        for (dx, dy) in [(h, 0.0_f64), (0.0, h), (h, h), (-h, 0.5 * h)] {
            let term = |(i, j): (usize, usize)| taylor.coefficient(i, j) * power(dx, i) * power(dy, j);
            let expanded: f64 = POWERS.map(term).iter().sum();
            let error = expanded - function(x + dx, y + dy);
            assert!(error.abs() < 10.0 * h.powi(4) + 1e-14, "h = {h}: {error}");
        }
    }
}

#[test]
fn plain_numbers_stand_on_either_side_and_whole_powers_take_any_base() {
    let x = Taylor::variable(4.0, 0);
    let all = [2.0 + x, 2.0 - x, 2.0 * x, 2.0 / x];
    assert_eq!(all.map(Scalar::value), [6.0, -2.0, 8.0, 0.5]);
    assert_eq!(all.map(|y| y.partial(0)), [1.0, -1.0, 2.0, -0.125]);
    assert!(x > 3.0 && x == 4.0 && x < Taylor::from(5.0));
    // (−2 + d)³ = −8 + 12 d − 6 d² + d³, and 0² has d² alone.
    let cube = Taylor::variable(-2.0, 0).powi(3);
    assert_eq!([0, 1, 2, 3].map(|i| cube.coefficient(i, 0)), [-8.0, 12.0, -6.0, 1.0]);
    let square = Taylor::variable(0.0, 0).powi(2);
    assert_eq!([0, 1, 2, 3].map(|i| square.coefficient(i, 0)), [0.0, 0.0, 1.0, 0.0]);
}

#[test]
fn constants_do_not_meet_infinite_slopes() {
    assert_eq!(Taylor::from(0.0).sqrt().coefficients, Taylor::from(0.0).coefficients);
    assert!(!Taylor::variable(0.0, 0).sqrt().partial(0).is_finite());
}
