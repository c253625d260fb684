"""Charts of a run, as PNG and SVG: ``python -m benchmarks.charts`` draws them anew from its JSON.

``draw`` makes those of peers.json, ``draw_accuracy`` that of accuracy.json.

Colours are Okabe and Ito's, told apart by colour-blind eyes too, and every series has a marker of
its own and its name beside it.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator

from benchmarks.figures import slowdown

Record = dict[str, Any]

INK, PALE = "#222222", "#d9d9d9"
#: right edges of the columns of ratios beside a chart, as fractions of its width
RATIOS = (1.12, 1.24)


@dataclass(frozen=True)
class Style:
    """How a series looks, and which contenders it stands for: of several, the fastest."""

    label: str
    color: str
    marker: str
    contenders: tuple[str, ...]
    #: where the colour is too pale for letters
    darker: str = ""

    @property
    def ink(self) -> str:
        """The colour of its name."""
        return self.darker or self.color


MORO = Style("moro", "#0072B2", "o", ("moro", "moro, out="))
BATCH = Style("moro, batch", "#56B4E9", "D", ("moro, batch",), "#2A7FB0")
CASADI = Style(
    "CasADi", "#D55E00", "s",
    ("CasADi", "CasADi, textbook", "CasADi, moro's algorithm", "CasADi, buffers"),
)  # fmt: skip
PINOCCHIO = Style("Pinocchio", "#009E73", "^", ("Pinocchio",))
MUJOCO = Style(
    "MuJoCo",
    "#CC79A7",
    "v",
    ("MuJoCo, mj_rne", "MuJoCo, mj_inverse", "MuJoCo, mj_makeM"),
    "#A8507F",
)
LAMBDIFY = Style("SymPy lambdify", "#E69F00", "P", ("SymPy lambdify",), "#966700")
TOOLBOX = Style("Robotics Toolbox", "#555555", "X", ("Robotics Toolbox",))

STYLES = (BATCH, MORO, CASADI, PINOCCHIO, MUJOCO, LAMBDIFY, TOOLBOX)

ARMS = {
    "two_link": "two links",
    "stanford_arm": "Stanford arm",
    "puma560": "PUMA 560",
    "ur5": "UR5",
    "ur5e": "UR5e",
    "panda": "Panda",
    "seven_axis": "seven axes,\nfull tensors",
}

LOOK = {
    "font.family": "DejaVu Sans",
    "font.size": 9.5,
    "text.color": INK,
    "axes.labelcolor": INK,
    "axes.edgecolor": "#888888",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 11,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "xtick.color": INK,
    "ytick.color": INK,
    "svg.fonttype": "none",
    "svg.hashsalt": "moro",
    "figure.dpi": 100,
}


def draw(results: Record, folder: Path) -> Iterator[Path]:
    """Draw every chart that the run has records for; yield the files written."""
    charts: dict[str, Callable[[Record], Figure | None]] = {
        "time_per_call": time_per_call,
        "functions": functions,
        "from_python": from_python,
        "batch": batch,
        "joints": joints,
        "operations": operations,
        "passes": passes,
    }
    with mpl.rc_context(LOOK):
        for name, chart in charts.items():
            if figure := chart(results):
                yield from _written(figure, folder, name)


def draw_accuracy(results: Record, folder: Path) -> Iterator[Path]:
    """Draw the chart of accuracy; yield the files written."""
    with mpl.rc_context(LOOK):
        yield from _written(accuracy(results), folder, "accuracy")


def _written(figure: Figure, folder: Path, name: str) -> Iterator[Path]:
    for suffix in ("png", "svg"):
        path = folder / f"{name}.{suffix}"
        plain = {"Date": None} if suffix == "svg" else {}
        figure.savefig(path, dpi=160, bbox_inches="tight", metadata=plain)
        yield path


# -- dots: one row for each arm or function, time to the right -------------------------------------


def time_per_call(results: Record) -> Figure | None:
    """One call of tau in C, by arm and library."""
    chosen = [r for r in results["calls"] if r["function"] == "tau" and not r["dependent"]]
    return _dots(
        chosen, "arm", ARMS.get, "Inverse dynamics in C: time for one sample", (CASADI, PINOCCHIO)
    )


def functions(results: Record) -> Figure | None:
    """One call of every function in C, for the Panda."""
    chosen = [r for r in results["calls"] if r["arm"] == "panda" and not r["dependent"]]
    return _dots(
        chosen,
        "function",
        lambda name: name.replace("_", " ").replace(
            "dynamics derivatives", "dynamics\nderivatives"
        ),
        "Functions of the Panda's dynamics in C: time for one sample",
        (CASADI, PINOCCHIO),
    )


def from_python(results: Record) -> Figure | None:
    """One call of tau from Python, by arm and library."""
    return _dots(
        results["python"], "arm", ARMS.get, "Inverse dynamics: one call from Python",
        (CASADI, PINOCCHIO),
    )  # fmt: skip


def _dots(
    records: Sequence[Record],
    row: str,
    label: Callable[[str], str | None],
    title: str,
    compared: Sequence[Style],
) -> Figure | None:
    """Return a chart of dots on a logarithmic scale, with ratios at the right edge."""
    keys = list(dict.fromkeys(r[row] for r in records))
    if not keys:
        return None
    figure = Figure(figsize=(8, 1.3 + 0.42 * len(keys)))
    axes = figure.subplots()
    axes.set_xscale("log")
    beside = axes.get_yaxis_transform()
    for y, key in enumerate(keys):
        of_key = [r for r in records if r[row] == key]
        points = [(style, x) for style in STYLES if (x := _fastest(of_key, style))]
        times = [x for _, x in points]
        axes.plot([min(times), max(times)], [y, y], color=PALE, lw=1.2, zorder=1)
        for style, x in points:
            axes.plot(x, y, style.marker, color=style.color, ms=6.5, mec="white", mew=0.6)
        for k, style in enumerate(compared):
            if ratio := slowdown(of_key, style.label):
                axes.text(
                    RATIOS[k], y, f"{_short(ratio)} ×", transform=beside, color=style.ink,
                    ha="right", va="center",
                )  # fmt: skip
    for k, style in enumerate(compared):
        axes.text(
            RATIOS[k], -0.5, f"{style.label}\n÷ moro", transform=beside, color=style.ink,
            fontsize=8.5, ha="right", va="bottom", linespacing=1.3,
        )  # fmt: skip
    axes.set_yticks(range(len(keys)), [label(key) or key for key in keys])
    axes.set_ylim(len(keys) - 0.5, -0.5)
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
    _nanoseconds(axes.xaxis)
    axes.set_xlabel("nanoseconds, logarithmic: less is better")
    axes.set_title(title, pad=30)
    first = [r for r in records if r[row] == keys[0]]
    _names_above(axes, [(s, x) for s in STYLES if (x := _fastest(first, s))])
    return figure


def _names_above(axes: Axes, points: Sequence[tuple[Style, float]], row: int = 0) -> None:
    """Write the names of the series above the first row, moved apart where they would touch.

    Below any other row.
    """
    points = sorted(points, key=lambda point: point[1])
    to_points = 72 / axes.figure.dpi
    places = [axes.transData.transform((x, row))[0] * to_points for _, x in points]
    widths = [4.9 * len(style.label) + 8 for style, _ in points]
    centers = _apart(places, widths)
    for (style, x), place, center in zip(points, places, centers, strict=True):
        axes.annotate(
            style.label, (x, row), (center - place, -15 if row else 15), ha="center",
            textcoords="offset points", va="top" if row else "bottom", color=style.ink,
            fontsize=8.5, annotation_clip=False,
            arrowprops={"arrowstyle": "-", "color": style.color, "lw": 0.7, "shrinkB": 4,
                        "relpos": (0.5, 1 if row else 0)},
        )  # fmt: skip


def _apart(places: Sequence[float], widths: Sequence[float]) -> list[float]:
    """Return ascending centers, near their places, of things that wide which do not overlap."""
    centers = list(places)
    for _ in range(200):
        for i in range(len(centers) - 1):
            overlap = (widths[i] + widths[i + 1]) / 2 - (centers[i + 1] - centers[i])
            if overlap > 0:
                centers[i] -= overlap / 2
                centers[i + 1] += overlap / 2
    return centers


#: percentiles of errors: shades of one colour, the largest in ink
PERCENTILES = {
    "50 %": Style("half below", MORO.color, "o", ()),
    "90 %": Style("90 %", "#4A9CC9", "D", (), "#2A7FB0"),
    "99 %": Style("99 %", "#8FC1DE", "^", (), "#4587AC"),
    "100 %": Style("largest", INK, "s", ()),
}
#: unit roundoff of each type
ROUNDOFF = {"float64": -53, "float32": -24}


def accuracy(results: Record) -> Figure:
    """Errors of tau by arm, and of sines, in double and in single precision."""
    arms = list(next(iter(results["tau"].values())))
    figure = Figure(figsize=(9, 1.3 + 0.42 * (len(arms) + 1)))
    panels = figure.subplots(1, len(ROUNDOFF), sharey=True)
    for axes, (dtype, power) in zip(panels, ROUNDOFF.items(), strict=True):
        rows = [{k: x / 2.0**power for k, x in results["tau"][dtype][arm].items()} for arm in arms]
        rows.append(results["sines"][dtype])  # in units in the last place already
        axes.set_xscale("log")
        for y, row in enumerate(rows):
            points = [(style, row[k]) for k, style in PERCENTILES.items()]
            axes.plot([points[0][1], points[-1][1]], [y, y], color=PALE, lw=1.2, zorder=1)
            for style, x in points:
                axes.plot(x, y, style.marker, color=style.color, ms=6.5, mec="white", mew=0.6)
        axes.set_yticks(range(len(rows)), [*(ARMS.get(a, a) for a in arms), "sines, cosines"])
        axes.set_ylim(len(rows) - 0.5, -0.5)
        axes.tick_params(axis="y", length=0)
        axes.spines["left"].set_visible(False)
        axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
        axes.xaxis.set_major_locator(LogLocator(subs=(1, 3)))
        axes.xaxis.set_minor_locator(NullLocator())
        axes.set_xlabel(f"error ÷ largest torque, in units of $2^{{{power}}}$\n"
                        "(of sines: in units in the last place)")  # fmt: skip
        axes.set_title(f"Errors of inverse dynamics, {dtype}", pad=30)
        axes.margins(x=0.06)
        axes.autoscale_view(scaley=False)
        _names_above(axes, [(style, rows[0][k]) for k, style in PERCENTILES.items()])
    figure.subplots_adjust(wspace=0.12)
    return figure


# -- lines -----------------------------------------------------------------------------------------


def batch(results: Record) -> Figure | None:
    """Time for each sample by the size of the batch."""
    arms = [a for a in ("ur5", "panda") if any(r["arm"] == a for r in results["batches"])]
    if not arms:
        return None
    figure = Figure(figsize=(4.2 * len(arms) + 0.6, 3.6))
    panels = figure.subplots(1, len(arms), sharey=True, squeeze=False)[0]
    for axes, arm in zip(panels, arms, strict=True):
        chosen = [r for r in results["batches"] if r["arm"] == arm]
        _lines(axes, chosen, "batch", "best", (BATCH, MORO, CASADI, PINOCCHIO, MUJOCO))
        axes.set_title(f"Inverse dynamics of the {ARMS[arm]} in C")
        axes.set_xlabel("samples in a batch")
        axes.set_xticks([1, 4, 16, 64, 256, 1024, 4096])
        axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
        axes.xaxis.set_minor_locator(NullLocator())
        _nanoseconds(axes.yaxis)
    panels[0].set_ylabel("nanoseconds for each sample")
    figure.subplots_adjust(wspace=0.35)
    return figure


def joints(results: Record) -> Figure | None:
    """Time of tau, and of making it, by the number of joints."""
    if not results["growth"] or not results["making"]:
        return None
    figure = Figure(figsize=(9, 3.6))
    calls, making = figure.subplots(1, 2)
    figure.subplots_adjust(wspace=0.6)
    _lines(calls, results["growth"], "dof", "best", (BATCH, MORO, CASADI, PINOCCHIO, MUJOCO))
    _nanoseconds(calls.yaxis)
    calls.set_ylabel("nanoseconds for each sample")
    calls.set_title("Inverse dynamics in C")
    seconds = [{**r, "seconds": r["generate"] + r["compile"]} for r in results["making"]]
    _lines(making, seconds, "dof", "seconds", (MORO, CASADI), log=False)
    making.set_ylim(bottom=0)
    making.set_ylabel("seconds")
    making.set_title("Generating and compiling it")
    for axes in (calls, making):
        axes.set_xlabel("joints (synthetic arms, full tensors)")
    return figure


def _lines(
    axes: Axes,
    records: Sequence[Record],
    x: str,
    y: str,
    series: Iterable[Style],
    *,
    log: bool = True,
) -> None:
    """Draw a line for each series, with its name at its end."""
    if log:
        axes.set_yscale("log")
    if x == "batch":
        axes.set_xscale("log", base=2)
    keys = sorted({r[x] for r in records})
    ends = []
    for style in series:
        points = [(k, _fastest([r for r in records if r[x] == k], style, y)) for k in keys]
        points = [(k, value) for k, value in points if value]
        if points:
            axes.plot(
                *zip(*points, strict=True), marker=style.marker, color=style.color, lw=1.8, ms=5,
                mec="white", mew=0.6,
            )  # fmt: skip
            ends.append((style, points[-1]))
    axes.margins(x=0.03)
    axes.autoscale_view()
    ends.sort(key=lambda end: end[1][1])
    to_points = 72 / axes.figure.dpi
    heights = [axes.transData.transform(end)[1] * to_points for _, end in ends]
    centers = _apart(heights, [11.0] * len(ends))
    for (style, end), height, center in zip(ends, heights, centers, strict=True):
        axes.annotate(
            style.label, end, (7, center - height), textcoords="offset points", va="center",
            color=style.ink, fontsize=8.5, annotation_clip=False,
        )  # fmt: skip
    axes.grid(axis="y", color=PALE, lw=0.6)
    axes.set_axisbelow(True)


# -- bars ------------------------------------------------------------------------------------------


def operations(results: Record) -> Figure | None:
    """Operations of tau by arm."""
    records = results["operations"]
    if not records:
        return None
    figure = Figure(figsize=(8, 1.2 + 0.42 * len(records)))
    axes = figure.subplots()
    shapes = {name: CASADI.color if k else "white" for k, name in enumerate(_graphs(records))}
    for y, r in enumerate(records):
        total = r["add"] + r["mul"]
        axes.barh(y, r["add"], color=MORO.color, height=0.55)
        axes.barh(y, r["mul"], left=r["add"], color=BATCH.color, height=0.55)
        others = r.get("casadi", {})
        for name, count in others.items():
            axes.plot(count, y, CASADI.marker, color=CASADI.color, ms=6, mfc=shapes[name])
        near = [count for count in others.values() if count < total + 50]
        axes.annotate(
            str(total), (max([total, *near]), y), (8 if near else 4, 0), fontweight="bold",
            textcoords="offset points", va="center", color=MORO.color,
        )  # fmt: skip
    last, y = records[-1], len(records) - 1
    for text, x, color in (
        ("additions", last["add"] / 2, "white"),
        ("multiplications", last["add"] + last["mul"] / 2, INK),
    ):
        axes.text(x, y, text, color=color, ha="center", va="center", fontsize=8.5)
    for name, count in last.get("casadi", {}).items():
        axes.annotate(
            name.replace(", ", ",\n"), (count, y), (0, -9), textcoords="offset points",
            color=CASADI.color, ha="center", va="top", fontsize=8.5, annotation_clip=False,
        )  # fmt: skip
    axes.set_yticks(range(len(records)), [ARMS.get(r["arm"], r["arm"]) for r in records])
    axes.set_ylim(len(records) + 0.2, -0.6)
    axes.tick_params(axis="y", length=0)
    axes.set_xlabel("operations of moro's code and CasADi's, sines and cosines apart")
    axes.set_title("Operations of inverse dynamics", pad=10)
    return figure


def _graphs(records: Sequence[Record]) -> list[str]:
    """Return the names of CasADi's graphs, that with the fewest operations first."""
    counts = records[-1].get("casadi", {})
    return sorted(counts, key=counts.__getitem__)


