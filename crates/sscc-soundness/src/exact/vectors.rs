//! Vectors of three numbers.

use super::number::Number;

/// A vector.
pub type Vector<N> = [N; 3];

/// Returns the difference of two vectors.
pub fn minus<N: Number>(a: &Vector<N>, b: &Vector<N>) -> Vector<N> {
    std::array::from_fn(|c| a[c].minus(&b[c]))
}

/// Returns the sum of two vectors.
pub fn plus<N: Number>(a: &Vector<N>, b: &Vector<N>) -> Vector<N> {
    std::array::from_fn(|c| a[c].plus(&b[c]))
}

/// Returns the scalar product.
pub fn dot<N: Number>(a: &Vector<N>, b: &Vector<N>) -> N {
    a[0].times(&b[0]).plus(&a[1].times(&b[1])).plus(&a[2].times(&b[2]))
}

/// Returns the vector product.
pub fn cross<N: Number>(a: &Vector<N>, b: &Vector<N>) -> Vector<N> {
    let entry = |i: usize, j: usize| a[i].times(&b[j]).minus(&a[j].times(&b[i]));
    [entry(1, 2), entry(2, 0), entry(0, 1)]
}

/// Whether all three numbers are 0; None if undecided.
pub fn is_zero<N: Number>(a: &Vector<N>) -> Option<bool> {
    let mut undecided = false;
    for x in a {
        match x.sign() {
            Some(0) => {}
            Some(_) => return Some(false),
            None => undecided = true,
        }
    }
    (!undecided).then_some(true)
}
