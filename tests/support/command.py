"""moro-codegen in a process of its own, without the seconds that importing SymPy takes.

A server imports once what the command does; each run is a fork of it, with folder, environment and
output as a new process has them.
"""

import os
import subprocess
import sys
import tempfile
from multiprocessing import get_context
from pathlib import Path

FORKS = get_context("forkserver")
FORKS.set_forkserver_preload(["moro_codegen.cli.job", "moro_codegen.cli.table", "moro.robot"])
#: seconds that a run may take
LIMIT = 120


def run(*arguments, cwd, **environment):
    """Run moro-codegen with these arguments; return what subprocess.run would."""
    words = [str(argument) for argument in arguments]
    variables = os.environ | {"COLUMNS": "100"} | environment
    with tempfile.TemporaryDirectory() as folder:
        streams = [Path(folder) / name for name in ("stdout", "stderr")]
        process = FORKS.Process(target=_command, args=(words, str(cwd), variables, streams))
        process.start()
        process.join(LIMIT)
        if process.exitcode is None:
            process.kill()
            raise subprocess.TimeoutExpired(words, LIMIT)
        texts = [path.read_text(encoding="utf-8") for path in streams]
    return subprocess.CompletedProcess(words, process.exitcode, *texts)


def _command(words, folder, variables, streams):
    from moro_codegen.cli import main

    for stream, path in zip((sys.stdout, sys.stderr), streams, strict=True):
        with path.open("wb") as file:
            os.dup2(file.fileno(), stream.fileno())
    os.environ.clear()
    os.environ.update(variables)
    os.chdir(folder)
    main(words, prog_name="moro-codegen")
