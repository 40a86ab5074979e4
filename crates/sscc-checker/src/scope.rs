//! The scope of certificates: metric, centre, and which pairs of triangles count.

use crate::container::Container;
use crate::model::{LARGEST, Model};
use crate::refusal::{Result, input, require};

/// The largest number of modes of a dense metric, whose factor takes a time cubic in it.
const MAX_DENSE: usize = 1024;

/// Metric, centre and contact filter of certificates.
pub(crate) struct Scope {
    /// The factor S: its diagonal, or the whole upper triangular matrix by rows.
    pub(crate) factor: Vec<f64>,
    pub(crate) is_dense: bool,
    pub(crate) center: Vec<f64>,
    /// Whether pairs with exactly one common vertex count.
    pub(crate) one_vertex: bool,
    pub(crate) weld: bool,
    pub(crate) ignored: Vec<[u32; 2]>,
    pub(crate) exceptions: Vec<[u32; 2]>,
    pub(crate) groups: Option<Groups>,
}

/// The group of each triangle, and the pairs of groups that count or do not count.
pub(crate) struct Groups {
    pub(crate) of_triangles: Vec<u32>,
    pub(crate) others_count: bool,
    pub(crate) listed: Vec<[u32; 2]>,
}

impl Scope {
    pub(crate) fn read(file: &Container<'_>, model: &Model) -> Result<Self> {
        require(!file.has("clearance"), "certificates with a clearance are not checked")?;
        let rank = model.rank;
        let is_dense = file.has("metric_factor");
        let (name, axes) = if is_dense { ("metric_factor", 2) } else { ("metric_scales", 1) };
        let factor = file.reals(name, &vec![Some(rank); axes])?;
        require(!is_dense || rank <= MAX_DENSE, "metric: it is dense, and has more than 1024 rows")?;
        let is_row = |i: usize| {
            let row = &factor[i * rank..][..rank];
            let is_in_range = row[i] >= LARGEST.recip() && row.iter().all(|s| s.abs() <= LARGEST);
            is_in_range && row[..i].iter().all(|s| *s == 0.0)
        };
        let is_scale = |s: &f64| *s > 0.0 && s.is_finite();
        let is_factor = if is_dense { (0..rank).all(is_row) } else { factor.iter().all(is_scale) };
        let center = file.reals("center", &[Some(rank)])?;
        let is_finite = center.iter().all(|x| x.is_finite());
        require(is_factor && is_finite, "metric or centre: a number is out of range")?;
        let one_vertex = is_second(file, "neighbours", ["exclude", "include-one-vertex"])?;
        let weld = is_second(file, "weld", ["none", "equal"])?;
        let triangles = model.faces.len();
        let pairs = |name: &str| if file.has(name) { file.pairs(name) } else { Ok(Vec::new()) };
        let (ignored, exceptions) = (pairs("ignored")?, pairs("exceptions")?);
        let is_pair = |[a, b]: &[u32; 2]| a != b && (*b as usize) < triangles;
        let are_pairs = ignored.iter().chain(&exceptions).all(is_pair);
        require(are_pairs, "a pair names a triangle that does not exist, or one twice")?;
        let mut groups = None;
        if file.has("groups") {
            let others_count = is_second(file, "group_pairs", ["counted", "ignored"])?;
            let of_triangles = file.integers("groups", &[Some(triangles)])?;
            groups = Some(Groups { of_triangles, others_count, listed: file.pairs("group_pairs")? });
        }
        Ok(Self { factor, is_dense, center, one_vertex, weld, ignored, exceptions, groups })
    }

    /// Returns the group of a triangle, if there are groups.
    pub(crate) fn group(&self, t: u32) -> Option<u32> {
        self.groups.as_ref().map(|groups| groups.of_triangles[t as usize])
    }

    /// Whether triangles of two groups count; they do if the groups are not known.
    pub(crate) fn groups_count(&self, g: Option<u32>, h: Option<u32>) -> bool {
        let (Some(groups), Some(g), Some(h)) = (&self.groups, g, h) else { return true };
        groups.listed.binary_search(&[g.min(h), g.max(h)]).is_ok() != groups.others_count
    }

    /// Returns which pairs of triangles do not count, as text.
    pub(crate) fn left_out(&self) -> String {
        let vertices = if self.one_vertex { "two common vertices" } else { "common vertices" };
        let welded = if self.weld { " (equal ones are welded)" } else { "" };
        let [exceptions, ignored] = [&self.exceptions, &self.ignored].map(Vec::len);
        let groups = match &self.groups {
            None => "no groups".to_owned(),
            Some(Groups { others_count: true, listed, .. }) => format!("{} pairs of groups", listed.len()),
            Some(Groups { listed, .. }) => format!("all pairs of groups but {}", listed.len()),
        };
        format!("pairs with {vertices}{welded}, {exceptions} exceptions, {ignored} ignored pairs, {groups}")
    }
}

/// Whether a text of the file is the second of two possible values.
fn is_second(file: &Container<'_>, key: &str, values: [&str; 2]) -> Result<bool> {
    let which = values.iter().position(|value| Ok(*value) == file.text(key));
    which.map_or_else(|| input(format!("text '{key}' is missing or not known")), |which| Ok(which == 1))
}

#[cfg(test)]
impl Scope {
    /// Returns the default scope about 0, with the factor of a diagonal or of a dense metric.
    pub(crate) fn of_factor(factor: Vec<f64>, rank: usize) -> Self {
        Self {
            is_dense: factor.len() != rank,
            factor,
            center: vec![0.0; rank],
            one_vertex: false,
            weld: false,
            ignored: Vec::new(),
            exceptions: Vec::new(),
            groups: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pairs_that_do_not_count_are_stated() {
        let mut scope = Scope::of_factor(vec![1.0], 1);
        assert_eq!(scope.left_out(), "pairs with common vertices, 0 exceptions, 0 ignored pairs, no groups");
        (scope.weld, scope.one_vertex) = (true, true);
        (scope.ignored, scope.exceptions) = (vec![[0, 1]], vec![[0, 2], [1, 2]]);
        let groups = |others_count| Groups { of_triangles: vec![0; 3], others_count, listed: vec![[0, 0]] };
        scope.groups = Some(groups(true));
        let vertices = "pairs with two common vertices (equal ones are welded)";
        assert_eq!(scope.left_out(), format!("{vertices}, 2 exceptions, 1 ignored pairs, 1 pairs of groups"));
        scope.groups = Some(groups(false));
        assert!(scope.left_out().ends_with(", all pairs of groups but 1"));
    }
}
