"""Polynomials with integer coefficients: their roots in [0, 1] by Sturm's theorem, and exact signs at these roots."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from math import gcd
from typing import NamedTuple

#: Coefficients, the constant first; the last coefficient is not 0.
Polynomial = tuple[int, ...]


class Root(NamedTuple):
    """The only root of a polynomial in an interval; for a rational root both ends are that number."""

    #: A polynomial without repeated roots. No end of the interval is a root of it, unless both ends are equal.
    of: Polynomial
    low: Fraction
    high: Fraction


def rational(x: Fraction) -> Root:
    return Root((), x, x)


def trimmed(coefficients: list[int]) -> Polynomial:
    while coefficients and coefficients[-1] == 0:
        coefficients.pop()
    return tuple(coefficients)


def add(p: Polynomial, q: Polynomial) -> Polynomial:
    long, short = (p, q) if len(p) > len(q) else (q, p)
    return trimmed([a + b for a, b in zip(long, short, strict=False)] + list(long[len(short) :]))


def negate(p: Polynomial) -> Polynomial:
    return tuple(-a for a in p)


def multiply(p: Polynomial, q: Polynomial) -> Polynomial:
    product = [0] * max(len(p) + len(q) - 1, 0)
    for i, a in enumerate(p):
        for j, b in enumerate(q):
            product[i + j] += a * b
    return trimmed(product)


def value(p: Polynomial, x: Fraction) -> Fraction:
    return Fraction(numerator(p, x), x.denominator ** max(len(p) - 1, 0))


def numerator(p: Polynomial, x: Fraction) -> int:
    """Returns the value times a power of the denominator of x, by Horner's rule in integers."""
    total, power = 0, 1
    for coefficient in reversed(p):
        total = total * x.numerator + coefficient * power
        power *= x.denominator
    return total


def sign_of(p: Polynomial, x: Fraction) -> int:
    total = numerator(p, x)
    return (total > 0) - (total < 0)


def derivative(p: Polynomial) -> Polynomial:
    return tuple(i * a for i, a in enumerate(p))[1:]


def divide(p: Polynomial, by: Polynomial) -> tuple[Polynomial, Polynomial]:
    """Returns quotient and remainder, each up to a positive factor."""
    rest, quotient = list(p), [0] * max(len(p) - len(by) + 1, 0)
    size = abs(by[-1])
    for i in reversed(range(len(quotient))):
        # The rest is multiplied by the size of the leading coefficient, so that the factor is an integer.
        factor = rest[i + len(by) - 1] * (by[-1] // size)
        rest, quotient = [c * size for c in rest], [c * size for c in quotient]
        quotient[i] = factor
        for j, b in enumerate(by):
            rest[i + j] -= factor * b
    return reduced(quotient), reduced(rest)


def reduced(coefficients: list[int]) -> Polynomial:
    common = gcd(*coefficients)
    return trimmed([c // common for c in coefficients] if common > 1 else coefficients)


def common_divisor(p: Polynomial, q: Polynomial) -> Polynomial:
    while q:
        p, q = q, divide(p, q)[1]
    return p


def count_roots(chain: list[Polynomial], low: Fraction, high: Fraction) -> int:
    """Returns the number of different roots above ``low`` and not above ``high``, by a Sturm chain."""
    changes = []
    for x in (low, high):
        signs = [s for s in (sign_of(p, x) for p in chain) if s != 0]
        changes.append(sum(a != b for a, b in pairwise(signs)))
    return changes[0] - changes[1]


def roots(p: Polynomial) -> list[Root]:
    """Returns all different roots in [0, 1] of a polynomial that is not 0."""
    of = divide(p, common_divisor(p, derivative(p)))[0]
    chain = [of, derivative(of)]
    while chain[-1]:
        chain.append(negate(divide(chain[-2], chain[-1])[1]))
    found = [rational(Fraction(0))] if sign_of(of, Fraction(0)) == 0 else []
    waiting = [(Fraction(0), Fraction(1))]
    while waiting:
        low, high = waiting.pop()
        inside = count_roots(chain, low, high)
        if inside == 1 and sign_of(of, high) == 0:
            found.append(rational(high))
        elif inside == 1 and sign_of(of, low) != 0:
            found.append(Root(of, low, high))
        elif inside > 0:
            middle = (low + high) / 2
            waiting += [(low, middle), (middle, high)]
    return found


def halve(root: Root) -> Root:
    """Returns the same root in half the interval."""
    middle = (root.low + root.high) / 2
    at_middle = sign_of(root.of, middle)
    if at_middle == 0:
        return rational(middle)
    # The root is simple, so the sign changes there.
    is_above = at_middle == sign_of(root.of, root.low)
    return Root(root.of, middle, root.high) if is_above else Root(root.of, root.low, middle)


def refine(root: Root, width: Fraction) -> Root:
    """Returns the same root in an interval of at most this width."""
    while root.high - root.low > width:
        root = halve(root)
    return root


def sign_at(p: Polynomial, root: Root) -> int:
    """Returns the exact sign of a polynomial at a root in [0, 1]."""
    slope = sum(abs(a) for a in derivative(p))
    is_known_not_zero = False
    while True:
        at_low = value(p, root.low)
        # Within the interval the polynomial changes by no more than this.
        if root.low == root.high or abs(at_low) > slope * (root.high - root.low):
            return (at_low > 0) - (at_low < 0)
        if not is_known_not_zero:
            common = common_divisor(root.of, p)
            if sign_of(common, root.low) != sign_of(common, root.high):
                return 0
            is_known_not_zero = True
        root = halve(root)
