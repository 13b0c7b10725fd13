use std::io::{self, Read};

use super::*;
use crate::{Quantity, RecordError};

fn read_text(text: &str) -> Result<Reading, CsvError> {
    CsvReader::default().read_from(text.as_bytes())
}

fn values(text: &str) -> Vec<f64> {
    read_text(text).unwrap().record.into_values()
}

fn message(text: &str) -> String {
    read_text(text).unwrap_err().to_string()
}

fn measured(name: &str) -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/data").join(name)
}

#[test]
fn separators_headers_comments_and_line_ends() {
    for text in [
        "t,v\n0,1.5\n1,2.5\n2,-1\n",
        "t,v\n0,1.5\n1,2.5\n2,-1",
        "t;v\r\n0;1,5\r\n1;2,5\r\n2;-1\r\n",
        "t\tv\n0\t1,5\n1\t2,5\n2\t-1\n",
        "\u{feff}t;v\n0;1.5\n1;2.5\n2;-1\n",
        "# a \"comment, with; all\n\n% another\nt , v\n 0 , 1.5\n  # within, \"data\n1,2.5\n\n2,-1\n\n",
        "\"t\",\"v\"\n\"0\",\"1.5\"\n\"1\",\"2.5\"\n\"2\",\"-1\"\n",
        "t,v\r0,1.5\r1,2.5\r2,-1\r",
    ] {
        let reading = read_text(text).unwrap_or_else(|error| panic!("{text:?}: {error}"));
        assert_eq!(reading.record.values(), [1.5, 2.5, -1.0], "{text:?}");
        assert_eq!(reading.record.rate(), 1.0);
    }
}

#[test]
fn time_is_found_by_name_and_by_nature() {
    let named = read_text("v,Zeit [ms],w\n5,0,9\n6,2,8\n7,4,7\n").unwrap();
    assert_eq!((named.record.rate(), &named.channel[..], named.time.as_deref()), (500.0, "v", Some("Zeit [ms]")));
    assert_eq!(named.columns, ["v", "Zeit [ms]", "w"]);
    let unnamed = read_text("0.1,5\n0.2,6\n0.3,7\n").unwrap();
    assert_eq!((unnamed.record.rate(), unnamed.record.start(), &unnamed.channel[..]), (10.0, 0.1, "1"));
    assert!(message("a,b\n3,5\n1,6\n2,7\n").contains("give a time column or a rate; the file has: \"a\", \"b\""));
    assert!(matches!(read_text("1.0\n2.0\n3.0\n"), Err(CsvError::NoRate { .. })));
    assert!(matches!(read_text("t\n2.0\n3.0\n"), Err(CsvError::NoChannel { .. })));
    assert!(matches!(read_text("t,v\n0,1\n0,2\n"), Err(CsvError::Record(RecordError::TimeNotIncreasing { .. }))));
}

#[test]
fn a_given_rate_needs_no_time() {
    let reader = CsvReader::default().rate(100.0);
    let named = reader.read_from(&b"date,t,v\nMonday,bad,4\nMonday,worse,5\n"[..]);
    assert!(matches!(named, Err(CsvError::NotANumber { .. })), "the first column that is not time is text");
    let chosen = reader.clone().channel("V").read_from(&b"date,t,v\nMonday,bad,4\nMonday,worse,5\n"[..]).unwrap();
    assert_eq!((chosen.record.values(), chosen.record.rate(), chosen.record.start()), (&[4.0, 5.0][..], 100.0, 0.0));
    assert_eq!((chosen.sampling.to_string(), chosen.time.as_deref()), ("given as 100 Hz".into(), Some("t")));
    assert_eq!(reader.read_from(&b"4\n5\n"[..]).unwrap().record.values(), [4.0, 5.0]);
    assert_eq!(reader.read_from(&b"4,1\n2,2\n"[..]).unwrap().record.values(), [4.0, 2.0]);
    // The first column could be nothing but time.
    assert_eq!(reader.read_from(&b"0.00,1\n0.01,2\n"[..]).unwrap().record.values(), [1.0, 2.0]);
    assert!(matches!(reader.time(0).read_from(&b"1,2\n"[..]), Err(CsvError::TimeAndRate)));
    let bad = CsvReader::default().rate(-1.0).read_from(&b"4\n5\n"[..]);
    assert!(matches!(bad, Err(CsvError::Record(RecordError::Rate { .. }))));
}

