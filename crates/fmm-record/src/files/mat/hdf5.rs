//! MATLAB files of version 7.3, which are HDF5.

use std::collections::{BTreeSet, HashMap};

use hdf5_pure::{AttrValue, DType, Dataset, Error, File, FormatError, Group, Layout};

use crate::error::RecordError;
use crate::files::arrays::{ArrayFile, Notation};
use crate::files::mat::class;
use crate::files::reading::{MOST_INFLATED, too_large};

/// Most bytes that one byte of deflated data can expand to (RFC 1951: 258 bytes for two bits).
const DEFLATE_RATIO: u64 = 1032;

/// Groups within groups that are followed.
const DEEPEST: usize = 32;

/// Reads the arrays of a file, and the names of its other variables.
///
/// No size is trusted that the file states: arrays that are not chunked lie in the file, chunks must be there all,
/// and none may expand more than deflate can.
pub(crate) fn parse(bytes: &[u8]) -> Result<ArrayFile, RecordError> {
    let mut variables = Variables { file: ArrayFile::new(Notation::Matlab), bytes, budget: MOST_INFLATED as u64 };
    let damaged = |error| RecordError::undecoded("the version 7.3 file (HDF5) cannot be read", error);
    let opened = File::from_bytes(bytes.to_vec()).map_err(damaged)?;
    if let Ok(attributes) = opened.root().attrs() {
        variables.state("", &attributes);
    }
    variables.add(&opened.root(), "", 0).map_err(damaged)?;
    Ok(variables.file)
}

/// Variables read from a file so far.
struct Variables<'a> {
    file: ArrayFile,
    /// The whole of it.
    bytes: &'a [u8],
    /// Remaining memory for its arrays (bytes).
    budget: u64,
}

impl Variables<'_> {
    /// Adds the attributes of what is called `path`, empty for those of the whole file.
    fn state(&mut self, path: &str, attributes: &HashMap<String, AttrValue>) {
        for (key, value) in attributes {
            let number = value.as_f64().or(value.as_i64().map(|number| number as f64));
            let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            self.file.state(path, value.as_str(), number);
        }
    }

    /// Adds what lies in a group, and in those in it: fields of structures. `prefix` is how they are called, up to
    /// their own name.
    fn add(&mut self, group: &Group, prefix: &str, depth: usize) -> Result<(), hdf5_pure::Error> {
        let (datasets, groups) = members(group, self.bytes)?;
        for (name, dataset) in datasets {
            let name = format!("{prefix}{name}");
            let dataset = dataset.map_err(decoder);
            if let Some(attributes) = dataset.as_ref().ok().and_then(|dataset| dataset.attrs().ok()) {
                self.state(&name, &attributes);
            }
            match dataset.and_then(|dataset| variable(&dataset, self.bytes.len() as u64, &mut self.budget)) {
                Ok(Ok((dimensions, values))) => self.file.add(name, dimensions, values),
                Ok(Err(kind)) => self.file.others.push((name, kind.to_string())),
                Err(error) => self.file.damaged.push((name, error)),
            }
        }
        // Names with number signs are MATLAB's own: the contents of cells and of objects.
        for (name, group) in groups.into_iter().filter(|(name, _)| !name.starts_with('#')) {
            let name = format!("{prefix}{name}");
            match group.attrs() {
                Ok(attributes) if attributes.contains_key("MATLAB_sparse") => {
                    self.file.others.push((name, class::SPARSE.to_string()));
                }
                Ok(_) if depth == DEEPEST => {
                    self.file.damaged.push((name, RecordError::damaged("its groups are too deep")));
                }
                Ok(attributes) => {
                    self.state(&name, &attributes);
                    match self.add(&group, &format!("{name}."), depth + 1) {
                        Ok(()) => self.file.others.push((name, class::STRUCTURE.to_string())),
                        Err(error) => self.file.damaged.push((name, decoder(error))),
                    }
                }
                Err(error) => self.file.damaged.push((name, decoder(error))),
            }
        }
        Ok(())
    }
}

