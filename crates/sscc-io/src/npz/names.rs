//! Names of the arrays that hold the parts of a model.

/// Part of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Part {
    Mean,
    /// Modes along the last axis, or along the first if only that fits.
    Modes,
    /// Modes along the first axis, as in scikit-learn's PCA.
    Components,
    Faces,
    /// One number for each mode.
    Weights,
}

const NAMES: [(Part, &[&str]); 5] = [
    (Part::Mean, &["mean", "mean_", "vertices", "v_template", "rest_positions"]),
    (Part::Modes, &["modes", "shapedirs", "U", "basis"]),
    (Part::Components, &["components", "components_"]),
    (Part::Faces, &["faces", "f", "triangles"]),
    (Part::Weights, &["weights", "explained_variance", "explained_variance_", "eigenvalues"]),
];

impl Part {
    /// Returns the part that an array of this name holds, if any.
    pub fn of(name: &str) -> Option<Self> {
        NAMES.iter().find(|(_, names)| names.contains(&name)).map(|(part, _)| *part)
    }

    /// Returns all names of a part, for messages.
    pub fn names(self) -> String {
        let names = NAMES.iter().find(|(part, _)| *part == self).map(|(_, names)| *names);
        names.unwrap_or_default().join(", ")
    }
}
