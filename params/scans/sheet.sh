#!/bin/sh
# From a scan to a leaf: the scan, its captured profile, the veins found in it, and the shaped leaf, side by side.
# Usage: sheet.sh VENATION PARAMS.ini OUT.jpg [HEIGHT]; PARAMS has a [scan] file. Needs rsvg-convert, POV-Ray and ImageMagick. `./run scan` calls it.
set -eu
venation=$1 params=$2 out=$3 height=${4:-560}
here=$(cd "$(dirname "$params")" && pwd)
scan=$here/$(sed -n '/^\[scan\]/,/^\[/s/^file *= *//p' "$params")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$venation" capture "$scan" --params "$params" --name leaf -o "$work" -q --maps none
"$venation" shape "$params" --name bent -o "$work" -q --formats pov --size 2048

# Layers of the drawing, each picture with what it shows.
layers() {
    printf '%s\n' "$2" >"$work/style.css"
    rsvg-convert --stylesheet "$work/style.css" --height "$height" "$work/leaf_drawing.svg" --background-color white -o "$work/$1.png"
}
layers 1 '#outline-layer, #holes, #marks, #veins { display: none }'
layers 2 '#scan, #veins { display: none } #outline, #holes path { stroke: #222222 !important; stroke-width: 3px !important }'
layers 3 '#scan { display: none } #outline, #holes path { stroke: #888888 !important; stroke-width: 2px !important }'
(
    cd "$work"
    povray -D +A0.1 +Q9 "+W$((height * 11 / 10))" "+H$height" +Ibent.pov +O4.png >povray.log 2>&1 || { tail -n 20 povray.log >&2; exit 1; }
)
mkdir -p "$(dirname "$out")"
convert "$work/1.png" "$work/2.png" "$work/3.png" "$work/4.png" -background white -alpha remove +append -strip -quality 88 "$out"
echo "$out" >&2
