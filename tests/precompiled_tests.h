// As runtime/precompiled_runtime.h, for the tests.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <set>
#include <sstream>

#if __has_include(<nlohmann/json.hpp>)  // where the tools are built
#include "../tools/precompiled_tools.h"
#else
#include "../runtime/precompiled_runtime.h"
#endif
