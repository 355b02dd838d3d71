# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""What users meet at the command line: help, exit codes, one-line errors, JSON.

usage: command_test.py LAMINA SCENES
"""
import json
import math
import os
import pty
import resource
import select
import signal
import subprocess
import sys
import tempfile
import time
import unittest

LAMINA, SCENES = os.path.abspath(sys.argv.pop(1)), os.path.abspath(sys.argv.pop(1))
os.environ["LAMINA_CACHE"] = "off"


def run(*args):
    return subprocess.run([LAMINA, *args], capture_output=True, text=True, timeout=120)


def json_of(*args):
    result = run(*args, "--json", "-")
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)


def subcommands():
    lines = run("--help").stdout.split("Subcommands:")[1].splitlines()
    return [line.split()[0] for line in lines if line.startswith("  ") and line.strip()]


class Help(unittest.TestCase):
    def test_every_subcommand_has_help_with_an_example(self):
        self.assertGreaterEqual(set(subcommands()), {"materials", "slab", "profile", "render"})
        for command in subcommands():
            result = run(command, "--help")
            self.assertEqual(result.returncode, 0, command)
            self.assertIn(f"lamina {command}", result.stdout, command)
            if command != "completion":  # it prints a script or a page, nothing else
                self.assertIn("--json", result.stdout, command)


class ChangesOfMaterials(unittest.TestCase):
    """A built-in material with changes is one thing, however it is asked for."""

    def test_set_and_base_are_the_same(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "darker.json")
            with open(file, "w") as out:
                out.write('{"lamina": "material", "base": "skin_type_2", "skin": {"melanin": 0.1}}')
            for command, key in (("slab", "diffuse_reflectance"), ("materials", "material")):
                by_option = json_of(command, "skin_type_2", "--set", "skin.melanin=.1", "--bands", "500,600")
                self.assertEqual(by_option[key], json_of(command, file, "--bands", "500,600")[key], command)
            for command in ("profile", "bsdf", "photons", "export"):
                self.assertIn("--set KEY=VALUE", run(command, "--help").stdout, command)
            light = json_of("slab", "skin_type_2", "--bands", "500,600")["diffuse_reflectance"]
            dark = json_of("slab", file, "--bands", "500,600")["diffuse_reflectance"]
            self.assertLess(dark[0], 0.5 * light[0])

    def test_wrong_ones_are_named_where_they_stand(self):
        result = run("slab", "skin_type_2", "--set", "skin.melanin=.9")
        self.assertEqual(result.returncode, 2)
        self.assertIn("--set skin.melanin must lie in [0, 0.5], but is 0.9", result.stderr)
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "m.json")
            with open(file, "w") as out:
                out.write('{"lamina": "material",\n "base": "skin_typ_2"}')
            result = run("slab", file)
            self.assertEqual(result.returncode, 2)
            self.assertIn('m.json:2: base: there is no built-in material and no file "skin_typ_2"; did you mean "skin_type_', result.stderr)

    def test_a_material_without_a_name_has_that_of_its_file(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "my_board.json")
            with open(file, "w") as out:
                out.write('{"lamina": "material", "version": 1, "length_unit": "mm", "bands": "rgb", '
                          '"layers": [{"sigma_a": 1, "sigma_s": 9, "g": 0, "ior": 1.4, "thickness": "infinite"}]}')
            self.assertEqual(json_of("slab", file)["material"], "my_board")


class Outputs(unittest.TestCase):
    def test_name_that_is_too_long_is_found_before_the_work(self):
        name, inputs = "y" * 300, os.path.join(os.path.dirname(SCENES), "tests/inputs")
        for args in (["photons", "jade", "--photons", "1e15", "--json", name + ".json"],
                     ["photons", "jade", "--photons", "1e15", "--checkpoint", name],
                     ["slab", "jade", "--json", name + ".json"],
                     ["export", "jade", "--to", "mitsuba3", "-o", name + ".xml"],
                     ["maps", inputs + "/maps/good/everything.json", "-o", name],
                     ["acquire", inputs + "/capture/good/strips.json", "-o", name],
                     ["patch", inputs + "/patch/good/minimal.json", "-o", name + ".png"]):
            with self.subTest(" ".join(args)):
                result = run(*args)
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assertIn("File name too long", result.stderr)
                self.assertEqual(result.stderr.count("\n"), 1, result.stderr)


class WrongUse(unittest.TestCase):
    def check(self, args, *words):
        result = run(*args)
        self.assertEqual(result.returncode, 2, (args, result.stderr))
        self.assertEqual(result.stdout, "", args)
        self.assertEqual(result.stderr.count("\n"), 1, (args, result.stderr))
        for word in words:
            self.assertIn(word, result.stderr, args)

    def test_is_one_line_and_exit_code_2(self):
        self.check([])
        self.check(["nonsense"], "nonsense")
        self.check(["slab"])
        self.check(["slab", "donner_jensen_skim"], "donner_jensen_skin")
        self.check(["slab", "donner_jensen_skin", "--incidence", "91"], "91")
        self.check(["slab", "donner_jensen_skin", "--method", "magic"], "magic")
        self.check(["profile", "no/such/file.json"], "no/such/file.json")
        self.check(["profile", "donner_jensen_skin", "--radii", "-3"], "-3")
        self.check(["render", "no_such_scene.json"], "no_such_scene.json")
        self.check(["materials", "jad"], "jade")

    def test_says_what_a_file_of_another_kind_is_and_who_takes_it(self):
        commands = {"render": ("scene", []), "patch": ("patch", []), "maps": ("maps", []), "fit": ("measurement", []),
                    "acquire": ("capture", ["-o", "x"]), "slab": ("material", []), "profile": ("material", []), "bsdf": ("material", []),
                    "photons": ("material", []), "materials": ("material", []), "export": ("material", ["--to", "table"]),
                    "reproduce": ("reproduction", [])}
        takers = {"scene": "lamina render", "material": "lamina slab", "patch": "lamina patch", "maps": "lamina maps", "capture": "lamina acquire",
                  "measurement": "lamina fit", "job": "lamina submit", "population": "lamina edit"}
        with tempfile.TemporaryDirectory() as folder:
            for kind, taker in takers.items():
                file = os.path.join(folder, kind + ".json")
                with open(file, "w") as out:
                    json.dump({"lamina": kind, "version": 1}, out)
                for command, (takes, options) in commands.items():
                    if takes != kind:
                        self.check([command, file, *options], f'must be "{takes}"', f'but is "{kind}": ', taker)

    def test_names_the_new_name_of_a_method(self):
        for command, before, now in (("slab", "adding_doubling", "radiative_transfer"), ("slab", "exact", "radiative_transfer"),
                                     ("profile", "exact", "radiative_transfer"), ("profile", "multipole", "diffusion"),
                                     ("bsdf", "adding_doubling", "radiative_transfer")):
            self.check([command, "jade", "--method", before], before, f'did you mean "{now}"?')
        scene = os.path.join(SCENES, "sphere_skin.json")
        for option, before, now in (("--method", "profile", "probe"), ("--profile", "exact", "radiative_transfer"),
                                    ("--profile", "multipole", "diffusion")):
            self.check(["render", scene, option, before], option, before, f'did you mean "{now}"?')

    def test_refuses_options_that_nothing_would_read(self):
        self.check(["slab", "jade", "--method", "diffusion", "--accuracy", "1e-3"], "--accuracy", "radiative_transfer")
        self.check(["slab", "jade", "--photons", "100"], "--photons", "monte_carlo")
        self.check(["slab", "jade", "--compare", "--method", "diffusion"], "--method")
        self.check(["profile", "jade", "--method", "dipole", "--no-cache"], "--no-cache", "radiative_transfer")
        self.check(["bsdf", "jade", "--method", "monte_carlo", "--step", "5"], "--step")
        self.check(["bsdf", "jade", "--eta", "1.3"], "--eta", "rough_transmission")
        self.check(["bsdf", "--model", "rough_transmission", "--orders"], "--orders", "MATERIAL")
        self.check(["photons", "jade", "--dr", "0.1"], "--dr", "--tally r")
        self.check(["photons", "jade", "--beam-radius", "1"], "--beam")
        self.check(["photons", "jade", "--plot", "x.svg"], "needs --tally r, angle or time")
        self.check(["filters", "--count", "4"], "must lie in [5, 31], numbers to candidates, but is 4")
        self.check(["filters", "--compare", "401"], "must be of the candidates, but one is 401 nm")
        self.check(["filters", "--numbers", "melanine"], "must be of melanin, melanin_blend,")
        self.check(["filters", "--candidates", "nowhere.csv"], "nowhere.csv")
        self.check(["photons", "jade", "--output", "."], ".mci")

    def test_refuses_numbers_that_are_none(self):
        tally = ["photons", "jade", "--photons", "100", "--tally", "r,log_r"]
        for option, value in (("--dr", "1e-320"), ("--dr", "nan"), ("--dr", "inf"), ("--dr", "-1"), ("--dr", "0x1p3"),
                              ("--detector", "1e308"), ("--detector-width", "1e-300"), ("--log-range", "0"),
                              ("--seed", "-1"), ("--seed", "1.5"), ("--seed", "1e30"), ("--seed", "18446744073709551616"),
                              ("--r-bins", "1e-3"), ("--r-bins", "1e10"), ("--beam-radius", "nan"),
                              ("--photons", "nan"), ("--threads", "-1")):
            extra = ["1"] if option == "--log-range" else []
            self.check([*tally, option, value, *extra], option, "must be", value)
        self.check([*tally, "--direction", "10", "nan"], "--direction", "finite", "nan")
        self.check(["profile", "jade", "--r-min", "1e-320"], "--r-min", "must be in")
        self.check(["bsdf", "jade", "--theta-i", "nan"], "--theta-i", "nan")
        self.check(["render", "x.json", "--samples", "1.5"], "--samples", "whole number")
        self.check(["render", "x.json", "--exposure", "nan"], "--exposure")

    def test_refuses_endings_that_are_not_those_of_what_is_written(self):
        scene = os.path.join(SCENES, "sphere_skin.json")
        self.check(["slab", "jade", "--plot", "x.png"], "--plot")  # no such option
        for command in (["profile", "jade"], ["bsdf", "jade"], ["photons", "jade", "--tally", "r"]):
            self.check([*command, "--plot", "x.png"], "--plot", ".svg", "x.png")
        self.check(["render", scene, "-o", "x.jpg"], "--output", ".exr or .png", "x.jpg")
        self.check(["patch", "x.json", "-o", "x.svg"])
        self.check(["maps", "x.json", "-o", "x.png"], "--output", "folder")
        self.check(["render", "-"], "--output")

    def test_refuses_files_beyond_the_memory_budget(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "long.json")
            with open(path, "w") as file:
                file.write("[" + "0, " * 100_000 + "0]")
            self.check(["slab", path, "--memory-budget", "1MiB"], path, "more memory", "budget")
            self.check(["slab", path, "--memory-budget", "1GiB"], "must be an object")
            self.check(["slab", path, "--memory-budget", "5"], "--memory-budget", "unit", '"5"')
            os.environ["LAMINA_MEMORY_BUDGET"] = "1MiB"
            try:
                self.check(["slab", path], path, "budget")
                self.check(["slab", path, "--memory-budget", "1GiB"], "must be an object")
            finally:
                del os.environ["LAMINA_MEMORY_BUDGET"]

    def test_names_file_line_and_field(self):
        with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
            file.write('{ "lamina": "material", "version": 1,\n "length_unit": "mm", "bands": "rgb",\n'
                       ' "layers": [ {\n  "sigma_a": -1, "sigma_s": 2, "g": 0, "ior": 1.3,'
                       ' "thickness": "infinite" } ] }')
            file.flush()
            self.check(["slab", file.name], file.name + ":4", "layers[0].sigma_a", "-1")


class FailedWork(unittest.TestCase):
    def test_a_result_that_cannot_be_written_is_exit_code_1(self):
        result = run("slab", "jade", "--method", "diffusion", "--json", "/no/such/folder/x.json")
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr.count("\n"), 1)

    def test_that_is_found_before_the_work(self):
        for args in (["--json", "/no/such/folder/x.json"], ["--plot", "/"]):
            result = run("profile", "jade", "--method", "monte_carlo", "--photons", "1e15", *args)
            self.assertEqual(result.returncode, 1)
            self.assertEqual(result.stdout, "")
            self.assertIn("cannot be written", result.stderr)

    @unittest.skipUnless(hasattr(os, "mkfifo"), "needs links")
    def test_a_link_stays_a_link(self):
        with tempfile.TemporaryDirectory() as folder:
            target, link = os.path.join(folder, "target.json"), os.path.join(folder, "link.json")
            open(target, "w").close()
            os.symlink(target, link)
            self.assertEqual(run("slab", "jade", "--method", "diffusion", "--json", link).returncode, 0)
            self.assertTrue(os.path.islink(link))
            self.assertGreater(os.path.getsize(target), 0)


    @unittest.skipUnless(os.path.exists("/dev/full"), "needs a device that is full")
    def test_a_full_disk_is_exit_code_1(self):
        for args in (["--help"], ["--version"], ["slab", "--help"], ["materials"], ["materials", "jade"],
                     ["slab", "jade", "--method", "diffusion"],
                     ["slab", "jade", "--method", "diffusion", "--json", "-"],
                     ["slab", "jade", "--method", "diffusion", "--json", "/dev/full"],
                     ["profile", "jade", "--method", "dipole", "--radii", "5"],
                     ["photons", "jade", "--photons", "100"],
                     ["bsdf", "leaf", "--method", "first_order", "--plot", "/dev/full"]):
            with open("/dev/full", "w") as full:
                result = subprocess.run([LAMINA, *args], stdout=full, stderr=subprocess.PIPE, text=True, timeout=120)
            self.assertEqual(result.returncode, 1, args)
            self.assertIn("cannot be written: No space left on device", result.stderr, args)
            self.assertEqual(result.stderr.count("\n"), 1, args)

    def test_a_file_has_the_result_even_if_standard_output_does_not(self):
        result = subprocess.run([LAMINA, "slab", "jade", "--method", "diffusion", "--json", "kept.json"],
                                preexec_fn=lambda: os.close(1), stderr=subprocess.PIPE, timeout=120)
        self.assertEqual(result.returncode, 1)
        with open("kept.json") as file:
            self.assertEqual(json.load(file)["command"], "slab")

    def test_missing_memory_is_exit_code_1(self):
        """At every size of the address space the scene is rendered, or refused as work that failed."""
        codes = set()
        for mebibytes in range(60, 1000, 40):
            limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (mebibytes << 20, mebibytes << 20))
            result = subprocess.run([LAMINA, "render", os.path.join(SCENES, "sphere_skin.json"), "--samples", "1", "--profile", "diffusion",
                                     "--width", "8", "--height", "8", "--threads", "1", "-o", "memory.png"],
                                    preexec_fn=limit, capture_output=True, text=True)
            codes.add(result.returncode)
            self.assertIn(result.returncode, (0, 1, 127), (mebibytes, result.stderr))  # 127: not even loaded
        self.assertLessEqual({0, 1}, codes)

    def test_a_file_that_may_not_grow_so_large_keeps_the_last_good_one(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "x.json")
            with open(file, "w") as good:
                good.write("the last good one")
            limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (512, 512))
            result = subprocess.run([LAMINA, "profile", "jade", "--method", "dipole", "--json", file],
                                    preexec_fn=limit, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            self.assertEqual(result.returncode, 1)
            self.assertIn("File too large", result.stderr)
            self.assertEqual(os.listdir(folder), ["x.json"])
            with open(file) as good:
                self.assertEqual(good.read(), "the last good one")


class Stopping(unittest.TestCase):
    """By Ctrl-C, by kill, and by the end of the terminal."""

    def stop(self, args, how, until=b" s "):
        """Starts lamina on a terminal and sends a signal once its bar says `until`.
        @return exit code, seconds that this took, what it said"""
        ours, theirs = pty.openpty()
        process = subprocess.Popen([LAMINA, *args], stdout=subprocess.DEVNULL, stderr=theirs,
                                   preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_DFL))
        os.close(theirs)
        said = b""
        try:
            while until not in said:
                self.assertTrue(select.select([ours], [], [], 60)[0], (args, said))
                said += os.read(ours, 4096)
            process.send_signal(how)
            start = time.monotonic()
            try:
                while chunk := os.read(ours, 4096):
                    said += chunk
            except OSError:  # how a terminal ends
                pass
            return process.wait(60), time.monotonic() - start, said.decode()
        finally:
            process.kill()
            process.wait()
            os.close(ours)

    def test_work_without_a_result_ends_at_once_and_leaves_the_last_good_one(self):
        with tempfile.TemporaryDirectory() as folder:
            good = os.path.join(folder, "good.json")
            exact = ["profile", "donner_jensen_skin", "--accuracy", "1e-4", "--no-cache", "--json", good]
            for how in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
                with open(good, "w") as file:
                    file.write("the last good one")
                code, seconds, said = self.stop(exact, how)
                self.assertEqual(code, 130, said)
                self.assertLess(seconds, 1)
                self.assertIn("interrupted", said)
                with open(good) as file:
                    self.assertEqual(file.read(), "the last good one")
            self.assertEqual(os.listdir(folder), ["good.json"])

    def test_a_picture_is_not_replaced_before_there_is_another(self):
        with tempfile.TemporaryDirectory() as folder:
            good = os.path.join(folder, "good.png")
            with open(good, "w") as file:
                file.write("the last good one")
            scene = os.path.join(SCENES, "sphere_skin.json")
            code, seconds, said = self.stop(["render", scene, "-o", good], signal.SIGINT)
            self.assertEqual(code, 130, said)
            self.assertLess(seconds, 1)
            with open(good) as file:
                self.assertEqual(file.read(), "the last good one")
            self.assertEqual(os.listdir(folder), ["good.png"])

    def test_work_with_a_result_keeps_it_and_says_what_a_second_time_does(self):
        for how in (signal.SIGINT, signal.SIGTERM):
            with tempfile.TemporaryDirectory() as folder:
                file = os.path.join(folder, "photons.json")
                args = ["bsdf", "leaf", "--method", "monte_carlo", "--photons", "1e12", "--json", file]
                code, seconds, said = self.stop(args, how, b"left")
                self.assertEqual(code, 130, said)
                self.assertLess(seconds, 2)
                self.assertIn("once more ends at once", said)
                with open(file) as result:
                    self.assertEqual(json.load(result)["command"], "bsdf")


class Input(unittest.TestCase):
    def test_may_come_from_standard_input(self):
        material = run("materials", "jade").stdout
        piped = subprocess.run([LAMINA, "slab", "-", "--json", "-"], input=material, capture_output=True, text=True)
        self.assertEqual(piped.returncode, 0, piped.stderr)
        self.assertEqual(json.loads(piped.stdout)["diffuse_reflectance"],
                         json_of("slab", "jade")["diffuse_reflectance"])
        wrong = subprocess.run([LAMINA, "slab", "-"], input='{ "lamina":\n 1 }', capture_output=True, text=True)
        self.assertEqual(wrong.returncode, 2)
        self.assertIn("-:", wrong.stderr)

    def test_whole_numbers_may_have_exponents(self):
        few = json_of("photons", "jade", "--photons", "100", "--tally", "r", "--r-bins", "2e1", "--seed", "010")
        self.assertEqual(few, json_of("photons", "jade", "--photons", "1e2", "--tally", "r", "--r-bins", "20",
                                      "--seed", "1e1"))


class Output(unittest.TestCase):
    def test_names_of_pictures(self):
        scene = os.path.join(SCENES, "sphere_skin.json")
        small = ["--samples", "1", "--width", "8", "--height", "8", "--profile", "diffusion"]
        for name, files in (("beauty.0001", ["beauty.0001.exr", "beauty.0001.png"]), ("a.PNG", ["a.PNG"]),
                            ("b.exr", ["b.exr"]), (".", ["sphere_skin.exr", "sphere_skin.png"])):
            with tempfile.TemporaryDirectory() as folder:
                output = os.path.join(folder, name)
                result = run("render", scene, *small, "-o", output)
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertEqual(sorted(os.listdir(folder)), files)

    @unittest.skipUnless(os.path.isdir("/proc/self/task"), "counts threads as Linux shows them")
    def test_threads_are_those_asked_for(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "square.obj"), "w") as file:
                file.write("v 0 0 0\nv 5 0 0\nv 5 5 0\nv 0 5 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n")
            recipe = os.path.join(folder, "maps.json")
            with open(recipe, "w") as file:
                json.dump({"lamina": "maps", "version": 1, "width": 512, "height": 512, "skin": {},
                           "surface": {"file": "square.obj", "mm_per_unit": 10},
                           "features": [{"freckles": {"density": 9}}]}, file)
            process = subprocess.Popen([LAMINA, "maps", recipe, "-o", folder, "--threads", "1"], stdout=subprocess.DEVNULL)
            most = 1
            while process.poll() is None:
                try:
                    most = max(most, len(os.listdir(f"/proc/{process.pid}/task")))
                except FileNotFoundError:
                    pass
            self.assertEqual(process.returncode, 0)
            self.assertEqual(most, 1)


class Messages(unittest.TestCase):
    def test_show_what_files_hold_as_printable_text_of_bounded_length(self):
        for name, shown in (("\x1b[31mred", "\\x1b[31mred"), ("two\nlines", "two\\x0alines"), ("\x9bred", "\\xc2\\x9bred"),
                            ("turned\u202e", "turned\\xe2"), ("Käse 乳 🧀", "Käse 乳 🧀"), ("long" * 1000, " ... ")):
            result = run("slab", name)
            self.assertEqual(result.returncode, 2)
            self.assertIn(shown, result.stderr)
            self.assertEqual(result.stderr.count("\n"), 1)
            self.assertLess(len(result.stderr), 2200)
        with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
            json.dump({"lamina": "material", "version": 1, "name": "\x1b[2J", "length_unit": "mm", "bands": "rgb",
                       "layers": [{"name": "\x1b]0;title\x07" + "x" * 10000, "sigma_a": 1, "sigma_s": 2, "g": 0,
                                   "ior": 1.3, "thickness": "infinite"}]}, file)
            file.flush()
            result = run("slab", file.name, "--method", "diffusion")
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertNotIn("\x1b", result.stdout)

    def test_that_cannot_be_written_change_nothing(self):
        for code, args in ((2, ["nonsense"]), (0, ["slab", "jade", "--method", "diffusion"])):
            with open("/dev/full", "w") as full:
                self.assertEqual(subprocess.run([LAMINA, *args], stderr=full, stdout=subprocess.DEVNULL).returncode, code)
            closed = subprocess.run([LAMINA, *args], stdout=subprocess.DEVNULL, preexec_fn=lambda: os.close(2))
            self.assertEqual(closed.returncode, code)

    def test_suggest_the_name_that_was_meant(self):
        for args, meant in ((["rendr"], '"render"'), (["render", "x.json", "--smaples", "3"], '"--samples"'),
                            (["slab", "jade", "--acuracy=1e-3"], '"--accuracy"')):
            result = run(*args)
            self.assertEqual(result.returncode, 2)
            self.assertIn("did you mean " + meant, result.stderr)


class Colors(unittest.TestCase):
    def on_terminal(self, **environment):
        ours, theirs = pty.openpty()
        env = {key: value for key, value in os.environ.items() if key not in ("NO_COLOR", "TERM")} | environment
        process = subprocess.Popen([LAMINA, "slab", "jade", "--method", "diffusion"], stdout=theirs, env=env)
        os.close(theirs)
        text = b""
        try:
            while piece := os.read(ours, 4096):
                text += piece
        except OSError:
            pass  # the end of a terminal
        os.close(ours)
        self.assertEqual(process.wait(), 0)
        return text.decode()

    def test_are_shown_on_terminals_only(self):
        color = json_of("slab", "jade", "--method", "diffusion")["color"]["reflected"]
        chip = "\x1b[48;2;%d;%d;%dm" % tuple(color["srgb"])
        self.assertIn(chip, self.on_terminal(TERM="xterm-256color"))
        for text in (self.on_terminal(TERM="xterm", NO_COLOR="1"), self.on_terminal(TERM="dumb"), self.on_terminal(),
                     run("slab", "jade", "--method", "diffusion").stdout):
            self.assertNotIn("\x1b", text)
            self.assertIn(color["hex"], text)


class Json(unittest.TestCase):
    def test_says_what_made_it(self):
        result = json_of("slab", "donner_jensen_skin", "--method", "diffusion")
        self.assertEqual(result["command"], "slab")
        self.assertEqual(result["method"], "diffusion")
        self.assertEqual(result["bands"], ["R", "G", "B"])
        for key in ("specular_reflectance", "diffuse_reflectance", "transmittance"):
            self.assertEqual(len(result[key]), 3)
        self.assertEqual([len(layer) for layer in result["absorptance"]], [3, 3, 3])

    def test_has_the_color_of_slabs(self):
        """srgb_encode(.5) = .7354 -> 188; a clear red filter over a black ground has only a color seen through."""
        result = json_of("slab", "donner_jensen_skin", "--method", "diffusion")
        color = result["color"]["reflected"]
        self.assertEqual(color["linear_srgb"], result["diffuse_reflectance"])
        encoded = [255 * (1.055 * x ** (1 / 2.4) - .055) for x in result["diffuse_reflectance"]]
        self.assertEqual(color["srgb"], [round(x) for x in encoded])
        self.assertEqual(color["hex"], "#%02x%02x%02x" % tuple(color["srgb"]))
        self.assertNotIn("transmitted", result["color"])
        self.assertIn("transmitted", json_of("slab", "green_leaf", "--method", "diffusion")["color"])
        self.assertNotIn("color", json_of("slab", "green_leaf", "--method", "diffusion", "--bands", "500,600"))

    def test_slabs_without_absorption_are_white_in_any_bands(self):
        white = {"lamina": "material", "version": 1, "length_unit": "mm", "bands": [430, 480, 550, 620],
                 "layers": [{"sigma_a": 0, "sigma_s": 1, "g": 0, "ior": 1, "thickness": "infinite"}]}
        result = subprocess.run([LAMINA, "slab", "-", "--json", "-"], input=json.dumps(white), capture_output=True, text=True)
        self.assertEqual(json.loads(result.stdout)["color"]["reflected"]["hex"], "#ffffff", result.stderr)

    def test_has_null_only_where_there_is_no_value_to_have(self):
        clear = {"lamina": "material", "version": 1, "length_unit": "mm", "bands": "rgb", "ior_below": 1,
                 "layers": [{"sigma_a": 1, "sigma_s": 0, "g": 0, "ior": 1.3, "thickness": 1}]}
        result = subprocess.run([LAMINA, "slab", "-", "--compare=100", "--json", "-"], input=json.dumps(clear),
                                capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual({row["diffusion"] for row in json.loads(result.stdout)["rows"]}, {None})

    def test_light_is_neither_lost_nor_made(self):
        for method in ("diffusion",):
            result = json_of("slab", "parchment", "--method", method)
            for band in range(3):
                total = sum(result[key][band] for key in
                            ("specular_reflectance", "diffuse_reflectance", "transmittance"))
                total += sum(layer[band] for layer in result["absorptance"])
                self.assertAlmostEqual(total, 1.0, delta=1e-6)

    def test_bsdf_by_photons_counts_all_scattered_light(self):
        result = json_of("bsdf", "leaf", "--theta-i", "30", "--method", "monte_carlo", "--photons", "2e4",
                         "--cosines", "6", "--azimuths", "8", "--orders")
        rows, columns = len(result["theta_o_deg"]), len(result["phi_o_deg"])
        self.assertEqual((rows, columns), (6, 4))
        cell = 2 * math.pi / (rows * columns)
        for side, total, straight in (("brdf", "diffuse_reflectance", "unscattered_reflectance"),
                                      ("btdf", "transmittance", "unscattered_transmittance")):
            self.assertEqual(len(result[side + "_by_order"]), 12)
            for band in range(3):
                flux = sum(result[side][i][j][band] * (1 - (i + .5) / rows) * cell
                           for i in range(rows) for j in range(columns))
                self.assertAlmostEqual(flux, result[total][band] - result[straight][band], places=9)
                by_order = sum(plane[2][1][band] for plane in result[side + "_by_order"])
                self.assertAlmostEqual(by_order, result[side][2][1][band], places=9)
                self.assertGreater(result["standard_error"][side][2][1][band], 0)

    def test_bsdf_by_photons_is_that_of_adding_doubling(self):
        photons = json_of("bsdf", "leaf", "--theta-i", "60", "--method", "monte_carlo", "--photons", "2e5",
                          "--cosines", "8", "--azimuths", "24")
        exact = json_of("bsdf", "leaf", "--theta-i", "60", "--step", "5", "--accuracy", "1e-2")
        # At cosine 7/8 in the middle of its row, 30 degrees; away from the light and towards it.
        row = min(range(8), key=lambda i: abs(photons["theta_o_deg"][i] - 36))
        theta = photons["theta_o_deg"][row]
        for side in ("brdf", "btdf"):
            for column, phi in ((0, 0), (-1, -1)):
                low = int(theta // 5)
                t = theta / 5 - low
                expected = (1 - t) * exact[side][low][phi][1] + t * exact[side][low + 1][phi][1]
                error = photons["standard_error"][side][row][column][1]
                self.assertLess(abs(photons[side][row][column][1] - expected), 4 * error + 0.02 * expected)

    def test_profile_has_the_shape_that_it_states(self):
        result = json_of("profile", "donner_jensen_skin", "--method", "diffusion", "--radii", "40")
        self.assertEqual(result["per"], "entered_flux")
        self.assertEqual(len(result["r_mm"]), 40)
        self.assertEqual({len(row) for row in result["reflectance_profile"]}, {3})
        for total, expected in zip(result["total_reflectance"], (0.40861, 0.39882, 0.33281)):
            self.assertAlmostEqual(total, expected, delta=1e-4)


if __name__ == "__main__":
    os.chdir(tempfile.mkdtemp())
    unittest.main()
