# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Files of `lamina export`, read by parsers that are not lamina's.

usage: export_command_test.py LAMINA ROOT
"""
import json
import math
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

LAMINA, ROOT = os.path.abspath(sys.argv.pop(1)), pathlib.Path(sys.argv.pop(1)).resolve()

# What is exported most: of one band, which is solved fastest.
CLEAR = {"lamina": "material", "version": 1, "name": "clear", "length_unit": "mm", "bands": "rgb",
         "ior_above": 1.0, "ior_below": 1.0,
         "layers": [{"sigma_a": 1.0, "sigma_s": 0, "g": 0, "ior": 1.4, "thickness": 1.0}]}


def run(*args, cwd=None):
    return subprocess.run([LAMINA, *map(str, args)], capture_output=True, text=True, timeout=300, cwd=cwd)


def export(folder, material, formats, *args):
    """The result, with the text of every file by its name."""
    result = run("export", material, "--to", formats, "-o", str(folder) + "/", "--json", "-", *args)
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout), {file.name: file.read_bytes() for file in pathlib.Path(folder).iterdir()}


def names():
    return [row["name"] for row in json.loads(run("export", "--to", "list", "--json", "-").stdout)["formats"]]


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)


class Gaussians(Folder):
    def test_sum_to_the_totals_and_say_how_wrong_they_are(self):
        result, files = export(self.folder, "jade", "gaussians", "--mm-per-unit", 10)
        data = json.loads(files["jade_gaussians.json"])
        sums = data["reflectance"]
        for c, misfit in enumerate(data["misfit"]):
            total = sum(row[c] for row in sums["weights"])
            self.assertAlmostEqual(total, misfit["reflectance"]["wanted_total"], delta=1e-9)
            kernel = sum(row[c] for row in sums["separable_kernel"]["weights"])
            self.assertAlmostEqual(kernel, total, delta=1e-9)
            radius = sum(2 * v * row[c] for v, row in zip(sums["variance_mm2"], sums["weights"])) / total
            self.assertAlmostEqual(radius / misfit["reflectance"]["obtained_mean_square_radius_mm2"], 1, delta=2e-3)
        for mm, unit, variance in zip(sums["width_mm"], sums["width_scene_units"], sums["variance_mm2"]):
            self.assertAlmostEqual(mm / unit, 10)
            self.assertAlmostEqual(mm, math.sqrt(variance))
        self.assertLess(sums["largest_flux_error"], 0.03)
        self.assertEqual(result["exports"][0]["misfit"], data["misfit"])

    def test_more_of_them_are_nearer(self):
        errors = []
        for count in (2, 5, 9):
            _, files = export(self.folder, "jade", "gaussians", "--gaussians", count)
            errors.append(json.loads(files["jade_gaussians.json"])["reflectance"]["largest_flux_error"])
        self.assertGreater(errors[0], errors[1])
        self.assertGreater(errors[1], errors[2])


class Mcml(Folder):
    def test_is_run_by_photons_to_the_totals_of_slab(self):
        export(self.folder, "donner_jensen_skin", "mcml")
        photons = run("photons", self.folder / "donner_jensen_skin.mci", "--photons", 20000, "--output", self.folder,
                      "--json", "-")
        self.assertEqual(photons.returncode, 0, photons.stderr)
        slab = json.loads(run("slab", "donner_jensen_skin", "--json", "-").stdout)
        for band, name in enumerate("RGB"):
            lines = (self.folder / f"donner_jensen_skin_{name}.mco").read_text().splitlines()
            reflected = float(next(line for line in lines if "Diffuse reflectance" in line).split()[0])
            self.assertAlmostEqual(reflected, slab["diffuse_reflectance"][band], delta=4 * 0.5 / math.sqrt(20000))

    def test_says_what_it_cannot(self):
        result, _ = export(self.folder, "dust", "mcml", "--bands", 550)
        notes = " ".join(result["exports"][0]["notes"])
        self.assertIn("ground", notes)
        misfit = result["exports"][0]["misfit"][0]["reflectance"]
        self.assertGreater(misfit["wanted_total"], misfit["obtained_total"] + 0.005)  # what the ground returns


def diffuse_total(folder, sigma_a, sigma_s, g, ior, thickness="infinite"):
    """What a medium returns of diffuse light, per channel, by `lamina slab`."""
    material = {"lamina": "material", "version": 1, "name": "written", "length_unit": "mm", "bands": "rgb",
                "ior_above": 1.0,
                "layers": [{"sigma_a": sigma_a, "sigma_s": sigma_s, "g": g, "ior": ior, "thickness": thickness}]}
    if thickness != "infinite":
        material["ior_below"] = 1.0
    (folder / "written.json").write_text(json.dumps(material))
    result = json.loads(run("slab", folder / "written.json", "--incidence", "diffuse", "--json", "-").stdout)
    (folder / "written.json").unlink()
    return result["diffuse_reflectance"], result["transmittance"]


class Mixture(Folder):
    def test_of_three_media_is_nearer_than_one_and_has_the_color(self):
        _, files = export(self.folder, "donner_jensen_skin", "mixture")
        data = json.loads(files["donner_jensen_skin_mixture.json"])
        totals = [diffuse_total(self.folder, medium["sigma_a"], medium["sigma_s"], data["g"], data["ior"])[0]
                  for medium in data["media"]]
        for c, (misfit, one) in enumerate(zip(data["misfit"], data["misfit_of_one_medium"])):
            weights = [medium["weights"][c] for medium in data["media"]]
            self.assertAlmostEqual(sum(weights), 1, delta=1e-12)
            self.assertGreaterEqual(min(weights), 0)
            mixed = sum(weight * total[c] for weight, total in zip(weights, totals))
            self.assertAlmostEqual(mixed, misfit["reflectance"]["wanted_total"], delta=2e-4)
            self.assertLess(misfit["reflectance"]["profile_rms"], 0.5 * one["reflectance"]["profile_rms"])
            self.assertLess(misfit["reflectance"]["profile_rms"], 0.06)

    def test_is_of_something_thick(self):
        result = run("export", "paper", "--to", "mixture", "-o", self.folder)
        self.assertEqual((result.returncode, os.listdir(self.folder)), (2, []))
        self.assertIn("must be thick", result.stderr)


# What Mitsuba 3 knows: plugins by kind, and their parameters by type.
MITSUBA = {("medium", "homogeneous"): {"albedo": ("rgb", "spectrum"), "sigma_t": ("rgb", "spectrum"), "scale": ("float",)},
           ("phase", "hg"): {"g": ("float",)},
           ("bsdf", "dielectric"): {"int_ior": ("float",), "ext_ior": ("float",)},
           ("bsdf", "roughdielectric"): {"int_ior": ("float",), "ext_ior": ("float",), "distribution": ("string",),
                                         "alpha": ("float",)},
           ("bsdf", "null"): {}}


def mitsuba_plugins(text):
    """{kind: (type, {name: text})}, of what the table knows."""
    root = xml.etree.ElementTree.fromstring(text)
    assert root.tag == "scene" and root.get("version")
    plugins = {}

    def read(element):
        known = MITSUBA[element.tag, element.get("type")]
        values = {}
        for child in element:
            if child.get("type"):
                read(child)
            else:
                assert child.tag in known[child.get("name")], (child.tag, child.get("name"))
                values[child.get("name")] = child.get("value")
        plugins[element.tag] = element.get("type"), values

    for element in root:
        read(element)
    return plugins


class Mitsuba(Folder):
    def test_medium_returns_the_light_of_the_layers(self):
        result, files = export(self.folder, "donner_jensen_skin", "mitsuba3", "--mm-per-unit", 1000)
        plugins = mitsuba_plugins(files["donner_jensen_skin.xml"])
        kind, medium = plugins["medium"]
        numbers = {name: [float(x) for x in medium[name].split(",")] for name in ("albedo", "sigma_t")}
        self.assertEqual(max(numbers["sigma_t"]), 1)
        sigma_t = [x * float(medium["scale"]) / 1000 for x in numbers["sigma_t"]]
        sigma_s = [a * t for a, t in zip(numbers["albedo"], sigma_t)]
        total, _ = diffuse_total(self.folder, [t - s for t, s in zip(sigma_t, sigma_s)], sigma_s,
                                 float(plugins["phase"][1]["g"]), float(plugins["bsdf"][1]["int_ior"]))
        for value, misfit in zip(total, result["exports"][0]["misfit"]):
            self.assertAlmostEqual(value, misfit["reflectance"]["wanted_total"], delta=1e-4)
            self.assertIn("%.5f" % misfit["reflectance"]["obtained_total"], files["donner_jensen_skin.xml"].decode())

    def test_a_single_rough_layer_is_as_it_was(self):
        _, files = export(self.folder, "marble", "mitsuba3")
        plugins = mitsuba_plugins(files["marble.xml"])
        self.assertEqual(plugins["bsdf"], ("roughdielectric", {"int_ior": "1.5", "ext_ior": "1",
                                                                "distribution": "beckmann", "alpha": "0.1"}))
        sigma_t = [float(x) * float(plugins["medium"][1]["scale"]) for x in plugins["medium"][1]["sigma_t"].split(",")]
        for value, sigma_s, sigma_a in zip(sigma_t, (2.19, 2.62, 3.00), (0.0021, 0.0041, 0.0071)):
            self.assertAlmostEqual(value, sigma_s + sigma_a, delta=1e-6)


# What pbrt-v4 knows: parameters by type of material and medium.
PBRT = {"homogeneous": {"sigma_a": "rgb spectrum", "sigma_s": "rgb spectrum", "scale": "float", "g": "float"},
        "subsurface": {"sigma_a": "rgb spectrum", "sigma_s": "rgb spectrum", "scale": "float", "g": "float", "eta": "float",
                       "roughness": "float", "remaproughness": "bool"},
        "dielectric": {"eta": "float", "roughness": "float", "remaproughness": "bool"},
        "interface": {},
        "diffuse": {"reflectance": "rgb spectrum"},
        "coateddiffuse": {"reflectance": "rgb spectrum", "eta": "float", "roughness": "float", "remaproughness": "bool"},
        "diffusetransmission": {"reflectance": "rgb spectrum", "transmittance": "rgb spectrum"}}


def pbrt_statements(text):
    """{name: (directive, type, {parameter: values})}, read as pbrt's tokenizer does."""
    tokens = re.findall(r'"[^"\n]*"|[\[\]]|[^\s"\[\]]+', re.sub(r"#.*", "", text.decode()))
    statements, i = {}, 0
    while i < len(tokens):
        directive, name = tokens[i], tokens[i + 1].strip('"')
        assert directive in ("MakeNamedMedium", "MakeNamedMaterial"), directive
        i += 2
        values = {}
        while i < len(tokens) and tokens[i].startswith('"'):
            kind, parameter = tokens[i].strip('"').split()
            if tokens[i + 1] == "[":
                end = tokens.index("]", i)
                found, i = tokens[i + 2:end], end + 1
            else:
                found, i = [tokens[i + 1]], i + 2
            values[parameter] = kind, found
        kind, (of_type,) = values.pop("type")
        of_type = of_type.strip('"')
        assert kind == "string" and (of_type == "homogeneous") == (directive == "MakeNamedMedium")
        for parameter, (kind, found) in values.items():
            assert kind in PBRT[of_type][parameter].split(), (of_type, parameter, kind)
            if kind == "rgb":
                assert len(found) == 3
            elif kind == "spectrum":
                wavelengths = [float(x) for x in found[::2]]
                assert len(found) % 2 == 0 and wavelengths == sorted(set(wavelengths))
                assert wavelengths[0] <= 360 and wavelengths[-1] >= 830
            elif kind == "float":
                assert len(found) == 1 and math.isfinite(float(found[0]))
        assert name not in statements, name
        statements[name] = directive, of_type, values
    return statements