/// Data sets, or why they cannot be read, and groups, with their names.
type Members = (Vec<(String, Result<Dataset, Error>)>, Vec<(String, Group)>);

/// Members of a group. The decoder does not list a group with a symbolic link, or with one damaged object header; each
/// of its objects is then looked for by the names in the bytes of the file.
fn members(group: &Group, bytes: &[u8]) -> Result<Members, Error> {
    let listed = group.iter_datasets().and_then(|datasets| Ok((datasets, group.iter_groups()?)));
    let unlisted = match listed {
        Ok((datasets, groups)) => {
            return Ok((datasets.map(|(name, dataset)| (name, Ok(dataset))).collect(), groups.collect()));
        }
        // A file that is cut off is not half a file.
        Err(error @ Error::Format(FormatError::UnexpectedEof { .. })) => return Err(error),
        Err(error) => error,
    };
    let (mut datasets, mut groups) = (Vec::new(), Vec::new());
    for name in names(bytes) {
        match group.dataset(&name) {
            Err(Error::Format(FormatError::PathNotFound(_))) => {}
            Err(Error::NotADataset(_)) => groups.extend(group.group(&name).ok().map(|group| (name, group))),
            dataset => datasets.push((name, dataset)),
        }
    }
    let is_any = !groups.is_empty() || datasets.iter().any(|(_, dataset)| dataset.is_ok());
    if is_any { Ok((datasets, groups)) } else { Err(unlisted) }
}

/// The names in the local heaps of a file, which version 1 of the format of groups has, each once.
///
/// ```text
/// heap = "HEAP", version 0, 0 (3 bytes), length of its data (8), first free byte (8), address of its data (8)
/// data = names, each with a zero behind it
/// ```
fn names(bytes: &[u8]) -> BTreeSet<String> {
    let word = |at: usize| Some(u64::from_le_bytes(*bytes.get(at..)?.first_chunk()?) as usize);
    // Addresses count from the signature, which may stand behind a header of MATLAB.
    let base =
        [0, 512, 1024, 2048].into_iter().find(|at| bytes.get(*at..).is_some_and(|rest| rest.starts_with(b"\x89HDF")));
    let data = |at: usize| bytes.get(word(at + 24)?.checked_add(base?)?..)?.get(..word(at + 8)?);
    let heaps = (0..bytes.len()).filter(|at| bytes[*at..].starts_with(b"HEAP\0"));
    // Heaps that overlap would be more than the file.
    let within = |left: &mut usize, data: &&[u8]| left.checked_sub(data.len()).map(|less| *left = less).is_some();
    let heaps = heaps.filter_map(data).scan(bytes.len(), |left, data| within(left, &data).then_some(data));
    let names = heaps.flat_map(|data| data.split(|byte| *byte == 0)).filter(|name| !name.is_empty());
    names.filter_map(|name| std::str::from_utf8(name).ok().map(str::to_owned)).collect()
}

/// Dimensions and numbers of an array, or the class of another variable.
type Variable = Result<(Vec<usize>, Vec<f64>), &'static str>;

/// Error of the decoder about a variable.
fn decoder(error: hdf5_pure::Error) -> RecordError {
    RecordError::undecoded("the decoder of HDF5 says", error)
}

