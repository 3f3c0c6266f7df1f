#!/bin/bash
# Builds into build/PRESET; presets are in CMakePresets.json.
#
#   deploy/build.sh PRESET [-DOPTION=VALUE...] [TARGET...]      no target: all
#
# The packages must be there: see install-packages.sh. Two builds of a preset wait for each other.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=${1:?which preset? See CMakePresets.json}
shift
options=()
targets=()
for argument in "$@"; do
  case $argument in
    -D*) options+=("$argument") ;;
    *) targets+=("$argument") ;;
  esac
done
((${#targets[@]})) || targets=(all)

folder=build/$preset
mkdir -p "$folder"
exec 9>"$folder/.lock"
flock 9
# Where ccache is there: what a file depends on is asked of the compiler, not of a run of the
# preprocessor before it, which costs a tenth of a first build.
export CCACHE_DEPEND=1
echo "Building ${targets[*]} in $folder"
log=$folder/configure.log
if ! cmake --preset "$preset" "${options[@]}" >"$log" 2>&1; then
  cat "$log" >&2
  exit 1
fi
cmake --build --preset "$preset" --target "${targets[@]}"
