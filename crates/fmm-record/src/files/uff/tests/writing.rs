//! Files written here and read again.

use super::*;
use crate::error::says;
use crate::record::Record;
use crate::units::Quantity;

const FORMS: [Form; 3] = [Form::Ascii, Form::Binary(ByteOrder::Little), Form::Binary(ByteOrder::Big)];

fn again(sets: &[DataSet], form: Form) -> Vec<DataSet> {
    let mut bytes = Vec::new();
    write_to(&mut bytes, sets, form).unwrap();
    super::sets(&bytes)
}

/// Numbers that use all their digits, from tiny to huge, with both signs.
fn numbers(count: i32) -> Vec<f64> {
    (0..count).map(|i| (f64::from(i) * 0.7).sin() * 10f64.powi(i % 40 - 20)).collect()
}

fn header() -> Header {
    Header {
        lines: ["description µ".into(), String::new(), "07-Jun-24 12:00:00".into(), "a".repeat(80), "b".into()],
        function: FunctionType::FREQUENCY_RESPONSE,
        identification: 1_234_567_890,
        version: -42,
        load_case: 7,
        response: Freedom { entity: "Entity 123".into(), node: 99, direction: -3 },
        reference: Freedom { entity: String::new(), node: -5, direction: 6 },
        z: 1.5,
        abscissa: Axis::new(DataType::FREQUENCY, "Frequency", "Hz"),
        ordinate: Axis {
            data_type: DataType::GENERAL,
            exponents: [1, -2, 3],
            label: "ä".repeat(20),
            unit: "m/s²".into(),
        },
        denominator: Axis::new(DataType::EXCITATION_FORCE, "", "N"),
        z_axis: Axis::default(),
    }
}

#[test]
fn bytes_keep_every_digit() {
    let values = numbers(50);
    let pairs: Vec<[f64; 2]> = values.windows(2).map(|pair| [pair[0], pair[1]]).collect();
    let uneven = |count: u32| Abscissa::Uneven((0..count).map(|i| f64::from(i * i) * 0.125).collect());
    let even = Abscissa::Even { start: -0.25, step: 0.0625 };
    let sets = [
        DataSet::new(header(), even.clone(), Ordinate::Real(values.clone())).unwrap(),
        DataSet::new(header(), even, Ordinate::Complex(pairs.clone())).unwrap(),
        DataSet::new(header(), uneven(50), Ordinate::Real(values)).unwrap(),
        DataSet::new(header(), uneven(49), Ordinate::Complex(pairs)).unwrap(),
    ];
    for order in [ByteOrder::Little, ByteOrder::Big] {
        assert_eq!(again(&sets, Form::Binary(order)), sets);
    }
    // Whatever was written as text is written alike again.
    let text = again(&sets, Form::Ascii);
    assert_eq!(again(&text, Form::Ascii), text);
    for (text, set) in text.iter().zip(&sets) {
        assert_eq!((&text.header, text.ordinate().len()), (&set.header, set.ordinate().len()));
        let flat = |set: &DataSet| match set.ordinate() {
            Ordinate::Real(values) => values.clone(),
            Ordinate::Complex(values) => values.concat(),
        };
        for (text, exact) in flat(text).iter().zip(flat(set)) {
            // Half a unit of the thirteenth digit.
            assert!((text - exact).abs() <= 0.5e-12 * exact.abs() * (1.0 + 1e-3), "{text} for {exact}");
        }
    }
}

#[test]
fn records_come_back_as_they_were() {
    for rate in [1.0, 50.0, 512.0, 25_600.0, 44_100.0, 65_536.0, 200_000.0] {
        for (quantity, unit) in [(Quantity::Velocity, "m/s"), (Quantity::Force, "N"), (Quantity::Other, "V")] {
            let record = Record::new(-0.5, 1.0 / rate, numbers(33), quantity, unit).unwrap();
            for form in &FORMS[1..] {
                let set = &again(&[DataSet::of_record(&record)], *form)[0];
                assert_eq!(set.record().unwrap(), record, "{rate} Hz");
            }
        }
    }
    // A rate that is not whole: the format has six digits.
    let record = Record::sampled(1234.567, vec![1.0; 3], Quantity::Other, "").unwrap();
    let found = again(&[DataSet::of_record(&record)], FORMS[1])[0].record().unwrap();
    assert!((found.rate() / record.rate() - 1.0).abs() <= 5e-6, "{} Hz", found.rate());
}

