//! Values by method, with their JSON.

use serde::{Serialize, Serializer};

/// A value for each method, in the order of the columns. The JSON is an object.
#[derive(Clone, Debug, PartialEq)]
pub struct Means<T = f64>(pub Vec<(&'static str, T)>);

impl<T: Copy> Means<T> {
    /// Returns the value of one method.
    pub fn get(&self, key: &str) -> Option<T> {
        self.0.iter().find(|(known, _)| *known == key).map(|(_, value)| *value)
    }

    /// Returns whether there is no method.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl<T: Serialize> Serialize for Means<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(key, value)| (key, value)))
    }
}
