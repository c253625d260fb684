"""The benchmarks' own code, without peers: what is compared, and what is said of it."""

import itertools

import numpy as np
import pytest
import sympy as sp

import moro_codegen as mc
from benchmarks import arms, figures, measures, native, peers, report, timing
from benchmarks.peers import moro as ours
from benchmarks.tasks import TASKS


@pytest.fixture(scope="module")
def two_link():
    return next(arm for arm in arms.measured() if arm.label == "two_link")


@pytest.fixture
def here(tmp_path, monkeypatch):
    """Build in a folder of the test's own."""
    monkeypatch.setattr(native, "LIBRARIES", tmp_path)
    monkeypatch.setattr(ours, "KERNELS", tmp_path)


class TestArms:
    @pytest.mark.parametrize("name", ["stanford_arm", "panda", "seven_axis"])
    def test_numbers_place_the_links_where_the_robot_does(self, name):
        arm = next(arm for arm in arms.measured() if arm.label == name)
        q = arm.states["q"][0]
        R, p = np.eye(3), np.zeros(3)
        for i, x in enumerate(q):
            p = p + R @ arm.chain.p[i]
            R = R @ arm.chain.R[i]
            if arm.chain.revolute[i]:
                R = R @ np.array(sp.rot_axis3(-x), dtype=float)
            else:
                p = p + R[:, 2] * x
        values = dict(zip(arm.robot.qs, q, strict=True))
        # a body's centre of mass, in frame 0, is the same by either route
        last = arm.robot.r_cm(arm.dof).subs(values)
        np.testing.assert_allclose(p + R @ arm.chain.com[-1], np.array(last, float).ravel())

    def test_numbers_keep_zeros_and_tensors(self):
        chain = arms.Chain.of(arms.chain(3).robot.model())
        assert set(np.abs(chain.R.ravel())) == {0.0, 1.0}
        tensors = [np.array(I, float) for I in arms.chain(3).robot.inertia_tensors]
        np.testing.assert_allclose(chain.inertia, tensors)
        assert all(np.linalg.eigvalsh(I).min() > 0 for I in tensors)

    def test_trees_are_refused(self, two_link):
        from dataclasses import replace

        model = two_link.robot.model()
        tree = replace(model, joints=(model.joints[0], replace(model.joints[1], parent=-1)))
        with pytest.raises(ValueError, match="tree"):
            arms.Chain.of(tree)

    def test_states_lie_within_the_limits_and_are_always_the_same(self, two_link):
        low, high = np.array(two_link.robot.joint_limits, float).T
        q = two_link.states["q"]
        assert (low <= q).all()
        assert (q <= high).all()
        again = arms.Arm("again", two_link.robot).states["q"]
        np.testing.assert_array_equal(q, again)


class TestTiming:
    def test_contenders_take_turns(self):
        calls = []

        def block(name, seconds):
            def run(passes):
                calls.append(name)
                return seconds * passes

            return run

        blocks = {"a": block("a", 1e-3), "b": block("b", 3e-3)}
        samples = timing.interleaved(blocks, 10, rounds=4, block=0.012)
        assert "".join(calls).endswith("abbaabba")
        assert samples["a"].best == pytest.approx(1e-4)
        assert samples["a"].ratio(samples["b"]) == pytest.approx(3)
        assert samples["a"].paired_ratio(samples["b"]) == pytest.approx(3)

    def test_best_and_median(self):
        sample = timing.Sample((3.0, 1.0, 2.0))
        assert (sample.best, sample.median) == (1.0, 2.0)

    def test_passes_fill_a_block(self):
        assert timing.passes_for(lambda passes: 0.001 * passes, 0.1) == 100
        assert timing.passes_for(lambda passes: 5.0 * passes, 0.1) == 1

    def test_a_python_block_calls_as_often_as_it_is_told(self):
        count = itertools.count()
        assert timing.python_block(lambda: next(count))(7) > 0
        assert next(count) == 7


