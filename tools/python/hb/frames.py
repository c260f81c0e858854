"""Results as pandas DataFrames and xarray Datasets. Imported when asked for: the package itself needs neither."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .errors import refused, require

if TYPE_CHECKING:
    import pandas
    import xarray

    from ._core import Stability
    from .bench import Bench
    from .check import Check
    from .map import Map
    from .steady import Steady
    from .sweep import Sweep

_ROD_TABLES = ("response", "fourier", "deflection", "bending_moment", "exponents")
_POINT_COLUMNS = ("error_bound", "theory_error", "deflection", "bending_moment", "growth_rate", "growth_error", "verdict")


def of_table(table: tuple[list[str], Any]) -> "pandas.DataFrame":
    require("pandas", "to_frame()")
    import pandas

    columns, rows = table
    return pandas.DataFrame(rows, columns=columns)


def of_steady(result: "Steady", what: str) -> "pandas.DataFrame":
    require("pandas", "to_frame()")
    import pandas

    if what not in _ROD_TABLES:
        return of_table(result._answer.table(what))
    return pandas.concat({name: of_table(rod._table(what)) for name, rod in result.rods.items()}, names=["rod", None])


def steady_dataset(result: "Steady") -> "xarray.Dataset":
    require("xarray", "to_xarray()")
    import numpy
    import xarray

    unit = result.scene.units["angle"]
    angle = numpy.linspace(0, 360 if unit == "deg" else 2 * numpy.pi, 361)
    dataset = xarray.Dataset(coords={"crank_angle": ("crank_angle", angle, {"units": unit})})
    for name, rod in result.rods.items():
        modes = f"mode_{name}"
        dataset[f"q_{name}"] = ((modes, "crank_angle"), rod.response(angle))
        dataset = dataset.assign_coords({modes: numpy.arange(1, rod.modes + 1)})
    for name, force in result.joints.items():
        for kind, values in (("elastic", force.elastic(angle)), ("rigid", force.rigid(angle))):
            dims = ("crank_angle",) if values.ndim == 1 else ("direction", "crank_angle")
            dataset[f"{name} {kind}"] = (dims, values)
    if result.torque is not None:
        dataset["torque elastic"] = ("crank_angle", result.torque.elastic(angle))
        dataset["torque rigid"] = ("crank_angle", result.torque.rigid(angle))
    if "direction" in dataset.dims:
        dataset = dataset.assign_coords(direction=["x", "y"])
    dataset.attrs.update(title=result.scene.title, rpm=result.rpm, omega=result.omega, verdict=str(result.verdict))
    return dataset


def of_sweep(result: "Sweep") -> "pandas.DataFrame":
    require("pandas", "to_frame()")
    import pandas

    columns: dict[tuple[str, str], Any] = {}
    for name, rod in result.rods.items():
        for i in range(rod.max_abs.shape[1]):
            columns[name, f"max_abs_{i + 1}"] = rod.max_abs[:, i]
        for key in _POINT_COLUMNS:
            if key in rod._entry:
                columns[name, key] = getattr(rod, key)
    frame = pandas.DataFrame(columns, index=pandas.Index(result.x, name=result.path))
    frame.columns = pandas.MultiIndex.from_tuples(columns, names=["rod", "quantity"])
    return frame


def sweep_dataset(result: "Sweep") -> "xarray.Dataset":
    require("xarray", "to_xarray()")
    import numpy
    import xarray

    rods = result.rods
    modes = max((rod.max_abs.shape[1] for rod in rods.values()), default=0)
    dataset = xarray.Dataset(
        coords={
            "x": ("x", result.x, {"long_name": result.path}),
            "rod": list(rods),
            "mode": numpy.arange(1, modes + 1),
            "rpm": ("x", result.rpm),
            "omega": ("x", result.omega),
        }
    )
    max_abs = numpy.full((len(rods), len(result), modes), numpy.nan)
    for r, rod in enumerate(rods.values()):
        max_abs[r, :, : rod.max_abs.shape[1]] = rod.max_abs
    dataset["max_abs"] = (("rod", "x", "mode"), max_abs)
    for key in _POINT_COLUMNS:
        if all(key in rod._entry for rod in rods.values()):
            dataset[key] = (("rod", "x"), numpy.array([getattr(rod, key) for rod in rods.values()]))
    dataset.attrs["title"] = result.scene.title
    return dataset


def map_dataset(result: "Map") -> "xarray.Dataset":
    require("xarray", "to_xarray()")
    import xarray

    return xarray.Dataset(
        {
            "growth_rate": (("y", "x"), result.growth_rate),
            "growth_error": (("y", "x"), result.growth_error),
            "verdict": (("y", "x"), result.verdict),
        },
        coords={
            "x": ("x", result.x, {"long_name": result.x_path}),
            "y": ("y", result.y, {"long_name": result.y_path}),
        },
        attrs={"title": result.scene.title},
    )


def of_check(result: "Check") -> "pandas.DataFrame":
    require("pandas", "to_frame()")
    import pandas

    document = result.to_dict()
    keys = ("q_difference", "q_allowed", "exponent_difference", "exponent_allowed", "agrees")
    several = isinstance(document["rpm"], list)
    rows = []
    for name, entry in document["rods"].items():
        for k, rpm in enumerate(document["rpm"] if several else [document["rpm"]]):
            rows.append({"rod": name, "rpm": rpm} | {key: entry[key][k] if several else entry[key] for key in keys if key in entry})
    return pandas.DataFrame(rows).set_index(["rod", "rpm"])


def of_stability(stability: "Stability") -> "pandas.DataFrame":
    require("pandas", "to_frame()")
    import pandas

    return pandas.DataFrame(
        {
            "real": stability.exponents.real,
            "imaginary": stability.exponents.imag,
            "error": stability.exponent_errors,
            "frequency [Hz]": stability.frequencies_hz,
            "damping ratio": stability.damping_ratios,
        }
    )


def of_bench(result: "Bench") -> "pandas.DataFrame":
    require("pandas", "to_frame()")
    import pandas

    rows = [{"rod": name} | row for name, rod in result.rods.items() for row in rod.rows]
    columns = ["rod", "method", "asked", "harmonics_or_steps", "error", "seconds", "seconds_median"]
    return pandas.DataFrame(rows, columns=columns)


def require_kind(kind: str, allowed: tuple[str, ...]) -> None:
    if kind not in allowed:
        raise refused("kind", kind, ", ".join(allowed))
