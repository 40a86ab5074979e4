use super::super::{CERTIFICATES, ContainerWriter, MODEL};
use super::*;

fn writer() -> ContainerWriter {
    let mut writer = ContainerWriter::new(MODEL);
    writer
        .text("units", "metres \"\u{e9}\"\n")
        .u8("bytes", &[3], &[1, 2, 255])
        .f64("points", &[2, 2], &[0.1, -0.0, f64::NAN, 1e300])
        .u64("big", &[1], &[u64::MAX])
        .u32("none", &[0, 2], &[])
        .u32("faces", &[1, 3], &[7, 8, u32::MAX]);
    writer
}

fn sample() -> Vec<u8> {
    writer().finish().unwrap()
}

/// Returns a container with any header and a valid digest.
fn with_header(header: &str, data: &[u8]) -> Vec<u8> {
    let length = (header.len() as u64).to_le_bytes();
    with_new_digest([&length[..], header.as_bytes(), data].concat())
}

fn with_new_digest(mut bytes: Vec<u8>) -> Vec<u8> {
    let digest = header::digest(&bytes);
    bytes[DIGEST].copy_from_slice(digest.as_bytes());
    bytes
}

/// Returns a header with these text entries and tensors.
fn header_of(texts: &str, tensors: &str) -> String {
    format!("{PREFIX}{}\"{texts}}}{tensors}}}", "0".repeat(64))
}

/// Pads a header with spaces to a multiple of 8.
fn pad(header: String) -> String {
    let padding = header.len().next_multiple_of(8) - header.len();
    header + &" ".repeat(padding)
}

fn message(bytes: &[u8]) -> String {
    Container::parse(bytes, MODEL).unwrap_err().to_string()
}

const TEXTS: &str = r#","format":"sscc.model","version":"1""#;

#[test]
fn round_trip() {
    let bytes = sample();
    let file = Container::parse(&bytes, MODEL).unwrap();
    assert_eq!(file.version(), MODEL.version);
    assert_eq!(file.text("units").unwrap(), "metres \"\u{e9}\"\n");
    assert_eq!(file.names(), ["big", "bytes", "faces", "none", "points"]);
    let points = file.f64("points").unwrap();
    let bits: Vec<u64> = points.values.iter().map(|v| v.to_bits()).collect();
    assert_eq!(bits, [0.1, -0.0, f64::NAN, 1e300].map(f64::to_bits));
    assert_eq!(file.u8("bytes").unwrap().values, [1, 2, 255]);
    assert_eq!(file.u64("big").unwrap().values, [u64::MAX]);
    assert_eq!(file.u32("faces").unwrap().shaped(&[1, 3]).unwrap().values, [7, 8, u32::MAX]);
    assert_eq!(file.u32("none").unwrap().shape, [0, 2]);
}

#[test]
fn the_file_is_a_plain_safetensors_file() {
    let bytes = sample();
    let plain = safetensors::SafeTensors::deserialize(&bytes).unwrap();
    assert_eq!(plain.len(), 5);
    let points = plain.tensor("points").unwrap();
    assert_eq!((points.dtype(), points.shape()), (safetensors::Dtype::F64, &[2, 2][..]));
    assert_eq!(points.data().as_ptr() as usize % 8, bytes.as_ptr() as usize % 8);
    assert_eq!(sample(), bytes, "the same content gives the same bytes");
}

#[test]
fn errors_name_missing_entries_and_wrong_types() {
    let bytes = sample();
    let file = Container::parse(&bytes, MODEL).unwrap();
    assert_eq!(file.f64("x").unwrap_err().to_string(), "tensor 'x': missing");
    assert_eq!(
        file.f64("faces").unwrap_err().to_string(),
        "tensor 'faces': it has the type U32, F64 was expected"
    );
    assert_eq!(file.text("blake3").unwrap_err().to_string(), "metadata 'blake3': missing");
    let shaped = |wanted: &[usize]| file.f64("points").unwrap().shaped(wanted);
    assert!(shaped(&[super::super::ANY, 2]).is_ok());
    assert_eq!(
        shaped(&[super::super::ANY, 3]).unwrap_err().to_string(),
        "tensor 'points': it has the shape [2, 2], [any, 3] was expected"
    );
    assert!(shaped(&[2]).is_err() && shaped(&[2, 2, 1]).is_err());
    assert_eq!(
        file.only(&["big"]).unwrap_err().to_string(),
        "tensor 'bytes': not known in this version of the format"
    );
}

#[test]
fn every_flipped_byte_is_rejected() {
    let bytes = sample();
    for at in 0..bytes.len() {
        for flip in [0x01, 0x20, 0x80, 0xff] {
            let mut flipped = bytes.clone();
            flipped[at] ^= flip;
            assert!(Container::parse(&flipped, MODEL).is_err(), "byte {at} ^ {flip}");
        }
    }
}

#[test]
fn truncations_and_extra_bytes_are_rejected() {
    let bytes = sample();
    for len in 0..bytes.len() {
        assert!(Container::parse(&bytes[..len], MODEL).is_err(), "{len}");
    }
    let extra = [&bytes[..], b"\0"].concat();
    assert!(message(&extra).starts_with("the file is damaged"));
    // A new digest does not hide the damage.
    for len in DIGEST.end..bytes.len() {
        assert!(Container::parse(&with_new_digest(bytes[..len].to_vec()), MODEL).is_err(), "{len}");
    }
    assert!(message(&with_new_digest(extra)).contains("the tensors take 55 bytes, the file has 56"));
}

