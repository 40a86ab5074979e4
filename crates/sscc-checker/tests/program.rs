//! Tests of the program: exit codes, and answers and messages of one line.
#![allow(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A folder for the files of a test, which is removed with this value.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("sscc-checker-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::write(self.0.join(name), bytes).unwrap();
    }

    /// Runs the program, and returns its exit code and its line: the answer, or a message.
    fn run(&self, args: &[&str]) -> (i32, String) {
        let output = checker(&self.0, args);
        let [answer, message] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
        let code = output.status.code().unwrap();
        let line = if code == 0 { &answer } else { &message };
        assert_eq!(line, &(answer.clone() + &message), "there must be one line alone");
        assert!(line.ends_with('\n') && line.lines().count() == 1, "{line}");
        (code, line.trim_end().to_owned())
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        _ = fs::remove_dir_all(&self.0);
    }
}

fn checker(folder: &Path, args: &[&str]) -> std::process::Output {
    Command::new(env!("CARGO_BIN_EXE_sscc-checker")).args(args).current_dir(folder).output().unwrap()
}

/// A tensor: name, type, shape and bytes.
type Tensor<'a> = (&'a str, &'a str, Vec<usize>, Vec<u8>);

fn reals(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|x| x.to_le_bytes()).collect()
}

fn integers(numbers: &[u32]) -> Vec<u8> {
    numbers.iter().flat_map(|n| n.to_le_bytes()).collect()
}

