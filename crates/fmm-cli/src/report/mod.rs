//! The report of one record as a page: what was found, how sure it is, and how it was made.

mod budget;
mod found;
mod profiles;

use std::error::Error;

use fmm_fit::{EstimateStatus, autocorrelation};
use fmm_frf::{Backbone, BackboneOptions};
use fmm_identify::{Finding, FittedMotion, Identification, Origin};
use fmm_model::{Rounded, coverage_factor};
use sha2::{Digest, Sha256};

use self::budget::budget;
pub(crate) use self::found::{Curve, Found, Pictures};
use self::profiles::profiles;
use crate::answer::{Answer, Detail};
use crate::backbone;
use crate::figure::{Panel, Role, drawn, histogram, label};
use crate::output::of_size;
use crate::page::{bullets, cell, escaped, figure, optional_cell, page, row_heading, section, table, text_cell, words};

/// Coverage probability of intervals (1).
const LEVEL: f64 = 0.95;
/// Periods over which residuals are correlated with themselves, and points drawn of that.
const PERIODS: f64 = 2.0;
const LAGS: usize = 300;

/// The page on what was `found` in a record. The same input makes the same page.
pub(crate) fn document(found: &Found) -> Result<String, Box<dyn Error>> {
    let Found { origin, decays, comparison, posterior, .. } = found;
    let name = |origin: &str| origin.split(", channel").next().unwrap_or(origin).to_owned();
    let name = origin.lines().map(name).collect::<Vec<_>>().join(", ");
    let described = origin.lines().zip(decays).map(|(origin, decay)| format!("{origin}. {}", decay.summary()));
    let described: Vec<String> = described.map(|text| format!("<p>{}.</p>\n", escaped(&text))).collect();
    let pictures = Pictures::of(found)?;
    let json = found.document(Detail::Brief)?;
    let title = format!("Friction of {name}");
    let body = [
        format!("<h1>{}</h1>\n<p class=\"verdict\">{}</p>\n", escaped(&title), escaped(&comparison.headline())),
        described.concat(),
        section("Findings", &findings(found)),
        posterior.as_ref().map_or_else(String::new, |posterior| section("Posterior", &posterior.html())),
        friction_curve(found),
        section("Limits", &warnings(found)),
        section(
            "Record and fit",
            &figure(
                &drawn(&pictures.fit),
                "Above: the record, and the motion that is fitted to it. Below: what is left over.",
                "fit",
            ),
        ),
        section("Sources of uncertainty", &budget(comparison.preferred())),
        section("Profiles", &profiles(found)?),
        section("Laws", &laws(found)),
        section("Residuals", &residuals(found, &pictures)),
        amplitude(found, &pictures),
        section("How this was made", &making(found)),
        // What looks like the end of a script ends it, wherever it stands.
        format!("<script type=\"application/json\" id=\"result\">{}</script>\n", json.replace('<', "\\u003c")),
    ];
    Ok(page(&title, &body.concat()))
}

/// Each quantity with its standard uncertainty, and expanded as the GUM asks.
fn findings(found: &Found) -> String {
    let row = |finding: &Finding| {
        let parameter = finding.parameter();
        let (value, u) = (finding.value(), finding.uncertainty());
        let rounded = Rounded::new(value, u);
        let freedom = finding.degrees_of_freedom();
        let factor = coverage_factor(LEVEL, freedom);
        let interval = finding.interval(LEVEL).map(|(low, high)| rounded.interval(low, high));
        let expanded = u.zip(factor).map(|(u, k)| of_size(k * u));
        let origin = match finding.origin() {
            Origin::Fitted(EstimateStatus::Fixed) => "held",
            Origin::Fitted(EstimateStatus::Undetermined) => "not determined",
            Origin::Fitted(status) if status.is_at_bound() => "at its bound",
            Origin::Fitted(_) => "fitted",
            _ => "derived",
        };
        vec![
            row_heading(&words(parameter.name())),
            text_cell(&rounded.to_string()),
            text_cell(parameter.unit()),
            optional_cell(interval),
            optional_cell(factor.filter(|_| u.is_some()).map(|k| format!("{k:.2}"))),
            optional_cell(expanded),
            optional_cell(u.map(|_| if freedom < 1e5 { format!("{freedom:.0}") } else { "∞".to_owned() })),
            cell(origin),
        ]
    };
    let headings = ["quantity", "value ± u", "unit", "95 % interval", "k", "U = k u", "ν", "origin"];
    let preferred = found.comparison.preferred();
    format!(
        "<p>By the law {}. u is a standard uncertainty with ν degrees of freedom, U the expanded uncertainty for a \
         coverage probability of 95 % with the coverage factor k (JCGM 100:2008, clauses 6 and G.4).</p>\n{}",
        escaped(preferred.law()),
        table("findings", &headings, preferred.findings().iter().map(row))
    )
}

