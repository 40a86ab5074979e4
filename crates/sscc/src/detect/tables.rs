//! What no q changes, shared by all clones of a query and by its discrete and continuous searches.

use crate::detect::bd_tree::BdTree;
use crate::detect::buckets::Clusters;
use crate::detect::coarse::Rough;
use crate::detect::contour::Contours;
use crate::detect::quantization::Units;
use crate::detect::vertices::Vertices;
use crate::query::Method;
use crate::query::context::Asked;

#[derive(Default)]
pub(crate) struct Tables {
    pub(crate) vertices: Vertices,
    pub(crate) units: Units,
    pub(crate) rough: Rough,
    pub(crate) clusters: Clusters,
    pub(crate) bd_tree: BdTree,
    /// For exact normal cones only.
    pub(crate) contours: Contours,
}

impl Tables {
    pub(crate) fn new(asked: &Asked<'_>) -> Self {
        let is_lazy = match asked.method {
            Method::BruteForce => return Self::default(),
            Method::Traditional | Method::NormalCones | Method::NormalConesApprox => false,
            Method::Certified | Method::BdTree => true,
        };
        let (model, hierarchy) = (asked.model, &asked.hierarchy);
        let mut clusters = Clusters::new(model.mesh(), hierarchy, &asked.filter);
        let vertices = Vertices::new(model, clusters.all_vertices());
        clusters.renumber(|v| vertices.place(v));
        let is_met = |n| clusters.of_node(n).is_none_or(|cluster| clusters.node(cluster) == n);
        let units = Units::new(model, &vertices);
        let bd_tree = BdTree::new(model, hierarchy, &units, |n| is_lazy && is_met(n));
        let contours = if asked.method == Method::NormalCones {
            Contours::new(model.mesh(), hierarchy, &asked.filter, &vertices, is_met)
        } else {
            Contours::default()
        };
        let rough = match asked.method {
            // Normals are made from exact positions, and then boxes are, too.
            Method::NormalCones | Method::NormalConesApprox => Rough::default(),
            _ => Rough::new(&units, &clusters, &vertices),
        };
        Self { vertices, units, rough, clusters, bd_tree, contours }
    }
}
