#pragma once

/// What a finger's explorations have gained of late: the low-passed RelativeGain of each.

#include <cmath>

namespace regrasp {

class ExploredGain {
 public:
  bool known() const { return value_ != kNone; }
  /// Whether it pays to explore again; what is not known may gain anything.
  bool at_least(double gain) const { return !known() || value_ >= gain; }
  /// One more exploration; `share`: its weight against the ones before.
  void Add(double gain, double share) {
    value_ += (known() ? share : 1.0) * (gain - value_);
    if (value_ == kNone) value_ = std::nextafter(kNone, 2.0);
  }
  double value() const { return value_; }
  template <typename V>
  void Fields(V& v) {
    v("value", value_);
  }

 private:
  static constexpr double kNone = 1.0;  // no exploration yet; a gain of this is stored as the next
  double value_ = kNone;
};

}  // namespace regrasp
