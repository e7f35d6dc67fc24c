// Compiled for a wider instruction set: nothing but kernels may be defined here.
#define SINEW_KERNELS avx512
#define SINEW_FLOAT_LANES 16
#include "sinew/crowd/kernels/sample.inl"
