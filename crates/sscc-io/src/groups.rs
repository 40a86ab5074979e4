//! Reader for the groups of triangles of a mesh file.

use std::path::Path;

use crate::file::ending;
use crate::mesh_path::named_file;
use crate::named_groups::{GroupsBy, NamedGroups};
use crate::{IoError, gltf, mesh, read_vector, read_whole};

/// Reads the groups of the triangles of a mesh file, in the order of the mesh readers: of an OBJ file, or of the mesh
/// of a glTF file that [`gltf::read`] chooses by `mesh_name`.
///
/// # Errors
/// When the ending is none of `.obj`, `.glb`, `.gltf`, `.vrm`; when the mesh cannot be read; when there are more than
/// 65,536 groups.
pub fn read_groups(path: &Path, mesh_name: Option<&str>, by: GroupsBy) -> Result<NamedGroups, IoError> {
    let (file, mesh_name) = named_file(path, mesh_name)?;
    let path = file.as_path();
    match ending(path).as_str() {
        "obj" => mesh::obj::groups(&read_whole(path)?, by).map_err(|error| error.of(path)),
        _ if gltf::is_gltf(path) => gltf::read_groups(path, mesh_name.as_deref(), by),
        _ => {
            let cause = "files of this kind have no groups of triangles: use a .obj, .glb, .gltf or .vrm, or a file of \
                         one number for each triangle";
            Err(IoError::request(path, cause))
        }
    }
}

/// As [`read_groups`], but for the mesh that [`load_mesh`](crate::load_mesh) reads, at its first place: the mesh of a glTF
/// file needs no morph targets.
///
/// # Errors
/// As [`read_groups`].
pub fn read_base_groups(path: &Path, mesh_name: Option<&str>, by: GroupsBy) -> Result<NamedGroups, IoError> {
    let (file, name) = named_file(path, mesh_name)?;
    if !gltf::is_gltf(&file) {
        return read_groups(path, mesh_name, by);
    }
    let placed = gltf::read_placed_mesh(&file, name.as_deref())?;
    placed.groups(0, by).map_err(|error| error.of(&file))
}

/// Reads the group of each triangle as numbers from 0 (`.npy` or text). Their names are the numbers.
///
/// # Errors
/// When the file cannot be read, or a number is no integer from 0 to 65,535.
pub fn read_group_numbers(path: &Path) -> Result<NamedGroups, IoError> {
    let refused = |at: usize, number: f64| {
        let cause = format!(
            "the group of triangle {at} (counted from 0) is {number}: an integer from 0 to 65535 was expected"
        );
        IoError::request(path, cause)
    };
    let mut of_triangle = Vec::new();
    for (at, number) in read_vector(path)?.into_iter().enumerate() {
        let group = number as u16;
        if f64::from(group) != number {
            return Err(refused(at, number));
        }
        of_triangle.push(u32::from(group));
    }
    let count = of_triangle.iter().max().map_or(0, |largest| largest + 1);
    Ok(NamedGroups { names: (0..count).map(|group| group.to_string()).collect(), of_triangle })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_selects_the_format() {
        let directory = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = directory.path().join(name);
            std::fs::write(&path, text).unwrap();
            path
        };
        let obj = write("a.OBJ", "v 0 0 0\nv 1 0 0\nv 0 1 0\ng body\nusemtl red\nf 1 2 3\n");
        assert_eq!(read_groups(&obj, None, GroupsBy::Group).unwrap().names, ["body"]);
        assert_eq!(read_groups(&obj, None, GroupsBy::Material).unwrap().names, ["red"]);
        assert_eq!(read_groups(&obj, None, GroupsBy::Object).unwrap().names, ["default"]);
        let message = |path: &Path| read_groups(path, None, GroupsBy::Group).unwrap_err().to_string();
        assert!(message(&write("a.ply", "ply")).contains("a.ply: files of this kind have no groups"));
        assert!(message(&directory.path().join("b.obj")).ends_with("b.obj: not found"));
        assert!(message(&write("c.obj", "f 1 2")).contains("line 1"));
    }

    #[test]
    fn numbers_name_groups() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("g.npy");
        let read = |numbers: &[f64]| {
            crate::write_npy(&path, &[numbers.len()], numbers).unwrap();
            read_group_numbers(&path).map_err(|error| error.to_string())
        };
        let found = read(&[2.0, 0.0, 2.0]).unwrap();
        assert_eq!((found.number("2"), &found.of_triangle[..]), (Ok(2), &[2, 0, 2][..]));
        for bad in [-1.0, 0.5, 65536.0, 1e300] {
            let message = read(&[0.0, bad]).unwrap_err();
            assert!(message.contains("the group of triangle 1"), "{message}");
        }
    }
}
