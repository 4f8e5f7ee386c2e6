#pragma once

/// What the keys of `top` mean. No terminal and no socket: a key and the model go in, what to send
/// comes out.

#include <optional>
#include <string>
#include <vector>

#include "cli/top/layout.h"

namespace regrasp::cli {

/// A request to send to the daemon.
struct Request {
  std::string method;
  Json params = Json::object();
};

class Keys {
 public:
  static constexpr int kEscape = 27;

  /// Takes a key (a character) and returns the request it asks for, if any.
  std::optional<Request> Press(int key, const DashboardModel& model);
  bool quit() const { return quit_; }
  /// What Layout shows of the state of the keys.
  Overlay Shown() const;

 private:
  struct Choice {
    int key;
    std::string label;
    Request request;
  };
  void Ask(std::string question, std::vector<Choice> choices);

  bool quit_ = false, help_ = false;
  std::string question_;
  std::vector<Choice> choices_;
  std::string finger_;
};

/// The next levels of noise, louder or quieter by a quarter, none above the wire's limits; from
/// silence up to the quietest preset.
Request ChangeNoise(const Json& noise, bool louder);

}  // namespace regrasp::cli
