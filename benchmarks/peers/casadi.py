"""CasADi: C code generated from SX graphs of inverse dynamics, and derivatives by its own rules.

Two graphs, for CasADi's code depends on what it is given: Newton-Euler as textbooks print it, in
vectors and matrices, the way a user would write it (the inertia matrix is its Jacobian by qdd); and
moro's own algorithms, run on SX. Both get common subexpressions removed where that helps. Forward
dynamics solves with CasADi's L D L^T; derivatives are CasADi's Jacobians.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

import casadi as ca
import numpy as np

from benchmarks import native
from benchmarks.arms import Arm, Chain
from benchmarks.native import Loop, library
from benchmarks.tasks import TASKS, Call, Task
from benchmarks.timing import seconds_of
from moro.algorithms.composite_rigid_body import joint_inertia
from moro.algorithms.coordinates import displacements
from moro.algorithms.coriolis import joint_coriolis
from moro.algorithms.newton_euler import joint_torques
from moro.algorithms.posture import Posture, posture

MADE = "CasADi"
CONTENDERS = TEXTBOOK, OURS = "CasADi, textbook", "CasADi, moro's algorithm"

VERSIONS = {"casadi": ca.__version__}
FLAGS = native.FLAGS
Z = ca.SX([0, 0, 1])


def textbook_torques(chain: Chain, q: ca.SX, qd: ca.SX, qdd: ca.SX) -> ca.SX:
    """Return the joint torques by Newton-Euler (Luh, Walker & Paul 1980), in the links' frames."""
    w, wd, a = ca.SX(3, 1), ca.SX(3, 1), ca.SX(-chain.gravity)
    turns, arms, forces, moments = [], [], [], []
    for i, revolute in enumerate(chain.revolute):
        R, p = ca.SX(chain.R[i]), ca.SX(chain.p[i])
        if revolute:
            s, c = ca.sin(q[i]), ca.cos(q[i])
            R = R @ ca.vertcat(ca.horzcat(c, -s, 0), ca.horzcat(s, c, 0), ca.SX([[0, 0, 1]]))
        else:
            p = p + R @ (Z * q[i])
        a = R.T @ (a + ca.cross(wd, p) + ca.cross(w, ca.cross(w, p)))
        w, wd = R.T @ w, R.T @ wd
        if revolute:
            wd = wd + ca.cross(w, Z * qd[i]) + Z * qdd[i]
            w = w + Z * qd[i]
        else:
            a = a + 2 * ca.cross(w, Z * qd[i]) + Z * qdd[i]
        m, com, inertia = chain.mass[i], ca.SX(chain.com[i]), ca.SX(chain.inertia[i])
        f = m * (a + ca.cross(wd, com) + ca.cross(w, ca.cross(w, com)))
        turns.append(R)
        arms.append(p)
        forces.append(f)
        moments.append(inertia @ wd + ca.cross(w, inertia @ w) + ca.cross(com, f))
    f, n, tau = ca.SX(3, 1), ca.SX(3, 1), []
    for i in reversed(range(chain.dof)):
        f, n = forces[i] + f, moments[i] + n
        tau.insert(0, n[2] if chain.revolute[i] else f[2])
        f = turns[i] @ f
        n = turns[i] @ n + ca.cross(arms[i], f)
    return ca.vertcat(*tau)


def our_posture(arm: Arm, q: ca.SX) -> Posture:
    """Return what moro's algorithms read, in CasADi's scalars."""
    model = arm.robot.model().map(float)
    positions = ca.vertsplit(q)
    angles = displacements(model, positions)
    return posture(model, positions, [(ca.sin(angle), ca.cos(angle)) for angle in angles])


class Graph:
    """The dynamics of an arm as CasADi's expressions, from one of the two graphs."""

    def __init__(self, arm: Arm, contender: str) -> None:
        self.dof = arm.dof
        names = ("q", "qd", "qdd", "tau")
        self.states = {name: ca.SX.sym(name, arm.dof) for name in names}
        q, qd, qdd, _ = self.states.values()
        if contender == TEXTBOOK:
            self._torques = textbook_torques(arm.chain, q, qd, qdd)
            self._M = ca.jacobian(self._torques, qdd)
            self._coriolis = None
        else:
            ours, rates = our_posture(arm, q), ca.vertsplit(qd)
            self._torques = ca.vertcat(*joint_torques(ours, rates, ca.vertsplit(qdd)))
            self._M = _matrix(joint_inertia(ours, [0] * arm.dof))
            self._coriolis = _matrix(joint_coriolis(ours, rates))

    def tau(self) -> list[ca.SX]:
        """Return M qdd + C qd + G."""
        return [self._torques]

    def bias(self) -> list[ca.SX]:
        """Return C qd + G."""
        return [ca.substitute(self._torques, self.states["qdd"], ca.SX.zeros(self.dof))]

    def gravity_vector(self) -> list[ca.SX]:
        """Return G."""
        return [ca.substitute(self.bias()[0], self.states["qd"], ca.SX.zeros(self.dof))]

    def inertia_matrix(self) -> list[ca.SX]:
        """Return M."""
        return [self._M]

    def coriolis_matrix(self) -> list[ca.SX]:
        """Return C of Christoffel's symbols, if the graph has it."""
        return [] if self._coriolis is None else [self._coriolis]

    def forward_dynamics(self) -> list[ca.SX]:
        """Return qdd, by L D L^T."""
        return [ca.ldl_solve(self.states["tau"] - self.bias()[0], *ca.ldl(self._M))]

    def tau_derivatives(self) -> list[ca.SX]:
        """Return d tau/dq, d tau/dqd, d tau/dqdd."""
        by = [ca.jacobian(self._torques, self.states[name]) for name in ("q", "qd")]
        return [*by, self._M]

    def forward_dynamics_derivatives(self) -> list[ca.SX]:
        """Return d qdd/dq, d qdd/dqd, d qdd/dtau."""
        qdd = self.forward_dynamics()[0]
        return [ca.jacobian(qdd, self.states[name]) for name in ("q", "qd", "tau")]


