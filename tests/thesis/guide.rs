//! The table in the guide of the thesis' numbers beside ours.

use fmm_thesis::CHAPTERS;

use super::{chapter, found};

/// Half of the last digit of a decimal number.
fn half_digit(number: &str) -> f64 {
    let digits = number.split_once('.').map_or(0, |(_, digits)| digits.len());
    0.5 * 10f64.powi(-i32::try_from(digits).unwrap())
}

#[test]
fn ours_are_what_the_chapters_compute() {
    let guide = include_str!("../../docs/guide.md");
    let rows: Vec<Vec<&str>> = guide
        .lines()
        .filter_map(|line| line.strip_prefix("| ")?.strip_suffix(" |"))
        .map(|line| line.split(" | ").collect())
        .filter(|cells: &Vec<_>| cells.len() == 5 && cells[0] != "target")
        .collect();
    assert_eq!(rows.len(), 10, "{rows:?}");
    for row in rows {
        let [id, quantity, _, printed, _] = row[..] else { panic!("{row:?}") };
        let quantity = quantity.split(" / ").next().unwrap();
        let chapters = CHAPTERS.iter().map(|(name, _)| chapter(name));
        let values: Vec<f64> = chapters.filter_map(|chapter| found(chapter, id, quantity)).collect();
        let [value] = values[..] else { panic!("{id}, {quantity}: {} values", values.len()) };
        let stated: f64 = printed.parse().unwrap();
        assert!((value - stated).abs() <= half_digit(printed), "{id}, {quantity}: {stated} stated, {value} computed");
    }
}
