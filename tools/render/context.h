// Off-screen GL context.
#pragma once

#include <memory>
#include <string>

#include "render/gl.h"

namespace sinew::render {

/// OSMesa, core profile 3.3, no display and no GPU needed. All drawing goes to our own framebuffers. Made,
/// used and destroyed by one thread, in which it is current.
class Context {
 public:
  static std::unique_ptr<Context> create(std::string& error);
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  const Gl& gl() const { return gl_; }

 private:
  Context() = default;
  void* handle_ = nullptr;
  unsigned char dummy_[16 * 16 * 4] = {};
  Gl gl_;
};

}  // namespace sinew::render
