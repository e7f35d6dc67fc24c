// Motion axes of the unknowns on the way to the root, component by component.
#pragma once

#include <span>
#include <vector>

#include "sinew/residual/tree.h"
#include "sinew/residual/tree_factor.h"

namespace sinew {

struct Unknowns;

/// For every unknown, the six components of the motion axes (w, v) of all unknowns on its path, root first,
/// in whole blocks: a wrench projected on a path is then six vector updates. Unknowns of one body share
/// arrays.
template <class T>
class PathAxes {
 public:
  /// Set-up for so many unknowns, whose paths have so many entries; nothing allocates afterwards.
  void reserve(int unknowns, int entries);
  void clear();
  /// Appends the unknowns of one tree, in the order of append_unknowns, whose answer `first` is.
  void append(const Tree<T>& tree, const Kinematics<T>& kinematics, const Unknowns& unknowns, int first);

  /// Component c (w.x, w.y, w.z, v.x, v.y, v.z) along the path of unknown k; entries beyond depth[k] belong
  /// to its own body's later unknowns, then to nobody.
  const T* component(int k, int c) const { return values_.data() + first_[k] + c * stride_[k]; }

  /// out[position] = force·v + moment·w for the positions 0 … last on the path of unknown k.
  void project(int k, const Vec3<T>& force, const Vec3<T>& moment, int last, T* out) const;

 private:
  std::vector<T> values_;
  std::vector<int> first_, stride_;  ///< [unknown]
};

extern template class PathAxes<float>;
extern template class PathAxes<double>;

}  // namespace sinew
