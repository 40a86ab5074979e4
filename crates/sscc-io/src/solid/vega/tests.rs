use std::path::Path;

use glam::DVec3;
use sscc_solid::VolumeMesh;

use super::*;

const TETS: &str = "# a body\n*VERTICES\n5 3 0 0\n1 0 0 0\n2, 1, 0, 0\n3\t0 1 0\n4 0 0 1\n5 1 1 1\n\n*ELEMENTS\nTET\n\
    2 4 0\n1 1 2 3 4\n2 2,3,4,5\n*MATERIAL soft rubber\nENU, 1000, 1e6, 0.45\n*MATERIAL hard\nENU,2000,1e9,0.3\n\
    *SET top\n2,\n*REGION\nallElements, softrubber\n*REGION,\ntop, hard\n";

const CUBE: &str = "*VERTICES\n8 3 0 0\n0 0 0 0\n1 1 0 0\n2 1 1 0\n3 0 1 0\n4 0 0 1\n5 1 0 1\n6 1 1 1\n7 0 1 1\n\
    *ELEMENTS\nCUBIC\n1 8 0\n0 0 1 2 3 4 5 6 7\n";

fn message(text: &str) -> String {
    parse(text.as_bytes()).unwrap_err().to_string()
}

fn with(from: &str, to: &str) -> String {
    assert!(TETS.contains(from), "{from}");
    message(&TETS.replace(from, to))
}

#[test]
fn sections_are_read() {
    let mesh = parse(TETS.as_bytes()).unwrap();
    assert_eq!((mesh.vertices()[1], mesh.vertices().len()), (DVec3::X, 5));
    assert_eq!(mesh.tets(), [[0, 1, 2, 3], [1, 2, 3, 4]]);
    let [soft, hard] = mesh.materials() else { panic!("two materials") };
    assert_eq!((soft.name.as_str(), hard.stated.density), ("softrubber", Some(2000.0)));
    assert_eq!(mesh.element_material(), [0, 1]);
    assert_eq!(parse(TETS.replace('\n', " \r\n").as_bytes()).unwrap(), mesh);
    let cube = parse(CUBE.as_bytes()).unwrap();
    assert_eq!((cube.cubes(), cube.vertices()[6]), (&[[0, 1, 2, 3, 4, 5, 6, 7]][..], DVec3::ONE));
    assert_eq!((cube.materials()[0].name.as_str(), cube.materials()[0].stated.density), ("default", None));
}

#[test]
fn the_last_region_decides() {
    let materials = |text: &str| parse(text.as_bytes()).unwrap().element_material().to_vec();
    // In the other order, the region of all elements overrides the set.
    let swapped = TETS.replace("top, hard\n", "").replace("*REGION\nall", "*REGION\ntop, hard\n*REGION\nall");
    assert_eq!(materials(&swapped.replace("*REGION,\n", "")), [0, 0]);
    // Elements without a region get the last material.
    assert_eq!(materials(&TETS.replace("*REGION\nallElements, softrubber\n", "")), [1, 1]);
    let without = TETS.split("*REGION").next().unwrap();
    assert_eq!(materials(without), [1, 1]);
    assert_eq!(materials(&TETS.replace("top, hard", "top, softrubber")), [0, 0]);
    // Another region uses the same set with another material.
    let again = format!("{TETS}*SET bottom\n1\n*REGION\nbottom,hard\n*REGION\ntop,softrubber\n");
    assert_eq!(materials(&again), [1, 0]);
}

