//! Chapter 4, the flexure: how far it may be deflected, how straight it moves, how much the shaft leans.
//!
//! The thesis prints no dimension of the flexure. The length follows from a printed ratio; width, thickness and modulus
//! are stock sizes that fit the printed stiffness and stress. All that depends on them is a check of consistency.

mod figures;
mod geometry;
mod motion;

use fmm_model::{Dual, Flexure, Scalar as _, Tilt};

use self::geometry::{ALLOWED_STRESS, LARGEST, PRINTED_RATIO, SAFETY};
use self::motion::{FreeVibration, largest};
use crate::{Chapter, Criterion, Found, Settings, Target, printed};

/// Chapter 4.
///
/// # Errors
/// If a computation cannot be done.
pub fn chapter(settings: &Settings<'_>) -> Found<Chapter> {
    let flexure = geometry::inferred()?;
    let mut chapter = Chapter::new("4 Flexure");
    parasitic_motion(&mut chapter, &flexure);
    vibrations(&mut chapter, &flexure)?;
    settings.done(0.9);
    strength(&mut chapter, &flexure);
    stiffness(&mut chapter, &flexure)?;
    tilt(&mut chapter)?;
    settings.done(1.0);
    Ok(chapter)
}

/// Section 4.1.
fn strength(chapter: &mut Chapter, flexure: &Flexure) {
    let leaf = flexure.leaf();
    let stress = leaf.bending_stress(LARGEST) / 1e6;
    chapter.target(
        Target::new("A4", "bending stress at 22 mm", "MPa", stress, Criterion::within(70.4, 0.002))
            .printed("70.4")
            .inferred()
            .note("Eq. 4.2 with L²; 1 mm in the length is 0.4 %"),
    );
    let yield_strength = SAFETY * ALLOWED_STRESS;
    let deflection = 1e3 * leaf.deflection_at(yield_strength);
    chapter.target(
        Target::new("A5", "deflection at six times 70.4 MPa", "mm", deflection, Criterion::within(134.0, 0.02))
            .printed("134")
            .inferred()
            .note("Eq. 4.1 with L²; 134 mm, 22 mm, 70.4 MPa and six do not agree to better than 1.6 %"),
    );
    let strength_of_134 = leaf.bending_stress(0.134) / 1e6;
    chapter.target(
        Target::new("A5", "yield strength that gives 134 mm", "MPa", strength_of_134, Criterion::near(429.4, 0.1))
            .inferred()
            .note("the last digit of the reference"),
    );
    let factor = 0.134 / LARGEST;
    chapter.target(
        Target::new("A5", "134 mm over 22 mm", "1", factor, Criterion::near(6.09, 0.005))
            .printed("six")
            .note("22.3 mm was rounded to 22 mm"),
    );

    // Eqs. 4.1 and 4.2 letter for letter, to show what they give.
    let (width, thickness, modulus) = (leaf.width(), leaf.thickness(), leaf.elastic_modulus());
    let first = yield_strength * leaf.length() / (3.0 * modulus * thickness);
    let second = 3.0 * modulus * thickness * LARGEST / (width * thickness * thickness);
    chapter.finding(
        "Eqs. 4.1 and 4.2 are misprinted: both need the length squared.",
        format!(
            "As printed, Eq. 4.1 is a pure number ({first:.3}) and Eq. 4.2 a stress per length ({:.1}·10¹³ Pa/m). With L² \
             they give {deflection:.1} mm and {stress:.2} MPa, the printed 134 mm and 70.4 MPa to 1.6 % and 0.2 %.",
            second / 1e13
        ),
        &["E1", "E2"],
    );
    chapter.finding(
        "134 mm, a factor of six, 22 mm and 70.4 MPa exclude each other by 1.6 %.",
        format!(
            "Six times 70.4 MPa allow {deflection:.1} mm; 134 mm need a yield strength of {strength_of_134:.1} MPa instead of \
             {:.1} MPa; 134 mm over 22 mm is {factor:.2}.",
            yield_strength / 1e6
        ),
        &["E3"],
    );
}

