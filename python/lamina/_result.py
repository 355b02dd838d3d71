# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""What calls return: small values that know their units, plot themselves, and become dicts."""

from __future__ import annotations

import copy
import dataclasses
import html
import io
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes


Self = TypeVar("Self", bound="Result")


def quantity(
    doc: str,
    *,
    unit: str = "1",
    axes: tuple[str, ...] = (),
    shared: bool = False,
    optional: bool = False,
) -> Any:
    """A field of a result.

    :param axes: what the array has after the axes of the layers.
    :param shared: the same for all layers: it has the axes named and no others.
    :param optional: None where the method does not say it.
    """
    metadata = {"doc": doc, "unit": unit, "axes": axes, "shared": shared}
    if optional:
        return dataclasses.field(default=None, metadata=metadata)
    return dataclasses.field(metadata=metadata)


def setting(doc: str) -> Any:
    """A field that is no number: how the result came about."""
    return dataclasses.field(metadata={"doc": doc})


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Result:
    """Base of all results: frozen; copies, pickles, and becomes a dict or an xarray dataset."""

    axes: tuple[str, ...] = setting("names of the leading axes of every array")
    coords: dict[str, Any] = setting("values along these axes and others, as wavelengths [nm]")

    def __init_subclass__(cls) -> None:
        lines = []
        for name, value in vars(cls).items():
            if isinstance(value, dataclasses.Field) and "doc" in value.metadata:
                unit = value.metadata.get("unit", "")
                axes = value.metadata.get("axes", ())
                tail = f" [{unit}]" if unit not in ("", "1") else ""
                before = () if value.metadata.get("shared") else ("...",)
                shape = f", axes ({', '.join(before + axes)})" if axes else ""
                lines.append(f"    {name}: {value.metadata['doc']}{tail}{shape}")
        if lines:
            cls.__doc__ = (cls.__doc__ or "") + "\n\nAttributes:\n" + "\n".join(lines) + "\n"

    @classmethod
    def units(cls) -> dict[str, str]:
        """The unit of every quantity, "1" without one."""
        return {f.name: f.metadata["unit"] for f in dataclasses.fields(cls) if "unit" in f.metadata}

    def to_dict(self) -> dict[str, Any]:
        """All fields by name; arrays are not copied."""
        names = (f.name for f in dataclasses.fields(self))
        return {name: getattr(self, name) for name in names if not name.startswith("_")}

    def __copy__(self: Self) -> Self:
        return dataclasses.replace(self)

    def __deepcopy__(self: Self, memo: dict[int, Any]) -> Self:
        # What is the library's cannot change, so that copies may have it in common.
        given = {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}
        return type(self)(**{
            name: value if name.startswith("_") else copy.deepcopy(value, memo) for name, value in given.items()})

    def to_xarray(self) -> Any:
        """An xarray.Dataset with units, axes and coordinates.

        :raises ImportError: without xarray.
        """
        import xarray

        variables: dict[str, Any] = {}
        attributes: dict[str, Any] = {}
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if "unit" not in field.metadata:
                if isinstance(value, (str, float, int, bool)):
                    attributes[field.name] = value
                continue
            if not isinstance(value, np.ndarray) or field.name in self.coords:
                continue
            dims = field.metadata["axes"] if field.metadata["shared"] else self.axes + field.metadata["axes"]
            variables[field.name] = (
                dims,
                value,
                {"units": field.metadata["unit"], "long_name": field.metadata["doc"]},
            )
        return xarray.Dataset(variables, coords=self.coords, attrs=attributes)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draws what there is to see into `ax`, or a new figure.

        :raises ImportError: without matplotlib.
        """
        if ax is None:
            from matplotlib.figure import Figure

            figure = Figure(figsize=(6.4, 4.0), layout="constrained")
            ax = figure.add_subplot()
        self._draw(ax)
        return ax

    def _draw(self, ax: Axes) -> None:
        raise NotImplementedError(f"{type(self).__name__} has no plot")

    def _repr_png_(self) -> bytes | None:
        if type(self)._draw is Result._draw:
            return None
        try:
            figure = self.plot().figure
        except ImportError:
            return None
        bytes_ = io.BytesIO()
        figure.savefig(bytes_, format="png", dpi=110)
        return bytes_.getvalue()

    def _repr_html_(self) -> str:
        rows = []
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if value is None or field.name in ("axes", "coords") or field.name.startswith("_"):
                continue
            unit = field.metadata.get("unit", "")
            rows.append(
                f"<tr><td><code>{field.name}</code></td><td>{html.escape(_brief(value))}</td>"
                f"<td>{html.escape('' if unit == '1' else unit)}</td>"
                f"<td style='text-align:left'>{html.escape(field.metadata.get('doc', ''))}</td></tr>"
            )
        return f"<b>{type(self).__name__}</b><table>{''.join(rows)}</table>"

    def __repr__(self) -> str:
        parts = []
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if value is not None and field.name not in ("axes", "coords") and not field.name.startswith("_"):
                unit = field.metadata.get("unit", "1")
                parts.append(f"  {field.name}={_brief(value)}{'' if unit == '1' else ' ' + unit}")
        return f"{type(self).__name__}(\n" + ",\n".join(parts) + ")"


def _brief(value: object) -> str:
    if isinstance(value, np.ndarray):
        if value.size <= 6:
            return np.array2string(value, precision=5, separator=", ").replace("\n", "")
        return f"array{value.shape} from {np.nanmin(value):.4g} to {np.nanmax(value):.4g}"
    if isinstance(value, dict):
        return "{" + ", ".join(str(key) for key in value) + "}"
    if isinstance(value, float):
        return f"{value:.5g}"
    return repr(value)


def band_labels(axes: tuple[str, ...], coords: dict[str, Any]) -> list[tuple[str, Any]]:
    """A label and a color for each stack of one axis, to plot curves by."""
    if len(axes) != 1:
        return []
    values = coords.get(axes[0])
    if axes[0] == "band" and values is not None:
        palette = {"R": "#c0392b", "G": "#27853f", "B": "#2a5db0"}
        return [(str(name), palette.get(str(name))) for name in values]
    if axes[0] == "wavelength" and values is not None:
        import matplotlib

        colors = matplotlib.colormaps["turbo"]
        return [(f"{nm:g} nm", colors((float(nm) - 380.0) / 340.0)) for nm in values]
    return []


Array = NDArray[np.float64]
