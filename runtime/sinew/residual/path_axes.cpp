#include "sinew/residual/path_axes.h"

#include <algorithm>

#include "sinew/residual/composite.h"

namespace sinew {

template <class T>
void PathAxes<T>::reserve(int unknowns, int entries) {
  values_.reserve(std::size_t(6) * entries);
  first_.reserve(unknowns);
  stride_.reserve(unknowns);
}

template <class T>
void PathAxes<T>::clear() {
  values_.clear();
  first_.clear();
  stride_.clear();
}

template <class T>
void PathAxes<T>::append(const Tree<T>& tree, const Kinematics<T>& kinematics, const Unknowns& unknowns,
                         int first) {
  const TreePattern& pattern = unknowns.pattern;
  for (int i = 0; i < tree.bodies; ++i) {
    int from = -1, to = -1;  // unknowns of this body
    for (int dof = tree.first_dof[i]; dof < tree.first_dof[i + 1]; ++dof)
      if (const int k = unknowns.of_dof[first + dof]; k >= 0) {
        if (from < 0) from = k;
        to = k;
      }
    if (from < 0) continue;
    const int stride = TreePattern::padded(pattern.depth[to] + 1);
    const int begin = static_cast<int>(values_.size());
    values_.resize(values_.size() + std::size_t(6) * stride, T(0));
    const int above = pattern.parent[from];
    const int inherited = above < 0 ? 0 : pattern.depth[above] + 1;
    for (int c = 0; c < 6; ++c) {
      T* out = values_.data() + begin + c * stride;
      if (above >= 0) std::copy_n(component(above, c), inherited, out);
      for (int k = from; k <= to; ++k) {
        const int dof = unknowns.dof[k];
        out[pattern.depth[k]] = c < 3 ? kinematics.w[dof][c] : kinematics.v[dof][c - 3];
      }
    }
    for (int k = from; k <= to; ++k) {
      first_.push_back(begin);
      stride_.push_back(stride);
    }
  }
}

template <class T>
void PathAxes<T>::project(int k, const Vec3<T>& f, const Vec3<T>& m, int last, T* __restrict out) const {
  const T* __restrict axes = values_.data() + first_[k];
  const int s = stride_[k];
  for (int block = 0; block <= last; block += TreePattern::kBlock)
    for (int i = block; i < block + TreePattern::kBlock; ++i)
      out[i] = (m.x() * axes[i] + m.y() * axes[i + s] + m.z() * axes[i + 2 * s]) +
               (f.x() * axes[i + 3 * s] + f.y() * axes[i + 4 * s] + f.z() * axes[i + 5 * s]);
}

template class PathAxes<float>;
template class PathAxes<double>;

}  // namespace sinew
