#!/usr/bin/env python3
"""Characteristic values a_m(q), b_m(q) of Mathieu's equation x'' + (a - 2 q cos 2t) x = 0 by SciPy.

python3 mathieu_characteristic.py > mathieu_characteristic.csv

Each value is improved by Newton's method on the continued fraction's tridiagonal matrix in 40 digits (mpmath), and
SciPy's own value is kept beside it.
"""
import mpmath
from scipy.special import mathieu_a, mathieu_b

mpmath.mp.dps = 40
SIZE = 60  # of the matrices: far beyond what q <= 25 needs


def determinant(even, m, q, a):
    """Continuant of the symmetric tridiagonal matrix of the Fourier recurrence, minus a."""
    if m % 2 == 0:
        start = 0 if even else 2
        diagonal = [mpmath.mpf((start + 2 * k) ** 2) for k in range(SIZE)]
        coupling = [q * q] * (SIZE - 1)
        if even:
            coupling[0] = 2 * q * q
    else:
        diagonal = [mpmath.mpf((1 + 2 * k) ** 2) for k in range(SIZE)]
        diagonal[0] += q if even else -q
        coupling = [q * q] * (SIZE - 1)
    # Ratio form from the far end: d_k - a - q^2/(d_{k+1} - a - ...).
    fraction = mpmath.mpf(0)
    wanted = m // 2 if (even or m % 2 == 1) else m // 2 - 1
    tail = diagonal[-1] - a
    for k in range(SIZE - 2, wanted, -1):
        tail = diagonal[k] - a - coupling[k] / tail
    head = None
    for k in range(wanted):
        head = diagonal[k] - a - (coupling[k - 1] / head if head is not None else 0)
    fraction = diagonal[wanted] - a - coupling[wanted] / tail
    if head is not None:
        fraction -= coupling[wanted - 1] / head
    return fraction


def improved(even, m, q, guess):
    return mpmath.findroot(lambda a: determinant(even, m, mpmath.mpf(q), a), mpmath.mpf(guess))


print("# Mathieu's equation x'' + (a - 2 q cos 2t) x = 0: characteristic values (SciPy, and improved with mpmath)")
print("function,m,q,scipy,value")
for m in range(0, 5):
    for even in (True, False):
        if m == 0 and not even:
            continue
        for step in range(1, 26):
            q = step * 0.4
            guess = mathieu_a(m, q) if even else mathieu_b(m, q)
            value = improved(even, m, q, guess)
            assert abs(value - mpmath.mpf(guess)) < 1e-8 * max(1, abs(value)), (m, even, q, guess, value)
            print(f"{'a' if even else 'b'},{m},{q!r},{float(guess)!r},{mpmath.nstr(value, 18)}")
