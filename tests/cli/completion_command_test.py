#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Completion in shells and pages of man: they hold every option, and shells and man take them.

usage: completion_command_test.py LAMINA
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

LAMINA = sys.argv.pop(1)


def lamina(*arguments):
    return subprocess.run([LAMINA, *arguments], capture_output=True, text=True)


def options():
    """{subcommand: [option]} by the help."""
    names = re.findall(r"^  (\w+) {2,}", lamina("--help").stdout.split("Subcommands:")[1], re.MULTILINE)
    return {name: sorted(set(re.findall(r"(?:^  |,)(--[a-z][\w-]*)", lamina(name, "--help").stdout, re.MULTILINE)))
            for name in names}


def completed(*words):
    """What bash offers for the last word."""
    with tempfile.TemporaryDirectory() as folder:
        open(os.path.join(folder, "own.json"), "w").close()
        script = lamina("completion", "bash").stdout + f"""
cd {folder}
COMP_WORDS=(lamina {' '.join(repr(word) for word in words)})
COMP_CWORD={len(words)}
_lamina
printf '%s\\n' "${{COMPREPLY[@]}}"
"""
        done = subprocess.run(["bash", "-c", script], capture_output=True, text=True)
        assert done.returncode == 0 and not done.stderr, done.stderr
        return done.stdout.split()


class Completion(unittest.TestCase):
    def test_every_option_is_in_every_script(self):
        scripts = {kind: lamina("completion", kind).stdout for kind in ("bash", "zsh", "fish")}
        self.assertGreater(len(options()), 12)
        for subcommand, names in options().items():
            self.assertGreaterEqual(len(names), 1)
            page = lamina("completion", "man", subcommand).stdout.replace("\\-", "-")
            for name in names:
                with self.subTest(subcommand, name=name):
                    self.assertIn(name, scripts["bash"])
                    self.assertIn(f"'{name}[", scripts["zsh"])
                    self.assertRegex(scripts["fish"], rf"from {subcommand}'.* -l {name[2:]}\b")
                    self.assertIn(name, page)

    def test_bash_offers_what_fits(self):
        self.assertEqual(completed("sl"), ["slab"])
        self.assertIn("render", completed(""))
        self.assertEqual(completed("slab", "jad"), ["jade"])
        self.assertIn("own.json", completed("slab", "o"))
        self.assertEqual(completed("slab", "jade", "--meth"), ["--method"])
        self.assertEqual(completed("slab", "jade", "--method", "d"), ["diffusion"])
        self.assertEqual(completed("slab", "jade", "--method", "=", "d"), ["diffusion"])
        self.assertEqual(completed("slab", "jade", "--accuracy", ""), [])
        self.assertEqual(completed("completion", "z"), ["zsh"])
        self.assertEqual(completed("nothing", ""), [])

    def test_shells_take_their_scripts(self):
        for shell in ("bash", "zsh", "fish"):
            if not shutil.which(shell):
                print(f"skipped: {shell} is not installed")
                continue
            script = lamina("completion", shell).stdout
            done = subprocess.run([shell, "-n"], input=script, capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""), shell)

    def test_man_takes_its_pages(self):
        if not shutil.which("groff"):
            print("skipped: groff is not installed")
            return
        for subcommand in ["", *options()]:
            page = lamina("completion", "man", *([subcommand] if subcommand else [])).stdout
            done = subprocess.run(["groff", "-man", "-Tutf8", "-P-cbou", "-ww"], input=page, capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""), subcommand)
            for heading in ("NAME", "SYNOPSIS", "OPTIONS", "EXIT STATUS"):
                self.assertIn(heading, done.stdout)

    def test_wrong_use(self):
        for arguments, message in ((["csh"], "must be one of bash, zsh, fish, man"), (["man", "rende"], "page: must be one of"),
                                   (["bash", "slab"], "page: is for man"), ([], "kind is required")):
            done = lamina("completion", *arguments)
            self.assertEqual(done.returncode, 2)
            self.assertIn(message, done.stderr)


if __name__ == "__main__":
    unittest.main()
