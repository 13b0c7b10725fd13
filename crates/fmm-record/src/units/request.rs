//! Request: quantity and unit of a channel as the caller declares them, and the meaning that follows with the file.

use crate::error::{RecordError, listed};
use crate::units::label::Label;
use crate::units::{Quantity, WrittenUnit, unit_of_motion};

/// Meaning of the numbers of a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Meaning {
    /// Measured quantity; never [`Quantity::Other`].
    pub quantity: Quantity,
    /// Factor from its numbers to the unit below (that unit per unit of the file).
    pub factor: f64,
    /// The unit of the numbers times the factor: the SI unit, or `counts`.
    pub unit: &'static str,
    /// True if this unit is written nowhere, but taken as the SI unit of the declared quantity.
    pub is_assumed: bool,
}

/// Text such as `velocity in m/s`.
impl std::fmt::Display for Meaning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let taken = if self.is_assumed { ", taken to be" } else { "" };
        write!(f, "{}{taken} in {}", self.quantity, self.unit)?;
        if self.factor == 1.0 { Ok(()) } else { write!(f, " after a factor of {}", self.factor) }
    }
}

/// Quantity and unit of a channel as the caller declares them, beside the file. It may be empty if the file states
/// enough.
///
/// | declared | counts |
/// |---|---|
/// | quantity | unless the unit in use, or the file, contradicts |
/// | unit | if the file writes none, or the same |
/// | scale | with the unit of the scaled numbers, instead of the unit in the file |
///
/// Without a quantity, that of the unit is taken, else that of a word in the name. Without a unit, SI units are taken
/// only for a declared quantity, and never if the name has a word for rotation or for a sensor;
/// [`Meaning::is_assumed`] is true then.
///
/// ```
/// use fmm_record::{Label, Quantity, Request};
///
/// let meaning = Request::default().meaning(&Label::of("vel [mm/s]"))?;
/// assert_eq!((meaning.quantity, meaning.factor, meaning.unit), (Quantity::Velocity, 1e-3, "m/s"));
/// let refused = Request::default().quantity(Quantity::Velocity).meaning(&Label::of("a [m/s^2]")).unwrap_err();
/// assert_eq!(refused.to_string(), "channel \"a [m/s^2]\" is in m/s^2, which is a unit of acceleration, not of velocity");
/// # Ok::<(), fmm_record::RecordError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Request {
    quantity: Option<Quantity>,
    unit: Option<WrittenUnit>,
    scale: Option<f64>,
}

/// Largest relative difference of two factors that differ by their last digits only (1).
const SAME_FACTOR: f64 = 1e-9;

impl Request {
    /// Declares the measured quantity; [`Quantity::Other`] declares none.
    #[must_use]
    pub fn quantity(mut self, quantity: Quantity) -> Self {
        self.quantity = (quantity != Quantity::Other).then_some(quantity);
        self
    }

    /// Declares the unit of the numbers, or of the scaled numbers if there is a scale.
    #[must_use]
    pub fn unit(mut self, unit: WrittenUnit) -> Self {
        self.unit = Some(unit);
        self
    }

    /// Declares the factor that turns the numbers into the declared unit, or into SI units if there is none.
    #[must_use]
    pub fn scale(mut self, scale: f64) -> Self {
        self.scale = Some(scale);
        self
    }

    /// The declared quantity: by itself, or by the unit.
    fn declared_quantity(&self) -> Option<Quantity> {
        self.quantity.or(self.unit.as_ref().and_then(WrittenUnit::shown_quantity))
    }