#[test]
fn errors_name_the_line() {
    assert_eq!(message("v 0 0 0\n"), "line 1: a section (*VERTICES, ...) was expected, not 'v 0 0 0'");
    assert_eq!(message("*PLANES\n"), "line 1: the section '*PLANES' is not known");
    assert_eq!(message("*VERTICES\n"), "the number of vertices is missing in *VERTICES");
    assert_eq!(message("*ELEMENTS\n"), "line 1: *ELEMENTS comes before *VERTICES");
    assert_eq!(message("*MATERIAL a\n*SET b\n"), "line 2: the values are missing in *MATERIAL");
    assert_eq!(with("5 3 0 0", "5 2 0 0"), "line 3: the section declares 2 coordinates: 3 were expected");
    assert_eq!(with("5 3 0 0", "6 3 0 0"), "line 3: the file has 5 of the 6 vertices declared here");
    assert_eq!(with("5 3 0 0", "4 3 0 0"), "line 8: the section has more vertices than the declared 4");
    assert_eq!(with("4 0 0 1", "4 0 0 nan"), "line 7: 'nan' is not a finite number");
    assert_eq!(
        with("4 0 0 1", "4 0 0 -2e60"),
        "line 7: a coordinate is not finite, or beyond 2^200: repair it, or change the unit"
    );
    let gaps = "are numbered from 0 or 1 without gaps:";
    assert_eq!(with("4 0 0 1", "5 0 0 1"), format!("line 7: vertices {gaps} 4 was expected, not 5"));
    assert_eq!(with("\n1 1 2 3 4", "\n7 1 2 3 4"), format!("line 13: elements {gaps} 1 was expected, not 7"));
    assert_eq!(
        with("TET\n", "HEX\n"),
        "line 11: elements of kind 'HEX' are not supported: only TET and CUBIC are"
    );
    assert_eq!(with("2 4 0", "2 10 0"), "line 12: the section declares 10 corners: 4 were expected");
    assert_eq!(with("2 4 0", "3 4 0"), "line 12: the file has 2 of the 3 elements declared here");
    assert_eq!(
        with("2 2,3,4,5", "2 2 3 4 6"),
        "line 14: the element names vertex 6 (counted from 1), but there are 5"
    );
    assert_eq!(
        with("2 2,3,4,5", "2 2 3 4 0"),
        "line 14: the element names vertex 0, but vertices are counted from 1"
    );
    assert_eq!(with("2 2,3,4,5", "2 2 3 4 4"), "line 14: the element names vertex 4 (counted from 1) twice");
    assert_eq!(with("2 2,3,4,5", "2 2 3 4"), "line 14: an element has 4 corners, this one has 3");
    assert_eq!(
        with("0.45", "0.5"),
        "line 16: E = 1000000, nu = 0.5: E must be above 0 and finite, nu above -1 and below 0.5"
    );
    assert_eq!(with("L hard", "L soft rubber"), "line 17: the material 'softrubber' is repeated");
    assert_eq!(with("\n2,\n", "\n3\n"), "line 20: there is no element 3");
    assert_eq!(with("\n2,\n", "\n0\n"), "line 20: there is no element 0");
    assert_eq!(with("top, hard", "top"), "line 24: 'set, material' was expected, not 'top'");
    assert_eq!(
        with("top, hard", "tip, hard"),
        "line 24: the region names the set 'tip', which does not exist"
    );
    let wood = "line 24: the region names the material 'wood', which does not exist";
    assert_eq!(with("top, hard", "top, wood"), wood);
    assert_eq!(
        with("*MATERIAL hard", "*ELEMENTS"),
        "line 17: the section *ELEMENTS is repeated: a file has one kind of elements"
    );
}

#[test]
fn truncations_are_rejected_or_lack_only_materials() {
    let whole = parse(TETS.as_bytes()).unwrap();
    let elements = TETS.find("4,5\n").unwrap() + 3;
    for len in 0..TETS.len() {
        // Whole lines after the elements may be missing: they define materials only.
        if let Ok(mesh) = parse(&TETS.as_bytes()[..len]) {
            let is_whole = (mesh.vertices(), mesh.tets()) == (whole.vertices(), whole.tets());
            assert!(len >= elements && is_whole, "{len}");
        }
    }
    for len in 0..CUBE.len() - 2 {
        assert!(parse(&CUBE.as_bytes()[..len]).is_err(), "{len}");
    }
}

