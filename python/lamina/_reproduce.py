# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Tables and figures of papers, made again, each with a verdict."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from . import _lamina
from ._files import opened
from ._input import PathLike, one_of, path_text, shown, suggestion
from ._lamina import InvalidInput
from ._result import Result, quantity, setting

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class ReproductionItem(NamedTuple):
    """A table, figure or plate of a paper that `reproduce` makes."""

    id: str  #: as in "dj05.table1"
    paper: str  #: as in "donner_jensen_2005"
    title: str
    shows: str


class CheckedNumber(NamedTuple):
    """A number of a paper against ours."""

    what: str
    value: float
    expected: float
    tolerance: float  #: absolute
    source: str  #: of what is expected
    holds: bool


class CheckedFeature(NamedTuple):
    """A feature of a figure, and whether ours has it."""

    what: str
    measure: float | None  #: how clearly
    holds: bool


@dataclass(frozen=True, eq=False, repr=False)
class Reproduction(Result):
    """A table or figure of a paper, made again."""

    id: str = setting("of the item")
    paper: str = setting("as in donner_jensen_2005")
    title: str = setting("of the item")
    shows: str = setting("what it shows")
    verdict: str = setting("agrees, agrees_in_shape or differs")
    numbers: tuple[CheckedNumber, ...] = setting("of the paper, against ours")
    features: tuple[CheckedFeature, ...] = setting("of the figure, and whether ours has them")
    columns: tuple[str, ...] = setting("of its table")
    cells: tuple[tuple[str, ...], ...] = setting("of its table, rows with their names")
    pictures: tuple[tuple[str, str], ...] = setting("paths and captions, if a folder was given; the page has them, too")
    svg: str = setting("its plot; empty without one")
    html: str = setting("all of it as a page that needs nothing else")
    seconds: float = quantity("that its commands took", unit="s")

    def save(self, path: PathLike) -> None:
        """Writes the page, .html, or the plot, .svg.

        :raises InvalidInput: for another ending, or without a plot.
        """
        name = path_text("path", path)
        text = self.html if name.endswith(".html") else self.svg if name.endswith(".svg") else ""
        if not text:
            raise InvalidInput(f"path: must end in .html, or in .svg if there is a plot, but is {shown(name)}")
        Path(name).write_text(text)

    def _repr_html_(self) -> str:
        import base64
        import html

        rows = "".join(
            f"<tr><td>{'✓' if n.holds else '✗'}</td><td style='text-align:left'>{html.escape(n.what)}</td>"
            f"<td>{n.value:.4g}</td><td>{n.expected:.4g} ± {n.tolerance:.2g}</td></tr>" for n in self.numbers)
        rows += "".join(
            f"<tr><td>{'✓' if f.holds else '✗'}</td><td style='text-align:left'>{html.escape(f.what)}</td><td></td><td></td></tr>"
            for f in self.features)
        plot = base64.b64encode(self.svg.encode()).decode()
        image = f"<img src='data:image/svg+xml;base64,{plot}' style='max-width:100%'>" if plot else ""
        return (f"<b>{html.escape(self.title)}</b>: {self.verdict.replace('_', ' ')}{image}"
                f"<table><tr><th></th><th>what</th><th>here</th><th>paper</th></tr>{rows}</table>")

    def _repr_png_(self) -> None:
        return None  # the table of checks says more

    def _draw(self, ax: Axes) -> None:
        names = [n.what for n in self.numbers]
        off = [(n.value - n.expected) / n.tolerance if n.tolerance > 0 else 0.0 for n in self.numbers]
        ax.axvspan(-1.0, 1.0, color="0.9")
        ax.plot(off, range(len(off)), "o")
        ax.set(yticks=range(len(off)), xlabel="(here - paper) / tolerance")
        ax.set_yticklabels([n if len(n) < 48 else n[:45] + "…" for n in names], fontsize=7)
        ax.invert_yaxis()