#[test]
fn flipped_bytes_with_a_new_digest_do_not_panic() {
    let bytes = sample();
    for at in 0..bytes.len() {
        for flip in [0x01, 0x04, 0x10, 0x80] {
            let mut flipped = bytes.clone();
            flipped[at] ^= flip;
            if let Ok(file) = Container::parse(&with_new_digest(flipped), MODEL) {
                for name in file.names() {
                    let _ = (file.f64(&name), file.u64(&name), file.u32(&name), file.u8(&name));
                }
            }
        }
    }
}

#[test]
fn other_kinds_and_versions_are_rejected() {
    let bytes = sample();
    let other = Container::parse(&bytes, CERTIFICATES).unwrap_err().to_string();
    assert_eq!(other, "this is a model file, a certificate file was expected");
    let newer = ContainerWriter::new(Kind { version: 7, ..MODEL }).finish().unwrap();
    assert_eq!(
        message(&newer),
        "written by a newer sscc (format version 7, this build reads up to 3): update sscc"
    );
    for version in ["0", "01", "+1", "-1", "x", ""] {
        let header = header_of(&TEXTS.replace(r#"n":"1""#, &format!(r#"n":"{version}""#)), "");
        let expected =
            format!("metadata 'version': '{version}' is not a version number: create the file anew");
        assert_eq!(message(&with_header(&pad(header), b"")), expected);
    }
    assert_eq!(message(b"hello"), "not a file written by sscc, or its beginning is damaged");
}

#[test]
fn headers_in_other_than_canonical_form_are_rejected() {
    let one = r#","a":{"dtype":"U8","shape":[1],"data_offsets":[0,1]}"#;
    assert!(Container::parse(&with_header(&pad(header_of(TEXTS, one)), b"x"), MODEL).is_ok());
    let twice = format!("{one}{one}");
    let blake3 = format!(r#","blake3":"{}"{TEXTS}"#, "0".repeat(64));
    for header in [
        header_of(TEXTS, one),
        pad(header_of(TEXTS, &twice)),
        pad(header_of(&format!(r#"{TEXTS},"version":"1""#), one)),
        pad(header_of(&blake3, one)),
        pad(header_of(TEXTS, &one.replace("[1]", "[ 1]"))),
        pad(header_of(TEXTS, &one.replace("[1]", "[-1]"))),
        pad(header_of(TEXTS, &one.replace("U8", "I8"))),
        pad(header_of(TEXTS, &one.replace("[0,1]", "[1,0]"))),
        pad(header_of(TEXTS, &one.replace("[0,1]", "[0,2]"))),
        pad(header_of(TEXTS, &format!("{one},{}", "[".repeat(100_000)))),
    ] {
        assert!(Container::parse(&with_header(&header, b"x"), MODEL).is_err(), "{header}");
    }
    let long = pad(header_of(&format!(r#"{TEXTS},"x":"{}""#, "x".repeat(MAX_HEADER_BYTES)), ""));
    assert!(message(&with_header(&long, b"")).contains("at most 1048576 are allowed"));
    let mut length = sample();
    length[..8].copy_from_slice(&u64::MAX.to_le_bytes());
    assert!(message(&with_new_digest(length)).contains("does not fit into the file"));
}

#[test]
fn sizes_that_overflow_are_rejected() {
    // Eight tensors of nearly 2^61 bytes and one of 56: together 2^64 - 8.
    let big = (1_u64 << 61) - 8;
    let mut tensors = String::new();
    for i in 0..8 {
        let (begin, end) = (i * big, (i + 1) * big);
        tensors +=
            &format!(r#","a{i}":{{"dtype":"F64","shape":[{}],"data_offsets":[{begin},{end}]}}"#, big / 8);
    }
    let (begin, end) = (8 * big, 8 * big + 56);
    tensors += &format!(r#","b":{{"dtype":"F64","shape":[7],"data_offsets":[{begin},{end}]}}"#);
    let header = header_of(TEXTS, &tensors);
    assert!(
        message(&with_header(&pad(header), &[0; 56])).contains("the tensors take 18446744073709551608 bytes")
    );
}

#[test]
fn the_writer_rejects_invalid_content() {
    let rejected = |change: &dyn Fn(&mut ContainerWriter) -> &mut ContainerWriter| {
        let mut writer = writer();
        change(&mut writer);
        writer.finish().unwrap_err().to_string()
    };
    assert_eq!(rejected(&|w| w.text("units", "")), "metadata 'units': the entry already exists");
    assert_eq!(rejected(&|w| w.text("blake3", "")), "metadata 'blake3': the entry already exists");
    assert_eq!(rejected(&|w| w.u8("big", &[0], &[])), "tensor 'big': the name is already in use");
    assert_eq!(
        rejected(&|w| w.u8("__metadata__", &[0], &[])),
        "tensor '__metadata__': the name is already in use"
    );
    assert_eq!(rejected(&|w| w.f64("x", &[2], &[1.0])), "tensor 'x': 1 values do not fill the shape [2]");
    assert!(rejected(&|w| w.text("x", &"x".repeat(1 << 20))).contains("at most 1048576 are allowed"));
}

#[test]
fn messages_of_the_json_parser_are_cut_to_one_line() {
    let odd = format!(r#","a\n{}":{{"dtype":"U8","shape":[1],"data_offsets":[0,2]}}"#, "x".repeat(500));
    for tensors in [odd.replace("U8", &format!("U\\n{}", "x".repeat(500))), odd] {
        let message = message(&with_header(&pad(header_of(TEXTS, &tensors)), b"xx"));
        assert!(message.starts_with("byte 8: not a safetensors header: "), "{message}");
        assert!(!message.contains('\n') && message.len() < 400, "{message}");
    }
}
