//! A mesh at rest, at the places that the nodes of its file give it.

use std::collections::BTreeMap;
use std::path::Path;

use glam::{DMat4, DVec3};
use sscc::TriMesh;

use super::json::{self, PlacedRoot, SkinRoot};
use super::nodes::{NODE_SIZE, Nodes};
use super::place::{Place, SkinWeights, check_joints, check_positions};
use super::shape::Shape;
use super::shown::{Shown, choose_shown, shown_nodes};
use super::skin::Skin;
use crate::gltf::accessors::Accessors;
use crate::gltf::buffers::Buffers;
use crate::gltf::json::{Root, parse_parts};
use crate::gltf::part_names::PartNames;
use crate::gltf::triangles::geometry_accessors;
use crate::gltf::{glb, select};
use crate::named_groups::{GroupCollector, GroupsBy, NamedGroups};
use crate::{FormatError, IoError, read_whole};

/// A mesh of a glTF file without its morph targets, and its places: the nodes of the default scene that show it; if none
/// does, the nodes of any scene; if no node shows it, one place, in the mesh's own coordinates.
///
/// The world positions are those of the stored state, without an animation. A node without a skin maps the file's
/// positions `p` to `M p`, where M is the product of the matrices of its ancestors, the outermost first, and of its own.
/// A node with a skin maps them to `sum w (J B) p`, as in [`ScenePose::positions`](super::ScenePose::positions). All of it
/// is evaluated in f64, from the file's numbers.
pub struct PlacedMesh {
    mesh: usize,
    shape: Shape,
    /// The node of each place, with the number of its skin.
    nodes: Vec<(usize, Option<usize>)>,
    /// Skins of these nodes, by their numbers.
    skins: BTreeMap<usize, Skin>,
    /// World transforms of all nodes.
    world: Vec<DMat4>,
    names: Result<PartNames, FormatError>,
    notes: Vec<String>,
}

/// Reads a mesh: that of this name (`#3` is the fourth), else the one at the only node of this name, at this node alone;
/// without a name the only mesh with triangles. Its primitives of triangles are joined in file order; those of points and
/// lines are left out.
///
/// # Errors
/// When the file cannot be read or is malformed (as [`read`](crate::gltf::read)); when no mesh has triangles, or
/// several have and none is named; when the name fits no mesh or node, several, or a mesh without triangles; when the
/// node hierarchy or the skin is malformed (as [`read_scene`](super::read_scene)).
pub fn read_placed_mesh(path: &Path, name: Option<&str>) -> Result<PlacedMesh, IoError> {
    read_in(path, |root, placed| choose_shown(root, placed, name))
}

/// As [`read_placed_mesh`], for the mesh that [`read`](crate::gltf::read) chooses: models are in the coordinates of their
/// mesh, and [`PlacedMesh::place`] moves their positions to the world.
///
/// # Errors
/// As [`read_placed_mesh`] and [`read`](crate::gltf::read).
pub fn read_model_placement(path: &Path, name: Option<&str>) -> Result<PlacedMesh, IoError> {
    read_in(path, |root, placed| {
        let mesh = select::choose(root, name)?;
        Ok(Shown { mesh, nodes: shown_nodes(placed, mesh) })
    })
}

/// As [`read_placed_mesh`], from the bytes of a file without external buffers.
///
/// # Errors
/// As [`read_placed_mesh`], and when a buffer is in another file.
pub fn parse_placed_mesh(bytes: &[u8], name: Option<&str>) -> Result<PlacedMesh, FormatError> {
    parse_in(bytes, None, |root, placed| choose_shown(root, placed, name))
}

fn read_in(
    path: &Path,
    choose: impl FnOnce(&Root, &PlacedRoot) -> Result<Shown, FormatError>,
) -> Result<PlacedMesh, IoError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    parse_in(&read_whole(path)?, Some(folder), choose).map_err(|error| error.of(path))
}

fn parse_in(
    bytes: &[u8],
    folder: Option<&Path>,
    choose: impl FnOnce(&Root, &PlacedRoot) -> Result<Shown, FormatError>,
) -> Result<PlacedMesh, FormatError> {
    let chunks = glb::split(bytes)?;
    let root = Root::parse(chunks.json)?;
    let placed: PlacedRoot = parse_parts(chunks.json)?;
    let Shown { mesh: index, nodes: shown } = choose(&root, &placed)?;
    let mesh = &root.meshes[index];
    // Attributes of skins are not read where no node needs them: an error there must not refuse the file.
    let skin_of = |node: &usize| placed.nodes[*node].skin.map(|skin| skin as usize);
    let file_skins: SkinRoot = match shown.iter().any(|node| skin_of(node).is_some()) {
        true => parse_parts(chunks.json)?,
        false => SkinRoot::default(),
    };
    let attributes = file_skins.meshes.get(index);
    let influences = attributes.into_iter().flat_map(json::Mesh::skin_accessors);
    let used_skins = shown.iter().filter_map(|node| file_skins.skins.get(skin_of(node)?));
    let matrices = used_skins.filter_map(|skin| skin.inverse_bind_matrices);
    let buffers = Buffers::new(&root.buffers, chunks.binary, folder);
    let used = geometry_accessors(mesh).chain(influences).chain(matrices);
    let mut accessors = Accessors::new(&root, buffers, used, bytes.len() as u64)?;
    let refused = |cause| FormatError::part("nodes", cause);
    accessors.allowance.take(placed.nodes.len() as u64, NODE_SIZE).map_err(refused)?;
    let nodes = Nodes::new(&placed.nodes)?;
    let shape = Shape::read(&mut accessors, index, mesh, 0, attributes)?;
    let mut skins = BTreeMap::new();
    for node in &shown {
        let (Some(number), Some(influences)) = (skin_of(node), &shape.influences) else { continue };
        if skins.contains_key(&number) {
            continue;
        }
        let place = format!("nodes[{node}]");
        let Some(skin) = file_skins.skins.get(number) else {
            return Err(FormatError::part(place, format!("skins[{number}] does not exist")));
        };
        let skin = Skin::read(&mut accessors, &nodes, number, skin)?;
        check_joints(influences, (number, &skin), index, &place)?;
        skins.insert(number, skin);
    }
    let notes = shown.iter().filter_map(|node| placed.nodes[*node].instancing_note(*node)).collect();
    let shown = shown.into_iter().map(|node| (node, skin_of(&node))).collect();
    // These nodes take most of the memory for a file of empty nodes.
    drop(placed);
    let (world, names) = (nodes.world_transforms(&[]), PartNames::parse(chunks.json));
    Ok(PlacedMesh { mesh: index, shape, nodes: shown, skins, world, names, notes })
}

