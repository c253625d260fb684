"""The parameters that the torques of an arm can tell apart, and how all others join them.

The energies are linear in the standard parameters (``standard_parameters``). Parameters act on the
torques alike exactly if their functions K_k, and P_k but for a constant, depend linearly on each
other, with factors that the geometry fixes. The base parameters are those, counted from the base to
the tip, whose functions do not depend on the ones before; every other parameter adds to them.

Two steps find the groups:

1. Rules in closed form, from the tip to the base. What of a link does not change when its joint
   moves acts as if fixed to the link before: of a link that turns, a rod on its axis (YY, MZ, M);
   of one that slides, its tensor. It moves there by [[S, h], [h^T, m]] -> T [[S, h], [h^T, m]] T^T.
2. Some more depend near the base: where joints are parallel to the first, gravity is along it, a
   joint slides before the second direction of turning, or rotors turn. ``independence`` finds them,
   and proves that the rest are independent: the set is minimal.

Gautier & Khalil, Direct calculation of minimum set of inertial parameters of serial robots, IEEE
Trans. on Robotics and Automation 6 (1990); Khalil & Dombre, Modeling, Identification and Control of
Robots (2002), section 9.4, whose names are used: XXR_2 is what XX_2 has become.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import sympy as sp

from moro.algorithms.drives import Functions, step, stribeck
from moro.closed_form import ClosedForm
from moro.identification.independence import Independence
from moro.identification.standard_parameters import (
    BODY,
    MOMENTS,
    TENSOR,
    Standard,
    matrix,
    parameters,
    values,
    vector,
)
from moro.model import Drive, Joint, Model
from moro.printing.display import Display
from moro.printing.plain import in_decimals, prefers_decimals
from moro.printing.tables import Table
from moro.scalars.relations import Coefficient, Monomial
from moro.scalars.trig import Trig, TrigRing
from moro.spatial.moments import Moments
from moro.spatial.vectors import Scalar

#: characters of a value that still goes into a table
_SHORT = 80

#: a linear combination of standard parameters
Form: TypeAlias = "dict[Standard, Trig]"


@dataclass(frozen=True)
class BaseParameter:
    """A base parameter of an arm."""

    #: the standard parameter that leads the group
    leader: Standard
    #: XX_2, or XXR_2 if others have joined it
    symbol: Any
    #: of standard parameters XX_1 .. M_n, about the origins of Khalil's frames, and lengths
    combination: Any
    #: the same in the symbols and numbers that the model was given
    value: Any
    #: SI unit
    unit: str

    @property
    def link(self) -> int:
        """Number of the link (and joint), from 1."""
        return self.leader.link + 1


class BaseParameters(Sequence[BaseParameter]):
    """The base parameters of an arm, from the base to the tip; prints as a table."""

    def __init__(self, parameters: Iterable[BaseParameter]):
        self._parameters = tuple(parameters)

    @property
    def symbols(self) -> list[Any]:
        """Their symbols."""
        return [x.symbol for x in self]

    @property
    def combinations(self) -> sp.Matrix:
        """Their combinations of standard parameters (b x 1)."""
        return sp.Matrix(len(self), 1, [x.combination for x in self])

    @property
    def values(self) -> sp.Matrix:
        """Their values in the symbols and numbers of the model (b x 1)."""
        return sp.Matrix(len(self), 1, [x.value for x in self])

    @property
    def table(self) -> Table:
        """Symbol, combination, value (if all are short enough) and unit; decimals where there are.

        Numbers are decimals in the whole table as soon as one is a fifth, a tenth or finer than a
        twelfth.
        """
        columns = [self.symbols, list(self.combinations), list(self.values)]
        if prefers_decimals(x for column in columns for x in column):
            columns = [[in_decimals(x) for x in column] for column in columns]
        rows = [(*row, x.unit) for row, x in zip(zip(*columns, strict=True), self, strict=True)]
        headings = ("parameter", "combination", "value", "unit")
        if all(len(str(value)) <= _SHORT for _, _, value, _ in rows):
            return Table(headings, rows)
        return Table((*headings[:2], headings[3]), [(*row[:2], row[3]) for row in rows])

    def counted(self, model: Model, zeros: bool | None) -> BaseParameters:
        """Return those that count: not zero, or zero where a body is given in numbers.

        ``zeros`` True or False keeps or leaves out all that are zero.
        """

        def counts(x: BaseParameter) -> bool:
            if zeros or x.value != 0:
                return True
            is_number = x.leader.name in BODY and model.bodies[x.leader.link].in_numbers
            return zeros is None and is_number

        return BaseParameters(x for x in self if counts(x))

    def __getitem__(self, i: Any) -> Any:
        return BaseParameters(self._parameters[i]) if isinstance(i, slice) else self._parameters[i]

    def __iter__(self) -> Iterator[BaseParameter]:
        return iter(self._parameters)

    def __len__(self) -> int:
        return len(self._parameters)

    def __repr__(self) -> str:
        return repr(self.table)

    def _repr_latex_(self) -> str:
        return self.table._repr_latex_()

    def _repr_html_(self) -> str:
        return self.table._repr_html_()


def base_parameters(
    model: Model, ring: TrigRing, rates: Sequence[Any], display: Display
) -> BaseParameters:
    """Return the base parameters of a model, friction among them.

    Bodies that are not given have no values: there the combinations of standard parameters stand
    for themselves.
    """
    known = values(model, ring)
    found = []
    for leader, form in base_forms(model, ring, rates).items():
        joined = "R" if len(form) > 1 else ""
        symbol = sp.Symbol(f"{leader.name}{joined}_{leader.link + 1}")
        combination = value = _combination(form, display)
        if all(x in known for x in form):
            value = display(sum((factor * known[x] for x, factor in form.items()), ring.zero))
        found.append(BaseParameter(leader, symbol, combination, value, _unit_of(leader, model)))
    for i in range(model.nv):
        for name, value in drive_coefficients(model, i).items():
            x = Standard(i, name)
            found.append(BaseParameter(x, x.symbol, x.symbol, value, _unit_of(x, model)))
    return BaseParameters(sorted(found, key=lambda x: x.leader.place))


def base_parameters_of(model: Model, zeros: bool | None = None) -> BaseParameters:
    """Return those base parameters of a model that count, without a robot's notation."""
    ring, rates = TrigRing(), [sp.Dummy() for _ in model.coordinates]
    ClosedForm(model, ring)  # declares its angles
    for symbol in (*model.qs, *rates, *model.defaults):
        ring.generator(symbol)
    display = Display(ring, inertial=inertial_symbols(model), velocities=rates)
    return base_parameters(model, ring, rates, display).counted(model, zeros)


