# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Arguments of photons, as several functions have them."""

from __future__ import annotations

from typing import Any

from ._input import flag, number, whole
from ._lamina import InvalidInput


def effort_of(
    photons: float | None,
    relative_error: float | None,
    seconds: float | None,
    seed: int,
    independent_bands: bool,
) -> dict[str, Any]:
    """What the bindings take. With a precision or a time to reach, photons are without limit unless
    one is given."""
    error = 0.0 if relative_error is None else number("relative_error", relative_error, 1e-9, 1.0)
    time = 0.0 if seconds is None else number("seconds", seconds, 1e-3, 1e9, unit="s")
    most = 10**6 if error == 0.0 and time == 0.0 else 10**12
    return {
        "photons": most if photons is None else whole("photons", photons, 1, 10**15),
        "seed": whole("seed", seed, 0, 2**64 - 1),
        "relative_error": error,
        "seconds": time,
        "independent_bands": flag("independent_bands", independent_bands),
    }


def require_unused(method: str, arguments: dict[str, tuple[bool, str]]) -> None:
    """Refuses arguments that the method would not read: {name: (is given, the method it is for)}."""
    for name, (is_given, owner) in arguments.items():
        if is_given and method != owner:
            raise InvalidInput(f'{name}: is for method="{owner}", but the method is {method}')
