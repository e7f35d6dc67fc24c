#define SINEW_KERNELS baseline
#define SINEW_FLOAT_LANES 4
#include "sinew/animation/kernels/blend.inl"
#include "sinew/animation/kernels/offset.inl"
#include "sinew/animation/kernels/spline.inl"
