//! Parser for legacy `.vtk` files of unstructured grids and of polygons, versions 1 to 5.1, text and binary.

use glam::DVec3;

use super::super::words::Words;
use super::cells::Cells;
use super::displacement::Displacement;
use super::grid::Grid;
use super::legacy_numbers::{Kind, Numbers};
use crate::FormatError;
use crate::error::quoted;

/// Types of cells of the lists of a PolyData.
const LISTS: [(&str, u64); 4] = [("VERTICES", 2), ("LINES", 4), ("POLYGONS", 7), ("TRIANGLE_STRIPS", 6)];

/// The objects to which attributes belong.
#[derive(Clone, Copy, PartialEq)]
enum Section {
    /// The whole grid.
    Grid,
    Points,
    Cells,
}

struct Parser<'a, 'd> {
    numbers: Numbers<'a>,
    displacement: &'d Displacement,
    points: Option<Vec<DVec3>>,
    cells: Cells,
    /// Keywords of the points and lists read so far.
    parts: Vec<String>,
    /// Whether the types of an unstructured grid have been read.
    has_types: bool,
    section: (Section, u64),
    /// Names of all vectors of the points, and their values.
    vectors: Vec<(String, Vec<DVec3>)>,
}

/// Parses a file.
pub(super) fn parse(bytes: &[u8], displacement: &Displacement) -> Result<Grid, FormatError> {
    let mut words = Words::new(bytes, false)?;
    words.rest_of_line(); // the version, which the lists of cells also show
    words.rest_of_line(); // the title
    let form = words.word("ASCII or BINARY")?;
    words.binary = match form {
        "ASCII" => false,
        "BINARY" => true,
        _ => return words.refused(format!("ASCII or BINARY was expected, not {}", quoted(form))),
    };
    let mut parser = Parser {
        numbers: Numbers { words },
        displacement,
        points: None,
        cells: Cells::default(),
        parts: Vec::new(),
        has_types: false,
        section: (Section::Grid, 1),
        vectors: Vec::new(),
    };
    let is_grid = parser.dataset()?;
    parser.sections(is_grid)?;
    parser.finish(is_grid)
}

impl Parser<'_, '_> {
    /// Reads the kind of the data set; returns whether it is an unstructured grid, not polygons.
    fn dataset(&mut self) -> Result<bool, FormatError> {
        let words = &mut self.numbers.words;
        let keyword = words.word("DATASET")?;
        if keyword != "DATASET" {
            return words.refused(format!("DATASET was expected, not {}", quoted(keyword)));
        }
        match words.word("the kind of the data set")? {
            "UNSTRUCTURED_GRID" => Ok(true),
            "POLYDATA" => Ok(false),
            other => words.refused(format!(
                "a data set of kind {}: save it as UNSTRUCTURED_GRID or POLYDATA",
                quoted(other)
            )),
        }
    }

    fn sections(&mut self, is_grid: bool) -> Result<(), FormatError> {
        while let Some(keyword) = self.numbers.words.next_word()? {
            let keyword = keyword.to_ascii_uppercase();
            if let (false, Some((_, kind))) = (is_grid, LISTS.iter().find(|(name, _)| *name == keyword)) {
                self.first_of(&keyword)?;
                self.list(&keyword, Some(*kind))?;
                continue;
            }
            match keyword.as_str() {
                "POINTS" => self.points()?,
                "CELLS" if is_grid => {
                    self.first_of(&keyword)?;
                    self.list(&keyword, None)?;
                }
                "CELL_TYPES" if is_grid => self.types()?,
                "POINT_DATA" => self.section = (Section::Points, self.size("the number of points")?),
                "CELL_DATA" => self.section = (Section::Cells, self.size("the number of cells")?),
                _ => self.attribute(&keyword)?,
            }
        }
        Ok(())
    }

    /// Refuses a second part of this name: which of the two holds is unknown.
    fn first_of(&mut self, keyword: &str) -> Result<(), FormatError> {
        if self.parts.iter().any(|part| part == keyword) {
            let cause = format!("there is a second {keyword}: save each grid as a file");
            return self.numbers.words.refused(cause);
        }
        self.parts.push(keyword.to_owned());
        Ok(())
    }

    fn size(&mut self, what: &str) -> Result<u64, FormatError> {
        Ok(self.numbers.words.count(what)? as u64)
    }

    fn points(&mut self) -> Result<(), FormatError> {
        self.first_of("POINTS")?;
        let count = self.size("the number of points")?;
        let kind = self.numbers.kind()?;
        let coordinates = self.numbers.floats(count.saturating_mul(3), kind, "a coordinate")?;
        self.points = Some(vectors(&coordinates));
        Ok(())
    }

