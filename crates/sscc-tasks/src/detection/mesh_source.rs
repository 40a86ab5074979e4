//! A file with a mesh at rest, at each of its places. A place is the mesh as one node of the file shows it.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use glam::DVec3;
use sscc::{TriMesh, TriangleGroups};
use sscc_io::gltf::{PlacedMesh, is_gltf, read_placed_mesh};
use sscc_io::{
    GroupsBy, IoError, LoadedMesh, Message, NamedGroups, Setting, load_mesh_with_warnings, read_base_groups,
    split_mesh_name,
};

use super::weld_classes::WeldClasses;
use crate::TaskError;
use crate::error::Result;
use crate::groups::{GroupRules, MeshGroups};
use crate::watch::Watch;

/// Maximum difference of a sum of weights from 1 that is treated as rounding.
pub(super) const MAX_WEIGHT_ERROR: f64 = 1e-2;

/// A mesh of a file, read once. The nodes of a glTF file give it places; other meshes have one place.
pub(super) struct MeshSource {
    /// The file as in the request, which may name the mesh (`FILE#NAME`).
    pub file: PathBuf,
    /// Name of the mesh, given in addition to the file.
    pub name: Option<String>,
    /// Groups that hold between the mesh and the other one of the request.
    pub groups: Option<TriangleGroups>,
    content: Content,
}

enum Content {
    Plain(TriMesh),
    Placed(Box<PlacedMesh>),
}

impl MeshSource {
    /// Reads a mesh. `name` is the name of a mesh of a glTF file.
    pub fn read(file: &Path, name: Option<&str>, watch: &dyn Watch) -> Result<Self> {
        let (path, name_of_path) = split_mesh_name(file);
        // If both names are given, the reader returns an error.
        let content = match is_gltf(&path) && (name_of_path.is_none() || name.is_none()) {
            true => Content::Placed(Box::new(read_placed_mesh(&path, name_of_path.as_deref().or(name))?)),
            false => {
                let LoadedMesh { mesh, warnings, .. } = load_mesh_with_warnings(file, name)?;
                warnings.iter().for_each(|warning| watch.warn(&format!("{}: {warning}", file.display())));
                Content::Plain(mesh)
            }
        };
        let source = Self { file: file.to_owned(), name: name.map(str::to_owned), groups: None, content };
        source.warn(watch);
        Ok(source)
    }

    /// Warns if no node shows the mesh, and if skin weights break the standard. Also sends the notes of the reader.
    fn warn(&self, watch: &dyn Watch) {
        let Content::Placed(placed) = &self.content else { return };
        let warn = |text: &str| watch.warn(&format!("{}: {text}", self.file.display()));
        if placed.node(0).is_none() {
            warn("no node shows the mesh: it is checked in its own coordinates");
        }
        placed.notes().iter().for_each(|note| warn(note));
        let error = placed.largest_weight_error();
        if error > MAX_WEIGHT_ERROR {
            warn(&format!(
                "the sums of skin weights differ from 1 by up to {error:.3}; they were normalized"
            ));
        }
    }

    /// Warns if the first place does not represent all places: skins deform a mesh, and a scale of 0 flattens it.
    pub fn warn_of_other_places(&self, watch: &dyn Watch) {
        let Content::Placed(placed) = &self.content else { return };
        // Places with the same skin count as one.
        let is_other = |place: &usize| match placed.skin(*place) {
            None => placed.skin(0).is_some() || placed.is_flattened(*place) || placed.is_flattened(0),
            skin => skin != placed.skin(0),
        };
        let other = (1..placed.places()).find(is_other);
        if let Some((first, other)) = placed.node(0).zip(other.and_then(|other| placed.node(other))) {
            watch.warn(&format!(
                "{}: node {first} alone is checked; node {other} shows the mesh with another skin, or one of \
                 them flattens it",
                self.file.display()
            ));
        }
    }

    /// Returns the number of places, at least 1.
    pub fn places(&self) -> usize {
        match &self.content {
            Content::Plain(_) => 1,
            Content::Placed(placed) => placed.places(),
        }
    }

    /// Returns the number of the node at a place, if there are several places.
    pub fn node(&self, place: usize) -> Option<usize> {
        match &self.content {
            Content::Placed(placed) if placed.places() > 1 => placed.node(place),
            _ => None,
        }
    }