class Pbrt(Folder):
    def test_medium_returns_the_light_of_the_layers(self):
        result, files = export(self.folder, "donner_jensen_skin", "pbrt-v4", "--mm-per-unit", 10)
        statements = pbrt_statements(files["donner_jensen_skin.pbrt"])
        self.assertEqual({of_type for _, of_type, _ in statements.values()},
                         {"homogeneous", "dielectric", "subsurface", "coateddiffuse"})
        self.assertEqual(len([name for name in statements if "_layer_" in name]), 3)
        medium = statements["donner_jensen_skin_medium"][2]
        self.assertEqual(float(medium["scale"][1][0]), 10)
        numbers = {name: [float(x) for x in medium[name][1]] for name in ("sigma_a", "sigma_s")}
        total, _ = diffuse_total(self.folder, numbers["sigma_a"], numbers["sigma_s"], float(medium["g"][1][0]),
                                 float(statements["donner_jensen_skin_boundary"][2]["eta"][1][0]))
        for value, misfit in zip(total, result["exports"][0]["misfit"]):
            self.assertAlmostEqual(value, misfit["reflectance"]["wanted_total"], delta=1e-4)
        layer = statements["donner_jensen_skin_layer_3"][2]
        self.assertEqual([float(x) for x in layer["sigma_a"][1]], [0.085, 1.0, 25.0])

    def test_wavelengths_are_spectra(self):
        _, files = export(self.folder, "snow", "pbrt-v4", "--channels", "bands", "--bands", "500,600")
        statements = pbrt_statements(files["snow.pbrt"])
        self.assertEqual(statements["snow_medium"][2]["sigma_s"][0], "spectrum")


