//! Polynomials with integer coefficients, their roots in [0, 1] by Sturm's theorem, and signs at these roots.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

/// Coefficients, the constant first; the last coefficient is not 0.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Polynomial(Vec<BigInt>);

/// Root of a polynomial, stored as the only root in an interval, or a rational number.
#[derive(Clone, Debug)]
pub struct Root {
    /// A polynomial without repeated roots, of which this is a root.
    of: Polynomial,
    /// Interval that contains only this root. Neither end is a root, unless both ends are equal.
    interval: [BigRational; 2],
}

/// Sturm chain of a polynomial, each member up to a positive factor.
struct SturmChain(Vec<Polynomial>);

impl SturmChain {
    /// Returns the number of distinct roots in an interval without its lower end (Sturm's theorem).
    fn count(&self, ends: &[BigRational; 2]) -> usize {
        let [lower, upper] = ends.each_ref().map(|x| {
            let signs: Vec<i8> = self.0.iter().map(|p| p.sign_at(x)).filter(|s| *s != 0).collect();
            signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
        });
        lower - upper
    }
}

fn sign(x: &BigInt) -> i8 {
    x.signum().to_i8().expect("-1, 0 or 1")
}

fn middle([lower, upper]: &[BigRational; 2]) -> BigRational {
    (lower + upper) / BigRational::from_integer(2.into())
}

impl Polynomial {
    pub(crate) fn new(mut coefficients: Vec<BigInt>) -> Self {
        while coefficients.last().is_some_and(Zero::is_zero) {
            coefficients.pop();
        }
        Self(coefficients)
    }

    pub(crate) fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    pub(crate) fn plus(&self, other: &Self) -> Self {
        let [short, long] = if self.0.len() < other.0.len() { [self, other] } else { [other, self] };
        let mut sum = long.0.clone();
        sum.iter_mut().zip(&short.0).for_each(|(a, b)| *a += b);
        Self::new(sum)
    }

    pub(crate) fn times(&self, other: &Self) -> Self {
        let mut product = vec![BigInt::ZERO; (self.0.len() + other.0.len()).saturating_sub(1)];
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

    /// Returns the sign of the value: Horner's rule for numerators over powers of the denominator.
    fn sign_at(&self, x: &BigRational) -> i8 {
        let (mut sum, mut power) = (BigInt::ZERO, BigInt::one());
        for c in self.0.iter().rev() {
            sum = sum * x.numer() + c * &power;
            power *= x.denom();
        }
        sign(&sum)
    }

    fn derivative(&self) -> Self {
        Self::new(self.0.iter().enumerate().skip(1).map(|(i, c)| c * i).collect())
    }

    /// Returns quotient and remainder, each up to a positive factor.
    fn divided(&self, by: &Self) -> (Self, Self) {
        let mut rest = self.0.clone();
        let mut quotient = vec![BigInt::ZERO; (self.0.len() + 1).saturating_sub(by.0.len())];
        let leading = &by.0[by.0.len() - 1];
        let (size, is_negative) = (leading.abs(), leading.is_negative());
        for i in (0..quotient.len()).rev() {
            // The rest is multiplied by the size of the leading coefficient, so that the factor is an integer.
            let top = rest[i + by.0.len() - 1].clone();
            let factor = if is_negative { -top } else { top };
            rest.iter_mut().chain(&mut quotient).for_each(|c| *c *= &size);
            for (j, c) in by.0.iter().enumerate() {
                rest[i + j] -= &factor * c;
            }
            quotient[i] = factor;
        }
        (Self::reduced(quotient), Self::reduced(rest))
    }

    /// Removes the common power of two.
    fn reduced(mut coefficients: Vec<BigInt>) -> Self {
        if let Some(zeros) = coefficients.iter().filter_map(BigInt::trailing_zeros).min() {
            coefficients.iter_mut().for_each(|c| *c >>= zeros);
        }
        Self::new(coefficients)
    }

    fn greatest_common_divisor(&self, other: &Self) -> Self {
        let (mut a, mut b) = (self.clone(), other.clone());
        while !b.is_zero() {
            let rest = a.divided(&b).1;
            (a, b) = (b, rest);
        }
        a
    }

    fn without_repeated_roots(&self) -> Self {
        let common = self.greatest_common_divisor(&self.derivative());
        if common.0.len() > 1 { self.divided(&common).0 } else { self.clone() }
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
        let rational = |x: &BigRational| (of.sign_at(x) == 0).then(|| Root::at(x.clone()));
        let mut roots: Vec<Root> = rational(&ends[0]).into_iter().collect();
        let mut waiting = vec![ends];
        while let Some([lower, upper]) = waiting.pop() {
            let inside = chain.count(&[lower.clone(), upper.clone()]);
            let short = &upper - &lower < BigRational::new(1.into(), 32.into());
            match inside {
                0 => {}
                1 if of.sign_at(&upper) == 0 => roots.push(Root::at(upper)),
                1 if short && of.sign_at(&lower) != 0 => {
                    roots.push(Root { of: of.clone(), interval: [lower, upper] }.refined(44));
                }
                _ => {
                    let ends = [lower, upper];
                    let middle = middle(&ends);
                    let [lower, upper] = ends;
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
            let middle = middle(&self.interval);
            let signs = [&self.interval[0], &middle].map(|x| self.of.sign_at(x));
            // The root is simple, so the sign changes there. No end becomes the root.
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
            return p.sign_at(lower);
        }
        // Floating-point filter: the interval is shorter than 1e-14, and doubles are precise to 1e-16. It decides
        // nothing where a coefficient overflows.
        let x = lower.to_f64().expect("a rational number has a double near it");
        let (mut value, mut size) = (0.0, 0.0);
        for c in p.0.iter().rev().map(|c| c.to_f64().expect("an integer has a double near it, or infinity")) {
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
        while chain.count(&root.interval) > 0 || simple.sign_at(&root.interval[0]) == 0 {
            root = root.refined(1);
        }
        p.sign_at(&root.interval[1])
    }
}
