//! Bytes of the arrays of a VTK file: base64, raw, plain or compressed by zlib.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::{Decompress, FlushDecompress, Status};

/// Bytes that are expanded at a time.
const BUFFER: usize = 1 << 14;

/// Encoding of the binary arrays of a file.
#[derive(Clone, Copy)]
pub(super) struct Layout {
    /// Bytes of a number in the header of an array: 4 or 8.
    pub header: usize,
    pub is_big_endian: bool,
    pub is_compressed: bool,
}

impl Layout {
    /// Returns the bytes of an array that has `expected` of them. `data` begins with its header; bytes after the array are
    /// ignored. Memory is that of the data and of `expected`, which the caller has checked.
    pub fn unpack(self, data: &[u8], expected: u64) -> Result<Vec<u8>, String> {
        if self.is_compressed { self.inflate(data, expected) } else { self.plain(data, expected) }
    }

    fn plain(self, data: &[u8], expected: u64) -> Result<Vec<u8>, String> {
        let length = self.number(data, 0)?;
        check_length(length, expected)?;
        let bytes = usize::try_from(length).ok().and_then(|length| data[self.header..].get(..length));
        match bytes {
            Some(bytes) => Ok(bytes.to_vec()),
            None => Err(cut_off(length, data.len() - self.header)),
        }
    }

    /// Expands an array in blocks. Its header has the number of blocks, the size of each, that of the last one if it is
    /// smaller (else 0), and the compressed size of each.
    fn inflate(self, data: &[u8], expected: u64) -> Result<Vec<u8>, String> {
        let count = self.number(data, 0)?;
        if count == 0 {
            return check_length(0, expected).map(|()| Vec::new());
        }
        let (size, last) = (self.number(data, 1)?, self.number(data, 2)?);
        if size == 0 {
            return Err("its blocks have no bytes: the file is damaged".into());
        }
        let last = if last == 0 { size } else { last };
        let total = (count - 1).checked_mul(size).and_then(|length| length.checked_add(last));
        check_length(total.unwrap_or(u64::MAX), expected)?;
        let header = count.checked_add(3).and_then(|numbers| numbers.checked_mul(self.header as u64));
        let start = header.and_then(|bytes| usize::try_from(bytes).ok()).filter(|bytes| *bytes <= data.len());
        let Some(mut at) = start else { return Err(cut_off(header.unwrap_or(u64::MAX), data.len())) };
        let (mut bytes, mut blocks) = (Vec::new(), Blocks::new());
        for block in 0..count as usize {
            let compressed = self.number(data, 3 + block)?;
            let end = usize::try_from(compressed).ok().and_then(|length| at.checked_add(length));
            let Some(packed) = end.and_then(|end| data.get(at..end)) else {
                return Err(cut_off(compressed, data.len() - at));
            };
            at += packed.len();
            let size = if block + 1 == count as usize { last } else { size };
            if !blocks.expand(packed, size, &mut bytes) {
                return Err(format!(
                    "compressed block {block} (counted from 0) is damaged: it does not expand to {size} bytes"
                ));
            }
        }
        Ok(bytes)
    }

    /// Returns a number of the header.
    fn number(self, data: &[u8], at: usize) -> Result<u64, String> {
        let start = at * self.header;
        let Some(bytes) = data.get(start..start + self.header) else {
            return Err(cut_off((start + self.header) as u64, data.len()));
        };
        Ok(unsigned(bytes, self.is_big_endian))
    }
}

/// Expands blocks of zlib one after the other, with one state, since blocks may be tiny.
struct Blocks {
    zlib: Decompress,
    buffer: Box<[u8]>,
}

impl Blocks {
    fn new() -> Self {
        Self { zlib: Decompress::new(true), buffer: vec![0; BUFFER].into() }
    }

    /// Appends the bytes of a block; returns whether it is whole and has `size` bytes. At most [`BUFFER`] more are appended.
    fn expand(&mut self, packed: &[u8], size: u64, bytes: &mut Vec<u8>) -> bool {
        self.zlib.reset(true);
        loop {
            let (read, written) = (self.zlib.total_in(), self.zlib.total_out());
            let rest = usize::try_from(read).ok().and_then(|read| packed.get(read..)).unwrap_or_default();
            let status = self.zlib.decompress(rest, &mut self.buffer, FlushDecompress::None);
            bytes.extend(&self.buffer[..(self.zlib.total_out() - written) as usize]);
            match status {
                Ok(Status::StreamEnd) => return self.zlib.total_out() == size,
                Ok(_) if self.zlib.total_out() > size => return false,
                // Without progress the block is cut off.
                Ok(_) if (self.zlib.total_in(), self.zlib.total_out()) == (read, written) => return false,
                Ok(_) => {}
                Err(_) => return false,
            }
        }
    }
}

fn check_length(stated: u64, expected: u64) -> Result<(), String> {
    if stated == expected {
        return Ok(());
    }
    Err(format!("the file states {stated} bytes, its numbers of points and cells need {expected}"))
}

fn cut_off(needed: u64, left: usize) -> String {
    format!("{needed} bytes are needed, {left} are left: is the file cut off?")
}

