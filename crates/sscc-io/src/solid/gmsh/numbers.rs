//! Numbers of gmsh files, as text or as bytes.

use crate::error::quoted;
use crate::solid::words::Words;
use crate::{FormatError, Message, Place};

/// Reads numbers of a text or a binary file. Nothing is allocated by a count: each item is read before the next.
pub(super) struct Numbers<'a> {
    pub words: Words<'a>,
    pub big_endian: bool,
}

impl Numbers<'_> {
    /// Returns the current place.
    pub fn place(&self) -> Place {
        self.words.place()
    }

    pub fn refused<T>(&self, cause: impl Into<Message>) -> Result<T, FormatError> {
        Err(FormatError::new(self.place(), cause))
    }

    fn bytes<const N: usize>(&mut self, what: &str) -> Result<[u8; N], FormatError> {
        let mut bytes = self.words.take::<N>(what)?;
        if self.big_endian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    /// Reads an integer, of 32 bits in a binary file.
    pub fn integer(&mut self, what: &str) -> Result<i64, FormatError> {
        if self.words.binary {
            return Ok(i32::from_le_bytes(self.bytes(what)?).into());
        }
        self.words.integer(what)
    }

    /// Reads a count, or a tag of version 4.
    pub fn size(&mut self, what: &str) -> Result<u64, FormatError> {
        if self.words.binary {
            return Ok(u64::from_le_bytes(self.bytes(what)?));
        }
        let word = self.words.word(what)?;
        word.parse().or_else(|_| self.refused(format!("{} is not a count or tag", quoted(word))))
    }

    /// Reads a tag of version 2: an integer from 0.
    pub fn tag(&mut self, what: &str) -> Result<u64, FormatError> {
        let tag = self.integer(what)?;
        u64::try_from(tag).or_else(|_| self.refused(format!("{tag} is not a tag")))
    }

    /// Reads a finite number.
    pub fn number(&mut self, what: &str) -> Result<f64, FormatError> {
        if !self.words.binary {
            return self.words.number(what);
        }
        let value = f64::from_le_bytes(self.bytes(what)?);
        if value.is_finite() { Ok(value) } else { self.refused(format!("{value} is not a finite number")) }
    }

    /// Skips that many integers.
    pub fn skip_integers(&mut self, count: u64, what: &str) -> Result<(), FormatError> {
        (0..count).try_for_each(|_| self.integer(what).map(drop))
    }
}
