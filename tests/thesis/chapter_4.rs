//! Chapter 4: what the thesis computes about its flexure.

use super::{assert_complete, chapter};

/// Nothing in the chapter is random; the criteria are the digits that are printed or, for the two stresses and
/// deflections that do not agree with each other, the disagreement.
#[test]
fn all_targets_pass() {
    let ids = ["A1", "A2", "A3", "A4", "A5", "A6", "A7"];
    assert_complete(chapter("chapter_4_flexure"), &ids, &[], &["figure_3", "figure_5", "figure_6"]);
}

/// Our values themselves, to the digits of an independent computation from the same inputs.
#[test]
fn values_are_those_of_the_reference() {
    let targets = &chapter("chapter_4_flexure").targets;
    let ours = |quantity: &str| {
        let target = targets.iter().find(|target| target.document()["quantity"] == quantity);
        target.unwrap_or_else(|| panic!("no {quantity}")).document()["ours"].as_f64().unwrap()
    };
    for (quantity, reference, digit) in [
        ("length of the leaves, from the ratio 230", 552.0, 1e-9),
        ("parasitic motion at 4 mm", 17.39, 0.005),
        ("parasitic motion at 22 mm", 526.1, 0.05),
        ("deflection over parasitic motion at 22 mm", 41.8, 0.05),
        ("bending stress at 22 mm", 70.49, 0.005),
        ("deflection at six times 70.4 MPa", 131.8, 0.05),
        ("stiffness of four leaves", 1981.7, 0.05),
    ] {
        assert!((ours(quantity) - reference).abs() <= digit, "{quantity}: {} against {reference}", ours(quantity));
    }
}