    /// Reads a list of cells, all of one type or of types that follow.
    fn list(&mut self, keyword: &str, kind: Option<u64>) -> Result<(), FormatError> {
        let (count, size) = (self.size("the number of cells")?, self.size("the size of the cells")?);
        let is_new = self.numbers.words.peek().ok().flatten() == Some("OFFSETS");
        let before = self.cells.ends.len();
        match is_new {
            true => self.offsets_and_connectivity(count, size)?,
            false => self.counted_cells(keyword, count, size)?,
        }
        if let Some(kind) = kind {
            self.cells.types.extend((before..self.cells.ends.len()).map(|_| kind));
        }
        Ok(())
    }

    /// Reads the list of version 5.1: offsets from 0 to the end of the last cell, and all corners.
    fn offsets_and_connectivity(&mut self, count: u64, size: u64) -> Result<(), FormatError> {
        self.numbers.words.word("OFFSETS")?;
        let kind = self.numbers.kind()?;
        let offsets = self.numbers.integers(count, kind, "an offset")?;
        if let Some(first) = offsets.first().filter(|first| **first != 0) {
            let cause = format!(
                "the first offset is {first}, but offsets begin with 0: correct it, or save the grid again"
            );
            return self.numbers.words.refused(cause);
        }
        let end = offsets.last().copied().unwrap_or_default();
        if end != size {
            let cause = format!(
                "the last offset is {end}, but the list has {size} corners: correct its counts, or save the grid again"
            );
            return self.numbers.words.refused(cause);
        }
        let keyword = self.numbers.words.word("CONNECTIVITY")?;
        if keyword != "CONNECTIVITY" {
            return self.numbers.words.refused(format!("CONNECTIVITY was expected, not {}", quoted(keyword)));
        }
        let kind = self.numbers.kind()?;
        let connectivity = self.numbers.integers(size, kind, "a corner")?;
        let start = self.cells.connectivity.len() as u64;
        self.cells.ends.extend(offsets.iter().skip(1).map(|end| end.saturating_add(start)));
        self.cells.connectivity.extend(connectivity);
        Ok(())
    }

    /// Reads the list of earlier versions: for each cell its number of corners, and the corners.
    fn counted_cells(&mut self, keyword: &str, count: u64, size: u64) -> Result<(), FormatError> {
        let numbers = self.numbers.ints(size, "a corner")?;
        let mut rest = &numbers[..];
        for cell in 0..count {
            let corners = rest.split_first().and_then(|(corners, after)| {
                usize::try_from(*corners).ok().and_then(|corners| after.split_at_checked(corners))
            });
            let Some((corners, after)) = corners else {
                let cause = format!("cell {cell} (counted from 0) leaves the {size} numbers of the cells");
                return self.numbers.words.refused(cause);
            };
            self.cells.connectivity.extend(corners);
            self.cells.ends.push(self.cells.connectivity.len() as u64);
            rest = after;
        }
        if !rest.is_empty() {
            let used = numbers.len() - rest.len();
            let cause = format!(
                "{keyword} has {size} numbers, but its {count} cells take {used} of them: correct its counts, or save the \
                 grid again"
            );
            return self.numbers.words.refused(cause);
        }
        Ok(())
    }

    fn types(&mut self) -> Result<(), FormatError> {
        self.first_of("CELL_TYPES")?;
        let count = self.size("the number of types")?;
        self.cells.types = self.numbers.ints(count, "the type of a cell")?;
        self.has_types = true;
        Ok(())
    }

    /// Reads an attribute of points, cells or the grid.
    fn attribute(&mut self, keyword: &str) -> Result<(), FormatError> {
        if keyword == "METADATA" {
            // The metadata end with an empty line.
            self.numbers.words.rest_of_line();
            while !self.numbers.words.rest_of_line().trim_ascii().is_empty() {}
            return Ok(());
        }
        let components = match keyword {
            "SCALARS"
            | "COLOR_SCALARS"
            | "TEXTURE_COORDINATES"
            | "LOOKUP_TABLE"
            | "FIELD"
            | "GLOBAL_IDS"
            | "PEDIGREE_IDS" => 1,
            "VECTORS" | "NORMALS" => 3,
            "TENSORS6" => 6,
            "TENSORS" => 9,
            _ => {
                let cause = format!("{} is no known part of a grid", quoted(keyword));
                return self.numbers.words.refused(cause);
            }
        };
        let name = self.numbers.words.word("the name of an attribute")?.to_owned();
        let count = self.section.1;
        match keyword {
            "FIELD" => self.field(),
            "LOOKUP_TABLE" => {
                let size = self.size("the size of a table")?;
                self.numbers.skip_bytes(size.saturating_mul(4), "a colour")
            }
            "COLOR_SCALARS" => {
                let components = self.size("the number of components")?;
                self.numbers.skip_bytes(count.saturating_mul(components), "a colour")
            }
            "TEXTURE_COORDINATES" => {
                let components = self.size("the number of components")?;
                let kind = self.numbers.kind()?;
                self.skip(&name, components, count, kind)
            }
            _ => {
                let kind = self.numbers.kind()?;
                match keyword {
                    "VECTORS" => self.array(name, components, count, kind),
                    "SCALARS" => {
                        let components = self.components_of_scalars()?;
                        self.skip(&name, components, count, kind)
                    }
                    _ => self.skip(&name, components, count, kind),
                }
            }
        }
    }

