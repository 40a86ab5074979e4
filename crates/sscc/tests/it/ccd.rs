//! Compares continuous tests with published queries with exact answers, and counts false positives.
#![allow(clippy::print_stdout)]

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use glam::DVec3;
use num_traits::ToPrimitive;
use sscc::parts::{impact_edge_edge, impact_vertex_face};
use sscc::{Detector, Impact, MovingTriangle, Pair, TriMesh, impact_triangle_triangle};
use sscc_testing::{distance, first_contact, models};

/// Tolerances, as shares of the size of the two triangles.
const TOLERANCES: [f64; 5] = [1e-3, 1e-6, 1e-9, 1e-12, 0.0];

/// Eight points, four at time 0, then the same four at time 1: a vertex and a face's corners, or two edges.
type Corners = [DVec3; 8];

/// The kind of the four points.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    VertexFace,
    EdgeEdge,
}

/// A query with its exact answer.
struct Known {
    corners: Corners,
    collides: bool,
}

impl Kind {
    fn impact(self, p: &Corners, tolerance: f64) -> Option<f64> {
        match self {
            Self::VertexFace => {
                let face = MovingTriangle { t0: [p[1], p[2], p[3]], t1: [p[5], p[6], p[7]] };
                impact_vertex_face([p[0], p[4]], &face, tolerance)
            }
            Self::EdgeEdge => {
                impact_edge_edge([[p[0], p[1]], [p[4], p[5]]], [[p[2], p[3]], [p[6], p[7]]], tolerance)
            }
        }
    }
}

/// Converts a fraction to the equal double; panics if there is none. Denominators are powers of two of up to 112 bits.
fn exact(numerator: &str, denominator: &str) -> f64 {
    let (n, d): (i128, u128) = (numerator.parse().unwrap(), denominator.parse().unwrap());
    assert!(d.is_power_of_two(), "{denominator}: not a power of two");
    let odd = n.unsigned_abs() >> n.unsigned_abs().trailing_zeros().min(127);
    assert!(odd < 1 << 53, "{numerator}/{denominator}: not a double");
    n as f64 / d as f64 // both exact, a power of two divides without rounding
}

fn read_queries(path: &Path) -> Vec<Known> {
    let text = std::fs::read_to_string(path).unwrap();
    let rows: Vec<(DVec3, bool)> = text
        .lines()
        .map(|line| {
            let columns: Vec<&str> = line.split(',').map(str::trim).collect();
            assert_eq!(columns.len(), 7, "{line}");
            let x = [0, 2, 4].map(|i| exact(columns[i], columns[i + 1]));
            (DVec3::from_array(x), columns[6] == "1")
        })
        .collect();
    let (queries, rest) = rows.as_chunks::<8>();
    assert!(rest.is_empty() && !queries.is_empty(), "{}", path.display());
    let known = |rows: &[(DVec3, bool); 8]| {
        assert!(rows.iter().all(|row| row.1 == rows[0].1));
        Known { corners: rows.map(|row| row.0), collides: rows[0].1 }
    };
    queries.iter().map(known).collect()
}

/// Counts of one set of queries.
#[derive(Default)]
struct Counts {
    queries: usize,
    colliding: usize,
    missed: usize,
    false_positives: [usize; TOLERANCES.len()],
}

impl Counts {
    fn add(&mut self, kind: Kind, known: &Known) {
        self.queries += 1;
        self.colliding += usize::from(known.collides);
        for (count, tolerance) in self.false_positives.iter_mut().zip(TOLERANCES) {
            let impact = kind.impact(&known.corners, tolerance);
            assert!(impact.is_none_or(|t| (0.0..=1.0).contains(&t)));
            self.missed += usize::from(known.collides && impact.is_none());
            *count += usize::from(!known.collides && impact.is_some());
        }
    }

    fn print(&self, name: &str) {
        let Self { queries, colliding, missed, false_positives } = self;
        println!(
            "{name:<42} {queries:>5} queries {colliding:>4} colliding {missed:>3} missed, false positives at \
             {TOLERANCES:?}: {false_positives:?}"
        );
    }
}

#[test]
fn no_published_query_is_missed() {
    let Some(folder) = models("no_published_query_is_missed") else { return };
    let folder = folder.join("ccd");
    let mut sum = Counts::default();
    for (set, expected) in [
        ("unit-tests", [(74, 36), (250, 124)]),
        ("erleben-cube-cliff-edges", [(250, 38), (250, 22)]),
        ("erleben-spike-wedge", [(250, 36), (250, 14)]),
        ("erleben-sliding-spike", [(250, 0), (250, 4)]),
    ] {
        let kinds = [("edge-edge", Kind::EdgeEdge), ("vertex-face", Kind::VertexFace)];
        for ((name, kind), expected) in kinds.into_iter().zip(expected) {
            let mut counts = Counts::default();
            for file in ["data_0_0.csv", "data_0_1.csv"] {
                for known in read_queries(&folder.join(set).join(name).join(file)) {
                    counts.add(kind, &known);
                }
            }
            counts.print(&format!("{set}/{name}"));
            assert_eq!((counts.queries, counts.colliding), expected, "{set}/{name}");
            assert_eq!(counts.missed, 0, "{set}/{name}");
            sum.queries += counts.queries;
            sum.false_positives.iter_mut().zip(counts.false_positives).for_each(|(s, c)| *s += c);
        }
    }
    assert_eq!(sum.queries, 1824);
    println!("all: {:?}", sum.false_positives);
    // All these false positives are of a cube on a cliff, of size 1; at the reported time the distance is less than 5e-14.
    assert!(sum.false_positives[3] <= 185, "at {}: {:?}", TOLERANCES[3], sum.false_positives);
}

