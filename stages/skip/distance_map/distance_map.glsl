// skip/distance_map: occupancy from the volume and the exact Chebyshev transform at each change of the transfer
// function (Deakin and Knackstedt).
#include "brace/skip_distance.glsl"