impl PlacedMesh {
    /// Index of the mesh in the file.
    pub fn mesh(&self) -> usize {
        self.mesh
    }

    /// Lines about content of the nodes that was not evaluated.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Number of places, at least 1.
    pub fn places(&self) -> usize {
        self.nodes.len().max(1)
    }

    /// Index of the node at a place; None if no node shows the mesh.
    pub fn node(&self, place: usize) -> Option<usize> {
        self.nodes.get(place).map(|(node, _)| *node)
    }

    /// Index of the skin that deforms the mesh at a place; None without a skin.
    pub fn skin(&self, place: usize) -> Option<usize> {
        self.nodes.get(place)?.1
    }

    /// The largest |sum of weights - 1| of a vertex, as
    /// [`MeshNode::largest_weight_error`](super::MeshNode::largest_weight_error).
    pub fn largest_weight_error(&self) -> f64 {
        self.shape.influences.as_ref().map_or(0.0, |influences| influences.largest_sum_error)
    }

    /// Faces (N): three vertex indices each, in file order over all primitives of triangles. N is 0 if the mesh has only
    /// strips whose triangles have repeated corners.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.shape.faces
    }

    /// Positions (V) in the mesh's own coordinates.
    pub fn rest_positions(&self) -> &[DVec3] {
        &self.shape.rest
    }

    /// Returns the mesh at a place, in world coordinates.
    ///
    /// # Errors
    /// When there is no such place, or as [`PlacedMesh::place`]; when the mesh has no triangles.
    pub fn to_mesh(&self, place: usize) -> Result<TriMesh, FormatError> {
        if self.shape.faces.is_empty() {
            let cause = "it has only strips whose triangles have repeated corners, so it has no triangles: export the mesh with \
                         its surface";
            return Err(FormatError::part(format!("meshes[{}]", self.mesh), cause));
        }
        let mut positions = self.shape.rest.clone();
        self.place(place, &mut positions)?;
        Ok(TriMesh::new(positions, self.shape.faces.clone())?.with_split_vertices())
    }

    /// Replaces positions of all vertices (V) in the mesh's own coordinates by those in the world, at a place. Skin
    /// weights are divided by their sum.
    ///
    /// # Errors
    /// When there is no such place, the number of positions is not V, or a position is then not finite or exceeds
    /// [`sscc::limits::LARGEST`].
    pub fn place(&self, place: usize, positions: &mut [DVec3]) -> Result<(), FormatError> {
        if place >= self.places() || positions.len() != self.shape.rest.len() {
            let (places, vertices, found) = (self.places(), self.shape.rest.len(), positions.len());
            return Err(FormatError::whole(format!(
                "place {place} or {found} positions do not fit the mesh: there are {places} places and {vertices} vertices"
            )));
        }
        let Some(map) = self.map(place) else { return Ok(()) };
        map.apply(SkinWeights::Normalized, positions);
        check_positions(positions, &format!("nodes[{}]", self.nodes[place].0))
    }

    /// Returns the transform from the mesh's own coordinates to the world, at a place; None with a skin, which has several.
    pub fn transform(&self, place: usize) -> Option<DMat4> {
        match self.map(place) {
            None => Some(DMat4::IDENTITY),
            Some(Place::Rigid(transform)) => Some(transform),
            Some(Place::Skinned(..)) => None,
        }
    }

    /// Whether a scale of 0 flattens triangles at a place to segments or points.
    pub fn is_flattened(&self, place: usize) -> bool {
        self.map(place).is_some_and(|map| map.is_flat())
    }

    /// Returns for each vertex (V) the first vertex that coincides with it in every pose of the skin at a place: the
    /// position and the influences are equal. None without a skin, where positions alone decide.
    pub fn weld_classes(&self, place: usize) -> Option<&[u32]> {
        self.skin(place).map(|_| &self.shape.weld_classes[..])
    }

    /// Returns the group of each triangle, at a place.
    ///
    /// # Errors
    /// When a name or the material of a primitive is malformed, or there are more than 65,536 groups.
    pub fn groups(&self, place: usize, by: GroupsBy) -> Result<NamedGroups, FormatError> {
        let names = self.names.as_ref().map_err(Clone::clone)?;
        let mut groups = GroupCollector::default();
        for &(primitive, end) in &self.shape.primitives {
            let name = names.group(by, self.node(place), self.mesh, primitive);
            groups.extend_to(end as usize, &name)?;
        }
        Ok(groups.finish())
    }

    fn map(&self, place: usize) -> Option<Place<'_>> {
        let (node, skin) = self.nodes.get(place)?;
        let skin = skin.and_then(|skin| self.skins.get(&skin));
        Some(Place::new(*node, skin.zip(self.shape.influences.as_ref()), |node| self.world[node]))
    }
}
