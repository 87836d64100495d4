#!/bin/sh
# One leaf of the training data with its labels, side by side: image, blade, veins, orders (primary yellow, finer ones bluer), areoles (each its colour).
# Usage: training.sh VENATION SWEEP.ini OUT.jpg [NUMBER [HEIGHT]]. Needs ImageMagick. `./run training` calls it.
set -eu
venation=$1 sweep=$2 out=$3 number=${4:-35} height=${5:-330}
count=$(sed -n 's/^count *= *//p' "$sweep")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$venation" sweep "$sweep" --dataset --size 512 --cell 0 --shard $((number + 1))/"$count" -q -o "$work"
set -- "$work"/leaves/*/
leaf=$1$(basename "$1")

# Labels are whole numbers: orders of 8 bits, areoles of 16, which multiples scatter over the colours.
convert "${leaf}_vein_order.png" -colorspace sRGB -type TrueColor -channel R -fx 'u > 0 ? max(1 - 0.25 * (u * 255 - 1), 0.25) : 0' \
    -channel G -fx 'u > 0 ? max(0.85 - 0.13 * (u * 255 - 1), 0.4) : 0' -channel B -fx 'u > 0 ? min(0.3 + 0.22 * (u * 255 - 1), 1) : 0' "$work/order.png"
convert "${leaf}_areole.png" -colorspace sRGB -type TrueColor -channel R -fx 'u > 0 ? 0.3 + 0.7 * mod(u * 65535 * 0.618, 1) : 0' \
    -channel G -fx 'u > 0 ? 0.35 + 0.6 * mod(u * 65535 * 0.414, 1) : 0' -channel B -fx 'u > 0 ? 0.3 + 0.7 * mod(u * 65535 * 0.732, 1) : 0' "$work/areole.png"
mkdir -p "$(dirname "$out")"
convert "${leaf}_specimen.png" "${leaf}_opacity.png" "${leaf}_vein_mask.png" "$work/order.png" "$work/areole.png" -colorspace sRGB -type TrueColor \
    -resize "x$height" -bordercolor white -border 2 +append -strip -quality 85 "$out"
echo "$out" >&2