def drive_coefficients(model: Model, j: int) -> dict[str, Any]:
    """Return what torques are linear in of the friction and the spring of a coordinate.

    Viscous friction FV; Coulomb's FC, half the sum of what the two directions have, and FD, half
    the difference; likewise FS and FE of what Stribeck's adds; a spring's stiffness KQ, and KR, its
    torque at q = 0. ``terms_of_drive`` are what they are factors of.
    """
    drive, coefficients = model.coordinates[j].drive, {}
    if "viscous_friction" not in model.not_set:
        coefficients["FV"] = drive.viscous
    if "coulomb_friction" not in model.not_set:
        forward, backward = drive.coulomb
        coefficients |= {"FC": (forward + backward) / 2, "FD": (forward - backward) / 2}
        if drive.static is not None:
            more, less = drive.static[0] - forward, drive.static[1] - backward
            coefficients |= {"FS": (more + less) / 2, "FE": (more - less) / 2}
    if drive.stiffness != 0:
        coefficients |= {"KQ": drive.stiffness, "KR": -drive.stiffness * drive.rest}
    return coefficients


def terms_of_drive(drive: Drive, q: Scalar, qd: Scalar, functions: Functions) -> dict[str, Scalar]:
    """Return the torques (forces) per unit of ``drive_coefficients``."""
    s, fading = step(drive, qd, functions), 1
    if drive.static is not None:
        fading = stribeck(drive, qd, functions)
    return {
        "FV": qd, "FC": s, "FD": s * s, "FS": s * fading, "FE": s * s * fading, "KQ": q, "KR": 1,
    }  # fmt: skip


def inertial_symbols(model: Model) -> set[Any]:
    """Return the symbols of masses and central tensors; of other tensors, those of no length."""
    masses, tensors, lengths = set[Any](), set[Any](), set[Any]()
    for body in model.bodies:
        masses |= _symbols((body.mass,))
        about = body.inertia if body.central is None else body.central.inertia
        tensors |= _symbols(x for row in about for x in row)
        if body.central is None:
            lengths |= _symbols(body.first_moment)
    if lengths:
        lengths = lengths.union(*(_symbols(joint.placement.p) for joint in model.joints))
    return masses | (tensors - lengths)


def _symbols(values: Iterable[Any]) -> set[Any]:
    return set().union(*(sp.sympify(x).free_symbols for x in values))


