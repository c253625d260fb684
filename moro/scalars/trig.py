"""Exact trigonometric polynomials: the canonical form behind every closed-form result.

Every entry of M, C, G, T, J of an arm is a polynomial in the sines and cosines of its joint angles,
the displacements of its prismatic joints, velocities, and the symbols of the model, with rational
coefficients. Reduced by ``sin^2 -> 1 - cos^2`` it has exactly one form, so zero is recognised by
looking and equality is ``==``.

A polynomial is a dictionary {monomial: coefficient}. A monomial is one integer that packs the
exponents of all generators, eight bits each: monomials are multiplied by adding two integers.
Generators come into being when they are first asked for. They are

- symbols (and whatever is not a polynomial, taken as a whole: ``sqrt(l)``, ``exp(x)``),
- square roots of integers, with ``g^2`` an integer,
- pairs (sine, cosine) of an angle, with ``s^2 = 1 - c^2``,
- reciprocals of polynomials p, with ``g p = 1`` and what follows of it (``relations``).

Angles are sums of joint variables. Consecutive parallel joints share one group of angles, q2 and
q2 + q3, so that their rotations compose without products; see ``TrigRing.declare_angles``.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from time import thread_time
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

from moro.scalars.free import FreePolynomials, rational
from moro.scalars.relations import (
    BITS,
    FIELD,
    Coefficient,
    Monomial,
    Relations,
    common_factor,
)

_BITS = BITS
#: terms times values that are evaluated at once
_CHUNK = 1 << 20
_FIELD = FIELD
#: the highest exponent that a product may reach; beyond it a field would overflow
MAX_EXPONENT = (1 << (_BITS - 1)) - 1


#: functions of an angle as quotients
_QUOTIENTS: dict[Any, tuple[Any, Any]] = {
    sp.tan: (sp.sin, sp.cos),
    sp.cot: (sp.cos, sp.sin),
    sp.sec: (lambda _: sp.Integer(1), sp.cos),
    sp.csc: (lambda _: sp.Integer(1), sp.sin),
}


class Trig:
    """A trigonometric polynomial: an immutable element of a ``TrigRing``.

    Supports ``+ - *`` with other elements of the ring, integers and fractions, and ``==``.
    """

    __slots__ = ("ring", "terms")

    def __init__(self, ring: TrigRing, terms: dict[Monomial, Coefficient]):
        self.ring = ring
        self.terms = terms

    def __add__(self, other: Trig | Coefficient) -> Trig:
        if not isinstance(other, Trig):
            if other == 0:
                return self
            other = Trig(self.ring, {0: other})
        if not other.terms:
            return self
        small, terms = other.terms, self.terms
        if len(small) > len(terms):
            small, terms = terms, small
        terms = terms.copy()
        for monomial, c in small.items():
            total = terms.get(monomial, 0) + c
            if total:
                terms[monomial] = total
            else:
                del terms[monomial]
        return Trig(self.ring, terms)

    __radd__ = __add__

    def __neg__(self) -> Trig:
        return Trig(self.ring, {m: -c for m, c in self.terms.items()})

    def __sub__(self, other: Trig | Coefficient) -> Trig:
        return self + (-other)

    def __rsub__(self, other: Coefficient) -> Trig:
        return -self + other

    def __mul__(self, other: Trig | Coefficient) -> Trig:
        if not isinstance(other, Trig):
            if other == 0:
                return self.ring.zero
            if other == 1:
                return self
            return Trig(self.ring, {m: c * other for m, c in self.terms.items()})
        if not self.terms or not other.terms:
            return self.ring.zero
        short, long = self.terms, other.terms
        if len(short) > len(long):
            short, long = long, short
        self.ring.spend(len(short) * len(long))
        if len(short) == 1:
            ((m0, c0),) = short.items()
            product = {m + m0: c * c0 for m, c in long.items()}
        else:
            product = {}
            get = product.get
            items = list(long.items())
            for m0, c0 in short.items():
                for m, c in items:
                    monomial = m + m0
                    product[monomial] = get(monomial, 0) + c * c0
        return Trig(self.ring, self.ring.reduced(product))

    __rmul__ = __mul__

    def __truediv__(self, other: Coefficient) -> Trig:
        if other == 1:
            return self
        return Trig(self.ring, {m: _as_integer(Fraction(c) / other) for m, c in self.terms.items()})

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Trig):
            return self.terms == other.terms
        return self.terms == ({0: other} if other else {})

    def __hash__(self) -> int:
        return hash(frozenset(self.terms.items()))

    def __bool__(self) -> bool:
        return bool(self.terms)

    def __len__(self) -> int:
        return len(self.terms)

    def __repr__(self) -> str:
        return f"Trig({self.ring.expanded(self)})"


class TrigRing:
    """The ring of trigonometric polynomials over the rationals, in generators as they turn up.

    ``declare_angles`` comes first: it says which sums of joint variables are the basic angles.
    With a ``time_limit`` [s, of this thread on its processor, so that a busy machine gives the
    same], arithmetic that goes on for longer raises TimeoutError; after ``allow``, what takes more
    products of terms does.
    """

    def __init__(self, time_limit: float = float("inf")) -> None:
        self._deadline = thread_time() + time_limit
        self._products_left = float("inf")
        self.zero = Trig(self, {})
        self.one = Trig(self, {0: 1})
        self.half = Fraction(1, 2)
        #: what each generator stands for, by index
        self.generators: list[Any] = []
        self._index: dict[Any, int] = {}
        self._constants: dict[Any, Trig] = {}
        # bits of exponents that reduced() must look at
        self._reducible = 0
        self._sines: dict[int, int] = {}  # index of sine -> index of cosine
        self._roots: dict[int, int] = {}  # index of square root -> its square
        #: index of a reciprocal -> the polynomial that it is one over
        self.reciprocals: dict[int, Trig] = {}
        self._inverses: dict[Any, Trig] = {}
        self._relations = Relations()
        #: basic angle -> (index of sine, index of cosine)
        self.pairs: dict[Any, tuple[int, int]] = {}
        #: basic angles of parallel joints, in order, by group
        self.groups: list[list[Any]] = []
        # joint variable -> it as {basic angle: whole multiple} plus a constant
        self._joint_angles: dict[Any, tuple[dict[Any, int], Any]] = {}
        self._slopes: dict[Any, dict[Any, Any]] = {}  # variable -> {angle: its derivative}
        # joint variable -> {multiple that is not whole: the sum [(multiple, times)] that it is}
        self._parts: dict[Any, dict[Any, list[tuple[Any, int]]]] = {}

    def allow(self, products: float) -> None:
        """Let arithmetic from now on take so many products of terms: the same on any machine."""
        self._products_left = products

    def spend(self, products: int) -> None:
        """Count products of terms. Raise TimeoutError if there have been more than allowed."""
        self._products_left -= products
        if self._products_left < 0:
            raise TimeoutError("the closed form takes more products than allowed")

    # -- generators -------------------------------------------------------------------------------

    def declare_angles(
        self, angles: Sequence[tuple[Any, Any]], groups: Sequence[int] | None = None
    ) -> None:
        """Make angles basic: (joint variable, angle) pairs, each with a variable of its own.

        Angle theta is q / n or +- q plus variables declared before and constants,

            theta = q / n + sum_k a_k q_k + b,    so    q = n theta - n (sum_k a_k q_k + b),

        which is how q is written in basic angles. ``groups`` tells by numbers which are those of
        parallel joints, whose sines and cosines join; by default all are.
        """
        groups = groups or [0] * len(angles)
        start = len(self.groups)
        self.groups.extend([] for _ in range(1 + max(groups, default=-1)))
        for (variable, angle), group in zip(angles, groups, strict=True):
            self.groups[start + group].append(angle)
            self._joint_angles[variable] = self._solved(variable, angle)
            self._pair(angle)

    def _solved(self, variable: Any, angle: Any) -> tuple[dict[Any, int], Any]:
        """Return a joint variable as whole multiples of basic angles, and a constant."""
        angle = sp.expand(angle)
        slope = angle.coeff(variable)
        n = int(1 / slope)
        basic, offset = {angle: n}, sp.Integer(0)
        for part in sp.Add.make_args(sp.expand(angle - slope * variable)):
            factor, rest = part.as_coeff_Mul()
            others, constant = self._joint_angles.get(rest, ({}, rest))
            offset -= n * factor * constant
            for other, k in others.items():
                basic[other] = basic.get(other, 0) - int(n * factor * k)
        return {x: k for x, k in basic.items() if k}, sp.expand(offset)

    def generator(self, meaning: Any) -> Trig:
        """Return the generator that stands for ``meaning``, a SymPy object, as a polynomial."""
        if meaning not in self._index:
            index = self._index[meaning] = len(self.generators)
            self.generators.append(meaning)
            self._reducible |= (MAX_EXPONENT + 1) << _BITS * index  # an overflow is not missed
        return Trig(self, {1 << _BITS * self._index[meaning]: 1})

    def _with_square(self, meaning: Any) -> int:
        """Return the index of a generator whose square is replaced in products."""
        self.generator(meaning)
        index = self._index[meaning]
        self._reducible |= (_FIELD & ~1) << _BITS * index
        return index

    def _pair(self, angle: Any) -> tuple[int, int]:
        if angle not in self.pairs:
            sine = self._with_square(sp.sin(angle, evaluate=False))
            self.generator(sp.cos(angle, evaluate=False))
            cosine = self._index[sp.cos(angle, evaluate=False)]
            self._sines[sine] = cosine
            rest = ((0, 1), (2 * self.unit(cosine), -1))
            self._relations.square(self.unit(sine), rest, sine=True)
            self.pairs[angle] = sine, cosine
            for variable in angle.atoms(AppliedUndef) or angle.free_symbols:
                self._slopes.setdefault(variable, {})[angle] = sp.diff(angle, variable)
        return self.pairs[angle]

    def _root(self, n: int) -> Trig:
        """Return sqrt(n), n free of squares, as the product of the roots of its primes."""
        product = self.one
        for prime in sp.primefactors(n):
            root = sp.sqrt(prime)
            if root not in self._index:
                index = self._with_square(root)
                self._roots[index] = prime
                self._relations.square(self.unit(index), ((0, prime),), sine=False)
            product = product * self.generator(root)
        return product

    def _reciprocal(self, base: Any) -> Trig:
        """Return one over an expression that is not zero."""
        if base not in self._inverses:
            polynomial = self.convert(base)
            if not polynomial:
                raise ZeroDivisionError(f"{base}, by which is divided, is zero")
            self._inverses[base] = self._inverse(polynomial)
        return self._inverses[base]

    def _inverse(self, p: Trig) -> Trig:
        """Return one over a polynomial, by the reciprocals of its factors."""
        above = self.one
        for index, divisor in list(self.reciprocals.items()):  # 1/(a/b + c) = b/(a + b c)
            for _ in range(max(self.exponent(m, index) for m in p.terms)):
                p, above = p * divisor, above * divisor
        common = next(iter(p.terms))
        for m in p.terms:
            common = self.common_factor(common, m)
        for index, e in self.exponents(common):
            above = above * self._repeated_product(self._inverse_generator(index), e)
        rest = Trig(self, {m - common: c for m, c in p.terms.items()})
        if len(rest) == 1:
            return above / rest.terms[0]
        scale, factors = self._factors(rest)
        for factor in factors:
            above = above * self._atom(factor)
        return above / scale

    def _inverse_generator(self, index: int) -> Trig:
        """Return one over a generator: of a square root, itself over its square."""
        generator = Trig(self, {self.unit(index): 1})
        if index in self._roots:
            return generator / self._roots[index]
        return self._atom(generator)

    def _factors(self, p: Trig) -> tuple[Coefficient, list[Trig]]:
        """Return a number and irreducible polynomials that p is the product of.

        Where squares are replaced, in polynomials of sines and roots, there is no one way to
        factor: these are taken as they are.
        """
        used = sorted({i for m in p.terms for i, _ in self.exponents(m)})
        if any(i in self._sines or i in self._roots for i in used):
            scale, whole = self._primitive(p)
            return scale, [whole]
        free = FreePolynomials(p.terms)
        number, found = free.of(p.terms).factor_list()
        total, factors = rational(number), []
        for factor, times in found:
            scale, primitive = self._primitive(Trig(self, free.terms(factor)))
            factors += [primitive] * times
            total = total * scale**times
        return total, factors

    def _primitive(self, p: Trig) -> tuple[Coefficient, Trig]:
        """Return (scale, q) with p = scale q: q has coprime whole numbers, and no minus first."""
        divisor = math.lcm(*(c.denominator for c in p.terms.values()))
        content = math.gcd(*(int(c * divisor) for c in p.terms.values()))
        scale = Fraction(content, divisor)
        if self.expanded(p).could_extract_minus_sign():
            scale = -scale
        return _as_integer(scale), p / scale

    def _atom(self, p: Trig) -> Trig:
        """Return the generator that is one over a polynomial."""
        meaning = sp.Pow(self.expanded(p), -1)
        known = meaning in self._index
        reciprocal = self.generator(meaning)
        if not known:
            (unit,) = reciprocal.terms
            self.reciprocals[self._index[meaning]] = p
            self._relations.reciprocal(unit, p.terms)
        return reciprocal

    def reduced(self, terms: dict[Monomial, Coefficient]) -> dict[Monomial, Coefficient]:
        """Apply ``s^2 = 1 - c^2``, ``sqrt(n)^2 = n``, ``g p = 1`` until none does; drop zeros."""
        if thread_time() > self._deadline:
            raise TimeoutError("the closed form takes longer than the time limit")
        mask = self._reducible
        work = [(m, c) for m, c in terms.items() if m & mask]
        if work:
            terms = {m: c for m, c in terms.items() if not m & mask}
            while work:
                m, c = work.pop()
                for m2, c2 in self._reduced_once(m, c):
                    if m2 & mask:
                        work.append((m2, c2))
                    else:
                        terms[m2] = terms.get(m2, 0) + c2
        if self.reciprocals:
            terms = self._relations.cancelled(terms)
        return {m: c for m, c in terms.items() if c}

    def _reduced_once(self, m: Monomial, c: Coefficient) -> list[tuple[Monomial, Coefficient]]:
        bits = m & self._reducible
        index = ((bits & -bits).bit_length() - 1) // _BITS
        square = 2 << _BITS * index
        if index in self._sines:
            rest = m - square
            return [(rest, c), (rest + (2 << _BITS * self._sines[index]), -c)]
        if index in self._roots:
            return [(m - square, c * self._roots[index])]
        raise OverflowError(
            f"an exponent of {self.generators[index]} exceeds {MAX_EXPONENT} in a product"
        )

    # -- from SymPy -------------------------------------------------------------------------------

    def convert(self, expr: Any) -> Trig:
        """Bring a SymPy expression to canonical form; floats become the decimals they print as."""
        expr = sp.sympify(expr)
        found = self._constants.get(expr)
        if found is None:
            found = self._constants[expr] = self._convert(expr)
        return found

    def _convert(self, expr: Any) -> Trig:
        if expr.is_Number:
            return self._number(expr)
        if expr.is_Add:
            return sum((self.convert(arg) for arg in expr.args), self.zero)
        if expr.is_Mul:
            product = self.one
            for arg in expr.args:
                product = product * self.convert(arg)
            return product
        if expr.is_Pow:
            return self._power(expr)
        if isinstance(expr, (sp.sin, sp.cos)):
            sine, cosine = self.sincos(expr.args[0])
            return sine if isinstance(expr, sp.sin) else cosine
        if expr.func in _QUOTIENTS:
            above, below = _QUOTIENTS[expr.func]
            return self.convert(above(*expr.args)) * self._reciprocal(below(*expr.args))
        return self.generator(expr)

    def _number(self, number: Any) -> Trig:
        if number.is_Integer:
            return self.zero + int(number)
        if number.is_Rational:
            return self.zero + Fraction(int(number.p), int(number.q))
        if number.is_Float and number.is_finite:
            return self.zero + _as_integer(Fraction(str(number)))
        raise ValueError(f"{number} is not a finite real number")

    def _power(self, power: Any) -> Trig:
        base, exponent = power.args
        if exponent.is_Integer:
            factor = self.convert(base) if exponent > 0 else self._reciprocal(base)
            return self._repeated_product(factor, abs(int(exponent)))
        if base.is_Integer and base > 0 and exponent == sp.Rational(1, 2):
            return self._root(int(base))
        return self.generator(power)

    def _repeated_product(self, factor: Trig, times: int) -> Trig:
        if times > MAX_EXPONENT:
            raise OverflowError(f"exponent {times} exceeds {MAX_EXPONENT}")
        product = self.one
        for _ in range(times):
            product = product * factor
        return product

    def sincos(self, angle: Any) -> tuple[Trig, Trig]:
        """Return (sin, cos) of an angle, a SymPy expression.

        Integer combinations of joint variables and symbols are expanded by the addition theorems;
        multiples of pi/2, pi/3, pi/4 are exact; any other constant angle is a pair of its own.
        """
        constant, terms = self._split(sp.expand(angle))
        sine, cosine = self._constant_sincos(constant)
        for part, times in terms.items():
            for _ in range(abs(times)):
                s, c = self._basic_sincos(part)
                if times < 0:
                    s = -s
                sine, cosine = sine * c + cosine * s, cosine * c - sine * s
        return sine, cosine

    def _split(self, angle: Any) -> tuple[Any, dict[Any, int]]:
        """Write ``angle`` as a constant plus whole multiples of basic angles and symbols."""
        if angle in self.pairs:
            return sp.Integer(0), {angle: 1}
        constant, terms = sp.Integer(0), dict[Any, int]()
        work = list(sp.Add.make_args(angle))
        while work:
            part = work.pop()
            factor, rest = part.as_coeff_Mul()
            if part.is_number:
                constant += part
            elif rest in self._joint_angles and self._is_whole(factor, rest):
                basic, offset = self._joint_angles[rest]
                work.extend(sp.Add.make_args(sp.expand(factor * offset)))
                for a, n in basic.items():
                    terms[a] = terms.get(a, 0) + int(factor * n)
            elif rest in self._joint_angles:
                for multiple, n in self._in_parts(rest, factor):
                    if multiple.is_Integer:
                        work.append(n * multiple * rest)
                    else:
                        terms[multiple * rest] = terms.get(multiple * rest, 0) + n
            elif not factor.is_Integer:  # sin(-q/2) is -sin(q/2)
                sign = -1 if factor.is_negative else 1
                terms[sign * part] = terms.get(sign * part, 0) + sign
            else:
                terms[rest] = terms.get(rest, 0) + int(factor)
        return constant, {a: n for a, n in terms.items() if n}

    def _is_whole(self, factor: Any, variable: Any) -> bool:
        """Return whether a multiple of a joint variable is one of basic angles, all whole."""
        basic, _ = self._joint_angles[variable]
        return all((factor * n).is_Integer for n in basic.values())

    def _in_parts(self, variable: Any, factor: Any) -> list[tuple[Any, int]]:
        """Return a multiple of a joint variable, that is not whole, as multiples met before.

        2.09 q is q + 1.09 q where 1.09 q has been met; one that is no such sum is a new one.
        """
        size, sign = abs(factor), 1 if factor > 0 else -1
        parts = self._parts.setdefault(variable, {})
        if size not in parts:
            known = [sp.Integer(1), *(x for x, found in parts.items() if found == [(x, 1)])][:4]
            sums = (
                [(x, n) for x, n in zip(known, numbers, strict=True) if n]
                for numbers in itertools.product(range(-3, 4), repeat=len(known))
                if sum(x * n for x, n in zip(known, numbers, strict=True)) == size
            )
            shortest = min(sums, key=lambda found: sum(abs(n) for _, n in found), default=None)
            parts[size] = shortest or [(size, 1)]
        return [(multiple, sign * n) for multiple, n in parts[size]]

    def _basic_sincos(self, angle: Any) -> tuple[Trig, Trig]:
        sine, cosine = self._pair(angle)
        return Trig(self, {1 << _BITS * sine: 1}), Trig(self, {1 << _BITS * cosine: 1})

    def _constant_sincos(self, angle: Any) -> tuple[Trig, Trig]:
        if angle.is_Float:
            angle = sp.Rational(str(angle))
        if (12 * angle / sp.pi).is_Integer:  # multiples of pi/12 that need no nested roots
            sine, cosine = sp.sin(angle), sp.cos(angle)
            return self.convert(sp.expand(sine)), self.convert(sp.expand(cosine))
        if angle.could_extract_minus_sign():
            sine, cosine = self._basic_sincos(-angle)
            return -sine, cosine
        return self._basic_sincos(angle)

    # -- calculus ---------------------------------------------------------------------------------

    def diff(self, p: Trig, variable: Any) -> Trig:
        """Return the partial derivative of ``p`` with respect to a joint variable or a symbol."""
        derivative, terms = self.zero, dict[Monomial, Coefficient]()
        for angle, slope in self._slopes.get(variable, {}).items():
            if slope.is_Rational:
                number = _as_integer(Fraction(int(slope.p), int(slope.q)))
                self._add_angle_derivative(terms, p, self.pairs[angle], number)
            else:
                by_angle = dict[Monomial, Coefficient]()
                self._add_angle_derivative(by_angle, p, self.pairs[angle], 1)
                derivative += self._without_zeros(by_angle) * self.convert(slope)
        derivative += self._without_zeros(terms)
        for index, inner in self._depending_on(variable):
            outer = {}
            for m, c in p.terms.items():
                e = self.exponent(m, index)
                if e:
                    outer[m - self.unit(index)] = c * e
            derivative = derivative + Trig(self, outer) * inner
        return derivative

    def _without_zeros(self, terms: dict[Monomial, Coefficient]) -> Trig:
        return Trig(self, {m: c for m, c in terms.items() if c})

    def _depending_on(self, variable: Any) -> list[tuple[int, Trig | int]]:
        """Return (index, derivative) of the generators but angles that hold ``variable``."""
        found: list[tuple[int, Trig | int]] = []
        angles = {i for pair in self.pairs.values() for i in pair}
        for index, meaning in enumerate(list(self.generators)):
            if meaning == variable:
                found.append((index, 1))
            elif index not in angles and meaning.has(variable) and not meaning.is_Derivative:
                found.append((index, self.convert(sp.diff(meaning, variable))))
        return found

    def _add_angle_derivative(
        self,
        terms: dict[Monomial, Coefficient],
        p: Trig,
        pair: tuple[int, int],
        slope: Coefficient,
    ) -> None:
        """Add slope * dp/dangle: s -> c, c -> -s by the product rule, reduced as it goes."""
        sine, cosine = (_BITS * index for index in pair)
        S, C = 1 << sine, 1 << cosine
        both = (_FIELD << sine) | (_FIELD << cosine)
        for m, c in p.terms.items():
            if not m & both:
                continue
            k = m >> cosine & _FIELD
            c = c * slope
            if m & S:  # d(s c^k) = (k + 1) c^(k+1) - k c^(k-1)
                _accumulate(terms, m - S + C, c * (k + 1))
                if k:
                    _accumulate(terms, m - S - C, -c * k)
            else:  # d(c^k) = -k s c^(k-1)
                _accumulate(terms, m + S - C, -c * k)

    def coefficients(self, p: Trig, variables: Iterable[Any]) -> dict[Monomial, Trig]:
        """Write ``p`` as a sum of monomials in ``variables`` times polynomials in the rest."""
        mask = self.mask(variables)
        parts: dict[Monomial, dict[Monomial, Coefficient]] = {}
        for m, c in p.terms.items():
            parts.setdefault(m & mask, {})[m & ~mask] = c
        return {key: Trig(self, terms) for key, terms in parts.items()}

    def mask(self, meanings: Iterable[Any]) -> int:
        """Return the bits of the monomials that belong to the generators for ``meanings``."""
        mask = 0
        for meaning in meanings:
            index = self._index.get(meaning)
            if index is not None:
                mask |= _FIELD << _BITS * index
        return mask

    @property
    def lowest_bits(self) -> int:
        """The lowest bits of all exponents, which tell the odd ones."""
        return ((1 << _BITS * len(self.generators)) - 1) // _FIELD

    @staticmethod
    def unit(index: int) -> Monomial:
        """Return the monomial that is one generator."""
        return 1 << _BITS * index

    @staticmethod
    def exponent(m: Monomial, index: int) -> int:
        """Return the exponent of one generator."""
        return m >> _BITS * index & _FIELD

    @staticmethod
    def field(unit: Monomial) -> int:
        """Return the bits that hold the exponent of the generator ``unit``."""
        return unit * _FIELD

    @staticmethod
    def common_factor(a: Monomial, b: Monomial) -> Monomial:
        """Return the greatest monomial that divides both."""
        return common_factor(a, b)

    # -- to SymPy and to numbers ------------------------------------------------------------------

    def exponents(self, m: Monomial) -> list[tuple[int, int]]:
        """Return the (generator index, exponent) pairs of a monomial."""
        packed = m.to_bytes(len(self.generators), "little")
        return [(index, e) for index, e in enumerate(packed) if e]

    def expanded(self, p: Trig) -> Any:
        """Return ``p`` as a SymPy sum of products, term by term as it is stored."""
        return sp.Add(
            *(
                sp.Mul(_rational(c), *(self.generators[i] ** e for i, e in self.exponents(m)))
                for m, c in p.terms.items()
            )
        )

    def evaluate(
        self, p: Trig, values: Mapping[Any, Any], known: dict[int, Any] | None = None
    ) -> Any:
        """Return the numeric value of ``p``, an array of the shape of the values.

        ``values`` gives numbers, or arrays of one common shape, for the joint variables, velocities
        and symbols that occur. ``known`` keeps what generators are, for other polynomials at the
        same values.
        """
        import numpy as np

        shape = np.broadcast_shapes(*(np.shape(v) for v in values.values()))
        known = {} if known is None else known

        def value(index: int) -> Any:
            if index not in known:
                known[index] = np.broadcast_to(_numeric(self.generators[index], values), shape)
            return known[index]

        count, items = len(self.generators), list(p.terms.items())
        size = max(1, _CHUNK // max(1, math.prod(shape)))
        total = np.zeros(shape)
        for start in range(0, len(items), size):
            terms = items[start : start + size]
            packed = b"".join(m.to_bytes(count, "little") for m, _ in terms)
            exponents = np.frombuffer(packed, dtype=np.uint8).reshape(-1, count)
            part = np.array([float(c) for _, c in terms]).reshape(-1, *(1,) * len(shape))
            for index in np.flatnonzero(exponents.any(axis=0)).tolist():
                e = exponents[:, index]
                powers = np.stack([value(index) ** k for k in range(e.max() + 1)])
                part = part * powers[e]
            total = total + part.sum(axis=0)
        return total


def _accumulate(terms: dict[Monomial, Coefficient], m: Monomial, c: Coefficient) -> None:
    if c:
        terms[m] = terms.get(m, 0) + c


def _as_integer(x: Fraction) -> Coefficient:
    return x.numerator if x.denominator == 1 else x


def _rational(c: Coefficient) -> Any:
    return sp.Rational(c.numerator, c.denominator)


def _numeric(meaning: Any, values: Mapping[Any, Any]) -> Any:
    if meaning in values:
        return values[meaning]
    if meaning.is_number:  # also one that NumPy has no name for, zeta(3)
        return float(meaning.evalf())
    plain = {x: sp.Dummy() for x in values if meaning.has(x)}  # for functions and derivatives too
    function = sp.lambdify(list(plain.values()), meaning.xreplace(plain), "numpy")
    return function(*(values[x] for x in plain))
