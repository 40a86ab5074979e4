//! Positions differ from the real numbers of the standard by no more than docs/guarantees.md states.

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use glam::DVec3;

use crate::gltf::{SkinWeights, parse_scene};

/// A point as integers over a common denominator.
struct Fraction {
    over: [i128; 3],
    denominator: i128,
}

/// A node: a rotation about an axis by the angle with sine 24/25 and cosine 7/25, a scale and a translation in tenths.
struct Level {
    axis: usize,
    scale: [i64; 3],
    translation: [i64; 3],
}

/// Integers from a sequence without a pattern.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, count: u64) -> i64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) % count) as i64
    }
}

impl Level {
    fn random(numbers: &mut Numbers) -> Self {
        let axis = numbers.below(3) as usize;
        let scale = [0, 1, 2].map(|_| numbers.below(20) - 10).map(|s| if s == 0 { 3 } else { s });
        Self { axis, scale, translation: [0, 1, 2].map(|_| numbers.below(200) - 100) }
    }

    /// The node in the file, which shows mesh 0 or has a child.
    fn json(&self, content: &str) -> String {
        let tenths = |numbers: &[i64; 3]| {
            let tenth =
                |n: &i64| format!("{}{}.{}", if *n < 0 { "-" } else { "" }, n.abs() / 10, n.abs() % 10);
            numbers.iter().map(tenth).collect::<Vec<_>>().join(",")
        };
        // Half the angle has the sine 3/5 and the cosine 4/5.
        let mut rotation = ["0", "0", "0", "0.8"];
        rotation[self.axis] = "0.6";
        format!(
            r#"{{{content},"rotation":[{}],"scale":[{}],"translation":[{}]}}"#,
            rotation.join(","),
            tenths(&self.scale),
            tenths(&self.translation)
        )
    }

    /// Maps a point exactly.
    fn apply(&self, point: &Fraction) -> Fraction {
        let scaled: [i128; 3] = [0, 1, 2].map(|k| point.over[k] * i128::from(self.scale[k]));
        let (u, v) = ((self.axis + 1) % 3, (self.axis + 2) % 3);
        let mut over = scaled.map(|x| 25 * x);
        over[u] = 7 * scaled[u] - 24 * scaled[v];
        over[v] = 24 * scaled[u] + 7 * scaled[v];
        for (x, t) in over.iter_mut().zip(self.translation) {
            *x += 25 * point.denominator * i128::from(t);
        }
        Fraction { over, denominator: 250 * point.denominator }
    }
}

/// The bound of the guarantees: 2^-46 (n + 1) S for n nested nodes.
fn bound(levels: &[Level], point: DVec3) -> f64 {
    let (mut size, mut scale) = (0.0, 1.0);
    for level in levels {
        size += scale * DVec3::from_array(level.translation.map(|t| t as f64 / 10.0)).length();
        scale *= level.scale.iter().map(|s| s.abs()).max().unwrap() as f64 / 10.0;
    }
    2.0_f64.powi(-46) * (levels.len() + 1) as f64 * (size + scale * point.length())
}

#[test]
fn nested_nodes_are_as_accurate_as_stated() {
    const BITS: i32 = 60;
    let mut numbers = Numbers(7);
    let mut largest: f64 = 0.0;
    for nodes in 1..=6 {
        for _ in 0..200 {
            let levels: Vec<Level> = (0..nodes).map(|_| Level::random(&mut numbers)).collect();
            // Multiples of 1/8 are exact in single precision.
            let corners = [0, 1, 2].map(|_| [0, 1, 2].map(|_| numbers.below(200) - 100));
            let floats = corners.as_flattened().iter().map(|x| *x as f32 / 8.0);
            let data = BASE64.encode(floats.flat_map(f32::to_le_bytes).collect::<Vec<u8>>());
            let content = |number: usize| match number + 1 {
                next if next == nodes => r#""mesh":0"#.to_owned(),
                next => format!(r#""children":[{next}]"#),
            };
            let nodes_json: Vec<String> =
                levels.iter().enumerate().map(|(number, level)| level.json(&content(number))).collect();
            let file = format!(
                r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":36,"uri":"data:;base64,{data}"}}],
                "bufferViews":[{{"buffer":0,"byteLength":36}}],
                "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}],
                "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],"nodes":[{}]}}"#,
                nodes_json.join(",")
            );
            let scene = parse_scene(file.as_bytes()).unwrap();
            let mut found = Vec::new();
            scene.positions(nodes - 1, None, 0.0, SkinWeights::Normalized, &mut found).unwrap();
            for (corner, found) in corners.iter().zip(&found) {
                let start = Fraction { over: corner.map(i128::from), denominator: 8 };
                let exact = levels.iter().rev().fold(start, |point, level| level.apply(&point));
                let bound = bound(&levels, DVec3::from_array(corner.map(|x| x as f64 / 8.0)));
                for k in 0..3 {
                    let fixed = (found[k] * 2.0_f64.powi(BITS)) as i128;
                    let difference = fixed * exact.denominator - (exact.over[k] << BITS);
                    let error = difference as f64 / exact.denominator as f64 / 2.0_f64.powi(BITS);
                    largest = largest.max(error.abs() / bound);
                    assert!(error.abs() <= bound, "{error} of {bound}: {file}");
                }
            }
        }
    }
    // The bound is not far too large: the largest error exceeds a thousandth of it.
    assert!(largest > 1e-3, "{largest}");
}
