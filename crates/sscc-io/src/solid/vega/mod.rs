//! Reader for VegaFEM's `.veg` files, text.
//!
//! Sections begin with `*`; fields are separated by commas or blanks; `#` begins a comment.
//!
//! | section | content |
//! | --- | --- |
//! | `*VERTICES` | `n 3 0 0`, then n lines `number x y z` |
//! | `*ELEMENTS` | `TET` or `CUBIC`, then `n 4 0` or `n 8 0`, then n lines `number corners` |
//! | `*MATERIAL name` | one line, see below |
//! | `*SET name` | numbers of elements, over any number of lines |
//! | `*REGION` | `set, material`; the set `allElements` needs no `*SET` |
//! | `*INCLUDE file` | the lines of a file in the same folder or below come here (also TetGen's files) |
//!
//! The number of the first vertex, 0 or 1, is the base of the corners of elements; that of the first element is the
//! base of sets. As in VegaFEM, the last region that contains an element decides its material, and elements in no
//! region get the last material. Blanks in names are ignored.
//!
//! | material | density | Young's modulus, Poisson's ratio |
//! | --- | --- | --- |
//! | `ENU, density, E, nu` | as given | as given |
//! | `MOONEYRIVLIN, density, mu01, mu10, v1` | as given | those of the same stiffness at rest |
//! | `ORTHOTROPIC..., density, ...`, other types | as given | not read: the caller must give the stiffness |

mod count;
mod include;
mod material;
mod parser;
mod regions;
#[cfg(test)]
mod tests;

pub use include::{parse, read};
