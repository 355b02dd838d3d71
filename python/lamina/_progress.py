# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Progress of long calls: `progress=None`, `True` for a bar, or a function."""

from __future__ import annotations

import sys
import time
from typing import Callable, Optional, TextIO, Union

from ._input import shown
from ._lamina import Interrupted, InvalidInput

#: None: say nothing. True: a bar on standard error. A function is called with the finished
#: fraction, in [0, 1], some ten times a second, from any thread; it ends the work by returning
#: False or raising.
Progress = Union[None, bool, Callable[[float], Optional[bool]]]


class _Bar:
    """One line that is drawn again and again; nothing for work that is done within half a second."""

    def __init__(self, title: str, stream: TextIO) -> None:
        self._title = title
        self._stream = stream
        self._begun = time.monotonic()
        self._drawn = 0

    def __call__(self, finished: float) -> bool:
        seconds = time.monotonic() - self._begun
        if seconds < 0.5:
            return True
        if finished > 0.0:
            width = 30
            full = int(width * min(finished, 1.0))
            left = seconds * (1.0 - finished) / finished
            text = f"{self._title} [{'#' * full}{'.' * (width - full)}] {100 * finished:3.0f} %, {left:.0f} s left"
        else:
            text = f"{self._title} {seconds:.0f} s"
        self._stream.write("\r" + text.ljust(self._drawn))
        self._stream.flush()
        self._drawn = len(text)
        return True

    def close(self) -> None:
        if self._drawn:
            self._stream.write("\r" + " " * self._drawn + "\r")
            self._stream.flush()


class progress_of:
    """`with progress_of(progress, "slab") as callback:` gives what the library calls."""

    def __init__(self, progress: Progress, title: str) -> None:
        if not (progress is None or isinstance(progress, bool) or callable(progress)):
            raise InvalidInput(
                f"progress: must be None, True, False or a function, but is {shown(progress)}"
            )
        self._bar = _Bar(title, sys.stderr) if progress is True else None
        self._callback = (
            self._bar if self._bar else None if isinstance(progress, bool) else progress
        )

    def __enter__(self) -> Optional[Callable[[float], Optional[bool]]]:
        return self._callback

    def __exit__(self, *exception: object) -> None:
        if self._bar:
            self._bar.close()


def interrupted_with(result: object) -> BaseException:
    """What Ctrl-C raises where there is a result so far."""
    exception = Interrupted("interrupted: `result` of this exception has what there is so far")
    exception.result = result
    return exception
