// What the nodes of motion_nodes.h give, as bytes, twice in one program: by the kernels of this processor,
// and by the baseline's. node_bits.cpp and the animation layer are compiled a second time with the namespace
// renamed (-Dsinew=sinew_baseline) and SINEW_BASELINE_ONLY.
#pragma once

#include <vector>

namespace sinew {
template <class T>
std::vector<unsigned char> node_bits(int node);
}
namespace sinew_baseline {
template <class T>
std::vector<unsigned char> node_bits(int node);
}
