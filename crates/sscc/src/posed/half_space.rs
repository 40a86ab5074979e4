//! The vertices of a posed shape below a plane.

use glam::{DVec3, Vec4};

use super::posed_shape::PosedShape;
use crate::arithmetic::check_arithmetic;
use crate::detect::aabb8::AabbF32;
use crate::{Error, limits};

impl PosedShape {
    /// Appends to `found` the used vertices x with `normal . x < height` in the world, ascending. Their heights are
    /// rounded.
    ///
    /// # Errors
    /// When a component of the normal is not finite or beyond [`limits::LARGEST`], the height is not finite, or this thread's
    /// arithmetic is not that of IEEE 754 ([`Error::Arithmetic`]). Then nothing is appended.
    pub fn vertices_below(&mut self, normal: DVec3, height: f64, found: &mut Vec<u32>) -> Result<(), Error> {
        check_arithmetic()?;
        if !limits::contains(normal) {
            let (name, wanted) = ("the normal of a plane", "finite and at most 2^200 (about 1.6e60)");
            let is_outside = |x: &f64| !limits::contains(DVec3::splat(*x));
            let value = normal.to_array().into_iter().find(is_outside).unwrap_or(f64::NAN);
            return Err(Error::Option { name, value, wanted });
        }
        if !height.is_finite() {
            return Err(Error::Option { name: "the height of a plane", value: height, wanted: "finite" });
        }
        let first = found.len();
        self.enter(self.whole);
        let layout = std::sync::Arc::clone(&self.volumes.layout);
        let pose = self.motion.pose[0];
        let local = pose.rotation.transpose() * normal;
        let own_height = height - normal.dot(pose.translation);
        // The plane in the frame of the search. Vertices higher by more than the errors are not below it. The images of
        // vertices are finite.
        let frame = self.volumes.frame();
        let reach = normal.abs().element_sum();
        let error = reach * f64::from(self.volumes.corner_error()) * (1.0 + 1e-6);
        let limit = (height - normal.dot(frame.center())) * frame.scale();
        // The error alone would be enough: it contains more than 270 units of 2^-52 of the largest coordinate in the
        // world, and 16 of 2^-24 of the frame. If the limit is so large that its own rounding is larger, all vertices
        // are on one side of it.
        let rounding =
            64.0 * f64::EPSILON * (reach * frame.center().abs().max_element() * frame.scale() + limit.abs());
        let limit = limit
            + with_mutant!(error, HalfSpaceExact, 0.0)
            + with_mutant!(rounding, HalfSpaceFrameExact, 0.0);
        // A height that overflows in the frame may leave NaN, which would exclude all vertices.
        let limit =
            with_mutant!(if limit.is_nan() { f64::INFINITY } else { limit }, HalfSpaceOverflow, limit);
        let along = |x: Vec4| normal.dot(x.truncate().as_dvec3());
        let spread = |x: Vec4| normal.abs().dot(x.truncate().as_dvec3());
        self.below.clear();
        self.below.push(0);
        while let Some(n) = self.below.pop() {
            self.volumes.update_node(n, &self.motion);
            let AabbF32 { lower, upper } = *self.volumes.node(n);
            if 0.5 * (along(lower) + along(upper) - spread(upper - lower)) > limit {
                continue;
            }
            if let Some(bucket) = layout.buckets.of_node(n) {
                self.volumes.open_bucket(bucket, &self.motion);
                let near = self.volumes.mapped_vertices(bucket).filter(|(_, x)| along(*x) <= limit);
                let [q] = &self.motion.q;
                let below =
                    near.filter(|(v, _)| local.dot(layout.vertices.position(*v, [q])[0]) < own_height);
                found.extend(below.map(|(v, _)| layout.vertices.mesh_vertex(v)));
            } else {
                self.below.extend(self.context.hierarchy.nodes()[n as usize].children());
            }
        }
        // Buckets may have vertices in common, which are then found twice.
        found[first..].sort_unstable();
        let mut kept = first;
        for i in first..found.len() {
            if kept == first || found[kept - 1] != found[i] {
                found[kept] = found[i];
                kept += 1;
            }
        }
        found.truncate(kept);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DQuat};

    use super::*;
    use crate::posed::Pose;
    use crate::test_models::Random;
    use crate::{Certificates, CertifyOptions, Modes, ReducedModel, TriMesh};

    /// The planes contain vertices, or are a little above them.
    #[test]
    fn vertices_just_below_a_plane_are_found() {
        let random = &mut Random(6);
        let positions: Vec<DVec3> = (0..302)
            .map(|i| DVec3::new(f64::from(i / 2) * 0.02, f64::from(i % 2) * 0.03, 0.1 * random.signed()))
            .collect();
        let faces = (0..300).map(|i| [i, i + 1, i + 2]).collect();
        let modes = (0..302 * 5).map(|_| random.vector() * 0.2).collect();
        let mesh = TriMesh::new(positions, faces).unwrap();
        let model = ReducedModel::new(mesh, Modes::new(5, modes).unwrap()).unwrap();
        let options = CertifyOptions::default().budget(0);
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        let mut shape = PosedShape::new(&model, &certificates).unwrap();
        let mut partly = 0;
        for case in 0..400 {
            let q: Vec<f64> = (0..5).map(|_| random.signed()).collect();
            let rotation = DMat3::from_quat(DQuat::from_scaled_axis(random.vector() * 3.0));
            let pose = Pose { rotation, translation: random.vector() * [0.0, 1.0, 100.0][case % 3] };
            shape.place(&q, &pose).unwrap();
            let normal = random.vector().normalize();
            // The heights as the search computes them.
            let local = rotation.transpose() * normal;
            let heights: Vec<f64> = (0..302).map(|v| local.dot(model.position(v, &q))).collect();
            let height = heights[case % 302] + normal.dot(pose.translation) + [0.0, 1e-9, 1e-6][case / 3 % 3];
            let own = height - normal.dot(pose.translation);
            let expected: Vec<u32> = (0..302).filter(|v| heights[*v as usize] < own).collect();
            let mut found = Vec::new();
            shape.vertices_below(normal, height, &mut found).unwrap();
            assert_eq!(found, expected, "case {case}");
            partly += usize::from(!found.is_empty() && found.len() < 302);
        }
        assert!(partly > 300, "{partly}");
    }

