//! The numbers of a figure as a table.

use sscc_bench::FigureRecord;

/// Returns the lines of a figure: its model, notes, and a row for each point.
pub fn figure_lines(record: &FigureRecord) -> Vec<String> {
    let mut lines = vec![format!("{}: {}", record.scenario, record.source)];
    lines.extend(record.note.iter().map(|note| format!("note: {note}")));
    let Some(first) = record.rows.first() else { return lines };
    let names: Vec<String> = first.0.iter().map(|(name, _)| name.replace('_', " ")).collect();
    let line = |cells: Vec<String>| {
        let padded = cells.iter().zip(&names).map(|(cell, name)| format!("{cell:>0$}", name.len().max(10)));
        format!("  {}", padded.collect::<Vec<_>>().join("  "))
    };
    lines.push(line(names.clone()));
    let text = |value: &f64| if value.fract() == 0.0 { format!("{value}") } else { format!("{value:.4}") };
    lines.extend(record.rows.iter().map(|row| line(row.0.iter().map(|(_, value)| text(value)).collect())));
    lines
}
