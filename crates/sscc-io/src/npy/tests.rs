use npyz::WriterBuilder;
use proptest::prelude::*;

use super::*;

/// Returns a `.npy` file with any header.
fn file(version: u8, header: &str, body: &[u8]) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY".to_vec();
    bytes.extend([version, 0]);
    match version {
        1 => bytes.extend((header.len() as u16).to_le_bytes()),
        _ => bytes.extend((header.len() as u32).to_le_bytes()),
    }
    bytes.extend(header.bytes());
    bytes.extend(body);
    bytes
}

fn header(descr: &str, order: &str, shape: &str) -> String {
    format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}\n")
}

fn body(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

const SIX: [f64; 6] = [0.0, 1.0, -2.5, 3e-300, 1e300, -0.0];

#[test]
fn orders_types_and_versions() {
    let c = parse(&file(1, &header("<f8", "False", "(2, 3)"), &body(&SIX))).unwrap();
    assert_eq!((c.shape(), c.at([0, 2]), c.at([1, 0])), (&[2, 3][..], -2.5, 3e-300));
    let f = parse(&file(2, &header("<f8", "True", "(3, 2)"), &body(&SIX))).unwrap();
    assert_eq!((f.at([2, 0]), f.at([0, 1])), (-2.5, 3e-300));
    assert_eq!(f.to_c_order(), [0.0, 3e-300, 1.0, 1e300, -2.5, -0.0]);
    let big: Vec<u8> = SIX.iter().flat_map(|v| v.to_be_bytes()).collect();
    assert_eq!(parse(&file(3, &header(">f8", "False", "(2, 3)"), &big)).unwrap(), c);
    let small: Vec<u8> = [0.1f32, -2.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let small = parse(&file(1, &header("<f4", "False", "(2,)"), &small)).unwrap();
    assert_eq!(small.to_c_order(), [f64::from(0.1f32), -2.0]);
    let big: Vec<u8> = [0.1f32, -2.0].iter().flat_map(|v| v.to_be_bytes()).collect();
    assert_eq!(parse(&file(1, &header(">f4", "True", "(2L,)"), &big)).unwrap(), small);
    let other = "{\"shape\":(2,3),\"descr\":\"<f8\",\"fortran_order\":False}";
    assert_eq!(parse(&file(1, other, &body(&SIX))).unwrap(), c);
}

#[test]
fn integers_of_all_sizes() {
    let wide = |descr: &str, body: &[u8]| {
        parse_integers(&file(1, &header(descr, "False", "(2,)"), body)).unwrap().to_c_order()
    };
    assert_eq!(wide("|i1", &[7, 0xff]), [7, -1]);
    assert_eq!(wide("|u1", &[7, 0xff]), [7, 255]);
    assert_eq!(wide("<i2", &[0, 0x80, 2, 1]), [-32768, 258]);
    assert_eq!(wide(">u2", &[0x80, 0, 1, 2]), [32768, 258]);
    let both = |little: [&[u8]; 2]| little.map(|b| b.iter().rev().copied().collect::<Vec<u8>>()).concat();
    let four = [(-5_i32).to_le_bytes(), i32::MAX.to_le_bytes()];
    assert_eq!(wide("<i4", &four.concat()), [-5, i32::MAX.into()]);
    assert_eq!(wide(">i4", &both([&four[0], &four[1]])), [-5, i32::MAX.into()]);
    assert_eq!(wide("<u4", &four.concat()), [4294967291, i32::MAX.into()]);
    let eight = [i64::MIN.to_le_bytes(), i64::MAX.to_le_bytes()];
    assert_eq!(wide("<i8", &eight.concat()), [i64::MIN, i64::MAX]);
    assert_eq!(wide(">i8", &both([&eight[0], &eight[1]])), [i64::MIN, i64::MAX]);
    let message = |descr: &str, body: &[u8]| {
        parse_integers(&file(1, &header(descr, "False", "(2,)"), body)).unwrap_err().to_string()
    };
    assert_eq!(message("<u8", &eight.concat()), "the integer 9223372036854775808 is too large");
    for descr in ["<f8", "|i4", "=i4", "<i3", "<b1", "<i16", "i4", "", "\u{e9}4"] {
        assert!(message(descr, &[0; 8]).contains("save the array as integers"), "{descr}");
    }
}

#[test]
fn entries_in_c_order_are_moved() {
    let [c, fortran] = ["False", "True"]
        .map(|order| parse(&file(1, &header("|i1", order, "(2, 3)"), &[0, 1, 2, 3, 0x80, 0x7f])).unwrap());
    let place = c.data.as_ptr();
    assert_eq!(c.to_c_order(), [0.0, 1.0, 2.0, 3.0, -128.0, 127.0]);
    let moved = c.into_c_order();
    assert_eq!((moved.as_ptr(), moved), (place, vec![0.0, 1.0, 2.0, 3.0, -128.0, 127.0]));
    assert_eq!(fortran.to_c_order(), [0.0, 2.0, -128.0, 1.0, 3.0, 127.0]);
    assert_eq!(fortran.into_c_order(), [0.0, 2.0, -128.0, 1.0, 3.0, 127.0]);
}

#[test]
fn entries_are_counted_by_their_bytes() {
    let count = |descr: &str, bytes: usize| {
        entry_count(&file(1, &header(descr, "False", "(4000000000, 1000000000)"), &vec![0; bytes]))
    };
    for (descr, bytes, expected) in
        [("|i1", 24, 24), ("<f2", 24, 12), (">u4", 24, 6), ("<f8", 24, 3), ("<f8", 7, 0)]
    {
        assert_eq!(count(descr, bytes), Some(expected), "{descr} {bytes}");
    }
    assert_eq!((count("<c8", 24), entry_count(b"x"), entry_count(b"")), (None, None, None));
}

#[test]
fn half_floats_and_integers_are_floats() {
    let floats = |descr: &str, body: &[u8]| {
        parse(&file(1, &header(descr, "False", &format!("({},)", body.len() / 2)), body))
            .unwrap()
            .to_c_order()
    };
    // 1, -2, 65504, the smallest normal and denormal numbers, a third, negative zero, infinity.
    let halves = [0x3c00_u16, 0xc000, 0x7bff, 0x0400, 0x0001, 0x3555, 0x8000, 0x7c00];
    let expected =
        [1.0, -2.0, 65504.0, 2.0_f64.powi(-14), 2.0_f64.powi(-24), 0.333251953125, -0.0, f64::INFINITY];
    let little: Vec<u8> = halves.iter().flat_map(|bits| bits.to_le_bytes()).collect();
    let big: Vec<u8> = halves.iter().flat_map(|bits| bits.to_be_bytes()).collect();
    assert_eq!(floats("<f2", &little), expected);
    assert_eq!(floats(">f2", &big), expected);
    assert!(floats("<f2", &[0x01, 0x7c])[0].is_nan());
    assert_eq!(floats("<i2", &[0, 0x80, 2, 1]), [-32768.0, 258.0]);
    assert_eq!(floats(">u2", &[0x80, 0, 1, 2]), [32768.0, 258.0]);
    let eight = |value: i64| parse(&file(1, &header("<i8", "True", "(1,)"), &value.to_le_bytes()));
    assert_eq!(eight(-(1 << 53)).unwrap().to_c_order(), [-9007199254740992.0]);
    let refused = eight((1 << 53) + 1).unwrap_err().to_string();
    assert_eq!(refused, "the integer 9007199254740993 is beyond 2^53: save the array as float64");
    assert!(eight(i64::MIN).is_err());
}

#[test]
fn errors_name_the_cause() {
    let message = |header: &str| parse(&file(1, header, &body(&SIX))).unwrap_err().to_string();
    let good = header("<f8", "False", "(2, 3)");
    assert!(message(&header("<c8", "False", "(2, 3)")).contains("type '<c8': save the array as float64"));
    assert!(message(&good.replace("'<f8'", "[('a', '<f8')]")).contains("the array is structured"));
    assert!(message(&good.replace("False", "Maybe")).contains("'False' expected before ' Maybe"));
    assert!(message(&good.replace("shape", "form")).contains("unknown key 'form'"));
    assert!(
        message(&good.replace("'shape': (2, 3)", "'descr': '<f8'")).contains("the key 'descr' is repeated")
    );
    assert!(message("{}").contains("is missing"));
    assert!(message(&good.replace("}\n", "} x")).contains("unexpected text 'x'"));
    for shape in ["(-1, 3)", "2", "(2 3)", "(99999999999999999999999,)", "(2.0, 3)", "((2,), 3)"] {
        assert!(parse(&file(1, &header("<f8", "False", shape), &body(&SIX))).is_err(), "{shape}");
    }
    for shape in ["(2, 4)", "(2, 2)", "(6, 1099511627776)", "(9223372036854775808, 2)", "()", "(0,)"] {
        let message = message(&header("<f8", "False", shape));
        assert!(message.contains("bytes follow: is the file cut off?"), "{shape}: {message}");
    }
    assert!(
        message(&header("<f8", "False", &format!("({})", "1,".repeat(40)))).contains("more than 32 axes")
    );
    assert_eq!(
        parse(b"hello").unwrap_err().to_string(),
        "byte 0: not a NumPy array: a .npy file begins with '\\x93NUMPY'"
    );
    assert_eq!(
        parse(b"\x93NUMPY\x04\x00\x00").unwrap_err().to_string(),
        "byte 6: version 4.0 of the format is not supported"
    );
    let huge = [&b"\x93NUMPY\x02\x00"[..], &u32::MAX.to_le_bytes(), b"{"].concat();
    assert_eq!(parse(&huge).unwrap_err().to_string(), "byte 13: the file ends within the header");
}

#[test]
fn open_brackets_are_rejected_fast() {
    for bracket in ["{", "[", "(", "{'shape':("] {
        assert!(parse(&file(1, &bracket.repeat(6000), &[])).is_err());
    }
}

#[test]
fn truncations_and_extra_bytes_are_rejected() {
    let bytes = to_bytes(&[2, 3], &SIX).unwrap();
    for len in 0..bytes.len() {
        assert!(parse(&bytes[..len]).is_err(), "{len}");
    }
    assert!(parse(&[&bytes[..], b"\0"].concat()).is_err());
}

#[test]
fn written_files_have_the_form_of_numpy() {
    let bytes = to_bytes(&[2, 3], &SIX).unwrap();
    assert!(bytes.starts_with(
        b"\x93NUMPY\x01\x00\x76\x00{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }"
    ));
    assert_eq!(bytes.len(), 128 + 48);
    assert!(to_bytes(&[2, 2], &SIX).is_none());
    assert!(to_bytes(&[usize::MAX, 2], &SIX).is_none());
}

proptest! {
    #[test]
    fn agrees_with_npyz(shape in prop::collection::vec(0_usize..5, 0..4), fortran: bool, narrow: bool) {
        let count: usize = shape.iter().product();
        let values: Vec<f64> = (0..count).map(|i| i as f64 - 1.5).collect();

        // This reader reads files of npyz.
        let lengths: Vec<u64> = shape.iter().map(|n| *n as u64).collect();
        let order = if fortran { npyz::Order::Fortran } else { npyz::Order::C };
        let mut bytes = Vec::new();
        if narrow {
            let options = npyz::WriteOptions::<f32>::new().shape(&lengths).order(order).default_dtype();
            let mut writer = options.writer(&mut bytes).begin_nd().unwrap();
            writer.extend(values.iter().map(|v| *v as f32)).unwrap();
            writer.finish().unwrap();
        } else {
            let options = npyz::WriteOptions::<f64>::new().shape(&lengths).order(order).default_dtype();
            let mut writer = options.writer(&mut bytes).begin_nd().unwrap();
            writer.extend(values.iter().copied()).unwrap();
            writer.finish().unwrap();
        }
        let array = parse(&bytes).unwrap();
        prop_assert_eq!(array.shape(), &shape[..]);
        prop_assert_eq!(&array.data, &values);

        // Both readers read files of this writer.
        let c_order = array.to_c_order();
        let bytes = to_bytes(&shape, &c_order).unwrap();
        let theirs = npyz::NpyFile::new(&bytes[..]).unwrap();
        prop_assert_eq!(theirs.shape(), &lengths[..]);
        prop_assert_eq!(theirs.into_vec::<f64>().unwrap(), c_order.clone());
        prop_assert_eq!(parse(&bytes).unwrap().to_c_order(), c_order);
    }
}
