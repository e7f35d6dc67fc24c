// What a host hears of the whole library.
#include "sinew/skeleton/hooks.h"

#include "sinew/c/call.h"

namespace sinew::c {
namespace {

/// A function of the host's and what it is given.
template <class Function>
struct Hook {
  Function function = nullptr;
  void* context = nullptr;
};

constinit Hook<sinew_log> log_hook;
constinit Hook<sinew_assertion> assertion_hook;

static_assert(int(LogLevel::kInfo) == SINEW_LOG_INFO && int(LogLevel::kWarning) == SINEW_LOG_WARNING &&
              int(LogLevel::kError) == SINEW_LOG_ERROR);

void log_to_host(void* /*context*/, LogLevel level, const char* words, int index) {
  log_hook.function(log_hook.context, static_cast<sinew_log_level>(level), words, index);
}

void assert_to_host(void* /*context*/, const char* condition, const char* file, int line) {
  assertion_hook.function(assertion_hook.context, condition, file, line);
}

}  // namespace
}  // namespace sinew::c

using namespace sinew;
using namespace sinew::c;

sinew_status sinew_set_log(sinew_log log, void* context) {
  log_hook = {log, context};
  set_log({log ? log_to_host : nullptr, nullptr});
  return SINEW_OK;
}

sinew_status sinew_set_assertion(sinew_assertion failed, void* context) {
  const Status set = set_assert({failed ? assert_to_host : nullptr, nullptr});
  if (set) assertion_hook = {failed, context};
  return answer(set);
}

sinew_status sinew_set_profiler(sinew_zone begin, sinew_zone end, void* context) {
  return answer(set_profiler({begin, end, context}));
}