def reproductions() -> tuple[ReproductionItem, ...]:
    """The items that `reproduce` makes, by paper.

    >>> import lamina
    >>> sorted({item.paper for item in lamina.reproductions()})[0]
    'donner_2008'
    """
    return tuple(ReproductionItem(*item) for item in _lamina.reproduction_items())


def _find_command(command: PathLike | None) -> str:
    if command is not None:
        return path_text("command", command)
    here = Path(__file__).resolve().parent
    places = [here.parents[1] / "lamina", here.parents[3] / "bin/lamina"]  # in the build, installed
    for place in places:
        if place.is_file() and os.access(place, os.X_OK):
            return str(place)
    found = shutil.which("lamina")
    if found is None:
        raise InvalidInput("command: the command lamina must be on PATH, or be named, but is not found")
    return found


def _find_sources(sources: PathLike | None, command: str) -> str:
    if sources is not None:
        return path_text("sources", sources)
    for start in (Path(command).resolve(), Path.cwd()):
        for folder in start.parents if start.is_file() else (start, *start.parents):
            if (folder / "reproduce").is_dir() and (folder / "scenes").is_dir():
                return str(folder)
    return ""


def reproduce(
    item: str | os.PathLike[str] | Mapping[str, Any],
    *,
    quality: str = "draft",
    folder: PathLike | None = None,
    sources: PathLike | None = None,
    command: PathLike | None = None,
) -> Reproduction:
    """Makes a table or figure of a paper again, by lamina's command, and judges it.

    :param item: the id of one of `reproductions`, the path of an item's file (.json), or a dict
        with its keys; docs/reproduction.md.
    :param quality: "draft" or "full": the photons and samples of a publication.
    :param folder: where its files go; else in a folder that is gone at the end.
    :param sources: the folder with lamina's scenes, if an item needs one; else looked for above the
        command and the current folder.
    :param command: the program lamina; else that beside the package, or on PATH.
    :raises InvalidInput: if there is no such item, or a command or expression of it is wrong.
    :raises FileError: if the item's file, or what it needs, is not there. Ctrl-C ends it as usual.
    """
    one_of("quality", quality, ("draft", "full"))
    program = _find_command(command)
    place = _find_sources(sources, program)
    is_file = isinstance(item, Mapping) or str(item).endswith(".json")
    if not is_file:
        ids = [known.id for known in reproductions()]
        if item not in ids:
            raise InvalidInput(f"item: must be one of reproductions(), but is {shown(item)}{suggestion(str(item), ids)}")
    with tempfile.TemporaryDirectory(prefix="lamina_") as made:
        out = Path(made if folder is None else folder).resolve()

        def run(arguments: list[str], where: str) -> str:
            result = Path(where) / "result.json"
            # Its own group of threads: as many as here. It writes to its folder alone, whatever an item of others names.
            done = subprocess.run(
                [program, *arguments, "--threads", str(_lamina.thread_count()), "--json", str(result)], cwd=where,
                env={**os.environ, "LAMINA_WRITE_FOLDER": where}, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            if done.returncode != 0:
                last = (done.stderr.strip().splitlines() or ["it ended without a word"])[-1]
                raise InvalidInput(f"lamina {' '.join(arguments)}: {last}")
            return result.read_text()

        if is_file:
            with opened("item", "reproduction", item, None) as (path, text):
                found = _lamina.reproduce("", path, text, quality, str(out), place, run)
        else:
            found = _lamina.reproduce(str(item), None, None, quality, str(out), place, run)
    pictures = tuple((path, caption) for path, caption in found.pop("pictures"))
    return Reproduction(
        axes=(), coords={}, pictures=pictures if folder is not None else (),
        numbers=tuple(CheckedNumber(*n) for n in found.pop("numbers")),
        features=tuple(CheckedFeature(*f) for f in found.pop("features")),
        columns=tuple(found.pop("columns")), cells=tuple(tuple(row) for row in found.pop("cells")), **found)
