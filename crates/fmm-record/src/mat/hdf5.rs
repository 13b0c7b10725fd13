//! MATLAB files of version 7.3, which are HDF5.

use hdf5_pure::{AttrValue, DType, Dataset, File, Group, Layout};

use super::{Array, Kind, MOST_INFLATED, MatError, MatFile};

/// Most bytes that one byte of deflated data can expand to (RFC 1951: 258 bytes for two bits).
const DEFLATE_RATIO: u64 = 1032;

/// Groups within groups that are followed.
const DEEPEST: usize = 32;

/// Reads the arrays of a file, and the names of its other variables.
///
/// No size is trusted that the file states: arrays that are not chunked lie in the file, chunks must be there all,
/// and none may expand more than deflate can.
pub(super) fn parse(bytes: &[u8]) -> Result<MatFile, MatError> {
    let mut variables = Variables {
        file: MatFile { arrays: Vec::new(), others: Vec::new(), damaged: Vec::new() },
        length: bytes.len() as u64,
        budget: MOST_INFLATED as u64,
    };
    let damaged = |error: hdf5_pure::Error| MatError::Hdf5File { reason: error.to_string() };
    let mut opened = File::from_bytes(bytes.to_vec()).map_err(damaged)?;
    if opened.root().datasets().is_err() {
        // The decoder follows symbolic links to where they do not lead, and then gives the whole group up.
        opened = File::from_bytes(without_symbolic_links(bytes)).map_err(damaged)?;
    }
    variables.add(&opened.root(), "", 0).map_err(damaged)?;
    Ok(variables.file)
}

/// What has been read of a file.
struct Variables {
    file: MatFile,
    /// Length of the file (bytes).
    length: u64,
    /// What its arrays may still take (bytes).
    budget: u64,
}

impl Variables {
    /// Adds what lies in a group, and in those in it: fields of structures. `prefix` is how they are called, up to their own
    /// name.
    fn add(&mut self, group: &Group, prefix: &str, depth: usize) -> Result<(), hdf5_pure::Error> {
        for (name, dataset) in group.iter_datasets()? {
            let name = format!("{prefix}{name}");
            match variable(&dataset, self.length, &mut self.budget) {
                Ok(Variable::Array { dimensions, values }) => self.file.arrays.push(Array { name, dimensions, values }),
                Ok(Variable::Other(kind)) => self.file.others.push((name, kind)),
                Err(Fault::TooLarge) => {
                    let error = MatError::TooLarge { limit: MOST_INFLATED };
                    self.file.damaged.push((name, error.to_string()));
                }
                Err(Fault::Because(reason)) => self.file.damaged.push((name, reason)),
            }
        }
        // Names with number signs are MATLAB's own: the contents of cells and of objects.
        for (name, group) in group.iter_groups()?.filter(|(name, _)| !name.starts_with('#')) {
            let name = format!("{prefix}{name}");
            match group.attrs() {
                Ok(attributes) if attributes.contains_key("MATLAB_sparse") => {
                    self.file.others.push((name, Kind::Sparse));
                }
                Ok(_) if depth == DEEPEST => self.file.damaged.push((name, "its groups are too deep".into())),
                Ok(_) => match self.add(&group, &format!("{name}."), depth + 1) {
                    Ok(()) => self.file.others.push((name, Kind::Structure)),
                    Err(error) => self.file.damaged.push((name, error.to_string())),
                },
                Err(error) => self.file.damaged.push((name, error.to_string())),
            }
        }
        Ok(())
    }
}

/// The bytes of a file whose symbol tables (version 1 of the format of groups) have no symbolic links any more.
///
/// ```text
/// node  = "SNOD", version 1, 0, count (2 bytes), entries of 40 bytes
/// entry = name (8 bytes), address of the object (8), kind (4; 2 is a symbolic link), 20 others
/// ```
fn without_symbolic_links(bytes: &[u8]) -> Vec<u8> {
    const HEAD: usize = 8;
    const ENTRY: usize = 40;
    let mut file = bytes.to_vec();
    let nodes: Vec<usize> =
        (0..file.len().saturating_sub(HEAD)).filter(|at| file[*at..].starts_with(b"SNOD\x01\0")).collect();
    for node in nodes {
        let count = usize::from(u16::from_le_bytes([file[node + 6], file[node + 7]]));
        let Some(entries) = file.get(node + HEAD..node + HEAD + count * ENTRY) else { continue };
        let is_link = |entry: &&[u8]| entry[16..20] == [2, 0, 0, 0] && entry[8..16].iter().all(|byte| *byte == 0xFF);
        let kept: Vec<u8> = entries.chunks_exact(ENTRY).filter(|entry| !is_link(entry)).flatten().copied().collect();
        let left = (kept.len() / ENTRY) as u16;
        file[node + 6..node + 8].copy_from_slice(&left.to_le_bytes());
        file[node + HEAD..node + HEAD + kept.len()].copy_from_slice(&kept);
    }
    file
}

enum Variable {
    Array { dimensions: Vec<usize>, values: Vec<f64> },
    Other(Kind),
}

