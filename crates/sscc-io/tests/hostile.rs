//! Random bytes, and good files with random damage, into every parser: an error or a result, never a panic.

#![allow(clippy::unwrap_used)]

use proptest::prelude::*;
use sscc_io::container::{CERTIFICATES, MODEL, Sealed, certificates_from_bytes, model_from_bytes};
use sscc_io::mesh::{obj, off, ply};
use sscc_io::modes::{array, vega};
use sscc_io::npy;

fn parse_all(bytes: &[u8]) {
    for mesh in [obj::parse(bytes), off::parse(bytes), ply::parse(bytes)] {
        one_line(&mesh);
    }
    for vertices in [0, 1, 3] {
        for precision in [vega::Precision::Single, vega::Precision::Double] {
            one_line(&vega::parse(bytes, precision, vertices));
        }
        match npy::parse(bytes) {
            Ok(read) => one_line(&array::from_array(&read, vertices)),
            Err(error) => one_line(&Err::<(), _>(error)),
        }
    }
    one_line(&model_from_bytes(bytes));
    one_line(&certificates_from_bytes(bytes));
    for kind in [MODEL, CERTIFICATES] {
        one_line(&Sealed::parse(bytes, kind));
    }
}

fn one_line<T>(result: &Result<T, sscc_io::FormatError>) {
    if let Err(error) = result {
        let message = error.to_string();
        assert!(!message.is_empty() && !message.contains('\n') && message.len() < 400, "{message}");
    }
}

/// Small good files: what is close to right goes furthest into a parser.
fn seeds() -> Vec<Vec<u8>> {
    let ply = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_index\nend_header\n";
    let text = format!("ply\nformat ascii 1.0\n{ply}0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    let mut binary = format!("ply\nformat binary_little_endian 1.0\n{ply}").into_bytes();
    binary.extend([0; 36]);
    binary.extend([3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    vec![
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2/2 \\\n -1\n".to_vec(),
        b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n".to_vec(),
        text.into_bytes(),
        binary,
        npy::to_bytes(&[9, 2], &[0.5; 18]).unwrap(),
        npy::to_bytes(&[3, 3, 3], &[0.5; 27]).unwrap(),
        [&[9, 0, 0, 0, 2, 0, 0, 0][..], &[0; 72]].concat(),
    ]
}

#[test]
fn seeds_are_good() {
    let seeds = seeds();
    assert!(obj::parse(&seeds[0]).is_ok() && off::parse(&seeds[1]).is_ok());
    assert!(ply::parse(&seeds[2]).is_ok() && ply::parse(&seeds[3]).is_ok());
    assert!(npy::parse(&seeds[4]).is_ok() && npy::parse(&seeds[5]).is_ok());
    assert!(vega::parse(&seeds[6], vega::Precision::Single, 3).is_ok());
}

proptest! {
    #[test]
    fn random_bytes(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        parse_all(&bytes);
    }

    #[test]
    fn random_words(
        words in prop::collection::vec(
            prop::sample::select(vec![
                "v", "f", "OFF", "ply", "format", "ascii", "1.0", "element", "vertex", "face", "property", "list",
                "float", "int", "uchar", "x", "y", "z", "vertex_index", "end_header", "0", "1", "2", "3", "-1", "1/2",
                "18446744073709551615", "1e999", "nan", "\\", "#", "\n", "\n", "\n", "\r\n", "\u{e9}",
            ]),
            0..80,
        ),
        joint in prop::sample::select(vec![" ", "\n", ""]),
    ) {
        parse_all(words.join(joint).as_bytes());
    }

    #[test]
    fn damaged_files(
        seed in 0_usize..7,
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
        cut in any::<prop::sample::Index>(),
        whole: bool,
    ) {
        let mut bytes = seeds().swap_remove(seed);
        for (at, value) in damage {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        let len = if whole { bytes.len() } else { cut.index(bytes.len()) };
        parse_all(&bytes[..len]);
    }
}
