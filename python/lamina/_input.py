# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Checks of what users give, in the wording of the command: what, what it must be, what it is."""

from __future__ import annotations

import difflib
import functools
import inspect
import json
import math
import numbers
import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar, Union, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._lamina import InvalidInput

Doubles = NDArray[np.float64]
Incidence = Union[str, float]
PathLike = Union[str, "os.PathLike[str]"]


def number_text(value: float) -> str:
    return f"{value:.12g}"


def whole_text(value: int) -> str:
    """A whole number as a person reads it in a range: from a million on 1e9, 2^24 or 2^64 - 1 where it is one of these."""
    if value < 0:
        return "-" + whole_text(-value)
    digits = str(value).rstrip("0")
    if value >= 10**6 and len(digits) == 1:
        return f"{digits}e{len(str(value)) - 1}"
    for power, tail in ((value, ""), (value + 1, " - 1")):
        if value >= 10**6 and power & (power - 1) == 0:
            return f"2^{power.bit_length() - 1}{tail}"
    return str(value)


def refuse(name: str, must: str, value: object) -> InvalidInput:
    """What to raise: `name: must be ..., but is ...`."""
    text = shown(value) if not isinstance(value, float) else number_text(value)
    return InvalidInput(f"{name}: must {must}, but is {text}")


def shown(value: object) -> str:
    """A value in a message: short, in one line."""
    try:
        text = " ".join(repr(value).split())
    except (RecursionError, ValueError):  # lists in lists without end; whole numbers of thousands of digits
        text = f"a {type(value).__name__} that is too long to print"
    return text if len(text) <= 60 else text[:57] + "..."


def name_text(name: str, value: object, must: str = "be a name") -> str:
    """Text that the library can take: of whole characters, none of them 0."""
    if not isinstance(value, str) or "\0" in value:
        raise refuse(name, must, value)
    try:
        size = len(value.encode())
    except UnicodeEncodeError:
        raise refuse(name, f"{must}, as text in Unicode", value) from None
    if size > 4095:  # the longest path that Linux takes
        raise refuse(name, f"{must}, of at most 4095 bytes", value)
    return value


def name_list(name: str, values: object) -> list[str]:
    """Some names, each as name_text takes it."""
    if not isinstance(values, (list, tuple)):
        raise refuse(name, "be a list of names", values)
    return [name_text(f"{name}[{i}]", value) for i, value in enumerate(values)]


def path_text(name: str, value: object) -> str:
    if not isinstance(value, (str, os.PathLike)):
        raise refuse(name, "be a path", value)
    return name_text(name, os.fspath(value), "be a path")


def as_float(name: str, must: str, value: Any) -> float:
    try:
        return float(value)
    except OverflowError:
        raise refuse(name, must, value) from None


F = TypeVar("F", bound=Callable[..., Any])


def suggests(function: F) -> F:
    """The function, which for an argument that it does not know says which one may be meant, as files do for keys."""
    known = [
        name for name, each in inspect.signature(function).parameters.items()
        if each.kind in (each.POSITIONAL_OR_KEYWORD, each.KEYWORD_ONLY)]

    @functools.wraps(function)
    def checked(*given: Any, **named: Any) -> Any:
        for name in named:
            if name not in known:
                raise TypeError(
                    f"{function.__name__}() got an unexpected keyword argument '{name}'{suggestion(name, known)}")
        return function(*given, **named)

    return cast(F, checked)


def suggestion(value: str, options: Sequence[str]) -> str:
    near = difflib.get_close_matches(value, options, 1)
    return f'; did you mean "{near[0]}"?' if near else ""


def one_of(name: str, value: object, options: Sequence[str]) -> str:
    if isinstance(value, str) and value in options:
        return value
    near = suggestion(value, options) if isinstance(value, str) else ""
    raise InvalidInput(f"{name}: must be one of {', '.join(options)}, but is {shown(value)}{near}")


def number(
    name: str,
    value: object,
    low: float = -math.inf,
    high: float = math.inf,
    *,
    closed: str = "[]",
    unit: str = "",
) -> float:
    """A finite number in a range; `closed` has its brackets."""
    tail = f" {unit}" if unit else ""
    interval = f"{closed[0]}{number_text(low)}, {number_text(high)}{closed[1]}"
    must = "be a number" if math.isinf(low) and math.isinf(high) else f"be in {interval}{tail}"
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, numbers.Real):
        raise refuse(name, must, value)
    result = as_float(name, must, value)
    is_low = result >= low if closed[0] == "[" else result > low
    is_high = result <= high if closed[1] == "]" else result < high
    if not (is_low and is_high and math.isfinite(result)):
        raise refuse(name, must, result)
    return result


def whole(name: str, value: object, low: int, high: int) -> int:
    """A whole number in a range; 1e6 is one."""
    must = f"be a whole number in [{whole_text(low)}, {whole_text(high)}]"
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, numbers.Real):
        raise refuse(name, must, value)
    result = as_float(name, must, value)
    if not (math.isfinite(result) and result == math.floor(result) and low <= result <= high):
        raise refuse(name, must, value if isinstance(value, int) else result)
    return int(value)  # exact where a float would not be


def flag(name: str, value: object) -> bool:
    if not isinstance(value, (bool, np.bool_)):
        raise refuse(name, "be True or False", value)
    return bool(value)


def incidence(value: Incidence, name: str = "incidence") -> tuple[bool, float]:
    """Whether light is diffuse, and else its angle [rad]."""
    must = "be normal, diffuse or an angle in [0, 90) degrees"
    if isinstance(value, str):
        if value in ("normal", "diffuse"):
            return value == "diffuse", 0.0
        raise refuse(name, must, value)
    try:
        degrees = number(name, value, 0.0, 90.0, closed="[)")
    except InvalidInput:
        raise refuse(name, must, value) from None
    return False, math.radians(degrees)


