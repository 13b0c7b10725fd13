//! Writes the simplest file of MATLAB.

/// A file of version 5 with one column of `values`, not compressed.
pub fn version_5(name: &str, values: &[f64]) -> Vec<u8> {
    let rows = values.len() as u32;
    let (integers, names, class, text) = (5, 1, 6u32, format!("{:<116}", "MATLAB 5.0 MAT-file"));
    let numbers: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    let matrix = [
        element(6, &[class.to_le_bytes(), [0; 4]].concat()),
        element(integers, &[rows.to_le_bytes(), 1u32.to_le_bytes()].concat()),
        element(names, name.as_bytes()),
        element(9, &numbers),
    ];
    [text.as_bytes(), &[0; 8], &[0x00, 0x01, b'I', b'M'], &element(14, &matrix.concat())].concat()
}

/// A data element: type, count of bytes, and the bytes padded to eight.
fn element(kind: u32, bytes: &[u8]) -> Vec<u8> {
    let padding = vec![0; bytes.len().next_multiple_of(8) - bytes.len()];
    [&kind.to_le_bytes(), &(bytes.len() as u32).to_le_bytes(), bytes, &padding].concat()
}
