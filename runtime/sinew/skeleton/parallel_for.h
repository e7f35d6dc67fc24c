// The host's job system, as the runtime sees it: it starts no threads of its own.
#pragma once

namespace sinew {

/// A loop whose turns the host may take on its threads.
struct ParallelFor {
  /// Calls task(context, i) once for every i in [0, count), on any threads and in any order, and returns when
  /// all have returned. Null: here, one after the other.
  void (*run)(void* host, int count, void (*task)(void* context, int index), void* context) = nullptr;
  void* host = nullptr;  ///< given to `run`

  /// Runs the loop: by `run`, or here.
  void operator()(int count, void (*task)(void* context, int index), void* context) const {
    if (run)
      run(host, count, task, context);
    else
      for (int i = 0; i < count; ++i) task(context, i);
  }
};

}  // namespace sinew
