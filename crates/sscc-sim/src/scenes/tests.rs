use std::path::Path;

use glam::DVec3;
use sscc_tasks::{Fix, ModesSpec, Resize, Shape};

use super::*;
use crate::error::Result;

const GOOD: &str = r#"
about = "two soft springs"
steps_per_second = 1000
duration = 0.25
gravity = [0, 0, -9.81]
[ground]
height = 0.5
friction = 0.3
[models.soft]
shape = "spring-4k"
kind = "linear"
rank = 12
size = 0.3
material = { youngs = 1e5, density = 900 }
damping = { mass = 0.5, stiffness = 1e-3 }
[[bodies]]
model = "soft"
position = [1, 2, 3]
rotation = { axis = [0, 0, 2], degrees = 90 }
velocity = [0, 0, -1.5]
shake = [0.1, -2]
[[bodies]]
model = "soft"
grid = [2, 1, 3]
spacing = [1, 1, 0.5]
turn = 10
"#;

fn parse(text: &str) -> Result<Scene> {
    Scene::parse(Path::new("scenes/good.toml"), text)
}

#[test]
fn a_scene_has_the_values_of_its_file() {
    let scene = parse(GOOD).unwrap();
    assert_eq!((scene.name.as_str(), scene.steps, scene.step, scene.bodies.len()), ("good", 250, 0.001, 7));
    assert_eq!((scene.gravity, scene.ground.unwrap().friction), (DVec3::new(0.0, 0.0, -9.81), 0.3));
    let model = &scene.models[0];
    assert_eq!(
        (model.recipe.name.as_str(), model.recipe.resize, model.damping.mass),
        ("soft", Resize::LongestSide(0.3), 0.5)
    );
    let material = model.recipe.material;
    assert_eq!(
        (material.youngs_modulus, material.poisson_ratio, material.density),
        (Some(1e5), None, Some(900.0))
    );
    assert!(model.is_linear && scene.sound.is_none());
    let [one, .., last] = &scene.bodies[..] else { panic!() };
    assert!((one.orientation * DVec3::X - DVec3::Y).length() < 1e-15 && one.shake.values == [0.1, -2.0]);
    assert_eq!(one.place(DVec3::ZERO), DVec3::new(1.0, 2.0, 3.0));
    // Without a position, the grid begins at the default: of held bodies their position in the file.
    let default = DVec3::new(5.0, 6.0, 7.0);
    assert_eq!((scene.bodies[1].place(default), last.place(default)), (default, DVec3::new(6.0, 6.0, 8.0)));
    assert!((last.orientation.to_axis_angle().1.to_degrees() - 50.0).abs() < 1e-12);
}

