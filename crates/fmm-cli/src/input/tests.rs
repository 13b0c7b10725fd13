//! Channels of files as a command takes them, and files that should be refused.

use std::path::{Path, PathBuf};

use fmm_record::uff::{ByteOrder, DataSet, Form, write};
use fmm_record::{Column, Quantity, Record};

use super::{Choice, Input};
use crate::host::Host;

/// A file in a folder of these tests.
fn file(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join("fmm-cli").join("identify_files");
    std::fs::create_dir_all(&folder).unwrap();
    folder.join(name)
}

/// A text file with time stamps and the columns of a header, of which the first begins with 1, the second with 2.
fn text(name: &str, header: &str) -> PathBuf {
    let columns = header.split(',').count();
    let row = |time: usize| {
        let values: Vec<String> = (1..=columns).map(|column| (column + time).to_string()).collect();
        format!("{time},{}\n", values.join(","))
    };
    let path = file(name);
    std::fs::write(&path, format!("t [s],{header}\n{}{}{}", row(0), row(1), row(2))).unwrap();
    path
}

/// A record that comes with the examples.
fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/data").join(name)
}

fn quantity(quantity: Quantity) -> Choice {
    Choice { quantity: Some(quantity), ..Choice::default() }
}

fn unit(text: &str) -> Choice {
    Choice { unit: Some(text.parse().unwrap()), ..Choice::default() }
}

fn read(choice: &Choice, path: &Path) -> Input {
    let input = choice.read(path, &Host::default()).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert!(input.warnings.is_empty(), "{:?}", input.warnings);
    input
}

fn refusal(choice: &Choice, path: &Path) -> String {
    choice
        .read(path, &Host::default())
        .err()
        .map_or_else(|| panic!("{} was read", path.display()), |error| error.to_string())
}

/// Quantity, unit and first value.
fn found(input: &Input) -> (Quantity, &str, f64) {
    (input.record.quantity(), input.record.unit(), input.record.values()[0])
}

#[test]
fn an_acceleration_is_no_velocity() {
    for (name, header) in [("ms2.csv", "a [m/s^2]"), ("g.csv", "a [g]"), ("suffix.csv", "acc_ms2")] {
        let path = text(name, header);
        let input = read(&Choice::default(), &path);
        assert_eq!((input.record.quantity(), input.record.unit()), (Quantity::Acceleration, "m/s²"));
        let refused = refusal(&quantity(Quantity::Velocity), &path);
        assert!(
            refused.contains("a unit of acceleration, not of velocity; leave out --quantity velocity"),
            "{refused}"
        );
    }
    let refused = refusal(&Choice::default(), &text("force.csv", "F [N]"));
    assert!(refused.contains("a record of force") && !refused.contains("integrate"), "{refused}");
}

#[test]
fn the_channel_is_the_one_that_its_unit_tells_out() {
    let three = text("three.csv", "disp [mm],vel [mm/s]");
    let input = read(&Choice::default(), &three);
    assert_eq!(found(&input), (Quantity::Velocity, "m/s", 2.0 * 1e-3));
    let origin = "three.csv, channel vel [mm/s]: velocity in m/s after a factor of 0.001; the sampling rate was";
    assert!(input.origin.starts_with(origin), "{}", input.origin);
    let displacement = read(&quantity(Quantity::Displacement), &three);
    assert_eq!(found(&displacement), (Quantity::Displacement, "m", 1e-3));
    let by_name = Choice { channel: Some(Column::from("disp [mm]")), ..Choice::default() };
    assert_eq!(found(&read(&by_name, &three)), (Quantity::Displacement, "m", 1e-3));
    let without_unit = Choice { channel: Some(Column::from("disp")), ..Choice::default() };
    assert_eq!(found(&read(&without_unit, &three)), (Quantity::Displacement, "m", 1e-3));
    let refused = refusal(&Choice::default(), &text("two.csv", "v1 [m/s],v2 [m/s]"));
    assert!(refused.contains("\"v1 [m/s]\" (velocity in m/s), \"v2 [m/s]\""), "{refused}");
    assert!(refused.ends_with("choose one by --channel"), "{refused}");
    let same_names = text("same_names.csv", "v,v,v [m/s]");
    assert_eq!(found(&read(&Choice::default(), &same_names)), (Quantity::Velocity, "m/s", 3.0));
}

