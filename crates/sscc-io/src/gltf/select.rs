//! Selection of a mesh in a glTF file.

use super::json::{Mesh, Root};
use super::triangles::{morph_targets, with_triangles};
use crate::error::{cut, quoted};
use crate::{FormatError, Message, Setting};

/// Returns the name that selects a mesh: its own, or `#3` for an unnamed fourth mesh.
pub(super) fn mesh_name(mesh: &Mesh, number: usize) -> String {
    mesh.name.clone().unwrap_or_else(|| format!("#{number}"))
}

/// Returns the index of the mesh of that name, else of the only one with morph targets. `#3` and `3` are the fourth mesh,
/// unless a mesh has this name.
pub(super) fn choose(root: &Root, name: Option<&str>) -> Result<usize, FormatError> {
    let wanted = Wanted {
        is_candidate: &|mesh| morph_targets(mesh) > 0,
        content: "morph targets",
        settings: Setting::MeshName.into(),
        none: "no mesh of the file has morph targets: export it with shape keys, or give a mesh file with "
            + Setting::Modes,
    };
    wanted.choose(root, name)
}

/// As [`choose`], for meshes with triangles.
pub(super) fn choose_base(root: &Root, name: Option<&str>) -> Result<usize, FormatError> {
    let wanted = Wanted {
        is_candidate: &has_triangles,
        content: "triangles",
        settings: Setting::MeshName + " or " + Setting::AgainstMesh,
        none: "no mesh of the file has triangles: export the scene with its surfaces".into(),
    };
    wanted.choose(root, name)
}

/// Whether a mesh has triangles.
pub(super) fn has_triangles(mesh: &Mesh) -> bool {
    with_triangles(mesh).next().is_some()
}

/// The meshes that can be chosen.
struct Wanted<'a> {
    is_candidate: &'a dyn Fn(&Mesh) -> bool,
    /// Name of the content that a candidate needs, in messages.
    content: &'a str,
    /// Settings that name a mesh, in messages.
    settings: Message,
    /// Message if there is no candidate.
    none: Message,
}

impl Wanted<'_> {
    fn choose(self, root: &Root, name: Option<&str>) -> Result<usize, FormatError> {
        let names = root.meshes.iter().enumerate().map(|(number, mesh)| mesh_name(mesh, number));
        let (all, content): (Vec<String>, _) = (names.collect(), self.content);
        let is_candidate = |index: usize| (self.is_candidate)(&root.meshes[index]);
        let candidates: Vec<usize> = (0..all.len()).filter(|i| is_candidate(*i)).collect();
        let names = || {
            let names: Vec<_> = candidates.iter().take(20).map(|i| quoted(&all[*i])).collect();
            cut(&names.join(", "), 200)
        };
        let Some(name) = name else {
            return match candidates[..] {
                [one] => Ok(one),
                [] => Err(FormatError::whole(self.none)),
                _ => {
                    let cause = format!("{} meshes have {content}: choose one with ", candidates.len());
                    let names = format!(", or as FILE#NAME: {}", names());
                    Err(FormatError::whole(Message::from(cause) + self.settings + names))
                }
            };
        };
        let by_number = || -> Option<usize> {
            name.strip_prefix('#').unwrap_or(name).parse().ok().filter(|index| *index < all.len())
        };
        let named: Vec<usize> = (0..all.len()).filter(|i| all[*i] == name).collect();
        let cause = match named[..] {
            [one] if is_candidate(one) => return Ok(one),
            [_] => format!("the mesh {} has no {content}", quoted(name)),
            [] => match by_number() {
                Some(index) if is_candidate(index) => return Ok(index),
                Some(index) => format!("the mesh #{index} has no {content}"),
                None => format!("there is no mesh {}", quoted(name)),
            },
            [one, ..] => {
                let several = format!("{} meshes have the name {}", named.len(), quoted(name));
                return Err(FormatError::whole(format!(
                    "{several}: choose one by its number, such as #{one}"
                )));
            }
        };
        let others = if candidates.is_empty() { "none".into() } else { names() };
        Err(FormatError::whole(format!("{cause}; meshes with {content}: {others}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Meshes with these names and numbers of targets.
    fn root(meshes: &[(Option<&str>, usize)]) -> Root {
        let mesh = |(name, targets): &(Option<&str>, usize)| {
            let name = name.map_or(String::new(), |name| format!(r#""name":"{name}","#));
            let targets = vec!["{}"; *targets].join(",");
            format!(r#"{{{name}"primitives":[{{"attributes":{{"POSITION":0}},"targets":[{targets}]}}]}}"#)
        };
        let meshes: Vec<_> = meshes.iter().map(mesh).collect();
        Root::parse(format!(r#"{{"asset":{{"version":"2.0"}},"meshes":[{}]}}"#, meshes.join(",")).as_bytes())
            .unwrap()
    }

    #[test]
    fn the_only_or_the_named_mesh_is_chosen() {
        let one = root(&[(Some("a"), 0), (Some("b"), 2)]);
        assert_eq!(choose(&one, None), Ok(1));
        assert_eq!(choose(&one, Some("b")), Ok(1));
        let message = |root: &Root, name| choose(root, name).unwrap_err().to_string();
        assert_eq!(
            message(&one, Some("a")),
            "the mesh 'a' has no morph targets; meshes with morph targets: 'b'"
        );
        assert_eq!(message(&one, Some("c")), "there is no mesh 'c'; meshes with morph targets: 'b'");
        let many = root(&[(None, 1), (Some("b"), 1), (Some("b"), 3), (Some("#0"), 0)]);
        assert_eq!(
            message(&many, None),
            "3 meshes have morph targets: choose one with mesh_name, or as FILE#NAME: '#0', 'b', 'b'"
        );
        assert_eq!(
            message(&many, Some("b")),
            "2 meshes have the name 'b': choose one by its number, such as #1"
        );
        assert_eq!(choose(&many, Some("#2")), Ok(2));
        assert_eq!(choose(&many, Some("2")), Ok(2));
        assert!(message(&many, Some("#4")).starts_with("there is no mesh '#4'"));
        assert_eq!(
            message(&root(&[]), None),
            "no mesh of the file has morph targets: export it with shape keys, or give a mesh file with modes"
        );
        assert_eq!(message(&root(&[]), Some("a")), "there is no mesh 'a'; meshes with morph targets: none");
        let long = "x".repeat(1000);
        assert!(message(&root(&[(Some(long.as_str()), 1); 50]), None).len() < 400);
    }
}