/// Friction over the speed without a law, if it was looked for.
fn friction_curve(found: &Found) -> String {
    let content = match &found.curve {
        None => return String::new(),
        Some(Curve::Missing { missing }) => format!("<p>It cannot be had: {}.</p>\n", escaped(missing)),
        Some(Curve::Found(curve)) => {
            let sentences = std::iter::once(curve.headline()).chain(curve.doubts().map(ToOwned::to_owned));
            let text = format!("<p>{}.</p>\n", escaped(&sentences.collect::<Vec<_>>().join("; ")));
            let caption = "Grey: friction over the speed, no law assumed, with its 95 % intervals at each speed. Dark: \
                           95 % intervals for the whole curve. Red: the preferred law.";
            found
                .curve_panels()
                .map_or(text.clone(), |panels| text + &figure(&drawn(&panels), caption, "friction_curve"))
        }
    };
    section("Friction over speed", &content)
}

fn warnings(found: &Found) -> String {
    let list = bullets(found.comparison.warnings().iter().map(ToString::to_string));
    if list.is_empty() { "<p>None was found.</p>\n".to_owned() } else { list }
}

/// The laws that were tried.
fn laws(found: &Found) -> String {
    let comparison = &found.comparison;
    let best = comparison.scores().iter().copied().fold(f64::INFINITY, f64::min);
    let standings = comparison.scores().iter().zip(comparison.p_values());
    let is_excluded = |law: &Identification| !comparison.not_excluded().any(|left| std::ptr::eq(left, law));
    let rows = comparison.identifications().iter().zip(standings).map(|(law, (score, p))| {
        let stop = law.motions().iter().find_map(FittedMotion::stop_time);
        vec![
            row_heading(law.law()),
            text_cell(&format!("{:.4e}", law.rms_residual())),
            text_cell(&law.fit().rank().to_string()),
            text_cell(&law.motions().iter().map(FittedMotion::half_swings).sum::<usize>().to_string()),
            optional_cell(stop.map(|time| format!("{time:.4}"))),
            text_cell(&format!("{:.1}", score - best)),
            if is_excluded(law) { cell("excluded") } else { text_cell(&format!("{p:.3}")) },
        ]
    });
    let unit = found.decays[0].record().unit();
    let rms = label("rms residual", unit);
    let headings = ["law", &rms, "rank", "half swings", "rest from / s", "misfit + 2 rank", "p"];
    table("laws", &headings, rows)
}

fn residuals(found: &Found, pictures: &Pictures) -> String {
    let unit = found.decays[0].record().unit();
    let histogram = histogram(&label("residual", unit), "residuals", &pictures.residuals);
    let summary = found.decays[0].summary();
    let count = pictures.residuals.len();
    let last = ((PERIODS * summary.rate / summary.frequency) as usize).clamp(1, count.saturating_sub(1).max(1));
    let correlation = |lag: usize| Some((lag as f64 / summary.rate, autocorrelation(&pictures.residuals, lag)?));
    let points = (1..=last).step_by(last.div_ceil(LAGS)).filter_map(correlation);
    let of_noise = 1.96 / (count as f64).sqrt();
    let ends = |value: f64| [(0.0, value), (last as f64 / summary.rate, value)];
    let panel = Panel::new("lag / s", "autocorrelation", 260.0)
        .with(Role::Residual, "residuals", points)
        .with(Role::Reference, "95 % of white noise", ends(of_noise))
        .with(Role::Reference, "", ends(-of_noise));
    figure(
        &histogram,
        "The distribution of the residuals, with the normal density of the same mean and deviation.",
        "histogram",
    ) + &figure(&drawn(&[panel]), "How the residuals go with themselves at a later time.", "autocorrelation")
}