    /// Meaning of a channel.
    ///
    /// # Errors
    /// [`RecordError::Unclear`] if a statement is missing or not known, [`RecordError::Contradiction`] if two exclude
    /// each other. Both come with their remedy.
    pub fn meaning(&self, label: &Label) -> Result<Meaning, RecordError> {
        if let (Some(declared), Some(unit)) = (self.quantity, &self.unit)
            && let Some(measured) = unit.shown_quantity().filter(|measured| *measured != declared)
        {
            let what = format!("{unit} is a unit of {measured}, not of {declared}");
            return Err(RecordError::contradiction(what, format!("give `quantity` {measured}, or another `unit`")));
        }
        let channel = label.name();
        let Some((factor, unit)) = self.unit_in_use(label)? else {
            return self.assumed(label);
        };
        let of_unit = unit.shown_quantity();
        let Some(quantity) = self.quantity.or(of_unit).or_else(|| label.quantity()) else {
            let what = format!("channel \"{channel}\" is in {unit}, which does not tell what it measured");
            let remedy = "give `quantity` velocity, `quantity` displacement or `quantity` acceleration";
            return Err(RecordError::unclear(what, remedy));
        };
        if let Some(measured) = of_unit.filter(|measured| *measured != quantity) {
            let what = format!("channel \"{channel}\" is in {unit}, which is a unit of {measured}, not of {quantity}");
            let remedy =
                format!("leave out `quantity` {quantity}, choose another `channel`, or give both `scale` and `unit`");
            return Err(RecordError::contradiction(what, remedy));
        }
        // A declared quantity stands above a word in a name, but not above the statement of the format.
        let is_named = !label.word.is_sensor && self.declared_quantity().is_none();
        let stated = label.stated_quantity().or(label.word.quantity.filter(|_| is_named));
        if let Some(stated) = stated.filter(|stated| *stated != quantity) {
            let unit = (self.quantity.is_none() && of_unit.is_some()).then_some(unit);
            return Err(other_statement(label, stated, unit, quantity));
        }
        Ok(Meaning { quantity, factor, unit: unit.si(), is_assumed: false })
    }

    /// The declared or the written unit, and the factor to its SI unit; `None` if there is no unit at all.
    fn unit_in_use<'a>(&'a self, label: &'a Label) -> Result<Option<(f64, &'a WrittenUnit)>, RecordError> {
        let channel = label.name();
        if let (Some(unit), Some(scale)) = (&self.unit, self.scale) {
            return Ok(Some((scale * unit.factor(), unit)));
        }
        if let Some(unit) = label.unknown_unit() {
            let what = format!("the unit \"{unit}\" of channel \"{channel}\" is not known");
            let remedy = "give `unit`, such as m/s, and `scale`, the factor that turns the numbers into it";
            return Err(RecordError::unclear(what, remedy));
        }
        match (&self.unit, self.scale, label.unit()) {
            (Some(declared), _, Some(written)) if !declared.is_same_as(written) => {
                let what = format!("channel \"{channel}\" is in {written}, not in {declared}");
                let remedy = format!(
                    "leave out `unit` {declared}, or give `scale` as well, the factor that turns the numbers into \
                     {declared}"
                );
                Err(RecordError::contradiction(what, remedy))
            }
            (Some(declared), ..) => Ok(Some((declared.factor(), declared))),
            (None, _, None) => Ok(None),
            (None, _, Some(written)) if written.is_counts() => {
                let what = format!("channel \"{channel}\" is in {written}, whose size is not known");
                let remedy =
                    format!("give `scale` and `unit`, as in `scale` 1.57e-4 `unit` rad, or stay with `unit` {written}");
                Err(RecordError::unclear(what, remedy))
            }
            // Volts are the SI unit of no motion: a factor for them is a gain, which leads to another unit.
            (None, Some(scale), Some(written))
                if written.quantity() == Quantity::Other || !((scale / written.factor() - 1.0).abs() < SAME_FACTOR) =>
            {
                let what = format!(
                    "channel \"{channel}\" is in {written}; a factor of {scale} leads to a unit that was not said"
                );
                Err(RecordError::contradiction(what, "give `unit` as well, or leave out `scale`".into()))
            }
            (None, _, Some(written)) => Ok(Some((written.factor(), written))),
        }
    }

    /// The meaning of a channel without any unit: in SI units, if its quantity is declared.
    fn assumed(&self, label: &Label) -> Result<Meaning, RecordError> {
        let channel = label.name();
        let Some(quantity) = self.quantity.or_else(|| label.quantity()) else {
            let what = format!("channel \"{channel}\" has neither a unit nor a name that tells what it measured");
            let remedy = "give `quantity` velocity, displacement or acceleration, and `unit`, with `scale` if the \
                          numbers are not in it";
            return Err(RecordError::unclear(what, remedy));
        };
        if let Some(stated) = label.stated_quantity().filter(|stated| *stated != quantity) {
            return Err(other_statement(label, stated, None, quantity));
        }
        let likely = unit_of_motion(quantity, label.word.is_angular).unwrap_or("N");
        // Behind a word for rotation or for a sensor, SI units without an angle would be a guess.
        if self.quantity.is_none() || label.word.is_angular || label.word.is_sensor {
            let what = format!("channel \"{channel}\" is a record of {quantity}, but its unit is written nowhere");
            let remedy = format!("give `unit`, such as {likely}, and `scale` if the numbers are not in it");
            return Err(RecordError::unclear(what, remedy));
        }
        Ok(Meaning { quantity, factor: self.scale.unwrap_or(1.0), unit: likely, is_assumed: true })
    }

    /// Position of the channel that is meant among all channels but the time: the only one, or the one that stands
    /// alone by its unit, else by a word in its name, else by being the only one of which nothing is known.
    ///
    /// A declared quantity or unit is looked for; otherwise a velocity, then a displacement.
    ///
    /// # Errors
    /// [`RecordError::Unclear`] if several are alike, or none of several is one.
    pub fn choose(&self, labels: &[Label]) -> Result<usize, RecordError> {
        let declared = self.declared_quantity();
        let alike = |is_meant: &dyn Fn(&Label) -> bool| -> Vec<usize> {
            labels.iter().enumerate().filter(|(_, label)| is_meant(label)).map(|(index, _)| index).collect()
        };
        // With a scale, the declared unit is not that of the file.
        let same_unit = match (&self.unit, self.scale) {
            (Some(wanted), None) => alike(&|label: &Label| label.unit().is_some_and(|unit| unit.is_same_as(wanted))),
            _ => Vec::new(),
        };
        let wanted = declared.map_or(vec![Quantity::Velocity, Quantity::Displacement], |declared| vec![declared]);
        let by = |quantity_of: fn(&Label) -> Option<Quantity>| {
            let of = move |quantity: &Quantity| alike(&|label: &Label| quantity_of(label) == Some(*quantity));
            wanted.iter().map(of).find(|found| !found.is_empty())
        };
        let open = || alike(&|label: &Label| declared.is_some() && label.quantity().is_none());
        let found = match same_unit.len() {
            _ if labels.len() == 1 => vec![0],
            1 => same_unit,
            _ => by(Label::quantity_of_unit).or_else(|| by(Label::quantity)).unwrap_or_else(open),
        };
        let [index] = found[..] else {
            let wanted = declared.map_or("motion".into(), |declared| declared.to_string());
            let channels = listed(&labels.iter().map(Label::to_string).collect::<Vec<_>>());
            let what = format!("it is not clear which channel is the {wanted}; there are: {channels}");
            return Err(RecordError::unclear(what, "choose one by `channel`"));
        };
        Ok(index)
    }
}

