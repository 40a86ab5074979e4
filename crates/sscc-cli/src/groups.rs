//! The groups of triangles of `--ignore-groups`, `--only-groups` and `--group-by`.

use std::path::Path;

use anyhow::{Context, Result, anyhow, ensure};
use sscc::TriangleGroups;
use sscc_io::{GroupsBy, NamedGroups};

use crate::args;

/// Returns the groups of triangles, and which pairs of them count; none without `--ignore-groups` and `--only-groups`.
pub fn groups(files: &args::Model, triangles: usize, typed: &args::Groups) -> Result<Option<TriangleGroups>> {
    let args::Groups { ignore_groups, only_groups, group_by } = typed;
    let flag = match (ignore_groups.is_empty(), only_groups.is_empty()) {
        (true, true) => {
            ensure!(
                group_by.is_none(),
                "--group-by changes nothing without --ignore-groups or --only-groups"
            );
            return Ok(None);
        }
        (false, _) => "--ignore-groups",
        (true, false) => "--only-groups",
    };
    let named = named_groups(files, group_by.as_deref())?;
    let found = named.of_triangle.len();
    ensure!(
        found == triangles,
        "{}: there are groups of {found} triangles, but the model has {triangles}",
        group_by.as_ref().unwrap_or(&files.path).display()
    );
    let pair = |text: &String| named.pair(text).map_err(|cause| anyhow!("{flag} {text}: {cause}"));
    let pairs = ignore_groups.iter().chain(only_groups).map(pair).collect::<Result<Vec<_>>>()?;
    let table = named.to_table()?;
    Ok(Some(if only_groups.is_empty() { table.ignoring(pairs) } else { table.only(pairs) }?))
}

/// Reads the groups of `--group-by`.
fn named_groups(files: &args::Model, typed: Option<&Path>) -> Result<NamedGroups> {
    let by = match typed.map(Path::to_str) {
        None | Some(Some("group")) => GroupsBy::Group,
        Some(Some("object")) => GroupsBy::Object,
        Some(Some("material")) => GroupsBy::Material,
        Some(_) => {
            let numbers = sscc_io::read_group_numbers(typed.unwrap_or(Path::new("")));
            return numbers
                .with_context(|| "--group-by is none of group, object and material, so it must be a file");
        }
    };
    Ok(sscc_io::read_groups(&files.path, files.mesh_name.as_deref(), by)?)
}
