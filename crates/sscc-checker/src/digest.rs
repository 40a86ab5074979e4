//! The digest of model and scope that certificates contain.

use crate::counted::CountedPairs;

/// Returns the BLAKE3 digest of the model and the scope: of named lists one after the other, each with its length; all numbers
/// have 64 bits.
pub(crate) fn digest(CountedPairs { model, scope, classes, .. }: &CountedPairs<'_>) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    let mut list = |name: &str, count: usize, numbers: Vec<u64>| {
        hasher.update(name.as_bytes()).update(&(count as u64).to_le_bytes());
        for number in numbers {
            hasher.update(&number.to_le_bytes());
        }
    };
    let integers = |numbers: &[u32]| numbers.iter().map(|n| u64::from(*n)).collect();
    let reals = |numbers: &[f64]| numbers.iter().map(|x| x.to_bits()).collect();
    let (rank, vertices) = (model.rank, model.positions.len());
    list("faces", model.faces.len(), integers(model.faces.as_flattened()));
    list("positions", vertices, reals(model.positions.as_flattened()));
    list("rank", rank, Vec::new());
    // The modes follow vertex by vertex: three components for each mode.
    let of_vertex =
        |rows: &[f64]| -> Vec<u64> { (0..3 * rank).map(|i| rows[i % 3 * rank + i / 3].to_bits()).collect() };
    list("modes", vertices * rank, model.modes.chunks(3 * rank).flat_map(of_vertex).collect());
    let factor = &scope.factor;
    list(if scope.is_dense { "factor" } else { "scales" }, factor.len(), reals(factor));
    let neighbours = if scope.one_vertex { "include-one-vertex" } else { "exclude-adjacent" };
    list(neighbours, 0, Vec::new());
    if scope.center.iter().any(|x| *x != 0.0) {
        list("center", rank, reals(&scope.center));
    }
    if scope.weld {
        list("weld", classes.len(), integers(classes));
    }
    for (name, pairs) in [("ignored", &scope.ignored), ("exceptions", &scope.exceptions)] {
        if !pairs.is_empty() {
            list(name, pairs.len(), integers(pairs.as_flattened()));
        }
    }
    if let Some(groups) = &scope.groups {
        list("groups", groups.of_triangles.len(), integers(&groups.of_triangles));
        let name = if groups.others_count { "ignored-groups" } else { "only-groups" };
        list(name, groups.listed.len(), integers(groups.listed.as_flattened()));
    }
    *hasher.finalize().as_bytes()
}
