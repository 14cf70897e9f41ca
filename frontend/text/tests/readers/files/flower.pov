// A flower: petals by a loop, stamens by random numbers, a stem of its own threshold.
#version 3.7;
#include "colors.inc"
global_settings { assumed_gamma 1 }
camera { location <0, 2, -6> look_at 0 }
light_source { <3, 5, -4>, White }

#declare Petals = 7;
#declare Angle = 360 / Petals;
#declare Tilt = transform { rotate 20*x translate 0.1*y }
#declare Stream = seed(11);

/* A petal is a squashed ball. /* Comments nest. */ */
#declare Flower = blob {
    threshold 0.5
    sphere { 0, 0.7, 1.5 scale <1, 0.6, 1> pigment { color Gold } }
    #for (N, 0, Petals - 1)
        sphere {
            <1, 0, 0>, 0.8, strength (mod(N, 2) = 0 ? 1.1 : 0.9)
            scale <1, 0.35, 0.6> transform { Tilt } rotate N*Angle*y
            #if (mod(N, 2)) pigment { rgb <0.9, 0.2, 0.4> } #else texture { pigment { color red 0.8 blue 0.5 } } #end
        }
    #end
    #declare N = 0;
    #while (N < 5)
        component 0.8 0.25 <rand(Stream) - 0.5, 0.4, rand(Stream) - 0.5>
        #declare N = N + 1;
    #end
    cylinder { -0.3*y, 0.6*y, 0.3, -0.4 }
    pigment { color rgb <0.9, 0.8, 0.3>*0.9 }
    scale 1.2
}

#declare Stem = blob {
    threshold 0.25
    cylinder { <0, -2.5, 0>, <0, -0.2, 0>, 0.4, 0.6 }
    sphere { <0.5, -1.6, 0>, 0.6, 0.5 matrix <1, 0.5, 0, 0, 1, 0, 0, 0, 0.5, 0, 0.2, 0> }
    pigment { Green*0.4 }
    sturm
}

union {
    object { Flower rotate <-25, 15, 0> }
    object { Stem }
    translate 0.5*y
}
box { -1, 1 translate 40*x }
