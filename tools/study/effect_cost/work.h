// What the counting program runs.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

namespace sinew::study {

/// `step` is what is counted, once per step; `prepare` comes before it and is not.
struct Work {
  virtual ~Work() = default;
  virtual void prepare() {}
  virtual void step() = 0;
  virtual std::size_t bytes() const { return 0; }  ///< of the effect
};

// Null where they do not know the mode; the program ends where they do not know the effect.
std::unique_ptr<Work> make_kernel(const std::string& mode, const std::string& effect, int instances);
std::unique_ptr<Work> make_world(const std::string& mode, const std::string& effect, int instances);

/// With exit code 3.
[[noreturn]] void unknown(const std::string& effect);

}  // namespace sinew::study
