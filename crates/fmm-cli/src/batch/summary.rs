//! Summary of a campaign: what its records say together.

use fmm_model::{Estimated, Interval};
use fmm_uq::{Outlier, Precision, RandomEffects};
use serde::Serialize;

use super::Asked;
use super::campaign::Campaign;
use super::dependence::{Dependence, FRICTION, LOAD, dependences, is_under, number_in};
use super::joint::Together;
use super::pooled::Pooled;
use super::row::{Outcome, Row, Told, quantities};
use super::shared::{Parted, SharedPart};
use super::sheet::Field;
use super::table::probability;

/// Coverage probability of intervals (1).
pub(super) const LEVEL: f64 = 0.95;

/// Each quantity that two records or more show.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Summary {
    pub(crate) records: usize,
    pub(crate) found: usize,
    /// Records that count in what follows.
    pub(crate) counted: usize,
    /// Records that the manifest leaves out, with the reason.
    pub(crate) excluded: Vec<Excluded>,
    /// Records that were found, but whose warnings doubt the fit.
    pub(crate) doubted: Vec<Doubted>,
    /// True if these count all the same, as that was asked for.
    pub(crate) counts_doubtful: bool,
    pub(crate) quantities: Vec<Quantity>,
    /// Friction over the speed, no law assumed, unless curves are left out.
    pub(crate) friction_curve: Option<Pooled>,
    /// Friction against what differs between the records.
    pub(crate) dependences: Vec<Dependence>,
    /// All records fitted together, where that is asked for.
    pub(crate) joint: Option<Outcome<Together>>,
    /// The record sheet, where the manifest has one.
    pub(crate) sheet: Option<Vec<Field>>,
}

/// A record that the manifest leaves out.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Excluded {
    pub(crate) file: String,
    pub(crate) reason: String,
}

/// A record that lies farther from the others than chance and uncertainties explain.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Outlying {
    pub(crate) file: String,
    /// Distance from the consensus of the others, over it (1).
    pub(crate) relative: f64,
    /// p, probability that any record lies as far off by chance.
    pub(crate) p: f64,
}

/// A record whose fit is doubted.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Doubted {
    pub(crate) file: String,
    pub(crate) doubts: Vec<String>,
}

/// A quantity of a campaign.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Quantity {
    pub(crate) name: String,
    pub(crate) unit: String,
    /// Ends of the loads (N) of these records, where the quantity differs with the load by design.
    pub(crate) loads: Option<(f64, f64)>,
    /// Records that tell it with an uncertainty.
    pub(crate) records: usize,
    /// Records that show it without one, such as on a bound; they are left out.
    pub(crate) left_out: usize,
    /// Consensus with random effects after Mandel and Paule, its standard uncertainty, and the interval after Hartung
    /// and Knapp.
    pub(crate) mean: f64,
    pub(crate) u: f64,
    pub(crate) interval_95: [f64; 2],
    /// Contributions to u of inputs that records share, together and each.
    pub(crate) shared_u: f64,
    pub(crate) shared: Vec<SharedPart>,
    /// Standard deviation between the records beyond their uncertainties.
    pub(crate) between: f64,
    /// The same after DerSimonian and Laird.
    pub(crate) between_der_simonian_laird: f64,
    /// p, probability of differences as large if the records differed by their uncertainties only.
    pub(crate) p: f64,
    pub(crate) i_squared: f64,
    /// The mean weighted by the uncertainties alone, as if the records did not differ, with the standard uncertainty
    /// that it claims.
    pub(crate) weighted_mean: [f64; 2],
    /// Records that lie far from the others.
    pub(crate) outlying: Vec<Outlying>,
    /// The record whose absence moves the consensus most, and by how many standard uncertainties.
    pub(crate) most_influential: Option<(String, f64)>,
    /// Value and standard uncertainty by the joint fit, where it has the quantity as the records have it.
    pub(crate) joint: Option<(f64, Option<f64>)>,
    /// Repeatability and reproducibility; `None` without groups.
    pub(crate) precision: Option<ByGroup>,
}

