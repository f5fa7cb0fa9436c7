#!/bin/sh
# editor-tour.sh OUT_DIR [WIDTHxHEIGHT [SCALE]]: the pictures of the tour in docs/editor.md, from a build folder (bin/,
# assets/). The editor runs a script in its real window; without a display, give it one with xvfb-run. ImageMagick's
# convert makes the JPEGs. A command that fails ends the script.
set -eu
out=$1 size=${2:-1280x800} scale=${3:-1}
work=$(mktemp -d "${TMPDIR:-/tmp}/lambent-tour.XXXXXX")
trap 'rm -rf "$work"' EXIT
mkdir -p "$out"
cp assets/hello.glb "$work/room.glb"
head -c 2000 assets/hello.glb > "$work/broken.glb"

edit() {  # SCRIPT QUALITY
  exec bin/lambent-editor --fresh --size "$size" --scale "$scale" --cache "$work/cache" --quality "$2" --json --script "$1" > "$work/answers"
}

cat > "$work/first" << END
wait frames 3
screenshot $work/01-start.png
drop $work/room.glb
wait loaded 60
screenshot $work/02-dropped.png
wait baked 300
wait rest 60
screenshot $work/03-baked.png
select "has:Transform box type:node"
wait frames 3
drag gizmo.x -60 0
wait rest 60
panel Bakes
wait frames 3
screenshot $work/04-moved.png
bake
wait baked 300
wait rest 60
screenshot $work/05-rebaked.png
create-sphere
wait rest 60
screenshot $work/06-lamp.png
drag gizmo.y 0 -60
set Light.color 1 0.6 0.3
wait rest 60
screenshot $work/07-lamp-moved.png
select "has:Transform sphere type:node"
wait frames 3
click inspector.material.sphere
wait frames 3
click inspector.material.sphere.select
wait frames 3
set Material.base_color 0.8 0.2 0.15
wait rest 60
screenshot $work/08-material.png
save $work/room.json
END
cat > "$work/second" << END
open $work/room.json
wait loaded 60
wait rest 60
wait frames 3
screenshot $work/09-opened-again.png
try open $work/broken.glb
panel Log
wait seconds 1
screenshot $work/10-error.png
END
# At standard quality the bake still goes on when its first picture is there.
(edit "$work/first" standard)
(edit "$work/second" standard)
for picture in "$work"/[01][0-9]-*.png; do
  convert "$picture" -resize '960x>' -quality 82 "$out/tour-$(basename "$picture" .png).jpg"
done
