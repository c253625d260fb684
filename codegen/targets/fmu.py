"""FMU: Functional Mock-up Units (FMI 3.0 and 2.0), an arm that other programs simulate.

The unit's states are q and qd, its inputs the torques (forces) tau, its parameters those of the
kernel: dqd/dt is ``forward_dynamics``, compiled from the kernel's own C. It serves model exchange,
where the importer integrates, and co-simulation, with steps of Runge and Kutta's fourth order of at
most ``max_step``. Sources are in it, beside the library for the machine at hand.
"""

from __future__ import annotations

import hashlib
import io
import platform
import sys
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from xml.etree import ElementTree as ET

import sympy as sp

import moro
from moro.model import Drive, Model, Parameter
from moro_codegen.backends import c_text, toolchain
from moro_codegen.emit.render import render
from moro_codegen.program import Program, generate
from moro_codegen.progress import tell
from moro_codegen.signature import RuntimeParameter
from moro_codegen.targets import Export, Target
from moro_codegen.targets.python import made

VERSIONS = ("3.0", "2.0")
#: of steps of a co-simulation [s], by default
MAX_STEP = 1e-3
#: at which rates dry friction has its size, nearly [rad/s or m/s], by default
FRICTION_WIDTH = sp.Rational(1, 100)
#: entries of a zip file have a time; the same for the same unit
TIME = (1980, 1, 1, 0, 0, 0)
FLAGS = ("-O2", "-std=c99", "-fPIC", "-shared", "-fvisibility=hidden")


class FMU(Target):
    """The units of both versions of FMI, and words."""

    name = "fmu"
    reserved = c_text.RESERVED

    def files(self, export: Export) -> dict[str, str | bytes]:
        """Return the units: ROBOT.fmu of FMI 3.0, ROBOT_fmi2.fmu of FMI 2.0.

        They have ``forward_dynamics``, whichever functions are asked for. Raises ValueError for a
        robot without, or a parameter without a default; ToolchainError where there is no compiler.
        """
        model = replace(_smooth(export.model), name=export.name)
        program = generate(model, ("forward_dynamics",))
        units = [_Unit(model, program, version) for version in VERSIONS]
        texts = {unit.path: _zipped(unit.files()) for unit in units}
        variables = [*units[0].variables()]
        readme = render(
            "export_fmu_readme.md.jinja", name=export.name, made=made(export), variables=variables
        )
        return {**texts, "README.md": readme}


def _smooth(model: Model) -> Model:
    """Return a model whose dry friction is tanh(qd / friction_width), a parameter, at rest.

    Where friction jumps, integrators take tiny steps without end.
    """
    width = sp.Symbol("friction_width")

    def smooth(drive: Drive) -> Drive:
        jumps = drive.width is None and (drive.coulomb != (0, 0) or drive.static is not None)
        return replace(drive, width=width) if jumps else drive

    coordinates = tuple(replace(x, drive=smooth(x.drive)) for x in model.coordinates)
    if coordinates == model.coordinates:
        return model
    meaning = "rate at which dry friction has 76 % of its size, in rad/s or m/s"
    parameters = (*model.parameters, Parameter(width, FRICTION_WIDTH, meaning))
    return replace(model, coordinates=coordinates, parameters=parameters)


