# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Files of `lamina export`, read by parsers that are not lamina's, against tables of what their programs know."""
import ast
import io
import json
import math
import re
import struct
import xml.etree.ElementTree

from exporting import ROOT

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


SHEETS = ("arnold", "renderman", "unreal", "unity-hdrp")


def check_sheet(data):
    """Held against the schema, where Python has jsonschema."""
    try:
        import jsonschema
    except ImportError:
        return
    jsonschema.validate(data, json.loads((ROOT / "schema/parameters.schema.json").read_text()))


def number_or_word(word):
    if word in ("on", "off"):
        return word == "on"
    return json.loads(word)


def arnold_node(text):
    """Type, name and parameters of the only node in an .ass file: lists of colors, numbers, words, on and off."""
    kind, brace, *lines, end = [line.strip() for line in text.splitlines() if line.strip() and line[0] != "#"]
    assert (brace, end) == ("{", "}")
    values = {}
    for line in lines:
        key, rest = line.split(" ", 1)
        assert key not in values, key
        words = [rest] if key == "name" or rest[0] == '"' else rest.split()
        assert len(words) in (1, 3), line
        values[key] = rest if key == "name" else number_or_word(words[0]) if len(words) == 1 else [float(x) for x in words]
    return kind, values.pop("name"), values


def rib_bxdf(text):
    """Type, name and parameters, each with its type, of the only request in a RIB."""
    lines = [line for line in text.splitlines() if line and line[0] != "#"]
    kind, name = re.fullmatch(r'Bxdf "(\w+)" "([\w-]+)"', lines[0]).groups()
    values = {}
    for line in lines[1:]:
        declared, key, numbers = re.fullmatch(r'  "(int|float|color) (\w+)" \[([^\[\]]+)\]', line).groups()
        found = [int(x) if declared == "int" else float(x) for x in numbers.split()]
        assert key not in values and len(found) == (3 if declared == "color" else 1), line
        values[key] = (declared, found)
    return kind, name, values


# MCX's input, as its schema has it.
MCX = {"Session": {"ID", "Photons", "RNGSeed", "DoMismatch", "DoAutoThread", "DoSaveVolume", "DoSaveRef", "DoNormalize",
                   "DoSpecular", "BCFlags"},
       "Forward": {"T0", "T1", "Dt"}, "Optode": {"Source"},
       "Domain": {"OriginType", "LengthUnit", "Dim", "Media"}, "Shapes": None}


def refuse_constant(name):
    raise ValueError(name + " in JSON")


def read_json(text):
    """JSON of finite numbers; NaN and Infinity, which Python would take, are none."""
    return json.loads(text, parse_constant=refuse_constant)


def mcml_runs(text):
    """Layers [n, mua, mus, g, d] by run, of an input file of MCML 1.2."""
    lines = [line for line in (line.split("#")[0].strip() for line in text.decode().splitlines()) if line]
    assert lines[0] == "1.0"
    runs, at = [], 2
    for _ in range(int(lines[1])):
        assert lines[at].split()[1] == "A" and int(lines[at + 1]) > 0
        assert all(float(x) > 0 for line in lines[at + 2:at + 4] for x in line.split())
        count = int(lines[at + 4])
        layers = [[float(x) for x in line.split()] for line in lines[at + 6:at + 6 + count]]
        assert all(len(layer) == 5 and all(map(math.isfinite, layer)) for layer in layers)
        assert math.isfinite(float(lines[at + 5])) and math.isfinite(float(lines[at + 6 + count]))
        runs.append(layers)
        at += 7 + count
    assert at == len(lines)
    return runs


def read_exported(name, content):
    """Reads any file of `lamina export` by its ending; fails where it is not what the ending says, or a number not finite."""
    assert len(content) > 100, name
    ending = name[name.index("."):]
    if ending not in (".npz", ".exr", ".glb"):
        words = content.decode().replace("float('inf')", "")  # so Python writes a layer without end
        assert not re.search(r"(?<![\w.])[+-]?(nan|inf|infinity)\b", words, re.IGNORECASE), name
    if ending in (".json", ".mcx.json"):
        data = read_json(content)
        if any(name.endswith(f"_{sheet}.json") for sheet in SHEETS):
            check_sheet(data)
        if ending == ".mcx.json":
            assert set(data) == set(MCX), name
    elif ending == ".ass":
        arnold_node(content.decode())
    elif ending == ".rib":
        rib_bxdf(content.decode())
    elif ending == ".xml":
        mitsuba_plugins(content)
    elif ending == ".mtlx":
        openpbr_inputs(content)
    elif ending == ".glb":
        read_json(json.dumps(read_glb(content)[0]))
    elif ending == ".pbrt":
        pbrt_statements(content)
    elif ending == ".mci":
        assert mcml_runs(content), name
    elif ending == ".py":
        ast.parse(content)  # bytes: the encoding that they name is obeyed
    elif ending == ".csv":
        rows = [line.split(",") for line in content.decode().splitlines() if not line.startswith("#")]
        assert all(len(row) == len(rows[0]) and all(math.isfinite(float(x)) for x in row) for row in rows[1:]), name
    elif ending == ".npz":
        import numpy
        arrays = numpy.load(io.BytesIO(content), allow_pickle=False)
        for key in arrays.files:
            if arrays[key].dtype.kind == "f":
                assert numpy.isfinite(arrays[key]).all(), (name, key)
    else:
        assert ending == ".exr" and struct.unpack("<I", content[:4])[0] == 20000630, name
