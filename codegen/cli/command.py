"""``moro-codegen robot.yaml``: from the description of a robot to a verified, compiled kernel."""

from __future__ import annotations

import sys
import textwrap
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import click

from moro.checks.meant import hint
from moro.formats.loading import packaged
from moro_codegen import FUNCTIONS, registry
from moro_codegen.backends.toolchain import ToolchainError
from moro_codegen.cli.robot_file import read, save
from moro_codegen.functions.function import Function
from moro_codegen.installation import versions

#: what a person can cause: bad input, no compiler, a folder that cannot be written
EXPECTED = (ValueError, TypeError, OSError, ToolchainError)
#: columns of --help
WIDTH = 78
#: what NumPy calls the scalar types
NUMPY_NAMES = {"float64": "double", "float32": "float"}


def _epilog() -> str:
    functions = [
        line
        for function in FUNCTIONS.values()
        for line in (f"  {_called(function)}", *_indented(function.summary))
    ]
    return "\n\n".join(
        [
            "\b\n" + "\n".join(["Functions:", *functions]),
            f"Packaged arms: {', '.join(packaged())}.",
            "Exit code: 0 if the kernel verified, 1 if it did not, 2 if something given was wrong, "
            "130 if it was interrupted.",
        ]
    )


def _called(function: Function) -> str:
    """Return how a function is asked for: jacobian[@FRAME]."""
    return function.name + "[@FRAME]" * (function.frame is not None)


def _indented(text: str) -> list[str]:
    return textwrap.wrap(text, WIDTH, initial_indent=" " * 6, subsequent_indent=" " * 6)


class _Names(click.ParamType):  # type: ignore[type-arg]
    """Names with commas between them, of those there are.

    ``joined``: of functions, where ``+`` joins what is done together and ``@`` names a frame.
    """

    name = "names"

    def __init__(self, there: Iterable[str], joined: bool = False) -> None:
        self.there = tuple(there)
        self.joined = joined

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[Any, ...]:
        if not isinstance(value, str):
            return tuple(value)
        items = [item.strip() for item in value.split(",") if item.strip()]
        names = [item.split("+") if self.joined else [item] for item in items]
        for name in (name for group in names for name in group):
            name = name.partition("@")[0] if self.joined else name
            if name not in self.there:
                known = ", ".join(self.there)
                self.fail(f"no {name!r}; {hint(name, self.there)}there are {known}.", param, ctx)
        if not names:
            self.fail(f"none given; there are {', '.join(self.there)}.", param, ctx)
        return tuple(tuple(group) if len(group) > 1 else group[0] for group in names)


def _print_versions(context: click.Context, _: click.Parameter, asked: bool) -> None:
    if asked:
        click.echo(versions())
        context.exit()


class _Scalar(click.Choice):  # type: ignore[type-arg]
    """double or float; the names of NumPy's types are read too."""

    def __init__(self) -> None:
        super().__init__(["double", "float"])

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        return super().convert(NUMPY_NAMES.get(str(value), value), param, ctx)


class _Fixed(click.ParamType):  # type: ignore[type-arg]
    """A joint that stands still, and where: ``wrist=0.5``, ``wrist=-pi/2``."""

    name = "joint=value"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[str, Any]:
        joint, is_there, text = str(value).rpartition("=")
        if not is_there or not joint:
            self.fail(f"{value!r} is no joint=value, wrist=0.5 say.", param, ctx)
        from moro.formats.yaml.expressions import ExpressionError, parse

        try:
            return joint, parse(text)
        except ExpressionError as error:
            self.fail(f"{value!r}: {error}", param, ctx)


