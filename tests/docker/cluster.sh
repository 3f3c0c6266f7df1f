#!/bin/bash
# The farm in containers: builds the image, brings up the compose file with three workers, renders
# through it, kills a worker while it renders, and compares the digest with a render in one process.
#
#   tests/docker/cluster.sh
#
# Starts a Docker engine where none runs (as root) and makes the base image from Debian's packages
# where no registry is in reach. Takes down all that it brought up.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
source tests/docker/engine.sh

scene=scenes/cornell-box/cornell-box.pbrt
bin=build/release/bin
run=$(mktemp -d -t strata-cluster.XXXXXXXX)
brought_up=

fail() {
  echo "cluster.sh: $*" >&2
  exit 1
}

compose() {
  docker-compose --project-name "$project" --file deploy/docker-compose.yml "$@" </dev/null
}

finish() {
  local status=$?
  trap - EXIT
  trap '' INT TERM  # One signal often comes twice: the cleaning up is not for interrupting.
  if [[ -n $brought_up ]]; then
    if ((status != 0)); then compose logs --tail 30 >&2 || true; fi
    # Nothing in here is worth a worker's time to finish.
    compose down --volumes --timeout 5 >/dev/null 2>&1 || true
  fi
  stop_engine
  rm -rf "$run"
  exit "$status"
}
trap finish EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

# until_true SECONDS WHAT COMMAND...
until_true() {
  local seconds=$1 what=$2 start=$SECONDS
  shift 2
  until "$@"; do
    ((SECONDS - start < seconds)) || fail "waited $seconds s for $what"
    sleep 0.2
  done
}

# The value of a key in one line of JSON, without quotes.
value_of() { grep --only-matching "\"$1\":[^,}]*" | tail -n 1 | cut -d : -f 2- | tr -d '"'; }

workers() { compose ps --quiet worker; }
all_healthy() {
  local id
  for id in $(compose ps --quiet); do
    [[ $(docker inspect --format '{{.State.Health.Status}}' "$id") == healthy ]] || return 1
  done
}
# Work is merged, and more than half is left to do: a good moment for a worker to die.
under_way() {
  kill -0 "$submit" 2>/dev/null || fail "the job ended before a worker could be killed: $(<"$run/submit.err")"
  local fraction
  fraction=$(tail -n 1 "$run/submit.json" | value_of fraction)
  awk -v f="${fraction:-0}" 'BEGIN { exit !(f > 0 && f < 0.5) }'
}

echo "== Programs and image"
deploy/build.sh release strata >/dev/null
start_engine
need_base_image
project=strata-test-$$
export STRATA_IMAGE=strata-test STRATA_PORT=0 DOCKER_BUILDKIT=0 COMPOSE_DOCKER_CLI_BUILD=0
start=$SECONDS
compose build >"$run/build.log" 2>&1 || { tail -n 40 "$run/build.log" >&2; fail "the image does not build"; }
echo "Image: $(docker image inspect --format '{{.Size}}' strata-test | awk '{ printf "%.0f MB", $1 / 1e6 }')," \
  "built in $((SECONDS - start)) s"

echo "== Up, with three workers"
brought_up=yes
compose up --detach --no-build --scale worker=3 >"$run/up.log" 2>&1 ||
  { cat "$run/up.log" >&2; fail "docker-compose up failed"; }
until_true 120 "coordinator and workers to be healthy" all_healthy
server=$(compose port coordinator 7447)
[[ $server == 127.0.0.1:* ]] || fail "the coordinator is published on $server and not on loopback"
mapfile -t ids < <(workers)  # All of them: whoever still writes into a closed pipe ends with an error.
first=${ids[0]}
[[ $(docker exec "$first" id -u) != 0 ]] || fail "the worker runs as root"
"$bin/strata" workers --server "$server"

echo "== A job, and a worker that dies"
job=(--resolution 256x256 --spp 512)
"$bin/strata" submit "$scene" --server "$server" "${job[@]}" --seed 7 --watch --json -o "$run/farm.exr" \
  >"$run/submit.json" 2>"$run/submit.err" &
submit=$!
until_true 120 "the first results" under_way
docker kill "$first" >/dev/null
echo "Killed a worker at fraction $(tail -n 1 "$run/submit.json" | value_of fraction)."
wait "$submit" || fail "submit ended with status $?: $(<"$run/submit.err")"
[[ $(docker inspect --format '{{.State.Running}}' "$first") == false ]] ||
  fail "the killed worker runs again"
[[ -s $run/farm.exr ]] || fail "submit wrote no image"
farm=$(tail -n 1 "$run/submit.json" | value_of digest)

echo "== The same job in one process"
digest_of_render() {
  "$bin/strata" render "$scene" --json -o "$run/local.exr" "$@" | tail -n 1 | value_of digest
}
local=$(digest_of_render "${job[@]}" --seed 7)
other=$(digest_of_render --resolution 256x256 --spp 8 --seed 8)

echo "farm:  $farm"
echo "local: $local"
[[ $farm == sha256:* && $farm == "$local" ]] || fail "the digests differ"
[[ $farm != "$other" ]] || fail "another job has the same digest: the comparison says nothing"
echo "Same bits."
