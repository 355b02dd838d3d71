#!/usr/bin/env bash
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# The commands slab and profile by diffusion: results, JSON, and one line for wrong use.
set -euo pipefail
lamina=$1
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
export LAMINA_CACHE=$folder/cache
fail() { echo "FAILED: $1" >&2; exit 1; }

# Into a file first, here and below: grep -q ends at the first match, which stops a command that is still printing.
"$lamina" slab donner_jensen_skin --method diffusion --json "$folder/slab.json" > "$folder/told"
grep -q "bloody dermis" "$folder/told" || fail "slab names the layers"
python3 - "$folder/slab.json" <<'PY'
import json, sys
slab = json.load(open(sys.argv[1]))
assert slab["command"] == "slab" and slab["method"] == "diffusion" and slab["bands"] == ["R", "G", "B"]
entered = [1 - f for f in slab["specular_reflectance"]]
# Totals per entered flux of Donner and Jensen's skin, from an independent program.
for b, expected in enumerate((.40861, .39882, .33281)):
    assert abs(slab["diffuse_reflectance"][b] / entered[b] - expected) < 1e-5
    total = slab["specular_reflectance"][b] + slab["diffuse_reflectance"][b] + slab["transmittance"][b]
    assert abs(total + sum(layer[b] for layer in slab["absorptance"]) - 1) < 1e-12
PY

"$lamina" profile leaf --method diffusion --compare --radii 40 --plot "$folder/leaf.svg" --json "$folder/leaf.json" > /dev/null 2>&1 ||
  fail "profile with comparison and plot"
grep -q "Transmittance" "$folder/leaf.svg" || fail "the plot has T(r)"
python3 - "$folder/leaf.json" <<'PY'
import json, sys
profile = json.load(open(sys.argv[1]))
assert profile["per"] == "entered_flux" and profile["method"] == "diffusion"
assert len(profile["r_mm"]) == len(profile["reflectance_profile"]) == len(profile["transmittance_profile"]) == 40
assert len(profile["reflectance_profile"][0]) == len(profile["total_transmittance"]) == 3
dipole = profile["comparison"]
assert dipole["method"] == "dipole"
for r, d in zip(profile["reflectance_profile"], zip(dipole["reflectance_profile"], dipole["relative_difference"])):
    for b, difference in enumerate(d[1]):  # far out too, where the dipole is off by nearly all; null where nothing is left
        if difference is not None: assert abs(difference - (d[0][b] / r[b] - 1)) < 1e-9 * (1 + abs(difference))
        else: assert r[b] < 1e-14 * profile["reflectance_profile"][0][b]
PY

"$lamina" slab donner_jensen_skin --json "$folder/slab.json" > /dev/null || fail "slab by adding-doubling"
"$lamina" slab donner_jensen_skin --derivatives --json "$folder/derivatives.json" > "$folder/derivatives" || fail "slab --derivatives"
grep -q "reflectance: epidermis, sigma_a" "$folder/derivatives" || fail "slab --derivatives names layers"
"$lamina" materials donner_jensen_skin > "$folder/made_of.json" || fail "materials prints what skin is made of"
python3 - "$folder/derivatives.json" "$folder/made_of.json" <<'PY'
import json, sys
found, skin = (json.load(open(file)) for file in sys.argv[1:])
by = found["derivatives"]["diffuse_reflectance"]
assert len(by["by_g"]) == 3 and set(by) == {"by_sigma_a", "by_sigma_s", "by_g", "by_thickness"}
# Coefficients times c and thicknesses over c give the same.
for b in range(3):
    change = largest = 0
    for l, layer in enumerate(skin["layers"]):
        of = lambda key: layer[key][b] if isinstance(layer[key], list) else layer[key]
        parts = [of("sigma_a") * by["by_sigma_a"][l][b], of("sigma_s") * by["by_sigma_s"][l][b]]
        if layer["thickness"] != "infinite": parts.append(-layer["thickness"] * by["by_thickness"][l][b])
        change += sum(parts); largest = max(largest, *map(abs, parts))
    assert abs(change) < 1e-9 * largest, (change, largest)
    assert by["by_sigma_a"][0][b] < 0 < by["by_sigma_s"][0][b]
PY

"$lamina" profile donner_jensen_skin --domain frequency --derivatives --radii 2 --r-min 1 --r-max 2 --accuracy .1 --json "$folder/waves.json" > "$folder/waves" \
  || fail "profile --domain frequency --derivatives"
