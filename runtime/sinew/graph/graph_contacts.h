// Which joints the clips that play mean to rest on the ground: what FootPlacementJob asks for.
#pragma once

#include "sinew/graph/graph_scratch.h"

namespace sinew {

/// 0 … 1: the weights of the clips that play in this frame and have a contact window of the joint now, by
/// what the whole of them weigh. After GraphUpdateJob (or GraphStepJob), for the same character. Layers count
/// as far as they are shown, whatever their masks.
template <class T>
T graph_contact(const Graph& graph, const GraphScratch<T>& scratch, int joint);

/// @cond
extern template float graph_contact<float>(const Graph&, const GraphScratch<float>&, int);
extern template double graph_contact<double>(const Graph&, const GraphScratch<double>&, int);
/// @endcond

}  // namespace sinew
