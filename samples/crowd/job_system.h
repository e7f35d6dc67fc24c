// The threads of a host, handed to the runtime as a ParallelFor: oneTBB's where it was found, else a few of
// our own.
#pragma once

#include <sinew/skeleton/parallel_for.h>

#ifdef SINEW_TBB

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

class JobSystem {
 public:
  explicit JobSystem(int threads) : arena_(threads) {}
  sinew::ParallelFor parallel_for() { return {run, this}; }

 private:
  static void run(void* host, int count, void (*task)(void*, int), void* context) {
    static_cast<JobSystem*>(host)->arena_.execute([=] {
      // One at a time: what the runtime hands out is a worker's whole share.
      tbb::parallel_for(
          0, count, [=](int i) { task(context, i); }, tbb::simple_partitioner());
    });
  }

  tbb::task_arena arena_;
};

#else

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

class JobSystem {
 public:
  explicit JobSystem(int threads) {
    for (int n = 1; n < threads; ++n) helpers_.emplace_back([this] { help(); });
  }
  ~JobSystem() {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    wake_.notify_all();
    for (std::thread& t : helpers_) t.join();
  }
  JobSystem(const JobSystem&) = delete;
  JobSystem& operator=(const JobSystem&) = delete;
  sinew::ParallelFor parallel_for() { return {run, this}; }

 private:
  static void run(void* host, int count, void (*task)(void*, int), void* context) {
    JobSystem& self = *static_cast<JobSystem*>(host);
    {
      const std::lock_guard lock(self.mutex_);
      self.task_ = task;
      self.context_ = context;
      self.count_ = count;
      self.next_ = 0;
      self.busy_ = static_cast<int>(self.helpers_.size());
      ++self.round_;
    }
    self.wake_.notify_all();
    self.work();
    std::unique_lock lock(self.mutex_);
    self.done_.wait(lock, [&] { return self.busy_ == 0; });
  }
  void work() {
    for (int i; (i = next_.fetch_add(1)) < count_;) task_(context_, i);
  }
  void help() {
    for (int seen = 0;;) {
      {
        std::unique_lock lock(mutex_);
        wake_.wait(lock, [&] { return stop_ || round_ != seen; });
        if (stop_) return;
        seen = round_;
      }
      work();
      const std::lock_guard lock(mutex_);
      if (--busy_ == 0) done_.notify_one();
    }
  }

  std::vector<std::thread> helpers_;
  std::mutex mutex_;
  std::condition_variable wake_, done_;
  void (*task_)(void*, int) = nullptr;
  void* context_ = nullptr;
  std::atomic<int> next_{0};
  int count_ = 0, busy_ = 0, round_ = 0;
  bool stop_ = false;
};

#endif
