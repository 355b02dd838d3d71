# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""What the Principled BSDF of a version of Blender has to be set to, so that Cycles walks in the medium that is wanted.

Plain Python, without bpy. A medium is a dict as `lamina export --to blender` writes it: per channel R, G, B `albedo` (of
single scattering) and `mean_free_path_mm` of a half-space under a boundary that does not refract, as Cycles has it, which
returns `reflectance` of diffuse light; `g`, `ior` and `roughness` (alpha of the facets) of the surface; of sheets
`reflectance` and `transmittance` alone.

The rules are facts of Cycles: 3.4.1 as Debian has it, tested there; 4.0 to 5.1 and 5.2 as their sources read, untested.

How long a radius is: up to 5.1, and with LEGACY later, the kernel divides it by 4 pi and takes it as 1 / sigma_t', but of SKIN,
whose radius it multiplies by sqrt(3 (1 - albedo')). From 5.2 on RANDOM_WALK has the radius as it is for 1 / sigma_t.
"""
import math

WHITEST = 0.999999  # albedo that Cycles does not go beyond
METHODS = ("RANDOM_WALK", "SKIN", "LEGACY")


class Refused(ValueError):
    """A medium or a version that no rule is known for."""


def rule_of(version):
    """The name of the rules of a version such as (3, 4, 1)."""
    if version < (3, 0):
        raise Refused("Blender %s: lamina's rules begin with 3.0" % ".".join(map(str, version)))
    return "3.0" if version < (4, 0) else "4.0" if version < (5, 2) else "5.2"


def polynomial(x, coefficients):
    total = 0.0
    for coefficient in reversed(coefficients):
        total = total * x + coefficient
    return total


def wrenninge_albedo(color, g):
    """[Wrenninge2017], as Cycles has it from 3.0 to 5.1; LEGACY and SKIN also later."""
    a = polynomial(g, (1.8260523782, -1.28451056436, -1.79904629312, 9.19393289202, -22.8215585862, 32.0234874259,
                       -23.6264803333, 7.21067002658))
    b = 4.98511194385 + 0.127355959438 * math.exp(polynomial(g, (
        0.0, 31.1491581433, -201.847017512, 841.576016723, -2018.09288505, 2731.71560286, -1935.41424244, 559.009054474)))
    c = polynomial(g, (1.09686102424, -0.394704063468, 1.05258115941, -8.83963712726, 28.8643230661, -46.8802913581,
                       38.5402837518, -12.7181042538))
    d = polynomial(g, (0.496310210422, 0.360146581622, -2.15139309747, 17.8896899217, -55.2984010333, 82.065982243,
                       -58.5106008578, 15.8478295021))
    e = 4.23190299701 + 0.00310603949088 * math.exp(polynomial(g, (
        0.0, 76.7316253952, -594.356773233, 2448.8834203, -5576.68528998, 7116.60171912, -4763.54467887, 1303.5318055)))
    f = polynomial(g, (2.40602999408, -2.51814844609, 9.18494908356, -79.2191708682, 259.082868209, -403.613804597,
                       302.85712436, -87.4370473567))
    blend = color ** 0.25
    albedo = (1 - blend) * a * math.atan(b * color) ** c + blend * d * math.atan(e * color) ** f
    return min(max(albedo, 0.0), WHITEST)


def van_de_hulst_albedo(color, g):
    """[VanDeHulst1980], inverted, as Cycles has it from 5.2."""
    s = 4.09712 + 4.20863 * color - math.sqrt(9.59217 + 41.6808 * color + 17.7126 * color * color)
    return min(max((1 - s * s) / (1 - g * s * s), 0.0), WHITEST)


def van_de_hulst_color(albedo, g):
    s = math.sqrt((1 - albedo) / (1 - g * albedo))
    return (1 - s) * (1 - 0.139 * s) / (1 + 1.17 * s)


def argument_of(value, rising, high):
    """Where in [0, high] a rising function has a value: the low end where it is above, the high one where it is below."""
    low = 0.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        if rising(middle) < value:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def color_of(albedo, g, fit):
    """The color from which `fit` makes an albedo; the lowest one where it makes nothing whiter."""
    return argument_of(min(albedo, WHITEST), lambda color: fit(color, g), 1.0)


def albedo_of_changed_color(albedo, g, factor):
    """The albedo with which a half-space under a matched boundary returns `factor` times what it returns with `albedo`:
    van de Hulst's fit is right for what differs little."""
    return argument_of(van_de_hulst_color(albedo, g) * factor, lambda x: van_de_hulst_color(x, g), WHITEST)


def fresnel(cos_i, eta):
    sin2_t = (1 - cos_i * cos_i) / (eta * eta)
    if sin2_t >= 1:
        return 1.0
    cos_t = math.sqrt(1 - sin2_t)
    r_s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t)
    r_p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t)
    return 0.5 * (r_s * r_s + r_p * r_p)


