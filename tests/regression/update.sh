#!/usr/bin/env bash
# Regenerate the references of all scenarios, or of those named: update.sh [scenarios/a.yaml ...]
# Few channels and samples keep each below 100 kB. VEHICLEDYN names the program to use.
set -euo pipefail
cd "$(dirname "$0")/../.."
if [ $# -eq 0 ]; then set -- scenarios/*.yaml; fi

for scenario in "$@"; do
  name=$(basename "$scenario" .yaml)
  "${VEHICLEDYN:-vehicledyn}" run "$scenario" --no-plots --quiet \
    -o "tests/regression/references/$name.h5" \
    --set "output.interval=250 ms" \
    --set "output.channels=[chassis.?, chassis.yaw, chassis.pitch, chassis.roll, steering.rack,
      wheel_*.tyre.normal_force, wheel_fl.tyre.lateral_force]"
  echo "tests/regression/references/$name.h5"
done
