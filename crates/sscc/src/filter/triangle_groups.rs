//! Groups of triangles, and a table of the pairs of groups that count.

use std::sync::Arc;

use crate::Error;

/// The group of each triangle, and which pairs of groups count: two triangles count only if the pair of their groups
/// does. The table is symmetric. Equal tables are equal values, however they were made.
///
/// ```
/// use sscc::TriangleGroups;
///
/// # fn main() -> Result<(), sscc::Error> {
/// // Two triangles of a body, one of a shirt, one of its buttons.
/// let groups = TriangleGroups::new(&[0, 0, 1, 2])?.ignoring([[0, 0], [1, 2]])?;
/// assert!(!groups.is_pair_counted(0, 1) && groups.is_pair_counted(0, 2) && !groups.is_pair_counted(2, 3));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct TriangleGroups {
    of_triangle: Vec<u16>,
    /// Whether pairs of groups that are not listed count. Listed pairs count if the others do not.
    others_count: bool,
    /// For each group g the start of its groups in `partners`, and the end.
    starts: Vec<usize>,
    /// For each group g, the groups that it is listed with: `partners[starts[g]..starts[g + 1]]`, ascending. At most half of
    /// all pairs are listed.
    partners: Vec<u16>,
    /// Shared by the meshes between which the table also holds.
    scene: Option<Arc<()>>,
}

/// The contents of [`TriangleGroups`], for writing files.
#[derive(Clone, Debug)]
pub struct GroupTable<'a> {
    /// The group of each triangle.
    pub of_triangles: &'a [u16],
    /// The number of groups: one more than the largest group of a triangle.
    pub count: usize,
    /// Whether pairs of groups that are not listed count.
    pub others_count: bool,
    /// The listed pairs of groups `a <= b`, sorted: those that do not count if the others do, else those that count.
    pub listed: Vec<[u16; 2]>,
}

impl<'a> From<&'a TriangleGroups> for GroupTable<'a> {
    fn from(groups: &'a TriangleGroups) -> Self {
        let listed = groups.listed().map(|(g, h)| [g, h]).collect();
        Self {
            of_triangles: groups.of_triangles(),
            count: groups.group_count(),
            others_count: groups.others_count(),
            listed,
        }
    }
}

/// Whether the groups hold between meshes is no part of the value: files do not store it.
impl PartialEq for TriangleGroups {
    fn eq(&self, other: &Self) -> bool {
        let Self { of_triangle, others_count, starts, partners, scene: _ } = self;
        (of_triangle, others_count, starts, partners)
            == (&other.of_triangle, &other.others_count, &other.starts, &other.partners)
    }
}

impl Eq for TriangleGroups {}

impl TriangleGroups {
    /// The maximum number of groups: a triangle stores its group in 16 bits.
    pub const MAX_GROUPS: usize = 1 << 16;

    /// Creates groups from the group number of each triangle, from 0. All pairs count.
    ///
    /// # Errors
    /// If a number is 65,536 or larger.
    pub fn new(of_triangle: &[u32]) -> Result<Self, Error> {
        if let Some(triangle) = of_triangle.iter().position(|group| *group as usize >= Self::MAX_GROUPS) {
            let group = of_triangle[triangle];
            return Err(refused(format!(
                "triangle {triangle} (counted from 0) is in group {group}: at most {} groups are supported, \
                 numbered from 0",
                Self::MAX_GROUPS
            )));
        }
        let count = of_triangle.iter().max().map_or(0, |largest| *largest as usize + 1);
        let of_triangle = of_triangle.iter().map(|group| *group as u16).collect();
        Ok(Self {
            of_triangle,
            others_count: true,
            starts: vec![0; count + 1],
            partners: Vec::new(),
            scene: None,
        })
    }

    /// Returns the same groups, with a table in which pairs of triangles within one group do not count either.
    #[must_use]
    pub fn between_only(self) -> Self {
        let within: Vec<(u16, u16)> = (0..self.group_count()).map(|g| (g as u16, g as u16)).collect();
        self.without(&within)
    }