grep -q "R: epidermis, sigma_a" "$folder/waves" || fail "profile --derivatives names layers"
python3 - "$folder/derivatives.json" "$folder/waves.json" <<'PY'
import json, sys
slab, waves = (json.load(open(file))["derivatives"] for file in sys.argv[1:])
assert set(waves) == {"reflectance", "transmittance"}
for by, layers in waves["reflectance"].items():  # [layer][k][band], k 0 first
    within = 1e-6 if by == "by_g" else .02  # what comes back from inside unscattered knows no g
    for l, at_k in enumerate(layers):
        assert len(at_k) == 3 and len(at_k[0]) == 3
        for wave, total in zip(at_k[0], slab["diffuse_reflectance"][by][l]):
            assert abs(wave - total) <= within * abs(total), (by, l, wave, total)
PY

"$lamina" profile donner_jensen_skin --compare --radii 60 --json "$folder/skin.json" > /dev/null || fail "profile by radiative transfer"
python3 - "$folder/slab.json" "$folder/skin.json" <<'PY'
import json, sys
slab, skin = (json.load(open(file)) for file in sys.argv[1:])
assert slab["method"] == "radiative_transfer"
for b, expected in enumerate((.398083, .392509, .309059)):
    assert abs(slab["diffuse_reflectance"][b] - expected) < 1e-5
    assert abs(skin["total_reflectance"][b] - expected) < 1e-5
assert skin["method"] == "radiative_transfer" and skin["per"] == "arriving_flux"
assert max(skin["estimated_error"]) < .005 and len(skin["accuracy"]) == len(skin["transmittance_accuracy"]) == 60
assert skin["comparison"]["method"] == "diffusion"
PY
"$lamina" profile donner_jensen_skin --radii 60 --json "$folder/again.json" > /dev/null || fail "profile by radiative transfer from the cache"
"$lamina" profile donner_jensen_skin --radii 60 --no-cache --json "$folder/anew.json" > /dev/null || fail "profile by radiative transfer without the cache"
python3 - "$folder/skin.json" "$folder/again.json" "$folder/anew.json" <<'PY'
import json, sys
first, again, anew = (json.load(open(file)) for file in sys.argv[1:])
assert [x.pop("from_cache") for x in (first, again, anew)] == [False, True, False]
del first["comparison"]
assert first == again == anew
PY
"$lamina" profile paper --incidence diffuse --from below --accuracy 0.1 --radii 20 --json "$folder/below.json" > /dev/null ||
  fail "profile by radiative transfer of diffuse light from below"
python3 - "$folder/below.json" <<'PY'
import json, sys
below = json.load(open(sys.argv[1]))
assert below["incidence"] == "diffuse" and below["from"] == "below"
assert len(below["transmittance_profile"]) == 20 and min(below["total_transmittance"]) > 0
PY
"$lamina" profile donner_jensen_skin --incidence 45 --radii 8 --r-min .05 --r-max 2 --moments 2 --json "$folder/slanted.json" > /dev/null ||
  fail "profile by radiative transfer of an oblique beam"
"$lamina" profile leaf --gaussians 6 --accuracy .1 --json "$folder/gaussians.json" > /dev/null || fail "profile as Gaussians"
python3 - "$folder/slanted.json" "$folder/gaussians.json" <<'PY'
import json, sys
slanted, gaussians = (json.load(open(file)) for file in sys.argv[1:])
assert slanted["incidence_deg"] == 45
moments = slanted["reflectance_moments"]
assert len(moments) == 8 and len(moments[0]) == 2 and len(moments[0][0]) == 3
assert all(0 < m[1][0] < 2 * m[0][0] for m in moments[:4])  # more light ahead than behind
assert len(gaussians["variances_mm2"]) == len(gaussians["reflectance_weights"]) == 7
assert max(gaussians["reflectance_rms_error"]) < .05 and len(gaussians["transmittance_rms_error"]) == 3
PY
for wrong in "--incidence diffuse --method diffusion" "--from below --compare" "--incidence askew" "--incidence 95" \
  "--gaussians 4 --method dipole" "--gaussians 4 --incidence 30"; do
  "$lamina" profile leaf $wrong > /dev/null 2> "$folder/wrong" && fail "profile $wrong"
  [ $? -eq 2 ] && [ "$(wc -l < "$folder/wrong")" -eq 1 ] || fail "one line and status 2 for profile $wrong"
