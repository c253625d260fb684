"""``Robot``: rows of DH parameters in, every symbolic quantity of its mechanics out."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Generic, Literal, TypeVar, overload

import sympy as sp

from moro.checks import values as checks
from moro.checks.meant import elsewhere
from moro.formats.dh.arm import Arm
from moro.formats.dh.description import Description
from moro.formats.hand_made import HandMade
from moro.formats.source import QUANTITIES, Source
from moro.mechanics import Mechanics
from moro.model import Model
from moro.printing.notebook import Page
from moro.printing.tables import Table

_T = TypeVar("_T")
_Self = TypeVar("_Self", bound="Robot")


class _Given(Generic[_T]):
    """What a robot's source holds; results that depend on it are dropped when it is set."""

    def __init__(self, of: Any, used: bool = True):
        self.__doc__ = of.__doc__
        self._used = used

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    @overload
    def __get__(self, robot: None, owner: type) -> _Given[_T]: ...
    @overload
    def __get__(self, robot: Robot, owner: type) -> _T: ...
    def __get__(self, robot: Robot | None, owner: type) -> Any:
        if robot is None:
            return self
        if self._name in QUANTITIES:
            return robot._source.given(self._name)
        if not hasattr(type(robot._source), self._name):
            raise AttributeError(
                f"{robot.name} has no {self._name}: that is of DH rows, and it is made of a Model"
            )
        return getattr(robot._source, self._name)

    def __set__(self, robot: Robot, value: Any) -> None:
        if getattr(getattr(Description, self._name), "fset", None) is None:
            raise AttributeError(f"{self._name} of a Robot cannot be set")
        if getattr(getattr(type(robot._source), self._name, None), "fset", None) is None:
            raise AttributeError(
                f"{self._name} of {robot.name} cannot be set: it is made of a Model; make another "
                "model, by dataclasses.replace say, and Robot.of(model)"
            )
        setattr(robot._source, self._name, value)
        robot._forget(results=self._used)


