//! Friction over the speed that the records of a campaign share, no law assumed.

mod shown;

use fmm_identify::Source;
use fmm_model::{Estimated, Interval};
use fmm_uq::RandomEffects;
use serde::Serialize;

use super::campaign::Campaign;
use super::curve::{RowCurve, STATED};
use super::dependence::{Dependence, is_under, load_of, over_load};
use super::row::{Outcome, Row, Told, tally};
use super::shared::Parted;
use super::summary::{Excluded, LEVEL, Quantity, groups_of_load};
use crate::figure::{ends, label};

pub(super) use shown::{lines, section};

/// Friction curves of a campaign.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Pooled {
    /// One of all records, or one for each load where friction is no coefficient; empty if none is made.
    pub(crate) curves: Vec<PooledCurve>,
    /// Why none is made.
    pub(crate) missing: Option<String>,
    /// Records that were found, but have no curve, or one that is doubted.
    pub(crate) left_out: Vec<Excluded>,
}

/// Mean of friction curves.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct PooledCurve {
    /// Unit of friction: 1 for a coefficient, N for a force, else that of a force per mass.
    pub(crate) unit: String,
    pub(crate) speed_unit: String,
    /// False if a declared damping of the machine is not part of the curves.
    pub(crate) whole_resistance: bool,
    /// Ends of the loads (N) of these records, where friction differs with the load by design.
    pub(crate) loads: Option<(f64, f64)>,
    /// Files of the records.
    pub(crate) records: Vec<String>,
    /// Ends of the speeds of which all of them have samples; `None` if there are none.
    pub(crate) common_speeds: Option<(f64, f64)>,
    /// Friction at rest, in the mean over the path, at the top speed of each record, and at common speeds.
    pub(crate) levels: Vec<PooledLevel>,
    /// Speeds and friction of each record, for the eye.
    #[serde(skip)]
    each: Vec<Vec<(f64, f64)>>,
    /// Common speeds with mean and ends of its interval, for the eye.
    #[serde(skip)]
    band: Vec<(f64, f64, f64, f64)>,
}

/// Friction of one name that curves share.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct PooledLevel {
    /// `None` for what is no level at one speed of all records.
    pub(crate) speed: Option<f64>,
    #[serde(flatten)]
    pub(crate) friction: Quantity,
    /// Friction force against the load, where the records state different ones and friction is a coefficient.
    pub(crate) over_load: Option<Dependence>,
}

/// A record with its curve.
type Curved<'a> = (&'a Row, &'a RowCurve);

/// Unit of a coefficient, which does not differ with the load by design.
const COEFFICIENT: &str = "1";
/// Lowest common speed over the highest (1): the lowest level of a curve above rest is at 1.2 % of its top speed.
const LOWEST: f64 = 0.01;
/// Pieces in which the mean is drawn.
const PIECES: u32 = 60;

impl Pooled {
    /// Curves of the records that were found, also where their law is doubted; doubtful curves count where they are
    /// asked for.
    pub(super) fn of(campaign: &Campaign, rows: &[Row], with_doubtful: bool) -> Option<Self> {
        if campaign.without_curves {
            return None;
        }
        let (mut curved, mut left_out): (Vec<Curved<'_>>, Vec<Excluded>) = (Vec::new(), Vec::new());
        for row in rows {
            let mut leave_out = |reason| left_out.push(Excluded { file: row.file.display().to_string(), reason });
            match row.found().map(|found| &found.friction_curve) {
                Some(Outcome::Found(curve)) if with_doubtful || curve.limits.is_empty() => curved.push((row, curve)),
                Some(Outcome::Found(curve)) => leave_out(curve.limits.join("; ")),
                Some(Outcome::Refused(why)) => leave_out(why.clone()),
                None => {}
            }
        }
        let mut missing = why_not(&curved);
        let loads = groups_of_load(&curved.iter().map(|(row, _)| *row).collect::<Vec<_>>());
        let mut curves = Vec::new();
        if missing.is_none() {
            if loads.len() < 2 || curved[0].1.unit == COEFFICIENT {
                curves.push(PooledCurve::of(campaign, &curved, None));
            } else {
                let within = |ends: &(f64, f64)| {
                    let curved: Vec<Curved<'_>> =
                        curved.iter().filter(|(row, _)| is_under(row, *ends)).copied().collect();
                    (curved.len() > 1).then(|| PooledCurve::of(campaign, &curved, Some(*ends)))
                };
                curves.extend(loads.iter().filter_map(within));
                missing = curves.is_empty().then(|| "under no load two records have a curve that counts".to_owned());
            }
        }
        Some(Self { curves, missing, left_out })
    }

    /// Quantities that curves state in one number, pooled.
    pub(super) fn stated(&self) -> impl Iterator<Item = &Quantity> {
        let levels = self.curves.iter().flat_map(|curve| &curve.levels);
        levels.filter(|level| level.speed.is_none()).map(|level| &level.friction)
    }
}

/// Why curves have no mean; `None` if they have one.
fn why_not(curved: &[Curved<'_>]) -> Option<String> {
    let kind = |(_, curve): &Curved<'_>| {
        let whole = if curve.whole_resistance { "" } else { " without a declared damping" };
        format!("{} over {}{whole}", quantity(&curve.unit), curve.speed_unit)
    };
    match tally(curved.iter().map(kind)).as_slice() {
        [] | [(_, 1)] => Some("fewer than two records have a curve that counts".to_owned()),
        [_] => None,
        several => {
            let several: Vec<String> = several.iter().map(|(kind, count)| format!("{kind} ({count})")).collect();
            Some(format!("curves of different kinds have no mean: {}", several.join(", ")))
        }
    }
}

impl PooledCurve {
    /// The curve of records whose curves are of one kind.
    fn of(campaign: &Campaign, curved: &[Curved<'_>], loads: Option<(f64, f64)>) -> Self {
        let common_speeds = common_speeds(curved);
        let stated = (0..STATED.len()).map(|place| {
            let told: Vec<RowTold<'_>> =
                curved.iter().map(|(row, curve)| (*row, curve.stated[place].clone())).collect();
            PooledLevel::of(campaign, &told, loads, None)
        });
        let at_speeds = common_speeds.map_or_else(Vec::new, round_speeds).into_iter();
        let at_speeds = at_speeds.map(|speed| PooledLevel::of(campaign, &at(curved, speed), loads, Some(speed)));
        let drawn = |(low, high): (f64, f64)| {
            // Closer near rest, where friction changes most.
            let speed = |piece: u32| low * (high / low).powf(f64::from(piece) / f64::from(PIECES));
            (0..=PIECES).filter_map(|piece| mean_at(curved, speed(piece).min(high))).collect()
        };
        let (_, first) = curved[0];
        Self {
            unit: first.unit.clone(),
            speed_unit: first.speed_unit.clone(),
            whole_resistance: first.whole_resistance,
            loads,
            records: curved.iter().map(|(row, _)| row.file.display().to_string()).collect(),
            common_speeds,
            levels: stated.chain(at_speeds).flatten().collect(),
            each: curved.iter().map(|(_, curve)| curve.points()).collect(),
            band: common_speeds.map_or_else(Vec::new, drawn),
        }
    }
}

/// Name of friction in this unit.
fn quantity(unit: &str) -> String {
    if unit == COEFFICIENT { "friction coefficient".to_owned() } else { label("friction", unit) }
}

/// Row of a record, and what the record tells.
type RowTold<'a> = (&'a Row, Told);

/// Friction of each record at `speed`.
fn at<'a>(curved: &[Curved<'a>], speed: f64) -> Vec<RowTold<'a>> {
    curved.iter().filter_map(|(row, curve)| Some((*row, curve.at(speed)?))).collect()
}

