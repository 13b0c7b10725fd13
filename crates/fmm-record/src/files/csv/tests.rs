use std::io::{self, Read};

use crate::error::{RecordError, says};
use crate::files::Reader;
use crate::files::reading::Reading;
use crate::sampling::Sampling;
use crate::units::Quantity;

fn read_text(text: &str) -> Result<Reading, RecordError> {
    Reader::default().read_from(text.as_bytes())
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
    assert!(says(&read_text("1.0\n2.0\n3.0\n"), "the sampling rate is not known"));
    assert!(says(&read_text("t\n2.0\n3.0\n"), "has only the time column"));
    assert!(says(&read_text("t,v\n0,1\n0,2\n"), "time must increase"));
}

#[test]
fn a_given_rate_needs_no_time() {
    let reader = Reader::default().rate(100.0);
    let named = reader.read_from(&b"date,t,v\nMonday,bad,4\nMonday,worse,5\n"[..]);
    assert!(says(&named, "is not a number"), "the first column that is not time is text");
    let chosen = reader.clone().channel("V").read_from(&b"date,t,v\nMonday,bad,4\nMonday,worse,5\n"[..]).unwrap();
    assert_eq!((chosen.record.values(), chosen.record.rate(), chosen.record.start()), (&[4.0, 5.0][..], 100.0, 0.0));
    assert_eq!((chosen.sampling.to_string(), chosen.time.as_deref()), ("given as 100 Hz".into(), Some("t")));
    assert_eq!(reader.read_from(&b"4\n5\n"[..]).unwrap().record.values(), [4.0, 5.0]);
    assert_eq!(reader.read_from(&b"4,1\n2,-2\n"[..]).unwrap().record.values(), [4.0, 2.0]);
    // The first column could be nothing but time.
    assert_eq!(reader.read_from(&b"0.00,1\n0.01,2\n"[..]).unwrap().record.values(), [1.0, 2.0]);
    assert!(says(&reader.time(0).read_from(&b"1,2\n"[..]), "give one of them"));
    let bad = Reader::default().rate(-1.0).read_from(&b"4\n5\n"[..]);
    assert!(says(&bad, "the sampling rate must be positive"));
}

#[test]
fn columns_by_name_and_position() {
    let text = "time,v,V,w\n0,1,2,3\n1,1,2,3\n";
    let channel = |column: &str| Reader::default().channel(column).read_from(text.as_bytes());
    for (column, value) in [("v", 1.0), ("V", 2.0), ("W", 3.0), ("2", 2.0), (" w ", 3.0)] {
        assert_eq!(channel(column).unwrap().record.values()[0], value, "{column}");
    }
    let missing = channel("x").unwrap_err().to_string();
    assert_eq!(missing, "there is no column \"x\"; the file has: \"time\", \"v\", \"V\", \"w\"");
    assert!(says(&channel("4"), "there is no column"));
    let twice = Reader::default().channel("A").read_from(&b"t,a,a\n0,1,2\n1,1,2\n"[..]);
    assert!(says(&twice, "columns are called"));
    let same = Reader::default().channel("v").time("v").read_from(text.as_bytes());
    assert!(says(&same, "cannot be both the time and the channel"));
}

#[test]
fn a_name_without_its_unit_is_enough_where_one_column_has_it() {
    let text =
        "t [s],Velocity [m/s],x (left) [mm],x (right) [mm],v,v [mm/s],a / (m/s^2)\n0,1,2,3,4,5,6\n1,1,2,3,4,5,6\n";
    let channel = |column: &str| Reader::default().channel(column).read_from(text.as_bytes());
    for (column, found) in [("Velocity", 1), ("velocity", 1), ("v", 4), ("v [mm/s]", 5), ("a", 6)] {
        assert_eq!(channel(column).unwrap().record.values()[0], f64::from(found), "{column}");
    }
    assert_eq!(channel("velocity").unwrap().channel, "Velocity [m/s]", "the unit is that of the column");
    assert_eq!(
        channel("x").unwrap_err().to_string(),
        "2 columns are called \"x\": \"x (left) [mm]\" at position 2, \"x (right) [mm]\" at position 3; choose one by its \
         whole name or by its position, counted from 0"
    );
    assert!(says(&channel("vel"), "there is no column \"vel\""), "a part of a name is none");
    let timed = Reader::default().time("t").channel("v").read_from(text.as_bytes()).unwrap();
    assert_eq!(timed.time.as_deref(), Some("t [s]"));
}

