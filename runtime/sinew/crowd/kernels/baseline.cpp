#define SINEW_KERNELS baseline
#include "sinew/crowd/kernels/batch.inl"