#[test]
fn columns_by_name_and_position() {
    let text = "time,v,V,w\n0,1,2,3\n1,1,2,3\n";
    let channel = |column: &str| CsvReader::default().channel(column).read_from(text.as_bytes());
    for (column, value) in [("v", 1.0), ("V", 2.0), ("W", 3.0), ("2", 2.0), (" w ", 3.0)] {
        assert_eq!(channel(column).unwrap().record.values()[0], value, "{column}");
    }
    let missing = channel("x").unwrap_err().to_string();
    assert_eq!(missing, "there is no column \"x\"; the file has: \"time\", \"v\", \"V\", \"w\"");
    assert!(matches!(channel("4"), Err(CsvError::NoSuchColumn { .. })));
    let twice = CsvReader::default().channel("A").read_from(&b"t,a,a\n0,1,2\n1,1,2\n"[..]);
    assert!(matches!(twice, Err(CsvError::AmbiguousColumn { count: 2, .. })));
    let same = CsvReader::default().channel("v").time("v").read_from(text.as_bytes());
    assert!(matches!(same, Err(CsvError::SameColumn { .. })));
}

#[test]
fn channels_are_all_columns_but_the_time() {
    let channels = |text: &str| CsvReader::default().channels_from(text.as_bytes()).unwrap();
    let positions = |text: &str| channels(text).into_iter().map(|(index, _)| index).collect::<Vec<_>>();
    assert_eq!(channels("t,v\n0,1\n1,2\n"), [(1, "v".to_owned())]);
    assert_eq!(positions("x,time,v,v\n0,1,a,2\n1,2,b,3\n"), [0, 2, 3], "text in other columns does not matter");
    assert_eq!(positions("0.1,5,7\n0.2,6,7\n0.3,7,7\n"), [1, 2], "the first column is time by nature");
    assert_eq!(positions("a,b\n3,5\n1,6\n2,7\n"), [0, 1], "no column is time");
    assert_eq!(positions("date,b\nMonday,5\nMonday,6\n"), [0, 1], "no column is time");
    assert_eq!(positions("4\n5\n6\n"), [0], "a single column is no time");
    let other = CsvReader::default().time("b").channels_from(&b"t,a,b\n0,1,2\n"[..]).unwrap();
    assert_eq!(other.iter().map(|(index, _)| *index).collect::<Vec<_>>(), [0, 1]);
    assert!(matches!(CsvReader::default().channels_from(&b""[..]), Err(CsvError::Empty)));
    assert!(matches!(CsvReader::default().channels("/no/such/file.csv"), Err(CsvError::Open { .. })));
}

#[test]
fn damage_is_named_with_its_line() {
    assert_eq!(message("# c\n\nt,v\n0,1\n# c\n1,x2\n"), "line 6, column \"v\": \"x2\" is not a number");
    assert_eq!(message("t,v\n0,1\n1,\n"), "line 3, column \"v\": \"\" is not a number");
    assert_eq!(message("t;v;w\n0;1;2\n1;1\n"), "line 3 has 2 fields, but the first row has 3");
    assert!(message("t,v\n0,001,1,5\n").starts_with("line 2 has 4 fields, but the first row has 2; if the numbers"));
    let mixed = message("t;v\n0;1,5\n1;2.5\n");
    assert!(mixed.starts_with("line 3, column \"v\": \"2.5\" has a decimal point, but earlier numbers"), "{mixed}");
    for (text, expected) in [("", "empty"), ("# only\n\n", "empty"), ("t,v\n", "no rows"), ("\n", "empty")] {
        assert!(message(text).contains(expected), "{text:?}: {}", message(text));
    }
    for number in ["NaN", "inf", "-Infinity", "1e999"] {
        let error = read_text(&format!("t,v\n0,1\n1,{number}\n")).unwrap_err();
        assert!(matches!(error, CsvError::Record(RecordError::NonFinite { index: 1, count: 1, .. })), "{number}");
    }
    assert!(matches!(CsvReader::default().read_from(&b"\xff\xfet\0"[..]), Err(CsvError::Utf16)));
    assert!(matches!(CsvReader::default().read_from(io::repeat(b'1')), Err(CsvError::LineTooLong { line: 1, .. })));
    assert!(matches!(CsvReader::default().separator(b'.').read_from(&b""[..]), Err(CsvError::Separator { .. })));
    assert!(matches!(read("/no/such/file.csv"), Err(CsvError::Open { .. })));
    // Latin-1 in a header is not UTF-8, and no reason to stop.
    assert!(CsvReader::default().read_from(&b"t,\xb0C\n0,1\n1,2\n"[..]).is_ok());
}

