//! Reader for VegaFEM's modal matrices.
//!
//! Layout, little endian: rows m = 3V (i32), columns r (i32), then m r numbers, column after column. The ending of the
//! file name gives the type, float64 or float32; the size must agree.

use sscc::Modes;

use super::mesh_mismatch::mesh_mismatch;
use crate::{FormatError, Place};

/// Type of the entries, by the ending of the file name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// `*.float`
    Single,
    /// `*.U`, `*.Ulinear`, `*.Unonlinear`, `*.URendering`
    Double,
}

impl Precision {
    /// Size of one entry in bytes.
    fn size(self) -> u64 {
        match self {
            Self::Single => 4,
            Self::Double => 8,
        }
    }
}

/// Size of the header in bytes.
const HEADER: usize = 8;

/// Parses a modal matrix for a mesh with this number of vertices.
///
/// # Errors
/// When the size of the file does not agree with its header and the precision, the modes belong to a mesh with
/// another number of vertices, there are none, or [`Modes::new`] rejects an entry.
#[expect(clippy::unreachable, reason = "8 bytes are two chunks of 4 bytes")]
pub fn parse(bytes: &[u8], precision: Precision, vertices: usize) -> Result<Modes, FormatError> {
    let Some((header, body)) = bytes.split_first_chunk::<HEADER>() else {
        return Err(FormatError::new(Place::Byte(bytes.len()), "the file ends within the header"));
    };
    let [rows, rank] = header.as_chunks::<4>().0 else { unreachable!("8 bytes are two chunks of 4 bytes") };
    let [rows, rank] = [("rows", 0, *rows), ("columns", 4, *rank)].map(|(what, at, bytes)| {
        u32::try_from(i32::from_le_bytes(bytes)).map_err(|_| {
            FormatError::new(Place::Byte(at), format!("a negative number of {what}: is this a modal matrix?"))
        })
    });
    let (rows, rank) = (rows?, rank?);
    check_size(u64::from(rows) * u64::from(rank), body.len() as u64, precision, [rows, rank])?;
    let (rows, rank) = (rows as usize, rank as usize);
    if vertices.checked_mul(3) != Some(rows) {
        return Err(mesh_mismatch(rows, vertices));
    }
    Ok(match precision {
        Precision::Double => {
            let values = body.as_chunks::<8>().0;
            Modes::from_matrix(vertices, rank, |row, k| f64::from_le_bytes(values[k * rows + row]))
        }
        Precision::Single => {
            let values = body.as_chunks::<4>().0;
            Modes::from_matrix(vertices, rank, |row, k| f32::from_le_bytes(values[k * rows + row]).into())
        }
    }?)
}

fn check_size(entries: u64, found: u64, precision: Precision, shape: [u32; 2]) -> Result<(), FormatError> {
    // Two i32 give up to 2^62 entries of at most 8 bytes, which may exceed 2^64 bytes.
    let has_size = |precision: Precision| entries.checked_mul(precision.size()) == Some(found);
    if has_size(precision) && entries > 0 {
        return Ok(());
    }
    let [rows, rank] = shape;
    let cause = if entries == 0 {
        format!("a modal matrix of {rows} rows and {rank} columns is empty")
    } else if precision == Precision::Double && has_size(Precision::Single) {
        "its size fits float32 numbers, but its name means float64: rename it to end in .float".into()
    } else if precision == Precision::Single && has_size(Precision::Double) {
        "its size fits float64 numbers, but its name means float32: rename it to end in .U".into()
    } else {
        format!(
            "the header declares {rows} rows and {rank} columns of {}-byte numbers, but {found} bytes follow: \
             is the file cut off?",
            precision.size()
        )
    };
    Err(FormatError::new(Place::Byte(HEADER), cause))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn file(rows: i32, rank: i32, body: &[u8]) -> Vec<u8> {
        [&rows.to_le_bytes()[..], &rank.to_le_bytes(), body].concat()
    }

    fn doubles(count: usize) -> Vec<u8> {
        (0..count).flat_map(|i| (i as f64).to_le_bytes()).collect()
    }

    #[test]
    fn columns_are_modes() {
        let modes = parse(&file(6, 2, &doubles(12)), Precision::Double, 2).unwrap();
        assert_eq!((modes.rank(), modes.of_vertex(1)[1]), (2, DVec3::new(9.0, 10.0, 11.0)));
        let singles: Vec<u8> = (0..12).flat_map(|i| (i as f32).to_le_bytes()).collect();
        assert_eq!(parse(&file(6, 2, &singles), Precision::Single, 2).unwrap(), modes);
    }

    #[test]
    fn errors_name_the_cause() {
        let message = |bytes: &[u8], precision| parse(bytes, precision, 2).unwrap_err().to_string();
        let double = file(6, 2, &doubles(12));
        assert!(message(&double, Precision::Single).contains("rename it to end in .U"));
        assert!(message(&file(6, 2, &doubles(6)), Precision::Double).contains("rename it to end in .float"));
        let other = message(&file(9, 2, &doubles(18)), Precision::Double);
        assert_eq!(other, "the modes are for 3 vertices, the mesh has 2: are they of another mesh?");
        assert!(message(&file(6, 0, &[]), Precision::Double).contains("is empty"));
        assert!(message(&file(0, 6, &[]), Precision::Double).contains("is empty"));
        assert!(message(&file(-6, 2, &doubles(12)), Precision::Double).contains("a negative number of rows"));
        assert!(
            message(&file(6, -2, &doubles(12)), Precision::Double).contains("a negative number of columns")
        );
        assert!(
            message(&file(i32::MAX, i32::MAX, &doubles(12)), Precision::Double).contains("96 bytes follow")
        );
        let nan = file(6, 1, &[&doubles(5)[..], &f64::NAN.to_le_bytes()].concat());
        assert!(message(&nan, Precision::Double).starts_with("mode 0 of vertex 1 "));
    }

    #[test]
    fn truncations_and_extra_bytes_are_rejected() {
        let bytes = file(6, 2, &doubles(12));
        for len in 0..bytes.len() {
            assert!(parse(&bytes[..len], Precision::Double, 2).is_err(), "{len}");
        }
        assert!(parse(&[&bytes[..], b"\0"].concat(), Precision::Double, 2).is_err());
    }
}
