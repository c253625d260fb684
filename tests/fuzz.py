"""``make fuzz``: robot files, expressions and names that nobody would think of.

Each target is a property that holds for every input; Hypothesis looks for one that breaks it, until
the time is over, and prints the smallest. ``python -m tests.fuzz [seconds] [target ...]``
"""

import ast
import io
import itertools
import operator
import re
import signal
import subprocess
import sys
import tempfile
import time
import tokenize
import warnings
from functools import lru_cache
from pathlib import Path

import mpmath
import sympy as sp
import yaml
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

import moro_codegen as mc
from moro import Robot, load
from moro.abc import q1
from moro.formats.loading import RobotFileError, packaged
from moro.formats.yaml.expressions import FUNCTIONS, ExpressionError, parse
from moro_codegen.emit import statements
from moro_codegen.pipeline import sources
from moro_codegen.program import generate

PLAIN_NAME = "plain_name"
#: seconds that any one input may take
LIMIT = 60
#: inputs of one round
ROUND = 200
ARMS = Path(__file__).parents[1] / "moro/robots"
TEXTS = [(ARMS / f"{name}.yaml").read_text(encoding="utf-8") for name in packaged()]

#: what is special somewhere: to YAML, to expressions, to the schema
TOKENS = [
    *"-:,.[]{}#&*!|>'\"%@`~?\n\t\0", "0", "-1", "1e400", "1e-400", ".nan", ".inf", "null", "true",
    "yes", "1_000", "0x10", "010", "1:30", "2026-01-01", "1,5", "!!python/name:os.system ", "&a ",
    "*a", "<<: *a", "pi", "pi/0", "q1", "payload", "sqrt(-1)", "9**9", "log(0)", "sin(1)**2",
    "links:", "joint:", "mass:", "com:", "inertia:", "limits:", "parameters:", "name:", "gravity:",
    "dh", "mdh", "revolute", "prismatic", "fixed", "helical", "xyz:", "rpy:", "R:", "axis:",
    "bodies:", "frames:", "parent:", "base:", "tool:", "coordinates:", "gear_ratio:", "-q2 - q3",
    "q1*q2", "\u2028", "\ufeff", "é", "１", "\U0001f916",
]  # fmt: skip

#: what is special in a URDF
URDF_WORDS = re.split(
    r"(\W)", (Path(__file__).parent / "reference/urdf/stacker.urdf").read_text(encoding="utf-8")
)
XML_TOKENS = [
    *"<>/\"'&;= \n\t\0", "0", "-1", "1e400", "nan", "inf", "1_0", "&lol;", "&#0;", "<!--",
    "<![CDATA[", "<!DOCTYPE x>", "<?xml?>", "${x}", "xacro:x", "floating",
    "planar", "fixed", "mimic", "finger",
    "deck", "floor", "ixx", "xyz", "9" * 200, "\ufeff", "é", "１", "\ud800",
]  # fmt: skip

#: what is special in a comment, a string, or a line of what is emitted
HOSTILE = [
    "*/", "/*", "//", "\\", "\\\n", "\n", "\r", "\u2028", '"', '"""', "'", "'''", "??/", "{{", "}}",
    "{%", "%s", "#", "#error", "\0", "\\u0022", "\\N{QUOTATION MARK}", "$", "`", "<!--", "\x85",
    "\x0c", "NAN", "int", "class", "parameters", "q", "m_1", " ", "é", "\U0001f916", "\ud800",
]  # fmt: skip


@st.composite
def robot_texts(draw):
    """A packaged robot file with some of its lines, words and characters replaced."""
    text = draw(st.sampled_from(TEXTS))
    for _ in range(draw(st.integers(1, 6))):
        start = draw(st.integers(0, len(text)))
        end = min(len(text), start + draw(st.integers(0, 12)))
        new = draw(st.sampled_from(TOKENS) | st.text(max_size=4))
        text = text[:start] + new + text[end:]
    return text.encode("utf-8", "surrogatepass")


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.sampled_from(TOKENS) | st.text(),
    lambda inner: st.lists(inner, max_size=7) | st.dictionaries(st.text(max_size=5), inner),
    max_leaves=12,
)


