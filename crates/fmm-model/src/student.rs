//! Student's t: coverage factors and quantiles.

use statrs::distribution::{Continuous, ContinuousCDF, Normal, StudentsT};

/// Degrees of freedom above which the expansion about the normal distribution is the more accurate (1). From 10⁷ on the
/// inverse of statrs is wrong in the first digits.
const EXPANSION_ABOVE: f64 = 1000.0;
/// Steps of Newton's method at most; two are the rule, ten where the start is wrong by its order of magnitude.
const STEPS: usize = 40;

/// The factor k (1) that makes y ± k u an interval of coverage probability `level` p, for a standard uncertainty u of
/// `degrees_of_freedom` ν > 0: the (1 + p)/2 quantile of Student's t, and of the normal distribution if ν is infinite.
///
/// ```text
/// k = t_p(ν)                                                       (JCGM 100:2008, G.3.2 and Table G.2)
/// ```
///
/// `None` unless 0 < p < 1 and ν > 0. Errors are below 1e-12 of k for ν ≤ 1000, also for levels close to 1. For larger
/// ν they are below 2e-14 for levels up to 0.9973 (z = 3) and 1e-11 up to z = 6.
///
/// ```
/// use fmm_model::coverage_factor;
///
/// assert!((coverage_factor(0.95, 9.0).unwrap() - 2.262_157_162_8).abs() < 1e-10);
/// assert!((coverage_factor(0.95, f64::INFINITY).unwrap() - 1.959_963_984_540).abs() < 1e-12);
/// assert_eq!(coverage_factor(1.0, 9.0), None);
/// ```
///
/// # References
/// M. Abramowitz, I. A. Stegun, *Handbook of Mathematical Functions*, 26.7.5 (many degrees of freedom).
pub fn coverage_factor(level: f64, degrees_of_freedom: f64) -> Option<f64> {
    let is_possible = level > 0.0 && level < 1.0 && degrees_of_freedom > 0.0;
    is_possible.then(|| student_quantile(0.5 * (1.0 - level), degrees_of_freedom))
}

/// The value (1) that Student's t of `degrees_of_freedom` ν > 0 exceeds with probability `tail`, 0 < `tail` ≤ 1/2.
///
/// The upper tail is the argument because 1 − `tail` would round to 1.
///
/// ```
/// // One degree of freedom is Cauchy's distribution, of which the tail is 1/(π x) where x is large.
/// let x = fmm_model::student_quantile(1e-9, 1.0);
/// assert!((x * std::f64::consts::PI * 1e-9 - 1.0).abs() < 1e-12);
/// ```
pub fn student_quantile(tail: f64, degrees_of_freedom: f64) -> f64 {
    let nu = degrees_of_freedom;
    if nu <= EXPANSION_ABOVE
        && let Ok(student) = StudentsT::new(0.0, 1.0, nu)
    {
        return refine(-student.inverse_cdf(tail), tail, &student);
    }
    let z = -Normal::standard().inverse_cdf(tail);
    let s = z * z;
    let terms = [
        z * (s + 1.0) / 4.0,
        z * ((5.0 * s + 16.0) * s + 3.0) / 96.0,
        z * (((3.0 * s + 19.0) * s + 17.0) * s - 15.0) / 384.0,
        z * ((((79.0 * s + 776.0) * s + 1482.0) * s - 1920.0) * s - 945.0) / 92_160.0,
    ];
    z + terms.iter().rev().fold(0.0, |sum, term| (sum + term) / nu)
}

