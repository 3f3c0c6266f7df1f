#!/bin/bash
# Draws the pictures of the README: the Cornell box, and how wrong each of its pixels is.
#
#   docs/images/make.sh
#
# The error of a pixel is the largest ci95 half-width of its channels over its luminance, or over 5 % of
# the mean luminance where it is darker. Black is 0, yellow 10 % and more.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

deploy/install-packages.sh build
deploy/build.sh release strata >/dev/null
work=$(mktemp -d -t strata-images.XXXXXXXX)
trap 'rm -rf "$work"' EXIT

image=$work/cornell-box.exr
build/release/bin/strata render scenes/cornell-box/cornell-box.pbrt --resolution 400x400 --spp 256 \
  -o "$image" --png

luminance=(--ch R,G,B --chsum:weight=0.2126,0.7152,0.0722)
mean=$(oiiotool "$image" "${luminance[@]}" --stats | awk '/Stats Avg:/ { print $3; exit }')
dark=$(awk -v mean="$mean" 'BEGIN { print 0.05 * mean }')
oiiotool "$image" "${luminance[@]}" --maxc "$dark" -o "$work/level.exr"
oiiotool "$image" --ch ci95.R "$image" --ch ci95.G --max "$image" --ch ci95.B --max \
  "$work/level.exr" --div --mulc 10 --clamp:min=0:max=1 --colormap inferno -d uint8 \
  -o docs/images/cornell-box-error.png
mv "$work/cornell-box.png" docs/images/cornell-box.png
ls -l docs/images/*.png