fn borrowed<'a>(told: &'a [RowTold<'a>]) -> Vec<(&'a Row, &'a Told)> {
    told.iter().map(|(row, told)| (*row, told)).collect()
}

/// Mean at `speed`, and the ends of its interval.
fn mean_at(curved: &[Curved<'_>], speed: f64) -> Option<(f64, f64, f64, f64)> {
    let told = at(curved, speed);
    let consensus = Parted::of(&borrowed(&told)).consensus(RandomEffects::MandelPaule).ok()?;
    let Interval { low, high, .. } = consensus.interval(LEVEL).ok()?;
    Some((speed, consensus.mean().value, low, high))
}

/// Ends of the speeds of which all records have samples.
fn common_speeds(curved: &[Curved<'_>]) -> Option<(f64, f64)> {
    let (_, low) = ends(curved.iter().map(|(_, curve)| curve.samples_down_to));
    let (high, _) = ends(curved.iter().map(|(_, curve)| curve.top()));
    let low = low.max(LOWEST * high);
    (low < high).then_some((low, high))
}

/// Speeds of 1, 2 and 5 times powers of ten between two ends; the ends where fewer than two are there.
fn round_speeds((low, high): (f64, f64)) -> Vec<f64> {
    let power = |speed: f64| speed.log10().floor() as i32;
    let round = (power(low)..=power(high)).flat_map(|power| {
        // Read as they are written, so that no digit is added.
        [1, 2, 5].into_iter().filter_map(move |digit| format!("{digit}e{power}").parse::<f64>().ok())
    });
    let speeds: Vec<f64> = round.filter(|speed| (low..=high).contains(speed)).collect();
    if speeds.len() < 2 { vec![low, high] } else { speeds }
}

impl PooledLevel {
    fn of(campaign: &Campaign, told: &[RowTold<'_>], loads: Option<(f64, f64)>, speed: Option<f64>) -> Option<Self> {
        let shown = borrowed(told);
        let (_, first) = shown.first()?;
        let (name, unit) = (first.name.as_str(), first.unit.as_str());
        let friction = Quantity::of(campaign, &shown, loads, None, (name, unit))?;
        let run = |(row, told): &(&Row, &Told)| {
            let load = load_of(row)?;
            let own = told.contributions.iter().filter(|part| part.source != Source::NormalLoad.to_string());
            let u = own.fold(0.0, |u: f64, part| u.hypot(part.u));
            Some((load, Estimated::new(told.value * load.value, u * load.value)))
        };
        let runs: Vec<(Estimated, Estimated)> = shown.iter().filter_map(run).collect();
        let over_load = if unit == COEFFICIENT { over_load((name, "N"), &runs) } else { None };
        Some(Self { speed, friction, over_load })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn common_speeds_are_round() {
        assert_eq!(round_speeds((0.0017, 0.17)), [0.002, 0.005, 0.01, 0.02, 0.05, 0.1]);
        assert_eq!(round_speeds((5.0, 130.0)), [5.0, 10.0, 20.0, 50.0, 100.0]);
        assert_eq!(round_speeds((0.06, 0.09)), [0.06, 0.09]);
    }
}
