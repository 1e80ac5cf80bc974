#!/usr/bin/env bash
# Run every scenario as a user would and compare its result with the stored reference.
# check.sh [FOLDER for results and JUnit reports]; VEHICLEDYN names the program to use.
#
# Tolerance: 1e-7 of a channel's range and 1e-8 in SI on top, for channels that stay at zero.
# Compilers, their options and the interpreter differ by rounding only, below 1e-11 of the range
# (measured with gcc -O1, -O3 -ffast-math and CasADi); what a change of a model, a law or a
# method does is far above. Scenarios go two at a time.
set -uo pipefail
cd "$(dirname "$0")/../.."
folder=${1:-$(mktemp -d)}
mkdir -p "$folder/systems"
export folder vehicledyn=${VEHICLEDYN:-vehicledyn} compiles=yes
"$vehicledyn" doctor | grep -q '^C compiler.*CasADi interprets' && compiles=no

check() { # check SCENARIO: run it, compare the result with its reference
  local name=${1#scenarios/} brief=()
  name=${name%.yaml}
  mapfile -t brief < <(sed -n "s|^$name |duration=|p" tests/regression/brief.txt)
  if [ ${#brief[@]} -gt 0 ]; then
    if [ "$compiles" = no ]; then
      echo "$name: left out, as it takes long without a compiler"
      return 0
    fi
    brief=(--set "${brief[0]}")
  fi
  "$vehicledyn" run "$1" --no-plots --quiet -o "$folder/$name.h5" "${brief[@]}" || return
  "$vehicledyn" compare "$folder/$name.h5" "tests/regression/references/$name.h5" \
    --interpolate --relative 1e-7 --absolute 1e-8 --junit "$folder/$name.xml"
}
export -f check
printf '%s\0' scenarios/*.yaml scenarios/systems/*.yaml |
  xargs -0 -n 1 -P 2 bash -c 'check "$1"' check || exit 1
