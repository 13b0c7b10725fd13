//! Choice of the poles that stay where they are.

use super::diagram::{STABLE_FREQUENCY, StabilisationDiagram, by_frequency, changes};
use super::pole::Pole;

/// Orders that a pole may miss before it counts as gone. Origin: chosen; noise pushes a weak pole over the axis now and
/// then.
const GAP: usize = 3;
/// Largest relative change of a damping ratio along a pole (1), wider than that of a stable one. Origin: simulated
/// chains with noise, where the damping of weak modes goes up and down by a fifth; what noise alone makes is told by
/// its residues afterwards.
const DAMPING: f64 = 0.3;
/// Least number of orders of a pole, as a share of all (1) and as a number. Origin: chosen by simulated structures of
/// 2 to 8 modes: the poles of noise live for a tenth of all orders, those of weak modes for a third.
const SHARE: f64 = 0.2;
const LEAST: usize = 4;

/// A pole through the orders.
struct Track {
    poles: Vec<Pole>,
    orders: Vec<usize>,
}

impl Track {
    fn last(&self) -> (Pole, usize) {
        (self.poles[self.poles.len() - 1], self.orders[self.orders.len() - 1])
    }

    /// True if this and a longer track are one pole that was lost for a while: near each other, and seldom in the same
    /// order, where two modes would be.
    fn continues(&self, other: &Self) -> bool {
        let common = self.orders.iter().filter(|order| other.orders.contains(order)).count();
        let (one, two) = (self.pole().0, other.pole().0);
        2 * common < self.orders.len() && (one - two).norm() < one.re.abs().max(two.re.abs())
    }

    /// The median of frequency and of damping.
    fn pole(&self) -> Pole {
        let median = |part: fn(&Pole) -> f64| {
            let mut values: Vec<f64> = self.poles.iter().map(part).collect();
            values.sort_by(f64::total_cmp);
            values[values.len() / 2]
        };
        Pole(fmm_record::Complex64::new(median(|pole| pole.0.re), median(|pole| pole.0.im)))
    }
}

/// The stable poles of a diagram, in the order of their frequencies.
///
/// Orders are gone through from the lowest on. The nearest pair of a known pole and one of the new order that agree in
/// frequency and damping is joined first, and each only once, so that two modes that are near remain two.
pub(super) fn stable_poles(diagram: &StabilisationDiagram) -> Vec<Pole> {
    let mut tracks: Vec<Track> = Vec::new();
    for present in diagram.poles().chunk_by(|a, b| a.order == b.order) {
        let order = present[0].order;
        let mut pairs = Vec::new();
        for (index, found) in present.iter().enumerate() {
            for (number, track) in tracks.iter().enumerate().filter(|(_, track)| order - track.last().1 <= GAP) {
                let last = track.last().0;
                let (frequency, damping) = changes(found.pole, last);
                if frequency < STABLE_FREQUENCY && damping < DAMPING {
                    pairs.push(((found.pole.0 - last.0).norm(), index, number));
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        let mut joined = vec![false; present.len()];
        for (_, index, number) in pairs {
            if !joined[index] && tracks[number].last().1 < order {
                joined[index] = true;
                tracks[number].poles.push(present[index].pole);
                tracks[number].orders.push(order);
            }
        }
        let new = present.iter().zip(&joined).filter(|(_, joined)| !**joined);
        tracks.extend(new.map(|(found, _)| Track { poles: vec![found.pole], orders: vec![order] }));
    }
    let least = LEAST.max((SHARE * diagram.order() as f64).ceil() as usize).min(diagram.order());
    tracks.retain(|track| track.orders.len() >= least);
    // A stable sort: of equals the one of lower order first.
    tracks.sort_by_key(|track| std::cmp::Reverse(track.orders.len()));
    let mut kept: Vec<&Track> = Vec::new();
    for track in &tracks {
        if !kept.iter().any(|longer| track.continues(longer)) {
            kept.push(track);
        }
    }
    let mut poles: Vec<Pole> = kept.into_iter().map(Track::pole).collect();
    poles.sort_by(by_frequency);
    poles
}
