# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""What the pages say is so: their commands run, their C++ compiles, and every option, key, name,
file, link and source that they mention exists. Comments name files and sources that exist, too.
CONTRIBUTING.md has the test program of each room.

usage: docs_test.py LAMINA ROOT COMPILER [unittest's arguments]

DOCS_PART=1/4 in the environment runs the commands of the second of four parts of the pages, and DOCS_PART=pages
all that runs no commands.

Commands run page by page, in order, in a scratch folder that sees the folders of the checkout; a
block whose first line is "// NAME.json" or "# NAME.obj", or .csv, is that file there. They run small: see SMALL. What
cannot run here is named, with its reason, in NOT_RUN; its options are checked all the same.
"""
import functools
import hashlib
import json
import os
import pathlib
import re
import resource
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

LAMINA, ROOT, COMPILER = os.path.abspath(sys.argv.pop(1)), pathlib.Path(sys.argv.pop(1)).resolve(), sys.argv.pop(1)
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
PART, PARTS = map(int, os.environ.get("DOCS_PART", "0/1").replace("pages", "-1/1").split("/"))
LINKED = ["scenes", "demo", "reproduce"]  # folders of the checkout that commands name

# What a command runs with here, in place of its own number of photons, pixels, samples and radii.
SMALL = {
    "slab": {"--photons": "500"},
    "photons": {"--photons": "500"},
    "profile": {"--radii": "8"},
    "bsdf": {"--step": "45"},
    "render": {"--width": "12", "--height": "9", "--samples": "1"},
}
# Scenes that are rendered by a profile where no method is named; here by one that is there at once.
OF_PROFILES = ("arm.json", "bumpy.json", "sphere_skin.json", "candle.json", "pebble.json")
# A command that has one of these words is not run, because:
NOT_RUN = {
    "demo/": "demo.sh fetches the head, 89 MB",
    "scenes/hanrahan_krueger/": "their head is that of the demo",
    "scenes/donner_2008/": "their head is that of the demo",
    "--gaussians": "8 CPU-s",
    "--domain frequency": "30 CPU-s",
    "--from below": "3 CPU-minutes",
    "tissue.mci": "stands for a file of the reader's",
    "--partition": "needs a Slurm",
    "submit sphere.job": "needs a Slurm",
    "picture.job/shards/1?.shard": "a part of hundreds of shards",
    "part*.shard": "the parts of hundreds of shards",
    "--resume": "goes on with a picture that was stopped",
}
# A `word` that is not of lamina's sources: of papers, formats, tools and the reader's own files.
NOT_OURS = set("""
    apt brew cmake ctest dnf git jq pacman rsvg convert make nproc flock sudo ninja python3 numpy
    usemtl utils helpers zv zr POSITION MaxArraySize ccache sloppiness pch_defines time_macros
""".split())


@functools.lru_cache(None)
def text_of(page):
    return page.read_text()


def fences(page):
    """(language, text, line) of the ``` blocks of a page."""
    for block in re.finditer(r"^```(\w*)[^\n]*\n(.*?)^```", text_of(page), re.DOTALL | re.MULTILINE):
        yield block.group(1), block.group(2), text_of(page).count("\n", 0, block.start()) + 2


def prose(page):
    """The page without ``` blocks, line by line."""
    return re.sub(r"^```.*?^```", lambda block: "\n" * block.group().count("\n"), text_of(page),
                  flags=re.DOTALL | re.MULTILINE)


def spans(page):
    """(text, line) of `code` in prose."""
    for number, line in enumerate(prose(page).splitlines(), 1):
        for text in re.findall(r"`([^`]+)`", line):
            yield text, number


def where(page, line):
    return f"{page.relative_to(ROOT)}:{line}"


def steps(page):
    """What a reader does, in order: ("file", name, text) and ("command", words, place)."""
    for language, text, line in fences(page):
        name = re.match(r"(?://|#) ([\w-]+\.(?:json|obj|csv))\n", text)
        if name:
            yield "file", name.group(1), text
        if language in ("", "sh", "bash", "console"):
            yield from commands(text, page, line)
    for number, line in enumerate(prose(page).splitlines(), 1):
        if line.startswith("    lamina "):
            yield from commands(line.strip(), page, number)


def commands(text, page, first):
    text = text.replace("\\\n", "  ")
    for number, line in enumerate(text.splitlines(), first):
        for part in re.sub(r"\s#.*", "", line).split("&&"):
            words = shlex.split(part.strip().removeprefix("$ "))
            if words and words[0] in ("lamina", "build/release/lamina") and len(words) > 1:
                yield "command", words[1:], where(page, number)


@functools.lru_cache(None)
def help_of(subcommand=None):
    result = subprocess.run([LAMINA, *([subcommand] if subcommand else []), "--help"], capture_output=True, text=True)
    return result.stdout if result.returncode == 0 else None


def options_of(subcommand):
    return set(re.findall(r"(?<![\w-])--?[a-z][a-z-]*", help_of(subcommand) or ""))


def subcommands():
    return re.findall(r"^  (\w+)  ", help_of().split("Subcommands:")[1], re.MULTILINE)


def smaller(words):
    """The command with the numbers of SMALL, and where its output would be lost, none."""
    subcommand, rest = words[0], words[1:]
    numbers = dict(SMALL.get(subcommand, {}))
    method = rest[rest.index("--method") + 1] if "--method" in rest else ""
    if subcommand in ("slab", "profile", "bsdf") and method != "monte_carlo":
        numbers.pop("--photons", None)
    if subcommand in ("profile", "bsdf") and method == "monte_carlo" or "rough_transmission" in rest:
        numbers = {"--photons": "500"}
    if "--domain" in rest:
        numbers = {}
    if subcommand == "render" and "--profile" not in rest and not any("random_walk" in word for word in rest):
        if method in ("probe", "hierarchy", "shadow_map") or not method and rest[0].endswith(OF_PROFILES):
            numbers["--profile"] = "diffusion"
    if subcommand == "reproduce" and "full" in rest:  # hours, where ./demo.sh has fetched the head
        rest = [*rest, "--list"]
    if "rough_transmission" in rest and method in ("", "analytic") and "--compare" not in rest:
        numbers = {}
    if subcommand == "photons" and rest[0].endswith(".mci"):
        numbers = {}
    kept, i = [], 0
    while i < len(rest):
        if rest[i] in numbers:
            i += 2
            continue
        kept.append(rest[i].replace("--compare", "--compare=500") if subcommand == "slab" else rest[i])
        i += 1
    if subcommand == "edit" and "--no-preview" not in kept:  # previews take seconds
        kept.append("--no-preview")
    return [subcommand, *kept, *(word for pair in numbers.items() for word in pair)]


class Commands(unittest.TestCase):
    def test_every_command_has_its_options(self):
        for page in PAGES:
            for kind, words, place in steps(page):
                if kind != "command" or words[0].startswith("-"):
                    continue
                with self.subTest(place):
                    self.assertIn(words[0], subcommands())
                    for word in words[1:]:
                        if re.match(r"--?[a-z]", word):
                            self.assertIn(word.split("=")[0], options_of(words[0]))


def commands_of(page):
    return [" ".join(words) for kind, words, _ in steps(page) if kind == "command"
            if not any(word in " ".join(words) for word in NOT_RUN)]


def parts_of_pages():
    """Pages by part, about as many commands in each. Pages that make the same maps are in one part, where they are made once."""
    def maps_of(page):
        return {line for line in commands_of(page) if line.startswith(("acquire ", "maps "))}

    groups = []
    for page in PAGES:
        if not commands_of(page):
            continue
        shared = [group for group in groups if any(maps_of(page) & maps_of(other) for other in group)]
        groups = [group for group in groups if group not in shared] + [[page, *sum(shared, [])]]
    parts = [[] for _ in range(PARTS)]
    for group in sorted(groups, key=lambda group: -sum(len(commands_of(page)) for page in group)):
        min(parts, key=lambda part: sum(len(commands_of(page)) for page in part)).extend(group)
    return parts


class Made:
    """What commands made: the same command of another page, on files with the same bytes, is not run again."""

    def __init__(self, folder):
        self.folder, self.of_runs = pathlib.Path(folder), {}

    @staticmethod
    def files(folder):
        return {file.relative_to(folder): (file.stat().st_mtime_ns, file.stat().st_size)
                for file in pathlib.Path(folder).rglob("*") if file.is_file()}  # not behind links: LINKED does not change

    @staticmethod
    def hash_below(place):
        files = [place] if place.is_file() else sorted(file for file in place.rglob("*") if file.is_file())
        return hashlib.sha256(b"".join(str(file.relative_to(place.parent)).encode() + hashlib.sha256(file.read_bytes()).digest()
                                       for file in files)).hexdigest()

    def key(self, words, folder):
        """The words, and the bytes of all that they may read: of the folder here that they name something of, or of all folders."""
        hashes = []
        for word in words:
            place = pathlib.Path(folder, word)
            first = (pathlib.Path(os.path.relpath(place, folder)).parts or (".",))[0]
            if place.exists() and first not in ("..", *LINKED):
                top = pathlib.Path(folder, first)
                hashes.append(self.hash_below(top if top.is_dir() else pathlib.Path(folder)))
        return (*words, *hashes)

    def run(self, words, folder):
        key = self.key(words, folder)
        if key in self.of_runs:
            result, made = self.of_runs[key]
            shutil.copytree(made, folder, dirs_exist_ok=True)
            return result
        before = self.files(folder)
        result = subprocess.run([LAMINA, *words], cwd=folder, capture_output=True, text=True, timeout=300)
        made = self.folder / str(len(self.of_runs))
        made.mkdir()
        for name, state in self.files(folder).items():
            if before.get(name) != state:
                (made / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(pathlib.Path(folder, name), made / name)
        self.of_runs[key] = result, made
        return result


class RunCommands(unittest.TestCase):
    def test_every_command_runs(self):
        self.assertEqual(sum(len(part) for part in parts_of_pages()), sum(bool(commands_of(page)) for page in PAGES))
        ran = 0
        with tempfile.TemporaryDirectory() as kept:
            self.made = Made(kept)
            for page in parts_of_pages()[PART]:
                with tempfile.TemporaryDirectory() as folder:
                    for name in LINKED:
                        os.symlink(ROOT / name, os.path.join(folder, name))
                    shutil.copytree(ROOT / "examples", os.path.join(folder, "examples"))  # one reads what another made
                    for step in steps(page):
                        ran += self.do(step, folder)
        self.assertGreater(ran, 20 // PARTS)

    def do(self, step, folder):
        kind, what, rest = step
        if kind == "file":
            pathlib.Path(folder, what).write_text(rest)
            return 0
        line = " ".join(what)
        if any(word in line for word in NOT_RUN):
            return 0
        words = smaller(what)
        target = None
        if ">" in words:
            target, words = words[words.index(">") + 1], words[:words.index(">")]
        with self.subTest(rest, command=line):
            result = self.made.run(words, folder)
            self.assertEqual(result.returncode, 0, f"lamina {' '.join(words)}: {result.stderr}")
            if os.environ.get("DOCS_TIMES"):  # to see what to make smaller
                usage = resource.getrusage(resource.RUSAGE_CHILDREN)
                print(f"{usage.ru_utime + usage.ru_stime:7.1f} s until {rest} {line}", flush=True)
            if target:
                pathlib.Path(folder, target).write_text(result.stdout)
            self.make_small(what, folder)
        return 1

    def make_small(self, words, folder):
        """Patches that a recipe of maps wrote are solved by diffusion: the other tables take 20 CPU-s."""
        if words[0] == "maps" and "-o" in words:
            for patch in pathlib.Path(folder, words[words.index("-o") + 1]).glob("patch.json"):
                value = json.loads(patch.read_text())
                patch.write_text(json.dumps({**value, "totals": "diffusion"}))


class Programs(unittest.TestCase):
    def test_every_program_compiles(self):
        blocks = [(page, text, line) for page in PAGES for language, text, line in fences(page) if language == "cpp"]
        self.assertGreaterEqual(len(blocks), 2)
        for page, text, line in blocks:
            with self.subTest(where(page, line)):
                result = subprocess.run([COMPILER, "-std=c++20", "-fsyntax-only", "-Wall", "-Werror",
                                         "-Wno-unused-variable", f"-I{ROOT}/src", "-x", "c++", "-"],
                                        input=self.program(text), capture_output=True, text=True)
                self.assertEqual(result.returncode, 0, result.stderr[:2000])

    def program(self, text):
        """A block without a main is what stands in one, or before it."""
        if "int main" in text:
            return text
        includes = "".join(line + "\n" for line in text.splitlines() if line.startswith("#include"))
        body = "".join(line + "\n" for line in text.splitlines() if not line.startswith("#include"))
        return f"{includes}int main() {{\n{body}}}\n"


class Rooms(unittest.TestCase):
    """The table of rooms in CONTRIBUTING.md, against the folders and tests/CMakeLists.txt."""
    rows = [[cell.strip() for cell in row.split("|")[1:4]]
            for row in re.search(r"\| room \|.*\n\|-.*\n((?:\|.*\n)*)", text_of(ROOT / "CONTRIBUTING.md")).group(1).splitlines()]

    def test_every_room_is_in_the_table(self):
        listed = {room for row in self.rows for room in re.findall(r"`([\w/]+)`", row[0])}
        for folder in (ROOT / "src/lamina").glob("*/"):
            with self.subTest(folder.name):
                self.assertTrue(any(room.split("/")[0] == folder.name for room in listed))

    def test_each_program_has_the_tests_of_its_rooms(self):
        for room, program, _ in self.rows:
            if program.startswith("by its users"):
                continue
            name = re.search(r"`(\w+)_test`", program).group(1)
            for one in re.findall(r"`([\w/]+)`", room):
                with self.subTest(one):
                    self.assertTrue((ROOT / "src/lamina" / one).is_dir())
                    self.assertTrue(any((one + "/").startswith(folder + "/") for folder in test_programs()[name]))

    def test_every_test_is_in_a_program(self):
        folders = {folder for program in test_programs().values() for folder in program}
        for file in (ROOT / "tests").rglob("*_test.cpp"):
            name = file.relative_to(ROOT / "tests").as_posix()
            with self.subTest(name):
                self.assertTrue(any(name.startswith(folder + "/") for folder in folders))


class Names(unittest.TestCase):
    def test_every_option_exists(self):
        every = set().union(*(options_of(subcommand) for subcommand in subcommands()), options_of(None))
        for page in PAGES:
            for text, line in spans(page):
                first = text.split()[0]
                if first.startswith("-") or first == "lamina":
                    known = options_of(text.split()[1]) if first == "lamina" and len(text.split()) > 1 and \
                        text.split()[1] in subcommands() else every
                    for option in re.findall(r"(?<![\w-])--[a-z][a-z-]*", text):
                        with self.subTest(where(page, line)):
                            self.assertTrue(option in known, f"no such option: {option}")

    def test_every_key_is_in_a_schema(self):
        for page in PAGES:
            for language, text, line in fences(page):
                if language in ("json", "jsonc"):
                    with self.subTest(where(page, line)):
                        self.check_keys(parsed(text))
            header = ""
            for number, row in enumerate(prose(page).splitlines(), 1):
                if not row.startswith("|"):
                    header = ""
                    continue
                header = header or row
                if re.match(r"\| key\b", header):
                    for key in re.findall(r"`([a-z_]+)`", row.split("|")[1]):
                        with self.subTest(where(page, number)):
                            self.assertTrue(key in keys_of_schemas(), f"no such key: {key}")

    def check_keys(self, value, are_free=False):
        for entry in value if isinstance(value, list) else []:
            self.check_keys(entry)
        for key, entry in value.items() if isinstance(value, dict) else []:
            if not are_free:
                self.assertTrue(key in keys_of_schemas(), f"no such key: {key}")
            self.check_keys(entry, key in ("materials", "parts", "maps", "for", "values"))

    def test_every_name_is_in_the_sources(self):
        for page in PAGES:
            if page.name in ("notation.md",):  # defines names: the first column of its tables
                continue
            for text, line in spans(page):
                for name in re.findall(r"(?<![\w./<-])[A-Za-z][A-Za-z_]*[a-z_](?![\w/-]|\.[a-z])", text):
                    with self.subTest(where(page, line), span=text):
                        self.assertTrue(is_known(name), name)

    def test_every_file_exists(self):
        roots = "src|cli|tests|tools|scenes|schema|examples|reproduce|benchmarks|demo|docs|cmake|data"
        for page in PAGES:
            for text, line in spans(page):
                for path in re.findall(rf"(?<![\w./])(?:{roots})/[\w./*-]*\w", text):
                    if path.startswith(("demo/out", "demo/assets")):
                        continue  # what demo.sh fetches and makes
                    with self.subTest(where(page, line)):
                        self.assertTrue(list(ROOT.glob(path)) or list(ROOT.glob(path + ".cpp")), path)
                for path in re.findall(rf"^(?:{rooms()})/[\w/]*$", text):
                    with self.subTest(where(page, line)):
                        self.assertTrue((ROOT / "src/lamina" / path).is_dir(), path)
                for path in re.findall(r"(?<![\w./])[\w/]+\.(?:h|cpp|py|sh)\b(?!\w)", text):
                    if path.startswith("NAME"):
                        continue  # what a command writes
                    with self.subTest(where(page, line)):
                        self.assertTrue((ROOT / path).exists() or (ROOT / "src/lamina" / path).exists() or
                                        "/" not in path and path in names_of_files(), path)


class Written(unittest.TestCase):
    def test_pages_that_repeat_something_are_up_to_date(self):
        sys.path.insert(0, str(ROOT / "tools/docs"))
        sys.dont_write_bytecode = True
        import write_pages
        for page, written in write_pages.pages(LAMINA):
            with self.subTest(page.name):
                self.assertTrue(text_of(page) == written, f"run tools/docs/write_pages.py {LAMINA}")


class Links(unittest.TestCase):
    def test_every_link_leads_somewhere(self):
        for page in PAGES:
            for number, line in enumerate(prose(page).splitlines(), 1):
                for target in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`]*`", "", line)):
                    if re.match(r"\w+:", target):
                        continue
                    path, _, anchor = target.partition("#")
                    file = (page.parent / path) if path else page
                    with self.subTest(where(page, number)):
                        self.assertTrue(file.exists(), target)
                        if anchor and file.suffix == ".md":
                            self.assertIn(anchor, anchors(file), target)

    def test_every_page_and_picture_is_linked(self):
        linked = set()
        for page in PAGES:
            for target in re.findall(r"\]\(([^)#\s]+)", text_of(page)):
                linked.add((page.parent / target).resolve())
        linked.add(ROOT / "docs/index.md")
        for file in [*(ROOT / "docs").rglob("*.md"), *(ROOT / "docs/images").iterdir(), *(ROOT / "docs/figures").iterdir()]:
            with self.subTest(str(file)):
                self.assertTrue(file.resolve() in linked, "no page links to it")

    def test_every_export_format_has_a_page_with_a_picture(self):
        listed = subprocess.run([LAMINA, "export", "--to", "list", "--json", "-"], capture_output=True, text=True, check=True)
        for one in json.loads(listed.stdout)["formats"]:
            with self.subTest(one["name"]):
                page = ROOT / f"docs/export/{one['name']}.md"
                self.assertIn(f"](../images/export_{one['name']}.png)", text_of(page))
                self.assertIn(f"](export/{page.name})", text_of(ROOT / "docs/export.md"))

    def test_comments_name_files_and_sources_that_exist(self):
        for folder in ("src", "cli", "tests", "tools"):
            for file in (ROOT / folder).rglob("*"):
                if file.suffix not in (".h", ".cpp"):
                    continue
                for number, line in enumerate(file.read_text().splitlines(), 1):
                    comment = "" if line.startswith("#include") else line.partition("//")[2]
                    for path in re.findall(r"(?<![\w./<\"])(?:docs/\w+\.md|[\w/]*\w{3}\.(?:h|cpp|py))\b", comment):
                        with self.subTest(where(file, number)):
                            self.assertTrue((ROOT / path).exists() or (ROOT / "src/lamina" / path).exists() or
                                            (ROOT / "tests" / path).exists() or "/" not in path and
                                            any(name.endswith(path) for name in names_of_files()), path)
                    for key in re.findall(r"\[([A-Z][A-Za-z]+(?:19|20)\d\d)[,\]]", comment):
                        with self.subTest(where(file, number)):
                            self.assertTrue(key in known_sources(), f"not in references.bib: {key}")

    def test_every_source_is_in_the_list(self):
        for page in PAGES:
            for key in re.findall(r"\[([A-Z][A-Za-z]+(?:19|20)\d\d)[,\]]", prose(page)):
                with self.subTest(str(page)):
                    self.assertTrue(key in known_sources(), f"not in references.bib: {key}")


def rooms():
    return "|".join(sorted(room.name for room in (ROOT / "src/lamina").iterdir() if room.is_dir()))


@functools.lru_cache(None)
def known_sources():
    return set(re.findall(r"^@\w+\{([\w-]+)", (ROOT / "docs/references.bib").read_text(), re.MULTILINE))


@functools.lru_cache(None)
def anchors(file):
    """Of the headings of a page, as GitHub makes them."""
    headings = re.findall(r"^#+ (.*)$", prose(file), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.replace("`", "").lower()).replace(" ", "-") for heading in headings}


@functools.lru_cache(None)
def names_of_files():
    return {file.name for folder in ("src", "cli", "tests", "tools", "examples", "benchmarks", "scenes", "reproduce")
            for file in (ROOT / folder).rglob("*")} | {file.name for file in ROOT.iterdir()}


@functools.lru_cache(None)
def words_of_sources():
    words = set()
    for folder in ("src", "cli", "schema", "examples", "tools", "cmake", "scenes", "demo", "reproduce", "benchmarks", "tests", "python"):
        for file in (ROOT / folder).rglob("*"):
            if file.suffix in (".h", ".cpp", ".json", ".cmake", ".txt", ".sh", ".py"):
                words.update(re.findall(r"[A-Za-z_]\w*", file.read_text(errors="replace")))
            words.update(file.stem.split("."))
    for name in ("CMakePresets.json", "CMakeLists.txt", "setup.sh", "demo.sh"):
        words.update(re.findall(r"[A-Za-z_]\w*", (ROOT / name).read_text()))
    return words | {"docs", "build"} | {f"{name}_test" for name in test_programs()}


@functools.lru_cache(None)
def test_programs():
    """Folders of tests by the name of their program."""
    text = (ROOT / "tests/CMakeLists.txt").read_text().replace("\n    ", " ")
    programs = {}
    for name, folders in re.findall(r"lamina_test\((\w+) FOLDERS ([\w/ ]+?) (?:SOURCES|LINKS) ", text):
        programs.setdefault(name, set()).update(folders.split())  # some are built in parts without images
    return programs


@functools.lru_cache(None)
def is_known(name):
    """In the sources, or what they begin (`parse_`), or a field whose name they join of two."""
    if name in words_of_sources() or name in NOT_OURS:
        return True
    if name.endswith("_"):
        return any(word.startswith(name) for word in words_of_sources())
    first = re.fullmatch(r"(\w+_)(?:reflected|transmitted)", name)
    return bool(first) and first.group(1) in words_of_sources() | {word + "_" for word in words_of_sources()}


@functools.lru_cache(None)
def keys_of_schemas():
    keys = set()

    def collect(value):
        for key, entry in value.items() if isinstance(value, dict) else []:
            if key == "properties":
                keys.update(entry)
            collect(entry)
        for entry in value if isinstance(value, list) else []:
            collect(entry)

    for file in (ROOT / "schema").glob("*.json"):
        collect(json.loads(file.read_text()))
    return keys


def parsed(text):
    """JSON with comments; a piece of a file counts as what stands in an object."""
    text = re.sub(r'"(?:\\.|[^"\\])*"|//[^\n]*|/\*.*?\*/',
                  lambda token: token.group() if token.group().startswith('"') else "", text, flags=re.DOTALL)
    try:
        return json.loads(text)
    except ValueError:
        return json.loads("{" + text.rstrip().rstrip(",") + "}")


def load_tests(loader, tests, _):
    if PARTS > 1:
        return loader.loadTestsFromTestCase(RunCommands)
    return unittest.TestSuite(suite for suite in tests if PART == 0 or not any(isinstance(test, RunCommands) for test in suite))


if __name__ == "__main__":
    unittest.main()
