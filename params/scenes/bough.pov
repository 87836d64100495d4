// A poplar bough.
// grow  poplar ../poplar.ini --set growth.final_length=1200
// shape bough0 poplar --pose drooping --set pose.seed=1 --set mesh.petiole_length=0.45
// shape bough1 poplar --pose cupped --set pose.seed=2 --set mesh.petiole_length=0.4
// shape bough2 poplar --pose drooping --set pose.seed=3 --set pose.strength=1.4 --set mesh.petiole_length=0.5
// shape bough3 poplar --pose wavy --set pose.seed=4 --set pose.strength=0.7 --set mesh.petiole_length=0.4
// size  1400 740
#include "common.inc"
camera { location <0.5, 9, -95> look_at <0.5, 0.2, 0> angle 25 right x * image_width / image_height }
Sun(50, 155, 1.2 * <1, 0.96, 0.88>)
light_source { <60, 40, -120>, 0.35 shadowless }
sky_sphere { pigment { gradient y color_map { [0.3 rgb <0.80, 0.83, 0.84>] [0.62 rgb <0.56, 0.67, 0.78>] } scale 2 translate -y } }
#declare Kind = array[4];
#declare End = array[4];
#for (K, 0, 3)
    #declare Kind[K] = Shaped_leaf(concat("bough", str(K, 1, 0)))
    #declare End[K] = Petiole_end;
#end
#declare Twig = function(x) { 4.5 + 5 * sin(x * 2.4) - 7 * x }; // height along the twig, x from 0 to 1
#declare Bark = texture { pigment { bozo color_map { [0 rgb <0.28, 0.24, 0.16>] [1 rgb <0.36, 0.33, 0.22>] } scale 0.6 } finish { ambient 0 diffuse 0.8 } }
sphere_sweep {
    b_spline 14
    #for (K, 0, 13)
        <-27 + 45 * (K - 1) / 11, Twig((K - 1) / 11), 0>, 0.42 - 0.024 * K
    #end
    tolerance 0.001
    texture { Bark }
}
#declare Chance = seed(11);
#for (K, 0, 14)
    #declare T = (K + 0.7) / 15;
    // the petiole ends on the axis of the twig
    object {
        Kind[mod(K, 4)]
        translate -End[mod(K, 4)]
        scale (1.1 - 0.35 * T) * (0.85 + 0.2 * rand(Chance))
        rotate <50 + 40 * rand(Chance), 0, 0>
        rotate y * (K * 137.5 + 20 * rand(Chance))
        translate <-27 + 45 * T, Twig(T), 0>
    }
#end
