// Assembles a sparse matrix over and over from additions that come in the same order each time: the first
// time finds the pattern and where each addition goes, the others only add.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

namespace sinew::study {

class SparseAssembly {
 public:
  void resize(Eigen::Index size) { matrix_.resize(size, size); }
  void begin() {
    next_ = 0;
    if (known_) std::fill_n(matrix_.valuePtr(), matrix_.nonZeros(), 0.0);
  }
  void add(Eigen::Index row, Eigen::Index column, double value) {
    if (known_)
      matrix_.valuePtr()[place_[next_++]] += value;
    else
      added_.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
  }
  template <class Block>
  void add_block(Eigen::Index row, Eigen::Index column, const Block& block) {
    for (Eigen::Index c = 0; c < block.cols(); ++c)
      for (Eigen::Index r = 0; r < block.rows(); ++r) add(row + r, column + c, block(r, c));
  }
  void end() {
    if (known_) return;
    matrix_.setFromTriplets(added_.begin(), added_.end());
    for (const Eigen::Triplet<double>& a : added_)
      place_.push_back(static_cast<std::size_t>(&matrix_.coeffRef(a.row(), a.col()) - matrix_.valuePtr()));
    added_.clear();
    known_ = true;
  }
  /// Forgets the pattern: other additions will come.
  void forget() {
    known_ = false;
    place_.clear();
  }
  const Eigen::SparseMatrix<double>& matrix() const { return matrix_; }

 private:
  Eigen::SparseMatrix<double> matrix_;
  std::vector<Eigen::Triplet<double>> added_;
  std::vector<std::size_t> place_;  ///< of each addition among the matrix's values
  std::size_t next_ = 0;
  bool known_ = false;
};

}  // namespace sinew::study
