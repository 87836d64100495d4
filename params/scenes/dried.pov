// Three dried leaves on a board.
// grow  leaflet leaflet.ini
// grow  poplar ../poplar.ini --set growth.final_length=1200
// grow  sweetgum ../sweetgum.ini
// shape dry0 leaflet --set mesh.petiole_length=0.1 --set mesh.petiole_bend=20 --pose withered --set pose.age=0.75 --set pose.seed=3 --set texture.lamina_colour=#96602a --set texture.abaxial_vein_colour=#8a6840 --set texture.vein_colour=#b5905c --set texture.abaxial_lamina_colour=#a98455
// shape dry1 poplar --set mesh.petiole_bend=20 --pose withered --set pose.age=0.55 --set pose.seed=5 --set texture.lamina_colour=#b58b2e --set texture.abaxial_vein_colour=#b09560 --set texture.vein_colour=#d2b878 --set texture.abaxial_lamina_colour=#b79a63
// shape dry2 sweetgum --set mesh.membrane=bilaplace --set mesh.petiole_bend=8 --pose withered --set pose.age=0.5 --set pose.seed=2 --set texture.lamina_colour=#8c3a22 --set texture.abaxial_vein_colour=#9c6a42 --set texture.vein_colour=#b9854f --set texture.abaxial_lamina_colour=#a4694a
// size  1400 900
#include "common.inc"
camera { location <2, 46, -34> look_at <1.5, 0, 0.3> angle 32 right x * image_width / image_height }
Sun(50, -50, 1.15 * <1, 0.94, 0.84>)
Sky()
object { Board(9) rotate -12 * y }
object { Settled("dry0", -5) rotate 62 * y translate <-5, 0, 2.6> }
object { Settled("dry1", 0) rotate -30 * y translate <2, 0, -4.5> }
object { Settled("dry2", 0) rotate 150 * y translate <10, 0, 2.5> }
