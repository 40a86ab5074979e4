//! Modes in a NumPy array.

use sscc::Modes;

use super::mesh_mismatch::mesh_mismatch;
use crate::FormatError;
use crate::npy::Array;

/// Returns the modes in an array for a mesh with V `vertices`. The first matching line gives the layout:
///
/// | shape | entry of vertex v, component c, mode k |
/// | --- | --- |
/// | (3V, r) | `[3 v + c, k]` |
/// | (V, 3, r) | `[v, c, k]` |
/// | (r, V, 3) | `[k, v, c]` |
/// | (V, 3) | `[v, c]`, one mode |
/// | (3V) | `[3 v + c]`, one mode |
///
/// Only V = 3 and r = 3 match two lines, (V, 3, r) and (r, V, 3); then the former applies.
///
/// # Errors
/// When no line matches, the array is empty, or [`Modes::new`] rejects the entries.
pub fn from_array(array: &Array, vertices: usize) -> Result<Modes, FormatError> {
    let rows = vertices.saturating_mul(3);
    if array.shape().contains(&0) {
        return Err(FormatError::whole(format!("the array of shape {:?} is empty", array.shape())));
    }
    let modes = match *array.shape() {
        [n, rank] if n == rows => Modes::from_matrix(vertices, rank, |row, k| array.at([row, k])),
        [n, 3, rank] if n == vertices => {
            Modes::from_matrix(vertices, rank, |row, k| array.at([row / 3, row % 3, k]))
        }
        [rank, n, 3] if n == vertices => {
            Modes::from_matrix(vertices, rank, |row, k| array.at([k, row / 3, row % 3]))
        }
        [n, 3] if n == vertices => Modes::from_matrix(vertices, 1, |row, _| array.at([row / 3, row % 3])),
        [n] if n == rows => Modes::from_matrix(vertices, 1, |row, _| array.at([row])),
        [_, n] if n == rows => {
            let cause = format!("shape {:?} has the modes in rows: transpose it to (3V, r)", array.shape());
            return Err(FormatError::whole(cause));
        }
        [n, _] | [n] => return Err(mesh_mismatch(n, vertices)),
        [n, 3, _] | [_, n, 3] => return Err(mesh_mismatch(n.saturating_mul(3), vertices)),
        _ => {
            let cause = format!(
                "shape {:?} is none of (3V, r), (V, 3, r), (r, V, 3), (V, 3) for V = {vertices} vertices",
                array.shape()
            );
            return Err(FormatError::whole(cause));
        }
    };
    Ok(modes?)
}

