//! The order of crates and of modules that `layers.toml` declares, lowest first.

use std::collections::BTreeMap;
use std::path::Path;

use toml::de::DeValue;

use super::toml_file::TomlFile;

/// The file that declares the order, at the root of the workspace.
pub const FILE: &str = "layers.toml";

/// The declared order of crates and modules.
pub struct Order {
    pub crates: Levels,
    /// The levels of each crate, such as `sscc`, and folder of modules, such as `sscc/query`.
    pub folders: BTreeMap<String, Levels>,
}

/// Names in levels, lowest first.
#[derive(Default)]
pub struct Levels {
    pub rows: Vec<Vec<String>>,
    places: BTreeMap<String, Place>,
}

#[derive(Clone, Copy)]
pub struct Place {
    /// The level; 0 is the lowest.
    pub level: usize,
    /// The line in the file.
    pub line: usize,
}

impl Levels {
    /// Returns the place of a name; none if the order does not have it.
    pub fn place(&self, name: &str) -> Option<Place> {
        self.places.get(name).copied()
    }

    /// Returns all names with the lines of their declarations.
    pub fn entries(&self) -> impl Iterator<Item = (&str, usize)> {
        self.places.iter().map(|(name, place)| (name.as_str(), place.line))
    }

    /// Reads an array of strings: each is one level, the names in it are separated by spaces.
    fn read(file: &TomlFile, value: &toml::Spanned<DeValue<'_>>) -> Result<Self, String> {
        let at = |value: &toml::Spanned<DeValue<'_>>| format!("{}:{}", file.path, file.line(value.span()));
        let DeValue::Array(array) = value.get_ref() else {
            return Err(format!("{}: a list of levels was expected, lowest first", at(value)));
        };
        let mut levels = Self::default();
        for (level, row) in array.iter().enumerate() {
            let Some(names) = row.get_ref().as_str() else {
                return Err(format!("{}: a level is a string of names with spaces between them", at(row)));
            };
            for name in names.split_whitespace() {
                let place = Place { level, line: file.line(row.span()) };
                if levels.places.insert(name.to_owned(), place).is_some() {
                    return Err(format!("{}: '{name}' is declared twice", at(row)));
                }
            }
            levels.rows.push(names.split_whitespace().map(str::to_owned).collect());
        }
        Ok(levels)
    }
}

impl Order {
    /// Reads `layers.toml`; errors name the line.
    pub fn read(root: &Path) -> Result<Self, String> {
        let file = TomlFile::read(root, FILE)?;
        let mut order = Self { crates: Levels::default(), folders: BTreeMap::new() };
        for (key, value) in &file.parse()? {
            match (key.get_ref().as_ref(), value.get_ref()) {
                ("crates", _) => order.crates = Levels::read(&file, value)?,
                ("modules", DeValue::Table(folders)) => {
                    for (folder, value) in folders {
                        order.folders.insert(folder.get_ref().to_string(), Levels::read(&file, value)?);
                    }
                }
                (other, _) => {
                    let line = file.line(key.span());
                    return Err(format!("{FILE}:{line}: '{other}': crates and [modules] were expected"));
                }
            }
        }
        Ok(order)
    }
}
