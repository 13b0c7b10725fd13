//! Faults of programs and damage of files.

use super::*;
use crate::error::{RecordError, says};
use crate::tests::synthetic::Noise;

/// Six real single points at 1/512 s.
const FORM: &str = "         2         6         1  0.00000E+00  1.95312E-03  0.00000E+00";
const POINTS: &str = "  1.00000E+00  2.00000E+00  3.00000E+00\n  4.00000E+00  5.00000E+00  6.00000E+00\n";
const VALUES: [f64; 6] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];

fn warnings(bytes: &[u8]) -> (Vec<String>, Vec<f64>) {
    let file = UffFile::parse(bytes).unwrap();
    (file.warnings().to_vec(), real(&file.sets()[0]).to_vec())
}

fn bytes_of(values: &[f64], big: bool) -> Vec<u8> {
    values.iter().flat_map(|value| if big { value.to_be_bytes() } else { value.to_le_bytes() }).collect()
}

#[test]
fn line_ends_and_blank_lines_do_not_matter() {
    let plain = String::from_utf8(ascii(FORM, POINTS)).unwrap();
    let padded = plain.lines().fold(String::new(), |text, line| format!("{text}{line:<80}\r\n"));
    for text in [
        plain.clone(),
        padded,
        plain.replace('\n', "\r\n"),
        plain.replace('\n', "\r"),
        plain.replace(POINTS, &POINTS.replace('\n', "\n\n \n")),
        format!("\n\n{plain}\n\n"),
        plain.replace("E+00  4", "E+00\n  4"),
        plain.trim_end().to_owned(),
    ] {
        assert_eq!(real(&sets(text.as_bytes())[0]), VALUES, "{text:?}");
    }
}

#[test]
fn headers_may_be_latin_1_or_utf_8_and_keep_to_no_columns() {
    let unit = |text: &[u8]| {
        let mut bytes = ascii(FORM, POINTS);
        let at = bytes.windows(3).position(|window| window == b"m/s").unwrap();
        bytes.splice(at..at + 3, text.iter().copied());
        sets(&bytes)[0].header.ordinate.unit.clone()
    };
    assert_eq!(unit(b"(1/N)*(m/s\xB2)"), "(1/N)*(m/s²)");
    assert_eq!(unit("(1/N)*(m/s²)".as_bytes()), "(1/N)*(m/s²)");
    let plain = String::from_utf8(ascii(FORM, POINTS)).unwrap();
    let free = plain
        .replace("    1         0    0         0 NONE               3  -1 NONE", "1 0 0 0 NONE 3 -1 NONE")
        .replace(FORM, " 2 6  1 0.00000E+000 1.95312D-003 0.")
        .replace("        11    0    0    0 NONE                 m/s", "11 0 0 0 NONE m/s");
    assert_eq!(sets(free.as_bytes()), sets(plain.as_bytes()));
    let set = &sets(plain.as_bytes())[0];
    // The direction looks like a delimiter.
    assert_eq!(set.header.response, Freedom { entity: String::new(), node: 3, direction: -1 });
    assert_eq!(set.header.lines[1], "", "NONE means that there is none");
}

#[test]
fn other_data_sets_are_passed_over() {
    let other =
        |number: u32| format!("    -1\n{number:>6}\n         1  what   -1 ever\n        -1\n    -1\n").into_bytes();
    let binary = |order: u8, name: &str| {
        block(
            &format!("    58b     {order}     2          11           48     0"),
            name,
            &bytes_of(&VALUES, order == 2),
        )
    };
    let form = "         4         6         1  0.00000E+00  1.95312E-03  0.00000E+00";
    let file = [other(151), other(164), ascii(FORM, POINTS), binary(1, form), other(15), binary(2, form)].concat();
    let file = UffFile::parse(&file).unwrap();
    assert!(file.warnings().is_empty());
    assert_eq!(file.others(), [(151, 2), (164, 7), (15, 42)]);
    assert_eq!(file.sets().iter().map(real).collect::<Vec<_>>(), [VALUES; 3]);
    assert!(says(&channel(&file, "velocity"), "data sets are called"));
    let error = UffFile::parse(&[other(164), other(151), other(164)].concat()).unwrap_err().to_string();
    assert_eq!(error, "the file has no data set 58 with points, only 151, 164");
    // One delimiter between data sets instead of two.
    let one = [ascii(FORM, POINTS), ascii(FORM, POINTS)[7..].to_vec()].concat();
    assert_eq!(sets(&one).len(), 2);
    let stray = [b"made by a program\n".to_vec(), ascii(FORM, POINTS), b"and\nmore\n".to_vec()].concat();
    assert_eq!(
        UffFile::parse(&stray).unwrap().warnings(),
        ["line 1 belongs to no data set", "line 18 belongs to no data set"]
    );
}