#[test]
fn channels_are_all_columns_but_the_time() {
    let channels = |text: &str| Reader::default().text_channels(text.as_bytes()).unwrap();
    let positions = |text: &str| channels(text).into_iter().map(|(index, _)| index).collect::<Vec<_>>();
    assert_eq!(channels("t,v\n0,1\n1,2\n"), [(1, "v".to_owned())]);
    assert_eq!(positions("x,time,v,v\n0,1,a,2\n1,2,b,3\n"), [0, 2, 3], "text in other columns does not matter");
    assert_eq!(positions("0.1,5,7\n0.2,6,7\n0.3,7,7\n"), [1, 2], "the first column is time by nature");
    assert_eq!(positions("a,b\n3,5\n1,6\n2,7\n"), [0, 1], "no column is time");
    assert_eq!(positions("date,b\nMonday,5\nMonday,6\n"), [0, 1], "no column is time");
    assert_eq!(positions("4\n5\n6\n"), [0], "a single column is no time");
    let other = Reader::default().time("b").text_channels(&b"t,a,b\n0,1,2\n"[..]).unwrap();
    assert_eq!(other.iter().map(|(index, _)| *index).collect::<Vec<_>>(), [0, 1]);
    assert!(says(&Reader::default().text_channels(&b""[..]), "empty or holds comments only"));
    assert!(says(&Reader::default().open("/no/such/file.csv"), "cannot read"));
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
        assert!(error.to_string().contains("not finite; the first is sample"), "{number}");
    }
    assert!(says(&Reader::default().read_text(io::repeat(b'1')), "is longer than"));
    assert!(says(&Reader::default().separator(b'.').read_from(&b""[..]), "cannot separate columns"));
    assert!(says(&Reader::default().read("/no/such/file.csv"), "cannot read"));
    // Latin-1 in a header is not UTF-8, and no reason to stop.
    assert!(Reader::default().read_from(&b"t,\xb0C\n0,1\n1,2\n"[..]).is_ok());
}

#[test]
fn text_of_any_bytes_never_panics() {
    let mut random = crate::tests::synthetic::Noise::new(5);
    let alphabet = b"0123456789.,;\t\n\r\"#%-+eE tv\xff\0";
    for _ in 0..20_000 {
        let length = random.next() % 40;
        let text: Vec<u8> = (0..length).map(|_| alphabet[random.next() as usize % alphabet.len()]).collect();
        // Either outcome is right; a panic is not.
        let _ = Reader::default().read_from(&text[..]);
        let _ = Reader::default().rate(10.0).separator(b';').read_from(&text[..]);
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
    let reading = Reader::default().read_text(header.chain(rows)).unwrap();
    assert_eq!((reading.record.len(), reading.record.rate()), (100_000, 1000.0));
    assert_eq!(reading.record.values()[99_999], f64::from(99_999 % 7));
}

#[test]
fn measured_records_are_read_by_themselves() {
    let wheel = Reader::default().read(measured("bicycle_wheel_radial_gyro.csv")).unwrap();
    assert_eq!((wheel.record.len(), wheel.record.rate(), &wheel.channel[..]), (1001, 500.0, "angular_velocity"));
    assert_eq!(wheel.record.values()[0], 3.236_790_061_330_015);
    let pendulum = Reader::default()
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
        let reading = Reader::default().read_from(&text(name, ["0", "0.001", "0.002"])[..]).unwrap();
        assert_eq!((reading.record.rate(), reading.time.as_deref()), (1000.0, Some(name)), "{name}");
    }
    for name in ["Time (msec)", "Timestamp (ms)", "time_millis", "millis", "timeMs", "Time [Milliseconds]", "x [ms]"] {
        let reading = Reader::default().read_from(&text(name, ["10", "11", "12"])[..]).unwrap();
        assert_eq!((reading.record.rate(), reading.time.as_deref()), (1000.0, Some(name)), "{name}");
    }
    for name in ["Time [µs]", "time_us", "micros", "Timestamp (usec)"] {
        let reading = Reader::default().read_from(&text(name, ["0", "1000", "2000"])[..]).unwrap();
        assert_eq!((reading.record.rate(), &reading.time.unwrap()[..]), (1000.0, name), "{name}");
    }
    let minutes = Reader::default().read_from(&text("Time (min)", ["0", "0.5", "1.0"])[..]).unwrap();
    assert!((minutes.record.interval() - 30.0).abs() < 1e-12);

    for (name, unit) in [("Time (jiffies)", "jiffies"), ("Time [samples]", "samples"), ("time/rev", "rev")] {
        for reader in [Reader::default(), Reader::default().time(name)] {
            let error = reader.read_from(&text(name, ["0", "1", "2"])[..]).unwrap_err();
            let expected =
                format!("the time stamps \"{name}\" are in \"{unit}\", which is no unit of time that is known");
            assert!(matches!(error, RecordError::TimeAxis { .. }));
            assert!(error.to_string().starts_with(&expected), "{name}: {error}");
        }
        let rate = Reader::default().rate(50.0).read_from(&text(name, ["0", "1", "2"])[..]).unwrap();
        assert_eq!((&rate.channel[..], rate.record.rate()), ("v", 50.0));
    }
}