#[test]
fn what_no_unit_tells_is_asked_for() {
    for (header, remedy) in [
        ("velocity", "--unit, such as m/s"),
        ("angular_velocity", "--unit, such as rad/s"),
        ("encoder_counts", "--scale and --unit"),
        ("ch1 [V]", "--quantity velocity, --quantity displacement or --quantity acceleration"),
        ("v", "--quantity velocity, displacement or acceleration, and --unit"),
        ("v [knots]", "--unit, such as m/s, and --scale"),
        ("velocity [mm]", "--quantity displacement if the unit is right"),
    ] {
        let refused = refusal(&Choice::default(), &text("silent.csv", header));
        assert!(refused.contains(&format!("\"{header}\"")) && refused.contains(remedy), "{header}: {refused}");
    }
    let millimetres = text("millimetres.csv", "v [mm/s]");
    for (choice, remedy) in [
        (unit("m/s"), "leave out --unit m/s, or give --scale as well"),
        (Choice { scale: Some(2.0), ..Choice::default() }, "give --unit as well"),
        (Choice { quantity: Some(Quantity::Velocity), ..unit("m") }, "give --quantity displacement"),
    ] {
        let refused = refusal(&choice, &millimetres);
        assert!(refused.contains(remedy), "{refused}");
    }
    let scaled = Choice { scale: Some(0.5), quantity: Some(Quantity::Displacement), ..unit("rad") };
    let counts = read(&scaled, &text("counts.csv", "encoder_counts"));
    assert_eq!(found(&counts), (Quantity::Displacement, "rad", 0.5));
    let input = read(&quantity(Quantity::Displacement), &text("x.csv", "x"));
    assert_eq!(found(&input), (Quantity::Displacement, "m", 1.0));
    assert!(input.origin.contains("displacement, taken to be in m;"), "{}", input.origin);
}

#[test]
fn measured_records_are_what_they_were() {
    let input = Choice::default().read_bundled().unwrap();
    // The program carries a copy of its own, as it is published without the examples.
    assert!(super::BUNDLED.1 == std::fs::read(data(super::BUNDLED.0)).unwrap());
    assert_eq!((input.record.len(), input.record.rate().round()), (30_000, 1000.0));
    assert!(input.origin.contains("channel data: velocity in V;"), "{}", input.origin);
    let theta = Choice { channel: Some(Column::from("theta_rad")), ..Choice::default() };
    assert_eq!(found(&read(&theta, &data("single_pendulum_55s_1khz.csv"))).0, Quantity::Displacement);
    let wheel_in = |spelled: &str| read(&unit(spelled), &data("bicycle_wheel_radial_gyro.csv")).record;
    let degree = wheel_in("deg/s").values()[0] / wheel_in("rad/s").values()[0];
    assert!((degree.to_degrees() - 1.0).abs() < 1e-12, "one degree is {degree} rad");
}

