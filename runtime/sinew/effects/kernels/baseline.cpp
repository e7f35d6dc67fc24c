#define SINEW_KERNELS baseline
#define SINEW_FLOAT_LANES 4
#include "sinew/effects/kernels/check.inl"