/// The quantile from a value near it, by Newton's method between the logarithms of value and tail: a nearly straight
/// line where tails are small, for which the inverse of statrs has an absolute floor.
fn refine(near: f64, tail: f64, student: &StudentsT) -> f64 {
    // The line that the tail becomes, whose slope is −ν.
    let nu = student.freedom();
    let far = || ((student.ln_pdf(1e100) + 1e100_f64.ln() * (nu + 1.0) - nu.ln() - tail.ln()) / nu).exp();
    let mut x = if near.is_finite() { near } else { far() };
    let mut last = f64::INFINITY;
    for _ in 0..STEPS {
        let (beyond, density) = (student.sf(x), student.pdf(x));
        // Relative to x where that is large, and never by more than its order of magnitude.
        let step = if x > 1.0 { (beyond / tail).ln() * beyond / (x * density) } else { (beyond - tail) / density };
        // Steps that no longer shrink are rounding.
        if !(step.abs() < last) || step == 0.0 {
            break;
        }
        last = step.abs();
        x += if x > 1.0 { x * step.clamp(-2.0, 2.0).exp_m1() } else { step };
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative error of the inverse incomplete beta function, which iterates to a fixed tolerance.
    const BETA_INVERSE: f64 = 1e-12;

    /// Two-sided factors for 90 %, 95 % and 99 %, computed with 40 digits and printed with 16.
    const FACTORS: [(f64, [f64; 3]); 9] = [
        (1.0, [6.313_751_514_675_043, 12.706_204_736_174_7, 63.656_741_162_871_58]),
        (2.0, [2.919_985_580_353_726, 4.302_652_729_749_464, 9.924_843_200_918_293]),
        (4.0, [2.131_846_786_326_65, 2.776_445_105_197_794, 4.604_094_871_349_993]),
        (9.0, [1.833_112_932_656_237, 2.262_157_162_798_205, 3.249_835_541_592_126]),
        (16.0, [1.745_883_676_276_25, 2.119_905_299_221_255, 2.920_781_622_425_1]),
        (24.0, [1.710_882_079_909_428, 2.063_898_561_628_026, 2.796_939_504_774_456]),
        (50.0, [1.675_905_025_163_098, 2.008_559_112_100_761, 2.677_793_270_940_844]),
        (100.0, [1.660_234_326_085_34, 1.983_971_518_523_552, 2.625_890_521_438_018]),
        (f64::INFINITY, [1.644_853_626_951_473, 1.959_963_984_540_054, 2.575_829_303_548_901]),
    ];

    #[test]
    fn factors_of_the_table() {
        for (nu, row) in FACTORS {
            for (level, expected) in [0.90, 0.95, 0.99].into_iter().zip(row) {
                let k = coverage_factor(level, nu).unwrap();
                assert!((k / expected - 1.0).abs() < BETA_INVERSE, "level {level}, ν {nu}: {k}, not {expected}");
            }
        }
    }

    #[test]
    fn both_branches_meet() {
        let (below, above) = (EXPANSION_ABOVE, EXPANSION_ABOVE * (1.0 + f64::EPSILON));
        for level in [0.5, 0.6827, 0.95, 0.9973] {
            let (exact, expanded) = (coverage_factor(level, below).unwrap(), coverage_factor(level, above).unwrap());
            assert!((expanded / exact - 1.0).abs() < BETA_INVERSE, "level {level}: {exact} and {expanded}");
        }
    }

    #[test]
    fn many_degrees_of_freedom_approach_the_normal_factor_from_above() {
        let normal = coverage_factor(0.95, f64::INFINITY).unwrap();
        for nu in [1e5, 1e7, 1e9] {
            let excess = coverage_factor(0.95, nu).unwrap() - normal;
            // First term of the expansion, (z³ + z)/4ν; the next is 1/ν smaller, and z itself rounds to 4e-16.
            let first = (normal.powi(3) + normal) / (4.0 * nu);
            assert!((excess - first).abs() < 2.0 * first / nu + 1e-15, "ν {nu}: {excess}, not {first}");
        }
    }

    #[test]
    fn impossible_levels_and_degrees_of_freedom_are_refused() {
        for level in [0.0, 1.0, -0.5, 95.0, f64::NAN] {
            assert_eq!(coverage_factor(level, 5.0), None, "{level}");
        }
        for nu in [0.0, -1.0, f64::NAN] {
            assert_eq!(coverage_factor(0.95, nu), None, "ν {nu}");
        }
    }
}