#[test]
fn promises_that_are_not_kept() {
    let promise = FORM.replace("         6", "   2508876");
    let (found, values) = warnings(&ascii(&promise, POINTS));
    assert_eq!(
        (&found[..], &values[..]),
        (&["the data set at line 2 promises 2508876 points, but 6 are there".to_owned()][..], &VALUES[..])
    );
    let fewer = FORM.replace("         6", "         4");
    let (found, values) = warnings(&ascii(&fewer, POINTS));
    assert_eq!(
        (&found[..], &values[..]),
        (&["the data set at line 2 promises 4 points, but more are there".to_owned()][..], &VALUES[..4])
    );
    let none = UffFile::parse(&ascii(FORM, "")).unwrap_err().to_string();
    assert_eq!(
        none,
        "the file has no data set 58 with points, and no others; the data set at line 2 promises 6 points, but 0 are \
         there"
    );

    let form = |count: &str| FORM.replace("         2         6", &format!("         4{count:>10}"));
    let identifier = "    58b     1     2          11          48     0     0           0           0";
    for (count, points, expected) in [
        ("9999999999", 6, "the data set at line 2 promises 9999999999 points, but 6 are there"),
        ("7", 6, "the data set at line 2 promises 7 points, but 6 are there"),
        ("5", 5, "the data set at line 2 promises 5 points, but more are there"),
    ] {
        let (found, values) = warnings(&block(identifier, &form(count), &bytes_of(&VALUES, false)));
        assert_eq!(values, VALUES[..points]);
        assert!(found.iter().any(|found| found == expected), "{count}: {found:?}");
    }
    // Stray line ends before the delimiter, and a count of bytes that is wrong.
    for stray in ["\n", "\r\n", "\n\n"] {
        let points = [bytes_of(&VALUES, false), stray.as_bytes().to_vec()].concat();
        assert_eq!(warnings(&block(identifier, &form("6"), &points)), (vec![], VALUES.to_vec()), "{stray:?}");
    }
    let wrong = identifier.replace("48", "24");
    let found = warnings(&block(&wrong, &form("6"), &bytes_of(&VALUES, false)));
    assert_eq!(
        found,
        (vec!["the data set at line 2 states 24 bytes, but its points have 48".to_owned()], VALUES.to_vec())
    );
    // A delimiter among the bytes: the last value holds it.
    let mut hidden = VALUES;
    hidden[5] = f64::from_le_bytes(*b"    -1\n ");
    assert_eq!(real(&sets(&block(identifier, &form("6"), &bytes_of(&hidden, false)))[0]), hidden);
}

