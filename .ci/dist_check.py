"""Build the source distribution and the wheel, install each by itself, and do the main job there.

Everything happens in a temporary folder, from a copy of the files that git knows: what lies about
in the checkout can neither help nor get into a distribution.
"""

import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
import venv
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
#: folders that are installed whole, and under which name
FOLDERS = {"moro": "moro", "codegen": "moro_codegen", "templates": "moro_codegen/templates"}
#: what else the source distribution holds
BESIDE = {
    "CHANGELOG.md", "LICENSE", "MANIFEST.in", "README.md", "SECURITY.md", "pyproject.toml",
    "setup.py",
}  # fmt: skip


def main() -> None:
    """Print what is done; exit with what failed."""
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        known = tracked()
        tree = copied(known, work / "tree")
        run(sys.executable, "-m", "build", "--outdir", work / "dist", tree, cwd=work)
        (sdist,) = (work / "dist").glob("*.tar.gz")
        (wheel,) = (work / "dist").glob("*.whl")
        compare(sdist, in_sdist(sdist), sources(known) | BESIDE | {"PKG-INFO", "setup.cfg"})
        compare(wheel, in_wheel(wheel), installed(known))
        for made in (sdist, wheel):
            try_out(made, work / made.suffix[1:])


def tracked() -> set[str]:
    """Return the paths of the repository's files, those that git has not heard of yet too."""
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    return {path for path in listed.split("\0") if path and (ROOT / path).is_file()}


def copied(paths: set[str], tree: Path) -> Path:
    """Return a copy of the files, with two more that a distribution must not take."""
    for path in paths:
        (tree / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / path, tree / path)
    (tree / "codegen/_runtime.c").write_text("#error stale\n")
    (tree / "moro/robots/mine.yml").write_text("stray\n")
    return tree


def sources(known: set[str]) -> set[str]:
    return {path for path in known if path.split("/")[0] in FOLDERS}


def installed(known: set[str]) -> set[str]:
    """Return what the wheel holds, but for the compiled module and what describes the wheel."""
    inside = (path.partition("/") for path in sources(known) if not path.endswith(".pyx"))
    return {f"{FOLDERS[folder]}/{rest}" for folder, _, rest in inside}


def in_sdist(path: Path) -> set[str]:
    with tarfile.open(path) as archive:
        names = {file.name.partition("/")[2] for file in archive.getmembers() if file.isfile()}
    return {name for name in names if ".egg-info/" not in name}


def in_wheel(path: Path) -> set[str]:
    names = set(zipfile.ZipFile(path).namelist())
    (compiled,) = (name for name in names if name.endswith(".so"))
    assert compiled.startswith("moro_codegen/_runtime."), compiled
    return {name for name in names - {compiled} if ".dist-info/" not in name}


def compare(archive: Path, found: set[str], expected: set[str]) -> None:
    if found != expected:
        stray, missing = sorted(found - expected), sorted(expected - found)
        sys.exit(f"{archive.name}: holds {stray}, which do not belong there; lacks {missing}")
    print(f"{archive.name}: {len(found)} files, as it should be", flush=True)


def try_out(made: Path, folder: Path) -> None:
    """Install a distribution in a fresh environment, and make, verify and call kernels with it."""
    venv.create(folder, with_pip=True)
    python = folder / "bin/python"
    run(python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", made, cwd=folder)
    print(f"{made.name}: installed", flush=True)
    run(folder / "bin/moro-codegen", "puma560", cwd=folder)
    run(
        python, "-m", "moro_codegen", "two_link", "--backend", "numpy", "--no-benchmark", cwd=folder
    )
    report = "import moro; moro.load('two_link').report('html', 'two_link.html')"
    run(python, "-c", report, cwd=folder)
    assert (folder / "build/puma560/libpuma560.so").is_file()
    assert (folder / "two_link.html").is_file()


def run(*command: object, cwd: Path) -> None:
    """Run a command as in an environment that knows nothing of the checkout."""
    hidden = ("PYTHONPATH", "VIRTUAL_ENV")
    variables = {name: value for name, value in os.environ.items() if name not in hidden}
    variables["XDG_CACHE_HOME"] = str(cwd / "cache")
    # pip's own cache stays, so that nothing is fetched twice
    variables.setdefault("PIP_CACHE_DIR", os.environ.get("PIP_CACHE_DIR") or pip_cache())
    done = subprocess.run([str(word) for word in command], cwd=cwd, env=variables, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}: exit status {done.returncode}")


def pip_cache() -> str:
    command = [sys.executable, "-m", "pip", "cache", "dir"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


if __name__ == "__main__":
    main()