#[test]
fn errors_name_the_line_and_the_cause() {
    for (from, to, cause) in [
        ("gravity", "gravty", "line 5: unknown key 'gravty'; did you mean 'gravity'?"),
        ("size =", "sise =", "line 13: unknown key 'sise'; did you mean 'size'?"),
        ("youngs", "young", "line 14: unknown key 'young'; did you mean 'youngs'?"),
        ("turn", "t\\n", "line 26: "),
        (
            "\"spring-4k\"",
            "\"sprig\"",
            "line 10: shape: one of spring, spring-4k, bunny, dragon was expected",
        ),
        ("rank = 12", "rank = 0", "line 12: rank: a whole number from 1 to 500 was expected"),
        ("rank = 12", "rank = 1.5", "line 12: rank: a whole number"),
        ("density = 900", "density = -900", "line 14: density: a positive number was expected"),
        ("density = 900", "density = 0", "line 14: density: a positive number"),
        ("density = 900", "poisson = 0.5", "line 14: poisson: a number between -1 and 0.5"),
        ("= 1000", "= 0", "line 3: steps_per_second: a positive number"),
        ("= 1000", "= -1000", "line 3: steps_per_second: a positive number"),
        ("= 1000", "= nan", "line 3: steps_per_second: a number was expected"),
        (
            "= 1000",
            "= 300",
            "line 3: steps_per_second: the period of contacts of 100 Hz is less than 4 steps: raise",
        ),
        ("= 0.25", "= 1e9", "line 4: duration: 1e12 steps"),
        ("= 0.25", "= 1e-9", "line 4: duration: 0e0 steps"),
        ("steps_per_second = 1000", "", "line 1: steps_per_second: it is missing"),
        ("mass = 0.5", "mass = -0.5", "line 15: mass: a number that is not negative"),
        ("[1, 2, 3]", "[1, 2]", "line 18: position: a list of three numbers"),
        ("[1, 2, 3]", "3", "line 18: position: a list was expected"),
        ("[0, 0, 2]", "[0, 0, 0]", "line 19: axis: the axis is 0: give"),
        ("[2, 1, 3]", "[2, 1, 3e4]", "line 24: grid: three whole numbers"),
        ("[2, 1, 3]", "[2, 1, 0]", "line 24: grid: three whole numbers"),
        (
            "model = \"soft\"\ngrid",
            "model = \"sift\"\ngrid",
            "line 23: model: there is no such model; did you mean 'soft'?",
        ),
        ("shape = \"spring-4k\"", "", "shape: it is missing: give shape = \"NAME\" or file"),
        (
            "rank = 12",
            "rank = 12\ndynamics = \"nonlinear\"",
            "line 13: dynamics: linear modes have no nonlinear forces",
        ),
        (
            "kind = \"linear\"",
            "kind = \"polynomial\"",
            "line 12: rank: there are at most 24 polynomial modes: leave",
        ),
        ("rank = 12", "rank = 12\namplitudes = [1, 2]", "line 13: amplitudes: 2 numbers for 12 modes"),
        ("rank = 12", "rank = 1\nspread = [0]", "line 13: spread: numbers above 0 were expected"),
        (
            "rank = 12",
            "rank = 1\namplitudes = [1]\nspread = [1]",
            "line 14: spread: the same key as amplitudes: leave one of them out",
        ),
        ("[ground]", "[ground", "line 6: "),
        ("{ youngs = 1e5, density = 900 }", "\"stel\"", "line 14: material: one of steel, "),
        ("[0.1, -2]", "{ speed = [1], energy = [1] }", "line 21: shake: one of energy (J) and speed (m/s)"),
        ("[0.1, -2]", "{ force = [1] }", "line 21: unknown key 'force'"),
        ("rank = 12", "rank = 1", "line 21: shake: 2 numbers for 1 modes"),
        ("size = 0.3", "size = 0.3\nscale = 2", "line 14: scale: the model has both size and scale"),
        (
            "size = 0.3",
            "units = \"mm\"\nscale = 2",
            "line 13: units: the model has both units and size or scale",
        ),
        ("size = 0.3", "units = \"ft\"", "line 13: units: one of mm, cm, m, in was expected"),
        ("size = 0.3", "scale = 0", "line 13: scale: a positive number was expected"),
        ("size = 0.3", "fix = [0, 1.5]", "line 13: fix: vertex numbers, counted from 0, were expected"),
        ("size = 0.3", "fix = \"box:0,1\"", "line 13: fix: the value box: six numbers were expected"),
        ("size = 0.3", "fix = \"none.bou\"", "none.bou: not found"),
        ("size = 0.3", "forces = \"a.cub\"", "line 13: forces: this key needs file"),
        (
            "shape = \"spring-4k\"",
            "file = \"a.obj\"\nforces = \"a.cub\"",
            "line 11: forces: forces belong to modes",
        ),
        (
            "shape = \"spring-4k\"",
            "file = \"a.obj\"\nmodes = \"a.U\"",
            "line 12: kind: the file has its modes already: leave this key out",
        ),
        ("duration", "detection = \"magic\"\nduration", "line 4: detection: one of certified, kinetic, "),
        (
            "duration",
            "response = \"no\"\nduration",
            "line 4: response: one of contact, penalty, constrain, ignore",
        ),
    ] {
        let count = GOOD.matches(from).count();
        assert!(count == 1, "{from}: {count}");
        let refused = format!("{:#}", parse(&GOOD.replace(from, to)).unwrap_err());
        assert!(refused.starts_with("scenes/good.toml: ") && refused.contains(cause), "{refused}");
        assert!(!refused.contains('\n'), "{refused}");
    }
    let alone = &GOOD[..GOOD.find("[[bodies]]").unwrap()];
    assert!(parse(alone).unwrap_err().to_string().contains("line 1: bodies: the scene has no bodies: add"));
    let spaced = GOOD.replace("grid = [2, 1, 3]\n", "");
    assert!(parse(&spaced).unwrap_err().to_string().contains("turn: this key needs grid"));
    let long = GOOD.replace("rank = 12", "shake = 1").replace("shake = [0.1, -2]", "");
    assert!(parse(&long).unwrap_err().to_string().contains("unknown key 'shake'"));
    let brackets = format!("a = {}", "[".repeat(100_000));
    assert!(parse(&brackets).is_err());
}

