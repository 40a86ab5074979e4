//! The digest of model and scope that certificates contain.

use crate::counted::CountedPairs;

/// Returns the BLAKE3 digest of the model and the scope: of named lists one after the other, each with its length; all numbers
/// have 64 bits.
pub(crate) fn digest(CountedPairs { model, scope, classes, .. }: &CountedPairs<'_>) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    let mut list = |name: &str, count: usize, numbers: &mut dyn Iterator<Item = u64>| {
        hasher.update(name.as_bytes()).update(&(count as u64).to_le_bytes());
        numbers.for_each(|n| {
            hasher.update(&n.to_le_bytes());
        });
    };
    let (rank, vertices) = (model.rank, model.positions.len());
    list("faces", model.faces.len(), &mut integers(model.faces.as_flattened()));
    list("positions", vertices, &mut reals(model.positions.as_flattened()));
    list("rank", rank, &mut std::iter::empty());
    // The modes follow vertex by vertex: three components for each mode.
    let mut modes = (0..vertices).flat_map(|i| {
        let rows = model.modes_of(i);
        (0..rank).flat_map(move |k| (0..3).map(move |c| rows[c * rank + k].to_bits()))
    });
    list("modes", vertices * rank, &mut modes);
    let factor = &scope.factor;
    list(if scope.is_dense { "factor" } else { "scales" }, factor.len(), &mut reals(factor));
    let neighbours = if scope.one_vertex { "include-one-vertex" } else { "exclude-adjacent" };
    list(neighbours, 0, &mut std::iter::empty());
    if scope.center.iter().any(|x| *x != 0.0) {
        list("center", rank, &mut reals(&scope.center));
    }
    if scope.weld {
        list("weld", classes.len(), &mut integers(classes));
    }
    for (name, pairs) in [("ignored", &scope.ignored), ("exceptions", &scope.exceptions)] {
        if !pairs.is_empty() {
            list(name, pairs.len(), &mut integers(pairs.as_flattened()));
        }
    }
    if let Some(groups) = &scope.groups {
        list("groups", groups.of_triangles.len(), &mut integers(&groups.of_triangles));
        let name = if groups.others_count { "ignored-groups" } else { "only-groups" };
        list(name, groups.listed.len(), &mut integers(groups.listed.as_flattened()));
    }
    *hasher.finalize().as_bytes()
}

fn integers(numbers: &[u32]) -> impl Iterator<Item = u64> {
    numbers.iter().map(|n| u64::from(*n))
}

fn reals(numbers: &[f64]) -> impl Iterator<Item = u64> {
    numbers.iter().map(|x| x.to_bits())
}
