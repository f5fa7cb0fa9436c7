#!/usr/bin/env bash
# Errors of pictures of a volume against the path-traced reference, over the size of its transfer grid:
#   bench/volume_errors.sh [-o DIR] [-b BUILD] [-s SPP] [-z SIZE] [-d DENSITY_SCALE] [-k SCALE] [-g "GRIDS"] VOLUME.nrrd|.vdb LIGHT CAMERA...
# The reference's light is cut to the five bands of the transfer; each figure is free of the reference's noise by two seeds
# (lambent compare --reference2). SCALE: of the node that holds the volume; DENSITY_SCALE: extinction per metre where the
# file says 1. Also what the bundle weighs and how long its bake took.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

build=$here/build/release out=$here/out/volume_errors spp=1024 size=128x96 density=20 scale=0.01 grids="8 16 32 64"
while getopts "o:b:s:z:d:k:g:" option; do
  case $option in
    o) out=$OPTARG ;;
    b) build=$OPTARG ;;
    s) spp=$OPTARG ;;
    z) size=$OPTARG ;;
    d) density=$OPTARG ;;
    k) scale=$OPTARG ;;
    g) grids=$OPTARG ;;
    *) sed -n 2,8p "$0" >&2; exit 2 ;;
  esac
done
shift $((OPTIND - 1))
(($# >= 3)) || { sed -n 2,8p "$0" >&2; exit 2; }
volume=$1 light=$2
shift 2

mkdir -p "$out"
file=$(basename "$volume") name=$(basename "${volume%.*}")
cp -f "$volume" "$out/$file"
cat > "$out/$name.gltf" <<END
{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
 "nodes": [{"name": "$name", "scale": [$scale, $scale, $scale],
            "extras": {"lambent": {"volume": {"file": "$file", "density_scale": $density}}}}]}
END

source "$here/bench/percent.sh"
for camera in "$@"; do
  for seed in 1 2; do
    reference=$out/$name.${camera//[^0-9a-z-]/_}.$seed.exr
    [[ -e $reference ]] ||
      "$build"/bin/lambent reference "$out/$name.gltf" --light "$light" --camera "$camera" --size "$size" --band-limit 5 \
        --spp "$spp" --seed $seed -o "$reference" >/dev/null
  done
done

echo "| volume | grid | bake s | bytes | camera | relative RMS % |"
echo "|---|---|---|---|---|---|"
for grid in $grids; do
  bundle=$out/$name.$grid.lmb.glb
  seconds=$("$build"/bin/lambent bake "$out/$name.gltf" -o "$bundle" --volume-grid "$grid" --force --json |
    sed -n 's/.*"seconds": \([0-9.e+-]*\).*/\1/p' | awk '{ sum += $1 } END { printf "%.0f", sum }')
  for camera in "$@"; do
    stem=$out/$name.${camera//[^0-9a-z-]/_}
    "$build"/bin/lambent-demo "$bundle" --light "$light" --camera "$camera" --size "$size" --window off \
      --headless "$stem.demo.exr" >/dev/null
    echo "| $name | $grid³ | $seconds | $(stat -c %s "$bundle") | $camera | $(percent "$stem.demo.exr" "$stem.1.exr" "$stem.2.exr") |"
  done
done