/// The name or the format states another quantity than the unit in use, or than the declared `quantity`.
fn other_statement(label: &Label, stated: Quantity, unit: Option<&WrittenUnit>, quantity: Quantity) -> RecordError {
    let (basis, remedy) = match unit {
        Some(unit) => (
            format!("{unit} is a unit of {quantity}"),
            format!("give `quantity` {quantity} if the unit is right, or else both `scale` and `unit`"),
        ),
        None => (
            format!("it was said to be one of {quantity}"),
            format!("leave out what says {quantity}, or choose another `channel`"),
        ),
    };
    let name = label.name();
    RecordError::contradiction(
        format!("the file says that channel \"{name}\" is a record of {stated}, but {basis}"),
        remedy,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::RecordError::{Contradiction, Unclear};
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

    fn refusal(request: &Request, name: &str) -> RecordError {
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
        let alone = "give `unit` as well, or leave out `scale`";
        let small = unit("rad").scale(1.570_796_3e-4).quantity(Displacement);
        assert_eq!(of(&small, "encoder_counts"), (Displacement, 1.570_796_3e-4, "rad", false));
        assert_eq!(of(&unit("m/s").scale(0.5), "a [m/s^2]"), (Velocity, 0.5, "m/s", false));
        assert_eq!(of(&unit("m/s").scale(0.5), "disp [mm]"), (Velocity, 0.5, "m/s", false));
        assert_eq!(of(&unit("m/s").scale(0.5), "v [knots]"), (Velocity, 0.5, "m/s", false));
        assert_eq!(of(&nothing().scale(1e-3), "v [mm/s]"), (Velocity, 1e-3, "m/s", false));
        assert!(matches!(refusal(&nothing().scale(1.0), "v [mm/s]"), Contradiction { remedy, .. } if remedy == alone));
        assert!(
            matches!(refusal(&nothing().scale(f64::NAN), "v [mm/s]"), Contradiction { remedy, .. } if remedy == alone)
        );
        assert!(matches!(refusal(&nothing().scale(1.0).quantity(Velocity), "v \
                [V]"), Contradiction { remedy, .. } if remedy == alone));
    }

    #[test]
    fn contradictions_are_refused_with_both_sides() {
        let velocity = nothing().quantity(Velocity);
        let said = |request: &Request, name: &str| refusal(request, name).to_string();
        assert_eq!(
            said(&velocity, "x [mm]"),
            "channel \"x [mm]\" is in mm, which is a unit of displacement, not of velocity"
        );
        assert!(said(&velocity, "a [g]").ends_with("is in g, which is a unit of acceleration, not of velocity"));
        assert_eq!(said(&unit("rad"), "theta [deg]"), "channel \"theta [deg]\" is in deg, not in rad");
        assert_eq!(said(&unit("m/s"), "v [mm/s]"), "channel \"v [mm/s]\" is in mm/s, not in m/s");
        assert_eq!(said(&unit("m/s"), "gyro [V]"), "channel \"gyro [V]\" is in V, not in m/s");
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
        let error = velocity.meaning(&stated).unwrap_err();
        assert!(error.to_string().ends_with("is a unit of acceleration, not of velocity"), "{error}");
        let remedy = "leave out `quantity` velocity, choose another `channel`, or give both `scale` and `unit`";
        assert!(matches!(error, Contradiction { remedy: found, .. } if found == remedy));
        let stated = Label::of("3+Z").with_quantity(Acceleration);
        assert_eq!(
            velocity.meaning(&stated).unwrap_err().to_string(),
            "the file says that channel \"3+Z\" is a record of acceleration, but it was said to be one of velocity"
        );
        let scaled = unit("m/s").scale(2.0).meaning(&stated).unwrap_err();
        assert!(scaled.to_string().ends_with("a record of acceleration, but m/s is a unit of velocity"), "{scaled}");
    }

    #[test]
    fn what_would_be_a_guess_is_refused() {
        let velocity = nothing().quantity(Velocity);
        let is_unclear = |request: &Request, name: &str, end: &str| {
            let error = refusal(request, name);
            assert!(matches!(error, Unclear { .. }) && error.to_string().ends_with(end), "{error}");
        };
        let nothing_known = "has neither a unit nor a name that tells what it measured";
        is_unclear(&nothing(), "data", nothing_known);
        is_unclear(&nothing().scale(2.0), "v", nothing_known);
        let no_unit = |request: &Request, name: &str| {
            let Unclear { what, remedy } = refusal(request, name) else { panic!("{name}") };
            let quantity = [Velocity, Displacement, Acceleration, Quantity::Force];
            let quantity = quantity.into_iter().find(|quantity| what.contains(&format!("record of {quantity}, but")));
            let unit = remedy.strip_prefix("give `unit`, such as ").and_then(|rest| rest.split_once(", and `scale`"));
            (quantity.unwrap(), unit.unwrap().0.to_owned())
        };
        assert_eq!(no_unit(&nothing(), "velocity"), (Velocity, "m/s".to_owned()));
        assert_eq!(no_unit(&nothing(), "angular_velocity"), (Velocity, "rad/s".to_owned()));
        assert_eq!(no_unit(&velocity, "angular_velocity"), (Velocity, "rad/s".to_owned()));
        assert_eq!(no_unit(&nothing().scale(1e-3), "velocity"), (Velocity, "m/s".to_owned()));
        assert_eq!(no_unit(&nothing(), "theta"), (Displacement, "rad".to_owned()));
        assert_eq!(no_unit(&nothing().quantity(Displacement), "encoder"), (Displacement, "m".to_owned()));
        assert_eq!(no_unit(&nothing(), "force"), (Quantity::Force, "N".to_owned()));
        is_unclear(&nothing(), "ch1 [V]", "is in V, which does not tell what it measured");
        is_unclear(&unit("V"), "ch1", "is in V, which does not tell what it measured");
        is_unclear(&nothing(), "encoder_counts", "is in counts, whose size is not known");
        let scaled = nothing().quantity(Displacement).scale(2.0);
        is_unclear(&scaled, "encoder_counts", "is in counts, whose size is not known");
        for request in [nothing(), velocity, unit("m/s"), nothing().scale(0.5)] {
            is_unclear(&request, "v [knots]", "the unit \"knots\" of channel \"v [knots]\" is not known");
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
