#!/bin/bash
# Installs the Debian 12 packages Strata needs. This is the one list of them: people, tests, CI and
# the container image all take it from here.
#
#   deploy/install-packages.sh [SET...]      SET: build (default), runtime, test, ci
#
# Does nothing when all is installed already. Works as root or with sudo, asks nothing.
set -euo pipefail

# To compile the three programs. What they need to run comes along.
build=(
  g++ cmake ninja-build
  libembree-dev libtbb-dev libopenimageio-dev
  openimageio-tools  # libopenimageio-dev's CMake files name its programs and fail without them
  libgrpc++-dev libprotobuf-dev protobuf-compiler protobuf-compiler-grpc
  libabsl-dev libspdlog-dev libcli11-dev nlohmann-json3-dev libssl-dev zlib1g-dev
  libtinygltf-dev  # compiled into the renderer, headers only
  libboost-dev  # Boost.Math, headers only: p-values of strata diff, and of the tests
)
# To run programs that were compiled elsewhere, on the same release of Debian.
runtime=(
  libembree3-3 libtbb12 libopenimageio2.4
  libgrpc++1.51 libprotobuf32
  libabsl20220623 libspdlog1.10 libssl3 zlib1g
)
# To test, and to compile often.
test=(libgtest-dev libgmock-dev libbenchmark-dev ccache gnuplot-nox)  # the last draws plots of strata lab
# For what CI checks on top: formatting, locking, sanitizers (llvm names their stack frames), containers.
ci=(clang clang-format libclang-rt-dev llvm docker.io docker-compose debootstrap)

packages=()
for set in "${@:-build}"; do
  case $set in
    build | runtime | test | ci)
      declare -n list=$set
      packages+=("${list[@]}")
      ;;
    *)
      echo "install-packages.sh: no package set '$set'; there are: build runtime test ci" >&2
      exit 2
      ;;
  esac
done

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $status == installed ]] || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
  exit 0
fi
echo "Installing ${#missing[@]} Debian packages: ${missing[*]}"

as_root=()
if ((EUID != 0)); then
  if ! command -v sudo >/dev/null; then
    echo "install-packages.sh: run as root, or install sudo, or install by hand: ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi

# One at a time: apt waits for the lock of dpkg, but not for the one of its package lists.
exec 9</var/lib/apt
flock 9

apt_get() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get --quiet --quiet -o DPkg::Lock::Timeout=600 -o Dpkg::Use-Pty=0 "$@" </dev/null
}
install_missing() { apt_get install --yes --no-install-recommends "${missing[@]}"; }

# Package lists that are missing or out of date show themselves by a failing install.
if ! install_missing 2>/dev/null; then
  apt_get update
  install_missing
fi
