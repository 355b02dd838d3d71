# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""The files of `lamina photons`: shards that were changed, checkpoints, MCML's outputs, azimuths.

usage: photons_files_test.py LAMINA
"""
import copy
import json
import math
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest

LAMINA = sys.argv.pop(1)
MASK = (1 << 64) - 1
HAZE = {"lamina": "material", "version": 1, "name": "haze", "length_unit": "mm", "bands": [500],
        "ior_below": 1.0, "layers": [{"sigma_a": 0.01, "sigma_s": 1, "g": 0.8, "ior": 1.0, "thickness": 0.5}]}


def run(*args, **options):
    return subprocess.run([LAMINA, *args], capture_output=True, text=True, timeout=120, **options)


def strict(text):
    """JSON without NaN and infinities, and without null."""
    def refuse(name):
        raise ValueError(name)

    def check(value):
        assert value is not None, "null"
        for inner in value.values() if isinstance(value, dict) else value if isinstance(value, list) else ():
            check(inner)
        return value
    return check(json.loads(text, parse_constant=refuse))


def checksum(run_of_file):
    """core/hash.h of the text of a run: its length, then words of eight bytes."""
    text = json.dumps(run_of_file, separators=(",", ":"), ensure_ascii=False).encode()
    words = [len(text)] + [int.from_bytes(text[i:i + 8], "little") for i in range(0, len(text), 8)]
    value = 0
    for word in words:
        value = ((value ^ word) + 0x9e3779b97f4a7c15) & MASK
        value = ((value ^ (value >> 30)) * 0xbf58476d1ce4e5b9) & MASK
        value = ((value ^ (value >> 27)) * 0x94d049bb133111eb) & MASK
        value ^= value >> 31
    return f"{value:016x}"


def signed(document):
    """With the checksums of what it says."""
    for entry in document["counts"] or ():
        entry.pop("checksum", None)
        entry["checksum"] = checksum(entry)
    return document


def places(value, path=()):
    """The places of all numbers, strings, flags and lists."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from places(inner, path + (key,))
        return
    yield path
    if isinstance(value, list):
        for i, inner in enumerate(value):
            yield from places(inner, path + (i,))


def changes(value):
    """What a value might be changed to."""
    if isinstance(value, bool):
        yield from (not value, 0, None)
    elif isinstance(value, (int, float)):
        yield from (-1, 0, 1e308, 1e-320, 10**30, 2**53, value + 1, None, "x")
    elif isinstance(value, str):
        yield from ("", "x", value[:-1], value + "0", value.replace("0", "f"), 0, None)
    else:
        yield from ([], value[:-1], value + value[-1:], None)


def put(document, path, value):
    document = copy.deepcopy(document)
    at = document
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = value
    return document


