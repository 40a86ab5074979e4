//! Reads tables of a scene file. Errors name the file and the line.

use std::fmt::Display;
use std::ops::Range;
use std::path::Path;

use glam::DVec3;
use sscc_tasks::text::one_line;
use sscc_tasks::{did_you_mean, nearest};
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

use crate::error::{Result, SimError};

/// Text of a file, from which errors compute the line.
#[derive(Clone, Copy)]
pub struct Text<'a> {
    pub path: &'a Path,
    pub text: &'a str,
}

impl Text<'_> {
    /// Returns an error at a place in the text.
    pub fn refused(self, span: &Range<usize>, cause: impl Display) -> SimError {
        let line = 1 + self.text.bytes().take(span.start).filter(|byte| *byte == b'\n').count();
        SimError::Scene { path: self.path.to_owned(), line, cause: cause.to_string() }
    }
}

/// A table whose keys are all known.
pub struct Section<'a> {
    text: Text<'a>,
    table: &'a DeTable<'a>,
    /// Range of the table in the text.
    span: Range<usize>,
}

impl<'a> Section<'a> {
    /// Creates the section of a table.
    ///
    /// # Errors
    /// When the table has a key that is not in `keys`.
    pub fn new(text: Text<'a>, table: &'a Spanned<DeTable<'a>>, keys: &[&str]) -> Result<Self> {
        Self::within(text, table.get_ref(), table.span(), keys)
    }

    fn within(text: Text<'a>, table: &'a DeTable<'a>, span: Range<usize>, keys: &[&str]) -> Result<Self> {
        // The table is sorted by key; the error names the unknown key that is first in the file.
        let unknown = table.keys().filter(|key| !keys.contains(&key.get_ref().as_ref()));
        match unknown.min_by_key(|key| key.span().start) {
            None => Ok(Self { text, table, span }),
            Some(key) => {
                let typed: String = key.get_ref().chars().take(40).collect();
                let meant = nearest(&typed, keys.iter().copied()).unwrap_or_default();
                let cause = format!("unknown key '{}'; did you mean '{meant}'?", one_line(&typed));
                Err(text.refused(&key.span(), cause))
            }
        }
    }

    fn value(&self, key: &str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.table.get(key)
    }

    /// Returns an error at a key, or at the table if the key is missing.
    pub fn refused(&self, key: &str, cause: impl Display) -> SimError {
        let span = self.value(key).map_or(self.span.clone(), Spanned::span);
        self.text.refused(&span, format_args!("{key}: {cause}"))
    }

    /// Returns the error of a value of another type.
    fn expected<T>(&self, key: &str, description: &str) -> Result<T> {
        Err(self.refused(key, format_args!("{description} was expected")))
    }

    /// Returns the value of a required key.
    ///
    /// # Errors
    /// When the key is missing.
    pub fn require<T>(&self, key: &str, found: Option<T>) -> Result<T> {
        found.ok_or_else(|| self.refused(key, "it is missing"))
    }

    /// Whether the table has the key.
    pub fn has(&self, key: &str) -> bool {
        self.value(key).is_some()
    }