@st.composite
def robot_trees(draw):
    """A packaged robot with any values in some of its places."""
    tree = yaml.safe_load(draw(st.sampled_from(TEXTS)))
    for _ in range(draw(st.integers(1, 4))):
        link = draw(st.sampled_from(tree["links"])) if tree.get("links") else tree
        place = link if isinstance(link, dict) and draw(st.booleans()) else tree
        key = draw(st.sampled_from(sorted(map(str, place)) or ["a"]) | st.text(max_size=5))
        place[key] = draw(VALUES)
        if not isinstance(tree.get("links"), list):
            break
    return yaml.safe_dump(tree, allow_unicode=True).encode("utf-8", "surrogatepass")


@st.composite
def urdfs(draw):
    """A URDF with some of its words and characters replaced."""
    words = [*URDF_WORDS]
    for _ in range(draw(st.integers(1, 4))):
        at = draw(st.integers(0, len(words) - 1))
        words[at] = draw(st.sampled_from(XML_TOKENS) | st.text(max_size=4))
    return "".join(words).encode("utf-8", "surrogatepass")


def urdf_files(data):
    """Any file is a robot with a model, or one error that names the file."""
    robot_files(data, "robot.urdf")


def robot_files(data, name="arm.yaml"):
    """Any file is a robot with a model, or one error that names the file."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        path.write_bytes(data)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                robot = load(path)
        except RobotFileError as error:
            robot, message = None, str(error)
    if robot is None:
        assert message.startswith(str(path))
    elif robot.masses is not None:
        assert robot.model().nv == robot.dof > 0


OPERATIONS = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}  # fmt: skip
TINY = mpmath.mpf(10) ** -35
NUMBERS = st.sampled_from(["0", "1", "2", "0.5", "1e-3", ".25", "3.", "1000", "pi", "a", "b"])


def _longer(inner):
    pair = st.tuples(inner, st.sampled_from(["+", "-", "*", "/", "**"]), inner)
    one = st.tuples(st.sampled_from([f for f, (n, _) in FUNCTIONS.items() if n == 1]), inner)
    return (
        pair.map(lambda t: f"{t[0]} {t[1]} {t[2]}")
        | one.map(lambda t: f"{t[0]}({t[1]})")
        | inner.map("({})".format)
        | inner.map("-{}".format)
        | st.tuples(inner, inner).map(lambda t: f"atan2({t[0]}, {t[1]})")
    )


def expressions(text):
    """Whatever is accepted has the value that Python gives it; the rest is one error."""
    a, b = sp.symbols("a b")
    try:
        value = parse(text, {"a": a, "b": b})
    except ExpressionError:
        return
    with mpmath.workdps(80):
        try:
            expected = _value(ast.parse(text.strip(), mode="eval").body, text.strip())
        except (ArithmeticError, ValueError):
            return  # at a, b = 1/2, 2 it has no real one: 1/(b - 2), asin(b)
        found = sp.sympify(value).subs({a: sp.Rational(1, 2), b: 2}).evalf(80, maxn=400)
        found = mpmath.mpmathify(found)
        assert abs(found - expected) <= mpmath.mpf(10) ** -40 * max(1, abs(expected))


def _value(node, text):
    """Return the value of Python's syntax tree of an expression, to the digits that mpmath has."""
    match node:
        case ast.Constant():
            return mpmath.mpf(ast.get_source_segment(text, node))
        case ast.Name(id=name):
            return {"pi": +mpmath.pi, "a": mpmath.mpf("0.5"), "b": mpmath.mpf(2)}[name]
        case ast.UnaryOp(op=op, operand=operand):
            value = _value(operand, text)
            return -value if isinstance(op, ast.USub) else value
        case ast.BinOp(left=left, op=op, right=right):
            return _real(OPERATIONS[type(op)](_value(left, text), _value(right, text)))
        case ast.Call(func=ast.Name(id=name), args=args):
            function = abs if name == "abs" else getattr(mpmath, name)
            values = [_value(arg, text) for arg in args]
            if name == "atan2" and values == [0, 0]:
                raise ValueError("no angle")
            return _real(function(*values))
    raise AssertionError(f"{ast.dump(node)} was accepted")


def _real(value):
    """Raise ValueError where the digits do not tell: what is all but 0 may be 0."""
    if isinstance(value, mpmath.mpc) or not (value == 0 or TINY < abs(value) < 1 / TINY):
        raise ValueError("not real, or too small or large to be compared")
    return value


