//! Transform of a node relative to its parent: a matrix, or translation, rotation and scale.

use glam::{DMat3, DMat4, DQuat, DVec3};

use super::json::Node;
use super::rotation::unit;

/// Transform as the file stores it.
#[derive(Clone, Copy)]
pub(super) enum Transform {
    Matrix(DMat4),
    Parts(Parts),
}

/// Translation, rotation (a unit quaternion) and scale, applied in reverse order.
#[derive(Clone, Copy)]
pub(super) struct Parts {
    pub translation: DVec3,
    pub rotation: DQuat,
    pub scale: DVec3,
}

impl Transform {
    /// Returns the transform of a node; the matrix counts if the node has both forms. The error is the cause.
    pub fn of(node: &Node) -> Result<Self, &'static str> {
        if let Some(matrix) = &node.matrix {
            let mut matrix = DMat4::from_cols_array(matrix);
            // The format allows no other last row. Players ignore it.
            for (column, last) in [
                (&mut matrix.x_axis, 0.0),
                (&mut matrix.y_axis, 0.0),
                (&mut matrix.z_axis, 0.0),
                (&mut matrix.w_axis, 1.0),
            ] {
                column.w = last;
            }
            return Ok(Self::Matrix(matrix));
        }
        let vector = |stored: &Option<Box<[f64; 3]>>, default| {
            stored.as_ref().map_or(default, |stored| DVec3::from_array(**stored))
        };
        let rotation = match &node.rotation {
            Some(stored) => unit(DQuat::from_array(**stored)).ok_or("its rotation has length 0")?,
            None => DQuat::IDENTITY,
        };
        let translation = vector(&node.translation, DVec3::ZERO);
        Ok(Self::Parts(Parts { translation, rotation, scale: vector(&node.scale, DVec3::ONE) }))
    }

    /// Returns the matrix.
    pub fn matrix(&self) -> DMat4 {
        match self {
            Self::Matrix(matrix) => *matrix,
            Self::Parts(parts) => parts.matrix(),
        }
    }

    /// Returns translation, rotation and scale. Players split matrices like this if an animation moves the node;
    /// shear is lost. None if an axis has length 0.
    pub fn parts(&self) -> Option<Parts> {
        let matrix = match self {
            Self::Parts(parts) => return Some(*parts),
            Self::Matrix(matrix) => matrix,
        };
        let axes = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.truncate());
        let mut scale = DVec3::from_array(axes.map(DVec3::length));
        if scale.min_element() <= 0.0 || !scale.is_finite() {
            return None;
        }
        if DMat3::from_cols(axes[0], axes[1], axes[2]).determinant() < 0.0 {
            scale.x = -scale.x;
        }
        let rotation = DMat3::from_cols(axes[0] / scale.x, axes[1] / scale.y, axes[2] / scale.z);
        let rotation = unit(DQuat::from_mat3(&rotation))?;
        Some(Parts { translation: matrix.w_axis.truncate(), rotation, scale })
    }
}

impl Parts {
    /// Returns the matrix.
    pub fn matrix(&self) -> DMat4 {
        DMat4::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node(json: &str) -> Node {
        serde_json::from_str(json).unwrap()
    }

    #[test]
    fn matrices_split_into_their_parts() {
        let rotation = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -3.0).normalize(), 2.5);
        for scale in [DVec3::new(1.0, 2.0, 3.0), DVec3::new(-1.0, 2.0, 0.5), DVec3::new(-1e-9, -2.0, -1e9)] {
            let parts = Parts { translation: DVec3::new(1.0, -2.0, 3.0), rotation, scale };
            let back = Transform::Matrix(parts.matrix()).parts().unwrap().matrix();
            let error = (back - parts.matrix()).to_cols_array().map(f64::abs).into_iter().fold(0.0, f64::max);
            assert!(error < 1e-14 * scale.abs().max_element(), "{scale}: {error}");
        }
        assert!(Transform::Matrix(DMat4::ZERO).parts().is_none());
    }

    #[test]
    fn the_matrix_counts_before_parts() {
        let both = node(
            r#"{"matrix":[2,0,0,0, 0,2,0,0, 0,0,2,0, 1,2,3,7],"translation":[9,9,9],"rotation":[0,0,0,0]}"#,
        );
        let matrix = Transform::of(&both).ok().unwrap().matrix();
        assert_eq!(matrix.transform_point3(DVec3::ONE), DVec3::new(3.0, 4.0, 5.0));
        assert_eq!(matrix.w_axis.w, 1.0);
        assert_eq!(Transform::of(&node("{}")).ok().unwrap().matrix(), DMat4::IDENTITY);
        assert_eq!(
            Transform::of(&node(r#"{"rotation":[0,0,0,0]}"#)).err(),
            Some("its rotation has length 0")
        );
    }
}
