//! Time stamps, their units and their steps.

use super::*;

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
    let as_channel = Reader::default().channel(0).read_from(&b"time [s],v\n0,1\n1,2\n"[..]);
    assert!(says(&as_channel, "column \"time [s]\" is the time, and no other column tells it"));
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
        rounded.contains(
            "rounded to 0.01 s, more than an interval; a line through them says about 1000 Hz; give the rate"
        ),
        "{rounded}"
    );
}

#[test]
fn rows_without_a_number_leave_gaps_where_any_spacing_is_taken() {
    let text = "t,v,T\n0,1,20\n1,,\n2,3,\n3,NaN,21\n4,5,\n5,6,\n";
    let found = Reader::default().any_spacing().channel("v").read_from(text).unwrap();
    assert_eq!((found.record.values(), found.record.time(1)), (&[1.0, 3.0, 5.0, 6.0][..], 2.0));
    assert_eq!(found.remarks, ["2 of 6 rows have no number in the channel and were left out"]);
    let slow = Reader::default().any_spacing().channel("T").read_from(text).unwrap().record;
    assert_eq!((slow.values(), slow.end()), (&[20.0, 21.0][..], 3.0));
    let own = "t_v,v,t_T,T\n0,1,0,20\n1,2,3,21\n2,3,,\n3,4,,\n";
    let found = Reader::default().any_spacing().time("t_T").channel("T").read_from(own).unwrap();
    assert_eq!((found.record.values(), found.remarks.len()), (&[20.0, 21.0][..], 0));
    assert!(says(&Reader::default().channel("v").read_from(text), "line 3, column \"v\": \"\" is not a number"));
    let repaired =
        Reader::default().any_spacing().repair().channel("v").read_from("t,v\n0,1\n1,NaN\n2,3\n3,4\n").unwrap();
    assert_eq!(repaired.record.values(), [1.0, 2.0, 3.0, 4.0]);
}

#[test]
fn times_since_1970_are_told_by_their_size() {
    for (unit, factor) in [("ms", 1e3), ("µs", 1e6), ("ns", 1e9)] {
        for name in ["timestamp", "rosbagTimestamp", "x", ""] {
            let stamp = |time: f64| (factor * (1_714_644_000.123 + time)).round();
            let rows = [0.0, 0.002, 0.004].map(|time| format!("{},{}\n", stamp(time), 1.5 + time));
            let reading = read_text(&format!("{name},v\n{}", rows.concat())).unwrap();
            assert_eq!((reading.record.rate(), reading.record.start()), (500.0, 0.0), "{name}, {unit}");
            let expected = Sampling::Epoch { name: name.into(), unit, first: stamp(0.0) };
            assert_eq!((reading.sampling, &*reading.channel), (expected, "v"), "{name}");
        }
    }
}

#[test]
fn ticks_tell_time_in_a_unit_of_time_only() {
    for (head, factor) in
        [("tick_us;v", 1e6), ("ticks [ms];v", 1e3), ("Datum/Zeit;v", 1.0), ("Date Time;v", 1.0), (";v", 1.0)]
    {
        let rows = [0.0, 0.002, 0.004].map(|time| format!("{};1.5\n", factor * time));
        let reading = read_text(&format!("{head}\n{}", rows.concat())).unwrap();
        assert_eq!((reading.record.rate(), &*reading.channel), (500.0, "v"), "{head}");
    }
    let counts = read_text("ticks;v\n0;1\n2;2\n4;1\n").unwrap_err().to_string();
    assert!(counts.contains("counts samples"), "{counts}");
}
