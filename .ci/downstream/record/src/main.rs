//! The same decay out of every kind of file that this build can read.

use std::error::Error;

use fmm_record::{Quantity, Record, Swings};

#[cfg(feature = "mat")]
mod matlab;

/// Velocity (m/s) at 1 kHz of a swing of 5 Hz that loses 4 % of its first height with every half swing, as by dry
/// friction.
fn decay() -> Result<Record, Box<dyn Error>> {
    let velocity = |t: f64| (1.0 - 0.4 * t) * (10.0 * std::f64::consts::PI * t).sin();
    let values = (0..2000).map(|i| velocity(f64::from(i) * 1e-3)).collect();
    Ok(Record::sampled(1000.0, values, Quantity::Velocity, "m/s")?)
}

/// Says what a record shows, and sees that it is the decay.
fn check(format: &str, record: &Record) -> Result<(), Box<dyn Error>> {
    let swings = Swings::of(record);
    let frequency = swings.frequency().ok_or("it does not swing")?;
    let [first, second, ..] = swings.peaks() else { return Err("it has fewer than two peaks".into()) };
    let kept = (second.value / first.value).abs();
    println!("{format:>6}: {frequency:.4} Hz, {kept:.4} of the height is left after a half swing");
    // Pieces of a sine are fitted, which loses nothing within itself: that leaves some parts in ten thousand.
    assert!((frequency / 5.0 - 1.0).abs() < 3e-4, "{format}: {frequency} Hz");
    assert!((kept - 0.94 / 0.98).abs() < 3e-4, "{format}: {kept}");
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let record = decay()?;
    check("made", &record)?;

    {
        let rows = record.times().zip(record.values()).map(|(time, velocity)| format!("{time:.3};{velocity:.9}\n"));
        let text = String::from("time;velocity\n") + &rows.collect::<String>();
        check("CSV", &fmm_record::Reader::default().read_from(text.as_bytes())?.record)?;
    }
    {
        use fmm_record::uff::{DataSet, Form, UffFile, write_to};

        let mut file = Vec::new();
        write_to(&mut file, &[DataSet::of_record(&record)], Form::Ascii)?;
        check("UFF 58", &UffFile::parse(&file)?.sets()[0].record()?)?;
    }
    #[cfg(feature = "mat")]
    {
        let file = matlab::version_5("velocity", record.values());
        check("MATLAB", &fmm_record::Reader::default().rate(1000.0).read_from(file)?.record)?;
    }
    #[cfg(feature = "npy")]
    {
        let header = format!("{:<117}\n", "{'descr': '<f8', 'fortran_order': False, 'shape': (2000,), }");
        let values = record.values().iter().flat_map(|value| value.to_le_bytes());
        let file: Vec<u8> =
            b"\x93NUMPY\x01\x00\x76\x00".iter().copied().chain(header.into_bytes()).chain(values).collect();
        check("NumPy", &fmm_record::Reader::default().rate(1000.0).read_from(file)?.record)?;
    }
    Ok(())
}
