#!/usr/bin/env bash
# What the farm costs: two one-thread workers over TCP against `strata render --threads 2`.
# Prints render_s of alternated pairs, each pair's ratio, and the median ratio.
#
#   bench/farm_overhead.sh [SCENE] [PAIRS] [job options...]
#
# Defaults: the shared cornell-box when it is there, else the project's own; 5 pairs; 512x512, 64 spp.
set -euo pipefail
cd "$(dirname "$0")/.."
bin=${STRATA_BIN:-build/release/bin}

scene=${1:-}
if [[ -z $scene ]]; then
  scene=../shared/scenes/pbrt/cornell-box/scene.pbrt
  [[ -e $scene ]] || scene=scenes/cornell-box/cornell-box.pbrt
fi
pairs=${2:-5}
options=("${@:3}")
((${#options[@]})) || options=(--resolution 512x512 --spp 64)

work=$(mktemp -d)
pids=()
finish() {
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
  wait 2>/dev/null || true
  rm -rf "$work"
}
trap finish EXIT

"$bin/strata-coordinator" --listen 127.0.0.1:0 --state "$work/state" --port-file "$work/port" \
  >"$work/coordinator.log" 2>&1 &
pids+=($!)
until [[ -s $work/port ]]; do sleep 0.05; done
server=127.0.0.1:$(cat "$work/port")
for worker in 1 2; do
  "$bin/strata-worker" --server "$server" --cache "$work/cache-$worker" --threads 1 \
    --name "overhead-$worker" >"$work/worker-$worker.log" 2>&1 &
  pids+=($!)
done
until [[ $("$bin/strata" workers --server "$server" --json | grep -o '"threads"' | wc -l) == 2 ]]; do
  sleep 0.1
done

# The value of "render_s" in the last line of a command's JSON.
render_seconds() { "$@" --json 2>/dev/null | tail -n 1 | sed -E 's/.*"render_s":([0-9.eE+-]+).*/\1/'; }
farm() {
  render_seconds "$bin/strata" submit "$scene" --server "$server" "${options[@]}" --watch
}
local_render() {
  render_seconds "$bin/strata" render "$scene" -o "$work/local.exr" --threads 2 "${options[@]}"
}

farm >/dev/null  # Workers load the scene.
local_render >/dev/null
printf '%-6s %10s %10s %8s\n' pair farm_s local_s ratio
for pair in $(seq "$pairs"); do
  # The order alternates, so that a machine that drifts favours neither.
  if ((pair % 2)); then a=$(farm); b=$(local_render); else b=$(local_render); a=$(farm); fi
  awk -v p="$pair" -v a="$a" -v b="$b" 'BEGIN { printf "%-6d %10.3f %10.3f %8.4f\n", p, a, b, a / b }'
done | tee "$work/pairs"
awk '{ print $4 }' "$work/pairs" | sort -n |
  awk '{ r[NR] = $1 } END { printf "median ratio %.4f (min %.4f, max %.4f)\n", r[int((NR + 1) / 2)], r[1], r[NR] }'