def place(index: Sequence[Any]) -> str:
    return "[" + ", ".join(str(int(i)) for i in index) + "]"


def _is_masked(value: object) -> bool:
    if isinstance(value, np.ma.MaskedArray):
        mask = np.asarray(value.mask)
        return mask.dtype.names is not None or bool(mask.any())
    return isinstance(value, (list, tuple)) and any(
        _is_masked(item) for item in value if isinstance(item, (np.ma.MaskedArray, list, tuple)))


def refuse_masked(name: str, value: object) -> None:
    """Refuses arrays whose mask hides elements: NumPy drops masks in silence, and what lies under them is no number."""
    try:
        is_masked = _is_masked(value)
    except RecursionError:
        is_masked = False  # refused by what takes it
    if is_masked:
        raise InvalidInput(
            f"{name}: must have no masked elements, but is a masked array that hides some; fill them, or leave them out")


def real_array(name: str, value: ArrayLike) -> NDArray[Any]:
    """An array of real numbers, of the kind that they have."""
    refuse_masked(name, value)
    try:
        array = np.asarray(value)
    except ValueError:  # rows of other lengths
        raise refuse(name, "be numbers", value) from None
    if array.dtype.kind not in "fiu":
        raise InvalidInput(f"{name}: must be numbers, but is {_kind(value, array)}")
    return array


def doubles(
    name: str,
    value: ArrayLike,
    low: float = -math.inf,
    high: float = math.inf,
    *,
    closed: str = "[]",
    unit: str = "",
    infinite: bool = False,
) -> Doubles:
    """An array of numbers in a range. One of doubles is not copied; names the first that is not in
    the range. `infinite` allows +inf besides."""
    array = real_array(name, value)
    result = np.asarray(array, dtype=np.float64)
    if result.size == 0:
        raise InvalidInput(f"{name}: must hold numbers, but has the shape {result.shape}")
    is_fine = (result >= low) if closed[0] == "[" else (result > low)
    is_fine &= (result <= high) if closed[1] == "]" else (result < high)
    is_fine &= np.isfinite(result)
    if infinite:
        is_fine |= np.isposinf(result)
    if not is_fine.all():
        index = np.unravel_index(int(np.argmin(is_fine)), result.shape)
        tail = f" {unit}" if unit else ""
        interval = f"{closed[0]}{number_text(low)}, {number_text(high)}{closed[1]}"
        is_any = math.isinf(low) and math.isinf(high)
        must = "be finite" if is_any else f"be in {interval}{tail}"
        at = f"{name}{place(index)}" if result.ndim else name
        raise refuse(at, must, float(result[index]))
    return result


def _kind(value: object, array: NDArray[Any]) -> str:
    if value is None:
        return "None"
    if array.ndim == 0 and not isinstance(value, np.ndarray):
        return shown(value)
    return f"an array of {array.dtype}"


def broadcast(arrays: Mapping[str, NDArray[Any]]) -> tuple[dict[str, NDArray[Any]], tuple[int, ...]]:
    """Arrays of one shape, by NumPy's rules; names those that do not fit."""
    try:
        shape = np.broadcast_shapes(*(a.shape for a in arrays.values()))
    except ValueError:
        shapes = ", ".join(f"{n} {a.shape}" for n, a in arrays.items() if a.size > 1)
        raise InvalidInput(f"shapes must broadcast together, but are {shapes}") from None
    return {n: np.broadcast_to(a, shape) for n, a in arrays.items()}, shape


def wavelengths(
    name: str, value: ArrayLike, low: float = 200.0, high: float = 3000.0
) -> list[float]:
    """Ascending wavelengths [nm]."""
    array = doubles(name, value, low, high, unit="nm")
    if array.ndim == 0:
        array = array[None]
    if array.ndim != 1 or not (np.diff(array) > 0.0).all():
        raise refuse(name, "be ascending wavelengths in one row [nm]", value)
    return [float(nm) for nm in array]


def json_text(name: str, value: object) -> str:
    """A dict as the text of a file. Arrays become lists, an infinite number "infinite"."""
    try:
        text = json.dumps(_plain(name, value), ensure_ascii=False)
        text.encode()
    except RecursionError:
        raise InvalidInput(f"{name}: must not hold lists or dicts in each other without end") from None
    except UnicodeEncodeError:
        raise InvalidInput(f"{name}: must be text in Unicode, but has half a character (a surrogate)") from None
    return text


MOST_IN_JSON = 10_000_000


def _plain(where: str, value: object) -> object:
    if isinstance(value, Mapping):
        plain: dict[str, object] = {}
        for key, item in value.items():
            if not isinstance(key, str):
                raise InvalidInput(f"{where}: keys must be text, but one is {shown(key)}")
            plain[key] = _plain(f"{where}.{key}", item)
        return plain
    if isinstance(value, np.ndarray):
        refuse_masked(where, value)
        if value.size > MOST_IN_JSON:
            raise InvalidInput(f"{where}: must have at most {MOST_IN_JSON} elements, but has {value.size}")
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [_plain(f"{where}[{i}]", item) for i, item in enumerate(value)]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, float):
        if value == math.inf:
            return "infinite"
        if not math.isfinite(value):
            raise refuse(where, "be a finite number", value)
        return value
    if value is None or isinstance(value, (bool, int, str)):
        return value
    raise InvalidInput(
        f"{where}: must be what JSON can hold (dict, list, text, number, True, False, None), "
        f"but is {type(value).__name__}"
    )