# What MaterialX 1.39 knows of OpenPBR 1.1.1: inputs by type, and the range that each may have.
OPENPBR = {"base_weight": ("float", 0, 1), "base_color": ("color3", 0, 1), "specular_weight": ("float", 0, math.inf),
           "specular_ior": ("float", 0, math.inf), "specular_roughness": ("float", 0, 1),
           "subsurface_weight": ("float", 0, 1), "subsurface_color": ("color3", 0, 1),
           "subsurface_radius": ("float", 0, math.inf), "subsurface_radius_scale": ("color3", 0, 1),
           "subsurface_scatter_anisotropy": ("float", -1, 1), "geometry_thin_walled": ("boolean", 0, 1)}


def openpbr_inputs(text):
    """{name: numbers}, of what the table knows."""
    root = xml.etree.ElementTree.fromstring(text)
    assert (root.tag, root.get("version"), root.get("colorspace")) == ("materialx", "1.39", "lin_rec709")
    surface, material = root
    assert (surface.tag, surface.get("type")) == ("open_pbr_surface", "surfaceshader")
    assert (material.tag, material.get("type")) == ("surfacematerial", "material")
    assert [dict(i.attrib) for i in material] == [{"name": "surfaceshader", "type": "surfaceshader",
                                                   "nodename": surface.get("name")}]
    for element in root:
        assert re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", element.get("name")), element.get("name")
    inputs = {}
    for element in surface:
        kind, low, high = OPENPBR[element.get("name")]
        assert (element.tag, element.get("type")) == ("input", kind)
        values = [{"true": 1.0, "false": 0.0}.get(x.strip()) if kind == "boolean" else float(x)
                  for x in element.get("value").split(",")]
        assert len(values) == (3 if kind == "color3" else 1) and all(low <= x <= high for x in values), element.attrib
        assert element.get("name") not in inputs
        inputs[element.get("name")] = values
    return inputs


