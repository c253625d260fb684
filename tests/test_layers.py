"""The layers: imports run one way, and nothing heavy is imported before it is needed."""

import ast
import importlib
import subprocess
import sys
from pathlib import Path

import pytest

import moro

ROOT = Path(__file__).parents[1]
PACKAGES = {"moro": ROOT / "moro", "moro_codegen": ROOT / "codegen"}


def modules():
    for package, folder in PACKAGES.items():
        for path in sorted(folder.rglob("*.py")):
            parts = [package, *path.relative_to(folder).with_suffix("").parts]
            yield ".".join(parts[:-1] if parts[-1] == "__init__" else parts), path


MODULES = dict(modules())


def imports(module, path):
    """Modules of the project that a module imports, also inside functions and for types."""
    package = module if path.name == "__init__.py" else module.rpartition(".")[0]
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                above = package.split(".")[: len(package.split(".")) - node.level + 1]
                base = ".".join([*above, *([base] if base else [])])
            names = [f"{base}.{alias.name}" for alias in node.names]
            names = [name if name in MODULES else base for name in names]
        else:
            continue
        yield from (name for name in names if name in MODULES)


GRAPH = {module: set(imports(module, path)) - {module} for module, path in MODULES.items()}


def reached(module, graph=GRAPH):
    """All that a module imports, and what that imports."""
    found, new = set(), {module}
    while new:
        found |= new
        new = {name for m in new for name in graph[m]} - found
    return found


#: the rooms of both packages, in the order of their imports, as CONTRIBUTING.md lists them
ROOMS = {
    "moro": "late abc spatial model checks scalars closed_form algorithms printing identification "
    "formats mechanics report robot io core",
    "moro_codegen": "registry progress waiting calls graph passes functions signature program emit "
    "backends kernel proof lambdified pipeline targets exported installation benchmark cli "
    "__main__",
}


def room(module):
    """A module's package, and the place of its room there; that of the package itself is last."""
    package, _, inside = module.partition(".")
    rooms = ROOMS[package].split()
    return package, rooms.index(inside.split(".")[0]) if inside else len(rooms)


def test_imports_run_down_the_list_of_rooms():
    upwards = [
        (module, name)
        for module, used in GRAPH.items()
        for name in used
        if "." in name and room(module)[0] == room(name)[0] and room(module)[1] < room(name)[1]
    ]
    assert not upwards


@pytest.mark.parametrize("package", PACKAGES)
def test_contributing_lists_the_rooms_in_their_order(package):
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    table = text.split(f"(`{package}`) | what |")[1].split("\n\n")[0]
    listed = [
        name.strip().removesuffix("/").removesuffix(".py")
        for line in table.splitlines()[2:]
        for name in line.split("|")[1].split(",")
    ]
    rooms = ROOMS[package].split()
    known = [name for name in listed if name != "robots"]  # which is data
    assert known == [name for name in rooms if name in known]
    small = {"late", "io", "core", "installation", "__main__"}
    assert set(rooms) - set(known) <= small


def test_moro_never_imports_moro_codegen():
    guilty = {m for m, used in GRAPH.items() if m.startswith("moro.") or m == "moro"
              for name in used if name.startswith("moro_codegen")}  # fmt: skip
    assert not guilty


@pytest.mark.parametrize("module", [m for m in GRAPH if m.startswith("moro.algorithms")])
def test_algorithms_know_only_the_model(module):
    allowed = ("moro.algorithms", "moro.model", "moro.spatial")
    assert all(name.startswith(allowed) for name in GRAPH[module]), GRAPH[module]


@pytest.mark.parametrize("module", ["moro.scalars.trig", "moro.spatial.vectors", "moro.abc"])
def test_the_ground_floor_stands_on_nothing(module):
    below = {"moro.scalars.relations", "moro.scalars.free"}
    assert reached(module) <= {module, *below}


@pytest.mark.parametrize(
    "module", ["moro.closed_form", "moro.closed_form.geometry", "moro.printing.display"]
)
def test_the_symbolic_route_never_uses_the_recursive_one(module):
    assert not {name for name in reached(module) if name.startswith("moro.algorithms")}


@pytest.mark.parametrize(
    "module", ["moro.mechanics", "moro.formats.loading", "moro.report", "moro.formats.source"]
)
def test_what_the_face_is_made_of_does_not_know_it(module):
    assert "moro.robot" not in reached(module)


def test_what_reads_the_model_knows_no_rows():
    assert not {
        "moro.formats.dh.description",
        "moro.formats.dh.arm",
        "moro.formats.dh.to_model",
    } & reached("moro.mechanics")


def test_imports_anywhere_in_a_file_are_seen(tmp_path):
    path = tmp_path / "some.py"
    path.write_text(
        "from typing import TYPE_CHECKING\n"
        "if TYPE_CHECKING:\n    from moro.robot import Robot\n"
        "def f():\n    from .model import Model\n    import moro.scalars.trig\n"
    )
    assert {*imports("moro.some", path)} == {"moro.robot", "moro.model", "moro.scalars.trig"}


def test_there_are_no_circles():
    done, path = set(), []

    def visit(module):
        assert module not in path, " -> ".join([*path[path.index(module) :], module])
        if module in done:
            return
        path.append(module)
        for name in sorted(GRAPH[module]):
            visit(name)
        path.pop()
        done.add(module)

    for module in GRAPH:
        visit(module)


HEAVY = ("sympy", "numpy", "pydantic", "yaml", "jinja2", "rich", "click")


def loaded(code, folder):
    """Which of the heavy packages a program imports, whether or not it exits."""
    program = (
        "import sys\n"
        f"try:\n    {code}\n"
        f"except SystemExit: pass\n"
        f"print('', *[m for m in {HEAVY} if m in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=folder
    )
    return set(done.stdout.splitlines()[-1].split()), done


@pytest.mark.parametrize("package", ["moro", "moro.formats.loading", "moro_codegen"])
def test_importing_is_light(package, tmp_path):
    assert loaded(f"import {package}", tmp_path)[0] == set()


def test_importing_symbols_needs_nothing_but_sympy(tmp_path):
    assert loaded("from moro import Robot; import moro; moro.abc", tmp_path)[0] <= {
        "sympy",
        "numpy",
    }


@pytest.mark.parametrize("package", PACKAGES)
def test_names_come_when_they_are_asked_for(package):
    module = importlib.import_module(package)
    assert set(module.__all__) <= set(dir(module))
    assert all(getattr(module, name) for name in module.__all__)
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        module.nonsense  # noqa: B018


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--help"], "Functions:"),
        (["--version"], f"moro-codegen {moro.__version__}"),
        (["pma560"], "did you mean `puma560`"),
        (["two_link", "-f", "tua"], "did you mean 'tau'"),
        (["broken.yaml"], "not YAML: a list is not closed"),
        (["empty.yaml"], "the file is empty"),
        (["text.yaml"], "expected `links:`"),
        (["nowhere/arm.yaml"], "no such file"),
    ],
)
def test_help_and_refusals_need_no_sympy(arguments, said, tmp_path):
    (tmp_path / "broken.yaml").write_text("links: [1, 2\n")
    (tmp_path / "empty.yaml").write_text("")
    (tmp_path / "text.yaml").write_text("robot\n")
    packages, done = loaded(
        f"from moro_codegen import cli; cli.main({arguments}, prog_name='moro-codegen')", tmp_path
    )
    assert said in done.stdout + done.stderr
    assert packages <= {"click", "yaml"}
