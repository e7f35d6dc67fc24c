// Version of the asset format: files of a newer major version are refused, newer minor ones only add fields.
#pragma once

namespace sinew {

inline constexpr int kSchemaMajor = 2;  // 2: packed clips
inline constexpr int kSchemaMinor = 2;  // 2.1: curves, events, markers, masks; 2.2: morph targets

}  // namespace sinew