#[test]
fn models_are_surfaces_solids_or_files_with_modes() {
    let model = |keys: &str| {
        let bodies = "[[bodies]]\nmodel = \"m\"\nshake = { energy = [1, 2, 3] }\n";
        let text = format!("steps_per_second = 1000\nduration = 1\n[models.m]\n{keys}\n{bodies}");
        let scene = parse(&text).unwrap();
        (scene.models[0].recipe.clone(), scene.bodies[0].shake.clone())
    };
    let (recipe, shake) = model("file = \"x.model.safetensors\"\ndynamics = \"linear\"\nscale = 0.01");
    let Shape::Model(files) = recipe.shape else { panic!("{recipe:?}") };
    assert_eq!(
        (files.path.as_path(), files.is_linear),
        (Path::new("scenes/x.model.safetensors"), Some(true))
    );
    assert!(matches!(recipe.modes, ModesSpec::Given) && recipe.resize == Resize::Factor(0.01));
    assert_eq!((shake.values, shake.unit), (vec![1.0, 2.0, 3.0], ShakeUnit::Energy));
    let (recipe, _) = model("file = \"a.obj\"\nmodes = \"a.U\"\nforces = \"a.cub\"\namplitudes = [1]");
    let Shape::Model(files) = recipe.shape else { panic!("{recipe:?}") };
    assert_eq!(files.forces.as_deref(), Some(Path::new("scenes/a.cub")));
    let (recipe, _) = model("file = \"a.obj\"\nsolid = \"a.veg\"\nkind = \"linear\"\nfix = [3, 0]");
    assert!(matches!(recipe.shape, Shape::Embedded { .. }));
    assert_eq!(recipe.fix, Some(Fix::Numbers(vec![3, 0])));
    let (recipe, _) = model("file = \"a.veg\"\nkind = \"linear\"\nfix = \"box:0,0,0,1,2,3\"");
    assert_eq!(recipe.fix, Some(Fix::Box([DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)])));
}

#[test]
fn shipped_scenes_have_the_sizes_of_the_paper() {
    let scenes = SHIPPED.map(|(name, text)| Scene::parse(Path::new(name), text).unwrap());
    let facts = scenes.each_ref().map(|scene| {
        let [model] = &scene.models[..] else { panic!("{}", scene.name) };
        (scene.name.as_str(), model.recipe.modes.rank(), scene.bodies.len(), model.is_linear)
    });
    let expected = [
        ("spring", Some(20), 1, true),
        ("bunny16", Some(30), 16, false),
        ("bunny128", Some(30), 128, false),
        ("dragon-nonlinear", Some(30), 1, false),
        ("dragon-polynomial", None, 1, true),
    ];
    assert_eq!(facts, expected);
    let [spring, ..] = &scenes;
    assert_eq!((spring.step, spring.sound.unwrap().modes), (1.0 / 44_100.0, 200));
}