done
"$lamina" profile donner_jensen_skin --from below > /dev/null 2> "$folder/wrong" && fail "half-space from below"
grep -q "infinite" "$folder/wrong" || fail "why a half-space cannot be lit from below"
"$lamina" slab donner_jensen_skin --compare=20000 --json "$folder/compare.json" > /dev/null || fail "slab --compare"
python3 - "$folder/compare.json" <<'PY'
import json, sys
rows = json.load(open(sys.argv[1]))["rows"]
assert len(rows) == 18 and max(abs(row["difference_in_standard_errors"]) for row in rows) < 4.5
PY
"$lamina" profile leaf --domain frequency --accuracy .1 --radii 4 --json "$folder/leaf.json" > /dev/null || fail "frequencies"
grep -q '"estimated_error"' "$folder/leaf.json" || fail "frequencies must say how accurate they are"

refused() {
  local status=0
  "$lamina" "$@" > /dev/null 2> "$folder/error" || status=$?
  [ "$status" = 2 ] || fail "$* must exit with 2, not $status"
  [ "$(wc -l < "$folder/error")" = 1 ] || fail "$* must say so in one line"
}
cat > "$folder/glow.json" <<'JSON'
{ "lamina": "material", "version": 1, "name": "thin, on white", "source": "a test", "length_unit": "mm", "bands": [600],
  "layers": [ { "thickness": 0.1, "ior": 1.4, "sigma_a": 0.05, "sigma_s": 4.95, "g": 0.8 } ], "ior_below": 1,
  "ground": { "reflectance": 1 } }
JSON
"$lamina" profile "$folder/glow.json" --no-cache --accuracy .05 --json - > "$folder/glow" 2> /dev/null || fail "photons refine thin slabs on white"
python3 - "$folder/glow" <<'PYTHON' || fail "and say so"
import json, sys
glow = json.load(open(sys.argv[1]))
assert glow["photons"][0] > 10000 and 0 < glow["mean_error"][0] < .05, glow["mean_error"]
PYTHON
cat > "$folder/dark.json" <<'JSON'
{ "lamina": "material", "version": 1, "name": "dark and forward", "source": "a test", "length_unit": "mm", "bands": [600],
  "layers": [ { "thickness": 0.1, "ior": 1.4, "sigma_a": 2000, "sigma_s": 200, "g": 0.995 } ], "ior_below": 1 }
JSON
refused profile "$folder/dark.json" --no-cache --accuracy .1
grep -q "monte_carlo" "$folder/error" || fail "a doubtful profile names the way out"
"$lamina" profile "$folder/dark.json" --method monte_carlo --photons 1e4 > /dev/null 2>&1 || fail "photons take dark layers"
refused slab
refused slab no_such_material
refused slab leaf --method diffusion --incidence 90
refused slab leaf --method guess
refused slab leaf --accuracy 0
refused slab leaf --derivatives --method diffusion
refused slab marble --derivatives
grep -q "roughness" "$folder/error" || fail "derivatives say what they cannot do"
refused profile leaf --derivatives
refused slab leaf --compare=0
refused profile leaf --domain frequency --method dipole
refused profile leaf --accuracy 2
refused profile leaf --r-min 0
refused profile leaf --radii 1
refused profile leaf --r-min nan

"$lamina" bsdf leaf --method first_order --theta-i 45 --plot "$folder/bsdf.svg" --json "$folder/bsdf.json" > /dev/null ||
  fail "bsdf by first order"
grep -q "transmitted" "$folder/bsdf.svg" || fail "the plot has both sides of a leaf"
"$lamina" bsdf leaf --compare --theta-i 45 --step 15 --json "$folder/compared.json" > "$folder/told"
grep -q layered_bsdf "$folder/told" || fail "bsdf compares"
"$lamina" bsdf leaf --method guess > "$folder/out" 2>&1 && fail "an unknown method of bsdf"
grep -q "must be radiative_transfer, first_order, layered_bsdf or monte_carlo, but is guess" "$folder/out" || fail "bsdf names its methods"
python3 - "$folder/bsdf.json" "$folder/compared.json" <<'PY'
import json, sys
first, compared = (json.load(open(name)) for name in sys.argv[1:])
assert first["method"] == "first_order" and first["brdf"][0][0][0] > 0 and first["btdf"][0][0][1] > 0
assert [m["method"] for m in compared["methods"]] == ["radiative_transfer", "layered_bsdf", "first_order"]
assert all(m < 0.15 for m in compared["methods"][1]["misplaced_reflection"])
PY
