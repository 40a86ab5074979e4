//! Parser for the sections; lines may come from several files.

use std::collections::BTreeSet;

use sscc_solid::{NamedMaterial, VolumeMesh};

use super::count::{Promise, numbered, promise};
use super::material::parse_material;
use super::regions::{Regions, compact};
use crate::error::quoted;
use crate::solid::builder::Builder;
use crate::solid::statements::{corners, fields, index, position};
use crate::{FormatError, Place};

/// Expected content of the next line.
#[derive(Default, PartialEq)]
enum Expected {
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
    expected: Expected,
    builder: Builder,
    vertices: Option<Promise>,
    elements: Option<Promise>,
    /// Corners of an element: 4 or 8.
    corners: u64,
    /// Number of the first element.
    first_element: u64,
    materials: Vec<NamedMaterial>,
    /// Of the materials.
    names: BTreeSet<String>,
    regions: Regions,
}

impl Default for Parser {
    fn default() -> Self {
        Self {
            expected: Expected::default(),
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
        let promises = [
            (&self.vertices, self.builder.vertices(), "vertices"),
            (&self.elements, self.builder.elements(), "elements"),
        ];
        for (promise, found, what) in promises {
            match promise {
                None => return Err(FormatError::whole(format!("the file has no section of {what}"))),
                Some(Promise { count, place }) if found as u64 != *count => {
                    let cause = format!("the file has {found} of the {count} {what} promised here");
                    return Err(FormatError::new(place.clone(), cause));
                }
                Some(_) => {}
            }
        }
        let mesh = self.builder.finish()?;
        if self.materials.is_empty() {
            self.regions.materials(0, &[])?; // refuses any
            return Ok(mesh);
        }
        let of_element = self.regions.materials(mesh.element_count(), &self.materials)?;
        Ok(mesh.with_materials(self.materials, of_element)?)
    }

    /// Ends the current section.
    fn leave(&mut self) -> Result<(), String> {
        let missing = match std::mem::take(&mut self.expected) {
            Expected::VertexCount => "the number of vertices is missing in *VERTICES",
            Expected::Kind => "TET or CUBIC is missing in *ELEMENTS",
            Expected::ElementCount => "the number of elements is missing in *ELEMENTS",
            Expected::Material(_) => "the values are missing in *MATERIAL",
            Expected::Region => "'set, material' is missing in *REGION",
            _ => return Ok(()),
        };
        Err(missing.into())
    }

    fn enter(&mut self, section: &str) -> Result<(), String> {
        let keyword = section.split(|c: char| c == ',' || c.is_ascii_whitespace()).next().unwrap_or_default();
        let name = || compact(&section[keyword.len()..]);
        self.expected = match keyword {
            "VERTICES" if self.vertices.is_some() => return Err("a second section *VERTICES".into()),
            "VERTICES" => Expected::VertexCount,
            "ELEMENTS" if self.elements.is_some() => {
                return Err("a second section *ELEMENTS: a file has one kind of elements".into());
            }
            "ELEMENTS" if self.vertices.is_none() => return Err("*ELEMENTS before *VERTICES".into()),
            "ELEMENTS" => Expected::Kind,
            "MATERIAL" if !self.names.insert(name()) => {
                return Err(format!("a second material {}", quoted(&name())));
            }
            "MATERIAL" => Expected::Material(name()),
            "SET" if self.elements.is_none() => return Err("*SET before *ELEMENTS".into()),
            "SET" => {
                self.regions.begin_set(name())?;
                Expected::Set
            }
            "REGION" => Expected::Region,
            _ => return Err(format!("the section {} is not known", quoted(&format!("*{section}")))),
        };
        Ok(())
    }

    fn line(&mut self, text: &str, place: &Place) -> Result<(), String> {
        match &self.expected {
            Expected::Section => {
                return Err(format!("a section (*VERTICES, ...) was expected, not {}", quoted(text)));
            }
            Expected::VertexCount => {
                self.vertices = Some(promise(text, 3, "coordinates", place)?);
                self.expected = Expected::Vertices;
            }
            Expected::Vertices => self.vertex(text, place)?,
            Expected::Kind => {
                self.corners = match text {
                    "TET" => 4,
                    "CUBIC" => 8,
                    other => return Err(format!("elements of kind {}: TET or CUBIC", quoted(other))),
                };
                self.expected = Expected::ElementCount;
            }
            Expected::ElementCount => {
                self.elements = Some(promise(text, self.corners, "corners", place)?);
                self.expected = Expected::Elements;
            }
            Expected::Elements => self.element(text, place)?,
            Expected::Material(name) => {
                self.materials.push(parse_material(name.clone(), text)?);
                self.expected = Expected::Section;
            }
            Expected::Set => {
                for field in fields(text) {
                    let number = index(field)?;
                    let element = number.checked_sub(self.first_element);
                    match element.filter(|e| *e < self.builder.elements() as u64) {
                        Some(element) => self.regions.add(element as u32),
                        None => return Err(format!("there is no element {number}")),
                    }
                }
            }
            Expected::Region => {
                self.regions.push(text, place)?;
                self.expected = Expected::Section;
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
        self.builder.vertex(position, place.clone()).map_err(|error| error.cause().to_owned())
    }

    fn element(&mut self, text: &str, place: &Place) -> Result<(), String> {
        let done = self.builder.elements() as u64;
        let mut fields = fields(text);
        self.first_element = numbered(fields.next(), done, self.first_element, &self.elements, "elements")?;
        let first = self.builder.first;
        let from_0 = |corner: u64| {
            corner.checked_sub(first).ok_or("names vertex 0, but vertices are counted from 1".to_owned())
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
        added.map_err(|error| error.cause().to_owned())
    }
}
