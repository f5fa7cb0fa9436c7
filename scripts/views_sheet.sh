#!/bin/sh
# views_sheet.sh OUT.jpg: a contact sheet of all views and overlays, from a build folder (bin/, assets/). ImageMagick's
# montage puts it together; bundles are baked once beside it.
set -eu
out=$1
work=${TMPDIR:-/tmp}/lambent-views
mkdir -p "$work"
for scene in gallery playroom flight; do
  [ -f "$work/$scene.lmb.glb" ] || bin/lambent bake "assets/$scene.glb" -o "$work/$scene.lmb.glb" --rays 256 --bounces 2
done
draw() {  # NAME SCENE ARGUMENTS...
  name=$1 scene=$2
  shift 2
  bin/lambent-demo "$work/$scene.lmb.glb" --size 480x270 --camera "${camera:-main}" "$@" --headless "$work/$name.png" > /dev/null
}
evening="--light constant:0.5,0.55,0.7 --light sun:40,30,6,75,42,18"
day="--light constant:0.5,0.55,0.65 --light sun:30,50,8,30,27,22"
sky="--light sun:70,48,12,60,54,44 --light constant:0.3,0.42,0.6"
draw 01-final gallery $evening
draw 02-irradiance gallery $evening --view irradiance
draw 03-transfer-dc gallery --light constant:1,1,1 --view transfer-dc
draw 05-error flight --light constant:1,1,1 --view error
draw 06-clusters gallery --light constant:1,1,1 --view clusters
draw 07-normals gallery --light constant:1,1,1 --view normals
draw 08-wireframe flight $sky --view wireframe
camera=orbit:25,14,0.8,25
draw 09-light-samples playroom $day --overlay light-probes
camera=main
draw 10-neighborhoods playroom $day --overlay neighborhoods
draw 11-groups-lights playroom $day --overlay groups,lights
draw 12-volumes flight $sky --overlay volumes,neighborhoods
montage "$work"/[01][0-9]-*.png -tile 3x4 -geometry +3+3 -background '#1b1b1b' "$work/sheet.png"
convert "$work/sheet.png" -quality 86 "$out"
