"""Exports: the same bytes every time, nothing half-written, nothing of others overwritten."""

import json
import os
import subprocess
import sys
from dataclasses import replace

import pytest
import sympy as sp
from command import run as command
from exports import tree, two_link

import moro
import moro_codegen as mc
from moro.abc import q1
from moro_codegen import registry
from moro_codegen.proof import golden
from moro_codegen.proof.results import Expected
from moro_codegen.targets import Target, get, register

ALL = registry.TARGETS.names()
#: those that compute in single precision, too
FLOAT = tuple(name for name in ALL if name != "cython")


def test_the_same_bytes_every_time(tmp_path):
    program = f"import moro, moro_codegen as mc\nmc.export(moro.load('two_link'), 'out', {ALL})"
    subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, check=True,
        env=os.environ | {"PYTHONHASHSEED": "7"},
    )  # fmt: skip
    mc.export(two_link(), tmp_path / "here", ALL)
    assert tree(tmp_path / "out") == tree(tmp_path / "here")


def test_what_made_it_is_in_every_folder(tmp_path):
    robot = two_link()
    for folder in mc.export(robot, tmp_path, ALL, ("tau",), batch=True, prefix="arm"):
        said = json.loads((folder / "moro.json").read_text())
        readme = (folder / "README.md").read_text()
        assert said["made by"] == f"moro {moro.__version__}"
        assert said["model sha256"] in readme
        assert moro.__version__ in readme
        again = f"targets=('{folder.name}',), functions=('tau',), batch=True, prefix='arm')"
        assert again in said["made with"]
        assert again in readme
        assert "choose your own licence" in readme
        assert set(said["files"]) == set(tree(folder)) - {"moro.json"}


def test_a_change_of_the_model_changes_the_hash(tmp_path):
    hashes = set()
    for name, robot in (("a", two_link()), ("b", two_link(payload=0.5))):
        (folder,) = mc.export(robot, tmp_path / name)
        hashes.add(json.loads((folder / "moro.json").read_text())["model sha256"])
    assert len(hashes) == 2


def test_an_export_is_replaced_and_what_is_not_of_it_stays(tmp_path):
    (folder,) = mc.export(two_link(), tmp_path, prefix="old")
    (folder / "mine.c").write_text("int mine;")
    mc.export(two_link(), tmp_path, prefix="new")
    assert {"new.c", "new.h", "mine.c", "README.md"} < set(tree(folder))
    assert not [path for path in tree(folder) if path.startswith("old")]


def test_nothing_of_others_is_overwritten(tmp_path):
    (folder,) = mc.export(two_link(), tmp_path)
    (folder / "two_link.h").write_text("edited")
    before = tree(tmp_path)
    with pytest.raises(FileExistsError, match=r"two_link.h was edited since it was exported"):
        mc.export(two_link(), tmp_path, ("python", "c"))
    (tmp_path / "python").mkdir()
    (tmp_path / "python" / "notes.txt").write_text("mine")
    with pytest.raises(FileExistsError, match="holds something else than an export of moro"):
        mc.export(two_link(), tmp_path, ("python",))
    (folder / "two_link.h").unlink()
    (folder / "arm.h").write_text("mine")
    with pytest.raises(FileExistsError, match=r"arm.h is not of an export: move it away"):
        mc.export(two_link(), tmp_path, prefix="arm")
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="file"):
        mc.export(two_link(), tmp_path / "file")
    assert tree(tmp_path).keys() == before.keys() - {"c/two_link.h"} | {
        "python/notes.txt", "c/arm.h", "file"
    }  # fmt: skip


def test_a_list_that_leads_elsewhere_is_refused(tmp_path):
    (folder,) = mc.export(two_link(), tmp_path / "out")
    (tmp_path / "precious").write_text("")
    (folder / "moro.json").write_text(json.dumps({"files": {"../../precious": "0"}}))
    with pytest.raises(FileExistsError, match="which is not in its folder"):
        mc.export(two_link(), tmp_path / "out")