@dataclass(frozen=True)
class _Unit:
    model: Model
    program: Program
    version: str

    @property
    def path(self) -> str:
        return f"{self.name}.fmu" if self.version == "3.0" else f"{self.name}_fmi2.fmu"

    @property
    def name(self) -> str:
        return self.program.name

    def files(self) -> dict[str, bytes]:
        """Return the contents of the unit, by path in it."""
        texts = {
            "modelDescription.xml": self.description(),
            **{f"sources/{path}": text for path, text in self.sources.items()},
        }
        if self.version == "3.0":
            texts["sources/buildDescription.xml"] = self._build_description()
        return {
            **{path: text.encode() for path, text in texts.items()},
            self._library_path(): self._library(),
        }

    @cached_property
    def kernel(self) -> dict[str, str]:
        """Source and header of the kernel."""
        return c_text.emit(self.program)

    @cached_property
    def sources(self) -> dict[str, str]:
        """The C files: the kernel, and the interface."""
        return {**self.kernel, "fmu.c": self._interface()}

    @property
    def compiled(self) -> list[str]:
        """The files that are compiled."""
        return [path for path in self.sources if path.endswith(".c")]

    @cached_property
    def token(self) -> str:
        """What the description and the library know each other by."""
        said = f"{moro.__version__} {self.version} {self.kernel}"
        digest = hashlib.sha256(said.encode()).hexdigest()
        parts = digest[:8], digest[8:12], digest[12:16], digest[16:20], digest[20:32]
        return f"{{{'-'.join(parts)}}}"

    def _interface(self) -> str:
        three = self.version == "3.0"
        return render(
            "fmi3.c.jinja" if three else "fmi2.c.jinja",
            title=f"{self.name}: forward dynamics of a robot arm with {self.program.dof} joints",
            name=self.name,
            n=self.program.dof,
            parameters=[{"start": repr(_start(x))} for x in self.program.parameters],
            token=self.token,
            max_step=repr(float(MAX_STEP)),
            modes=MODES_3 if three else MODES_2,
            others=OTHERS_3 if three else OTHERS_2,
            clocks=CLOCKS,
            statuses=STATUSES,
        )

    def _library_path(self) -> str:
        bits = 64 if sys.maxsize > 2**32 else 32
        machine = {"x86_64": "x86_64", "AMD64": "x86_64", "arm64": "aarch64"}.get(
            platform.machine(), platform.machine()
        )
        system, suffix = ("darwin", ".dylib") if sys.platform == "darwin" else ("linux", ".so")
        folder = f"{machine}-{system}" if self.version == "3.0" else f"{system}{bits}"
        return f"binaries/{folder}/{self.name}{suffix}"

    def _library(self) -> bytes:
        """Return the compiled unit. Raise ToolchainError if it does not compile."""
        tell("compiling the FMU")
        compiler = toolchain.find_compiler("native")
        with TemporaryDirectory() as folder:
            for path, text in self.sources.items():
                (Path(folder) / path).write_text(text, encoding="utf-8")
            command = [*compiler.command, *FLAGS, *self.compiled, "-lm", "-o", "unit"]
            done = toolchain.run(command, Path(folder))
            if done.returncode != 0:
                raise toolchain.ToolchainError(
                    f"the FMU of {self.name} does not compile:\n{toolchain.words(done)}"
                )
            return (Path(folder) / "unit").read_bytes()

    # -- modelDescription.xml ---------------------------------------------------------------------

    def description(self) -> str:
        """Return the description of the unit's variables."""
        root = self._root()
        variables = list(self.variables())
        if self.version == "3.0":
            _described_3(root, variables, self.program.dof)
        else:
            _described_2(root, variables, self.program.dof)
        ET.indent(root)
        text = ET.tostring(root, encoding="unicode")
        return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'

    def _root(self) -> ET.Element:
        three = self.version == "3.0"
        root = ET.Element(
            "fmiModelDescription",
            {
                "fmiVersion": self.version,
                "modelName": self.name,
                "instantiationToken" if three else "guid": self.token,
                "description": "Forward dynamics of a robot: torques in, positions and velocities "
                "out. SI units.",
                "generationTool": f"moro {moro.__version__}",
                "variableNamingConvention": "structured",
            },
        )
        able = {"modelIdentifier": self.name}
        state = "canGetAndSetFMUState" if three else "canGetAndSetFMUstate"
        serial = "canSerializeFMUState" if three else "canSerializeFMUstate"
        able |= {state: "true", serial: "true"}
        stepping = {**able, "canHandleVariableCommunicationStepSize": "true"}
        exchange = ET.SubElement(root, "ModelExchange", able)
        simulation = ET.SubElement(root, "CoSimulation", stepping)
        if not three:
            for kind in (exchange, simulation):
                files = ET.SubElement(kind, "SourceFiles")
                for path in self.compiled:
                    ET.SubElement(files, "File", {"name": path})
        units = ET.SubElement(root, "UnitDefinitions")
        for name, base in UNITS.items():
            ET.SubElement(ET.SubElement(units, "Unit", {"name": name}), "BaseUnit", base)
        return root

    def variables(self) -> Iterator[_Variable]:
        n, kinds = self.program.dof, self.model.types
        names = [x.name for x in self.model.coordinates]

        def block(
            letter: str, first: int, units: tuple[str, str], what: str, **attributes: str
        ) -> Iterator[_Variable]:
            for j, (kind, name) in enumerate(zip(kinds, names, strict=True)):
                of = f"{what} of joint {name or j + 1}"
                unit = units[0] if kind.is_angle else units[1]
                more = {k: v.format(first + j - n) for k, v in attributes.items()}
                yield _Variable(f"{letter}[{j + 1}]", first + j, of, unit, more)

        yield _Variable("time", 0, "time", "s", {"causality": "independent"})
        out = {"causality": "output", "initial": "exact", "start": "0"}
        yield from block("q", 1, ("rad", "m"), "position", **out)
        yield from block("qd", 1 + n, ("rad/s", "m/s"), "velocity", **out, derivative="{}")
        yield from block(
            "qdd", 1 + 2 * n, ("rad/s2", "m/s2"), "acceleration", causality="local",
            initial="calculated", derivative="{}",
        )  # fmt: skip
        yield from block(
            "tau", 1 + 3 * n, ("N.m", "N"), "torque or force", causality="input", start="0"
        )
        given = {"causality": "parameter", "variability": "tunable", "initial": "exact"}
        for k, x in enumerate(self.program.parameters):
            start = {"start": repr(_start(x))}
            yield _Variable(
                x.name, 1 + 4 * n + k, x.description or "parameter", "", {**given, **start}
            )
        step = {**given, "start": repr(float(MAX_STEP))}
        place = 1 + 4 * n + len(self.program.parameters)
        what = "longest step of a co-simulation"
        yield _Variable("max_step", place, what, "s", step)

    def _build_description(self) -> str:
        root = ET.Element("fmiBuildDescription", {"fmiVersion": "3.0"})
        build = ET.SubElement(root, "BuildConfiguration", {"modelIdentifier": self.name})
        files = ET.SubElement(build, "SourceFileSet", {"language": "C99"})
        for path in self.compiled:
            ET.SubElement(files, "SourceFile", {"name": path})
        ET.indent(root)
        text = ET.tostring(root, encoding="unicode")
        return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'


