//! Parser for the sections; lines may come from several files.

use std::collections::BTreeSet;

use sscc_solid::{NamedMaterial, VolumeMesh};

use super::count::{DeclaredCount, declared_count, numbered};
use super::material::parse_material;
use super::regions::{Regions, compact};
use crate::error::quoted;
use crate::solid::builder::Builder;
use crate::solid::statements::{corners, fields, index, position};
use crate::{FormatError, Place};

/// Expected content of the next line.
#[derive(Default, PartialEq)]
enum ExpectedLine {
    #[default]
    Section,
    VertexCount,
    Vertices,
    Kind,
    ElementCount,
    Elements,
    Material(String),
    Set,
    Region,
}

/// Content read so far.
pub(super) struct Parser {
    expected: ExpectedLine,
    builder: Builder,
    vertices: Option<DeclaredCount>,
    elements: Option<DeclaredCount>,
    /// Corners of an element: 4 or 8.
    corners: u64,
    /// Number of the first element.
    first_element: u64,
    materials: Vec<NamedMaterial>,
    /// Names of the materials.
    names: BTreeSet<String>,
    regions: Regions,
}

impl Default for Parser {
    fn default() -> Self {
        Self {
            expected: ExpectedLine::default(),
            builder: Builder::new(1),
            vertices: None,
            elements: None,
            corners: 0,
            first_element: 1,
            materials: Vec::new(),
            names: BTreeSet::new(),
            regions: Regions::default(),
        }
    }
}

impl Parser {
    /// Parses a line without comments that is not blank.
    pub fn statement(&mut self, text: &str, place: &Place) -> Result<(), FormatError> {
        let result = match text.strip_prefix('*') {
            Some(section) => self.leave().and_then(|()| self.enter(section)),
            None => self.line(text, place),
        };
        result.map_err(|cause| FormatError::new(place.clone(), cause))
    }

    /// Returns the mesh at the end of the file.
    pub fn finish(mut self) -> Result<VolumeMesh, FormatError> {
        self.leave().map_err(FormatError::whole)?;
        let declared_counts = [
            (&self.vertices, self.builder.vertices(), "vertices"),
            (&self.elements, self.builder.elements(), "elements"),
        ];
        for (declared_count, found, what) in declared_counts {
            match declared_count {
                None => return Err(FormatError::whole(format!("the file has no section of {what}"))),
                Some(DeclaredCount { count, place }) if found as u64 != *count => {
                    let cause = format!("the file has {found} of the {count} {what} declared here");
                    return Err(FormatError::new(place.clone(), cause));
                }
                Some(_) => {}
            }
        }
        let mesh = self.builder.finish()?;
        if self.materials.is_empty() {
            self.regions.materials(0, &[])?; // an error if there is a region
            return Ok(mesh);
        }
        let of_element = self.regions.materials(mesh.element_count(), &self.materials)?;
        Ok(mesh.with_materials(self.materials, of_element)?)
    }

    /// Ends the current section.
    fn leave(&mut self) -> Result<(), String> {
        let missing = match std::mem::take(&mut self.expected) {
            ExpectedLine::VertexCount => "the number of vertices is missing in *VERTICES",
            ExpectedLine::Kind => "TET or CUBIC is missing in *ELEMENTS",
            ExpectedLine::ElementCount => "the number of elements is missing in *ELEMENTS",
            ExpectedLine::Material(_) => "the values are missing in *MATERIAL",
            ExpectedLine::Region => "'set, material' is missing in *REGION",
            _ => return Ok(()),
        };
        Err(missing.into())
    }

