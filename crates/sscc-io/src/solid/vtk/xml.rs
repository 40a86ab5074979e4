//! The structure of a `.vtu` file: an XML head, and perhaps appended data, which is no XML.

use glam::DVec3;
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

use super::cells::Cells;
use super::data::Layout;
use super::displacement::Displacement;
use super::grid::Grid;
use super::xml_arrays::{Array, Data, Decoder};
use crate::FormatError;
use crate::allowance::Allowance;
use crate::error::{cut, quoted};

/// Beginning of the data that is no XML.
const APPENDED: &[u8] = b"<AppendedData";

/// Advice if a file has another structure.
const SAVE: &str =
    "save it as an unstructured grid (.vtu) of one piece, as ParaView's filter Merge Blocks does";

/// Maximum depth of nested elements, which bounds memory; real files have about six.
const MAX_DEPTH: usize = 64;

/// An element with its attributes. An array also has its text, without that of its children.
pub(crate) struct Element<'a> {
    pub name: String,
    /// Number of the element around it.
    parent: Option<usize>,
    attributes: Vec<(String, String)>,
    text: &'a str,
    line: usize,
}

impl<'a> Element<'a> {
    /// Returns an attribute.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    pub fn refused(&self, cause: impl Into<String>) -> FormatError {
        FormatError::line(self.line, cause.into())
    }

    fn count(&self, name: &str) -> Result<u64, FormatError> {
        let Some(text) = self.get(name) else {
            return Err(self.refused(format!("{} has no {name}", quoted(&self.name))));
        };
        let number = text.trim().parse();
        number.map_err(|_| self.refused(format!("{name} is {}: a count was expected", quoted(text))))
    }

    fn array(&self) -> Result<Array<'a>, FormatError> {
        let components = match self.get("NumberOfComponents") {
            Some(_) => self.count("NumberOfComponents")?,
            None => 1,
        };
        let data = match self.get("format").unwrap_or("ascii") {
            "ascii" => Data::Ascii(self.text),
            "binary" => Data::Base64(self.text),
            "appended" => Data::Appended(self.count("offset")?),
            other => Data::Unknown(other.to_owned()),
        };
        let text = |name: &str| self.get(name).unwrap_or_default().to_owned();
        let components = usize::try_from(components).unwrap_or(usize::MAX);
        Ok(Array::new(text("Name"), text("type"), components, data))
    }
}

/// Returns the elements of an XML text in the order of their beginnings. `is_head`: whether the text ends early, before data that
/// is no XML.
pub(crate) fn elements(text: &str, is_head: bool) -> Result<Vec<Element<'_>>, FormatError> {
    let mut reader = Reader::from_str(text);
    let (mut found, mut open): (Vec<Element<'_>>, Vec<usize>) = (Vec::new(), Vec::new());
    let mut lines = LineCounter { text: text.as_bytes(), at: 0, line: 1 };
    loop {
        let line = lines.line_of(reader.buffer_position());
        let event = reader
            .read_event()
            .map_err(|error| malformed(lines.line_of(reader.error_position()), &error.to_string()))?;
        match event {
            Event::Start(start) => {
                let element = element(&start, open.last(), line)?;
                if open.len() == MAX_DEPTH {
                    return Err(
                        element.refused(format!("elements are nested more than {MAX_DEPTH} levels deep"))
                    );
                }
                open.push(found.len());
                found.push(element);
            }
            Event::Empty(start) => found.push(element(&start, open.last(), line)?),
            Event::End(_) => drop(open.pop()),
            Event::Text(part) if is_in_array(&found, &open) && !part.trim_ascii().is_empty() => {
                let start = usize::try_from(reader.buffer_position()).unwrap_or(usize::MAX);
                // Text is borrowed from the file, so its end is the position of the reader.
                let part = text.get(start - part.len()..start).unwrap_or_default();
                if let Some(parent) = open.last().map(|number| &mut found[*number]) {
                    if !parent.text.is_empty() {
                        return Err(FormatError::line(line, "the text of an array is in several parts"));
                    }
                    parent.text = part;
                }
            }
            Event::GeneralRef(_) if is_in_array(&found, &open) => {
                return Err(FormatError::line(line, "character references are not supported in arrays"));
            }
            Event::CData(_) if is_in_array(&found, &open) => {
                return Err(FormatError::line(line, "CDATA sections are not supported in arrays"));
            }
            Event::Eof => match open.last().filter(|_| !is_head) {
                None => return Ok(found),
                Some(last) => {
                    let cause =
                        format!("the file ends within {}: is it cut off?", quoted(&found[*last].name));
                    return Err(found[*last].refused(cause));
                }
            },
            _ => {}
        }
    }
}

