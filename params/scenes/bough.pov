// A poplar bough.
// grow  poplar ../poplar.ini --set growth.final_length=1200
// shape bough0 poplar --pose drooping --set pose.seed=1
// shape bough1 poplar --pose cupped --set pose.seed=2
// shape bough2 poplar --pose drooping --set pose.seed=3 --set pose.strength=1.4
// shape bough3 poplar --pose wavy --set pose.seed=4 --set pose.strength=0.7
// size  1400 1000
#include "common.inc"
camera { location <0, 12, -95> look_at <0, -4, 0> angle 27 right x * image_width / image_height }
Sun(50, 155, 1.2 * <1, 0.96, 0.88>)
light_source { <60, 40, -120>, 0.35 shadowless }
background { rgb <0.72, 0.78, 0.84> }
#declare Kind = array[4];
#declare K = 0;
#while (K < 4)
    #declare Kind[K] = Shaped_leaf(concat("bough", str(K, 1, 0)))
    #declare K = K + 1;
#end
#declare Twig = function(x) { 4 * sin(x * 2.6) - 5 * x }; // height along the twig, x from 0 to 1
#declare Bark = texture { pigment { bozo color_map { [0 rgb <0.28, 0.24, 0.16>] [1 rgb <0.36, 0.33, 0.22>] } scale 0.6 } finish { ambient 0 diffuse 0.8 } }
sphere_sweep {
    b_spline 14
    #declare K = 0;
    #while (K < 14)
        <-26 + 52 * (K - 1) / 11, Twig((K - 1) / 11), 0>, 0.42 - 0.022 * K
        #declare K = K + 1;
    #end
    tolerance 0.001
    texture { Bark }
}
#declare Chance = seed(11);
#declare K = 0;
#while (K < 11)
    #declare T = (K + 0.6) / 11;
    // base of the petiole at the origin: the petiole hangs 3.5 cm before the blade
    object {
        Kind[mod(K, 4)]
        translate 3.4 * z
        scale 0.8 + 0.25 * rand(Chance)
        rotate <55 + 40 * rand(Chance), 0, 0>
        rotate y * (K * 137.5 + 20 * rand(Chance))
        translate <-26 + 52 * T, Twig(T), 0>
    }
    #declare K = K + 1;
#end