fn read_files(main: &str, others: &[(&str, &str)]) -> Result<VolumeMesh, String> {
    let directory = tempfile::tempdir().unwrap();
    for (name, text) in [("main.veg", main)].iter().chain(others) {
        let path = directory.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    let shown = format!("{}/", directory.path().display());
    read(&directory.path().join("main.veg")).map_err(|error| error.to_string().replace(&shown, ""))
}

const NODE: &str = "# from TetGen\n4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n# Generated\n";

#[test]
fn files_are_included() {
    let main =
        "*VERTICES\n*INCLUDE parts/a.node\n*ELEMENTS\nTET\n*INCLUDE ./a.ele\n*MATERIAL a\nENU,1,2,0.3\n";
    let files = [("parts/a.node", NODE), ("a.ele", "1 4 0\n1 1 2 3 4\n")];
    let mesh = read_files(main, &files).unwrap();
    assert_eq!((mesh.vertices().len(), mesh.tets()), (4, &[[0, 1, 2, 3]][..]));
    assert!(parse(main.as_bytes()).unwrap_err().to_string().starts_with("line 2: *INCLUDE refers to a file"));
    let error = |main: &str, others: &[(&str, &str)]| read_files(main, others).unwrap_err();
    assert_eq!(
        error(main, &files[..1]),
        "main.veg: line 5: the file includes './a.ele', which does not exist"
    );
    let nested = error("*INCLUDE a\n", &[("a", "# a\n\n*INCLUDE b\n")]);
    assert_eq!(nested, "main.veg: a: line 3: the file includes 'b', which does not exist");
    let bad = [files[0], ("a.ele", "1 4 0\n1 1 2 3 x\n")];
    assert_eq!(error(main, &bad), "main.veg: ./a.ele: line 2: 'x' is not a number of a vertex or element");
    let late = [files[0], ("a.ele", "1 4 0\n1 1 2 3 9\n")];
    assert_eq!(
        error(main, &late),
        "main.veg: ./a.ele: line 2: the element names vertex 9 (counted from 1), but there are 4"
    );
    assert_eq!(
        error(main, &[files[0], ("a.ele", "# nothing\n")]),
        "main.veg: line 6: the number of elements is missing in *ELEMENTS"
    );
}

#[test]
fn loops_and_other_folders_are_rejected() {
    let error = |main: &str, others: &[(&str, &str)]| read_files(main, others).unwrap_err();
    assert_eq!(error("*INCLUDE main.veg\n", &[]), "main.veg: line 1: 'main.veg' is included a second time");
    let looped = error("*INCLUDE a\n", &[("a", "# a\n*INCLUDE b\n"), ("b", "*INCLUDE ./a\n")]);
    assert_eq!(looped, "main.veg: b: line 1: './a' is included a second time");
    let elsewhere = ["../a", "/etc/passwd", "b/../../a", "", ".", "..", "a\\b", "c:a"];
    for name in elsewhere {
        let message = error(&format!("*INCLUDE {name}\n"), &[]);
        let end = "is not a file in the same folder or below";
        assert!(message.starts_with("main.veg: line 1: '") && message.ends_with(end), "{message}");
    }
    let chain: Vec<_> = (0..10).map(|i| (format!("{i}"), format!("*INCLUDE {}\n", i + 1))).collect();
    let chain: Vec<_> = chain.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
    assert!(error("*INCLUDE 0\n", &chain).starts_with("main.veg: 7: line 1: too many included files"));
    let many: Vec<_> = (0..65).map(|i| (format!("{i}"), "# nothing\n")).collect();
    let many: Vec<_> = many.iter().map(|(name, text)| (name.as_str(), *text)).collect();
    let main: String = (0..65).map(|i| format!("*INCLUDE {i}\n")).collect();
    assert!(error(&main, &many).starts_with("main.veg: line 65: too many included files"));
    assert!(read(Path::new("/nowhere/a.veg")).unwrap_err().to_string().ends_with("not found"));
}