def test_nothing_is_written_unless_everything_can_be(tmp_path):
    with pytest.raises(ValueError, match="double precision only"):
        mc.export(two_link(), tmp_path, ("c", "cython"), dtype="float32")
    assert not tree(tmp_path)


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ({"targets": "c"}, TypeError, "targets is a tuple of names"),
        ({"targets": ()}, ValueError, "no targets"),
        ({"targets": ("fortran",)}, ValueError, 'target must be "c"'),
        ({"functions": ("tua",)}, ValueError, "did you mean"),
        ({"functions": (mc.Function("q_min", q1),)}, ValueError, "cannot be named 'q_min'"),
        ({"functions": (mc.Function("new", q1),), "targets": ("cpp",)}, ValueError, "named 'new'"),
        ({"prefix": "my arm"}, ValueError, "'my arm' cannot name functions"),
        ({"dtype": "half"}, ValueError, "dtype must be"),
    ],
)
def test_what_cannot_be_exported(arguments, error, words, tmp_path):
    with pytest.raises(error, match=words):
        mc.export(two_link(), tmp_path, **arguments)
    assert not tree(tmp_path)


def test_functions_that_golden_states_refute_are_not_exported(tmp_path, monkeypatch):
    wrong = Expected(lambda x: [1.001 * x.G])
    monkeypatch.setitem(golden.EXPECTED, "gravity_vector", wrong)
    with pytest.raises(ValueError, match=r"nothing is exported: .* gravity_vector is off by 1.0e"):
        mc.export(two_link(), tmp_path, functions=("tau", "gravity_vector"))
    assert not tree(tmp_path)


def test_golden_states_of_every_function(tmp_path):
    """Each is compared, those of one's own with their expressions."""
    gain = sp.Symbol("gain")
    own = mc.Function("spring", [gain * q1, sp.sin(q1)], parameters={gain: None})
    model = two_link(payload=0.5).model()
    functions = (*mc.FUNCTIONS, ("tau", "jacobian"), own, "jacobian@1")
    program = mc.generate(model, functions)
    found = golden.golden_states(model, program, (own,))
    assert not found.unchecked
    assert {x.signature.name for x in found.functions} == {s.name for s in program.signatures}
    errors = golden.largest_errors(program, found)
    differences = {name for name in errors if "hessian" in name or "derivatives" in name}
    assert max(errors.pop(name) for name in differences) < 1e-12
    assert max(errors.values()) < 1e-14
    unknown = golden.golden_states(model, program)
    assert unknown.unchecked == ("spring",)
    rounded = golden.golden_states(model, replace(program, scalar="float"), (own,))
    assert rounded.tolerance == 2e-4
    q = rounded.functions[0].inputs["q"]
    assert (q == q.astype("float32")).all()


class Words(Target):
    name = "words"
    reserved = frozenset({"a_word"})

    def files(self, export):
        return {"names.txt": "\n".join(s.name for s in export.program.signatures)}


def test_a_target_from_outside(tmp_path):
    register(Words())
    try:
        assert get("words").name == "words"
        (folder,) = mc.export(two_link(), tmp_path, ("words",), ("tau", "bias"))
        assert (folder / "names.txt").read_text() == "tau\nbias"
        with pytest.raises(ValueError, match="there is a target 'words' already"):
            register(Words())
        with pytest.raises(ValueError, match="cannot be named 'a_word'"):
            mc.export(two_link(), tmp_path, ("words",), (mc.Function("a_word", q1),))
    finally:
        registry.TARGETS.remove("words")


def test_the_command(tmp_path):
    words = ("--export", "out", "--target", "c,python", "-f", "tau,tau+bias", "--no-benchmark")
    done = command("two_link", *words, "--prefix", "arm", "--batch", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "\nout/c/: CMakeLists.txt" in done.stdout
    assert "\nout/python/: README.md, arm.py" in done.stdout
    assert "arm_tau_bias_batch(" in (tmp_path / "out/c/arm.h").read_text()
    again = "moro-codegen two_link --export DIR --target c --functions tau,tau+bias --batch"
    assert f"{again} --prefix arm" in (tmp_path / "out/c/README.md").read_text()
    asked = command("two_link", *words, "--json", cwd=tmp_path)
    exported = json.loads(asked.stdout)["exported"]
    assert set(exported) == {str(tmp_path / "out" / name) for name in ("c", "python")}


def test_the_command_exports_nothing_that_is_wrong(tmp_path, monkeypatch, capsys):
    from moro_codegen import cli, verify

    module = sys.modules[verify.__module__]
    monkeypatch.setitem(module.CHECKS, "bias", lambda x, bias: [module.Pair(bias, 2 * x.bias)])
    monkeypatch.chdir(tmp_path)
    words = ["two_link", "-f", "bias", "--no-benchmark", "--backend", "numpy", "--export", "out"]
    with pytest.raises(SystemExit) as stopped:
        cli.main(words)
    assert stopped.value.code == 1
    assert not (tmp_path / "out").exists()
    assert "out/" not in capsys.readouterr().out
