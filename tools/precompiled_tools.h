// As runtime/precompiled_runtime.h, for the tools.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
// Each file that includes this would instantiate the parser for the sake of a literal operator that nobody
// uses (0.4 s). Here the operator is declared only; its body becomes that of a template.
#define _json(...)    \
  _json(__VA_ARGS__); \
  template <class S>  \
  nlohmann::json json_of_literal(S s, std::size_t n)
#include <nlohmann/json.hpp>
#undef _json
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "../runtime/precompiled_runtime.h"
