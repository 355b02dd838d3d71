# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Materials of Blender as rules.plan says. Nothing but nodes is written."""
import bpy


def set_input(node, name, value):
    """Sets a socket if the node has it: versions differ. A color gets an alpha."""
    socket = node.inputs.get(name)
    if socket is None:
        return False
    if socket.type == "RGBA" and len(value) == 3:
        value = (*value, 1.0)
    socket.default_value = value
    return True


def make_material(name, plan):
    """A new material, or the one of that name with new nodes."""
    material = bpy.data.materials.get(name) or bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    output.location = (400, 0)
    if plan["kind"] == "sheet":
        shader = make_sheet(tree, plan)
    else:
        principled = tree.nodes.new("ShaderNodeBsdfPrincipled")
        principled.subsurface_method = plan["method"]
        missing = [name for name, value in plan["inputs"].items() if not set_input(principled, name, value)]
        if missing:
            raise RuntimeError("the Principled BSDF of Blender %s has no %s" % (bpy.app.version_string, ", ".join(missing)))
        shader = principled.outputs[0]
    tree.links.new(shader, output.inputs["Surface"])
    return material


def make_sheet(tree, plan):
    """Both sides scatter evenly, each in its color, below a surface that reflects."""
    both = tree.nodes.new("ShaderNodeAddShader")
    both.location = (0, 0)
    for i, (kind, side) in enumerate((("ShaderNodeBsdfDiffuse", "reflectance"), ("ShaderNodeBsdfTranslucent", "transmittance"))):
        node = tree.nodes.new(kind)
        node.location = (-200, 100 - 200 * i)
        set_input(node, "Color", plan[side])
        tree.links.new(node.outputs[0], both.inputs[i])
    fresnel = tree.nodes.new("ShaderNodeFresnel")
    fresnel.location = (0, 200)
    set_input(fresnel, "IOR", plan["ior"])
    glossy = tree.nodes.new("ShaderNodeBsdfGlossy")
    glossy.location = (0, -200)
    set_input(glossy, "Roughness", plan["roughness"])
    mix = tree.nodes.new("ShaderNodeMixShader")
    mix.location = (200, 0)
    for socket, source in zip(mix.inputs, (fresnel, both, glossy)):
        tree.links.new(source.outputs[0], socket)
    return mix.outputs[0]


def link_maps(material, folder, sockets):
    """Images of a folder whose names end in the keys of `sockets`, linked to those inputs; the names that were linked."""
    tree = material.node_tree
    shader = next((node for node in tree.nodes if node.type == "BSDF_PRINCIPLED"), None)
    linked = []
    if shader is None:
        return linked
    for file in sorted(folder.iterdir()):
        kind = file.stem.lower().rsplit("_", 1)[-1]
        if kind not in sockets or file.suffix.lower() not in (".png", ".exr", ".jpg", ".jpeg", ".tif", ".tiff"):
            continue
        image = tree.nodes.new("ShaderNodeTexImage")
        image.image = bpy.data.images.load(str(file), check_existing=True)
        image.location = (-600, -300 * len(linked))
        if kind in ("roughness", "normal", "bump"):
            image.image.colorspace_settings.name = "Non-Color"
        output = image.outputs["Color"]
        if kind in ("normal", "bump"):
            between = tree.nodes.new("ShaderNodeNormalMap" if kind == "normal" else "ShaderNodeBump")
            between.location = (-300, -300 * len(linked))
            tree.links.new(output, between.inputs["Color" if kind == "normal" else "Height"])
            output = between.outputs["Normal"]
        for name in sockets[kind]:
            if shader.inputs.get(name) is not None:
                tree.links.new(output, shader.inputs[name])
        linked.append(file.name)
    return linked
