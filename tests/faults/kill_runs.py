# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Kills commands by SIGKILL at random moments, and runs them again.

usage: kill_runs.py LAMINA SOURCE [--kills N] [--only NAME ...] [--seed N]

Half of the kills come out of nothing, half up to 60 ms behind an interrupt, on which commands write
down how far they got. Asked after each kill: what lies in the folder is whole, or is not there. Asked
of the run that is let to its end, with --resume where there is such: its files are, byte by byte, those of
a run that nobody disturbed. The cache is shared by all runs and killed with them. Prints a table, and
exits with 1 if anything else was found.
"""
import argparse
import collections
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from fault_runs import COMMANDS, files_of, make_inputs

LARGER_MAPS = ["--set", "width=96", "--set", "height=96", "--set", "mm_per_pixel=0.2"]

SHARD = "render {source}/scenes/bumpy.json --method probe --profile diffusion --width 48 --samples 96 --shard"

# NAME: the command, whether it goes on with --resume, what it keeps while it is not finished.
WORK = {
    "render": ("render {source}/scenes/bumpy.json --method probe --profile diffusion --width 48 --samples 48 -o {out}/picture", True, [".unfinished"]),
    "render_shard": (SHARD + " 1/2 -o {out}/1.shard", True, [".unfinished"]),
    "render_cloud": ("render {source}/scenes/bumpy.json --method hierarchy --profile diffusion --width 24 --samples 4 --cache {out}/light.ply -o {out}/picture", False, []),
    "photons": ("photons marble --photons 60000 --tally r,angle --checkpoint {out}/photons.part --json {out}/photons.json", True, [".part"]),
    "maps": (f"maps {{source}}/examples/skin/freckles.json {' '.join(LARGER_MAPS)} -o {{out}} --png", False, []),
    "patch": ("patch {source}/tests/inputs/patch/good/minimal.json -o {out}/patch", False, []),
    "acquire": (COMMANDS["acquire"], False, []),
    "acquire_tiles": (COMMANDS["acquire_tiles"], False, []),
    "fit_shard": (COMMANDS["fit_shard"], False, []),
    "profile": ("profile donner_jensen_skin --json {out}/profile.json", False, []),
    "reproduce": (COMMANDS["reproduce"], True, [".json"]),
    "merge": (COMMANDS["merge"], False, []),
}
# What is done with a finished file whose bytes hold times, to compare what it means.
THEN = {"render_shard": "merge {in}/first.shard {out}/1.shard -o {out}/merged.exr"}
# Commands whose cache is empty at first in each trial.
FILLS_CACHE = {"profile"}


class Work:
    def __init__(self, args, name):
        self.args, self.name = args, name
        self.command, self.goes_on, self.kept = WORK[name]
        self.environment = dict(os.environ, LAMINA_CACHE=os.path.join(args.work, "cache"))

    def begin(self):
        """A folder for the results of a trial."""
        if self.name in FILLS_CACHE:
            shutil.rmtree(self.environment["LAMINA_CACHE"], ignore_errors=True)
        return tempfile.mkdtemp(dir=self.args.work)

    def start(self, command, out, resumes):
        words = command.format(source=self.args.source, out=out, **{"in": self.args.inputs}).split()
        words += ["--resume"] if resumes else []
        return subprocess.Popen([self.args.lamina, *words], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=self.environment)

    def finish(self, out):
        """Files and seconds, or nothing and what was said."""
        begin = time.monotonic()
        for command, resumes in ((self.command, self.goes_on), (THEN.get(self.name), False)):
            if not command:
                continue
            process = self.start(command, out, resumes)
            said = process.communicate(timeout=300)[1].decode(errors="replace")
            if process.returncode != 0:
                return None, f"exit code {process.returncode}: {said.strip()[:300]}"
        return files_of(out), time.monotonic() - begin


def trial(work, randoms, good, seconds, unequal, results, findings):
    """Kills a run, and those that go on from it, one to three times; then lets it finish."""
    out = work.begin()
    moments = []
    has_partial_result = False  # an interrupted run may have written one, whole
    for _ in range(randoms.randint(1, 3)):
        process = work.start(work.command, out, work.goes_on)
        moment = randoms.uniform(0.0, 1.05 * seconds)
        interrupted = randoms.random() < 0.5
        has_partial_result |= interrupted
        moments.append(f"{moment:.3f} s{' interrupted' if interrupted else ''}")
        try:
            process.communicate(timeout=moment)
        except subprocess.TimeoutExpired:
            if interrupted:
                process.send_signal(signal.SIGINT)
                time.sleep(randoms.uniform(0.0, 0.06))
            process.kill()
            process.communicate()
        results["killed" if process.returncode == -signal.SIGKILL else "over before"] += 1
        if process.returncode not in (0, 130, -signal.SIGINT, -signal.SIGKILL):
            findings.append(f"{work.name}: exit code {process.returncode} at {moments}")
        for name, found in files_of(out).items():
            is_kept = any(name.endswith(end) for end in work.kept) or ".lamina-" in name
            if process.returncode == -signal.SIGKILL and not is_kept and good.get(name) != found and name not in unequal:
                if has_partial_result:
                    results["partial result, as an interrupt asks"] += 1
                else:
                    findings.append(f"{work.name}: {name} is not whole, killed at {moments}")
    files, what = work.finish(out)
    if files is None:
        findings.append(f"{work.name}: {what}, killed at {moments}")
    else:
        files = {name: found for name, found in files.items() if ".lamina-" not in name}
        for name in sorted(set(files) | set(good)):
            if name not in unequal and files.get(name) != good.get(name):
                findings.append(f"{work.name}: {name} differs once finished, killed at {moments}")
        results["finished"] += 1
    shutil.rmtree(out)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("lamina"), parser.add_argument("source")
    parser.add_argument("--kills", type=int, default=200, help="in all")
    parser.add_argument("--only", nargs="*")
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    args.lamina, args.source = map(os.path.abspath, (args.lamina, args.source))
    randoms = random.Random(args.seed)
    names = args.only or list(WORK)
    findings, kills = [], 0
    with tempfile.TemporaryDirectory() as folder:
        args.work, args.inputs = folder, os.path.join(folder, "in")
        make_inputs(args.lamina, args.source, args.inputs)
        for name in names:
            work = Work(args, name)
            if name == "render_shard":
                subprocess.run([args.lamina, *(SHARD + " 0/2 -o {in}/first.shard").format(source=args.source, **{"in": args.inputs}).split()], check=True, capture_output=True)
            runs = []
            for _ in range(2):
                out = work.begin()
                files, seconds = work.finish(out)
                if files is None:
                    sys.exit(f"{name}: {seconds}")
                runs.append((files, seconds))
                shutil.rmtree(out)
            good, seconds = runs[1]
            unequal = {file for file in good if runs[0][0].get(file) != good[file]}
            results = collections.Counter()
            while results["killed"] < args.kills / len(names) and results["over before"] < 10 * args.kills / len(names):
                trial(work, randoms, good, seconds, unequal, results, findings)
            kills += results["killed"]
            print(f"{name:13} {seconds:.2f} s {dict(results)}{f'; not compared: {sorted(unequal)}' if unequal else ''}", flush=True)
    print(f"{kills} kills, {len(findings)} findings")
    for finding in findings:
        print(finding)
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
