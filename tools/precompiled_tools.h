// As runtime/precompiled_runtime.h, for the tools.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "../runtime/precompiled_runtime.h"