class TestAgreement:
    EXPECTED = np.array([[1.0, 100.0], [0.0, 0.0]])

    def test_rounding_is_no_disagreement(self):
        measures.check({"ours": self.EXPECTED, "theirs": self.EXPECTED * (1 + 1e-13)}, "tau")

    @pytest.mark.parametrize("error", [1e-7, np.nan, np.inf])
    def test_anything_else_is(self, error):
        other = self.EXPECTED.copy()
        other[0, 0] += error
        with pytest.raises(measures.DisagreementError, match=r"tau: theirs and ours differ"):
            measures.check({"ours": self.EXPECTED, "theirs": other}, "tau")

    def test_what_is_compared_with_has_to_be_finite(self):
        with pytest.raises(measures.DisagreementError, match="NaN"):
            measures.check({"ours": np.full((1, 2), np.nan)}, "tau")

    def test_a_singular_inertia_matrix_is_seen(self):
        conditions = {
            arm.label: measures.condition(arm)
            for arm in arms.measured()
            if arm.label in ("ur5", "panda")
        }
        assert conditions["ur5"] > measures.CONDITION > conditions["panda"]


class TestLoops:
    def test_calls_and_batches_give_what_the_kernel_gives(self, two_link, here):
        runs = measures.agreeing(two_link, TASKS["tau"], {"moro": ours})
        assert list(runs) == [measures.CALL, measures.BATCH]
        states = [two_link.states[name] for name in ("q", "qd", "qdd")]
        expected = mc.compile(two_link.robot).tau(*states)
        for run in runs.values():
            run.results[0][:] = np.nan
            assert run.seconds(64, 2) > 0
            np.testing.assert_allclose(run.results[0], expected, rtol=1e-12, atol=1e-12)
        assert runs[measures.CALL].seconds(1, 1, dependent=True) > 0

    def test_every_task_that_moro_has_takes_and_returns_what_is_said(self, two_link):
        for task in TASKS.values():
            assert ours.offers(task.name)
            function = mc.FUNCTIONS[task.name]
            assert tuple(a.name for a in function.inputs) == task.inputs
            assert "".join("vm"[len(a.shape) - 1] for a in function.outputs) == task.outputs

    def test_what_the_compiler_says_is_shown(self, here):
        with pytest.raises(native.BuildError, match="error"):
            native.library("broken", {"broken.c": "no C at all"})

    def test_every_peer_is_there_or_it_is_said_why(self):
        found = peers.find()
        assert "moro" in found.present
        assert set(found.present) | set(found.absent) == set(peers.MODULES)
        assert not set(found.present) & set(found.absent)
        assert all(found.absent.values())


def record(contender, ratio, **what):
    return {
        "arm": "ur5",
        "dof": 6,
        "contender": contender,
        "best": 10.0 * ratio,
        "median": 11.0 * ratio,
        "ratio": ratio,
        "paired_ratio": ratio,
        **what,
    }


@pytest.fixture
def results():
    def series(ratios, **what):
        return [record(contender, ratio, **what) for contender, ratio in ratios.items()]

    ratios = {"moro": 1, "CasADi, textbook": 3, "CasADi, moro's algorithm": 2.75, "Pinocchio": 19}
    made = {5: (0.1, 0.9), 50: (2.0, 10.0)}
    return {
        "when": "2026-01-01T00:00:00+00:00",
        "machine": {"processor": "a processor", "cores": 2, "system": "Linux"},
        "compilers": {"C": "cc 1"},
        "versions": {"moro": "0"},
        "commit": "0" * 40,
        "uncommitted_changes": False,
        "settings": {"states": 4096, "rounds": 15, "agreement": 1e-10},
        "absent": {"mujoco": "ImportError: no module"},
        "calls": [
            *series(ratios, function="tau", dependent=False),
            *series({"moro": 1, "Pinocchio": 0.5}, function="bias", dependent=False),
            *series({"moro": 1, "CasADi": 2.6}, function="tau", dependent=True),
            *(
                {**one, "arm": "panda"}
                for one in series({"moro": 1, "CasADi": 2.25}, function="tau", dependent=True)
            ),
        ],
        "batches": [
            *series({"moro, batch": 1, "Pinocchio": 0.8}, batch=1),
            *series({"moro, batch": 1, "Pinocchio": 80}, batch=4096),
        ],
        "python": series({"moro, out=": 1, "moro": 1.1, "Pinocchio": 4}),
        "growth": series({"moro": 1, "Pinocchio": 10}),
        "making": [
            {"dof": n, "contender": name, "generate": g * k, "compile": c * k}
            for n, (g, c) in made.items()
            for name, k in (("moro", 1), ("CasADi", 0.5))
        ],
        "operations": [
            {"arm": "ur5", "dof": 6, "add": 100, "mul": 110, "sincos": 4, "casadi": {"textbook": 9}}
        ],
        "passes": [{"passes": "+ one", "arm": "ur5", "operations": 210, "sincos": 4}],
    }


