//! The meshes of a glTF file and their morph targets.

use std::path::Path;

use serde::Serialize;
use sscc_io::IoError;
use sscc_io::gltf::{MeshInfo, list_meshes, read};

use crate::output::{counted, one_line};

/// Maximum number of meshes that are read. The others are listed by name.
const MAX_READ: usize = 20;

#[derive(Serialize)]
pub struct Meshes {
    meshes: Vec<Mesh>,
}

#[derive(Serialize)]
struct Mesh {
    name: String,
    primitives: usize,
    /// Names of the morph targets, which are the modes of the model; empty for a mesh without targets.
    targets: Vec<String>,
    triangles: Option<usize>,
    vertices: Option<usize>,
    default_q: Vec<f64>,
}

impl Meshes {
    pub fn of(path: &Path) -> Result<Self, IoError> {
        let mut read_count = 0;
        let mesh = |(index, info): (usize, MeshInfo)| -> Result<Mesh, IoError> {
            let mut mesh = Mesh {
                name: info.name,
                primitives: info.primitives,
                targets: Vec::new(),
                triangles: None,
                vertices: None,
                default_q: Vec::new(),
            };
            if info.targets > 0 && read_count < MAX_READ {
                read_count += 1;
                // By number, since two meshes may have the same name.
                let model = read(path, Some(&format!("#{index}")))?;
                mesh.triangles = Some(model.mesh.faces().len());
                mesh.vertices = Some(model.mesh.rest_positions().len());
                mesh.targets = model.target_names;
                mesh.default_q = model.default_weights;
            }
            Ok(mesh)
        };
        Ok(Self { meshes: list_meshes(path)?.into_iter().enumerate().map(mesh).collect::<Result<_, _>>()? })
    }

    pub fn lines(&self) -> Vec<String> {
        let (models, others): (Vec<_>, Vec<_>) =
            self.meshes.iter().partition(|mesh| !mesh.targets.is_empty());
        let mut lines = vec![format!(
            "glTF           {}, {} with morph targets",
            counted(self.meshes.len() as u64, "mesh").replace("meshs", "meshes"),
            models.len()
        )];
        for mesh in models {
            let (triangles, vertices) =
                (mesh.triangles.unwrap_or(0) as u64, mesh.vertices.unwrap_or(0) as u64);
            lines.push(format!(
                "--mesh-name {}: {}, {vertices} vertices, {}: {}",
                one_line(&mesh.name),
                counted(triangles, "triangle"),
                counted(mesh.targets.len() as u64, "mode"),
                one_line(&mesh.targets.join(", "))
            ));
        }
        let names: Vec<&str> = others.iter().map(|mesh| mesh.name.as_str()).collect();
        if !names.is_empty() {
            lines.push(format!("no targets     {}", one_line(&names.join(", "))));
        }
        lines
    }
}