#[test]
fn universal_files_state_quantity_and_unit() {
    let universal = |name: &str, quantity, unit: &str| {
        let path = file(name);
        let record = Record::sampled(100.0, vec![3.0, 2.0, 1.0], quantity, unit).unwrap();
        write(&path, &[DataSet::of_record(&record)], Form::Binary(ByteOrder::default())).unwrap();
        path
    };
    let millimetres = read(&Choice::default(), &universal("mm.uff", Quantity::Velocity, "mm/s"));
    assert_eq!(found(&millimetres), (Quantity::Velocity, "m/s", 3.0 * 1e-3));
    let volts = universal("volts.uff", Quantity::Displacement, "V");
    assert_eq!(found(&read(&Choice::default(), &volts)), (Quantity::Displacement, "V", 3.0));
    let refused = refusal(&quantity(Quantity::Velocity), &volts);
    assert!(refused.contains("is a record of displacement, but it was said to be one of velocity"), "{refused}");
    let refused = refusal(&Choice::default(), &universal("pascal.uff", Quantity::Other, "Pa"));
    assert!(refused.starts_with("the unit \"Pa\" of channel") && refused.contains("--unit"), "{refused}");
    let refused = refusal(&Choice { rate: Some(1.0), ..Choice::default() }, &volts);
    assert!(refused.contains("leave out the rate and the time"), "{refused}");
}

#[test]
fn what_is_missing_outside_of_the_span_does_not_matter() {
    let path = file("gap.csv");
    std::fs::write(&path, "t [s],v [m/s]\n0,NaN\n1,1\n2,2\n3,3\n").unwrap();
    let whole = Choice::default().read(&path, &Host::default()).unwrap();
    assert_eq!(whole.record.values(), [1.0, 2.0, 3.0]);
    let said = "1 of 4 rows have no number in the channel and were left out";
    assert!(whole.warnings.iter().any(|warning| warning.contains(said)), "{:?}", whole.warnings);
    let cut = Choice { from: Some(1.0), to: Some(2.0), ..Choice::default() }.read(&path, &Host::default()).unwrap();
    assert_eq!((cut.record.start(), cut.record.values()), (1.0, &[1.0, 2.0][..]));
}

#[test]
fn uneven_times_are_taken_unless_a_rate_is_given() {
    let path = file("uneven.csv");
    std::fs::write(&path, "t [s],v [m/s]\n0,0\n1,1\n3,2\n4,3\n5,4\n").unwrap();
    let record = Choice::default().read(&path, &Host::default()).unwrap().record;
    assert!(!record.is_equally_spaced() && record.time(2) == 3.0);
    let stepped = Choice { rate: Some(1.0), ..Choice::default() }.read(&path, &Host::default()).unwrap();
    assert_eq!(stepped.record.rate(), 1.0);
    let said = "the 1 Hz of --rate were taken, though the file says 0.8 Hz";
    assert_eq!(stepped.warnings, [said]);
}

#[test]
fn remarks_name_options_that_exist() {
    let path = file("parts.csv");
    std::fs::write(&path, "t [s],v [m/s]\n0,1\n1,2\n2,3\nt [s],v [m/s]\n0,4\n1,5\n2,6\n").unwrap();
    let input = Choice::default().read(&path, &Host::default()).unwrap();
    assert!(input.warnings[0].ends_with("which has 3 of 6 samples; --table chooses another"), "{:?}", input.warnings);
    std::fs::write(&path, "t [s],v [m/s]\n0,1\n1,x\n2,3\n").unwrap();
    let refused = refusal(&Choice::default(), &path);
    assert!(refused.starts_with("line 3, column \"v [m/s]\": \"x\" is not a number; --repair uses"), "{refused}");
}

#[test]
fn all_formats_are_compiled() {
    let object = file("table.json");
    std::fs::write(&object, r#"{"time": [0, 1, 2], "velocity": [1, 2, 3], "unit": "m/s"}"#).unwrap();
    assert_eq!(found(&read(&Choice::default(), &object)), (Quantity::Velocity, "m/s", 1.0));
    for (begin, word) in [(&b"RIFF\0\0\0\0WAVE"[..], "WAV"), (b"PK\x03\x04xl/", "workbook"), (b"\x1F\x8B\x08", "gzip")]
    {
        std::fs::write(&object, begin).unwrap();
        let refused = refusal(&Choice::default(), &object);
        assert!(refused.contains(word) && !refused.contains("feature"), "{refused}");
    }
}