#[test]
fn a_counter_of_samples_is_no_time() {
    for name in ["Sample", "", "Unnamed: 0", "index", "N° no.", "Frame No.", "x", "Timestamp"] {
        let text = format!("{name},v\n0,1.5\n1,2.5\n2,4.5\n");
        let error = Reader::default().read_from(text.as_bytes()).unwrap_err();
        let expected = format!("\"{name}\" counts samples and tells no time");
        assert!(error.to_string().starts_with(&expected), "{name}: {error}");
        let rate = Reader::default().rate(50.0).read_from(text.as_bytes()).unwrap();
        assert_eq!((&rate.channel[..], rate.record.values()), ("v", &[1.5, 2.5, 4.5][..]), "{name}");
    }
    assert!(says(&read_text("0,1.5\n1,2.5\n2,1\n"), "counts samples and tells no time"));
    let stated = Reader::default().time(0).read_from(&b"0,1.5\n1,2.5\n2,1.5\n"[..]).unwrap();
    assert_eq!(stated.record.rate(), 1.0, "who says that it is time is believed");
    // Beside time, a counter is no channel unless it is asked for.
    let pandas = ",time,v\n0,0.0,1.5\n1,0.5,2.5\n2,1.0,4.5\n";
    let reading = read_text(pandas).unwrap();
    assert_eq!((&reading.channel[..], reading.record.rate()), ("v", 2.0));
    assert_eq!(Reader::default().text_channels(pandas.as_bytes()).unwrap(), [(2, "v".to_owned())]);
    // Temperatures, angles and frequencies are no time.
    for name in ["T [K]", "angle [deg]", "f (Hz)"] {
        let text = format!("{name},v\n0.1,1.5\n0.2,2.5\n0.3,4.5\n");
        assert!(says(&read_text(&text), "the sampling rate is not known"), "{name}");
    }
}

/// As the programs write them, with numbers of our own; `µ` in Latin-1.
mod programs {
    use super::*;

    fn reading(text: &str) -> Reading {
        let bytes: Vec<u8> = text.chars().map(|letter| u8::try_from(u32::from(letter)).unwrap()).collect();
        Reader::default().read_from(&bytes[..]).unwrap_or_else(|error| panic!("{error}:\n{text}"))
    }

    #[test]
    fn labview() {
        let head = "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\n\
                    Multi_Headings\tYes\nX_Columns\tOne\nTime_Pref\tRelative\nDate\t2021/03/04\nTime\t10:11:12,5\n\
                    ***End_of_Header***\t\n\t\nChannels\t2\t\t\nSamples\t4\t4\t\nDate\t2021/03/04\t2021/03/04\t\n\
                    Y_Unit_Label\tVolts\tVolts\t\nX_Dimension\tTime\tTime\t\nX0\t0,0\t0,0\t\nDelta_X\t0,000500\t0,000500\t\n\
                    ***End_of_Header***\t\t\t\n";
        let rows = "0,000000\t1,5\t-2,0\n0,000500\t1,25\t-1,0\n0,001000\t0,75\t-0,5\n0,001500\t0,5\t0,25\n";
        let one = reading(&format!("{head}X_Value\tgyro\tforce\tComment\n{rows}"));
        assert_eq!((one.record.values(), one.record.rate()), (&[1.5, 1.25, 0.75, 0.5][..], 2000.0));
        assert_eq!(
            (&one.channel[..], one.columns),
            ("gyro [Volts]", ["X_Value", "gyro [Volts]", "force [Volts]"].map(String::from).to_vec())
        );
        // Without a column of time, its header tells the interval.
        let rows = "\t1,5\t-2,0\n\t1,25\t-1,0\n\t0,75\t-0,5\n\t0,5\t0,25\n";
        let none = reading(&format!("{head}X_Value\tgyro\tforce\tComment\n{rows}"));
        assert_eq!((none.record.values(), none.record.rate()), (&[1.5, 1.25, 0.75, 0.5][..], 2000.0));
        let expected = Sampling::IntervalVariable { name: "Delta_X".into(), interval: 5e-4 };
        assert_eq!((&none.channel[..], none.time, none.sampling), ("gyro [Volts]", None, expected));
    }

    #[test]
    fn tektronix() {
        let newer = "Model,DPO2024B\nFirmware Version,1.56\n\nWaveform Type,ANALOG\nHorizontal Units,s\nSample Interval,4e-06\n\
                     Record Length,4\nProbe Attenuation,1.0\nVertical Units,V\n,\n,\nLabel,\nTIME,CH1\n";
        let rows = "-8.0e-06,0.04\n-4.0e-06,0.02\n0.0e+00,0.01\n4.0e-06,0.00\n";
        let found = reading(&format!("{newer}{rows}"));
        assert_eq!((found.record.rate(), &found.channel[..]), (250_000.0, "CH1"));
        assert_eq!((found.record.start(), found.record.values()), (-8e-6, &[0.04, 0.02, 0.01, 0.0][..]));
        // The older ones write the header beside the first rows.
        let older = "Record Length,2.500000e+03,,-0.000500,  0.0160,\nSample Interval,1.000000e-04,,-0.000400,  0.0200,\n\
                     Trigger Point,1.250000000000e+03,,-0.000300,  0.0240,\n,,,-0.000200,  0.0280,\n,,,-0.000100,  0.0320,\n";
        let found = reading(older);
        assert_eq!((found.record.rate(), found.record.start()), (10_000.0, -5e-4));
        assert_eq!((&found.channel[..], found.record.values()), ("4", &[0.016, 0.02, 0.024, 0.028, 0.032][..]));
    }

