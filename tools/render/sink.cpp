#include "render/sink.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <exception>
#include <filesystem>

#include "render/render.h"

namespace sinew::render {

using convert::Error;

namespace {

/// frame_%04d.png, or one picture. Written under temporary names, renamed when all are there.
class Pictures : public FrameWriter {
 public:
  Pictures() = default;
  ~Pictures() override {
    for (std::size_t n = done_; n < names_.size(); ++n) std::remove(temporary(n).c_str());
  }
  Pictures(const Pictures&) = delete;
  Pictures& operator=(const Pictures&) = delete;

  Error open(const std::string& output) {
    const auto percent = output.find('%');
    head_ = output.substr(0, percent);
    if (percent == std::string::npos) return {};
    const auto d = output.find('d', percent);
    const bool numbered = d != std::string::npos && d - percent <= 3 &&
                          std::all_of(output.begin() + static_cast<std::ptrdiff_t>(percent) + 1,
                                      output.begin() + static_cast<std::ptrdiff_t>(d),
                                      [](unsigned char c) { return std::isdigit(c) != 0; }) &&
                          output.find('%', d) == std::string::npos;
    if (!numbered) return {output + ": the number in it is not like %04d"};
    digits_ = std::max(1, std::atoi(output.c_str() + percent + 1));
    tail_ = output.substr(d + 1);
    return {};
  }

  Error add(const Image& image) override {
    names_.push_back(name(names_.size()));
    return write_png(image, temporary(names_.size() - 1), names_.back());
  }

  Error finish() override {
    for (; done_ < names_.size(); ++done_)
      if (std::rename(temporary(done_).c_str(), names_[done_].c_str()) != 0)
        return {names_[done_] + ": cannot be written"};
    return {};
  }

 private:
  std::string name(std::size_t n) const {
    if (digits_ == 0) return head_;
    std::string number = std::to_string(n);
    number.insert(0, std::max(number.size(), std::size_t(digits_)) - number.size(), '0');
    return head_ + number + tail_;
  }
  std::string temporary(std::size_t n) const { return names_[n] + ".tmp"; }

  std::string head_, tail_;
  int digits_ = 0;  ///< 0: the name has no number
  std::vector<std::string> names_;
  std::size_t done_ = 0;
};

}  // namespace

std::unique_ptr<Sink> Sink::open(const std::string& output, const Options& options, Error& error) {
  std::unique_ptr<Sink> sink(new Sink);
  if (std::filesystem::path(output).extension() == ".png") {
    auto pictures = std::make_unique<Pictures>();
    error = pictures->open(output);
    sink->single_ = output.find('%') == std::string::npos;
    sink->writer_ = std::move(pictures);
  } else {
    sink->writer_ = create_video(output, options.width, options.height, options.fps, options.threads, error);
  }
  if (error) return nullptr;
  sink->thread_ = std::thread([made = sink.get()] { made->work(); });
  return sink;
}

Sink::~Sink() {
  stop();
}

bool Sink::single() const {
  return single_;
}

void Sink::work() {
  for (;;) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closing_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    Image image = std::move(waiting_.front());
    waiting_.pop_front();
    const bool failed = static_cast<bool>(error_);
    lock.unlock();
    Error error;
    try {
      if (!failed) error = writer_->add(image);
    } catch (const std::exception& unexpected) {  // memory ran out
      error = {unexpected.what()};
    }
    lock.lock();
    if (error) error_ = error;
    spare_.push_back(std::move(image));
    changed_.notify_all();
  }
}

void Sink::stop() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

Error Sink::add(Image& image) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return waiting_.size() < kWaiting || error_; });
  if (error_) return error_;
  waiting_.push_back(std::move(image));
  image = {};
  if (!spare_.empty()) {
    image = std::move(spare_.back());
    spare_.pop_back();
  }
  changed_.notify_all();
  return {};
}

Error Sink::finish() {
  stop();
  return error_ ? error_ : writer_->finish();
}

}  // namespace sinew::render
