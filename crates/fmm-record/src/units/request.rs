//! Request: quantity and unit of a channel as the caller states them, and those that follow with the file.

use crate::{Label, Meaning, MeaningError, Quantity, WrittenUnit};

/// Quantity and unit of a channel as the caller states them, beside the file. It may be empty where the file tells
/// enough.
///
/// | said | counts |
/// |---|---|
/// | quantity | unless the unit in use, or the file, says another |
/// | unit | if the file writes none, or the same |
/// | scale | with the unit of the scaled numbers, instead of the unit in the file |
///
/// Without a quantity, that of the unit is taken, else that of a word in the name. Without a unit, SI units are taken
/// only if a quantity was said, and never where the name tells of rotation or of a sensor; [`Meaning::is_assumed`]
/// tells of it.
///
/// ```
/// use fmm_record::{Label, Quantity, Request};
///
/// let meaning = Request::default().meaning(&Label::of("vel [mm/s]"))?;
/// assert_eq!((meaning.quantity, meaning.factor, meaning.unit), (Quantity::Velocity, 1e-3, "m/s"));
/// let refused = Request::default().quantity(Quantity::Velocity).meaning(&Label::of("a [m/s^2]")).unwrap_err();
/// assert_eq!(refused.to_string(), "channel \"a [m/s^2]\" is in m/s^2, which is a unit of acceleration, not of velocity");
/// # Ok::<(), fmm_record::MeaningError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Request {
    quantity: Option<Quantity>,
    unit: Option<WrittenUnit>,
    scale: Option<f64>,
}

/// Two factors that differ by less are the same but for their digits.
const SAME_FACTOR: f64 = 1e-9;

impl Request {
    /// Says what the channel measured; [`Quantity::Other`] says nothing.
    #[must_use]
    pub fn quantity(mut self, quantity: Quantity) -> Self {
        self.quantity = (quantity != Quantity::Other).then_some(quantity);
        self
    }

    /// Says the unit of the numbers, or of the scaled numbers if a scale is said as well.
    #[must_use]
    pub fn unit(mut self, unit: WrittenUnit) -> Self {
        self.unit = Some(unit);
        self
    }

    /// Says what the numbers are to be multiplied by to be in the unit said, or in SI units if none is.
    #[must_use]
    pub fn scale(mut self, scale: f64) -> Self {
        self.scale = Some(scale);
        self
    }

    /// The quantity said: by itself, or as that of the unit.
    fn said_quantity(&self) -> Option<Quantity> {
        let of_unit = self.unit.as_ref().map(WrittenUnit::quantity).filter(|quantity| *quantity != Quantity::Other);
        self.quantity.or(of_unit)
    }

    /// Meaning of a channel.
    ///
    /// # Errors
    /// Any [`MeaningError`] but [`MeaningError::WhichChannel`].
    pub fn meaning(&self, label: &Label) -> Result<Meaning, MeaningError> {
        if let (Some(said), Some(unit)) = (self.quantity, &self.unit)
            && unit.quantity() != Quantity::Other
            && unit.quantity() != said
        {
            return Err(MeaningError::Said { unit: unit.to_string(), measured: unit.quantity(), said });
        }
        let channel = || label.name().to_owned();
        let Some((factor, unit)) = self.unit_in_use(label)? else {
            return self.assumed(label);
        };
        let of_unit = Some(unit.quantity()).filter(|quantity| *quantity != Quantity::Other);
        let Some(quantity) = self.quantity.or(of_unit).or_else(|| label.quantity()) else {
            return Err(MeaningError::NoQuantity { channel: channel(), unit: unit.to_string() });
        };
        if let (Some(said), Some(measured)) = (self.quantity, of_unit)
            && said != measured
        {
            return Err(MeaningError::OtherQuantity { channel: channel(), unit: unit.to_string(), measured, said });
        }
        // What the user says stands above a word in a name, but not above what the format states.
        let told =
            label.stated_quantity().or_else(|| label.named_quantity().filter(|_| self.said_quantity().is_none()));
        if let Some(told) = told.filter(|told| *told != quantity) {
            let unit = (self.quantity.is_none() && of_unit.is_some()).then(|| unit.to_string());
            return Err(MeaningError::Contradiction { channel: channel(), told, unit, other: quantity });
        }
        Ok(Meaning { quantity, factor, unit: unit.si(), is_assumed: false })
    }

