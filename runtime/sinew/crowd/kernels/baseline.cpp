#define SINEW_KERNELS baseline
#define SINEW_FLOAT_LANES 4
#include "sinew/crowd/kernels/sample.inl"