    /// Returns the name of a key that the table has, out of two names; the first if it has neither.
    ///
    /// # Errors
    /// When the table has both.
    pub fn either<'k>(&self, [name, alias]: [&'k str; 2]) -> Result<&'k str> {
        match (self.has(name), self.has(alias)) {
            (true, true) => {
                Err(self.refused(alias, format_args!("the same key as {name}: leave one of them out")))
            }
            (false, true) => Ok(alias),
            _ => Ok(name),
        }
    }

    /// Reads a finite number.
    pub fn number(&self, key: &str) -> Result<Option<f64>> {
        let Some(value) = self.value(key) else { return Ok(None) };
        finite(value.get_ref()).map_or_else(|| self.expected(key, "a number"), |x| Ok(Some(x)))
    }

    /// Reads a number above 0.
    pub fn positive(&self, key: &str) -> Result<Option<f64>> {
        match self.number(key)? {
            Some(x) if x <= 0.0 => self.expected(key, "a positive number"),
            found => Ok(found),
        }
    }

    /// Reads a number of at least 0.
    pub fn not_negative(&self, key: &str) -> Result<Option<f64>> {
        match self.number(key)? {
            Some(x) if x < 0.0 => self.expected(key, "a number that is not negative"),
            found => Ok(found),
        }
    }

    /// Reads a whole number from 1 to `max`.
    pub fn count(&self, key: &str, max: usize) -> Result<Option<usize>> {
        let Some(value) = self.value(key) else { return Ok(None) };
        match whole(value.get_ref()) {
            Some(count) if (1..=max).contains(&count) => Ok(Some(count)),
            _ => self.expected(key, &format!("a whole number from 1 to {max}")),
        }
    }

    /// Reads a text.
    pub fn text(&self, key: &str) -> Result<Option<&'a str>> {
        match self.value(key).map(Spanned::get_ref) {
            None => Ok(None),
            Some(DeValue::String(text)) => Ok(Some(text)),
            Some(_) => self.expected(key, "a text"),
        }
    }

    /// Whether the value of the key is a text.
    pub fn is_text(&self, key: &str) -> bool {
        self.value(key).is_some_and(|value| value.get_ref().is_str())
    }

    /// Whether the value of the key is a table.
    pub fn is_table(&self, key: &str) -> bool {
        self.value(key).is_some_and(|value| matches!(value.get_ref(), DeValue::Table(_)))
    }

    /// Reads one of some words, and returns its meaning.
    pub fn word<T: Copy>(&self, key: &str, words: &[(&str, T)]) -> Result<Option<T>> {
        let Some(typed) = self.text(key)? else { return Ok(None) };
        match words.iter().find(|(word, _)| *word == typed) {
            Some((_, meaning)) => Ok(Some(*meaning)),
            None => {
                let names: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
                let meant = did_you_mean(typed, names.iter().copied());
                Err(self.refused(key, format_args!("one of {} was expected{meant}", names.join(", "))))
            }
        }
    }

    /// Reads a list of finite numbers.
    pub fn numbers(&self, key: &str) -> Result<Option<Vec<f64>>> {
        let Some(array) = self.array(key)? else { return Ok(None) };
        let numbers: Option<Vec<f64>> = array.iter().map(|value| finite(value.get_ref())).collect();
        numbers.map_or_else(|| self.expected(key, "a list of numbers"), |numbers| Ok(Some(numbers)))
    }

    /// Reads a list of three finite numbers.
    pub fn vector(&self, key: &str) -> Result<Option<DVec3>> {
        match self.numbers(key)?.as_deref() {
            None => Ok(None),
            Some([x, y, z]) => Ok(Some(DVec3::new(*x, *y, *z))),
            Some(_) => self.expected(key, "a list of three numbers"),
        }
    }

    fn array(&self, key: &str) -> Result<Option<&'a DeArray<'a>>> {
        match self.value(key).map(Spanned::get_ref) {
            None => Ok(None),
            Some(DeValue::Array(array)) => Ok(Some(array)),
            Some(_) => self.expected(key, "a list"),
        }
    }

    /// Reads a table within this one.
    pub fn section(&self, key: &str, keys: &[&str]) -> Result<Option<Section<'a>>> {
        let Some(value) = self.value(key) else { return Ok(None) };
        match value.get_ref() {
            DeValue::Table(table) => Ok(Some(Self::within(self.text, table, value.span(), keys)?)),
            _ => self.expected(key, "a table"),
        }
    }

    /// Reads tables with any names within a table, in the order of the file.
    pub fn named(&self, key: &str, keys: &[&str]) -> Result<Vec<(&'a str, Section<'a>)>> {
        let Some(value) = self.value(key) else { return Ok(Vec::new()) };
        let DeValue::Table(all) = value.get_ref() else { return self.expected(key, "a table") };
        let mut found = Vec::new();
        for (name, value) in all.iter() {
            let DeValue::Table(table) = value.get_ref() else {
                return self.expected(key, &format!("a table such as [{key}.NAME]"));
            };
            found.push((name.get_ref().as_ref(), Self::within(self.text, table, value.span(), keys)?));
        }
        found.sort_by_key(|(_, section)| section.span.start);
        Ok(found)
    }

    /// Reads an array of tables.
    pub fn sections(&self, key: &str, keys: &[&str]) -> Result<Vec<Section<'a>>> {
        let mut found = Vec::new();
        for value in self.array(key)?.into_iter().flat_map(|array| array.iter()) {
            let DeValue::Table(table) = value.get_ref() else {
                return self.expected(key, &format!("an array of tables such as [[{key}]]"));
            };
            found.push(Self::within(self.text, table, value.span(), keys)?);
        }
        Ok(found)
    }
}

fn whole(value: &DeValue<'_>) -> Option<usize> {
    let DeValue::Integer(number) = value else { return None };
    usize::from_str_radix(number.as_str(), number.radix()).ok()
}

fn finite(value: &DeValue<'_>) -> Option<f64> {
    let number = match value {
        DeValue::Float(number) => number.as_str().parse().ok()?,
        DeValue::Integer(number) => i64::from_str_radix(number.as_str(), number.radix()).ok()? as f64,
        _ => return None,
    };
    f64::is_finite(number).then_some(number)
}