    /// Returns the same groups, with a table in which these pairs do not count either (in any order; `[a, a]` is the pairs within
    /// group a).
    ///
    /// # Errors
    /// If a group number is larger than those of all triangles.
    pub fn ignoring(self, pairs: impl IntoIterator<Item = [u32; 2]>) -> Result<Self, Error> {
        let pairs = self.check(pairs)?;
        Ok(self.without(&pairs))
    }

    /// Returns the same groups, with a table in which only these pairs count.
    ///
    /// # Errors
    /// Those of [`TriangleGroups::ignoring`].
    pub fn only(self, pairs: impl IntoIterator<Item = [u32; 2]>) -> Result<Self, Error> {
        let pairs = self.check(pairs)?;
        Ok(self.with_table(false, pairs))
    }

    /// Splits the groups of the triangles of several meshes, one mesh after the other, into the groups of each mesh: `counts` are
    /// the numbers of triangles. Between two of these meshes, too, triangles count only if the pair of their groups does
    /// ([`Detector::against`] and the other queries of two detectors).
    ///
    /// ```
    /// use sscc::glam::DVec3;
    /// use sscc::{ContactFilter, Detector, TriMesh, TriangleGroups};
    ///
    /// # fn main() -> Result<(), sscc::Error> {
    /// // A body, and a shirt that it may touch, at the same place.
    /// let scene = TriangleGroups::new(&[0, 1])?.ignoring([[0, 1]])?;
    /// let mesh = TriMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]])?;
    /// let detector = |groups| Detector::with_filter(&mesh, &ContactFilter::default().with_groups(groups));
    /// let mut groups = scene.of_meshes(&[1, 1])?.into_iter();
    /// let (body, shirt) = (groups.next().unwrap(), groups.next().unwrap());
    /// let (x, mut body, mut shirt) = (mesh.rest_positions(), detector(body)?, detector(shirt)?);
    /// assert!(body.against(x, &mut shirt, x)?.is_empty());
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// If the meshes together have another number of triangles.
    ///
    /// [`Detector::against`]: crate::Detector::against
    pub fn of_meshes(&self, counts: &[usize]) -> Result<Vec<Self>, Error> {
        let sum = counts.iter().try_fold(0_usize, |sum, count| sum.checked_add(*count));
        if sum != Some(self.of_triangle.len()) {
            let found = self.of_triangle.len();
            let sum = sum.map_or_else(|| "too many".to_owned(), |sum| sum.to_string());
            return Err(refused(format!("there are groups of {found} triangles, but the meshes have {sum}")));
        }
        let (mut rest, scene) = (&self.of_triangle[..], Some(Arc::new(())));
        let mesh = |count: &usize| {
            let (of_triangle, after) = rest.split_at(*count);
            rest = after;
            let (starts, partners) = (self.starts.clone(), self.partners.clone());
            let of_triangle = of_triangle.to_vec();
            Self { of_triangle, others_count: self.others_count, starts, partners, scene: scene.clone() }
        };
        Ok(counts.iter().map(mesh).collect())
    }

    /// Whether the table holds between these two meshes.
    pub(crate) fn is_common_with(&self, other: &Self) -> bool {
        let is_same = |(one, two)| with_mutant!(Arc::ptr_eq(one, two), GroupsOfOtherScenes, true);
        self.scene.as_ref().zip(other.scene.as_ref()).is_some_and(is_same)
    }

    /// Returns the group of each triangle.
    pub(crate) fn of_triangles(&self) -> &[u16] {
        &self.of_triangle
    }

