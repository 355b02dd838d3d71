# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Runs each subcommand on 1, 2 and 64 threads: what it prints and writes must be the same, byte by byte.

usage: thread_runs.py LAMINA SOURCE [--only NAME ...]

Times of work and the memory that it took are left out of the comparison. Exits with 1 where anything differs.
"""
import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile

from fault_runs import COMMANDS, files_of, make_inputs

# Shards say how much CPU time they took, in what their checksums cover; the pictures of merged ones are
# compared. So do the lists of what `reproduce` finished.
MORE = {"merge_own": "merge {out}/0.shard {in}/1.shard -o {out}/merged.exr"}
HOLD_TIMES = re.compile(r"[.]shard$|finished[.]json$")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("lamina"), parser.add_argument("source")
    parser.add_argument("--only", nargs="*")
    args = parser.parse_args()
    lamina, source = map(os.path.abspath, (args.lamina, args.source))
    findings = []
    with tempfile.TemporaryDirectory() as folder:
        inputs = os.path.join(folder, "in")
        make_inputs(lamina, source, inputs)
        for name in args.only or COMMANDS:
            results = {}
            for threads in (1, 2, 64):
                out = os.path.join(folder, "out")  # the same for all, as some files name it
                shutil.rmtree(out, ignore_errors=True)
                os.makedirs(out)
                commands = [COMMANDS[name]]
                if name == "render_shard":
                    commands = [COMMANDS[name].replace("--samples 2", "--samples 4"), MORE["merge_own"]]
                text = b""
                for command in commands:
                    words = command.format(source=source, out=out, **{"in": inputs}).split()
                    if "completion" not in words:
                        words += ["--threads", str(threads)]
                    result = subprocess.run([lamina, *words], capture_output=True, cwd=folder, env=dict(os.environ, LAMINA_CACHE="off"), timeout=600)
                    if result.returncode != 0:
                        sys.exit(f"{name}: exit code {result.returncode}: {result.stderr.decode()}")
                    text += result.stdout
                text = re.sub(rb"[0-9.]{1,12} (s|ms|ns|CPU-s|MiB)\b", b"", text)
                text = re.sub(rb'"[a-z_]*(seconds|threads)[a-z_]*": [-0-9.e+]+', b"", text)
                results[threads] = (text, {file: what for file, what in files_of(out).items() if not HOLD_TIMES.search(file)})
            for threads in (2, 64):
                if results[threads][0] != results[1][0]:
                    findings.append(f"{name}: prints other things on {threads} threads than on 1")
                for file in sorted(set(results[1][1]) | set(results[threads][1])):
                    if results[threads][1].get(file) != results[1][1].get(file):
                        findings.append(f"{name}: {file} is another on {threads} threads than on 1")
            print(f"{name:17} {len(results[1][1])} files and {len(results[1][0])} bytes of text", flush=True)
    for finding in findings:
        print(finding)
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
