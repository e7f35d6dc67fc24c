#include "sinew/animation/clip_packing.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace sinew {
namespace {

using Numbers = std::int32_t[4];
using Values = double[4];

int components(const Clip::Packing& packing, bool rotation) {
  return rotation ? packing.components : 3;
}
int components(bool rotation) {
  return rotation ? 4 : 3;
}

/// a ⊗ b, x y z w.
void multiply(const Values& a, const Values& b, Values& out) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    out[i] = (a[3] * b[i] + a[i] * b[3]) + (a[j] * b[k] - a[k] * b[j]);
  }
  out[3] = a[3] * b[3] - ((a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]);
}

/// Bits, the least significant first.
class BitWriter {
 public:
  /// Counts only.
  BitWriter() = default;
  explicit BitWriter(std::vector<std::uint8_t>& out) : out_(&out) {}
  void put(std::uint32_t value, int bits) {
    count_ += std::size_t(bits);
    if (!out_) return;
    pending_ |= std::uint64_t(value) << held_;
    for (held_ += bits; held_ >= 8; held_ -= 8, pending_ >>= 8) out_->push_back(std::uint8_t(pending_));
  }
  void finish() {
    if (out_ && held_ > 0) out_->push_back(std::uint8_t(pending_));
  }
  std::size_t count() const { return count_; }

 private:
  std::vector<std::uint8_t>* out_ = nullptr;
  std::size_t count_ = 0;
  std::uint64_t pending_ = 0;
  int held_ = 0;
};

class BitReader {
 public:
  explicit BitReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  std::uint32_t take(int bits) {
    while (held_ < bits) {
      ended_ |= next_ == bytes_.size();
      pending_ |= std::uint64_t(ended_ ? 0 : bytes_[next_++]) << held_;
      held_ += 8;
    }
    const auto value = std::uint32_t(pending_ & ((std::uint64_t(1) << bits) - 1));
    pending_ >>= bits;
    held_ -= bits;
    return value;
  }
  bool ended() const { return ended_; }  ///< more was asked for than there is
  std::size_t left() const { return 8 * (bytes_.size() - next_) + std::size_t(ended_ ? 0 : held_); }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t next_ = 0;
  std::uint64_t pending_ = 0;
  int held_ = 0;
  bool ended_ = false;
};

/// The Golomb–Rice parameter that the numbers so far make likely: about the binary logarithm of their mean.
class Likely {
 public:
  explicit Likely(int bits) : sum_(std::uint64_t(1) << bits) {}
  int bits() const {
    int bits = 0;
    while (bits < kPackingBits && (count_ << bits) < sum_ * 11 / 16) ++bits;  // ln 2 of the mean
    return bits;
  }
  void learn(std::uint32_t value) {
    sum_ += value;
    if (++count_ < kMemory) return;
    sum_ /= 2;
    count_ /= 2;
  }

 private:
  static constexpr std::uint64_t kMemory = 16;  ///< numbers: as long as a movement of a second or two
  std::uint64_t sum_, count_ = 1;
};

constexpr int kOrderBits = 2, kFirstBits = 5, kLikelyBits = 5, kMostPrefix = 20;
constexpr int kConstant = 0, kHighestOrder = 3;  ///< orders: of differences, or all numbers are the same

/// Small whatever the sign: 0, −1, 1, −2, …
std::uint32_t folded(std::int64_t x) {
  return std::uint32_t(x < 0 ? -2 * x - 1 : 2 * x);
}
std::int64_t unfolded(std::uint32_t x) {
  return x % 2 == 0 ? std::int64_t(x / 2) : -std::int64_t(x / 2) - 1;
}

/// What differences of an order say of the next number, from up to three before it.
class Prediction {
 public:
  explicit Prediction(int order) : order_(order) {}
  std::int64_t next() const {
    switch (std::min(order_, known_)) {
      case 1:
        return a_;
      case 2:
        return 2 * a_ - b_;
      case 3:
        return 3 * (a_ - b_) + c_;
      default:
        return 0;
    }
  }
  void learn(std::int64_t number) {
    c_ = b_;
    b_ = a_;
    a_ = number;
    ++known_;
  }

 private:
  int order_, known_ = 0;
  std::int64_t a_ = 0, b_ = 0, c_ = 0;  ///< the last number and those before
};

void put_first(std::int32_t number, BitWriter& out) {
  const std::uint32_t value = folded(number);
  const int width = std::bit_width(value);
  out.put(std::uint32_t(width), kFirstBits);
  out.put(value, width);
}

