//! A q as typed: numbers, or weights of modes by name.

use sscc_io::LoadedModel;

use crate::error::{At, Result};
use crate::text::one_line;
use crate::{SimError, nearest};

/// The longest name that an error repeats.
const MAX_SHOWN: usize = 60;

/// Returns the q of `--q`: r numbers, or `NAME=WEIGHT,NAME=WEIGHT`, where modes that are not named are 0. A mode can also be
/// named by its number from 0.
///
/// # Errors
/// When an entry is no number, a name is unknown (the error has the nearest one), ambiguous or repeated, or q is not a
/// configuration of the model.
pub fn read_q(typed: &str, loaded: &LoadedModel) -> Result<Vec<f64>> {
    let number = |text: &str| {
        let refused = |_| SimError::refused("--q", format!("{} is not a number", quoted(text)));
        text.trim().parse::<f64>().map_err(refused)
    };
    let q = if typed.contains('=') {
        let mut q = vec![None; loaded.model.rank()];
        for part in typed.split(',') {
            let Some((name, weight)) = part.rsplit_once('=') else {
                let cause = format!("{} has no weight: NAME=WEIGHT was expected", quoted(part));
                return Err(SimError::refused("--q", cause));
            };
            let entry = &mut q[mode_of(name.trim(), loaded)?];
            if entry.replace(number(weight)?).is_some() {
                return Err(SimError::refused("--q", format!("{} is named twice", quoted(name))));
            }
        }
        q.into_iter().map(Option::unwrap_or_default).collect()
    } else {
        typed.split(',').map(number).collect::<Result<Vec<f64>>>()?
    };
    loaded.model.check_coordinates(&q).at(|| "--q".into())?;
    Ok(q)
}

/// Returns the number of a mode by its name, or by its number.
fn mode_of(name: &str, loaded: &LoadedModel) -> Result<usize> {
    let (names, rank) = (&loaded.mode_names, loaded.model.rank());
    let mut found = (0..names.len()).filter(|k| names[*k].trim() == name);
    if let Some(mode) = found.next() {
        return match found.next() {
            None => Ok(mode),
            Some(other) => Err(SimError::refused(
                "--q",
                format!("modes {mode} and {other} are both named {}: use their numbers", quoted(name)),
            )),
        };
    }
    if let Some(mode) = name.parse().ok().filter(|mode| *mode < rank) {
        return Ok(mode);
    }
    let advice = match nearest(name, names.iter().map(String::as_str)) {
        Some(nearest) => format!("the nearest name is {}; sscc info lists all", quoted(nearest)),
        None => format!("the modes of this model have no names; use numbers from 0 to {}", rank - 1),
    };
    Err(SimError::refused("--q", format!("there is no mode {}: {advice}", quoted(name))))
}

/// Returns the beginning of a text on one line, in quotes.
fn quoted(text: &str) -> String {
    let mut shown: String = one_line(text.trim()).chars().take(MAX_SHOWN + 1).collect();
    if shown.chars().count() > MAX_SHOWN {
        shown.pop();
        shown += "...";
    }
    format!("'{shown}'")
}

#[cfg(test)]
mod tests {
    use std::fs;

    use sscc_io::{LoadOptions, load_model_with};

    use super::*;

    #[test]
    fn weights_by_name_and_by_number() {
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
        let read = |typed: &str| read_q(typed, &loaded);
        assert_eq!(read("smile=0.5").unwrap(), [0.0, 0.5, 0.0]);
        assert_eq!(read(" smile = -2e-1 ,0=1").unwrap(), [1.0, -0.2, 0.0]);
        assert_eq!(read("x=1=3").unwrap(), [0.0, 0.0, 3.0]);
        assert_eq!(read("1, 2,-3").unwrap(), [1.0, 2.0, -3.0]);
        let message = |typed: &str| read(typed).unwrap_err().to_string();
        let unknown = "--q: there is no mode 'jawOpn': the nearest name is 'jawOpen'; sscc info lists all";
        assert_eq!(message("jawOpn=1"), unknown);
        assert_eq!(message("smile=1,smile=1"), "--q: 'smile' is named twice");
        assert_eq!(message("smile=1,0.5"), "--q: '0.5' has no weight: NAME=WEIGHT was expected");
        assert_eq!(message("smile=x\n"), "--q: 'x' is not a number");
        assert_eq!(message("1,,3"), "--q: '' is not a number");
        assert_eq!(message("1,2"), "--q: q has 2 entries, the model has 3 modes");
        assert_eq!(message("smile=inf"), "--q: q[1] is inf: every entry must be finite");
        assert!(message(&format!("{}=1", "a\u{7}".repeat(5000))).len() < 250);
        let mut twice = loaded.clone();
        twice.mode_names = vec!["a".into(), "b".into(), "a".into()];
        let ambiguous = read_q("a=1", &twice).unwrap_err().to_string();
        assert_eq!(ambiguous, "--q: modes 0 and 2 are both named 'a': use their numbers");
        let mut unnamed = loaded.clone();
        unnamed.mode_names.clear();
        assert_eq!(read_q("2=1", &unnamed).unwrap(), [0.0, 0.0, 1.0]);
        let no_names = read_q("3=1", &unnamed).unwrap_err().to_string();
        let expected =
            "--q: there is no mode '3': the modes of this model have no names; use numbers from 0 to 2";
        assert_eq!(no_names, expected);
    }
}
