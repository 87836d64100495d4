// Two ginkgo leaves, gold and green.
// grow  ginkgo ../ginkgo.ini
// shape gold ginkgo --pose wavy --set pose.strength=0.6 --set pose.seed=4 --set texture.lamina_colour=#d3a52c --set texture.vein_colour=#e3c873 --set texture.abaxial_lamina_colour=#cfae58 --set mesh.petiole_length=0.7
// shape green ginkgo --pose wavy --set pose.strength=0.8 --set pose.seed=9 --set mesh.petiole_length=0.7
// size  1200 900
#include "common.inc"
camera { location <2, 34, -26> look_at <0.5, 0, 0.5> angle 33 right x * image_width / image_height }
Sun(46, -48, 1.1 * <1, 0.96, 0.88>)
Sky()
plane { y, 0 pigment { rgb <0.5, 0.5, 0.52> } finish { ambient 0 diffuse 0.8 } }
object { Laid(Shaped_leaf("gold")) translate -4 * z rotate -28 * y translate <-6, 0, 1> }
object { Laid(Shaped_leaf("green")) translate -4 * z rotate 40 * y translate <6.5, 0, -1> }
