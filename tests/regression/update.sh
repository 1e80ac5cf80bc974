#!/usr/bin/env bash
# Regenerate the references of all scenarios, or of those named: update.sh [scenarios/a.yaml ...]
# Few channels and samples keep each below 160 kB, those of systems in one file below 100 kB. VEHICLEDYN names
# the program to use, PYTHON the Python it is installed in.
set -euo pipefail
cd "$(dirname "$0")/../.."
if [ $# -eq 0 ]; then set -- scenarios/*.yaml scenarios/systems/*.yaml; fi
references=tests/regression/references
mkdir -p $references/systems

for scenario in "$@"; do
  name=$(basename "$scenario" .yaml)
  folder=$(dirname "${scenario#scenarios/}")
  target=$references/$folder/$name.h5
  if grep -q '^model: .*\.yaml$' "$scenario"; then
    mapfile -t changes < <("${PYTHON:-python3}" tests/regression/reference_samples.py "$scenario")
  else
    changes=("output.interval=250 ms"
      "output.channels=[chassis.?, chassis.yaw, chassis.pitch, chassis.roll, steering.rack,
      wheel_*.tyre.normal_force, wheel_fl.tyre.lateral_force]")
  fi
  sets=()
  for change in "${changes[@]}" output.animation=false; do sets+=(--set "$change"); done
  "${VEHICLEDYN:-vehicledyn}" run "$scenario" --no-plots --quiet -o "$target" "${sets[@]}"
  echo "$target"
done
