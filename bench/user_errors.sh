#!/usr/bin/env bash
# What a user sees: pictures with default settings against the path-traced reference without a band limit.
#   bench/user_errors.sh [-o DIR] [-b BUILD] [-s SPP] [-t DEGREES] SCENE.glb LIGHT...
# A LIGHT is what --light takes; several that shine together are joined by "+". Prints a row for each: the key lights
# that were found, and in percent the relative RMS, free of the noise of two references of SPP paths, and the bias of the
# channel that is farthest off. -t turns the light.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build=build/release out=out/user_errors spp=64 turn=0
while getopts "o:b:s:t:" option; do
  case $option in
    o) out=$OPTARG ;;
    b) build=$OPTARG ;;
    s) spp=$OPTARG ;;
    t) turn=$OPTARG ;;
    *) sed -n 2,6p "$0" >&2; exit 2 ;;
  esac
done
shift $((OPTIND - 1))
(($# >= 2)) || { sed -n 2,6p "$0" >&2; exit 2; }
scene=$1 name=$(basename "${1%.*}"); shift
mkdir -p "$out"
bundle=$out/$name.lmb.glb
[[ -e $bundle ]] || "$build"/bin/lambent bake "$scene" -o "$bundle" >/dev/null

echo "| $name under | key lights | error | bias |"
echo "|---|---|---|---|"
for light in "$@"; do
  words=(--rotate-light "$turn" --size 480x270)
  IFS=+ read -ra parts <<<"$light"
  for part in "${parts[@]}"; do words+=(--light "$part"); done
  light=${light##*/} light=${light%.hdr}
  stem=$out/$name.${light//[^0-9A-Za-z_.-]/_}
  for seed in 1 2; do
    [[ -e $stem.ref$seed.exr ]] ||
      "$build"/bin/lambent reference "$scene" "${words[@]}" --spp "$spp" --seed $seed -o "$stem.ref$seed.exr" >/dev/null
  done
  "$build"/bin/lambent-demo "$bundle" "${words[@]}" --headless "$stem.exr" --json >"$stem.demo.json"
  "$build"/bin/lambent compare "$stem.exr" "$stem.ref1.exr" --reference2 "$stem.ref2.exr" --json >"$stem.json"
  python3 - "$light" "$stem" <<'PYTHON'
import json, sys
light, stem = sys.argv[1:]
errors, shown = json.load(open(f"{stem}.json")), json.load(open(f"{stem}.demo.json"))
bias = max(errors["bias"], key=abs)
print(f"| {light} | {len(shown['key_lights'])} | {100 * errors['relativeRms']:.1f} | {100 * bias:+.1f} |")
PYTHON
done
