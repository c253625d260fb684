"""What the command says of its job for machines: one JSON document."""

from __future__ import annotations

import json
import math
from typing import Any

from moro_codegen.benchmark import BATCH
from moro_codegen.cli.job import Outcome, files


def document(outcome: Outcome) -> str:
    """Return the outcome as JSON; numbers that are not finite, or not there, are null.

    Errors are relative to the largest component of a state, as ``verify`` gives them; times are
    seconds; of ``timings`` each is one call from Python ("batch": 1), or per sample of a batch.
    """
    kernel, verification, times = outcome.kernel, outcome.verification, outcome.times
    found = {
        "name": kernel.name,
        "directory": str(kernel.directory),
        "files": outcome.files,
        "exported": {str(folder): files(folder) for folder in outcome.exported},
        "backend": kernel.backend,
        "scalar": kernel.manifest["scalar"],
        "joints": kernel.dof,
        "joint_types": list(outcome.robot.joint_types),
        "convention": outcome.robot.convention,
        "parameters": kernel.parameters,
        "verified": verification.passed,
        "verification": {
            "route": verification.route,
            "routes": dict(verification.routes),
            "states": len(verification.q),
            "tolerance": verification.tolerance,
            "largest_error": verification.max_error,
            "errors": verification.max_errors,
            "not_checked": list(verification.unchecked),
            "states_left_out": verification.left_out,
            "singular": verification.singular.tolist(),
        },
        "operations": kernel.ops,
        "times": {
            **{step: times[step] for step in ("derive", "generate")},
            "compile": None if kernel.reused else times["compile"],
            "verify": times["verify"],
        },
        "timings": [
            {
                "function": timing.function,
                "what": timing.what,
                "batch": BATCH if timing.batch else 1,
                "seconds": timing.seconds,
            }
            for timing in outcome.timings
        ],
    }
    return json.dumps(_finite(found), indent=2, allow_nan=False)


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