/// Two frames of a cloth, and pairs of their edges, vertices and faces.
struct Frames {
    /// The positions at both ends.
    vertices: [Vec<DVec3>; 2],
    edges: Vec<[usize; 2]>,
    faces: Vec<[usize; 3]>,
}

impl Frames {
    fn read(folder: &Path) -> Self {
        let [(start, faces), (end, same)] = ["227.ply", "228.ply"].map(|name| read_ply(&folder.join(name)));
        assert_eq!(faces, same);
        // Unique vertex pairs (smaller, greater), ordered by the greater vertex, then the smaller one.
        let mut edges: Vec<[usize; 2]> = faces
            .iter()
            .flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]])
            .map(|[a, b]| [a.max(b), a.min(b)])
            .collect();
        edges.sort_unstable();
        edges.dedup();
        edges.iter_mut().for_each(|edge| edge.swap(0, 1));
        Self { vertices: [start, end], edges, faces }
    }

    /// Returns the corners of a pair of elements, whose numbers count vertices first, then edges, then faces.
    fn corners(&self, kind: Kind, [a, b]: [usize; 2]) -> Corners {
        let edges = self.vertices[0].len();
        let faces = edges + self.edges.len();
        let four: Vec<usize> = match kind {
            Kind::VertexFace => [&[a][..], &self.faces[b - faces]].concat(),
            Kind::EdgeEdge => [self.edges[a - edges], self.edges[b - edges]].concat(),
        };
        std::array::from_fn(|i| self.vertices[i / 4][four[i % 4]])
    }

    /// Returns the triangle of that number.
    fn triangle(&self, number: u32) -> MovingTriangle {
        let corners = |end: usize| self.faces[number as usize].map(|v| self.vertices[end][v]);
        MovingTriangle { t0: corners(0), t1: corners(1) }
    }

    /// Returns all pairs of triangles without a common vertex of which one contains the first element and the other the second.
    fn triangles_around(&self, [a, b]: [usize; 2]) -> Vec<Pair> {
        let edges = self.vertices[0].len();
        let faces = edges + self.edges.len();
        let with = |element: usize| -> Vec<usize> {
            let corners = match element {
                vertex if vertex < edges => vec![vertex],
                edge if edge < faces => self.edges[edge - edges].to_vec(),
                face => return vec![face - faces],
            };
            let has = |face: &usize| corners.iter().all(|corner| self.faces[*face].contains(corner));
            (0..self.faces.len()).filter(has).collect()
        };
        let (around_a, around_b) = (with(a), with(b));
        let all = around_a.iter().flat_map(|f| around_b.iter().map(move |g| (*f, *g)));
        let is_adjacent = |(f, g): &(usize, usize)| self.faces[*f].iter().any(|v| self.faces[*g].contains(v));
        all.filter(|pair| !is_adjacent(pair)).map(|(f, g)| (f.min(g) as u32, f.max(g) as u32)).collect()
    }
}

/// Reads the format of these two files: binary little-endian, with positions as doubles and triangles only.
fn read_ply(path: &Path) -> (Vec<DVec3>, Vec<[usize; 3]>) {
    let bytes = std::fs::read(path).unwrap();
    let end = b"end_header\n";
    let body = bytes.windows(end.len()).position(|w| w == end).unwrap() + end.len();
    let header = std::str::from_utf8(&bytes[..body]).unwrap();
    assert!(header.contains("binary_little_endian") && header.contains("property double x"));
    let count = |what: &str| -> usize {
        header.split(&format!("element {what} ")).nth(1).unwrap().lines().next().unwrap().parse().unwrap()
    };
    let (vertices, faces) = bytes[body..].split_at(24 * count("vertex"));
    assert_eq!(faces.len(), 13 * count("face"));
    let number = |b: &[u8]| f64::from_le_bytes(b.try_into().unwrap());
    let vertex = |b: &[u8]| DVec3::new(number(&b[..8]), number(&b[8..16]), number(&b[16..]));
    let index = |b: &[u8]| u32::from_le_bytes(b.try_into().unwrap()) as usize;
    let face = |b: &[u8]| [index(&b[1..5]), index(&b[5..9]), index(&b[9..])];
    (vertices.chunks(24).map(vertex).collect(), faces.chunks(13).map(face).collect())
}

