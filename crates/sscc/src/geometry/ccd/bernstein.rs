//! Polynomials of time in the Bernstein basis of an interval: where all coefficients are positive, so is the polynomial.
//!
//! Coefficients are stored multiplied by their binomial. That changes no sign, and makes products of polynomials plain
//! convolutions.

use super::number::Number;

/// The largest degree of a polynomial: that of a gap along the direction perpendicular to an edge.
const DEGREE: usize = 4;

/// A polynomial on an interval of time: Bernstein coefficients times their binomials.
#[derive(Clone)]
pub(super) struct Polynomial<T> {
    degree: usize,
    coefficients: [T; DEGREE + 1],
}

impl<T: Number> Polynomial<T> {
    pub(super) fn constant(x: T) -> Self {
        let mut coefficients = std::array::from_fn(|_| T::zero());
        coefficients[0] = x;
        Self { degree: 0, coefficients }
    }

    pub(super) fn linear(from: T, to: T) -> Self {
        let mut polynomial = Self::constant(from);
        (polynomial.degree, polynomial.coefficients[1]) = (1, to);
        polynomial
    }

    /// Combines the coefficients of two polynomials of the same degree.
    fn zip_with(&self, other: &Self, f: impl Fn(&T, &T) -> T) -> Self {
        debug_assert_eq!(self.degree, other.degree);
        let mut result = self.clone();
        for i in 0..=self.degree {
            result.coefficients[i] = f(&self.coefficients[i], &other.coefficients[i]);
        }
        result
    }

    pub(super) fn plus(&self, other: &Self) -> Self {
        self.zip_with(other, T::plus)
    }

    pub(super) fn minus(&self, other: &Self) -> Self {
        self.zip_with(other, T::minus)
    }

    pub(super) fn times(&self, other: &Self) -> Self {
        let mut product = Self::constant(T::zero());
        product.degree = self.degree + other.degree;
        for (i, a) in self.coefficients[..=self.degree].iter().enumerate() {
            for (j, b) in other.coefficients[..=other.degree].iter().enumerate() {
                product.coefficients[i + j] = product.coefficients[i + j].plus(&a.times(b));
            }
        }
        product
    }

    /// Returns the polynomial times -1.
    pub(super) fn reversed(&self) -> Self {
        let mut result = self.clone();
        result.coefficients.iter_mut().for_each(|x| *x = T::zero().minus(x));
        result
    }

    /// Returns the same polynomial with the coefficients of a given degree, which is no lower than its own.
    pub(super) fn elevated(&self, degree: usize) -> Self {
        // (1 - t) + t
        let one = Self::linear(T::from_f64(1.0), T::from_f64(1.0));
        (self.degree..degree).fold(self.clone(), |polynomial, _| polynomial.times(&one))
    }

    /// Returns an upper bound of the magnitude on the interval: a polynomial is a mean of its Bernstein coefficients, and their
    /// binomials are at least 1.
    pub(super) fn magnitude(&self) -> T {
        let negative = |x: &T| T::zero().minus(x);
        let coefficients = self.coefficients().iter();
        let least = coefficients.fold(T::zero(), |least, x| least.minimum(x).minimum(&negative(x)));
        negative(&least)
    }

    pub(super) fn degree(&self) -> usize {
        self.degree
    }

    /// Returns the `degree + 1` coefficients. The first is the value at the beginning of the interval.
    pub(super) fn coefficients(&self) -> &[T] {
        &self.coefficients[..=self.degree]
    }
}

pub(super) fn subtract<T: Number>(a: &[Polynomial<T>; 3], b: &[Polynomial<T>; 3]) -> [Polynomial<T>; 3] {
    std::array::from_fn(|k| a[k].minus(&b[k]))
}

pub(super) fn dot<T: Number>(a: &[Polynomial<T>; 3], b: &[Polynomial<T>; 3]) -> Polynomial<T> {
    a[0].times(&b[0]).plus(&a[1].times(&b[1])).plus(&a[2].times(&b[2]))
}

pub(super) fn cross<T: Number>(a: &[Polynomial<T>; 3], b: &[Polynomial<T>; 3]) -> [Polynomial<T>; 3] {
    let minor = |i: usize, j: usize| a[i].times(&b[j]).minus(&a[j].times(&b[i]));
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}
