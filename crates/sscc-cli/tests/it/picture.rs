//! `sscc certify --picture`: contents of the picture, and refusals.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::common::{files, sscc, strips};

const MODEL: &str = "strips.model.safetensors";

/// Height of a line of text (pixels).
const LINE: usize = 20;

/// Returns width, height and RGB pixels of a PNG file.
fn decode(path: &Path) -> (usize, usize, Vec<[u8; 3]>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(fs::read(path).unwrap())).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgb, png::BitDepth::Eight));
    (info.width as usize, info.height as usize, bytes.as_chunks().0.to_vec())
}

#[test]
fn views_in_both_directions_of_each_mode() {
    let directory = strips();
    let folder = directory.path();
    let args = ["certify", MODEL, "-o", "x.sscc.safetensors", "--picture", "x.png"];
    let run = sscc(folder, &args);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    assert!(run.stdout.ends_with("picture        x.png\n"), "{}", run.stdout);
    let (width, height, pixels) = decode(&folder.join("x.png"));
    // The shape at rest and two modes; the longer side of a view has 400 pixels. Names are above the views, weights below
    // each, and the radius is below all.
    let [w, h] = [width / 3, (height - 4 * LINE) / 2];
    assert_eq!((3 * w, 2 * h + 4 * LINE, w.max(h)), (width, height, 400));
    let view = |left: usize, top: usize| -> Vec<[u8; 3]> {
        (top..top + h).flat_map(|y| pixels[y * width + left..][..w].to_vec()).collect()
    };
    let rest = view(0, LINE + (h + LINE) / 2);
    let [upper, lower] = [LINE, h + 2 * LINE];
    let along = [(w, upper), (w, lower), (2 * w, upper), (2 * w, lower)].map(|(left, top)| view(left, top));
    let label = |left: usize, top: usize| -> Vec<[u8; 3]> {
        (top..top + LINE).flat_map(|y| pixels[y * width + left..][..w].to_vec()).collect()
    };
    let labels = [(w, 0), (2 * w, 0), (w, h + LINE), (w, 2 * h + 2 * LINE), (0, LINE + (h + LINE) / 2 + h)]
        .map(|(left, top)| label(left, top));
    for text in &labels {
        let ink = text.iter().filter(|pixel| pixel.iter().all(|byte| *byte < 100)).count();
        assert!((50..text.len() / 4).contains(&ink), "{ink} pixels of ink");
    }
    assert_eq!(labels.iter().collect::<BTreeSet<_>>().len(), labels.len(), "all labels differ");
    // No label beside the names of modes.
    assert!(label(0, 0).iter().all(|pixel| *pixel == pixels[0]));
    for shown in along.iter().chain([&rest]) {
        let colors: BTreeSet<[u8; 3]> = shown.iter().copied().collect();
        assert!(colors.len() > 5, "{} colours", colors.len());
        let background = shown.iter().filter(|pixel| **pixel == shown[0]).count();
        assert!((shown.len() / 4..shown.len()).contains(&background), "{background} of {}", shown.len());
    }
    let views: BTreeSet<&Vec<[u8; 3]>> = along.iter().chain([&rest]).collect();
    assert_eq!(views.len(), 5, "all views differ");

    // Picture and certificates do not depend on threads, nor certificates on --picture.
    let first = fs::read(folder.join("x.png")).unwrap();
    assert_eq!(sscc(folder, &[&args[..], &["--threads", "1", "--json"]].concat()).code, Some(0));
    assert_eq!(fs::read(folder.join("x.png")).unwrap(), first);
    let [with, without] =
        ["x.sscc.safetensors", "strips.sscc.safetensors"].map(|name| fs::read(folder.join(name)).unwrap());
    assert_eq!(with, without);
}

#[test]
fn without_a_finite_radius_the_picture_shows_the_centre() {
    let directory = strips();
    let folder = directory.path();
    sscc_io::write_npy(&folder.join("still.npy"), &[72, 1], &[0.0; 72]).unwrap();
    let still = ["mesh.obj", "--modes", "still.npy"];
    let touching = ["mesh.obj", "--modes", "modes.npy", "--center=1,0", "--max-exceptions=0"];
    for (model, radius) in [(&still[..], "unlimited"), (&touching, "0")] {
        let output = ["-o", "x.sscc.safetensors", "--picture", "x.png"];
        let run = sscc(folder, &[&["certify"], model, &output].concat());
        assert_eq!(run.code, Some(0), "{run:?}");
        let note =
            format!("note: the root radius is {radius}: the picture shows the shape at the centre alone\n");
        assert!(run.stderr.ends_with(&note), "{}", run.stderr);
        let (width, height, pixels) = decode(&folder.join("x.png"));
        assert_eq!(width.max(height - LINE), 400);
        assert!(pixels.iter().any(|pixel| *pixel != pixels[0]));
    }
}

#[test]
fn pictures_that_cannot_be_written_are_refused_first() {
    let directory = strips();
    let folder = directory.path();
    fs::create_dir(folder.join("folder.png")).unwrap();
    let before = files(folder);
    for (picture, named) in [
        ("x.jpg", "x.jpg: the name of the output must end in .png"),
        (".png", ".png: the name of the output must end in .png"),
        ("missing/x.png", "missing/x.png: cannot be written"),
        ("folder.png", "folder.png: cannot be written: it is not a file"),
    ] {
        let run = sscc(folder, &["certify", MODEL, "-o", "x.sscc.safetensors", "--picture", picture]);
        assert!(run.refusal().contains(named), "{run:?}");
        assert_eq!(files(folder), before);
    }
}
