//! Sentences on what a test tells that others do not.

use crate::design::{DesignPrediction, Plan};
use crate::error::IdentifyError;
use crate::finding::{Finding, Origin};

/// Without a test, an uncertainty that grows by less than this says nothing.
const NOTABLE: f64 = 1.02;
/// Of two findings that lose about as much, the one derived is the plainer.
const ALIKE: f64 = 0.99;

impl Plan {
    /// A sentence for the test at `place` by itself, beside what is known: how far it goes alone.
    ///
    /// # Errors
    /// As for [`predict`](Self::predict).
    pub fn told_alone(&self, place: usize) -> Result<String, IdentifyError> {
        let alone = self.predict(&[place])?;
        if let Some(direction) = alone.null_directions().first() {
            return Ok(format!("alone, {direction}"));
        }
        let relative = |finding: &&Finding| {
            let u = finding.uncertainty().filter(|_| matches!(finding.origin(), Origin::Fitted(_)))?;
            Some(u / finding.value().abs()).filter(|relative| relative.is_finite())
        };
        let mut known: Vec<(&str, f64)> = alone
            .findings()
            .iter()
            .filter_map(|finding| Some((finding.parameter().name(), relative(&finding)?)))
            .collect();
        known.sort_by(|a, b| a.1.total_cmp(&b.1));
        let little: Vec<&str> = known.iter().filter(|(_, u)| *u > 1.0).map(|(name, _)| *name).collect();
        if !little.is_empty() {
            return Ok(format!("alone, it tells little of {}: u exceeds the value", little.join(", ")));
        }
        Ok(match known.as_slice() {
            [] => "alone, it determines everything".to_owned(),
            [.., (name, u)] => format!("alone, it determines everything, {name} least: u is {:.2} % of it", 100.0 * u),
        })
    }

    /// A sentence for each test of a set, once, of what it tells that the others of the set do not: the direction that
    /// would stay free without it, or the finding that would lose most. The sentences are in the order of the places.
    ///
    /// # Errors
    /// As for [`predict`](Self::predict).
    pub fn told_by_each(&self, tests: &[usize]) -> Result<Vec<(usize, String)>, IdentifyError> {
        let whole = self.predict(tests)?;
        let mut places = tests.to_vec();
        places.sort_unstable();
        places.dedup();
        places
            .into_iter()
            .map(|place| {
                let others: Vec<usize> = tests.iter().copied().filter(|other| *other != place).collect();
                let without = self.predict(&others)?;
                Ok((place, sentence(&whole, &without)))
            })
            .collect()
    }
}

/// What is lost without a test.
fn sentence(whole: &DesignPrediction, without: &DesignPrediction) -> String {
    if without.rank() < whole.rank() {
        let lost: Vec<String> = without.null_directions().iter().map(ToString::to_string).collect();
        return format!("without it, {}", lost.join("; "));
    }
    let ratio = |finding: &Finding| {
        let before = without.finding(finding.parameter().name())?.uncertainty()?;
        Some(before / finding.uncertainty()?).filter(|ratio| ratio.is_finite())
    };
    let mut most: Option<(&str, f64)> = None;
    for finding in whole.findings() {
        let Some(ratio) = ratio(finding) else { continue };
        if most.is_none_or(|(_, largest)| ratio > ALIKE * largest) {
            most = Some((finding.parameter().name(), ratio));
        }
    }
    match most {
        Some((name, ratio)) if ratio > NOTABLE => {
            format!("without it, u of {name} would be {ratio:.2} times as large, and of no other more")
        }
        _ => "without it, no uncertainty would be larger by more than 2 %".to_owned(),
    }
}
