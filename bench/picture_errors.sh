#!/usr/bin/env bash
# Errors of pictures against the band-limited path-traced reference, split into where they come from:
#   bench/picture_errors.sh [-o DIR] [-b BUILD] [-s SPP] SCENE.glb PROBE.hdr... -- CAMERA...
# Per probe and camera: "picture" is the demo at standard quality, "interpolation" the same with rays and codes
# so fine that what remains lies between the samples. Both against the mean of two references with different
# seeds, free of their noise (lambent compare --reference2). Errors at the samples: ray_error; of the codes:
# lambent bake, "coding". Three bounces everywhere; light of order 5 without a window.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build=build/release out=out/picture_errors spp=256
while getopts "o:b:s:" option; do
  case $option in
    o) out=$OPTARG ;;
    b) build=$OPTARG ;;
    s) spp=$OPTARG ;;
    *) sed -n 2,8p "$0" >&2; exit 2 ;;
  esac
done
shift $((OPTIND - 1))
(($# >= 3)) || { sed -n 2,8p "$0" >&2; exit 2; }
scene=$1; shift
probes=()
while (($# > 0)) && [[ $1 != -- ]]; do probes+=("$1"); shift; done
[[ ${1-} == -- ]] && shift
cameras=("$@")
name=$(basename "${scene%.*}")
mkdir -p "$out"

bounces=(--bounces 3)
"$build"/bin/lambent bake "$scene" -o "$out/$name.lmb.glb" "${bounces[@]}" >/dev/null
"$build"/bin/lambent bake "$scene" -o "$out/$name.fine.lmb.glb" "${bounces[@]}" --rays 8192 --codes 0.0003 >/dev/null

percent() { # JSON file -> relative RMS in percent
  sed -n 's/^  "relativeRms": \([0-9.e+-]*\).*/\1/p' "$1" | awk '{ printf "%.2f", 100 * $1 }'
}
echo "| scene | probe | camera | picture % | interpolation % |"
echo "|---|---|---|---|---|"
for probe in "${probes[@]}"; do
  for camera in "${cameras[@]}"; do
    stem="$out/$name.$(basename "${probe%.*}").${camera//[^0-9a-z-]/_}"
    words=(--light "$probe" --camera "$camera" --size 512x512)
    for seed in 1 2; do
      [[ -e $stem.ref$seed.exr ]] ||
        "$build"/bin/lambent reference "$scene" "${words[@]}" --band-limit 5 "${bounces[@]}" --spp "$spp" --seed $seed \
          -o "$stem.ref$seed.exr" >/dev/null
    done
    for which in "" .fine; do
      "$build"/bin/lambent-demo "$out/$name$which.lmb.glb" "${words[@]}" --window off --headless "$stem$which.exr" >/dev/null
      "$build"/bin/lambent compare "$stem$which.exr" "$stem.ref1.exr" --reference2 "$stem.ref2.exr" --json > "$stem$which.json"
    done
    echo "| $name | $(basename "${probe%.*}") | $camera | $(percent "$stem.json") | $(percent "$stem.fine.json") |"
  done
done
