#include "sinew/optimizer/coupling_rows.h"

#include <algorithm>
#include <vector>

namespace sinew {
namespace {

template <class T>
class CouplingRows final : public CouplingModel<T> {
 public:
  void reserve(const SolveCapacity& capacity) override;
  std::size_t bytes(const SolveCapacity& capacity) const override {
    return capacity.nodes * (sizeof(Node) + 2 * sizeof(Vec3<T>)) + capacity.stencils * sizeof(Stencils) +
           capacity.tetrahedra * sizeof(Tetrahedra) + capacity.node_entries * 3 * sizeof(T);
  }
  void collect(std::span<TreeProblem<T>* const> trees, std::span<Coupling<T>* const> couplings,
               const Unknowns& unknowns, const PathAxes<T>& axes) override;
  bool empty() const override { return stencils_.empty() && tetrahedra_.empty(); }
  bool others_coupled() const override { return others_coupled_; }
  bool loops_coupled() const override { return loops_coupled_; }
  void add_curvature(bool loops, TreeMatrix<T>& matrix) const override;
  void multiply(std::span<const T> x, std::span<T> y) const override;
  bool add_rows(RowFactor<T>& rows) const override;

 private:
  struct Node {
    int leaf = -1;   ///< last unknown of its path; −1: nothing moves it
    int first = 0;   ///< of its entries
    int single = 0;  ///< a particle: its path is its own three translations along the world's axes
  };
  struct Stencils {
    bool loop = false;
    int count = 0;
    int node[4];
    T weight[4];
    Mat3<T> curvature;
    Mat3<T> root;  ///< of it, of loops
  };
  struct Tetrahedra {
    int node[4];
    TetrahedronHessian<T> curvature;
  };

  void add_node(const CouplingNode<T>& node, std::span<TreeProblem<T>* const> trees, const Unknowns& unknowns,
                const PathAxes<T>& axes);
  int cut(const int* nodes, int count, int node) const;
  void add_block(int i, int j, const Mat3<T>& block, int from, TreeMatrix<T>& matrix) const;
  bool couples(const int* nodes, int count) const;

  const TreePattern* pattern_ = nullptr;
  std::vector<Node> nodes_;
  std::vector<T> along_[3];  ///< [entry] displacement per unknown, world axes, root first
  std::vector<Stencils> stencils_;
  std::vector<Tetrahedra> tetrahedra_;
  mutable std::vector<Vec3<T>> moved_, pulled_;  ///< [node] of a product
  bool loops_coupled_ = false, others_coupled_ = false;
};

template <class T>
double measure(std::span<TreeProblem<T>* const> trees, const Vec3<double>& common_origin, Coupling<T>& c) {
  for (CouplingNode<T>& node : c.nodes) {
    if (node.tree < 0) {
      node.point = (node.place - common_origin).template cast<T>();
    } else {
      const Kinematics<T>& k = trees[node.tree]->kinematics;
      node.point = k.origin[node.body] + k.rotation[node.body] * node.local;
    }
  }
  return measure_elements(c);
}

template <class T>
void add_wrenches(const Coupling<T>& c, std::span<TreeProblem<T>* const> trees) {
  for (const CouplingNode<T>& node : c.nodes) {
    if (node.tree < 0) continue;
    TreeProblem<T>& p = *trees[node.tree];
    p.force[node.body] += node.gradient;
    p.moment[node.body] += node.point.cross(node.gradient);
  }
}

template <class T>
void CouplingRows<T>::reserve(const SolveCapacity& capacity) {
  nodes_.reserve(capacity.nodes);
  moved_.reserve(capacity.nodes);
  pulled_.reserve(capacity.nodes);
  stencils_.reserve(capacity.stencils);
  tetrahedra_.reserve(capacity.tetrahedra);
  for (std::vector<T>& v : along_) v.reserve(capacity.node_entries);
}

template <class T>
void CouplingRows<T>::add_node(const CouplingNode<T>& source, std::span<TreeProblem<T>* const> trees,
                               const Unknowns& unknowns, const PathAxes<T>& axes) {
  Node node;
  if (source.tree >= 0) {
    const TreeProblem<T>& p = *trees[source.tree];
    node.leaf = unknown_above<T>(*p.tree, source.body, unknowns, p.first_unknown_map);
  }
  if (node.leaf >= 0) {
    const Tree<T>& tree = *trees[source.tree]->tree;
    const int last = pattern_->depth[node.leaf], size = TreePattern::padded(last + 1);
    node.first = static_cast<int>(along_[0].size());
    for (int a = 0; a < 3; ++a) {
      along_[a].resize(along_[a].size() + size);
      const Vec3<T> axis = Vec3<T>::Unit(a);
      axes.project(node.leaf, axis, source.point.cross(axis), last, along_[a].data() + node.first);
    }
    const int parent = tree.parent[source.body];
    node.single = last == 2 && tree.type[source.body] == JointType::kTranslation &&
                  (parent < 0 || trees[source.tree]->kinematics.rotation[parent].isIdentity(T(0)));
  }
  nodes_.push_back(node);
}

/// Depth from which on the unknowns of one node's path belong to one of the element's branches each. 0 where
/// no path parts from it.
template <class T>
int CouplingRows<T>::cut(const int* nodes, int count, int node) const {
  const int own = nodes_[node].leaf;
  int depth = 0;
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < i; ++j) {
      const Node &a = nodes_[nodes[i]], &b = nodes_[nodes[j]];
      if (a.single || b.single) continue;
      const int shared = pattern_->common(a.leaf, b.leaf);
      if (shared >= 0 && shared != a.leaf && shared != b.leaf && pattern_->common(own, shared) >= 0)
        depth = std::max(depth, pattern_->depth[shared] + 1);
    }
  return depth;
}

template <class T>
bool CouplingRows<T>::couples(const int* nodes, int count) const {
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < i; ++j) {
      const int a = nodes_[nodes[i]].leaf, b = nodes_[nodes[j]].leaf;
      if (a < 0 || b < 0) continue;
      const int shared = pattern_->common(a, b);
      if (shared != a && shared != b) return true;
    }
  return false;
}