@dataclass(frozen=True)
class _Variable:
    name: str
    reference: int
    description: str
    unit: str
    attributes: Mapping[str, str]

    def element(self, tag: str, **more: str) -> ET.Element:
        given = {"name": self.name, "valueReference": str(self.reference)}
        said = {"description": self.description} | ({"unit": self.unit} if self.unit else {})
        return ET.Element(tag, {**given, **said, **more})


def _described_3(root: ET.Element, variables: list[_Variable], n: int) -> None:
    there = ET.SubElement(root, "ModelVariables")
    for x in variables:
        varies = {"variability": "continuous"} if x.attributes["causality"] != "parameter" else {}
        there.append(x.element("Float64", **{**varies, **x.attributes}))
    structure = ET.SubElement(root, "ModelStructure")
    for k in range(1, 1 + 2 * n):
        ET.SubElement(structure, "Output", {"valueReference": str(k)})
    for k in range(1 + n, 1 + 3 * n):
        ET.SubElement(structure, "ContinuousStateDerivative", {"valueReference": str(k)})
    for k in range(1 + 2 * n, 1 + 3 * n):
        ET.SubElement(structure, "InitialUnknown", {"valueReference": str(k)})


def _described_2(root: ET.Element, variables: list[_Variable], n: int) -> None:
    there = ET.SubElement(root, "ModelVariables")
    for x in variables:
        given = dict(x.attributes)
        derivative = given.pop("derivative", None)
        start = given.pop("start", None)
        varies = {"variability": given.pop("variability", "continuous")}
        scalar = x.element("ScalarVariable", **varies, **given)
        unit = scalar.attrib.pop("unit", None)
        real = ET.SubElement(scalar, "Real")
        for key, value in (("unit", unit), ("start", start)):
            if value is not None:
                real.set(key, value)
        if derivative is not None:
            real.set("derivative", str(int(derivative) + 1))
        there.append(scalar)
    structure = ET.SubElement(root, "ModelStructure")
    for tag, places in (
        ("Outputs", range(1, 1 + 2 * n)),
        ("Derivatives", range(1 + n, 1 + 3 * n)),
        ("InitialUnknowns", range(1 + 2 * n, 1 + 3 * n)),
    ):
        listed = ET.SubElement(structure, tag)
        for k in places:  # places among the variables, from 1, and not references
            ET.SubElement(listed, "Unknown", {"index": str(k + 1)})


