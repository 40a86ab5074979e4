//! The methods by which a query finds colliding pairs.

use crate::detect::layout::Needs;

/// The method by which a query finds the colliding pairs. All methods find the same pairs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Certificates of nodes and node pairs cull the traversal of a BD-tree (paper, Algorithm 1): BD-tree AABBs for
    /// nodes down to buckets of at most 64 triangles, tight ones below.
    Certified,
    /// The same BD-tree without certificates (James and Pai 2004).
    BdTree,
    /// All boxes refitted, no certificates: the paper's "traditional" method.
    Traditional,
    /// The traditional method that does not open a node whose normals and boundary prove that it is free (normal cones with
    /// the contour test, Volino and Magnenat-Thalmann 1994). Normals at the start and the end of a motion prove nothing in between, so
    /// continuous queries are traditional.
    NormalCones,
    /// Tests of every pair of triangles, in quadratic time: the oracle of the other methods.
    BruteForce,
}

names! { Method, "method":
    Certified = "certified",
    BdTree = "bdtree",
    Traditional = "traditional",
    NormalCones = "normal-cones",
    BruteForce = "brute-force",
}

impl Method {
    /// Returns the parts of the layout that the method needs; `None` for brute force.
    pub(super) fn needs(self) -> Option<Needs> {
        match self {
            Self::Certified | Self::BdTree => Some(Needs::LAZY),
            Self::Traditional => Some(Needs::REFIT),
            Self::NormalCones => Some(Needs::NORMALS),
            Self::BruteForce => None,
        }
    }

    /// Whether AABBs are computed only when the traversal visits their nodes.
    pub(super) fn is_lazy(self) -> bool {
        matches!(self, Self::Certified | Self::BdTree)
    }
}