    /// Warns of those among the first `places` nodes that flatten the mesh.
    pub fn warn_of_flattened_places(&self, places: usize, watch: &dyn Watch) {
        let Content::Placed(placed) = &self.content else { return };
        for node in
            (0..places).filter(|place| placed.is_flattened(*place)).filter_map(|place| placed.node(place))
        {
            watch.warn(&format!(
                "{}: node {node}: a scale of 0 flattens the mesh, so that its triangles touch",
                self.file.display()
            ));
        }
    }

    /// Returns the mesh at a place.
    pub fn mesh(&self, place: usize) -> Result<TriMesh> {
        match &self.content {
            Content::Plain(mesh) => Ok(mesh.clone()),
            Content::Placed(placed) => {
                let in_file = |error| IoError::Format { path: self.file.clone(), error };
                Ok(placed.to_mesh(place).map_err(in_file)?)
            }
        }
    }

    /// Returns positions in the mesh's own coordinates. Vertices are welded by these, so that rounding at a place has no effect.
    pub fn own_positions(&self) -> &[DVec3] {
        match &self.content {
            Content::Plain(mesh) => mesh.rest_positions(),
            Content::Placed(placed) => placed.rest_positions(),
        }
    }

    /// Returns classes of the vertices that are welded at a place. A skin may separate vertices of equal position.
    pub fn weld_classes(&self, place: usize) -> WeldClasses {
        let of_skin = match &self.content {
            Content::Plain(_) => None,
            Content::Placed(placed) => placed.weld_classes(place),
        };
        of_skin.map_or_else(|| WeldClasses::at(self.own_positions()), WeldClasses::from)
    }

    /// Assigns the groups that hold between two meshes to both, if `rules` has any.
    pub fn set_groups(rules: &GroupRules, meshes: [&mut Self; 2]) -> Result<()> {
        let [a, b] = meshes;
        if rules.is_empty() && rules.by.is_none() {
            return Ok(());
        }
        if let Some(several) = [&*a, &*b].into_iter().find(|mesh| mesh.places() > 1) {
            let cause = "several nodes show the mesh, and groups are those of one: name it, as in FILE#NODE";
            return Err(TaskError::refused(several.file.display(), cause));
        }
        let triangles = |mesh: &Self| Ok::<_, TaskError>(mesh.mesh(0)?.faces().len());
        let (in_a, in_b) = (triangles(a)?, triangles(b)?);
        let [read_a, read_b] = [&*a, &*b].map(|mesh| move |by: GroupsBy| mesh.named_groups(by));
        let found = rules.of_two([
            MeshGroups { path: &a.file, triangles: in_a, read: &read_a },
            MeshGroups { path: &b.file, triangles: in_b, read: &read_b },
        ])?;
        let [of_a, of_b] = found.map_or([None, None], |groups| groups.map(Some));
        (a.groups, b.groups) = (of_a, of_b);
        Ok(())
    }

    /// Returns the groups of its triangles by their names, at the first place.
    fn named_groups(&self, by: GroupsBy) -> Result<NamedGroups, IoError> {
        match &self.content {
            Content::Plain(_) => read_base_groups(&self.file, self.name.as_deref(), by),
            Content::Placed(placed) => {
                placed.groups(0, by).map_err(|error| IoError::Format { path: self.file.clone(), error })
            }
        }
    }

    /// Refuses to compare a mesh with itself at the same place. With the same frames, all nodes count as the same place.
    pub fn check_differs(&self, other: &Self, has_frames: bool) -> Result<()> {
        let real = |source: &Self| fs::canonicalize(split_mesh_name(&source.file).0).ok();
        if real(self) != real(other) {
            return Ok(());
        }
        let file = other.file.display();
        let cause = match (&self.content, &other.content) {
            (Content::Placed(a), Content::Placed(b)) => {
                let nodes = |placed: &PlacedMesh| -> BTreeSet<Option<usize>> {
                    (0..placed.places()).map(|place| placed.node(place)).collect()
                };
                let is_apart = !has_frames && nodes(a).is_disjoint(&nodes(b));
                if a.mesh() != b.mesh() || is_apart {
                    return Ok(());
                }
                let (path, _) = split_mesh_name(&self.file);
                let path = path.display();
                let named = format!("the same mesh is on both sides: name a mesh for each, as in {path}#A ");
                Message::from(named)
                    + Setting::Against
                    + format!(" {path}#B, or with ")
                    + Setting::MeshName
                    + " and "
                    + Setting::AgainstMesh
                    + " (sscc info lists the meshes)"
            }
            _ => {
                let cause = "the same mesh is on both sides: give another one; its collisions with itself are found without ";
                cause + Setting::Against
            }
        };
        Err(TaskError::refused(file, cause))
    }
}
