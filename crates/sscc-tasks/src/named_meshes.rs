//! Groups of several meshes by their names, with one table of pairs.

use std::collections::{BTreeMap, BTreeSet};

use sscc::TriangleGroups;
use sscc_io::NamedGroups;

use crate::error::Result;

/// A mesh whose triangles have a name of each of several kinds: of their node, mesh, material and others.
pub(crate) struct NamedMesh {
    /// The groups of each kind, for the same triangles. A group with an empty name has no name.
    pub kinds: Vec<NamedGroups>,
}

impl NamedMesh {
    fn has(&self, name: &str) -> bool {
        self.kinds.iter().any(|kind| kind.names.iter().any(|known| known == name))
    }

    fn triangles(&self) -> usize {
        self.kinds.first().map_or(0, |kind| kind.of_triangle.len())
    }
}

/// A pair of names.
type Names = [String; 2];

/// Returns the names of each pair `A,B`. The error is the first text that is not a pair of known names, with the cause.
pub(crate) fn names_of_pairs<'t>(
    meshes: &[NamedMesh],
    typed: &'t [String],
) -> std::result::Result<Vec<Names>, (&'t str, String)> {
    let mut known = NamedGroups::default();
    let mut seen = BTreeSet::new();
    let names = meshes.iter().flat_map(|mesh| mesh.kinds.iter().flat_map(|kind| &kind.names));
    known.names.extend(names.filter(|name| !name.is_empty() && seen.insert(*name)).cloned());
    let pair = |text: &'t String| {
        let (a, b) = known.pair(text).map_err(|cause| (text.as_str(), cause))?;
        Ok([a, b].map(|name| known.names[name as usize].clone()))
    };
    typed.iter().map(pair).collect()
}

/// Whether some mesh has triangles of both names.
pub(crate) fn is_in_one_mesh(meshes: &[NamedMesh], names: &Names) -> bool {
    meshes.iter().any(|mesh| names.iter().all(|name| mesh.has(name)))
}

/// Returns the groups of each mesh with one table, in which these pairs of names do not count, or no other pairs count. A
/// triangle is in the groups of all its names.
pub(crate) fn tables(
    meshes: &[NamedMesh],
    pairs: &[Names],
    are_ignored: bool,
) -> Result<Vec<TriangleGroups>> {
    let mut numbers: BTreeMap<&str, usize> = BTreeMap::new();
    for name in pairs.iter().flatten() {
        let next = numbers.len();
        numbers.entry(name).or_insert(next);
    }
    // Triangles with the same names, among the names in pairs, are one group of the table.
    let mut groups: BTreeMap<Vec<usize>, u32> = BTreeMap::new();
    let mut of_triangles = Vec::new();
    for mesh in meshes {
        let mut last: Option<(Vec<u32>, u32)> = None;
        let mut of_names: BTreeMap<Vec<u32>, u32> = BTreeMap::new();
        for triangle in 0..mesh.triangles() {
            let of_kinds: Vec<u32> = mesh.kinds.iter().map(|kind| kind.of_triangle[triangle]).collect();
            let group = match last.take() {
                Some((names, group)) if names == of_kinds => group,
                _ => *of_names.entry(of_kinds.clone()).or_insert_with_key(|of_kinds| {
                    let names =
                        mesh.kinds.iter().zip(of_kinds).map(|(kind, group)| &kind.names[*group as usize]);
                    let set: BTreeSet<usize> =
                        names.filter_map(|name| numbers.get(&**name)).copied().collect();
                    let next = groups.len() as u32;
                    *groups.entry(set.into_iter().collect()).or_insert(next)
                }),
            };
            of_triangles.push(group);
            last = Some((of_kinds, group));
        }
    }
    let with = |name: &str| -> Vec<u32> {
        let number = numbers[name];
        groups.iter().filter(|(names, _)| names.contains(&number)).map(|(_, group)| *group).collect()
    };
    let table = TriangleGroups::new(&of_triangles)?;
    let mut listed = BTreeSet::new();
    for [a, b] in pairs {
        let partners = with(b);
        listed.extend(with(a).into_iter().flat_map(|g| partners.iter().map(move |h| [g, *h])));
    }
    let table = if are_ignored { table.ignoring(listed) } else { table.only(listed) }?;
    let counts: Vec<usize> = meshes.iter().map(NamedMesh::triangles).collect();
    Ok(table.of_meshes(&counts)?)
}