    fn skip(&mut self, name: &str, components: u64, count: u64, kind: Kind) -> Result<(), FormatError> {
        self.numbers.skip(count.saturating_mul(components), kind, &what(name))
    }

    /// Reads the number of components of scalars, which may be left out, and the name of their table.
    fn components_of_scalars(&mut self) -> Result<u64, FormatError> {
        let is_count = self.numbers.words.peek()?.is_some_and(|word| word != "LOOKUP_TABLE");
        let components = if is_count { self.size("the number of components")? } else { 1 };
        let keyword = self.numbers.words.word("LOOKUP_TABLE")?;
        if keyword != "LOOKUP_TABLE" {
            return self.numbers.words.refused(format!("LOOKUP_TABLE was expected, not {}", quoted(keyword)));
        }
        self.numbers.words.word("the name of a table").map(|_| components)
    }

    fn field(&mut self) -> Result<(), FormatError> {
        for _ in 0..self.size("the number of arrays")? {
            let mut name = self.numbers.words.word("the name of an array")?.to_owned();
            while name.eq_ignore_ascii_case("METADATA") {
                self.attribute("METADATA")?;
                name = self.numbers.words.word("the name of an array")?.to_owned();
            }
            let (components, count) =
                (self.size("the number of components")?, self.size("the number of rows")?);
            let kind = self.numbers.kind()?;
            self.array(name, components, count, kind)?;
        }
        Ok(())
    }

    /// Reads vectors or the array of a field, where they are used, and skips the others.
    fn array(&mut self, name: String, components: u64, count: u64, kind: Kind) -> Result<(), FormatError> {
        if self.section.0 != Section::Points || components != 3 || *self.displacement == Displacement::None {
            return self.skip(&name, components, count, kind);
        }
        let found = (name.as_str(), 3);
        // Only vectors that can be chosen are kept, because there may be many.
        let is_wanted = match self.displacement {
            Displacement::Named(wanted) => *wanted == name,
            displacement => displacement.choose([found].into_iter())?.is_some(),
        };
        let values = if is_wanted {
            vectors(&self.numbers.floats(count.saturating_mul(components), kind, &what(&name))?)
        } else {
            self.skip(&name, components, count, kind)?;
            Vec::new()
        };
        self.vectors.push((name, values));
        Ok(())
    }

    fn finish(mut self, is_grid: bool) -> Result<Grid, FormatError> {
        let Some(points) = self.points.take() else {
            return Err(FormatError::whole("the file has no POINTS"));
        };
        if is_grid && !self.has_types || self.cells.types.len() != self.cells.ends.len() {
            let (types, cells) = (self.cells.types.len(), self.cells.ends.len());
            return Err(FormatError::whole(format!("the file has {cells} cells and {types} types of cells")));
        }
        let names = self.vectors.iter().map(|(name, _)| (name.as_str(), 3));
        let is_unclear = self.displacement.is_unclear(names.clone());
        let chosen = self.displacement.choose(names)?;
        let displacement = chosen.map(|chosen| self.vectors.swap_remove(chosen));
        if let Some((name, vectors)) =
            displacement.as_ref().filter(|(_, vectors)| vectors.len() != points.len())
        {
            let cause = format!("{} has {} vectors for {} points", quoted(name), vectors.len(), points.len());
            return Err(FormatError::whole(cause));
        }
        Ok(Grid { points, cells: self.cells, displacement, is_unclear })
    }
}

/// Names an item of an array in messages.
fn what(name: &str) -> String {
    format!("an item of {}", quoted(name))
}

fn vectors(numbers: &[f64]) -> Vec<DVec3> {
    numbers.as_chunks().0.iter().map(|vector| DVec3::from_array(*vector)).collect()
}