class OpenPbr(Folder):
    def test_the_printed_inversion_makes_the_medium_that_returns_the_light(self):
        result, files = export(self.folder, "donner_jensen_skin", "openpbr", "--mm-per-unit", 10)
        inputs = openpbr_inputs(files["donner_jensen_skin.mtlx"])
        (g,), (radius,) = inputs["subsurface_scatter_anisotropy"], inputs["subsurface_radius"]
        sigma_a, sigma_s = [], []
        for color, scale in zip(inputs["subsurface_color"], inputs["subsurface_radius_scale"]):
            # OpenPBR 1.1.1, section Subsurface.
            s = 4.09712 + 4.20863 * color - math.sqrt(9.59217 + 41.6808 * color + 17.7126 * color ** 2)
            albedo = (1 - s * s) / (1 - g * s * s)
            sigma_s.append(albedo / (10 * radius * scale))
            sigma_a.append((1 - albedo) / (10 * radius * scale))
        total, _ = diffuse_total(self.folder, sigma_a, sigma_s, g, *inputs["specular_ior"])
        for value, misfit in zip(total, result["exports"][0]["misfit"]):
            self.assertAlmostEqual(value, misfit["reflectance"]["wanted_total"], delta=3e-4)  # six digits of the formula

    def test_skins_have_radii_of_their_own_and_the_same_name_by_materialx(self):
        found = []
        for name in ("skin_type_2", "skin_type_6"):
            export(self.folder, name, "materialx", "--bands", "450,550,650")
            found.append(openpbr_inputs((self.folder / f"{name}.mtlx").read_text()))
        light, dark = found
        self.assertGreater(min(a - b for a, b in zip(light["subsurface_color"], dark["subsurface_color"])), 0.05)
        self.assertNotEqual(light["subsurface_radius"], dark["subsurface_radius"])
        for inputs in found:
            self.assertEqual(inputs["geometry_thin_walled"], [0.0])
            self.assertEqual(sorted(inputs["subsurface_radius_scale"], reverse=True), inputs["subsurface_radius_scale"])

    def test_sheets_are_thin_walls(self):
        result, files = export(self.folder, "leaf", "openpbr")
        inputs = openpbr_inputs(files["leaf.mtlx"])
        self.assertEqual(inputs["geometry_thin_walled"], [1.0])
        self.assertNotIn("subsurface_radius", inputs)
        slab = json.loads(run("slab", "leaf", "--incidence", "diffuse", "--json", "-").stdout)
        lit = sum(slab["diffuse_reflectance"]), sum(slab["transmittance"])
        (forward,) = inputs["subsurface_scatter_anisotropy"]
        self.assertAlmostEqual((1 + forward) / 2, lit[1] / sum(lit), delta=1e-4)
        for misfit in result["exports"][0]["misfit"]:
            self.assertAlmostEqual(*(sum(misfit[side][key] for side in ("reflectance", "transmittance"))
                                     for key in ("wanted_total", "obtained_total")), delta=1e-9)

    def test_wavelengths_are_refused(self):
        result = run("export", "snow", "--to", "openpbr", "--channels", "bands", "-o", self.folder)
        self.assertEqual((result.returncode, os.listdir(self.folder)), (2, []))
        self.assertIn("must be R, G, B", result.stderr)


class Blender(Folder):
    def test_script_is_python_and_has_the_medium(self):
        """Run with a bpy that keeps what is set: no Blender is needed."""
        export(self.folder, "marble", "blender", "--mm-per-unit", 1000)
        medium = json.loads((self.folder / "marble_blender.json").read_text())
        total, _ = diffuse_total(self.folder, *([x(a) / l for a, l in zip(medium["albedo"], medium["mean_free_path_mm"])]
                                                for x in (lambda a: 1 - a, lambda a: a)), medium["g"], 1.0)
        for value, wanted in zip(total, medium["reflectance"]):
            self.assertAlmostEqual(value, wanted, delta=1e-4)
        source = (self.folder / "marble_blender.py").read_text().split("\nmake_material(")[0].replace("import bpy\n", "")
        names = {}
        exec(source, names)
        self.assertEqual(names["MEDIUM"], medium)
        plan = names["plan"](medium, (3, 4, 1), names["MM_PER_UNIT"])
        for radius, length in zip(plan["inputs"]["Subsurface Radius"], medium["mean_free_path_mm"]):
            self.assertAlmostEqual(radius * 1000 / (4 * math.pi * length), 1, delta=1e-9)

    def test_sheets_have_two_colors(self):
        export(self.folder, "leaf", "blender")
        medium = json.loads((self.folder / "leaf_blender.json").read_text())
        slab = json.loads(run("slab", "leaf", "--incidence", "diffuse", "--json", "-").stdout)
        for side, key in (("reflectance", "diffuse_reflectance"), ("transmittance", "transmittance")):
            for value, wanted in zip(medium[side], slab[key]):
                self.assertAlmostEqual(value, wanted, delta=2e-5)
        self.assertNotIn("albedo", medium)


