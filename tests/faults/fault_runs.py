# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Runs each subcommand with one call of the system made to fail, over and over.

usage: fault_runs.py LAMINA PRELOAD SOURCE [--first N] [--later N] [--only NAME ...] [--jobs N]

Requests for memory, writes (failing, cut short, disk full), fsyncs and reads: the first N calls of each
in main, and N later ones at random. Asked of every run: it ends within its time, by an exit code and
not by a signal; an exit code of 0 comes with the very result of a run without faults; what it writes
is there whole or not at all, and files that were there before are the old ones or the new ones.
Ends by a signal inside of a library of others are counted apart. Prints a table, and exits with 1 if
anything else was found.
"""
import argparse
import collections
import concurrent.futures
import hashlib
import json
import os
import random
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import zlib

KINDS = {"memory": "memory", "write": "write", "short": "write", "space": "write", "sync": "sync", "read": "read"}

SMALL = ["--set", "width=16", "--set", "height=16", "--set", "mm_per_pixel=0.2"]

# NAME: the command, in which {source} is the tree, {out} a folder for what is written, {in} one for what `INPUTS` made.
COMMANDS = {
    "acquire": "acquire {source}/tests/inputs/capture/good/texture.json -o {out} --lateral none",
    "bsdf": "bsdf donner_jensen_skin --method first_order --json {out}/bsdf.json",
    "bsdf_monte_carlo": "bsdf marble --method monte_carlo --photons 500 --json {out}/bsdf.json",
    "completion": "completion bash",
    "edit": "edit {in}/maps --tan 0.5 --no-preview -o {out}",
    "export": "export jensen_skin1 --to mcx,mcml,pbrt-v4 -o {out}",
    "filters": "filters --count 5 --candidates {in}/bands.csv --json {out}/filters.json",
    "acquire_tiles": "acquire {in}/large.json --tile-memory 2MiB --tiles {out}/tiles -o {out}/maps",
    "fit": "fit {source}/tests/inputs/measurement/good/table.json -o {out}/fit.json --report {out}/fit.html",
    "fit_shard": "fit {source}/examples/measurements/liquid.json --batch {in}/spectra --shard 0/2 --json {out}/fits.json",
    "info": "info {source}/tests/inputs/scene/good/everything.json --json {out}/info.json",
    "invert": "invert --color 0.5 0.3 0.2 --json {out}/invert.json",
    "invert_texture": "invert --texture {source}/examples/layers/brush.png --clamp -o {out}/albedo.exr",
    "maps": f"maps {{source}}/examples/skin/freckles.json {' '.join(SMALL)} -o {{out}} --png",
    "materials": "materials marble --json {out}/marble.json",
    "merge": "merge {in}/0.shard {in}/1.shard -o {out}/merged.exr",
    "merge_fits": "merge {in}/0.fits {in}/1.fits -o {out}/fits.csv --json {out}/fits.json",
    "merge_photons": "merge {in}/0.json {in}/1.json --json {out}/photons.json",
    "patch": "patch {source}/tests/inputs/patch/good/everything.json -o {out}/patch --no-cache",
    "photons": "photons marble --photons 2000 --tally r,angle --json {out}/photons.json --plot {out}/photons.svg",
    "profile": "profile donner_jensen_skin --method diffusion --json {out}/profile.json --plot {out}/profile.svg",
    "render": "render {source}/scenes/bumpy.json --method probe --profile diffusion --width 8 --samples 2 -o {out}/picture",
    "render_cloud": "render {source}/scenes/bumpy.json --method hierarchy --profile diffusion --width 8 --samples 2 --cache {out}/light.ply -o {out}/picture",
    "render_shard": "render {source}/scenes/bumpy.json --method probe --profile diffusion --width 8 --samples 2 --shard 0/2 -o {out}/0.shard",
    "reproduce": "reproduce {in}/item.json -o {out}",
    "slab": "slab donner_jensen_skin --json {out}/slab.json",
}


# What fails in a command that these run is said in their own files, which are then others.
TELLS_OF_FAILURE = {"reproduce"}


def make_inputs(lamina, source, folder):
    def run(*args):
        subprocess.run([lamina, *args], check=True, capture_output=True)
    os.makedirs(folder)
    with open(f"{folder}/bands.csv", "w") as file:
        file.write("wavelength_nm,width_nm\n" + "".join(f"{nm},10\n" for nm in range(450, 700, 50)))
    run("maps", f"{source}/examples/skin/freckles.json", *SMALL, "-o", f"{folder}/maps")
    shutil.copy(f"{source}/tests/inputs/reproduction/good/marble.json", f"{folder}/item.json")
    for i in range(2):
        run("render", f"{source}/scenes/bumpy.json", "--method", "probe", "--profile", "diffusion", "--width", "8", "--samples", "4", "--shard", f"{i}/2", "-o", f"{folder}/{i}.shard")
        run("photons", "marble", "--photons", "2000", "--tally", "r", "--shard", f"{i}/2", "--json", f"{folder}/{i}.json")
    os.makedirs(f"{folder}/spectra")
    for name in "ab":
        shutil.copy(f"{source}/examples/measurements/cuvette.csv", f"{folder}/spectra/{name}.csv")
    for i in range(2):
        run("fit", f"{source}/examples/measurements/liquid.json", "--batch", f"{folder}/spectra", "--shard", f"{i}/2", "--json", f"{folder}/{i}.fits")
    images = []
    for nm, level in ((450, 60), (550, 80), (650, 130)):
        with open(f"{folder}/{nm}.png", "wb") as file:
            file.write(gray_png(80, 70, lambda x, y: level + (x * 7 + y * 3) % 20))
        images.append({"image": f"{nm}.png", "encoding": "linear", "sensor": {"wavelength_nm": nm}})
    with open(f"{folder}/large.json", "w") as file:
        json.dump({"lamina": "capture", "version": 1, "population": "none", "numbers": ["melanin", "hemoglobin_dermis"], "images": images}, file)


def gray_png(width, height, value):
    """8 bits; value(x, y) in [0, 255]."""
    rows = b"".join(b"\0" + bytes(value(x, y) for x in range(width)) for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def hash_of(path):
    with open(path, "rb") as file:
        data = file.read()
    # Times differ from run to run, and so do names of folders.
    text = re.sub(rb'"[a-z_]*seconds[a-z_]*": [-0-9.e+]+|"from_cache": (true|false)', b"", data)
    text = re.sub(rb"(?<![0-9.])[0-9.]{1,12} (s|ms|CPU seconds|seconds)\b", b"", text)
    return hashlib.sha256(text).hexdigest()


def files_of(folder):
    found = {}
    for place, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(place, name)
            found[os.path.relpath(path, folder)] = hash_of(path)
    return found


class Case:
    def __init__(self, args, name):
        self.args, self.name = args, name
        self.base = os.path.join(args.work, name)
        os.makedirs(self.base)
        self.words = COMMANDS[name]

    def run(self, fault, number):
        """Exit code, standard output without times, files, the log of the fault."""
        here = os.path.join(self.base, f"{fault}_{number}")
        out = os.path.join(here, "out")
        os.makedirs(out)
        log = os.path.join(here, "log")
        environment = dict(os.environ, LD_PRELOAD=self.args.preload, LAMINA_CACHE="off", LAMINA_FAULT_LOG=log)
        if fault:
            environment["LAMINA_FAULT"] = f"{fault}:{number}"
        words = self.words.format(source=self.args.source, out=out, **{"in": self.args.inputs}).split()
        try:
            result = subprocess.run([self.args.lamina, *words], capture_output=True, env=environment, timeout=60, cwd=here)
            code, text, said = result.returncode, result.stdout, result.stderr
        except subprocess.TimeoutExpired:
            code, text, said = "hang", b"", b""
        text = re.sub(rb"(?<![0-9.])[0-9.]{1,12} (s|ms)\b", b"", text).replace(out.encode(), b"OUT")
        text = re.sub(rb'"[a-z_]*seconds[a-z_]*": [-0-9.e+]+', b"", text)
        content = ""
        if os.path.exists(log):
            with open(log) as file:
                content = file.read()
        files = files_of(out)
        shutil.rmtree(here)
        return code, text, files, content, said.decode(errors="replace")


def foreign_library(trace, lamina):
    """The library of others in which a run crashed, by the first frame beyond the C and C++ libraries, or by the namespace if its headers are compiled into lamina; else nothing."""
    for line in trace.partition("crash\n")[2].splitlines():
        module, _, place = line.partition("(")
        if re.search(r"libc\.so|libstdc\+\+|libgcc_s|libm\.so|ld-linux|lamina_faults", module):
            continue
        if os.path.basename(module) != os.path.basename(lamina):
            return os.path.basename(module)
        name, _, offset = place.partition(")")[0].rpartition("+")
        where = ["-e", lamina, offset] if not name else None
        function = subprocess.run(["c++filt", name] if name else ["addr2line", "-Cf", *where], capture_output=True, text=True).stdout.splitlines()[0]
        if re.match(r"(void |bool )?std::|operator", function):
            continue
        found = re.match(r"(?:[a-z]+ )?(CLI|nlohmann|tbb|fmt|hwy|Eigen)::", function)
        return found.group(1) if found else ""
    return ""


def check(case, good, fault, number, is_same):
    code, text, files, trace, said = case.run(fault, number)
    good_text, good_files = good
    where = f"{case.name} {fault}:{number}"
    if not trace:
        return "not reached", where
    if code == "hang":
        return "hang", where
    if code < 0 or code >= 128:
        foreign = foreign_library(trace, case.args.lamina)
        what = signal.Signals(-code).name if code < 0 else str(code)
        return (f"in {foreign}" if foreign else "crash", f"{where}: {what} {said.strip()[:200]} {'' if foreign else trace}")
    if code not in (0, 1, 2):
        return "exit code", f"{where}: {code}"
    if code != 0 and not said.strip():
        return "says nothing", where
    leftover = [name for name in files if ".lamina-" in name]
    if leftover and fault != "memory":
        return "left over", f"{where}: {leftover}"
    for name, found in files.items():
        if is_same and name not in leftover and good_files.get(name) != found and name not in case.unequal:
            return "half file", f"{where}: {name}, exit code {code}"
    if code == 0 and is_same and set(files) != set(good_files):
        return "missing file", f"{where}: {sorted(set(good_files) - set(files))}"
    if code == 0 and text != good_text and is_same and not case.text_differs:
        return "wrong result", where
    return ("result in spite of it" if code == 0 else "error", where)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("lamina"), parser.add_argument("preload"), parser.add_argument("source")
    parser.add_argument("--first", type=int, default=300)
    parser.add_argument("--later", type=int, default=300)
    parser.add_argument("--only", nargs="*")
    parser.add_argument("--kinds", nargs="*", default=list(KINDS))
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    args = parser.parse_args()
    args.lamina, args.preload, args.source = map(os.path.abspath, (args.lamina, args.preload, args.source))
    findings, total = [], 0
    with tempfile.TemporaryDirectory() as work:
        args.work, args.inputs = work, os.path.join(work, "in")
        os.environ["TMPDIR"] = work
        make_inputs(args.lamina, args.source, args.inputs)
        for name in args.only or COMMANDS:
            case, randoms = Case(args, name), random.Random(name)
            code, text, files, log, said = case.run("", 0)
            again = case.run("", 1)
            if code != 0:
                sys.exit(f"{name}: without faults the exit code is {code}: {said}")
            # What holds a time or the like cannot be compared.
            case.unequal = {name for name in files if files[name] != again[2].get(name)}
            case.text_differs = text != again[1]
            counts = {kind: int(number) for kind, number in (line.split() for line in log.splitlines())}
            results = collections.Counter()
            with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
                runs = []
                for fault in args.kinds:
                    most = counts[KINDS[fault]]
                    first = min(args.first, most)
                    later = range(first + 1, most + 1)
                    step = max(1, len(later) // max(args.later, 1))  # one at random of each of as many parts
                    drawn = [later[i + randoms.randrange(step)] for i in range(0, len(later) - step + 1, step)][:args.later]
                    numbers = [*range(1, first + 1), *drawn]
                    runs += [pool.submit(check, case, (text, files), fault, number, name not in TELLS_OF_FAILURE) for number in numbers]
                for run in runs:
                    what, where = run.result()
                    results[what] += 1
                    if what not in ("error", "result in spite of it", "not reached") and not what.startswith("in "):
                        findings.append(f"{what}: {where}")
                        print(findings[-1], flush=True)
            total += sum(results.values())
            calls = ", ".join(f"{kind} {number}" for kind, number in counts.items())
            unequal = f"; not compared: {sorted(case.unequal)}{' stdout' if case.text_differs else ''}" if case.unequal or case.text_differs else ""
            print(f"{name:17} {dict(results)} of calls {calls}{unequal}", flush=True)
    print(f"{total} runs, {len(findings)} findings")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