    #[test]
    fn rigol() {
        let found = reading(
            "X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-6.000000e-03,1.000000e-05\n\
             0,1.20e+00,2.0e-01,,\n1,1.60e+00,1.0e-01,,\n2,2.00e+00,3.0e-01,,\n",
        );
        assert_eq!((&found.channel[..], found.record.values()), ("CH1 [Volt]", &[1.2, 1.6, 2.0][..]));
        assert!((found.record.rate() / 1e5 - 1.0).abs() < 1e-12);
        assert_eq!(found.sampling.to_string(), "found from the interval of 0.00001 s in the variable \"X Increment\"");
        let newer = reading("Time(s),CH1(V)\n-0.0060,1.2\n-0.0059,1.6\n-0.0058,2.0\n");
        assert!((newer.record.interval() - 1e-4).abs() < 1e-15);
    }

    #[test]
    fn picoscope() {
        let found = reading("Time;Channel A;Channel B\n(µs);(mV);(V)\n\n-10,0;0,5;1,5\n-5,0;0,25;1,0\n0,0;0,125;0,5\n");
        assert_eq!((found.record.interval(), &found.channel[..]), (5e-6, "Channel A [mV]"));
        assert_eq!(crate::units::label::Label::from(&found).unit().map(crate::units::WrittenUnit::si), Some("V"));
        assert_eq!(found.record.values(), [0.5, 0.25, 0.125]);
        // Either name chooses the channel.
        let text = "Time,A,B\n(ms),(V),(V)\n0.0,1,4\n0.5,2,5\n1.0,3,6\n";
        for name in ["B", "b", "B [V]"] {
            let found = Reader::default().channel(name).read_from(text.as_bytes()).unwrap();
            assert_eq!((found.record.values(), found.record.rate()), (&[4.0, 5.0, 6.0][..], 2000.0), "{name}");
        }
    }

    #[test]
    fn catman() {
        let found = reading(
            "HBM_CATMANDATAFILE_40\t\nNo test\t\nT0 = 04.03.2021 10:11:12\t\nZeit  1 - Standardmessrate\tMX840_1 CH 1\tKraft\n\
             s\tmm\tN\n0,0000\t1,50\t12,0\n0,0005\t1,25\t12,5\n0,0010\t0,75\t13,0\n",
        );
        assert_eq!((found.record.rate(), &found.channel[..]), (2000.0, "MX840_1 CH 1 [mm]"));
        assert_eq!(found.time.as_deref(), Some("Zeit  1 - Standardmessrate [s]"));
        let inline = reading("Zeit  1 - Standardmessrate [ms]\tx [µm]\n0,0\t1,50\n0,5\t1,25\n1,0\t0,75\n");
        assert_eq!((inline.record.rate(), &inline.channel[..]), (2000.0, "x [µm]"));
    }

    #[test]
    fn spreadsheets_and_numpy() {
        let excel = reading("sep=;\nt [ms];v [m/s]\n0,5;1,5\n1,0;1,25\n1,5;0,75\n");
        assert_eq!((excel.record.rate(), &excel.channel[..]), (2000.0, "v [m/s]"));
        let bar = reading("sep=|\nt|v\n0.5|1.5\n1.0|1.25\n1.5|0.75\n");
        assert_eq!((bar.record.rate(), bar.record.values()), (2.0, &[1.5, 1.25, 0.75][..]));
        let savetxt = reading(
            "0.000000000000000000e+00 1.500000000000000000e+00\n5.000000000000000000e-01 -1.250000000000000000e+00\n\
             1.000000000000000000e+00 7.500000000000000000e-01\n",
        );
        assert_eq!((savetxt.record.rate(), savetxt.record.values()), (2.0, &[1.5, -1.25, 0.75][..]));
        let aligned = reading("# t [ms]   v [mm/s]\n    0.00      1.500\n    0.50     -1.250\n   10.00e-1  -0.75\n");
        assert_eq!((aligned.record.rate(), &aligned.channel[..]), (2000.0, "v [mm/s]"));
        let named =
            reading("  t [s]   angular velocity   x\n  0,0     1,5     3\n  0,5     1,25   4\n  1,0     0,75   5\n");
        assert_eq!((named.record.values(), &named.channel[..]), (&[1.5, 1.25, 0.75][..], "angular velocity"));
        let comma = reading("# t,v\n0.0,1.5\n0.5,1.25\n1.0,0.75\n");
        assert_eq!((comma.time.as_deref(), &comma.channel[..]), (Some("t"), "v"));
    }

