//! Reader for the numbers in the rows of a PLY file.

use super::header::{Element, Encoding, Header, Kind, Number};
use crate::error::quoted;
use crate::text::{decoded, ends_line, is_line_end};
use crate::{FormatError, Place};

/// Reads the numbers after the header, with their places.
pub(super) struct Values<'a> {
    bytes: &'a [u8],
    /// Offset of the next byte.
    at: usize,
    encoding: Encoding,
    /// Line of that byte, for text.
    line: usize,
    /// Offset of the row that is read.
    row_start: usize,
    /// The first row of a text file that is not a line of its own, and how it differs.
    uneven: Option<(usize, &'static str)>,
    /// Whether the error is that the file has too few numbers or too many, which an uneven row can cause.
    is_miscounted: bool,
}

impl<'a> Values<'a> {
    pub fn new(bytes: &'a [u8], header: &Header) -> Self {
        Self {
            bytes,
            at: header.body,
            encoding: header.encoding,
            line: header.lines + 1,
            row_start: header.body,
            uneven: None,
            is_miscounted: false,
        }
    }

    /// Returns the place of the next number.
    pub fn place(&mut self) -> Place {
        match self.encoding {
            Encoding::Text => {
                self.skip_space();
                Place::Line(self.line)
            }
            _ => Place::Byte(self.at),
        }
    }

    /// Marks the next number as the first of a row.
    pub fn begin_row(&mut self) {
        if self.encoding == Encoding::Text {
            self.skip_space();
        }
        self.row_start = self.at;
    }

    /// Reads a row. In a text file, a row that is not a line of its own is recorded, because it can cause errors in later rows.
    pub fn row<T>(
        &mut self,
        read: impl FnOnce(&mut Self) -> Result<T, FormatError>,
    ) -> Result<T, FormatError> {
        self.begin_row();
        if self.encoding != Encoding::Text || self.uneven.is_some() {
            return read(self);
        }
        let line = self.line;
        let value = read(self)?;
        let mut rest = self.bytes[self.at..].iter();
        let next = rest.find(|b| !b.is_ascii_whitespace() || is_line_end(**b));
        if self.line != line {
            self.uneven = Some((line, "fewer"));
        } else if next.is_some_and(|next| !is_line_end(*next)) {
            self.uneven = Some((line, "more"));
        }
        Ok(value)
    }

    /// Returns the cause of an error of the rows: if the numbers did not suffice, some were left over, or the row of the error
    /// begins within a line, the first row that is not a line of its own. Such rows are valid, so they cause no other errors.
    pub fn cause_of(&self, error: FormatError) -> FormatError {
        match self.uneven.filter(|_| self.is_miscounted || !self.row_begins_line()) {
            Some((line, what)) => {
                FormatError::line(line, format!("this row has {what} values than the header declares"))
            }
            None => error,
        }
    }

    /// Whether the row that is read begins a line, so that the rows before it are whole lines together.
    fn row_begins_line(&self) -> bool {
        let before = self.bytes[..self.row_start].iter().rev();
        before.take_while(|b| b.is_ascii_whitespace()).any(|b| is_line_end(*b))
    }

    /// Returns an error if an element cannot fit into the rest of the file, before reading it.
    pub fn check_room(&mut self, element: &Element) -> Result<(), FormatError> {
        let number = |n: Number| if self.encoding == Encoding::Text { 2 } else { n.size() };
        let row: usize = element
            .properties
            .iter()
            .map(|p| match p.kind {
                Kind::Number(n) | Kind::List { count: n, .. } => number(n),
            })
            .sum();
        // White space after the last number of a text file is optional.
        let left = self.bytes.len() - self.at + 1;
        if element.count.checked_mul(row).is_some_and(|size| size <= left) {
            return Ok(());
        }
        self.is_miscounted = true;
        let Element { name, count, line, .. } = element;
        let cause = format!("{count} rows of {} do not fit into the file: is it cut off?", quoted(name));
        Err(FormatError::line(*line, cause))
    }