#[test]
fn text_of_any_bytes_never_panics() {
    let mut random = crate::synthetic::Noise::new(5);
    let alphabet = b"0123456789.,;\t\n\r\"#%-+eE tv\xff\0";
    for _ in 0..20_000 {
        let length = random.next() % 40;
        let text: Vec<u8> = (0..length).map(|_| alphabet[random.next() as usize % alphabet.len()]).collect();
        // Either outcome is right; a panic is not.
        let _ = CsvReader::default().read_from(&text[..]);
        let _ = CsvReader::default().rate(10.0).separator(b';').read_from(&text[..]);
    }
}

/// Rows that nobody stores, each far longer than the numbers in use.
struct Endless {
    row: u32,
    rows: u32,
    text: io::Cursor<Vec<u8>>,
}

impl Read for Endless {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        if self.text.position() as usize == self.text.get_ref().len() && self.row < self.rows {
            let time = f64::from(self.row) / 1000.0;
            self.text = io::Cursor::new(format!("{time:.3};{};{}\n", self.row % 7, "x".repeat(500)).into_bytes());
            self.row += 1;
        }
        self.text.read(out)
    }
}

#[test]
fn rows_are_read_as_a_stream() {
    let header = &b"t;v;text\n"[..];
    let rows = Endless { row: 0, rows: 100_000, text: io::Cursor::new(Vec::new()) };
    let reading = CsvReader::default().read_from(header.chain(rows)).unwrap();
    assert_eq!((reading.record.len(), reading.record.rate()), (100_000, 1000.0));
    assert_eq!(reading.record.values()[99_999], f64::from(99_999 % 7));
}

#[test]
fn measured_records_are_read_by_themselves() {
    let wheel = read(measured("bicycle_wheel_radial_gyro.csv")).unwrap();
    assert_eq!((wheel.record.len(), wheel.record.rate(), &wheel.channel[..]), (1001, 500.0, "angular_velocity"));
    assert_eq!(wheel.record.values()[0], 3.236_790_061_330_015);
    let pendulum = CsvReader::default()
        .channel("omega_rad_per_s")
        .quantity(Quantity::Velocity)
        .unit("rad/s")
        .read(measured("single_pendulum_55s_1khz.csv"))
        .unwrap();
    assert_eq!((pendulum.record.len(), pendulum.record.rate(), pendulum.record.end()), (55_001, 1000.0, 55.0));
    assert_eq!((pendulum.record.quantity(), pendulum.record.unit()), (Quantity::Velocity, "rad/s"));
    assert_eq!(values("t,v\n0,1\n1,2\n"), [1.0, 2.0]);
}