    /// The unit that was said or is written, and the factor to its SI unit; `None` if there is no unit at all.
    fn unit_in_use<'a>(&'a self, label: &'a Label) -> Result<Option<(f64, &'a WrittenUnit)>, MeaningError> {
        let channel = || label.name().to_owned();
        if let (Some(unit), Some(scale)) = (&self.unit, self.scale) {
            return Ok(Some((scale * unit.factor(), unit)));
        }
        if let Some(unit) = label.unknown_unit() {
            return Err(MeaningError::UnknownUnit { channel: channel(), unit: unit.to_owned() });
        }
        match (&self.unit, self.scale, label.unit()) {
            (Some(said), _, Some(written)) if !said.is_same_as(written) => Err(MeaningError::OtherUnit {
                channel: channel(),
                written: written.to_string(),
                said: said.to_string(),
            }),
            (Some(said), ..) => Ok(Some((said.factor(), said))),
            (None, _, None) => Ok(None),
            (None, _, Some(written)) if written.is_counts() => {
                Err(MeaningError::Counts { channel: channel(), unit: written.to_string() })
            }
            // Volts are the SI unit of no motion: a factor for them is a gain, which leads to another unit.
            (None, Some(scale), Some(written))
                if written.quantity() == Quantity::Other || !((scale / written.factor() - 1.0).abs() < SAME_FACTOR) =>
            {
                Err(MeaningError::ScaleAlone { channel: channel(), written: written.to_string(), scale })
            }
            (None, _, Some(written)) => Ok(Some((written.factor(), written))),
        }
    }

    /// The meaning of a channel without any unit: in SI units, if the user said what it measured.
    fn assumed(&self, label: &Label) -> Result<Meaning, MeaningError> {
        let channel = label.name().to_owned();
        let Some(quantity) = self.quantity.or_else(|| label.quantity()) else {
            return Err(MeaningError::Nothing { channel });
        };
        if let Some(told) = label.stated_quantity().filter(|told| *told != quantity) {
            return Err(MeaningError::Contradiction { channel, told, unit: None, other: quantity });
        }
        let likely = WrittenUnit::of_motion(quantity, label.is_angular()).unwrap_or("N");
        if self.quantity.is_none() || label.needs_unit() {
            return Err(MeaningError::NoUnit { channel, quantity, likely });
        }
        Ok(Meaning { quantity, factor: self.scale.unwrap_or(1.0), unit: likely, is_assumed: true })
    }

    /// Position of the channel that is meant among all channels but the time: the only one, or the one that stands
    /// alone by its unit, else by a word in its name, else by being the only one of which nothing is known.
    ///
    /// With a quantity or a unit said, that is looked for; otherwise a velocity, then a displacement.
    ///
    /// # Errors
    /// [`MeaningError::WhichChannel`] if several are alike, or none of several is one.
    pub fn choose(&self, labels: &[Label]) -> Result<usize, MeaningError> {
        let said = self.said_quantity();
        let alike = |is_meant: &dyn Fn(&Label) -> bool| -> Vec<usize> {
            labels.iter().enumerate().filter(|(_, label)| is_meant(label)).map(|(index, _)| index).collect()
        };
        let by_unit = |quantity| alike(&|label: &Label| label.quantity_of_unit() == Some(quantity));
        let by_word = |quantity| alike(&|label: &Label| label.quantity() == Some(quantity));
        // With a scale, the unit said is not that of the file.
        let same_unit = || match (&self.unit, self.scale) {
            (Some(said), None) => alike(&|label: &Label| label.unit().is_some_and(|unit| unit.is_same_as(said))),
            _ => Vec::new(),
        };
        let is_open = |label: &Label| label.quantity().is_none();
        let mut found = if labels.len() == 1 { vec![0] } else { same_unit() };
        if found.len() > 1 {
            found.clear();
        }
        let wanted = match said {
            Some(said) => vec![said],
            None => vec![Quantity::Velocity, Quantity::Displacement],
        };
        for by in [&by_unit as &dyn Fn(Quantity) -> Vec<usize>, &by_word] {
            for quantity in &wanted {
                if found.is_empty() {
                    found = by(*quantity);
                }
            }
        }
        if found.is_empty() && said.is_some() {
            found = alike(&is_open);
        }
        match found[..] {
            [index] => Ok(index),
            _ => Err(MeaningError::WhichChannel { said, channels: labels.iter().map(Label::to_string).collect() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Quantity::{Acceleration, Displacement, Velocity};

    fn nothing() -> Request {
        Request::default()
    }

    fn unit(text: &str) -> Request {
        Request::default().unit(text.parse().unwrap())
    }

    fn of(request: &Request, name: &str) -> (Quantity, f64, &'static str, bool) {
        let meaning = request.meaning(&Label::of(name)).unwrap_or_else(|error| panic!("{error}"));
        (meaning.quantity, meaning.factor, meaning.unit, meaning.is_assumed)
    }

    fn refusal(request: &Request, name: &str) -> MeaningError {
        let meaning = request.meaning(&Label::of(name));
        meaning.err().unwrap_or_else(|| panic!("{name} was taken as {}", request.meaning(&Label::of(name)).unwrap()))
    }

    #[test]
    fn the_quantity_follows_from_the_unit_or_else_from_a_word() {
        assert_eq!(of(&nothing(), "v [mm/s]"), (Velocity, 1e-3, "m/s", false));
        assert_eq!(of(&nothing(), "x [m]"), (Displacement, 1.0, "m", false));
        assert_eq!(of(&nothing(), "a [m/s^2]"), (Acceleration, 1.0, "m/s²", false));
        assert_eq!(of(&nothing(), "a [g]"), (Acceleration, 9.806_65, "m/s²", false));
        assert_eq!(of(&nothing(), "gyro [mV]"), (Velocity, 1e-3, "V", false));
        assert_eq!(of(&unit("rad/s"), "angular_velocity"), (Velocity, 1.0, "rad/s", false));
        assert_eq!(of(&unit("deg/s"), "data").0, Velocity);
        assert_eq!(of(&unit("V"), "gyro"), (Velocity, 1.0, "V", false));
        assert_eq!(of(&nothing(), "encoder [deg/s]").0, Velocity, "a unit overrules a sensor");
        let stated = Label::of("3+Z").with_unit("V").with_quantity(Velocity);
        assert_eq!(nothing().meaning(&stated).unwrap().quantity, Velocity);
    }

    #[test]
    fn what_is_said_counts_where_the_file_is_silent() {
        let velocity = nothing().quantity(Velocity);
        assert_eq!(of(&velocity, "data"), (Velocity, 1.0, "m/s", true));
        assert_eq!(of(&velocity, "velocity"), (Velocity, 1.0, "m/s", true));
        assert_eq!(of(&nothing().quantity(Displacement).scale(2.0), "x"), (Displacement, 2.0, "m", true));
        assert_eq!(of(&nothing().quantity(Displacement), "x [mm]"), (Displacement, 1e-3, "m", false));
        assert_eq!(of(&velocity, "ch1 [V]"), (Velocity, 1.0, "V", false));
        assert_eq!(of(&unit("mm/s"), "data"), (Velocity, 1e-3, "m/s", false));
        assert_eq!(of(&unit("mm/s").scale(2.0), "data"), (Velocity, 2e-3, "m/s", false));
        assert_eq!(of(&unit("rad"), "theta_rad"), (Displacement, 1.0, "rad", false));
        assert_eq!(of(&unit("counts").quantity(Displacement), "encoder_counts"), (Displacement, 1.0, "counts", false));
        assert_eq!(of(&velocity.clone().quantity(Quantity::Other).unit("m/s".parse().unwrap()), "v").0, Velocity);
        // A word in the name is no unit.
        assert_eq!(of(&nothing().quantity(Displacement), "velocity").0, Displacement);
    }

    #[test]
    fn a_scale_and_a_unit_stand_above_those_of_the_file() {
        let small = unit("rad").scale(1.570_796_3e-4).quantity(Displacement);
        assert_eq!(of(&small, "encoder_counts"), (Displacement, 1.570_796_3e-4, "rad", false));
        assert_eq!(of(&unit("m/s").scale(0.5), "a [m/s^2]"), (Velocity, 0.5, "m/s", false));
        assert_eq!(of(&unit("m/s").scale(0.5), "disp [mm]"), (Velocity, 0.5, "m/s", false));
        assert_eq!(of(&unit("m/s").scale(0.5), "v [knots]"), (Velocity, 0.5, "m/s", false));
        assert_eq!(of(&nothing().scale(1e-3), "v [mm/s]"), (Velocity, 1e-3, "m/s", false));
        assert!(matches!(refusal(&nothing().scale(1.0), "v [mm/s]"), MeaningError::ScaleAlone { .. }));
        assert!(matches!(refusal(&nothing().scale(f64::NAN), "v [mm/s]"), MeaningError::ScaleAlone { .. }));
        assert!(matches!(refusal(&nothing().scale(1.0).quantity(Velocity), "v [V]"), MeaningError::ScaleAlone { .. }));
    }

    #[test]
    fn contradictions_are_refused_with_both_sides() {
        let velocity = nothing().quantity(Velocity);
        let said = |request: &Request, name: &str| refusal(request, name).to_string();
        assert_eq!(
            said(&velocity, "x [mm]"),
            "channel \"x [mm]\" is in mm, which is a unit of displacement, not of velocity"
        );
        assert!(matches!(refusal(&velocity, "a [g]"), MeaningError::OtherQuantity { measured: Acceleration, .. }));
        assert_eq!(said(&unit("rad"), "theta [deg]"), "channel \"theta [deg]\" is in deg, not in rad");
        assert_eq!(said(&unit("m/s"), "v [mm/s]"), "channel \"v [mm/s]\" is in mm/s, not in m/s");
        assert!(matches!(refusal(&unit("m/s"), "gyro [V]"), MeaningError::OtherUnit { .. }));
        assert_eq!(
            said(&velocity.clone().unit("mm".parse().unwrap()), "v"),
            "mm is a unit of displacement, not of velocity"
        );
        assert_eq!(
            said(&nothing(), "velocity [mm]"),
            "the file says that channel \"velocity [mm]\" is a record of velocity, but mm is a unit of displacement"
        );
        assert_eq!(of(&nothing().quantity(Displacement), "velocity [mm]").0, Displacement, "the user has decided");
        let stated = Label::of("3+Z").with_unit("m/s^2").with_quantity(Acceleration);
        assert!(matches!(velocity.meaning(&stated), Err(MeaningError::OtherQuantity { .. })));
        let stated = Label::of("3+Z").with_quantity(Acceleration);
        assert_eq!(
            velocity.meaning(&stated).unwrap_err().to_string(),
            "the file says that channel \"3+Z\" is a record of acceleration, but it was said to be one of velocity"
        );
        let scaled = unit("m/s").scale(2.0).meaning(&stated);
        assert!(matches!(scaled, Err(MeaningError::Contradiction { told: Acceleration, other: Velocity, .. })));
    }

    #[test]
    fn what_would_be_a_guess_is_refused() {
        let velocity = nothing().quantity(Velocity);
        assert!(matches!(refusal(&nothing(), "data"), MeaningError::Nothing { .. }));
        assert!(matches!(refusal(&nothing().scale(2.0), "v"), MeaningError::Nothing { .. }));
        let no_unit = |request: &Request, name: &str| match refusal(request, name) {
            MeaningError::NoUnit { quantity, likely, .. } => (quantity, likely),
            other => panic!("{other}"),
        };
        assert_eq!(no_unit(&nothing(), "velocity"), (Velocity, "m/s"));
        assert_eq!(no_unit(&nothing(), "angular_velocity"), (Velocity, "rad/s"));
        assert_eq!(no_unit(&velocity, "angular_velocity"), (Velocity, "rad/s"));
        assert_eq!(no_unit(&nothing().scale(1e-3), "velocity"), (Velocity, "m/s"));
        assert_eq!(no_unit(&nothing(), "theta"), (Displacement, "rad"));
        assert_eq!(no_unit(&nothing().quantity(Displacement), "encoder"), (Displacement, "m"));
        assert_eq!(no_unit(&nothing(), "force"), (Quantity::Force, "N"));
        assert!(matches!(refusal(&nothing(), "ch1 [V]"), MeaningError::NoQuantity { .. }));
        assert!(matches!(refusal(&unit("V"), "ch1"), MeaningError::NoQuantity { .. }));
        assert!(matches!(refusal(&nothing(), "encoder_counts"), MeaningError::Counts { .. }));
        assert!(matches!(
            refusal(&nothing().quantity(Displacement).scale(2.0), "encoder_counts"),
            MeaningError::Counts { .. }
        ));
        for request in [nothing(), velocity, unit("m/s"), nothing().scale(0.5)] {
            assert!(matches!(refusal(&request, "v [knots]"), MeaningError::UnknownUnit { .. }));
        }
    }

    #[test]
    fn the_channel_that_stands_alone_is_chosen() {
        let choose = |request: &Request, names: &[&str]| {
            request.choose(&names.iter().map(|name| Label::of(name)).collect::<Vec<_>>()).ok()
        };
        let (velocity, displacement) = (nothing().quantity(Velocity), nothing().quantity(Displacement));
        assert_eq!(choose(&nothing(), &["anything"]), Some(0));
        assert_eq!(choose(&nothing(), &["disp [mm]", "vel [mm/s]"]), Some(1));
        assert_eq!(choose(&displacement, &["disp [mm]", "vel [mm/s]"]), Some(0));
        assert_eq!(choose(&unit("mm"), &["vel [mm/s]", "disp [mm]"]), Some(1));
        assert_eq!(choose(&nothing(), &["theta_rad", "omega_rad_per_s"]), Some(1));
        assert_eq!(choose(&nothing(), &["F [N]", "x [mm]", "note"]), Some(1), "the only motion");
        assert_eq!(choose(&nothing(), &["angular_velocity", "angle [deg]"]), Some(1), "a unit says more than a word");
        assert_eq!(choose(&nothing(), &["temperature [degC]", "gyro [V]"]), Some(1));
        assert_eq!(choose(&unit("V").quantity(Velocity), &["a", "b [V]", "c [mV]"]), Some(1));
        assert_eq!(choose(&unit("rad").scale(1e-4), &["temperature", "encoder_counts"]), Some(1));
        assert_eq!(choose(&displacement, &["x", "a [m/s^2]"]), Some(0), "the only one that is open");
        assert_eq!(choose(&nothing(), &["v1 [m/s]", "v2 [m/s]"]), None);
        assert_eq!(choose(&velocity, &["v1 [m/s]", "v2 [m/s]", "v3"]), None);
        assert_eq!(choose(&unit("m/s"), &["v1 [m/s]", "v2 [mm/s]"]), Some(0));
        assert_eq!(choose(&unit("m/s").scale(1.0), &["v1 [m/s]", "v2 [mm/s]"]), None);
        assert_eq!(choose(&unit("V").quantity(Velocity), &["gyro [V]", "encoder [V]"]), Some(0));
        assert_eq!(choose(&nothing(), &["x", "y"]), None);
        assert_eq!(choose(&velocity, &["x", "y"]), None);
        assert_eq!(choose(&nothing(), &["x", "a [m/s^2]"]), None);
        assert_eq!(choose(&velocity, &["x [m]", "a [m/s^2]"]), None);
        assert_eq!(choose(&nothing(), &[]), None);
        let error = velocity.choose(&[Label::of("v1 [m/s]"), Label::of("v2 [mm/s]")]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "it is not clear which channel is the velocity; there are: \"v1 [m/s]\" (velocity in m/s), \
             \"v2 [mm/s]\" (velocity in mm/s)"
        );
    }

    #[test]
    fn a_meaning_says_what_was_taken_for_granted() {
        let meaning = |request: &Request, name: &str| request.meaning(&Label::of(name)).unwrap().to_string();
        assert_eq!(meaning(&nothing(), "v [m/s]"), "velocity in m/s");
        assert_eq!(meaning(&nothing(), "v [mm/s]"), "velocity in m/s after a factor of 0.001");
        assert_eq!(meaning(&nothing().quantity(Displacement), "x"), "displacement, taken to be in m");
    }
}