/// Numbers by differences of one order.
void put_differences(std::span<const std::int32_t> numbers, int order, BitWriter& out) {
  Prediction prediction(order);
  prediction.learn(numbers[0]);
  std::uint64_t sum = 0;
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    sum += folded(numbers[i] - prediction.next());
    prediction.learn(numbers[i]);
  }
  const int first_guess = std::bit_width(std::uint32_t(sum / (numbers.size() - 1)));
  out.put(std::uint32_t(order), kOrderBits);
  put_first(numbers[0], out);
  out.put(std::uint32_t(first_guess), kLikelyBits);
  Likely likely(first_guess);
  prediction = Prediction(order);
  prediction.learn(numbers[0]);
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    const std::uint32_t value = folded(numbers[i] - prediction.next());
    const int bits = likely.bits();
    const std::uint32_t prefix = value >> bits;
    if (prefix < kMostPrefix) {
      out.put((1u << prefix) - 1, int(prefix) + 1);
      out.put(value & ((1u << bits) - 1), bits);
    } else {
      out.put((1u << kMostPrefix) - 1, kMostPrefix);
      out.put(value, 32);
    }
    likely.learn(value);
    prediction.learn(numbers[i]);
  }
}

void put_component(std::span<const std::int32_t> numbers, BitWriter& out) {
  if (std::all_of(numbers.begin(), numbers.end(), [&](std::int32_t n) { return n == numbers[0]; })) {
    out.put(kConstant, kOrderBits);
    put_first(numbers[0], out);
    return;
  }
  int best = 1;
  std::size_t fewest = 0;
  for (int order = 1; order <= kHighestOrder; ++order) {
    BitWriter counted;
    put_differences(numbers, order, counted);
    if (order == 1 || counted.count() < fewest) {
      fewest = counted.count();
      best = order;
    }
  }
  put_differences(numbers, best, out);
}

/// False where the bytes say what cannot be. `order`: of the differences found.
bool take_component(BitReader& in, std::span<std::int32_t> numbers, int& order) {
  order = int(in.take(kOrderBits));
  const std::int64_t first = unfolded(in.take(int(in.take(kFirstBits))));
  if (std::abs(first) >= 1 << kPackingBits) return false;
  std::fill(numbers.begin(), numbers.end(), std::int32_t(first));
  if (order == kConstant) return !in.ended();
  Likely likely(int(in.take(kLikelyBits)));
  Prediction prediction(order);
  prediction.learn(first);
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    const int bits = likely.bits();
    std::uint32_t prefix = 0;
    while (prefix < kMostPrefix && in.take(1) != 0) ++prefix;
    const std::uint32_t value = prefix < kMostPrefix ? prefix << bits | in.take(bits) : in.take(32);
    const std::int64_t number = prediction.next() + unfolded(value);
    if (in.ended() || std::abs(number) >= 1 << kPackingBits) return false;
    numbers[i] = std::int32_t(number);
    likely.learn(value);
    prediction.learn(number);
  }
  return true;
}

constexpr int kCountBits = 16, kJointBits = 16, kStepBits = 7;

void put_track(int joint, const Clip::Packing& packing, bool rotation, BitWriter& out) {
  out.put(std::uint32_t(joint), kJointBits);
  out.put(packing.step, kStepBits);
  if (!rotation) return;
  out.put(packing.components == 4, 1);
  if (packing.components == 3)
    for (const std::int8_t r : packing.reference) out.put(std::uint8_t(r), 8);
}

Clip::Packing take_track(bool rotation, BitReader& in, int& joint) {
  Clip::Packing packing;
  joint = int(in.take(kJointBits));
  packing.step = std::uint8_t(in.take(kStepBits));
  if (!rotation) return packing;
  packing.components = in.take(1) != 0 ? 4 : 3;
  if (packing.components == 3)
    for (std::int8_t& r : packing.reference) r = std::int8_t(in.take(8));
  return packing;
}

bool is_storable(int joint, const Clip::Packing& packing, bool rotation) {
  if (joint < 0 || joint >= 1 << kJointBits || packing.step >= kPackingSteps) return false;
  return !rotation || packing.components == 3 || packing.components == 4;
}

/// Numbers of one track, [component][knot]. False where a control is not what they can say, or nothing moves:
/// bytes that say that could ask for any memory.
bool numbers_of(const Clip::Group& group, std::size_t track, std::vector<std::int32_t> (&out)[4]) {
  const Clip::Packing& packing = group.packings[track];
  const std::size_t width = components(group.rotation), row = width * group.tracks.size();
  bool moves = false;
  for (auto& numbers : out) numbers.clear();
  for (int knot = 0; knot < group.control_count; ++knot) {
    Numbers numbers;
    const float* control = group.controls.data() + row * std::size_t(knot) + width * track;
    if (!pack_control(packing, group.rotation, control, numbers)) return false;
    for (int c = 0; c < components(packing, group.rotation); ++c) {
      out[c].push_back(numbers[c]);
      moves |= numbers[c] != out[c][0];
    }
  }
  return moves;
}

}  // namespace

