//! Words in the name of a channel: quantities, sensors, rotation.

use crate::units::Quantity;

/// Meaning of the words of a name.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Word {
    /// The quantity, if the words agree on one.
    pub(crate) quantity: Option<Quantity>,
    /// True for a sensor or a symbol, which other words and units overrule.
    pub(crate) is_sensor: bool,
    /// True if any word means rotation.
    pub(crate) is_angular: bool,
}

/// Words for quantities.
const NAMES: [(&str, Quantity); 4] = [
    ("velocity velocities vel speed rate", Quantity::Velocity),
    ("displacement disp displ position pos angle deflection", Quantity::Displacement),
    ("acceleration accel acc", Quantity::Acceleration),
    ("force torque", Quantity::Force),
];

/// Sensors and symbols, and the quantity that they measure or stand for if nothing else is known.
const SENSORS: [(&str, Quantity); 3] = [
    ("gyro gyroscope omega", Quantity::Velocity),
    ("encoder theta phi", Quantity::Displacement),
    ("accelerometer", Quantity::Acceleration),
];

/// Words for rotation.
const ANGULAR: &str = "angular angle ang rotation rotational rotary gyro gyroscope omega theta phi yaw pitch roll";

/// Words before "rate" of which the rate is no velocity.
const OF_RATES: &str = "sample sampling frame data bit flow strain decay heart refresh";

impl Word {
    /// Meaning of a name without its brackets.
    pub(crate) fn in_name(bare: &str) -> Self {
        let words = words(bare);
        let is_motion = |at: usize| words[at] != "rate" || at == 0 || !is_in(OF_RATES, &words[at - 1]);
        let find = |table: &[(&str, Quantity)]| {
            let mut found = words.iter().enumerate().filter(|(at, _)| is_motion(*at)).filter_map(|(_, word)| {
                table.iter().find(|(known, _)| is_in(known, word)).map(|(_, quantity)| *quantity)
            });
            // Words that contradict each other tell nothing.
            let first = found.next()?;
            Some(found.all(|other| other == first).then_some(first))
        };
        let (named, sensor) = (find(&NAMES), find(&SENSORS));
        Self {
            quantity: named.or(sensor).flatten(),
            is_sensor: named.is_none() && sensor.is_some(),
            is_angular: words.iter().any(|word| is_in(ANGULAR, word)),
        }
    }
}

/// True for one of the words of a list, which blanks separate.
pub(crate) fn is_in(list: &str, word: &str) -> bool {
    list.split(' ').any(|known| known == word)
}

/// The words of a name in small letters, without digits at their ends: `angularVelocity1` has two.
pub(crate) fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut previous_is_small = false;
    for sign in name.chars() {
        if !sign.is_alphanumeric() || (sign.is_uppercase() && previous_is_small) {
            words.push(String::new());
        }
        if let (true, Some(word)) = (sign.is_alphanumeric(), words.last_mut()) {
            word.extend(sign.to_lowercase());
        }
        previous_is_small = sign.is_lowercase();
    }
    let words = words.iter().map(|word| word.trim_end_matches(|sign: char| sign.is_ascii_digit()).to_owned());
    words.filter(|word| !word.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_tell_a_quantity() {
        let all = |names: &[&str], quantity: Option<Quantity>| {
            for name in names {
                assert_eq!(Word::in_name(name).quantity, quantity, "{name}");
            }
        };
        all(
            &["velocity", "Vel", "VEL1", "speed", "angular_velocity", "angularVelocity", "AngVel", "yaw rate"],
            Some(Quantity::Velocity),
        );
        all(&["gyro", "gyroX", "omega_2", "gyro rate", "encoder speed", "rate"], Some(Quantity::Velocity));
        all(
            &["disp", "Displacement", "pos_x", "position", "angle", "encoder", "encoder_counts", "theta"],
            Some(Quantity::Displacement),
        );
        all(&["gyro angle", "deflection"], Some(Quantity::Displacement));
        all(&["acc", "accel", "accX", "Acceleration 1", "accelerometer"], Some(Quantity::Acceleration));
        all(&["force", "hammer force", "Torque"], Some(Quantity::Force));
        all(
            &[
                "",
                "v",
                "x",
                "data",
                "sample_rate",
                "frame rate",
                "angle rate",
                "velocity of position",
                "channel",
                "marvel",
            ],
            None,
        );
        all(&["gyro theta", "access", "accuracy"], None);
    }

    #[test]
    fn sensors_and_rotation() {
        let word = |name: &str| (Word::in_name(name).is_sensor, Word::in_name(name).is_angular);
        assert_eq!(word("gyro"), (true, true));
        assert_eq!(word("encoder"), (true, false));
        assert_eq!(word("encoder speed"), (false, false));
        assert_eq!(word("angular_velocity"), (false, true));
        assert_eq!(word("velocity"), (false, false));
        assert_eq!(word("roll"), (false, true));
        assert_eq!(word("rollers"), (false, false));
    }
}