    fn enter(&mut self, section: &str) -> Result<(), String> {
        let keyword = section.split(|c: char| c == ',' || c.is_ascii_whitespace()).next().unwrap_or_default();
        let name = || compact(&section[keyword.len()..]);
        self.expected = match keyword {
            "VERTICES" if self.vertices.is_some() => return Err("the section *VERTICES is repeated".into()),
            "VERTICES" => ExpectedLine::VertexCount,
            "ELEMENTS" if self.elements.is_some() => {
                return Err("the section *ELEMENTS is repeated: a file has one kind of elements".into());
            }
            "ELEMENTS" if self.vertices.is_none() => return Err("*ELEMENTS comes before *VERTICES".into()),
            "ELEMENTS" => ExpectedLine::Kind,
            "MATERIAL" if !self.names.insert(name()) => {
                return Err(format!("the material {} is repeated", quoted(&name())));
            }
            "MATERIAL" => ExpectedLine::Material(name()),
            "SET" if self.elements.is_none() => return Err("*SET comes before *ELEMENTS".into()),
            "SET" => {
                self.regions.begin_set(name())?;
                ExpectedLine::Set
            }
            "REGION" => ExpectedLine::Region,
            _ => return Err(format!("the section {} is not known", quoted(&format!("*{section}")))),
        };
        Ok(())
    }

    fn line(&mut self, text: &str, place: &Place) -> Result<(), String> {
        match &self.expected {
            ExpectedLine::Section => {
                return Err(format!("a section (*VERTICES, ...) was expected, not {}", quoted(text)));
            }
            ExpectedLine::VertexCount => {
                self.vertices = Some(declared_count(text, 3, "coordinates", place)?);
                self.expected = ExpectedLine::Vertices;
            }
            ExpectedLine::Vertices => self.vertex(text, place)?,
            ExpectedLine::Kind => {
                self.corners = match text {
                    "TET" => 4,
                    "CUBIC" => 8,
                    other => {
                        return Err(format!(
                            "elements of kind {} are not supported: only TET and CUBIC are",
                            quoted(other)
                        ));
                    }
                };
                self.expected = ExpectedLine::ElementCount;
            }
            ExpectedLine::ElementCount => {
                self.elements = Some(declared_count(text, self.corners, "corners", place)?);
                self.expected = ExpectedLine::Elements;
            }
            ExpectedLine::Elements => self.element(text, place)?,
            ExpectedLine::Material(name) => {
                self.materials.push(parse_material(name.clone(), text)?);
                self.expected = ExpectedLine::Section;
            }
            ExpectedLine::Set => {
                for field in fields(text) {
                    let number = index(field)?;
                    let element = number.checked_sub(self.first_element);
                    match element.filter(|e| *e < self.builder.elements() as u64) {
                        Some(element) => self.regions.add(element as u32),
                        None => return Err(format!("there is no element {number}")),
                    }
                }
            }
            ExpectedLine::Region => {
                self.regions.push(text, place)?;
                self.expected = ExpectedLine::Section;
            }
        }
        Ok(())
    }

    fn vertex(&mut self, text: &str, place: &Place) -> Result<(), String> {
        let done = self.builder.vertices() as u64;
        let mut fields = fields(text);
        let first = numbered(fields.next(), done, self.builder.first, &self.vertices, "vertices")?;
        self.builder.first = first;
        let position = position(&mut fields)?;
        self.builder.vertex(position, place.clone()).map_err(|error| error.cause().to_string())
    }

    fn element(&mut self, text: &str, place: &Place) -> Result<(), String> {
        let done = self.builder.elements() as u64;
        let mut fields = fields(text);
        self.first_element = numbered(fields.next(), done, self.first_element, &self.elements, "elements")?;
        let first = self.builder.first;
        let from_0 = |corner: u64| {
            corner
                .checked_sub(first)
                .ok_or("the element names vertex 0, but vertices are counted from 1".to_owned())
        };
        let material = self.builder.default_material();
        let added = if self.corners == 4 {
            let mut corners = corners::<4>(&mut fields)?;
            for corner in &mut corners {
                *corner = from_0(*corner)?;
            }
            self.builder.tet(corners, material, place.clone())
        } else {
            let mut corners = corners::<8>(&mut fields)?;
            for corner in &mut corners {
                *corner = from_0(*corner)?;
            }
            self.builder.cube(corners, material, place.clone())
        };
        added.map_err(|error| error.cause().to_string())
    }
}
