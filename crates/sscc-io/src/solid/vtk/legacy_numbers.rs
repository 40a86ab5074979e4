//! Numbers of a legacy `.vtk` file: words, or big-endian bytes.

use super::super::words::Words;
use super::data::unsigned;
use crate::FormatError;
use crate::error::quoted;

/// Reads the arrays of a file.
pub(super) struct Numbers<'a> {
    pub words: Words<'a>,
}

/// Type of the items of an array.
#[derive(Clone, Copy)]
pub(super) struct Kind {
    /// Bytes of an item; 0 if items are not whole bytes.
    size: u64,
    form: Form,
}

#[derive(Clone, Copy, PartialEq)]
enum Form {
    Float,
    Signed,
    Unsigned,
    /// Bits, eight in a byte. They are only skipped.
    Bit,
    /// Texts: lines, or bytes after their length. They are only skipped.
    Text,
}

/// Number of bytes of the length before a text, by the first two bits of the length.
const LENGTHS: [u64; 4] = [8, 4, 2, 1];

impl Numbers<'_> {
    /// Reads the type of an array.
    pub fn kind(&mut self) -> Result<Kind, FormatError> {
        let name = self.words.word("the type of an array")?;
        let (size, form) = match name.to_ascii_lowercase().as_str() {
            "float" => (4, Form::Float),
            "double" => (8, Form::Float),
            "char" | "signed_char" | "vtktypeint8" => (1, Form::Signed),
            "short" | "vtktypeint16" => (2, Form::Signed),
            "int" | "vtktypeint32" => (4, Form::Signed),
            "long" | "vtktypeint64" | "vtkidtype" => (8, Form::Signed),
            "unsigned_char" | "vtktypeuint8" => (1, Form::Unsigned),
            "unsigned_short" | "vtktypeuint16" => (2, Form::Unsigned),
            "unsigned_int" | "vtktypeuint32" => (4, Form::Unsigned),
            "unsigned_long" | "vtktypeuint64" => (8, Form::Unsigned),
            "bit" => (0, Form::Bit),
            "string" | "utf8_string" => (0, Form::Text),
            _ => return self.words.refused(format!("numbers of type {} are not supported", quoted(name))),
        };
        // Ids are written as 32-bit integers, whatever their type.
        let size = if name.eq_ignore_ascii_case("vtkIdType") { 4 } else { size };
        Ok(Kind { size, form })
    }

    /// Reads `count` numbers. A file that is too short for them is an error before memory is reserved.
    pub fn floats(&mut self, count: u64, kind: Kind, what: &str) -> Result<Vec<f64>, FormatError> {
        self.check_numbers(kind)?;
        if !self.words.binary {
            return (0..count).map(|_| self.words.number(what)).collect();
        }
        let number = |bytes: &[u8]| match (kind.form, kind.size) {
            (Form::Float, 4) => f64::from(f32::from_bits(unsigned(bytes, true) as u32)),
            (Form::Float, _) => f64::from_bits(unsigned(bytes, true)),
            (Form::Signed, size) => signed(bytes, size) as f64,
            (_, _) => unsigned(bytes, true) as f64,
        };
        Ok(self.bytes(count, kind, what)?.chunks_exact(kind.size as usize).map(number).collect())
    }

    /// Reads `count` integers from 0; `kind` is that of binary ones.
    pub fn integers(&mut self, count: u64, kind: Kind, what: &str) -> Result<Vec<u64>, FormatError> {
        self.check_numbers(kind)?;
        if !self.words.binary {
            return (0..count).map(|_| Ok(self.words.count(what)? as u64)).collect();
        }
        let number = |bytes: &[u8]| match kind.form {
            Form::Float => None,
            Form::Signed => u64::try_from(signed(bytes, kind.size)).ok(),
            _ => Some(unsigned(bytes, true)),
        };
        let bytes = self.bytes(count, kind, what)?;
        let numbers: Option<Vec<u64>> = bytes.chunks_exact(kind.size as usize).map(number).collect();
        match numbers {
            Some(numbers) => Ok(numbers),
            None => self.words.refused(format!("{what}: integers from 0 were expected")),
        }
    }

    /// Reads `count` integers of 32 bits.
    pub fn ints(&mut self, count: u64, what: &str) -> Result<Vec<u64>, FormatError> {
        self.integers(count, Kind { size: 4, form: Form::Signed }, what)
    }

    /// Refuses items that are not read as numbers.
    fn check_numbers(&self, kind: Kind) -> Result<(), FormatError> {
        match kind.form {
            Form::Bit => self.words.refused("numbers of type 'bit' are not supported"),
            Form::Text => self.words.refused("numbers were expected, not texts"),
            Form::Float | Form::Signed | Form::Unsigned => Ok(()),
        }
    }

    /// Skips `count` items: numbers, which may be any words, bits or texts.
    pub fn skip(&mut self, count: u64, kind: Kind, what: &str) -> Result<(), FormatError> {
        match kind.form {
            Form::Text => self.skip_texts(count, what),
            Form::Bit if self.words.binary => {
                self.words.rest_of_line();
                self.words.bytes(count.div_ceil(8), what).map(drop)
            }
            _ if self.words.binary => self.bytes(count, kind, what).map(drop),
            _ => (0..count).try_for_each(|_| self.words.word(what).map(drop)),
        }
    }

    /// Skips texts: lines, which may be empty; in binary files bytes after their length.
    fn skip_texts(&mut self, count: u64, what: &str) -> Result<(), FormatError> {
        self.words.rest_of_line();
        for _ in 0..count {
            if !self.words.binary {
                self.words.line(what)?;
                continue;
            }
            let mut ahead = self.words;
            let start = ahead.take::<1>(what)?[0] >> 6;
            let size = LENGTHS[usize::from(start)];
            let length = unsigned(self.words.bytes(size, what)?, true);
            // The first two bits state the size of the length.
            let length = if size == 8 { length } else { length & (u64::MAX >> (66 - 8 * size)) };
            self.words.bytes(length, what)?;
        }
        Ok(())
    }

    /// Skips `count` bytes, or as many words.
    pub fn skip_bytes(&mut self, count: u64, what: &str) -> Result<(), FormatError> {
        self.skip(count, Kind { size: 1, form: Form::Unsigned }, what)
    }

    /// Returns the bytes of `count` numbers, which begin in the next line.
    fn bytes(&mut self, count: u64, kind: Kind, what: &str) -> Result<&[u8], FormatError> {
        self.words.rest_of_line();
        self.words.bytes(count.saturating_mul(kind.size), what)
    }
}

fn signed(bytes: &[u8], size: u64) -> i64 {
    let shift = 64 - 8 * size as u32;
    (unsigned(bytes, true) << shift).cast_signed() >> shift
}