class ChangedShards(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        tallies = ["--tally", "r,angle,rz,fluence,log_r,bsdf,orders,path,time", "--r-bins", "2", "--z-bins", "1",
                   "--angle-bins", "1", "--log-bins", "1", "--bsdf-cosines", "1", "--bsdf-azimuths", "2",
                   "--path-bins", "1", "--time-bins", "1", "--frequency", "100", "--detector", "1", "--direction", "30", "0"]
        with open("haze.json", "w") as file:
            json.dump(HAZE, file)
        for shard in range(2):
            result = run("photons", "haze.json", "--photons", "1000", "--shard", f"{shard}/2", *tallies,
                         "--json", f"{shard}.json")
            assert result.returncode == 0, result.stderr
        with open("0.json") as file:
            cls.document = {"counts": json.load(file)["counts"]}
        merged = run("merge", "0.json", "1.json", "--json", "-")
        cls.right = strict(merged.stdout)

    def merge(self, document):
        with open("changed.json", "w") as file:
            json.dump(document, file)
        return run("merge", "changed.json", "1.json", "--json", "-")

    def check(self, document, what, is_signed):
        """Refused in a line, or a right result; with a right checksum at least one of numbers."""
        result = self.merge(document)
        if result.returncode == 0:
            merged = strict(result.stdout)
            if not is_signed:
                self.assertEqual(merged, self.right, what)
            return False
        self.assertEqual(result.returncode, 2, (what, result.stderr))
        self.assertEqual(result.stderr.count("\n"), 1, (what, result.stderr))
        self.assertIn(".json", result.stderr, what)
        return True

    def test_an_unchanged_shard_is_taken(self):
        self.assertFalse(self.check(self.document, "unchanged", is_signed=False))
        self.assertFalse(self.check(signed(copy.deepcopy(self.document)), "signed again", is_signed=False))

    def test_no_change_passes_unseen(self):
        refused = 0
        for path in places(self.document["counts"], ("counts",)):
            at = self.document
            for key in path:
                at = at[key]
            for value in list(changes(at))[::3]:
                if value == at:
                    continue
                refused += self.check(put(self.document, path, value), (path, value), is_signed=False)
        self.assertGreater(refused, 100)

    def test_wrong_values_with_their_checksum_do_no_harm(self):
        refused = 0
        for path in places(self.document["counts"], ("counts",)):
            at = self.document
            for key in path:
                at = at[key]
            for value in changes(at):
                refused += self.check(signed(put(self.document, path, value)), (path, value), is_signed=True)
        self.assertGreater(refused, 100)

    def test_grids_whose_cells_cannot_be_counted_are_refused(self):
        document = copy.deepcopy(self.document)
        for band in document["counts"][0]["bands_counts"]:
            band["tallies"].update(bsdf=[900000013, 854015917], orders=True, path_length=[28292772, 1.0])
        self.assertTrue(self.check(signed(document), "wraps", is_signed=True))


class Checkpoints(unittest.TestCase):
    MEDIUM = ["photons", "marble", "--photons", "5e5", "--tally", "r,angle,rz", "--seed", "5"]

    @classmethod
    def setUpClass(cls):
        result = run(*cls.MEDIUM, "--counts", "--json", "whole.json")
        assert result.returncode == 0, result.stderr

    def resume(self):
        result = run(*self.MEDIUM, "--checkpoint", "kept.json", "--resume", "--counts", "--json", "resumed.json")
        self.assertEqual(result.returncode, 0, result.stderr)
        with open("whole.json") as whole, open("resumed.json") as resumed:
            self.assertEqual(whole.read(), resumed.read())
        self.assertFalse(os.path.exists("kept.json"))

    def test_what_a_signal_stops_goes_on_to_the_same_end(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            process = subprocess.Popen([LAMINA, *self.MEDIUM, "--checkpoint", "kept.json", "--json", "part.json"],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            time.sleep(0.4)
            process.send_signal(number)
            error = process.communicate()[1]
            self.assertEqual(process.returncode, 130, error)
            self.assertIn("--resume", error)
            with open("part.json") as file:
                part = json.load(file)
            self.assertTrue(part["was_stopped"][-1])
            self.assertGreater(part["photons"][0], 0)
            self.resume()

    @unittest.skipUnless(os.path.exists("/dev/full"), "needs a full disk")
    def test_is_kept_until_the_result_is_written(self):
        result = run("photons", "jade", "--photons", "1e3", "--checkpoint", "full.json", "--json", "/dev/full")
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertTrue(os.path.exists("full.json"))

    def test_what_time_stops_goes_on_to_the_same_end(self):
        result = run(*self.MEDIUM, "--time", "0.2", "--checkpoint", "kept.json")
        self.assertEqual(result.returncode, 0, result.stderr)
        with open("kept.json", "rb") as file:
            kept = file.read()
        again = run(*self.MEDIUM, "--checkpoint", "kept.json")  # a forgotten --resume
        self.assertEqual(again.returncode, 2, again.stderr)
        self.assertIn("--checkpoint: kept.json keeps what an earlier run has counted; --resume goes on", again.stderr)
        with open("kept.json", "rb") as file:
            self.assertEqual(file.read(), kept)
        other = run("photons", "marble", "--photons", "5e5", "--seed", "6", "--checkpoint", "kept.json", "--resume")
        self.assertEqual(other.returncode, 2)
        self.assertIn("kept.json", other.stderr)
        self.assertIn("--resume", other.stderr)
        self.resume()


MCI = "1.0\n1\n{name} A\n100\n0.1 0.1\n2 2 2\n1\n1.0\n1.4 1 90 0.75 0.02\n1.0\n"


class McmlOutputs(unittest.TestCase):
    def photons(self, name, *options, file="in.mci"):
        with open(file, "w") as mci:
            mci.write(MCI.format(name=name))
        return run("photons", file, *options)

    def test_stay_in_their_folder_and_off_their_inputs(self):
        absolute = os.path.abspath("elsewhere.mco")
        os.makedirs("out", exist_ok=True)
        if not os.path.islink("out/link"):
            os.symlink("..", "out/link")
        for name in ("../x.mco", absolute, "a/../../x.mco", "..", ".", "link/x.mco"):
            result = self.photons(name, "-o", "out")
            self.assertEqual(result.returncode, 2, (name, result.stderr))
            self.assertIn("in.mci:3: ", result.stderr)
            self.assertEqual(result.stderr.count("\n"), 1)
        self.assertFalse(os.path.exists("x.mco") or os.path.exists(absolute))
        for name, options in (("in.mci", ()), ("./in.mci", ()), ("r.json", ("--json", "r.json"))):
            result = self.photons(name, *options)
            self.assertEqual(result.returncode, 2, (name, result.stderr))
            with open("in.mci") as file:
                self.assertEqual(file.read(), MCI.format(name=name))

    def test_make_their_folder(self):
        self.assertEqual(self.photons("deep/x.mco", "-o", "new/folder").returncode, 0)
        self.assertGreater(os.path.getsize("new/folder/deep/x.mco"), 100)


class Azimuths(unittest.TestCase):
    """0 is forward in every command."""
    def json_of(self, *args):
        result = run(*args, "--json", "-")
        self.assertEqual(result.returncode, 0, result.stderr)
        return strict(result.stdout)

    def test_forward_light_is_at_azimuth_0(self):
        with open("haze.json", "w") as file:
            json.dump(HAZE, file)
        for method in (["radiative_transfer", "--step", "30", "--accuracy", "1e-2"], ["first_order", "--step", "30"],
                       ["layered_bsdf", "--step", "30"],
                       ["monte_carlo", "--photons", "1e5", "--cosines", "3", "--azimuths", "4"]):
            result = self.json_of("bsdf", "haze.json", "--theta-i", "60", "--method", *method)
            self.assertEqual(sorted(result["phi_o_deg"]), result["phi_o_deg"])
            for side in ("brdf", "btdf"):
                row = result[side][-1]
                self.assertGreater(row[0][0], 1.5 * row[-1][0], (method, side))
        for method in (["analytic"], ["monte_carlo", "--photons", "2e4"], ["height_field", "--photons", "2e4"]):
            result = self.json_of("bsdf", "--model", "rough_transmission", "--theta-i", "45", "--method", *method)
            for side in ("brdf", "btdf"):
                flux = [sum(row[j][0] for row in result[side]) for j in range(len(result["phi_o_deg"]))]
                self.assertGreater(flux[0], 3 * flux[-1], (method, side))
        photons = self.json_of("photons", "haze.json", "--incidence", "60", "--photons", "1e5", "--tally", "bsdf",
                               "--bsdf-cosines", "3", "--bsdf-azimuths", "8",
                               "--direction", "60", "0", "60", "180", "120", "0", "120", "180")
        for side in ("reflected", "transmitted"):
            row = photons["bsdf_" + side][0]
            self.assertGreater(row[0][0], 1.5 * row[3][0], side)
        above, back, below, below_back = (value[0] for value in photons["direction_bsdf"])
        self.assertGreater(above, 1.5 * back)
        self.assertGreater(below, 1.5 * below_back)
        bsdf = self.json_of("bsdf", "haze.json", "--theta-i", "60", "--step", "30", "--accuracy", "1e-3")
        for found, exact in ((above, bsdf["brdf"][2][0][0]), (back, bsdf["brdf"][2][-1][0]),
                             (below, bsdf["btdf"][2][0][0]), (below_back, bsdf["btdf"][2][-1][0])):
            self.assertLess(abs(found - exact), 0.03 * exact)


class Bands(unittest.TestCase):
    def test_share_their_random_numbers_unless_asked_not_to(self):
        material = dict(HAZE, bands=[500, 600])
        with open("two.json", "w") as file:
            json.dump(material, file)
        def reflectance(*options):
            result = run("photons", "two.json", "--photons", "1000", "--json", "-", *options)
            self.assertEqual(result.returncode, 0, result.stderr)
            return strict(result.stdout)["diffuse_reflectance"]
        shared, independent = reflectance(), reflectance("--independent-bands")
        self.assertEqual(shared[0], shared[1])
        self.assertEqual(independent[0], shared[0])
        self.assertNotEqual(independent[1], independent[0])


class Comparison(unittest.TestCase):
    def test_says_how_far_a_count_of_nothing_is_off(self):
        material = dict(HAZE, layers=[dict(HAZE["layers"][0], sigma_a=6, sigma_s=0,
                                                        thickness=1)])
        with open("filter.json", "w") as file:
            json.dump(material, file)
        result = run("slab", "filter.json", "--compare=100", "--seed", "1", "--json", "-")
        self.assertEqual(result.returncode, 0, result.stderr)
        row = next(row for row in json.loads(result.stdout)["rows"] if row["name"] == "transmittance")
        self.assertAlmostEqual(row["radiative_transfer"], math.exp(-6), delta=1e-5)
        self.assertEqual(row["monte_carlo"], 0)
        self.assertAlmostEqual(row["standard_error"], 0.01, delta=1e-3)
        self.assertAlmostEqual(row["difference_in_standard_errors"], -math.exp(-6) / row["standard_error"], delta=0.01)


if __name__ == "__main__":
    os.chdir(tempfile.mkdtemp())
    unittest.main()
