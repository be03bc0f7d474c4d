// skip/partitioned: D', the smallest of the partitions' distance maps that the transfer function shows.
#include "brace/skip_distance.glsl"
