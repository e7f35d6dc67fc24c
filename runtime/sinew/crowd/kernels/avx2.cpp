// Compiled for a wider instruction set: nothing but kernels may be defined here.
#define SINEW_KERNELS avx2
#define SINEW_FLOAT_LANES 8
#include "sinew/crowd/kernels/sample.inl"