def passes(results: Record) -> Figure | None:
    """Operations of tau as one pass of the generator after the other joins in."""
    records = [r for r in results["passes"] if not r["passes"].startswith("all but")]
    if not records:
        return None
    rows = list(dict.fromkeys(r["passes"] for r in records))
    figure = Figure(figsize=(8, 1.2 + 0.36 * len(rows)))
    axes = figure.subplots()
    arms = dict.fromkeys(r["arm"] for r in records)
    lines = [
        (ARMS.get(arm, arm), [r["operations"] for r in records if r["arm"] == arm], style)
        for arm, style in zip(arms, (MORO, CASADI, PINOCCHIO, MUJOCO, LAMBDIFY), strict=False)
    ]
    for _, counts, style in lines:
        axes.plot(counts, range(len(rows)), marker=style.marker, color=style.color, lw=1.6, ms=5.5,
                  mec="white", mew=0.6)  # fmt: skip
    axes.set_yticks(range(len(rows)), rows)
    axes.set_ylim(len(rows) + 0.1, -0.3)
    axes.set_xlim(left=0)
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
    axes.grid(axis="y", color=PALE, lw=0.6)
    axes.set_axisbelow(True)
    axes.set_xlabel("operations, sines and cosines apart")
    axes.set_title("Operations of inverse dynamics, pass by pass", pad=30)
    _names_above(axes, [(replace(style, label=arm), counts[0]) for arm, counts, style in lines])
    numbers = [(replace(s, label=str(counts[-1])), counts[-1]) for _, counts, s in lines]
    _names_above(axes, numbers, len(rows) - 1)
    return figure


# -- common ----------------------------------------------------------------------------------------


def _fastest(records: Sequence[Record], style: Style, value: str = "best") -> float | None:
    return min((r[value] for r in records if r["contender"] in style.contenders), default=None)


def _nanoseconds(axis: Any) -> None:
    axis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:,.0f}"))
    axis.set_minor_formatter(NullFormatter())
    axis.set_major_locator(LogLocator(subs=(1, 3)))
    axis.set_minor_locator(NullLocator())


def _short(x: float) -> str:
    return f"{x:.0f}" if x >= 10 else f"{x:.1f}"


def main() -> None:
    """Draw the charts of benchmarks/results/peers.json and accuracy.json."""
    folder = Path(__file__).parent / "results"
    for drawn, name in ((draw, "peers"), (draw_accuracy, "accuracy")):
        for path in drawn(json.loads((folder / f"{name}.json").read_text()), folder):
            print(path)


if __name__ == "__main__":
    main()