def _start(parameter: RuntimeParameter) -> float:
    if parameter.default is None:
        raise ValueError(
            f"parameter {parameter.name} has no default, and an FMU starts with one: give it, by "
            "robot.parameters or in the file"
        )
    return float(parameter.default)


def _zipped(files: Mapping[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, content in files.items():
            entry = zipfile.ZipInfo(path, TIME)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, content)
    return buffer.getvalue()


UNITS = {
    "s": {"s": "1"},
    "rad": {"rad": "1"},
    "rad/s": {"rad": "1", "s": "-1"},
    "rad/s2": {"rad": "1", "s": "-2"},
    "m": {"m": "1"},
    "m/s": {"m": "1", "s": "-1"},
    "m/s2": {"m": "1", "s": "-2"},
    "N": {"kg": "1", "m": "1", "s": "-2"},
    "N.m": {"kg": "1", "m": "2", "s": "-2"},
}

#: functions that say in which mode an instance is, which changes nothing here
MODES_3 = (
    "ExitInitializationMode", "EnterEventMode", "Terminate", "EnterConfigurationMode",
    "ExitConfigurationMode", "EvaluateDiscreteStates", "EnterContinuousTimeMode", "EnterStepMode",
)  # fmt: skip
MODES_2 = (
    "EnterInitializationMode", "ExitInitializationMode", "EnterEventMode", "Terminate",
    "EnterContinuousTimeMode",
)  # fmt: skip
#: types that the unit has no variables of, and what they are in C
OTHERS_3 = (
    ("Float32", "float"), ("Int8", "int8_t"), ("UInt8", "uint8_t"), ("Int16", "int16_t"),
    ("UInt16", "uint16_t"), ("Int32", "int32_t"), ("UInt32", "uint32_t"), ("Int64", "int64_t"),
    ("UInt64", "uint64_t"), ("Boolean", "bool"), ("String", "const char *"),
)  # fmt: skip
OTHERS_2 = (("Integer", "int"), ("Boolean", "int"), ("String", "const char *"))
STATUSES = (("Integer", "int "), ("Boolean", "int "), ("String", "const char *"))
#: functions of clocks, of which there are none
_FRACTION = (("uint64_t", "counters"), ("uint64_t", "resolutions"))
_SET_FRACTION = tuple((f"const {of}", name) for of, name in _FRACTION)
CLOCKS = (
    ("GetIntervalDecimal", (("double", "intervals"), ("int", "qualifiers"))),
    ("GetIntervalFraction", (*_FRACTION, ("int", "qualifiers"))),
    ("GetShiftDecimal", (("double", "shifts"),)),
    ("GetShiftFraction", _FRACTION),
    ("SetIntervalDecimal", (("const double", "intervals"),)),
    ("SetIntervalFraction", _SET_FRACTION),
    ("SetShiftDecimal", (("const double", "shifts"),)),
    ("SetShiftFraction", _SET_FRACTION),
)

TARGET = FMU()
