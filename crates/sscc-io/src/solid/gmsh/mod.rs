//! Reader for gmsh's `.msh` files, versions 2.0 to 2.2 and 4.1, text and binary.
//!
//! The module has its own parser: the crate `mshio` panics on a count of 0, reads version 4.1 only, has no parametric
//! nodes and no names of groups, and gives no places of errors.
//!
//! A file is a sequence of sections `$Name` .. `$EndName`. The reader uses the format, the nodes, the elements, and the
//! physical groups of volumes, which give materials. It skips other sections.

mod elements;
mod groups;
mod nodes;
mod numbers;
#[cfg(test)]
mod tests;
mod version;

use sscc_solid::VolumeMesh;

use super::builder::Builder;
use super::volume_or_surface::VolumeOrSurface;
use super::words::Words;
use crate::FormatError;
use crate::error::quoted;
use groups::Groups;
use nodes::Nodes;
use numbers::Numbers;
use version::Version;

/// Parses a gmsh file: 4-node or 10-node tetrahedra, 8-node hexahedra, and a surface of triangles with 3 or 6 nodes and
/// 4-node quadrilaterals. Points, lines and other faces are skipped. Vertices keep the file's order, independent of their tags.
///
/// The material of an element is the first physical group of its volume, with the name of the group, else its number.
/// Elements without a group have the default material.
///
/// # Errors
/// When the version is not supported, binary numbers have another width, a section does not match its counts or has no
/// end, solid elements have another kind, or tags of nodes are repeated or unknown; else as
/// [`read_volume_mesh`](super::read_volume_mesh).
pub fn parse(bytes: &[u8]) -> Result<VolumeMesh, FormatError> {
    parse_any(bytes)?.into_volume().map(|(mesh, _)| mesh)
}

/// As [`parse`], but for a file without tetrahedra and hexahedra returns the surface of its faces.
///
/// # Errors
/// As [`parse`]; when such a file has faces of higher order other than triangles of 6 nodes.
pub fn parse_any(bytes: &[u8]) -> Result<VolumeOrSurface, FormatError> {
    let mut words = Words::new(bytes, false)?;
    let (version, mut numbers) = header(&mut words)?;
    let mut builder = Builder::new(0);
    let (mut nodes, mut groups) = (None, Groups::default());
    let mut elements = false;
    while let Some(section) = numbers.words.next_word()? {
        let place = numbers.words.place();
        let Some(name) = section.strip_prefix('$') else {
            let cause = format!("the name of a section was expected, not {}", quoted(section));
            return numbers.words.refused(cause);
        };
        let refused = |cause: String| Err(FormatError::new(place, cause));
        let second = || format!("the section {} is repeated", quoted(section));
        numbers.words.rest_of_line();
        match (name, &nodes) {
            ("Nodes" | "ParametricNodes", Some(_)) => return refused(second()),
            ("ParametricNodes", None) if numbers.words.binary => {
                return refused(
                    "binary parametric nodes are not supported: save the file as text, or as 4.1".into(),
                );
            }
            ("Nodes" | "ParametricNodes", None) => {
                let parametric = name == "ParametricNodes";
                nodes = Some(Nodes::read(&mut numbers, version, parametric, &mut builder)?);
            }
            ("Elements", _) if elements => return refused(second()),
            ("Elements", None) => return refused("$Elements comes before $Nodes".into()),
            ("Elements", Some(nodes)) => {
                elements = true;
                elements::read(&mut numbers, version, nodes, &groups, &mut builder)?;
            }
            ("PhysicalNames" | "Entities", _)
                if elements && (name == "PhysicalNames" || version == Version::V4) =>
            {
                let cause = format!(
                    "{} comes after $Elements, which need it for their materials: move it before them",
                    quoted(section)
                );
                return refused(cause);
            }
            ("PhysicalNames", _) => groups.read_names(&mut numbers.words)?,
            ("Entities", _) if version == Version::V4 => groups.read_entities(&mut numbers)?,
            _ if numbers.words.skip_past_line(&format!("$End{name}")) => continue,
            _ => {
                return Err(FormatError::whole(format!(
                    "the file ends before {}",
                    quoted(&format!("$End{name}"))
                )));
            }
        }
        end(&mut numbers.words, name)?;
    }
    if !elements {
        return Err(FormatError::whole("the file has no section $Elements"));
    }
    builder.finish_any()
}

/// Parses `$MeshFormat`: version, whether the file is binary, width of sizes; then for binary files the integer 1.
fn header<'a>(words: &mut Words<'a>) -> Result<(Version, Numbers<'a>), FormatError> {
    let magic = words.word("the header")?;
    if magic != "$MeshFormat" {
        return words.refused(format!("a gmsh file begins with '$MeshFormat', not {}", quoted(magic)));
    }
    let version = match words.word("the version")? {
        "2.2" | "2.1" | "2" | "2.0" => Version::V2,
        "4.1" => Version::V4,
        other => {
            let cause = format!(
                "version {} of the format is not supported: save the file as 2.2 or 4.1",
                quoted(other)
            );
            return words.refused(cause);
        }
    };
    words.binary = words.integer("the type of the file")? != 0;
    let size = words.integer("the size of numbers")?;
    if words.binary && size != 8 {
        return words.refused(format!("numbers of {size} bytes are not supported: only 8 are"));
    }
    words.rest_of_line();
    let mut big_endian = false;
    if words.binary {
        big_endian = match words.take::<4>("the integer 1")? {
            [1, 0, 0, 0] => false,
            [0, 0, 0, 1] => true,
            other => {
                return words.refused(format!("the byte order is not clear: 1 is stored as {other:?}"));
            }
        };
    }
    end(words, "MeshFormat")?;
    Ok((version, Numbers { words: *words, big_endian }))
}

fn end(words: &mut Words, name: &str) -> Result<(), FormatError> {
    let expected = format!("$End{name}");
    let found = words.word(&quoted(&expected))?;
    if found != expected {
        return words.refused(format!("{} was expected, not {}", quoted(&expected), quoted(found)));
    }
    words.rest_of_line();
    Ok(())
}