/// Repeatability and reproducibility by the groups of a column.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct ByGroup {
    pub(crate) groups: Vec<String>,
    pub(crate) means: Vec<f64>,
    pub(crate) repeatability: f64,
    pub(crate) between: f64,
    pub(crate) reproducibility: f64,
    /// p, probability of means as different if all groups were alike.
    pub(crate) p: f64,
    /// Mandel's statistics of each group.
    pub(crate) h: Vec<f64>,
    pub(crate) k: Vec<Option<f64>>,
    /// The group whose mean lies farthest off (Grubbs), and the one that scatters most (Cochran), with the p of that.
    pub(crate) farthest: Option<(String, f64)>,
    pub(crate) widest: Option<(String, f64)>,
}

impl Summary {
    /// Summary of all rows, with the questions `asked` of all of them, and with the joint fit if there was one.
    pub(crate) fn of(campaign: &Campaign, rows: &[Row], asked: &Asked, joint: Option<Outcome<Together>>) -> Self {
        let together = joint.as_ref().and_then(Outcome::found);
        let counted: Vec<&Row> = rows.iter().filter(|row| row.counts(asked.count_doubtful)).collect();
        let loads = groups_of_load(&counted);
        let of = |quantity: (&'_ str, &'_ str)| -> Vec<Quantity> {
            let shown: Vec<(&Row, &Told)> =
                counted.iter().filter_map(|row| Some((*row, row.told(quantity)?))).collect();
            if loads.len() < 2 || !is_of_load(quantity.0) {
                return Quantity::of(campaign, &shown, None, together, quantity).into_iter().collect();
            }
            let under = |ends: &(f64, f64)| {
                let shown: Vec<(&Row, &Told)> = shown.iter().filter(|(row, _)| is_under(row, *ends)).copied().collect();
                Quantity::of(campaign, &shown, Some(*ends), together, quantity)
            };
            loads.iter().filter_map(under).collect()
        };
        let excluded = |row: &Row| match &row.outcome {
            Outcome::Refused(reason) if row.is_excluded => {
                Some(Excluded { file: row.file.display().to_string(), reason: reason.clone() })
            }
            _ => None,
        };
        let doubted = |row: &Row| {
            let doubts = row.found().map(|found| found.doubts.clone()).filter(|doubts| !doubts.is_empty())?;
            Some(Doubted { file: row.file.display().to_string(), doubts })
        };
        Self {
            records: rows.len(),
            found: rows.iter().filter_map(Row::found).count(),
            counted: counted.len(),
            excluded: rows.iter().filter_map(excluded).collect(),
            doubted: rows.iter().filter_map(doubted).collect(),
            counts_doubtful: asked.count_doubtful,
            quantities: quantities(&counted).into_iter().flat_map(of).collect(),
            friction_curve: Pooled::of(campaign, rows, asked.count_doubtful),
            dependences: dependences(&counted, &asked.against),
            joint,
            sheet: campaign.sheet.as_ref().map(|sheet| sheet.fields(rows, &counted)),
        }
    }

    /// The measure of friction that tells most of what the records have in common.
    pub(crate) fn main(&self) -> Option<&Quantity> {
        let of = |ending: &&str| {
            self.quantities.iter().find(|quantity| quantity.loads.is_none() && quantity.name.ends_with(*ending))
        };
        FRICTION.iter().find_map(of)
    }

    /// Why a joint fit would claim too much; `None` where its friction is that of all records.
    pub(crate) fn against_joint(&self) -> Option<String> {
        let differ = self.main().filter(|quantity| quantity.p < DIFFER)?;
        Some(format!(
            "the records differ in {} beyond their uncertainties (p {}), by {:.2} % in standard deviation, and one law \
             of one machine for all would claim too small an uncertainty: take the consensus, which allows for it, \
             leave out a record that lies far off by `exclude` in the manifest, or fit groups of records that agree",
            differ.name,
            probability(differ.p),
            100.0 * differ.between / differ.mean.abs()
        ))
    }
}

/// Loads that differ by less than this factor are one load that was set again (1), by judgement.
const ONE_LOAD: f64 = 1.02;
/// Value p below which records differ beyond their uncertainties, or one lies far from the others (1).
pub(super) const DIFFER: f64 = 0.05;

/// True for a force, or a force per mass, which differs with the load by design.
fn is_of_load(name: &str) -> bool {
    FRICTION[1..].iter().any(|level| name.ends_with(level))
}

