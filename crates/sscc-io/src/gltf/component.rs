//! Number types of a glTF file.

/// Number type; all are little endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    /// Returns the type with this OpenGL number.
    pub fn from_code(code: u32) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    /// Size of one number in bytes.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// Whether indices may be of this type.
    pub fn is_index(self) -> bool {
        matches!(self, Self::U8 | Self::U16 | Self::U32)
    }

    /// Decodes one number from its bytes ([`Component::size`] of them). Normalized integers are divided by the largest
    /// of their type, in f64; the smallest signed integer counts as -1.
    pub fn decode(self, bytes: &[u8], normalized: bool) -> f64 {
        let byte = |at: usize| bytes.get(at).copied().unwrap_or_default();
        let (two, four) = ([byte(0), byte(1)], [byte(0), byte(1), byte(2), byte(3)]);
        let (value, largest): (f64, f64) = match self {
            Self::I8 => (i8::from_le_bytes([byte(0)]).into(), i8::MAX.into()),
            Self::U8 => (byte(0).into(), u8::MAX.into()),
            Self::I16 => (i16::from_le_bytes(two).into(), i16::MAX.into()),
            Self::U16 => (u16::from_le_bytes(two).into(), u16::MAX.into()),
            Self::U32 => (u32::from_le_bytes(four).into(), u32::MAX.into()),
            Self::F32 => return f32::from_le_bytes(four).into(),
        };
        if normalized { (value / largest).max(-1.0) } else { value }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_decoded_by_the_standard() {
        use Component::*;
        let f32_bytes = 0.1_f32.to_le_bytes();
        for (component, bytes, plain, normalized) in [
            (I8, &[0x80][..], -128.0, -1.0),
            (I8, &[127], 127.0, 1.0),
            (U8, &[51], 51.0, 0.2),
            (I16, &[0, 0x80], -32768.0, -1.0),
            (U16, &[0xff, 0xff], 65535.0, 1.0),
            (U32, &[1, 0, 0, 0x80], 2147483649.0, 2147483649.0 / 4294967295.0),
            (F32, &f32_bytes, f64::from(0.1_f32), f64::from(0.1_f32)),
        ] {
            assert_eq!(bytes.len(), component.size());
            assert_eq!(component.decode(bytes, false), plain, "{component:?}");
            assert_eq!(component.decode(bytes, true), normalized, "{component:?}");
        }
        assert_eq!(Component::from_code(5124), None);
        assert_eq!(Component::from_code(5130), None);
    }
}
