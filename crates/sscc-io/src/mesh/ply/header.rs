//! Parser for the header of a PLY file.

use crate::FormatError;
use crate::error::quoted;
use crate::text::{Lines, count, decoded};

/// Encoding of the rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// Number type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// Property of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Number(Number),
    List { count: Number, item: Number },
}

pub(super) struct Property {
    pub name: String,
    pub kind: Kind,
}

pub(super) struct Element {
    pub name: String,
    /// Count of rows, not yet checked against the file.
    pub count: usize,
    pub properties: Vec<Property>,
    /// Line of its declaration.
    pub line: usize,
}

pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Number of lines of the header.
    pub lines: usize,
    /// Offset of the first byte after the header.
    pub body: usize,
}

/// Maximum number of elements, and of properties of an element. Each name is compared with all others.
const MAX_DECLARATIONS: usize = 256;

impl Number {
    fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    /// Size of one number in bytes.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Smallest and largest integer; None for floating point.
    pub fn range(self) -> Option<(i64, i64)> {
        Some(match self {
            Self::I8 => (i8::MIN.into(), i8::MAX.into()),
            Self::U8 => (0, u8::MAX.into()),
            Self::I16 => (i16::MIN.into(), i16::MAX.into()),
            Self::U16 => (0, u16::MAX.into()),
            Self::I32 => (i32::MIN.into(), i32::MAX.into()),
            Self::U32 => (0, u32::MAX.into()),
            Self::F32 | Self::F64 => return None,
        })
    }
}

impl Header {
    pub fn parse(bytes: &[u8]) -> Result<Self, FormatError> {
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        let mut first_end: &[u8] = &[];
        for (line, text) in Lines::new(bytes)? {
            let refused = |cause: String| Err(FormatError::line(line, cause));
            if line == 1 {
                if text.trim_ascii_end() != b"ply" {
                    return refused("a PLY file begins with 'ply'".into());
                }
                first_end = line_end(after(bytes, text));
                continue;
            }
            if text.starts_with(b"comment") || text.starts_with(b"obj_info") {
                continue;
            }
            let words: Vec<_> = decoded(text, line)?.split_ascii_whitespace().take(6).collect();
            match words[..] {
                [] => {}
                ["format", name, "1.0"] if encoding.is_none() => encoding = Some(encoding_of(name, line)?),
                ["element", name, rows] => {
                    if elements.iter().any(|e| e.name == name) {
                        return refused(format!("there is a second element {}", quoted(name)));
                    }
                    if elements.len() == MAX_DECLARATIONS {
                        return refused(format!("more than {MAX_DECLARATIONS} elements"));
                    }
                    let count = count(rows, line)?;
                    elements.push(Element { name: name.into(), count, properties: Vec::new(), line });
                }
                ["property", ref rest @ ..] => {
                    let Some(element) = elements.last_mut() else {
                        return refused("a property before the first element".into());
                    };
                    let property = property(rest, line)?;
                    if element.properties.iter().any(|p| p.name == property.name) {
                        return refused(format!("there is a second property {}", quoted(&property.name)));
                    }
                    if element.properties.len() == MAX_DECLARATIONS {
                        return refused(format!("more than {MAX_DECLARATIONS} properties"));
                    }
                    element.properties.push(property);
                }
                ["end_header"] => {
                    let Some(encoding) = encoding else {
                        return refused("the header has no line 'format'".into());
                    };
                    let rest = after(bytes, text);
                    // The rows of a binary file may begin with the byte LF, after a CR that ends all lines.
                    let is_cr = encoding != Encoding::Text && first_end == b"\r";
                    let end = if is_cr { rest.len().min(1) } else { line_end(rest).len() };
                    let body = bytes.len() - rest.len() + end;
                    return Ok(Self { encoding, elements, lines: line, body });
                }
                _ => {
                    return refused(format!(
                        "not a line of a PLY header: {}",
                        quoted(&String::from_utf8_lossy(text))
                    ));
                }
            }
        }
        Err(FormatError::whole("the file ends within the header"))
    }
}

/// Returns the bytes after a line, from its line end on. The line is a part of the bytes.
fn after<'a>(bytes: &'a [u8], line: &[u8]) -> &'a [u8] {
    let end = line.as_ptr_range().end as usize - bytes.as_ptr() as usize;
    bytes.get(end..).unwrap_or_default()
}

/// Returns the line end at the beginning of these bytes; nothing at the end of the file.
fn line_end(rest: &[u8]) -> &[u8] {
    let size = if rest.starts_with(b"\r\n") { 2 } else { 1 };
    rest.get(..size).unwrap_or_default()
}

fn encoding_of(name: &str, line: usize) -> Result<Encoding, FormatError> {
    match name {
        "ascii" => Ok(Encoding::Text),
        "binary_little_endian" => Ok(Encoding::LittleEndian),
        "binary_big_endian" => Ok(Encoding::BigEndian),
        _ => Err(FormatError::line(line, format!("unknown format {}", quoted(name)))),
    }
}

fn property(words: &[&str], line: usize) -> Result<Property, FormatError> {
    let number = |name: &str| {
        Number::from_name(name)
            .ok_or_else(|| FormatError::line(line, format!("unknown type {}", quoted(name))))
    };
    let (name, kind) = match *words {
        ["list", count, item, name] => {
            let count = number(count)?;
            if count.range().is_none() {
                return Err(FormatError::line(line, "the length of a list must be of an integer type"));
            }
            (name, Kind::List { count, item: number(item)? })
        }
        [kind, name] => (name, Kind::Number(number(kind)?)),
        _ => return Err(FormatError::line(line, "a property has a type and a name")),
    };
    Ok(Property { name: name.into(), kind })
}
