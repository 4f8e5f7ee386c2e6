#pragma once

/// Changes inside a JSON value that stay JSON: what a parser of text never lets through is not
/// tried, what stands in the fields is.

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

namespace regrasp {

/// The fuzzer's bytes, one decision after the other; zeros after their end.
class Decisions {
 public:
  Decisions(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  std::size_t Below(std::size_t end) {
    if (end <= 1) return 0;
    const std::size_t number = end > 256 ? Byte() << 8 | Byte() : Byte();
    return number % end;
  }
  bool empty() const { return size_ == 0; }

 private:
  std::size_t Byte() {
    if (size_ == 0) return 0;
    --size_;
    return *data_++;
  }
  const std::uint8_t* data_;
  std::size_t size_;
};

/// A value that some field does not expect.
inline nlohmann::ordered_json OddValue(Decisions* decisions) {
  using Json = nlohmann::ordered_json;
  switch (decisions->Below(20)) {
    case 0:
      return nullptr;
    case 1:
      return true;
    case 2:
      return 0;
    case 3:
      return -1;
    case 4:
      return 1;
    case 5:
      return 7;
    case 6:
      return 1000000000;
    case 7:
      return std::numeric_limits<std::int64_t>::min();
    case 8:
      return std::numeric_limits<std::uint64_t>::max();
    case 9:
      return 1e308;
    case 10:
      return -1e308;
    case 11:
      return 5e-324;
    case 12:
      return 0.5;
    case 13:
      return -0.0;
    case 14:
      return "";
    case 15:
      return std::string("x\0\x1b", 3);
    case 16:
      return Json::array();
    case 17:
      return Json::object();
    case 18:
      return Json::array({0, 0, 1});
    default:
      return std::string(300, 'n');
  }
}

/// Walks down from `json` and changes what it comes to.
inline void Edit(nlohmann::ordered_json* json, Decisions* decisions) {
  while (json->is_structured() && !json->empty() && decisions->Below(8) != 0) {
    auto child = json->begin();
    std::advance(child, static_cast<std::ptrdiff_t>(decisions->Below(json->size())));
    json = &*child;
  }
  switch (decisions->Below(json->is_structured() ? 6 : 2)) {
    case 0:
    case 1:
      *json = OddValue(decisions);
      break;
    case 2:
      if (!json->empty())
        json->erase(
            std::next(json->begin(), static_cast<std::ptrdiff_t>(decisions->Below(json->size()))));
      break;
    case 3:
      if (json->is_array() && !json->empty()) {
        const nlohmann::ordered_json copy = (*json)[decisions->Below(json->size())];
        json->push_back(copy);
      }
      break;
    case 4:
      if (json->is_array())
        for (std::size_t n = decisions->Below(200); n > 0 && !json->empty(); --n)
          json->push_back(nlohmann::ordered_json(json->front()));
      break;
    default:
      if (json->is_object())
        (*json)["odd"] = OddValue(decisions);
      else
        json->push_back(OddValue(decisions));
  }
}

}  // namespace regrasp