    #[test]
    fn lines_above_may_be_skipped() {
        let text = "7,8\n9,1\nt,v\n0.0,1.5\n0.5,2.5\n";
        let found = Reader::default().skip(2).read_from(text.as_bytes()).unwrap();
        assert_eq!((found.record.values(), found.record.rate()), (&[1.5, 2.5][..], 2.0));
        let error = Reader::default().skip(2).read_from("a\nb\nt,v\n0,1\n1,x\n2,3\n".as_bytes()).unwrap_err();
        assert_eq!(error.to_string(), "line 5, column \"v\": \"x\" is not a number");
        let all = reading("Logger 4711\nStart 10:11\n\n0.0;1.5\n0.5;1.25\n1.0;0.75\n");
        assert_eq!((all.record.rate(), &all.columns[..]), (2.0, &["0".to_owned(), "1".to_owned()][..]));
    }
}

#[test]
fn decimal_commas_without_another_separator() {
    let read = |text: &str| Reader::default().rate(10.0).read_from(text.as_bytes());
    for (text, expected) in [
        ("1,5\n1,05\n0,75\n", &[1.5, 1.05, 0.75][..]),
        ("v\n1,5\n1,25\n0,75\n", &[1.5, 1.25, 0.75]),
        ("angular velocity\n1,5\n1,25\n", &[1.5, 1.25]),
        ("1,5\n2\n-0,5\n", &[1.5, 2.0, -0.5]),
        ("0,1\n1,3\n2,5\n", &[1.0, 3.0, 5.0]),
    ] {
        assert_eq!(read(text).unwrap().record.values(), expected, "{text:?}");
    }
    let error = read("4,1\n2,2\n9,5\n").unwrap_err();
    assert!(error.to_string().starts_with("\"4,1\" may be two whole numbers"), "{error}");
    let separated = |separator| Reader::default().rate(10.0).separator(separator).read_from(&b"4,1\n2,2\n"[..]);
    assert_eq!(separated(b',').unwrap().record.values(), [4.0, 2.0]);
    assert_eq!(separated(b';').unwrap().record.values(), [4.1, 2.2]);
}

#[test]
fn a_file_cut_off_within_its_last_number_is_refused() {
    let rows = |format: fn(f64) -> String| -> String {
        let value = |i: u32| (f64::from(i) * 0.7).sin();
        let row = |i: u32| format!("{:.3};{}\n", f64::from(i) / 1e3, format(value(i)));
        (0..40).map(row).collect()
    };
    let formats: [fn(f64) -> String; 4] = [
        |value| format!("{value:.4}"),
        |value| format!("{value:.5e}"),
        |value| format!("{value:.3}").replace('.', ","),
        |value| format!("{:+06}", (value * 1e4) as i32),
    ];
    for format in formats {
        let text = format!("t;v\n{}", rows(format).replace('.', if format(0.1).contains(',') { "," } else { "." }));
        assert_eq!(values(&text).len(), 40);
        assert_eq!(values(text.trim_end()).len(), 40, "the last line need not end");
        let last = text.trim_end().rfind(';').unwrap() + 1;
        for length in last..text.len() - 1 {
            let error = read_text(&text[..length]).unwrap_err();
            let shown = error.to_string();
            assert!(matches!(error, RecordError::Damaged { line: Some(41), .. }), "{error}");
            assert!(shown.contains("is cut off") || shown.contains("is not a number"), "{error}");
        }
    }
}

#[test]
fn a_stray_quote_costs_no_memory_and_no_rows() {
    let row = |i: u32| format!("{:.3},{}\n", f64::from(i) / 1e3, i % 7);
    let rows: String = (0..1000).map(row).collect();
    let text = format!("t,\"v\n{rows}");
    let reading = read_text(&text).unwrap();
    assert_eq!((reading.record.len(), &reading.channel[..]), (1000, "\"v"));
    let error = read_text(&text.replace("0.500,3", "0.500,\"3")).unwrap_err().to_string();
    assert_eq!(error, "line 502, column \"\"v\": \"\"3\" is not a number");
}

#[test]
fn no_row_is_lost_above_the_first() {
    for (text, line) in
        [("t,v\n0,n/a\n1,5\n2,6\n", 2), ("t,v\n,1\n0.5,2\n1.0,3\n", 2), ("t,v\n0,1\n1,x\n2,3\n3,4\n", 3)]
    {
        let error = read_text(text).unwrap_err();
        assert!(matches!(error, RecordError::Damaged { line: Some(at), .. } if at == line), "{text:?}: {error}");
    }
}

#[test]
fn a_record_whose_times_are_not_uniform_is_refused_with_a_remedy() {
    let row = |i: u32| format!("{:.6},1\n", 1e3 * f64::from(i) / 200.0 + if i.is_multiple_of(3) { 0.6 } else { 0.0 });
    let error = read_text(&format!("t [ms],v\n{}", (0..600).map(row).collect::<String>())).unwrap_err().to_string();
    assert!(error.ends_with("only their stamps are not, or else resample them first"), "{error}");
}