/// Whether text belongs to an array, of which no part may be dropped.
fn is_in_array(found: &[Element<'_>], open: &[usize]) -> bool {
    open.last().is_some_and(|number| found[*number].name == "DataArray")
}

/// Returns the error of a line. The cause may name words of the file.
fn malformed(line: usize, cause: &str) -> FormatError {
    FormatError::line(line, format!("malformed XML: {}", cut(cause, 120)))
}

fn element<'a>(
    start: &BytesStart<'_>,
    parent: Option<&usize>,
    line: usize,
) -> Result<Element<'a>, FormatError> {
    let refused = |cause: String| malformed(line, &cause);
    let mut attributes: Vec<(String, String)> = Vec::new();
    // The checks of `quick-xml` name neither the element nor the attribute, as `repeated_name` does.
    for attribute in start.attributes().with_checks(false) {
        let attribute = attribute.map_err(|error| refused(error.to_string()))?;
        let value = attribute
            .normalized_value(XmlVersion::Implicit1_0)
            .map_err(|error| refused(error.to_string()))?;
        attributes.push((attribute.key.as_ref().to_owned(), value.into_owned()));
    }
    let name = start.name().as_ref().to_owned();
    if let Some(twice) = repeated_name(&attributes) {
        let cause = format!(
            "{} has two attributes {}: remove one of them, or save the file again",
            quoted(&name),
            quoted(twice)
        );
        return Err(FormatError::line(line, cause));
    }
    Ok(Element { name, parent: parent.copied(), attributes, text: "", line })
}

/// Returns a name that two attributes have. Sorts them, because a hostile element may have any number of attributes.
fn repeated_name(attributes: &[(String, String)]) -> Option<&str> {
    let mut names: Vec<&str> = attributes.iter().map(|(name, _)| name.as_str()).collect();
    names.sort_unstable();
    names.windows(2).find(|two| two[0] == two[1]).map(|two| two[0])
}

/// Counts the lines of a text once, while a reader advances.
struct LineCounter<'a> {
    text: &'a [u8],
    at: usize,
    line: usize,
}

impl LineCounter<'_> {
    fn line_of(&mut self, position: u64) -> usize {
        let end = usize::try_from(position).unwrap_or(usize::MAX).clamp(self.at, self.text.len());
        self.line += self.text[self.at..end].iter().filter(|byte| **byte == b'\n').count();
        self.at = end;
        self.line
    }
}

/// Parses a file.
pub(super) fn parse(bytes: &[u8], displacement: &Displacement) -> Result<Grid, FormatError> {
    let split = bytes.windows(APPENDED.len()).position(|window| window == APPENDED);
    let (head, tail) = bytes.split_at(split.unwrap_or(bytes.len()));
    let Ok(head) = std::str::from_utf8(head) else {
        return Err(FormatError::whole(
            "neither XML in UTF-8 nor a file that begins with '# vtk DataFile Version'",
        ));
    };
    let head = head.strip_prefix('\u{feff}').unwrap_or(head);
    let elements = elements(head, split.is_some())?;
    let decoder = decoder(&elements, tail, bytes.len() as u64)?;
    read_grid(&elements, decoder, displacement)
}

fn decoder<'a>(elements: &[Element<'_>], tail: &'a [u8], size: u64) -> Result<Decoder<'a>, FormatError> {
    let Some(root) = elements.first().filter(|root| root.name == "VTKFile") else {
        return Err(FormatError::whole(
            "the file is no VTK file: '<VTKFile' or '# vtk DataFile Version' was expected",
        ));
    };
    let kind = root.get("type").unwrap_or_default();
    if kind != "UnstructuredGrid" {
        return Err(root.refused(format!("the VTK file has the type {}: {SAVE}", quoted(kind))));
    }
    let is_compressed = match root.get("compressor") {
        None | Some("") => false,
        Some("vtkZLibDataCompressor") => true,
        Some(other) => {
            let cause = format!("compressed by {}: save it with zlib or uncompressed", quoted(other));
            return Err(root.refused(cause));
        }
    };
    let header = match root.get("header_type") {
        None | Some("UInt32") => 4,
        Some("UInt64") => 8,
        Some(other) => return Err(root.refused(format!("header_type {} is not known", quoted(other)))),
    };
    let is_big_endian = match root.get("byte_order") {
        None | Some("LittleEndian") => false,
        Some("BigEndian") => true,
        Some(other) => return Err(root.refused(format!("byte_order {} is not known", quoted(other)))),
    };
    let (is_base64, appended) = match tail.is_empty() {
        true => (false, None),
        false => appended(tail)?,
    };
    let offset = |element: &Element<'_>| element.get("offset")?.trim().parse().ok();
    Ok(Decoder {
        layout: Layout { header, is_big_endian, is_compressed },
        appended,
        is_base64,
        offsets: elements.iter().filter_map(offset).collect(),
        allowance: Allowance::new(size, u64::MAX),
    })
}

