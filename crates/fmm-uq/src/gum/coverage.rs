//! From a standard uncertainty to an interval: the coverage factor of Student's t.

use crate::UncertaintyError;
use crate::distributions::student;

/// The factor k that makes y ± k u a symmetric interval of coverage probability `level`, for a standard
/// uncertainty of `degrees_of_freedom` ν: the (1 + p)/2 quantile of Student's t.
///
/// ```text
/// k = t_p(ν)                                                       (JCGM 100:2008, G.3.2 and Table G.2)
/// ```
///
/// For ν ≤ 1000 this is the inverse of the regularised incomplete beta function, good to 1e-12 of k there also for
/// levels close to 1; it loses digits as ν grows. Beyond, it is the Cornish–Fisher expansion about the normal
/// quantile z to 1/ν⁴, whose error relative to k stays below 2e-14 for levels up to 0.9973 (z = 3) and 1e-11 up to
/// z = 6.
///
/// ```
/// let k = fmm_uq::coverage_factor(0.95, 9.0)?;
/// assert!((k - 2.262_157_162_8).abs() < 1e-10);
/// assert!((fmm_uq::coverage_factor(0.95, f64::INFINITY)? - 1.959_963_984_540).abs() < 1e-12);
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
///
/// # Errors
/// [`UncertaintyError::OutOfRange`] unless 0 < level < 1 and ν ≥ 1.
///
/// # References
/// M. Abramowitz, I. A. Stegun, *Handbook of Mathematical Functions*, 26.7.5.
pub fn coverage_factor(level: f64, degrees_of_freedom: f64) -> Result<f64, UncertaintyError> {
    let nu = UncertaintyError::require_degrees_of_freedom("the result", degrees_of_freedom)?;
    let level = valid_level(level)?;
    Ok(student::upper_quantile(0.5 * (1.0 - level), nu))
}

/// Passes a coverage probability through if it lies between 0 and 1.
pub(crate) fn valid_level(level: f64) -> Result<f64, UncertaintyError> {
    if level > 0.0 && level < 1.0 { Ok(level) } else { Err(UncertaintyError::level_out_of_range(level)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::distributions::student::EXPANSION_ABOVE;

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
            assert!(matches!(coverage_factor(level, 5.0), Err(UncertaintyError::OutOfRange { .. })), "{level}");
        }
        for nu in [0.0, 0.5, -1.0, f64::NAN] {
            assert!(coverage_factor(0.95, nu).is_err(), "ν {nu}");
        }
    }
}