#[test]
fn values_outside_of_the_span_may_be_missing() {
    let row =
        |i: u32| format!("{},{}\n", f64::from(i) / 8.0, if [1, 7].contains(&i) { f64::NAN } else { f64::from(i) });
    let text = format!("t,v\n{}", (0..9).map(row).collect::<String>());
    let span = |from: f64, to: f64| Reader::default().from(from).to(to).read_from(text.as_bytes());
    let record = span(0.25, 0.75).unwrap().record;
    assert_eq!((record.start(), record.values()), (0.25, &[2.0, 3.0, 4.0, 5.0, 6.0][..]));
    let late = Reader::default().rate(8.0).from(1.0).read_from(text.as_bytes()).unwrap().record;
    assert_eq!((late.start(), late.values()), (1.0, &[8.0][..]));
    let error = span(0.25, 1.0).unwrap_err();
    assert!(matches!(error, RecordError::Values { index: 7, .. }), "{error}");
    assert!(
        error.to_string().starts_with("1 of 7 samples is not finite; the first is sample 7 (at 0.875 s)"),
        "{error}"
    );
    assert!(says(&span(2.0, 3.0), "no sample lies between 2 s and 3 s; the record spans 0 s to 1 s"));
    let file = Reader::default().from(0.25).to(0.75).parse(text.as_bytes()).unwrap();
    assert_eq!(file.channels().unwrap()[0].rate, Some(8.0), "a channel that can be read has a rate");
}

#[test]
fn thousands_and_quoted_decimal_commas() {
    for text in [
        "t [s];v [m/s]\n0,0;299,5\n0,5;-6.174,0\n1,0;12.345,25\n",
        "t [s],v [m/s]\n\"0,0\",\"299,5\"\n\"0,5\",\"-6174,0\"\n\"1,0\",\"12345,25\"\n",
        "t [s],v [m/s]\n0.0,299.5\n0.5,\"-6,174\"\n1.0,\"12,345.25\"\n",
        "t [s]\tv [m/s]\n0,0\t299,5\n0,5\t-6 174,0\n1,0\t12\u{a0}345,25\n",
    ] {
        let reading = read_text(text).unwrap_or_else(|error| panic!("{text}: {error}"));
        assert_eq!((reading.record.values(), reading.record.rate()), (&[299.5, -6174.0, 12_345.25][..], 2.0), "{text}");
    }
}

#[test]
fn text_in_utf_16_is_read_with_and_without_its_mark() {
    let text = "Zeit [s]\tv [µm/s]\r\n0,0\t1,5\r\n0,5\t2,5\r\n1,0\t-1\r\n";
    let units: Vec<u16> = text.encode_utf16().collect();
    let little: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
    let big: Vec<u8> = units.iter().flat_map(|unit| unit.to_be_bytes()).collect();
    for bytes in [[&b"\xff\xfe"[..], &little].concat(), [&b"\xfe\xff"[..], &big].concat(), little, big] {
        let reading = Reader::default().read_from(bytes).unwrap();
        assert_eq!((reading.record.values(), &reading.channel[..]), (&[1.5, 2.5, -1.0][..], "v [µm/s]"));
    }
}

#[cfg(feature = "gzip")]
#[test]
fn a_compressed_file_is_what_is_in_it() {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    io::Write::write_all(&mut encoder, b"t [s],v [m/s]\n0,1.5\n1,2.5\n").unwrap();
    let bytes = encoder.finish().unwrap();
    assert_eq!(Reader::default().read_from(&bytes[..]).unwrap().record.values(), [1.5, 2.5]);
    assert!(says(&Reader::default().read_from(&bytes[..20]), "the gzip file is damaged"));
}

#[test]
fn times_of_day_count_from_the_first() {
    for (name, stamps) in [
        ("timestamp", ["2024-05-02 23:59:59.999", "2024-05-03 00:00:00.001", "2024-05-03 00:00:00.003"]),
        ("Time", ["10:00:00.000", "10:00:00.002", "10:00:00.004"]),
        ("Uhrzeit", ["10:00:00,000", "10:00:00,002", "10:00:00,004"]),
        ("Time [hh:mm:ss.fff]", ["00:00.000", "00:00.002", "00:00.004"]),
        ("", ["2024-05-02T10:00:00.000Z", "2024-05-02T10:00:00.002Z", "2024-05-02T10:00:00.004Z"]),
    ] {
        let text = format!("{name};v\n{};1\n{};2\n{};4\n", stamps[0], stamps[1], stamps[2]);
        let reading = read_text(&text).unwrap_or_else(|error| panic!("{text}: {error}"));
        assert_eq!((reading.record.start(), reading.record.rate()), (0.0, 500.0), "{text}");
        let sampling = reading.sampling.to_string();
        assert!(sampling.ends_with(&format!("counted from the first, {}", stamps[0])), "{sampling}");
    }
    let motion = Reader::default().channel("v").read_from(&b"t,v\n0,10:00:01\n1,10:00:02\n"[..]);
    assert!(says(&motion, "holds times of day, such as 10:00:01, and no motion"));
}

