"""What Petzold's three waters send back, as tables that come with the package."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
Illumination = Literal["flood", "isolated"]

FAINTEST = 1e-300


@dataclass(frozen=True, kw_only=True)
class ResponseTable:
    """One of Petzold's waters, lit in one way; lengths are of half the path in the water.

    Parameters
    ----------
    depth : array (depths,)
        Of the bottom, growing from 0 [m].
    two_way : array (depths,)
        Two-way transmission of light that touched the bottom once [1].
    late_edges : array (late + 1,)
        Of half the path beyond the depth [m].
    late_share : array (depths, late)
        How the bottom's light is spread over them [1].
    column_edges : array (bins + 1,)
        [m].
    column : array (bins,)
        Attenuated backscatter of bottomless water [1/(m sr)].
    """

    depth: FloatArray
    two_way: FloatArray
    late_edges: FloatArray
    late_share: FloatArray
    column_edges: FloatArray
    column: FloatArray

    def two_way_at(self, depth: FloatArray) -> FloatArray:
        """Return the two-way transmission at depths; below the table it goes on as it ends."""
        logarithm = np.log(self.two_way)
        end = (logarithm[-1] - logarithm[-2]) / (self.depth[-1] - self.depth[-2])
        beyond = np.maximum(depth - self.depth[-1], 0.0)
        return np.asarray(np.exp(np.interp(depth, self.depth, logarithm) + end * beyond))

    def late_share_at(self, depth: float) -> FloatArray:
        """Return how the light of a bottom at a depth is spread over ``late_edges`` (late,)."""
        columns = self.late_share.T
        return np.array([np.interp(depth, self.depth, column) for column in columns])

    def column_at(self, depth: FloatArray) -> FloatArray:
        """Return the column's backscatter at depths [1/(m sr)]."""
        middle = 0.5 * (self.column_edges[1:] + self.column_edges[:-1])
        faint = np.log(np.maximum(self.column, FAINTEST))
        return np.asarray(np.exp(np.interp(depth, middle, faint)))


@cache
def response_table(name: str, illumination: Illumination) -> ResponseTable:
    """Return a shipped table of "clear", "coastal" or "harbor" water."""
    shipped = _shipped()
    water = shipped["waters"][name]
    lit = water[illumination]
    late = np.array(lit["late_share"])
    return ResponseTable(
        depth=np.array([0.0, *water["depth_m"]]),
        two_way=np.array([1.0, *lit["two_way"]]),
        late_edges=np.array(shipped["late_edges_m"]),
        late_share=np.vstack([np.eye(1, late.shape[1]), late]),
        column_edges=np.arange(len(lit["column_per_m_sr"]) + 1) * water["column_bin_m"],
        column=np.array(lit["column_per_m_sr"]),
    )


@cache
def _shipped() -> Mapping[str, Any]:
    source = resources.files("survey.optics") / "data" / "response_tables.json"
    found: dict[str, Any] = json.loads(source.read_text(encoding="utf-8"))
    return found