/// Returns whether appended data is base64, and the data after its `_`.
fn appended(tail: &[u8]) -> Result<(bool, Option<&[u8]>), FormatError> {
    let refused = |cause: &str| FormatError::part("AppendedData", cause);
    let begin =
        tail.iter().position(|byte| *byte == b'>').ok_or_else(|| refused("the file ends within it"))?;
    let is_base64 = match encoding(&tail[..=begin]).as_deref() {
        Some("raw") => false,
        Some("base64") => true,
        _ => return Err(refused("its encoding must be stated once, as 'raw' or as 'base64'")),
    };
    let data = tail[begin + 1..].trim_ascii_start();
    let Some(data) = data.strip_prefix(b"_") else { return Err(refused("its data must begin with '_'")) };
    // The end of raw data is not searched: it may contain any bytes.
    let end =
        if is_base64 { data.iter().position(|byte| *byte == b'<').unwrap_or(data.len()) } else { data.len() };
    Ok((is_base64, Some(&data[..end])))
}

/// Returns the encoding that the start of the appended data states.
fn encoding(start: &[u8]) -> Option<String> {
    let elements = elements(std::str::from_utf8(start).ok()?, true).ok()?;
    let element = elements.first().filter(|element| element.name == "AppendedData")?;
    element.get("encoding").map(str::to_owned)
}

fn read_grid(
    elements: &[Element<'_>],
    mut decoder: Decoder<'_>,
    displacement: &Displacement,
) -> Result<Grid, FormatError> {
    let mut pieces = elements.iter().filter(|element| element.name == "Piece");
    let Some(piece) = pieces.next() else { return Err(FormatError::whole("the file has no 'Piece'")) };
    if let Some(second) = pieces.next() {
        return Err(second.refused(format!("there is a second piece of the grid: {SAVE}")));
    }
    if let Some(step) = elements.iter().find(|element| element.get("TimeStep").is_some()) {
        let cause = "the file has several time steps: save each as a file, in a collection (.pvd)";
        return Err(step.refused(cause));
    }
    let (points, cells) = (piece.count("NumberOfPoints")?, piece.count("NumberOfCells")?);
    let within = |section: &'static str| {
        let is_in = move |parent: usize| elements[parent].name == section;
        elements
            .iter()
            .filter(move |element| element.name == "DataArray" && element.parent.is_some_and(is_in))
    };
    let positions = only_array(within("Points"), piece, "array in 'Points'")?;
    let positions = vectors(decoder.floats(&positions, points.saturating_mul(3))?);
    let cell_array = |name: &str| {
        let named = within("Cells").filter(|array| array.get("Name") == Some(name));
        only_array(named, piece, &format!("array {} in 'Cells'", quoted(name)))
    };
    let ends = decoder.integers(&cell_array("offsets")?, cells)?;
    let types = decoder.integers(&cell_array("types")?, cells)?;
    let connectivity = decoder.integers(&cell_array("connectivity")?, ends.last().copied().unwrap_or(0))?;
    let data = within("PointData").map(Element::array).collect::<Result<Vec<_>, _>>()?;
    let names = data.iter().map(|array| (array.name.as_str(), array.components));
    let is_unclear = displacement.is_unclear(names.clone());
    let chosen = displacement.choose(names)?;
    let displacement = match chosen.map(|chosen| &data[chosen]) {
        Some(array) => Some((array.name.clone(), vectors(decoder.floats(array, points.saturating_mul(3))?))),
        None => None,
    };
    Ok(Grid { points: positions, cells: Cells { types, ends, connectivity }, displacement, is_unclear })
}

/// Returns the only one of these arrays of a piece. Which of two the file means is unknown.
fn only_array<'e, 'a: 'e>(
    mut arrays: impl Iterator<Item = &'e Element<'a>>,
    piece: &Element<'_>,
    what: &str,
) -> Result<Array<'a>, FormatError> {
    let Some(first) = arrays.next() else {
        return Err(piece.refused(format!("the piece has no {what}")));
    };
    match arrays.next() {
        Some(second) => Err(second
            .refused(format!("there is a second {what}: remove one of the two, or save the grid again"))),
        None => first.array(),
    }
}

fn vectors(numbers: Vec<f64>) -> Vec<DVec3> {
    numbers.as_chunks().0.iter().map(|vector| DVec3::from_array(*vector)).collect()
}
