#include "sinew/residual/articulated_matrix.h"

namespace sinew {

template <class T>
void ArticulatedMatrix<T>::reserve(int bodies, int unknowns) {
  blocks_.resize(bodies);
  eliminated_.resize(bodies);
  first_.resize(unknowns);
  for (auto* v : {&force_, &motion_}) v->resize(bodies);
  for (auto* v : {&axes_, &moved_, &reduced_}) v->resize(unknowns);
  for (auto* v : {&own_, &factor_}) v->resize(unknowns);
  parts_ = {0, blocks_, first_, axes_, moved_, reduced_, own_, factor_, eliminated_, force_, motion_};
}

template <class T>
void ArticulatedMatrix<T>::assemble(const Tree<T>& tree, const Kinematics<T>& kin,
                                    std::span<Composite<T>> bodies, const Unknowns& unknowns,
                                    bool geometric) {
  size_ = unknowns.pattern.size;
  assemble_joints<T>(tree, kin, bodies, unknowns.dof, geometric, parts_);
}

template <class T>
void ArticulatedMatrix<T>::multiply(std::span<const T> x, std::span<T> y) {
  multiply_by_joints<T>(parts_, x, y);
}

template <class T>
bool ArticulatedMatrix<T>::factorise() {
  return factorise_joints<T>(parts_);
}

template <class T>
void ArticulatedMatrix<T>::solve(std::span<T> b) {
  solve_by_joints<T>(parts_, b);
}

template class ArticulatedMatrix<float>;
template class ArticulatedMatrix<double>;

}  // namespace sinew
