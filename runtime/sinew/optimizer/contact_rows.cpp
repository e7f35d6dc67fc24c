#include "sinew/optimizer/contact_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "sinew/optimizer/newton_constants.h"
#include "sinew/residual/tree_factor_pass.h"

namespace sinew {
namespace {

/// path += a·x + b·y + c·z over the blocks that hold entries 0 … last.
template <class T>
inline void add_combination(T* __restrict path, T a, const T* __restrict x, T b, const T* __restrict y, T c,
                            const T* __restrict z, int last) {
  for (int block = 0; block <= last; block += TreePattern::kBlock)
    for (int j = block; j < block + TreePattern::kBlock; ++j) path[j] += a * x[j] + b * y[j] + c * z[j];
}

constexpr double kArm = 0.1;  ///< m of a human's

template <class T>
class ContactRows final : public ContactModel<T> {
 public:
  using Trees = typename ContactModel<T>::Trees;

  void reserve(int contacts, int entries) override;
  std::size_t bytes(const SolveCapacity& capacity) const override {
    return capacity.contacts * sizeof(Row) + capacity.contact_entries * (sizeof(int) + 7 * sizeof(T));
  }
  void limit(int entries) override { most_entries_ = entries; }
  void evaluate(Trees trees, std::span<Contact<T>> contacts, T stick, double& energy) const override;
  void add_forces(Trees trees, std::span<const Contact<T>> contacts, T stick) const override;
  void collect(Trees trees, std::span<const Contact<T>> contacts, const Unknowns& unknowns,
               const PathAxes<T>& axes, T near, T stick) override;
  bool empty() const override { return rows_.empty(); }
  bool coupled() const override { return coupled_; }
  bool bends_across() const override { return bends_across_; }
  bool slides_across() const override { return slides_across_; }
  void look_along(std::span<const T> direction) override;
  T slope(T t) const override;
  void move(T t) override;
  void correct(std::span<const Contact<T>> contacts) override;
  void measure(std::span<const Contact<T>> contacts) override;
  bool in_factor(T drag, bool apart) const override;
  void expect_forces(std::span<Contact<T>> contacts) const override;
  void add_gradient(std::span<T> gradient) const override;
  void measure_curvature(T drag) override;
  void add_curvature(TreeMatrix<T>& matrix, bool across) const override;
  bool add_rows(const TreePattern& pattern, RowFactor<T>& rows) const override;
  void multiply(std::span<const T> x, std::span<T> y) const override;
  void multiply_coupling(std::span<const T> x, std::span<T> y) const override;
  void add_bending(TreeMatrix<T>& matrix) const override;
  void multiply_bending(std::span<const T> x, std::span<T> y) const override;
  void add_sliding(TreeMatrix<T>& matrix) const override;
  void multiply_sliding(std::span<const T> x, std::span<T> y) const override;

 private:
  struct Side {
    int first = 0;  ///< of its entries
    int count = 0;
    int depth = 0;  ///< position of the first entry on its unknown's path
  };
  /// Second derivative by (gap, slip 1, slip 2).
  struct Block {
    T normal = T(0), slip11 = T(0), slip12 = T(0), slip22 = T(0);
    bool zero() const { return normal <= T(0) && slip11 <= T(0) && slip22 <= T(0); }
    /// But for a share of the largest entries.
    bool near(const Block& o, T share) const {
      const T most = share * std::max(o.slip11, o.slip22);
      return std::abs(normal - o.normal) <= share * o.normal && std::abs(slip11 - o.slip11) <= most &&
             std::abs(slip12 - o.slip12) <= most && std::abs(slip22 - o.slip22) <= most;
    }
  };
  struct Row {
    int contact = 0;
    Side side[2];
    T stiffness = T(0), grip = T(0);  ///< N/m, μλ in N
    T width = T(0), stick = T(0);     ///< m; m per step
    T stretch = T(1);                 ///< change of the damped gap by the gap
    T gap = T(0), slip[2]{};          ///< at the inner solution so far; the gap is the damped one
    T d_gap = T(0), d_slip[2]{};      ///< along the direction looked at
    Block curvature;                  ///< that the last factor holds of it
    bool bends = false;
    Mat3<T> bending = Mat3<T>::Zero();  ///< −force·∇²distance, N/m, world axes
    T sliding = T(0);                   ///< N/m, see Slide