#[test]
fn text_is_in_its_columns() {
    let set = DataSet::new(
        Header { lines: std::array::from_fn(|_| String::new()), ..header() },
        Abscissa::Uneven(vec![1.0, 2.0]),
        Ordinate::Complex(vec![[-1.0 / 3.0, 1e-300], [0.0, f64::NAN]]),
    )
    .unwrap();
    let mut bytes = Vec::new();
    write_to(&mut bytes, &[set], Form::Ascii).unwrap();
    let text: String = bytes.iter().copied().map(char::from).collect();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[2], "NONE");
    assert_eq!(lines[7], "    41234567890  -42         7 Entity 123        99  -3 NONE              -5   6");
    assert_eq!(lines[8], "         6         2         0  0.00000E+00  0.00000E+00  1.50000E+00");
    assert_eq!(lines[10], "         1    1   -2    3 ääääääääääääääääääää m/s²                ");
    assert_eq!(lines[13], "  1.00000E+00 -3.333333333333E-01 1.000000000000E-300");
    assert_eq!(lines[14], "  2.00000E+00  0.000000000000E+00                 NaN");
    assert_eq!((lines[15], lines.len()), ("    -1", 16));
}

#[test]
fn what_the_format_cannot_hold_is_refused() {
    let refused = |change: &dyn Fn(&mut Header)| {
        let mut header = header();
        change(&mut header);
        let set = DataSet::new(header, Abscissa::Even { start: 0.0, step: 1.0 }, Ordinate::Real(vec![1.0])).unwrap();
        write_to(std::io::sink(), &[set], Form::Ascii).unwrap_err().to_string()
    };
    assert!(refused(&|header| header.lines[0] = "x".repeat(81)).contains("at most 80 characters"));
    assert!(refused(&|header| header.lines[0] = "two\nlines".into()).contains("on one line"));
    assert!(refused(&|header| header.abscissa.unit = "Ω".into()).contains("of Latin-1"));
    assert_eq!(refused(&|header| header.version = 123_456), "version 123456 cannot be written: it has only 5 columns");
    assert!(refused(&|header| header.response.direction = -1000).starts_with("direction -1000"));

    let set = |x: Vec<f64>, y: f64| {
        let values = vec![y; x.len()];
        DataSet::new(Header::default(), Abscissa::Uneven(x), Ordinate::Real(values)).unwrap()
    };
    let close = set(vec![1.0, 1.000_001], 1.0);
    assert!(says(
        &write_to(std::io::sink(), std::slice::from_ref(&close), FORMS[0]),
        "cannot be told from its neighbour"
    ));
    assert!(write_to(std::io::sink(), &[close], FORMS[1]).is_ok(), "bytes have seven digits");
    let far = set(vec![1e300], 1.0);
    assert!(says(&write_to(std::io::sink(), std::slice::from_ref(&far), FORMS[1]), "is too large"));
    assert!(write_to(std::io::sink(), &[far], FORMS[0]).is_ok(), "text has any exponent");
    let even = Abscissa::Even { start: 0.0, step: 1.0 };
    assert!(says(&DataSet::new(Header::default(), even.clone(), Ordinate::Real(vec![])), "at least one point"));
    let three = Abscissa::Uneven(vec![1.0, 2.0, 3.0]);
    assert!(says(&DataSet::new(Header::default(), three, Ordinate::Real(vec![1.0])), "abscissae were given for"));
    let infinite = Abscissa::Even { start: f64::INFINITY, step: 1.0 };
    assert!(says(
        &DataSet::new(Header::default(), infinite, Ordinate::Real(vec![1.0])),
        "an even abscissa must be finite"
    ));
    assert!(says(&write("/no/such/folder/file.uff", &[], FORMS[0]), "cannot create /no/such/folder/file.uff: "));
}