def _combination(form: Form, display: Display) -> Any:
    """Return a form as people write it: parameters with the same factors share a bracket."""
    alike: dict[tuple[Monomial, Coefficient], dict[Any, int]] = {}
    for x, factor in form.items():
        for m, c in display.shortened(factor).items():
            size, sign = (c, 1) if c > 0 else (-c, -1)
            alike.setdefault((m, size), {})[x.symbol] = sign
    brackets: dict[Any, Any] = {}
    for (m, c), signs in alike.items():
        first = next(iter(signs.values()))
        inner = sp.Add(*(first * sign * x for x, sign in signs.items()))
        outer = display.ring.expanded(Trig(display.ring, {m: first * c}))
        brackets[inner] = brackets.get(inner, 0) + outer
    return sp.Add(*(outer * inner for inner, outer in brackets.items()))


def _unit_of(parameter: Standard, model: Model) -> str:
    if parameter.name in BODY:
        return {"M": "kg"}.get(parameter.name, "kg m" if parameter.name in MOMENTS else "kg m^2")
    kind = model.types[parameter.link]
    if parameter.name == "IA":
        return "kg m^2" if kind.is_angle else "kg"
    by = {"FV": f" s/{kind.unit}", "KQ": f"/{kind.unit}"}
    return kind.effort + by.get(parameter.name, "")


def base_forms(model: Model, ring: TrigRing, rates: Sequence[Any]) -> dict[Standard, Form]:
    """Return {leading parameter: the combination that joins it}, from the base to the tips.

    ``ring`` knows the model's angles already; ``rates`` are symbols of the joint velocities. Only
    geometry and gravity matter, and whether there are rotors: all bodies count as general.
    """
    forms: dict[Standard, Form] = {}
    every = [
        Standard(i, name)
        for i, joint in enumerate(model.joints)
        for name in BODY
        if name not in joint.type.absent
    ]
    if "rotor_inertias" not in model.not_set:
        every += [Standard(j, "IA") for j in range(model.nv)]
    forms |= {x: {x: ring.one} for x in every}
    _move_to_parents(forms, model.joints, ring)
    left = sorted(forms, key=lambda x: (x.name == "IA", *x.place))  # rotors join bodies
    for parameter, factors in Independence(model, ring, rates).dependences(left).items():
        form = forms.pop(parameter)
        for leader, factor in factors.items():
            _add(forms[leader], factor, form)
    return {leader: forms[leader] for leader in sorted(forms, key=lambda x: x.place)}


def _move_to_parents(forms: dict[Standard, Form], joints: Sequence[Joint], ring: TrigRing) -> None:
    for i, joint in reversed(list(enumerate(joints))):
        for name in joint.type.carried:
            moving, is_rod = forms.pop(Standard(i, name)), "XX" not in joint.type.carried
            if is_rod and name == "YY":  # a rod has XX = YY
                _add(forms[Standard(i, "XX")], -ring.one, moving)
            if joint.parent >= 0:
                for target, factor in _seen_from_parent(joint, name, is_rod, ring).items():
                    _add(forms[Standard(joint.parent, target)], factor, moving)


def _seen_from_parent(joint: Joint, name: str, is_rod: bool, ring: TrigRing) -> dict[str, Trig]:
    """Return what 1 of a parameter that the joint does not change is in the parent's frame."""
    R, p = matrix(joint.placement.R, ring), vector(joint.placement.p, ring)
    moments = _unit(name, ring, is_rod).rotated(R).displaced(p)
    return {target: x for target, x in parameters(moments).items() if x}


def _unit(name: str, ring: TrigRing, rod: bool) -> Moments:
    """Return the moments of 1 of a parameter; of a rod along z, YY = XX."""
    h, I = [0, 0, 0], [[0, 0, 0], [0, 0, 0], [0, 0, 0]]
    if name in MOMENTS:
        h[MOMENTS[name]] = 1
    elif name in TENSOR:
        j, k = TENSOR[name]
        I[j][k] = I[k][j] = 1
        I[0][0] = 1 if rod else I[0][0]
    x, y, z = (vector(row, ring) for row in I)
    mass = ring.one if name == "M" else ring.zero
    return Moments.of(mass, vector(h, ring), (x, y, z))


def _add(form: Form, factor: Trig, other: Form) -> None:
    for parameter, x in other.items():
        total = form.get(parameter, 0) + factor * x
        if total:
            form[parameter] = total
        else:
            form.pop(parameter, None)
