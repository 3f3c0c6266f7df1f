#!/usr/bin/env bash
# The figures of docs/accuracy.md, "Intervals, allocation": crops of four shared scenes and a scene
# of fireflies. Prints as it goes; a quiet machine of two cores takes hours at the full size.
#
#   bench/calibration.sh [SCENE...]      default: all
#
# Exit status 1: some figures are not as asked for.
# RENDERS=250 TRIALS=40 take fewer seeds for coverage and for efficiency than the full 1000 and 100.
set -euo pipefail
cd "$(dirname "$0")/.."
bench=${STRATA_BIN:-build/release/bin}/bench_calibration
shared=${STRATA_SHARED:-../shared}/scenes/pbrt
renders=${RENDERS:-1000}
trials=${TRIALS:-100}

# Frames so small that 36x32 pixels hold edges, shadows and lamps or their reflections.
declare -A crops=(
  [cornell-box]="--resolution 64x64 --crop 4,2,40,34"
  [veach-mis]="--resolution 80x45 --crop 32,4,68,36"
  [coffee]="--resolution 64x80 --crop 16,30,52,62"
  [staircase2]="--resolution 64x64 --crop 4,20,40,52"
)

# measure ARGUMENT...: one run of the bench; what it misses does not stop the next.
measure() {
  local status=0
  "$bench" "$@" || status=$?
  ((status < 2)) || exit "$status"
  ((status == 0)) || missed=yes
}

normal() {  # The control of the bench itself.
  measure normal --allocation uniform,ring,greedy --renders 250 --truth-renders 1000 \
    --watch-spp 4096 --watch-renders 6
}

fireflies() {
  measure scenes/fireflies/fireflies.pbrt --bsdf-only --resolution 32x32 --crop 0,0,32,32 \
    --spp 64 --allocation uniform,ring,greedy --renders 800 --truth-renders 2400
}

shared_scene() {
  # shellcheck disable=SC2206  # Words on purpose.
  local scene=("$shared/$1/scene.pbrt" ${crops[$1]})
  measure "${scene[@]}" --spp 256 --allocation ring,ring-mse,greedy-mse,neyman,oracle \
    --renders "$renders" --truth-renders "$renders" --trials "$trials" \
    --watch-spp 4096 --watch-renders 6
  for spp in 64 128; do
    measure "${scene[@]}" --spp "$spp" --allocation ring --renders "$trials" \
      --truth-renders "$trials"
  done
  measure "${scene[@]}" --spp 1024 --truth-renders 8
}

(($#)) || set -- normal fireflies cornell-box veach-mis coffee staircase2
missed=
for scene in "$@"; do
  case $scene in
    normal | fireflies) "$scene" ;;
    *) shared_scene "$scene" ;;
  esac
done
[[ -z $missed ]]
