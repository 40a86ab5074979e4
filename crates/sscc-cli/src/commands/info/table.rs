//! Tables and lists in columns, as text.

/// Maximum number of rows; the JSON has all.
const MAX_ROWS: usize = 100;

/// Maximum width of a line of columns.
const WIDTH: usize = 100;

/// Rows of numbers, each followed by a name.
pub struct Table<const N: usize> {
    titles: [&'static str; N],
    rows: Vec<([String; N], String)>,
    left_out: usize,
}

impl<const N: usize> Table<N> {
    pub fn new(titles: [&'static str; N]) -> Self {
        Self { titles, rows: Vec::new(), left_out: 0 }
    }

    pub fn row(&mut self, numbers: [String; N], name: String) {
        match self.rows.len() < MAX_ROWS {
            true => self.rows.push((numbers, name)),
            false => self.left_out += 1,
        }
    }

    /// Returns the titles and the rows, with numbers aligned to the right; no lines without rows.
    pub fn lines(self) -> Vec<String> {
        if self.rows.is_empty() {
            return Vec::new();
        }
        let titles = (self.titles.map(str::to_owned), "name".to_owned());
        let rows = || std::iter::once(&titles).chain(&self.rows);
        let widths: [usize; N] =
            std::array::from_fn(|at| rows().map(|(numbers, _)| numbers[at].len()).max().unwrap_or(0));
        let line = |(numbers, name): &([String; N], String)| {
            let cells = numbers.iter().zip(widths).map(|(number, width)| format!("{number:>width$}  "));
            format!("{}{name}", cells.collect::<String>())
        };
        let more = (self.left_out > 0).then(|| format!("... and {} more; --json lists all", self.left_out));
        rows().map(line).chain(more).collect()
    }
}

/// Returns entries in columns of one width, row by row.
pub fn columns(entries: impl Iterator<Item = String>) -> Vec<String> {
    let entries: Vec<String> = entries.collect();
    let width = 2 + entries.iter().map(|entry| entry.chars().count()).max().unwrap_or(0);
    let line = |row: &[String]| {
        let cells: String = row.iter().map(|entry| format!("  {entry:<width$}")).collect();
        cells.trim_end().to_owned()
    };
    entries.chunks((WIDTH / (width + 2)).max(1)).map(line).collect()
}