    /// Reads the next number. In a text file it has the value of its declared type.
    pub fn number(&mut self, kind: Number) -> Result<f64, FormatError> {
        if self.encoding == Encoding::Text {
            return self.word(kind);
        }
        let little = self.encoding == Encoding::LittleEndian;
        Ok(match kind {
            Number::I8 => i8::from_le_bytes(self.take(little)?).into(),
            Number::U8 => u8::from_le_bytes(self.take(little)?).into(),
            Number::I16 => i16::from_le_bytes(self.take(little)?).into(),
            Number::U16 => u16::from_le_bytes(self.take(little)?).into(),
            Number::I32 => i32::from_le_bytes(self.take(little)?).into(),
            Number::U32 => u32::from_le_bytes(self.take(little)?).into(),
            Number::F32 => f32::from_le_bytes(self.take(little)?).into(),
            Number::F64 => f64::from_le_bytes(self.take(little)?),
        })
    }

    /// Reads the next number, an integer from 0.
    pub fn integer(&mut self, kind: Number) -> Result<u64, FormatError> {
        let place = self.place();
        let value = self.signed_integer(kind)?;
        u64::try_from(value).map_err(|_| FormatError::new(place, format!("{value} is negative")))
    }

    /// Reads the next number, an integer.
    pub fn signed_integer(&mut self, kind: Number) -> Result<i64, FormatError> {
        let place = self.place();
        let value = self.number(kind)?;
        if kind.range().is_none() {
            return Err(FormatError::new(place, "vertex numbers must be of an integer type"));
        }
        Ok(value as i64) // exact: integer types have at most 32 bits
    }

    /// Reads the length of the next list, without its items.
    pub fn list(&mut self, count: Number, item: Number) -> Result<usize, FormatError> {
        let place = self.place();
        let length = self.integer(count)? as usize;
        let size = if self.encoding == Encoding::Text { 1 } else { item.size() };
        if length.checked_mul(size).is_none_or(|size| size > self.bytes.len() - self.at) {
            // In a row that begins a line, the count is not another number of an earlier row.
            self.is_miscounted = !self.row_begins_line();
            let cause = format!("a list of {length} items does not fit into the file");
            return Err(FormatError::new(place, cause));
        }
        Ok(length)
    }

    /// Skips a list.
    pub fn skip_list(&mut self, count: Number, item: Number) -> Result<(), FormatError> {
        for _ in 0..self.list(count, item)? {
            self.number(item)?;
        }
        Ok(())
    }

    /// Returns an error if bytes follow the last row (in text: other than white space).
    pub fn finish(&mut self) -> Result<(), FormatError> {
        let place = self.place();
        match self.bytes.len() - self.at {
            0 => Ok(()),
            left => {
                self.is_miscounted = true;
                let cause = format!("the file has {left} bytes more than the header declares");
                Err(FormatError::new(place, cause))
            }
        }
    }

    /// Reads the next N bytes, in little endian order.
    fn take<const N: usize>(&mut self, little: bool) -> Result<[u8; N], FormatError> {
        let Some(bytes) = self.bytes[self.at..].first_chunk::<N>() else {
            return Err(FormatError::new(Place::Byte(self.at), "the file ends here, within a row"));
        };
        self.at += N;
        let mut bytes = *bytes;
        if !little {
            bytes.reverse();
        }
        Ok(bytes)
    }

    fn skip_space(&mut self) {
        while self.bytes.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.line += usize::from(ends_line(self.bytes, self.at));
            self.at += 1;
        }
    }

    fn word(&mut self, kind: Number) -> Result<f64, FormatError> {
        self.skip_space();
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        let line = self.line;
        if end == 0 {
            self.is_miscounted = true;
            return Err(FormatError::line(line, "the file ends here, within a row"));
        }
        self.at += end;
        let word = decoded(&rest[..end], line)?;
        let value = match (kind, kind.range()) {
            (_, Some((smallest, largest))) => {
                word.parse::<i64>().ok().filter(|v| (smallest..=largest).contains(v)).map(|v| v as f64)
            }
            (Number::F32, _) => word.parse::<f32>().ok().map(f64::from),
            _ => word.parse::<f64>().ok(),
        };
        value.ok_or_else(|| {
            FormatError::line(line, format!("{} is not a number of the declared type", quoted(word)))
        })
    }
}
