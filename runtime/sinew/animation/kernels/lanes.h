// Pack widths of the instruction set that is being compiled for.
#pragma once

#include "sinew/animation/kernels/pack.h"

namespace sinew::kernels {
namespace {

template <class T>
struct LanesOf;
template <>
struct LanesOf<float> {
  using Type = Pack<float, SINEW_FLOAT_LANES>;
};
template <>
struct LanesOf<double> {
  using Type = Pack<double, 4>;
};

}  // namespace
}  // namespace sinew::kernels