# What the glTF of lamina may hold of a material: ranges of numbers and lengths of arrays, as its schemas have them.
GLTF = {"KHR_materials_ior": {"ior": (1, math.inf, 0)},
        "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": (0, 1, 0), "diffuseTransmissionColorFactor": (0, 1, 3)},
        "KHR_materials_transmission": {"transmissionFactor": (0, 1, 0)},
        "KHR_materials_volume": {"thicknessFactor": (0, math.inf, 0), "attenuationDistance": (1e-300, math.inf, 0),
                                 "attenuationColor": (0, 1, 3)},
        "KHR_materials_scatter": {"multiscatterColorFactor": (0, 1, 3), "scatterAnisotropy": (-1, 1, 0)}}


def read_glb(data):
    """(JSON, binary) of a GLB; the material held against the table."""
    magic, version, size = struct.unpack_from("<III", data)
    assert (magic, version, size) == (0x46546C67, 2, len(data))
    chunks, at = {}, 12
    while at < size:
        length, kind = struct.unpack_from("<II", data, at)
        assert length % 4 == 0
        chunks[kind] = data[at + 8:at + 8 + length]
        at += 8 + length
    root = json.loads(chunks[0x4E4F534A])
    (material,) = root["materials"]
    assert len(material["pbrMetallicRoughness"]["baseColorFactor"]) == 4
    assert set(material["extensions"]) <= set(root["extensionsUsed"])
    for name, values in material["extensions"].items():
        for key, value in values.items():
            low, high, length = GLTF[name][key]
            numbers = value if length else [value]
            assert len(numbers) == (length or 1) and all(low <= x <= high for x in numbers), (name, key, value)
    return root, chunks.get(0x004E4942)


def validate_gltf(file):
    """By the validator of Khronos, where GLTF_VALIDATOR names the folder of its npm package; errors are none."""
    package = os.environ.get("GLTF_VALIDATOR")
    if not package:
        return
    script = ("const v=require(process.argv[1]);v.validateBytes(new Uint8Array(require('fs').readFileSync(process.argv[2])))"
              ".then(r=>process.stdout.write(JSON.stringify(r.issues)))")
    issues = json.loads(subprocess.run(["node", "-e", script, package, str(file)], capture_output=True, check=True).stdout)
    assert issues["numErrors"] == 0, issues


