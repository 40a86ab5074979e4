//! Content of an accessor: the shape of its items and the number types that the format allows for it.

use super::component::Component;
use super::json::Kind;

/// Use of an accessor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// Positions or displacements of vertices.
    Positions,
    /// Indices of vertices.
    Indices,
    /// Times of key frames.
    KeyTimes,
    /// Translations or scales at key frames.
    KeyVectors,
    /// Rotations at key frames: quaternions x, y, z, w.
    KeyRotations,
    /// Weights of morph targets at key frames.
    KeyWeights,
    /// Joints of vertices.
    Joints,
    /// Skin weights of vertices.
    SkinWeights,
    /// Inverse bind matrices, columns first.
    Matrices,
}

impl Role {
    /// Count of numbers in one item.
    pub fn width(self) -> usize {
        match self {
            Self::Indices | Self::KeyTimes | Self::KeyWeights => 1,
            Self::Positions | Self::KeyVectors => 3,
            Self::KeyRotations | Self::Joints | Self::SkinWeights => 4,
            Self::Matrices => 16,
        }
    }

    fn kind(self) -> Kind {
        match self.width() {
            1 => Kind::Scalar,
            3 => Kind::Vec3,
            4 => Kind::Vec4,
            _ => Kind::Mat4,
        }
    }

    /// Whether items of this kind, with numbers of this type, may have this use.
    pub fn accepts(self, kind: Kind, component: Component, normalized: bool) -> bool {
        use Component::{F32, I8, I16, U8, U16, U32};
        let is_allowed = match (self, component) {
            // Integer positions are those of the extension KHR_mesh_quantization.
            (Self::Positions, _) => component != U32,
            (Self::Indices, _) => component.is_index() && !normalized,
            (Self::Joints, U8 | U16) => !normalized,
            (Self::Joints, _) => false,
            (_, F32) => true,
            (Self::KeyRotations | Self::KeyWeights, I8 | U8 | I16 | U16) => normalized,
            (Self::SkinWeights, U8 | U16) => normalized,
            _ => false,
        };
        is_allowed && kind == self.kind()
    }

    /// Returns the requirement that [`Role::accepts`] checks, for a message.
    pub fn requirement(self) -> &'static str {
        match self {
            Self::Positions => "positions must be VEC3 of float32 (or of 8 or 16 bit integers)",
            Self::Indices => "vertex numbers must be SCALAR of unsigned integers",
            Self::KeyTimes => "times of key frames must be SCALAR of float32",
            Self::KeyVectors => "translations and scales must be VEC3 of float32",
            Self::KeyRotations => {
                "rotations must be VEC4 of float32 (or of normalized integers of 8 or 16 bits)"
            }
            Self::KeyWeights => {
                "weights of morph targets must be SCALAR of float32 (or of normalized integers of 8 or 16 bits)"
            }
            Self::Joints => "joints must be VEC4 of unsigned integers of 8 or 16 bits, not normalized",
            Self::SkinWeights => {
                "skin weights must be VEC4 of float32 (or of normalized unsigned integers of 8 or 16 bits)"
            }
            Self::Matrices => "inverse bind matrices must be MAT4 of float32",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn number_types_are_those_of_the_standard() {
        use Component::*;
        let all = [I8, U8, I16, U16, U32, F32];
        let accepted = |role: Role, normalized: bool| {
            all.into_iter().filter(|c| role.accepts(role.kind(), *c, normalized)).collect::<Vec<_>>()
        };
        for (role, plain, normalized) in [
            (Role::Positions, &[I8, U8, I16, U16, F32][..], &[I8, U8, I16, U16, F32][..]),
            (Role::Indices, &[U8, U16, U32], &[]),
            (Role::KeyTimes, &[F32], &[F32]),
            (Role::KeyVectors, &[F32], &[F32]),
            (Role::KeyRotations, &[F32], &[I8, U8, I16, U16, F32]),
            (Role::KeyWeights, &[F32], &[I8, U8, I16, U16, F32]),
            (Role::Joints, &[U8, U16], &[]),
            (Role::SkinWeights, &[F32], &[U8, U16, F32]),
            (Role::Matrices, &[F32], &[F32]),
        ] {
            assert_eq!(accepted(role, false), plain, "{role:?}");
            assert_eq!(accepted(role, true), normalized, "{role:?}");
            assert!(!role.accepts(Kind::Other, F32, false), "{role:?}");
        }
    }
}
