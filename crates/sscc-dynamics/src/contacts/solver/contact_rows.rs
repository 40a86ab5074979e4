//! Rows of contacts: the velocity between the points of a contact as products of packed rows with the changes of its bodies.
//!
//! The unknowns of a body are the changes of its velocity, of its angular velocity and of its modal velocities, in one
//! vector, each divided by the square root of its inverse mass (of the inverse inertia: Cholesky's factor). In these units the
//! response to an impulse has the same rows as the velocity: `w = J u`, and an impulse p adds `J' p` to u. A contact has three
//! rows for each body, along its own axes, of which the first is its normal: contacts that are open need only the row of the
//! normal.

use glam::{DMat3, DVec3};
use pulp::Simd;

use super::rigid_velocity::RigidVelocity;
use crate::Body;
use crate::contacts::contact::Contact;
use crate::contacts::contact_constraint::{ContactPoints, Side};
use crate::packed_rows::{ROW_LANES, add_rows_to, products};

/// The rows of one side of a contact, and the numbers of its body.
#[derive(Clone, Copy, Debug)]
struct RowSide {
    /// Index of the first number of the rows.
    rows: usize,
    /// Index of the first number of the body.
    state: usize,
    /// Length of a row.
    stride: usize,
}

/// A contact: its axes (the normal first) and its sides.
#[derive(Clone, Copy, Debug)]
struct RowContact {
    axes: [DVec3; 3],
    sides: [RowSide; 2],
    count: usize,
}

/// The constants of a body.
#[derive(Clone, Copy, Debug)]
struct RowBody {
    rotation: DMat3,
    /// Square root of the inverse mass.
    mass_root: f64,
    /// Cholesky's factor of the inverse inertia.
    inertia_root: DMat3,
    /// Index of the body's first number.
    state: usize,
    stride: usize,
}

/// A point of a body at which a contact acts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowPoint<'m> {
    pub body: usize,
    /// Sign of the impulse on the body.
    pub sign: f64,
    /// Vector from the centre of mass to the point; None for contacts within a body, whose impulses change its modes alone
    /// and whose vectors are in its axes.
    pub arm: Option<DVec3>,
    /// Displacement of the point by each mode (r vectors, axes of the body).
    pub modes: &'m [DVec3],
}

/// The rows of some contacts, and the changes of all bodies.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactRows {
    bodies: Vec<RowBody>,
    contacts: Vec<RowContact>,
    rows: Vec<f64>,
    state: Vec<f64>,
    /// For each body the square roots of the inverse masses of its modes, at the index of its state.
    roots: Vec<f64>,
}

