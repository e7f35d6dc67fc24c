// Compiled with -mavx2: nothing but kernels may be defined here.
#define SINEW_KERNELS avx2
#define SINEW_FLOAT_LANES 8
#include "sinew/animation/kernels/blend.inl"
#include "sinew/animation/kernels/offset.inl"
#include "sinew/animation/kernels/spline.inl"