#[test]
fn time_is_in_the_unit_that_its_name_tells() {
    let text = |name: &str, stamps: [&str; 3]| {
        let [a, b, c] = stamps;
        // Bytes, as some programs write Latin-1.
        let mut text: Vec<u8> = name.chars().map(|letter| letter as u8).collect();
        text.extend(format!(";v\n{a};1\n{b};2\n{c};4\n").bytes());
        text
    };
    for name in
        ["t", "Time", "time_s", "Time (sec)", "Elapsed Time [s]", "time_seconds", "Zeit [Sekunden]", "seconds", "[s]"]
    {
        let reading = CsvReader::default().read_from(&text(name, ["0", "0.001", "0.002"])[..]).unwrap();
        assert_eq!((reading.record.rate(), reading.time.as_deref()), (1000.0, Some(name)), "{name}");
    }
    for name in ["Time (msec)", "Timestamp (ms)", "time_millis", "millis", "timeMs", "Time [Milliseconds]", "x [ms]"] {
        let reading = CsvReader::default().read_from(&text(name, ["10", "11", "12"])[..]).unwrap();
        assert_eq!((reading.record.rate(), reading.time.as_deref()), (1000.0, Some(name)), "{name}");
    }
    for name in ["Time [µs]", "time_us", "micros", "Timestamp (usec)"] {
        let reading = CsvReader::default().read_from(&text(name, ["0", "1000", "2000"])[..]).unwrap();
        assert_eq!((reading.record.rate(), &reading.time.unwrap()[..]), (1000.0, name), "{name}");
    }
    let minutes = CsvReader::default().read_from(&text("Time (min)", ["0", "0.5", "1.0"])[..]).unwrap();
    assert!((minutes.record.interval() - 30.0).abs() < 1e-12);

    for (name, unit) in [("Time (jiffies)", "jiffies"), ("Time [samples]", "samples"), ("time/rev", "rev")] {
        for reader in [CsvReader::default(), CsvReader::default().time(name)] {
            let error = reader.read_from(&text(name, ["0", "1", "2"])[..]).unwrap_err();
            let expected = RecordError::TimeUnit { name: name.into(), unit: unit.into() };
            assert!(matches!(&error, CsvError::Record(error) if *error == expected), "{name}: {error}");
        }
        let rate = CsvReader::default().rate(50.0).read_from(&text(name, ["0", "1", "2"])[..]).unwrap();
        assert_eq!((&rate.channel[..], rate.record.rate()), ("v", 50.0));
    }
}

#[test]
fn a_counter_of_samples_is_no_time() {
    for name in ["Sample", "", "Unnamed: 0", "index", "N° no.", "Frame No.", "x", "Timestamp"] {
        let text = format!("{name},v\n0,1.5\n1,2.5\n2,4.5\n");
        let error = CsvReader::default().read_from(text.as_bytes()).unwrap_err();
        let expected = RecordError::Counter { name: name.into() };
        assert!(matches!(&error, CsvError::Record(error) if *error == expected), "{name}: {error}");
        let rate = CsvReader::default().rate(50.0).read_from(text.as_bytes()).unwrap();
        assert_eq!((&rate.channel[..], rate.record.values()), ("v", &[1.5, 2.5, 4.5][..]), "{name}");
    }
    assert!(matches!(read_text("0,1.5\n1,2.5\n2,1\n"), Err(CsvError::Record(RecordError::Counter { .. }))));
    let stated = CsvReader::default().time(0).read_from(&b"0,1.5\n1,2.5\n2,1.5\n"[..]).unwrap();
    assert_eq!(stated.record.rate(), 1.0, "who says that it is time is believed");
    // Beside time, a counter is no channel unless it is asked for.
    let pandas = ",time,v\n0,0.0,1.5\n1,0.5,2.5\n2,1.0,4.5\n";
    let reading = read_text(pandas).unwrap();
    assert_eq!((&reading.channel[..], reading.record.rate()), ("v", 2.0));
    assert_eq!(CsvReader::default().channels_from(pandas.as_bytes()).unwrap(), [(2, "v".to_owned())]);
    // Temperatures, angles and frequencies are no time.
    for name in ["T [K]", "angle [deg]", "f (Hz)"] {
        let text = format!("{name},v\n0.1,1.5\n0.2,2.5\n0.3,4.5\n");
        assert!(matches!(read_text(&text), Err(CsvError::NoRate { .. })), "{name}");
    }
}
