//! Stabilisation diagram: poles of growing order, and which of them stay where they are.

use super::normal_equations::Denominators;
use super::pole::Pole;

/// Largest relative change of a natural frequency from one order to the next that counts as none (1). Origin: B. Peeters
/// et al., "The PolyMAX frequency-domain method", Shock and Vibration 11 (2004) 395, section 2.
pub(super) const STABLE_FREQUENCY: f64 = 0.01;
/// The same of a damping ratio (1). Origin: the same.
pub(super) const STABLE_DAMPING: f64 = 0.05;
/// Largest damping ratio of a pole that is shown (1). Origin: chosen; a wider hump is no mode that stands out of a
/// background.
const LARGEST_DAMPING: f64 = 0.3;

/// A pole of one order.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct DiagramPole {
    /// Order of the denominator (1).
    pub order: usize,
    /// The pole.
    pub pole: Pole,
    /// True if a pole of the order below has the same natural frequency to 1 %.
    pub is_stable_in_frequency: bool,
    /// True if that pole has the same damping ratio to 5 % as well.
    pub is_stable_in_damping: bool,
}

impl DiagramPole {
    /// True for a pole that is stable in frequency and damping.
    pub fn is_stable(&self) -> bool {
        self.is_stable_in_frequency && self.is_stable_in_damping
    }
}

/// Poles of all orders in the band, with a damping ratio between 0 and 0.3: those of the structure stay where they are
/// as the order grows, those that fit noise do not.
///
/// A band of many lines is gone through in windows as well, each of a quarter of the lines of the next larger ones,
/// since one polynomial over thousands of lines does not resolve modes that are as narrow as a few.
#[derive(Debug, Clone, PartialEq)]
pub struct StabilisationDiagram {
    poles: Vec<DiagramPole>,
    order: usize,
}

impl StabilisationDiagram {
    /// The poles of one window of lines, of which those from `low` to `high` (Hz) count.
    pub(super) fn of(denominators: &Denominators, (low, high): (f64, f64)) -> Self {
        let mut poles: Vec<DiagramPole> = Vec::new();
        let mut below: Vec<Pole> = Vec::new();
        for order in 1..=denominators.order() {
            let is_shown = |pole: &Pole| {
                let (frequency, ratio) = (pole.natural_frequency(), pole.damping_ratio());
                (low..=high).contains(&frequency) && ratio > 0.0 && ratio < LARGEST_DAMPING && pole.0.im > 0.0
            };
            let mut present: Vec<Pole> = denominators.poles(order).into_iter().map(Pole).filter(is_shown).collect();
            present.sort_by(by_frequency);
            poles.extend(present.iter().map(|pole| {
                let distance = |other: &Pole| (other.0 - pole.0).norm();
                let nearest = below.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
                let (frequency, damping) =
                    nearest.map_or((f64::INFINITY, f64::INFINITY), |other| changes(*pole, *other));
                let is_stable_in_frequency = frequency < STABLE_FREQUENCY;
                let is_stable_in_damping = is_stable_in_frequency && damping < STABLE_DAMPING;
                DiagramPole { order, pole: *pole, is_stable_in_frequency, is_stable_in_damping }
            }));
            below = present;
        }
        Self { poles, order: denominators.order() }
    }

    /// The poles of all windows.
    pub(super) fn joined(windows: Vec<Self>) -> Self {
        let order = windows.iter().map(|window| window.order).max().unwrap_or(0);
        let mut poles: Vec<DiagramPole> = windows.into_iter().flat_map(|window| window.poles).collect();
        poles.sort_by(|a, b| a.order.cmp(&b.order).then(by_frequency(&a.pole, &b.pole)));
        Self { poles, order }
    }

    /// All poles, by order and then by frequency.
    pub fn poles(&self) -> &[DiagramPole] {
        &self.poles
    }

    /// The highest order.
    pub fn order(&self) -> usize {
        self.order
    }
}

/// The order of natural frequencies.
pub(super) fn by_frequency(a: &Pole, b: &Pole) -> std::cmp::Ordering {
    a.natural_frequency().total_cmp(&b.natural_frequency())
}

/// Relative changes of natural frequency and damping ratio from `other` to `pole`.
pub(super) fn changes(pole: Pole, other: Pole) -> (f64, f64) {
    let change = |a: f64, b: f64| (a / b - 1.0).abs();
    (change(pole.natural_frequency(), other.natural_frequency()), change(pole.damping_ratio(), other.damping_ratio()))
}
