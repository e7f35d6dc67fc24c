// A symmetric form given in a body's axes, in the world's.
#pragma once

#include "sinew/skeleton/vector.h"

namespace sinew {

/// R S Rᵀ, of which six entries are computed.
template <class T>
Mat3<T> turned_form(const Mat3<T>& rotation, const Mat3<T>& form) {
  const Mat3<T> half = rotation * form;
  Mat3<T> out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j)
      out(i, j) = out(j, i) = vector::sum<T>(half(i, 0) * rotation(j, 0), half(i, 1) * rotation(j, 1),
                                             half(i, 2) * rotation(j, 2));
  return out;
}

}  // namespace sinew
