#!/bin/bash
# Draws the pictures of the README: the Cornell box, and how wrong each of its pixels is.
#
#   docs/images/make.sh
#
# The error of a pixel is the half-width of its luminance's 95 % interval, over its luminance, or over
# 5 % of the mean luminance where it is darker. Black is 0, yellow 50 % and more.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

deploy/install-packages.sh build
deploy/build.sh release strata >/dev/null
work=$(mktemp -d -t strata-images.XXXXXXXX)
trap 'rm -rf "$work"' EXIT

image=$work/cornell-box.exr
build/release/bin/strata render scenes/cornell-box/cornell-box.pbrt --resolution 320x320 --spp 128 \
  -o "$image" --png

# luminance CHANNELS...: oiiotool's arguments for it; channels of a pixel err together, so half-widths
# add up like the channels do.
luminance() { echo "--ch $1,$2,$3 --chsum:weight=0.2126,0.7152,0.0722"; }
mean=$(oiiotool "$image" $(luminance R G B) --printstats | awk '/Stats Avg:/ { print $3 }')
dark=$(awk -v mean="$mean" 'BEGIN { print 0.05 * mean }')
oiiotool "$image" $(luminance R G B) --maxc "$dark" -o "$work/level.exr"
oiiotool --nosoftwareattrib "$image" $(luminance ci95.R ci95.G ci95.B) "$work/level.exr" --div \
  --mulc 2 --clamp:min=0:max=1 --colormap inferno -d uint8 -o docs/images/cornell-box-error.png
mv "$work/cornell-box.png" docs/images/cornell-box.png
ls -l docs/images/*.png
