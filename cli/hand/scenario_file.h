#pragma once

/// Where a new scenario is written, and how it names the files it needs.

#include <filesystem>
#include <string>
#include <utility>

namespace regrasp::hand {

/// A file that is not there yet.
class ScenarioFile {
 public:
  explicit ScenarioFile(std::filesystem::path path) : path_(std::move(path)) {}
  const std::filesystem::path& path() const { return path_; }
  /// What the scenario and its hand are called.
  std::string name() const { return path_.stem().string(); }

  /// Throws Failure unless it can be made.
  void Check() const;
  /// The file of a ball of its own, beside it.
  std::string BallName() const { return name() + "_ball.urdf"; }
  /// Throws Failure where that file is there already.
  void CheckBall() const;
  /// An object as the scenario names it: a name, or where its file is from there. Throws Failure
  /// where that is no text.
  std::string NameOfObject(const std::string& object) const;
  /// The URDF likewise: nothing where it stands beside it under the same name.
  std::string NameOfUrdf(const std::filesystem::path& urdf) const;
  /// The whole file, and that of the ball unless `ball` is empty, or none. Throws Failure(kIo).
  void Write(const std::string& text, const std::string& ball) const;

 private:
  /// The way to a file from the scenario's place; empty where there is none.
  std::string WayTo(const std::filesystem::path& file) const;

  std::filesystem::path path_;
};

}  // namespace regrasp::hand
