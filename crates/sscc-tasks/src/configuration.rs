//! A q as a user states it: numbers, weights of modes by name, or a file.

use std::path::Path;

use sscc_io::{LoadedModel, Message, Setting, read_vector};

use crate::error::{At, Result};
use crate::text::quoted;
use crate::{TaskError, nearest};

/// Returns the q that a setting states: r numbers with commas; `NAME=WEIGHT,NAME=WEIGHT`, where the other modes are 0; or a
/// file of r numbers. A mode can also be named by its number from 0.
///
/// # Errors
/// When an entry is not a number, a name is unknown (the error states the nearest name), ambiguous or repeated, the file
/// cannot be read, or q is not a configuration of the model.
pub fn read_configuration(setting: Setting, typed: &str, loaded: &LoadedModel) -> Result<Vec<f64>> {
    let mut place = Message::from(setting);
    let q = match typed.split(',').map(number).collect() {
        Ok(numbers) => numbers,
        Err(_) if Path::new(typed).exists() || !typed.contains(['=', ',']) => {
            place = setting + format!(" {typed}");
            let cause = " is not a list of numbers, so it must be a file";
            read_vector(Path::new(typed)).at(|| setting + cause)?
        }
        Err(_) if typed.contains('=') => {
            by_name(typed, loaded).map_err(|cause| TaskError::refused(setting, cause))?
        }
        Err(cause) => return Err(TaskError::refused(setting, cause)),
    };
    loaded.model.check_coordinates(&q).at(|| place)?;
    Ok(q)
}

fn number(text: &str) -> std::result::Result<f64, String> {
    text.trim().parse().map_err(|_| format!("{} is not a number", quoted(text)))
}

/// Returns the q of `NAME=WEIGHT,NAME=WEIGHT`, or the cause of its refusal.
fn by_name(typed: &str, loaded: &LoadedModel) -> std::result::Result<Vec<f64>, String> {
    let mut q = vec![None; loaded.model.rank()];
    for part in typed.split(',') {
        let Some((name, weight)) = part.rsplit_once('=') else {
            return Err(format!("{} has no weight: NAME=WEIGHT was expected", quoted(part)));
        };
        let entry = &mut q[mode_of(name.trim(), loaded)?];
        if entry.replace(number(weight)?).is_some() {
            return Err(format!("{} is named twice", quoted(name)));
        }
    }
    Ok(q.into_iter().map(Option::unwrap_or_default).collect())
}

/// Returns the number of a mode by its name, or by its number.
fn mode_of(name: &str, loaded: &LoadedModel) -> std::result::Result<usize, String> {
    let (names, rank) = (&loaded.mode_names, loaded.model.rank());
    let mut found = (0..names.len()).filter(|k| names[*k].trim() == name);
    if let Some(mode) = found.next() {
        return match found.next() {
            None => Ok(mode),
            Some(other) => {
                Err(format!("modes {mode} and {other} are both named {}: use their numbers", quoted(name)))
            }
        };
    }
    if let Some(mode) = name.parse().ok().filter(|mode| *mode < rank) {
        return Ok(mode);
    }
    let advice = match nearest(name, names.iter().map(String::as_str)) {
        Some(nearest) => format!("the nearest name is {}; sscc info lists all", quoted(nearest)),
        None => format!("the modes of this model have no names; use numbers from 0 to {}", rank - 1),
    };
    Err(format!("there is no mode {}: {advice}", quoted(name)))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use sscc_io::{LoadOptions, load_model_with};

    use super::*;

    #[test]
    fn a_q_is_read_from_numbers_names_and_files() {
        let folder = tempfile::tempdir().unwrap();
        let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        let [mesh, targets] = ["a.obj", "targets"].map(|name| folder.path().join(name));
        fs::write(&mesh, obj).unwrap();
        fs::create_dir(&targets).unwrap();
        for name in ["jawOpen", "smile", "x=1"] {
            fs::write(targets.join(format!("{name}.obj")), obj.replace("v 1 0 0", "v 1 0 2")).unwrap();
        }
        let loaded = load_model_with(&mesh, &LoadOptions::new(Some(&targets), None)).unwrap();
        assert_eq!(loaded.mode_names, ["jawOpen", "smile", "x=1"]);
        let read = |typed: &str| read_configuration(Setting::Q, typed, &loaded);
        assert_eq!(read("smile=0.5").unwrap(), [0.0, 0.5, 0.0]);
        assert_eq!(read(" smile = -2e-1 ,0=1").unwrap(), [1.0, -0.2, 0.0]);
        assert_eq!(read("x=1=3").unwrap(), [0.0, 0.0, 3.0]);
        assert_eq!(read("1, 2,-3").unwrap(), [1.0, 2.0, -3.0]);
        // The text is a file, even if its name has the characters of names and lists.
        for name in ["q.txt", "smile=1,2.txt"] {
            let file = folder.path().join(name);
            fs::write(&file, "3 2\n1").unwrap();
            assert_eq!(read(file.to_str().unwrap()).unwrap(), [3.0, 2.0, 1.0]);
        }
        let message = |typed: &str| read(typed).unwrap_err().to_string();
        let unknown = "q: there is no mode 'jawOpn': the nearest name is 'jawOpen'; sscc info lists all";
        assert_eq!(message("jawOpn=1"), unknown);
        assert_eq!(message("smile=1,smile=1"), "q: 'smile' is named twice");
        assert_eq!(message("smile=1,0.5"), "q: '0.5' has no weight: NAME=WEIGHT was expected");
        assert_eq!(message("smile=x\n"), "q: 'x' is not a number");
        assert_eq!(message("1,,3"), "q: '' is not a number");
        assert!(message("none.txt").contains("q is not a list of numbers, so it must be a file"));
        assert_eq!(message("1,2"), "q: q has 2 entries, the model has 3 modes");
        assert_eq!(message("smile=inf"), "q: q[1] is inf: every entry must be finite");
        assert!(message(&format!("{}=1", "a\u{7}".repeat(5000))).len() < 250);
        let mut twice = loaded.clone();
        twice.mode_names = vec!["a".into(), "b".into(), "a".into()];
        let ambiguous = read_configuration(Setting::Q, "a=1", &twice).unwrap_err().to_string();
        assert_eq!(ambiguous, "q: modes 0 and 2 are both named 'a': use their numbers");
        let mut unnamed = loaded.clone();
        unnamed.mode_names.clear();
        assert_eq!(read_configuration(Setting::Q, "2=1", &unnamed).unwrap(), [0.0, 0.0, 1.0]);
        let no_names = read_configuration(Setting::Q, "3=1", &unnamed).unwrap_err().to_string();
        let expected =
            "q: there is no mode '3': the modes of this model have no names; use numbers from 0 to 2";
        assert_eq!(no_names, expected);
    }
}
