//! Profiles of fitted quantities, against fits with the quantity held and against what is known of their noise.

use fmm_fit::ProfileEnd;
use fmm_friction::{Berger, Coulomb, CoulombViscous};
use fmm_identify::{Candidate, Experiment, Identification, Inquiry, Machine, Profile, Profiles, Terms, identify};
use fmm_model::coverage_factor;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use crate::records::{NOISE, RELEASES, machine, noisy, prepared, velocity};

const SAMPLES: usize = 1500;
const LEVEL: f64 = 0.95;

fn profile<'a>(profiles: &'a Profiles, name: &str) -> &'a Profile {
    profiles.profiles().iter().find(|profile| profile.parameter().name() == name).unwrap_or_else(|| panic!("{name}"))
}

/// The ends of every interval are where a fit with the quantity held there says so: (S − S_min)/s² = t².
fn ends_are_those_of_held_fits(
    found: &Identification,
    profiles: &Profiles,
    held: impl Fn(&str, f64) -> Identification,
) {
    let fit = found.fit();
    let factor = coverage_factor(LEVEL, fit.degrees_of_freedom() as f64).unwrap();
    for profile in profiles.profiles() {
        let name = profile.parameter().name();
        for end in [profile.interval().lower(), profile.interval().upper()] {
            let ProfileEnd::At(end) = end else { continue };
            let rise = held(name, end).fit().sum_of_squares() - fit.sum_of_squares();
            let distance = rise.sqrt() / fit.residual_standard_deviation().unwrap();
            // Where a reversal passes a sample the sum of squares has a small corner, at which a fit that comes from
            // elsewhere may end; a lower end would show that the profile is not the lowest.
            let ratio = distance / factor;
            assert!(ratio > 1.0 - 1e-6 && ratio < 1.0 + 1e-3, "{name} at {end}: {distance} instead of {factor}");
        }
    }
}

/// Friction and damping that a record tells well are as sure as ± k u says.
#[test]
fn what_is_well_determined_is_straight() {
    let motion = velocity::<CoulombViscous>(machine(), &[0.2, 0.5], RELEASES[1], SAMPLES);
    let decays = [noisy(&motion, 1)];
    let found = identify::<CoulombViscous>(&Machine::per_unit_mass(), &decays).unwrap();
    let profiles = found.profiles(&decays, LEVEL).unwrap();
    assert_eq!((profiles.profiles().len(), profiles.left_out().len()), (3, 0));
    for profile in profiles.profiles() {
        let name = profile.parameter().name();
        assert!(
            profile.bend() < 0.02 && !profile.is_bent() && profile.curve().is_empty(),
            "{name}: {}",
            profile.bend()
        );
        let (low, high) = found.interval(name, LEVEL).unwrap();
        let straight = profile.straight();
        assert!((straight.0 - low).abs() + (straight.1 - high).abs() < 1e-9 * high, "{name}: {straight:?}");
    }
    ends_are_those_of_held_fits(&found, &profiles, |name, value| {
        let terms = Terms::default().holding(name, value).unwrap();
        Inquiry::of(&Machine::per_unit_mass(), &decays)
            .candidate(&Candidate::of::<CoulombViscous>().with(terms.clone()))
            .unwrap()
    });
    let other = found.profiles(&[noisy(&motion[..1000], 1)], LEVEL).unwrap_err();
    assert!(other.to_string().contains("1500 residuals"), "{other}");
}

/// Without noise there is nothing to compare with.
#[test]
fn a_record_without_noise_has_none() {
    let decays = [prepared(velocity::<Coulomb>(machine(), &[0.2], RELEASES[1], SAMPLES))];
    let profiles = identify::<Coulomb>(&Machine::per_unit_mass(), &decays).unwrap().profiles(&decays, LEVEL).unwrap();
    assert!(profiles.profiles().is_empty() && profiles.left_out().is_empty());
}

/// A damping that is not there ends on its bound, and its interval there.
#[test]
fn a_damping_at_its_bound_is_one_sided() {
    let motion = velocity::<Coulomb>(machine(), &[0.2], RELEASES[1], SAMPLES);
    let name = "damping_per_mass";
    let fitted = (0..20).find_map(|seed| {
        let decays = [noisy(&motion, seed)];
        let found = identify::<CoulombViscous>(&Machine::per_unit_mass(), &decays).unwrap();
        (found.finding(name)?.value() == 0.0).then_some((found, decays))
    });
    // Half of the records ask for a negative one.
    let (found, decays) = fitted.expect("one of twenty");
    let profiles = found.profiles(&decays, LEVEL).unwrap();
    let damping = profile(&profiles, name);
    assert_eq!((damping.interval().lower(), damping.bend()), (ProfileEnd::Bound(0.0), f64::INFINITY));
    let upper = damping.interval().upper().value().unwrap();
    // A fit that would rather be below the bound rises faster above it.
    assert!(upper > 0.0 && upper < damping.straight().1, "{upper} beside {:?}", damping.straight());
    let curve = damping.curve();
    assert!(curve[0] == (0.0, 0.0) && curve.is_sorted_by(|a, b| a.1 < b.1), "{curve:?}");
    assert!(curve.iter().all(|(value, rise)| *rise >= damping.parabola(*value)));
}

/// The static excess that one record hardly tells: bent, and the curve says where.
#[test]
fn an_excess_that_is_hardly_told_is_bent() {
    let motion = velocity::<Berger>(machine(), &[0.15, 0.05, 20.0], RELEASES[1], SAMPLES);
    let decays = [noisy(&motion, 2)];
    let found = identify::<Berger>(&Machine::per_unit_mass(), &decays).unwrap();
    let profiles = found.profiles(&decays, LEVEL).unwrap();
    let bent: Vec<&Profile> = profiles.profiles().iter().filter(|profile| profile.is_bent()).collect();
    assert!(!bent.is_empty());
    for profile in bent {
        let (lower, upper) = (profile.interval().lower(), profile.interval().upper());
        let inside = |value: f64| {
            lower.value().is_none_or(|lower| value >= lower) && upper.value().is_none_or(|upper| value <= upper)
        };
        for (value, rise) in profile.curve() {
            let is_low = *rise <= profile.interval().threshold();
            assert_eq!(inside(*value), is_low, "{} at {value}: {rise}", profile.parameter().name());
        }
    }
}

/// Noise that remembers a few samples makes u larger than white noise of its size would, and the profile as wide.
#[test]
fn correlated_noise_widens_the_profile_as_it_does_u() {
    let motion = velocity::<Coulomb>(machine(), &[0.2], RELEASES[1], 4 * SAMPLES);
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut noise = 0.0;
    let values = motion.iter().map(|v| {
        let white: f64 = StandardNormal.sample(&mut random);
        noise = 0.9 * noise + NOISE * white;
        v + noise
    });
    let decays: [Experiment; 1] = [prepared(values.collect())];
    let found = identify::<Coulomb>(&Machine::per_unit_mass(), &decays).unwrap();
    let name = "friction_per_mass";
    let independent = found.fit().estimate(name).unwrap().standard_uncertainty().unwrap();
    let u = found.finding(name).unwrap().uncertainty().unwrap();
    // Of such noise low frequencies have √((1 + 0.9)/(1 − 0.9)) = 4.4 times the white deviation.
    assert!(u > 2.0 * independent, "{u} beside {independent}");
    let profiles = found.profiles(&decays, LEVEL).unwrap();
    let friction = profile(&profiles, name);
    assert!(friction.bend() < 0.02, "{}", friction.bend());
}
