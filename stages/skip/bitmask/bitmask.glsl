// skip/bitmask: the exact transform of the union of the partitions' bits that the transfer function shows.
#include "brace/skip_distance.glsl"
