#pragma once

/// Standard error for a log that must never hold up the daemon: while nobody reads it, lines are
/// counted and left out.

#include <poll.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <unistd.h>

#include <memory>
#include <mutex>

namespace regrasp {

class PatientSink final : public spdlog::sinks::base_sink<std::mutex> {
 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    // A pipe that is ready takes PIPE_BUF bytes; no line of ours is longer but in extremity.
    pollfd descriptor{STDERR_FILENO, POLLOUT, 0};
    if (::poll(&descriptor, 1, 0) == 0) {
      ++lost_;
      return;
    }
    if (lost_ > 0) {
      const std::string text = std::to_string(lost_) + " lines were lost: nobody read the log";
      lost_ = 0;
      terminal_->log({message.logger_name, spdlog::level::warn, text});
    }
    terminal_->log(message);
  }
  void flush_() override { terminal_->flush(); }
  void set_pattern_(const std::string& pattern) override { terminal_->set_pattern(pattern); }
  void set_formatter_(std::unique_ptr<spdlog::formatter> formatter) override {
    terminal_->set_formatter(std::move(formatter));
  }

 private:
  std::shared_ptr<spdlog::sinks::stderr_color_sink_mt> terminal_ =
      std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
  std::size_t lost_ = 0;
};

}  // namespace regrasp
