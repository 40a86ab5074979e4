//! Reads sealed safetensors files: a length, a header in JSON, and data. The header contains the BLAKE3 digest of all other bytes.

use safetensors::Dtype;
use safetensors::tensor::Metadata;

use crate::refusal::{Refusal, Result, input, require};

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
    metadata: Metadata,
    data: &'a [u8],
}

impl<'a> Container<'a> {
    /// Parses a file. `format`: its kind; `newest`: the newest supported version.
    pub(crate) fn parse(bytes: &'a [u8], format: &str, newest: u64) -> Result<Self> {
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
        let (length, rest) = bytes.split_first_chunk()?;
        let length = usize::try_from(u64::from_le_bytes(*length)).ok().filter(|n| *n <= MAX_HEADER)?;
        let (header, data) = rest.split_at_checked(length)?;
        // This refuses tensors that do not lie one after the other, as in all files of sscc, or whose shape does not fit their
        // size: no byte has two meanings, or none.
        let metadata: Metadata = serde_json::from_slice(header).ok()?;
        (metadata.data_len() == data.len()).then_some(Self { metadata, data })
    }

    pub(crate) fn text(&self, key: &str) -> Result<&str> {
        let text = self.metadata.metadata().as_ref().and_then(|texts| texts.get(key));
        text.map_or_else(|| input(format!("text '{key}' is missing")), |text| Ok(text.as_str()))
    }

    pub(crate) fn has(&self, name: &str) -> bool {
        self.metadata.info(name).is_some()
    }

    /// Returns the bytes of a tensor of these axes; `None` matches any length.
    pub(crate) fn bytes(&self, name: &str, axes: &[Option<usize>], dtype: Dtype) -> Result<&'a [u8]> {
        let Some(info) = self.metadata.info(name) else {
            return input(format!("tensor '{name}' is missing"));
        };
        if info.dtype != dtype {
            return input(format!("tensor '{name}' has another type"));
        }
        let fits = |(found, wanted): (&usize, &Option<usize>)| wanted.is_none_or(|wanted| wanted == *found);
        if info.shape.len() != axes.len() || !info.shape.iter().zip(axes).all(fits) {
            return input(format!("tensor '{name}' has another shape"));
        }
        Ok(&self.data[info.data_offsets.0..info.data_offsets.1])
    }

    pub(crate) fn reals(&self, name: &str, axes: &[Option<usize>]) -> Result<Vec<f64>> {
        Ok(reals(self.bytes(name, axes, Dtype::F64)?))
    }

    pub(crate) fn integers(&self, name: &str, axes: &[Option<usize>]) -> Result<Vec<u32>> {
        let bytes = self.bytes(name, axes, Dtype::U32)?;
        Ok(bytes.as_chunks().0.iter().map(|bytes| u32::from_le_bytes(*bytes)).collect())
    }

    /// Returns the pairs of a tensor of two columns, which must be ascending, each with the smaller number first.
    pub(crate) fn pairs(&self, name: &str) -> Result<Vec<[u32; 2]>> {
        let pairs = self.integers(name, &[None, Some(2)])?.as_chunks().0.to_vec();
        let is_sorted = pairs.is_sorted_by(|a, b| a < b) && pairs.iter().all(|[a, b]| a <= b);
        require(is_sorted, "pairs are not in order")?;
        Ok(pairs)
    }
}

/// Returns the numbers of a list of bytes.
pub(crate) fn reals(bytes: &[u8]) -> Vec<f64> {
    bytes.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a sealed file with these entries of the header after its texts, quoted by apostrophes.
    fn sealed(entries: &str, data: &[u8]) -> Vec<u8> {
        let texts = "','format':'f','version':'1'}";
        let header = [PREFIX, &"0".repeat(64), &format!("{texts}{entries}}}").replace('\'', "\"")].concat();
        let mut bytes = [&(header.len() as u64).to_le_bytes()[..], header.as_bytes(), data].concat();
        let digest = blake3::hash(&bytes).to_hex();
        bytes[DIGITS].copy_from_slice(digest.as_bytes());
        bytes
    }

    /// Returns the entry of a tensor of bytes.
    fn tensor(name: &str, shape: &str, begin: u64, end: u64) -> String {
        format!(",'{name}':{{'dtype':'U8','shape':[{shape}],'data_offsets':[{begin},{end}]}}")
    }

    #[test]
    fn headers_that_do_not_describe_each_byte_once_are_refused() {
        let two = tensor("a", "4", 0, 4) + &tensor("b", "2, 2", 4, 8);
        let bytes = sealed(&two, &[7; 8]);
        let file = Container::parse(&bytes, "f", 1).unwrap();
        assert!(file.has("b") && !file.has("c") && file.bytes("b", &[Some(2), None], Dtype::U8).is_ok());
        for (axes, dtype) in
            [(&[Some(4)][..], Dtype::U8), (&[Some(2), Some(3)], Dtype::U8), (&[None; 2], Dtype::I8)]
        {
            assert!(file.bytes("b", axes, dtype).is_err(), "{axes:?}");
        }
        let last = u64::MAX;
        for entries in [
            two.clone() + &tensor("c", "1", 8, 9),
            tensor("a", "4", 0, 4),
            tensor("a", "4", 0, 4) + &tensor("b", "3", 5, 8),
            tensor("a", "5", 0, 5) + &tensor("b", "4", 4, 8),
            tensor("a", "4", 0, 4) + &tensor("b", "3", 4, 8),
            // A name twice, of which the last one leaves a gap, and texts twice.
            tensor("a", "4", 0, 4) + &tensor("a", "4", 4, 8),
            two.clone() + ",'__metadata__':{'format':'f','version':'1'}",
            // Sizes that overflow.
            two.clone() + &tensor("c", &(last - 7).to_string(), 8, last) + &tensor("d", "9", last, 8),
            tensor("a", "4294967296, 4294967296", 0, 0) + &tensor("b", "8", 0, 8),
            tensor("a", "-1", 0, 8),
            two.replace("U8", "X8"),
            two.replace("dtype", "type"),
            format!(",{}", " ".repeat(MAX_HEADER)),
        ] {
            let refusal = Container::parse(&sealed(&entries, &[7; 8]), "f", 1).err();
            assert_eq!(
                refusal,
                Some(Refusal::Input("its header is malformed or too large".into())),
                "{entries:.200}"
            );
        }
        for (format, newest) in [("g", 1), ("f", 0)] {
            assert!(Container::parse(&bytes, format, newest).is_err(), "{format} {newest}");
        }
    }
}
