//! The contents of a glTF file: scenes, nodes that place meshes, meshes with their morph targets, skins and animations.

use std::path::Path;

use serde::Serialize;
use sscc_io::IoError;
use sscc_io::gltf::{AnimationContents, Contents, MeshContents, MeshNodeContents, NamedPart, read_contents};

use super::table::{Table, columns};
use crate::output::{counted, grouped, length, one_line};

#[derive(Serialize)]
pub struct Gltf {
    scenes: Vec<Scene>,
    default_scene: Option<usize>,
    #[serde(skip)]
    all_nodes: usize,
    /// Nodes that place a mesh.
    nodes: Vec<Node>,
    meshes: Vec<Mesh>,
    skins: Vec<Skin>,
    animations: Vec<Animation>,
}

#[derive(Serialize)]
struct Scene {
    name: Option<String>,
    root_nodes: usize,
}

#[derive(Serialize)]
struct Node {
    node: usize,
    name: Option<String>,
    mesh: usize,
    skin: Option<usize>,
    in_default_scene: bool,
}

#[derive(Serialize)]
struct Mesh {
    name: String,
    primitives: usize,
    /// Names of the morph targets, which are the modes of the model; empty for a mesh without targets.
    targets: Vec<String>,
    /// Null for a malformed mesh.
    triangles: Option<usize>,
    vertices: Option<usize>,
    default_q: Vec<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
}

#[derive(Serialize)]
struct Skin {
    name: Option<String>,
    joints: usize,
}

#[derive(Serialize)]
struct Animation {
    name: Option<String>,
    /// The time of the last key frame; null for a malformed animation.
    seconds: Option<f64>,
    channels: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
}

impl Gltf {
    pub fn of(path: &Path) -> Result<Self, IoError> {
        let contents = read_contents(path)?;
        let Contents { scenes, default_scene, nodes, mesh_nodes, meshes, skins, animations, .. } = contents;
        let named = |parts: Vec<NamedPart>| parts.into_iter().map(|part| (part.name, part.parts));
        let node = |node: MeshNodeContents| {
            let MeshNodeContents { node, name, mesh, skin, is_in_default_scene, .. } = node;
            Node { node, name, mesh, skin, in_default_scene: is_in_default_scene }
        };
        Ok(Self {
            scenes: named(scenes).map(|(name, root_nodes)| Scene { name, root_nodes }).collect(),
            default_scene,
            all_nodes: nodes,
            nodes: mesh_nodes.into_iter().map(node).collect(),
            meshes: meshes.into_iter().map(Mesh::from).collect(),
            skins: named(skins).map(|(name, joints)| Skin { name, joints }).collect(),
            animations: animations.into_iter().map(Animation::from).collect(),
        })
    }

    pub fn lines(&self) -> Vec<String> {
        let count = |count: usize, noun| counted(count as u64, noun);
        let mut lines = vec![format!(
            "glTF           {}, {} ({} with meshes), {}, {}, {}",
            count(self.scenes.len(), "scene"),
            count(self.all_nodes, "node"),
            grouped(self.nodes.len() as u64),
            count(self.meshes.len(), "mesh").replace("meshs", "meshes"),
            count(self.skins.len(), "skin"),
            count(self.animations.len(), "animation"),
        )];
        if !self.meshes.iter().any(|mesh| mesh.triangles != Some(0)) {
            lines.push("no triangles   no mesh has any: export the scene with its surfaces".to_owned());
        }
        lines.extend(self.scene_table());
        lines.extend(self.node_table());
        lines.extend(self.mesh_table());
        lines.extend(self.skin_table());
        lines.extend(self.animation_table());
        let repeated = |names: Vec<&str>, what, flag| {
            let (name, number) = repeated(&names)?;
            Some(format!(
                "several {what} have the name {}: choose one by its number, as in {flag} {number}",
                one_line(name)
            ))
        };
        let meshes = self.meshes.iter().map(|mesh| mesh.name.as_str()).collect();
        lines.extend(repeated(meshes, "meshes", "--mesh-name"));
        let animations =
            self.animations.iter().map(|animation| animation.name.as_deref().unwrap_or_default());
        lines.extend(repeated(animations.collect(), "animations", "--animation"));
        lines
    }

    fn scene_table(&self) -> Vec<String> {
        let mut table = Table::new(["scene", "root nodes"]);
        for (number, scene) in self.scenes.iter().enumerate() {
            let default = if self.default_scene == Some(number) { " (default)" } else { "" };
            let name = name_of(scene.name.as_deref()) + default;
            table.row([number.to_string(), grouped(scene.root_nodes as u64)], name);
        }
        table.lines()
    }

