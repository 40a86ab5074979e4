//! Rational polynomials, their roots in [0, 1] by Sturm's theorem, and signs at these roots.

use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

/// Coefficients, the constant one first, the last one not 0.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Polynomial(Vec<BigRational>);

/// Root of a polynomial, stored as the only root in an interval, or a rational number.
#[derive(Clone, Debug)]
pub struct Root {
    /// A polynomial without repeated roots.
    of: Polynomial,
    /// Neither end is a root, unless both ends are equal.
    interval: [BigRational; 2],
}

/// Sturm chain of a polynomial.
struct SturmChain(Vec<Polynomial>);

impl SturmChain {
    /// Returns the number of distinct roots in an interval without its lower end (Sturm's theorem).
    fn count(&self, ends: &[BigRational; 2]) -> usize {
        let [lower, upper] = ends.each_ref().map(|x| {
            let signs: Vec<i8> = self.0.iter().map(|p| sign(&p.at(x))).filter(|s| *s != 0).collect();
            signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
        });
        lower - upper
    }
}

fn two() -> BigRational {
    BigRational::one() + BigRational::one()
}

fn sign(x: &BigRational) -> i8 {
    x.signum().to_i8().expect("-1, 0 or 1")
}

impl Polynomial {
    pub(crate) fn new(mut coefficients: Vec<BigRational>) -> Self {
        while coefficients.last().is_some_and(Zero::is_zero) {
            coefficients.pop();
        }
        Self(coefficients)
    }

    pub(crate) fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    pub(crate) fn plus(&self, other: &Self) -> Self {
        let at = |p: &Self, i: usize| p.0.get(i).cloned().unwrap_or_else(BigRational::zero);
        Self::new((0..self.0.len().max(other.0.len())).map(|i| at(self, i) + at(other, i)).collect())
    }

    pub(crate) fn times(&self, other: &Self) -> Self {
        let mut product = vec![BigRational::zero(); (self.0.len() + other.0.len()).saturating_sub(1)];
        for (i, a) in self.0.iter().enumerate() {
            for (j, b) in other.0.iter().enumerate() {
                product[i + j] += a * b;
            }
        }
        Self::new(product)
    }

    pub(crate) fn negated(&self) -> Self {
        Self(self.0.iter().map(|c| -c).collect())
    }

    fn at(&self, x: &BigRational) -> BigRational {
        self.0.iter().rev().fold(BigRational::zero(), |sum, c| sum * x + c)
    }

    fn derivative(&self) -> Self {
        let scaled = |(i, c): (usize, &BigRational)| c * BigRational::from_integer(i.into());
        Self::new(self.0.iter().enumerate().skip(1).map(scaled).collect())
    }

    /// Returns quotient and remainder.
    fn divided(&self, by: &Self) -> (Self, Self) {
        let mut rest = self.0.clone();
        let mut quotient = vec![BigRational::zero(); (self.0.len() + 1).saturating_sub(by.0.len())];
        for i in (0..quotient.len()).rev() {
            let factor = &rest[i + by.0.len() - 1] / &by.0[by.0.len() - 1];
            for (j, c) in by.0.iter().enumerate() {
                rest[i + j] -= &factor * c;
            }
            quotient[i] = factor;
        }
        (Self::new(quotient), Self::new(rest))
    }

    fn greatest_common_divisor(&self, other: &Self) -> Self {
        let (mut a, mut b) = (self.clone(), other.clone());
        while !b.is_zero() {
            (a, b) = (b.clone(), a.divided(&b).1);
        }
        a
    }

    fn without_repeated_roots(&self) -> Self {
        self.divided(&self.greatest_common_divisor(&self.derivative())).0
    }

    fn chain(&self) -> SturmChain {
        let mut chain = vec![self.clone(), self.derivative()];
        while !chain[chain.len() - 1].is_zero() {
            let rest = chain[chain.len() - 2].divided(&chain[chain.len() - 1]).1;
            chain.push(rest.negated());
        }
        SturmChain(chain)
    }

    /// Returns all distinct roots in [0, 1], each in an interval shorter than 2^-48.
    pub(crate) fn roots(&self) -> Vec<Root> {
        let of = self.without_repeated_roots();
        let chain = of.chain();
        let ends = [BigRational::zero(), BigRational::one()];
        let rational = |x: &BigRational| of.at(x).is_zero().then(|| Root::at(x.clone()));
        let mut roots: Vec<Root> = rational(&ends[0]).into_iter().collect();
        let mut waiting = vec![ends];
        while let Some([lower, upper]) = waiting.pop() {
            let inside = chain.count(&[lower.clone(), upper.clone()]);
            let short = &upper - &lower < BigRational::new(1.into(), 32.into());
            match inside {
                0 => {}
                1 if of.at(&upper).is_zero() => roots.push(Root::at(upper)),
                1 if short && !of.at(&lower).is_zero() => {
                    roots.push(Root { of: of.clone(), interval: [lower, upper] }.refined(44));
                }
                _ => {
                    let middle = (&lower + &upper) / two();
                    waiting.push([lower, middle.clone()]);
                    waiting.push([middle, upper]);
                }
            }
        }
        roots
    }
}

impl Root {
    pub(crate) fn at(x: BigRational) -> Self {
        Self { of: Polynomial::new(vec![]), interval: [x.clone(), x] }
    }

    /// Halves the interval `times` times.
    fn refined(mut self, times: usize) -> Self {
        for _ in 0..times {
            let [lower, upper] = &self.interval;
            let middle = (lower + upper) / two();
            let signs = [lower, &middle].map(|x| sign(&self.of.at(x)));
            // The root is simple, so the sign changes there. The ends stay off the root.
            match signs[0] * signs[1] {
                0 => self.interval = [middle.clone(), middle],
                1 => self.interval[0] = middle,
                _ => self.interval[1] = middle,
            }
        }
        self
    }

    /// Returns a lower bound of the root.
    pub fn lower(&self) -> &BigRational {
        &self.interval[0]
    }

    /// Returns an upper bound of the root, less than 2^-48 above the lower bound.
    pub fn upper(&self) -> &BigRational {
        &self.interval[1]
    }

    /// Returns the exact sign of a polynomial at this root.
    pub(crate) fn sign(&self, p: &Polynomial) -> i8 {
        let [lower, upper] = &self.interval;
        if p.is_zero() || lower == upper {
            return sign(&p.at(lower));
        }
        // Floating-point filter: the interval is shorter than 1e-14, and doubles are precise to 1e-16.
        let double = |x: &BigRational| x.to_f64().expect("a rational number has a double near it");
        let x = double(lower);
        let (mut value, mut size) = (0.0, 0.0);
        for c in p.0.iter().rev().map(double) {
            (value, size) = (value * x + c, size + c.abs());
        }
        if value.abs() > 1e-9 * size {
            return if value > 0.0 { 1 } else { -1 };
        }
        let common = self.of.greatest_common_divisor(p);
        if common.0.len() > 1 && common.chain().count(&self.interval) > 0 {
            return 0;
        }
        let simple = p.without_repeated_roots();
        let chain = simple.chain();
        let mut root = self.clone();
        while chain.count(&root.interval) > 0 || simple.at(&root.interval[0]).is_zero() {
            root = root.refined(1);
        }
        sign(&p.at(&root.interval[1]))
    }
}
