#!/usr/bin/env bash
# Run every scenario as a user would and compare its result with the stored reference.
# check.sh [FOLDER for results and JUnit reports]; VEHICLEDYN names the program to use.
#
# Tolerance: 1e-7 of a channel's range and 1e-8 in SI on top, for channels that stay at zero.
# Compilers, their options and the interpreter differ by rounding only, below 1e-11 of the range
# (measured with gcc -O1, -O3 -ffast-math and CasADi); what a change of a model, a law or a
# method does is far above.
set -uo pipefail
cd "$(dirname "$0")/../.."
folder=${1:-$(mktemp -d)}
mkdir -p "$folder"
vehicledyn=${VEHICLEDYN:-vehicledyn}
wrong=0

for scenario in scenarios/*.yaml; do
  name=$(basename "$scenario" .yaml)
  "$vehicledyn" run "$scenario" --no-plots --quiet -o "$folder/$name.h5" &&
    "$vehicledyn" compare "$folder/$name.h5" "tests/regression/references/$name.h5" \
      --interpolate --relative 1e-7 --absolute 1e-8 --junit "$folder/$name.xml" || wrong=1
done
exit $wrong
