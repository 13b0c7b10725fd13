//! Texts as programs and instruments write them, with numbers of our own; `µ` in Latin-1.

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
    let newer = "Model,DPO2024B\nFirmware Version,1.56\n\nWaveform Type,ANALOG\nHorizontal Units,s\nSample \
                 Interval,4e-06\n\
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
        "HBM_CATMANDATAFILE_40\t\nNo test\t\nT0 = 04.03.2021 10:11:12\t\nZeit  1 - Standardmessrate\tMX840_1 CH \
         1\tKraft\n\
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
    let one = "channel names: \nDev1_ai0\nstart times: \n3/4/2026 13:59:59.0\ndt: \
               \n0.001000\ndata:\n1.5E-01\n2.5E-01\n-1E-1\n";
    let one = read_text(one).unwrap();
    assert_eq!(
        (one.record.values(), one.record.rate(), &one.channel[..]),
        (&[0.15, 0.25, -0.1][..], 1000.0, "Dev1_ai0")
    );
}

#[test]
fn monitors_of_serial_ports() {
    let plain = reading("t;v\n0,000;1,5\n0,002;2,5\n0,004;-1\n").record.into_values();
    for text in [
        "boot\n10:11:12.000 -> 1.5\n10:11:12.002 -> 2.5\n10:11:12.004 -> -1\n",
        "10:11:12.000 -> 7,1.5\n10:11:12.002 -> 7,2.5\n10:11:12.004 -> 7,-1\n",
    ] {
        let column = if text.contains(',') { 2 } else { 1 };
        let found = Reader::default().time(0).channel(column).read_from(text).unwrap();
        assert_eq!((found.record.values(), found.record.rate()), (&plain[..], 500.0), "{text}");
    }
}

#[test]
fn names_before_each_number() {
    for text in [
        "boot\nms:0 v:1.5\nms:2 v:2.5\nms:4 v:-1\n",
        "t_s: 0, v: 1.5\nt_s: 0.002, v: 2.5\nt_s: 0.004, v: -1\n",
        "ms=0 v=1.5\nms=2 v=2.5\nms=4 v=-1\n",
    ] {
        let found = reading(text);
        assert_eq!((&*found.channel, found.record.values(), found.record.rate()), ("v", &[1.5, 2.5, -1.0][..], 500.0));
    }
    let no_time = Reader::default().rate(500.0).channel("v").read_from("x:0,v:1.5\nx:2,v:2.5\nx:4,v:-1\n").unwrap();
    assert_eq!(no_time.record.values(), [1.5, 2.5, -1.0]);
}

#[test]
fn fortran_and_bars() {
    for text in [
        "  0.000D+00   1.50D+00\n  2.000D-03   2.50D+00\n  4.000D-03  -1.00D+00\n",
        "t [s] | v [m/s]\n0.000 | 1.5\n0.002 | 2.5\n0.004 | -1\n",
    ] {
        let found = reading(text).record;
        assert_eq!((found.values(), found.rate()), (&[1.5, 2.5, -1.0][..], 500.0), "{text}");
    }
}

#[test]
fn lines_above_a_table_that_are_no_header() {
    let rows = "0.000,1.5\n0.002,2.5\n0.004,-1\n";
    for text in [
        format!("Mode,Detail\nWaveform Data,\n{rows}"),
        format!("; Sample Rate 500\n; Channels 1\n{}", rows.replace(',', " ")),
        format!(
            "Title:\tTime\nDate:\t02-05-2024\nZ-axis size:\t1\n{}",
            rows.replace("0.00", "7\t0.00").replace(',', "\t")
        ),
        format!("Name\tWeg\nMessrate: 500 Hz\tMessrate: 500 Hz\ns\tmm\n{}", rows.replace(',', "\t")),
        format!("\"vel\",\"CR6\"\n\"TIME\",\"vel\"\n\"TS\",\"m/s\"\n\"\",\"Smp\"\n{rows}"),
        format!("time\tvel\ns\tm/s\n\tring down\n{}", rows.replace(',', "\t")),
        format!("# time vel\n# [s] [m/s]\n{}", rows.replace(',', " ")),
        format!("s,m/s\ntime,vel\n{rows}"),
        "\"time\" \"vel\"\n\"1\" 0 1.5\n\"2\" 0.002 2.5\n\"3\" 0.004 -1\n".to_owned(),
    ] {
        let width = text.lines().last().unwrap().split([',', '\t', ' ']).count();
        let reader = if width == 3 { Reader::default().time(1).channel(2) } else { Reader::default() };
        let found = reader.read_from(&*text).unwrap_or_else(|error| panic!("{error}:\n{text}"));
        assert_eq!((found.record.values(), found.record.rate()), (&[1.5, 2.5, -1.0][..], 500.0), "{text}");
    }
}

#[test]
fn the_rate_is_stated_above_one_column() {
    for head in [
        "Sample Rate: 500 Hz. Sample values on linear scale.\nLength processed: 3 samples\n",
        "Delta-X:0.002\nLength:3\n",
        "# velocity of a fork\n# fs = 500 Hz\n",
        "\"SampleRate\",500.0\n\"Time\",\"10:00:00.00\"\n",
        "CH1(V),t0 =-1.5e+00, tInc = 2.0e-03,\n",
    ] {
        let end = if head.contains("tInc") { ",,\n" } else { "\n" };
        let found =
            read_text(&format!("{head}1.5{end}2.5{end}-1{end}")).unwrap_or_else(|error| panic!("{error}:\n{head}"));
        assert_eq!((found.record.values(), found.record.rate()), (&[1.5, 2.5, -1.0][..], 500.0), "{head}");
    }
    let counted = read_text("Time interval :,2000.0uS\nindex,CH1\n0,1.5\n1,2.5\n2,-1\n").unwrap();
    assert_eq!((counted.record.values(), counted.record.rate()), (&[1.5, 2.5, -1.0][..], 500.0));
}
