//! Parser for the header of a `.npy` file: a Python dictionary with the keys `descr`, `fortran_order` and `shape`.

use crate::error::quoted;
use crate::{FormatError, Place};

const MAGIC: &[u8] = b"\x93NUMPY";

/// Maximum number of axes; NumPy allows 64.
const MAX_AXES: usize = 32;

/// Kind of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Class {
    Float,
    Signed,
    Unsigned,
}

/// Type of entries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Item {
    pub class: Class,
    /// Size of one entry in bytes: 2, 4 or 8 for floats; 1, 2, 4 or 8 for integers.
    pub size: usize,
    pub big: bool,
}

/// Kind of numbers that a reader accepts; a reader of floats also accepts integers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NumberKind {
    Floats,
    Integers,
}

#[derive(Debug, PartialEq)]
pub(super) struct Header {
    pub item: Item,
    pub fortran: bool,
    /// Length of each axis, not yet checked against the file.
    pub shape: Vec<usize>,
    /// Offset of the first byte after the header.
    pub body: usize,
}

impl NumberKind {
    fn advice(self) -> &'static str {
        match self {
            Self::Floats => "save the array as float64",
            Self::Integers => "save the array as integers",
        }
    }
}

impl Item {
    fn from_descr(descr: &str, wanted: NumberKind) -> Option<Self> {
        let [order, kind, digit] = *descr.as_bytes() else {
            return None;
        };
        let (class, sizes) = match (kind, wanted) {
            (b'f', NumberKind::Floats) => (Class::Float, &b"248"[..]),
            (b'i', _) => (Class::Signed, &b"1248"[..]),
            (b'u', _) => (Class::Unsigned, &b"1248"[..]),
            _ => return None,
        };
        let order_fits = match order {
            b'<' | b'>' => true,
            b'|' => digit == b'1', // one byte has no order
            _ => false,
        };
        let is_supported = order_fits && sizes.contains(&digit);
        is_supported.then(|| Self { class, size: (digit - b'0').into(), big: order == b'>' })
    }
}

impl Header {
    pub fn parse(bytes: &[u8], wanted: NumberKind) -> Result<Self, FormatError> {
        let at_byte = |at, cause: &str| FormatError::new(Place::Byte(at), cause);
        let Some(rest) = bytes.strip_prefix(MAGIC) else {
            return Err(at_byte(0, "not a NumPy array: a .npy file begins with '\\x93NUMPY'"));
        };
        let cut = || at_byte(bytes.len(), "the file ends within the header");
        let [major, minor] = *rest.first_chunk::<2>().ok_or_else(cut)?;
        let (length, start) = match (major, minor) {
            (1, 0) => {
                let length = rest[2..].first_chunk::<2>().ok_or_else(cut)?;
                (usize::from(u16::from_le_bytes(*length)), 10)
            }
            (2 | 3, 0) => {
                let length = rest[2..].first_chunk::<4>().ok_or_else(cut)?;
                (u32::from_le_bytes(*length) as usize, 12)
            }
            _ => return Err(at_byte(6, &format!("version {major}.{minor} of the format is not supported"))),
        };
        let body = usize::checked_add(start, length).filter(|end| *end <= bytes.len()).ok_or_else(cut)?;
        let text =
            std::str::from_utf8(&bytes[start..body]).map_err(|_| at_byte(start, "the header is not text"))?;
        let (item, fortran, shape) =
            dictionary(text, wanted).map_err(|cause| at_byte(start, &format!("header: {cause}")))?;
        Ok(Self { item, fortran, shape, body })
    }
}

fn dictionary(text: &str, wanted: NumberKind) -> Result<(Item, bool, Vec<usize>), String> {
    let (mut item, mut fortran, mut shape) = (None, None, None);
    let mut scanner = Scanner(text);
    scanner.expect("{")?;
    while !scanner.take("}") {
        let key = scanner.string()?;
        scanner.expect(":")?;
        let is_repeated = match key {
            "descr" => item.replace(scanner.item(wanted)?).is_some(),
            "fortran_order" => fortran.replace(scanner.boolean()?).is_some(),
            "shape" => shape.replace(scanner.shape()?).is_some(),
            _ => return Err(format!("unknown key {}", quoted(key))),
        };
        if is_repeated {
            return Err(format!("the key {} is repeated", quoted(key)));
        }
        if !scanner.take(",") {
            scanner.expect("}")?;
            break;
        }
    }
    scanner.end()?;
    match (item, fortran, shape) {
        (Some(item), Some(fortran), Some(shape)) => Ok((item, fortran, shape)),
        _ => Err("one of 'descr', 'fortran_order', 'shape' is missing".into()),
    }
}

/// Unparsed remainder of the header.
struct Scanner<'a>(&'a str);

impl<'a> Scanner<'a> {
    fn take(&mut self, token: &str) -> bool {
        let rest = self.0.trim_ascii_start().strip_prefix(token);
        self.0 = rest.unwrap_or(self.0);
        rest.is_some()
    }

    fn expect(&mut self, token: &str) -> Result<(), String> {
        if self.take(token) { Ok(()) } else { Err(format!("'{token}' expected before {}", quoted(self.0))) }
    }

    fn end(&self) -> Result<(), String> {
        match self.0.trim_ascii() {
            "" => Ok(()),
            rest => Err(format!("unexpected text {}", quoted(rest))),
        }
    }

    fn string(&mut self) -> Result<&'a str, String> {
        let quote = if self.take("'") { '\'' } else { self.expect("\"").map(|()| '"')? };
        let (text, rest) = self.0.split_once(quote).ok_or("a string has no end")?;
        self.0 = rest;
        Ok(text)
    }

    fn item(&mut self, wanted: NumberKind) -> Result<Item, String> {
        let advice = wanted.advice();
        if self.0.trim_ascii_start().starts_with('[') {
            return Err(format!("the array is structured: {advice}"));
        }
        let descr = self.string()?;
        Item::from_descr(descr, wanted)
            .ok_or_else(|| format!("the array has numbers of type {}: {advice}", quoted(descr)))
    }

    fn boolean(&mut self) -> Result<bool, String> {
        if self.take("True") { Ok(true) } else { self.expect("False").map(|()| false) }
    }

    fn shape(&mut self) -> Result<Vec<usize>, String> {
        let mut shape = Vec::new();
        self.expect("(")?;
        while !self.take(")") {
            let rest = self.0.trim_ascii_start();
            let (digits, rest) = rest.split_at(rest.bytes().take_while(u8::is_ascii_digit).count());
            let length =
                digits.parse().map_err(|_| format!("not the length of an axis: {}", quoted(rest)))?;
            shape.push(length);
            // Python 2 wrote long integers as 3L.
            self.0 = rest.strip_prefix('L').unwrap_or(rest);
            if shape.len() > MAX_AXES {
                return Err(format!("more than {MAX_AXES} axes"));
            }
            if !self.take(",") {
                self.expect(")")?;
                break;
            }
        }
        Ok(shape)
    }
}