/// Returns the pairs of a `*_boxes.json`, with the answers of the matching `*_mma_bool.json`.
fn read_pairs(folder: &Path, kind: &str) -> Vec<([usize; 2], bool)> {
    let words = |name: String| -> Vec<String> {
        let text = std::fs::read_to_string(folder.join(name)).unwrap();
        text.split(['[', ']', ',']).map(str::trim).filter(|w| !w.is_empty()).map(str::to_owned).collect()
    };
    let numbers = words(format!("227{kind}_boxes.json"));
    let answers = words(format!("227{kind}_mma_bool.json"));
    assert_eq!(numbers.len(), 2 * answers.len());
    let pair = |pair: &[String]| [0, 1].map(|i| pair[i].parse().unwrap());
    numbers.chunks(2).map(pair).zip(answers.iter().map(|a| a.parse().unwrap())).collect()
}

#[test]
fn no_pair_of_the_cloth_is_missed() {
    let Some(folder) = models("no_pair_of_the_cloth_is_missed") else { return };
    let folder = folder.join("ccd_frames/cloth-funnel");
    let frames = Frames::read(&folder);
    assert_eq!((frames.vertices[0].len(), frames.edges.len(), frames.faces.len()), (9_450, 27_930, 18_484));
    for (name, kind, expected) in [("ee", Kind::EdgeEdge, (263, 107)), ("vf", Kind::VertexFace, (92, 27))] {
        let mut counts = Counts::default();
        for (pair, collides) in read_pairs(&folder, name) {
            counts.add(kind, &Known { corners: frames.corners(kind, pair), collides });
        }
        counts.print(&format!("cloth-funnel/{name}"));
        assert_eq!((counts.queries, counts.colliding, counts.missed), (expected.0, expected.1, 0), "{name}");
        assert_eq!(counts.false_positives[3], 0, "{name} at {}", TOLERANCES[3]);
    }
}

/// The detector lists the triangles of every colliding query, and all its times are right: never late, and within the
/// tolerance.
#[test]
fn the_detector_lists_every_contact_of_the_cloth() {
    let Some(folder) = models("the_detector_lists_every_contact_of_the_cloth") else { return };
    let folder = folder.join("ccd_frames/cloth-funnel");
    let frames = Frames::read(&folder);
    let faces = frames.faces.iter().map(|face| face.map(|v| v as u32)).collect();
    let mesh = TriMesh::new(frames.vertices[0].clone(), faces).unwrap();
    let mut detector = Detector::new(&mesh);
    let impacts = detector.continuous(&frames.vertices[0], &frames.vertices[1]).unwrap();
    let times: BTreeMap<Pair, f64> = impacts.iter().map(|impact| (impact.pair, impact.time)).collect();

    let (mut queries, mut known) = (0, BTreeSet::new());
    for name in ["ee", "vf"] {
        for (elements, _) in read_pairs(&folder, name).into_iter().filter(|(_, collides)| *collides) {
            queries += 1;
            for pair in frames.triangles_around(elements) {
                // Exact times are compared below.
                assert!(times.contains_key(&pair), "{name} {elements:?}: {pair:?} is missing");
                known.insert(pair);
            }
        }
    }
    assert_eq!(queries, 107 + 27);
    assert!(known.len() > 134, "{}", known.len());

    let mut moving = 0;
    for (&(i, j), &time) in &times {
        let (x, y) = (frames.triangle(i), frames.triangle(j));
        let apart = distance(&x, &y, time);
        assert!(apart <= size(&x, &y) * (Impact::TOLERANCE + 1e-15), "{i} {j}: {apart} at {time}");
        if time > 0.0 {
            moving += 1;
            // Exact arithmetic is slow, so it is used for every eighth pair, and for those of the queries.
            if moving % 8 == 0 || known.contains(&(i, j)) {
                let contact = first_contact(&x, &y).map(|contact| contact.upper().to_f64().unwrap());
                assert!(
                    contact.is_none_or(|contact| time <= contact),
                    "{i} {j}: {time} is after {contact:?}"
                );
            }
        }
    }
    println!("{} impacts, {moving} of them not from the start; {} of the queries", times.len(), known.len());
    assert!(times.len() > 261 && moving > 50, "{} {moving}", times.len());
}

/// Returns the unit of tolerances: the largest difference of a corner from the first one of x, in any coordinate.
fn size(x: &MovingTriangle, y: &MovingTriangle) -> f64 {
    let ends = [[x.t0, y.t0], [x.t1, y.t1]];
    let differences = ends.iter().flat_map(|end| end.as_flattened().iter().map(|p| *p - end[0][0]));
    differences.map(|d| d.abs().max_element()).fold(0.0, f64::max)
}

#[test]
fn a_pierced_pair_collides_from_the_start() {
    let needle = [DVec3::new(0.2, 0.2, -5.0), DVec3::new(0.2, 0.2, 5.0), DVec3::new(0.2, 0.3, 5.0)];
    let face = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let still = MovingTriangle { t0: face, t1: face };
    let sliding = MovingTriangle { t0: needle, t1: needle.map(|p| p + DVec3::X * 0.1) };
    assert_eq!(impact_triangle_triangle(&still, &sliding, 1e-9), Some(0.0));
}
