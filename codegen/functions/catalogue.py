"""What can be generated: for each function its name, arguments, meaning and algorithm.

A function that follows from M(q) and G(q) alone is the same for an arm with fewer inertial
parameters and other frames: it is built for several such arms, and the one that takes the fewest
operations is kept (``System.dynamics``). Where the last frame is, and how high the masses are, has
to be asked of the arm itself (``System.geometry``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import chain
from typing import Any

from moro.algorithms.articulated_body import joint_accelerations
from moro.algorithms.composite_rigid_body import joint_inertia
from moro.algorithms.coordinates import displacements
from moro.algorithms.coriolis import joint_coriolis
from moro.algorithms.drives import Functions, drive_torques, spring_energy, spring_torques
from moro.algorithms.energies import energy_of_motion, energy_of_position
from moro.algorithms.external_wrench import joint_torques_in_contact
from moro.algorithms.factorization import factorized, solution
from moro.algorithms.kinematics import frame_jacobian, poses
from moro.algorithms.newton_euler import joint_torques
from moro.algorithms.posture import Posture, posture, with_frame
from moro.model import Model
from moro.spatial.vectors import Scalar
from moro_codegen.functions.arguments import Argument
from moro_codegen.functions.singular import singular, unresisted
from moro_codegen.graph.derivatives import jacobian
from moro_codegen.graph.nodes import Graph, Node, fewest, replaced
from moro_codegen.passes import PASSES, Pass, equivalent_postures, rearranged
from moro_codegen.passes.factor import factored

#: from an arm in a posture to results, flat
Algorithm = Callable[[Posture], Sequence[Scalar]]
#: what functions of a frame call it, unless another is asked for (``at_frame``)
LAST = "the last frame"
#: a sequence of nodes for every output, flat
Outputs = list[Sequence[Node]]


@dataclass(frozen=True)
class System:
    """A model whose scalars are nodes of a graph."""

    graph: Graph
    model: Model
    #: leave out rotor inertia and friction
    rigid: bool = False
    #: the run-time parameters, by symbol
    parameters: Mapping[Any, Node] = field(default_factory=dict)
    #: what its functions are made small by
    passes: tuple[Pass, ...] = PASSES

    @property
    def rotors(self) -> list[Scalar]:
        """The rotor inertias."""
        return [0 if self.rigid else x.drive.rotor_inertia for x in self.model.coordinates]

    def posture(self, q: Sequence[Node]) -> Posture:
        """Return the arm at q."""
        angles = displacements(self.model, q)
        pairs = [(self.graph.sin(angle), self.graph.cos(angle)) for angle in angles]
        return posture(self.model, q, pairs)

    def with_tip(self, q: Sequence[Node]) -> Posture:
        """Return the arm with its joints at q, and the last frame as a further link."""
        tip = self.model.tip
        return with_frame(self.posture(q), tip.link, tip.placement)

    def dynamics(self, arm: Posture, *algorithms: Algorithm) -> list[Node]:
        """Return the results of the algorithm, and for the equivalent arm, that are cheapest."""
        return fewest(self._alternatives(arm, algorithms), self.graph)

    def _alternatives(
        self, arm: Posture, algorithms: Sequence[Algorithm]
    ) -> Iterator[Sequence[Scalar]]:
        """Yield the results of every algorithm for every equivalent arm.

        With run-time parameters, again with sums searched for what cancels: parameters that the
        equations do not have, at the cost of parts that sums shared.
        """
        arms = list(equivalent_postures(arm, self.passes))
        yield from (run(arm) for run in algorithms for arm in arms)
        if self.graph.has_parameters:
            self.graph.cancels = True
            for run in algorithms:
                for other in equivalent_postures(arm, self.passes):
                    yield factored([self.graph.constant(x) for x in run(other)])
            self.graph.cancels = False

    def geometry(self, q: Sequence[Node], algorithm: Algorithm) -> list[Node]:
        """Return the cheapest results for the arm itself, with frame n as a further link."""
        arm = self.with_tip(q)
        return fewest((algorithm(x) for x in rearranged(arm, self.passes)), self.graph)

    def drives(
        self, q: Sequence[Node], qd: Sequence[Node], qdd: Sequence[Scalar]
    ) -> Sequence[Scalar]:
        """Return the torques of rotor inertia, friction and springs."""
        springs = spring_torques(self.model, q)
        if self.rigid:
            return springs
        return _sum(drive_torques(self.model, qd, qdd, self.functions), springs)

    @property
    def functions(self) -> Functions:
        """What friction is made of."""
        call = self.graph.call
        return Functions(self.graph.sign, partial(call, "tanh"), partial(call, "exp"))


@dataclass(frozen=True)
class Function:
    """A function of the dynamics: what C, Python, the headers and the docs say of it.

    ``build`` takes the system and one sequence of nodes per input, and returns one flat sequence
    of nodes per output.
    """

    name: str
    inputs: tuple[Argument, ...]
    outputs: tuple[Argument, ...]
    summary: str
    build: Callable[..., Sequence[Sequence[Node]]]
    #: how it is computed
    algorithm: str = ""
    #: run-time parameters besides those of the robot, with their defaults (None: no default)
    parameters: Mapping[Any, Any] = field(default_factory=dict, hash=False)
    #: what it computes together, in the order of its outputs; itself if that is all
    together: tuple[Function, ...] = ()
    #: name of the frame that it is of, "" for the last; None if it is of none
    frame: str | None = None
    #: its name in the catalogue, if that is another
    kind: str = ""

    @property
    def request(self) -> str:
        """What asks for it: jacobian, jacobian@camera."""
        return f"{self.kind}@{self.frame}" if self.frame else self.name

    @property
    def parts(self) -> tuple[Function, ...]:
        """The functions that it computes, none of which computes several."""
        return tuple(part for one in self.together for part in one.parts) or (self,)


def own_parameters(functions: Iterable[Function]) -> dict[Any, Any]:
    """Return the parameters that functions bring, with their defaults.

    Raises ValueError if two give one symbol different defaults.
    """
    found: dict[Any, Any] = {}
    for function in functions:
        for symbol, default in function.parameters.items():
            if found.setdefault(symbol, default) != default:
                raise ValueError(
                    f"{function.name}: the default of {symbol} is {default}, but another "
                    f"function's is {found[symbol]}"
                )
    return found


def _tau(system: System, q: Sequence[Node], qd: Sequence[Node], qdd: Sequence[Node]) -> Outputs:
    tau = system.dynamics(system.posture(q), lambda arm: joint_torques(arm, qd, qdd))
    return [_sum(tau, system.drives(q, qd, qdd))]


def _tau_with_wrench(
    system: System,
    q: Sequence[Node],
    qd: Sequence[Node],
    qdd: Sequence[Node],
    wrench: Sequence[Node],
) -> Outputs:
    def rigid(arm: Posture) -> Sequence[Scalar]:
        return joint_torques_in_contact(arm, qd, qdd, wrench)

    tau = system.dynamics(system.with_tip(q), rigid)
    return [_sum(tau, system.drives(q, qd, qdd))]


def _bias(system: System, q: Sequence[Node], qd: Sequence[Node]) -> Outputs:
    still = [0] * system.model.nv
    bias = system.dynamics(system.posture(q), lambda arm: joint_torques(arm, qd, still))
    return [_sum(bias, system.drives(q, qd, still))]


def _gravity_vector(system: System, q: Sequence[Node]) -> Outputs:
    still = [0] * system.model.nv
    gravity = system.dynamics(system.posture(q), lambda arm: joint_torques(arm, still, still))
    return [_sum(gravity, spring_torques(system.model, q))]


def _inertia_matrix(system: System, q: Sequence[Node]) -> Outputs:
    rotors = system.rotors
    return [system.dynamics(system.posture(q), lambda arm: _flat(joint_inertia(arm, rotors)))]


def _coriolis_matrix(system: System, q: Sequence[Node], qd: Sequence[Node]) -> Outputs:
    return [system.dynamics(system.posture(q), lambda arm: _flat(joint_coriolis(arm, qd)))]


def _forward_dynamics(
    system: System, q: Sequence[Node], qd: Sequence[Node], tau: Sequence[Node]
) -> Outputs:
    still, rotors = [0] * system.model.nv, system.rotors
    if joints := unresisted(system.model, rotors):
        raise singular(system.model, joints)
    left = [x - y for x, y in zip(tau, system.drives(q, qd, still), strict=True)]

    def by_articulated_bodies(arm: Posture) -> Sequence[Scalar]:
        return joint_accelerations(arm, rotors, qd, left)

    def by_factorization(arm: Posture) -> Sequence[Scalar]:
        bias = joint_torques(arm, qd, still)
        factors = factorized(joint_inertia(arm, rotors), arm)
        return solution(factors, [x - y for x, y in zip(left, bias, strict=True)])

    arm = system.posture(q)
    algorithms = (by_articulated_bodies, by_factorization)
    try:
        return [system.dynamics(arm, *(algorithms if _one_to_one(arm) else algorithms[1:]))]
    except ZeroDivisionError:  # whatever the run-time parameters are
        raise singular(system.model) from None


def _tau_derivatives(
    system: System, q: Sequence[Node], qd: Sequence[Node], qdd: Sequence[Node]
) -> Outputs:
    def derivatives(arm: Posture) -> Sequence[Scalar]:
        return _flat((*_slopes(system, arm, q, qd, qdd), _flat(joint_inertia(arm, system.rotors))))

    return _thirds(system.dynamics(system.posture(q), derivatives))


def _forward_dynamics_derivatives(
    system: System, q: Sequence[Node], qd: Sequence[Node], tau: Sequence[Node]
) -> Outputs:
    (caused,) = _forward_dynamics(system, q, qd, tau)
    qdd = [system.graph.input("qdd", k) for k in range(len(q))]

    def derivatives(arm: Posture) -> Sequence[Scalar]:
        """M dqdd = dtau - (dtau/dq) dq - (dtau/dqd) dqd, for the qdd that tau causes."""
        n, factors = len(q), factorized(joint_inertia(arm, system.rotors), arm)
        by_q, by_qd = _slopes(system, arm, q, qd, qdd)
        by_tau = [system.graph.constant(int(i == j)) for i in range(n) for j in range(n)]
        slopes = []
        for block in ([-x for x in by_q], [-x for x in by_qd], by_tau):
            columns = [solution(factors, block[j::n]) for j in range(n)]
            slopes += [system.graph.constant(x) for row in zip(*columns, strict=True) for x in row]
        return replaced(slopes, dict(zip(qdd, caused, strict=True)))

    return _thirds(system.dynamics(system.posture(q), derivatives))


def _slopes(
    system: System, arm: Posture, q: Sequence[Node], qd: Sequence[Node], qdd: Sequence[Node]
) -> tuple[list[Node], list[Node]]:
    """Return d tau/dq and d tau/dqd, flat."""
    tau = _sum(joint_torques(arm, qd, qdd), system.drives(q, qd, qdd))
    nodes = [system.graph.constant(x) for x in tau]
    return _flat(jacobian(nodes, q)), _flat(jacobian(nodes, qd))


def _thirds(entries: Sequence[Node]) -> Outputs:
    third = len(entries) // 3
    return [entries[k * third : (k + 1) * third] for k in range(3)]


def _forward_kinematics(system: System, q: Sequence[Node]) -> Outputs:
    def pose(arm: Posture) -> Sequence[Scalar]:
        tip = poses(arm)[-1]
        rows = [(*row, x) for row, x in zip(tip.R, tip.p, strict=True)]
        return _flat([*rows, (0, 0, 0, 1)])

    return [system.geometry(q, pose)]


def _jacobian(system: System, q: Sequence[Node]) -> Outputs:
    return [system.geometry(q, lambda arm: _flat(frame_jacobian(arm)))]


def _kinetic_energy(system: System, q: Sequence[Node], qd: Sequence[Node]) -> Outputs:
    rotors = system.rotors
    return [system.dynamics(system.posture(q), lambda arm: [energy_of_motion(arm, rotors, qd)])]


def _potential_energy(system: System, q: Sequence[Node]) -> Outputs:
    (gravity,) = system.geometry(q, lambda arm: [energy_of_position(arm)])
    return [[gravity + spring_energy(system.model, q)]]


def _one_to_one(arm: Posture) -> bool:
    """Return whether each coordinate moves one joint of its own, by 1 or -1."""
    ratios = [ratio for link in arm.links for _, ratio in link.terms]
    return len(ratios) == len(arm.links) == arm.nv and all(
        ratio.op == "const" and abs(ratio.value) == 1 for ratio in ratios
    )


def _of_no_robot(*_: object) -> Outputs:
    raise ValueError("the regressor is that of a robot: compile(robot, functions=('regressor',))")


def _flat(rows: Iterable[Iterable[Scalar]]) -> list[Scalar]:
    return list(chain.from_iterable(rows))


def _sum(a: Sequence[Scalar], b: Sequence[Scalar]) -> list[Scalar]:
    return [x + y for x, y in zip(a, b, strict=True)]


Q = Argument("q", ("n",), "rad or m", "joint positions")
QD = Argument("qd", ("n",), "rad/s or m/s", "joint velocities")
QDD = Argument("qdd", ("n",), "rad/s^2 or m/s^2", "joint accelerations")
TAU = Argument(
    "tau", ("n",), "N m or N", "joint torques, about the joint axes (forces, along them)"
)
WRENCH = Argument(
    "wrench",
    (6,),
    "N, N m",
    f"force, then moment about the origin of {LAST}, on its link; in frame 0",
)
T = Argument("T", (4, 4), "1, m", f"pose of {LAST} in frame 0: [[R, p], [0, 1]]")
J = Argument("J", (6, "n"), "m/rad, 1", f"(v, omega) of {LAST} = J qd; in frame 0")
M = Argument("M", ("n", "n"), "kg m^2 to kg", "inertia matrix, symmetric")
C = Argument("C", ("n", "n"), "N m s to N s/m", "Coriolis matrix")
G = Argument("G", ("n",), "N m or N", "torques (forces) against gravity")
TAU_BY_Q = Argument("dtau_dq", ("n", "n"), "N m/rad to N/m", "d tau_i/d q_j")
TAU_BY_QD = Argument("dtau_dqd", ("n", "n"), "N m s/rad to N s/m", "d tau_i/d qd_j")
QDD_BY_Q = Argument("dqdd_dq", ("n", "n"), "1/s^2", "d qdd_i/d q_j")
QDD_BY_QD = Argument("dqdd_dqd", ("n", "n"), "1/s", "d qdd_i/d qd_j")
QDD_BY_TAU = Argument("dqdd_dtau", ("n", "n"), "1/(kg m^2) to 1/kg", "d qdd_i/d tau_j: 1/M")
K = Argument("K", (), "J", "kinetic energy")
P = Argument("P", (), "J", "potential energy, zero at the origin of frame 0")

FUNCTIONS = {
    function.name: function
    for function in (
        Function(
            "tau",
            (Q, QD, QDD),
            (TAU,),
            "Inverse dynamics: M(q) qdd + C(q, qd) qd + G(q), with rotor inertia and friction.",
            _tau,
            "recursive Newton-Euler",
        ),
        Function(
            "tau_with_wrench",
            (Q, QD, QDD, WRENCH),
            (TAU,),
            "Inverse dynamics against a wrench w that the environment exerts on the link of "
            f"{LAST}: M(q) qdd + C(q, qd) qd + G(q) - J(q)^T w, with rotor inertia and friction.",
            _tau_with_wrench,
            f"recursive Newton-Euler, with the wrench on a further link at {LAST}",
            frame="",
        ),
        Function(
            "bias",
            (Q, QD),
            (Argument("bias", ("n",), "N m or N", "torques (forces) for zero acceleration"),),
            "What tau is without joint accelerations: C(q, qd) qd + G(q), with friction.",
            _bias,
            "recursive Newton-Euler for qdd = 0",
        ),
        Function(
            "gravity_vector",
            (Q,),
            (G,),
            "Gravity vector G(q), the gradient of P.",
            _gravity_vector,
            "recursive Newton-Euler at rest",
        ),
        Function(
            "inertia_matrix",
            (Q,),
            (M,),
            "Inertia matrix M(q), rotor inertias on its diagonal.",
            _inertia_matrix,
            "composite rigid bodies",
        ),
        Function(
            "coriolis_matrix",
            (Q, QD),
            (C,),
            "Coriolis matrix C(q, qd) of the Christoffel symbols: dM/dt - 2 C is skew-symmetric.",
            _coriolis_matrix,
            "recursion over composite bodies, of the Christoffel symbols",
        ),
        Function(
            "forward_dynamics",
            (Q, QD, TAU),
            (QDD,),
            "Forward dynamics: the accelerations that joint torques cause, the inverse of tau.",
            _forward_dynamics,
            "articulated bodies, or M = L D L^T, whichever costs fewer operations",
        ),
        Function(
            "tau_derivatives",
            (Q, QD, QDD),
            (TAU_BY_Q, TAU_BY_QD, M),
            "Derivatives of tau with respect to q, qd and qdd (that is M); Coulomb friction, which "
            "jumps, has none.",
            _tau_derivatives,
            "the graph of tau differentiated; M by composite rigid bodies",
        ),
        Function(
            "forward_dynamics_derivatives",
            (Q, QD, TAU),
            (QDD_BY_Q, QDD_BY_QD, QDD_BY_TAU),
            "Derivatives of forward_dynamics with respect to q, qd and tau.",
            _forward_dynamics_derivatives,
            "M = L D L^T and the derivatives of tau",
        ),
        Function(
            "forward_kinematics",
            (Q,),
            (T,),
            f"Forward kinematics: the pose of {LAST}.",
            _forward_kinematics,
            "product of the transforms",
            frame="",
        ),
        Function(
            "jacobian",
            (Q,),
            (J,),
            f"Jacobian of {LAST}: velocity of its origin, angular velocity.",
            _jacobian,
            "joint axes, and the way from each to the frame",
            frame="",
        ),
        Function(
            "kinetic_energy",
            (Q, QD),
            (K,),
            "Kinetic energy 1/2 qd^T M(q) qd, with that of the rotors.",
            _kinetic_energy,
            "velocities from the base to the tip",
        ),
        Function(
            "potential_energy",
            (Q,),
            (P,),
            "Potential energy P(q): minus the sum of m_i g . r_Ci.",
            _potential_energy,
            "heights of the centres of mass, from the tip to the base",
        ),
    )
}

#: what is known of it without a robot (``base_regressor``); b is the number of base parameters
REGRESSOR = Function(
    "regressor",
    (Q, QD, QDD),
    (
        Argument("Y", ("n", "b"), "SI", "torques (forces) per unit of each base parameter"),
        Argument("p", ("b",), "SI", "base parameters, with the values of the model"),
    ),
    "Regressor: tau = Y(q, qd, qdd) p, friction and rotor inertia included.",
    _of_no_robot,
    "body regressors (Atkeson, An & Hollerbach), columns of base parameters",
)

#: the functions that have a name
KNOWN = {**FUNCTIONS, REGRESSOR.name: REGRESSOR}
