//! Arguments of the motion of a mesh without modes.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// The motion of a mesh without modes.
#[derive(Debug, Args)]
pub struct Motion {
    /// Frames of the mesh: .npy of shape (T, V, 3) with the positions of all vertices, a .pc2 point cache, deformed
    /// .vtu, .vtk or .pvd, or a folder of meshes with the same faces (9.obj before 10.obj)
    #[arg(long, value_name = "FRAMES", conflicts_with_all = ["trajectory", "q", "animation"])]
    pub frames: Option<PathBuf>,
    /// Another mesh: list the pairs (triangle of MODEL, triangle of this mesh) that collide
    #[arg(long, value_name = "MESH", conflicts_with_all = ["trajectory", "q", "animation", "meshes"])]
    pub against: Option<PathBuf>,
    /// The other mesh where its glTF file has several, as --mesh-name for MODEL
    #[arg(long, value_name = "NAME")]
    pub against_mesh: Option<String>,
    /// Frames of the other mesh; if both meshes move, as many as those of --frames
    #[arg(long, value_name = "FRAMES")]
    pub against_frames: Option<PathBuf>,
    /// The animation of a .glb, .gltf or .vrm, by name or number, as a player would show it: nodes, morph targets, skins
    #[arg(long, value_name = "NAME", conflicts_with_all = ["trajectory", "q", "mesh_name"])]
    pub animation: Option<String>,
    /// Check the animation N times a second, from 0 to its last key frame [default: 30]
    #[arg(long, value_name = "N", conflicts_with = "times")]
    pub fps: Option<f64>,
    /// Check the animation at these times (s)
    #[arg(long, value_name = "TIMES", value_delimiter = ',', allow_hyphen_values = true)]
    pub times: Option<Vec<f64>>,
    /// Also compare the meshes of every two nodes with each other at each time; those that collide have a line. The
    /// nodes of a glTF file with several meshes are always compared in this way without --animation
    #[arg(long, conflicts_with_all = ["trajectory", "q", "frames", "against"])]
    pub between_nodes: bool,
    /// Check the mesh at this node only, by its name or its number in the file [default: every node with a mesh]
    #[arg(long, value_name = "NODE")]
    pub node: Option<String>,
    /// How to read skin weights that do not sum to 1 [default: normalized]
    #[arg(long, value_enum, value_name = "READING")]
    pub weights: Option<Weights>,
}

/// Interpretations of skin weights that do not sum to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Weights {
    /// Divide the weights of each vertex by their sum, as three.js does
    Normalized,
    /// Use the weights of the file
    AsStored,
}
