//! Tensor read from a container.

use crate::{FormatError, Message, Place};

/// Matches any length of an axis in [`Tensor::shaped`].
pub const ANY: usize = usize::MAX;

/// A named array (C order: last axis fastest).
#[derive(Clone, Debug, PartialEq)]
pub struct Tensor<T> {
    /// Name in the file.
    pub name: String,
    /// Length of each axis; the product is the number of values.
    pub shape: Vec<usize>,
    /// Values.
    pub values: Vec<T>,
}

impl<T> Tensor<T> {
    /// Returns the tensor if it has this shape, where [`ANY`] matches any length.
    ///
    /// # Errors
    /// When it has another shape; the message names the tensor and both shapes.
    pub fn shaped(self, wanted: &[usize]) -> Result<Self, FormatError> {
        let fits = |(found, wanted): (&usize, &usize)| *wanted == ANY || found == wanted;
        if self.shape.len() == wanted.len() && self.shape.iter().zip(wanted).all(fits) {
            return Ok(self);
        }
        let axes: Vec<_> =
            wanted.iter().map(|n| if *n == ANY { "any".to_owned() } else { n.to_string() }).collect();
        let cause = format!("it has the shape {:?}, [{}] was expected", self.shape, axes.join(", "));
        Err(FormatError::new(Place::Tensor(self.name), cause))
    }

    /// Returns an error for the values of the tensor.
    pub fn refused(&self, cause: impl Into<Message>) -> FormatError {
        FormatError::new(Place::Tensor(self.name.clone()), cause)
    }
}
