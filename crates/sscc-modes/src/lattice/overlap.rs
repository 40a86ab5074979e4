//! Overlap with boxes, generously: what touches overlaps, and rounding never hides an overlap of the enlarged box.

use glam::DVec3;

/// Whether a triangle overlaps the box around `centre` with the half sides `half` (separating axes).
pub(super) fn triangle_box(corners: [DVec3; 3], centre: DVec3, half: DVec3) -> bool {
    let p = corners.map(|c| c - centre);
    let low = p[0].min(p[1]).min(p[2]);
    let high = p[0].max(p[1]).max(p[2]);
    if low.cmpgt(half).any() || high.cmplt(-half).any() {
        return false;
    }
    let apart = |axis: DVec3| {
        let along = p.map(|p| axis.dot(p));
        let reach = half.dot(axis.abs());
        let slack = 1e-12 * (reach + along.iter().fold(0.0_f64, |m, x| m.max(x.abs())));
        let (low, high) = (along[0].min(along[1]).min(along[2]), along[0].max(along[1]).max(along[2]));
        low > reach + slack || high < -reach - slack
    };
    let edges = [p[1] - p[0], p[2] - p[1], p[0] - p[2]];
    !apart(edges[0].cross(edges[1]))
        && !edges.iter().any(|edge| DVec3::AXES.iter().any(|axis| apart(axis.cross(*edge))))
}

/// Whether a segment overlaps the box.
pub(super) fn segment_box(ends: [DVec3; 2], centre: DVec3, half: DVec3) -> bool {
    let [a, b] = ends.map(|p| p - centre);
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for axis in 0..3 {
        let (start, step) = (a[axis], b[axis] - a[axis]);
        if step == 0.0 {
            if start.abs() > half[axis] {
                return false;
            }
            continue;
        }
        let (near, far) = ((-half[axis] - start) / step, (half[axis] - start) / step);
        from = from.max(near.min(far));
        to = to.min(near.max(far));
    }
    from <= to + 1e-12
}
