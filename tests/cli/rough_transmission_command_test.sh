#!/usr/bin/env bash
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# `lamina bsdf --model rough_transmission`: what it prints, and how it ends.
#   rough_transmission_command_test.sh LAMINA PYTHON
set -euo pipefail
lamina=$1 python=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fail() { echo "FAILED: $*" >&2; exit 1; }

# expect CODE TEXT ARGUMENT...: the model with the arguments ends with CODE and prints TEXT.
expect() {
  local code=$1 text=$2 got=0; shift 2
  "$lamina" bsdf --model rough_transmission "$@" >output 2>&1 || got=$?
  [ "$got" = "$code" ] || fail "bsdf $*: exit code $got instead of $code"
  grep -qF -- "$text" output || fail "bsdf $*: no '$text' in: $(cat output)"
}

expect 0 'transmittance one facet 0.9682' --smoothness 6
expect 0 'energy lost 18.' --smoothness 1 --method monte_carlo --photons 100000
expect 0 'height_field' --smoothness 2 --compare --photons 4000
expect 0 'Example:' --help
expect 2 '--theta-i must lie in [0, 90) degrees, but is 90' --theta-i 90
expect 2 '--method of rough_transmission must be' --method adding
expect 2 'smoothness must lie in [0.01, 10000]' --smoothness 0
expect 2 'eta must differ from 1' --eta 1
expect 2 'eta must be > 0 and finite' --eta -1
expect 2 'eta: must be a finite number' --eta nan
expect 2 '--photons: is read by --method monte_carlo, height_field only' --photons 100
expect 2 '--photons: must be a whole number' --method monte_carlo --photons 0
expect 1 'cannot be written' --plot no/such/folder/lobes.svg
expect 0 '' --plot lobes.svg
grep -q '^<svg' lobes.svg || fail "no SVG"

# The cells add up to the total, whatever the method.
for method in analytic "monte_carlo --photons 20000" "height_field --photons 20000"; do
  # shellcheck disable=SC2086
  "$lamina" bsdf --model rough_transmission --method $method --json - | "$python" -c '
import json, math, sys
result = json.load(sys.stdin)
thetas, phis = len(result["theta_o_deg"]), len(result["phi_o_deg"])
flux = 0
for i in range(thetas):
    a, b = (math.sin(k * math.pi / 2 / thetas) for k in (i, i + 1))
    flux += (b * b - a * a) * math.pi / phis * sum(cell[0] for cell in result["btdf"][i])
assert abs(flux - result["transmittance"][0]) < 1e-3, (flux, result["transmittance"])
assert ("standard_error" in result) == (result["method"] != "analytic")
' || fail "the cells of $method do not add up"
done