/// Returns the modes in an array with one mode in each row, as in scikit-learn's `components_`. The first matching line
/// gives the layout; if no row layout matches, the modes may be along the last axis:
///
/// | shape | entry of vertex v, component c, mode k |
/// | --- | --- |
/// | (r, 3V) | `[k, 3 v + c]` |
/// | (r, V, 3) | `[k, v, c]` |
/// | others | as [`from_array`] |
///
/// # Errors
/// As [`from_array`].
pub fn from_rows(array: &Array, vertices: usize) -> Result<Modes, FormatError> {
    match *array.shape() {
        [rank, n] if n == vertices.saturating_mul(3) && n > 0 => {
            Ok(Modes::from_matrix(vertices, rank, |row, k| array.at([k, row]))?)
        }
        [rank, n, 3] if n == vertices && n > 0 => {
            Ok(Modes::from_matrix(vertices, rank, |row, k| array.at([k, row / 3, row % 3]))?)
        }
        _ => from_array(array, vertices),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::npy::{parse, to_bytes};
    use glam::DVec3;

    fn array(shape: &[usize]) -> Array {
        let values: Vec<f64> = (0..shape.iter().product()).map(|i| i as f64).collect();
        parse(&to_bytes(shape, &values).unwrap()).unwrap()
    }

    #[test]
    fn all_layouts_are_read() {
        // Two vertices, four modes.
        let mode_1_of_vertex_1 = |shape: &[usize]| {
            let modes = from_array(&array(shape), 2).unwrap();
            assert_eq!((modes.vertices(), modes.rank()), (2, 4));
            modes.of_vertex(1)[1]
        };
        assert_eq!(mode_1_of_vertex_1(&[6, 4]), DVec3::new(13.0, 17.0, 21.0));
        assert_eq!(mode_1_of_vertex_1(&[2, 3, 4]), DVec3::new(13.0, 17.0, 21.0));
        assert_eq!(mode_1_of_vertex_1(&[4, 2, 3]), DVec3::new(9.0, 10.0, 11.0));
        let one = from_array(&array(&[6]), 2).unwrap();
        assert_eq!((one.rank(), one.of_vertex(1)[0]), (1, DVec3::new(3.0, 4.0, 5.0)));
        assert_eq!(from_array(&array(&[2, 3]), 2).unwrap(), one);
        // Three modes of one vertex: the first layout applies.
        assert_eq!(from_array(&array(&[3, 3]), 1).unwrap().rank(), 3);
    }

    #[test]
    fn vertices_come_first_in_the_ambiguous_shape() {
        let modes = from_array(&array(&[3, 3, 3]), 3).unwrap();
        assert_eq!(modes.of_vertex(1)[2], DVec3::new(11.0, 14.0, 17.0));
    }

    #[test]
    fn rows_are_modes() {
        let mode_1_of_vertex_1 = |shape: &[usize]| from_rows(&array(shape), 2).unwrap().of_vertex(1)[1];
        assert_eq!(mode_1_of_vertex_1(&[4, 6]), DVec3::new(9.0, 10.0, 11.0));
        assert_eq!(mode_1_of_vertex_1(&[4, 2, 3]), DVec3::new(9.0, 10.0, 11.0));
        assert_eq!(mode_1_of_vertex_1(&[6, 6]), DVec3::new(9.0, 10.0, 11.0));
        assert_eq!(mode_1_of_vertex_1(&[6, 4]), DVec3::new(13.0, 17.0, 21.0));
        assert_eq!(mode_1_of_vertex_1(&[2, 3, 4]), DVec3::new(13.0, 17.0, 21.0));
        let square = from_rows(&array(&[3, 3, 3]), 3).unwrap();
        assert_eq!(square.of_vertex(1)[2], DVec3::new(21.0, 22.0, 23.0));
        for shape in [&[0, 6][..], &[6, 0], &[0, 2, 3], &[5, 5]] {
            assert!(from_rows(&array(shape), 2).is_err(), "{shape:?}");
        }
        assert!(from_rows(&array(&[1, 0]), 0).is_err());
    }

    #[test]
    fn errors_name_the_shape() {
        let message =
            |shape: &[usize], vertices| from_array(&array(shape), vertices).unwrap_err().to_string();
        let another = "the modes are for 2 vertices, the mesh has 5: are they of another mesh?";
        for shape in [&[6, 4][..], &[2, 3, 4], &[4, 2, 3], &[6]] {
            assert_eq!(message(shape, 5), another, "{shape:?}");
        }
        assert!(message(&[7, 4], 5).contains("7 rows (no multiple of 3)"));
        assert!(message(&[4, 15], 5).contains("transpose it to (3V, r)"));
        assert!(
            message(&[5, 4, 4], 5).contains("is none of (3V, r), (V, 3, r), (r, V, 3), (V, 3) for V = 5")
        );
        assert!(message(&[], 5).contains("is none of"));
        assert_eq!(message(&[15, 0], 5), "the array of shape [15, 0] is empty");
        assert_eq!(message(&[0, 9], 0), "the array of shape [0, 9] is empty");
        assert!(message(&[3, 3], usize::MAX).contains("another mesh"));
    }

    #[test]
    fn errors_name_entries_out_of_range() {
        for bad in [f64::NAN, f64::INFINITY, 1e61] {
            let mut values = [0.0; 12];
            values[7] = bad;
            let array = parse(&to_bytes(&[6, 2], &values).unwrap()).unwrap();
            let message = from_array(&array, 2).unwrap_err().to_string();
            assert!(message.starts_with("mode 1 of vertex 1 "), "{message}");
        }
    }
}