impl ContactRows {
    /// Removes all contacts, and sets the changes of these bodies to 0. Each body is given with the inverse masses of its modes.
    pub fn begin<'b>(&mut self, bodies: impl Iterator<Item = (&'b RigidVelocity, &'b [f64])>) {
        self.bodies.clear();
        self.contacts.clear();
        self.rows.clear();
        self.roots.clear();
        let mut state = 0;
        let roots = &mut self.roots;
        self.bodies.extend(bodies.map(|(mass, weights)| {
            let stride = (weights.len() + 6).next_multiple_of(ROW_LANES);
            state += stride;
            roots.extend(weights.iter().map(|weight| weight.sqrt()));
            roots.resize(state, 0.0);
            RowBody {
                rotation: mass.rotation,
                mass_root: mass.inverse_mass.sqrt(),
                inertia_root: cholesky(&mass.inverse_inertia),
                state: state - stride,
                stride,
            }
        }));
        self.state.clear();
        self.state.resize(state, 0.0);
    }

    /// Adds a contact, which gets the next number. N is its number of rows: 3, or 1 (along the normal), which suffices for
    /// [`Self::along_normal`] and [`Self::push_along_normal`].
    pub fn push<const N: usize>(&mut self, at: &ContactPoints, bodies: &[Body], contacts: &[Contact]) {
        let points = at.sides().map(|Side { n, body, sign }| RowPoint {
            body,
            sign,
            arm: (!at.is_within()).then_some(at.arms[n]),
            modes: at.modes(n, bodies[body].shape(), contacts),
        });
        self.push_rows::<N>(at.normal, points);
    }

    pub(super) fn push_rows<'m, const N: usize>(
        &mut self,
        normal: DVec3,
        points: impl Iterator<Item = RowPoint<'m>>,
    ) {
        let (first, second) = normal.any_orthonormal_pair();
        let none = RowSide { rows: 0, state: 0, stride: 0 };
        let mut contact = RowContact { axes: [normal, first, second], sides: [none; 2], count: 0 };
        for point in points {
            let body = self.bodies[point.body];
            contact.sides[contact.count] =
                RowSide { rows: self.rows.len(), state: body.state, stride: body.stride };
            contact.count += 1;
            for axis in &contact.axes[..N] {
                let axis = *axis * point.sign;
                let end = self.rows.len() + body.stride;
                let local = if point.arm.is_some() { body.rotation.transpose() * axis } else { axis };
                let modal = point.modes.iter().zip(&self.roots[body.state..]);
                self.rows.extend(modal.map(|(u, root)| u.dot(local) * root));
                if let Some(arm) = point.arm {
                    self.rows.extend((axis * body.mass_root).to_array());
                    self.rows.extend((body.inertia_root.transpose() * arm.cross(axis)).to_array());
                }
                self.rows.resize(end, 0.0);
            }
        }
        self.contacts.push(contact);
    }

    /// Returns the axes of a contact, its normal first.
    #[inline(always)]
    pub fn axes(&self, contact: usize) -> [DVec3; 3] {
        self.contacts[contact].axes
    }

    /// Returns the change of the velocity between the points of a contact along its normal.
    #[inline(always)]
    pub fn along_normal<S: Simd>(&self, simd: S, contact: usize) -> f64 {
        let [along] = self.along::<S, 1>(simd, contact, 0);
        along
    }

    /// Returns the changes of the velocity along the two axes other than the normal.
    #[inline(always)]
    pub fn across<S: Simd>(&self, simd: S, contact: usize) -> [f64; 2] {
        self.along::<S, 2>(simd, contact, 1)
    }

    /// Adds an impulse along the normal of a contact.
    #[inline(always)]
    pub fn push_along_normal<S: Simd>(&mut self, simd: S, contact: usize, impulse: f64) {
        self.add(simd, contact, [impulse]);
    }

    /// Adds an impulse, given along the axes of a contact.
    #[inline(always)]
    pub fn push_along_axes<S: Simd>(&mut self, simd: S, contact: usize, impulse: [f64; 3]) {
        self.add(simd, contact, impulse);
    }

    /// Returns the products with N rows, beginning with row `first`.
    #[inline(always)]
    fn along<S: Simd, const N: usize>(&self, simd: S, contact: usize, first: usize) -> [f64; N] {
        let contact = &self.contacts[contact];
        let mut sums = [0.0; N];
        for side in &contact.sides[..contact.count] {
            let row = |n: usize| &self.rows[side.rows + (first + n) * side.stride..][..side.stride];
            let state = &self.state[side.state..][..side.stride];
            let own: [f64; N] = products(simd, std::array::from_fn(row), state);
            sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        }
        sums
    }

    /// Adds the first N rows with these weights.
    #[inline(always)]
    fn add<S: Simd, const N: usize>(&mut self, simd: S, contact: usize, weights: [f64; N]) {
        let contact = &self.contacts[contact];
        for side in &contact.sides[..contact.count] {
            let row = |n: usize| &self.rows[side.rows + n * side.stride..][..side.stride];
            let state = &mut self.state[side.state..][..side.stride];
            add_rows_to::<S, N>(simd, std::array::from_fn(row), weights, state);
        }
    }
}

/// Returns the lower triangular L with `L L' = matrix`, for a matrix that is symmetric and positive definite, or 0.
fn cholesky(matrix: &DMat3) -> DMat3 {
    let entry = |row: usize, column: usize| matrix.col(column)[row];
    let mut root = [[0.0_f64; 3]; 3];
    for column in 0..3 {
        for row in column..3 {
            let known: f64 = (0..column).map(|k| root[row][k] * root[column][k]).sum();
            let rest = entry(row, column) - known;
            root[row][column] = if row == column {
                rest.max(0.0).sqrt()
            } else if root[column][column] > 0.0 {
                rest / root[column][column]
            } else {
                0.0
            };
        }
    }
    DMat3::from_cols_array_2d(&root).transpose()
}