/// Reads a variable and takes its numbers off the budget; `length` is that of the file (bytes).
fn variable(dataset: &Dataset, length: u64, budget: &mut u64) -> Result<Variable, RecordError> {
    let attributes = dataset.attrs().map_err(decoder)?;
    let stored = dataset.dtype().map_err(decoder)?;
    if let Some(kind) = kind(attributes.get("MATLAB_class").and_then(AttrValue::as_str), &stored) {
        return Ok(Err(kind));
    }
    let sizes = dataset.shape().map_err(decoder)?;
    let count = sizes.iter().try_fold(1u64, |product, size| product.checked_mul(*size));
    let width = dataset.element_size().map_err(decoder)?;
    if !matches!(width, 1 | 2 | 4 | 8) {
        return Err(RecordError::damaged("its numbers have a width that no numbers have"));
    }
    let needed = count.and_then(|count| count.checked_mul(8)).ok_or_else(too_large)?;
    if needed > *budget {
        return Err(too_large());
    }
    check_storage(dataset, &sizes, needed / 8 * width, length)?;
    *budget -= needed;
    let values = if needed == 0 { Vec::new() } else { dataset.read_f64().map_err(decoder)? };
    if values.len() as u64 != needed / 8 {
        return Err(RecordError::damaged("its dimensions do not match its amount of data"));
    }
    if attributes.get("MATLAB_empty").and_then(AttrValue::as_i64).is_some_and(|flag| flag != 0) {
        // An empty array stores its dimensions instead of its numbers.
        let dimensions: Vec<usize> = values.iter().map(|size| *size as usize).collect();
        let empty = dimensions.len() >= 2 && dimensions.contains(&0);
        let not_empty = "it is called empty, but has dimensions that are not";
        return if empty { Ok(Ok((dimensions, Vec::new()))) } else { Err(RecordError::damaged(not_empty)) };
    }
    // HDF5 names the dimension first that varies last; MATLAB stores columns one after the other.
    let mut dimensions: Vec<usize> = sizes.iter().rev().map(|size| *size as usize).collect();
    dimensions.resize(dimensions.len().max(2), 1);
    Ok(Ok((dimensions, values)))
}

/// Refuses data that the file cannot hold.
fn check_storage(dataset: &Dataset, sizes: &[u64], bytes: u64, length: u64) -> Result<(), RecordError> {
    let (chunk, missing) = match dataset.layout().map_err(decoder)? {
        _ if bytes == 0 => return Ok(()),
        Layout::Compact { .. } | Layout::Contiguous { address: Some(_), .. } if bytes <= length => return Ok(()),
        Layout::Compact { .. } | Layout::Contiguous { address: Some(_), .. } => {
            return Err(RecordError::damaged("it promises more data than the file has"));
        }
        Layout::Chunked { chunk_shape, .. } => (chunk_shape, "chunks of it are missing"),
        _ => return Err(RecordError::damaged("it stores no data of its own")),
    };
    let width = bytes / sizes.iter().product::<u64>();
    let chunk_bytes = chunk.iter().try_fold(width, |product, size| product.checked_mul(*size)).ok_or_else(too_large)?;
    if chunk_bytes == 0 || chunk.len() != sizes.len() {
        return Err(RecordError::damaged("its chunks have no size"));
    }
    let expected = sizes.iter().zip(&chunk).map(|(size, chunk)| size.div_ceil(*chunk)).product::<u64>();
    let chunks = dataset.chunks().map_err(decoder)?;
    if chunks.len() as u64 != expected {
        return Err(RecordError::damaged(missing));
    }
    if chunks.iter().any(|stored| chunk_bytes > stored.storage_size.min(length).saturating_mul(DEFLATE_RATIO)) {
        return Err(RecordError::damaged("it promises more data than its chunks can expand to"));
    }
    Ok(())
}

/// Class of a variable by its MATLAB class, or, in a file of another program, by its stored type; `None` if
/// it is real and numeric.
fn kind(class: Option<&str>, stored: &DType) -> Option<&'static str> {
    use DType::{
        Compound, F32, F64, I8, I16, I32, I64, ObjectReference, String, U8, U16, U32, U64, VariableLengthString,
    };
    match class {
        Some("char") => return Some(class::TEXT),
        Some("cell") => return Some(class::CELL),
        Some("struct") => return Some(class::STRUCTURE),
        None | Some("double" | "single" | "logical") => {}
        Some(class) if class.strip_prefix('u').unwrap_or(class).starts_with("int") => {}
        Some(_) => return Some(class::OBJECT),
    }
    match stored {
        F32 | F64 | I8 | I16 | I32 | I64 | U8 | U16 | U32 | U64 => None,
        Compound(fields) if fields.iter().map(|(name, _)| &name[..]).eq(["real", "imag"]) => Some(class::COMPLEX),
        Compound(_) => Some(class::STRUCTURE),
        String | VariableLengthString => Some(class::TEXT),
        ObjectReference => Some(class::CELL),
        _ => Some(class::OBJECT),
    }
}
