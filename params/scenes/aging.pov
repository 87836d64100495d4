// One leaflet of horse chestnut getting older, clockwise from the left (Hong 2005, fig. 8.5).
// grow  leaflet leaflet.ini
// shape age0 leaflet --pose withered --set pose.age=0
// shape age1 leaflet --pose withered --set pose.age=0.2 --set texture.lamina_colour=#5b7a2a --set texture.abaxial_vein_colour=#c6cc88
// shape age2 leaflet --pose withered --set pose.age=0.4 --set texture.lamina_colour=#86852a --set texture.vein_colour=#d6c98a --set texture.abaxial_vein_colour=#d0c483
// shape age3 leaflet --pose withered --set pose.age=0.6 --set texture.lamina_colour=#a8802b --set texture.vein_colour=#cdb27a --set texture.abaxial_lamina_colour=#b79a63 --set texture.abaxial_vein_colour=#c2a468
// shape age4 leaflet --pose withered --set pose.age=0.8 --set texture.lamina_colour=#8a5a24 --set texture.vein_colour=#a98655 --set texture.abaxial_lamina_colour=#a98455 --set texture.abaxial_vein_colour=#9a7748
// shape age5 leaflet --pose withered --set pose.age=1 --set texture.lamina_colour=#5e3d1e --set texture.vein_colour=#86683f --set texture.abaxial_lamina_colour=#8a6a45 --set texture.abaxial_vein_colour=#765a36
// size  1500 1000
#include "common.inc"
camera { location <0, 80, -24> look_at <0, 0, -1> angle 41 right x * image_width / image_height }
Sun(48, -35, 1.05 * <1, 0.97, 0.9>)
Sky()
plane { y, 0 pigment { rgb 0.62 } finish { ambient 0 diffuse 0.8 } }
#declare K = 0;
#while (K < 6)
    object {
        Laid(Shaped_leaf(concat("age", str(K, 1, 0))))
        translate -9 * z
        rotate <-2, (K < 3 ? -14 + 14 * K : 194 - 14 * (K - 3) - 180), 0>
        translate <(K < 3 ? -15 + 15 * K : 15 - 15 * (K - 3)), 0, (K < 3 ? 10 : -9.5)>
    }
    #declare K = K + 1;
#end