    /// Normals have any length, shapes any size, and most planes cut off one end of a long strip: its
    /// vertices are all found, and few buckets are opened.
    #[test]
    fn planes_open_the_buckets_below_them_alone() {
        let random = &mut Random(11);
        let positions: Vec<DVec3> = (0..602)
            .map(|i| DVec3::new(f64::from(i / 2) * 0.02, f64::from(i % 2) * 0.03, 0.01 * random.signed()))
            .collect();
        let faces = (0..600).map(|i| [i, i + 1, i + 2]).collect();
        let bend = |p: &DVec3, k: u32| {
            let angle = 0.05 * f64::from(k) * p.x;
            DVec3::new(0.2 * angle.sin(), angle.cos(), angle.sin()) * 0.05
        };
        let modes = positions.iter().flat_map(|p| (1..6).map(move |k| bend(p, k))).collect();
        let mesh = TriMesh::new(positions, faces).unwrap();
        let model = ReducedModel::new(mesh, Modes::new(5, modes).unwrap()).unwrap();
        let mut shape = PosedShape::without_certificates(&model).unwrap();
        let buckets = shape.context.layout.buckets.count();
        assert!(buckets > 8, "{buckets}");
        let (mut partly, mut opened) = (0, 0);
        for case in 0..240 {
            let q: Vec<f64> = (0..5).map(|_| random.signed()).collect();
            let size = [1.0, 0.01][case % 2];
            let rotation = DMat3::from_quat(DQuat::from_scaled_axis(random.vector() * 3.0)) * size;
            let pose = Pose { rotation, translation: random.vector() * [0.0, 1.0, 100.0][case / 2 % 3] };
            shape.place(&q, &pose).unwrap();
            let length = random.power(-3.0, 3.0);
            let normal = random.vector().normalize() * length;
            // The heights as the search computes them.
            let local = rotation.transpose() * normal;
            let heights: Vec<f64> = (0..602).map(|v| local.dot(model.position(v, &q))).collect();
            let mut sorted = heights.clone();
            sorted.sort_by(f64::total_cmp);
            let offset = [0.0, 1e-9, 1e-6][case / 6 % 3] * length * size;
            let height = sorted[[3, 30, 150][case / 18 % 3]] + normal.dot(pose.translation) + offset;
            let own = height - normal.dot(pose.translation);
            let expected: Vec<u32> = (0..602).filter(|v| heights[*v as usize] < own).collect();
            let mut found = Vec::new();
            shape.vertices_below(normal, height, &mut found).unwrap();
            assert_eq!(found, expected, "case {case}");
            partly += usize::from(!found.is_empty() && found.len() < 602);
            opened += buckets - shape.volumes.closed_buckets();
        }
        assert!(partly > 200 && 2 * opened < 240 * buckets, "{partly} {opened} of {buckets}");
    }

    /// The error has the first component that is out of range.
    #[test]
    fn the_component_of_a_normal_that_is_out_of_range_is_reported() {
        let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let mesh = TriMesh::new(corners.clone(), vec![[0, 1, 2]]).unwrap();
        let model = ReducedModel::new(mesh, Modes::new(1, corners).unwrap()).unwrap();
        let mut shape = PosedShape::without_certificates(&model).unwrap();
        for wrong in [f64::NAN, f64::NEG_INFINITY, 1e61] {
            for axis in 0..3 {
                let mut normal = DVec3::new(1.0, -2.0, 3.0);
                normal[axis] = wrong;
                let error = shape.vertices_below(normal, 0.0, &mut Vec::new()).unwrap_err();
                let is_named =
                    matches!(error, Error::Option { value, .. } if value.to_bits() == wrong.to_bits());
                assert!(is_named, "{error}");
            }
        }
    }

    #[test]
    fn invalid_planes_are_refused() {
        let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let mesh = TriMesh::new(corners.clone(), vec![[0, 1, 2]]).unwrap();
        let model = ReducedModel::new(mesh, Modes::new(1, corners).unwrap()).unwrap();
        let mut shape = PosedShape::without_certificates(&model).unwrap();
        let mut below = |normal: DVec3, height: f64| {
            let mut found = Vec::new();
            let result = shape.vertices_below(normal, height, &mut found);
            assert!(result.is_ok() || found.is_empty());
            result.map(|()| found.len())
        };
        for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e61] {
            for normal in
                [DVec3::new(wrong, 0.0, 1.0), DVec3::new(0.0, wrong, 1.0), DVec3::new(1.0, 0.0, wrong)]
            {
                let error = below(normal, 1.0).unwrap_err().to_string();
                assert!(error.starts_with("the normal of a plane is "), "{error}");
            }
        }
        for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let error = below(DVec3::Z, wrong).unwrap_err().to_string();
            assert!(error.starts_with("the height of a plane is "), "{error}");
        }
        // Planes above and below all vertices, as far away as numbers allow.
        for (height, count) in [(1.0, 3), (f64::MAX, 3), (0.0, 0), (f64::MIN, 0)] {
            assert_eq!(below(DVec3::Z, height), Ok(count), "{height}");
        }
    }
}