#[test]
fn days_of_a_calendar_are_no_seconds() {
    for day in [46_085.5, 739_000.25] {
        let row = |i: u32| format!("{:.12},{}\n", day + f64::from(i) * 0.002 / 86_400.0, i % 7);
        let text = format!("time,v [mm/s]\n{}", (0..500).map(row).collect::<String>());
        let reading = read_text(&text).unwrap();
        assert!(
            (reading.record.rate() - 500.0).abs() < 0.01 && reading.record.start() == 0.0,
            "{}",
            reading.record.rate()
        );
        assert!(matches!(reading.sampling, Sampling::Days { first, .. } if first == day), "{}", reading.sampling);
    }
    let seconds = read_text("time,v\n46085.500,1\n46085.501,2\n46085.502,1\n").unwrap();
    assert!((seconds.record.interval() - 1e-3).abs() < 1e-9, "a clock that has run for half a day");
}

#[test]
fn the_unit_of_time_may_be_said() {
    let reader = Reader::default().time_unit("ms");
    for text in ["t,v\n0,1\n2,2\n4,1\n", "1234, 0.1\n1236, 0.2\n1238, 0.1\n", "t [s],v\n0,1\n2,2\n4,1\n"] {
        assert_eq!(reader.read_from(text).unwrap().record.rate(), 500.0, "{text}");
    }
    let counts = message("1234, 0.1\n1236, 0.2\n1238, 0.1\n");
    assert!(counts.ends_with("in steps of 2 it may be milliseconds, say their unit"), "{counts}");
    assert!(says(&Reader::default().time_unit("mm").read_from("t,v\n0,1\n2,2\n"), "\"mm\" is no unit of time"));
}

#[test]
fn empty_rows_at_the_end_lose_nothing() {
    let text = "t [s],v [m/s],\n0.0,1.5,\n0.5,2.5,\n1.0,-1,\n,,\n,,\n,,\n,,\n";
    assert_eq!(values(text), [1.5, 2.5, -1.0]);
    assert!(says(&read_text(",,\n,,\n"), "no rows"));
}

#[test]
fn damaged_lines_are_named_and_used_around_on_request() {
    let text = "4, 0.01\u{fffd}7\n0.0, 1.0\n0.5, 2.0\n1.0, 3?5\n1.5, 4.0\n2.0\n2.5, 6.0\n3.0, 7.0\n3";
    assert!(message(text).starts_with("line 1, column \"1\": \"0.01\u{fffd}7\" is not a number"), "{}", message(text));
    let reading = Reader::default().repair().read_from(text).unwrap();
    assert_eq!((reading.record.values(), reading.record.rate()), (&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0][..], 2.0));
    let serial =
        text.replace("0.0,", "1234,").replace("0.5,", "1236,").replace("1.0,", "1238,").replace("1.5,", "1240,");
    let serial = serial.replace("2.5,", "1244,").replace("3.0,", "1246,");
    let file = Reader::default().repair().time_unit("ms").parse(serial).unwrap();
    assert_eq!(file.channels().unwrap().len(), 1, "the first column is time in spite of the damage in others");
    assert_eq!(file.reading().unwrap().record.rate(), 500.0);
    assert_eq!(reading.remarks.len(), 5, "{:?}", reading.remarks);
    assert_eq!(reading.remarks[1], "line 4, column \"1\": \"3?5\" is not a number; the line was not used");
    assert!(reading.remarks[4].starts_with("straight lines between their neighbours stand for 2 damaged lines"));
}

#[test]
fn tables_of_a_text_are_joined_or_told() {
    let goes_on = "t [s],v [m/s]\n0,1\n1,2\n2,3\nt [s],v [m/s]\n3,4\n4,5\n5,6\n";
    let joined = read_text(goes_on).unwrap();
    assert_eq!(joined.record.len(), 6);
    assert!(joined.remarks[0].starts_with("the file has 2 tables whose times go on"), "{:?}", joined.remarks);
    let second = Reader::default().table(2).read_from(goes_on).unwrap().record;
    assert_eq!((second.start(), second.values()), (3.0, &[4.0, 5.0, 6.0][..]));
    let begins_anew = goes_on.replace("\n3,4", "\n0,4").replace("\n4,5", "\n1,5").replace("\n5,6", "\n2,6");
    let first = read_text(&begins_anew).unwrap();
    assert_eq!(first.record.values(), [1.0, 2.0, 3.0]);
    assert!(first.remarks[0].contains("the first was read, which has 3 of 6 samples; `table`"), "{:?}", first.remarks);
    assert!(says(&Reader::default().table(3).read_from(&begins_anew[..]), "there is no table 3; the file has 2"));
}

