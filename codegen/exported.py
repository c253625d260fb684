"""Exports: a robot's functions as folders of sources, to be built and used without moro.

A folder of an export carries ``moro.json``, which lists its files with their checksums. It is what
tells a folder that may be replaced from one that holds something else.
"""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import moro
from moro.model import Model, as_model
from moro.robot import Robot
from moro_codegen import targets as known
from moro_codegen.functions.own import UserFunction
from moro_codegen.functions.regressors import Regressor
from moro_codegen.functions.requested import Request
from moro_codegen.pipeline import check_names, digest
from moro_codegen.program import generate
from moro_codegen.progress import shown, tell
from moro_codegen.proof.golden import Golden, golden_states, largest_errors
from moro_codegen.proof.symbolic_route import SymbolicRoute
from moro_codegen.targets import Export

#: lists the files of an export
LIST = "moro.json"


@shown()
def export(
    robot: Robot | Model,
    directory: str | os.PathLike[str],
    targets: Sequence[str] = ("c",),
    functions: Sequence[Request] = ("tau",),
    dtype: Any = "float64",
    *,
    batch: bool = False,
    prefix: str | None = None,
) -> tuple[Path, ...]:
    """Write a robot's functions as sources that need no moro, and return a folder for each target.

        mc.export(robot, "out", targets=("c", "python"), functions=("tau", "inertia_matrix"))

    makes out/c and out/python. Each says how it is built, and carries a test of its own: golden
    states from the route that each function was not made by. ``functions`` and
    ``dtype`` are those of ``compile``. ``batch`` adds functions for many states in C. ``prefix``
    begins the names of files and of C functions: by default that of the robot, with an f behind it
    in single precision, as in the C library.

    The same robot and arguments give the same bytes. Nothing is written unless everything can be;
    an earlier export in the same place is replaced. Raises ValueError for a target or function that
    does not exist, for names that cannot be used, and for golden states that the functions do not
    reproduce; FileExistsError for a folder that holds anything else, or an export that was edited.
    """
    return written(robot, Path(directory), targets, functions, dtype, batch=batch, prefix=prefix)


def written(
    robot: Robot | Model,
    directory: Path,
    targets: Sequence[str],
    functions: Sequence[Request],
    dtype: Any,
    *,
    batch: bool,
    prefix: str | None,
    loaded: str | None = None,
    route: SymbolicRoute | None = None,
) -> tuple[Path, ...]:
    """Export a robot that was ``loaded`` from a file or name, and whose equations may be known."""
    if isinstance(targets, str):
        raise TypeError(f"targets is a tuple of names: targets=({targets!r},)")
    chosen = [known.get(name) for name in dict.fromkeys(targets)]
    if not chosen:
        raise ValueError("no targets are given")
    model = as_model(robot)
    program = generate(robot, functions, dtype=dtype)
    name = prefix or model.name + "f" * (program.scalar == "float")
    program = replace(program, name=name)
    check_names(program, TAKEN, frozenset().union(*(target.reserved for target in chosen)))
    tell("deriving golden states")
    own = [item for item in _flat(functions) if isinstance(item, UserFunction)]
    golden = golden_states(model, program, own, route)
    _require_right(model, largest_errors(program, golden), golden)
    folders = {}
    for target in chosen:
        command, call = _again(target.name, model, functions, program.scalar, batch, prefix, loaded)
        model_hash = digest(model)
        texts = target.files(Export(program, model, golden, batch, model_hash, command, call))
        folders[directory.absolute() / target.name] = _listed(texts, model_hash, call)
    _place(folders)
    return tuple(folders)


def _require_right(model: Model, errors: Mapping[str, float], golden: Golden) -> None:
    """Raise ValueError for functions that do not return what they must."""
    wrong = {name: error for name, error in errors.items() if not error <= golden.tolerance}
    if wrong:
        raise ValueError(
            f"nothing is exported: of {model.name} "
            + ", ".join(f"{name} is off by {error:.1e}" for name, error in wrong.items())
            + f", relative to the largest component, and {golden.tolerance:.0e} is allowed"
        )


#: what every export in C has besides its functions
TAKEN = frozenset({"fault", "joint_names", "q_min", "q_max", "default_parameters"})


def _flat(functions: Sequence[Any]) -> list[Any]:
    return [one for item in functions for one in (item if isinstance(item, tuple) else (item,))]


