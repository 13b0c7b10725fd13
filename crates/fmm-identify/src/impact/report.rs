//! The report of an identification from blows, on one screen.

use std::fmt;

use crate::finding::name_width;
use crate::impact::{ImpactDomain, ImpactIdentification};
use crate::warning::write_warnings;

impl fmt::Display for ImpactDomain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Mobility => "mobility",
            Self::Time => "time record",
            Self::Both => "mobility and time record",
        })
    }
}

impl fmt::Display for ImpactIdentification {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fit = self.fit();
        writeln!(f, "Blows by the law {}, fitted to the {}", self.law(), self.options().domain())?;
        writeln!(
            f,
            "  {}; {} residuals, rank {} of {}, rms residual {:.4e} m/s, χ = {:.2}",
            fit.outcome(),
            fit.residuals().len(),
            fit.rank(),
            fit.free_count(),
            self.rms_residual(),
            self.chi(),
        )?;
        let width = name_width(self.findings());
        for finding in self.findings() {
            let name = finding.parameter().name();
            write!(f, "  {name:<width$} = {finding}")?;
            if let Some((low, high)) = self.interval(name, 0.95) {
                // To the second digit of its width.
                let digits = (1.0 - (0.5 * (high - low)).log10().floor()).clamp(0.0, 15.0) as usize;
                write!(f, ", 95 % from {low:.digits$} to {high:.digits$}")?;
            }
            writeln!(f)?;
        }
        writeln!(f, "\nTrials  impulse                half swings  at rest     closed form")?;
        for (number, ((summary, motion), force)) in
            self.trials().iter().zip(self.motions()).zip(self.closed_forms()).enumerate()
        {
            let rest = motion.stop_time().map_or_else(|| "-".to_owned(), |time| format!("{time:.4} s"));
            let force = force.map_or_else(|| "-".to_owned(), |force| format!("{force:.4} N"));
            let impulse = format!("{} N s", summary.impulse);
            writeln!(f, "  {:<4}  {impulse:<21}  {:>11}  {rest:<10}  {force}", number + 1, motion.half_swings())?;
        }
        write_warnings(f, self.warnings())
    }
}
