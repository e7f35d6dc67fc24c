#include "sinew/character/neighbour_grid.h"

#include <algorithm>

namespace sinew {

void NeighbourGrid::reserve(int balls) {
  balls_.reserve(balls);
  large_.reserve(balls);
  order_.reserve(balls);
  std::uint32_t buckets = 16;
  while (buckets < 2u * static_cast<std::uint32_t>(balls) && buckets < (1u << 22)) buckets *= 2;
  if (first_.size() != buckets + 1) first_.assign(buckets + 1, 0);
  mask_ = buckets - 1;
}

int NeighbourGrid::add(int id, const Vec3<double>& center, double radius) {
  balls_.push_back({center, radius, id, 0, 0});
  return static_cast<int>(balls_.size()) - 1;
}

void NeighbourGrid::build() {
  large_.clear();
  double largest = 0.25;  // m; smaller cells only cost walks
  for (const Ball& b : balls_)
    if (b.radius <= kLarge) largest = std::max(largest, b.radius);
  cell_ = 2 * largest;
  std::fill(first_.begin(), first_.end(), 0);
  for (std::size_t n = 0; n < balls_.size(); ++n) {
    Ball& b = balls_[n];
    if (!(b.radius <= kLarge)) {
      large_.push_back(static_cast<int>(n));
      continue;
    }
    b.x = cell_of(b.center.x());
    b.y = cell_of(b.center.y());
    ++first_[bucket_of(b.x, b.y)];
  }
  int sum = 0;
  for (int& count : first_) {
    sum += count;
    count = sum;  // where the bucket ends; filling backwards turns that into where it begins
  }
  order_.resize(static_cast<std::size_t>(sum));
  for (std::size_t n = balls_.size(); n-- > 0;)
    if (const Ball& b = balls_[n]; b.radius <= kLarge)
      order_[static_cast<std::size_t>(--first_[bucket_of(b.x, b.y)])] = static_cast<int>(n);
}

}  // namespace sinew