def triangle_glb():
    """A triangle, twice, with a red material."""
    binary = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
    root = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "buffers": [{"byteLength": 36}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}, {"attributes": {"POSITION": 0}}]}],
            "materials": [{"name": "red", "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}}]}
    text = json.dumps(root).encode()
    text += b" " * (-len(text) % 4)
    return (struct.pack("<III", 0x46546C67, 2, 28 + len(text) + len(binary)) + struct.pack("<II", len(text), 0x4E4F534A) + text +
            struct.pack("<II", len(binary), 0x004E4942) + binary)


class Gltf(Folder):
    def test_leaf_reflects_and_transmits_in_two_colors(self):
        mesh = self.folder / "mesh.glb"
        mesh.write_bytes(triangle_glb())
        result, files = export(self.folder, "leaf", "gltf", "--mesh", mesh)
        root, binary = read_glb(files["leaf.glb"])
        validate_gltf(self.folder / "leaf.glb")
        self.assertEqual(binary, struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0))
        self.assertEqual([p["material"] for p in root["meshes"][0]["primitives"]], [0, 0])
        self.assertEqual(root["materials"][0]["name"], "leaf")
        slab = json.loads(run("slab", "leaf", "--incidence", "diffuse", "--json", "-").stdout)
        material = root["materials"][0]
        sheet = material["extensions"]["KHR_materials_diffuse_transmission"]
        factor = sheet["diffuseTransmissionFactor"]
        ratios = []
        for c in range(3):
            r = (1 - factor) * material["pbrMetallicRoughness"]["baseColorFactor"][c]
            t = factor * sheet["diffuseTransmissionColorFactor"][c]
            ratios += [slab["diffuse_reflectance"][c] / r, slab["transmittance"][c] / t]
        for ratio in ratios:  # what the surface lets in, of all
            self.assertAlmostEqual(ratio, ratios[0], delta=1e-3)
            self.assertTrue(0.9 < ratio < 0.95)
        info = run("info", self.folder / "leaf.glb")
        self.assertEqual(info.returncode, 0, info.stderr)

    def test_thick_ones_have_their_color_and_scatter_behind_a_flag(self):
        export(self.folder, "donner_jensen_skin", "gltf")
        root, _ = read_glb((self.folder / "donner_jensen_skin.glb").read_bytes())
        validate_gltf(self.folder / "donner_jensen_skin.glb")
        self.assertEqual(set(root["materials"][0]["extensions"]), {"KHR_materials_ior"})
        result, files = export(self.folder, "donner_jensen_skin", "gltf", "--scatter", "--mm-per-unit", 1000)
        extensions = read_glb(files["donner_jensen_skin.glb"])[0]["materials"][0]["extensions"]
        volume, scatter = extensions["KHR_materials_volume"], extensions["KHR_materials_scatter"]
        sigma_a, sigma_s = [], []
        for attenuation, color in zip(volume["attenuationColor"], scatter["multiscatterColorFactor"]):
            sigma_t = -math.log(attenuation) / (1000 * volume["attenuationDistance"])
            albedo = 1 - (4.09712 + 4.20863 * color - math.sqrt(9.59217 + 41.6808 * color + 17.7126 * color ** 2)) ** 2
            sigma_s.append(sigma_t * albedo)
            sigma_a.append(sigma_t * (1 - albedo))
        total, _ = diffuse_total(self.folder, sigma_a, sigma_s, scatter["scatterAnisotropy"], extensions["KHR_materials_ior"]["ior"])
        for value, misfit in zip(total, result["exports"][0]["misfit"]):
            self.assertAlmostEqual(value, misfit["reflectance"]["wanted_total"], delta=3e-4)

    def test_wrong_meshes_are_refused_in_one_line(self):
        for content, word in ((b"x", "GLB"), (triangle_glb()[:40], "cut off"), (b"glTF" + bytes(20), "GLB")):
            mesh = self.folder / "mesh.glb"
            mesh.write_bytes(content)
            result = run("export", "leaf", "--to", "gltf", "--mesh", mesh, "-o", self.folder / "out.glb")
            self.assertEqual(result.returncode, 2, content)
            self.assertIn(word, result.stderr)
            self.assertEqual(len(result.stderr.strip().splitlines()), 1)
            self.assertFalse((self.folder / "out.glb").exists())


SHEETS = ("arnold", "renderman", "unreal", "unity-hdrp")


def check_sheet(data):
    """Held against the schema, where Python has jsonschema."""
    try:
        import jsonschema
    except ImportError:
        return
    jsonschema.validate(data, json.loads((ROOT / "schema/parameters.schema.json").read_text()))


class Sheets(Folder):
    def sheet(self, material, name, *args):
        export(self.folder, material, name, *args)
        data = json.loads((self.folder / f"{material}_{name}.json").read_text())
        check_sheet(data)
        return data

    def test_keep_to_the_schema_for_something_thick_and_a_leaf(self):
        for name in SHEETS:
            for material in ("donner_jensen_skin", "leaf"):
                with self.subTest(f"{name}, {material}"):
                    self.sheet(material, name)

    def test_schema_refuses_what_is_missing_or_unknown(self):
        try:
            import jsonschema
        except ImportError:
            self.skipTest("no jsonschema")
        data = self.sheet("jade", "unreal")
        for change in (lambda p: p.pop("bEnableMeanFreePath"), lambda p: p.update(bEnableMeanFreePath=False),
                       lambda p: p.update(Glow=1), lambda p: p.update(MeanFreePathDistance=-1)):
            broken = json.loads(json.dumps(data))
            change(broken["parameters"])
            with self.assertRaises(jsonschema.ValidationError):
                check_sheet(broken)

    def test_lengths_are_those_of_the_medium(self):
        export(self.folder, "jade", "blender")
        medium = json.loads((self.folder / "jade_blender.json").read_text())
        arnold = self.sheet("jade", "arnold", "--mm-per-unit", 10)["parameters"]
        renderman = self.sheet("jade", "renderman", "--mm-per-unit", 10)["parameters"]
        self.assertAlmostEqual(renderman["unitLength"], 0.1)
        for c, (albedo, length) in enumerate(zip(medium["albedo"], medium["mean_free_path_mm"])):
            self.assertAlmostEqual(10 * arnold["subsurface_scale"] * arnold["subsurface_radius"][c] / length, 1, delta=1e-9)
            sigma_a, sigma_t_prime = (1 - albedo) / length, (1 - albedo * medium["g"]) / length
            dmfp = 1 / math.sqrt(3 * sigma_a * sigma_t_prime)
            self.assertAlmostEqual(renderman["subsurfaceDmfp"] * renderman["subsurfaceDmfpColor"][c] / dmfp, 1, delta=1e-9)

    def test_burleys_profile_has_the_total_and_falls_as_it_should(self):
        result, _ = export(self.folder, "jade", "unity-hdrp")
        data = json.loads((self.folder / "jade_unity-hdrp.json").read_text())["parameters"]
        for c, misfit in enumerate(result["exports"][0]["misfit"]):
            light = misfit["reflectance"]
            self.assertEqual(light["wanted_total"], light["obtained_total"])
            d = data["scatteringDistance"][c] * data["scatteringDistanceMultiplier"]
            self.assertAlmostEqual(light["obtained_mean_square_radius_mm2"] / (14 * d * d), 1, delta=0.02)
            self.assertLess(light["profile_rms"], 0.6)


class Table(Folder):
    def test_is_read_by_numpy_and_has_what_slab_has(self):
        import numpy
        export(self.folder, "jade", "table")
        data = numpy.load(self.folder / "jade.npz", allow_pickle=False)
        r, profile = data["r_mm"], data["reflectance_profile"]
        self.assertEqual(profile.shape, (len(r), 3))
        slab = json.loads(run("slab", "jade", "--incidence", "diffuse", "--json", "-").stdout)
        rings = 2 * math.pi * (r[:, None] ** 2 * profile)
        flux = numpy.sum(0.5 * (rings[1:] + rings[:-1]) * numpy.log(r[1:] / r[:-1])[:, None], axis=0)
        for c in range(3):
            self.assertAlmostEqual(data["total_reflectance"][c], slab["diffuse_reflectance"][c], delta=2e-5)
            self.assertAlmostEqual(flux[c] / data["total_reflectance"][c], 1, delta=0.02)
        # The BRDF over the hemisphere of a normal beam.
        theta, phi = (numpy.radians(data[name]) for name in ("theta_o_deg", "phi_o_deg"))
        self.assertEqual(data["brdf"].shape, (len(data["theta_i_deg"]), len(theta), len(phi), 3))
        ring = numpy.mean(0.5 * (data["brdf"][0][:, 1:] + data["brdf"][0][:, :-1]), axis=1)
        ring *= 2 * math.pi * (numpy.sin(theta) * numpy.cos(theta))[:, None]
        ring, theta = numpy.vstack([ring, numpy.zeros((1, 3))]), numpy.append(theta, math.pi / 2)
        total = numpy.sum(0.5 * (ring[1:] + ring[:-1]) * numpy.diff(theta)[:, None], axis=0)
        normal = json.loads(run("slab", "jade", "--json", "-").stdout)["diffuse_reflectance"]
        for value, wanted in zip(total, normal):
            self.assertAlmostEqual(value / wanted, 1, delta=0.02)

    def test_pictures_and_csv_say_the_same(self):
        import numpy
        _, files = export(self.folder, "jade", "table")
        data = numpy.load(self.folder / "jade.npz")
        rows = [line for line in files["jade_profile.csv"].decode().splitlines() if not line.startswith("#")]
        self.assertEqual(rows[0], "r_mm,R_R,R_G,R_B,T_R,T_G,T_B")
        numbers = numpy.array([[float(x) for x in row.split(",")] for row in rows[1:]])
        self.assertTrue(numpy.array_equal(numbers[:, 0], data["r_mm"]))
        self.assertTrue(numpy.array_equal(numbers[:, 1:4], data["reflectance_profile"]))
        for name, width, height in (("jade_profile.exr", len(data["r_mm"]), 2), ("jade_brdf.exr", 18 * 13, 6)):
            picture = files[name]
            self.assertEqual(struct.unpack("<I", picture[:4])[0], 20000630)  # the magic number of OpenEXR
            at = picture.index(b"dataWindow\0box2i\0") + len(b"dataWindow\0box2i\0") + 4
            self.assertEqual(struct.unpack("<4i", picture[at:at + 16]), (0, 0, width - 1, height - 1))


# MCX's input, as its schema has it.
MCX = {"Session": {"ID", "Photons", "RNGSeed", "DoMismatch", "DoAutoThread", "DoSaveVolume", "DoSaveRef", "DoNormalize",
                   "DoSpecular", "BCFlags"},
       "Forward": {"T0", "T1", "Dt"}, "Optode": {"Source"},
       "Domain": {"OriginType", "LengthUnit", "Dim", "Media"}, "Shapes": None}


class Mcx(Folder):
    def test_layers_are_voxels_of_the_same_optical_thickness(self):
        result, files = export(self.folder, "donner_jensen_skin", "mcx")
        data = json.loads(files["donner_jensen_skin_R.mcx.json"])
        self.assertEqual(set(data), set(MCX))
        for part, keys in MCX.items():
            if keys:
                self.assertEqual(set(data[part]), keys)
        media, unit = data["Domain"]["Media"], data["Domain"]["LengthUnit"]
        self.assertEqual([m["n"] for m in media], [1.0, 1.4, 1.34, 1.4])
        grid, layers = data["Shapes"][0]["Grid"], data["Shapes"][1]["ZLayers"]
        self.assertEqual(grid["Size"], data["Domain"]["Dim"])
        self.assertEqual([first for first, _, _ in layers], [1] + [last + 1 for _, last, _ in layers[:-1]])
        self.assertEqual(layers[-1][1], grid["Size"][2])
        for (first, last, tag), thickness, sigma_s in zip(layers, (0.03, 0.05), (48, 32)):
            self.assertAlmostEqual((last - first + 1) * unit * media[tag]["mus"], thickness * sigma_s, delta=1e-9)
        for misfit in result["exports"][0]["misfit"]:
            self.assertAlmostEqual(misfit["reflectance"]["obtained_total"], misfit["reflectance"]["wanted_total"], delta=2e-3)

    def test_python_for_pyxopto_is_in_meters(self):
        _, files = export(self.folder, "donner_jensen_skin", "mcx")
        names = {}
        exec(files["donner_jensen_skin_pyxopto.py"].decode(), names)
        rows = names["layers"]["G"]
        self.assertEqual([row["d"] for row in rows], [0.0, 3e-5, 5e-5, float("inf"), 0.0])
        self.assertEqual(rows[1], {"d": 3e-5, "n": 1.4, "mua": 2100.0, "mus": 60000.0, "g": 0.0})


class Everything(Folder):
    """Every format on materials of every kind: files, or one line and exit code 2."""

    CASES = [("donner_jensen_skin",), ("skin_type_6", "--bands", 550), ("green_leaf", "--bands", 550),
             ("snow", "--bands", 550), ("dust", "--bands", 550), ("white_paint", "--bands", 550), ("painted_jade",), ("marble",),
             ("hanrahan_krueger_skin",)]

    def test_is_written_or_refused(self):
        for material, *args in self.CASES:
            with self.subTest(material):
                result, files = export(self.folder / material, material, "all", *args)
                self.assertEqual([one["format"] for one in result["exports"]], names())
                for one in result["exports"]:
                    self.assertNotEqual(bool(one["files"]), "refusal" in one)
                    for misfit in one["misfit"]:
                        for light in misfit.values():
                            if not isinstance(light, str):
                                self.assertTrue(all(math.isfinite(x) for x in light.values()), light)
                for name, content in files.items():
                    self.assertGreater(len(content), 100, name)
                    if name.endswith((".json", ".mci", ".pbrt", ".xml", ".csv", ".py")):
                        self.assertNotRegex(content.decode(), r"\bnan\b", name)
                    if name.endswith(".json"):
                        json.loads(content)
                    if any(name.endswith(f"_{sheet}.json") for sheet in SHEETS):
                        check_sheet(json.loads(content))
                    if name.endswith(".xml"):
                        mitsuba_plugins(content)
                    if name.endswith(".glb"):
                        read_glb(content)
                    if name.endswith(".mtlx"):
                        openpbr_inputs(content)
                    if name.endswith(".pbrt"):
                        pbrt_statements(content)

    def test_what_does_not_scatter_is_layers_only(self):
        clear = self.folder / "clear.json"
        clear.write_text(json.dumps(CLEAR))
        for name in names():
            result = run("export", clear, "--to", name, "-o", self.folder / name)
            if name in ("mcml", "mcx"):
                self.assertEqual(result.returncode, 0, result.stderr)
            else:
                self.assertEqual(result.returncode, 2, name)
                self.assertEqual(len(result.stderr.strip().splitlines()), 1)
                self.assertFalse((self.folder / name).exists())


class Command(Folder):
    def test_lists_every_format_in_help(self):
        text = run("export", "--help").stdout
        for name in names():
            self.assertIn(f"\n  {name} ", text)

    def test_one_file_goes_to_the_path_given(self):
        file = self.folder / "own.mci"
        self.assertEqual(run("export", "jade", "--to", "mcml", "-o", file).returncode, 0)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["own.mci"])

    def test_wrong_use_is_one_line(self):
        clear = self.folder / "clear.json"
        clear.write_text(json.dumps(CLEAR))
        inside = sorted(p.name for p in self.folder.iterdir())
        for args, words in ((["jade", "--to", "gausians"], ["gausians", "gaussians"]),
                            (["--to", "mcml"], ["MATERIAL"]),
                            (["jade"], ["--to"]),
                            (["jade", "--to", "mcml", "--mm-per-unit", "0"], ["--mm-per-unit"]),
                            (["jade", "--to", "mcml", "--g", "1"], ["--g"]),
                            ([clear, "--to", "gaussians"], ["must scatter", "clear", "band R"]),
                            ([clear, "--to", "mcml", "-o", clear], ["clear.json"]),
                            (["jade", "--to", "mcml", "-o", clear / "x.mci"], ["clear.json"])):
            result = run("export", *args, cwd=self.folder)
            self.assertIn(result.returncode, (1, 2), args)
            self.assertEqual(len(result.stderr.strip().splitlines()), 1, result.stderr)
            for word in words:
                self.assertIn(word, result.stderr)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), inside)
        self.assertEqual(json.loads(clear.read_text()), CLEAR)


if __name__ == "__main__":
    unittest.main()
