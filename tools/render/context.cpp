#include "render/context.h"

// glcorearb.h first: osmesa.h pulls in gl.h, whose declarations are a subset.
#include <GL/osmesa.h>

#include <mutex>

namespace sinew::render {

std::unique_ptr<Context> Context::create(std::string& error) {
  static std::mutex one_at_a_time;  // OSMesa sets itself up in the first call
  const std::lock_guard lock(one_at_a_time);
  const int attributes[] = {OSMESA_FORMAT,
                            OSMESA_RGBA,
                            OSMESA_DEPTH_BITS,
                            24,
                            OSMESA_PROFILE,
                            OSMESA_CORE_PROFILE,
                            OSMESA_CONTEXT_MAJOR_VERSION,
                            3,
                            OSMESA_CONTEXT_MINOR_VERSION,
                            3,
                            0};
  std::unique_ptr<Context> made(new Context);
  made->handle_ = OSMesaCreateContextAttribs(attributes, nullptr);
  if (!made->handle_ ||
      !OSMesaMakeCurrent(static_cast<OSMesaContext>(made->handle_), made->dummy_, GL_UNSIGNED_BYTE, 16, 16)) {
    error = "no off-screen OpenGL 3.3 context (OSMesa)";
    return nullptr;
  }
#define SINEW_GL_LOAD(type, name)                                            \
  made->gl_.name = reinterpret_cast<type>(OSMesaGetProcAddress("gl" #name)); \
  if (!made->gl_.name) {                                                     \
    error = "OpenGL function gl" #name " is missing";                        \
    return nullptr;                                                          \
  }
  SINEW_GL_FUNCTIONS(SINEW_GL_LOAD)
#undef SINEW_GL_LOAD
  return made;
}

Context::~Context() {
  if (handle_) OSMesaDestroyContext(static_cast<OSMesaContext>(handle_));
}

}  // namespace sinew::render
