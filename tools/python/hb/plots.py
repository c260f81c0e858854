"""Pictures by matplotlib, with the colours and words of the command's. Imported when asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

from .errors import require
from .frames import require_kind

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ._core import Rod, Stability
    from .bench import Bench
    from .check import Check
    from .map import Map
    from .scene import Scene
    from .steady import Steady
    from .sweep import Sweep, SweepRod
    from .tune import Tune

require("matplotlib", "plot()")

LINES = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
UNSTABLE = "#d55e00"  # shaded bands
ELASTIC, RIGID_LINK = "#b03060", "#333333"
BOUNDED, UNDECIDED, MISSING = "#beaed4", "#c6c6c6", "#8a8a8a"
BOUNDARIES = {  # kind: colour, words
    "-1": ("#000000", "boundary −1: period doubling"),
    "+1": ("#00735a", "boundary +1: once per turn"),
    "complex": ("#7b3294", "boundary, complex pair"),
}
_GROWTH = ((0, "#2166ac"), (0.25, "#67a9cf"), (0.44, "#d1e5f0"), (0.5, "#f7f7f7"), (0.56, "#fddbc7"), (0.75, "#ef8a62"), (1, "#b2182b"))
_MODES = ((0, "#08306b"), (0.25, "#08519c"), (0.4, "#2b8cbe"), (0.49, "#7bccc4"), (0.5, "#999999"), (0.51, "#fc8d59"), (1, "#99000d"))
_SHOWN = 6  # curves at most
_VERDICTS = {"unstable": "UNSTABLE: would not be seen in a machine", "undecided": "stability undecided"}


def _axes(ax: Optional["Axes"], width: float = 8.0, height: float = 4.6) -> "Axes":
    if ax is not None:
        return ax
    import matplotlib.pyplot as plt

    return plt.figure(figsize=(width, height), layout="constrained").add_subplot()


def _title(ax: "Axes", bold: str, shown: str) -> None:
    ax.set_title(f"{bold}\n{shown}", fontsize=10, loc="left")


def _name(scene: "Scene") -> str:
    return scene.title or scene.name


def _unit(columns: list[str], begin: str) -> str:
    """" [mm]" of the first column that begins so."""
    for column in columns:
        if column.startswith(begin) and "[" in column:
            return " " + column[column.index("[") :]
    return ""


def _legend(ax: "Axes", **more: Any) -> None:
    ax.legend(fontsize=8, frameon=False, **more)


# One speed.

_OF_EXPONENTS = "Floquet exponents; right of the line disturbances grow"


def _exponents(ax: "Axes", real: Any, imaginary: Any, errors: Any) -> None:
    ax.errorbar(real, imaginary, xerr=errors, fmt="o", color=LINES[0], markersize=4)
    ax.axvline(0, color="#000000", linewidth=0.8)


def stability(stability: "Stability", ax: Optional["Axes"] = None) -> "Axes":
    ax = _axes(ax)
    _exponents(ax, stability.exponents.real, stability.exponents.imag, stability.exponent_errors)
    ax.set(xlabel="real part, per unit time", ylabel="imaginary part, folded")
    _title(ax, _VERDICTS.get(stability.verdict, stability.verdict), _OF_EXPONENTS)
    return ax


def rod(rod: "Rod", kind: str = "response", ax: Optional["Axes"] = None) -> "Axes":
    import numpy as np

    require_kind(kind, ("response", "spectrum", "phase", "deflection", "bending_moment", "exponents"))
    table = {"spectrum": "fourier", "phase": "response"}.get(kind, kind)
    columns, rows = rod._table(table)
    ax = _axes(ax)
    verdict = "" if rod.verdict is None else ", " + _VERDICTS.get(rod.verdict, rod.verdict)
    bold = rod.name + verdict
    shown = min(rod.modes, _SHOWN)
    if kind == "response":
        for i in range(shown):
            ax.plot(rows[:, 0], rows[:, 1 + i], color=LINES[i % 7], label=f"$q_{{{i + 1}}}$")
        ax.set(xlabel=columns[0], ylabel=f"$q_i${_unit(columns, 'q_1')}", xlim=(0, 360), xticks=range(0, 361, 60))
        _title(ax, bold, "periodic response")
        _legend(ax)
    elif kind == "phase":
        for i in range(shown):
            ax.plot(rows[:, 1 + i], rows[:, 1 + rod.modes + i], color=LINES[i % 7], label=f"$q_{{{i + 1}}}$")
            ax.plot(rows[0, 1 + i], rows[0, 1 + rod.modes + i], "o", color=LINES[i % 7], markersize=4)
        ax.set(xlabel=f"$q_i${_unit(columns, 'q_1')}", ylabel=f"$dq_i/dt${_unit(columns, 'dq_1')}")
        _title(ax, bold, "phase trajectories; dot: angle 0")
        _legend(ax)
    elif kind == "spectrum":
        for i in range(shown):
            amplitude = rows[:, 3 + 3 * i]
            ax.semilogy(rows[:, 0], np.where(amplitude > 0, amplitude, np.nan), ".-", color=LINES[i % 7], label=f"$q_{{{i + 1}}}$")
        ax.set(xlabel="harmonic n", ylabel=f"amplitude $|c_0|$, $2|c_n|${_unit(columns, 're of q_1')}")
        _title(ax, bold, "spectrum")
        _legend(ax)
    elif kind == "exponents":
        _exponents(ax, rows[:, 0], rows[:, 1], rows[:, 2])
        ax.set(xlabel=columns[0], ylabel=columns[1])
        _title(ax, bold, _OF_EXPONENTS)
    else:
        from matplotlib.colors import hsv_to_rgb

        ax.fill_between(rows[:, 0], rows[:, 1], rows[:, 2], color="#e8e8e8", linewidth=0, label="whole turn")
        angles = rows.shape[1] - 3
        for k in range(angles):
            ax.plot(rows[:, 0], rows[:, 3 + k], color=hsv_to_rgb((k / angles, 0.9, 0.75)), label=f"{360 * k // angles} deg")
        what = "deflection w, to the left positive" if kind == "deflection" else "bending moment M = EJ ∂²w/∂x²"
        ax.set(xlabel="x from joint 0 to joint 1" + _unit(columns, "x"), ylabel=what + _unit(columns[1:], ""))
        _title(ax, bold, f"{kind.replace('_', ' ')} over the turn")
        _legend(ax, title="crank angle", loc="center left", bbox_to_anchor=(1, 0.5))
    return ax


def steady(result: "Steady", name: Optional[str], kind: str, ax: Optional["Axes"]) -> "Axes":
    at = f"{_name(result.scene)}, {result.rpm:.10g} rpm"
    if kind == "torque":
        columns, rows = result._answer.table("torque")
        ax = _axes(ax)
        ax.plot(rows[:, 0], rows[:, 1], color=LINES[0], label="elastic")
        ax.plot(rows[:, 0], rows[:, 2], "--", color=LINES[1], label="rigid")
        ax.set(xlabel=columns[0], ylabel="driving torque" + _unit(columns[1:], ""), xlim=(0, 360), xticks=range(0, 361, 60))
        _title(ax, at, "driving torque")
        _legend(ax)
        return ax
    chosen = result[name if name is not None else next(iter(result))]
    ax = rod(chosen, kind, ax)
    bold, _, shown = ax.get_title(loc="left").partition("\n")
    _title(ax, f"{at}, {bold}", shown)
    return ax


# Along an axis.


def _points(rod: "SweepRod") -> tuple[list[str], Any, dict[str, int]]:
    core = rod._sweep._core
    columns, rows = core.rod_table(rod.name)
    return columns, rows, core.columns(rod.name)


def _shade(ax: "Axes", rod: "SweepRod") -> str:
    for low, high in rod.unstable_bands or []:
        ax.axvspan(low, high, color=UNSTABLE, alpha=0.18, linewidth=0)
    return "; shaded: unstable" if rod.unstable_bands else ""


def _beyond(rows: Any, at: dict[str, int]) -> Any:
    import numpy as np

    return rows[:, at["beyond"] - 1] > 0 if at["beyond"] else np.zeros(len(rows), dtype=bool)


def _curve(ax: "Axes", x: Any, y: Any, beyond: Any, **style: Any) -> None:
    """Grey and dashed where the answer is beyond the linear theory."""
    import numpy as np

    if beyond.any():
        ax.plot(x, y, "--", color="#999999", linewidth=1)
    ax.plot(x, np.where(beyond, np.nan, y), **style)


def sweep_rod(rod: "SweepRod", kind: str = "campbell", ax: Optional["Axes"] = None) -> "Axes":
    require_kind(kind, ("campbell", "growth", "peaks", "deflection", "branches"))
    ax = _axes(ax)
    if kind == "branches":
        return _branches(ax, rod)
    columns, rows, at = _points(rod)
    beyond = _beyond(rows, at)
    {"campbell": _campbell, "growth": _growth, "peaks": _peaks, "deflection": _largest}[kind](ax, rod, columns, rows, at, beyond)
    x = rod._sweep.x
    ax.set(xlabel=rod._sweep._core.axis_label(), xlim=(x[0], x[-1]))
    if beyond.any():
        bold, _, shown = ax.get_title(loc="left").partition("\n")
        _title(ax, bold, shown + "; grey, dashed: beyond the linear theory")
    return ax


def _require(at: dict[str, int], column: str, only: str) -> None:
    if not at[column]:
        from .errors import refused

        raise refused("kind", f"a sweep without {only}", f'only="{only}" among what is computed')


def _campbell(ax: "Axes", rod: "SweepRod", columns: list[str], rows: Any, at: dict[str, int], beyond: Any) -> None:
    import numpy as np
    from matplotlib.collections import LineCollection
    from matplotlib.colors import LinearSegmentedColormap, Normalize

    _require(at, "first_frequency", "stability")
    sweep = rod._sweep
    note = _shade(ax, rod)
    x = rows[:, 0]
    seconds = sweep.to_dict()["units"]["time"]
    per_second = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0}[seconds]
    order = np.sort(sweep.x)[[0, -1]]
    turns = np.array([sweep.omega.min(), sweep.omega.max()]) / (2 * np.pi * per_second)
    modes = min(rod.modes, _SHOWN)
    first = at["first_frequency"] - 1
    frequency = rows[:, first : first + 2 * rod.modes : 2]
    growth = rows[:, first + 1 : first + 1 + 2 * rod.modes : 2]
    top = max([2 * turns[1]] + [1.15 * np.nanmax(frequency[:, i]) for i in range(min(rod.modes, 2)) if np.isfinite(frequency[:, i]).any()])
    most = min(24, int(np.ceil(top / turns[1])) + 12)
    for half in range(1, 2 * most + 1):
        if (half % 2 and half > 12) or half / 2 * turns[0] > top:
            continue
        whole = half % 2 == 0
        ax.plot(order, half / 2 * turns, color="#b0b0b0" if whole else "#c8c8c8", linewidth=0.9 if whole else 0.6, linestyle="-" if whole else (0, (5, 5)))
        if not whole:
            continue
        label = "Ω" if half == 2 else f"{half // 2}Ω"
        if half / 2 * turns[1] <= top:
            ax.annotate(label, (order[1], half / 2 * turns[1]), xytext=(3, 0), textcoords="offset points", fontsize=8, color="#777777", va="center")
        elif turns[1] > turns[0]:
            share = (top / (half / 2) - turns[0]) / (turns[1] - turns[0])
            if half // 2 <= 12:
                ax.annotate(label, (order[0] + share * (order[1] - order[0]), top), xytext=(0, -3), textcoords="offset points", fontsize=8, color="#777777", ha="center", va="top")
    for i in range(min(modes, 3)):
        for j in range(i + 1, min(modes, 3)):
            for sign in (1, -1):
                ax.plot(x, np.abs(frequency[:, j] + sign * frequency[:, i]) / 2, ":", color="#56b4e9", linewidth=0.8)
    leading = rows[:, at["growth"] - 1]
    scale = max(4 * abs(np.nanmedian(leading)), 1e-300)
    palette = LinearSegmentedColormap.from_list("growth of a mode", _MODES)
    speed = np.interp(x, order, turns)
    lines = None
    for i in range(modes):
        y = frequency[:, i].copy()
        jumps = np.abs(np.diff(y, prepend=y[0])) > 0.25 * speed  # a frequency is known up to half the speed
        y[jumps] = np.nan
        if beyond.any():
            ax.plot(x, y, "--", color="#999999", linewidth=2)
            y[beyond] = np.nan
        pieces = np.stack([np.column_stack([x[:-1], y[:-1]]), np.column_stack([x[1:], y[1:]])], axis=1)
        lines = LineCollection(pieces, cmap=palette, norm=Normalize(-scale, scale), linewidth=2.5)
        lines.set_array(np.clip(growth[1:, i], -scale, scale))
        ax.add_collection(lines)
        inside = np.flatnonzero(frequency[:, i] <= 0.97 * top)
        if len(inside):
            ax.annotate(f"mode {i + 1}", (x[inside[0]], frequency[inside[0], i]), xytext=(4, 4), textcoords="offset points", fontsize=8)
    if lines is not None:
        unit = columns[at["growth"] - 1]
        ax.figure.colorbar(lines, ax=ax, label="growth rate of the mode" + (" " + unit[unit.index("[") :] if "[" in unit else ""))
    peaks = [p for p in sweep.critical if p["rod"] == rod.name and "frequency" in p and p["mode"] > 0]
    ax.plot([p["x"] for p in peaks], [p["frequency"] / (2 * np.pi * per_second) for p in peaks], "o", color="#000000", markersize=3)
    ax.set(ylim=(0, top), ylabel="frequency [Hz]")
    dotted = ", dotted: $(ω_i ± ω_j)/2$" if modes > 1 else ""
    _title(ax, _subject(rod), f"Campbell diagram; grey: nΩ, dashed: kΩ/2{dotted}\ndots: resonance peaks{note}")


def _subject(rod: "SweepRod") -> str:
    name = _name(rod._sweep.scene)
    return name if rod.name == "system" else f"{name}, {rod.name}"


def _growth(ax: "Axes", rod: "SweepRod", columns: list[str], rows: Any, at: dict[str, int], beyond: Any) -> None:
    import numpy as np

    _require(at, "growth", "stability")
    note = _shade(ax, rod)
    leading = rows[:, at["growth"] - 1]
    ax.plot(rows[:, 0], leading, color="#bbbbbb", linewidth=5, label="leading")
    for i in range(min(rod.modes, _SHOWN)):
        _curve(ax, rows[:, 0], rows[:, at["first_frequency"] + 2 * i], beyond, color=LINES[i % 7], linewidth=1.4, label=f"mode {i + 1}")
    ax.axhline(0, color="#000000", linewidth=0.8)
    low, high = np.nanmin(leading), max(np.nanmax(leading), 0.0)
    span = max(high - low, 1e-300)
    ax.set(ylim=(low - 0.35 * span, high + 0.1 * span), ylabel=columns[at["growth"] - 1])
    _title(ax, _subject(rod), "growth rate of disturbances: below zero they die out" + note)
    _legend(ax, loc="center left", bbox_to_anchor=(1, 0.5))


def _stable_range(ax: "Axes", values: Any, rows: Any, at: dict[str, int]) -> None:
    """What is seen where the motion is stable fills the picture: peaks of unstable motions would hide it."""
    import numpy as np

    if at["growth"]:
        stable = rows[:, at["growth"] + 1] < 0  # the verdict as a number
        values = values[stable] if stable.any() else values
    values = values[np.isfinite(values) & (values > 0)]
    if len(values):
        ax.set_ylim(max(values.min(), 1e-12 * values.max()) / 2, 10 * values.max())


def _peaks(ax: "Axes", rod: "SweepRod", columns: list[str], rows: Any, at: dict[str, int], beyond: Any) -> None:
    _require(at, "first_peak", "steady")
    note = _shade(ax, rod)
    first = at["first_peak"] - 1
    for i in range(min(rod.modes, _SHOWN)):
        y = rows[:, first + i]
        _curve(ax, rows[:, 0], y, beyond, color=LINES[i % 7], label=f"$q_{{{i + 1}}}$")
    ax.set(yscale="log", ylabel="largest $|q_i|$" + _unit(columns[first:], "max"))
    _stable_range(ax, rows[:, first : first + min(rod.modes, _SHOWN)], rows, at)
    meaning = "$q_i$: unknowns of the system" if rod.name == "system" else "$q_i$: amplitude of sin(iπx/l)"
    _title(ax, _subject(rod), f"{meaning}, largest over the turn{note}")
    _legend(ax, loc="center left", bbox_to_anchor=(1, 0.5))


def _largest(ax: "Axes", rod: "SweepRod", columns: list[str], rows: Any, at: dict[str, int], beyond: Any) -> None:
    _require(at, "deflection", "shape")
    note = _shade(ax, rod)
    _curve(ax, rows[:, 0], rows[:, at["deflection"] - 1], beyond, color=LINES[0])
    ax.set(yscale="log", ylabel=columns[at["deflection"] - 1])
    _stable_range(ax, rows[:, at["deflection"] - 1 : at["deflection"]], rows, at)
    _title(ax, _subject(rod), "largest deflection over rod and turn" + note)


def _branches(ax: "Axes", rod: "SweepRod") -> "Axes":
    """Solid where stable, dashed where not, over the linear response; folds black, bifurcations red."""
    import numpy as np

    sweep = rod._sweep
    if not sweep.branches:
        from .errors import refused

        raise refused("kind", "a sweep of the linear theory", 'branches of theory="nonlinear"')
    along = sweep.path if sweep.path in ("rpm", "omega") else "x"
    if rod.max_abs.shape[1]:
        ax.plot(sweep.x, np.nanmax(rod.max_abs, axis=1), color="#bbbbbb", linewidth=1, label="linear theory")
    for k, branch in enumerate(sweep.branches):
        x = np.array(branch[along])
        y = np.array([max(values) for values in branch["rods"][rod.name]["max_abs"]])
        verdicts = np.array(branch.get("verdict", ["stable"] * len(x)), dtype=object)
        stable = np.isin(verdicts, ("stable", "bounded"))
        colour = LINES[k % 7]
        ax.plot(x, np.where(stable, y, np.nan), color=colour)
        ax.plot(x, np.where(stable & np.roll(stable, 1) & np.roll(stable, -1), np.nan, y), "--", color=colour, linewidth=1)
    ax.set(xlabel=sweep._core.axis_label(), ylabel="largest $|q_i|$", yscale="log")
    _title(ax, _subject(rod), "motion without linearisation: solid stable, dashed not")
    _legend(ax)
    return ax


def sweep(result: "Sweep", kind: str, name: Optional[str], ax: Optional["Axes"]) -> "Axes":
    return sweep_rod(result[name if name is not None else next(iter(result))], kind, ax)


# Over two numbers.


def map(result: "Map", ax: Optional["Axes"] = None) -> "Axes":
    import numpy as np
    from matplotlib.colors import ListedColormap, LinearSegmentedColormap
    from matplotlib.patches import Patch

    ax = _axes(ax, 9.0, 6.4)
    growth = result.growth_rate
    sizes = np.sort(np.abs(growth[np.isfinite(growth)]))
    largest = sizes[-1] if len(sizes) and sizes[-1] > 0 else 1.0
    seen = sizes[sizes > 1e-6 * largest]
    scale = seen[len(seen) // 2] if len(seen) else largest
    limit = np.arcsinh(largest / scale)
    x, y = result.x, result.y

    def cells(values: Any) -> Any:
        middle = (values[1:] + values[:-1]) / 2
        return np.concatenate([[values[0]], middle, [values[-1]]])

    ax.set_facecolor(MISSING)
    palette = LinearSegmentedColormap.from_list("growth", _GROWTH)
    shown = ax.pcolormesh(cells(x), cells(y), np.arcsinh(growth / scale), cmap=palette, vmin=-limit, vmax=limit, rasterized=True)
    handles: list[Any] = []
    for verdict, colour, words in (("bounded", BOUNDED, "bounded: no damping"), ("undecided", UNDECIDED, "undecided")):
        where = result.verdict == verdict
        if where.any():
            ax.pcolormesh(cells(x), cells(y), np.where(where, 1.0, np.nan), cmap=ListedColormap([colour]), rasterized=True)
            handles.append(Patch(color=colour, label=words))
    if not np.isfinite(growth).all():
        handles.append(Patch(color=MISSING, label="no system: the linkage does not turn through"))
    for line in result.to_dict()["resonance_lines"]:
        for piece in line["pieces"]:
            points = np.array(piece)
            ax.plot(points[:, 0], points[:, 1], color="#444444", linewidth=0.8, linestyle=(0, (6, 6)))
    labelled = set()
    for boundary in result.boundaries:
        colour, words = BOUNDARIES[boundary.kind]
        (drawn,) = ax.plot(boundary.points[:, 0], boundary.points[:, 1], color=colour, linewidth=2, label=words)
        if boundary.kind not in labelled:
            handles.append(drawn)
        labelled.add(boundary.kind)
    sample = result.theory_sample or []
    beyond = [place for place in sample if place["beyond"]]
    for places, mark, words in ((beyond, "x", "beyond"), ([place for place in sample if not place["beyond"]], "o", "within")):
        if places:
            at = [place["x"] for place in places], [place["y"] for place in places]
            style: dict[str, Any] = {"markersize": 5, "markerfacecolor": "none", "linestyle": "none", "clip_on": False}
            handles += ax.plot(*at, mark, color="#000000", label=f"{words} the linear theory", **style)
    bar = ax.figure.colorbar(shown, ax=ax, label=f"growth rate [1/{result.scene.units['time']}]")
    ticks = [v for e in range(int(np.floor(np.log10(scale))), int(np.floor(np.log10(largest))) + 1) for v in (10.0**e,) if 0.4 * scale <= v <= largest]
    places = [-np.arcsinh(v / scale) for v in reversed(ticks)] + [0.0] + [np.arcsinh(v / scale) for v in ticks]
    bar.set_ticks(places, labels=[f"−{v:g}" for v in reversed(ticks)] + ["0"] + [f"{v:g}" for v in ticks])

    def label(path: str) -> str:
        return {"rpm": "speed [rpm]", "omega": f"speed [rad/{result.scene.units['time']}]"}.get(path, path)

    ax.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]), xlabel=label(result.x_path), ylabel=label(result.y_path))
    rods = list(result.rods)
    of = "" if rods == ["system"] else ", " + ", ".join(rods) + (" (the worst)" if len(rods) > 1 else "")
    what = "stability of the steady motion" if rods == ["system"] else "stability by the linear theory"
    more = f"; beyond it at {len(beyond)} of {len(sample)} points looked at" if beyond else ""
    _title(ax, _name(result.scene), what + of + more)
    if handles:
        ax.legend(handles=handles, fontsize=8, frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.12), ncol=2)
    return ax


# The rest.


def check(result: "Check", ax: Optional["Axes"] = None) -> "Axes":
    frame = result.to_frame()
    ax = _axes(ax)
    for r, name in enumerate(result):
        rows = frame.loc[name]
        ax.semilogy(rows.index, rows["q_difference"].astype(float), ".-", color=LINES[r % 7], label=name)
        ax.semilogy(rows.index, rows["q_allowed"].astype(float), "--" if len(rows) > 1 else "_", color=LINES[r % 7], label=f"{name} allowed")
    ax.set(xlabel="crank speed [rpm]", ylabel="|difference of q| / max |q|")
    _title(ax, _name(result.scene), "harmonic balance against time integration")
    _legend(ax)
    return ax


def bench(result: "Bench", rod: Optional[str], ax: Optional["Axes"] = None) -> "Axes":
    import numpy as np

    name = next(iter(result)) if rod is None else rod
    entry = result[name]
    ax = _axes(ax)
    methods: dict[str, list[tuple[float, float]]] = {}
    for row in entry.rows:
        error = np.nan if row["error"] is None else max(row["error"], 1e-16)
        methods.setdefault(row["method"], []).append((row["seconds"], error))
    for k, (method, points) in enumerate(methods.items()):
        ax.loglog(*np.array(points).T, ".-", color=LINES[k] if k < 7 else "#888888", label=method)
    ax.axhline(max(entry.reference_error, 1e-16), color="#888888", linestyle="--", label="error of the reference")
    ax.set(xlabel="time of one solution [s]", ylabel="max |error of q| / max |q|", ylim=(1e-16, 10))
    _title(ax, _name(result.scene), f"{name}: error against run time")
    _legend(ax, loc="center left", bbox_to_anchor=(1, 0.5))
    return ax


def tune(result: "Tune", ax: Optional["Axes"] = None) -> "Axes":
    import numpy as np

    frame = result.to_frame()
    ax = _axes(ax)
    goal = frame["goal"].to_numpy()
    excess = [column for column in frame.columns if column.startswith("excess of")]
    met = (frame[excess].to_numpy() <= 0).all(axis=1) if excess else np.isfinite(goal)
    number = np.arange(1, len(goal) + 1)
    ax.plot(number[~met], goal[~met], "x", color=LINES[1], label="conditions not met")
    ax.plot(number[met], goal[met], "o", color=LINES[0], label="conditions met", markersize=4)
    unit = result.goal["unit"]
    ax.set(xlabel="designs tried", ylabel="goal" + (f" [{unit}]" if unit else ""))
    _title(ax, _name(result.before), f"{result.status}; {', '.join(f'{k} = {v:.5g}' for k, v in result.values.items())}")
    _legend(ax)
    return ax


def scene(scene: "Scene", ax: Optional["Axes"] = None) -> "Axes":
    import numpy as np

    table = scene._core.mechanism()
    if table is None:
        from .errors import refused

        raise refused("plot", "a [hill] scene", "a mechanism")
    columns, rows = table
    ax = _axes(ax, 8.0, 5.6)
    # Columns "NAME x [unit]", "NAME y [unit]"; names begin with the body.
    points = [columns[k].rpartition(" x")[0] for k in range(1, len(columns), 2)]
    xy = rows[:, 1:].reshape(len(rows), len(points), 2)
    strokes = []
    for k, name in enumerate(points):
        same = [m for m in range(k) if points[m].rsplit(".", 1)[0] == name.rsplit(".", 1)[0]]
        strokes += [(m, k, name.rsplit(".", 1)[0]) for m in same[:2]]
    for pose in range(0, len(rows) - 1, max(1, (len(rows) - 1) // 12)):
        for a, b, _ in strokes:
            ax.plot(*xy[pose, [a, b]].T, color="#c4ccd4", linewidth=0.7)
    drawn: list[Any] = []
    for k, name in enumerate(points):
        if np.ptp(xy[:, k], axis=0).max() == 0 or any(np.abs(xy[:, k] - xy[:, m]).max() <= 1e-9 * np.ptp(xy) for m in drawn):
            continue
        ax.plot(*xy[:, k].T, color=LINES[len(drawn) % 7], linewidth=1.2, label=name)
        drawn.append(k)
    elastic = set(scene.rods)
    for a, b, body in strokes:
        ax.plot(*xy[0, [a, b]].T, color=ELASTIC if body in elastic else RIGID_LINK, linewidth=2 if body in elastic else 3)
    ax.plot(*xy[0].T, "o", color="#222222", markersize=3)
    length = scene.units["length"]
    ax.set(xlabel=f"x [{length}]", ylabel=f"y [{length}]", aspect="equal")
    _title(ax, _name(scene), "crank angle 0 dark, every 30 deg light; paths of the joints; red: elastic")
    _legend(ax, loc="center left", bbox_to_anchor=(1, 0.5))
    return ax
