# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Materials of lamina in Blender: a panel in the sidebar of the 3D view. Writes shader nodes, nothing else."""
import json
import pathlib

import bpy

from . import nodes, rules, skins

bl_info = {
    "name": "Lamina materials",
    "author": "the lamina authors",
    "version": (0, 1, 0),
    "blender": (3, 0, 0),
    "location": "3D View > Sidebar > Lamina",
    "description": "Skin, stone, milk and leaves as the Principled BSDF of this version of Blender shows them",
    "category": "Material",
}

BUILT_IN = json.loads(pathlib.Path(__file__).with_name("materials.json").read_text())
MAPS = {"color": ("Base Color", "Subsurface Color"), "albedo": ("Base Color", "Subsurface Color"), "roughness": ("Roughness",),
        "normal": ("Normal",), "bump": ("Normal",)}  # by the end of an image's name


def method_items(self, context):
    items = [("RANDOM_WALK", "Random Walk", "the medium itself"), ("SKIN", "Skin", "half of the light enters evenly")]
    if bpy.app.version >= (5, 2):
        items.append(("LEGACY", "Legacy", "the random walk of Blender 4"))
    return items


class LaminaSettings(bpy.types.PropertyGroup):
    source: bpy.props.EnumProperty(name="Source", items=[("BUILT_IN", "Built-in", ""), ("SKIN", "Skin", ""), ("FILE", "File", "")])
    material: bpy.props.EnumProperty(name="Material", items=[(name, name.replace("_", " "), BUILT_IN[name]["source"])
                                                             for name in BUILT_IN])
    file: bpy.props.StringProperty(name="JSON", subtype="FILE_PATH", description="of lamina export --to blender")
    melanin: bpy.props.FloatProperty(name="Melanin", default=0.014, min=skins.MELANIN[0], max=skins.MELANIN[-1], precision=4,
                                     description="volume fraction in the epidermis")
    hemoglobin: bpy.props.FloatProperty(name="Hemoglobin", default=0.003, min=skins.HEMOGLOBIN[0], max=skins.HEMOGLOBIN[-1],
                                        precision=4, description="volume fraction in the dermis")
    roughness: bpy.props.FloatProperty(name="Roughness", default=0.35, min=0.0, max=1.0, description="of skin, as the slider's")
    method: bpy.props.EnumProperty(name="Method", items=method_items)
    mm_per_unit: bpy.props.FloatProperty(name="mm per unit", default=0.0, min=0.0, description="0: as the scene's units say")


def chosen_medium(settings):
    if settings.source == "BUILT_IN":
        return BUILT_IN[settings.material]
    if settings.source == "SKIN":
        return skins.skin(settings.melanin, settings.hemoglobin, settings.roughness ** 2)
    medium = json.loads(pathlib.Path(bpy.path.abspath(settings.file)).read_text())
    if medium.get("format") != "blender":
        raise rules.Refused("%s: must be a file of lamina export --to blender" % settings.file)
    return medium


def mm_per_unit(settings, scene):
    return settings.mm_per_unit or 1000 * scene.unit_settings.scale_length


class LAMINA_OT_apply(bpy.types.Operator):
    """Gives the active object the material"""
    bl_idname = "lamina.apply"
    bl_label = "Apply"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        settings = context.scene.lamina
        try:
            medium = chosen_medium(settings)
            plan = rules.plan(medium, bpy.app.version, mm_per_unit(settings, context.scene), settings.method or "RANDOM_WALK")
            material = nodes.make_material(medium["material"], plan)
        except (rules.Refused, OSError, KeyError, ValueError, RuntimeError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        target = context.object
        if target and hasattr(target.data, "materials"):
            if target.data.materials:
                target.material_slots[target.active_material_index].material = material
            else:
                target.data.materials.append(material)
        return {"FINISHED"}


class LAMINA_OT_maps(bpy.types.Operator):
    """Links images called *_color, *_albedo, *_roughness, *_normal or *_bump of a folder to the active material"""
    bl_idname = "lamina.maps"
    bl_label = "Import maps"
    bl_options = {"REGISTER", "UNDO"}
    directory: bpy.props.StringProperty(subtype="DIR_PATH")

    def invoke(self, context, event):
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        material = context.object and context.object.active_material
        if not material or not material.use_nodes:
            self.report({"ERROR"}, "the active object must have a material with nodes")
            return {"CANCELLED"}
        linked = nodes.link_maps(material, pathlib.Path(self.directory), MAPS)
        if not linked:
            self.report({"ERROR"}, "%s: there is no image that ends in _%s" % (self.directory, ", _".join(MAPS)))
            return {"CANCELLED"}
        self.report({"INFO"}, "linked " + ", ".join(linked))
        return {"FINISHED"}


class LAMINA_PT_panel(bpy.types.Panel):
    bl_label = "Lamina"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Lamina"

    def draw(self, context):
        settings, layout = context.scene.lamina, self.layout
        layout.prop(settings, "source", expand=True)
        shown = {"BUILT_IN": ("material",), "SKIN": ("melanin", "hemoglobin", "roughness"), "FILE": ("file",)}[settings.source]
        for name in (*shown, "method", "mm_per_unit"):
            layout.prop(settings, name)
        layout.operator("lamina.apply")
        layout.operator("lamina.maps")


CLASSES = (LaminaSettings, LAMINA_OT_apply, LAMINA_OT_maps, LAMINA_PT_panel)


def register():
    for one in CLASSES:
        bpy.utils.register_class(one)
    bpy.types.Scene.lamina = bpy.props.PointerProperty(type=LaminaSettings)


def unregister():
    del bpy.types.Scene.lamina
    for one in reversed(CLASSES):
        bpy.utils.unregister_class(one)