class Robot(Mechanics):
    """A robot arm given by rows of DH parameters, or any robot as a ``Model`` (``Robot.of``).

    A row is ``(a, alpha, d, theta)`` or ``(a, alpha, d, theta, "r" | "p")``: link length [m], link
    twist [rad], link offset [m], joint angle [rad]. The joint variable stands in ``theta`` of a
    revolute joint and in ``d`` of a prismatic one, possibly plus a constant, ``q1 + pi/2``, or in a
    sum with others, ``-q2 - q3``. Entries are numbers or SymPy expressions, in any mixture.
    ``convention`` is "dh" (standard or distal, T_i = Rz(theta) Tz(d) Tx(a) Rx(alpha)) or "mdh"
    (modified or proximal, Rx(alpha) Tx(a) Rz(theta) Tz(d), with a and alpha of the link before).

    Joints and links are counted from 1, frames from 0 (the base). A subscript i0 means: frame i
    expressed in frame 0. Results are exact SymPy objects in their shortest common form; a float
    counts as the decimal it prints as, and makes results print decimals.

    >>> from moro import Robot
    >>> from moro.abc import *
    >>> Robot((l1, 0, 0, q1), (l2, 0, 0, q2)).T[0, 3]
    l_1*cos(q_1(t)) + l_2*cos(q_1(t) + q_2(t))

    Raises ValueError, TypeError or IndexError that names the row or link, what was expected and
    what was found.
    """

    def __init__(
        self,
        *rows: Any,
        convention: Literal["dh", "mdh"] = "dh",
        name: str = "robot",
        **others: Any,
    ):
        super().__init__(Description(*rows, convention=convention, name=name, **others))

    @classmethod
    def load(
        cls: type[_Self],
        source: str | os.PathLike[str],
        *,
        root: str | None = None,
        tip: str | Sequence[str] | None = None,
        fix: Mapping[str, Any] | None = None,
        as_written: bool = False,
    ) -> _Self:
        """Return the robot that a file describes.

        ``source`` is the path of a robot.yaml, a URDF or an MJCF (of MuJoCo, which has to be
        installed), or the name of a packaged arm. Where it could be both, it is the packaged arm;
        ``./puma560`` is always a path.

        ``root`` and ``tip`` name the links between which the robot is meant (several tips: all ways
        to them; what is fixed on the way belongs to it), ``fix`` the joints that stand still,
        {name: position [rad or m]}; rows of DH parameters have no names. In a URDF or an MJCF,
        decimals that are a multiple of pi/4 or pi/6 to the last digit, 1.5708, are that angle,
        unless ``as_written``; ``model_summary`` lists them.

        Raises ``moro.io.RobotFileError``, a ValueError, that lists all that is wrong with the file,
        with lines and fields. Warns (RobotFileWarning) of what is legal but probably not meant.
        """
        from moro.formats.loading import description  # which asks for more than SymPy

        return cls.of(description(source, root=root, tip=tip, fix=fix, as_written=as_written))

    @classmethod
    def of(cls: type[_Self], described: Mapping[str, Any] | Model | Source) -> _Self:
        """Return the robot that is described as in a robot.yaml, or is a ``Model``, a tree say.

        A dictionary has the fields of the file, in numbers, expressions of SymPy, or texts as
        there: ``{"links": [{"joint": "revolute", "xyz": [0, 0, l1], "axis": "y"}, ..]}``. Of a
        bare chain of rows everything can be set as of ``Robot(row, ..)``; else it has no rows, and
        its masses and all else are set where it is described. Frame i is that of joint i; others
        are known by their names, ``robot.T_i0("hand")``. Raises ``moro.io.RobotFileError``, a
        ValueError, that lists all that is wrong with the fields.
        """
        if isinstance(described, Mapping):
            from moro.formats.loading import given  # which asks for more than SymPy

            described = given(described)
        robot = cls.__new__(cls)
        source = described if isinstance(described, Source) else HandMade(described)
        Mechanics.__init__(robot, source)
        return robot

    # -- what is given ----------------------------------------------------------------------------

    name = _Given[str](Description.name, used=False)
    convention = _Given[str](Description.convention)
    dh_parameters = _Given[list[tuple[Any, ...]]](Description.dh_parameters)
    dh_table = _Given[Table](Description.dh_table)
    arm = _Given[Arm](Description.arm)
    joint_limits = _Given[list[tuple[Any, Any]]](Description.joint_limits)
    masses = _Given[list[Any] | None](Description.masses)
    cm_positions = _Given[list[sp.Matrix] | None](Description.cm_positions)
    inertia_tensors = _Given[list[sp.Matrix] | None](Description.inertia_tensors)
    gravity = _Given[sp.Matrix | None](Description.gravity)
    rotor_inertias = _Given[list[Any] | None](Description.rotor_inertias)
    rotors = _Given[list[tuple[Any, Any] | None] | None](Description.rotors)
    viscous_friction = _Given[list[Any] | None](Description.viscous_friction)
    coulomb_friction = _Given[list[tuple[Any, Any]] | None](Description.coulomb_friction)
    parameters = _Given[dict[Any, Any]](Description.parameters, used=False)

    def declare(self, defaults: Mapping[Any, Any]) -> None:
        """Add parameters, with their defaults, that the model need not hold.

        Functions of one's own may use them; kernels that do not, do not ask for them. Those that a
        robot.yaml declares are among them.
        """
        self._source.declare(defaults)
        self._forget()

    def with_parameters(self: _Self, values: Mapping[Any, Any]) -> _Self:
        """Return a new robot in which symbols have been given values.

        ``values`` maps symbols, or their names, to numbers or expressions. ValueError for a symbol
        that the model does not hold.
        """
        return self.of(self._source.with_parameters(values))

    def model_summary(self) -> Table:
        """Return what is given, what was assumed by default, and what is not set."""
        return self._source.summary()

    def model(self) -> Model:
        """Return the robot as all algorithms read it (``moro.model``)."""
        return self._model

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the robot as a robot.yaml, from which ``load`` makes the same one.

        A file that is there is replaced. Symbols become parameters, under names that a file can
        hold. Raises ValueError for what no robot.yaml can say; nothing is written then.
        """
        from moro.formats.saving import save  # which asks for more than SymPy

        save(self._source, path)

    def report(
        self, kind: Literal["tex", "html"], path: str | os.PathLike[str] | None = None
    ) -> str:
        """Return the derivation of the arm's equations, for LaTeX or a browser.

        Rows, frames, Jacobians, energies, M, C, G and the equations of motion, in the notation of
        the texts, long sub-expressions named, no line wider than the page. ``path``: written there
        too. The LaTeX needs amsmath and geometry, the HTML nothing else; Jupyter shows it.
        """
        from moro.report import report  # which asks for Jinja

        page = report(self, self._source, self._collector, kind)
        if path is not None:
            Path(path).write_text(page, encoding="utf-8")
        return Page(page) if kind == "html" else page

    def __setattr__(self, name: str, value: Any) -> None:
        if not name.startswith("_") and not hasattr(type(self), name):
            there = (x for x in dir(type(self)) if not x.startswith("_"))
            advice = elsewhere(name)
            near = f"; {advice}" if advice else checks.suggestion(name, there)
            raise AttributeError(f"a Robot has no {name}{near}")
        super().__setattr__(name, value)

    def __repr__(self) -> str:
        kinds = "".join(self.joint_types).upper()
        given = f"convention {self.convention}" if self.convention else "made of a Model"
        return f"<Robot {self.name}: {self.dof} joints {kinds}, {given}>"

    def _repr_latex_(self) -> str:
        return self._source.table._repr_latex_()

    def _repr_html_(self) -> str:
        return self._source.table._repr_html_()
