// Where rendered frames go: a video or numbered pictures, written by a thread of its own.
#pragma once

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "render/video.h"

namespace sinew::render {

struct Options;

/// Encodes in a second thread while the next frame is drawn. The order of frames is kept, so that the result
/// does not depend on timing. Files appear under their names in finish(); without it nothing is left behind.
class Sink {
 public:
  static std::unique_ptr<Sink> open(const std::string& output, const Options& options, convert::Error& error);
  ~Sink();
  Sink(const Sink&) = delete;
  Sink& operator=(const Sink&) = delete;

  /// Only one frame is wanted: "x.png" without a number in its name.
  bool single() const;
  /// Takes the picture's memory and leaves that of an earlier one in `image`. Waits while the encoder is more
  /// than a few frames behind. Reports the first error of an earlier frame.
  convert::Error add(Image& image);
  convert::Error finish();

 private:
  Sink() = default;
  void work();
  void stop();

  static constexpr std::size_t kWaiting = 4;  ///< frames; 4 of 1080p are 33 MB

  bool single_ = false;
  std::unique_ptr<FrameWriter> writer_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Image> waiting_;
  std::vector<Image> spare_;
  bool closing_ = false;
  convert::Error error_;
  std::thread thread_;
};

}  // namespace sinew::render
