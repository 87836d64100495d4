// Two ginkgo leaves, gold and green.
// grow  ginkgo ../ginkgo.ini
// shape gold ginkgo --set mesh.petiole_bend=6 --pose wavy --set pose.strength=0.3 --set pose.seed=4 --set texture.lamina_colour=#d3a52c --set texture.vein_colour=#e3c873 --set texture.abaxial_lamina_colour=#cfae58 --set mesh.petiole_length=0.7
// shape green ginkgo --set mesh.petiole_bend=6 --pose wavy --set pose.strength=0.4 --set pose.seed=9 --set mesh.petiole_length=0.7
// size  1200 900
#include "common.inc"
camera { location <1.4, 38, -20> look_at <1.2, 0, 0.4> angle 38 right x * image_width / image_height }
Sun(46, -48, 1.1 * <1, 0.96, 0.88>)
Sky()
plane { y, 0 pigment { rgb <0.5, 0.5, 0.52> } finish { ambient 0 diffuse 0.8 } }
object { Settled("gold", 0) rotate -42 * y translate <-5.8, 0, 1.2> }
object { Settled("green", 0) rotate 50 * y translate <8.6, 0, 2.6> }
