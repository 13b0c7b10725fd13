//! Results that no machine has, and the units that would make them plausible.

use fmm_model::Rounded;

use crate::warning::Warning;

/// Largest coefficient of friction that is believed (1). Dry contacts of tables reach 1.5 (rubber on concrete 0.6 to
/// 1.0, aluminium on aluminium 1.05 to 1.35; Avallone and Baumeister, Marks' Standard Handbook, table 3.2.1), clean
/// metals in vacuum about 2 to 3 before they seize.
const LARGEST_MU: f64 = 3.0;

/// Frequencies of machines that are let swing (Hz): a mooring sways with periods of some 50 s, beyond 20 kHz no table
/// vibrometer or accelerometer of a laboratory is specified.
const FREQUENCIES: (f64, f64) = (0.02, 20e3);

/// Share of the weight of the moving mass below which a normal load is doubted if the coefficient is (1): a power of
/// ten.
const SMALL_LOAD: f64 = 0.1;

/// Standard gravity (m/s²).
const GRAVITY: f64 = 9.806_65;

/// Units that times may be in when seconds were read, with their seconds; what loggers and spreadsheets write first.
const TIMES: [(&str, f64); 6] =
    [("ms", 1e-3), ("days", 86_400.0), ("us", 1e-6), ("ns", 1e-9), ("min", 60.0), ("h", 3600.0)];

/// Frequencies (Hz) that make a unit of time likely.
const LIKELY: (f64, f64) = (0.1, 2e3);

impl Warning {
    /// Numbers that no machine has: a frequency (Hz), or a coefficient `mu` of a contact under a `load` (N) that brakes
    /// a `mass` (kg).
    pub(crate) fn of_plausibility(
        frequency: Option<f64>,
        mu: Option<f64>,
        load: Option<f64>,
        mass: Option<f64>,
    ) -> Option<Self> {
        let (lowest, highest) = FREQUENCIES;
        if let Some(frequency) = frequency.filter(|frequency| !(lowest..=highest).contains(frequency)) {
            let (least, most) = LIKELY;
            let unit = TIMES.into_iter().find(|(_, seconds)| (least..=most).contains(&(frequency / seconds)));
            let remedy = match unit {
                Some((unit, seconds)) => {
                    format!(
                        "if its times are in {unit}, it has {} Hz; say their unit",
                        Rounded::significant(frequency / seconds, 3)
                    )
                }
                None => "look at the unit of its times, or at the rate".to_owned(),
            };
            return Some(Self::Implausible { number: format!("{} Hz", Rounded::significant(frequency, 3)), remedy });
        }
        let mu = mu.filter(|mu| *mu > LARGEST_MU)?;
        let weight = mass.map(|mass| GRAVITY * mass);
        let small = load.zip(weight).filter(|(load, weight)| *load < SMALL_LOAD * weight);
        let unit =
            [("thousandths", 1e-3), ("millionths", 1e-6)].into_iter().find(|(_, factor)| factor * mu <= LARGEST_MU);
        let unit = unit.map(|(unit, factor)| {
            format!(
                "if its numbers are {unit} of the unit that they were read in, mu is {}",
                Rounded::significant(factor * mu, 3)
            )
        });
        let load = small.map(|(load, weight)| {
            let [load, weight] = [load, weight].map(|force| Rounded::significant(force, 3));
            format!(
                "the normal load of {load} N is little beside the weight of {weight} N that moves: look at both units"
            )
        });
        let remedy: Vec<String> = unit.into_iter().chain(load).collect();
        let remedy = if remedy.is_empty() { "look at the units".to_owned() } else { remedy.join("; ") };
        Some(Self::Implausible { number: format!("mu = {}", Rounded::significant(mu, 3)), remedy })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_no_machine_has_are_told_with_the_unit_that_would_be_right() {
        let said = |frequency: f64, mu: f64, load: f64| {
            let found = Warning::of_plausibility(Some(frequency), Some(mu), Some(load), Some(10.0));
            found.map_or_else(String::new, |warning| warning.to_string())
        };
        for (frequency, mu, load, words) in [
            (0.002_25, 2.5e-4, 5.0, "if its times are in ms, it has 2.25 Hz"),
            (194_467.0, 21_383.0, 5.0, "if its times are in days, it has 2.25 Hz"),
            (2.25, 198.0, 50.0, "if its numbers are thousandths of the unit that they were read in, mu is 0.198"),
            (2.25, 198.0, 5.0, "the normal load of 5 N is little beside the weight of 98.1 N"),
            (1e9, 1.0, 50.0, "look at the unit of its times"),
        ] {
            assert!(said(frequency, mu, load).contains(words), "{}", said(frequency, mu, load));
        }
        assert_eq!(said(2.25, 0.2, 5.0) + &said(0.021, 2.9, 5.0) + &said(19e3, 0.1, 50.0), "");
        assert_eq!(Warning::of_plausibility(None, None, None, None), None);
    }
}
