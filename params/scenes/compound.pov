// A palmate leaf of seven leaflets (Hong 2005, fig. 8.6).
// grow  leaflet leaflet.ini
// shape part0 leaflet --pose drooping --set pose.seed=1 --set pose.strength=0.8
// shape part1 leaflet --pose drooping --set pose.seed=2
// shape part2 leaflet --pose folded --set pose.seed=3 --set pose.strength=0.5
// shape part3 leaflet --pose drooping --set pose.seed=4
// size  1200 1100
#include "common.inc"
camera { location <1.5, 66, -42> look_at <1.5, -1, -3> angle 31 right x * image_width / image_height }
Sun(52, -40, 1.05 * <1, 0.97, 0.9>)
Sky()
plane { y, -9 pigment { rgb 0.6 } finish { ambient 0 diffuse 0.8 } }
#declare Part = array[4];
#declare K = 0;
#while (K < 4)
    #declare Part[K] = Shaped_leaf(concat("part", str(K, 1, 0)))
    #declare K = K + 1;
#end
#declare Big = array[7] { 0.62, 0.85, 1, 1.06, 1, 0.85, 0.62 };
#declare K = 0;
#while (K < 7)
    object { Part[mod(K * 3, 4)] scale Big[K] rotate <-6, (K - 3) * 44, 0> translate <0, 0.02 * K, 0> }
    #declare K = K + 1;
#end
sphere_sweep {
    b_spline 5, <0, 1, 3>, 0.22, <0, 0, 0>, 0.24, <0.4, -0.6, -6>, 0.24, <1.5, -3, -15>, 0.3, <3, -8, -26>, 0.34
    tolerance 0.001
    pigment { rgb <0.45, 0.5, 0.24> } finish { ambient 0 diffuse 0.75 specular 0.1 }
}