def fresnel_diffuse(eta, steps=200):
    """Of diffuse light that arrives from outside."""
    cosines = ((i + 0.5) / steps for i in range(steps))
    return sum(2 * c * fresnel(c, eta) for c in cosines) / steps


def burley_factors(roughness):
    """Parts of the color that the diffuse lobes of Blender 3's Principled BSDF make in uniform light: of the walk, which
    they darken on the way out (on the way in the kernel leaves the factor out), and of the retro-reflection beside it.
    `roughness` is the slider's."""
    steps = 24
    walk = retro = 0.0
    schlick = [(1 - (i + 0.5) / steps) ** 5 for i in range(steps)]
    for i, f_v in enumerate(schlick):
        cos_v = (i + 0.5) / steps
        for j, f_l in enumerate(schlick):
            cos_l = (j + 0.5) / steps
            weight = 4 * cos_v * cos_l / (steps * steps)
            walk += weight * (1 - 0.5 * f_l)
            sines = math.sqrt((1 - cos_v ** 2) * (1 - cos_l ** 2))
            for k in range(steps):
                rr = roughness * (1 + cos_v * cos_l + sines * math.cos(math.pi * (k + 0.5) / steps))
                retro += weight / steps * rr * (f_l + f_v + f_l * f_v * (rr - 1))
    return walk, retro


def refracted_entry_factor(albedo, g, ior):
    """How much of diffuse light a half-space returns where paths enter along refracted directions, over the same where
    they enter evenly, as Cycles has it from 4.0. By Hapke's H function and similarity."""
    gamma = math.sqrt((1 - albedo) / (1 - g * albedo))

    def returned(cosine):
        return 1 - gamma * (1 + 2 * cosine) / (1 + 2 * cosine * gamma)

    steps = 100
    even = refracted = 0.0
    for i in range(steps):
        cosine = (i + 0.5) / steps
        even += 2 * cosine * returned(cosine) / steps
        refracted += 2 * cosine * returned(math.sqrt(1 - (1 - cosine * cosine) / (ior * ior))) / steps
    return refracted / even if even > 0 else 1.0


def dipole_albedo(color, ior):
    """The reduced albedo that SKIN takes for its radius, by the dipole of [Jensen2001]."""
    inverse = 1 / ior
    f_dr = inverse * (-1.440 * inverse + 0.710) + 0.668 + 0.0636 * ior
    a = 4.0 / 3.0 * (1 + f_dr) / (1 - f_dr)
    if color < 1e-4:
        return 0.0
    if color >= 0.995:
        return WHITEST
    low, high = 0.0, 1.0
    for _ in range(12):  # as many steps as Cycles takes
        middle = 0.5 * (low + high)
        s = math.sqrt(3 * (1 - middle))
        if 0.5 * middle * (1 + math.exp(-a * s)) * math.exp(-s) < color:
            low = middle
        else:
            high = middle
    return middle


def clamped(value, low, high):
    return min(max(value, low), high)


