// Three letters over a puddle with a dent and a ball: seen from the camera, x goes to the right and y up, and z away.
#version 3.7;
#include "colors.inc"
global_settings { assumed_gamma 1 }
camera { location <2, 3, -12> look_at <0, 1, 0> }
light_source { <-6, 9, -9>, White }

#declare R = 0.62;
#declare S = 1.1;

union {
    blob {
        threshold 0.5
        // P: a stem, and a bowl of seven balls.
        cylinder { <-3.4, 0, 0>, <-3.4, 2.4, 0>, R, S pigment { color Red } }
        #for (I, 0, 6)
            sphere {
                <-2.75 + 0.65*sin(radians(30*I)), 1.75 + 0.65*cos(radians(30*I)), 0>, R, 0.75
                pigment { color rgb <0.9, 0.25 - 0.03*I, 0.05> }
            }
        #end
        // O: a ring of sixteen.
        #declare N = 0;
        #while (N < 16)
            sphere { 0.95*y, R, 0.75 rotate 22.5*N*z translate <0.1, 1.2, 0> pigment { Gold } }
            #declare N = N + 1;
        #end
        // V: two strokes.
        cylinder { <2, 2.4, 0>, <2.8, 0, 0>, R, S pigment { color rgb <0.1, 0.45, 0.9> } }
        cylinder { <3.6, 2.4, 0>, <2.8, 0, 0>, R, S pigment { color rgb <0.1, 0.45, 0.9> } }
        translate 0.3*y
    }
    blob {
        threshold 0.4
        sphere { 0, 5, 1 scale <1, 0.12, 0.4> }
        sphere { <-1.5, 0.3, -2>, 0.9, 1.6 pigment { White } }
        cylinder { <1, 0.5, -1>, <3, 0.5, -0.6>, 0.7, -0.9 }
        pigment { color rgb <0.55, 0.75, 0.85> }
        translate -0.5*y
    }
}
