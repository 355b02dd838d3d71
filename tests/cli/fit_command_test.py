# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""From a material to its totals by `lamina slab`, and back by `lamina fit`.

usage: fit_command_test.py LAMINA ROOT
"""
import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

LAMINA, ROOT = os.path.abspath(sys.argv.pop(1)), pathlib.Path(sys.argv.pop(1)).resolve()
EXAMPLES, INPUTS = ROOT / "examples/measurements", ROOT / "tests/inputs/measurement"
os.environ["LAMINA_CACHE"] = "off"


def run(*args, cwd=None):
    return subprocess.run([LAMINA, *map(str, args)], capture_output=True, text=True, timeout=120, cwd=cwd)


def json_of(*args, cwd=None):
    result = run(*args, "--json", "-", cwd=cwd)
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)


class RoundTrip(unittest.TestCase):
    def test_totals_of_a_cuvette_give_its_liquid_back(self):
        cuvette = EXAMPLES / "cuvette.json"
        totals = json_of("slab", cuvette, "--accuracy", "1e-8")
        with tempfile.TemporaryDirectory() as folder:
            rows = ["wavelength_nm,reflectance,transmittance,unscattered_transmittance"]
            for i, band in enumerate(totals["bands"]):
                rows.append(",".join(repr(x) for x in (
                    band, totals["specular_reflectance"][i] + totals["diffuse_reflectance"][i],
                    totals["transmittance"][i], totals["unscattered_transmittance"][i])))
            pathlib.Path(folder, "cuvette.csv").write_text("\n".join(rows) + "\n")
            pathlib.Path(folder, "liquid.json").write_text((EXAMPLES / "liquid.json").read_text())
            found = json_of("fit", "liquid.json", "--set", "measured[0].unit=fraction", "--set", "measured[0].sd=1e-6",
                            "--set", "measured[0].unscattered_transmittance_sd=1e-8", "-o", "found.json", cwd=folder)
            self.assertTrue(found["has_converged"])
            values = {free["parameter"]: free["value"] for free in found["free"]}
            for i, (band, sigma_a) in enumerate(zip(totals["bands"], [0.02, 0.06, 0.15, 0.05, 0.01])):
                self.assertAlmostEqual(values["layers[1].sigma_a"][i] / sigma_a, 1, delta=3e-4)
                self.assertAlmostEqual(values["layers[1].sigma_s_prime"][i] / (1.2 * (band / 500) ** -1.4), 1, delta=1e-4)
                self.assertAlmostEqual(values["layers[1].g"][i], 0.75, delta=1e-4)
            again = json_of("slab", "found.json", cwd=folder)
            for key in ("diffuse_reflectance", "transmittance"):
                for one, other in zip(again[key], totals[key]):
                    self.assertAlmostEqual(one, other, delta=3e-5)

    def test_noise_of_the_example_is_within_its_errors(self):
        with tempfile.TemporaryDirectory() as folder:
            found = json_of("fit", EXAMPLES / "liquid.json", "--plot", "liquid.svg", cwd=folder)
            self.assertIn("unscattered", pathlib.Path(folder, "liquid.svg").read_text())
        absorption = found["free"][0]
        for value, error, truth in zip(absorption["value"], absorption["high_error"], [0.02, 0.06, 0.15, 0.05, 0.01]):
            self.assertLess(abs(value - truth), 3 * error)
            self.assertLess(error, 0.06 * truth)
        points = found["measured"][0]["points"]
        self.assertEqual(len(points), 15)
        self.assertEqual(len(found["correlations"]), 5)

    def test_numbers_at_their_range_are_unknown(self):
        narrow = ["fit", EXAMPLES / "liquid.json", "--set", "free[0].high=0.008", "--set", "free[0].start=0.004"]
        found = json_of(*narrow)
        absorption = found["free"][0]
        self.assertEqual(absorption["is_at_bound"], [True] * 5)
        for key in ("low_error", "high_error", "standard_deviation"):
            self.assertEqual(absorption[key], [None] * 5)
        self.assertIn("unknown, since it ended at its range, 0.008", " ".join(found["notes"]))
        self.assertRegex(run(*narrow).stdout, r"450 +0\.008 unknown")

    def test_text_has_numbers_errors_and_notes(self):
        text = run("fit", EXAMPLES / "liquid.json").stdout
        for words in ("15 numbers measured, 15 fitted", "±", "layers[1].sigma_s_prime", "note: ", "hardly told apart"):
            self.assertIn(words, text)


class Report(unittest.TestCase):
    def test_is_one_page_with_all_of_it(self):
        with tempfile.TemporaryDirectory() as folder:
            fit = ["fit", EXAMPLES / "liquid.json", "--set", "name=milk & <water>"]
            self.assertEqual(run(*fit, "--report", "a.html", cwd=folder).returncode, 0)
            self.assertEqual(run(*fit, "--report", "b.html", cwd=folder).returncode, 0)
            page = pathlib.Path(folder, "a.html").read_text()
            self.assertEqual(page, pathlib.Path(folder, "b.html").read_text())
            found = json_of(*fit, cwd=folder)
        self.assertNotIn("http", page)  # nothing from a network
        for words in ("milk &amp; &lt;water&gt;", "an example, not a measurement", "light at normal incidence, first reflection at the surface included",
                      "layers[1].sigma_s_prime</code> [1/mm]", "0.001 to 100", "layers[0].ior</code>", "lamina fit ", "--set 'name=milk &amp; &lt;water&gt;'"):
            self.assertIn(words, page)
        for note in found["notes"]:
            self.assertIn(note, page)
        for point in found["measured"][0]["points"]:
            self.assertIn(">%.5g<" % point["measured"], page)
        self.assertEqual(page.count("correlations of the numbers found"), 5)

    def test_says_that_a_population_was_assumed(self):
        with tempfile.TemporaryDirectory() as folder:
            run("fit", EXAMPLES / "forearm.json", "--report", "forearm.html", cwd=folder)
            self.assertIn("as in a measured population", pathlib.Path(folder, "forearm.html").read_text())

    def test_says_that_spheres_read_it(self):
        with tempfile.TemporaryDirectory() as folder:
            run("fit", EXAMPLES / "sphere.json", "--set", "measured[0].beam_diameter_mm=null", "--report", "sphere.html", cwd=folder)
            self.assertIn("read in an integrating sphere", pathlib.Path(folder, "sphere.html").read_text())

    def test_of_another_ending_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            result = run("fit", EXAMPLES / "liquid.json", "--report", "liquid.pdf", cwd=folder)
            self.assertEqual(result.returncode, 2)
            self.assertIn(".html", result.stderr)
            self.assertEqual(os.listdir(folder), [])


class Batch(unittest.TestCase):
    def test_takes_each_column_of_a_table(self):
        rows = [row.split(",") for row in (EXAMPLES / "forearm.csv").read_text().splitlines() if not row.startswith("#")]
        with tempfile.TemporaryDirectory() as folder:
            lines = ["wavelength_nm,anna,bert,bad"] + [f"{nm},{r},{float(r) * .9:.2f},{'x' if nm == '400' else r}" for nm, r in rows[1:]]
            pathlib.Path(folder, "people.csv").write_text("\n".join(lines))
            result = run("fit", EXAMPLES / "forearm.json", "--batch", "people.csv", "-o", "found.csv", cwd=folder)
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertIn("people.csv:2: bad", result.stderr)
            found = pathlib.Path(folder, "found.csv").read_text().splitlines()
            self.assertEqual([row.split(",")[0] for row in found], ["file", "anna", "bert"])
            melanin = found[0].split(",").index("skin.melanin")
            alone = json_of("fit", EXAMPLES / "forearm.json")["free"][0]["value"]
            self.assertAlmostEqual(float(found[1].split(",")[melanin]), alone, delta=1e-9)
            self.assertGreater(float(found[2].split(",")[melanin]), alone)
            pathlib.Path(folder, "none.csv").write_text("wavelength_nm\n400\n")
            result = run("fit", EXAMPLES / "forearm.json", "--batch", "none.csv", cwd=folder)
            self.assertEqual(result.returncode, 2)
            self.assertIn("must have a column for each sample", result.stderr)

    def test_goes_on_past_a_bad_file_and_says_so(self):
        table = (EXAMPLES / "cuvette.csv").read_text().splitlines()
        with tempfile.TemporaryDirectory() as folder:
            spectra = pathlib.Path(folder, "spectra")
            spectra.mkdir()
            (spectra / "b.csv").write_text("\n".join(table))
            (spectra / "a.csv").write_text("\n".join(table[:4]))  # two bands less
            (spectra / "bad.csv").write_text("\n".join(table).replace("50.63", "-50.63"))
            batch = ["fit", EXAMPLES / "liquid.json", "--batch", "spectra", "-o", "found.csv", "--report", "found.html"]
            result = run(*batch, cwd=folder)
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertIn("bad.csv:3: reflectance must lie in", result.stderr)
            self.assertIn("1 of 3 files could not be fitted", result.stderr)
            page = pathlib.Path(folder, "found.html").read_text()
            self.assertIn("2 of 3 files fitted", page)
            self.assertIn("reflectance must lie in", page)
            rows = pathlib.Path(folder, "found.csv").read_text().splitlines()
            self.assertEqual([row.split(",")[0] for row in rows], ["file", "a.csv", "b.csv"])
            columns = rows[0].split(",")
            alone = json_of("fit", EXAMPLES / "liquid.json")["free"][0]
            place = columns.index("layers[1].sigma_a at 600 nm")
            self.assertEqual(rows[1].split(",")[place], "")
            self.assertAlmostEqual(float(rows[2].split(",")[place]), alone["value"][3], delta=1e-9)
            self.assertEqual(columns[place + 1], "layers[1].sigma_a at 600 nm sd")
            (spectra / "bad.csv").unlink()
            found = json_of("fit", EXAMPLES / "liquid.json", "--batch", "spectra", cwd=folder)
            self.assertEqual([fit["file"] for fit in found["fits"]], ["a.csv", "b.csv"])

    def test_table_has_a_row_for_each_file_whatever_its_name(self):
        with tempfile.TemporaryDirectory() as folder:
            spectra = pathlib.Path(folder, "spectra")
            spectra.mkdir()
            for name in ("=1+1", "x\ny", "a,b"):
                (spectra / f"{name}.csv").write_text((EXAMPLES / "cuvette.csv").read_text())
            result = run("fit", EXAMPLES / "liquid.json", "--batch", "spectra", "-o", "found.csv", cwd=folder)
            self.assertEqual(result.returncode, 0, result.stderr)
            with open(pathlib.Path(folder, "found.csv"), newline="") as table:
                names = [row[0] for row in csv.reader(table)]
            self.assertEqual(sorted(names), sorted(["file", "'=1+1.csv", "x y.csv", "a,b.csv"]))

    def test_of_nothing_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            result = run("fit", EXAMPLES / "liquid.json", "--batch", folder, "-o", "found.csv", cwd=folder)
            self.assertEqual(result.returncode, 2)
            self.assertIn("holds no CSV file", result.stderr)
            result = run("fit", EXAMPLES / "liquid.json", "-o", "found.csv", cwd=folder)
            self.assertEqual(result.returncode, 2)
            self.assertIn("must end in .json", result.stderr)
            self.assertEqual(os.listdir(folder), [])


class Shards(unittest.TestCase):
    """Three parts of five samples, one of which is refused, against all of them on one machine."""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        spectra = self.folder / "spectra"
        spectra.mkdir()
        text = (EXAMPLES / "cuvette.csv").read_text()
        for name in "abde":
            (spectra / f"{name}.csv").write_text(text)
        (spectra / "c.csv").write_text(text.replace("50.63", "-50.63"))
        self.batch = ["fit", EXAMPLES / "liquid.json", "--batch", "spectra"]
        for i in range(3):
            result = self.run_here(*self.batch, "--shard", f"{i}/3", "--json", f"{i}.json")
            self.assertEqual(result.returncode, 0, result.stderr)

    def run_here(self, *args):
        return run(*args, cwd=self.folder)

    def assertRefused(self, text, *args):
        before = sorted(os.listdir(self.folder))
        result = self.run_here(*args)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn(text, result.stderr.splitlines()[-1])
        self.assertEqual(sorted(os.listdir(self.folder)), before)

    def test_come_to_the_whole_bit_by_bit_in_any_order(self):
        whole = self.run_here(*self.batch, "-o", "whole.csv", "--json", "whole.json")
        self.assertEqual(whole.returncode, 1, whole.stderr)
        merged = self.run_here("merge", "2.json", "0.json", "1.json", "--all", "-o", "merged.csv", "--json", "merged.json")
        self.assertEqual(merged.returncode, 1, merged.stderr)
        self.assertEqual(merged.stderr, whole.stderr)
        self.assertIn("1 of 5 files could not be fitted", merged.stderr)
        self.assertEqual((self.folder / "merged.csv").read_bytes(), (self.folder / "whole.csv").read_bytes())
        one, other = (json.loads((self.folder / f"{name}.json").read_text()) for name in ("whole", "merged"))
        self.assertEqual(other.pop("command"), "merge")
        self.assertEqual(one.pop("command"), "fit")
        self.assertEqual(one, other)

    def test_that_are_missing_are_named_with_their_command(self):
        result = self.run_here("merge", "0.json", "2.json", "-o", "some.csv")
        self.assertEqual(result.returncode, 0, result.stderr)  # the refused sample is in the other
        self.assertIn("1 of 3 shards are missing: 1/3", result.stderr)
        missing = result.stderr.splitlines()[0]
        self.assertTrue(missing.endswith("--batch spectra --shard 1/3 --json 1.json"), missing)
        self.assertRefused("1 of 3 shards are missing", "merge", "0.json", "2.json", "--all", "-o", "none.csv")

    def test_that_do_not_belong_together_or_are_damaged_are_refused_by_name(self):
        self.assertRefused("1.json: shard 1/3 must be given once", "merge", "1.json", "1.json")
        self.run_here(*self.batch, "--shard", "0/2", "--json", "half.json")
        self.assertRefused("half.json: must be one of 3 shards, as 1.json", "merge", "1.json", "half.json")
        self.run_here(*self.batch, "--seed", "5", "--shard", "0/3", "--json", "other.json")
        self.assertRefused("other.json: must be of the measurement", "merge", "1.json", "other.json")
        sound = (self.folder / "0.json").read_text()
        for old, new in [('"index": 0', '"index": 2'), ('"value": 0.0', '"value": 0.1'), ("a.csv", "q.csv")]:
            self.assertIn(old, sound)
            (self.folder / "0.json").write_text(sound.replace(old, new, 1))
            self.assertRefused("0.json: is damaged", "merge", "0.json", "1.json")

    def test_of_data_that_changed_between_them_are_refused(self):
        sample = self.folder / "spectra" / "a.csv"
        sample.write_text(sample.read_text().replace("50.63", "40.63"))
        self.run_here(*self.batch, "--shard", "1/3", "--json", "1.json")
        self.assertRefused("1.json: must be of the measurement", "merge", "0.json", "1.json", "2.json")

    def test_need_a_batch_and_leave_the_whole_to_the_merge(self):
        self.assertRefused("--shard: is for samples of --batch", "fit", EXAMPLES / "liquid.json", "--shard", "0/2")
        self.assertRefused("--shard: must be I/N", *self.batch, "--shard", "2/2", "--json", "a.json")
        self.assertRefused("--shard: needs --json FILE", *self.batch, "--shard", "0/2")
        self.assertRefused("--output: is of all samples", *self.batch, "--shard", "0/2", "--json", "a.json", "-o", "a.csv")
        self.assertRefused("--output: must end in .csv", "merge", "0.json", "-o", "a.png")
        self.assertRefused("--denoise: is not for shards of fits", "merge", "0.json", "--denoise")


class WrongInput(unittest.TestCase):
    def test_is_one_line_with_exit_code_2_and_writes_nothing(self):
        files = sorted((INPUTS / "bad").glob("*.json"))
        self.assertGreater(len(files), 40)
        with tempfile.TemporaryDirectory() as folder:
            for file in files:
                result = run("fit", file, "-o", "found.json", "--plot", "fit.svg", "--report", "fit.html", "--json", "fit.json", cwd=folder)
                self.assertEqual(result.returncode, 2, (file, result.stderr))
                self.assertEqual(result.stdout, "", file)
                self.assertEqual(result.stderr.count("\n"), 1, (file, result.stderr))
                self.assertEqual(os.listdir(folder), [], file)

    def test_results_do_not_overwrite_the_measurement(self):
        result = run("fit", EXAMPLES / "liquid.json", "-o", EXAMPLES / "liquid.json")
        self.assertEqual(result.returncode, 2)
        self.assertIn("must be different files", result.stderr)


if __name__ == "__main__":
    unittest.main()