/// Returns an unsigned number of at most 8 bytes.
pub(super) fn unsigned(bytes: &[u8], is_big_endian: bool) -> u64 {
    let fold = |value: u64, byte: &u8| value << 8 | u64::from(*byte);
    if is_big_endian { bytes.iter().fold(0, fold) } else { bytes.iter().rev().fold(0, fold) }
}

/// Decodes base64 of several streams one after the other, each of which may end with padding.
pub(super) fn from_base64(text: &[u8]) -> Result<Vec<u8>, String> {
    let mut symbols: Vec<u8> = text.to_vec();
    symbols.retain(|byte| !byte.is_ascii_whitespace());
    let mut bytes = Vec::with_capacity(symbols.len() / 4 * 3);
    let mut rest = &symbols[..];
    while !rest.is_empty() {
        // A stream ends with the group of four that has padding.
        let padding = rest.iter().position(|symbol| *symbol == b'=');
        let end = padding.map_or(rest.len(), |at| (at / 4 + 1) * 4).min(rest.len());
        let (stream, next) = rest.split_at(end);
        STANDARD
            .decode_vec(stream, &mut bytes)
            .map_err(|error| format!("its base64 text is damaged or cut off: {error}"))?;
        rest = next;
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    const PLAIN: Layout = Layout { header: 4, is_big_endian: false, is_compressed: false };

    #[test]
    fn streams_of_base64_follow_each_other() {
        assert_eq!(from_base64(b"AQ==\n AgM= BAUG").unwrap(), [1, 2, 3, 4, 5, 6]);
        for bad in ["A", "AQ", "AQ=", "A===", "=AQI", "AQ==B", "AQ-_"] {
            assert!(from_base64(bad.as_bytes()).is_err(), "{bad}");
        }
    }

    #[test]
    fn numbers_have_a_byte_order() {
        assert_eq!((unsigned(&[1, 2], false), unsigned(&[1, 2], true)), (513, 258));
    }

    /// An array of zlib in blocks of this size.
    fn zlib(bytes: &[u8], size: usize) -> Vec<u8> {
        let pack = |block: &[u8]| {
            let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
            encoder.write_all(block).unwrap();
            encoder.finish().unwrap()
        };
        let blocks: Vec<Vec<u8>> = bytes.chunks(size).map(pack).collect();
        let lengths = blocks.iter().map(Vec::len);
        let header = [blocks.len(), size, bytes.len() % size].into_iter().chain(lengths);
        let header = header.flat_map(|number| (number as u32).to_le_bytes());
        header.chain(blocks.iter().flatten().copied()).collect()
    }

    #[test]
    fn blocks_have_any_size() {
        let layout = Layout { is_compressed: true, ..PLAIN };
        let bytes: Vec<u8> = (0..100_000_u64).map(|i| ((i * i) >> 7) as u8).collect();
        for size in [1, 7, BUFFER - 1, BUFFER, BUFFER + 1, 2 * BUFFER, bytes.len()] {
            let packed = zlib(&bytes, size);
            assert!(layout.unpack(&packed, bytes.len() as u64).unwrap() == bytes, "{size}");
            let cut = layout.unpack(&packed[..packed.len() - 1], bytes.len() as u64);
            assert!(cut.unwrap_err().contains("is the file cut off?"), "{size}");
        }
        // A block that is cut off, has a wrong sum, or expands to less or more than the header states.
        let whole = zlib(&bytes[..300], 300);
        let with = |at: usize, value: u8| {
            let mut damaged = whole.clone();
            damaged[at] = value;
            layout.unpack(&damaged, 300).unwrap_err()
        };
        for message in
            [with(12, whole[12] - 1), with(whole.len() - 1, whole[whole.len() - 1] ^ 1), with(16, 0)]
        {
            assert!(message.starts_with("compressed block 0 (counted from 0) is damaged"), "{message}");
        }
        for size in [299, 301] {
            let mut damaged = whole.clone();
            damaged[4..12].copy_from_slice(&[(size as u32).to_le_bytes(), [0; 4]].concat());
            let message = layout.unpack(&damaged, size).unwrap_err();
            assert!(message.ends_with(&format!("does not expand to {size} bytes")), "{message}");
        }
        // A bomb is not expanded beyond the stated size.
        let mut bomb = zlib(&vec![0; 10 << 20], 10 << 20);
        bomb[4..12].copy_from_slice(&[1000_u32.to_le_bytes(), [0; 4]].concat());
        let (mut blocks, mut bytes) = (Blocks::new(), Vec::new());
        assert!(!blocks.expand(&bomb[16..], 1000, &mut bytes) && bytes.len() <= 1000 + BUFFER);
        assert!(layout.unpack(&bomb, 1000).is_err());
    }

    #[test]
    fn stated_lengths_are_compared() {
        let data = [2, 0, 0, 0, 7, 8, 9];
        assert_eq!(PLAIN.unpack(&data, 2).unwrap(), [7, 8]);
        for (data, expected) in [(&data[..], 3), (&data[..5], 2), (&data[..3], 2), (&[], 0)] {
            assert!(PLAIN.unpack(data, expected).is_err(), "{data:?}");
        }
        let zlib = Layout { is_compressed: true, ..PLAIN };
        for numbers in [[u32::MAX; 3], [1, 0, 0], [2, u32::MAX, 1], [0, 0, 0]] {
            let data: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
            assert!(zlib.unpack(&data, 4).is_err(), "{numbers:?}");
        }
    }
}
