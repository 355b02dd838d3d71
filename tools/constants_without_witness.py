#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Named constants of src/lamina that nothing is said to have chosen.

usage: constants_without_witness.py                  how many each room has
       constants_without_witness.py ROOM             those of a room, such as render/subsurface
       constants_without_witness.py --keep|--check   writes the numbers of all wings to tests/constants_without_witness.txt;
                                                     fails where a wing has more, or a witness does not exist

A constant is a `constexpr` number with a name and digits in its value. It needs no witness if its value is
made of other constants, or if its comment names a source, as [Jensen2001]. Its witness is what shows that
it should have this value, named in its comment:

    constexpr double reach = 3.5;  // tools/tables/hierarchy_scaling
    constexpr double reach = 3.5;  // test Hierarchy.SeesEnoughOfItsNeighbors

tools/fit/NAME and benchmarks/NAME are witnesses, too. A comment is that of the line, or the one before it;
the one before a paragraph of constants is that of all of them.
"""
import collections
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
KEPT = ROOT / "tests/constants_without_witness.txt"
DECLARATION = re.compile(r"\s*(?:static |inline )*constexpr (?:static |inline )*"
                         r"(?:double|float|bool|int|unsigned|long long|std::size_t|std::u?int\d+_t) (\w+ ?(?:=|\{).*)")
SOURCE = re.compile(r"\[[A-Z][A-Za-z]+(?:19|20)\d\d[,\]]")
WITNESS = re.compile(r"\b((?:tools/tables|tools/fit|benchmarks)/\w+)|\btest (\w+\.\w+)")
# What a value may be made of, besides digits, and still be chosen by somebody.
WORDS = re.compile(r"\b(?:std::numbers::\w+|std::u?int\d+_t|std::size_t|std::pow|double|float|int)\b|"
                   r"\b0[xX][\da-fA-F'uUlL]+|\b[\d'.]+(?:[eE][-+]?\d+)?[fFuUlLzZ]*|\.\d[\d']*(?:[eE][-+]?\d+)?[fF]?")

Constant = collections.namedtuple("Constant", "file line name value comment")


def split_comment(line):
    code, slashes, comment = line.partition("//")
    return (code, comment) if slashes else (line, "")


def constants(file):
    """All with digits of their own, each with its comment."""
    lines, before = file.read_text().splitlines(), []
    of_paragraph, in_paragraph = "", False
    for number, line in enumerate(lines):
        code, comment = split_comment(line)
        if not code.strip():
            before = [*before, comment] if comment else []
            in_paragraph = in_paragraph and bool(comment)
            continue
        match = DECLARATION.fullmatch(code.rstrip())
        if match:
            if before or not in_paragraph:
                of_paragraph = " ".join(before)
            in_paragraph = True
            text, end = match[1], number
            while ";" not in text and end + 1 < len(lines):
                end += 1
                more, more_comment = split_comment(lines[end])
                text, comment = f"{text} {more.strip()}", f"{comment} {more_comment}"
            for name, value in re.findall(r"(\w+)\s*(?:=|\{)\s*((?:\([^()]*\)|\{[^{}]*\}|[^,;(){}])+)", text.partition(";")[0]):
                if re.search(r"[A-Za-z_]\w*", WORDS.sub("", value)) is None and re.search(r"\d", value):
                    yield Constant(file, number + 1, name, value.strip(), f"{of_paragraph} {comment}")
        else:
            in_paragraph = False
        before = []


def trivial(value):
    """Nothing, one, and powers of two that are sizes of memory or files."""
    return re.fullmatch(r"[-+]?[01](\.0*)?[fuU]?|(std::\w+\{1\}|\w+\{1\}|1u?) << \d+", value) is not None


def names_of_tests():
    return {f"{suite}.{name}" for file in (ROOT / "tests").rglob("*_test.cpp")
            for suite, name in re.findall(r"^(?:TEST|TEST_F|TEST_P|RC_GTEST_PROP)\((\w+),\s*(\w+)", file.read_text(), re.MULTILINE)}


def read_all():
    """Those without a witness by room, and witnesses that do not exist."""
    tests, rooms, wrong = names_of_tests(), collections.defaultdict(list), []
    for file in sorted((ROOT / "src/lamina").rglob("*")):
        if file.suffix not in (".h", ".cpp"):
            continue
        for constant in constants(file):
            if trivial(constant.value) or SOURCE.search(constant.comment):
                continue
            witnesses = WITNESS.findall(constant.comment)
            for program, test in witnesses:
                if not (test in tests or program and list(ROOT.glob(program + ".*"))):
                    wrong.append(f"{place(constant)}: there is no {program or 'test ' + test}")
            if not witnesses:
                folders = file.relative_to(ROOT / "src/lamina").parent.parts
                rooms["/".join(folder for folder in folders if folder not in ("internal", "files"))].append(constant)
    return rooms, wrong


def place(constant):
    return f"{constant.file.relative_to(ROOT)}:{constant.line}"


def main():
    rooms, wrong = read_all()
    numbers = {room: len(found) for room, found in sorted(rooms.items())}
    wings = collections.Counter()
    for room, number in numbers.items():
        wings[room.split("/")[0]] += number
    if sys.argv[1:] == ["--keep"]:
        KEPT.write_text("".join(f"{wing} {number}\n" for wing, number in wings.items()))
    elif sys.argv[1:] == ["--check"]:
        kept = {wing: int(number) for wing, number in map(str.split, KEPT.read_text().splitlines())}
        for wing, number in wings.items():
            if number > kept.get(wing, 0):
                wrong += [f"src/lamina/{wing} has {number} constants without a witness, of {kept.get(wing, 0)} at most: "
                          f"tools/constants_without_witness.py {wing} lists them and says how to name one"]
        print("\n".join(wrong) or f"{wings.total()} constants without a witness, of {sum(kept.values())} at most")
        sys.exit(1 if wrong else 0)
    elif len(sys.argv) == 2:
        for room, found in rooms.items():
            if f"{room}/".startswith(sys.argv[1].strip("/") + "/"):
                for constant in found:
                    print(f"{place(constant)}: {constant.name} = {constant.value}")
    else:
        for room, number in numbers.items():
            print(f"{number:5} {room}")
        print(f"{wings.total():5} in all")


if __name__ == "__main__":
    main()
