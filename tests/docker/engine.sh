# A Docker engine and the base image for tests: to be sourced by a bash script that runs `set -e`.
#
#   start_engine       uses the engine that runs, or starts one of its own under build/docker
#   need_base_image    pulls debian:bookworm-slim, or makes it from Debian's packages
#   stop_engine        stops what start_engine started; call it on every way out

engine_pid=
engine_folder=

start_engine() {
  if docker info >/dev/null 2>&1; then
    echo "Docker engine: the one of this machine."
    return
  fi
  if ((EUID != 0)); then
    echo "No Docker engine answers. Start one, or run this test as root so that it can." >&2
    return 1
  fi
  # One at a time: two engines would fight over the bridge.
  exec 8<"$(command -v dockerd)"
  flock 8
  # Sockets have short paths; images are kept, so that the next run is quick.
  engine_folder=$(mktemp -d -t strata-docker.XXXXXXXX)
  mkdir -p build/docker
  local driver attempt
  for driver in overlay2 vfs; do
    # In a session of its own: a signal to this script must not end it before the containers are down.
    setsid dockerd --host "unix://$engine_folder/docker.sock" --data-root "$PWD/build/docker/$driver" \
      --exec-root "$engine_folder/exec" --pidfile "$engine_folder/pid" \
      --storage-driver "$driver" >"$engine_folder/log" 2>&1 8<&- &
    engine_pid=$!
    export DOCKER_HOST=unix://$engine_folder/docker.sock
    # It ends at once when the file system does not suit the driver.
    for ((attempt = 0; attempt < 300; ++attempt)); do
      if docker info >/dev/null 2>&1; then
        echo "Docker engine: started one ($driver), its images are in build/docker."
        return
      fi
      kill -0 "$engine_pid" 2>/dev/null || break
      sleep 0.2
    done
    kill "$engine_pid" 2>/dev/null || true
    wait "$engine_pid" 2>/dev/null || true
  done
  echo "dockerd does not start; the end of its log:" >&2
  tail -n 20 "$engine_folder/log" >&2
  engine_pid=
  return 1
}

stop_engine() {
  if [[ -n $engine_pid ]]; then
    kill "$engine_pid" 2>/dev/null || true
    wait "$engine_pid" 2>/dev/null || true
    engine_pid=
  fi
  if [[ -n $engine_folder ]]; then rm -rf "$engine_folder"; fi
}

need_base_image() {
  local image=debian:bookworm-slim mirror root
  if docker image inspect "$image" >/dev/null 2>&1; then return; fi
  echo "Base image: pulling $image"
  if timeout 60 docker pull --quiet "$image" >/dev/null 2>&1; then return; fi

  # The sources and the transport options of this machine's apt reach Debian, so containers get them.
  echo "Base image: no registry in reach, making $image with debootstrap"
  mirror=$(debian_sources | awk '$3 == "bookworm" { print $2; exit }')
  root=$(mktemp -d -t strata-base.XXXXXXXX)
  if ! debootstrap --variant=minbase bookworm "$root" ${mirror:+"$mirror"} \
    >"$root.log" 2>&1; then
    tail -n 20 "$root.log" >&2
    rm -rf "$root" "$root.log"
    return 1
  fi
  if [[ -n $mirror ]]; then debian_sources >"$root/etc/apt/sources.list"; fi
  apt-config dump Acquire >"$root/etc/apt/apt.conf.d/90host"
  rm -rf "$root"/var/cache/apt/archives/*.deb "$root"/var/lib/apt/lists/*
  tar --directory "$root" --create . | docker import - "$image" >/dev/null
  rm -rf "$root" "$root.log"
}

# This machine's sources of Debian bookworm, as lines of a sources.list.
debian_sources() {
  apt-get indextargets --format '$(REPO_URI) $(RELEASE) $(COMPONENT)' \
    'Created-By: Packages' 'Origin: Debian' 2>/dev/null |
    awk '$2 ~ /^bookworm/ { print "deb", $1, $2, $3 }' | sort --unique
}