/// The amplitudes, and the backbone if the record shows one.
fn amplitude(found: &Found, pictures: &Pictures) -> String {
    if found.decays[0].summary().is_run_down {
        return String::new();
    }
    let amplitudes =
        figure(&drawn(&pictures.amplitude), "The amplitude of each half swing, measured and fitted.", "amplitude");
    let record = &*found.decays[0].record().equally_spaced();
    let backbone = Backbone::of(record, &BackboneOptions::default()).ok().filter(|_| found.decays[0].drive().is_none());
    let backbone = backbone.map_or_else(String::new, |backbone| {
        let suggestion = backbone.suggestion();
        let caption = format!(
            "Without a law: the spectrum, the envelope of the strongest mode, and its frequency and equivalent damping \
             against the amplitude, with {suggestion}."
        );
        figure(&drawn(&backbone::panels(record, &backbone, &suggestion)), &caption, "backbone")
    });
    section("Amplitude", &(amplitudes + &backbone))
}

/// SHA-256 of `bytes` in hexadecimal digits.
pub(crate) fn digest(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>().concat()
}

/// Version, command, input.
fn making(found: &Found) -> String {
    let entries = [
        ("Program", format!("fmm {}", env!("CARGO_PKG_VERSION"))),
        ("Command", found.command.clone()),
        ("Input", found.origin.clone()),
        ("SHA-256 of the input", found.sha256.clone()),
        ("Result for programs", "one JSON document in the element with the id \"result\" of this file".to_owned()),
    ];
    let entries = entries.map(|(name, text)| format!("<dt>{name}</dt><dd><code>{}</code></dd>", escaped(&text)));
    format!("<dl>{}</dl>\n", entries.concat())
}

#[cfg(test)]
mod tests {
    use fmm_friction::Viscous;
    use fmm_identify::{Candidate, Experiment, Machine, Preparation, compare};
    use fmm_model::Oscillator;
    use fmm_record::{Quantity, Record};
    use fmm_sim::{Engine, Exact, Sampling, Scenario};

    use super::*;

    /// The page has the findings, holds its own result, needs no network, is the same each time, and lets no text in as
    /// HTML.
    #[test]
    fn a_page_is_whole() {
        let scenario = Scenario::new(Oscillator::per_unit_mass(2.0).unwrap(), Viscous::new(0.3).unwrap(), 1.0).unwrap();
        let motion =
            Exact.run(&scenario.starting_at(0.02, 0.0).unwrap(), &Sampling::uniform(5e-3, 1000).unwrap()).unwrap();
        let noisy = |(i, v): (usize, &f64)| v + 1e-4 * ((i * i % 1009) as f64 / 504.5 - 1.0);
        let values = motion.velocity().values().iter().enumerate().map(noisy).collect();
        let record = Record::sampled(200.0, values, Quantity::Velocity, "m/s").unwrap();
        let decay = Experiment::ring_down(&record, &Preparation::default()).unwrap();
        let comparison =
            compare(&Machine::per_unit_mass(), std::slice::from_ref(&decay), &Candidate::standard()).unwrap();
        let damping = comparison.preferred().finding("damping_per_mass").unwrap();
        let (value, u) = (damping.value(), damping.uncertainty().unwrap());
        let k = coverage_factor(LEVEL, damping.degrees_of_freedom()).unwrap();
        let found = Found {
            origin: "<script>.csv, channel v: \"velocity\"".to_owned(),
            decays: vec![decay],
            comparison,
            curve: None,
            posterior: None,
            remarks: Vec::new(),
            declared: std::collections::BTreeMap::new(),
            failure: None,
            command: "fmm identify <script>.csv".to_owned(),
            sha256: digest(b"abc"),
        };
        let page = document(&found).unwrap();
        assert_eq!(page, document(&found).unwrap());
        assert!(page.contains(&Rounded::new(value, Some(u)).to_string()) && !page.contains("http"));
        assert!(page.contains(&format!("<td class=\"number\">{k:.2}</td>")) && k < 2.0, "{k}");
        // SHA-256 of "abc", as FIPS 180-2 prints it.
        assert!(page.contains("ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"));
        assert!(page.contains("&lt;script&gt;.csv") && !page.contains("<script>"));
        for section in [
            "Findings",
            "Limits",
            "Record and fit",
            "Sources of uncertainty",
            "Profiles",
            "Laws",
            "Residuals",
            "Amplitude",
            "How this was made",
        ] {
            assert!(page.contains(&format!("<h2>{section}</h2>")), "{section}");
        }
        let (_, json) = page.split_once("id=\"result\">").unwrap();
        let json: serde_json::Value = serde_json::from_str(json.split_once("</script>").unwrap().0).unwrap();
        assert_eq!(json["preferred"], found.comparison.preferred().law());
        // A budget that is all noise, and intervals that are as long on both sides.
        assert!(page.contains("(100 %)") && page.contains("no profile is drawn"));
    }
}
