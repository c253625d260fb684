"""Friction, rotors and springs of joints, at the coordinates that move them."""

import pytest
import sympy as sp

from moro.formats.assembly.drives import folded, together
from moro.model import Drive

R = sp.Rational
r, c, k = sp.symbols("r c k")


def test_a_joint_at_a_ratio():
    drive = Drive(R(3), R(5), (R(1), R(2)), stiffness=R(7), rest=R(1, 2))
    found = folded(drive, R(-2), R(1), "joint a")
    assert (found.rotor_inertia, found.viscous, found.stiffness) == (12, 20, 28)
    assert found.coulomb == (4, 2), "forwards at the coordinate is backwards at the joint"
    assert found.rest == R(1, 4), "where -2 q + 1 is 1/2"


def test_torques_at_the_coordinate_are_ratio_times_those_at_the_joint():
    """With every constant a symbol: tau_q = r tau_x(r qd, r qdd), x = r q + b."""
    q, qd, qdd, ratio = (sp.Symbol(x, positive=True) for x in ("q", "qd", "qdd", "ratio"))
    names = sp.symbols("J v f s w_s w k x0 b", positive=True)
    J, v, f, s, ws, w, k, x0, b = names
    drive = Drive(J, v, (f, f), (s, s), ws, w, k, x0)

    def torque(d, x, rate, acceleration):
        stribeck = sp.exp(-((rate / d.stribeck_velocity) ** 2))
        dry = d.coulomb[0] + (d.static[0] - d.coulomb[0]) * stribeck
        spring = d.stiffness * (x - d.rest)
        return (
            d.rotor_inertia * acceleration
            + d.viscous * rate
            + sp.tanh(rate / d.width) * dry
            + spring
        )

    at_joint = ratio * torque(drive, ratio * q + b, ratio * qd, ratio * qdd)
    at_coordinate = torque(folded(drive, ratio, b, "joint"), q, qd, qdd)
    assert sp.simplify(at_joint - at_coordinate) == 0


def test_a_ratio_of_unknown_sign():
    assert folded(Drive(viscous=c, coulomb=(k, k)), r, 0, "joint a") == Drive(
        viscous=r**2 * c, coulomb=(sp.Abs(r) * k, sp.Abs(r) * k)
    )
    with pytest.raises(ValueError, match="joint a: friction differs in the two directions"):
        folded(Drive(coulomb=(k, c)), r, 0, "joint a")


def test_drives_add_up():
    a = Drive(R(1), R(2), (R(3), R(4)), stiffness=R(1), rest=R(0))
    b = Drive(R(1), R(1), (R(1), R(1)), stiffness=R(3), rest=R(4))
    assert together([Drive(), a, Drive(), b], "q") == Drive(
        R(2), R(3), (R(4), R(5)), stiffness=R(4), rest=R(3)
    )
    assert together([Drive(width=R(1), coulomb=(c, c)), Drive(viscous=c)], "q").width == 1
    sharp, smooth = Drive(coulomb=(c, c)), Drive(coulomb=(c, c), width=R(1))
    with pytest.raises(ValueError, match="has one width, not None and 1"):
        together([sharp, smooth], "q")


def test_breakaway_of_two_adds_up_at_one_stribeck_velocity():
    a = Drive(coulomb=(R(1), R(1)), static=(R(2), R(2)), stribeck_velocity=R(1, 10))
    plain = Drive(coulomb=(R(1), R(1)))
    both = together([a, plain], "q")
    assert both.coulomb == (2, 2)
    assert both.static == (3, 3)
    assert both.stribeck_velocity == R(1, 10)
    slower = Drive(static=(R(2), R(2)), stribeck_velocity=R(1, 5))
    with pytest.raises(ValueError, match="one Stribeck velocity, not 1/10 and 1/5"):
        together([a, slower], "q")