class TestReport:
    def test_figures(self, results):
        found = {f.measure: f for f in figures.figures(results)}
        casadi = found["tau, calls in a row, against CasADi, the least of all arms"]
        assert (casadi.now, casadi.reached) == (2.75, False)  # the faster of its two graphs
        assert found["the same where calls wait for each other"].now == 2.25  # of two arms
        assert not found["tau, one C call, UR5, against Pinocchio's rnea"].reached
        assert found["the same against Pinocchio's rnea in a loop"].now == 80
        assert found["operations of tau, ur5, rigid"].now == 210
        assert found["operations of tau, puma560, rigid"].now is None
        (growth,) = (f for f in found.values() if "linear growth" in f.measure)
        assert growth.now == pytest.approx(1.2)
        assert growth.reached

    def test_it_is_said_where_a_peer_is_faster(self, results):
        lines = list(figures.faster_peers(results))
        assert lines == [
            "bias, ur5, calls in C in a row: Pinocchio is 2.00 times faster",
            "tau, ur5, batches of 1: Pinocchio is 1.25 times faster",
            "making tau, 5 joints: CasADi is 2.0 times faster",
            "making tau, 50 joints: CasADi is 2.0 times faster",
        ]
        assert all(line in report.report(results) for line in lines)

    def test_it_is_said_what_was_not_measured(self, results):
        assert "- mujoco: ImportError: no module" in report.report(results)

    def test_columns_line_up(self):
        lines = report.table(("a", "long head"), [("x", "1"), ("longer", "22")]).splitlines()
        assert len({len(line) for line in lines}) == 1
        assert lines[2] == "| x      |         1 |"

    def test_a_part_is_reported_too(self, results):
        nothing = {name: [] for name in ("calls", "batches", "python", "growth", "making")}
        text = report.report({**results, **nothing})
        assert "operations of tau, ur5, rigid" in text
        assert "faster" not in text.split("Operations of tau")[1]

    def test_accuracy_chart(self, tmp_path):
        charts = pytest.importorskip("benchmarks.charts", exc_type=ImportError)
        errors = {"50 %": 1e-17, "90 %": 1e-16, "99 %": 2e-16, "100 %": 3e-16}
        types = ("float64", "float32")
        found = {"tau": {t: {"ur5": errors, "panda": errors} for t in types},
                 "sines": dict.fromkeys(types, errors)}  # fmt: skip
        written = [path.name for path in charts.draw_accuracy(found, tmp_path)]
        assert written == ["accuracy.png", "accuracy.svg"]
        text = (tmp_path / "accuracy.svg").read_text()
        assert all(word in text for word in ("UR5", "Panda", "sines, cosines", "largest", "90 %"))

    def test_charts(self, results, tmp_path):
        charts = pytest.importorskip("benchmarks.charts", exc_type=ImportError)
        written = [path.name for path in charts.draw(results, tmp_path)]
        assert {"time_per_call.png", "joints.svg", "operations.png", "passes.svg"} <= set(written)
        assert all((tmp_path / name).stat().st_size > 1000 for name in written)