void unpack_control(const Clip::Packing& packing, bool rotation, const Numbers& numbers, float* control) {
  const double step = packing_step(packing.step);
  Values v = {0, 0, 0, 1}, out;
  for (int c = 0; c < components(packing, rotation); ++c) v[c] = numbers[c] * step;
  if (rotation && packing.components == 3) {
    Values reference;
    for (int c = 0; c < 4; ++c) reference[c] = packing.reference[c] / 127.0;
    multiply(reference, v, out);
  } else {
    std::copy(v, v + 4, out);
  }
  for (int c = 0; c < components(rotation); ++c) control[c] = float(out[c]);
}

bool pack_control(const Clip::Packing& packing, bool rotation, const float* control, Numbers& numbers) {
  Values v = {0, 0, 0, 1};
  for (int c = 0; c < components(rotation); ++c) v[c] = control[c];
  if (rotation && packing.components == 3) {
    Values back, beside;
    for (int c = 0; c < 4; ++c) back[c] = (c < 3 ? -1 : 1) * packing.reference[c] / 127.0;
    multiply(back, v, beside);
    for (int c = 0; c < 3; ++c) v[c] = beside[c] / beside[3];
  }
  for (int c = 0; c < components(packing, rotation); ++c) {
    const double number = std::round(v[c] / packing_step(packing.step));
    if (!(std::abs(number) < 1 << kPackingBits)) return false;
    numbers[c] = std::int32_t(number);
  }
  float again[4];
  unpack_control(packing, rotation, numbers, again);
  for (int c = 0; c < components(rotation); ++c)
    if (Eigen::numext::bit_cast<std::uint32_t>(again[c]) !=
        Eigen::numext::bit_cast<std::uint32_t>(control[c]))
      return false;
  return true;
}

std::size_t packed_bits(std::span<const std::int32_t> numbers) {
  BitWriter counted;
  if (!numbers.empty()) put_component(numbers, counted);
  return counted.count();
}

bool pack_group(const Clip::Group& group, std::vector<std::uint8_t>& bytes) {
  bytes.clear();
  if (group.packings.empty() || group.packings.size() != group.tracks.size() ||
      group.tracks.size() >= 1 << kCountBits || group.control_count < 2)
    return false;
  BitWriter out(bytes);
  out.put(std::uint32_t(group.tracks.size()), kCountBits);
  std::vector<std::int32_t> numbers[4];
  for (std::size_t k = 0; k < group.tracks.size(); ++k) {
    const Clip::Packing& packing = group.packings[k];
    if (!is_storable(group.tracks[k].joint, packing, group.rotation) || !numbers_of(group, k, numbers)) {
      bytes.clear();
      return false;
    }
    put_track(group.tracks[k].joint, packing, group.rotation, out);
    for (int c = 0; c < components(packing, group.rotation); ++c) put_component(numbers[c], out);
  }
  out.finish();
  return true;
}

Status unpack_group(std::span<const std::uint8_t> bytes, Clip::Group& group) {
  const auto bad = [](const char* reason) { return Status::error(Code::kBadFile, reason); };
  BitReader in(bytes);
  const std::size_t tracks = in.take(kCountBits), width = components(group.rotation);
  if (group.control_count < 2) return bad("packed curve without controls");
  const auto count = std::size_t(group.control_count);
  // A track has a head and at least a bit for all but its first control: bytes bound what is allocated.
  constexpr std::size_t kLeastHead = 24;
  if (tracks == 0 || tracks * (count + kLeastHead) > in.left()) return bad("packed curves end early");
  group.controls.resize(width * tracks * count);
  std::vector<std::int32_t> numbers[4];
  for (auto& of_component : numbers) of_component.resize(count);
  for (std::size_t k = 0; k < tracks; ++k) {
    int joint = 0, order = 0;
    const Clip::Packing packing = take_track(group.rotation, in, joint);
    if (!is_storable(joint, packing, group.rotation)) return bad("packed track says what cannot be");
    bool moves = false;
    for (int c = 0; c < components(packing, group.rotation); ++c) {
      if (!take_component(in, numbers[c], order)) return bad("packed curve is damaged");
      moves |= order != kConstant;
    }
    if (!moves) return bad("packed track does not move");
    group.tracks.push_back({joint});
    group.packings.push_back(packing);
    for (std::size_t knot = 0; knot < count; ++knot) {
      const Numbers at = {numbers[0][knot], numbers[1][knot], numbers[2][knot], numbers[3][knot]};
      unpack_control(packing, group.rotation, at, group.controls.data() + width * (tracks * knot + k));
    }
  }
  return {};
}

}  // namespace sinew
