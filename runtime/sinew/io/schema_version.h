// Version of the asset format: files of a newer major version are refused, newer minor ones only add fields.
#pragma once

namespace sinew {

inline constexpr int kSchemaMajor = 1;
inline constexpr int kSchemaMinor = 1;  // 1: ellipsoidal limits, muscles

}  // namespace sinew
