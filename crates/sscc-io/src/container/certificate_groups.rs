//! Groups of triangles in certificate files: the optional tensors `groups` and `group_pairs`.

use sscc::parts::GroupTable;
use sscc::{ContactFilter, TriangleGroups};

use super::{ANY, Container, ContainerWriter};
use crate::error::quoted;
use crate::{FormatError, Place};

/// Tensor: the group of each triangle.
pub(super) const GROUPS: &str = "groups";

/// Name of the tensor of the listed pairs of groups, and of the text that states whether they are ignored or counted.
pub(super) const PAIRS: &str = "group_pairs";

/// Value of the text: listed pairs do not count.
const IGNORED: &str = "ignored";

/// Value of the text: only listed pairs count.
const COUNTED: &str = "counted";

/// The first version with groups.
pub(super) const VERSION: u32 = 5;

/// Writes the groups of a filter, if it has any.
pub(super) fn write(writer: &mut ContainerWriter, filter: &ContactFilter) {
    let Some(groups) = filter.groups() else { return };
    let table = GroupTable::from(&**groups);
    let of_triangles: Vec<u32> = table.of_triangles.iter().map(|group| u32::from(*group)).collect();
    let pairs: Vec<u32> = table.listed.as_flattened().iter().map(|group| u32::from(*group)).collect();
    writer
        .text(PAIRS, if table.others_count { IGNORED } else { COUNTED })
        .u32(GROUPS, &[of_triangles.len()], &of_triangles)
        .u32(PAIRS, &[pairs.len() / 2, 2], &pairs);
}

/// Adds the groups of a file, if it has any, to a filter.
pub(super) fn read(file: &Container<'_>, filter: ContactFilter) -> Result<ContactFilter, FormatError> {
    let Some(name) = file.names().into_iter().find(|name| name == GROUPS || name == PAIRS) else {
        return Ok(filter);
    };
    if file.version() < VERSION {
        return Err(FormatError::new(Place::Tensor(name), "not known in this version of the format"));
    }
    let (of_triangles, pairs) = (file.u32(GROUPS)?.shaped(&[ANY])?, file.u32(PAIRS)?.shaped(&[ANY, 2])?);
    let groups = TriangleGroups::new(&of_triangles.values);
    let groups = groups.map_err(|error| of_triangles.refused(error.to_string()))?;
    let listed: &[[u32; 2]] = pairs.values.as_chunks().0;
    if !listed.is_sorted_by(|a, b| a < b) || listed.iter().any(|[g, h]| g > h) {
        return Err(pairs.refused("pairs are not in order"));
    }
    let groups = match file.text(PAIRS)? {
        IGNORED => groups.ignoring(listed.iter().copied()),
        COUNTED => groups.only(listed.iter().copied()),
        other => {
            let cause = format!("{} is not known in this version of the format", quoted(other));
            return Err(FormatError::new(Place::Key(PAIRS.into()), cause));
        }
    };
    Ok(filter.with_groups(groups.map_err(|error| pairs.refused(error.to_string()))?))
}