/// Table 2's stiffness from the inferred dimensions, and what they do to it.
fn stiffness(chapter: &mut Chapter, flexure: &Flexure) -> Found<()> {
    let leaf = flexure.leaf();
    let stiffness = flexure.stiffness();
    chapter.target(
        Target::new("A6", "stiffness of four leaves", "N/m", stiffness, Criterion::within(printed::MACHINE[1], 0.001))
            .printed("1982")
            .inferred()
            .note("width, thickness and modulus are inferred from it: consistency only"),
    );
    let row = |name: &str, value: String, source: &str| vec![name.to_owned(), value, source.to_owned()];
    chapter.table(
        "Dimensions of the flexure. The thesis prints only the number of leaves and that they are of steel.",
        &["quantity", "value", "from"],
        vec![
            row("leaves", flexure.leaves().to_string(), "section 3.1"),
            row("length / mm", format!("{:.1}", 1e3 * leaf.length()), "inferred: ratio 230 at 4 mm, Eq. 4.3"),
            row("width / mm", format!("{:.1}", 1e3 * leaf.width()), "inferred: 4 in"),
            row("thickness / mm", format!("{:.4}", 1e3 * leaf.thickness()), "inferred: 1/16 in"),
            row("elastic modulus / GPa", format!("{:.0}", leaf.elastic_modulus() / 1e9), "inferred: steel"),
        ],
    );

    let varied = geometry::inferred::<Dual<2>>()?.stiffness();
    let [by_thickness, by_length] =
        [(0, leaf.thickness()), (1, leaf.length())].map(|(i, value)| varied.partial(i) * value / varied.value());
    chapter.finding(
        "A stiffness that is computed from dimensions cannot set the scale of the friction.",
        format!(
            "An error of 1 % of the thickness is {by_thickness:.1} % of the stiffness, one of the length {:.1} % the other way. \
             A velocity record knows the friction only relative to the stiffness, so that both go into every coefficient of \
             friction in full.",
            -by_length
        ),
        &[],
    );
    Ok(())
}

/// Section 4.2, Eq. 4.3.
fn parasitic_motion(chapter: &mut Chapter, flexure: &Flexure) {
    let length = 1e3 * flexure.leaf().length();
    chapter.target(
        Target::new("A1", "length of the leaves, from the ratio 230", "mm", length, Criterion::near(552.0, 1.2))
            .inferred()
            .note("the ratio is printed to ±0.5"),
    );
    let micrometres = |deflection: f64| -1e6 * flexure.parasitic_motion(deflection);
    let (small, large) = (micrometres(PRINTED_RATIO.0), micrometres(LARGEST));
    chapter.target(
        Target::new("A2", "parasitic motion at 4 mm", "µm", small, Criterion::near(17.39, 0.05))
            .printed("17.4")
            .inferred()
            .note("the last printed digit"),
    );
    chapter.target(
        Target::new("A2", "parasitic motion at 22 mm", "µm", large, Criterion::near(526.1, 0.1))
            .printed("500")
            .inferred()
            .note("printed with one digit"),
    );
    let shortfall = 100.0 * (1.0 - 500.0 / large);
    chapter.target(
        Target::new("A2", "500 µm below Eq. 4.3 by", "%", shortfall, Criterion::AtMost(5.0))
            .inferred()
            .note("500 is 526 rounded to one digit"),
    );
    let ratio = flexure.motion_ratio(PRINTED_RATIO.0);
    chapter.target(
        Target::new("A3", "deflection over parasitic motion at 4 mm", "1", ratio, Criterion::near(230.0, 0.5))
            .printed("230")
            .inferred()
            .note("met by construction, as the length is from it"),
    );
    let ratio = flexure.motion_ratio(LARGEST);
    chapter.target(
        Target::new("A3", "deflection over parasitic motion at 22 mm", "1", ratio, Criterion::near(41.8, 0.5))
            .printed("42")
            .inferred()
            .note("the last printed digit"),
    );
    chapter.finding(
        "The parasitic motion at 22 mm is 526 µm, not 500 µm.",
        format!("Eq. 4.3 gives {large:.1} µm; the printed ratio of 42 alone means {:.0} µm.", 1e6 * LARGEST / 42.0),
        &["E4"],
    );
    let rows = (2..=11).map(|half| {
        let deflection = f64::from(2 * half) / 1e3;
        vec![
            (2 * half).to_string(),
            format!("{:.1}", micrometres(deflection)),
            format!("{:.1}", flexure.motion_ratio(deflection)),
            format!("{:.1}", flexure.leaf().bending_stress(deflection) / 1e6),
        ]
    });
    chapter.table(
        "Eq. 4.3 and Eq. 4.2 (corrected) over the range of the tests; printed are 17.4 µm and 230 at 4 mm, 500 µm, 42 and \
         70.4 MPa at 22 mm.",
        &["deflection / mm", "parasitic motion / µm", "ratio", "bending stress / MPa"],
        rows.collect(),
    );
}

