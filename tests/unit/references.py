#!/usr/bin/env python3
"""Areas and perimeters of leaves in scans, by scikit-image: what test_references.c holds captures against.

    apt-get install python3-skimage
    python3 references.py grape.jpg:red grape_301.jpg:red grape_303.jpg:red zelkova.jpg:grey > references.csv

Otsu's threshold on the channel, the largest component, marching squares between the middles of pixels: on the component with its holes filled
(binary), and on grey levels, where what is filled counts as leaf and what lies farther than 3 pixels from it as white (levels).
"""

import os
import sys

import numpy as np
from scipy import ndimage
from skimage import filters, io, measure


def area_and_length(curve):
    step = np.diff(curve, axis=0)
    y, x = curve[:, 0], curve[:, 1]
    return abs(np.dot(x[:-1], y[1:]) - np.dot(x[1:], y[:-1])) / 2, np.hypot(step[:, 0], step[:, 1]).sum()


def longest(image, level):
    return max(map(area_and_length, measure.find_contours(image, level)))[1]


print("# file, channel, threshold, area with holes kept, area with holes filled, perimeter binary, perimeter levels; pixels. Made by references.py")
for arg in sys.argv[1:]:
    path, channel = arg.split(":")
    rgb = io.imread(path).astype(float)
    grey = rgb[..., 0] if channel == "red" else (299 * rgb[..., 0] + 587 * rgb[..., 1] + 114 * rgb[..., 2]) / 1000
    level = filters.threshold_otsu(grey)
    parts = measure.label(grey <= level, connectivity=2)
    sizes = np.bincount(parts.ravel())
    sizes[0] = 0
    leaf = parts == sizes.argmax()
    filled = ndimage.binary_fill_holes(leaf)
    levels = np.where(filled & ~leaf, 0.0, np.where(ndimage.binary_dilation(filled, iterations=3), grey, 255.0))
    print(f"{os.path.basename(path)},{channel},{level:.1f},{leaf.sum()},{filled.sum()},{longest(filled.astype(float), 0.5):.1f},"
          f"{longest(levels, level):.1f}")
