# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""The part of tools/docs/export_pictures.py that runs in Blender: a plate under a sky that shines through a round hole."""
import json
import math
import pathlib
import sys

import bpy

JOB = json.loads(pathlib.Path(sys.argv[sys.argv.index("--") + 1]).read_text())
SCALE = 10.0 / JOB["width"]  # units per mm: Cycles takes no walk of less than 1e-8 units


def add_mesh(name, vertices, faces, material):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.materials.append(material)
    shown = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(shown)
    return shown


def black():
    material = bpy.data.materials.new("black")
    material.use_nodes = True
    material.node_tree.nodes.clear()
    diffuse = material.node_tree.nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs[0].default_value = (0, 0, 0, 1)
    output = material.node_tree.nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(diffuse.outputs[0], output.inputs[0])
    return material


def add_mask(radius, height, far=1000.0, sides=256):
    """A black plane with a hole, which the camera does not see."""
    around = [(math.cos(2 * math.pi * i / sides), math.sin(2 * math.pi * i / sides)) for i in range(sides)]
    vertices = [(r * x, r * y, height) for r in (radius, far) for x, y in around]
    faces = [(i, (i + 1) % sides, sides + (i + 1) % sides, sides + i) for i in range(sides)]
    add_mesh("mask", vertices, faces, black()).visible_camera = False


def main():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    source = pathlib.Path(JOB["script"]).read_text().replace("\nMM_PER_UNIT = 1\n", "\nMM_PER_UNIT = %r\n" % (1 / SCALE))
    exec(compile(source, JOB["script"], "exec"), {})
    material = bpy.data.materials[JOB["material"]]
    w, deep = 200.0, 200.0
    corners = [(x, y, z) for x in (-w, w) for y in (-w, w) for z in (-deep, 0)]
    if JOB["is_sheet"]:
        add_mesh("sheet", [(-w, -w, 0), (w, -w, 0), (w, w, 0), (-w, w, 0)], [(0, 1, 2, 3)], material)
    else:
        add_mesh("plate", corners, [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)], material)
    add_mask(SCALE * JOB["disc"], -0.002 if JOB["is_sheet"] else 0.002)
    if JOB["is_sheet"]:  # no light from the side of the camera
        add_mask(1e-3, 0.5)
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale, camera.sensor_fit = "ORTHO", 10.0, "HORIZONTAL"
    holder = bpy.data.objects.new("camera", camera)
    holder.location = (0, 0, 50)
    scene.collection.objects.link(holder)
    scene.camera = holder
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs[0].default_value = (1, 1, 1, 1)
    world.cycles_visibility.glossy = False  # what the surface mirrors is left out
    scene.world = world
    scene.render.engine = "CYCLES"
    scene.render.film_transparent = True
    scene.render.resolution_x, scene.render.resolution_y = JOB["size"]
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = JOB["exr"]
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = JOB["samples"], False, False
    cycles.pixel_filter_type = "BOX"
    cycles.max_bounces, cycles.diffuse_bounces = 12, 1
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(JOB["exr"])
    image.colorspace_settings.name = "Non-Color"
    flat, channels, width = list(image.pixels), image.channels, JOB["size"][0]
    rows = [[flat[channels * (y * width + x):channels * (y * width + x) + 3] for x in range(width)] for y in range(JOB["size"][1])]
    pathlib.Path(JOB["out"]).write_text(json.dumps(rows[::-1]))


main()
