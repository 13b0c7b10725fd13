//! Wrong input, and input at the edge of it.

use fmm_model::Estimated;
use fmm_uq::{AnalysisOfVariance, Consensus, Precision, RandomEffects, UncertaintyError};

#[test]
fn what_makes_no_groups_is_refused() {
    let refused = |groups: &[Vec<f64>]| AnalysisOfVariance::of(groups).unwrap_err();
    assert!(matches!(refused(&[vec![1.0, 2.0]]), UncertaintyError::Invalid { .. }));
    assert!(matches!(refused(&[vec![1.0], vec![]]), UncertaintyError::Invalid { .. }));
    assert!(matches!(refused(&[vec![1.0], vec![2.0]]), UncertaintyError::Invalid { .. }));
    assert!(matches!(refused(&[vec![1.0, f64::NAN], vec![2.0]]), UncertaintyError::Invalid { .. }));
    assert!(matches!(refused(&[vec![1e300, -1e300], vec![2.0]]), UncertaintyError::Invalid { .. }));
    for wrong in [Estimated::new(f64::NAN, 1.0), Estimated::new(1.0, 0.0), Estimated::new(1.0, f64::INFINITY)] {
        let found = Consensus::of(&[Estimated::new(1.0, 1.0), wrong], RandomEffects::default());
        assert!(matches!(found, Err(UncertaintyError::Invalid { .. })), "{found:?}");
    }
    let alike = Precision::of(&[[1.0, 1.0]; 4]).unwrap();
    assert_eq!((alike.repeatability(), alike.between(), alike.analysis().f()), (0.0, 0.0, 0.0));
    assert!(alike.cochran().is_none() && alike.grubbs().is_none());
    // Each group's squares are below what f64 holds, both together are not.
    assert!(matches!(refused(&[vec![0.0, 1.5e154], vec![0.0, 1.5e154]]), UncertaintyError::Invalid { .. }));
    assert!(matches!(refused(&[vec![1e-170, 2e-170], vec![3e-170]]), UncertaintyError::NoAnswer { .. }));
    let pair = [1.0, 2.0].map(|value| Estimated::new(value, 0.5));
    let consensus = Consensus::of(&pair, RandomEffects::default()).unwrap();
    assert!(matches!(consensus.without(2), Err(UncertaintyError::Invalid { .. })));
    assert!(matches!(consensus.without(0), Err(UncertaintyError::Invalid { .. })));
    let sharing = |contributions: &[f64]| consensus.clone().with_shared(&[contributions.to_vec()]);
    assert!(matches!(sharing(&[1.0]), Err(UncertaintyError::Invalid { .. })));
    assert!(matches!(sharing(&[1.0, f64::NAN]), Err(UncertaintyError::Invalid { .. })));
    assert!(sharing(&[f64::MAX, f64::MAX]).is_ok_and(|shared| shared.interval(0.5).is_ok()));
    let all = vec![vec![f64::MAX; 2]; 2];
    assert!(matches!(consensus.with_shared(&all), Err(UncertaintyError::Invalid { .. })));
}

/// Nothing differs within the groups, but something between them.
#[test]
fn groups_without_a_spread() {
    let found = Precision::of(&[[1.0, 1.0], [2.0, 2.0], [3.0, 3.0], [7.0, 7.0]]).unwrap();
    let analysis = found.analysis();
    assert_eq!((analysis.f(), analysis.p_value(), analysis.r_squared()), (f64::INFINITY, 0.0, 1.0));
    assert_eq!(found.repeatability(), 0.0);
    assert_eq!(found.reproducibility(), found.between());
    // Standard deviation of 1, 2, 3 and 7.
    assert!((found.between() - (20.75_f64 / 3.0).sqrt()).abs() < 1e-14, "{}", found.between());
    assert!(found.cochran().is_none() && found.k().iter().all(|k| *k == Some(1.0)));
}