#[test]
fn uneven_bytes_of_both_kinds() {
    let form = "         4         3         0  0.00000E+00  0.00000E+00  0.00000E+00";
    for (width, stated) in [(4, 36), (8, 48)] {
        let mut points = Vec::new();
        for (x, y) in [(0.5f32, 1.0f64), (0.75, -2.0), (1.0, 3.5)] {
            if width == 4 {
                points.extend(x.to_be_bytes());
            } else {
                points.extend(f64::from(x).to_be_bytes());
            }
            points.extend(y.to_be_bytes());
        }
        let identifier = format!("    58b     2     2          11{stated:>12}");
        let whole = block(&identifier, form, &points);
        let set = &sets(&whole)[0];
        assert_eq!((set.abscissa(), real(set)), (&Abscissa::Uneven(vec![0.5, 0.75, 1.0]), &[1.0, -2.0, 3.5][..]));
        assert_eq!((set.record().unwrap().start(), set.record().unwrap().rate()), (0.5, 4.0));
        // Where the end is missing, the abscissae must increase.
        let file = UffFile::parse(&whole[..whole.len() - 7 - 8]).unwrap();
        assert_eq!(file.sets()[0].abscissa(), &Abscissa::Uneven(vec![0.5, 0.75]), "{width} bytes");
    }
    let constant = block("    58b     1     2", form, &[7; 44]);
    assert!(says(&UffFile::parse(&constant), "neither as if its abscissae"));
}

#[test]
fn contradictions_name_their_line() {
    let message = |bytes: &[u8]| UffFile::parse(bytes).unwrap_err().to_string();
    let of_form = |form: &str| message(&ascii(form, POINTS));
    assert_eq!(
        of_form("7 6 1 0 1 0"),
        "line 9: the type of the ordinate must be 2, 4, 5 or 6, but the line is \"7 6 1 0 1 0\""
    );
    assert!(of_form("2 -6 1 0 1 0").starts_with("line 9: here the format has ordinate type"));
    assert!(of_form("2 6.5 1 0 1 0").starts_with("line 9: here the format has ordinate type"));
    assert!(of_form("2 6 2 0 1 0").starts_with("line 9: the spacing"));
    assert!(of_form("2 6 1 0").starts_with("line 9: an even abscissa needs"));
    assert!(of_form("2 6 1 0 inf").starts_with("line 9: an even abscissa needs"));
    assert!(of_form("two").starts_with("line 9: here the format has ordinate type"));
    let plain = String::from_utf8(ascii(FORM, POINTS)).unwrap();
    assert!(
        message(plain.replace("    1         0    0  ", "    1         x    0  ").as_bytes()).starts_with("line 8:")
    );
    assert!(message(plain.replace("        17    0", "        17    ?").as_bytes()).starts_with("line 10:"));
    assert_eq!(
        message(plain.replace("3.00000E+00", "3.00000F+00").as_bytes()),
        "line 14: \"3.00000F+00\" is not a number"
    );
    let binary = |identifier: &str| message(&block(identifier, FORM, &[0; 24]));
    assert!(binary("    58b     3     2").starts_with("line 2: the order of bytes must be"));
    assert!(binary("    58b").starts_with("line 2: the order of bytes must be"));
    assert!(binary("    58b     1     3").starts_with("line 2: binary numbers of format 3"));
    for text in [&b""[..], b"t,v\n0,1\n", b"    -1\n    -1\n", b"    -1\nabc\n", &[0; 500], &[b'\n'; 500]] {
        assert!(says(&UffFile::parse(text), "not a Universal File"), "{text:?}");
    }
    assert!(says(&UffFile::read("/no/such/file.uff"), "cannot read"));
}

#[test]
fn records_that_cannot_be() {
    let form = |step: &str| FORM.replace("1.95312E-03", step);
    let record = |bytes: &[u8]| UffFile::parse(bytes).unwrap().sets()[0].record();
    assert!(says(&record(&ascii(&form("0.00000E+00"), POINTS)), "the sampling interval must be positive"));
    let (found, _) = warnings(&ascii(FORM, &POINTS.replace("3.00000E+00", "        NaN")));
    assert_eq!(found, ["the data set at line 2 has 1 points that are not finite"]);
    let not_finite = record(&ascii(FORM, &POINTS.replace("3.00000E+00", "   Infinity")));
    assert!(says(&not_finite, "not finite; the first is sample"));
    let complex = FORM.replace("         2         6", "         5         3");
    assert!(says(&record(&ascii(&complex, POINTS)), "has complex values"));
    let unit = |unit: &str| {
        String::from_utf8(ascii(FORM, POINTS))
            .unwrap()
            .replace("Time                 s", &format!("Time                 {unit}"))
    };
    // The nearest whole number of hertz; at such a rate six digits do not tell 512 000 Hz.
    assert_eq!(record(unit("ms").as_bytes()).unwrap().interval(), 512_001f64.recip());
    assert!(says(&record(unit("rev").as_bytes()), "the time axis of"));
    // An interval with more digits than the format has is what it says.
    assert_eq!(record(&ascii(&form("1.953126E-03"), POINTS)).unwrap().interval(), 1.953_126e-3);
    // Six digits that no whole number of hertz explains.
    assert_eq!(record(&ascii(&form("1.33333E+00"), POINTS)).unwrap().interval(), 1.333_33);
}