template <class T>
void CouplingRows<T>::collect(std::span<TreeProblem<T>* const> trees, std::span<Coupling<T>* const> couplings,
                              const Unknowns& unknowns, const PathAxes<T>& axes) {
  pattern_ = &unknowns.pattern;
  nodes_.clear();
  stencils_.clear();
  tetrahedra_.clear();
  for (std::vector<T>& v : along_) v.clear();
  loops_coupled_ = others_coupled_ = false;
  for (const Coupling<T>* c : couplings) {
    const int first = static_cast<int>(nodes_.size());
    for (const CouplingNode<T>& node : c->nodes) add_node(node, trees, unknowns, axes);
    for (const Stencil<T>& e : c->stencils) {
      Stencils& made = stencils_.emplace_back();
      made.loop = c->closes_slowly;
      made.count = e.count;
      for (int i = 0; i < e.count; ++i) {
        made.node[i] = first + e.node[i];
        made.weight[i] = e.weight[i];
      }
      made.curvature = stencil_curvature(*c, e);
      if (bool& coupled = made.loop ? loops_coupled_ : others_coupled_; !coupled)
        coupled = couples(made.node, made.count);
      if (made.loop) made.root = stencil_root(*c, e);
    }
    for (const Tetrahedron<T>& e : c->tetrahedra) {
      Tetrahedra& made = tetrahedra_.emplace_back();
      for (int i = 0; i < 4; ++i) made.node[i] = first + e.node[i];
      made.curvature = tetrahedron_curvature(*c, e);
      others_coupled_ = others_coupled_ || couples(made.node, 4);
    }
  }
  moved_.resize(nodes_.size());
  pulled_.resize(nodes_.size());
}

/// matrix += Jᵢᵀ block Jⱼ where it lies within a path, unknowns from depth `from` on. For i ≠ j the caller
/// adds the transposed pair too.
template <class T>
void CouplingRows<T>::add_block(int i, int j, const Mat3<T>& block, int from, TreeMatrix<T>& matrix) const {
  const Node &a = nodes_[i], &b = nodes_[j];
  const int shared = i == j ? a.leaf : pattern_->common(a.leaf, b.leaf);
  if (shared < 0 || (shared != a.leaf && shared != b.leaf)) return;  // paths that part share no branch
  const int last_b = std::min(pattern_->depth[b.leaf], pattern_->depth[shared]);
  const T* x = along_[0].data() + b.first;
  const T* y = along_[1].data() + b.first;
  const T* z = along_[2].data() + b.first;
  int k = a.leaf;
  for (int depth = pattern_->depth[a.leaf]; depth >= from; --depth, k = pattern_->parent[k]) {
    const int e = a.first + depth;
    const Vec3<T> f = block.transpose() * Vec3<T>(along_[0][e], along_[1][e], along_[2][e]);
    T* row = matrix.row(k);
    for (int l = from; l <= std::min(depth, last_b); ++l)
      row[l] += f.x() * x[l] + f.y() * y[l] + f.z() * z[l];
  }
}