@click.command(
    epilog=_epilog(),
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": WIDTH + 2},
)
@click.argument("robot")
@click.option(
    "-f",
    "--functions",
    type=_Names(FUNCTIONS, joined=True),
    default="tau",
    show_default=True,
    help="What to generate, as listed below, with commas in between; a+b are two in one call, "
    "jacobian@camera is of the frame called camera.",
)
@click.option(
    "--root",
    help="The link that stands still, at the base; of a URDF, say, whose links have names.",
)
@click.option(
    "--tip",
    multiple=True,
    help="The link at which the robot ends; may be given several times.",
)
@click.option(
    "--fix",
    type=_Fixed(),
    multiple=True,
    help="A joint that stands still, and where [rad or m]; may be given several times.",
)
@click.option(
    "--as-written",
    is_flag=True,
    help="Of a URDF or an MJCF: 1.5708 is that decimal, and not pi/2.",
)
@click.option(
    "--save",
    "saved",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write the robot to this robot.yaml, and leave without making a kernel.",
)
@click.option(
    "-o",
    "--output",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("build"),
    show_default=True,
    help="Folder in which the kernel gets a folder of its own, named like the robot.",
)
@click.option(
    "--backend",
    type=click.Choice(registry.BACKENDS.names()),
    default="c",
    show_default=True,
    help="Compiled C, a Cython extension, or a Python module with NumPy, which needs no compiler.",
)
@click.option(
    "--scalar",
    type=_Scalar(),
    default="double",
    show_default=True,
    help="What the kernel computes with; float is single precision, not with cython.",
)
@click.option(
    "--export",
    "folder",
    type=click.Path(file_okay=False, path_type=Path),
    help="Folder to write sources to, besides, that are built and used without moro: one in it "
    "for each target.",
)
@click.option(
    "--target",
    "targets",
    type=_Names(registry.TARGETS.names()),
    default="c",
    show_default=True,
    help=f"What to export, with commas in between: {', '.join(registry.TARGETS.names())}.",
)
@click.option("--batch", is_flag=True, help="Of exports in C: functions for many states, too.")
@click.option(
    "--prefix",
    help="Of exports: how files and functions begin, in place of the robot's name.",
)
@click.option(
    "--arch",
    default="native",
    show_default=True,
    help="Oldest processor to compile for, as -march calls it: x86-64-v3.",
)
@click.option(
    "--clear-cache",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=lambda context, _, given: _clear_cache(context) if given else None,
    help="Remove the kernels that moro_codegen.compile keeps, and exit.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON document, not the table.")
@click.option("--no-benchmark", is_flag=True, help="Leave out the times per call.")
@click.option(
    "--version",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_print_versions,
    help="Print the versions that a report of a fault should name, and leave.",
)
def main(
    robot: str,
    functions: tuple[Any, ...],
    root: str | None,
    tip: tuple[str, ...],
    fix: tuple[tuple[str, Any], ...],
    as_written: bool,
    saved: Path | None,
    output: Path,
    backend: str,
    scalar: str,
    folder: Path | None,
    targets: tuple[str, ...],
    batch: bool,
    prefix: str | None,
    arch: str,
    as_json: bool,
    no_benchmark: bool,
) -> None:
    """Make a compiled kernel of a robot's dynamics, and prove it.

    ROBOT is a robot.yaml, a URDF or an MJCF, or the name of a packaged arm. The equations of
    motion are derived symbolically; a kernel, by default tau(q, qd, qdd), is generated on an
    independent route, compiled, compared with the equations at random and awkward states, and
    timed.
    BUILD/NAME/ gets the C source, its header, the shared library and a manifest.
    """
    try:
        if folder is None and (batch or prefix or _is_given("targets")):
            raise ValueError("--target, --batch and --prefix are of an export: add --export DIR")
        part = {"root": root, "tip": tip, "fix": dict(fix), "as_written": as_written}
        if saved is not None:
            save(robot, part, saved)
            click.echo(f"{saved}: written")
            sys.exit(0)
        arm, source = read(robot, part)
        # what follows needs SymPy and NumPy; a file that is refused does not
        from moro_codegen.cli.job import Exports, Order, run
        from moro_codegen.cli.json_document import document
        from moro_codegen.cli.table import show

        export = None if folder is None else Exports(folder, targets, batch, prefix, robot)
        order = Order(functions, output, backend, scalar, export, arch, not no_benchmark)
        outcome = run(arm, order, source)
        if as_json:
            click.echo(document(outcome))
        else:
            show(outcome)
    except KeyboardInterrupt:  # as shells say it, 128 + SIGINT: 1 is "not verified"
        click.echo("moro-codegen: interrupted", err=True)
        sys.exit(130)
    except EXPECTED as error:
        click.echo(f"moro-codegen: error: {_message(error)}", err=True)
        sys.exit(2)
    sys.exit(0 if outcome.verification.passed else 1)


def _is_given(name: str) -> bool:
    source = click.get_current_context().get_parameter_source(name)
    return source is click.core.ParameterSource.COMMANDLINE


def _clear_cache(context: click.Context) -> None:
    """Remove the user's kernels but those that are being built."""
    from moro_codegen.kernel import store

    try:
        folder = store.cache()
        count, freed = store.clear(folder)
    except OSError as error:
        click.echo(f"moro-codegen: error: {_message(error)}", err=True)
        context.exit(2)
    click.echo(f"{folder}: {count} kernels removed, {freed / 1e6:.1f} MB")
    context.exit()


def _message(error: Exception) -> str:
    if isinstance(error, OSError) and error.filename:
        return f"{error.filename}: {error.strerror}"
    return str(error).replace('backend="numpy"', "--backend numpy")  # as it is said here