/// Vibrations that Figures 3 to 6 show.
fn vibrations(chapter: &mut Chapter, flexure: &Flexure) -> Found<()> {
    let six = FreeVibration::of(flexure, 0.006, 5.0)?;
    let amplitude = 1e6 * largest(six.parasitic.values());
    chapter.target(
        Target::new(
            "A2",
            "largest parasitic motion of a 6 mm release (Fig. 3)",
            "µm",
            amplitude,
            Criterion::near(39.1, 0.05),
        )
        .inferred()
        .note("simulated free vibration; the last digit of the reference"),
    );
    let largest_test = FreeVibration::of(flexure, LARGEST, 2.0)?;
    let fastest = 1e3 * largest(largest_test.velocity.values());
    let across = 1e3 * largest(largest_test.parasitic_velocity.values());
    chapter.target(
        Target::new(
            "A2",
            "largest parasitic velocity of a 22 mm release (Fig. 6)",
            "mm/s",
            across,
            Criterion::near(7.27, 0.03),
        )
        .inferred()
        .note("simulated; without damping it is 7.266 mm/s"),
    );
    let ratio = fastest / across;
    chapter.target(
        Target::new(
            "A3",
            "largest velocity over largest parasitic velocity at 22 mm",
            "1",
            ratio,
            Criterion::near(41.8, 0.5),
        )
        .inferred()
        .note("the same ratio as of the motions, since one is the slope of the other"),
    );
    let excess = 1e3 * largest(&largest_test.excess());
    chapter.target(
        Target::new("A2", "most that it adds to the speed (Fig. 6)", "mm/s", excess, Criterion::near(0.134, 0.001))
            .inferred()
            .note("simulated; the last digit of the reference"),
    );
    let at_peak = 1e6 * largest_test.excess_at_peak();
    chapter.finding(
        "The parasitic motion does not disturb the velocity that is fitted.",
        format!(
            "At 22 mm it adds at most {excess:.3} mm/s to a velocity of up to {fastest:.0} mm/s, and {at_peak:.3} µm/s at the \
             peaks, where the platform is straight. Integrating the record and differentiating Eq. 4.3 as the thesis does is \
             within {:.1} µm/s of the formula −6 x v/(5 L).",
            1e6 * largest_test.worst_derivative
        ),
        &[],
    );

    figures::draw(chapter, &six, &largest_test)
}

/// Section 4.3.
fn tilt(chapter: &mut Chapter) -> Found<()> {
    let tilt = Tilt::from_displacements(1.6e-6, 0.0, 0.108)?;
    chapter.target(
        Target::new("A7", "tilt of the shaft", "10⁻⁴ °", 1e4 * tilt.degrees(), Criterion::near(8.488, 0.05))
            .printed("8.5")
            .note("1.6 µm over 10.8 cm; half of the last printed digit"),
    );
    chapter.target(
        Target::new("A7", "tilt of the shaft", "″", tilt.arcseconds(), Criterion::near(3.056, 0.05))
            .printed("3.1")
            .note("half of the last printed digit"),
    );
    Ok(())
}
