# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""The part of round_trip.py that runs in Blender: renders the jobs of a folder and compares them with lamina's pictures."""
import json
import math
import pathlib
import sys

import bpy

FOLDER = pathlib.Path(sys.argv[sys.argv.index("--") + 1])


def read_obj(file):
    vertices, faces = [], []
    for line in open(file):
        words = line.split()
        if words and words[0] == "v":
            vertices.append(tuple(map(float, words[1:])))
        elif words and words[0] == "f":
            faces.append(tuple(int(word) - 1 for word in words[1:]))
    return vertices, faces


def pixels_of(file):
    image = bpy.data.images.load(str(file))
    image.colorspace_settings.name = "Non-Color"
    width, height = image.size
    flat, channels = list(image.pixels), image.channels
    bpy.data.images.remove(image)
    rows = [[flat[channels * (y * width + x):channels * (y * width + x) + channels] for x in range(width)] for y in range(height)]
    return rows[::-1]  # Blender counts from below


def make_scene(job, scale):
    """In units of 1 / scale mm: Cycles takes no walk of less than 1e-8 units, and sees nothing far away."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    source = pathlib.Path(job["script"]).read_text().replace("\nMM_PER_UNIT = 1\n", "\nMM_PER_UNIT = %r\n" % (1 / scale))
    exec(compile(source, job["script"], "exec"), {})
    materials = [bpy.data.materials[job["material"]], bpy.data.materials.new("black")]
    materials[1].use_nodes = True
    materials[1].node_tree.nodes.clear()
    black = materials[1].node_tree.nodes.new("ShaderNodeBsdfDiffuse")
    black.inputs[0].default_value = (0, 0, 0, 1)
    output = materials[1].node_tree.nodes.new("ShaderNodeOutputMaterial")
    materials[1].node_tree.links.new(black.outputs[0], output.inputs[0])
    for i, file in enumerate(job["meshes"]):
        vertices, faces = read_obj(file)
        mesh = bpy.data.meshes.new("mesh%d" % i)
        mesh.from_pydata([[scale * x for x in v] for v in vertices], [], faces)
        mesh.materials.append(materials[i])
        scene.collection.objects.link(bpy.data.objects.new("object%d" % i, mesh))
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit = "HORIZONTAL"
    camera.angle = math.radians(job["fov"])
    camera.clip_end = 1e6
    holder = bpy.data.objects.new("camera", camera)
    holder.location = (0, 0, scale * job["distance"])
    scene.collection.objects.link(holder)
    scene.camera = holder
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs[0].default_value = (1, 1, 1, 1)
    world.node_tree.nodes["Background"].inputs[1].default_value = 0.0 if job["kind"] == "edge" else 1.0
    scene.world = world
    if job["kind"] == "edge":
        sun = bpy.data.lights.new("sun", "SUN")
        sun.angle, sun.energy = 0.0, 1.0
        lamp = bpy.data.objects.new("sun", sun)
        lamp.rotation_euler = (0, -math.pi / 4, 0)  # shines along -z, turned to come from -x
        scene.collection.objects.link(lamp)
    render = scene.render
    render.engine = "CYCLES"
    render.film_transparent = True
    render.resolution_x, render.resolution_y = job["size"]
    render.resolution_percentage = 100
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    render.filepath = job["stem"] + "_cycles.exr"
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = job["samples"], False, False
    cycles.pixel_filter_type = "BOX"
    cycles.max_bounces, cycles.diffuse_bounces = 12, 6
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    bpy.ops.render.render(write_still=True)
    return pixels_of(render.filepath)


def mean_color(pixels, covered):
    """Over what the object covers, its rim included; the background is black."""
    return [sum(p[c] for row in pixels for p in row) / covered for c in range(3)]


def edge_distances(pixels, job):
    """Where light from the lit half, x > 0, has fallen to parts of what it is at the edge; in mm, per channel."""
    width = job["size"][0]
    pixel = 12 * job["unit"] / width
    result = []
    for c in range(3):
        line = [sum(row[x][c] for row in pixels) / len(pixels) for x in range(width)]
        plateau = sum(line[-width // 8:]) / len(line[-width // 8:])
        result.append([])
        for part in (0.5, 0.1):
            wanted, found = part * 0.5 * plateau, None
            for x in range(width // 2, 0, -1):
                if line[x - 1] < wanted <= line[x]:
                    t = (line[x] - wanted) / (line[x] - line[x - 1])
                    found = (width / 2 - x - 0.5 + t) * pixel
                    break
            result[-1].append(found)
    return result


def percent(x, of):
    return "–" if x is None or not of else "%.1f" % (100 * x / of)


def main():
    results = []
    for job in json.loads((FOLDER / "jobs.json").read_text()):
        theirs = make_scene(job, 4.0 / job["unit"] if job["kind"] == "edge" else 1.0)
        row = {"material": job["material"], "kind": job["kind"]}
        if job["kind"] == "edge":
            row["wanted"], row["obtained"] = job["wanted"], edge_distances(theirs, job)
            text = "; ".join("50 %%: %s mm %s, 10 %%: %s mm %s" % tuple(
                part for w, o in zip(wanted, obtained) for part in ("–" if w is None else "%.3g" % w, percent(o, w)))
                for wanted, obtained in zip(row["wanted"], row["obtained"]))
        else:
            own = json.loads(pathlib.Path(job["stem"] + "_lamina.json").read_text())
            covered = sum(p[3] for row in theirs for p in row)
            row["wanted"], row["obtained"] = mean_color(own, covered), mean_color(theirs, covered)
            text = " ".join(percent(o, w) for w, o in zip(row["wanted"], row["obtained"]))
        row["text"] = "| %s | %s | %s |" % (job["material"], job["kind"], text)
        results.append(row)
        (FOLDER / "results.json").write_text(json.dumps(results))


main()
