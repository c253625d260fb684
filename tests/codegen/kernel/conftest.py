"""Kernels that many tests call."""

import pytest
from arms import reference_model
from programs import everything_program

from moro_codegen.pipeline import build
from moro_codegen.program import generate

SIZES = range(101)


@pytest.fixture(scope="module", params=["c", "numpy"])
def arm(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("puma560") / "puma560"
    return build(generate(reference_model("puma560")), folder, request.param)


@pytest.fixture(scope="module", params=["c", "numpy"])
def hand_made(request, tmp_path_factory):
    return build(everything_program(), tmp_path_factory.mktemp("all") / "all_ops", request.param)


@pytest.fixture(scope="module")
def compiled(tmp_path_factory):
    return build(generate(reference_model("puma560")), tmp_path_factory.mktemp("c") / "puma560")
