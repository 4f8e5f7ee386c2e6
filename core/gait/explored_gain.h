#pragma once

/// What a finger's explorations have gained of late: the low-passed RelativeGain of each.

namespace regrasp {

class ExploredGain {
 public:
  bool known() const { return known_; }
  /// Whether it pays to explore again; what is not known may gain anything.
  bool at_least(double gain) const { return !known_ || value_ >= gain; }
  /// One more exploration; `share`: its weight against the ones before.
  void Add(double gain, double share) {
    value_ = known_ ? value_ + share * (gain - value_) : gain;
    known_ = true;
  }
  double value() const { return value_; }
  template <typename V>
  void Fields(V& v) {
    v("known", known_);
    v("value", value_);
  }

 private:
  bool known_ = false;  // there was one
  double value_ = 0;
};

}  // namespace regrasp