def names(name):
    """Names of symbols and texts of functions leave no trace but in comments and strings.

    A symbol may give a local variable its name: one identifier, which is nothing else's.
    """
    for symbol, text in ((name, "text"), (PLAIN_NAME, name)):
        try:
            found = emitted(sp.Symbol(symbol), text)
        except ValueError:  # refused, and said so
            continue
        for path, words in emitted(sp.Symbol(PLAIN_NAME), "text").items():
            assert len(found[path]) == len(words), path
            pairs = set(zip(words, found[path], strict=True))
            local = {new for old, new in pairs if old == PLAIN_NAME}
            assert all(old in (new, PLAIN_NAME) for old, new in pairs), path
            assert len(local) <= 1, path
            assert all(re.fullmatch(r"[A-Za-z_]\w*", new, re.ASCII) for new in local), path
            near = itertools.chain(*(x for x in functions(path, words) if PLAIN_NAME in x))
            assert not local & {*near} - {PLAIN_NAME}, path


def functions(path, words):
    """Return the words of each function, with what is written before it.

    Python's end where an indentation does, for which tokenize has an empty word.
    """
    found, depth = [[]], 0
    for word in words:
        depth += (word == "{") - (word == "}")
        found[-1].append(word)
        if word in ("def", "") if path.endswith(("py", "pyx")) else (word, depth) == ("}", 0):
            found.append([])
    return found


@lru_cache(maxsize=8)
def emitted(mass, text):
    """Return all that is emitted of an arm, without comments and strings, by path."""
    robot = Robot((1, 0, 0, q1), name="arm")
    robot.masses = [mass]
    robot.cm_positions = [[0, 0, 0]]
    robot.inertia_tensors = [[[1, 0, 0], [0, 1, 0], [0, 0, 1]]]
    robot.gravity = [0, -9, 0]
    own = mc.Function("f", mass * q1, summary=text, unit=text)
    program = generate(robot, ("tau", own))
    written = sources(program, "c", ("cython", "python")).values()
    texts = {path: text for texts in written for path, text in texts.items()}
    return {path: stripped(path, text) for path, text in texts.items() if not path.endswith(".md")}


def stripped(path, text):
    """Return the words of code, without comments and strings; raise if it is none."""
    text.encode()
    if path.endswith((".c", ".h")):
        command = ["cc", "-w", "-fpreprocessed", "-dD", "-E", "-P", "-x", "c", "-"]
        done = subprocess.run(command, input=text, capture_output=True, text=True, check=True)
        return re.findall(r"\w+|\S", done.stdout)
    if path.endswith(".py"):
        compile(text, path, "exec")
    if path.endswith(".toml"):
        return []
    words = tokenize.generate_tokens(io.StringIO(text).readline)
    kinds = (tokenize.COMMENT, tokenize.STRING, tokenize.NL)
    return [word.string for word in words if word.type not in kinds]


TARGETS = {
    "robot_files": (robot_files, robot_texts() | robot_trees() | st.binary(max_size=200)),
    "urdf_files": (urdf_files, urdfs() | st.binary(max_size=200)),
    "expressions": (
        expressions,
        st.recursive(NUMBERS, _longer, max_leaves=12)
        | st.text("0123456789.e+-*/()ab pi,_", max_size=30),
    ),
    "names": (
        names,
        st.lists(st.sampled_from(HOSTILE) | st.text(max_size=6), max_size=6).map("".join),
    ),
}


def limited(holds):
    """Return a property that also fails, with TimeoutError, where it takes more than LIMIT."""

    def over(*_):
        raise TimeoutError(f"takes more than {LIMIT} s")

    def tested(value):
        signal.signal(signal.SIGALRM, over)
        signal.alarm(LIMIT)
        try:
            holds(value)
        finally:
            signal.alarm(0)

    return tested


def main(seconds=300, *wanted):
    """Give each target its share of the time, in rounds with seeds of their own."""
    warnings.simplefilter("ignore")
    statements.WIDTH = 10**6  # what is longer is divided: the length of a name would leave a trace
    targets = {name: TARGETS[name] for name in wanted or TARGETS}
    rounds = settings(
        max_examples=ROUND, deadline=None, database=None,
        suppress_health_check=list(HealthCheck), phases=[Phase.generate, Phase.shrink],
    )  # fmt: skip
    for name, (holds, inputs) in targets.items():
        end, count = time.monotonic() + float(seconds) / len(targets), 0
        while time.monotonic() < end:
            rounds(given(inputs)(limited(holds)))()
            count += 1
        sys.stdout.write(f"{name}: {count} rounds of up to {ROUND} inputs, none broke it\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main(*sys.argv[1:])
