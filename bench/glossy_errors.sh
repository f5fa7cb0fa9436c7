#!/usr/bin/env bash
# Errors of glossy pictures against the path-traced reference:
#   bench/glossy_errors.sh [-o DIR] [-b BUILD] [-s SPP] [-z SIZE] [-k SHRINK] [-n BOUNCES] [-a "BAKE OPTIONS"] SCENE.glb PROBE.hdr... -- CAMERA...
# Per probe and camera: against light and first-hit kernel both cut to five bands, which is what a perfect renderer of
# order 5 would show; then against the whole light and BRDF, without and with what order 5 cannot carry (--residual).
# Each free of the reference's noise by two seeds (lambent compare --reference2), and of means of SHRINK x SHRINK pixels
# (2), as a screen shows a picture of so many samples a pixel; five bands also pixel by pixel, and that without the pixels
# in which picture and reference show different surfaces. BOUNCES 3 if not said, no window.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

build=$here/build/release out=$here/out/glossy_errors spp=16 size=768x768 shrink=2 bounces=3 options=()
while getopts "o:b:s:z:k:n:a:" option; do
  case $option in
    o) out=$OPTARG ;;
    b) build=$OPTARG ;;
    s) spp=$OPTARG ;;
    z) size=$OPTARG ;;
    k) shrink=$OPTARG ;;
    n) bounces=$OPTARG ;;
    a) read -ra options <<< "$OPTARG" ;;
    *) sed -n 2,9p "$0" >&2; exit 2 ;;
  esac
done
shift $((OPTIND - 1))
(($# >= 3)) || { sed -n 2,9p "$0" >&2; exit 2; }
scene=$1; shift
probes=()
while (($# > 0)) && [[ $1 != -- ]]; do probes+=("$1"); shift; done
[[ ${1-} == -- ]] && shift
cameras=("$@")
name=$(basename "${scene%.*}")
mkdir -p "$out"

"$build"/bin/lambent bake "$scene" -o "$out/$name.lmb.glb" --bounces "$bounces" "${options[@]}" >/dev/null

source "$here/bench/percent.sh"
echo "| scene | probe | camera | five bands % | pixel by pixel % | same surfaces % | whole, without residual % | with % |"
echo "|---|---|---|---|---|---|---|---|"
for probe in "${probes[@]}"; do
  for camera in "${cameras[@]}"; do
    stem="$out/$name.b$bounces.$(basename "${probe%.*}").${camera//[^0-9a-z-]/_}"
    words=(--light "$probe" --camera "$camera" --size "$size")
    for seed in 1 2; do
      [[ -e $stem.five$seed.exr ]] ||
        "$build"/bin/lambent reference "$scene" "${words[@]}" --band-limit 5,5 --bounces "$bounces" --spp "$spp" --seed $seed \
          -o "$stem.five$seed.exr" >/dev/null
      [[ -e $stem.whole$seed.exr ]] ||
        "$build"/bin/lambent reference "$scene" "${words[@]}" --bounces "$bounces" --spp "$spp" --seed $seed \
          -o "$stem.whole$seed.exr" >/dev/null
    done
    for residual in off on; do
      "$build"/bin/lambent-demo "$out/$name.lmb.glb" "${words[@]}" --window off --residual $residual \
        --headless "$stem.$residual.exr" >/dev/null
    done
    echo "| $name | $(basename "${probe%.*}") | $camera |" \
      "$(percent "$stem.off.exr" "$stem.five1.exr" "$stem.five2.exr" "$shrink") |" \
      "$(percent "$stem.off.exr" "$stem.five1.exr" "$stem.five2.exr") |" \
      "$(same_surface_percent "$stem.off.exr" "$stem.five1.exr" "$stem.five2.exr") |" \
      "$(percent "$stem.off.exr" "$stem.whole1.exr" "$stem.whole2.exr" "$shrink") |" \
      "$(percent "$stem.on.exr" "$stem.whole1.exr" "$stem.whole2.exr" "$shrink") |"
  done
done
