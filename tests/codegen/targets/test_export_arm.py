"""Exports in C on Arm: cross-compiled as their README says, and run in an emulator."""

import re
import shutil
import subprocess

import pytest
from exports import EXPORTS, STRICT, errors, needs, run

#: compiler and emulator of each TARGET of the Makefile
TARGETS = {
    "cortex-m4": ("arm-none-eabi-gcc", "qemu-system-arm"),
    "cortex-m7": ("arm-none-eabi-gcc", "qemu-system-arm"),
    "aarch64": ("aarch64-linux-gnu-gcc", "qemu-aarch64"),
    "armhf": ("arm-linux-gnueabihf-gcc", "qemu-arm"),
}
STRICT_FLAGS = "CFLAGS=-O1 " + " ".join(STRICT)


def on(target):
    """Skip where the compiler, its C library or the emulator is missing."""
    compiler, emulator = TARGETS[target]
    missing = next((tool for tool in (compiler, emulator) if shutil.which(tool) is None), None)
    if not missing:
        command = [compiler, "-print-file-name=libc.a"]
        found = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        missing = None if "/" in found else f"the C library of {compiler}"
    reason = f"{missing} is not installed on this machine"
    return [pytest.mark.skipif(missing is not None, reason=reason), needs("make")]


def for_target(*targets):
    return [pytest.param(target, marks=on(target)) for target in targets]


CHECKED = {
    "cortex-m4": ("float",),
    "cortex-m7": ("pumaf", "puma"),
    "aarch64": ("float", "puma"),
    "armhf": ("pumaf", "puma"),
}


@pytest.mark.parametrize(
    ("target", "name"),
    [pytest.param(t, name, marks=on(t)) for t, names in CHECKED.items() for name in names],
)
def test_make_check(copy, target, name):
    """The self-test passes there, without a warning."""
    found = errors(run("make", "check", f"TARGET={target}", STRICT_FLAGS, cwd=copy(name)))
    assert len(found) == len(EXPORTS[name][1])
    assert max(found.values()) < (1e-12 if name == "puma" else 1e-4)


@pytest.mark.parametrize("target", for_target("cortex-m4"))
def test_what_is_wrong_there_fails(copy, target):
    """Also where the processor stops; and what was compiled for another is compiled anew."""
    folder = copy("tauf")
    assert errors(run("make", "check", cwd=folder))
    assert errors(run("make", "check", f"TARGET={target}", cwd=folder))
    assert "two_linkf.c" in run("make", cwd=folder)
    assert "two_linkf.c" not in run("make", cwd=folder)
    start = folder / "cortex_m.c"
    start.write_text(start.read_text().replace("0xFu << 20", "0x0u << 20"))  # no coprocessor
    assert "passed" not in run("make", "check", f"TARGET={target}", cwd=folder, fails=True)
    source = folder / "two_linkf.c"
    source.write_text(source.read_text().replace("tau[0] = ", "tau[0] = 1.5f + "))
    start.write_text(start.read_text().replace("0x0u << 20", "0xFu << 20"))
    assert "WRONG" in run("make", "check", f"TARGET={target}", cwd=folder, fails=True)


def test_a_target_that_is_none(copy):
    printed = run("make", "check", "TARGET=cortex-m0", cwd=copy("tauf"), fails=True)
    assert "TARGET is cortex-m4, cortex-m7, aarch64 or armhf, not cortex-m0" in printed


@pytest.mark.parametrize("target", for_target("cortex-m4"))
def test_stack_and_freestanding(copy, target):
    """Small there; and it needs no more than a few functions of <math.h>."""
    folder = copy("pumaf")
    printed = run("make", "-s", "stack", f"TARGET={target}", cwd=folder)
    sizes = {name: int(n) for name, n in re.findall(r"^puma560f_(\w+)\t(\d+) bytes", printed, re.M)}
    assert set(sizes) == {"tau", "forward_dynamics", "fault"}
    assert 200 < sizes["tau"] < 600
    flags = f"CFLAGS=-O2 -ffreestanding {' '.join(STRICT)}"
    run("make", "puma560f.o", f"TARGET={target}", flags, cwd=folder)
    needed = set(re.findall(r"U (\w+)", run("arm-none-eabi-nm", "-u", "puma560f.o", cwd=folder)))
    assert needed == {"sinf", "cosf", "atan2f", "fabsf"}


BITS = """
#include <stdio.h>
#include <string.h>
#include "puma560f.h"

int main(void)
{
    for (int k = -8; k <= 8; k++) {
        float q[6], qd[6], tau[6];
        unsigned bits[6];
        for (int i = 0; i < 6; i++) {
            q[i] = 0.37f * (float)(k * i + 1);
            qd[i] = 0.5f * (float)(i - k);
        }
        puma560f_tau(q, qd, q, tau);
        memcpy(bits, tau, sizeof bits);
        for (int i = 0; i < 6; i++)
            printf("%08x ", bits[i]);
    }
    return 0;
}
"""


@pytest.mark.parametrize("target", for_target("cortex-m4", "aarch64", "armhf"))
def test_the_same_bits(copy, target):
    """With -ffp-contract=off, on every processor: those of the machine at hand."""
    folder = copy("pumaf")
    (folder / "selftest.c").write_text(BITS)
    flags = "CFLAGS=-O2 -ffp-contract=off"
    here, there = (
        run("make", "-s", "check", flags, f"TARGET={name}", cwd=folder) for name in ("", target)
    )
    assert len(here.split()) == 17 * 6
    assert here == there


@needs("cmake")
@pytest.mark.parametrize("target", for_target("cortex-m7"))
def test_cmake(copy, target):
    folder = copy("tauf")
    toolchain = ("-DCMAKE_TOOLCHAIN_FILE=cortex_m.cmake", f"-DCORTEX_M={target}")
    run("cmake", "-B", "build", *toolchain, cwd=folder)
    run("cmake", "--build", "build", cwd=folder)
    assert "100% tests passed" in run("ctest", "--test-dir", "build", cwd=folder)
    (code,) = (folder / "build").rglob("two_linkf.c.obj")
    assert "_GLOBAL_OFFSET_TABLE_" not in run("arm-none-eabi-nm", code, cwd=folder)