enum Fault {
    TooLarge,
    Because(String),
}

impl From<hdf5_pure::Error> for Fault {
    fn from(error: hdf5_pure::Error) -> Self {
        Self::Because(error.to_string())
    }
}

impl From<&str> for Fault {
    fn from(reason: &str) -> Self {
        Self::Because(reason.into())
    }
}

/// Reads a variable and takes its numbers off the budget; `length` is that of the file (bytes).
fn variable(dataset: &Dataset, length: u64, budget: &mut u64) -> Result<Variable, Fault> {
    let attributes = dataset.attrs()?;
    if let Some(kind) = kind(attributes.get("MATLAB_class").and_then(AttrValue::as_str), &dataset.dtype()?) {
        return Ok(Variable::Other(kind));
    }
    let sizes = dataset.shape()?;
    let count = sizes.iter().try_fold(1u64, |product, size| product.checked_mul(*size));
    let width = dataset.element_size()?;
    if !matches!(width, 1 | 2 | 4 | 8) {
        return Err("its numbers have a width that no numbers have".into());
    }
    let needed = count.and_then(|count| count.checked_mul(8)).ok_or(Fault::TooLarge)?;
    if needed > *budget {
        return Err(Fault::TooLarge);
    }
    check_storage(dataset, &sizes, needed / 8 * width, length)?;
    *budget -= needed;
    let values = if needed == 0 { Vec::new() } else { dataset.read_f64()? };
    if values.len() as u64 != needed / 8 {
        return Err("its dimensions do not match its amount of data".into());
    }
    if attributes.get("MATLAB_empty").and_then(AttrValue::as_i64).is_some_and(|flag| flag != 0) {
        // An empty array stores its dimensions instead of its numbers.
        let dimensions: Vec<usize> = values.iter().map(|size| *size as usize).collect();
        let empty = dimensions.len() >= 2 && dimensions.contains(&0);
        let array = Variable::Array { dimensions, values: Vec::new() };
        return if empty { Ok(array) } else { Err("it is called empty, but has dimensions that are not".into()) };
    }
    // HDF5 names the dimension first that varies last; MATLAB stores columns one after the other.
    let mut dimensions: Vec<usize> = sizes.iter().rev().map(|size| *size as usize).collect();
    dimensions.resize(dimensions.len().max(2), 1);
    Ok(Variable::Array { dimensions, values })
}

/// Refuses data that the file cannot hold.
fn check_storage(dataset: &Dataset, sizes: &[u64], bytes: u64, length: u64) -> Result<(), Fault> {
    let (chunk, missing) = match dataset.layout()? {
        _ if bytes == 0 => return Ok(()),
        Layout::Compact { .. } | Layout::Contiguous { address: Some(_), .. } if bytes <= length => return Ok(()),
        Layout::Compact { .. } | Layout::Contiguous { address: Some(_), .. } => {
            return Err("it promises more data than the file has".into());
        }
        Layout::Chunked { chunk_shape, .. } => (chunk_shape, "chunks of it are missing"),
        _ => return Err("it stores no data of its own".into()),
    };
    let width = bytes / sizes.iter().product::<u64>();
    let chunk_bytes =
        chunk.iter().try_fold(width, |product, size| product.checked_mul(*size)).ok_or(Fault::TooLarge)?;
    if chunk_bytes == 0 || chunk.len() != sizes.len() {
        return Err("its chunks have no size".into());
    }
    let expected = sizes.iter().zip(&chunk).map(|(size, chunk)| size.div_ceil(*chunk)).product::<u64>();
    let chunks = dataset.chunks()?;
    if chunks.len() as u64 != expected {
        return Err(missing.into());
    }
    if chunks.iter().any(|stored| chunk_bytes > stored.storage_size.min(length).saturating_mul(DEFLATE_RATIO)) {
        return Err("it promises more data than its chunks can expand to".into());
    }
    Ok(())
}

/// What a variable is by the class that MATLAB gave it, or, in a file of another program, by what it stores; none if
/// it is real and numeric.
fn kind(class: Option<&str>, stored: &DType) -> Option<Kind> {
    use DType::{
        Compound, F32, F64, I8, I16, I32, I64, ObjectReference, String, U8, U16, U32, U64, VariableLengthString,
    };
    match class {
        Some("char") => return Some(Kind::Text),
        Some("cell") => return Some(Kind::Cell),
        Some("struct") => return Some(Kind::Structure),
        None | Some("double" | "single" | "logical") => {}
        Some(class) if class.strip_prefix('u').unwrap_or(class).starts_with("int") => {}
        Some(_) => return Some(Kind::Object),
    }
    match stored {
        F32 | F64 | I8 | I16 | I32 | I64 | U8 | U16 | U32 | U64 => None,
        Compound(fields) if fields.iter().map(|(name, _)| &name[..]).eq(["real", "imag"]) => Some(Kind::Complex),
        Compound(_) => Some(Kind::Structure),
        String | VariableLengthString => Some(Kind::Text),
        ObjectReference => Some(Kind::Cell),
        _ => Some(Kind::Object),
    }
}