@lru_cache(maxsize=256)
def function(arm: Arm, task: Task, contender: str) -> ca.Function | None:
    """Return CasADi's function, or None where the graph has no algorithm for it."""
    graph = _graph(arm, contender)
    outputs = getattr(graph, task.name)()
    if not outputs:
        return None
    inputs = [graph.states[name] for name in task.inputs]
    # CasADi stores matrices column by column
    dense = [ca.densify(x if x.is_column() else x.T) for x in outputs]
    name = f"{arm.label}_{task.name}"
    plain, shared = (ca.Function(name, inputs, x) for x in (dense, ca.cse(dense)))
    return min((plain, shared), key=ca.Function.n_instructions)


@lru_cache(maxsize=64)
def _graph(arm: Arm, contender: str) -> Graph:
    return Graph(arm, contender)


def _matrix(rows: list[list[object]]) -> ca.SX:
    return ca.vertcat(*(ca.horzcat(*row) for row in rows))


def operations(arm: Arm, contender: str) -> int:
    """Return how many additions, subtractions and multiplications tau takes, or their like."""
    made = function(arm, TASKS["tau"], contender)
    free = {ca.OP_CONST, ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_SIN, ca.OP_COS}
    return sum(made.instruction_id(k) not in free for k in range(made.n_instructions()))


def loops(arm: Arm, task: Task) -> Iterator[Loop]:
    """Yield CasADi's C code of a function, as calls, from either graph."""
    for contender in CONTENDERS:
        made = function(arm, task, contender)
        if made is not None:
            compiled = _library(made)
            yield Loop(contender, task, compiled.calls, owner=compiled)


def python_calls(arm: Arm) -> Iterator[Call]:
    """Yield tau through CasADi's Python functions, compiled, from the graph that is shorter."""
    made = min(
        (function(arm, TASKS["tau"], contender) for contender in CONTENDERS),
        key=ca.Function.n_instructions,
    )
    compiled = ca.external(made.name(), _library(made)._name)
    yield Call("CasADi", compiled)
    buffer, evaluate = compiled.buffer()
    inputs, result = np.empty((3, arm.dof)), np.empty(arm.dof)
    for k in range(3):
        buffer.set_arg(k, memoryview(inputs[k]))
    buffer.set_res(0, memoryview(result))

    def buffered(q: np.ndarray, qd: np.ndarray, qdd: np.ndarray) -> np.ndarray:
        inputs[0], inputs[1], inputs[2] = q, qd, qdd
        evaluate()
        return result

    buffered.buffer = buffer  # has to outlive the call
    yield Call("CasADi, buffers", buffered)


def making(arm: Arm) -> tuple[float, float]:
    """Return the seconds of generating C text of tau, the textbook's, and of the compiler."""
    chain, q, qd, qdd = arm.chain, *(ca.SX.sym(name, arm.dof) for name in ("q", "qd", "qdd"))

    def make() -> None:
        tau = textbook_torques(chain, q, qd, qdd)
        native.compiled({"tau.c": _text(ca.Function("tau", [q, qd, qdd], [tau]))})

    return seconds_of(make)


def _text(made: ca.Function) -> str:
    """Return CasADi's C code."""
    generator = ca.CodeGenerator(f"{made.name()}.c")
    generator.add(made)
    return generator.dump()


def _library(made: ca.Function) -> object:
    """Return the library of CasADi's C code with the loop that calls it."""
    n_in, n_out = made.n_in(), made.n_out()
    arguments = "".join(
        f"    arg[{k}] = in[{k}] + i * {made.numel_in(k)};\n" for k in range(n_in)
    ) + "".join(f"    res[{k}] = out[{k}] + i * {made.numel_out(k)};\n" for k in range(n_out))
    text = f"""\
#include "loops.h"

int {made.name()}(const double **arg, double **res, long long *iw, double *w, int mem);

void calls(void *self, size_t count, const double *const *in, double *const *out) {{
  const double *arg[{made.sz_arg()}];
  double *res[{made.sz_res()}], w[{made.sz_w()} + 1];
  long long iw[{made.sz_iw()} + 1];
  (void)self;
  for (size_t i = 0; i < count; ++i) {{
{arguments}    {made.name()}(arg, res, iw, w, 0);
  }}
}}
"""
    sources = {f"{made.name()}.c": _text(made), "loops.c": text}
    return library(f"casadi-{made.name()}", sources)