/// Returns a sealed file.
fn container(texts: &[(&str, &str)], tensors: &[Tensor<'_>]) -> Vec<u8> {
    let mut header = format!(r#"{{"__metadata__":{{"blake3":"{}""#, "0".repeat(64));
    for (key, text) in texts {
        header += &format!(r#","{key}":"{text}""#);
    }
    header.push('}');
    let mut data = Vec::new();
    for (name, dtype, shape, bytes) in tensors {
        let (begin, end) = (data.len(), data.len() + bytes.len());
        header +=
            &format!(r#","{name}":{{"dtype":"{dtype}","shape":{shape:?},"data_offsets":[{begin},{end}]}}"#);
        data.extend(bytes);
    }
    header.push('}');
    let mut bytes = [&(header.len() as u64).to_le_bytes(), header.as_bytes(), &data].concat();
    let digest = blake3::hash(&bytes).to_hex();
    let start = 8 + br#"{"__metadata__":{"blake3":""#.len();
    bytes[start..start + 64].copy_from_slice(digest.as_bytes());
    bytes
}

/// Two triangles one unit apart, each in a leaf, which one mode brings together at q = 1. There are three entries: within each
/// leaf, without a radius, and between the two.
struct Pair {
    factor: Vec<f64>,
    groups: Option<&'static str>,
    node_radii: [f64; 3],
    root_pair_radius: f64,
    first_child: u32,
}

impl Pair {
    /// The modes: the first moves the second triangle along -z, the others nothing.
    fn modes(&self) -> Vec<f64> {
        let rank = self.rank();
        (0..18 * rank)
            .map(|i| if [11, 14, 17].map(|row| row * rank).contains(&i) { -1.0 } else { 0.0 })
            .collect()
    }

    fn rank(&self) -> usize {
        self.factor.len().isqrt()
    }

    const POSITIONS: [f64; 18] = [0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1., 1., 0., 1., 0., 1., 1.];

    fn model(&self) -> Vec<u8> {
        container(
            &[("format", "sscc.model"), ("version", "3")],
            &[
                ("rest_positions", "F64", vec![6, 3], reals(&Self::POSITIONS)),
                ("modes", "F64", vec![6, 3, self.rank()], reals(&self.modes())),
                ("faces", "U32", vec![2, 3], integers(&[0, 1, 2, 3, 4, 5])),
            ],
        )
    }

    /// Returns the digest of model and scope.
    fn digest(&self) -> Vec<u8> {
        let (rank, modes, mut bytes) = (self.rank(), self.modes(), Vec::new());
        let by_vertex: Vec<f64> = (0..6)
            .flat_map(|i| (0..rank).flat_map(move |k| (0..3).map(move |c| (3 * i + c) * rank + k)))
            .map(|index| modes[index])
            .collect();
        let words = |numbers: &[u64]| numbers.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<u8>>();
        let factor = if rank > 1 { "factor" } else { "scales" };
        let mut list = |name: &str, count: usize, numbers: Vec<u8>| {
            bytes.extend([name.as_bytes(), &words(&[count as u64]), &numbers].concat());
        };
        list("faces", 2, words(&[0, 1, 2, 3, 4, 5]));
        list("positions", 6, reals(&Self::POSITIONS));
        list("rank", rank, Vec::new());
        list("modes", 6 * rank, reals(&by_vertex));
        list(factor, self.factor.len(), reals(&self.factor));
        list("exclude-adjacent", 0, Vec::new());
        if let Some(rule) = self.groups {
            list("groups", 2, words(&[0, 0]));
            list(if rule == "counted" { "only-groups" } else { "ignored-groups" }, 0, Vec::new());
        }
        blake3::hash(&bytes).as_bytes().to_vec()
    }

    fn certificates(&self) -> Vec<u8> {
        let mut texts = vec![
            ("format", "sscc.certificates"),
            ("version", "5"),
            ("neighbours", "exclude"),
            ("weld", "none"),
        ];
        let (name, rank) = (if self.rank() > 1 { "metric_factor" } else { "metric_scales" }, self.rank());
        let shape = if rank > 1 { vec![rank, rank] } else { vec![1] };
        let nodes = [0, 2, self.first_child, 2, 0, 1, 0, 0, 1, 1, 0, 0];
        let mut tensors = vec![
            (name, "F64", shape, reals(&self.factor)),
            ("center", "F64", vec![rank], reals(&vec![0.0; rank])),
            ("node_radii", "F64", vec![3], reals(&self.node_radii)),
            ("root_pair_radii", "F64", vec![1], reals(&[self.root_pair_radius])),
            ("nodes", "U32", vec![3, 4], integers(&nodes)),
            ("order", "U32", vec![2], integers(&[0, 1])),
            ("model_digest", "U8", vec![32], self.digest()),
        ];
        if let Some(rule) = self.groups {
            texts.push(("group_pairs", rule));
            tensors.push(("groups", "U32", vec![2], integers(&[0, 0])));
            tensors.push(("group_pairs", "U32", vec![0, 2], Vec::new()));
        }
        container(&texts, &tensors)
    }

    /// Returns a proof with these entries.
    fn proof(&self, entries: &[(u64, &[u8])]) -> Vec<u8> {
        let mut bytes = [&b"SSCCPRF1"[..], &self.digest()].concat();
        bytes.extend([3, entries.len() as u64].into_iter().flat_map(u64::to_le_bytes));
        bytes.extend([self.rank() as u32, 3].into_iter().flat_map(u32::to_le_bytes));
        bytes.extend(vec![0; 3 * 8 * (3 + 12 * self.rank())]);
        for (number, witnesses) in entries {
            bytes.extend(number.to_le_bytes());
            bytes.extend((witnesses.len() as u32).to_le_bytes());
            bytes.extend(*witnesses);
        }
        bytes
    }
}

const PAIR: Pair =
    Pair { factor: Vec::new(), groups: None, node_radii: [0.0; 3], root_pair_radius: 0.5, first_child: 1 };

fn pair() -> Pair {
    Pair { factor: vec![1.0], ..PAIR }
}

/// Returns the witness of the pair of leaves: a direction that separates the two triangles.
fn witness(dir: [f64; 3]) -> Vec<u8> {
    [b"t\xff", &reals(&dir)[..]].concat()
}

const LEFT_OUT: &str =
    "left out: pairs with common vertices, 0 exceptions, 0 ignored pairs, no groups, no local certificates";

#[test]
fn right_proofs_are_confirmed() {
    let folder = Folder::new("right");
    let along = witness([0.0, 0.0, 1.0]);
    let nothing = &b""[..];
    folder.write("m.model.safetensors", pair().model());
    folder.write("c", pair().certificates());
    folder.write("all", pair().proof(&[(0, nothing), (1, nothing), (2, &along)]));
    let line = format!("confirmed: 3 of 3 entries, 1 with a positive radius; root's radius 0.0; {LEFT_OUT}");
    for option in [&[][..], &["--sample"]] {
        assert_eq!(folder.run(&[option, &["m.model.safetensors", "c", "all"]].concat()), (0, line.clone()));
    }
    // The same model as a mesh and its modes.
    let vertices = Pair::POSITIONS.chunks(3).map(|p| format!("v {} {} {}\n", p[0], p[1], p[2]));
    folder.write("m.obj", vertices.collect::<String>() + "f 1 2 3\nf 4 5 6\n");
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (18, 1), }";
    let head = [b"\x93NUMPY\x01\0".as_slice(), &(header.len() as u16).to_le_bytes(), header.as_bytes()];
    folder.write("u.npy", [&head.concat()[..], &reals(&pair().modes())].concat());
    assert_eq!(folder.run(&["m.obj", "u.npy", "c", "all"]), (0, line));
    // The root's radius, and groups of which no pair counts.
    let only = Pair { groups: Some("counted"), node_radii: [1e300; 3], ..pair() };
    folder.write("groups", only.certificates());
    folder.write("none", only.proof(&[(0, b"n"), (1, b"t"), (2, b"n")]));
    let (code, line) = folder.run(&["m.model.safetensors", "groups", "none"]);
    let start = "confirmed: 3 of 3 entries, 3 with a positive radius; root's radius 1e300; ";
    assert!(code == 0 && line.starts_with(start), "{line}");
    assert!(line.contains(", all pairs of groups but 0, "), "{line}");
}

/// The author of a proof chooses the entries of a sample.
#[test]
fn samples_are_confirmed_on_request_and_only_if_they_state_something() {
    let folder = Folder::new("samples");
    let along = witness([0.0, 0.0, 1.0]);
    folder.write("m", pair().model());
    folder.write("c", pair().certificates());
    folder.write("one", pair().proof(&[(2, &along)]));
    folder.write("radius 0", pair().proof(&[(0, b""), (1, b"")]));
    folder.write("none", pair().proof(&[]));
    for (proof, sample, cause) in [
        ("one", None, "proof: it has 1 of 3 entries: samples are accepted on request alone"),
        ("radius 0", Some("its 2 of 3 entries have radius 0"), "proof: it has 2 of 3 entries"),
        ("none", Some("it proves no entry"), "proof: it proves no entry"),
    ] {
        let (code, line) = folder.run(&["m", "c", proof]);
        assert!(code == 1 && line.starts_with(&format!("error: {cause}")), "{line}");
        let (code, line) = folder.run(&["--sample", "m", "c", proof]);
        match sample {
            Some(cause) => assert!(code == 1 && line.contains(cause), "{line}"),
            None => {
                let start = "confirmed a sample: 1 of 3 entries, 1 of 1 with a positive radius, chosen by the \
                             author of the proof; nothing is known of the others";
                assert_eq!((code, line), (0, format!("{start}; {LEFT_OUT}")));
            }
        }
    }
    // Certificates without a radius state nothing, and their proof is empty.
    let nothing = Pair { root_pair_radius: 0.0, ..pair() };
    folder.write("c", nothing.certificates());
    folder.write("all", nothing.proof(&[(0, b""), (1, b""), (2, b"")]));
    let (code, line) = folder.run(&["m", "c", "all"]);
    assert!(code == 0 && line.starts_with("confirmed: 3 of 3 entries, 0 with a positive radius"), "{line}");
}

#[test]
fn wrong_proofs_and_wrong_certificates_are_not_confirmed() {
    let folder = Folder::new("wrong");
    let (along, across) = (witness([0.0, 0.0, 1.0]), witness([1.0, 0.0, 0.0]));
    let all = |pair: &Pair, dir: &[u8]| pair.proof(&[(0, b""), (1, b""), (2, dir)]);
    let right = all(&pair(), &along);
    folder.write("m", pair().model());
    folder.write("c", pair().certificates());
    let refused = |certificates: &str, proof: Vec<u8>| {
        folder.write("p", proof);
        let (code, line) = folder.run(&["m", certificates, "p"]);
        assert_eq!(code, 1, "{line}");
        line
    };
    assert!(
        refused("c", all(&pair(), &across)).starts_with("error: proof: entry 2, nodes 1 and 2, radius 5e-1")
    );
    assert!(refused("c", [&right[..], b"x"].concat()).contains("after its end"));
    // A proof that is cut off, also before its first eight bytes end.
    for length in [0, 3, 7, 8, 39, 40, 63, 64, 300, right.len() - 30, right.len() - 1] {
        assert_eq!(refused("c", right[..length].to_vec()), "error: proof: it ends too early", "{length}");
    }
    for (wrong, cause) in [
        (Pair { root_pair_radius: 1.0_f64.next_up(), ..pair() }, "proof: entry 2"),
        (Pair { root_pair_radius: f64::INFINITY, ..pair() }, "proof: entry 2"),
        (Pair { node_radii: [1e300, 0.0, 0.0], ..pair() }, "proof: entry 0"),
        (Pair { root_pair_radius: -0.5, ..pair() }, "certificates: a radius is negative"),
        (Pair { root_pair_radius: f64::NAN, ..pair() }, "certificates: a radius is negative"),
        (Pair { first_child: 2, ..pair() }, "certificates: hierarchy: "),
    ] {
        folder.write("w", wrong.certificates());
        let line = refused("w", all(&wrong, &along));
        assert!(line.starts_with(&format!("error: {cause}")), "{line}");
    }
    // Files that do not belong together, and files of other kinds.
    let other = Pair { groups: Some("ignored"), ..pair() };
    let mut damaged = pair().certificates();
    *damaged.last_mut().unwrap() ^= 1;
    let mut negative_scale = pair();
    negative_scale.factor = vec![-1.0];
    for (certificates, proof, cause) in [
        (pair().certificates(), all(&other, &along), "proof: of other certificates"),
        (pair().certificates(), b"x".to_vec(), "proof: not a proof of certificates"),
        (pair().certificates(), pair().model(), "proof: not a proof of certificates"),
        (pair().model(), right.clone(), "certificates: it is of another kind"),
        (damaged, right.clone(), "certificates: its content does not match its BLAKE3 digest"),
        (negative_scale.certificates(), right.clone(), "certificates: metric or centre"),
    ] {
        folder.write("w", certificates);
        folder.write("p", proof);
        let (code, line) = folder.run(&["m", "w", "p"]);
        assert_eq!((code, line.starts_with(&format!("error: {cause}"))), (2, true), "{line}");
    }
}

/// Small files must not take much time or memory.
#[test]
fn metrics_out_of_range_are_refused() {
    let folder = Folder::new("metrics");
    let (rank, tiny, huge) = (60, 2_f64.powi(-200), 2_f64.powi(200));
    let dense = |diagonal: f64, other: f64| {
        let entry = |e: usize| match (e % rank).cmp(&(e / rank)) {
            std::cmp::Ordering::Less => 0.0,
            std::cmp::Ordering::Equal => diagonal,
            std::cmp::Ordering::Greater => other,
        };
        Pair { factor: (0..rank * rank).map(entry).collect(), ..PAIR }
    };
    let check = |pair: Pair, witness: &[u8]| {
        folder.write("m", pair.model());
        folder.write("c", pair.certificates());
        folder.write("p", pair.proof(&[(0, b""), (1, b""), (2, witness)]));
        folder.run(&["m", "c", "p"])
    };
    let out_of_range = "error: certificates: metric or centre: a number is out of range";
    assert_eq!(check(dense(5e-324, f64::MAX), b""), (2, out_of_range.into()));
    assert_eq!(check(dense(tiny / 2.0, 0.0), b""), (2, out_of_range.into()));
    assert_eq!(check(dense(1.0, 2.0 * huge), b""), (2, out_of_range.into()));
    let singular = "error: certificates: metric: it is nearly singular";
    assert_eq!(check(dense(tiny, huge), b""), (2, singular.into()));
    assert_eq!(check(dense(1.0, 9.0), b""), (2, singular.into()));
    // A metric that differs from the unit matrix, and one with the units of the extremes.
    let along = witness([0.0, 0.0, 1.0]);
    let extreme = Pair { root_pair_radius: 0.5 * tiny, ..dense(tiny, 0.0) };
    for pair in [dense(1.0, 0.25), extreme] {
        let (code, line) = check(pair, &along);
        assert!(code == 0 && line.ends_with(LEFT_OUT), "{line}");
    }
}

#[test]
fn invalid_files_are_refused_with_one_line() {
    let folder = Folder::new("invalid");
    folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.write("polygon.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 1\n");
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (9, 1), }";
    let npy =
        [b"\x93NUMPY\x01\0".as_slice(), &(header.len() as u16).to_le_bytes(), header.as_bytes(), &[0; 72]];
    folder.write("u.npy", npy.concat());
    for (args, cause) in [
        (&["missing.obj", "u.npy", "a.obj", "a.obj"][..], "missing.obj: "),
        (&["two\nlines.obj", "u.npy", "a.obj", "a.obj"], r"two\nlines.obj: "),
        (&["polygon.obj", "u.npy", "a.obj", "a.obj"], "polygon.obj: line 4: "),
        (&["a.obj", "a.obj", "a.obj", "a.obj"], "a.obj: not an .npy file"),
        (&["a.obj", "u.npy", "a.obj", "a.obj"], "certificates: not a file written by sscc"),
        (&["a.obj", "a.obj", "a.obj"], "a.obj: not a file written by sscc"),
        (&["a.obj"], "three or four files are needed"),
        (&[], "three or four files are needed"),
    ] {
        let (code, message) = folder.run(args);
        assert_eq!((code, message.starts_with(&format!("error: {cause}"))), (2, true), "{message}");
    }
    let help = Command::new(env!("CARGO_BIN_EXE_sscc-checker")).arg("--help").output().unwrap();
    assert_eq!((help.status.code(), help.stderr.len()), (Some(0), 0));
    assert!(help.stdout.starts_with(b"usage: sscc-checker "));
}

#[test]
fn a_closed_pipe_leaves_the_exit_code() {
    for (args, code) in [(&["--help"][..], 0), (&[], 2)] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut command = Command::new(env!("CARGO_BIN_EXE_sscc-checker"));
        command.args(args).stdout(writer.try_clone().unwrap()).stderr(writer);
        assert_eq!(command.status().unwrap().code(), Some(code), "{args:?}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn an_answer_that_cannot_be_written_is_an_error() {
    for args in [&["--help"][..], &[]] {
        let full = || fs::File::options().write(true).open("/dev/full").unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_sscc-checker"));
        command.args(args).stdout(full()).stderr(full());
        assert_eq!(command.status().unwrap().code(), Some(2), "{args:?}");
    }
}