    fn node_table(&self) -> Vec<String> {
        let mut table = Table::new(["node", "mesh", "skin"]);
        for node in &self.nodes {
            let skin = node.skin.map_or("-".to_owned(), |skin| skin.to_string());
            let remark = match self.default_scene {
                _ if node.mesh >= self.meshes.len() => " (malformed: there is no such mesh)",
                Some(_) if !node.in_default_scene => " (not in the default scene)",
                _ => "",
            };
            let name = name_of(node.name.as_deref()) + remark;
            table.row([node.node.to_string(), node.mesh.to_string(), skin], name);
        }
        table.lines()
    }

    /// Returns the lines of the meshes, and below them the names of their morph targets, in columns.
    fn mesh_table(&self) -> Vec<String> {
        let mut table = Table::new(["mesh", "triangles", "vertices", "targets"]);
        for (number, mesh) in self.meshes.iter().enumerate() {
            let [triangles, vertices] =
                [mesh.triangles, mesh.vertices].map(|n| n.map_or("-".to_owned(), |n| grouped(n as u64)));
            let remark = match &mesh.error {
                Some(error) => format!(" (malformed: {})", one_line(error)),
                None if mesh.triangles == Some(0) => " (points and lines only)".to_owned(),
                None => String::new(),
            };
            let targets = mesh.targets.len().to_string();
            table.row([number.to_string(), triangles, vertices, targets], one_line(&mesh.name) + &remark);
        }
        let mut lines = table.lines();
        for (number, mesh) in self.meshes.iter().enumerate().filter(|(_, mesh)| !mesh.targets.is_empty()) {
            lines.push(format!("targets of mesh {number} ({})", one_line(&mesh.name)));
            let target = |(k, name): (usize, &String)| match mesh.default_q.get(k) {
                Some(weight) if *weight != 0.0 => format!("{k} {} = {}", one_line(name), length(*weight)),
                _ => format!("{k} {}", one_line(name)),
            };
            lines.extend(columns(mesh.targets.iter().enumerate().map(target)));
        }
        lines
    }

    fn skin_table(&self) -> Vec<String> {
        let mut table = Table::new(["skin", "joints"]);
        for (number, skin) in self.skins.iter().enumerate() {
            let joints = grouped(skin.joints as u64);
            table.row([number.to_string(), joints], name_of(skin.name.as_deref()));
        }
        table.lines()
    }

    fn animation_table(&self) -> Vec<String> {
        let mut table = Table::new(["animation", "seconds", "channels"]);
        for (number, animation) in self.animations.iter().enumerate() {
            let seconds = animation.seconds.map_or("-".to_owned(), length);
            let error = animation.error.iter().map(|error| format!(" (malformed: {})", one_line(error)));
            let name = name_of(animation.name.as_deref()) + &error.collect::<String>();
            table.row([number.to_string(), seconds, animation.channels.to_string()], name);
        }
        table.lines()
    }
}

impl From<MeshContents> for Mesh {
    fn from(mesh: MeshContents) -> Self {
        let MeshContents { name, primitives, targets, default_weights, size, .. } = mesh;
        let [triangles, vertices] = size.as_ref().map_or([None; 2], |size| size.map(Some));
        let error = size.err().map(|error| error.to_string());
        Self { name, primitives, targets, triangles, vertices, default_q: default_weights, error }
    }
}

impl From<AnimationContents> for Animation {
    fn from(AnimationContents { info, error, .. }: AnimationContents) -> Self {
        Self {
            name: info.name,
            seconds: error.is_none().then_some(info.last_time),
            channels: info.channels,
            error: error.map(|error| error.to_string()),
        }
    }
}

fn name_of(name: Option<&str>) -> String {
    name.map_or("-".to_owned(), one_line)
}

/// Returns the first name that occurs again, and its place. Parts without a name have an empty one.
fn repeated<'a>(names: &[&'a str]) -> Option<(&'a str, usize)> {
    let mut sorted: Vec<(&str, usize)> = names.iter().copied().zip(0..).collect();
    sorted.sort_unstable();
    let pairs = sorted.windows(2).filter(|pair| !pair[0].0.is_empty() && pair[0].0 == pair[1].0);
    pairs.map(|pair| pair[0]).min_by_key(|(_, number)| *number)
}
