#include "sinew/c/call.h"

#include <array>

#include "sinew/skeleton/hooks.h"
#include "sinew/skeleton/version.h"

namespace sinew::c {
namespace {

struct Failure {
  const char* reason = "";
  int index = -1;
};

constinit thread_local Failure last;

constexpr std::array kNames{"SINEW_OK",           "SINEW_INVALID_ARGUMENT", "SINEW_NOT_FINITE",
                            "SINEW_OUT_OF_RANGE", "SINEW_BAD_FILE",         "SINEW_BAD_VERSION",
                            "SINEW_IO",           "SINEW_BAD_HANDLE",       "SINEW_BUSY",
                            "SINEW_NO_MEMORY",    "SINEW_NOT_FOUND",        "SINEW_TOO_SMALL",
                            "SINEW_BROKEN",       "SINEW_UNSUPPORTED"};
static_assert(kNames.size() == SINEW_UNSUPPORTED + 1);

static_assert(int(Code::kOk) == SINEW_OK && int(Code::kInvalidArgument) == SINEW_INVALID_ARGUMENT &&
              int(Code::kNotFinite) == SINEW_NOT_FINITE && int(Code::kOutOfRange) == SINEW_OUT_OF_RANGE &&
              int(Code::kBadFile) == SINEW_BAD_FILE && int(Code::kBadVersion) == SINEW_BAD_VERSION &&
              int(Code::kIo) == SINEW_IO);

}  // namespace

sinew_status fail(sinew_status status, const char* reason, int index) noexcept {
  last = {reason, index};
  write_log(LogLevel::kError, reason, index);
  return status;
}

sinew_status answer(const Status& status) noexcept {
  switch (status.code) {
    case Code::kOk:
      return SINEW_OK;
    case Code::kUnsupported:
      return fail(SINEW_UNSUPPORTED, status.reason, status.index);
    case Code::kNotFound:
      return fail(SINEW_NOT_FOUND, status.reason, status.index);
    default:  // by the same number
      return fail(static_cast<sinew_status>(status.code), status.reason, status.index);
  }
}

sinew_status refuse(std::uint64_t handle, Kind kind) noexcept {
  return fail(SINEW_BAD_HANDLE, why_not(handle, kind));
}

sinew_status failed_at(sinew_status status, int index) noexcept {
  last.index = index;
  return status;
}

}  // namespace sinew::c

const char* sinew_version(void) {
  return sinew::version();
}

const char* sinew_status_name(sinew_status status) {
  return status >= SINEW_OK && status <= SINEW_UNSUPPORTED ? sinew::c::kNames[std::size_t(status)]
                                                           : "unknown status";
}

const char* sinew_last_reason(void) {
  return sinew::c::last.reason;
}

int32_t sinew_last_index(void) {
  return sinew::c::last.index;
}