def walk(medium, rule, method):
    """(color, radius in mm, g) per channel, before the slider's units."""
    g = medium["g"]
    is_new = rule == "5.2" and method == "RANDOM_WALK"
    if not (-0.99 <= g <= 0.99 if is_new else 0.0 <= g <= 0.9):
        raise Refused("g must lie in %s for this method, but is %g" % ("[-0.99, 0.99]" if is_new else "[0, 0.9]", g))
    fit = van_de_hulst_albedo if is_new else wrenninge_albedo
    ior = clamped(medium["ior"], 1.01, 3.8)
    if rule == "3.0":
        of_walk, of_retro = burley_factors(math.sqrt(medium["roughness"]))
    else:
        enters = 1 - fresnel_diffuse(medium["ior"])
    colors, radii = [], []
    for albedo, length in zip(medium["albedo"], medium["mean_free_path_mm"]):
        wanted = van_de_hulst_color(albedo, g)
        if rule == "3.0":  # what the walk has to return, beside the retro-reflection of the color itself
            color = color_of(albedo, g, fit)
            for _ in range(4):
                changed = albedo_of_changed_color(albedo, g, max(1 - of_retro * color / wanted, 0.0) / of_walk)
                color = color_of(changed, g, fit)
        else:  # the reflection at the surface takes its part of the light
            changed = albedo
            for _ in range(4):
                part = refracted_entry_factor(changed, g, ior)
                part = 0.5 * (1 + part) if method == "SKIN" else part
                changed = albedo_of_changed_color(albedo, g, 1 / (enters * part))
            color = color_of(changed, g, fit)
        colors.append(color)
        if is_new:
            radii.append(length)  # the mean free path itself
        else:
            scaled = length / (1 - g)  # 1 / sigma_t is radius times 1 - g
            radii.append(scaled / math.sqrt(3 * (1 - dipole_albedo(color, ior))) if method == "SKIN"
                         else 4 * math.pi * scaled)
    return colors, radii


def plan(medium, version, mm_per_unit, method="RANDOM_WALK"):
    """What nodes a material has, and what they are set to.

    version: of Blender, as (3, 4, 1); mm_per_unit: of the scene; method: one of METHODS, LEGACY from 5.2 on.
    returns {"kind": "subsurface", "method": ..., "inputs": {socket: value}}, or {"kind": "sheet", ...} where the version
    has no thin wall.
    """
    rule = rule_of(version)
    if method not in METHODS or (method == "LEGACY" and rule != "5.2"):
        raise Refused("method must be RANDOM_WALK, SKIN, or from 5.2 on LEGACY, but is " + str(method))
    if not mm_per_unit > 0:
        raise Refused("mm_per_unit must be > 0, but is %s" % mm_per_unit)
    roughness = math.sqrt(medium["roughness"])  # alpha is its square
    if medium.get("transmittance"):
        enters = 1 - fresnel_diffuse(medium["ior"])
        sides = {side: [clamped(x / enters, 0.0, 1.0) for x in medium[side]] for side in ("reflectance", "transmittance")}
        if rule == "5.2":
            both = [clamped(r + t, 0.0, 1.0) for r, t in zip(*sides.values())]
            through = sum(sides["transmittance"]) / max(sum(sides["reflectance"]) + sum(sides["transmittance"]), 1e-12)
            return {"kind": "subsurface", "method": "RANDOM_WALK",
                    "inputs": {"Base Color": both, "Subsurface Weight": 1.0, "Subsurface Anisotropy": 2 * through - 1,
                               "Roughness": roughness, "IOR": medium["ior"], "Thin Wall": True}}
        return {"kind": "sheet", "ior": medium["ior"], "roughness": roughness, **sides}
    colors, radii = walk(medium, rule, method)
    radii = [radius / mm_per_unit for radius in radii]
    longest = max(radii)
    if rule == "3.0":
        specular = clamped(((medium["ior"] - 1) / (medium["ior"] + 1)) ** 2 / 0.08, 0.0, 1.0)
        return {"kind": "subsurface", "method": "RANDOM_WALK" if method == "SKIN" else "RANDOM_WALK_FIXED_RADIUS",
                "inputs": {"Base Color": colors, "Subsurface": 1.0, "Subsurface Color": colors, "Subsurface Radius": radii,
                           "Subsurface IOR": clamped(medium["ior"], 1.01, 3.8), "Subsurface Anisotropy": medium["g"],
                           "Specular": specular, "Roughness": roughness, "IOR": medium["ior"]}}
    name = {"RANDOM_WALK": "RANDOM_WALK", "SKIN": "RANDOM_WALK_SKIN", "LEGACY": "RANDOM_WALK_LEGACY"}[method]
    return {"kind": "subsurface", "method": name,
            "inputs": {"Base Color": colors, "Subsurface Weight": 1.0, "Subsurface Scale": longest,
                       "Subsurface Radius": [radius / longest for radius in radii],
                       "Subsurface IOR": clamped(medium["ior"], 1.01, 3.8), "Subsurface Anisotropy": medium["g"],
                       "Roughness": roughness, "IOR": medium["ior"]}}
