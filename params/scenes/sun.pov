// The shadow side with the sun going over it: shadow lines of the veins (Hong 2005, fig. 8.7). frames 8: 0°, 20°, 60° … 180°.
// grow  leaflet leaflet.ini
// shape under leaflet --pose cupped --set pose.strength=0.4 --set mesh.vein_offset=0.9 --set mesh.vein_scale=2.2
// size  420 560
// frames 8
#include "common.inc"
#declare Height = array[8] { 4, 20, 60, 80, 100, 120, 160, 176 };
camera { orthographic location <0, 60, -9> look_at <0, 0, -9> up 23 * y right 17.25 * x }
light_source {
    vrotate(<120, 0, 0>, Height[frame_number] * z), 1.1 * <1, 0.97, 0.9>
    area_light 2 * x, 2 * z, 5, 5 adaptive 1 jitter circular orient
}
plane { y, -3 pigment { rgb 0.5 } finish { ambient 0.1 diffuse 0.6 } }
object { Shaped_leaf("under") rotate 180 * z translate -18 * z }
