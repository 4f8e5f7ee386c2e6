#pragma once

/// NumPy's .npz: a zip archive (without compression) of .npy arrays, format 1.0.

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace regrasp::run {

class Npz {
 public:
  /// Throws std::runtime_error when the file cannot be made.
  explicit Npz(const std::string& path);
  /// Row-major.
  void Add(const std::string& name, const std::vector<std::size_t>& shape,
           const std::vector<double>& values);
  /// One byte a value.
  void AddBools(const std::string& name, const std::vector<std::size_t>& shape,
                const std::string& values);
  void AddText(const std::string& name, const std::vector<std::string>& values);
  /// Throws std::runtime_error when something could not be written.
  void Finish();

 private:
  [[noreturn]] void TooLarge() const;
  void AddArray(const std::string& name, const std::string& type,
                const std::vector<std::size_t>& shape, const std::string& data);

  std::string path_;
  std::ofstream out_;
  std::string directory_;
  std::uint32_t offset_ = 0;
  std::uint16_t members_ = 0;
};

}  // namespace regrasp::run