/// Ends of the loads (N) under which `rows` stand, those that are alike together.
pub(super) fn groups_of_load(rows: &[&Row]) -> Vec<(f64, f64)> {
    let mut loads: Vec<f64> = rows.iter().filter_map(|row| number_in(row, LOAD)).collect();
    loads.sort_by(f64::total_cmp);
    let mut groups: Vec<(f64, f64)> = Vec::new();
    for load in loads {
        match groups.last_mut() {
            Some((low, high)) if load <= ONE_LOAD * *low => *high = load,
            _ => groups.push((load, load)),
        }
    }
    groups
}

/// Value of a quantity by the joint fit. Forces at one load are not those of records at others.
fn by_joint(together: &Together, (name, unit): (&str, &str)) -> Option<(f64, Option<f64>)> {
    let [coefficient, levels @ ..] = FRICTION;
    let is_level = !name.ends_with(coefficient) && levels.iter().any(|level| name.ends_with(level));
    if is_level && together.reference_load.is_some() {
        return None;
    }
    let found = together.findings.iter().find(|told| told.name == name && told.unit == unit)?;
    Some((found.value, found.u))
}

impl Quantity {
    /// Consensus of the records that show it; `None` if fewer than two of them tell it with an uncertainty.
    pub(super) fn of(
        campaign: &Campaign,
        shown: &[(&Row, &Told)],
        loads: Option<(f64, f64)>,
        together: Option<&Together>,
        quantity: (&str, &str),
    ) -> Option<Self> {
        let told: Vec<(&Row, &Told)> =
            shown.iter().copied().filter(|(_, told)| told.u.is_some_and(|u| u > 0.0)).collect();
        let parted = Parted::of(&told);
        let consensus = parted.consensus(RandomEffects::MandelPaule).ok()?;
        let other = parted.consensus(RandomEffects::DerSimonianLaird).ok()?;
        let Interval { low, high, .. } = consensus.interval(LEVEL).ok()?;
        let Estimated { value: mean, uncertainty: u } = consensus.mean();
        let moved = told.iter().enumerate().filter_map(|(index, (row, _))| {
            let others = consensus.without(index).ok()?.mean().value;
            Some((row.file.display().to_string(), (others - mean) / u))
        });
        let outlying = told.iter().enumerate().filter_map(|(index, (row, told))| {
            let p = consensus.outlier_p_value(index).ok().filter(|p| *p < DIFFER)?;
            let others = consensus.without(index).ok()?.mean().value;
            Some(Outlying { file: row.file.display().to_string(), relative: told.value / others - 1.0, p })
        });
        let outlying = outlying.collect();
        let plain = consensus.without_effects();
        Some(Self {
            name: quantity.0.to_owned(),
            unit: quantity.1.to_owned(),
            loads,
            outlying,
            records: told.len(),
            left_out: shown.len() - told.len(),
            mean,
            u,
            interval_95: [low, high],
            shared_u: consensus.shared_uncertainty(),
            shared: parted.shared(&consensus),
            between: consensus.between(),
            between_der_simonian_laird: other.between(),
            p: consensus.p_value(),
            i_squared: consensus.i_squared(),
            weighted_mean: [plain.value, plain.uncertainty],
            most_influential: moved.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())),
            joint: together.and_then(|together| by_joint(together, quantity)),
            precision: campaign.group.as_ref().and_then(|column| ByGroup::of(column, &told)),
        })
    }
}

impl ByGroup {
    fn of(column: &str, told: &[(&Row, &Told)]) -> Option<Self> {
        let mut groups: Vec<(String, Vec<f64>)> = Vec::new();
        for (row, told) in told {
            let group = row.description.get(column)?;
            match groups.iter_mut().find(|(name, _)| name == group) {
                Some((_, values)) => values.push(told.value),
                None => groups.push((group.clone(), vec![told.value])),
            }
        }
        let (names, values): (Vec<String>, Vec<Vec<f64>>) = groups.into_iter().unzip();
        let precision = Precision::of(&values).ok()?;
        let named = |outlier: Outlier| (names[outlier.group].clone(), outlier.p_value);
        Some(Self {
            means: precision.analysis().means().collect(),
            repeatability: precision.repeatability(),
            between: precision.between(),
            reproducibility: precision.reproducibility(),
            p: precision.analysis().p_value(),
            h: precision.h(),
            k: precision.k(),
            farthest: precision.grubbs().map(named),
            widest: precision.cochran().map(named),
            groups: names,
        })
    }
}