template <class T>
void CouplingRows<T>::add_curvature(bool loops, TreeMatrix<T>& matrix) const {
  const auto add = [&](const int* node, int count, const auto& block_of) {
    for (int i = 0; i < count; ++i) {
      const Node& own = nodes_[node[i]];
      if (own.leaf < 0) continue;
      if (own.single) {  // nobody else is on its path
        const Mat3<T> block = block_of(i, i);
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b <= a; ++b) matrix.row(own.leaf - 2 + a)[b] += block(a, b);
        continue;
      }
      const int from = cut(node, count, node[i]);
      for (int j = 0; j < count; ++j)
        if (nodes_[node[j]].leaf >= 0 && !nodes_[node[j]].single)
          add_block(node[i], node[j], block_of(i, j), from, matrix);
    }
  };
  for (const Stencils& e : stencils_)
    if (loops || !e.loop)
      add(e.node, e.count,
          [&](int i, int j) -> Mat3<T> { return (e.weight[i] * e.weight[j]) * e.curvature; });
  for (const Tetrahedra& e : tetrahedra_)
    add(e.node, 4, [&](int i, int j) -> Mat3<T> { return e.curvature.template block<3, 3>(3 * i, 3 * j); });
}

template <class T>
void CouplingRows<T>::multiply(std::span<const T> x, std::span<T> y) const {
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const Node& node = nodes_[n];
    Vec3<T>& moved = moved_[n];
    moved.setZero();
    pulled_[n].setZero();
    if (node.single) {
      moved = {x[node.leaf - 2], x[node.leaf - 1], x[node.leaf]};
      continue;
    }
    int e = node.leaf < 0 ? 0 : node.first + pattern_->depth[node.leaf];
    for (int k = node.leaf; k >= 0; k = pattern_->parent[k], --e)
      moved += x[k] * Vec3<T>(along_[0][e], along_[1][e], along_[2][e]);
  }
  for (const Stencils& e : stencils_) {
    Vec3<T> sum = Vec3<T>::Zero();
    for (int i = 0; i < e.count; ++i) sum += e.weight[i] * moved_[e.node[i]];
    const Vec3<T> pull = e.curvature * sum;
    for (int i = 0; i < e.count; ++i) pulled_[e.node[i]] += e.weight[i] * pull;
  }
  for (const Tetrahedra& e : tetrahedra_) {
    Eigen::Matrix<T, 12, 1> moved;
    for (int i = 0; i < 4; ++i) moved.template segment<3>(3 * i) = moved_[e.node[i]];
    Eigen::Matrix<T, 12, 1> pull;
    pull.noalias() = e.curvature * moved;
    for (int i = 0; i < 4; ++i) pulled_[e.node[i]] += pull.template segment<3>(3 * i);
  }
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const Node& node = nodes_[n];
    const Vec3<T>& pull = pulled_[n];
    if (node.single) {
      for (int a = 0; a < 3; ++a) y[node.leaf - 2 + a] += pull[a];
      continue;
    }
    int e = node.leaf < 0 ? 0 : node.first + pattern_->depth[node.leaf];
    for (int k = node.leaf; k >= 0; k = pattern_->parent[k], --e)
      y[k] += pull.x() * along_[0][e] + pull.y() * along_[1][e] + pull.z() * along_[2][e];
  }
}

template <class T>
bool CouplingRows<T>::add_rows(RowFactor<T>& rows) const {
  for (const Stencils& e : stencils_) {
    if (!e.loop || e.root.isZero(T(0))) continue;
    const int leaf[2] = {nodes_[e.node[0]].leaf, nodes_[e.node[1]].leaf};
    if (leaf[0] < 0 && leaf[1] < 0) continue;
    const auto room = rows.add(*pattern_, 3, leaf[0], leaf[1]);
    if (!room) return false;
    for (int s = 0; s < 2; ++s) {
      const Node& node = nodes_[e.node[s]];
      const int size = leaf[s] < 0 ? 0 : pattern_->depth[leaf[s]] + 1;
      for (int d = 0; d < size; ++d)
        for (int row = 0; row < 3; ++row)
          for (int a = 0; a < 3; ++a)
            room.side[s][d][row] += e.weight[s] * e.root(a, row) * along_[a][node.first + d];
    }
  }
  return true;
}

template <class T>
std::unique_ptr<CouplingModel<T>> make_rows() {
  return std::make_unique<CouplingRows<T>>();
}

template <class T>
constexpr CouplingTerm<T> kCouplings{make_rows<T>, measure<T>, add_wrenches<T>, close_slowly<T>, tighten<T>};

}  // namespace

template <class T>
void Ties<T>::declare(StepPlan<T>& plan) {
  plan.couplings = &kCouplings<T>;
}

template struct Ties<float>;
template struct Ties<double>;

}  // namespace sinew
