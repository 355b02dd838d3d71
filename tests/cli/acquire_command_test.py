# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""What users meet at `lamina acquire`: files, numbers, refusals.

usage: acquire_command_test.py LAMINA SOURCE
"""
import json
import math
import os
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zlib

LAMINA, SOURCE = os.path.abspath(sys.argv.pop(1)), os.path.abspath(sys.argv.pop(1))
CAPTURES = os.path.join(SOURCE, "tests/inputs/capture/good")
os.environ["LAMINA_CACHE"] = "off"


def run(*args):
    return subprocess.run([LAMINA, "acquire", *args], capture_output=True, text=True, timeout=120)


class Acquire(unittest.TestCase):
    def test_writes_maps_that_render(self):
        with tempfile.TemporaryDirectory() as folder:
            result = run(os.path.join(CAPTURES, "texture.json"), "-o", folder, "--json", "-")
            self.assertEqual(result.returncode, 0, result.stderr)
            said = json.loads(result.stdout)
            self.assertEqual([n["name"] for n in said["numbers"]], ["melanin", "hemoglobin_dermis", "saturation"])
            for number in said["numbers"]:
                self.assertLess(number["percentile_5"], number["median"])
                self.assertTrue(os.path.getsize(number["file"]) > 0)
                self.assertTrue(os.path.getsize(number["standard_deviation_file"]) > 0)
                self.assertEqual(set(number["change_by_2_percent"]), {"R", "G", "B"})
            self.assertEqual(said["pixels"]["excluded"], 48)  # a quarter of 16 x 12, by the mask
            self.assertEqual(said["lateral"], "none")
            with open(said["report"]) as page:
                text = page.read()
            self.assertIn("a texture", text)
            self.assertNotIn("http://", text.replace("http://www.w3.org", ""))
            with open(said["material"]) as material:
                self.assertEqual(json.load(material)["skin"]["saturation_epidermis"], {"map": "saturation.exr"})

    def test_takes_pixels_of_any_bands_without_a_table(self):
        with tempfile.TemporaryDirectory() as folder:
            result = run(os.path.join(CAPTURES, "bands.json"), "-o", folder, "--json", "-", "--lateral", "none",
                         "--set", "images[+]={\"image\": \"" + os.path.join(CAPTURES, "b550.png") + "\", \"encoding\": \"linear\", \"sensor\": {\"wavelength_nm\": 580}}")
            self.assertEqual(result.returncode, 0, result.stderr)
            said = json.loads(result.stdout)
            self.assertEqual(len(said["residual"]), 4)
            self.assertEqual(len(said["numbers"]), 5)  # without scales and saturation

    def test_refuses_in_one_line_and_leaves_nothing(self):
        texture = os.path.join(CAPTURES, "texture.json")
        with tempfile.TemporaryDirectory() as folder:
            output = os.path.join(folder, "maps")
            for arguments, words in (
                    ((texture, "-o", output + ".exr"), ("folder",)),
                    ((texture, "-o", output, "--lateral", "sideways"), ("--lateral", "transport")),
                    ((texture, "-o", output, "--resume"), ("--resume", "table")),
                    ((texture, "-o", output, "--robust", "3"), ("--robust", "not read")),
                    ((os.path.join(CAPTURES, "leaf.json"), "-o", output, "--robust", "3"), ("--robust", "leaf")),
                    ((os.path.join(CAPTURES, "leaf.json"), "-o", output, "--set", "window=[[0,0],[5,0],[5,4],[0,4]]",
                      "--set", "window_edge=0"), ("even light",)),
                    ((texture, "-o", output, "--set", "population=none", "--set", "numbers=null"), ("3 bands cannot tell 5 numbers",)),
                    ((texture, "-o", output, "--set", "mm_per_pixel=null", "--lateral", "transport"), ("mm_per_pixel", "missing")),
                    ((texture, "-o", output, "--lateral", "transport", "--resume"), ("melanin.exr",)),
                    ((texture, "-o", output, "--set", "images[0].white=1e-5"), ("white", "pixel 0, 0")),
                    ((os.path.join(folder, "none.json"), "-o", output), ("none.json",))):
                result = run(*arguments)
                self.assertEqual(result.returncode, 2, (arguments, result.stderr))
                self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
                for word in words:
                    self.assertIn(word, result.stderr)
                self.assertFalse(os.path.exists(output), arguments)

    def test_hears_an_interrupt_within_a_second(self):
        with tempfile.TemporaryDirectory() as folder:
            output = os.path.join(folder, "maps")
            process = subprocess.Popen([LAMINA, "acquire", os.path.join(CAPTURES, "camera.json"), "-o", output],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(0.5)
            process.send_signal(signal.SIGINT)
            asked = time.monotonic()
            self.assertEqual(process.wait(timeout=20), 130)
            self.assertLess(time.monotonic() - asked, 3.0)  # a busy machine
            self.assertFalse(os.path.exists(output))


def write_gray_png(path, width, height, value):
    """Gray of 16 bits; value(x, y) in [0, 1]."""
    rows = b"".join(b"\0" + b"".join(struct.pack(">H", round(65535 * value(x, y))) for x in range(width)) for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 16, 0, 0, 0, 0))
                   + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


class Tiles(unittest.TestCase):
    """150 x 140 pixels in nine tiles, each pixel by itself so that it is fast."""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = scratch.name
        images = []
        for nm, level in ((450, .25), (550, .3), (650, .5)):
            write_gray_png(self.path(f"{nm}.png"), 150, 140, lambda x, y: level * (1 + .1 * math.sin(x / 9) * math.cos(y / 7)))
            images.append({"image": f"{nm}.png", "encoding": "linear", "sensor": {"wavelength_nm": nm}})
        with open(self.path("capture.json"), "w") as file:
            json.dump({"lamina": "capture", "version": 1, "population": "none",
                       "numbers": ["melanin", "hemoglobin_dermis"], "images": images}, file)
        self.capture = ["capture.json"]

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def run_here(self, *args):
        memory = [] if "--tile-memory" in args else ["--tile-memory", "8MiB"]
        return subprocess.run([LAMINA, "acquire", *self.capture, *memory, *args], capture_output=True, text=True, timeout=120, cwd=self.folder)

    def assertRuns(self, *args):
        result = self.run_here(*args)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result

    def test_of_shards_make_the_maps_of_one_machine_bit_by_bit(self):
        self.assertEqual(self.assertRuns("--check").stdout, "9 tiles\n")
        self.assertRuns("-o", "whole")
        self.assertRuns("-o", "maps", "--tiles", "tiles", "--prepare")
        self.assertEqual(len(os.listdir(self.path("tiles"))), 1)
        for i, count in ((2, 4), (0, 6), (1, 9)):
            self.assertRuns("-o", "maps", "--tiles", "tiles", "--shard", f"{i}/3")
            self.assertEqual(len(os.listdir(self.path("tiles"))), count)
        self.assertFalse(os.path.exists(self.path("maps")))
        # A damaged tile is made again, and one of another capture is not taken.
        kept = self.path("tiles", sorted(os.listdir(self.path("tiles")))[4])
        with open(kept, "r+b") as file:
            file.seek(200)
            byte = file.read(1)[0]
            file.seek(200)
            file.write(bytes([byte ^ 4]))
        self.assertRuns("-o", "maps", "--tiles", "tiles")
        self.assertEqual(len(os.listdir(self.path("tiles"))), 9)
        maps = [name for name in os.listdir(self.path("whole")) if name.endswith(".exr")]
        self.assertGreaterEqual(len(maps), 5)
        for name in maps:
            with open(self.path("whole", name), "rb") as one, open(self.path("maps", name), "rb") as other:
                self.assertEqual(one.read(), other.read(), name)
        self.assertRuns("-o", "maps", "--tiles", "tiles", "--set", "numbers=[\"melanin\"]")
        self.assertEqual(len(os.listdir(self.path("tiles"))), 18)

    def test_are_refused_where_they_cannot_be(self):
        for arguments, words in (
                (("--shard", "0/2"), "--shard: needs --tiles FOLDER"),
                (("--prepare",), "--prepare: needs --tiles FOLDER"),
                (("--tiles", "tiles", "--shard", "2/2"), "--shard: must be I/N"),
                (("--tiles", "tiles", "--resume"), "--resume: does not go with --tiles"),
                (("--tiles", "tiles", "--tile-memory", "1GiB"), "--tiles: must be of a capture that takes more than 1024 MiB")):
            result = self.run_here("-o", "maps", *arguments)
            self.assertEqual(result.returncode, 2, (arguments, result.stderr))
            self.assertIn(words, result.stderr)
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
            self.assertFalse(os.path.exists(self.path("maps")) or os.path.exists(self.path("tiles")), arguments)


if __name__ == "__main__":
    unittest.main()