    bool couples() const { return side[0].count > 0 && side[1].count > 0; }
  };
  /// The stiffer direction of force·(lever·μ² − 2μw), turns taken as displacements at kArm.
  struct Slide {
    T stiffness = T(0);                ///< N/m; 0: nothing slides, or nothing presses
    Vec3<T> force = Vec3<T>::Zero();   ///< on a at the contact point, world
    Vec3<T> moment = Vec3<T>::Zero();  ///< m
    explicit Slide(const Contact<T>& contact);
  };
  /// By gap and slips.
  struct Change {
    T gap = T(0), slip[2] = {};
  };

  Side add_side(const Contact<T>& contact, const Slide& slide, int leaf, const Vec3<T>& material, T sign,
                int above, const TreePattern& pattern, const PathAxes<T>& axes);
  Block block(const Row& row, T drag) const;
  Change along(const Side& side, std::span<const T> direction) const;
  void pull(const Side& side, const Block& block, const Change& change, std::span<T> y) const;

  /// All that has a value per entry.
  std::array<std::vector<T>*, 7> arrays() {
    return {&gap_, &slip_[0], &slip_[1], &move_[0], &move_[1], &move_[2], &slide_};
  }

  std::vector<Row> rows_;
  std::vector<int> unknown_;  ///< [entry]
  std::vector<T> gap_, slip_[2],
      move_[3];           ///< [entry] change per unknown; move_: of the contact point, world
  std::vector<T> slide_;  ///< [entry] likewise, see Slide
  int most_entries_ = 0;
  bool coupled_ = false, bends_across_ = false, slides_across_ = false;
};

template <class T>
void ContactRows<T>::evaluate(Trees trees, std::span<Contact<T>> contacts, T stick, double& energy) const {
  for (Contact<T>& c : contacts) {
    TreeProblem<T>& a = *trees[c.tree_a];
    TreeProblem<T>* b = c.tree_b < 0 ? nullptr : trees[c.tree_b];
    sinew::measure(a.kinematics, b ? &b->kinematics : nullptr, c);
    if (!c.acts()) continue;
    energy += double(contact_energy(c, stick));
    const Vec3<T> normal = normal_gradient(c), tangent = friction_gradient(c, stick);
    a.force[c.body_a] += normal + tangent;
    a.moment[c.body_a] += c.point.cross(normal) + c.material_point.cross(tangent);
    if (b) {
      b->force[c.body_b] -= normal + tangent;
      b->moment[c.body_b] -= c.point.cross(normal) + c.material_point_b.cross(tangent);
    }
  }
}

template <class T>
void ContactRows<T>::add_forces(Trees trees, std::span<const Contact<T>> contacts, T stick) const {
  for (const Contact<T>& c : contacts) {
    if (!(c.grip > T(0)) && c.expected_force <= T(0)) continue;
    const Vec3<T> normal = -c.expected_force * c.normal, tangent = friction_gradient(c, stick);
    Composite<T>& a = trees[c.tree_a]->composite[c.body_a];
    a.add_force(c.point, normal);
    a.add_force(c.material_point, tangent);
    if (c.tree_b < 0) continue;
    Composite<T>& b = trees[c.tree_b]->composite[c.body_b];
    b.add_force(c.point, -normal);
    b.add_force(c.material_point_b, -tangent);
  }
}

template <class T>
void ContactRows<T>::reserve(int contacts, int entries) {
  rows_.reserve(contacts);
  unknown_.reserve(entries);
  for (std::vector<T>* v : arrays()) v->reserve(entries);
  most_entries_ = entries;
}

template <class T>
typename ContactRows<T>::Side ContactRows<T>::add_side(const Contact<T>& c, const Slide& slide, int leaf,
                                                       const Vec3<T>& material, T sign, int above,
                                                       const TreePattern& pattern, const PathAxes<T>& axes) {
  Side side;
  if (leaf < 0 || leaf == above) return side;
  const int whole = pattern.depth[leaf] + 1;
  const std::size_t begin = unknown_.size(), size = begin + TreePattern::padded(whole);
  if (size > static_cast<std::size_t>(most_entries_))
    return side;  // full: this side stands still in the inner problem
  unknown_.resize(size);
  for (std::vector<T>* v : arrays()) v->resize(size);
  // What moves both sides alike, up to `above`, is left out.
  side.depth = above < 0 ? 0 : pattern.depth[above] + 1;
  side.first = static_cast<int>(begin) + side.depth;
  side.count = whole - side.depth;
  for (int k = leaf, e = static_cast<int>(begin) + whole - 1; e >= side.first; k = pattern.parent[k], --e)
    unknown_[e] = k;
  // A unit force along each direction, and its moment about the common origin: n·(v + w × x) = n·v + (x ×
  // n)·w.
  const auto project = [&](const Vec3<T>& direction, const Vec3<T>& at, std::vector<T>& out) {
    axes.project(leaf, direction, at.cross(direction), whole - 1, out.data() + begin);
  };
  project(sign * c.normal, c.point, gap_);
  project(sign * c.frame.col(0), material, slip_[0]);
  project(sign * c.frame.col(1), material, slip_[1]);
  if (c.bends)
    for (int a = 0; a < 3; ++a) project(sign * Vec3<T>::Unit(a), c.point, move_[a]);
  if (slide.stiffness > T(0)) {
    axes.project(leaf, sign * slide.force, sign * (slide.moment + c.point.cross(slide.force)), whole - 1,
                 slide_.data() + begin);
  }
  return side;
}

template <class T>
void ContactRows<T>::collect(Trees trees, std::span<const Contact<T>> contacts, const Unknowns& unknowns,
                             const PathAxes<T>& axes, T near, T stick) {
  rows_.clear();
  unknown_.clear();
  for (std::vector<T>* v : arrays()) v->clear();
  coupled_ = bends_across_ = slides_across_ = false;
  for (std::size_t n = 0; n < contacts.size(); ++n) {
    const Contact<T>& c = contacts[n];
    if (c.gap > c.length_scale * near) continue;
    Row row;
    row.contact = static_cast<int>(n);
    row.stiffness = c.stiffness;
    row.grip = c.grip;
    row.width = c.width();
    row.stick = c.speed_scale * stick;
    row.stretch = c.stretch;
    row.gap = c.damped_gap();
    row.slip[0] = c.slip[0];
    row.slip[1] = c.slip[1];
    const auto leaf = [&](int tree, int body) {
      return tree < 0 ? -1
                      : unknown_above<T>(*trees[tree]->tree, body, unknowns, trees[tree]->first_unknown_map);
    };
    const int leaf_a = leaf(c.tree_a, c.body_a), leaf_b = leaf(c.tree_b, c.body_b);
    // What moves both sides alike moves neither gap nor slip.
    const int shared = c.tree_a == c.tree_b ? unknowns.pattern.common(leaf_a, leaf_b) : -1;
    const Slide slide(c);
    row.side[0] = add_side(c, slide, leaf_a, c.material_point, T(1), shared, unknowns.pattern, axes);
    if (c.tree_b >= 0)
      row.side[1] = add_side(c, slide, leaf_b, c.material_point_b, T(-1), shared, unknowns.pattern, axes);
    if (row.side[0].count + row.side[1].count == 0) continue;
    row.bends = c.expected_force > T(0) && c.bends;
    if (row.bends) row.bending = -c.expected_force * c.bending;
    row.sliding = slide.stiffness;
    coupled_ = coupled_ || row.couples();
    bends_across_ = bends_across_ || (row.bends && row.couples());
    slides_across_ = slides_across_ || (row.sliding > T(0) && row.couples());
    rows_.push_back(row);
  }
}

template <class T>
typename ContactRows<T>::Change ContactRows<T>::along(const Side& side, std::span<const T> direction) const {
  Change change;
  for (int e = side.first; e < side.first + side.count; ++e) {
    const T d = direction[unknown_[e]];
    change.gap += gap_[e] * d;
    change.slip[0] += slip_[0][e] * d;
    change.slip[1] += slip_[1][e] * d;
  }
  return change;
}

/// y += the side's rowsᵀ · block · change.
template <class T>
void ContactRows<T>::pull(const Side& side, const Block& b, const Change& change, std::span<T> y) const {
  const T normal = b.normal * change.gap;
  const T one = b.slip11 * change.slip[0] + b.slip12 * change.slip[1];
  const T two = b.slip12 * change.slip[0] + b.slip22 * change.slip[1];
  for (int e = side.first; e < side.first + side.count; ++e)
    y[unknown_[e]] += normal * gap_[e] + one * slip_[0][e] + two * slip_[1][e];
}

template <class T>
void ContactRows<T>::look_along(std::span<const T> direction) {
  for (Row& row : rows_) {
    const Change a = along(row.side[0], direction), b = along(row.side[1], direction);
    row.d_gap = row.stretch * (a.gap + b.gap);
    row.d_slip[0] = a.slip[0] + b.slip[0];
    row.d_slip[1] = a.slip[1] + b.slip[1];
  }
}

template <class T>
T ContactRows<T>::slope(T t) const {
  T slope = T(0);
  for (const Row& row : rows_) {
    slope -=
        ContactLaw<T>::force(row.stiffness, row.gap + t * row.d_gap, row.width) * row.d_gap / row.stretch;
    if (row.grip <= T(0)) continue;
    const T s0 = row.slip[0] + t * row.d_slip[0], s1 = row.slip[1] + t * row.d_slip[1];
    slope += row.grip * FrictionLaw<T>::slope_over_slip(std::sqrt(s0 * s0 + s1 * s1), row.stick) *
             (s0 * row.d_slip[0] + s1 * row.d_slip[1]);
  }
  return slope;
}

template <class T>
void ContactRows<T>::move(T t) {
  for (Row& row : rows_) {
    row.gap += t * row.d_gap;
    row.slip[0] += t * row.d_slip[0];
    row.slip[1] += t * row.d_slip[1];
  }
}

template <class T>
void ContactRows<T>::correct(std::span<const Contact<T>> contacts) {
  for (Row& row : rows_) {
    const Contact<T>& c = contacts[row.contact];
    row.gap = c.damped_gap() - row.d_gap;
    row.slip[0] = c.slip[0] - row.d_slip[0];
    row.slip[1] = c.slip[1] - row.d_slip[1];
  }
}

template <class T>
void ContactRows<T>::measure(std::span<const Contact<T>> contacts) {
  for (Row& row : rows_) {
    const Contact<T>& c = contacts[row.contact];
    row.gap = c.damped_gap();
    row.slip[0] = c.slip[0];
    row.slip[1] = c.slip[1];
  }
}

template <class T>
bool ContactRows<T>::in_factor(T drag, bool apart) const {
  return std::all_of(rows_.begin(), rows_.end(), [&](const Row& row) {
    const Block now = block(row, drag);
    return coupled_ && apart ? now.zero() && row.curvature.zero()
                             : now.near(row.curvature, T(kSameCurvature));
  });
}

template <class T>
void ContactRows<T>::expect_forces(std::span<Contact<T>> contacts) const {
  for (Contact<T>& c : contacts) c.expected_force = T(0);
  for (const Row& row : rows_)
    contacts[row.contact].expected_force = ContactLaw<T>::force(row.stiffness, row.gap, row.width);
}

template <class T>
void ContactRows<T>::add_gradient(std::span<T> gradient) const {
  for (const Row& row : rows_) {
    const T pressure = ContactLaw<T>::force(row.stiffness, row.gap, row.width);
    T drag[2] = {};
    if (row.grip > T(0)) {
      const T slip = std::sqrt(row.slip[0] * row.slip[0] + row.slip[1] * row.slip[1]);
      const T scale = row.grip * FrictionLaw<T>::slope_over_slip(slip, row.stick);
      drag[0] = scale * row.slip[0];
      drag[1] = scale * row.slip[1];
    } else if (pressure <= T(0)) {
      continue;
    }
    for (const Side& side : row.side)
      for (int e = side.first; e < side.first + side.count; ++e)
        gradient[unknown_[e]] += drag[0] * slip_[0][e] + drag[1] * slip_[1][e] - pressure * gap_[e];
  }
}

template <class T>
typename ContactRows<T>::Block ContactRows<T>::block(const Row& row, T drag) const {
  Block b;
  b.normal = row.stretch * ContactLaw<T>::curvature(row.stiffness, row.gap, row.width);
  if (row.grip <= T(0)) return b;
  const T slip = std::sqrt(row.slip[0] * row.slip[0] + row.slip[1] * row.slip[1]);
  const T across = row.grip * FrictionLaw<T>::slope_over_slip(slip, row.stick);
  b.slip11 = b.slip22 = across;
  if (slip <= T(0)) return b;
  const T along = std::max(row.grip * FrictionLaw<T>::curvature(slip, row.stick), drag * across) - across;
  const T x = row.slip[0] / slip, y = row.slip[1] / slip;
  b.slip11 += along * x * x;
  b.slip12 = along * x * y;
  b.slip22 += along * y * y;
  return b;
}

template <class T>
void ContactRows<T>::measure_curvature(T drag) {
  for (Row& row : rows_) row.curvature = block(row, drag);
}

template <class T>
void ContactRows<T>::add_curvature(TreeMatrix<T>& matrix, bool across) const {
  for (const Row& row : rows_) {
    const Block& b = row.curvature;
    if (b.zero() || (!across && row.couples())) continue;
    for (const Side& side : row.side) {
      const T *gap = gap_.data() + side.first, *first = slip_[0].data() + side.first,
              *second = slip_[1].data() + side.first;
      for (int i = 0; i < side.count; ++i) {
        const T normal = b.normal * gap[i];
        const T one = b.slip11 * first[i] + b.slip12 * second[i];
        const T two = b.slip12 * first[i] + b.slip22 * second[i];
        add_combination(matrix.row(unknown_[side.first + i]) + side.depth, normal, gap, one, first, two,
                        second, i);
      }
    }
  }
}

template <class T>
void ContactRows<T>::multiply(std::span<const T> x, std::span<T> y) const {
  for (const Row& row : rows_) {
    if (row.curvature.zero()) continue;
    const Change a = along(row.side[0], x), b = along(row.side[1], x);
    const Change both{a.gap + b.gap, {a.slip[0] + b.slip[0], a.slip[1] + b.slip[1]}};
    for (const Side& side : row.side) pull(side, row.curvature, both, y);
  }
}

template <class T>
void ContactRows<T>::multiply_coupling(std::span<const T> x, std::span<T> y) const {
  for (const Row& row : rows_) {
    if (row.curvature.zero() || !row.couples()) continue;
    const Change a = along(row.side[0], x), b = along(row.side[1], x);
    pull(row.side[0], row.curvature, b, y);
    pull(row.side[1], row.curvature, a, y);
  }
}

template <class T>
void ContactRows<T>::add_bending(TreeMatrix<T>& matrix) const {
  for (const Row& row : rows_) {
    if (!row.bends) continue;
    for (const Side& side : row.side)
      for (int i = 0; i < side.count; ++i) {
        const int e = side.first + i;
        const Vec3<T> f = row.bending * Vec3<T>(move_[0][e], move_[1][e], move_[2][e]);
        add_combination(matrix.row(unknown_[e]) + side.depth, f.x(), &move_[0][side.first], f.y(),
                        &move_[1][side.first], f.z(), &move_[2][side.first], i);
      }
  }
}

template <class T>
void ContactRows<T>::multiply_bending(std::span<const T> x, std::span<T> y) const {
  for (const Row& row : rows_) {
    if (!row.bends || row.side[0].count == 0 || row.side[1].count == 0) continue;
    Vec3<T> moved[2] = {Vec3<T>::Zero(), Vec3<T>::Zero()};
    for (const int n : {0, 1})
      for (int e = row.side[n].first; e < row.side[n].first + row.side[n].count; ++e)
        moved[n] += x[unknown_[e]] * Vec3<T>(move_[0][e], move_[1][e], move_[2][e]);
    for (const int n : {0, 1}) {
      const Vec3<T> f = row.bending * moved[1 - n];
      for (int e = row.side[n].first; e < row.side[n].first + row.side[n].count; ++e)
        y[unknown_[e]] += f.x() * move_[0][e] + f.y() * move_[1][e] + f.z() * move_[2][e];
    }
  }
}

template <class T>
ContactRows<T>::Slide::Slide(const Contact<T>& c) {
  if (!c.sliding.slides || !(c.expected_force > T(0))) return;
  const T arm = T(kArm) * c.length_scale, lever = c.sliding.lever / arm;
  const T most = (lever + std::sqrt(lever * lever + T(4))) / T(2);  // eigenvalue of (lever, −1; −1, 0)
  const T length = std::sqrt(most * most + T(1));
  stiffness = std::max(c.expected_force, normal_force(c)) * most / arm;
  force = c.sliding.across / -length;
  moment = c.sliding.tipping * (arm * most / length);
}

template <class T>
void ContactRows<T>::add_sliding(TreeMatrix<T>& matrix) const {
  for (const Row& row : rows_) {
    if (row.sliding <= T(0)) continue;
    for (const Side& side : row.side) {
      const T* slide = slide_.data() + side.first;
      for (int i = 0; i < side.count; ++i)
        subtract_path(matrix.row(unknown_[side.first + i]) + side.depth, slide, -row.sliding * slide[i], i);
    }
  }
}

template <class T>
void ContactRows<T>::multiply_sliding(std::span<const T> x, std::span<T> y) const {
  for (const Row& row : rows_) {
    if (row.sliding <= T(0) || !row.couples()) continue;
    T moved[2] = {};
    for (const int n : {0, 1})
      for (int e = row.side[n].first; e < row.side[n].first + row.side[n].count; ++e)
        moved[n] += x[unknown_[e]] * slide_[e];
    for (const int n : {0, 1})
      for (int e = row.side[n].first; e < row.side[n].first + row.side[n].count; ++e)
        y[unknown_[e]] += row.sliding * moved[1 - n] * slide_[e];
  }
}

template <class T>
bool ContactRows<T>::add_rows(const TreePattern& pattern, RowFactor<T>& rows) const {
  for (const Row& row : rows_) {
    if (!row.couples() || row.curvature.zero()) continue;
    const Block& b = row.curvature;
    const T normal = std::sqrt(b.normal), one = std::sqrt(b.slip11);
    const T lean = one > T(0) ? b.slip12 / one : T(0);
    const T two = std::sqrt(std::max(b.slip22 - lean * lean, T(0)));
    const auto last = [&](const Side& side) { return unknown_[side.first + side.count - 1]; };
    const auto room = rows.add(pattern, row.grip > T(0) ? 3 : 1, last(row.side[0]), last(row.side[1]));
    if (!room) return false;
    for (int s = 0; s < 2; ++s) {
      const Side& side = row.side[s];
      for (int i = 0; i < side.count; ++i) {
        const int e = side.first + i;
        auto& out = room.side[s][side.depth + i];
        out[0] = normal * gap_[e];
        out[1] = one * slip_[0][e] + lean * slip_[1][e];
        out[2] = two * slip_[1][e];
      }
    }
  }
  return true;
}

}  // namespace

template <class T>
std::unique_ptr<ContactModel<T>> make_contact_rows() {
  return std::make_unique<ContactRows<T>>();
}

template std::unique_ptr<ContactModel<float>> make_contact_rows<float>();
template std::unique_ptr<ContactModel<double>> make_contact_rows<double>();

}  // namespace sinew