#[test]
fn segments_of_labview_have_headers_of_their_own() {
    let segment = |begin: f64| {
        let row = |i: u32| format!("{:.3}\t{}\t\n", begin + f64::from(i) * 2e-3, f64::from(i) + begin);
        format!(
            "\t\nChannels\t1\t\nSamples\t3\t\nY_Unit_Label\tmm/s\t\nX_Dimension\tTime\t\nX0\t{begin:.3E}\t\nDelta_X\t0.002\t\n\
             ***End_of_Header***\t\t\nX_Value\tVelocity\tComment\n{}{}{}",
            row(0),
            row(1),
            row(2)
        )
    };
    let head = "LabVIEW Measurement\t\nSeparator\tTab\nX_Columns\tOne\n***End_of_Header***\t\n";
    let both = read_text(&format!("{head}{}{}", segment(0.0), segment(0.006))).unwrap();
    assert_eq!((both.record.len(), both.record.rate(), &both.channel[..]), (6, 500.0, "Velocity [mm/s]"));
    let apart = format!("{head}{}{}", segment(0.0), segment(1.0));
    let first = read_text(&apart).unwrap();
    assert_eq!((first.record.values(), first.remarks.len()), (&[0.0, 1.0, 2.0][..], 1));
    let second = Reader::default().table(2).read_from(apart).unwrap().record;
    assert_eq!((second.start(), second.values()), (1.0, &[1.0, 2.0, 3.0][..]));
}

#[test]
fn oscilloscopes_and_loggers() {
    let rigol = read_text("X,CH1,Start,Increment,\nSequence,Volt,0.0e+00,2.0e-03\n0,1.5,\n1,2.5,\n2,-1,\n").unwrap();
    assert_eq!((rigol.record.values(), rigol.record.rate()), (&[1.5, 2.5, -1.0][..], 500.0));
    let express = "channel names: \nDev1_ai0\tDev1_ai1\nstart times: \n3/4/2026 13:59:59.0\t3/4/2026 13:59:59.0\ndt: \n\
                   0.001000\t0.001000\ndata:\n1.5E-01\t1\n2.5E-01\t2\n-1E-1\t3\n";
    let express = Reader::default().channel("Dev1_ai1").read_from(express).unwrap();
    assert_eq!((express.record.values(), express.record.rate()), (&[1.0, 2.0, 3.0][..], 1000.0));
    let one = "channel names: \nDev1_ai0\nstart times: \n3/4/2026 13:59:59.0\ndt: \n0.001000\ndata:\n1.5E-01\n2.5E-01\n-1E-1\n";
    let one = read_text(one).unwrap();
    assert_eq!(
        (one.record.values(), one.record.rate(), &one.channel[..]),
        (&[0.15, 0.25, -0.1][..], 1000.0, "Dev1_ai0")
    );
}

#[test]
fn a_gap_is_named_with_both_ends_and_the_record_beside_it_is_read() {
    let row = |i: u32| format!("{:.3},{i}\n", f64::from(if i < 50 { i } else { i + 20 }) * 1e-3);
    let text = format!("t [s],v\n{}", (0..100).map(row).collect::<String>());
    let refused = message(&text);
    assert!(
        refused.ends_with(
            "missing samples: 20, and nothing is put in their place; use the record up to 0.049 s or from 0.07 s on"
        ),
        "{refused}"
    );
    let before = Reader::default().to(0.049).read_from(text.as_bytes()).unwrap().record;
    assert_eq!((before.len(), before.start()), (50, 0.0));
    let behind = Reader::default().from(0.07).read_from(text.as_bytes()).unwrap().record;
    assert_eq!((behind.len(), behind.start()), (50, 0.07));
    let row = |i: u32| format!("{:.2},{i}\n", f64::from(i) * 1e-3);
    let rounded = message(&format!("t [s],v\n{}", (0..1001).map(row).collect::<String>()));
    assert!(
        rounded.contains("rounded to 0.01 s, more than an interval; their span says about 1000 Hz; give the rate"),
        "{rounded}"
    );
}

#[test]
fn lines_above_the_table_are_found() {
    let rows = "0.0,1.5\n0.5,2.5\n1.0,-1\n";
    let names = "time [s],velocity [mm/s]\n";
    for above in [
        format!("Operator,Bob\nSpecimen,12\nDate,2024-01-02\n{names}"),
        format!("My test, run 3, hot, dry\n\nMass [kg],10.391\n{names}"),
        format!("a,b,c,d\n1,2,3,4\n{names}"),
        format!("Start,10:00:00.000\n{names}-----,-----\n"),
        "time,velocity\n[s],[mm/s]\n".to_owned(),
        format!("[Header]\nName=abc\n[Data]\n{names}"),
    ] {
        let reading = read_text(&format!("{above}{rows}")).unwrap_or_else(|error| panic!("{above}: {error}"));
        assert_eq!((reading.record.values(), reading.record.rate()), (&[1.5, 2.5, -1.0][..], 2.0), "{above}");
        assert_eq!(reading.channel, "velocity [mm/s]", "{above}");
    }
}
