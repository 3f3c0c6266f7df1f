#!/bin/bash
# From a fresh Debian 12 to a picture: installs packages, builds Strata, starts a coordinator and two
# workers on this machine, renders the Cornell box on them, and stops them again.
#
#   deploy/quickstart.sh
#
# Leaves out/cornell-box.exr (with its error layers) and out/cornell-box.png. Run it as often as you
# like, also twice at once: each run has its own port and its own state.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

say() { printf '\n== %s\n' "$*"; }

scene=scenes/cornell-box/cornell-box.pbrt
bin=build/release/bin
pids=()
run=$(mktemp -d -t strata-quickstart.XXXXXXXX)

finish() {
  local status=$?
  trap - EXIT
  trap '' INT TERM  # One signal often comes twice: the cleaning up is not for interrupting.
  # Workers first, so that they can say goodbye.
  for ((i = ${#pids[@]} - 1; i >= 0; i--)); do
    kill "${pids[i]}" 2>/dev/null || true
    wait "${pids[i]}" 2>/dev/null || true
  done
  if ((status != 0 && status != 130)); then
    echo "quickstart.sh: failed; the last lines of the logs:" >&2
    tail -n 15 "$run"/*.log >&2 2>/dev/null || true
  fi
  rm -rf "$run"
  exit "$status"
}
trap finish EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

# Starts a program of ours that logs to a file of its own.
start() {
  local log=$1
  shift
  "$@" >"$run/$log.log" 2>&1 &
  pids+=($!)
}

# Tries a command for half a minute, as long as all we started are alive.
wait_for() {
  local what=$1
  shift
  for ((attempt = 0; attempt < 300; ++attempt)); do
    if "$@" >/dev/null 2>&1; then return; fi
    for pid in "${pids[@]}"; do
      if ! kill -0 "$pid" 2>/dev/null; then
        echo "quickstart.sh: a program ended while waiting for $what" >&2
        return 1
      fi
    done
    sleep 0.1
  done
  echo "quickstart.sh: waited 30 s for $what" >&2
  return 1
}
two_workers_joined() { [[ $("$bin/strata" workers --json | grep -o '"threads"' | wc -l) == 2 ]]; }

say "Packages (Debian 12)"
deploy/install-packages.sh build

say "Build"
options=()
[[ -f build/release/CMakeCache.txt ]] || options=(-DSTRATA_TESTS=OFF -DSTRATA_BENCH=OFF)
deploy/build.sh release "${options[@]}" strata strata-coordinator strata-worker

say "A coordinator and two workers on this machine"
start coordinator "$bin/strata-coordinator" --listen 127.0.0.1:0 --port-file "$run/port" \
  --state "$run/state"
wait_for "the coordinator's port" test -s "$run/port"
export STRATA_SERVER=127.0.0.1:$(<"$run/port")
threads=$((($(nproc) + 1) / 2))
for worker in 1 2; do
  start "worker-$worker" "$bin/strata-worker" --server "$STRATA_SERVER" \
    --cache "$run/cache-$worker" --threads "$threads" --name "quickstart-$worker"
done
wait_for "the coordinator to answer" "$bin/strata" health
wait_for "two workers" two_workers_joined
"$bin/strata" workers

say "The Cornell box"
"$bin/strata" submit "$scene" --name quickstart --watch
job=$("$bin/strata" jobs --json | grep -o '"job":"[^"]*"' | head -n 1 | cut -d '"' -f 4)

mkdir -p out
for kind in exr png; do
  "$bin/strata" fetch "$job" -o "$run/cornell-box.$kind" >/dev/null
  mv "$run/cornell-box.$kind" "out/cornell-box.$kind"
done

say "Done"
echo "Picture:             $PWD/out/cornell-box.png"
echo "With error layers:   $PWD/out/cornell-box.exr"
oiiotool out/cornell-box.exr --ch R,G,B,ci95.R,ci95.G,ci95.B --printstats | awk '/Stats Avg:/ {
  error = (0.2126 * $6 + 0.7152 * $7 + 0.0722 * $8) / (0.2126 * $3 + 0.7152 * $4 + 0.0722 * $5)
  printf "Error of a pixel:    +- %.1f %% of the picture'"'"'s brightness on average, with 95 %% confidence\n", 100 * error
}'
