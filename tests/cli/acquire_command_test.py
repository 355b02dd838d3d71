# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""What users meet at `lamina acquire`: files, numbers, refusals.

usage: acquire_command_test.py LAMINA SOURCE
"""
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest

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
                    ((os.path.join(CAPTURES, "leaf.json"), "-o", output, "--method", "lbfgs"), ("--method", "leaf")),
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


if __name__ == "__main__":
    unittest.main()
