//! Reads sealed safetensors files: a length, a header in JSON, and data. The header contains the BLAKE3 digest of all other bytes.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::refusal::{Refusal, input, require};

/// The text before the 64 digits of the digest.
const PREFIX: &str = r#"{"__metadata__":{"blake3":""#;
/// The number of bytes of the header's length.
const LENGTH: usize = 8;
/// The range of the digits of the digest.
const DIGITS: std::ops::Range<usize> = LENGTH + PREFIX.len()..LENGTH + PREFIX.len() + 64;
/// The largest size of a header, in bytes.
const MAX_HEADER: usize = 1 << 20;

/// The tensors and texts of a file whose digest matches.
pub(crate) struct Container<'a> {
    texts: BTreeMap<String, String>,
    tensors: BTreeMap<String, Tensor<'a>>,
}

struct Tensor<'a> {
    dtype: String,
    shape: Vec<usize>,
    bytes: &'a [u8],
}

/// A type of numbers in tensors.
pub(crate) trait Number: Sized + Copy {
    const DTYPE: &'static str;
    fn list(bytes: &[u8]) -> Vec<Self>;
}

macro_rules! numbers {
    ($($type:ty = $name:literal),+) => {
        $(impl Number for $type {
            const DTYPE: &'static str = $name;
            fn list(bytes: &[u8]) -> Vec<Self> {
                bytes.as_chunks().0.iter().map(|bytes| Self::from_le_bytes(*bytes)).collect()
            }
        })+
    };
}

numbers!(f64 = "F64", u64 = "U64", f32 = "F32", u32 = "U32", u8 = "U8");

impl<'a> Container<'a> {
    /// Parses a file. `format`: its kind; `newest`: the newest supported version.
    pub(crate) fn parse(bytes: &'a [u8], format: &str, newest: u64) -> Result<Self, Refusal> {
        let is_sealed = bytes.len() >= DIGITS.end && bytes[LENGTH..].starts_with(PREFIX.as_bytes());
        require(is_sealed, "not a file written by sscc")?;
        let mut hasher = blake3::Hasher::new();
        hasher.update(&bytes[..DIGITS.start]).update(&[b'0'; 64]).update(&bytes[DIGITS.end..]);
        let is_whole = hasher.finalize().to_hex().as_bytes() == &bytes[DIGITS];
        require(is_whole, "its content does not match its BLAKE3 digest")?;
        let file = Self::parse_header(bytes)
            .ok_or_else(|| Refusal::Input("its header is malformed or too large".into()))?;
        require(file.text("format")? == format, "it is of another kind")?;
        let version = file.text("version")?;
        let is_known = (1..=newest).any(|known| known.to_string() == version);
        if is_known { Ok(file) } else { input(format!("its version is not one from 1 to {newest}")) }
    }

    fn parse_header(bytes: &'a [u8]) -> Option<Self> {
        let length = usize::try_from(u64::list(&bytes[..LENGTH])[0]).ok()?;
        let header = bytes[LENGTH..].get(..length).filter(|_| length <= MAX_HEADER)?;
        let data = &bytes[LENGTH + length..];
        let Value::Object(entries) = serde_json::from_slice(header).ok()? else { return None };
        let (mut texts, mut tensors, mut ranges) = (BTreeMap::new(), BTreeMap::new(), Vec::new());
        for (name, entry) in entries {
            if name == "__metadata__" {
                for (key, text) in entry.as_object()? {
                    texts.insert(key.clone(), text.as_str()?.to_owned());
                }
                continue;
            }
            let numbers = |key: &str| -> Option<Vec<usize>> {
                let numbers = entry.get(key)?.as_array()?.iter();
                numbers.map(|n| n.as_u64().and_then(|n| usize::try_from(n).ok())).collect()
            };
            let &[begin, end] = numbers("data_offsets")?.as_slice() else { return None };
            ranges.push([begin, end]);
            let dtype = entry.get("dtype")?.as_str()?.to_owned();
            tensors.insert(name, Tensor { dtype, shape: numbers("shape")?, bytes: data.get(begin..end)? });
        }
        // Tensors lie one after the other, as in all files of sscc: no byte has two meanings, or none.
        ranges.sort_unstable();
        let end = ranges.iter().try_fold(0, |end, range| (range[0] == end).then_some(range[1]))?;
        (end == data.len()).then_some(Self { texts, tensors })
    }

    pub(crate) fn text(&self, key: &str) -> Result<&str, Refusal> {
        let text = self.texts.get(key).map(String::as_str);
        text.ok_or_else(|| Refusal::Input(format!("text '{key}' is missing")))
    }

    pub(crate) fn has(&self, name: &str) -> bool {
        self.tensors.contains_key(name)
    }

    /// Returns the numbers of a tensor and the lengths of its axes.
    pub(crate) fn tensor<T: Number>(&self, name: &str) -> Result<(Vec<T>, &[usize]), Refusal> {
        let Some(tensor) = self.tensors.get(name) else {
            return input(format!("tensor '{name}' is missing"));
        };
        let numbers = T::list(tensor.bytes);
        let size = tensor.shape.iter().try_fold(1_usize, |size, axis| size.checked_mul(*axis));
        let bytes = numbers.len() * size_of::<T>();
        if tensor.dtype != T::DTYPE || size != Some(numbers.len()) || bytes != tensor.bytes.len() {
            return input(format!("tensor '{name}' has another type or size"));
        }
        Ok((numbers, &tensor.shape))
    }

    /// Returns the numbers of a tensor with these axes; `None` matches any length.
    pub(crate) fn shaped<T: Number>(&self, name: &str, axes: &[Option<usize>]) -> Result<Vec<T>, Refusal> {
        let (numbers, shape) = self.tensor(name)?;
        let fits = |(found, wanted): (&usize, &Option<usize>)| wanted.is_none_or(|wanted| wanted == *found);
        if shape.len() != axes.len() || !shape.iter().zip(axes).all(fits) {
            return input(format!("tensor '{name}' has another shape"));
        }
        Ok(numbers)
    }

    /// Returns the pairs of a tensor of two columns, which must be ascending, each with the smaller number first.
    pub(crate) fn pairs(&self, name: &str) -> Result<Vec<[u32; 2]>, Refusal> {
        let numbers = self.shaped::<u32>(name, &[None, Some(2)])?;
        let pairs = numbers.as_chunks().0.to_vec();
        let is_sorted = pairs.is_sorted_by(|a, b| a < b) && pairs.iter().all(|[a, b]| a <= b);
        require(is_sorted, "pairs are not in order")?;
        Ok(pairs)
    }
}