#[test]
fn a_file_cut_off_anywhere_has_fewer_points_and_says_so() {
    for name in [
        "impact_time_ascii.uff",
        "impact_time_binary.uff",
        "impact_frf_ascii_uneven.uff",
        "microphone_ascii.uff",
        "impact_frf_binary.uff",
    ] {
        let bytes = file(name);
        let whole = UffFile::parse(&bytes).unwrap();
        for length in (0..bytes.len() - 8).step_by(64).chain(bytes.len() - 200..bytes.len() - 8) {
            let file = match UffFile::parse(&bytes[..length]) {
                Ok(file) => file,
                Err(RecordError::UnknownFormat { .. }) => continue,
                Err(error) => panic!("{name}, {length} bytes: {error}"),
            };
            let complete = file.sets().len() - 1;
            assert_eq!(file.sets()[..complete], whole.sets()[..complete], "{name}, {length} bytes");
            let (cut, set) = (&file.sets()[complete], &whole.sets()[complete]);
            assert!(cut.abscissae().eq(set.abscissae().take(cut.ordinate().len())), "{name}, {length} bytes");
            match (cut.ordinate(), set.ordinate()) {
                (Ordinate::Real(cut), Ordinate::Real(set)) => {
                    assert_eq!(cut[..], set[..cut.len()], "{name}, {length}");
                }
                (Ordinate::Complex(cut), Ordinate::Complex(set)) => {
                    assert_eq!(cut[..], set[..cut.len()], "{name}, {length}");
                }
                _ => panic!("{name}, {length} bytes"),
            }
            assert!(file.warnings() != whole.warnings() || complete + 1 < whole.sets().len(), "{name}, {length} bytes");
        }
    }
}

#[test]
fn damaged_files_never_panic() {
    let mut random = Noise::new(58);
    let files: Vec<Vec<u8>> = [
        sets(&file("microphone_ascii.uff")),
        sets(&file("microphone_binary.uff")),
        sets(&file("impact_frf_ascii_uneven.uff")),
    ]
    .iter()
    .flat_map(|sets| [Form::Ascii, Form::Binary(ByteOrder::Big)].map(|form| (sets, form)))
    .map(|(sets, form)| {
        let mut bytes = Vec::new();
        write_to(&mut bytes, sets, form).unwrap();
        bytes
    })
    .collect();
    for bytes in &files {
        // Headers are where damage does most.
        for reach in [900, bytes.len() as u64] {
            for _ in 0..300 {
                let mut damaged = bytes.clone();
                for _ in 0..=random.next() % 3 {
                    let at = (random.next() % reach) as usize;
                    damaged[at] = if random.next().is_multiple_of(2) {
                        random.next() as u8
                    } else {
                        damaged[at] ^ (1 << (random.next() % 8))
                    };
                }
                if let Ok(file) = UffFile::parse(&damaged) {
                    let _ = (reading(&file), channel(&file, 0));
                    let _ = write_to(std::io::sink(), file.sets(), Form::Ascii);
                }
            }
        }
    }
    for length in 0..300 {
        let noise: Vec<u8> = (0..length).map(|_| random.next() as u8).collect();
        assert!(UffFile::parse(&noise).is_err());
        let _ = UffFile::parse(&block("    58b     1     2", FORM, &noise));
    }
}