    /// Returns the number of groups: one more than the largest group of a triangle.
    pub(crate) fn group_count(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether pairs of groups that are not listed count.
    pub(crate) fn others_count(&self) -> bool {
        self.others_count
    }

    /// Returns the listed pairs of groups `a <= b`, sorted: those that do not count if the others do, else those that count.
    pub(crate) fn listed(&self) -> impl Iterator<Item = (u16, u16)> {
        let row = |g: usize| &self.partners[self.starts[g]..self.starts[g + 1]];
        (0..self.group_count())
            .flat_map(move |g| row(g).iter().filter(move |h| **h as usize >= g).map(move |h| (g as u16, *h)))
    }

    /// Whether triangles of these two groups count.
    #[inline]
    pub(crate) fn is_counted(&self, g: u16, h: u16) -> bool {
        let [start, end] = [0, 1].map(|next| self.starts[g as usize + next]);
        self.partners[start..end].binary_search(&h).is_ok() != self.others_count
    }

    /// Whether two triangles count, by their groups.
    ///
    /// # Panics
    /// When there are no groups of such triangles.
    #[inline]
    pub fn is_pair_counted(&self, a: u32, b: u32) -> bool {
        self.is_counted(self.of_triangle[a as usize], self.of_triangle[b as usize])
    }

    /// Whether every pair of groups counts.
    pub(crate) fn is_all_counted(&self) -> bool {
        self.others_count && self.partners.is_empty()
    }

    /// Checks that the groups exist, and returns the pairs in 16 bits, the lower number first.
    fn check(&self, pairs: impl IntoIterator<Item = [u32; 2]>) -> Result<Vec<(u16, u16)>, Error> {
        let count = self.group_count();
        let checked = pairs.into_iter().map(|[a, b]| match a.max(b) {
            largest if largest as usize >= count => {
                let known = match count {
                    0 => "there are no triangles".to_owned(),
                    _ => format!("those of the triangles are 0 to {}", count - 1),
                };
                Err(refused(format!("group {largest} does not exist: {known}")))
            }
            _ => Ok((a.min(b) as u16, a.max(b) as u16)),
        });
        checked.collect()
    }

    /// Returns the same groups, with a table in which these pairs do not count either.
    fn without(self, pairs: &[(u16, u16)]) -> Self {
        let mut listed: Vec<(u16, u16)> = self.listed().collect();
        if self.others_count {
            listed.extend_from_slice(pairs);
        } else {
            let mut removed = pairs.to_vec();
            removed.sort_unstable();
            listed.retain(|pair| removed.binary_search(pair).is_err());
        }
        let others_count = self.others_count;
        self.with_table(others_count, listed)
    }

    /// Returns the same groups with the table of these listed pairs. The others are listed instead if the listed pairs
    /// are more than half of all, or exactly half and the others do not count.
    fn with_table(self, others_count: bool, mut listed: Vec<(u16, u16)>) -> Self {
        let count = self.group_count();
        listed.sort_unstable();
        listed.dedup();
        let (all, twice) = (count as u64 * (count as u64 + 1) / 2, 2 * listed.len() as u64);
        let is_short = twice < all || (twice == all && others_count);
        if !is_short {
            let pairs = (0..count).flat_map(|g| (g..count).map(move |h| (g as u16, h as u16)));
            listed = pairs.filter(|pair| listed.binary_search(pair).is_err()).collect();
        }
        let mut both: Vec<(u16, u16)> = listed.iter().flat_map(|&(g, h)| [(g, h), (h, g)]).collect();
        both.sort_unstable();
        both.dedup();
        let mut starts = vec![0; count + 1];
        both.iter().for_each(|(g, _)| starts[*g as usize + 1] += 1);
        (0..count).for_each(|g| starts[g + 1] += starts[g]);
        Self {
            of_triangle: self.of_triangle,
            others_count: others_count == is_short,
            starts,
            partners: both.into_iter().map(|(_, h)| h).collect(),
            scene: self.scene,
        }
    }
}

fn refused(what: String) -> Error {
    Error::Groups { what }
}

#[cfg(test)]
mod tests;
