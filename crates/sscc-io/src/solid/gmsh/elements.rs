//! Parser for the section `$Elements`.

use super::groups::Groups;
use super::nodes::Nodes;
use super::numbers::Numbers;
use super::version::Version;
use crate::FormatError;
use crate::solid::builder::{Builder, repeated};

const LAST_ELEMENT: &str = "the last element";

/// Kind of an element.
#[derive(Clone, Copy)]
enum Kind {
    Tet,
    /// A tetrahedron of second order.
    Tet10,
    Cube,
    Triangle,
    /// A triangle of second order.
    Triangle6,
    Quadrilateral,
    /// Not part of the volume; has this number of nodes.
    Skipped(u64),
    /// A face of higher order, with its number in gmsh and its number of nodes.
    HigherFace(i64, u64),
}

/// Returns the kind of an element by its number in gmsh; None for unsupported solid elements.
fn kind(number: i64) -> Option<Kind> {
    Some(match number {
        4 => Kind::Tet,
        11 => Kind::Tet10,
        5 => Kind::Cube,
        2 => Kind::Triangle,
        9 => Kind::Triangle6,
        3 => Kind::Quadrilateral,
        // Points, lines, and faces of higher order.
        15 => Kind::Skipped(1),
        1 => Kind::Skipped(2),
        8 => Kind::Skipped(3),
        26 => Kind::Skipped(4),
        27 => Kind::Skipped(5),
        28 => Kind::Skipped(6),
        16 => Kind::HigherFace(number, 8),
        10 | 20 => Kind::HigherFace(number, 9),
        21 => Kind::HigherFace(number, 10),
        _ => return None,
    })
}

/// Reads the elements into the builder.
pub(super) fn read(
    numbers: &mut Numbers,
    version: Version,
    nodes: &Nodes,
    groups: &Groups,
    builder: &mut Builder,
) -> Result<(), FormatError> {
    let mut reader = Reader { numbers, version, nodes, builder };
    match version {
        Version::V2 => {
            let count = reader.numbers.words.count("the number of elements")? as u64;
            reader.numbers.words.rest_of_line();
            let mut done = 0;
            while done < count {
                done += reader.block_2(count - done, groups)?;
            }
            Ok(())
        }
        Version::V4 => reader.blocks_4(groups),
    }
}

struct Reader<'r, 'a> {
    numbers: &'r mut Numbers<'a>,
    version: Version,
    nodes: &'r Nodes,
    builder: &'r mut Builder,
}

impl Reader<'_, '_> {
    /// Reads elements of version 2 that share a header, at most `left`; returns their number. In text files each element
    /// has its own header.
    fn block_2(&mut self, left: u64, groups: &Groups) -> Result<u64, FormatError> {
        if !self.numbers.words.binary {
            self.numbers.integer(LAST_ELEMENT)?; // the element's own number
        }
        let kind = self.kind()?;
        let count = if self.numbers.words.binary { self.numbers.tag(LAST_ELEMENT)? } else { 1 };
        let tags = self.numbers.tag(LAST_ELEMENT)?;
        if count == 0 {
            return self.numbers.refused("a block has 0 elements: it must have at least one");
        }
        if count > left {
            return self
                .numbers
                .refused(format!("a block has {count} elements, but only {left} of the section remain"));
        }
        for _ in 0..count {
            if self.numbers.words.binary {
                self.numbers.integer(LAST_ELEMENT)?;
            }
            let group = if tags > 0 { self.numbers.integer(LAST_ELEMENT)?.unsigned_abs() } else { 0 };
            self.numbers.skip_integers(tags.saturating_sub(1), LAST_ELEMENT)?;
            self.element(kind, |builder| groups.material(group, builder))?;
        }
        Ok(count)
    }

    fn blocks_4(&mut self, groups: &Groups) -> Result<(), FormatError> {
        let blocks = self.numbers.size("the number of blocks")?;
        let declared = self.numbers.size("the number of elements")?;
        self.numbers.size("the smallest tag")?;
        self.numbers.size("the largest tag")?;
        let mut found = 0_u64;
        for _ in 0..blocks {
            self.numbers.integer(LAST_ELEMENT)?; // the dimension, which the kind implies
            let entity = self.numbers.integer(LAST_ELEMENT)?;
            let kind = self.kind()?;
            let count = self.numbers.size("the number of elements in a block")?;
            for _ in 0..count {
                self.numbers.size(LAST_ELEMENT)?; // its tag
                self.element(kind, |builder| groups.material_of_volume(entity, builder))?;
            }
            found = found.saturating_add(count);
        }
        if found != declared {
            return self
                .numbers
                .refused(format!("the section has {found} elements, but declares {declared}"));
        }
        Ok(())
    }

    fn kind(&mut self) -> Result<Kind, FormatError> {
        let number = self.numbers.integer(LAST_ELEMENT)?;
        match kind(number) {
            Some(kind) => Ok(kind),
            None => self.numbers.refused(format!(
                "element type {number} is not supported: solid elements must be tetrahedra of 4 or 10 nodes \
                 (4, 11) or 8-node hexahedra (5)"
            )),
        }
    }

    fn element(&mut self, kind: Kind, material: impl Fn(&mut Builder) -> u32) -> Result<(), FormatError> {
        match kind {
            Kind::Tet => {
                let (corners, material) = (self.corners()?, material(self.builder));
                self.builder.tet(corners, material, self.numbers.place())
            }
            Kind::Tet10 => {
                let (nodes, material) = (self.corners()?, material(self.builder));
                self.builder.tet10(nodes, material, self.numbers.place())
            }
            Kind::Cube => {
                let (corners, material) = (self.corners()?, material(self.builder));
                self.builder.cube(corners, material, self.numbers.place())
            }
            Kind::Triangle => {
                let corners = self.corners::<3>()?;
                self.builder.face(corners, self.numbers.place())
            }
            Kind::Triangle6 => {
                let nodes = self.corners::<6>()?;
                self.builder.face_of_second_order(nodes, self.numbers.place())
            }
            Kind::Quadrilateral => {
                let corners = self.corners::<4>()?;
                self.builder.face(corners, self.numbers.place())
            }
            Kind::HigherFace(number, nodes) => {
                self.builder.unread_faces(&format!("element type {number}"), self.numbers.place());
                (0..nodes).try_for_each(|_| self.node().map(drop))
            }
            Kind::Skipped(nodes) => (0..nodes).try_for_each(|_| self.node().map(drop)),
        }
    }

    fn node(&mut self) -> Result<u64, FormatError> {
        match self.version {
            Version::V2 => self.numbers.tag(LAST_ELEMENT),
            Version::V4 => self.numbers.size(LAST_ELEMENT),
        }
    }

    /// Returns the vertices of an element's nodes.
    fn corners<const N: usize>(&mut self) -> Result<[u64; N], FormatError> {
        let mut corners = [0; N];
        for corner in &mut corners {
            *corner = self.node()?;
        }
        if let Some(twice) = repeated(&corners) {
            return self.numbers.refused(format!("the element names node {twice} twice"));
        }
        for corner in &mut corners {
            *corner = match self.nodes.vertex(*corner) {
                Some(vertex) => vertex,
                None => {
                    return self
                        .numbers
                        .refused(format!("the element names node {corner}, which does not exist"));
                }
            };
        }
        Ok(corners)
    }
}
