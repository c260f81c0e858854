"""What results of long work share: the command's document, and the means to make the rest anew."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Optional, Sequence

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .scene import Scene


class Result:
    """Numbers are those of the command's document. After unpickling the compiled half is computed anew when asked for."""

    def __init__(self, scene: "Scene", arguments: dict[str, Any], core: Any) -> None:
        self._scene = scene
        self._arguments = arguments
        self._handle = core
        self._text: str = core.json()
        self._document: dict[str, Any] = json.loads(self._text)

    @property
    def scene(self) -> "Scene":
        """The scene that was asked."""
        return self._scene

    def _computed(self) -> Any:
        raise NotImplementedError

    @property
    def _core(self) -> Any:
        if self._handle is None:
            self._handle = self._computed()
        return self._handle

    @property
    def title(self) -> str:
        """The scene's title."""
        return str(self._document.get("title", ""))

    @property
    def units(self) -> dict[str, Any]:
        """The scene's units, and what its units of force and torque are in N and N m."""
        return dict(self._document.get("units", {}))

    @property
    def notes(self) -> list[str]:
        """What missed its tolerance, and what is known less well than usual."""
        return list(self._document.get("notes", []))

    @property
    def tolerance(self) -> Optional[float]:
        """The relative error asked for; None where the document does not say."""
        return self._document.get("tolerance")

    @property
    def warnings(self) -> list[str]:
        """What is odd, and where an answer is beyond the linear theory."""
        return list(self._document.get("warnings", []))

    @property
    def shortfalls(self) -> list[str]:
        """One sentence for each thing that missed its tolerance."""
        return list(self._document.get("notes", []))

    @property
    def converged(self) -> bool:
        """Whether everything reached the tolerance asked for."""
        return not self.shortfalls

    def to_dict(self) -> dict[str, Any]:
        """The document that the command prints with --json."""
        document: dict[str, Any] = json.loads(self._text)
        return document

    def __str__(self) -> str:
        words: str = self._core.words()
        return words

    def _repr_html_(self) -> str:
        from .reports import preformatted

        return preformatted(str(self))

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_handle": None}


def floats(values: Sequence[Any]) -> "NDArray[Any]":
    """Numbers as a read-only array; None becomes NaN."""
    import numpy

    array = numpy.array(values, dtype=float)
    array.flags.writeable = False
    return array


def words(values: Sequence[Any]) -> "NDArray[Any]":
    """Texts as a read-only array of objects; None stays."""
    import numpy

    array = numpy.array(values, dtype=object)
    array.flags.writeable = False
    return array


def padded(rows: Sequence[Optional[Sequence[Any]]], complex_pairs: bool = False) -> "NDArray[Any]":
    """Rows of different length as a read-only array; what is missing becomes NaN."""
    import numpy

    width = max((len(row) for row in rows if row), default=0)
    array = numpy.full((len(rows), width), numpy.nan, dtype=complex if complex_pairs else float)
    for k, row in enumerate(rows):
        for i, value in enumerate(row or ()):
            array[k, i] = complex(*value) if complex_pairs else numpy.nan if value is None else value
    array.flags.writeable = False
    return array
