"""Pinocchio's numbers of packaged robots that are no plain arms.

`python -m benchmarks.packaged_reference` writes a .json for each in tests/reference. The files are
read here, by a plain YAML reader, and the rows and placements are put together by Pinocchio's
transforms; nothing of moro is used.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import sympy as sp
import yaml

ROOT = Path(__file__).parents[1]
NAMES = ("cobra600", "palletizer")
STATES = 6
AXES = {"x": pin.JointModelRX, "y": pin.JointModelRY, "z": pin.JointModelRZ}


class Peer:
    """A robot file as a model of Pinocchio, whose joints move by A q + b."""

    def __init__(self, data: dict[str, Any]):
        self.defaults = data.get("parameters", {})
        self.model = pin.Model()
        self.model.gravity.linear = np.array([self.value(x) for x in data["gravity"]])
        moves, at = [], {None: (0, pin.SE3.Identity())}
        last = None
        for i, link in enumerate(data["links"]):
            joint, placed = at[link.get("parent", last)]
            before, after = self.around(link, data.get("convention", "dh"))
            here = placed * before
            if link["joint"] != "fixed":
                kind, entry = self.kind(link)
                joint = self.model.addJoint(joint, kind(), here, f"joint{i}")
                moves.append(str(link.get(entry, 0)))
                here = pin.SE3.Identity()
            here = here * after
            for body in (link, *link.get("bodies", ())):
                self.model.appendBodyToJoint(joint, self.body(body), here)
            last = link.get("name", f"link{i}")
            at[last] = (joint, here)
            self.end = (joint, here * self.around(data.get("tool", {}), "dh")[0])
        self.data = self.model.createData()
        self.A, self.b = self.coordinates(moves)

    def value(self, x: Any) -> float:
        """Return an expression of the file as a number."""
        return float(sp.sympify(x).subs(self.defaults))

    def kind(self, link: dict[str, Any]) -> tuple[Any, str]:
        """Return the joint's model, and the entry that says how far it moves."""
        if link["joint"] == "prismatic":
            return pin.JointModelPZ, "d"
        return AXES[link.get("axis", "z")], "theta"

    def around(self, link: dict[str, Any], convention: str) -> tuple[pin.SE3, pin.SE3]:
        """Return what comes before the motion of a link, and after it; a placement is before."""
        if "a" not in link:
            shift = np.array([self.value(x) for x in link.get("xyz", (0, 0, 0))])
            return pin.SE3(np.eye(3), shift), pin.SE3.Identity()
        moved = self.kind(link)[1]
        own = {name: 0.0 if name == moved else self.value(link[name]) for name in ("d", "theta")}
        turn = pin.SE3(pin.utils.rotate("z", own["theta"]), np.zeros(3))
        lift = pin.SE3(np.eye(3), np.array([0, 0, own["d"]]))
        shift = pin.SE3(np.eye(3), np.array([self.value(link["a"]), 0, 0]))
        twist = shift * pin.SE3(pin.utils.rotate("x", self.value(link["alpha"])), np.zeros(3))
        if convention == "mdh":
            return twist * (turn if moved == "d" else lift), pin.SE3.Identity()
        return (turn, twist) if moved == "d" else (lift, twist)

    def body(self, link: dict[str, Any]) -> pin.Inertia:
        """Return the body of a link, in its frame."""
        if "mass" not in link:
            return pin.Inertia.Zero()
        given = link["inertia"]
        if isinstance(given, list):
            given = dict(zip(("xx", "yy", "zz"), given, strict=True))
        I = {name: self.value(given.get(name, 0)) for name in ("xx", "yy", "zz", "xy", "xz", "yz")}
        tensor = [
            [I["xx"], I["xy"], I["xz"]], [I["xy"], I["yy"], I["yz"]], [I["xz"], I["yz"], I["zz"]]
        ]  # fmt: skip
        com = np.array([self.value(x) for x in link["com"]])
        return pin.Inertia(self.value(link["mass"]), com, np.array(tensor))

    def coordinates(self, moves: list[str]) -> tuple[Any, Any]:
        """Return A and b of the entries that say how far joints move."""
        found, highest = [], 0
        for text in moves:
            entry = sp.sympify(text).subs(self.defaults)
            held = [int(s.name[1:]) for s in entry.free_symbols]
            if not held:
                held, entry = [highest + 1], entry + sp.Symbol(f"q{highest + 1}")
            highest = max(highest, *held)
            found.append(entry)
        q = sp.symbols(f"q1:{highest + 1}")
        x = sp.Matrix(found)
        A = np.array(x.jacobian(q), dtype=float)
        return A, np.array(x.subs(dict.fromkeys(q, 0)), dtype=float).ravel()

    def state(self, rng: np.random.Generator) -> dict[str, Any]:
        """Return a random state, and what Pinocchio says of it."""
        q, qd, qdd = rng.uniform(-1, 1, (3, self.A.shape[1]))
        x, A = self.A @ q + self.b, self.A
        tau = pin.rnea(self.model, self.data, x, A @ qd, A @ qdd)
        M = pin.crba(self.model, self.data, x)
        G = pin.computeGeneralizedGravity(self.model, self.data, x)
        pin.forwardKinematics(self.model, self.data, x)
        joint, here = self.end
        T = self.data.oMi[joint] * here
        return {
            "q": q.tolist(), "qd": qd.tolist(), "qdd": qdd.tolist(), "tau": (A.T @ tau).tolist(),
            "M": (A.T @ np.triu(M) @ A + A.T @ np.triu(M, 1).T @ A).tolist(),
            "G": (A.T @ G).tolist(), "T": T.homogeneous.tolist(),
        }  # fmt: skip


def main() -> None:
    """Write the numbers of all of them."""
    for name in NAMES:
        data = yaml.safe_load((ROOT / "moro" / "robots" / f"{name}.yaml").read_text())
        rng = np.random.default_rng(0)
        peer = Peer(data)
        numbers = {
            "robot": name,
            "made_with": f"Pinocchio {pin.__version__}, by benchmarks/packaged_reference.py",
            "units": "SI",
            "states": [peer.state(rng) for _ in range(STATES)],
        }
        path = ROOT / "tests" / "reference" / f"{name}.json"
        path.write_text(json.dumps(numbers, indent=1) + "\n")


if __name__ == "__main__":
    main()
