// Compiled for every machine.
#define SINEW_KERNELS baseline
#define SINEW_FLOAT_LANES 4
#include "sinew/optimizer/kernels/newton.inl"