def _again(
    target: str,
    model: Model,
    functions: Sequence[Request],
    scalar: str,
    batch: bool,
    prefix: str | None,
    loaded: str | None,
) -> tuple[str, str]:
    """Return the command and the call that make an export again; "" where the command cannot."""
    source = loaded or model.name
    words = ["moro-codegen", source, "--export", "DIR", "--target", target]
    names = [item if isinstance(item, tuple) else (item,) for item in functions]
    asked = ", ".join(map(_shown, functions)) + "," * (len(functions) == 1)
    told = [f"targets=({target!r},)", f"functions=({asked})"]
    if all(isinstance(one, str) for group in names for one in group):
        words += ["--functions", ",".join("+".join(map(str, group)) for group in names)]
    if scalar == "float":
        words += ["--scalar", "float"]
        told.append('dtype="float32"')
    if batch:
        words.append("--batch")
        told.append("batch=True")
    if prefix:
        words += ["--prefix", prefix]
        told.append(f"prefix={prefix!r}")
    robot = f"moro.load({loaded!r})" if loaded else "robot"
    by_command = loaded is not None and "--functions" in words
    return " ".join(words) if by_command else "", f"mc.export({robot}, DIR, {', '.join(told)})"


def _shown(request: Any) -> str:
    if isinstance(request, tuple):
        return f"({', '.join(map(_shown, request))})"
    if isinstance(request, UserFunction):
        return f"mc.Function({request.name!r}, ...)"
    if isinstance(request, Regressor):
        return f"mc.{request!r}"
    return repr(request if isinstance(request, str) else request.name)


# -- on disk -------------------------------------------------------------------------------------


def _listed(texts: Mapping[str, str | bytes], model_hash: str, call: str) -> dict[str, bytes]:
    """Return files as bytes, with their list."""
    files = {
        path: text.encode() if isinstance(text, str) else text
        for path, text in sorted(texts.items())
    }
    said = {
        "made by": f"moro {moro.__version__}",
        "made with": call,
        "model sha256": model_hash,
        "files": {path: _digest(content) for path, content in files.items()},
    }
    return {**files, LIST: (json.dumps(said, indent=2) + "\n").encode()}


def _place(written: Mapping[Path, Mapping[str, bytes]]) -> None:
    """Write folders, each beside its place first; nothing where one of them cannot be replaced."""
    before = {folder: _files_of(folder) for folder in written}
    for folder, files in written.items():
        for path in files:
            if path not in before[folder] and (folder / path).exists() and path != LIST:
                raise FileExistsError(f"{folder / path} is not of an export: move it away")
    with tempfile.TemporaryDirectory(dir=_made(folder.parent), prefix=".moro-") as beside:
        for folder, files in written.items():
            for path, content in files.items():
                file = Path(beside) / folder.name / path
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_bytes(content)
        for folder, files in written.items():
            _move(Path(beside) / folder.name, folder, files, before[folder])


def _made(folder: Path) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def _move(new: Path, folder: Path, files: Mapping[str, bytes], old: Mapping[str, str]) -> None:
    """Put an export in its place: its list last, then what was there before goes."""
    if not folder.exists():
        new.rename(folder)
        return
    for path in files:
        _made((folder / path).parent)
        (new / path).replace(folder / path)
    for path in set(old) - set(files):
        (folder / path).unlink(missing_ok=True)


def _files_of(folder: Path) -> dict[str, str]:
    """Return the files of the export in a folder, with their checksums; none if nothing is there.

    Raise FileExistsError for anything but an export as it was written.
    """
    if not folder.exists():
        return {}
    try:
        listed = json.loads((folder / LIST).read_text(encoding="utf-8"))["files"]
        files = {str(path): str(checksum) for path, checksum in listed.items()}
    except FileNotFoundError:
        if folder.is_dir() and not any(folder.iterdir()):
            return {}
        raise FileExistsError(f"{folder} holds something else than an export of moro") from None
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        raise FileExistsError(f"{folder} holds something else than an export of moro") from None
    for path, checksum in files.items():
        if Path(path).is_absolute() or ".." in Path(path).parts:
            raise FileExistsError(f"{folder / LIST} lists {path}, which is not in its folder")
        file = folder / path
        if file.is_file() and _digest(file.read_bytes()) != checksum:
            raise FileExistsError(f"{file} was edited since it was exported: move it away")
    return files


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
