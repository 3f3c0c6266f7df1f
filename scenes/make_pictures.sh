#!/bin/bash
# Renders the pictures of the project's own scenes, beside their files.
#
#   scenes/make_pictures.sh [NAME...]       folders of scenes; none: all
#
# Same samples, same bits: a picture changes only when the renderer or its scene does.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

strata=build/release/bin/strata
[[ -x $strata ]] || { echo "make_pictures.sh: first build: deploy/build.sh release strata" >&2; exit 2; }
wanted=("$@")

# picture SCENE PICTURE [OPTION...]: renders scenes/SCENE to scenes/PICTURE (a .png).
picture() {
  local scene=$1 picture=$2 name=${1%%/*}
  shift 2
  ((${#wanted[@]})) && [[ " ${wanted[*]} " != *" $name "* ]] && return
  "$strata" render "scenes/$scene" --quiet -o "scenes/$picture" "$@"
}

picture cornell-box/cornell-box.pbrt cornell-box/cornell-box.png --resolution 256x256 --spp 256
picture textures/textures.pbrt textures/textures.png --resolution 320x180 --spp 256
picture textures/procedural.pbrt textures/procedural.png
for name in textured point spot projection goniometric daylight latlong portal; do
  picture lights/$name.pbrt lights/$name.png --spp 512
done
picture detail/detail.pbrt detail/detail.png
picture media/media.pbrt media/media.png
picture caustic/caustic.pbrt caustic/caustic.png
picture leaves/leaves.pbrt leaves/leaves.png
picture lobes/lobes.pbrt lobes/lobes.png
picture metals/anisotropic.pbrt metals/anisotropic.png --spp 512
picture lamps/lamps.pbrt lamps/lamps.png --spp 512
picture cameras/orthographic.pbrt cameras/orthographic.png
picture cameras/spherical.pbrt cameras/spherical.png
picture cameras/equalarea.pbrt cameras/equalarea.png
picture motion/motion.pbrt motion/motion.png
picture motion/pan.pbrt motion/pan.png
picture curves/curves.pbrt curves/curves.png
picture subdivision/subdivision.pbrt subdivision/subdivision.png
picture furnace/white-furnace.pbrt furnace/white-furnace.png
picture version3/version3.pbrt version3/version3.png

for sampler in sobol independent halton halton_plain stratified latin_hypercube poisson_disk drand48; do
  picture soft-shadow/soft-shadow.pbrt soft-shadow/sampler-$sampler.png --sampler $sampler --spp 128 \
    --allocation uniform --strategy light
done
for strategy in mis light bsdf cosine uniform; do
  picture soft-shadow/soft-shadow.pbrt soft-shadow/strategy-$strategy.png --strategy $strategy \
    --spp 16 --allocation uniform
done
for roulette in throughput efficiency off; do
  picture soft-shadow/soft-shadow.pbrt soft-shadow/roulette-$roulette.png --roulette $roulette --spp 64
done
picture garland/garland.pbrt garland/garland.png
for selection in tree intensity uniform; do
  picture garland/garland.pbrt garland/selection-$selection.png --light-selection $selection \
    --spp 16 --allocation uniform
done
for routines in preserving plain rejection; do
  picture garland/garland.pbrt garland/routines-$routines.png --routines $routines --spp 16 \
    --allocation uniform
done
picture gltf/materials.gltf gltf/materials.png --resolution 400x225 --spp 512
picture gltf/bare.gltf gltf/bare.png --resolution 384x216 --spp 256 --env scenes/lights/landscape.hdr \
  --camera 0,1.7,7.6,0,1.0,0,30
